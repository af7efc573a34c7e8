//! Sorting of records by a whole number, in a time proportional to the number of records.

const DIGIT_BITS: u32 = 11;
const DIGITS: usize = 1 << DIGIT_BITS;
/// Number of records below which they are sorted by comparison.
const FEW: usize = 512;

/// The records by ascending key; those with equal keys keep their order. Keys within a narrow range need few passes
/// (radix sort, the least significant digit first; Knuth, The Art of Computer Programming 3, section 5.2.5).
pub fn sorted_by_key<T: Copy>(mut records: Vec<T>, key: impl Fn(&T) -> u64) -> Vec<T> {
    if records.is_sorted_by_key(&key) {
        return records;
    }
    if records.len() < FEW {
        records.sort_by_key(key);
        return records;
    }
    let (least, largest) = records
        .iter()
        .map(&key)
        .fold((u64::MAX, 0), |(least, largest), key| (least.min(key), largest.max(key)));
    let bits = u64::BITS - (largest - least).leading_zeros();
    let mut other = records.clone();
    for shift in (0..bits).step_by(DIGIT_BITS as usize) {
        let digit = |record: &T| ((key(record) - least) >> shift) as usize % DIGITS;
        let mut next = first_places(&records, digit);
        for record in &records {
            let place = &mut next[digit(record)];
            other[*place] = *record;
            *place += 1;
        }
        std::mem::swap(&mut records, &mut other);
    }
    records
}

/// First place of the records of each digit.
fn first_places<T>(records: &[T], digit: impl Fn(&T) -> usize) -> Vec<usize> {
    let mut counts = vec![0; DIGITS];
    records.iter().for_each(|record| counts[digit(record)] += 1);
    let mut sum = 0;
    for count in &mut counts {
        sum += std::mem::replace(count, sum);
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn records_are_sorted_and_equal_ones_stay_in_order(
            keys in prop::collection::vec(0u64..3000, 0..2000),
            base in prop::sample::select(vec![0, 1 << 40, u64::MAX - 4000]),
        ) {
            let records: Vec<(u64, usize)> =
                keys.iter().enumerate().map(|(place, key)| (base + key, place)).collect();
            let mut expected = records.clone();
            expected.sort_by_key(|record| record.0);
            prop_assert_eq!(sorted_by_key(records, |record| record.0), expected);
        }

        #[test]
        fn keys_of_any_size_are_sorted(mut keys in prop::collection::vec(any::<u64>(), 600..900)) {
            let sorted = sorted_by_key(keys.clone(), |&key| key);
            keys.sort_unstable();
            prop_assert_eq!(sorted, keys);
        }
    }
}
