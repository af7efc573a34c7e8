//! Walls that are meshes: their keys, their files, and the checksums of these files in the text of the case.

use super::mesh_file;
use super::surfaces::{direction, read_side, vector};
use crate::input::Section;
use nalgebra::{Matrix3, Vector3};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use talcum_engine::domain::{Mesh, Side, Surface, join_vertices, rotation};
use toml_edit::{DocumentMut, value};

/// Corners that are nearer to each other than this part of the mesh's size are the same: files of STL hold numbers of
/// seven digits.
const SAME_CORNER: f64 = 1.0e-6;

/// The file of a mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshFile {
    /// Where it is.
    pub path: PathBuf,
    /// Its BLAKE3 hash.
    pub checksum: String,
    /// Place of its wall among the walls that the case gives.
    wall: usize,
}

impl MeshFile {
    /// The name of its copy in a folder of results.
    pub fn name_in_results(&self) -> String {
        name_in_results(&self.path, &self.checksum)
    }
}

/// `mesh-`, the first digits of the checksum, and the ending: a name that no other file has.
fn name_in_results(path: &Path, checksum: &str) -> String {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    format!("mesh-{:.*}.{ending}", DIGITS, checksum)
}

/// Digits of the checksum in the name of a copy.
const DIGITS: usize = 16;

/// Whether a file in a folder of results is the copy of a mesh.
pub(crate) fn is_mesh_in_results(name: &str) -> bool {
    let middle = name.strip_prefix("mesh-").and_then(|rest| rest.split_once('.'));
    middle.is_some_and(|(digits, ending)| {
        let is_hex = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        digits.len() == DIGITS && digits.bytes().all(is_hex) && ["stl", "obj"].contains(&ending)
    })
}

/// The mesh of a table, and its file. `wall` is the place of the wall among those that the case gives.
pub(super) fn read_mesh(
    section: &Section<'_>,
    folder: &Path,
    wall: usize,
) -> Option<(Surface, MeshFile)> {
    let named = folder.join(section.text("file")?);
    let checksum = if section.has("checksum") { Some(section.text("checksum")?) } else { None };
    let kept = checksum.as_ref().map(|it| folder.join(name_in_results(&named, it)));
    let path = kept.filter(|kept| kept.exists() && !named.exists()).unwrap_or(named);
    let failed = |reason: String| section.fail("file", reason);
    let (corners, found) = mesh_file::read(&path).map_err(failed).ok()?;
    if checksum.is_some_and(|checksum| checksum != found) {
        let message = format!(
            "the file has changed: its checksum is {found}. A run continues with the mesh with which it began, of which \
             its results hold a copy"
        );
        section.fail("checksum", message);
        return None;
    }
    let feature_angle = section.number("feature_angle")?.to_radians();
    let mesh = mesh_of(&placed(section, corners)?, feature_angle).map_err(failed).ok()?;
    if read_side(section) != Side::Both && !mesh.is_closed() {
        let message = "needs a closed mesh whose triangles are all the same way round: see `talcum check` without this key";
        section.fail("bed", message);
        return None;
    }
    Some((Surface::Mesh(Arc::new(mesh)), MeshFile { path, checksum: found, wall }))
}

/// Corners that are scaled, turned and shifted.
fn placed(section: &Section<'_>, corners: Vec<Vector3<f64>>) -> Option<Vec<Vector3<f64>>> {
    let scale = section.number("scale")?;
    let shift = if section.has("shift") { vector(section, "shift")? } else { Vector3::zeros() };
    let turn = if section.has("axis") {
        rotation(&direction(section, "axis")?, section.number("angle")?.to_radians())
    } else {
        Matrix3::identity()
    };
    Some(corners.into_iter().map(|corner| turn * (corner * scale) + shift).collect())
}

fn mesh_of(corners: &[Vector3<f64>], feature_angle: f64) -> Result<Mesh, String> {
    let reach = |corner: &Vector3<f64>| (corner - corners[0]).norm();
    let size = corners.iter().map(reach).fold(0.0, f64::max);
    let (vertices, numbers) = join_vertices(corners, SAME_CORNER * size);
    Mesh::new(vertices, numbers.as_chunks().0, feature_angle).map_err(|error| error.to_string())
}

/// The text of a case with the checksums of its meshes.
pub(super) fn with_checksums(text: String, files: &[MeshFile]) -> String {
    let Ok(mut document) = text.parse::<DocumentMut>() else { return text };
    for MeshFile { checksum, wall, .. } in files {
        let mesh = &mut document["wall"][*wall]["mesh"];
        mesh["checksum"] = value(checksum);
        if let Some(table) = mesh.as_inline_table_mut() {
            table.fmt();
        }
    }
    document.to_string()
}
