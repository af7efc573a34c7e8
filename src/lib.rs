//! Talcum: CFD-DEM of fluidised beds of fine, cohesive powders, with the same bits on any number of MPI
//! ranks.
//!
//! # Quick start
//!
//! ```
//! use talcum::contact::{FrictionCap, LinearSpringDashpot};
//! use talcum::domain::Face::{Open, Periodic, Wall};
//! use talcum::setup::{Layers, Setup};
//! use talcum::state::Physics;
//!
//! // Stiffnesses, restitution, friction; the time step. Density, diameter and gravity are 1.
//! let law = LinearSpringDashpot::new(1.0e4, 8.2e3, 0.7, 0.3, FrictionCap::Contact)?;
//! let faces = [[Periodic; 2], [Periodic; 2], [Wall, Open]];
//! let mut run = Setup::new([6.0, 6.0, 30.0], faces, Physics::new(law, 4.0e-4))?
//!     .gravity(1.0)
//!     .layers(&Layers { count: 50, jitter: 0.05, ..Layers::default() })
//!     .start_alone()?;
//! run.steps(500)?;
//! let top = run.particles().map(|particle| particle.position[2]).fold(0.0, f64::max);
//! println!("time {}: top at {top}, digest {}", run.time(), run.digest()?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`setup`] describes this further, and the folder `examples` has complete programs. A case file is read by [`case`]
//! and run by [`simulation`]; this is what the program `talcum` does.
//!
//! # Equations
//!
//! Each particle i, a sphere of radius r, mass m, volume V and inertia I = (2/5) m r^2, moves according to
//!
//! ```math
//! \begin{aligned}
//! m \frac{d\mathbf{v}}{dt} &= \sum \mathbf{F}_\text{contact} + \mathbf{F}_\text{cohesion} + \mathbf{F}_\text{wall}
//!   + \mathbf{F}_\text{gas} - m\, g_\text{eff}(t)\, \mathbf{e}_z \\
//! I \frac{d\boldsymbol{\omega}}{dt} &= \sum r\, \mathbf{n} \times \mathbf{F}_t \\
//! g_\text{eff}(t) &= g \left[ 1 + \Gamma \sin 2 \pi f (t - t_0) \right] \quad \text{in the frame of a vibrated plate}
//! \end{aligned}
//! ```
//!
//! * Contact \[Moon2006 (1)-(3); Cundall1979\]: F_n = k_n delta - gamma_n v_n, and a tangential spring k_t
//!   with a slider at mu times the normal force ([`contact::LinearSpringDashpot`]).
//! * Alternatives are adhesive elastic-plastic \[Liu2016\] ([`contact::AdhesiveElasticPlastic`]), linear hysteretic
//!   \[Luding2008\] ([`contact::LinearHysteretic`]), Hertz-Mindlin ([`contact::HertzMindlin`]), and JKR \[Johnson1971\]
//!   ([`contact::Jkr`]) contacts. Each can be combined with resistance to rolling \[Ai2011\]
//!   ([`contact::RollingFriction`]) and to twisting \[Luding2008\] ([`contact::TwistingFriction`]).
//! * Cohesion \[Moon2006 (4); Hamaker1937\]: A r / (12 s^2) at a separation s of surfaces above a cut-off,
//!   constant below it and in contact ([`contact::VanDerWaals`]).
//! * Gas \[Moon2006 (6)-(12)\], one-dimensional and without inertia, from continuity of the mixture and
//!   Darcy's law; it acts vertically ([`gas::ColumnSolver`]):
//!
//! ```math
//! \begin{aligned}
//! (1 - \phi)\, u_g + \phi\, u_s &= U_s, \qquad -(1 - \phi) \frac{dp}{dz} = \beta (u_g - u_s) \\
//! F_\text{gas} &= \frac{V}{\phi}\, \beta \left[ (u_s - v) - \frac{u_s - U_s}{(1 - \phi)^2} \right]
//! \end{aligned}
//! ```
//!
//! * Volume-averaged gas, in three dimensions, with inertia: volume-averaged Navier-Stokes equations, model A, on a staggered grid
//!   ([`gas::volume_averaged`]).
//! * U_s is given, or chosen such that the gas carries the weight of a fully periodic box \[Moon2006 (18)\].
//! * Drag \[Moon2006 (13)-(16); WenYu1966\]: beta(phi, Re) ([`gas::DragLaw`]).
//! * phi and u_s on a vertical grid by hat weights \[Moon2006 (8)-(10)\] ([`coupling::ColumnDeposition`]).
//!
//! Symbols: phi is the solids fraction, u_s the mean velocity of the solids, u_g that of the gas between them, U_s the
//! superficial gas velocity, v the velocity of the particle, beta the momentum transfer per volume, delta the overlap,
//! v_n the normal relative velocity and A the Hamaker constant. Time is integrated by velocity Verlet; dashpots,
//! sliders and drag use the velocities of the half step.
//!
//! # Units
//!
//! All numbers are in one coherent system of units, which the case names: SI, or the one in which solid density,
//! reference diameter and gravity are 1. No function converts units; [`case`] converts dimensionless groups to
//! quantities once. z points upwards, gravity acts along -z.
//!
//! # One answer
//!
//! Positions and forces are multiples of quanta, so that sums are exact ([`numbers::Quantum`] \[Demmel2015\]);
//! diagnostics are summed exactly ([`numbers::ExactSum`] \[Neal2015\]). Results therefore do not depend on the number
//! of ranks, the decomposition of the box, the order of work, or restarts. `ARCHITECTURE.md` gives the reasons, and a
//! list of changes that would break this.
//!
//! # Modules
//!
//! [`time_step`] reads like the method section; [`state`] says what it works on. Below them: [`numbers`],
//! [`schema`], [`rules`], [`domain`], [`particles`], [`contact`], [`grid`], [`linear_solver`], [`gas`], [`coupling`],
//! [`parallel`], [`particle_sets`], [`timers`], [`balance`]. Around them: [`analysis`], [`beds`], [`setup`], [`output`], [`case`],
//! [`simulation`], [`post_processing`], [`study`], [`command_line`].
//!
//! # References
//!
//! * Moon2006: S. J. Moon, I. G. Kevrekidis, S. Sundaresan, "Particle simulation of vibrated gas-fluidized
//!   beds of cohesive fine powders", Ind. Eng. Chem. Res. 45 (2006) 6966-6977.
//! * Cundall1979: P. A. Cundall, O. D. L. Strack, "A discrete numerical model for granular assemblies",
//!   Géotechnique 29 (1979) 47-65.
//! * Hamaker1937: H. C. Hamaker, "The London-van der Waals attraction between spherical particles", Physica 4
//!   (1937) 1058-1072.
//! * WenYu1966: C. Y. Wen, Y. H. Yu, "Mechanics of fluidization", Chem. Eng. Prog. Symp. Ser. 62 (1966)
//!   100-111.
//! * Liu2016: D. Liu, B. G. M. van Wachem, R. F. Mudde, X. Chen, J. R. van Ommen, "An adhesive CFD-DEM model for
//!   simulating nanoparticle agglomerate fluidization", AIChE J. 62 (2016) 2259-2270.
//! * Luding2008: S. Luding, "Cohesive, frictional powders: contact models for tension", Granular Matter 10 (2008)
//!   235-246.
//! * Johnson1971: K. L. Johnson, K. Kendall, A. D. Roberts, "Surface energy and the contact of elastic solids",
//!   Proc. R. Soc. Lond. A 324 (1971) 301-313.
//! * Ai2011: J. Ai, J.-F. Chen, J. M. Rotter, J. Y. Ooi, "Assessment of rolling resistance models in discrete
//!   element simulations", Powder Technol. 206 (2011) 269-282.
//! * Demmel2015: J. Demmel, H. D. Nguyen, "Parallel reproducible summation", IEEE Trans. Comput. 64 (2015)
//!   2060-2070.
//! * Neal2015: R. M. Neal, "Fast exact summation using small and large superaccumulators", arXiv:1505.05571
//!   (2015).

#[doc(inline)]
pub use talcum_engine::{
    balance, contact, coupling, domain, fields, gas, grid, linear_solver, numbers, parallel,
    particle_sets, particles, rules, schema, state, time_step, timers,
};
#[doc(inline)]
pub use talcum_program::{command_line, post_processing, study};
#[doc(inline)]
pub use talcum_results::{analysis, instruments, output};
#[doc(inline)]
pub use talcum_runs::{beds, case, input, setup, simulation};
