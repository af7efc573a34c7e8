//! Parcels in place of particles.
//!
//! The rest of the case describes particles and is read as such; what acts on the parcels follows from it.

use super::particles::{Amount, BedStart, ParticleSetup};
use super::sizes::{SizeClass, SizeDistribution};
use super::{Case, Stage};
use crate::contact::{CoarseGraining, Kept};
use crate::input::Section;

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
    /// Diameter of the particles that bodies of the run of this diameter stand for: their own, or that of a parcel over l.
    pub fn particle_diameter(&self, diameter: f64) -> f64 {
        self.coarse_graining.map_or(diameter, |parcels| diameter / parcels.length())
    }
}

impl ParticleSetup {
    /// The parcels of these particles.
    fn coarse_grained(self, parcels: &CoarseGraining) -> Self {
        let length = parcels.length();
        let amount = |amount| match amount {
            Amount::Count(count) => {
                Amount::Count((count as f64 / parcels.particles()).round() as u64)
            }
            Amount::FillHeight(height) => Amount::FillHeight(height),
        };
        let start = match self.start {
            BedStart::Lattice { spacing, jitter, bottom } => {
                BedStart::Lattice { spacing: length * spacing, jitter, bottom }
            }
            other => other,
        };
        Self {
            amount: self.amount.map(amount),
            sizes: self.sizes.map(|sizes| sizes.enlarged(length)),
            reference_diameter: length * self.reference_diameter,
            start,
            ..self
        }
    }
}

impl SizeDistribution {
    /// All diameters multiplied by a factor.
    fn enlarged(self, factor: f64) -> Self {
        let class = |class: SizeClass| SizeClass { diameter: factor * class.diameter, ..class };
        match self {
            Self::Single(diameter) => Self::Single(factor * diameter),
            Self::Classes(classes) => Self::Classes(classes.into_iter().map(class).collect()),
            Self::Uniform { smallest, largest } => {
                Self::Uniform { smallest: factor * smallest, largest: factor * largest }
            }
            Self::Normal { mean, deviation, smallest, largest } => Self::Normal {
                mean: factor * mean,
                deviation: factor * deviation,
                smallest: factor * smallest,
                largest: factor * largest,
            },
            Self::LogNormal { median, deviation, smallest, largest } => Self::LogNormal {
                median: factor * median,
                deviation,
                smallest: factor * smallest,
                largest: factor * largest,
            },
        }
    }
}
