//! Checks of setups.

use super::{Setup, SetupError};
use std::collections::HashSet;
use talcum_engine::parallel::ParticleRecord;
use talcum_engine::state::SizeRange;

const POSITIVE: &str = "a number above 0";

impl Setup {
    /// Rejects numbers that are not valid.
    pub(super) fn check(&self) -> Result<(), SetupError> {
        let step = ("the time step", Some(self.physics.time_step));
        for (quantity, value) in
            [step, ("the skin", self.skin), ("the force limit", self.force_limit)]
        {
            if let Some(value) = value.filter(|&value| !is_positive(value)) {
                return Err(SetupError::NotPositive { quantity, value });
            }
        }
        self.check_field_names()?;
        let mut ids = HashSet::new();
        for particle in &self.particles {
            check_particle(particle)?;
            if !ids.insert(particle.id) {
                return Err(SetupError::SameId { id: particle.id });
            }
        }
        Ok(())
    }

    /// Each field of the particles has a name of its own, by which files and laws find it.
    fn check_field_names(&self) -> Result<(), SetupError> {
        let built_in = ParticleRecord::FIELDS.iter().map(|field| field.name);
        let mut names: HashSet<&str> = built_in.chain(["id"]).collect();
        match self.custom.fields.iter().find(|field| !names.insert(field.name)) {
            Some(field) => Err(SetupError::SameField { name: field.name }),
            None => Ok(()),
        }
    }

    /// A periodic box must be wide enough that a particle meets only one image of another.
    pub(super) fn check_width(&self, ghost_width: f64) -> Result<(), SetupError> {
        let bounds = &self.domain.bounds;
        let least = 2.0 * ghost_width;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let length = bounds.lengths()[axis];
            if bounds.is_periodic(axis) && length < least {
                return Err(SetupError::NarrowBox { axis: name, length, least });
            }
        }
        Ok(())
    }

    /// The given sizes, or those of the particles.
    pub(super) fn size_range(&self) -> Result<SizeRange, SetupError> {
        let of_particles = || SizeRange::of(self.particles.iter().map(|it| (it.radius, it.mass)));
        self.sizes.or_else(of_particles).ok_or(SetupError::NoSizes)
    }
}

