//! Bubbles in fields of the voidage, and their rise velocities.

mod detection;
#[cfg(test)]
mod tests;
mod tracking;

pub use detection::{Bubble, BubbleOptions, VoidageField, find_bubbles};
pub use tracking::{Track, TrackingOptions, track_bubbles};
