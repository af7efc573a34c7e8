//! Files that are read, damaged at random: they are read, or refused with a message that names the place; no reader panics.
//!
//! Each property tries 256 files; the environment variable `PROPTEST_CASES` sets another number.

use crate::checkpoints::forge;
use crate::launch::in_repository;
use hdf5::types::VarLenUnicode;
use proptest::prelude::*;
use proptest::sample::Index;
use std::path::Path;
use talcum::case::{BedPart, Case};
use talcum::output::checkpoint::{self, Checkpoint};
use talcum::output::readers::SeriesTable;
use talcum::parallel::OneRank;

/// Words in place of another: numbers beyond every range, no numbers, and what separates and announces parts.
const ODD: [&str; 20] = [
    "",
    "0",
    "-1",
    "1e999",
    "-1e300",
    "5e-324",
    "nan",
    "inf",
    "18446744073709551616",
    "1e18",
    "٣",
    "\u{0}",
    "\"",
    ",",
    "# case:",
    "id",
    "time [s]",
    "ITEM: ATOMS id x",
    "ITEM: TIMESTEP",
    "\r\n",
];

/// A change of a text: what happens at a place of it.
type Edit = (Index, usize, Index);

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    prop::collection::vec((any::<Index>(), 0..6usize, any::<Index>()), 1..5)
}

/// A text in which words are replaced, lines are removed, doubled or exchanged, characters are inserted, or the end is missing.
fn edited(text: &str, edits: &[Edit]) -> String {
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for (place, kind, with) in edits {
        if lines.is_empty() {
            break;
        }
        let at = place.index(lines.len());
        let other = with.index(lines.len());
        match kind {
            0 => drop(lines.remove(at)),
            1 => lines.insert(other, lines[at].clone()),
            2 => lines.swap(at, other),
            3 => lines.truncate(at + 1),
            4 => lines[at].insert_str(0, ODD[with.index(ODD.len())]),
            _ => lines[at] = with_odd_word(&lines[at], *with),
        }
    }
    lines.join("\n")
}

/// A line, one of whose words between commas or blanks is an odd one.
fn with_odd_word(line: &str, with: Index) -> String {
    let words: Vec<&str> = line.split_inclusive([',', ' ']).collect();
    let at = with.index(words.len().max(1));
    let odd = ODD[with.index(ODD.len())];
    let word = |(number, word): (usize, &&str)| {
        let end = word.chars().last().filter(|last| ", ".contains(*last)).map(String::from);
        if number == at { format!("{odd}{}", end.unwrap_or_default()) } else { (*word).to_owned() }
    };
    words.iter().enumerate().map(word).collect()
}

/// Makes the bed of a good case from a damaged file of particles.
fn make_bed(case: &str, name: &str, edits: &[Edit]) -> Result<(), TestCaseError> {
    let good = in_repository("tests/cases/good");
    let folder = tempfile::tempdir().unwrap();
    let text = std::fs::read_to_string(good.join(case)).unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, edited(&std::fs::read_to_string(good.join(name)).unwrap(), edits))
        .unwrap();
    let case = Case::from_text(&text, case, folder.path(), &[]).unwrap();
    match case.initial_bed(BedPart::WHOLE) {
        Ok(bed) => {
            let finite = |position: [f64; 3]| position.iter().all(|x| x.is_finite());
            prop_assert!(bed.particles.iter().all(|particle| finite(particle.position)));
        }
        // Particles that do not fit into the box are an error of the case.
        Err(error) => {
            let message = error.to_string();
            prop_assert!(message.contains(name) || message.contains(".toml:"), "{message}");
        }
    }
    Ok(())
}

/// Changes an attribute or a dataset of a checkpoint: removes it, or gives it another type, shape or number.
fn change(file: &hdf5::File, place: Index, kind: usize, with: Index) -> hdf5::Result<()> {
    let groups: Vec<hdf5::Group> = [file.as_group()?].into_iter().chain(file.groups()?).collect();
    let group = &groups[place.index(groups.len())];
    let names = group.attr_names()?;
    let datasets = group.datasets()?;
    if kind < 3 && !names.is_empty() {
        let name = &names[with.index(names.len())];
        group.delete_attr(name)?;
        let odd = [0.0, -1.0, f64::NAN, 1.0e300];
        match kind {
            0 => {}
            1 => group.new_attr::<f64>().create(&**name)?.write_scalar(&odd[with.index(4)])?,
            _ => {
                let odd: VarLenUnicode = ODD[with.index(10)].parse().unwrap_or_default();
                group.new_attr::<VarLenUnicode>().create(&**name)?.write_scalar(&odd)?;
            }
        }
    } else if !datasets.is_empty() {
        let dataset = &datasets[with.index(datasets.len())];
        let name = dataset.name();
        let rows = dataset.shape().first().copied().unwrap_or(0);
        file.unlink(&name)?;
        let shape = [vec![rows + 1], vec![rows, 2], vec![0], vec![rows]][with.index(4)].clone();
        match kind {
            3 => {}
            4 => drop(file.new_dataset::<f32>().shape(shape).create(&*name)?),
            _ => drop(file.new_dataset::<u64>().shape(shape).create(&*name)?),
        }
    }
    Ok(())
}

fn read(path: &Path) -> Result<Checkpoint, String> {
    let read = checkpoint::read(path, &OneRank);
    read.map(|(checkpoint, ..)| checkpoint).map_err(|error| error.to_string())
}

proptest! {
    #[test]
    fn no_table_of_particles_makes_the_reader_panic(edits in edits()) {
        make_bed("csv-file.toml", "bed.csv", &edits)?;
    }

    #[test]
    fn no_dump_of_particles_makes_the_reader_panic(edits in edits()) {
        make_bed("lammps-file.toml", "bed.dump", &edits)?;
    }

    #[test]
    fn no_series_makes_the_reader_panic(edits in edits()) {
        let whole = "# commit: abc\n# case: a = 1\n# units: si\ntime [s],bed_top [m],b [1]\n0,10,1\n0.5,12,1e-3\n1,20,inf\n";
        if let Ok(table) = SeriesTable::parse(&edited(whole, &edits)) {
            prop_assert!(table.rows.iter().all(|row| row.len() == table.columns.len()));
            prop_assert_eq!(table.column("time").unwrap().len(), table.rows.len());
            prop_assert!(table.between(0.2, 0.8).rows.len() <= table.rows.len());
        }
    }

    #[test]
    fn no_contents_of_a_checkpoint_make_the_reader_panic(
        version in 1..7, changes in prop::collection::vec((any::<Index>(), 0..6usize, any::<Index>()), 1..3),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("checkpoint.h5");
        std::fs::copy(in_repository(&format!("tests/program/checkpoints/version-{version}.h5")), &path).unwrap();
        forge(&path, |file| changes.iter().for_each(|(place, kind, with)| change(file, *place, *kind, *with).unwrap()));
        if let Err(message) = read(&path) {
            prop_assert!(message.contains("checkpoint.h5"), "{message}");
        }
    }
}
