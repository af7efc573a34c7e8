//! Answers to requests. No part of a request names a file.

use super::address::is_own_host;
use super::documents;
use crate::command_line::watch::run::WatchedRun;
use serde_json::Value;

const PAGE: &str = include_str!("page.html");

/// An answer to a request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Answer {
    pub(super) status: u16,
    pub(super) kind: &'static str,
    pub(super) body: String,
}

impl Answer {
    pub(super) fn text(status: u16, body: &str) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", body: format!("{body}\n") }
    }

    fn json(document: &Value) -> Self {
        Self { status: 200, kind: "application/json", body: document.to_string() }
    }
}

/// A run, and the columns that are displayed.
pub(super) struct Site {
    pub(super) run: WatchedRun,
    pub(super) columns: Vec<String>,
}

impl Site {
    /// Answers a request for a path, made by a method for a host.
    pub(super) fn answer(&mut self, method: &str, path: &str, host: Option<&str>) -> Answer {
        if !host.is_some_and(is_own_host) {
            return Answer::text(
                403,
                "this server goes by its address, its host's name, or localhost",
            );
        }
        if method != "GET" {
            return Answer::text(405, "only GET: nothing can be changed here");
        }
        let path = path.split(['?', '#']).next().unwrap_or_default();
        match path {
            "/" => {
                let kind = "text/html; charset=utf-8";
                Answer { status: 200, kind, body: PAGE.to_owned() }
            }
            "/state.json" => {
                self.run.renew();
                Answer::json(&documents::state(&self.run))
            }
            "/series.json" => Answer::json(&documents::series(&self.run, &self.columns)),
            "/profile.json" => Answer::json(&documents::profile(&mut self.run)),
            "/bed.json" => Answer::json(&documents::bed(&mut self.run)),
            _ => Answer::text(
                404,
                "there is /, /state.json, /series.json, /profile.json and /bed.json",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const ROWS: &str = "time [s],bed_top [m]\n0,2\n1,3\n2,4";

    fn status(site: &mut Site, method: &str, path: &str, host: &str) -> u16 {
        site.answer(method, path, Some(host)).status
    }

    fn document(site: &mut Site, path: &str) -> Value {
        let answer = site.answer("GET", path, Some("localhost:8017"));
        assert_eq!((answer.status, answer.kind), (200, "application/json"));
        serde_json::from_str(&answer.body).unwrap()
    }

    #[test]
    fn only_known_paths_are_answered_and_only_to_get_for_our_own_name() {
        let folder = tempfile::tempdir().unwrap();
        let run = WatchedRun::open(folder.path()).unwrap();
        let mut site = Site { run, columns: Vec::new() };
        let here = "127.0.0.1:8017";
        for path in ["/", "/state.json", "/series.json?again", "/profile.json", "/bed.json"] {
            assert_eq!(status(&mut site, "GET", path, here), 200, "{path}");
        }
        for path in ["/case.toml", "/../etc/passwd", "//", "", "*", "/state.json/"] {
            assert_eq!(status(&mut site, "GET", path, here), 404, "{path}");
        }
        for method in ["POST", "HEAD", "DELETE", "get"] {
            assert_eq!(status(&mut site, method, "/state.json", here), 405, "{method}");
        }
        assert_eq!(status(&mut site, "GET", "/state.json", "example.org:8017"), 403);
        assert_eq!(site.answer("GET", "/", None).status, 403);
    }

    #[test]
    fn an_empty_folder_waits_and_a_growing_file_is_followed() {
        let folder = tempfile::tempdir().unwrap();
        let run = WatchedRun::open(folder.path()).unwrap();
        let mut site = Site { run, columns: Vec::new() };
        let state = document(&mut site, "/state.json");
        assert_eq!((&state["state"], &state["time"]), (&"waiting".into(), &Value::Null));
        assert_eq!(document(&mut site, "/series.json"), Value::Null);
        fs::write(folder.path().join("series.csv"), ROWS).unwrap();
        let state = document(&mut site, "/state.json");
        assert_eq!((&state["state"], &state["time"]), (&"stopped".into(), &1.0.into()));
        let series = document(&mut site, "/series.json");
        assert_eq!(series["curves"][0]["values"], serde_json::json!([2.0, 3.0]));
        assert_eq!(
            (&series["chosen"][0], &series["version"]),
            (&"bed_top".into(), &state["versions"]["series"])
        );
        // The last line is finished, and another begun; a reading requires a pause of some microseconds.
        std::thread::sleep(std::time::Duration::from_millis(20));
        fs::write(folder.path().join("series.csv"), format!("{ROWS}.5\n3,")).unwrap();
        assert_eq!(document(&mut site, "/state.json")["time"], 2.0);
        let series = document(&mut site, "/series.json");
        assert_eq!(series["curves"][0]["values"], serde_json::json!([2.0, 3.0, 4.5]));
    }
}
