//! The domain: the box, its walls, gravity in the frame of the vibrated plate, and the decomposition into subdomains of
//! the ranks. Arithmetic only, without communication.

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
pub use walls::{
    Axis, Bend, Edge, Facet, Feature, FromSurface, Mesh, MeshError, NearestOnFacet, PosedWalls,
    Side, Surface, Turn, Wall, WallMotion, WallPose, WallRotation, WallShape, join_vertices,
    rotation,
};
