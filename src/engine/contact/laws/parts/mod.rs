//! Building blocks shared by several contact laws.

mod elastic;
pub(super) mod friction_cap;
mod hysteresis;
mod slider;

pub use elastic::{ContactModuli, Elasticity};
pub(crate) use elastic::{Elastic, ElasticParameters, loading_factor};
pub use friction_cap::FrictionCap;
pub(crate) use hysteresis::Hysteresis;
pub use hysteresis::{HystereticParameters, Reloading};
pub(crate) use slider::{SliderStep, stick_or_slide};
