//! Gas in a round column, compared with closed forms.

use super::driver::{Flow, OUTLET, PERIODIC, Problem, inlet, no_slip};
use nalgebra::Vector3;
use talcum::analysis::LineFit;
use talcum::gas::volume_averaged::{Boundary, Profile};
use talcum::grid::RoundColumn;

/// Neither its axis nor its wall has a place of its own on the cells.
const CENTRE: [f64; 2] = [0.512, 0.493];
const RADIUS: f64 = 0.47;

fn column(counts: [usize; 3], height: f64, vertical: [Boundary; 2]) -> Problem {
    let mut problem = Problem::new([1.0, 1.0, height], counts, [no_slip(), no_slip(), vertical]);
    problem.column = Some((CENTRE, RADIUS));
    problem
}

fn geometry(flow_cells: usize) -> RoundColumn {
    let problem = column([flow_cells, flow_cells, 1], 1.0, PERIODIC);
    RoundColumn::new(&problem.grid(), CENTRE, RADIUS).unwrap()
}

fn squared_distance([x, y, _]: [f64; 3]) -> f64 {
    (x - CENTRE[0]).powi(2) + (y - CENTRE[1]).powi(2)
}

/// The flow that a driving force of 1 pushes through the column, at viscosity 1.
fn poiseuille(cells: usize) -> Flow<'static> {
    let mut flow = column([cells, cells, 1], 1.0, PERIODIC).start();
    let along = Vector3::new(0.0, 0.0, 1.0);
    flow.run_to_rest(0.18 / (cells * cells) as f64, along, 1.0e-13);
    flow
}

/// Root mean square over the open cells, by open area, of what the vertical velocity differs from that of Poiseuille in a
/// column of this radius, over its mean; and the error of the flow, over it.
fn errors(flow: &Flow, radius: f64) -> [f64; 2] {
    let column = geometry(flow.part.counts[0]);
    let (mut square, mut total, mut area) = (0.0, 0.0, 0.0);
    for cell in flow.cells() {
        let (open, u) = (column.open_fraction([cell[0], cell[1]]), flow.state.velocity[2].at(cell));
        assert!(open > 0.0 || u == 0.0);
        let exact = 0.25 * (radius * radius - squared_distance(flow.place(cell, Some(2))));
        square += open * (u - exact).powi(2);
        total += open * u;
        area += open;
    }
    let mean = radius * radius / 8.0;
    [(square / area).sqrt() / mean, (total / area / mean - 1.0).abs()]
}

/// Exponent of the power of the number of cells that fits errors best; single pairs depend on how the wall lies among the cells.
fn fitted_order(cells: &[usize], errors: &[f64]) -> f64 {
    let fineness: Vec<f64> = cells.iter().map(|&n| -(n as f64).ln()).collect();
    let logarithms: Vec<f64> = errors.iter().map(|error| error.ln()).collect();
    LineFit::of(&fineness, &logarithms).unwrap().slope.value
}

#[test]
fn poiseuille_converges() {
    let cells = [8, 12, 16, 24, 32, 48];
    let flows = cells.map(poiseuille);
    for quantity in 0..2 {
        let found = |beyond: f64| -> Vec<f64> {
            let radius = |flow: &Flow| RADIUS + beyond * flow.spacing[0];
            flows.iter().map(|flow| errors(flow, radius(flow))[quantity]).collect()
        };
        let order = fitted_order(&cells, &found(0.0));
        println!("errors {:?}, order {order:.2}", found(0.0));
        // Second order away from the wall; in the cells at the wall the velocity is that of their centres, not of what they have.
        assert!(order > 1.5, "{order}");
        assert!(found(0.0)[0] < 0.03 && found(0.0)[5] < 2.0e-3, "{:?}", found(0.0));
        // Control: if the wall stood a quarter of a cell farther out, as of a staircase.
        assert!(fitted_order(&cells, &found(0.25)) < 1.2);
    }
}

/// Zero of the derivative of the Bessel function J_0.
const FIRST_ZERO: f64 = 3.831_705_970_207_512;

