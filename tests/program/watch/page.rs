//! `talcum watch --serve`: a read-only page and its documents over HTTP, only for this machine, of a run in progress.

use super::made;
use crate::analyse::made::CASE;
use crate::launch::{Running, signal, smoke, start, talcum};
use bytemuck::Zeroable;
use std::fs;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use talcum::parallel::ParticleRecord;

/// A server that runs.
pub(super) struct Served {
    pub(super) program: Running,
    /// `127.0.0.1:40123`.
    pub(super) address: String,
}

fn serve(folder: &Path) -> Served {
    let folder = folder.display().to_string();
    served_by(start(0, &["watch", &folder, "--serve", "0"]))
}

/// A server that was started, as soon as it says where it is.
pub(super) fn served_by(mut program: Running) -> Served {
    let line = program.first_line();
    let address = line.strip_prefix("http://").and_then(|rest| rest.split('/').next());
    Served { program, address: address.unwrap_or_else(|| panic!("{line}")).to_owned() }
}

impl Served {
    /// Status, head and body of the answer to a request.
    fn ask(&self, method: &str, path: &str, host: &str) -> (u16, String, String) {
        let mut stream = TcpStream::connect(&self.address).unwrap();
        let request =
            format!("{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n");
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        let (head, body) = answer.split_once("\r\n\r\n").unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        (status, head.to_owned(), body.to_owned())
    }

    fn document(&self, path: &str) -> serde_json::Value {
        let (status, head, body) = self.ask("GET", path, &self.address);
        assert!(status == 200 && head.contains("application/json"), "{head}");
        serde_json::from_str(&body).unwrap_or_else(|error| panic!("{error}: {body}"))
    }

    fn status(&self, method: &str, path: &str, host: &str) -> u16 {
        self.ask(method, path, host).0
    }
}

fn particle(id: u64, position: [f64; 3]) -> ParticleRecord {
    ParticleRecord { id, position, velocity: [0.0, 3.0, -4.0], radius: 0.5, ..Zeroable::zeroed() }
}

#[test]
fn the_page_and_each_document_are_served() {
    let made = made(20);
    made.profiles(&[0.0, 1.0, 2.0], |z, time| if z < 40.0 { 0.5 } else { 0.1 * time });
    made.snapshots(&[
        (0.0, vec![particle(0, [0.0; 3])]),
        (5.0, vec![particle(0, [1.0, 2.0, 3.0]), particle(1, [4.0, 1.0, 7.0])]),
    ]);
    let served = serve(made.path());
    assert!(served.address.starts_with("127.0.0.1:"), "{}", served.address);
    let (status, head, page) = served.ask("GET", "/", &served.address);
    assert!(status == 200 && head.contains("text/html") && page.contains("<canvas id=\"profile\""));
    assert!(head.contains("default-src 'none'") && head.contains("nosniff"), "{head}");
    let state = served.document("/state.json");
    assert_eq!((&state["title"], &state["part_done"]), (&"Made by hand".into(), &0.02.into()));
    let series = served.document("/series.json");
    assert_eq!(series["chosen"][1], "bed_top");
    let top = series["curves"].as_array().unwrap().iter().find(|curve| curve["name"] == "bed_top");
    assert_eq!(top.unwrap()["values"].as_array().unwrap().len(), 21);
    let profile = served.document("/profile.json");
    assert_eq!(profile["times"], serde_json::json!([0.0, 1.0, 2.0]));
    let row = profile["solids_fraction"][2].as_array().unwrap();
    assert_eq!((row.len(), &row[0], &row[80]), (81, &0.5.into(), &0.2.into()));
    let bed = served.document("/bed.json");
    assert_eq!(
        (&bed["time"], &bed["count"], &bed["box"][2]),
        (&5.0.into(), &2.into(), &120.0.into())
    );
    // From the back to the front: the second particle is nearer to the eye.
    assert_eq!(
        (&bed["x"], &bed["speed"]),
        (&serde_json::json!([1.0, 4.0]), &serde_json::json!([5.0, 5.0]))
    );
}

#[test]
fn a_run_without_profiles_and_particles_is_served_too() {
    let made = made(3);
    let served = serve(made.path());
    let state = served.document("/state.json");
    assert_eq!(
        (&state["versions"]["profile"], &state["versions"]["bed"]),
        (&().into(), &().into())
    );
    assert!(served.document("/profile.json").is_null() && served.document("/bed.json").is_null());
    assert!(!served.document("/series.json").is_null());
}

