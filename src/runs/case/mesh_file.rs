//! Triangles from files of STL and OBJ.

use nalgebra::Vector3;
use std::ffi::OsStr;
use std::io::Cursor;
use std::path::Path;

/// Largest number of triangles in a file: each takes about 400 bytes in the memory of each rank.
const MOST_FACETS: usize = 5_000_000;
/// Bytes of a binary file of STL before its triangles, and of each triangle.
const STL_BYTES: [usize; 2] = [84, 50];

/// The corners of the triangles in a file, three for each, and the BLAKE3 hash of the file.
///
/// # Errors
/// Why the file holds no mesh.
pub(super) fn read(file: &Path) -> Result<(Vec<Vector3<f64>>, String), String> {
    let extension = file.extension().and_then(OsStr::to_str).map(str::to_lowercase);
    let read = match extension.as_deref() {
        Some("stl") => read_stl,
        Some("obj") => read_obj,
        _ => return Err("must end in .stl or .obj".to_owned()),
    };
    let unreadable = |error: std::io::Error| format!("cannot be read: {error}");
    // A named pipe would be waited for.
    if !std::fs::metadata(file).map_err(unreadable)?.is_file() {
        return Err("is not a regular file".to_owned());
    }
    let bytes = std::fs::read(file).map_err(unreadable)?;
    let checksum = blake3::hash(&bytes).to_hex().to_string();
    let corners = read(bytes)?;
    if let Some(number) = corners.iter().position(|corner| corner.iter().any(|x| !x.is_finite())) {
        return Err(format!("triangle {}: a coordinate is not a finite number", number / 3 + 1));
    }
    Ok((corners, checksum))
}

/// Requires that a number of triangles fits into memory.
fn require_few(facets: usize) -> Result<(), String> {
    if facets > MOST_FACETS {
        let gigabytes = facets as f64 * 4.0e-7;
        return Err(format!(
            "holds {facets} triangles, which would take about {gigabytes:.1} GB on each rank: must be at most {MOST_FACETS}; \
             make the mesh coarser"
        ));
    }
    Ok(())
}

fn read_stl(mut bytes: Vec<u8>) -> Result<Vec<Vector3<f64>>, String> {
    let [head, triangle] = STL_BYTES;
    if let Some(count) = bytes.get(80..head) {
        let count = count.iter().rev().fold(0_usize, |count, &byte| count << 8 | usize::from(byte));
        if bytes.len() == head + triangle * count {
            require_few(count)?;
            // The free text of some binary files begins with the word that marks files of text.
            bytes[..5].fill(b' ');
        }
    }
    let mut reader = Cursor::new(bytes);
    let failed = |error: std::io::Error| format!("is not a file of STL: {error}");
    let triangles = stl_io::create_stl_reader(&mut reader).map_err(failed)?;
    let mut corners = Vec::new();
    for triangle in triangles {
        let vertices = triangle.map_err(failed)?.vertices;
        corners.extend(vertices.map(|vertex| Vector3::from(vertex.0).map(f64::from)));
        require_few(corners.len() / 3)?;
    }
    Ok(corners)
}

fn read_obj(bytes: Vec<u8>) -> Result<Vec<Vector3<f64>>, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials are of no use here.
    let without_materials = |_: &Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut Cursor::new(bytes), &options, without_materials)
        .map_err(|error| format!("is not a file of OBJ: {error}"))?;
    let mut corners = Vec::new();
    for mesh in models.iter().map(|model| &model.mesh) {
        let (points, _) = mesh.positions.as_chunks::<3>();
        let of_mesh = mesh.indices.iter().map(|&index| Vector3::from(points[index as usize]));
        corners.extend(of_mesh);
        require_few(corners.len() / 3)?;
    }
    Ok(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f32; 3]; 3] = [[0.0, 0.0, 0.5], [1.5, 0.0, 0.0], [0.0, 2.0, -1.0]];

    /// A binary file of one triangle whose free text begins with these bytes.
    fn binary(text: &[u8]) -> Vec<u8> {
        let mut bytes = vec![0; 84];
        bytes[..text.len()].copy_from_slice(text);
        bytes[80] = 1;
        bytes.extend([0; 12]);
        bytes.extend(CORNERS.iter().flatten().flat_map(|number| number.to_le_bytes()));
        bytes.extend([0; 2]);
        bytes
    }

    fn corners() -> Vec<Vector3<f64>> {
        CORNERS.map(|corner| Vector3::from(corner).map(f64::from)).to_vec()
    }

    #[test]
    fn binary_files_are_read_whatever_their_text() {
        for text in [&b"made by hand"[..], b"solid thing", b""] {
            assert_eq!(read_stl(binary(text)), Ok(corners()));
        }
        let mut short = binary(b"");
        short.truncate(120);
        assert!(read_stl(short).is_err());
    }

    #[test]
    fn files_of_text_give_the_same_corners() {
        let [a, b, c] = CORNERS.map(|[x, y, z]| format!("vertex {x} {y} {z}\n"));
        let stl = format!(
            "solid one\nfacet normal 0 0 0\nouter loop\n{a}{b}{c}endloop\nendfacet\nendsolid one\n"
        );
        assert_eq!(read_stl(stl.into_bytes()), Ok(corners()));
        let [a, b, c] = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n"));
        assert_eq!(read_obj(format!("{a}{b}{c}f 1 2 3\n").into_bytes()), Ok(corners()));
        // A quadrilateral gives two triangles.
        let square = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n".to_vec();
        assert_eq!(read_obj(square).map(|corners| corners.len()), Ok(6));
    }

    #[test]
    fn too_many_triangles_are_refused_before_they_are_read() {
        let error = require_few(10_000_000).unwrap_err();
        assert!(error.contains("4.0 GB") && error.contains("5000000"), "{error}");
        assert_eq!(require_few(MOST_FACETS), Ok(()));
    }
}
