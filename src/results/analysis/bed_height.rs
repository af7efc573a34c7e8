//! Height of a bed from its profile of the solids fraction.

use crate::analysis::no_value::{NoValue, require_finite, require_positive};

/// The solids fraction phi at heights k dz above the plate, k = 0, 1, ...; node 0 is on the plate and represents the
/// mass below dz / 2, so that sum(phi) dz is the volume of solids per area.
#[derive(Clone, Copy, Debug)]
pub struct Profile<'a> {
    /// phi at each node.
    pub solids_fractions: &'a [f64],
    /// Distance dz between nodes. Length.
    pub spacing: f64,
}

/// Height of a bed by three definitions, and its bottom. Lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BedHeight {
    /// The lowest height at which phi rises through the threshold; 0 if phi is above it on the plate.
    pub bottom: f64,
    /// The highest height at which phi falls through the threshold. Splashes and voids near the surface move it.
    pub by_threshold: f64,
    /// Twice the height of the centre of mass, 2 sum(z phi) / sum(phi): the top of a uniform bed that lies on the
    /// plate.
    pub by_centre_of_mass: f64,
    /// The height below which the given share of the mass lies. It is steady in a bubbling bed; for a uniform bed it is
    /// this share of its height.
    pub by_mass: f64,
}

/// Parameters of the definitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BedHeightOptions {
    /// Solids fraction that bounds the bed.
    pub threshold: f64,
    /// Share of the mass below the bed's height, above 0 and at most 1.
    pub mass_share: f64,
}

impl Default for BedHeightOptions {
    fn default() -> Self {
        Self { threshold: 0.3, mass_share: 0.95 }
    }
}

/// Measures the height of a bed.
///
/// Fails if the profile is not finite, has fewer than two nodes, holds no solids, or stays below the threshold.
pub fn bed_height(profile: &Profile, options: &BedHeightOptions) -> Result<BedHeight, NoValue> {
    let phi = profile.solids_fractions;
    require_finite("solids_fractions", phi)?;
    require_positive("the spacing", profile.spacing)?;
    require_positive("the threshold", options.threshold)?;
    if !(options.mass_share > 0.0 && options.mass_share <= 1.0) {
        let share = options.mass_share;
        return Err(NoValue::because(format!(
            "the share of mass is {share}, not above 0 and at most 1"
        )));
    }
    let mass: f64 = phi.iter().sum();
    if phi.len() < 2 || mass <= 0.0 {
        return Err(NoValue::because(format!(
            "the profile of {} nodes holds no solids",
            phi.len()
        )));
    }
    let moment: f64 = phi.iter().enumerate().map(|(node, phi)| node as f64 * phi).sum();
    let (bottom, top) = crossings(phi, options.threshold)?;
    Ok(BedHeight {
        bottom: bottom * profile.spacing,
        by_threshold: top * profile.spacing,
        by_centre_of_mass: 2.0 * moment / mass * profile.spacing,
        by_mass: mass_height(phi, options.mass_share * mass) * profile.spacing,
    })
}

/// (H - H_ref) / H_ref: expansion of a bed relative to a reference state, both by the same definition. Fails if the
/// reference is not positive.
pub fn expansion(height: f64, reference: f64) -> Result<f64, NoValue> {
    require_positive("the reference height", reference)?;
    require_finite("height", &[height])?;
    Ok(height / reference - 1.0)
}

/// Number of layers left out at the plate and below the surface, in spacings: their cells are half empty, or ordered by
/// the plate.
const END_LAYERS: f64 = 4.0;
/// Largest fraction of the height that is left out at either end of a shallow bed.
const MOST_LEFT_OUT: f64 = 0.25;

/// Solids fraction of the bulk: the mean of phi over the nodes between bottom and top, both as in [`BedHeight`],
/// without four spacings, or a quarter of the height if this is less, at either end.
///
/// Fails like [`bed_height`], or if no node lies in between.
pub fn bulk_solids_fraction(profile: &Profile, options: &BedHeightOptions) -> Result<f64, NoValue> {
    let BedHeight { bottom, by_threshold: top, .. } = bed_height(profile, options)?;
    let margin = (END_LAYERS * profile.spacing).min(MOST_LEFT_OUT * (top - bottom));
    let inside = |node: usize| {
        let height = node as f64 * profile.spacing;
        height >= bottom + margin && height <= top - margin
    };
    let nodes = profile.solids_fractions.iter().enumerate().filter(|(node, _)| inside(*node));
    let bulk: Vec<f64> = nodes.map(|(_, phi)| *phi).collect();
    match bulk.len() {
        0 => Err(NoValue::because("the bed is too shallow for the spacing of its profile")),
        count => Ok(bulk.iter().sum::<f64>() / count as f64),
    }
}

/// Lowest and highest position at which phi crosses a threshold, in nodes, by linear interpolation between nodes.
fn crossings(phi: &[f64], threshold: f64) -> Result<(f64, f64), NoValue> {
    let lowest = phi.iter().position(|&phi| phi >= threshold);
    let highest = phi.iter().rposition(|&phi| phi >= threshold);
    let (Some(lowest), Some(highest)) = (lowest, highest) else {
        let largest = phi.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        return Err(NoValue::because(format!(
            "the solids fraction is nowhere above the threshold {threshold}; its largest is {largest:.4}"
        )));
    };
    let part = |inside: f64, outside: f64| (inside - threshold) / (inside - outside);
    let bottom = match lowest {
        0 => 0.0,
        // Node 0 averages over half a cell and may be below the threshold in a bed that lies on the plate.
        1 if 2.0 * phi[0] >= threshold => 0.0,
        node => node as f64 - part(phi[node], phi[node - 1]),
    };
    let top = match phi.get(highest + 1) {
        Some(&above) => highest as f64 + part(phi[highest], above),
        None => highest as f64,
    };
    Ok((bottom, top))
}

