//! What several contact laws are made of.

mod elastic;
mod hysteresis;
mod slider;

pub use elastic::{ContactModuli, Elasticity};
pub(crate) use elastic::{Elastic, ElasticParameters, loading_factor};
pub(crate) use hysteresis::Hysteresis;
pub use hysteresis::HystereticParameters;
pub(crate) use slider::Slider;
