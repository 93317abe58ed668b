//! What planning needs of a robot description: the rest is blanked out before it is parsed, so that no inertia, material, texture,
//! transmission or simulator's element stops a robot from loading; what is needed and missing is named with its line.

use std::borrow::Cow;
use std::collections::BTreeSet;

use roxmltree::{Document, Node};

use super::UrdfError;
use crate::kinematics::guard::MAX_NAMESPACES;

/// A description without what planning does not use.
pub(super) struct Needed {
    /// The text, with blanks for what is left out: lines stay where they were.
    pub(super) text: String,
    /// Names of the links that have a visual.
    pub(super) seen: BTreeSet<String>,
}

/// The elements that are kept: the parent, the name.
const KEPT: [(&str, &str); 17] = [
    ("robot", "link"),
    ("robot", "joint"),
    ("link", "collision"),
    ("collision", "origin"),
    ("collision", "geometry"),
    ("geometry", "box"),
    ("geometry", "cylinder"),
    ("geometry", "sphere"),
    ("geometry", "capsule"),
    ("geometry", "mesh"),
    ("joint", "origin"),
    ("joint", "parent"),
    ("joint", "child"),
    ("joint", "axis"),
    ("joint", "limit"),
    ("joint", "mimic"),
    ("joint", "safety_controller"),
];

/// What an element must have: attributes with a text for the message, then elements.
const ATTRIBUTES: [(&str, &str, &str); 12] = [
    ("link", "name", "`name`"),
    ("joint", "name", "`name`"),
    ("joint", "type", "`type`"),
    ("box", "size", "`size`"),
    ("sphere", "radius", "`radius`"),
    ("cylinder", "radius", "`radius`"),
    ("cylinder", "length", "`length`"),
    ("capsule", "radius", "`radius`"),
    ("capsule", "length", "`length`"),
    ("mesh", "filename", "`filename`"),
    ("mimic", "joint", "`joint`"),
    ("limit", "velocity", "`velocity`"),
];

/// The text, with a declaration for every prefix that has none: old descriptions call the elements of a simulator by such
/// (`<sensor:camera>`), which planning does not use.
pub(super) fn with_namespaces(text: &str) -> Cow<'_, str> {
    let mut text = Cow::Borrowed(text);
    for _ in 0..MAX_NAMESPACES {
        let Err(roxmltree::Error::UnknownNamespace(prefix, _)) = Document::parse(&text) else { break };
        let Some(at) = behind_root_name(&text) else { break };
        text.to_mut().insert_str(at, &format!(" xmlns:{prefix}=\"{prefix}\""));
    }
    text
}

/// Where the name of the root element ends.
fn behind_root_name(text: &str) -> Option<usize> {
    let mut at = 0;
    loop {
        at += text.get(at..)?.find('<')?;
        let rest = text.get(at..)?;
        let other = [("<?", "?>"), ("<!--", "-->"), ("<!", ">")].into_iter().find(|(start, _)| rest.starts_with(start));
        let Some((_, end)) = other else {
            return rest.find(|c: char| c.is_whitespace() || c == '/' || c == '>').map(|length| at + length);
        };
        at += rest.find(end)?;
    }
}

/// Blanks out what planning does not use and asks for what it needs.
///
/// # Errors
/// [`UrdfError::Syntax`] for a text that is no XML, [`UrdfError::Lacks`] for what is missing.
pub(super) fn only(text: &str) -> Result<Needed, UrdfError> {
    let document = Document::parse(text).map_err(|error| UrdfError::Syntax { message: error.to_string() })?;
    let mut bytes = text.as_bytes().to_vec();
    let mut seen = BTreeSet::new();
    let mut stack: Vec<(Node<'_, '_>, Option<Node<'_, '_>>)> = vec![(document.root_element(), None)];
    while let Some((node, owner)) = stack.pop() {
        let name = node.tag_name().name();
        ask(&document, node, owner)?;
        for child in node.children().filter(Node::is_element) {
            let word = child.tag_name().name();
            if KEPT.contains(&(name, word)) {
                let owner = if name == "robot" { Some(child) } else { owner };
                stack.push((child, owner));
                continue;
            }
            if (name, word) == ("link", "visual") {
                seen.extend(node.attribute("name").map(str::to_owned));
            }
            for byte in bytes.get_mut(child.range()).into_iter().flatten().filter(|byte| **byte != b'\n') {
                *byte = b' ';
            }
        }
    }
    // Whole elements were blanked, so no character was cut.
    let text = String::from_utf8(bytes).map_err(|error| UrdfError::Syntax { message: error.to_string() })?;
    Ok(Needed { text, seen })
}

/// Has the element what it must have? `owner`: the link or joint that it belongs to.
fn ask(document: &Document<'_>, node: Node<'_, '_>, owner: Option<Node<'_, '_>>) -> Result<(), UrdfError> {
    let name = node.tag_name().name();
    let lacks = |missing: &'static str| {
        let of = owner.and_then(|owner| Some((owner.tag_name().name(), owner.attribute("name")?)));
        let element = match of {
            Some((kind, owner)) => format!("<{name}> of {kind} {owner:?}"),
            None => format!("<{name}>"),
        };
        Err(UrdfError::Lacks { element, missing, line: document.text_pos_at(node.range().start).row })
    };
    let has = |word: &str| node.children().any(|child| child.tag_name().name() == word);
    for (_, attribute, missing) in ATTRIBUTES.iter().filter(|(element, ..)| *element == name) {
        if node.attribute(*attribute).is_none() {
            return lacks(missing);
        }
    }
    match name {
        "parent" | "child" if node.attribute("link").is_none() => lacks("`link`"),
        "collision" if !has("geometry") => lacks("<geometry>"),
        "geometry" if !["box", "cylinder", "sphere", "capsule", "mesh"].into_iter().any(has) => {
            lacks("shape: a <box>, <cylinder>, <sphere>, <capsule> or <mesh>")
        }
        "joint" if !has("parent") => lacks("<parent>"),
        "joint" if !has("child") => lacks("<child>"),
        // Without it the joint could not move, and nobody would say so.
        "joint"
            if matches!(node.attribute("type"), Some("revolute" | "prismatic")) && !has("limit") && !has("mimic") =>
        {
            lacks("<limit>")
        }
        _ => Ok(()),
    }
}
