//! The same bits on any ranks and through restarts, for every contact law, rolling and twisting friction, rough
//! cohesive particles, moving walls and a round column, on dense beds.

use crate::beds::{Bench, OPEN, PERIODIC, PLATE, Snapshot, attraction};
use nalgebra::Vector3;
use talcum::balance::Balance;
use talcum::contact::{
    CohesionExpression, ContactLaw, ContactModel, ContactModuli, ExampleScales, HertzMindlin,
    RollingFriction, RollingKind, TwistingFriction,
};
use talcum::domain::{EffectiveGravity, RankGrid, Wall, WallMotion};
use talcum::parallel::run_on_threads;

const GRIDS: [[usize; 3]; 4] = [[1, 1, 2], [1, 1, 3], [2, 2, 1], [3, 1, 2]];
const STEPS: u64 = 3000;

/// Every law of the registry.
fn laws() -> Vec<ContactLaw> {
    ContactLaw::examples(ExampleScales { stiffness: 2.0e4, overlap: 4.0e-3, restitution: 0.8 })
}

/// The first example of a law.
fn law_named(name: &str) -> ContactLaw {
    laws().into_iter().find(|law| law.name() == name).unwrap()
}

fn rolling(kind: RollingKind) -> Option<RollingFriction> {
    Some(RollingFriction::new(kind, 0.2).unwrap())
}

/// A bed that falls onto a moving plate between a shaken wall and a wall at rest; the walls have no adhesion.
fn bed_between_walls(law: ContactLaw, kind: RollingKind) -> Bench {
    let wall = [PLATE[0]; 2];
    let mut bench = Bench::new([5.0, 5.0, 14.0], [wall, PERIODIC, PLATE]);
    bench.interface = Some(ContactModel { rolling: rolling(kind), ..law.into() });
    let hertz = HertzMindlin::new(ContactModuli { normal: 1.0e5, shear: 3.0e4 }, 0.7, 0.5).unwrap();
    let smooth = ContactModel::from(hertz);
    bench.at_walls = vec![smooth.clone(), smooth];
    let amplitude = Vector3::new(0.0, 0.3, 0.0);
    bench.domain.walls[0].motion = WallMotion { amplitude, frequency: 1.5, ..WallMotion::REST };
    let velocity = Vector3::new(0.5, 0.3, 0.0);
    bench.domain.walls[2].motion = WallMotion { velocity, start: 0.1, ..WallMotion::REST };
    let mut piston = Wall::plane("piston", Vector3::new(0.0, 0.0, 0.0), Vector3::z());
    piston.motion =
        WallMotion { amplitude: Vector3::z() * 0.05, frequency: 2.0, ..WallMotion::REST };
    bench.domain.walls.push(piston);
    bench.gravity = EffectiveGravity { magnitude: 5.0, vibration: None };
    bench.time_step = 4.0e-4;
    bench.skin = Some(0.04);
    bench.balance = Some(Balance::new(200, 1.05));
    bench.add_layers(128, (1.22, 0.8), &[1.0, 0.9, 1.1], (0.05, 2.0));
    bench
}

/// The same in a round column that sways.
fn bed_in_column(law: ContactLaw) -> Bench {
    let mut bench = Bench::new([7.0, 7.0, 14.0], [OPEN, OPEN, PLATE]);
    let kind = RollingKind::ElasticPlastic { damping: 0.3 };
    bench.interface = Some(ContactModel { rolling: rolling(kind), ..law.into() });
    let mut column = Wall::cylinder("column", Vector3::new(3.5, 3.5, 0.0), 3.3);
    let amplitude = Vector3::new(0.1, 0.05, 0.2);
    column.motion = WallMotion { amplitude, frequency: 1.0, ..WallMotion::REST };
    bench.domain.walls.push(column);
    bench.gravity = EffectiveGravity { magnitude: 5.0, vibration: None };
    bench.time_step = 4.0e-4;
    bench.skin = Some(0.04);
    bench.add_layers(396, (1.15, 0.8), &[1.0, 0.9], (0.05, 2.0));
    bench.particles.retain(|particle| {
        let [x, y, _] = particle.position;
        (x - 3.5).hypot(y - 3.5) < 2.7
    });
    bench
}

/// A bed whose contacts resist twisting too, those with walls as well, and whose rough particles attract each other.
fn twisting(mut bench: Bench) -> Bench {
    let twisting = Some(TwistingFriction::new(0.3, 0.1, 0.2).unwrap());
    bench.interface.iter_mut().chain(&mut bench.at_walls).for_each(|it| it.twisting = twisting);
    let mut cohesion = attraction((20.0, 5.0), 1.0, (1.0e-4, 0.02));
    cohesion.expression = CohesionExpression::Rough { asperity_radius: 1.0e-3 };
    bench.cohesion = Some(cohesion);
    bench
}

