use super::read::{obj, stl};
use super::*;
use crate::bounded_file::FileError;
use proptest::prelude::*;

const ASCII: &str = "solid one\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                     endloop\nendfacet\nendsolid one\n";

fn binary(header: &[u8]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, 0);
    bytes.extend(1_u32.to_le_bytes());
    for value in [0.0_f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend([0, 0]);
    bytes
}

#[test]
fn ascii_and_binary_stl_agree_even_under_a_lying_header() {
    let ascii = stl("a", ASCII.as_bytes()).unwrap();
    assert_eq!(ascii.triangles.len(), 1);
    for header in [&b"made by hand"[..], b"solid but binary"] {
        let soup = stl("b", &binary(header)).unwrap();
        assert_eq!(soup.vertices, ascii.vertices);
    }
}

#[test]
fn obj_polygons_become_fans_and_extras_are_ignored() {
    let text = "mtllib nowhere.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0 # corner\nvt 0 0\nusemtl x\n\
                o part\nf 1/1 2/1 3/1 4/1\ng other\nf -4 -3 -2\n";
    let soup = obj("o", text.as_bytes()).unwrap();
    assert_eq!(soup.triangles.len(), 3);
}

#[test]
fn malformed_files_are_errors_that_name_the_file() {
    let truncated = &binary(b"x")[..100];
    let cases: [Result<read::Soup, GeomError>; 7] = [
        stl("bad.stl", truncated),
        stl("bad.stl", b""),
        stl("bad.stl", b"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 zero\n"),
        stl("bad.stl", b"solid x\n"),
        obj("bad.obj", b"v 0 0\nf 1 2 3\n"),
        obj("bad.obj", b"v 0 0 0\nf 1 2 9\n"),
        obj("bad.obj", b"\xff\xfe"),
    ];
    for case in cases {
        let message = case.unwrap_err().to_string();
        assert!(message.contains("bad."), "{message}");
    }
}

#[test]
fn files_are_read_scaled_and_checked() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.STL");
    std::fs::write(&path, ASCII).unwrap();
    let mesh = TriangleMesh::from_file(&path, &Vector3::new(2.0, 1.0, 1.0)).unwrap();
    assert_eq!(mesh.vertices().iter().map(|p| p.x).fold(0.0, f64::max), 2.0);
    assert!(TriangleMesh::from_file(&path, &Vector3::zeros()).is_err());
    let refused = |name: &str| TriangleMesh::from_file(&folder.path().join(name), &Vector3::repeat(1.0)).unwrap_err();
    assert!(matches!(refused("a.dae"), GeomError::UnknownFormat { .. }));
    assert!(matches!(refused("none.obj"), GeomError::File(FileError::Unreadable { .. })));
    std::fs::create_dir(folder.path().join("folder.obj")).unwrap();
    assert!(matches!(refused("folder.obj"), GeomError::File(FileError::NotAFile { .. })));
    std::fs::File::create(folder.path().join("large.stl")).unwrap().set_len(MAXIMUM_FILE_BYTES + 1).unwrap();
    assert!(matches!(refused("large.stl"), GeomError::File(FileError::TooLarge { .. })));
}

#[test]
fn content_is_checked() {
    let square = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 9.0]].map(Point3::from);
    let mesh = TriangleMesh::new("m", &square, &[[0, 1, 2], [0, 0, 1]]).unwrap();
    assert_eq!((mesh.vertices().len(), mesh.triangles().len()), (3, 1));
    assert!(matches!(TriangleMesh::new("m", &square, &[[0, 1, 7]]), Err(GeomError::UnknownVertex { vertex: 7, .. })));
    assert!(matches!(TriangleMesh::new("m", &square, &[[0, 0, 1]]), Err(GeomError::Count { .. })));
    assert!(matches!(TriangleMesh::new("m", &square, &[]), Err(GeomError::Count { .. })));
    let broken = [Point3::new(f64::NAN, 0.0, 0.0), square[1], square[2]];
    assert!(matches!(TriangleMesh::new("m", &broken, &[[0, 1, 2]]), Err(GeomError::NotFinite { .. })));
}

