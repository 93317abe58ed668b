//! COLLADA files (DAE) as triangle soups: the geometry of the scene, as its nodes place it, in metres.
//!
//! The subset that meshes of robots use, read here on an XML reader because no crate that is kept reads the files in use:
//! triangles, polygons, strips and fans; matrices, translations, rotations and scales of nodes; instances of nodes. Materials,
//! normals, textures, lines and cameras are none of its business. `<up_axis>` is not applied: the robot descriptions in use
//! are written for readers that take the axes as they are, and their other meshes would no longer fit.

mod geometry;

use std::collections::BTreeMap;
use std::str::FromStr;

use nalgebra::{Matrix4, Point3, Rotation3, Translation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use super::read::{Soup, push};
use crate::error::GeomError;
use geometry::Geometries;

/// Most XML nodes of a file; coordinates are text, so that a large mesh has few.
const MOST_NODES: u32 = 1_000_000;
/// Most declarations of namespaces: the reader copies those of a parent.
const MOST_NAMESPACES: usize = 64;
/// Most nodes of the scene, instances counted each time.
const MOST_VISITS: usize = 100_000;

/// Reads the scene of a COLLADA file.
pub(super) fn dae(shown: &str, bytes: &[u8]) -> Result<Soup, GeomError> {
    let malformed = |reason: String| GeomError::Malformed { path: shown.to_owned(), format: "COLLADA", reason };
    let text = std::str::from_utf8(bytes).map_err(|error| malformed(error.to_string()))?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.matches("xmlns").take(MOST_NAMESPACES + 1).count() > MOST_NAMESPACES {
        return Err(malformed(format!("it declares more than {MOST_NAMESPACES} namespaces")));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| malformed(error.to_string()))?;
    let file = File::new(shown, &document);
    let mut soup = Soup::default();
    file.read(&mut soup)?;
    Ok(soup)
}

/// A file and the names in it.
struct File<'a> {
    shown: &'a str,
    document: &'a Document<'a>,
    ids: BTreeMap<&'a str, Node<'a, 'a>>,
}

