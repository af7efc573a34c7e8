//! Parcels instead of particles.
//!
//! The rest of the case describes particles and is read accordingly; the models for the parcels follow from it.

use super::{Case, Stage};
use crate::beds::{Amount, BedStart};
use crate::input::Section;
use talcum_engine::contact::{CoarseGraining, Kept};

/// `[coarse_graining]`: the case of the parcels.
pub(super) fn read_coarse_graining(section: &Section<'_>, case: Case) -> Option<Case> {
    let (factor, keeps) = (section.number("factor"), section.choice("keeps", &Kept::ALL));
    let parcels = CoarseGraining { factor: factor?, keeps: keeps? };
    if let BedStart::File { .. } = case.particles.start {
        let message = "cannot be given for a bed from a file: are its rows particles or parcels?";
        section.fail("factor", message);
    }
    if let Some(Amount::Count(count)) = case.particles.amount
        && count as f64 / parcels.particles() < 0.5
    {
        let least = parcels.particles().ceil();
        section.fail("factor", format!("a parcel stands for {least} particles: there are {count}"));
    }
    if case.stages.iter().any(|stage| stage.physics.gas.agglomerates().is_some()) {
        let message = "cannot be given with gas.agglomerates: contacts of parcels say nothing about the agglomerates of their particles";
        section.fail("factor", message);
        return None;
    }
    let of_stage =
        |stage: Stage| Stage { physics: stage.physics.coarse_grained(&parcels), ..stage };
    Some(Case {
        particles: case.particles.coarse_grained(&parcels),
        stages: case.stages.into_iter().map(of_stage).collect(),
        coarse_graining: Some(parcels),
        ..case
    })
}

impl Case {
    /// Diameter of the particles that are represented by bodies of this diameter: their own diameter, or that of a
    /// parcel divided by l.
    pub fn particle_diameter(&self, diameter: f64) -> f64 {
        self.coarse_graining.map_or(diameter, |parcels| diameter / parcels.length())
    }
}
