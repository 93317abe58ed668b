use super::dae::dae;
use super::glb::glb;
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
fn what_an_obj_file_says_is_read_or_refused() {
    let corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for text in [
        format!("\u{feff}{corners}f 1 2 3\n"),
        format!("\u{feff}{corners}f 1 2 3\n").replace('\n', "\r\n"),
        format!("{corners}f 1 2 \\\n 3\n"),
        format!("{corners}s off\nf 1 2 3 # a face"),
    ] {
        let soup = obj("good.obj", text.as_bytes()).unwrap();
        assert_eq!((soup.triangles.len(), soup.vertices[0]), (1, Point3::origin()), "{text}");
    }
    for (more, why) in [
        ("v 0,5 0 0\nf 1 2 3\n", "line 4: a vertex has three numbers"),
        ("f 1 2\n", "line 4: a face has at least three corners"),
        ("f 1 2 3\nV 0 0 1\n", "line 5: this is no line of the format"),
        ("f 1 2 3\nf 1 2 3 \\\n", "the last line ends in a backslash"),
        ("f 1 2 3\nsurf 0 1 0 1 1 2 3\n", "curved surfaces are not read"),
    ] {
        let message = obj("bad.obj", format!("{corners}{more}").as_bytes()).unwrap_err().to_string();
        assert!(message.contains("bad.obj") && message.contains(why), "{message}");
    }
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
    assert!(matches!(refused("a.ply"), GeomError::UnknownFormat { .. }));
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

/// A square in centimetres, once as two triangles and once as a polygon, shown by two nodes.
const COLLADA: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.01" name="cm"/><up_axis>Y_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="12">0 0 0  100 0 0  100 100 0  0 100 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X"/><param name="Y"/><param name="Z"/></accessor>
</technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="2"><input semantic="NORMAL" source="#s" offset="1"/><input semantic="VERTEX" source="#v" offset="0"/>
<p>0 0 1 0 2 0  0 0 2 0 3 0</p></triangles>
<polylist count="1"><input semantic="VERTEX" source="#v" offset="0"/><vcount>4</vcount><p>0 1 2 3</p></polylist>
<lines count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1</p></lines>
</mesh></geometry></library_geometries>
<library_nodes><node id="far"><translate>0 0 500</translate><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="scene">
<node><rotate>0 0 1 90</rotate><scale>2 1 1</scale><instance_geometry url="#g"/></node>
<node><instance_node url="#far"/></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>"##;

#[test]
fn collada_is_placed_by_its_nodes_in_metres() {
    let soup = dae("a.dae", COLLADA.as_bytes()).unwrap();
    assert_eq!(soup.triangles.len(), 8);
    let has = |x: f64, y: f64, z: f64| soup.vertices.iter().any(|p| (p - Point3::new(x, y, z)).norm() < 1e-12);
    // Scaled, then turned.
    assert!(has(0.0, 2.0, 0.0) && has(-1.0, 2.0, 0.0));
    assert!(has(1.0, 1.0, 5.0) && has(0.0, 0.0, 5.0));
}

#[test]
fn what_is_wrong_with_collada_is_told_with_its_line() {
    let broken = |from: &str, to: &str| {
        assert!(COLLADA.contains(from), "{from}");
        dae("bad.dae", COLLADA.replace(from, to).as_bytes()).unwrap_err().to_string()
    };
    for (from, to, line, told) in [
        ("<p>0 0 1 0 2 0", "<p>0 0 1 0 9 0", 9, "vertex 9, but only 4 exist"),
        ("<p>0 1 2 3</p>", "<p>0 1 2</p>", 11, "<vcount> tells of more corners"),
        ("<vcount>4</vcount>", "<vcount>3</vcount>", 11, "<vcount> tells of 3 corners, <p> has 4"),
        ("100 100 0", "100 one 0", 5, "\"one\" is no number here"),
        ("count=\"4\" stride", "count=\"5\" stride", 6, "5 points, 3 numbers apart"),
        ("url=\"#far\"", "url=\"#near\"", 17, "points to \"#near\", which is no <node>"),
        ("meter=\"0.01\"", "meter=\"0\"", 3, "`meter` is \"0\""),
        ("<rotate>0 0 1 90", "<rotate>0 0 1", 16, "<rotate> needs 4 finite numbers and has 3"),
        ("<translate>0 0 500</translate>", "<instance_node url=\"#far\"/>", 14, "holds itself"),
        ("<translate>0 0 500</translate>", "<skew>0</skew>", 14, "<skew> is not read"),
    ] {
        let message = broken(from, to);
        assert!(message.contains(told) && message.contains(&format!("line {line}:")), "{message}");
    }
    for bytes in [&b""[..], b"<a>", b"\xff", b"<COLLADA/>", b"<!DOCTYPE a><COLLADA/>"] {
        assert!(dae("bad.dae", bytes).unwrap_err().to_string().contains("bad.dae"));
    }
}

/// A GLB of one triangle with indices, shown by a node that is moved.
fn one_triangle_glb(json: &str) -> Vec<u8> {
    let mut blob: Vec<u8> = Vec::new();
    for value in [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        blob.extend(value.to_le_bytes());
    }
    for index in [0_u16, 1, 2, 0] {
        blob.extend(index.to_le_bytes());
    }
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + json.len() + 8 + blob.len();
    let word = |value: usize| u32::try_from(value).unwrap().to_le_bytes();
    let mut bytes = [b"glTF".as_slice(), &word(2), &word(length), &word(json.len()), b"JSON", &json].concat();
    bytes.extend(word(blob.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(blob);
    bytes
}

const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"translation":[0,0,3],"children":[1]},{"mesh":0,"scale":[2,1,1]}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
"buffers":[{"byteLength":44}]}"#;

#[test]
fn glb_is_placed_by_its_nodes() {
    let soup = glb("a.glb", &one_triangle_glb(GLTF)).unwrap();
    let expected = [[0.0, 0.0, 3.0], [2.0, 0.0, 3.0], [0.0, 1.0, 3.0]].map(Point3::from);
    assert_eq!((soup.vertices, soup.triangles), (expected.to_vec(), vec![[0, 1, 2]]));
}

#[test]
fn what_is_wrong_with_a_glb_is_told() {
    for (from, to, told) in [
        ("\"byteLength\":36}", "\"byteLength\":35}", "do not lie in its buffer view"),
        ("\"byteOffset\":36", "\"byteOffset\":40", "do not lie in its buffer view"),
        ("\"byteOffset\":36", "\"byteOffset\":18446744073709551615", ""),
        ("\"byteOffset\":36", "\"byteOffset\":10", "names a vertex that does not exist"),
        ("\"count\":3,\"type\":\"SCALAR\"", "\"count\":2,\"type\":\"SCALAR\"", "no multiple of 3"),
        ("\"mesh\":0", "\"mesh\":7", ""),
        ("\"POSITION\":0", "\"POSITION\":2", "positions are in accessor 2, there are 2"),
        ("\"indices\":1", "\"indices\":2", ""),
        ("\"mesh\":0", "\"mesh\":0,\"children\":[0]", "holds itself"),
        ("\"scene\":0", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"scene\":0", ""),
        ("{\"byteLength\":44}", "{\"byteLength\":44,\"uri\":\"a.bin\"}", "outside of the file"),
    ] {
        assert!(GLTF.contains(from), "{from}");
        let message = glb("bad.glb", &one_triangle_glb(&GLTF.replace(from, to))).unwrap_err().to_string();
        assert!(message.contains("bad.glb") && message.contains(told), "{message}");
    }
    let whole = one_triangle_glb(GLTF);
    for cut in 0..whole.len() {
        assert!(glb("bad.glb", &whole[..cut]).is_err(), "{cut}");
    }
}
