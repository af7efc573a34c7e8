//! The keys of the drag law.

use super::allowed::Allowed;
use super::section::Section;
use crate::gas::{
    Beetstra, DiFelice, DragLaw, Ergun, Gidaspow, SingleSphere, Switch, Tenneti, WenYu,
    WenYuCreeping,
};
use serde::Deserialize;

#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Law {
    WenYu,
    WenYuCreeping,
    Ergun,
    Gidaspow,
    Beetstra,
    Tenneti,
    DiFelice,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SwitchKind {
    Sharp,
    Smooth,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SphereDrag {
    Dallavalle,
    SchillerNaumann,
}

/// The drag law and its factor xi.
pub(super) fn read_drag(section: &Section<'_>) -> Option<(DragLaw, f64)> {
    let law: Option<Law> = section.value("drag");
    let factor = section.number_or("drag_factor", Allowed::POSITIVE, 1.0);
    let exponent = of_law(section, "voidage_exponent", law, |law| {
        matches!(law, Law::WenYu | Law::WenYuCreeping)
    })
    .then(|| section.number_or("voidage_exponent", Allowed::between(0.0, 10.0), 1.65));
    let switch = of_law(section, "drag_switch", law, |law| law == Law::Gidaspow)
        .then(|| section.value("drag_switch"))
        .flatten();
    let sphere = of_law(section, "single_sphere", law, |law| law == Law::DiFelice)
        .then(|| section.value("single_sphere"))
        .flatten();
    let law = match law? {
        Law::WenYu => DragLaw::WenYu(WenYu { exponent: exponent? }),
        Law::WenYuCreeping => DragLaw::WenYuCreeping(WenYuCreeping { exponent: exponent? }),
        Law::Ergun => DragLaw::Ergun(Ergun),
        Law::Gidaspow => DragLaw::Gidaspow(Gidaspow {
            switch: match switch? {
                SwitchKind::Sharp => Switch::Sharp,
                SwitchKind::Smooth => Switch::Smooth,
            },
        }),
        Law::Beetstra => DragLaw::Beetstra(Beetstra),
        Law::Tenneti => DragLaw::Tenneti(Tenneti),
        Law::DiFelice => DragLaw::DiFelice(DiFelice {
            single_sphere: match sphere? {
                SphereDrag::Dallavalle => SingleSphere::Dallavalle,
                SphereDrag::SchillerNaumann => SingleSphere::SchillerNaumann,
            },
        }),
    };
    Some((law, factor))
}

/// Whether a key belongs to the law; an error if it is given without.
fn of_law(
    section: &Section<'_>,
    key: &'static str,
    law: Option<Law>,
    belongs: impl Fn(Law) -> bool,
) -> bool {
    let belongs = law.is_some_and(belongs);
    if section.has(key) && law.is_some() && !belongs {
        section.fail(key, "cannot be given: this drag law has no use for it");
    }
    belongs
}
