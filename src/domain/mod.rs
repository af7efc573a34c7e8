//! Where the particles are: the box, its walls, the frame it is seen from, and how it is cut. Arithmetic
//! only; knows no ranks but as numbers.

mod bounds;
mod box_face;
mod decomposition;
mod gravity;
mod subdomain;
mod walls;

pub use bounds::{Bounds, Face};
pub use box_face::BoxFace;
pub use decomposition::{Decomposition, RankGrid};
pub use gravity::{EffectiveGravity, Vibration};
pub use subdomain::Subdomain;
pub use walls::{BASE_PLATE, PosedWalls, Wall, WallMotion, WallPose, WallShape};
