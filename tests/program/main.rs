//! The program as used by its users: case files, runs, restarts, checkpoints, failures, results.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

#[path = "../launch/mod.rs"]
mod launch;

mod adviser;
mod agglomerate_drag;
mod analyse;
mod case_files;
mod case_meaning;
mod case_schema;
mod checkpoints;
mod coarse_graining;
mod damaged_inputs;
mod documented_fields;
mod energy_table;
mod failures;
mod faults;
mod golden;
mod initial_beds;
mod instruments;
mod interruption;
mod left_semaphore;
mod meshes;
mod mpirun;
mod new_case;
mod printing;
mod restart;
mod round_column;
mod shell;
mod snapshots;
mod softened_adhesion;
mod species;
mod stage_ends;
mod study;
mod toml_files;
mod wall_table;
mod watch;
