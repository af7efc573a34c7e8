//! Reduction of long tables to few enough points to draw, without a visible loss.

/// At most `most` of the points, in the order of time: the lowest and the highest in each of equal parts of the rows,
/// so that no peak is lost, and the last point.
pub(super) fn thin(points: &[(f64, f64)], most: usize) -> Vec<(f64, f64)> {
    if points.len() <= most {
        return points.to_vec();
    }
    let parts = (most.saturating_sub(1) / 2).max(1);
    let mut kept: Vec<(f64, f64)> =
        points.chunks(points.len().div_ceil(parts)).flat_map(extremes).collect();
    if kept.last() != points.last() {
        kept.extend(points.last());
    }
    kept
}

fn extremes(part: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let numbered = || part.iter().enumerate();
    let lowest = numbered().min_by(|a, b| a.1.1.total_cmp(&b.1.1)).map_or(0, |(place, _)| place);
    let highest = numbered().max_by(|a, b| a.1.1.total_cmp(&b.1.1)).map_or(0, |(place, _)| place);
    let mut places = vec![lowest.min(highest), lowest.max(highest)];
    places.dedup();
    places.into_iter().map(|place| part[place]).collect()
}

/// The parts of a length that is divided into at most `most` equal ones; the last may be shorter.
pub(super) fn parts(length: usize, most: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let size = length.div_ceil(most.max(1)).max(1);
    (0..length).step_by(size).map(move |start| start..(start + size).min(length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_peaks_ends_and_order() {
        let mut points: Vec<(f64, f64)> = (0..10_000).map(|n| (f64::from(n), 0.5)).collect();
        points[7_777].1 = 9.0;
        points[3_333].1 = -9.0;
        let thinned = thin(&points, 100);
        assert!(thinned.len() <= 100, "{}", thinned.len());
        assert!(thinned.is_sorted_by(|a, b| a.0 < b.0));
        assert!(thinned.contains(&(7_777.0, 9.0)) && thinned.contains(&(3_333.0, -9.0)));
        assert_eq!((thinned[0], thinned.last()), (points[0], points.last()));
        // Taking every hundredth point would have lost both.
        let every_hundredth: Vec<_> = points.iter().step_by(100).collect();
        assert!(every_hundredth.iter().all(|point| point.1 == 0.5));
    }

    #[test]
    fn few_points_stay_as_they_are() {
        let points = [(0.0, 1.0), (1.0, 1.0), (2.0, 0.0)];
        assert_eq!(thin(&points, 3), points);
        assert_eq!(thin(&[], 3), []);
        assert!(!thin(&points, 1).is_empty());
    }

    #[test]
    fn parts_cover_a_length_without_gaps() {
        let covered = |length, most| parts(length, most).flatten().eq(0..length);
        assert!(covered(10, 3) && covered(3, 10) && covered(0, 5) && covered(1, 1));
        assert_eq!(parts(10, 3).count(), 3);
        assert_eq!(parts(1_001, 100).count(), 91);
    }
}
