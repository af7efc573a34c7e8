//! The program `talcum`.

use std::process::ExitCode;
use talcum::parallel::AllocatorOfRanks;

#[global_allocator]
static ALLOCATOR: AllocatorOfRanks = AllocatorOfRanks;

fn main() -> ExitCode {
    talcum::command_line::main()
}
