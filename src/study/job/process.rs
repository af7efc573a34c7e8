//! Runs as child processes: `talcum run`, under a launcher if there is more than one rank.

use super::{Exit, Job, Runner, Running};
use crate::study::definition::{Launcher, Resources};
use crate::study::setting::Setting;
use rustix::process::{Pid, Signal, kill_process, kill_process_group};
use std::fs::File;
use std::os::unix::process::{CommandExt, ExitStatusExt};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};

/// Standard output of a run.
const OUTPUT: &str = "output.log";
/// Standard error of a run.
const ERRORS: &str = "error.log";
/// Lines of the error output that are quoted.
const QUOTED_LINES: usize = 5;

/// Starts `talcum run`.
#[derive(Clone, Debug)]
pub(crate) struct TalcumRunner {
    /// The program.
    pub(crate) program: PathBuf,
    /// Ranks and launcher.
    pub(crate) resources: Resources,
}

impl TalcumRunner {
    /// The words of the command that runs a case.
    pub(crate) fn command_line(
        &self,
        case: &Path,
        settings: &[Setting],
        folder: &Path,
    ) -> Vec<String> {
        let mut words = Vec::new();
        let (several, ranks) = (self.resources.ranks > 1, self.resources.ranks.to_string());
        if let (true, Launcher::Command(launcher)) = (several, &self.resources.launcher) {
            words.extend(launcher.iter().map(|word| word.replace("{ranks}", &ranks)));
        }
        words.push(self.program.display().to_string());
        words.extend(["run".to_owned(), case.display().to_string()]);
        words.extend(["--output".to_owned(), folder.display().to_string()]);
        // Continues from the newest checkpoint, or begins if there is none.
        words.push("--resume".to_owned());
        if several && self.resources.launcher == Launcher::Threads {
            words.extend(["--threads".to_owned(), ranks]);
        }
        words.extend(settings.iter().flat_map(|s| ["--set".to_owned(), s.argument()]));
        words
    }

    fn command(&self, job: Job) -> Result<(Command, PathBuf), String> {
        let words = self.command_line(&job.request.case, &job.request.settings, &job.folder);
        let (program, arguments) = words.split_first().ok_or("there is no command")?;
        let mut command = Command::new(program);
        let errors = job.folder.join(ERRORS);
        command.args(arguments);
        // The lock is the standard input, an empty file: it is held until the last process of the run has ended,
        // even if the study is killed before.
        command.stdin(job.lock);
        command.stdout(append(&job.folder.join(OUTPUT))?);
        command.stderr(truncate(&errors)?);
        // Ctrl-C reaches the study alone, which then stops its runs gently.
        command.process_group(0);
        if self.resources.at_a_time > 1 {
            // Open MPI binds the ranks of every job to the first cores: jobs would share them.
            command.env("OMPI_MCA_hwloc_base_binding_policy", "none");
            command.env("PRTE_MCA_hwloc_default_binding_policy", "none");
        }
        Ok((command, errors))
    }
}

fn append(path: &Path) -> Result<File, String> {
    let file = File::options().append(true).create(true).open(path);
    file.map_err(|error| format!("{} cannot be opened: {error}", path.display()))
}

fn truncate(path: &Path) -> Result<File, String> {
    File::create(path).map_err(|error| format!("{} cannot be opened: {error}", path.display()))
}

impl Runner for TalcumRunner {
    fn start(&self, job: Job) -> Result<Box<dyn Running>, String> {
        let (mut command, errors) = self.command(job)?;
        let program = command.get_program().to_string_lossy().into_owned();
        let child = command.spawn();
        let child = child.map_err(|error| format!("{program} cannot be started: {error}"))?;
        Ok(Box::new(RunningProcess { child, errors }))
    }
}

struct RunningProcess {
    child: Child,
    errors: PathBuf,
}

impl RunningProcess {
    fn pid(&self) -> Option<Pid> {
        Pid::from_raw(i32::try_from(self.child.id()).ok()?)
    }
}

impl Running for RunningProcess {
    fn poll(&mut self) -> Option<Exit> {
        let status = match self.child.try_wait() {
            Ok(status) => status?,
            Err(error) => return Some(Exit { success: false, description: error.to_string() }),
        };
        let mut description = describe(status);
        let lines = last_lines(&self.errors);
        if !status.success() && !lines.is_empty() {
            description += &format!(": {lines}");
        }
        Some(Exit { success: status.success(), description })
    }

    fn ask_to_stop(&mut self) {
        // mpirun passes SIGUSR1 on to its ranks, and ends with their exit code. It may have ended just now.
        let _ = self.pid().map(|pid| kill_process(pid, Signal::USR1));
    }

    fn kill(&mut self) {
        let _ = self.pid().map(|pid| kill_process_group(pid, Signal::TERM));
    }
}

fn describe(status: ExitStatus) -> String {
    match (status.code(), status.signal()) {
        (Some(code), _) => format!("ended with exit code {code}"),
        (None, Some(signal)) => format!("ended by signal {signal}"),
        (None, None) => "ended".to_owned(),
    }
}

/// The error that a run printed last, or else its last lines.
fn last_lines(path: &Path) -> String {
    let bytes = std::fs::read(path).unwrap_or_default();
    let text = String::from_utf8_lossy(&bytes);
    let lines: Vec<&str> = text.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let error = lines.iter().rposition(|line| line.starts_with("error:"));
    let first = error.unwrap_or(lines.len().saturating_sub(QUOTED_LINES));
    lines.into_iter().skip(first).take(QUOTED_LINES).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::setting::Value;

    fn runner(ranks: u64, launcher: &str) -> TalcumRunner {
        let launcher = Launcher::from_text(launcher);
        let resources = Resources { ranks, launcher, at_a_time: 1 };
        TalcumRunner { program: PathBuf::from("talcum"), resources }
    }

    #[test]
    fn several_ranks_need_a_launcher_or_are_threads() {
        let value = Value::from_number(4.0);
        let settings = [Setting { key: "cohesion.bond_number".to_owned(), value, line: 1 }];
        let line = |ranks, launcher| {
            let runner = runner(ranks, launcher);
            runner.command_line(Path::new("bed.toml"), &settings, Path::new("out")).join(" ")
        };
        let run = "talcum run bed.toml --output out --resume --set cohesion.bond_number=4.0";
        assert_eq!(line(1, "mpirun -n {ranks}"), run);
        assert_eq!(line(3, "mpirun -n {ranks}"), format!("mpirun -n 3 {run}"));
        let by_threads = run.replace("--resume", "--resume --threads 3");
        assert_eq!(line(3, "threads"), by_threads);
    }

    #[test]
    fn the_error_is_quoted_rather_than_what_follows_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("error.log");
        std::fs::write(&path, "[INFO ] a\nerror: too fast\nkey: x\n--------\nmpirun\n").unwrap();
        assert_eq!(last_lines(&path), "error: too fast\nkey: x\n--------\nmpirun");
        std::fs::write(&path, "1\n2\n3\n4\n5\n6\n").unwrap();
        assert_eq!(last_lines(&path), "2\n3\n4\n5\n6");
        assert_eq!(last_lines(&folder.path().join("none")), "");
    }
}
