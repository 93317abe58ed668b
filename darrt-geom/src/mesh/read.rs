//! Mesh files as triangle soups, bounded in size and never panicking: STL and OBJ here, COLLADA and GLB next door.

use super::dae::dae;
use super::glb::glb;
use super::{MAXIMUM_FILE_BYTES, MAXIMUM_TRIANGLES};
use crate::bounded_file::read_bytes;
use crate::check;
use crate::error::GeomError;
use nalgebra::Point3;
use std::io::Cursor;
use std::path::Path;

/// What a file holds, before it is checked.
#[derive(Debug, Default)]
pub(super) struct Soup {
    pub(super) vertices: Vec<Point3<f64>>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// Reads the file by the reader its ending asks for.
pub(super) fn soup(path: &Path) -> Result<Soup, GeomError> {
    let shown = path.display().to_string();
    let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let parse = match ending.as_str() {
        "stl" => stl,
        "obj" => obj,
        "dae" => dae,
        "glb" => glb,
        _ => return Err(GeomError::UnknownFormat { path: shown, ending }),
    };
    parse(&shown, &read_bytes(path, MAXIMUM_FILE_BYTES)?)
}

/// STL, text or binary; all solids of a file together.
///
/// Many exporters begin a binary header with `solid`, so a file whose length is exactly that of a binary file with the
/// count it tells is binary, whatever its header says. One of any other length that is no text is refused: triangles that its
/// count does not tell would be lost.
pub(super) fn stl(shown: &str, bytes: &[u8]) -> Result<Soup, GeomError> {
    let malformed = |reason: String| GeomError::Malformed { path: shown.to_owned(), format: "STL", reason };
    let told = bytes.get(80..84).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let length = |count: u32| 84 + 50 * u64::from(count);
    let is_binary = told.is_some_and(|count| bytes.len() as u64 == length(count));
    if !is_binary && let Some(text) = text_of(bytes) {
        return text_stl(shown, text);
    }
    let Some(count) = told else {
        return Err(malformed(format!("{} bytes are neither a text with `solid` nor a binary header", bytes.len())));
    };
    if !is_binary {
        let (has, takes) = (bytes.len(), length(count));
        return Err(malformed(format!("it tells of {count} triangles, which take {takes} bytes, and has {has}")));
    }
    let mut owned;
    let bytes = if bytes.starts_with(b"solid") {
        owned = bytes.to_vec();
        owned.iter_mut().take(5).for_each(|b| *b = b' ');
        owned.as_slice()
    } else {
        bytes
    };
    let mut cursor = Cursor::new(bytes);
    let reader = stl_io::create_stl_reader(&mut cursor).map_err(|e| malformed(e.to_string()))?;
    let mut soup = Soup::default();
    for triangle in reader {
        let triangle = triangle.map_err(|e| malformed(e.to_string()))?;
        push(shown, &mut soup, triangle.vertices.map(|v| Point3::from(v.0.map(f64::from))))?;
    }
    Ok(soup)
}

/// The text of a text STL, without a mark of its encoding; `None` for what is none.
fn text_of(bytes: &[u8]) -> Option<&str> {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let head: Vec<u8> = bytes.iter().copied().skip_while(u8::is_ascii_whitespace).take(5).collect();
    let text = if head.eq_ignore_ascii_case(b"solid") { std::str::from_utf8(bytes).ok()? } else { return None };
    (!text.contains('\0')).then_some(text)
}

/// A text STL line by line: every solid, in any case, named or not, closed by `endsolid` or `end solid`.
fn text_stl(shown: &str, text: &str) -> Result<Soup, GeomError> {
    let mut soup = Soup::default();
    let mut corners: Vec<Point3<f64>> = Vec::new();
    let mut is_in_solid = false;
    for (number, line) in (1..).zip(text.lines()) {
        let malformed = |reason: &str| GeomError::Malformed {
            path: shown.to_owned(),
            format: "STL",
            reason: format!("line {number}: {reason}: `{}`", line.trim().chars().take(40).collect::<String>()),
        };
        let line = line.trim().to_ascii_lowercase();
        let words: Vec<&str> = line.split_whitespace().collect();
        match words.as_slice() {
            [] => {}
            ["solid", ..] if !is_in_solid => is_in_solid = true,
            ["endsolid", ..] | ["end", "solid", ..] if is_in_solid => is_in_solid = false,
            _ if !is_in_solid => {
                return Err(malformed("a solid begins with `solid`, and nothing stands between solids"));
            }
            ["facet", "normal", ..] | ["outer", "loop"] => corners.clear(),
            ["vertex", x, y, z] => {
                let number = |word: &&str| word.parse::<f64>().map_err(|_| malformed("a vertex has three numbers"));
                corners.push(Point3::new(number(x)?, number(y)?, number(z)?));
            }
            ["endloop"] => match corners.as_slice() {
                &[a, b, c] => push(shown, &mut soup, [a, b, c])?,
                _ => return Err(malformed("a facet has three vertices")),
            },
            ["endfacet"] => {}
            _ => return Err(malformed("this is no line of a solid")),
        }
    }
    if is_in_solid {
        let reason = "the last solid has no end".to_owned();
        return Err(GeomError::Malformed { path: shown.to_owned(), format: "STL", reason });
    }
    Ok(soup)
}

/// OBJ; only positions and faces are kept. What would be lost is refused: curved surfaces, and lines that are none of the format.
pub(super) fn obj(shown: &str, bytes: &[u8]) -> Result<Soup, GeomError> {
    let malformed = |reason: String| GeomError::Malformed { path: shown.to_owned(), format: "OBJ", reason };
    // Only these lines matter to us; the rest (normals, textures, materials, colours) is not even shown to the parser.
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let text = std::str::from_utf8(bytes).map_err(|e| malformed(e.to_string()))?;
    let mut kept = String::with_capacity(text.len());
    let mut whole = String::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim_end();
        // A line goes on behind a backslash.
        if let Some(begun) = line.strip_suffix('\\') {
            whole.push_str(begun);
            whole.push(' ');
            continue;
        }
        whole.push_str(line);
        keep(&whole, &mut kept).map_err(|reason| {
            let shown: String = whole.trim().chars().take(40).collect();
            malformed(format!("line {number}: {reason}: `{shown}`"))
        })?;
        whole.clear();
    }
    if !whole.trim().is_empty() {
        return Err(malformed("the last line ends in a backslash, and no line follows it".to_owned()));
    }
    let options =
        tobj::LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..Default::default() };
    let no_materials = |_: &Path| Err(tobj::LoadError::MaterialParseError);
    let (models, _) =
        tobj::load_obj_buf(&mut Cursor::new(kept), &options, no_materials).map_err(|e| malformed(e.to_string()))?;
    let mut soup = Soup::default();
    for mesh in models.iter().map(|model| &model.mesh) {
        let corner = |i: u32| {
            let start = 3 * i as usize;
            match mesh.positions.get(start..start + 3) {
                Some(&[x, y, z]) => Some(Point3::new(f64::from(x), f64::from(y), f64::from(z))),
                _ => None,
            }
        };
        let (triples, _) = mesh.indices.as_chunks::<3>();
        for &[a, b, c] in triples {
            let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) else {
                return Err(malformed("a face names a vertex that does not exist".to_owned()));
            };
            push(shown, &mut soup, [a, b, c])?;
        }
    }
    Ok(soup)
}

