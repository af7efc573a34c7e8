//! The states with which the runs of a study begin, if they are the ends of the runs of another study.

use crate::study::setting::{SEED, Setting, Value};
use std::path::{Path, PathBuf};

/// `[start]` of a study file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Start {
    /// The file of the other study.
    pub(crate) study: PathBuf,
    /// The folder of its results.
    pub(crate) results: PathBuf,
    /// The line of the study file, from 1.
    pub(crate) line: usize,
}

/// The end of a run of another study.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StartState {
    /// The name of the run.
    pub(crate) name: String,
    /// Identity of its results.
    pub(crate) identity: String,
    /// The seed of its bed, if that study has seeds.
    pub(crate) seed: Option<Value>,
    /// Its folder.
    pub(crate) folder: PathBuf,
    /// Its last checkpoint and the digest of this checkpoint, if the run is complete.
    pub(crate) end: Option<(PathBuf, String)>,
}

impl StartState {
    /// Its last checkpoint.
    ///
    /// # Errors
    /// If the run has not come to its end.
    pub(crate) fn checkpoint(&self) -> Result<PathBuf, String> {
        let end = self.end.as_ref().map(|(checkpoint, _)| checkpoint.clone());
        end.ok_or_else(|| {
            format!("{} is not complete: run that study first", self.folder.display())
        })
    }

    /// Its name with its digest, for the titles of runs that begin with it.
    pub(crate) fn describe(&self) -> String {
        let digest = self.end.as_ref().map(|(_, digest)| digest.as_str()).unwrap_or_default();
        format!("begins with the end of {}, digest {digest}", self.name)
    }

    /// Whether a run with these settings begins with it.
    pub(crate) fn belongs_to(&self, settings: &[Setting]) -> bool {
        let given = settings.iter().find(|setting| setting.key == SEED);
        match (&self.seed, given) {
            (Some(seed), Some(given)) => seed.same_as(&given.value),
            _ => true,
        }
    }
}

/// The path of a file relative to a folder, so that both may be moved together.
pub(crate) fn relative(file: &Path, folder: &Path) -> PathBuf {
    let whole = |path: &Path| std::fs::canonicalize(path).or_else(|_| std::path::absolute(path));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (Ok(file), Ok(folder)) = (whole(file), whole(folder)) else { return file.to_owned() };
    let shared = file.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| Path::new("..").as_os_str());
    up.chain(file.components().skip(shared).map(|part| part.as_os_str())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_relative_to_where_the_case_lies() {
        let root = tempfile::tempdir().unwrap();
        for folder in ["cases/moon", "results/bed"] {
            std::fs::create_dir_all(root.path().join(folder)).unwrap();
        }
        let file = root.path().join("results/bed/checkpoint.h5");
        std::fs::write(&file, "").unwrap();
        let seen = |folder: &str| relative(&file, &root.path().join(folder));
        assert_eq!(seen("cases/moon"), Path::new("../../results/bed/checkpoint.h5"));
        assert_eq!(seen("results/bed"), Path::new("checkpoint.h5"));
    }
}
