//! Where the particles are: the box, its walls, the frame it is seen from, and how it is cut. Arithmetic
//! only; knows no ranks but as numbers.

mod bounds;
mod decomposition;
mod gravity;
mod walls;

pub use bounds::{Bounds, Face};
pub use decomposition::{Decomposition, RankGrid};
pub use gravity::{EffectiveGravity, Vibration};
pub use walls::{BASE_PLATE, PosedWalls, Wall, WallMotion, WallPose, WallShape};
