//! Studies: many runs from one case, by lists and ranges of keys, seeds, continuation, and bisection.
//!
//! A study file is read strictly (`file`) into a `Study`; `Plan` expands it to points and tasks, which do not depend
//! on each other. The `Scheduler` asks every task what it needs next, starts runs as processes of their own (`job`), and
//! ends when nothing is left. All state is in the folders of the runs (`folder`), so that a study resumes wherever it
//! was stopped; the tables depend on the results only.
//!
//! A study is no part of a run: it knows how cases are read, and what the columns of `series.csv` are called, and it
//! runs without MPI. Tests put other things in the place of a `CaseChecker` and a `Runner`.

mod bisection;
mod case_text;
mod checker;
mod command;
mod definition;
mod file;
mod folder;
mod job;
mod known;
mod member;
mod plan;
mod problem;
mod quantity;
mod run_outline;
mod scheduler;
mod schema;
mod session;
mod setting;
mod signals;
mod start;
mod starting_states;
mod status;
mod summary;
mod table;
mod task;
mod templates;
#[cfg(test)]
mod tests;

pub use command::{StudyOptions, run};
pub use schema::FILE_KEYS;
pub use summary::{SummaryOptions, summary};
