//! A column over time as a plot of characters.

use crate::command_line::watch::columns::Curve;
use crate::command_line::watch::run::brief;
use crate::command_line::watch::thinning::thin;
use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Style};
use ratatui::symbols::Marker;
use ratatui::widgets::{Axis, Block, Chart, Dataset, GraphType};

/// Number of points per column of characters: two dots wide, with the lowest and highest of each.
const POINTS_PER_COLUMN: usize = 4;

/// Draws a curve into a part of the screen, optionally with a logarithmic axis.
pub(super) fn draw(
    frame: &mut Frame,
    area: Rect,
    curve: &Curve,
    time_unit: &str,
    is_logarithmic: bool,
) {
    let block = Block::bordered().border_style(Style::new().dim()).title(heading(curve));
    let scaled = if is_logarithmic { curve.logarithm() } else { curve.clone() };
    let points = thin(&scaled.points, POINTS_PER_COLUMN * usize::from(area.width));
    let (Some(first), Some(last), Some(range)) = (points.first(), points.last(), scaled.range())
    else {
        frame.render_widget(block, area);
        return;
    };
    let (times, values) = (around((first.0, last.0)), around(range));
    let line = Dataset::default()
        .marker(Marker::Braille)
        .graph_type(GraphType::Line)
        .style(Style::new().fg(Color::Cyan))
        .data(&points);
    let end = format!("{} {time_unit}", brief(times[1]));
    let value = |scaled: f64| if is_logarithmic { 10.0_f64.powf(scaled) } else { scaled };
    let chart = Chart::new(vec![line])
        .block(block)
        .legend_position(None)
        .x_axis(axis(times).labels([brief(times[0]), end.trim().to_owned()]))
        .y_axis(axis(values).labels(values.map(|scaled| brief(value(scaled)))));
    frame.render_widget(chart, area);
}

fn heading(curve: &Curve) -> String {
    let value = curve.last().map(|last| format!(" {}", brief(last))).unwrap_or_default();
    format!(" {}:{value} ", curve.title())
}

fn axis(bounds: [f64; 2]) -> Axis<'static> {
    Axis::default().bounds(bounds).style(Style::new().dim())
}

/// Bounds that differ even if all numbers are the same.
fn around((least, largest): (f64, f64)) -> [f64; 2] {
    if largest > least {
        return [least, largest];
    }
    let margin = if least == 0.0 { 1.0 } else { 0.1 * least.abs() };
    [least - margin, largest + margin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_apart_even_for_a_constant() {
        assert_eq!(around((1.0, 3.0)), [1.0, 3.0]);
        assert_eq!(around((0.0, 0.0)), [-1.0, 1.0]);
        let [least, largest] = around((-5.0e-9, -5.0e-9));
        assert!(least < -5.0e-9 && largest > -5.0e-9);
    }
}