/// Darcy's flow of a mean velocity 1 that comes in as 1 + J_0(k r) and evens out with height z:
/// p = beta [H - z + J_0(k r) exp(-k z) / k], where k R is a zero of J_0'. Root mean square errors of velocity and pressure.
fn spreading(cells: usize, zero: f64) -> [f64; 2] {
    const HEIGHT: f64 = 2.0;
    const DRAG: f64 = 1.0e6;
    let geometry = geometry(cells);
    let wave_number = zero / RADIUS;
    let bessel = |x: [f64; 3]| libm::j0(wave_number * squared_distance(x).sqrt());
    let mut profile = vec![0.0; cells * cells];
    for (place, factor) in profile.iter_mut().enumerate() {
        let centre = [place % cells, place / cells].map(|i| (i as f64 + 0.5) / cells as f64);
        *factor = 1.0 + bessel([centre[0], centre[1], 0.0]);
    }
    let vertical = [inlet(1.0, Profile::Table(profile)), OUTLET];
    let mut problem = column([cells, cells, 2 * cells], HEIGHT, vertical);
    problem.gas.viscosity = 0.0;
    let mut flow = problem.start();
    flow.complete();
    flow.bed.momentum_transfer = flow.field(None, |_| DRAG);
    for _ in 0..3 {
        flow.step(1.0e-2 / cells as f64).unwrap();
    }
    let (mut of_velocity, mut of_pressure, mut volume) = (0.0, 0.0, 0.0);
    for cell in flow.cells() {
        let open = geometry.open_fraction([cell[0], cell[1]]);
        let decay = |x: [f64; 3]| bessel(x) * (-wave_number * x[2]).exp();
        let velocity = 1.0 + decay(flow.place(cell, Some(2)));
        let centre = flow.place(cell, None);
        let pressure = DRAG * (HEIGHT - centre[2] + decay(centre) / wave_number);
        of_velocity += open * (flow.state.velocity[2].at(cell) - velocity).powi(2);
        of_pressure += open * (flow.state.pressure.at(cell) / pressure - 1.0).powi(2);
        volume += open;
    }
    [of_velocity, of_pressure].map(|sum| if volume > 0.0 { (sum / volume).sqrt() } else { sum })
}

#[test]
fn a_flow_that_evens_out_across_the_column_converges() {
    let cells = [8, 12, 16, 24, 32];
    let errors = cells.map(|cells| spreading(cells, FIRST_ZERO));
    let wrong = cells.map(|cells| spreading(cells, 0.95 * FIRST_ZERO));
    for quantity in 0..2 {
        let found = errors.map(|errors| errors[quantity]);
        let order = fitted_order(&cells, &found);
        println!("errors {found:?}, order {order:.2}");
        assert!(order > 1.5, "{order}");
        assert!(found[0] < 0.01, "{found:?}");
        // Control: a wave that would pass the wall.
        assert!(fitted_order(&cells, &wrong.map(|errors| errors[quantity])) < 0.5);
    }
}

/// Volume that enters at the bottom less what leaves at the top, over it, and the most iterations of the pressure equation.
fn mass_error(vertical: [Boundary; 2], tolerance: f64) -> (f64, usize) {
    let mut problem = column([12, 12, 20], 1.6, vertical);
    problem.gas.viscosity = 0.01;
    problem.gas.tolerance.relative = tolerance;
    let geometry = geometry(12);
    let mut flow = problem.start();
    let rough = |[x, y, z]: [f64; 3]| 0.6 + 0.2 * (37.0 * x + 11.0 * y).sin() * (9.0 * z).cos();
    flow.set(|_| [0.0; 3], |_| 0.0, rough);
    let mut iterations = 0;
    for _ in 0..20 {
        flow.bed.voidage = flow.field(None, rough);
        flow.bed.momentum_transfer = flow.field(None, |x| 300.0 * (1.0 - rough(x)));
        iterations = iterations.max(flow.step(2.0e-3).unwrap().convergence.iterations);
    }
    let through = |k: isize| -> f64 {
        let cells = flow.cells().into_iter().filter(|cell| cell[2] == 0);
        cells
            .map(|[i, j, _]| {
                let eps = |k: isize| flow.state.voidage.at([i, j, k]);
                let flux = 0.5 * (eps(k - 1) + eps(k)) * flow.state.velocity[2].at([i, j, k]);
                geometry.open_fraction([i, j]) * flux
            })
            .sum()
    };
    let expected = 0.3 * geometry.cross_section_in_cells();
    assert!((through(0) / expected - 1.0).abs() < 1.0e-13);
    (through(20) / through(0) - 1.0, iterations)
}

#[test]
fn what_enters_a_column_leaves_it() {
    let (error, iterations) = mass_error([inlet(0.3, Profile::Uniform), OUTLET], 1.0e-13);
    println!("mass error {error:.1e}, {iterations} iterations");
    assert!(error.abs() < 1.0e-12, "{error:e}");
    // In a box an iteration reduces the residual by a factor of some 10; so does one beside cells that the wall cuts.
    assert!(iterations < 20, "{iterations}");
    // Control: a tolerance that leaves a residual to be seen.
    let (error, _) = mass_error([inlet(0.3, Profile::Uniform), OUTLET], 1.0e-3);
    assert!(error.abs() > 1.0e-12, "{error:e}");
}
