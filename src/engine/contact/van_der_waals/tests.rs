//! Energies and forces of the attraction, asperities, the square force, and attractions with the same work.

use super::energy::hamaker_energy;
use super::expression::hamaker_full;
use super::*;
use CohesionExpression as Expression;

fn attraction(expression: Expression) -> VanDerWaals {
    VanDerWaals {
        hamaker_constant: Schedule::Constant(1.0e-9),
        wall_hamaker_constant: Schedule::Constant(3.0e-9),
        cut_off: 1.0e-4,
        range: 0.1,
        expression,
    }
}

const ROUGH: Expression = Expression::Rough { asperity_radius: 3.0e-3 };

#[test]
fn every_force_is_the_slope_of_its_energy() {
    for expression in [Expression::NearContact, Expression::Full, ROUGH] {
        let now = attraction(expression).at(0.0);
        for s in [-2.0e-5, 0.5e-4, 2.0e-4, 3.0e-3, 0.05] {
            // Central differences: relative error of order (h / s)^2 times a few; none where the force is constant.
            let h = 1.0e-4 * s;
            let slope = |energy: &dyn Fn(f64) -> f64| (energy(s + h) - energy(s - h)) / (2.0 * h);
            let particles = slope(&|s| now.energy_of_particles(0.5, 0.3, s));
            let wall = slope(&|s| now.energy_at_wall(0.5, s));
            for (force, slope) in
                [(now.between_particles(0.5, 0.3, s), particles), (now.to_wall(0.5, s), wall)]
            {
                assert!(
                    (slope / force - 1.0).abs() < 1.0e-6,
                    "{expression:?} {s}: {slope} {force}"
                );
                // Negative control: the force at another separation, unless it is constant there.
                let other = now.between_particles(0.5, 0.3, 1.01 * s);
                assert!(s < 1.0e-4 || (other / particles - 1.0).abs() > 1.0e-3);
            }
        }
        assert_eq!(now.energy_of_particles(0.5, 0.3, 0.1001), 0.0);
    }
}

#[test]
fn asperities_weaken_the_force_and_very_small_or_large_ones_do_not() {
    let factor = |asperity_radius: f64| {
        let rough = attraction(Expression::Rough { asperity_radius }).at(0.0);
        let smooth = attraction(Expression::NearContact).at(0.0);
        let of_walls = rough.to_wall(0.5, 0.0) / smooth.to_wall(0.5, 0.0);
        let of_particles =
            rough.between_particles(0.5, 0.5, 0.0) / smooth.between_particles(0.5, 0.5, 0.0);
        // For two particles of this radius r is that of one particle at a wall.
        assert!((of_walls / of_particles - 1.0).abs() < 1.0e-14);
        of_particles
    };
    // a / (a + r) + (s / (s + a))^2 with r = 0.5 and s = 1e-4, by hand.
    assert!((factor(1.0e-2) - (0.01 / 0.51 + (1.0_f64 / 101.0).powi(2))).abs() < 1.0e-14);
    assert!((factor(1.0e-9) - 1.0).abs() < 1.0e-4 && (factor(1.0e5) - 1.0).abs() < 1.0e-4);
    // Negative control: asperities of the size of the cut-off have the largest effect.
    assert!(factor(2.0e-3) < 0.02);
}

#[test]
fn a_square_force_is_constant_up_to_its_range() {
    let of = |force: f64| Schedule::Constant(force);
    let square = VanDerWaals::square(&of(2.0), &of(3.0), 0.5, 0.01).at(0.0);
    for s in [-0.1, 0.0, 0.0099] {
        assert!((square.between_particles(0.5, 0.5, s) - 2.0).abs() < 1.0e-14, "{s}");
        assert!((square.to_wall(0.5, s) - 3.0).abs() < 1.0e-14);
    }
    assert_eq!(square.between_particles(0.5, 0.5, 0.0101), 0.0);
    assert!((square.energy_of_particles(0.5, 0.5, 0.0) + 0.02).abs() < 1.0e-16);
    // Negative control: the other expressions decrease.
    let near = attraction(Expression::NearContact).at(0.0);
    assert!(near.between_particles(0.5, 0.5, 5.0e-3) < 0.1 * near.between_particles(0.5, 0.5, 0.0));
}

#[test]
fn work_is_kept_while_the_force_is_scaled() {
    let of = |force: f64| Schedule::Constant(force);
    let square = VanDerWaals::square(&of(2.0), &of(3.0), 0.5, 0.01);
    let others = [Expression::NearContact, Expression::Full, ROUGH].map(attraction);
    for real in others.into_iter().chain([square]) {
        let soft = real.keeping_work(0.1, 0.5).unwrap();
        let [before, after] = [&real, &soft].map(VanDerWaals::strongest);
        let work = |of: VanDerWaalsNow| of.energy_of_particles(0.5, 0.5, 0.0);
        let ratio = |one: f64, other: f64| one / other - 1.0;
        // The error is that of bisection to rounding, and of rounding in differences of energies at small separations.
        assert!(ratio(work(after), work(before)).abs() < 1.0e-10, "{soft:?}");
        let largest = |of: VanDerWaalsNow| of.between_particles(0.5, 0.5, 0.0);
        assert!(ratio(largest(after), 0.1 * largest(before)).abs() < 1.0e-12);
        assert!(ratio(after.to_wall(0.5, 0.0), 0.1 * before.to_wall(0.5, 0.0)).abs() < 1.0e-12);
        // Negative control: the smaller force with the unchanged cut-off has another work.
        let unscaled = VanDerWaals { cut_off: real.cut_off, range: real.range, ..soft.clone() };
        assert!(ratio(work(unscaled.strongest()), work(before)).abs() > 0.1);
    }
    // A force reduced to a thousandth would need a larger range.
    assert_eq!(attraction(Expression::NearContact).keeping_work(1.0e-4, 0.5), None);
}

#[test]
fn full_force_is_the_slope_of_hamakers_energy() {
    for (r1, r2, s) in [(0.5, 0.5, 0.1), (0.3, 1.2, 0.05), (1.0, 0.2, 2.0)] {
        let h = 1.0e-4 * s;
        let slope = (hamaker_energy(r1, r2, s + h) - hamaker_energy(r1, r2, s - h)) / (2.0 * h);
        // Central differences: relative error of order (h/s)^2 times a few.
        assert!((hamaker_full(r1, r2, s) / slope - 1.0).abs() < 1.0e-6);
        // Negative control: another radius gives another force.
        assert!((hamaker_full(1.1 * r1, r2, s) / slope - 1.0).abs() > 1.0e-3);
    }
}

#[test]
fn full_force_tends_to_the_near_contact_limit() {
    let (r1, r2) = (0.3, 1.2);
    let s = 1.0e-6;
    let near = 2.0 * r1 * r2 / (r1 + r2) / (12.0 * s * s);
    // The next term of the expansion in s/r is of order s/r = 1e-5.
    assert!((hamaker_full(r1, r2, s) / near - 1.0).abs() < 1.0e-5);
}
