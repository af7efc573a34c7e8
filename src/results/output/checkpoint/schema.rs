//! Layout of a checkpoint: a dataset for each id and each field of a record, and one for each of the custom fields.

use crate::output::MessageResult;
use crate::output::hdf5_file::SerialFile;
use talcum_engine::fields::{Field, Record, groups};
use talcum_engine::parallel::{Communicator, ParticleRecord, Records};
use talcum_engine::particles::CustomFields;

/// Value of the root's attribute `format`.
pub(super) const FORMAT: &str = "talcum checkpoint";
/// Version of this schema. A change that older programs would misread increases it; the contents of a file are
/// determined from the file itself.
///
/// 2: rolling angles of contacts, and a volume-averaged gas.
/// 3: the digest adds hashes by XXH3; those of earlier versions cannot be reproduced.
/// 4: twisting angles of contacts, and an energy ledger.
/// 5: species, if there are several.
/// 6: agglomerates of particles, if drag depends on them.
/// 7: any field that not every run has is left out if it is zero; custom fields.
pub(super) const VERSION: u64 = 7;
/// The first version whose digests are the present ones.
pub(super) const FIRST_WITH_DIGEST: u64 = 3;

/// The sums of an energy ledger.
pub(super) const LEDGER: &str = "/energy/work";

/// The fields of a record that a file has, with the place of the first word of each.
pub(super) type FieldsInFile = Vec<(usize, &'static Field)>;

/// The path of a dataset.
pub(super) fn path_of<R: Record>(name: &str) -> String {
    format!("{}/{name}", R::GROUP)
}

/// Whether a file has a dataset.
pub(super) fn has(file: &SerialFile, group: &str, name: &str) -> bool {
    file.names(group).is_ok_and(|names| names.iter().any(|other| other == name))
}

/// The fields that every run has, and the groups of fields that come together with a value that is not zero on some
/// rank. Collective.
pub(super) fn fields_in_use<R: Record>(
    records: &impl Records<R>,
    ranks: &dyn Communicator,
) -> FieldsInFile {
    let places: FieldsInFile = R::places().collect();
    let groups: Vec<_> = groups(R::FIELDS).map(|(_, fields)| fields).collect();
    let mut used = vec![0; groups.len()];
    let words_of = |group: usize| {
        let end = |field: usize| places[field].0 + places[field].1.width();
        places[groups[group].start].0..end(groups[group].end - 1)
    };
    for index in 0..records.count() {
        let record = records.at(index);
        for (group, used) in used.iter_mut().enumerate().filter(|(_, used)| **used == 0) {
            *used = i64::from(record.words()[words_of(group)].iter().any(|&word| word != 0));
        }
        if used.iter().all(|&used| used != 0) {
            break;
        }
    }
    ranks.sum_integers(&mut used);
    let is_in_use = |field: usize| {
        let group = groups.iter().position(|fields| fields.contains(&field));
        group.is_none_or(|group| used[group] != 0)
    };
    (0..places.len()).filter(|&field| is_in_use(field)).map(|field| places[field]).collect()
}

/// Custom fields of which one number is not zero on some rank. Collective.
pub(super) fn custom_fields_in_use(custom: &CustomFields, ranks: &dyn Communicator) -> Vec<usize> {
    let is_used = |field| custom.column(field).iter().any(|number| number.to_bits() != 0);
    let mut used: Vec<i64> =
        (0..custom.fields.len()).map(|field| i64::from(is_used(field))).collect();
    ranks.sum_integers(&mut used);
    (0..used.len()).filter(|&field| used[field] != 0).collect()
}

/// The fields of a record that a file has; all fields that every run has must be there.
pub(super) fn fields_in_file<R: Record>(file: &SerialFile) -> MessageResult<FieldsInFile> {
    let names = file.names(R::GROUP)?;
    let is_there = |field: &Field| names.iter().any(|name| name == field.name);
    let needed = R::FIELDS.iter().filter(|field| field.comes_with.is_none());
    if let Some(missing) = needed.clone().find(|field| !is_there(field)) {
        return Err(format!("{} is missing", path_of::<R>(missing.name)));
    }
    Ok(R::places().filter(|(_, field)| is_there(field)).collect())
}

/// Names of datasets of particles that are not built-in fields: custom fields.
pub(super) fn own_names(file: &SerialFile) -> MessageResult<Vec<String>> {
    let mut names = file.names(ParticleRecord::GROUP)?;
    let is_built_in = |name: &String| {
        let ids = ParticleRecord::IDS.iter().map(|id| id.name);
        ids.chain(ParticleRecord::FIELDS.iter().map(|field| field.name)).any(|other| other == name)
    };
    names.retain(|name| !is_built_in(name));
    names.sort_unstable();
    Ok(names)
}
