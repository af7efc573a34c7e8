//! Cases that are read once and known to all ranks.

use std::path::Path;
use talcum_engine::parallel::{Communicator, agree};
use talcum_runs::case::Case;
use talcum_runs::input::read_text;

/// Reads a case: rank 0 reads the file, and all ranks use its text, so that there is one file system, one version, and
/// one message.
pub(super) fn read_case(
    path: &Path,
    overrides: &[String],
    ranks: &dyn Communicator,
) -> anyhow::Result<Case> {
    let name = path.display();
    let text = if ranks.is_root() {
        read_text(path).map_err(|error| error.to_string())
    } else {
        Ok(String::new())
    };
    let mut bytes = agree(text, ranks)?.into_bytes();
    ranks.broadcast_from_root(&mut bytes);
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let folder = path.parent().unwrap_or(Path::new(""));
    Ok(agree(Case::from_text(&text, &name.to_string(), folder, overrides), ranks)?)
}
