//! The range of the neighbour list.

/// Separation of surfaces up to which the list holds pairs: the interaction range and the skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ListRange {
    /// Interaction range: separation of surfaces up to which particles act on each other.
    pub interaction: f64,
    /// Skin: additional separation that lets the list be used for many steps.
    pub skin: f64,
}

impl ListRange {
    /// Width of the ghost layer: the largest distance between two centres in the list.
    pub fn ghost_width(&self, largest_diameter: f64) -> f64 {
        largest_diameter + self.interaction + self.skin
    }
}
