//! Detection of processes that do not know each other: a launcher has started several, and each would do the whole run.

use thiserror::Error;

/// A launcher has started several processes, but MPI knows of one rank.
#[derive(Debug, PartialEq, Eq, Error)]
pub(super) enum LoneRanks {
    /// Slurm, through an interface that this MPI does not support.
    #[error(
        "srun has started {0} tasks, but MPI sees one rank: each would run the whole case. Start them by srun --mpi=pmix \
         (in a job: export SLURM_MPI_TYPE=pmix), or by what srun --mpi=list shows and your MPI was built for; or by mpirun -n {0}"
    )]
    Slurm(u64),
    /// The launcher of another MPI.
    #[error(
        "mpirun has started {0} processes, but MPI sees one rank: each would run the whole case. Start them by the mpirun of \
         the MPI that talcum was built with (ldd talcum shows which it is; on Debian, mpirun.openmpi or mpirun.mpich)"
    )]
    OtherMpi(u64),
}

/// Ranks are threads, but a launcher has started several processes.
#[derive(Debug, PartialEq, Eq, Error)]
#[error(
    "{processes} processes were started together, and threads are the ranks of one process: each would run the whole case. \
     Start talcum by itself, with --threads {processes}; or, if it was built with MPI, without --threads"
)]
pub(super) struct ManyProcesses {
    processes: u64,
    /// Whether this process reports the error.
    pub(super) speaks: bool,
}

/// Variables set by launchers: the number of processes, and the number of this one. The first one found counts:
/// `mpirun` may be called within a step of Slurm.
const LAUNCHERS: [[&str; 2]; 4] = [
    ["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"],
    ["PMI_SIZE", "PMI_RANK"],
    ["MV2_COMM_WORLD_SIZE", "MV2_COMM_WORLD_RANK"],
    ["SLURM_STEP_NUM_TASKS", "SLURM_PROCID"],
];

/// Refuses to run as one of several processes with the same command. `variable` reads the environment.
///
/// # Errors
/// If a launcher has started more than this process.
pub(super) fn require_one_process(
    variable: impl Fn(&str) -> Option<String>,
) -> Result<(), ManyProcesses> {
    let number = |name: &str| variable(name)?.parse::<u64>().ok();
    let known = LAUNCHERS.iter().find_map(|[size, rank]| Some((number(size)?, number(rank))));
    match known {
        Some((processes, rank)) if processes > 1 => {
            Err(ManyProcesses { processes, speaks: rank.unwrap_or(0) == 0 })
        }
        _ => Ok(()),
    }
}

/// Variables set by the launchers of Open MPI, and of MPICH and its relatives, to the number of processes that they
/// start.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// Refuses to run as one of many runs of the same case. `variable` reads the environment.
///
/// # Errors
/// If this is one rank of several processes that were started together.
pub(super) fn require_one_run(
    ranks: usize,
    variable: impl Fn(&str) -> Option<String>,
) -> Result<(), LoneRanks> {
    if ranks != 1 {
        return Ok(());
    }
    let number = |name: &str| variable(name)?.parse::<u64>().ok();
    // The smallest is used, not the largest: an mpirun of one rank may itself have been started by another launcher.
    let launched = SIZES.iter().filter_map(|name| number(name)).min();
    let tasks = number("SLURM_STEP_NUM_TASKS").filter(|&tasks| tasks > 1);
    match (launched, tasks) {
        (Some(0 | 1), _) | (None, None) => Ok(()),
        (_, Some(tasks)) => Err(LoneRanks::Slurm(tasks)),
        (Some(processes), None) => Err(LoneRanks::OtherMpi(processes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(variables: &[(&str, &str)], name: &str) -> Option<String> {
        let known = variables.iter().find(|(known, _)| *known == name);
        known.map(|(_, text)| (*text).to_owned())
    }

    #[test]
    fn threads_are_ranks_of_one_process() {
        let found = |variables: &[_]| require_one_process(|name| value(variables, name));
        assert_eq!(found(&[]), Ok(()));
        assert_eq!(found(&[("OMPI_COMM_WORLD_SIZE", "1"), ("SLURM_STEP_NUM_TASKS", "2")]), Ok(()));
        let of_mpirun = |rank| [("OMPI_COMM_WORLD_SIZE", "3"), ("OMPI_COMM_WORLD_RANK", rank)];
        for (rank, speaks) in [("0", true), ("2", false)] {
            assert_eq!(found(&of_mpirun(rank)), Err(ManyProcesses { processes: 3, speaks }));
        }
        assert!(found(&[("PMI_SIZE", "2")]).unwrap_err().to_string().contains("--threads 2"));
        assert!(found(&[("SLURM_STEP_NUM_TASKS", "8"), ("SLURM_PROCID", "0")]).is_err());
    }

    fn found(ranks: usize, variables: &[(&str, &str)]) -> Result<(), LoneRanks> {
        require_one_run(ranks, |name| value(variables, name))
    }

    #[test]
    fn one_rank_among_several_tasks_is_refused() {
        let error = found(1, &[("SLURM_STEP_NUM_TASKS", "32")]).unwrap_err().to_string();
        assert!(error.contains("32 tasks") && error.contains("--mpi=list"), "{error}");
        // The interface has forwarded them, but this MPI does not support it.
        assert!(found(1, &[("SLURM_STEP_NUM_TASKS", "4"), ("PMI_SIZE", "4")]).is_err());
    }

    #[test]
    fn one_rank_under_the_launcher_of_another_mpi_is_refused() {
        for name in SIZES {
            let error = found(1, &[(name, "2")]).unwrap_err().to_string();
            assert!(error.contains("2 processes") && error.contains("ldd"), "{error}");
            assert_eq!(found(1, &[(name, "1")]), Ok(()));
            assert_eq!(found(2, &[(name, "2")]), Ok(()));
        }
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
