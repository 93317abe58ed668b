//! The triangles of a `<geometry>`, in its own frame and units; each is read once, however often the scene shows it.

use std::collections::BTreeMap;
use std::rc::Rc;

use nalgebra::Point3;
use roxmltree::Node;

use super::{Corners, File, child};
use crate::check;
use crate::error::GeomError;
use crate::mesh::MAXIMUM_TRIANGLES;

/// Most numbers of one corner of a polygon.
const WIDEST: usize = 64;

/// How many numbers a corner has, which of them is its vertex, and where the vertices are.
type Inputs = (usize, usize, Rc<[Point3<f64>]>);

/// What has been read of a file, by the number of its XML node.
#[derive(Default)]
pub(super) struct Geometries {
    triangles: BTreeMap<usize, Rc<[Corners]>>,
    positions: BTreeMap<usize, Rc<[Point3<f64>]>>,
    /// Triangles of all geometries together.
    count: usize,
}

impl Geometries {
    /// The triangles of a `<geometry>`.
    pub(super) fn triangles<'a>(&mut self, file: &File<'a>, geometry: Node<'a, 'a>) -> Result<Vec<Corners>, GeomError> {
        if let Some(known) = self.triangles.get(&geometry.id().get_usize()) {
            return Ok(known.to_vec());
        }
        let mesh = child(geometry, "mesh").ok_or_else(|| {
            file.wrong(geometry, "this <geometry> has no <mesh>; other kinds are not read".to_owned())
        })?;
        let mut triangles = Vec::new();
        for part in mesh.children().filter(Node::is_element) {
            if matches!(part.tag_name().name(), "triangles" | "polylist" | "polygons" | "tristrips" | "trifans") {
                self.part(file, part, &mut triangles)?;
            }
        }
        self.triangles.insert(geometry.id().get_usize(), triangles.clone().into());
        Ok(triangles)
    }

    /// The triangles of one list of polygons.
    fn part<'a>(&mut self, file: &File<'a>, part: Node<'a, 'a>, out: &mut Vec<Corners>) -> Result<(), GeomError> {
        if child(part, "ph").is_some() {
            return Err(file.wrong(part, "polygons with holes (<ph>) are not read".to_owned()));
        }
        let lists = part.children().filter(|n| n.has_tag_name((n.tag_name().namespace().unwrap_or_default(), "p")));
        let lists = lists.map(|list| file.numbers::<u32>(list)).collect::<Result<Vec<_>, _>>()?;
        if lists.iter().all(Vec::is_empty) {
            return Ok(());
        }
        let (width, at, vertices) = self.inputs(file, part)?;
        let corner = |list: &[u32], index: usize| {
            let vertex = list.get(index * width + at).copied();
            let point = vertex.and_then(|vertex| vertices.get(vertex as usize)).copied();
            point.ok_or_else(|| {
                let count = vertices.len();
                file.wrong(
                    part,
                    vertex.map_or("a corner is missing in <p>".to_owned(), |vertex| {
                        format!("a corner is vertex {vertex}, but only {count} exist")
                    }),
                )
            })
        };
        let mut triangle = |list: &[u32], corners: [usize; 3]| -> Result<(), GeomError> {
            let [a, b, c] = corners;
            out.push([corner(list, a)?, corner(list, b)?, corner(list, c)?]);
            self.count += 1;
            check::count(format_args!("triangles of {}", file.shown), self.count, 0, MAXIMUM_TRIANGLES)
        };
        let sizes = match child(part, "vcount") {
            Some(sizes) => file.numbers::<u32>(sizes)?,
            None => Vec::new(),
        };
        for list in &lists {
            if !list.len().is_multiple_of(width) {
                let (numbers, each) = (list.len(), width);
                return Err(
                    file.wrong(part, format!("<p> has {numbers} numbers, no multiple of the {each} of a corner"))
                );
            }
            let count = list.len() / width;
            match part.tag_name().name() {
                "triangles" if !count.is_multiple_of(3) => {
                    return Err(file.wrong(part, format!("<triangles> has {count} corners, no multiple of 3")));
                }
                "triangles" => (0..count / 3).try_for_each(|i| triangle(list, [3 * i, 3 * i + 1, 3 * i + 2]))?,
                "polylist" => {
                    let mut first = 0_usize;
                    for size in sizes.iter().map(|size| *size as usize) {
                        if size > count - first {
                            return Err(file.wrong(part, "<vcount> tells of more corners than <p> has".to_owned()));
                        }
                        (2..size).try_for_each(|i| triangle(list, [first, first + i - 1, first + i]))?;
                        first += size;
                    }
                    if first != count {
                        return Err(file.wrong(part, format!("<vcount> tells of {first} corners, <p> has {count}")));
                    }
                }
                // Every other triangle of a strip turns the other way; what counts here is where it lies.
                "tristrips" => (2..count).try_for_each(|i| triangle(list, [i - 2, i - 1, i]))?,
                _ => (2..count).try_for_each(|i| triangle(list, [0, i - 1, i]))?,
            }
        }
        Ok(())
    }

    /// How many numbers a corner has, which of them is its vertex, and where the vertices are.
    fn inputs<'a>(&mut self, file: &File<'a>, part: Node<'a, 'a>) -> Result<Inputs, GeomError> {
        let (mut width, mut vertex) = (1, None);
        for input in part.children().filter(|child| child.tag_name().name() == "input") {
            let offset = number(file, input, "offset", 0)?;
            width = width.max(offset + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = Some((offset, input));
            }
        }
        if width > WIDEST {
            return Err(file.wrong(part, format!("a corner has {width} numbers; at most {WIDEST} are read")));
        }
        let Some((at, input)) = vertex else {
            return Err(file.wrong(part, "there is no <input> of the semantic VERTEX".to_owned()));
        };
        let vertices = file.target(input, "source", "vertices")?;
        let position = vertices.children().find(|child| child.attribute("semantic") == Some("POSITION"));
        let Some(position) = position else {
            return Err(file.wrong(vertices, "there is no <input> of the semantic POSITION".to_owned()));
        };
        let source = file.target(position, "source", "source")?;
        if let Some(known) = self.positions.get(&source.id().get_usize()) {
            return Ok((width, at, Rc::clone(known)));
        }
        let points: Rc<[Point3<f64>]> = positions(file, source)?.into();
        self.positions.insert(source.id().get_usize(), Rc::clone(&points));
        Ok((width, at, points))
    }
}

