//! A state between two steps.

use crate::particles::kick;
use crate::state::{Clock, Departed, SizeRange, State};
use crate::timers::{Phase, Timers};

/// A state whose velocities may belong to the half step before its time. The second half-kick of the last step is left
/// to the next step, which does it together with its own first half-kick. While this value holds the state, velocities
/// can be read only through [`Staggered::synchronised`], which brings them to the time of the clock.
///
/// When it is dropped, the state is synchronised.
#[derive(Debug)]
pub struct Staggered<'a> {
    state: &'a mut State,
    /// Length of the step whose second half-kick is due.
    kick_due: Option<f64>,
}

impl<'a> Staggered<'a> {
    /// A state at the beginning of a step; all of it belongs to one time.
    pub fn new(state: &'a mut State) -> Self {
        Self { state, kick_due: None }
    }

    /// The state with its velocities at the time of the clock: for instruments, records, checkpoints. Does the second
    /// half-kick if it is due.
    pub fn synchronised(&mut self, timers: &mut Timers) -> &mut State {
        timers.time(Phase::Integrate, || self.synchronise());
        self.state
    }

    /// The clock.
    pub fn clock(&self) -> &Clock {
        &self.state.clock
    }

    /// Particles that have left the box.
    pub fn departed(&self) -> Departed {
        self.state.departed
    }

    /// Sizes of the particles with which the run began.
    pub fn sizes(&self) -> &SizeRange {
        &self.state.sizes
    }

    /// Number of particles that this rank owns.
    pub fn owned_count(&self) -> usize {
        self.state.particles.owned_count()
    }

    /// Begins a step: the clock advances. Returns the state as it is, and the length of the step before if its second
    /// half-kick is due, which is now the caller's task.
    pub(super) fn begin_step(&mut self) -> (&mut State, Option<f64>) {
        self.state.clock.tick();
        (self.state, self.kick_due.take())
    }

    /// Leaves the second half-kick of a step of this length to the next.
    pub(super) fn leave_kick(&mut self, dt: f64) {
        self.kick_due = Some(dt);
    }

    fn synchronise(&mut self) {
        if let Some(dt) = self.kick_due.take() {
            kick(&mut self.state.particles, dt);
        }
    }
}

impl Drop for Staggered<'_> {
    fn drop(&mut self) {
        self.synchronise();
    }
}