fn is_positive(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn check_particle(particle: &ParticleRecord) -> Result<(), SetupError> {
    let id = particle.id;
    for (quantity, value) in [("radius", particle.radius), ("mass", particle.mass)] {
        if !is_positive(value) {
            let value = value.to_string();
            return Err(SetupError::Particle { id, quantity, value, allowed: POSITIVE });
        }
    }
    let vectors = [
        ("position", particle.position),
        ("velocity", particle.velocity),
        ("angular velocity", particle.angular_velocity),
    ];
    for (quantity, vector) in vectors {
        if !vector.iter().all(|component| component.is_finite()) {
            let (value, allowed) = (format!("{vector:?}"), "finite numbers");
            return Err(SetupError::Particle { id, quantity, value, allowed });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Layers, LayoutError, Sphere};
    use talcum_engine::contact::{
        ContactExchange, FrictionCap, LinearSpringDashpot, TouchingParticles,
    };
    use talcum_engine::domain::{Face, RankGrid};
    use talcum_engine::fields::{Field, Kind, Unit};
    use talcum_engine::parallel::OneRank;
    use talcum_engine::particles::Body;
    use talcum_engine::state::Physics;

    const PERIODIC: [Face; 2] = [Face::Periodic; 2];
    const WALLS: [Face; 2] = [Face::Wall; 2];

    fn physics(time_step: f64) -> Physics {
        let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.9, 0.1, FrictionCap::Contact).unwrap();
        Physics::new(law, time_step)
    }

    fn setup() -> Setup {
        Setup::new([4.0; 3], [PERIODIC, PERIODIC, WALLS], physics(4.0e-4)).unwrap()
    }

    fn sphere(radius: f64) -> Sphere {
        Sphere { position: [1.0; 3], velocity: [0.0; 3], radius, density: 1.0 }
    }

    fn refused(setup: &Setup) -> SetupError {
        setup.start_alone().map(|_| ()).unwrap_err()
    }

    #[test]
    fn boxes_without_meaning_are_refused() {
        for (lengths, faces, message) in [
            ([1.0, 0.0, 1.0], [WALLS; 3], "box: the length along y is 0: must be"),
            ([f64::NAN, 1.0, 1.0], [WALLS; 3], "box: the length along x is NaN: must be"),
            ([1.0; 3], [WALLS, WALLS, [Face::Periodic, Face::Wall]], "faces along z must both"),
        ] {
            let error = Setup::new(lengths, faces, physics(4.0e-4)).unwrap_err().to_string();
            assert!(error.contains(message), "{error}");
        }
    }

    #[test]
    fn setups_without_meaning_are_refused() {
        assert_eq!(refused(&setup()), SetupError::NoSizes);
        let good = setup().particle(sphere(0.5));
        assert!(good.start_alone().is_ok());
        let twice = good.clone().particles([sphere(0.5).record(0)]);
        assert_eq!(refused(&twice), SetupError::SameId { id: 0 });
        for (setup, message) in [
            (good.clone().skin(0.0), "the skin is 0: must be a number above 0"),
            (good.clone().skin(1.1), "the length along x is 4: must be at least 4.2"),
            (good.clone().particle(sphere(-0.5)), "particle 1: radius is -0.5: must be"),
            (good.clone().gravity(f64::INFINITY), "the largest force is inf: must be"),
        ] {
            let error = refused(&setup).to_string();
            assert!(error.contains(message), "{error}");
        }
        let no_step = Setup::in_domain(good.domain.clone(), physics(0.0)).particle(sphere(0.5));
        assert!(refused(&no_step).to_string().contains("the time step is 0"));
        let error = good.start(RankGrid([1, 2, 1]), &OneRank).map(|_| ()).unwrap_err();
        let wrong = LayoutError::WrongSize { grid: RankGrid([1, 2, 1]), ranks: 1 };
        assert_eq!(error, SetupError::Layout(wrong));
    }

    /// A law by which touching particles exchange nothing; each particle gains one per time.
    #[derive(Debug)]
    struct Source(&'static str);

    impl ContactExchange for Source {
        fn field(&self) -> Field {
            Field::new(self.0, Kind::Number, Unit::One, "amount")
        }
        fn flow(&self, _: &TouchingParticles, _: [f64; 2]) -> f64 {
            0.0
        }
        fn largest_flow(&self) -> f64 {
            1.0
        }
        fn rate(&self, _: &Body, inflow: f64) -> f64 {
            1.0 + inflow
        }
    }

    #[test]
    fn two_fields_of_one_name_are_refused() {
        let bed = || setup().particle(sphere(0.5));
        for name in ["species", "id"] {
            let setup = bed().exchange(Source(name), |_| 0.0);
            assert_eq!(refused(&setup), SetupError::SameField { name });
        }
        let twice = bed().exchange(Source("amount"), |_| 0.0).exchange(Source("amount"), |_| 0.0);
        assert_eq!(refused(&twice), SetupError::SameField { name: "amount" });
        assert!(bed().exchange(Source("amount"), |_| 0.0).start_alone().is_ok());
    }

    #[test]
    fn a_law_of_exchange_without_its_field_ends_the_run() {
        let mut setup = setup().particle(sphere(0.5));
        setup.physics.exchanges.add(Source("amount"));
        let error = setup.start_alone().unwrap().steps(1).unwrap_err();
        assert!(error.to_string().contains("exchange \"amount\", which is not"), "{error}");
    }

    #[test]
    fn fields_change_without_contacts() {
        let mut run = setup()
            .particle(sphere(0.5))
            .exchange(Source("amount"), |_| 2.0)
            .start_alone()
            .unwrap();
        run.steps(10).unwrap();
        let [amount] = run.state.particles.custom_fields().column(0)[..] else { panic!() };
        assert!((amount - (2.0 + 10.0 * 4.0e-4)).abs() < 1.0e-14, "ten sums round: {amount}");
    }

    #[test]
    fn layers_fill_the_box_from_below_and_do_not_overlap() {
        let layers = Layers { count: 20, spacing: 1.3, jitter: 0.1, seed: 3, ..Layers::default() };
        let bounds = &setup().domain.bounds;
        let spheres: Vec<Sphere> = layers.spheres(bounds).collect();
        assert_eq!(spheres.len(), 20);
        for (index, one) in spheres.iter().enumerate() {
            let layer = index / 9;
            let height = one.position[2] - 0.55 - 1.3 * layer as f64;
            assert!(height.abs() <= 0.1 + 1.0e-12, "rounding of a sum: {height}");
            for other in &spheres[..index] {
                let square: f64 = (0..3)
                    .map(|axis| {
                        let apart = one.position[axis] - other.position[axis];
                        let length = bounds.lengths()[axis];
                        let wraps = if axis < 2 { (apart / length).round() } else { 0.0 };
                        (apart - length * wraps).powi(2)
                    })
                    .sum();
                assert!(square >= 1.0, "{one:?} and {other:?} overlap");
            }
        }
    }
}
