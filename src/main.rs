//! The program `talcum`.

use std::process::ExitCode;
use talcum::parallel::AllocatorOfRanks;

#[global_allocator]
static ALLOCATOR: AllocatorOfRanks = AllocatorOfRanks;

fn main() -> ExitCode {
    AllocatorOfRanks::return_large_arrays();
    talcum::command_line::main()
}
