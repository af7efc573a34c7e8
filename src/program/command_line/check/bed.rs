//! The bed at rest: its height, and the compression of its contacts.

use super::lines::Lines;
use std::f64::consts::PI;
use talcum_engine::contact::{ContactForceLaw, overlap_under};
use talcum_engine::fields::Unit;
use talcum_engine::gas::GasModel;
use talcum_engine::gas::volume_averaged::VolumeAveragedModel;
use talcum_engine::parallel::Communicator;
use talcum_engine::rules::ReducedBody;
use talcum_engine::state::{SizeRange, State};
use talcum_results::output::ColumnUnits;
use talcum_runs::case::{Case, Stage};

/// Solids fraction of a poured bed.
const POURED: f64 = 0.6;
/// Smallest number of layers that form a bed for a gas to flow through; fewer usually mean that lengths are in two
/// different units.
const FEWEST_LAYERS: f64 = 3.0;
/// Depth of a packed bed that is missing from its pressure drop because of its two surfaces: 0.85 times the height of a
/// cell and three quarters of the filter's width, added as squares (docs/verification.md has the measured values).
const LOST_DEPTH: f64 = 0.85;
const OF_FILTER: f64 = 0.75;
/// Recommended width of the cells of `gas.local_voidage`, in diameters.
const ADVISED_CELL: f64 = 1.5;
/// Lost fraction of the pressure drop above which the loss is reported.
const LARGE_LOSS: f64 = 0.15;
/// The largest overlap over the diameter in a bed at rest: beyond it, solids fractions and drag depend on the
/// stiffness.
const AT_REST: f64 = 0.05;
/// Largest overlap of an impact at the highest speed, which is rare and short.
const IN_IMPACT: f64 = 0.1;

/// The bed that the particles of a case form under gravity.
pub(super) struct BedAtRest {
    height: f64,
    solid_volume: f64,
    cross_section: f64,
}

impl BedAtRest {
    /// The bed of all ranks' particles. Collective.
    pub(super) fn of(case: &Case, state: &State, ranks: &dyn Communicator) -> Self {
        let particles = &state.particles;
        let here: f64 = (0..particles.owned_count()).map(|index| particles.volume(index)).sum();
        let volumes = ranks.gather_to_root(&here.to_le_bytes()).unwrap_or_default();
        let read = |bytes: &Vec<u8>| bytes.as_slice().try_into().map_or(0.0, f64::from_le_bytes);
        let solid_volume: f64 = volumes.iter().map(read).sum();
        let cross_section = case.domain.cross_section();
        Self { height: solid_volume / (POURED * cross_section), solid_volume, cross_section }
    }

    /// Describes height and layers, with a warning if they are implausible.
    pub(super) fn describe(&self, lines: &mut Lines, case: &Case, sizes: &SizeRange) {
        if case.stages.iter().all(|stage| stage.physics.gravity.magnitude == 0.0) {
            return;
        }
        let length = ColumnUnits::of_system(case.units.name()).of(Unit::Length);
        let layers = self.height / sizes.largest_diameter;
        let text = format!(
            "about {:.4e} {length} high, {layers:.1} layers, at a solids fraction of {POURED}",
            self.height
        );
        lines.add("the bed at rest", &text);
        let has_gas = case.stages.iter().any(|stage| !matches!(stage.physics.gas, GasModel::None));
        if has_gas && layers < FEWEST_LAYERS {
            lines.warn(&format!(
                "these are fewer than {FEWEST_LAYERS} layers: are the box and the diameter in the same unit?"
            ));
        }
        if let Some(gas) = case.volume_averaged() {
            self.describe_cells(lines, gas, sizes);
        }
        let room = case.domain.bounds.lengths().z;
        if self.height > room {
            lines.warn(&format!("the box is only {room:.4e} {length} high"));
        }
    }

