//! Agglomerates of one reference time at increasing lags, and their critical times.
//!
//! Source: Liu et al., Powder Technology (2016), section 3.2.

/// The agglomerates of contacts kept from t_0 to t_0 + lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AtLag {
    /// Time since t_0.
    pub lag: f64,
    /// N_agg, number of agglomerates.
    pub count: u64,
    /// Mass-weighted mean of d_agg.
    pub diameter: f64,
}

/// Critical times of breakage, as lags; each is the lag of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CriticalTimes {
    /// tau_Nmax: the first lag at which the number of agglomerates is largest.
    pub most: Option<f64>,
    /// tau_N15: the first lag after tau_Nmax at which there are fewer than 15 agglomerates (a limit that the user may
    /// choose). `None` if this has not happened yet.
    pub few: Option<f64>,
    /// tau_ds: the first lag from which on the diameter stays within a fraction of its mean over that stretch, up to
    /// tau_N15 or the end, for at least three samples. The paper only says "becomes steady"; the criterion is ours.
    pub steady: Option<f64>,
}

impl CriticalTimes {
    /// Critical times from samples at ascending lags; `few` is 15 in the paper, `tolerance` is the fraction within
    /// which a diameter is steady.
    pub fn of(looks: &[AtLag], few: u64, tolerance: f64) -> Self {
        let largest = looks.iter().map(|look| look.count).max().filter(|&count| count > 0);
        let Some(first) = largest.and_then(|n| looks.iter().position(|look| look.count == n))
        else {
            return Self::default();
        };
        let late = looks[first..].iter().position(|look| look.count < few);
        let end = late.map_or(looks.len(), |late| first + late);
        let is_steady = |stretch: &[AtLag]| {
            let mean = stretch.iter().map(|look| look.diameter).sum::<f64>() / stretch.len() as f64;
            stretch.iter().all(|look| (look.diameter - mean).abs() <= tolerance * mean)
        };
        let mut starts = 0..(end + 1).saturating_sub(3);
        let steady = starts.find(|&start| is_steady(&looks[start..end]));
        Self {
            most: Some(looks[first].lag),
            few: late.map(|late| looks[first + late].lag),
            steady: steady.map(|start| looks[start].lag),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fragmentation first, then attrition; the diameter decays to a plateau.
    fn looks(plateau: f64) -> Vec<AtLag> {
        let look = |k: u64| AtLag {
            lag: 0.01 * k as f64,
            count: if k < 5 { 100 + 20 * k } else { 180_u64.saturating_sub(12 * (k - 4)) },
            diameter: plateau + libm::exp(-(k as f64) / 3.0),
        };
        (0..25).map(look).collect()
    }

    #[test]
    fn critical_times_of_a_known_curve() {
        let times = CriticalTimes::of(&looks(0.2), 15, 0.1);
        assert_eq!(times.most, Some(0.04));
        // 180 - 12 (k - 4) < 15 from k = 18 on.
        assert_eq!(times.few, Some(0.18));
        // d falls within 10 % of its mean up to there when exp(-k/3) < 0.02 or so.
        let steady = times.steady.unwrap();
        assert!((0.095..=0.125).contains(&steady), "{steady}");
    }

    #[test]
    fn what_never_happens_has_no_time() {
        let early = &looks(0.2)[..8];
        let times = CriticalTimes::of(early, 15, 0.1);
        assert_eq!((times.few, times.steady), (None, None)); // still falling: the control
        assert_eq!(CriticalTimes::of(&[], 15, 0.1), CriticalTimes::default());
        let none = [AtLag { lag: 0.1, count: 0, diameter: 0.0 }];
        assert_eq!(CriticalTimes::of(&none, 15, 0.1), CriticalTimes::default());
    }
}