impl<'a> File<'a> {
    fn new(shown: &'a str, document: &'a Document<'a>) -> Self {
        let mut ids = BTreeMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                // Of two with one id the first counts, as in the readers that robots are made for.
                ids.entry(id).or_insert(node);
            }
        }
        Self { shown, document, ids }
    }

    fn read(&self, soup: &mut Soup) -> Result<(), GeomError> {
        let root = self.document.root_element();
        if root.tag_name().name() != "COLLADA" {
            return Err(self.wrong(root, format!("the root is <{}>, not <COLLADA>", root.tag_name().name())));
        }
        let scene = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        let scene = match scene {
            Some(instance) => self.target(instance, "url", "visual_scene")?,
            None => child(root, "library_visual_scenes")
                .and_then(|library| child(library, "visual_scene"))
                .ok_or_else(|| self.wrong(root, "there is no <visual_scene>".to_owned()))?,
        };
        let metres = self.unit(root)?;
        let mut geometries = Geometries::default();
        let mut stack = vec![(scene, Matrix4::new_scaling(metres))];
        let mut visits = 0;
        while let Some((node, above)) = stack.pop() {
            visits += 1;
            if visits > MOST_VISITS {
                return Err(
                    self.wrong(node, format!("the scene has more than {MOST_VISITS} nodes, or one that holds itself"))
                );
            }
            let from_node = above * self.transform(node)?;
            for part in node.children().filter(Node::is_element) {
                match part.tag_name().name() {
                    "node" => stack.push((part, from_node)),
                    "instance_node" => stack.push((self.target(part, "url", "node")?, from_node)),
                    "instance_geometry" => {
                        let geometry = self.target(part, "url", "geometry")?;
                        for corners in geometries.triangles(self, geometry)? {
                            push(self.shown, soup, corners.map(|corner| from_node.transform_point(&corner)))?;
                        }
                    }
                    "instance_controller" => {
                        return Err(
                            self.wrong(part, "a mesh that bends (<instance_controller>) is not read".to_owned())
                        );
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// Metres of one unit of the file.
    fn unit(&self, root: Node<'a, 'a>) -> Result<f64, GeomError> {
        let Some(unit) = child(root, "asset").and_then(|asset| child(asset, "unit")) else { return Ok(1.0) };
        let Some(text) = unit.attribute("meter") else { return Ok(1.0) };
        match text.trim().parse::<f64>() {
            Ok(metres) if metres.is_finite() && (1e-9..=1e6).contains(&metres) => Ok(metres),
            _ => Err(self.wrong(unit, format!("`meter` is {text:?}, but must lie in [1e-9, 1e6]"))),
        }
    }

    /// From the frame of a node to that around it: its transformations from top to bottom.
    fn transform(&self, node: Node<'a, 'a>) -> Result<Matrix4<f64>, GeomError> {
        let mut all = Matrix4::identity();
        for part in node.children().filter(Node::is_element) {
            all *= match part.tag_name().name() {
                "matrix" => Matrix4::from_row_slice(&self.some::<16>(part)?),
                "translate" => Translation3::from(Vector3::from(self.some::<3>(part)?)).to_homogeneous(),
                "scale" => Matrix4::new_nonuniform_scaling(&Vector3::from(self.some::<3>(part)?)),
                "rotate" => {
                    let [x, y, z, degrees] = self.some(part)?;
                    // An axis without direction turns nothing.
                    Unit::try_new(Vector3::new(x, y, z), 1e-12).map_or_else(Matrix4::identity, |axis| {
                        Rotation3::from_axis_angle(&axis, degrees.to_radians()).to_homogeneous()
                    })
                }
                name @ ("skew" | "lookat") => return Err(self.wrong(part, format!("<{name}> is not read"))),
                _ => continue,
            };
        }
        Ok(all)
    }

    /// Exactly `N` finite numbers.
    fn some<const N: usize>(&self, node: Node<'a, 'a>) -> Result<[f64; N], GeomError> {
        let numbers: Vec<f64> = self.numbers(node)?;
        let count = numbers.len();
        match <[f64; N]>::try_from(numbers) {
            Ok(numbers) if numbers.iter().all(|x| x.is_finite()) => Ok(numbers),
            _ => {
                Err(self.wrong(node, format!("<{}> needs {N} finite numbers and has {count}", node.tag_name().name())))
            }
        }
    }

    /// The numbers of an element's text.
    fn numbers<T: FromStr>(&self, node: Node<'a, 'a>) -> Result<Vec<T>, GeomError> {
        let mut numbers = Vec::new();
        for text in node.children().filter_map(|child| if child.is_text() { child.text() } else { None }) {
            for word in text.split_ascii_whitespace() {
                let shown = || word.chars().take(20).collect::<String>();
                let number = word.parse().map_err(|_| self.wrong(node, format!("{:?} is no number here", shown())))?;
                numbers.push(number);
            }
        }
        Ok(numbers)
    }

    /// The element that an attribute points to, `#id`, which must be of this kind.
    fn target(&self, node: Node<'a, 'a>, attribute: &str, kind: &str) -> Result<Node<'a, 'a>, GeomError> {
        let name = node.tag_name().name();
        let Some(url) = node.attribute(attribute) else {
            return Err(self.wrong(node, format!("<{name}> has no `{attribute}`")));
        };
        let found = url.strip_prefix('#').and_then(|id| self.ids.get(id)).copied();
        found.filter(|target| target.tag_name().name() == kind).ok_or_else(|| {
            let url: String = url.chars().take(80).collect();
            self.wrong(node, format!("<{name}> points to {url:?}, which is no <{kind}> of this file"))
        })
    }

    fn wrong(&self, node: Node<'_, '_>, mut reason: String) -> GeomError {
        let line = self.document.text_pos_at(node.range().start).row;
        reason.insert_str(0, &format!("line {line}: "));
        GeomError::Malformed { path: self.shown.to_owned(), format: "COLLADA", reason }
    }
}

fn child<'a>(node: Node<'a, 'a>, name: &str) -> Option<Node<'a, 'a>> {
    node.children().find(|child| child.tag_name().name() == name)
}

/// The corners of a triangle.
type Corners = [Point3<f64>; 3];
