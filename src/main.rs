//! The program `talcum`.

use std::process::ExitCode;

fn main() -> ExitCode {
    talcum::command_line::main()
}