fn beds() -> Vec<Bench> {
    let springs = RollingKind::ElasticPlastic { damping: 0.3 };
    let mut beds: Vec<Bench> =
        laws().into_iter().map(|law| bed_between_walls(law, springs)).collect();
    beds.push(bed_between_walls(law_named("jkr"), RollingKind::ConstantTorque));
    beds.push(bed_in_column(law_named("adhesive_elastic_plastic")));
    beds.push(bed_in_column(law_named("jkr")));
    beds.push(twisting(bed_between_walls(law_named("hertz_mindlin"), springs)));
    beds
}

#[test]
fn the_same_bits_on_any_ranks() {
    for bench in beds() {
        let reference = bench.on_ranks([1, 1, 1], |run| run.steps(STEPS).snapshot());
        let touching = reference.pairs.len();
        println!("{touching} contacts, {} at walls, {:?}", reference.walls.len(), bench.interface);
        // Shaken, a bed of 128 jumps; it has met in all its parts many times over.
        assert!(touching > 40 && !reference.walls.is_empty(), "the bed is dense: {touching}");
        for grid in GRIDS {
            let found = bench.on_ranks(grid, |run| run.steps(STEPS).snapshot());
            assert!(found.bits() == reference.bits(), "{grid:?}, {:?}", bench.interface);
        }
    }
}

/// A run that is continued on other ranks.
fn continued(bench: &Bench, from: &Snapshot, grid: [usize; 3]) -> Snapshot {
    let grid = RankGrid(grid);
    run_on_threads(grid.size(), |ranks| bench.resume(from, grid, ranks).steps(200).snapshot())
        .swap_remove(0)
}

#[test]
fn what_contacts_remember_lives_through_restarts() {
    for bench in beds() {
        let halfway = bench.on_ranks([1, 1, 3], |run| run.steps(STEPS - 200).snapshot());
        let reference = bench.alone().steps(STEPS).snapshot();
        for grid in [[1, 1, 1], [2, 1, 2]] {
            let found = continued(&bench, &halfway, grid);
            assert!(found.bits() == reference.bits(), "{grid:?}, {:?}", bench.interface);
        }
        // Negative controls: whatever is forgotten is seen.
        let mut without = halfway.clone();
        without.pairs.iter_mut().for_each(|pair| pair.state.tangential_spring = [0.0; 3]);
        assert!(continued(&bench, &without, [1, 1, 1]).bits() != reference.bits());
        if halfway.pairs.iter().any(|pair| pair.state.largest_overlap != 0.0) {
            let mut without = halfway.clone();
            without.pairs.iter_mut().for_each(|pair| pair.state.largest_overlap = 0.0);
            assert!(continued(&bench, &without, [1, 1, 1]).bits() != reference.bits());
        }
        if halfway.pairs.iter().any(|pair| pair.state.rolling_angle != [0.0; 3]) {
            let mut without = halfway.clone();
            without.pairs.iter_mut().for_each(|pair| pair.state.rolling_angle = [0.0; 3]);
            assert!(continued(&bench, &without, [1, 1, 1]).bits() != reference.bits());
        }
        let twists = bench.interface.as_ref().is_some_and(|model| model.twisting.is_some());
        assert_eq!(halfway.pairs.iter().any(|pair| pair.state.twisting_angle != 0.0), twists);
        assert_eq!(halfway.walls.iter().any(|contact| contact.state.twisting_angle != 0.0), twists);
        if twists {
            let mut without = halfway.clone();
            without.pairs.iter_mut().for_each(|pair| pair.state.twisting_angle = 0.0);
            assert!(continued(&bench, &without, [1, 1, 1]).bits() != reference.bits());
        }
    }
}

/// Necks of JKR join spheres that are apart: they are among the contacts that travel.
#[test]
fn necks_beyond_contact_are_remembered() {
    let bench = bed_between_walls(law_named("jkr"), RollingKind::ConstantTorque);
    let state = bench.alone().steps(STEPS).snapshot();
    let place = |id: u64| state.particles.iter().find(|particle| particle.id == id).unwrap();
    let apart = state.pairs.iter().filter(|pair| {
        let (one, other) = (place(pair.lower), place(pair.higher));
        let displacement = crate::beds::branch(&bench.domain.bounds, one, other);
        displacement.norm() > one.radius + other.radius
    });
    let apart = apart.count();
    println!("{apart} of {} contacts are necks", state.pairs.len());
    assert!(apart > 3, "{apart}");
}
