//! Contents of the screen: head, progress, warnings, plots.

use super::plot;
use crate::command_line::watch::columns::Curve;
use crate::command_line::watch::run::{Overview, RunState};
use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Style, Stylize};
use ratatui::text::Line;
use ratatui::widgets::{Gauge, Paragraph};

/// Largest number of warnings that are shown.
const WARNINGS: usize = 4;
/// Number of columns from which plots are placed side by side.
const WIDE: u16 = 80;

/// Results of one check of a run.
pub(super) struct Screen {
    pub(super) overview: Overview,
    pub(super) curves: Vec<Curve>,
    /// Whether values have logarithmic axes.
    pub(super) is_logarithmic: bool,
}

impl Screen {
    pub(super) fn draw(&self, frame: &mut Frame) {
        let head = self.head();
        let rows = [
            Constraint::Length(head.len() as u16),
            Constraint::Length(1),
            Constraint::Fill(1),
            Constraint::Length(1),
        ];
        let [top, bar, plots, foot] = Layout::vertical(rows).areas(frame.area());
        frame.render_widget(Paragraph::new(head), top);
        frame.render_widget(self.progress(), bar);
        self.draw_plots(frame, plots);
        frame.render_widget(Line::from(" q: leave   l: linear or logarithmic").dim(), foot);
    }

    fn head(&self) -> Vec<Line<'_>> {
        let overview = &self.overview;
        let state = overview.state.text();
        let mut lines = vec![
            Line::from(overview.title.as_str()).bold(),
            Line::from(overview.folder.as_str()).dim(),
            Line::from(state).style(Style::new().fg(colour(&overview.state))),
            Line::from(overview.pace_text().unwrap_or_default()),
        ];
        let warning = |text: &String| Line::from(format!("warning: {text}")).yellow();
        lines.extend(overview.warnings.iter().take(WARNINGS).map(warning));
        lines
    }

    fn progress(&self) -> Gauge<'_> {
        let overview = &self.overview;
        let stage = overview.stage.as_ref().map(|(name, _)| format!(", {name}"));
        let label = format!("{}{}", overview.progress_text(), stage.unwrap_or_default());
        let bar = Gauge::default().use_unicode(true).label(label);
        bar.ratio(overview.part_done().unwrap_or(0.0)).gauge_style(Style::new().fg(Color::Blue))
    }

    fn draw_plots(&self, frame: &mut Frame, area: Rect) {
        if self.curves.is_empty() {
            frame.render_widget(Line::from("no rows of series.csv yet").dim(), area);
            return;
        }
        let across = if area.width >= WIDE && self.curves.len() > 1 { 2 } else { 1 };
        let rows: Vec<&[Curve]> = self.curves.chunks(across).collect();
        let areas = Layout::vertical(vec![Constraint::Fill(1); rows.len()]).split(area);
        for (curves, row) in rows.into_iter().zip(areas.iter()) {
            let cells = Layout::horizontal(vec![Constraint::Fill(1); curves.len()]).split(*row);
            for (curve, cell) in curves.iter().zip(cells.iter()) {
                plot::draw(frame, *cell, curve, &self.overview.time_unit, self.is_logarithmic);
            }
        }
    }
}

fn colour(state: &RunState) -> Color {
    match state {
        RunState::Running { .. } => Color::Green,
        RunState::Complete { .. } => Color::Blue,
        RunState::Waiting => Color::Gray,
        RunState::Quiet { .. } | RunState::Stopped | RunState::Died { .. } => Color::Yellow,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ratatui::Terminal;
    use ratatui::backend::TestBackend;

    fn screen() -> Screen {
        let points = (0..200).map(|n| (f64::from(n), (0.1 * f64::from(n)).sin())).collect();
        let curve = Curve { name: "bed_top".to_owned(), unit: "m".to_owned(), points };
        let overview = Overview {
            folder: "results/bed".to_owned(),
            title: "A bed".to_owned(),
            state: RunState::Running { holder: Some("process 7 on here".to_owned()) },
            time: Some(15.0),
            end: Some(60.0),
            time_unit: "s".to_owned(),
            stage: Some(("settle".to_owned(), 5.0e-4)),
            rate: Some(0.5),
            warnings: vec!["something is odd".to_owned()],
        };
        Screen { overview, curves: vec![curve.clone(), curve], is_logarithmic: false }
    }

    /// The lines of the screen on a terminal of a size.
    fn drawn(screen: &Screen, width: u16, height: u16) -> Vec<String> {
        let mut terminal = Terminal::new(TestBackend::new(width, height)).unwrap();
        terminal.draw(|frame| screen.draw(frame)).unwrap();
        let buffer = terminal.backend().buffer();
        let line = |row| (0..width).map(|column| buffer[(column, row)].symbol()).collect();
        (0..height).map(line).collect()
    }

    fn dots(lines: &[String]) -> usize {
        lines
            .iter()
            .flat_map(|line| line.chars())
            .filter(|c| ('\u{2801}'..='\u{28ff}').contains(c))
            .count()
    }

    #[test]
    fn head_progress_warnings_and_plots_are_drawn() {
        let lines = drawn(&screen(), 100, 30);
        let text = lines.join("\n");
        for expected in ["A bed", "running: process 7", "1000 steps/s", "25 %", "something is odd"]
        {
            assert!(text.contains(expected), "{expected}\n{text}");
        }
        assert_eq!(text.matches("bed_top [m]").count(), 2);
        assert!(dots(&lines) > 60, "{text}");
        // Negative control: without curves there are no dots, and only one word.
        let empty = drawn(&Screen { curves: Vec::new(), ..screen() }, 100, 30);
        assert_eq!(dots(&empty), 0);
        assert!(empty.join("\n").contains("no rows of series.csv yet"));
    }

    #[test]
    fn a_logarithmic_axis_shows_what_is_above_zero() {
        let points = (0..100).map(|n| (f64::from(n), 10.0_f64.powi(-n / 20))).collect();
        let curve = Curve { name: "energy".to_owned(), unit: String::new(), points };
        let rows_with_dots = |is_logarithmic| {
            let screen = Screen { curves: vec![curve.clone()], is_logarithmic, ..screen() };
            drawn(&screen, 60, 30).iter().filter(|line| dots(&[(*line).clone()]) > 2).count()
        };
        // Four decades: on a linear axis all except the first lie at the bottom.
        assert!(
            rows_with_dots(true) >= 5 && rows_with_dots(false) < 4,
            "{}",
            rows_with_dots(false)
        );
        let below =
            Screen { curves: vec![screen().curves[0].clone()], is_logarithmic: true, ..screen() };
        assert!(dots(&drawn(&below, 60, 30)) > 20);
    }

    #[test]
    fn no_terminal_is_too_small() {
        for (width, height) in [(1, 1), (5, 3), (20, 8), (79, 12), (300, 4)] {
            assert_eq!(drawn(&screen(), width, height).len(), usize::from(height));
        }
        let undefined = Curve { name: "x".to_owned(), unit: String::new(), points: Vec::new() };
        drawn(&Screen { curves: vec![undefined], ..screen() }, 80, 24);
    }
}
