//! Time of a run.

/// Time, as a count of steps since the length of the step was last changed, so that rounding errors do not accumulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Steps done since the run began.
    pub step: u64,
    /// Time at `origin_step`; time.
    pub origin_time: f64,
    /// Step from which `time_step` applies.
    pub origin_step: u64,
    /// Length of a step.
    pub time_step: f64,
}

impl Clock {
    /// A clock at time zero.
    pub fn new(time_step: f64) -> Self {
        Self { step: 0, origin_time: 0.0, origin_step: 0, time_step }
    }

    /// The time now.
    pub fn time(&self) -> f64 {
        self.time_of(self.step)
    }

    /// The time after `step` steps, as long as the length of the step does not change.
    pub fn time_of(&self, step: u64) -> f64 {
        self.origin_time + (step - self.origin_step) as f64 * self.time_step
    }

    /// Advances by one step.
    pub fn tick(&mut self) {
        self.step += 1;
    }

    /// A clock at this instant that continues with another length of the step.
    pub fn with_time_step(self, time_step: f64) -> Self {
        if time_step == self.time_step {
            return self;
        }
        Self { step: self.step, origin_time: self.time(), origin_step: self.step, time_step }
    }
}
