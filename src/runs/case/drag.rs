//! The drag law and the rule by which it is shared, from their keys.

use crate::input::Section;
use talcum_engine::gas::{DragLaw, DragShare};

/// The drag law.
pub(super) fn read_drag(section: &Section<'_>) -> Option<DragLaw> {
    DragLaw::from_keys(section.word("drag")?, section)
}

/// Rule by which particles of different sizes share the drag.
pub(super) fn read_drag_share(section: &Section<'_>) -> Option<DragShare> {
    let shares = [("own_diameter", DragShare::Diameter), ("sauter_diameter", DragShare::Surface)];
    section.choice("drag_in_mixtures", &shares)
}