proptest! {
    #[test]
    fn no_bytes_make_a_reader_panic(
        noise in prop::collection::vec(any::<u8>(), 0..300), cut in 0_usize..140, at in 0_usize..134, flip in any::<u8>(),
    ) {
        let mut near = binary(b"header");
        near[at] ^= flip;
        near.truncate(cut);
        for bytes in [&noise, &near] {
            let _ = stl("noise", bytes);
            let _ = obj("noise", bytes);
        }
    }

    #[test]
    fn no_text_makes_a_reader_panic(
        lines in prop::collection::vec("(v|f|o|g|l|vt|solid|facet normal|vertex)( (-?[0-9]{1,3}(\\.[0-9])?(/[0-9]?)?|nan|inf)){0,5}", 0..20),
    ) {
        let text = lines.join("\n");
        for soup in [stl("text", text.as_bytes()), obj("text", text.as_bytes())].into_iter().flatten() {
            let _ = TriangleMesh::new("text", &soup.vertices, &soup.triangles);
        }
    }
}

#[test]
fn every_solid_of_a_text_stl_is_read_however_it_is_spelt() {
    let second = ASCII.replace("one", "the second one").replace("vertex 0 0 0", "vertex 0 0 5");
    for text in [
        format!("{ASCII}{second}"),
        format!("\u{feff}{ASCII}\n\n{}", second.to_uppercase()),
        format!("{}{second}", ASCII.replace("solid one", "solid").replace("endsolid", "end solid")),
    ] {
        let soup = stl("two", text.as_bytes()).unwrap();
        assert_eq!(soup.triangles.len(), 2, "{text}");
        assert_eq!(soup.vertices[3], Point3::new(0.0, 0.0, 5.0));
    }
    for (text, words) in [
        (format!("{ASCII}rubbish\n"), "line 10"),
        (ASCII.replace("endsolid one\n", ""), "no end"),
        (ASCII.replace("vertex 1 0 0\n", ""), "three vertices"),
        (ASCII.replace("outer loop", "outer lop"), "line 3"),
    ] {
        let message = stl("bad.stl", text.as_bytes()).unwrap_err().to_string();
        assert!(message.contains("bad.stl") && message.contains(words), "{message}");
    }
}

#[test]
fn a_binary_stl_is_as_long_as_it_says() {
    let mut more = binary(b"two");
    more.extend_from_within(84..);
    let message = stl("more.stl", &more).unwrap_err().to_string();
    assert!(message.contains("1 triangles, which take 134 bytes, and has 184"), "{message}");
}

proptest! {
    /// Held to another reader: both read the same triangles of what both can read.
    #[test]
    fn text_stl_is_read_as_others_read_it(corners in prop::collection::vec(prop::array::uniform9(-1e3_f32..1e3), 1..20)) {
        let facets = corners.iter().map(|[a, b, c, d, e, f, g, h, i]| {
            let corners = format!("vertex {a} {b} {c}\nvertex {d} {e} {f}\nvertex {g} {h} {i}");
            format!("facet normal 0 0 1\nouter loop\n{corners}\nendloop\nendfacet\n")
        });
        let text = format!("solid made\n{}endsolid made\n", facets.collect::<String>());
        let ours = stl("made", text.as_bytes()).unwrap();
        let mut cursor = std::io::Cursor::new(text.as_bytes());
        let theirs: Vec<_> = stl_io::create_stl_reader(&mut cursor).unwrap().map(Result::unwrap).collect();
        prop_assert_eq!(ours.triangles.len(), theirs.len());
        for (corner, theirs) in ours.vertices.iter().zip(theirs.iter().flat_map(|triangle| triangle.vertices)) {
            let theirs = Point3::from(theirs.0.map(f64::from));
            prop_assert!((corner - theirs).norm() < 1e-4);
        }
    }
}