#[test]
fn without_snapshots_the_newest_checkpoint_shows_the_bed() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("results");
    let shown = output.display().to_string();
    let ended = talcum(0, &["run", &smoke("si"), "--output", &shown, "--set", "time.end=1e-4"]);
    let _ = ended.digest();
    let served = serve(&output);
    let snapshot = served.document("/bed.json");
    fs::remove_file(output.join("particles.vtkhdf")).unwrap();
    // A reading asks for a rest that is twenty times as long.
    std::thread::sleep(std::time::Duration::from_millis(500));
    let state = served.document("/state.json");
    let checkpoint = served.document("/bed.json");
    assert_eq!(checkpoint["version"], state["versions"]["bed"]);
    assert_ne!(checkpoint["version"], snapshot["version"]);
    assert_eq!((&checkpoint["count"], &snapshot["count"]), (&150.into(), &150.into()));
    // The end of the run has a checkpoint, and the interval of snapshots is longer than the run.
    assert!(checkpoint["time"].as_f64() > snapshot["time"].as_f64());
}

#[test]
fn nothing_but_get_of_known_paths_under_the_own_name_is_answered() {
    let made = made(3);
    fs::write(made.path().join("secret.json"), "{}").unwrap();
    let served = serve(made.path());
    let own = served.address.as_str();
    assert_eq!(served.status("GET", "/state.json", own), 200);
    for path in [
        "/secret.json",
        "/case.toml",
        "/../case.toml",
        "/%2e%2e/case.toml",
        "//etc/passwd",
        "/state",
    ] {
        let (status, _, body) = served.ask("GET", path, own);
        assert_eq!(status, 404, "{path}");
        assert!(!body.contains("title"), "{path}: {body}");
    }
    for method in ["POST", "PUT", "DELETE", "OPTIONS"] {
        let (status, head, _) = served.ask(method, "/state.json", own);
        assert!(status == 405 && head.contains("Allow: GET"), "{method}: {head}");
    }
    // Another page's name that leads here.
    assert_eq!(served.status("GET", "/state.json", "page.example.org"), 403);
    assert_eq!(served.status("GET", "/state.json", "localhost"), 200);
}

#[test]
fn a_growing_run_is_followed_to_its_end() {
    let made = made(3);
    let served = serve(made.path());
    let last = |served: &Served| served.document("/state.json")["time"].as_f64().unwrap();
    assert_eq!(last(&served), 3.0);
    let path = made.path().join("series.csv");
    let text = fs::read_to_string(&path).unwrap();
    let row = text.lines().last().unwrap().replacen('3', "4", 1);
    let (begun, rest) = row.split_at(row.len() / 2);
    let append = |part: &str| {
        let mut file = fs::File::options().append(true).open(&path).unwrap();
        file.write_all(part.as_bytes()).unwrap();
        // A reading asks for a rest that is twenty times as long.
        std::thread::sleep(std::time::Duration::from_millis(200));
    };
    append(begun);
    assert_eq!(last(&served), 3.0);
    append(&format!("{rest}\n"));
    assert_eq!(last(&served), 4.0);
    let version = served.document("/state.json")["versions"]["series"].clone();
    assert_eq!(served.document("/series.json")["version"], version);
    fs::write(made.path().join("complete"), "digest 0123456789abcdef\n").unwrap();
    let state = served.document("/state.json");
    assert_eq!(
        (&state["state"], &state["state_text"]),
        (&"complete".into(), &"complete, digest 0123456789abcdef".into())
    );
    // The run starts again: the folder is emptied, then a case stands in it.
    fs::remove_file(made.path().join("complete")).unwrap();
    fs::remove_file(&path).unwrap();
    fs::write(made.path().join("case.toml"), CASE).unwrap();
    assert!(served.document("/state.json")["time"].is_null());
    assert!(served.document("/series.json").is_null());
}

#[test]
fn a_signal_ends_the_server_and_a_port_in_use_is_an_error() {
    let made = made(3);
    let served = serve(made.path());
    signal("INT", served.program.process());
    let ended = served.program.wait();
    assert_eq!((ended.code(), ended.errors.as_str()), (Some(0), ""));
    let holder = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = holder.local_addr().unwrap().port().to_string();
    let folder = made.path().display().to_string();
    let ended = talcum(0, &["watch", &folder, "--serve", &port]);
    assert_eq!(ended.code(), Some(1));
    let expected = format!("--serve 127.0.0.1:{port}: another program has this port");
    assert!(ended.error().contains(&expected), "{}", ended.errors);
    // The other order of words would take the folder for an address.
    let ended = talcum(0, &["watch", "--serve", &folder]);
    assert_eq!(ended.code(), Some(2));
    assert!(ended.errors.contains("the folder stands before --serve"), "{}", ended.errors);
}

#[test]
fn an_address_of_the_network_is_served_with_a_warning() {
    let made = made(3);
    let folder = made.path().display().to_string();
    let mut program = start(0, &["watch", &folder, "--serve", "0.0.0.0:0"]);
    assert!(program.first_line().starts_with("http://0.0.0.0:"));
    signal("TERM", program.process());
    let ended = program.wait();
    assert_eq!(ended.code(), Some(0), "{ended:?}");
    assert!(ended.errors.contains("anybody who can reach"), "{}", ended.errors);
}
