//! Output of commands.

use std::io::{ErrorKind, Result, Write, stdout};

/// Prints a text and the end of its line on standard output.
///
/// A closed pipe, as left by `head` when it has enough, is not an error: nobody needs the rest, and the other work of a
/// command is more important.
///
/// # Errors
/// If standard output cannot be written, for example because its disk is full.
pub fn print(text: &str) -> Result<()> {
    let mut output = stdout();
    let printed = output.write_all(format!("{text}\n").as_bytes()).and_then(|()| output.flush());
    unless_closed(printed)
}

/// The result of printing, in which a closed pipe is not an error.
pub fn unless_closed(printed: Result<()>) -> Result<()> {
    match printed {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(()),
        Err(error) => Err(std::io::Error::new(
            error.kind(),
            format!("standard output cannot be written: {error}"),
        )),
        Ok(()) => Ok(()),
    }
}
