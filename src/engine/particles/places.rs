//! Places of the particles of a rank, by id.

use rustc_hash::FxHashMap;

/// The place of each particle of a list of ids.
pub(super) enum Places {
    /// A table by id, unless ids are sparse; a look-up is one access to an array.
    Dense(Vec<u32>),
    Sparse(FxHashMap<u64, u32>),
}

/// Largest number of entries per particle in a table by id: the table then takes about as many bytes as a hash map.
const ENTRIES_PER_PARTICLE: usize = 8;

const NOWHERE: u32 = u32::MAX;

impl Places {
    pub(super) fn of(ids: &[u64]) -> Self {
        let places = ids.iter().zip(0_u32..);
        let last = ids.iter().max().map_or(0, |&id| usize::try_from(id).unwrap_or(usize::MAX));
        if last >= ENTRIES_PER_PARTICLE * ids.len() {
            return Self::Sparse(places.map(|(&id, place)| (id, place)).collect());
        }
        let mut table = vec![NOWHERE; last + 1];
        places.for_each(|(&id, place)| table[id as usize] = place);
        Self::Dense(table)
    }

    pub(super) fn get(&self, id: u64) -> Option<usize> {
        let place = match self {
            Self::Dense(table) => usize::try_from(id).ok().and_then(|id| table.get(id)),
            Self::Sparse(map) => map.get(&id),
        };
        place.filter(|&&place| place != NOWHERE).map(|&place| place as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_id_is_found_where_it_is_and_no_other() {
        let dense: Vec<u64> = (0..50).map(|k| k * 7 % 50 + 3).collect();
        let sparse: Vec<u64> = dense.iter().map(|id| u64::MAX - 1000 * id).collect();
        assert!(matches!(Places::of(&dense), Places::Dense(_)));
        assert!(matches!(Places::of(&sparse), Places::Sparse(_)));
        for ids in [dense, sparse, vec![0], vec![u64::MAX], Vec::new()] {
            let places = Places::of(&ids);
            let found = ids.iter().map(|&id| places.get(id));
            assert!(found.eq((0..ids.len()).map(Some)));
            for absent in [2, 53, 1 << 40, u64::MAX - 1] {
                assert_eq!(places.get(absent), None);
            }
        }
    }
}
