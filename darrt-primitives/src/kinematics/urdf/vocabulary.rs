//! Words of a robot description that mean nothing, though something was meant: slips of the pen, and what xacro left over.
//! A reader that skips what it does not know would lose a shape or a limit in silence.
//!
//! Elements and attributes that planning does not use, or that are like no known one, are none of its business.

use roxmltree::{Document, Node};

use super::UrdfError;

/// An element that planning uses: its parent, its name, its attributes.
const ELEMENTS: [(&str, &str, &[&str]); 20] = [
    ("", "robot", &["name"]),
    ("robot", "link", &["name"]),
    ("robot", "joint", &["name", "type"]),
    ("link", "collision", &["name"]),
    ("link", "visual", &["name"]),
    ("collision", "origin", &["xyz", "rpy"]),
    ("collision", "geometry", &[]),
    ("geometry", "box", &["size"]),
    ("geometry", "cylinder", &["radius", "length"]),
    ("geometry", "sphere", &["radius"]),
    ("geometry", "capsule", &["radius", "length"]),
    ("geometry", "mesh", &["filename", "scale"]),
    ("joint", "origin", &["xyz", "rpy"]),
    ("joint", "parent", &["link"]),
    ("joint", "child", &["link"]),
    ("joint", "axis", &["xyz"]),
    ("joint", "limit", &["lower", "upper", "effort", "velocity"]),
    ("joint", "mimic", &["joint", "multiplier", "offset"]),
    ("joint", "safety_controller", &["soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"]),
    ("visual", "geometry", &[]),
];

/// Elements beside those that are no slips of them, for they have a meaning of their own.
const OTHERS: [&str; 9] =
    ["inertial", "material", "gazebo", "transmission", "calibration", "dynamics", "sensor", "texture", "contact"];

/// Checks the elements that planning uses.
///
/// # Errors
/// [`UrdfError::Syntax`] for a text that is no XML or names an attribute twice; [`UrdfError::UnknownWord`] for a name that is
/// nearly one that means something; [`UrdfError::Xacro`] for what xacro should have replaced.
pub(super) fn check(text: &str) -> Result<(), UrdfError> {
    let document = Document::parse(text).map_err(|error| UrdfError::Syntax { message: error.to_string() })?;
    let mut stack = vec![(document.root_element(), "")];
    while let Some((node, parent)) = stack.pop() {
        let name = node.tag_name().name();
        let Some((_, known, attributes)) = ELEMENTS.iter().find(|(above, known, _)| *above == parent && *known == name)
        else {
            refuse_slip(&document, node, parent)?;
            continue;
        };
        for attribute in node.attributes() {
            if attribute.value().contains("${") {
                let found = format!("{}=\"{}\"", attribute.name(), attribute.value());
                return Err(UrdfError::Xacro { found, line: line_of(&document, node) });
            }
            refuse_near(&document, node, ("attribute", attribute.name()), attributes.iter().copied())?;
        }
        stack.extend(node.children().filter(Node::is_element).map(|child| (child, *known)));
    }
    Ok(())
}

fn refuse_slip(document: &Document<'_>, node: Node<'_, '_>, parent: &str) -> Result<(), UrdfError> {
    let name = node.tag_name().name();
    if node.tag_name().namespace().is_some_and(|space| space.contains("xacro")) {
        return Err(UrdfError::Xacro { found: format!("<xacro:{name}>"), line: line_of(document, node) });
    }
    if OTHERS.contains(&name) {
        return Ok(());
    }
    let known = ELEMENTS.iter().filter(|(above, ..)| *above == parent).map(|(_, known, _)| *known);
    refuse_near(document, node, ("element", name), known.chain(OTHERS))
}

/// Refuses a name that is not among the known ones but very like one of them.
fn refuse_near(
    document: &Document<'_>,
    node: Node<'_, '_>,
    (kind, name): (&'static str, &str),
    known: impl Iterator<Item = &'static str> + Clone,
) -> Result<(), UrdfError> {
    if known.clone().any(|word| word == name) {
        return Ok(());
    }
    let lower = name.to_ascii_lowercase();
    // One slip in a short word, two in a long one.
    let slips = |word: &str| if word.len() < 6 { 1 } else { 2 };
    let near = known
        .map(|word| (strsim::osa_distance(&lower, word), word))
        .filter(|(distance, word)| *distance <= slips(word))
        .min_by_key(|(distance, _)| *distance);
    match near {
        Some((_, nearest)) if !OTHERS.contains(&nearest) => {
            Err(UrdfError::UnknownWord { kind, name: name.to_owned(), nearest, line: line_of(document, node) })
        }
        _ => Ok(()),
    }
}

fn line_of(document: &Document<'_>, node: Node<'_, '_>) -> u32 {
    document.text_pos_at(node.range().start).row
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(link: &str) -> Option<String> {
        let text = format!(
            "<robot name='r' xmlns:xacro='http://www.ros.org/wiki/xacro'>\n<link name='a'>\n{link}</link></robot>"
        );
        check(&text).err().map(|error| error.to_string())
    }

    #[test]
    fn slips_of_the_pen_are_told_with_line_and_word() {
        let shape = "<geometry><box size='1 1 1'/></geometry>";
        assert_eq!(said(&format!("<collision>{shape}</collision>")), None);
        assert_eq!(
            said(&format!("<colision>{shape}</colision>")).unwrap(),
            "line 3: there is no element `colision` here, did you mean `collision`?"
        );
        let attribute = said("<collision><geometry><mesh filname='a.stl'/></geometry></collision>").unwrap();
        assert_eq!(attribute, "line 3: there is no attribute `filname` here, did you mean `filename`?");
        assert!(said("<Collision/>").unwrap().contains("did you mean `collision`?"));
    }

    #[test]
    fn what_xacro_left_is_refused() {
        let message = said("<xacro:insert_block name='b'/>").unwrap();
        assert!(message.contains("line 3") && message.contains("<xacro:insert_block>"), "{message}");
        let message = said("<collision><geometry><sphere radius='${r}'/></geometry></collision>").unwrap();
        assert!(message.contains("radius=\"${r}\""), "{message}");
    }

    #[test]
    fn what_planning_does_not_use_may_be_named_as_it_likes() {
        for other in ["<inertia/>", "<inertial><mas/></inertial>", "<visual><materal/></visual>", "<self_collide/>"] {
            assert_eq!(said(other), None, "{other}");
        }
    }
}