/// The points of a `<source>`.
fn positions<'a>(file: &File<'a>, source: Node<'a, 'a>) -> Result<Vec<Point3<f64>>, GeomError> {
    let accessor = child(source, "technique_common").and_then(|technique| child(technique, "accessor"));
    let accessor = accessor.ok_or_else(|| file.wrong(source, "this <source> has no <accessor>".to_owned()))?;
    let array = file.target(accessor, "source", "float_array")?;
    let numbers = file.numbers::<f64>(array)?;
    let (count, offset) = (number(file, accessor, "count", 0)?, number(file, accessor, "offset", 0)?);
    let stride = number(file, accessor, "stride", 1)?;
    let params = accessor.children().filter(|child| child.tag_name().name() == "param");
    // A parameter without a name is passed over.
    let named = params.enumerate().filter(|(_, param)| param.attribute("name").is_some_and(|name| !name.is_empty()));
    let mut columns: Vec<usize> = named.map(|(column, _)| column).take(3).collect();
    if columns.is_empty() {
        columns = vec![0, 1, 2];
    }
    let &[x, y, z] = columns.as_slice() else {
        return Err(file.wrong(accessor, "positions need three named parameters".to_owned()));
    };
    let last = count.checked_sub(1).and_then(|last| last.checked_mul(stride)?.checked_add(offset)?.checked_add(z));
    if stride <= z || last.is_some_and(|last| last >= numbers.len()) {
        let has = numbers.len();
        return Err(file.wrong(
            accessor,
            format!("{count} points, {stride} numbers apart from number {offset} on, do not lie in the {has} numbers there are"),
        ));
    }
    let at = |i: usize, column: usize| numbers.get(offset + i * stride + column).copied().unwrap_or(f64::NAN);
    Ok((0..count).map(|i| Point3::new(at(i, x), at(i, y), at(i, z))).collect())
}

/// A count in an attribute.
fn number<'a>(file: &File<'a>, node: Node<'a, 'a>, attribute: &str, default: usize) -> Result<usize, GeomError> {
    let Some(text) = node.attribute(attribute) else { return Ok(default) };
    text.trim().parse().map_err(|_| {
        let text: String = text.chars().take(20).collect();
        file.wrong(node, format!("`{attribute}` is {text:?}, no count"))
    })
}