    /// Describes whether the cells of a gas, and the filter between them and the particles, resolve the bed's height.
    fn describe_cells(&self, lines: &mut Lines, gas: &VolumeAveragedModel, sizes: &SizeRange) {
        let spacing = gas.grid.spacing().z;
        // Drag laws that use finer cells do not use the filter.
        let (seen, filter_width) = match gas.coupling.local_voidage {
            None => (spacing, gas.coupling.filter_width),
            Some(_) => (gas.finest_cells().spacing().z, 0.0),
        };
        let lost = LOST_DEPTH * seen.hypot(OF_FILTER * filter_width) / self.height;
        if lost > LARGE_LOSS {
            let cells = self.height / spacing;
            let percent = 100.0 * lost.min(1.0);
            let advice = self.advice_on_finer_cells(spacing, lost, sizes);
            lines.warn(&format!(
                "at rest the bed is {cells:.1} cells of the gas high: cells and filter smear its surfaces, which takes some \
                 {percent:.0} % from its pressure drop below U_mf, and raises U_mf; voids smaller than a cell are not seen{advice}"
            ));
        }
    }

    /// The lost fraction with the voidage of finer cells, if it is much smaller.
    fn advice_on_finer_cells(&self, spacing: f64, lost: f64, sizes: &SizeRange) -> String {
        let finer = (spacing / (ADVISED_CELL * sizes.largest_diameter)).round().max(1.0);
        let of_finer = (LOST_DEPTH * spacing / finer / self.height).min(1.0);
        if of_finer < 0.8 * lost {
            let percent = 100.0 * of_finer;
            return format!("; gas.local_voidage = {finer} would take some {percent:.0} % instead");
        }
        String::new()
    }

    /// Describes the overlaps of two particles under the weight of the bed, and in an impact at the highest speed of a
    /// stage.
    pub(super) fn describe_overlaps(&self, lines: &mut Lines, case: &Case, stage: &Stage) {
        let diameter = case.particles.reference_diameter;
        let mass = case.particles.mass_of(diameter);
        let bodies = ReducedBody::of_equal_spheres(mass, 0.5 * diameter);
        let law = &stage.physics.contact.first().law;
        let gravity = &stage.physics.gravity;
        let largest = 1.0 + gravity.vibration.as_ref().map_or(0.0, |v| v.relative_acceleration);
        let stress =
            self.solid_volume * case.particles.mean_density() * gravity.magnitude * largest
                / self.cross_section;
        let at_rest = overlap_under(law, bodies, stress * diameter * diameter) / diameter;
        if at_rest > 0.0 {
            describe_overlap(lines, "overlap under the bed's weight", [at_rest, AT_REST], "");
        }
        let speed = highest_speed(case, stage);
        if speed > 0.0 {
            // The overlap of a linear spring: v sqrt(m* / k), with pi sqrt(m* / k) the duration of a contact.
            let overlap = speed * law.contact_duration(bodies.mass, bodies.radius) / PI / diameter;
            let unit = ColumnUnits::of_system(case.units.name()).of(Unit::Speed);
            let when = format!(" at {speed:.4e} {unit}");
            describe_overlap(lines, "overlap of an impact", [overlap, IN_IMPACT], &when);
        }
    }
}

fn describe_overlap(lines: &mut Lines, name: &str, [overlap, largest]: [f64; 2], when: &str) {
    lines.add(name, &format!("{overlap:.1e} of the diameter{when}"));
    if overlap > largest {
        lines.warn(&format!("that is more than {largest}: raise the stiffness"));
    }
}

/// The highest of the given speeds: the superficial velocity, and the speeds of the plate and of walls.
fn highest_speed(case: &Case, stage: &Stage) -> f64 {
    let gas = super::gas::upward_velocity(&stage.physics.gas).unwrap_or(0.0);
    let gravity = &stage.physics.gravity;
    let plate = gravity.vibration.as_ref().map_or(0.0, |vibration| {
        gravity.magnitude * vibration.relative_acceleration / (2.0 * PI * vibration.frequency)
    });
    let walls = case.domain.walls.iter().map(|wall| {
        let swing = 2.0 * PI * wall.motion.frequency * wall.motion.amplitude.norm();
        wall.motion.velocity.norm() + swing
    });
    walls.fold(gas.max(plate), f64::max)
}
