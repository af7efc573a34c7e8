//! The drag law, from its keys.

use super::section::Section;
use crate::gas::DragLaw;

/// The drag law.
pub(super) fn read_drag(section: &Section<'_>) -> Option<DragLaw> {
    DragLaw::from_keys(section.word("drag")?, section)
}