/// Lines that say nothing about the surface.
const ASIDE: [&str; 17] = [
    "vt", "vn", "vp", "p", "l", "g", "s", "o", "mg", "bevel", "c_interp", "d_interp", "lod", "usemtl", "mtllib",
    "usemap", "maplib",
];

/// Copies the position and face lines, reduced to coordinates and position indices.
fn keep(line: &str, kept: &mut String) -> Result<(), &'static str> {
    let mut words = line.split_whitespace();
    match words.next() {
        Some("v") => {
            kept.push('v');
            // Colours may follow three coordinates, a weight may be the fourth: neither is part of the surface we keep.
            let mut count = 0;
            for word in words.take(3) {
                count += usize::from(word.parse::<f64>().is_ok());
                kept.push(' ');
                kept.push_str(word);
            }
            if count < 3 {
                return Err("a vertex has three numbers");
            }
        }
        Some("f") => {
            kept.push('f');
            let mut count = 0;
            for word in words {
                count += 1;
                kept.push(' ');
                kept.push_str(word.split('/').next().unwrap_or_default());
            }
            if count < 3 {
                return Err("a face has at least three corners");
            }
        }
        Some(word) if ASIDE.contains(&word) || word.starts_with("shadow_obj") || word.starts_with("trace_obj") => {
            return Ok(());
        }
        Some(
            "cstype" | "deg" | "bmat" | "step" | "curv" | "curv2" | "surf" | "parm" | "trim" | "hole" | "scrv" | "sp"
            | "end" | "con",
        ) => {
            return Err("curves and curved surfaces are not read; export triangles");
        }
        Some(_) => return Err("this is no line of the format"),
        None => return Ok(()),
    }
    kept.push('\n');
    Ok(())
}

/// Adds a triangle with three vertices of its own.
pub(super) fn push(shown: &str, soup: &mut Soup, corners: [Point3<f64>; 3]) -> Result<(), GeomError> {
    check::count(format_args!("triangles of {shown}"), soup.triangles.len() + 1, 1, MAXIMUM_TRIANGLES)?;
    // Bounded by the line above, so the index fits.
    let first = u32::try_from(soup.vertices.len()).unwrap_or(u32::MAX);
    soup.vertices.extend(corners);
    soup.triangles.push([first, first + 1, first + 2]);
    Ok(())
}
