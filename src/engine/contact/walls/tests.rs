//! Contacts with walls side by side have the same bits as contacts one by one.

use super::*;
use crate::contact::rolling::Rolling;
use crate::contact::{
    ByPair, ContactForceLaw, ContactLaw, ContactModel, ExampleScales, Exchanges, RollingFriction,
    RollingKind, TwistingFriction, VanDerWaals,
};
use crate::domain::{Axis, Mesh, Surface, Wall, WallPose, WallRotation, WallShape};
use crate::numbers::{Quantum, Schedule, random_of, uniform};
use crate::particles::{ContactState, InteractionRanges, LANES, ListRange};
use nalgebra::Vector2;
use std::sync::Arc;

const SCALES: ExampleScales = ExampleScales { stiffness: 1.0e4, overlap: 0.01, restitution: 0.8 };
const DT: f64 = 1.0e-3;
const RADIUS: f64 = 0.5;

/// A moving plate, a round column, a rectangle that has turned a little, a frustum that turns about its axis, and the
/// mesh of a rough floor that has turned a little.
fn walls() -> ([Wall; 5], [WallPose; 5]) {
    let plate = Wall::plane("plate", Vector3::zeros(), Vector3::z());
    let cylinder = Wall::cylinder("cylinder", Vector3::zeros(), 6.0);
    let displacement = Vector3::new(0.0, 0.0, 0.002);
    let limited = |name, surface| Wall::of_shape(name, WallShape::Limited(surface));
    let half_edges = [Vector3::new(7.0, 0.0, 0.0), Vector3::new(0.0, 5.0, 0.0)];
    let rectangle = Surface::Rectangle { centre: Vector3::zeros(), half_edges };
    let turning = |direction: Vector3<f64>, speed: f64| WallRotation {
        axis: Axis { point: Vector3::new(0.0, 0.0, 0.01), direction },
        speed,
        ramp: 0.0,
        amplitude: 0.0,
        frequency: 0.0,
        start: 0.0,
        end: f64::INFINITY,
    };
    let rectangle =
        Wall { rotation: Some(turning(Vector3::x(), 0.002)), ..limited("rectangle", rectangle) };
    let axis = Axis { point: Vector3::zeros(), direction: Vector3::z() };
    let ends = [Vector2::new(-1.0, 6.01), Vector2::new(2.0, 5.99)];
    let frustum = limited("frustum", Surface::Revolved { axis, ends });
    let frustum = Wall { rotation: Some(turning(Vector3::z(), 0.7)), ..frustum };
    let floor = limited("floor", Surface::Mesh(Arc::new(floor())));
    let floor = Wall { rotation: Some(turning(Vector3::y(), 0.002)), ..floor };
    let turned = [&rectangle, &frustum, &floor].map(|wall| wall.pose(1.0, DT));
    assert!(turned[0].turn.unwrap().matrix.is_some() && turned[1].turn.unwrap().matrix.is_none());
    let moving = WallPose { displacement, velocity: displacement, turn: None };
    let poses = [moving, WallPose::REST, turned[0], turned[1], turned[2]];
    ([plate, cylinder, rectangle, frustum, floor], poses)
}

/// A floor of triangles that rise and fall, some of them smoothly.
fn floor() -> Mesh {
    const SIDE: u32 = 30;
    let place = |k: u32| {
        let [x, y] = [k % SIDE, k / SIDE].map(|k| 0.5 * f64::from(k) - 7.0);
        Vector3::new(x, y, 0.02 * (3.0 * x).sin() * (2.0 * y).cos())
    };
    let square = |k: u32| [[k, k + 1, k + SIDE], [k + 1, k + SIDE + 1, k + SIDE]];
    let squares = (0..SIDE * (SIDE - 1)).filter(|k| k % SIDE + 1 < SIDE);
    let facets: Vec<_> = squares.flat_map(square).collect();
    Mesh::new((0..SIDE * SIDE).map(place).collect(), &facets, 0.04).unwrap()
}

