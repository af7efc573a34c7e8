//! The drag law, from its keys.

use super::section::Section;
use crate::gas::{
    Beetstra, DiFelice, DragLaw, Ergun, Gidaspow, SingleSphere, Switch, Tenneti, WenYu,
    WenYuCreeping,
};

/// The drag law.
pub(super) fn read_drag(section: &Section<'_>) -> Option<DragLaw> {
    Some(match section.word("drag")? {
        "wen_yu" => DragLaw::WenYu(WenYu { exponent: section.number("voidage_exponent")? }),
        "wen_yu_creeping" => {
            DragLaw::WenYuCreeping(WenYuCreeping { exponent: section.number("voidage_exponent")? })
        }
        "ergun" => DragLaw::Ergun(Ergun),
        "gidaspow" => {
            let switches = [("sharp", Switch::Sharp), ("smooth", Switch::Smooth)];
            DragLaw::Gidaspow(Gidaspow { switch: section.choice("drag_switch", &switches)? })
        }
        "beetstra" => DragLaw::Beetstra(Beetstra),
        "tenneti" => DragLaw::Tenneti(Tenneti),
        "di_felice" => {
            let spheres = [
                ("dallavalle", SingleSphere::Dallavalle),
                ("schiller_naumann", SingleSphere::SchillerNaumann),
            ];
            let single_sphere = section.choice("single_sphere", &spheres)?;
            DragLaw::DiFelice(DiFelice { single_sphere })
        }
        _ => return None,
    })
}