/// The height below which a given sum of phi lies, in nodes. The mass of a node is spread evenly over its cell, from
/// half a spacing below to half a spacing above; for node 0 over the upper half.
fn mass_height(phi: &[f64], share: f64) -> f64 {
    let mut below = 0.0;
    for (node, &phi) in phi.iter().enumerate() {
        if below + phi >= share && phi > 0.0 {
            let part = (share - below) / phi;
            return if node == 0 { 0.5 * part } else { node as f64 - 0.5 + part };
        }
        below += phi;
    }
    // Because of round-off the sum stayed below the whole mass.
    phi.iter().rposition(|&phi| phi > 0.0).map_or(0.0, |node| node as f64 + 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hat weights of a uniform bed of phi 0.6 between two heights, on 200 nodes of spacing 1.5.
    fn uniform(from: f64, to: f64) -> Vec<f64> {
        let integral = |node: usize, z: f64| {
            let x = (z / 1.5 - node as f64).clamp(-1.0, 1.0);
            if x < 0.0 { 0.5 * (1.0 + x) * (1.0 + x) } else { 1.0 - 0.5 * (1.0 - x) * (1.0 - x) }
        };
        (0..200).map(|node| 0.6 * (integral(node, to) - integral(node, from))).collect()
    }

    fn measure(phi: &[f64]) -> BedHeight {
        let profile = Profile { solids_fractions: phi, spacing: 1.5 };
        bed_height(&profile, &BedHeightOptions::default()).unwrap()
    }

    #[test]
    fn a_uniform_bed_has_one_height_by_all_definitions() {
        for height in [30.0, 100.4, 151.1] {
            let found = measure(&uniform(0.0, height));
            // First moments of hat weights are exact.
            assert!((found.by_centre_of_mass / height - 1.0).abs() < 1e-12, "{found:?}");
            // Within the cells phi is assumed to be uniform, and edges to be straight: a tenth of the spacing.
            assert!((found.by_mass - 0.95 * height).abs() < 0.15, "{height} {found:?}");
            assert!((found.by_threshold - height).abs() < 0.15, "{height} {found:?}");
            assert_eq!(found.bottom, 0.0);
        }
    }

    #[test]
    fn a_lifted_bed_shows_its_bottom_and_an_expanded_one_its_expansion() {
        let found = measure(&uniform(7.0, 107.0));
        assert!((found.bottom - 7.0).abs() < 0.15, "{found:?}");
        let reference = measure(&uniform(0.0, 80.0));
        let expanded = measure(&uniform(0.0, 100.0));
        let by_centre = expansion(expanded.by_centre_of_mass, reference.by_centre_of_mass).unwrap();
        assert!((by_centre - 0.25).abs() < 1e-12);
        assert!(expansion(1.0, 0.0).is_err());
    }

    #[test]
    fn the_bulk_of_deep_and_shallow_beds_is_found_and_its_ends_are_left_out() {
        let options = BedHeightOptions::default();
        for height in [6.0, 30.0, 150.0] {
            let mut phi = uniform(0.0, height);
            // An ordered layer at the plate, and half-empty cells at the surface.
            phi[0] = 0.74;
            let profile = Profile { solids_fractions: &phi, spacing: 1.5 };
            let bulk = bulk_solids_fraction(&profile, &options).unwrap();
            assert!((bulk - 0.6).abs() < 1e-12, "{height}: {bulk}");
            // Control: a plain mean over the bed is not that of the bulk.
            let bed = &phi[..=(height / 1.5) as usize];
            assert!((bed.iter().sum::<f64>() / bed.len() as f64 - 0.6).abs() > 1e-3);
        }
        let flat = Profile { solids_fractions: &[0.0, 0.6, 0.0], spacing: 1.5 };
        assert!(bulk_solids_fraction(&flat, &options).is_ok());
    }

    #[test]
    fn a_bursting_bubble_moves_the_threshold_but_not_the_mass() {
        let quiet = uniform(0.0, 100.0);
        let mut splashed = quiet.clone();
        // A layer thrown 12 above the surface; its mass comes from the layer below the surface.
        splashed[74] = 0.4;
        splashed[65] -= 0.4;
        let (a, b) = (measure(&quiet), measure(&splashed));
        assert!(b.by_threshold - a.by_threshold > 10.0);
        assert!((b.by_mass - a.by_mass).abs() < 1.0);
        assert!((b.by_centre_of_mass - a.by_centre_of_mass).abs() < 0.3);
    }

    #[test]
    fn profiles_without_a_bed_say_why() {
        let options = BedHeightOptions::default();
        let measure = |phi: &[f64]| {
            bed_height(&Profile { solids_fractions: phi, spacing: 1.5 }, &options).unwrap_err()
        };
        assert!(measure(&[0.0; 10]).reason().contains("holds no solids"));
        assert!(measure(&[0.1; 10]).reason().contains("nowhere above the threshold 0.3"));
        assert!(measure(&[f64::NAN; 10]).reason().contains("NaN"));
    }
}
