//! Mesh files: refused, or a sound mesh that can be used as a shape.
//!
//! The first byte of an input says how it is read: `o` an OBJ file, `s` an STL file, `d` a COLLADA file, `g` a GLB file, anything
//! else corners and triangles.
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
    text(bytes, files).trim_start_matches('d').as_bytes().to_vec()
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
