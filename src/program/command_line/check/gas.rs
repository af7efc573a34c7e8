//! The gas in familiar numbers: its regime, and its velocity compared with those of fluidisation and of free fall.

use super::lines::Lines;
use super::particle::ReferenceParticle;
use talcum_engine::fields::Unit;
use talcum_engine::gas::volume_averaged::{CouplingModel, VolumeAveragedModel};
use talcum_engine::gas::{AgglomerateBall, AgglomerateDrag, DragShare, Drive, GasModel};
use talcum_engine::rules::{archimedes_number, excess_of_lone_fall, stokes_number};
use talcum_engine::state::SizeRange;
use talcum_results::analysis::minimum_fluidisation::minimum_fluidisation_velocity;
use talcum_results::output::ColumnUnits;
use talcum_runs::case::{Case, Stage};

/// Solids fractions of settled beds for which the minimum fluidisation velocity is printed.
const SETTLED: [f64; 3] = [0.60, 0.62, 0.64];
/// Ratio of solid to gas density below which the gas behaves like a liquid, whose added mass and lubrication are not
/// modelled.
const LEAST_DENSITY_RATIO: f64 = 10.0;
/// Excess of the fall velocity of a lone particle above which a warning is printed.
const LARGE_EXCESS: f64 = 0.1;

/// Describes regime and velocities of the gas of a stage; nothing without gas.
pub(super) fn describe_gas(
    lines: &mut Lines,
    case: &Case,
    stage: &Stage,
    particle: &ReferenceParticle,
    sizes: &SizeRange,
) {
    let [density, viscosity] = match &stage.physics.gas {
        GasModel::None => return,
        GasModel::Column(gas) => [gas.density, gas.viscosity],
        GasModel::VolumeAveraged(model) => [model.gas.density, model.gas.viscosity],
    };
    let ReferenceParticle { density: solid, gravity, .. } = *particle;
    let diameter = case.particle_diameter(particle.diameter);
    if gravity > 0.0 && viscosity > 0.0 {
        lines.add(
            "Stokes number",
            &format!("{:.4}", stokes_number(viscosity, solid, gravity, diameter)),
        );
    }
    if density > 0.0 {
        describe_densities(lines, [density, solid]);
    }
    if density > 0.0 && gravity > 0.0 && viscosity > 0.0 {
        let number = archimedes_number([density, solid], gravity, diameter, viscosity);
        lines.add("Archimedes number", &format!("{number:.4e}"));
    }
    describe_velocities(lines, case, stage);
    describe_mixture(lines, case, stage);
    describe_agglomerates(lines, stage, diameter);
    if let GasModel::VolumeAveraged(model) = &stage.physics.gas {
        describe_lone_fall(lines, case, model, (particle.gravity, sizes));
    }
    if let Some(velocity) = case.minimum_fluidisation(stage, SETTLED[0])
        && density > 0.0
        && viscosity > 0.0
    {
        let number = density * velocity * diameter / viscosity;
        lines.add(
            "Reynolds number at U_mf",
            &format!("{number:.4e} at a solids fraction of {}", SETTLED[0]),
        );
    }
}

/// Describes the excess of the fall velocity of the largest or the smallest particle alone, whichever is worse: its
/// drag is computed with the gas that it moves itself. Nothing is printed with drag from agglomerates, since the
/// recommended settings exclude it.
fn describe_lone_fall(
    lines: &mut Lines,
    case: &Case,
    model: &VolumeAveragedModel,
    (gravity, sizes): (f64, &SizeRange),
) {
    let CouplingModel { drag, filter_width, undisturbed, agglomerates, .. } = &model.coupling;
    let nothing_to_advise = *undisturbed || agglomerates.is_some();
    if nothing_to_advise || gravity <= 0.0 || drag.density <= 0.0 || drag.viscosity <= 0.0 {
        return;
    }
    let excess = |diameter: f64| {
        let weight = case.particles.mass_of(diameter) * gravity;
        let per_velocity = |velocity: f64| drag.per_velocity(diameter, 0.0, velocity);
        let velocity = minimum_fluidisation_velocity(per_velocity, weight, 0.0);
        let reynolds = drag.density * velocity * diameter / drag.viscosity;
        let resistance = drag.per_velocity(diameter, 0.0, velocity) / (drag.viscosity * diameter);
        let widths = [model.grid.cell_volume().cbrt(), *filter_width].map(|it| it / diameter);
        // With laws for packed beds nothing can fall alone.
        let falls = velocity.is_finite() && resistance.is_finite();
        falls.then(|| (excess_of_lone_fall(widths, reynolds, resistance), diameter))
    };
    let both = [sizes.largest_diameter, sizes.smallest_diameter].map(excess);
    let worse = both.into_iter().flatten().reduce(|a, b| if b.0 > a.0 { b } else { a });
    let Some((excess, diameter)) = worse else { return };
    let percent = format!("{:.0} %", 100.0 * excess);
    if excess > LARGE_EXCESS {
        lines.warn(&format!(
            "a lone particle of diameter {diameter:.4e} falls about {percent} too fast in these cells, together with the gas that it drags along: \
             gas.undisturbed_velocity corrects this (it makes no difference in a dense bed)"
        ));
    } else {
        lines.add(
            "fall of a lone particle",
            &format!("about {percent} too fast, together with the gas that it drags along"),
        );
    }
}