/// Particles of two sizes and species in a layer: most of them at a wall, some at both walls.
fn particles(count: usize) -> Particles {
    let mut random = random_of(1, 0, "walls");
    let mut number = |from: f64, to: f64| from + (to - from) * uniform(&mut random);
    let mut particles = Particles::default();
    for id in 0..count as u64 {
        let radius = RADIUS * if id % 3 == 0 { 1.0 } else { 0.8 };
        let (out, angle) = (6.0 - radius - number(-0.02, 0.01), number(0.0, 6.0));
        let z = radius - number(-0.02, 0.01);
        let position = Vector3::new(out * angle.cos(), out * angle.sin(), z);
        let velocity = Vector3::from_fn(|_, _| number(-0.3, 0.3));
        particles.push(id, position, velocity, radius, radius.powi(3));
        let body = &mut particles.body[id as usize];
        body.angular_velocity = Vector3::from_fn(|_, _| number(-0.3, 0.3));
        *body = body.of_species(id as usize % 2);
    }
    particles
}

/// Numbers of contacts that stick, and that slide.
#[derive(Default)]
struct Friction {
    sticks: usize,
    slides: usize,
}

/// Force and torque on each particle, and the states of its contacts, one contact at a time.
fn one_by_one(
    particles: &Particles,
    contacts: &mut Contacts,
    walls: PosedWalls<'_>,
    laws: &ForceLaws,
    friction: &mut Friction,
) -> Vec<[Vector3<f64>; 2]> {
    let mut loads = vec![[Vector3::zeros(); 2]; particles.owned_count()];
    for slot in contacts.wall_slots().collect::<Vec<_>>() {
        let pair = contacts.wall_pairs[slot];
        let i = pair.particle as usize;
        let at_wall = laws.at_wall(pair.wall as usize, particles.body[i].species());
        let contact = contact_with(walls, &pair, particles, at_wall.cohesion);
        let ContactModel { law, rolling, twisting, .. } = at_wall.contact;
        let state = &mut contacts.wall_state[slot];
        let mut history = state.history();
        let touches = law.touches(&contact, &history);
        contacts.wall_touching[slot] = touches;
        let (mut force, mut torque) = (contact.normal * -contact.cohesion, Vector3::zeros());
        if touches {
            match law.sticking_force(&contact, &mut { history }, DT) {
                (_, true) => friction.slides += 1,
                (_, false) => friction.sticks += 1,
            }
            let of_law = law.force(&contact, &mut history, DT);
            state.tangential_spring = history.tangential_spring.into();
            state.largest_overlap = history.largest_overlap;
            force = contact.normal * (of_law.normal - contact.cohesion) + of_law.tangential;
            torque = contact.normal.cross(&of_law.tangential) * contact.reduced_radius;
            let (limit, stiffness) = (of_law.friction_normal, law.stiffness_over(&contact, DT));
            let mut of_spin = Vector3::zeros();
            if let Some(rolling) = rolling {
                let mut angle = state.rolling_angle.into();
                of_spin += rolling.torque(&contact, limit, stiffness, &mut angle, DT);
                state.rolling_angle = angle.into();
            }
            let angle = &mut state.twisting_angle;
            if let Some(twisting) = twisting {
                let along = twisting.torque(&contact, limit, stiffness, angle, DT);
                of_spin += contact.normal * along;
            }
            torque += of_spin;
        } else {
            *state = ContactState::default();
        }
        loads[i][0] -= laws.force_quantum.round_vector(force);
        loads[i][1] -= laws.torque_quantum.round_vector(torque);
    }
    loads
}

