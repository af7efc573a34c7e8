//! Ranks that do not know of each other: a launcher has started many processes, and MPI takes each for a run of its own.

use thiserror::Error;

/// Slurm has started several tasks, but MPI knows of one rank.
#[derive(Debug, PartialEq, Eq, Error)]
#[error(
    "srun has started {0} tasks, but MPI sees one rank: each would run the whole case. Start them by srun --mpi=pmix, or by \
     what srun --mpi=list shows and your MPI was built for; or by mpirun -n {0}"
)]
pub(super) struct LoneRanks(u64);

/// Set by `mpirun` or by the interface of processes that MPI found; 1 if one rank was asked for.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// Refuses to go on as one of many runs of the same case. `variable` reads the environment.
///
/// # Errors
/// If this is one rank of several tasks of a step of Slurm.
pub(super) fn require_one_run(
    ranks: usize,
    variable: impl Fn(&str) -> Option<String>,
) -> Result<(), LoneRanks> {
    let number = |name: &str| variable(name)?.parse::<u64>().ok();
    let one_was_asked_for = SIZES.iter().any(|name| number(name) == Some(1));
    match number("SLURM_STEP_NUM_TASKS") {
        Some(tasks) if tasks > 1 && ranks == 1 && !one_was_asked_for => Err(LoneRanks(tasks)),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(ranks: usize, variables: &[(&str, &str)]) -> Result<(), LoneRanks> {
        let value = |name: &str| variables.iter().find(|(known, _)| *known == name);
        require_one_run(ranks, |name| value(name).map(|(_, text)| (*text).to_owned()))
    }

    #[test]
    fn one_rank_among_several_tasks_is_refused() {
        let error = found(1, &[("SLURM_STEP_NUM_TASKS", "32")]).unwrap_err().to_string();
        assert!(error.contains("32 tasks") && error.contains("--mpi=list"), "{error}");
        // The interface has told them, but MPI does not speak it.
        assert!(found(1, &[("SLURM_STEP_NUM_TASKS", "4"), ("PMI_SIZE", "4")]).is_err());
    }

    #[test]
    fn runs_that_are_one_go_on() {
        assert_eq!(found(32, &[("SLURM_STEP_NUM_TASKS", "32")]), Ok(()));
        assert_eq!(found(1, &[("SLURM_STEP_NUM_TASKS", "1")]), Ok(()));
        assert_eq!(found(1, &[]), Ok(()));
        // mpirun -n 1 in a step of several tasks.
        let by_mpirun = [("SLURM_STEP_NUM_TASKS", "2"), ("OMPI_COMM_WORLD_SIZE", "1")];
        assert_eq!(found(1, &by_mpirun), Ok(()));
    }
}