/// Describes the excess of the drag of all particles by their own diameters over that by their Sauter diameter.
fn describe_mixture(lines: &mut Lines, case: &Case, stage: &Stage) {
    let share = match &stage.physics.gas {
        GasModel::None => return,
        GasModel::Column(gas) => gas.drag_share,
        GasModel::VolumeAveraged(model) => model.coupling.drag.share,
    };
    let Some(excess) = case.particles.drag_excess() else { return };
    lines.add(
        "U_mf and terminal velocity",
        "of particles of the reference diameter and particles.density alone",
    );
    let text = match share {
        DragShare::Surface => format!(
            "by the local Sauter mean diameter; in a packed bed up to {:.1} % less than by each particle's own",
            100.0 * excess / (1.0 + excess)
        ),
        DragShare::Diameter => format!(
            "by each particle's own diameter; in a packed bed up to {:.1} % more than by the Sauter diameter (gas.drag_in_mixtures)",
            100.0 * excess
        ),
    };
    lines.add("drag of the mixture", &text);
}

/// Numbers of members, packing and surroundings of the agglomerates whose drag is printed.
const MEMBERS: [f64; 3] = [10.0, 30.0, 100.0];
const PACKING: f64 = 0.4;
const AROUND: [f64; 2] = [0.0, 0.2];

/// Describes the dependence of the drag on agglomerates, and xi for balls of some members.
fn describe_agglomerates(lines: &mut Lines, stage: &Stage, diameter: f64) {
    let GasModel::VolumeAveraged(model) = &stage.physics.gas else { return };
    let Some(AgglomerateDrag { every, smallest }) = model.coupling.agglomerates else { return };
    let interval = (every * model.substeps) as f64 * stage.physics.time_step;
    lines.add(
        "drag of agglomerates",
        &format!(
            "xi of each particle; agglomerates identified every {interval:.4e} ({every} gas steps): sets of {smallest} or more that \
             touch at two successive times"
        ),
    );
    for around in AROUND {
        let xi = |members: f64| {
            let size = diameter * libm::cbrt(members / PACKING);
            let ball = AgglomerateBall { diameter: size, packing: PACKING };
            model.coupling.drag.factor_in_agglomerate(diameter, &ball, around, 0.0)
        };
        let [few, some, many] = MEMBERS.map(xi);
        lines.add(
            &format!("xi in cells of phi {around}"),
            &format!("{few:.3}, {some:.3}, {many:.3} in balls of 10, 30, 100 at a packing of {PACKING}, in slow gas"),
        );
    }
}

fn describe_densities(lines: &mut Lines, [gas, solid]: [f64; 2]) {
    let ratio = solid / gas;
    lines.add("density of solid over gas", &format!("{ratio:.4e}"));
    if ratio < LEAST_DENSITY_RATIO {
        lines.warn(&format!(
            "the gas is nearly as dense as the solid: is its density right? In a liquid (ratio below {LEAST_DENSITY_RATIO}) \
             added mass and lubrication count, which are not modelled"
        ));
    }
}

fn describe_velocities(lines: &mut Lines, case: &Case, stage: &Stage) {
    let unit = ColumnUnits::of_system(case.units.name()).of(Unit::Speed);
    let at = |phi: f64| Some((phi, case.minimum_fluidisation(stage, phi)?));
    let minimum: Vec<(f64, f64)> = SETTLED.into_iter().filter_map(at).collect();
    if minimum.is_empty() {
        return;
    }
    let values: Vec<String> = minimum
        .iter()
        .map(|(phi, velocity)| format!("{velocity:.4e} {unit} at phi {phi:.2}"))
        .collect();
    lines.add("U_mf of the force balance", &values.join(", "));
    // Without neighbours the balance is that of a particle that falls alone.
    let terminal = case.minimum_fluidisation(stage, 0.0).unwrap_or(f64::INFINITY);
    // Laws for packed beds have no terminal velocity.
    if terminal.is_finite() {
        lines.add("terminal velocity of a particle", &format!("{terminal:.4e} {unit}"));
    }
    let Some(velocity) = upward_velocity(&stage.physics.gas).filter(|&velocity| velocity > 0.0)
    else {
        return;
    };
    let text = format!(
        "up to {velocity:.4e} {unit}: {:.3} U_mf at phi {:.2}, {:.3} terminal velocities",
        velocity / minimum[0].1,
        minimum[0].0,
        velocity / terminal
    );
    lines.add("superficial velocity", &text);
    if velocity > terminal {
        lines.warn(
            "the gas is faster than a single particle falls: only what sticks together stays. Are velocity, diameter and \
             viscosity in the same units?",
        );
    }
}

/// The largest mean superficial velocity of the gas from below; `None` if the case does not give it.
pub(super) fn upward_velocity(gas: &GasModel) -> Option<f64> {
    match gas {
        GasModel::VolumeAveraged(model) => {
            let [upwards, from_below] = [2, 0];
            let mut inlets = model.gas.inlets();
            let (face, inlet) =
                inlets.find(|(face, _)| face.axis == upwards && face.side == from_below)?;
            Some(model.largest_inflow(face, inlet).mean)
        }
        _ => highest_velocity(gas),
    }
}

/// The largest superficial velocity given by the case; `None` if there is no gas or it follows from the weight.
pub(super) fn highest_velocity(gas: &GasModel) -> Option<f64> {
    match gas {
        GasModel::None => None,
        GasModel::Column(gas) => match &gas.drive {
            Drive::Velocity(schedule) => Some(schedule.largest()),
            Drive::Plenum(plenum) => Some(plenum.supply.largest()),
            Drive::Weight(_) => None,
        },
        GasModel::VolumeAveraged(model) => {
            inflow(model).map(|[_, velocity]| velocity).reduce(f64::max)
        }
    }
}

/// Cell size along the axis of each inlet, and the largest superficial velocity there, where its profile is highest.
pub(super) fn inflow(model: &VolumeAveragedModel) -> impl Iterator<Item = [f64; 2]> {
    let spacing = model.grid.spacing();
    let inlets = model.gas.inlets();
    inlets.map(move |(face, inlet)| [spacing[face.axis], model.largest_inflow(face, inlet).peak])
}