/// Compares both ways over some steps in which walls and particles move, so that contacts begin and end.
fn assert_equal_bits(count: usize, model: &ContactModel, cohesion: Option<VanDerWaalsNow>) {
    let mut particles = particles(count);
    let (walls, mut poses) = walls();
    let other = ContactModel { rolling: None, ..model.clone() };
    let of_kind = |one, other_species| match one + other_species {
        0 => model.clone(),
        _ => other.clone(),
    };
    let contact = ByPair::of_species(2, of_kind);
    let cohesion = cohesion.map(ByPair::of_all);
    let range = cohesion.as_ref().map_or(0.0, |cohesion| cohesion.first().range());
    let laws = ForceLaws {
        contact: &contact,
        at_walls: &[],
        exchanges: &Exchanges::default(),
        cohesion,
        ranges: InteractionRanges { contact: 0.0, any: range, diameter: 2.0 * RADIUS },
        dt: DT,
        limit: 1.0e6,
        force_quantum: Quantum::spanning(1.0e6),
        torque_quantum: Quantum::spanning(1.0e6),
    };
    let mut contacts = Contacts::default();
    let list = ListRange { interaction: range, skin: 0.05 };
    contacts.find_wall_pairs(&particles, PosedWalls { walls: &walls, poses: &poses }, list);
    let mut reference = contacts.clone();
    let mut tallies = WallTallies::default();
    tallies.reset(walls.len());
    let (mut begun, mut ended, mut friction) = (0, 0, Friction::default());
    for step in 0..30 {
        let walls = PosedWalls { walls: &walls, poses: &poses };
        let before = contacts.wall_touching.clone();
        particles.forces.iter_mut().for_each(|load| *load = Default::default());
        find_mesh_contacts(&particles, &mut contacts, walls, range);
        find_mesh_contacts(&particles, &mut reference, walls, range);
        add_wall_forces(&mut particles, &mut contacts, walls, &laws, &mut tallies).unwrap();
        let expected = one_by_one(&particles, &mut reference, walls, &laws, &mut friction);
        let found: Vec<[Vector3<f64>; 2]> =
            particles.forces.iter().map(|load| [load.force, load.torque]).collect();
        assert_eq!(found, expected, "step {step} of {model:?}");
        assert_eq!(contacts.wall_touching, reference.wall_touching);
        assert_eq!(contacts.wall_state, reference.wall_state);
        let on_walls: [i64; 3] =
            [0, 1, 2].map(|axis| (0..5).map(|wall| tallies.on_wall(wall)[axis]).sum());
        let sum = found.iter().fold(Vector3::zeros(), |sum, [force, _]| sum + force);
        assert_eq!(on_walls, [0, 1, 2].map(|axis| -laws.force_quantum.count(sum[axis])));
        for (before, now) in before.into_iter().zip(&contacts.wall_touching) {
            begun += usize::from(step > 0 && !before && *now);
            ended += usize::from(before && !now);
        }
        particles.body.iter_mut().for_each(|body| body.position += body.velocity * DT);
        poses.iter_mut().for_each(|pose| pose.displacement += Vector3::new(2.0e-4, 0.0, 3.0e-4));
    }
    let moved = contacts.wall_state.iter().any(|of| of.tangential_spring != [0.0; 3]);
    assert!(moved || count < 5, "a control: springs are deflected");
    assert!((begun > 0 && ended > 0) || count < 50, "a control: {begun} begin, {ended} end");
    let Friction { sticks, slides } = friction;
    // The other laws are evaluated as a whole.
    let tells = !["hertz_mindlin", "jkr"].contains(&model.law.name());
    assert!(
        (sticks > 0 && (slides > 0) == tells) || count < 50,
        "a control: {sticks} stick, {slides} slide with {model:?}"
    );
}

#[test]
fn contacts_in_lanes_have_the_bits_of_contacts_one_by_one() {
    let [force, at_wall] = [10.0, 20.0].map(Schedule::Constant);
    let attraction = VanDerWaals::square(&force, &at_wall, RADIUS, 0.01).at(0.0);
    let kind = RollingKind::ElasticPlastic { damping: 0.3 };
    let rolling = RollingFriction::new(kind, 0.1).unwrap();
    let twisting = TwistingFriction::new(0.1, 0.5, 0.3).unwrap();
    for law in ContactLaw::examples(SCALES) {
        for (rolling, twisting) in [
            (None, None),
            (Some(rolling), None),
            (None, Some(twisting)),
            (Some(rolling), Some(twisting)),
        ] {
            let model = ContactModel { rolling, twisting, ..ContactModel::from(law.clone()) };
            // Fewer particles than a block, exactly one block, and more.
            for count in [1, LANES, 2 * LANES + 7] {
                assert_equal_bits(count, &model, None);
            }
            assert_equal_bits(100, &model, Some(attraction));
        }
    }
}
