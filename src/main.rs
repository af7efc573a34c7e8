//! The program `talcum`.

mod gallery;

use gallery::GALLERY;
use std::process::ExitCode;
use talcum::command_line::{self, Build};
use talcum::parallel::AllocatorOfRanks;

#[global_allocator]
static ALLOCATOR: AllocatorOfRanks = AllocatorOfRanks;

fn main() -> ExitCode {
    AllocatorOfRanks::return_large_arrays();
    command_line::main(&Build { commit: env!("TALCUM_COMMIT"), gallery: &GALLERY })
}
