//! Binary glTF files (GLB) as triangle soups: the meshes of the scene, as its nodes place them, in metres.
//!
//! The container and its JSON are read and checked by the crate `gltf`; the numbers are taken from the binary part here, none
//! of them without asking whether it is there. The axes are taken as they are (glTF means y to be up), as for the other formats.

use gltf::accessor::{DataType, Dimensions};
use gltf::buffer::Source;
use gltf::json::validation::Checked;
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Glb, Node, Primitive, Semantic, json};
use nalgebra::{Matrix4, Point3};

/// Of the file's header and of that of its first chunk.
const HEADER_BYTES: usize = 20;

use super::MAXIMUM_TRIANGLES;
use super::read::{Soup, push};
use crate::check;
use crate::error::GeomError;

/// Most nodes of the scene, instances counted each time.
const MOST_VISITS: usize = 100_000;

/// Reads the scene of a GLB file.
pub(super) fn glb(shown: &str, bytes: &[u8]) -> Result<Soup, GeomError> {
    let mut reader = Reader { shown, blob: &[], soup: Soup::default() };
    if !bytes.starts_with(b"glTF") {
        return Err(reader.wrong("it does not begin with `glTF`"));
    }
    check_header(bytes).map_err(|why| reader.wrong(&why))?;
    let file = Glb::from_slice(bytes).map_err(|error| reader.wrong(&error.to_string()))?;
    reader.blob = file.bin.as_deref().unwrap_or_default();
    let file = document(&file.json).map_err(|why| reader.wrong(&why))?;
    if let Some(extension) = file.extensions_required().next() {
        let extension: String = extension.chars().take(80).collect();
        return Err(reader.wrong(&format!("it needs the extension `{extension}`, which is not read")));
    }
    let scene = file.default_scene().or_else(|| file.scenes().next());
    let scene = scene.ok_or_else(|| reader.wrong("it has no scene"))?;
    let mut stack: Vec<(Node<'_>, Matrix4<f64>)> = scene.nodes().map(|node| (node, Matrix4::identity())).collect();
    let mut visits = 0;
    while let Some((node, above)) = stack.pop() {
        visits += 1;
        if visits > MOST_VISITS {
            let reason = format!("its scene has more than {MOST_VISITS} nodes, or one that holds itself");
            return Err(reader.wrong(&reason));
        }
        let from_node = above * Matrix4::from(node.transform().matrix()).cast::<f64>();
        if let Some(mesh) = node.mesh() {
            mesh.primitives().try_for_each(|primitive| reader.add(&primitive, &from_node))?;
        }
        stack.extend(node.children().map(|child| (child, from_node)));
    }
    Ok(reader.soup)
}

struct Reader<'a> {
    shown: &'a str,
    /// The binary part of the file.
    blob: &'a [u8],
    soup: Soup,
}

/// An accessor's numbers where they lie.
struct Numbers<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
    kind: DataType,
}

impl Numbers<'_> {
    fn bytes<const N: usize>(&self, index: usize, skip: usize) -> Option<[u8; N]> {
        let start = index.checked_mul(self.stride)?.checked_add(skip)?;
        self.bytes.get(start..start.checked_add(N)?)?.try_into().ok()
    }

    fn point(&self, index: usize) -> Option<Point3<f64>> {
        let coordinate = |axis: usize| Some(f64::from(f32::from_le_bytes(self.bytes(index, 4 * axis)?)));
        (index < self.count).then_some(())?;
        Some(Point3::new(coordinate(0)?, coordinate(1)?, coordinate(2)?))
    }

    fn index(&self, index: usize) -> Option<usize> {
        let value = match self.kind {
            DataType::U8 => u32::from(u8::from_le_bytes(self.bytes(index, 0)?)),
            DataType::U16 => u32::from(u16::from_le_bytes(self.bytes(index, 0)?)),
            _ => u32::from_le_bytes(self.bytes(index, 0)?),
        };
        usize::try_from(value).ok()
    }
}

