//! Kinds of pairs, by the two species that meet.

use super::body::Body;

/// Number of the kind of a pair of species, the same from both sides: pairs (0, 0), (1, 0), (1, 1), (2, 0) and so on.
#[inline(always)]
pub(crate) fn kind_of_species(one: usize, other: usize) -> usize {
    let (lower, higher) = if one < other { (one, other) } else { (other, one) };
    higher * (higher + 1) / 2 + lower
}

/// Number of the kind of a pair of bodies.
#[inline(always)]
pub(crate) fn kind_of_bodies([one, other]: [&Body; 2]) -> usize {
    kind_of_species(one.species(), other.species())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_are_numbered_without_gaps_and_the_same_from_both_sides() {
        let mut number = 0;
        for higher in 0..5 {
            for lower in 0..=higher {
                assert_eq!(kind_of_species(lower, higher), number);
                assert_eq!(kind_of_species(higher, lower), number);
                number += 1;
            }
        }
    }
}
