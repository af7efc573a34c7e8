//! Cohesive spheres stick below a speed. The clipped van der Waals force has a plateau of width delta beyond contact
//! and a tail: F = F_max [delta / max(s, delta)]^2.

use super::damping_ratio;
use crate::beds::{Bench, OPEN, PERIODIC, attraction, law};
use std::f64::consts::PI;

const CUT_OFF: f64 = 1.0e-4;
/// Beyond, 1/20,000 of the work would be left.
const RANGE: f64 = 0.5;

/// Two spheres of diameter and density 1.
#[derive(Clone, Copy)]
struct Pair {
    stiffness: f64,
    restitution: f64,
    /// F_max.
    force: f64,
}

impl Pair {
    const REDUCED_MASS: f64 = PI / 12.0;

    /// Work to part from the cut-off on: F_max delta (plateau) + F_max delta (tail).
    fn work(self) -> f64 {
        2.0 * self.force * CUT_OFF
    }

    /// sqrt(2 W / m*) sqrt(1/e^2 - 1), where the spring is stiff: F_max^2 / (2 k) << W.
    fn stiff_limit(self) -> f64 {
        (2.0 * self.work() / Self::REDUCED_MASS).sqrt() * (self.restitution.powi(-2) - 1.0).sqrt()
    }

    /// A step that resolves the contact, and the plateau at `speed`.
    fn time_step(self, speed: f64) -> f64 {
        let contact = PI * (Self::REDUCED_MASS / self.stiffness).sqrt() / 400.0;
        let fastest = (speed.powi(2) + 2.0 * self.work() / Self::REDUCED_MASS).sqrt();
        contact.min(0.05 * CUT_OFF / fastest)
    }

    /// Whether a run of the program ends with the spheres together. They start so near that the tail
    /// beyond is known: at 20 delta the work left is W / 40.
    fn sticks(self, speed: f64) -> bool {
        let start = 20.0 * CUT_OFF;
        let fast = (speed.powi(2) + 2.0 * self.outer_work(start) / Self::REDUCED_MASS).sqrt();
        let mut bench = Bench::new([4.0; 3], [PERIODIC, PERIODIC, OPEN]);
        bench.contact = law(self.stiffness, self.restitution, 0.0);
        bench.cohesion = Some(attraction((self.force, 0.0), 1.0, (CUT_OFF, RANGE)));
        bench.time_step = self.time_step(speed);
        bench.add([2.0, 2.0, 1.0], [0.0, 0.0, 0.5 * fast], 0.5);
        bench.add([2.0, 2.0, 2.0 + start], [0.0, 0.0, -0.5 * fast], 0.5);
        let mut run = bench.alone();
        let mut approaches = true;
        loop {
            run.steps(1);
            let (lower, upper) = (run.particle(0), run.particle(1));
            let velocity = upper.velocity[2] - lower.velocity[2];
            let separation = upper.position[2] - lower.position[2] - 1.0;
            if approaches {
                approaches = velocity < 0.0;
            } else if velocity <= 0.0 {
                // Turned back: caught.
                return true;
            } else if separation > start {
                // Past the start with a speed that the rest of the tail cannot take, or can.
                let energy = 0.5 * Self::REDUCED_MASS * velocity * velocity;
                return energy < self.outer_work(start);
            }
        }
    }

    /// Work of the tail from a separation to the range.
    fn outer_work(self, separation: f64) -> f64 {
        self.force * CUT_OFF * CUT_OFF * (1.0 / separation - 1.0 / RANGE)
    }

    /// The same from the equation of motion of the separation s, written independently: the gap before contact by energy,
    /// the contact in fine steps of the midpoint rule, the parting by energy.
    fn sticks_by_reference(self, speed: f64) -> bool {
        let m = Self::REDUCED_MASS;
        let gap_work = self.force * CUT_OFF + self.outer_work(CUT_OFF);
        let damping = 2.0 * damping_ratio(self.restitution) * (self.stiffness * m).sqrt();
        let rate = |overlap: f64, velocity: f64| {
            (-self.stiffness * overlap - damping * velocity + self.force) / m
        };
        let dt = (m / self.stiffness).sqrt() / 20_000.0;
        let (mut overlap, mut velocity) = (0.0, (speed * speed + 2.0 * gap_work / m).sqrt());
        let mut sinks = true;
        loop {
            let half = velocity + 0.5 * dt * rate(overlap, velocity);
            velocity += dt * rate(overlap + 0.5 * dt * velocity, half);
            overlap += dt * half;
            if overlap <= 0.0 {
                return 0.5 * m * velocity * velocity < gap_work;
            }
            if !sinks && velocity > 0.0 {
                return true;
            }
            sinks = sinks && velocity > 0.0;
        }
    }

    /// The largest speed at which the spheres stick.
    fn threshold(self, sticks: impl Fn(f64) -> bool) -> f64 {
        let (mut low, mut high) = (0.0, 8.0 * self.stiff_limit());
        assert!(sticks(1.0e-3 * high) && !sticks(high), "the threshold lies between");
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            *(if sticks(middle) { &mut low } else { &mut high }) = middle;
        }
        0.5 * (low + high)
    }
}

#[test]
fn cohesive_spheres_stick_below_the_speed_that_they_should() {
    // The force over the plateau's spring force, F_max / (k delta): stiff to soft.
    for (softness, restitution) in [(0.02, 0.9), (0.5, 0.9), (0.5, 0.6), (2.0, 0.8)] {
        let stiffness = 2.0e5;
        let pair = Pair { stiffness, restitution, force: softness * stiffness * CUT_OFF };
        let found = pair.threshold(|speed| pair.sticks(speed));
        let expected = pair.threshold(|speed| pair.sticks_by_reference(speed));
        let limit = pair.stiff_limit();
        println!(
            "sticking speed, F/(k delta) {softness}, e {restitution}: {found:.6}, reference \
             {expected:.6}, stiff limit {limit:.6}"
        );
        // Bisection: 8/4096 of the limit. The dashpot's first order, b omega dt with 400 steps per contact,
        // enters through 1 - e^2: a few times 0.5 %.
        assert!((found / expected - 1.0).abs() < 0.015, "{found} for {expected}");
        if softness < 0.05 {
            // Spring energy over work is softness / 4; it enters e by the order of its square root.
            assert!((found / limit - 1.0).abs() < 0.05, "{found} for {limit}");
        } else {
            // Negative control: where the spring is loaded by the attraction the limit is wrong.
            assert!((expected / limit - 1.0).abs() > 0.05, "{expected} {limit}");
        }
        // Negative controls: half of the work (no tail), or another restitution.
        let other = Pair { restitution: 0.9 * restitution, ..pair };
        let wrong = other.threshold(|speed| other.sticks_by_reference(speed));
        assert!((found / wrong - 1.0).abs() > 0.03);
        assert!((found / (0.5_f64.sqrt() * expected) - 1.0).abs() > 0.03);
    }
}

#[test]
fn without_attraction_nothing_sticks() {
    let pair = Pair { stiffness: 2.0e5, restitution: 0.5, force: 1.0e-6 };
    assert!(!pair.sticks(0.1) && !pair.sticks_by_reference(0.1));
}
