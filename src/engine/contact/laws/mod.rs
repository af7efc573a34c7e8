//! The contact laws: one file each, its `mod` line, and its line in the registry.

mod custom;
mod parts;
mod registered;
#[macro_use]
mod registry;

mod adhesive_elastic_plastic;
mod hertz_mindlin;
mod jkr;
mod linear_hysteretic;
mod linear_spring_dashpot;

pub use custom::CustomContactLaw;
pub use parts::{ContactModuli, Elasticity, FrictionCap, HystereticParameters, Reloading};
pub use registered::{
    Adhesion, ContactLawValues, ExampleScales, FRICTION, RESTITUTION, RegisteredContactLaw,
};

// The name of the file is the name of the law in a case. These lines define the enum `ContactLaw`, its dispatch in and
// outside the loop over pairs, the names that a case can choose from, the laws that the tests run over, and the table
// in docs/laws.md.
contact_laws! {
    linear_spring_dashpot::LinearSpringDashpot,
    adhesive_elastic_plastic::AdhesiveElasticPlastic,
    linear_hysteretic::LinearHysteretic,
    hertz_mindlin::HertzMindlin,
    jkr::Jkr,
}
