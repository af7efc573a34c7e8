//! Files for schedulers: what they name, and that bash reads any path in them as it is.

use super::fakes::{Desk, FakeChecker};
use crate::study::folder::StudyFolder;
use crate::study::session::Session;
use crate::study::templates::{tell_row, write_row, write_slurm};
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;

const GRID: &str = "seeds = 2\n[[axis]]\nkey = \"cohesion.bond_number\"\nvalues = [2, 4]\n[[axis]]\nkey = \"gas.superficial_velocity\"\nvalues = [0.1, 0.2]\n[run]\nat_a_time = 3\n";

#[test]
fn files_for_schedulers_name_every_task() {
    let desk = Desk::new(GRID);
    desk.with_session(|session| {
        let program = Path::new("talcum");
        let text = fs::read_to_string(write_slurm(session, program).unwrap()).unwrap();
        assert!(text.contains("#SBATCH --array=1-8%3\n"), "{text}");
        assert!(!text.contains("{tasks}") && !text.contains("{study}"), "{text}");
        let command = row_command(&write_row(session, program).unwrap());
        assert!(command.starts_with("talcum study /") && command.contains("{directory}"));
        let task = &session.plan.tasks[0];
        let folder = desk.path("out/tasks").join(&task.name);
        let values = fs::read_to_string(folder.join("value.json")).unwrap();
        assert!(values.contains("\"cohesion.bond_number\": 2,"), "{values}");
        assert!(!folder.join("done").exists());
        tell_row(session.folder.root(), task).unwrap();
        assert!(folder.join("done").exists());
    });
}

/// The command of the action in a workflow.
fn row_command(workflow: &Path) -> String {
    let workflow: toml::Table = fs::read_to_string(workflow).unwrap().parse().unwrap();
    workflow["action"][0]["command"].as_str().unwrap().to_owned()
}

/// Names of folders that end a word, a text or a comment, or make a shell execute what they hold.
const ODD: [&str; 5] = [
    "it's",
    "a \"b\"} {study}",
    "$(touch executed) `touch executed`",
    "a\ntouch executed\n#",
    "\u{1b}\\",
];

/// Makes a program that writes its arguments, one a line, and each line's end within one as `|`, into a file beside it.
fn make_echo(program: &Path) {
    let script = "#!/usr/bin/env bash\nfor word in \"$@\"; do echo \"${word//$'\\n'/|}\"; done >\"$(dirname \"$0\")/words\"\n";
    fs::write(program, script).unwrap();
    fs::set_permissions(program, fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn bash_reads_any_path_in_files_for_schedulers_as_it_is() {
    for name in ODD {
        let desk = Desk::new("");
        let folder = desk.path(name);
        fs::create_dir(&folder).unwrap();
        for file in ["bed.toml", "study.toml"] {
            fs::copy(desk.path(file), folder.join(file)).unwrap();
        }
        let program = folder.join("talcum");
        make_echo(&program);
        let study = crate::study::file::read(&folder.join("study.toml"));
        let (study, output) = (study.unwrap(), folder.join("out"));
        let place = StudyFolder::at(&output);
        let session = Session::new(&study, &place, Vec::new(), &FakeChecker).unwrap();
        let expected = |path: &Path| path.display().to_string().replace('\n', "|");
        let words_after = |script: &mut Command| {
            let finished = script.env("SLURM_ARRAY_TASK_ID", "1").env_remove("TALCUM");
            assert!(finished.current_dir(desk.path("")).status().unwrap().success(), "{name}");
            let words = fs::read_to_string(folder.join("words")).unwrap();
            fs::remove_file(folder.join("words")).unwrap();
            words.lines().map(str::to_owned).collect::<Vec<String>>()
        };
        let slurm = write_slurm(&session, &program).unwrap();
        let words = words_after(Command::new("bash").arg(slurm));
        assert_eq!(words[..4], ["study", &expected(&study.file), "--output", &expected(&output)]);
        let command = row_command(&write_row(&session, &program).unwrap());
        let words = words_after(Command::new("bash").args(["-c", &command]));
        assert_eq!(words[..4], ["study", &expected(&study.file), "--output", &expected(&output)]);
        assert!(!desk.path("executed").exists(), "{name}");
    }
}
