//! The run in the terminal, until the user leaves.

mod guard;
mod plot;
mod screen;

use self::guard::{guard, has_gone};
use self::screen::Screen;
use super::columns::chosen;
use super::run::WatchedRun;
use crate::command_line::signals::stop_flag;
use anyhow::Context;
use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use std::mem::ManuallyDrop;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Time between checks of the folder.
const BETWEEN_LOOKS: Duration = Duration::from_secs(1);
/// Time between checks for keys and signals.
const PATIENCE: Duration = Duration::from_millis(100);

/// Shows the run until `q`, Esc, Ctrl-C, a signal or the end of the terminal; restores the terminal, also after an
/// error.
pub(super) fn show(run: &mut WatchedRun, columns: &[String]) -> anyhow::Result<()> {
    let stop = stop_flag()?;
    guard(Arc::clone(&stop)).context("no thread can be started")?;
    let terminal = ratatui::try_init().context("the terminal cannot be drawn on; try --once")?;
    // When dropped, it would print an error to a terminal that has gone, and panic.
    let mut terminal = ManuallyDrop::new(terminal);
    let ended = follow(&mut terminal, run, columns, &stop);
    // Nothing is left to restore if the terminal has gone, and nobody can be shown an error.
    let _ = terminal.show_cursor();
    let _ = ratatui::try_restore();
    if ended.is_err() && has_gone() { Ok(()) } else { ended }
}

fn follow(
    terminal: &mut DefaultTerminal,
    run: &mut WatchedRun,
    columns: &[String],
    stop: &AtomicBool,
) -> anyhow::Result<()> {
    let mut is_logarithmic = false;
    loop {
        let curves = run.series().map(|series| chosen(columns, series)).unwrap_or_default();
        let screen = Screen { overview: run.overview(), curves, is_logarithmic };
        terminal.draw(|frame| screen.draw(frame))?;
        match wait(stop)? {
            Wish::Leave => return Ok(()),
            Wish::OtherScale => is_logarithmic = !is_logarithmic,
            Wish::Look => run.renew(),
        }
    }
}

/// The next action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Wish {
    Leave,
    OtherScale,
    Look,
}

/// Waits for a key, or for the next check. A terminal that changes its size is redrawn at once.
fn wait(stop: &AtomicBool) -> anyhow::Result<Wish> {
    let begin = Instant::now();
    while begin.elapsed() < BETWEEN_LOOKS {
        if stop.load(Ordering::Relaxed) {
            return Ok(Wish::Leave);
        }
        if !event::poll(PATIENCE)? {
            continue;
        }
        match event::read()? {
            Event::Key(key) if key.kind == KeyEventKind::Press => {
                if let Some(wish) = wish_of(key) {
                    return Ok(wish);
                }
            }
            Event::Resize(..) => return Ok(Wish::Look),
            _ => {}
        }
    }
    Ok(Wish::Look)
}

fn wish_of(key: KeyEvent) -> Option<Wish> {
    match key.code {
        KeyCode::Char('q') | KeyCode::Esc => Some(Wish::Leave),
        KeyCode::Char('c') if key.modifiers.contains(KeyModifiers::CONTROL) => Some(Wish::Leave),
        KeyCode::Char('l') => Some(Wish::OtherScale),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn q_escape_and_control_c_leave_and_l_changes_the_scale() {
        let wish = |code, modifiers| wish_of(KeyEvent::new(code, modifiers));
        assert_eq!(wish(KeyCode::Char('q'), KeyModifiers::NONE), Some(Wish::Leave));
        assert_eq!(wish(KeyCode::Esc, KeyModifiers::NONE), Some(Wish::Leave));
        assert_eq!(wish(KeyCode::Char('c'), KeyModifiers::CONTROL), Some(Wish::Leave));
        assert_eq!(wish(KeyCode::Char('l'), KeyModifiers::NONE), Some(Wish::OtherScale));
        assert_eq!(wish(KeyCode::Char('c'), KeyModifiers::NONE), None);
        assert_eq!(wish(KeyCode::Enter, KeyModifiers::NONE), None);
    }
}