impl<'a> Reader<'a> {
    /// Adds the triangles of a primitive; points and lines have none.
    fn add(&mut self, primitive: &Primitive<'_>, from_node: &Matrix4<f64>) -> Result<(), GeomError> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Err(self.wrong("a primitive has no positions"));
        };
        if (positions.data_type(), positions.dimensions()) != (DataType::F32, Dimensions::Vec3) {
            return Err(self.wrong("positions are not three 32-bit floats each"));
        }
        let points = self.numbers(&positions)?;
        let indices = match primitive.indices() {
            Some(accessor) => {
                let is_index = matches!(accessor.data_type(), DataType::U8 | DataType::U16 | DataType::U32);
                if !is_index || accessor.dimensions() != Dimensions::Scalar {
                    return Err(self.wrong("indices are not unsigned integers"));
                }
                Some(self.numbers(&accessor)?)
            }
            None => None,
        };
        let count = indices.as_ref().map_or(points.count, |indices| indices.count);
        let triangles = if mode == Mode::Triangles { count / 3 } else { count.saturating_sub(2) };
        if mode == Mode::Triangles && !count.is_multiple_of(3) {
            return Err(self.wrong(&format!("triangles have {count} corners, no multiple of 3")));
        }
        let all = self.soup.triangles.len().saturating_add(triangles);
        check::count(format_args!("triangles of {}", self.shown), all, 0, MAXIMUM_TRIANGLES)?;
        let corner = |index: usize| {
            let vertex = indices.as_ref().map_or(Some(index), |indices| indices.index(index))?;
            points.point(vertex).map(|point| from_node.transform_point(&point))
        };
        for i in 0..triangles {
            let corners = match mode {
                Mode::Triangles => [3 * i, 3 * i + 1, 3 * i + 2],
                // Every other triangle of a strip turns the other way; what counts here is where it lies.
                Mode::TriangleStrip => [i, i + 1, i + 2],
                _ => [0, i + 1, i + 2],
            };
            let [Some(a), Some(b), Some(c)] = corners.map(corner) else {
                return Err(self.wrong("a triangle names a vertex that does not exist"));
            };
            push(self.shown, &mut self.soup, [a, b, c])?;
        }
        Ok(())
    }

    /// The numbers of an accessor, which must lie in the binary part.
    fn numbers(&self, accessor: &Accessor<'_>) -> Result<Numbers<'a>, GeomError> {
        if accessor.sparse().is_some() {
            return Err(self.wrong("sparse accessors are not read"));
        }
        let Some(view) = accessor.view() else {
            return Err(self.wrong("an accessor has no buffer view"));
        };
        if !matches!(view.buffer().source(), Source::Bin) {
            return Err(self.wrong("a buffer lies outside of the file, which is not read"));
        }
        let (size, count) = (accessor.size(), accessor.count());
        let stride = view.stride().unwrap_or(size);
        let needed = count.checked_sub(1).and_then(|last| last.checked_mul(stride)?.checked_add(size)).unwrap_or(0);
        let range = |start: usize, length: usize| Some(start..start.checked_add(length)?);
        let in_view = range(view.offset(), view.length()).and_then(|range| self.blob.get(range));
        let bytes = in_view.and_then(|bytes| bytes.get(accessor.offset()..)).filter(|bytes| needed <= bytes.len());
        match bytes {
            Some(bytes) if stride >= size => Ok(Numbers { bytes, stride, count, kind: accessor.data_type() }),
            _ => Err(self.wrong(&format!("{count} numbers of an accessor do not lie in its buffer view"))),
        }
    }

    fn wrong(&self, reason: &str) -> GeomError {
        GeomError::Malformed { path: self.shown.to_owned(), format: "GLB", reason: reason.to_owned() }
    }
}

/// The JSON part, checked.
fn document(bytes: &[u8]) -> Result<Document, String> {
    let root: json::Root = json::deserialize::from_slice(bytes).map_err(|error| error.to_string())?;
    // The checks of the crate `gltf` look up the accessors of positions before they check that these exist.
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let positions = primitives.filter_map(|primitive| primitive.attributes.get(&Checked::Valid(Semantic::Positions)));
    if let Some(missing) = positions.map(json::Index::value).find(|&index| index >= root.accessors.len()) {
        return Err(format!("positions are in accessor {missing}, there are {}", root.accessors.len()));
    }
    Document::from_json(root).map_err(|error| error.to_string())
}

/// Do the lengths in the header agree with the file? The parser subtracts them without asking.
fn check_header(bytes: &[u8]) -> Result<(), String> {
    let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes).map(|word| word as usize);
    let (Some(length), Some(chunk)) = (word(8), word(12)) else {
        return Err(format!("{} bytes are no header and chunk", bytes.len()));
    };
    if length != bytes.len() {
        return Err(format!("its header says {length} bytes, there are {}", bytes.len()));
    }
    if chunk > length.saturating_sub(HEADER_BYTES) {
        return Err(format!("its first chunk says {chunk} bytes, the file has {length}"));
    }
    Ok(())
}
