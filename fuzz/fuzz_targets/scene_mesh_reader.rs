//! Mesh files: refused, or a sound mesh that can be used as a shape.
//!
//! The first byte of an input says how it is read: `o` an OBJ file, `s` an STL file, `d` a COLLADA file, `g` a GLB file, `j` the
//! JSON of a GLB file of one triangle, anything else corners and triangles.
#![no_main]

use std::path::PathBuf;

use arbitrary::{Arbitrary, Unstructured};
use darrt_fuzz::text::text;
use darrt_geom::{Body, GeomError, Shape, TriangleMesh};
use libfuzzer_sys::fuzz_target;
use nalgebra::{Point3, Vector3};

const COLLADA: &[&str] = &[include_str!("../seeds/scene_mesh_reader/square_dae")];

/// The bytes, or a file with edits.
fn edited(bytes: &[u8], files: &[&str]) -> Vec<u8> {
    // The seed begins with the byte that says how it is read.
    text(bytes, files).trim_start_matches(['d', 'j']).as_bytes().to_vec()
}

/// The JSON of a GLB file.
const GLTF: &[&str] = &[include_str!("../seeds/scene_mesh_reader/triangle_gltf")];

/// A GLB file with this JSON and the numbers of one triangle, its lengths as they should be.
fn with_header(json: &[u8]) -> Vec<u8> {
    let numbers = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes());
    let numbers: Vec<u8> = numbers.chain([0, 0, 1, 0, 2, 0, 0, 0]).collect();
    let word = |value: usize| (value as u32).to_le_bytes();
    let padded = json.len().next_multiple_of(4);
    let spaces = vec![b' '; padded - json.len()];
    let length = word(28 + padded + numbers.len());
    let json_chunk = [&word(padded)[..], b"JSON", json, &spaces].concat();
    [&b"glTF"[..], &word(2), &length, &json_chunk, &word(numbers.len()), b"BIN\0", &numbers].concat()
}

/// Corners, triangles.
type Soup = (Vec<[f64; 3]>, Vec<[u16; 3]>);

/// A file of this process, gone when dropped.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn read(ending: &str, bytes: &[u8]) -> Result<TriangleMesh, GeomError> {
    let file = Temporary(std::env::temp_dir().join(format!("darrt-fuzz-{}.{ending}", std::process::id())));
    std::fs::write(&file.0, bytes).expect("a writable folder for temporary files");
    TriangleMesh::from_file(&file.0, &Vector3::new(1.0, 0.5, -2.0))
}

fn assemble(bytes: &[u8]) -> Option<TriangleMesh> {
    let (corners, triangles) = Soup::arbitrary(&mut Unstructured::new(bytes)).ok()?;
    let corners: Vec<_> = corners.into_iter().map(Point3::from).collect();
    let triangles: Vec<_> = triangles.into_iter().map(|t| t.map(u32::from)).collect();
    TriangleMesh::new("soup", &corners, &triangles).ok()
}

fuzz_target!(|data: &[u8]| {
    let Some((kind, bytes)) = data.split_first() else { return };
    let mesh = match kind {
        b'o' => read("obj", bytes).ok(),
        b's' => read("stl", bytes).ok(),
        b'd' => read("dae", &edited(bytes, COLLADA)).ok(),
        b'g' => read("glb", bytes).ok(),
        b'j' => read("glb", &with_header(&edited(bytes, GLTF))).ok(),
        _ => assemble(bytes),
    };
    let Some(mesh) = mesh else { return };
    let count = mesh.vertices().len();
    assert!(!mesh.triangles().is_empty() && count <= 3 * mesh.triangles().len());
    assert!(mesh.triangles().iter().flatten().all(|&corner| (corner as usize) < count));
    assert!(mesh.vertices().iter().all(|p| p.coords.iter().all(|x| x.abs() <= darrt_geom::MAXIMUM_LENGTH)));
    let _ = Shape::convex_hull("hull", mesh.vertices());
    Body::single("mesh", Shape::Mesh(mesh.into())).expect("a mesh is a shape");
});
