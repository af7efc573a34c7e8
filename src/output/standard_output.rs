//! What commands print.

use std::io::{ErrorKind, Result, Write, stdout};

/// Prints a text and the end of its line on standard output.
///
/// A reader that has gone, as `head` does when it has enough, is no error: nobody misses the rest, and what else a command
/// does is worth more.
///
/// # Errors
/// If standard output cannot be written, for example since its disk is full.
pub(crate) fn print(text: &str) -> Result<()> {
    let mut output = stdout();
    let printed = output.write_all(format!("{text}\n").as_bytes()).and_then(|()| output.flush());
    unless_closed(printed)
}

/// The result of printing, where a reader that has gone is no error.
pub(crate) fn unless_closed(printed: Result<()>) -> Result<()> {
    match printed {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(std::io::Error::new(
            error.kind(),
            format!("standard output cannot be written: {error}"),
        )),
        Ok(()) => Ok(()),
    }
}
