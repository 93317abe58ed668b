//! From text to a [`SemanticDescription`]: names first, then what refers to them.

use std::collections::{BTreeMap, BTreeSet};

use roxmltree::{Document, Node};

use super::{
    AnyJoint, DisabledPair, EndEffector, Group, GroupState, Remark, SemanticDescription, SrdfError, VirtualJoint,
    VirtualKind,
};
use crate::kinematics::guard::bounded;
use crate::kinematics::urdf::{JointKind, RobotDescription};

/// Reads and resolves; `text` has passed the guard.
pub(super) fn read(text: &str, robot: &RobotDescription) -> Result<SemanticDescription, SrdfError> {
    let document = Document::parse(text).map_err(|error| SrdfError::Syntax { message: error.to_string() })?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let message = format!("its root is <{}>, not <robot>", root.tag_name().name());
        return Err(SrdfError::Syntax { message });
    }
    let mut reader = Reader::new(&document, robot);
    reader.names(root)?;
    for node in root.children().filter(Node::is_element) {
        reader.element(node)?;
    }
    reader.resolve_groups()?;
    reader.out.remarks.sort_by_key(|remark| remark.line);
    Ok(reader.out)
}

/// Most groups, and most chains of all groups together: resolving them takes their number times the size of the robot.
const MOST_GROUPS: usize = 1000;

/// What reading has come to.
struct Reader<'a> {
    document: &'a Document<'a>,
    robot: &'a RobotDescription,
    links: BTreeMap<&'a str, usize>,
    joints: BTreeMap<&'a str, usize>,
    /// The joint above each link.
    above: Vec<Option<usize>>,
    groups: BTreeMap<&'a str, usize>,
    virtual_joints: BTreeMap<&'a str, (usize, VirtualKind)>,
    group_lines: Vec<u32>,
    chains: usize,
    states: BTreeSet<(usize, &'a str)>,
    hands: BTreeSet<&'a str>,
    out: SemanticDescription,
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document<'a>, robot: &'a RobotDescription) -> Self {
        let mut above = vec![None; robot.links.len()];
        for (index, joint) in robot.joints.iter().enumerate() {
            if let Some(slot) = above.get_mut(joint.child) {
                *slot = Some(index);
            }
        }
        Self {
            document,
            robot,
            links: robot.links.iter().enumerate().map(|(i, link)| (&*link.name, i)).collect(),
            joints: robot.joints.iter().enumerate().map(|(i, joint)| (&*joint.name, i)).collect(),
            above,
            groups: BTreeMap::new(),
            virtual_joints: BTreeMap::new(),
            group_lines: Vec::new(),
            chains: 0,
            states: BTreeSet::new(),
            hands: BTreeSet::new(),
            out: SemanticDescription::default(),
        }
    }

    /// The names that elements further up may use: virtual joints and groups.
    fn names(&mut self, root: Node<'a, 'a>) -> Result<(), SrdfError> {
        root.attribute("name").unwrap_or_default().clone_into(&mut self.out.robot);
        if self.out.robot != self.robot.name {
            let text = format!("the robot is called {:?} here and {:?} in its URDF", self.out.robot, self.robot.name);
            self.remark(root, text);
        }
        for node in root.children().filter(Node::is_element) {
            match node.tag_name().name() {
                "group" => {
                    let name = self.attribute(node, "name")?;
                    if self.groups.insert(name, self.groups.len()).is_some() {
                        return Err(self.duplicate(node, name));
                    }
                    bounded("groups", self.groups.len(), MOST_GROUPS)?;
                }
                "virtual_joint" => {
                    let name = self.attribute(node, "name")?;
                    let is_known = self.joints.contains_key(name);
                    let it = (self.virtual_joints.len(), self.kind(node)?);
                    if self.virtual_joints.insert(name, it).is_some() || is_known {
                        return Err(self.duplicate(node, name));
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn element(&mut self, node: Node<'a, 'a>) -> Result<(), SrdfError> {
        match node.tag_name().name() {
            "group" => self.group(node),
            "group_state" => self.state(node),
            "end_effector" => self.end_effector(node),
            "virtual_joint" => self.virtual_joint(node),
            "passive_joint" => {
                if let Some((AnyJoint::Robot(joint), _)) = self.known_joint(node)? {
                    self.out.passive_joints.push(joint);
                }
                Ok(())
            }
            "disable_collisions" => {
                let reason = node.attribute("reason").unwrap_or_default().to_owned();
                if let Some((first, second)) = self.pair(node)? {
                    self.out.disabled.push(DisabledPair { first, second, reason });
                }
                Ok(())
            }
            "enable_collisions" => {
                if let Some(pair) = self.pair(node)? {
                    self.out.enabled.push(pair);
                }
                Ok(())
            }
            "disable_default_collisions" => {
                let link = self.find("link", node, "link")?;
                self.out.disabled_by_default.push(link);
                Ok(())
            }
            _ => {
                self.unknown(node, &KNOWN);
                Ok(())
            }
        }
    }

    fn group(&mut self, node: Node<'a, 'a>) -> Result<(), SrdfError> {
        let name = self.attribute(node, "name")?.to_owned();
        let (mut joints, mut links, mut subgroups) = (BTreeSet::new(), BTreeSet::new(), BTreeSet::new());
        let (mut chains, mut virtual_joints) = (Vec::new(), BTreeSet::new());
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "joint" => match self.known_joint(child)?.map(|(joint, _)| joint) {
                    None => {}
                    Some(AnyJoint::Virtual(joint)) => _ = virtual_joints.insert(joint),
                    Some(AnyJoint::Robot(joint)) => {
                        joints.insert(joint);
                        links.extend(self.robot.joints.get(joint).map(|joint| joint.child));
                    }
                },
                "link" => {
                    let link = self.find("link", child, "name")?;
                    links.insert(link);
                    joints.extend(self.above.get(link).copied().flatten());
                }
                "chain" => {
                    let (base, tip) = (self.find("link", child, "base_link")?, self.find("link", child, "tip_link")?);
                    self.chains += 1;
                    bounded("chains", self.chains, MOST_GROUPS)?;
                    self.walk(child, (base, tip), &mut joints, &mut links)?;
                    chains.push((base, tip));
                }
                "group" => _ = subgroups.insert(self.find("group", child, "name")?),
                _ => self.unknown(child, &["joint", "link", "chain", "group"]),
            }
        }
        self.group_lines.push(self.line(node));
        self.out.groups.push(Group {
            name,
            chains,
            joints: joints.into_iter().collect(),
            virtual_joints: virtual_joints.into_iter().collect(),
            links: links.into_iter().collect(),
            subgroups: subgroups.into_iter().collect(),
        });
        Ok(())
    }

    /// Collects what lies between two links, both of them included.
    fn walk(
        &self,
        node: Node<'_, '_>,
        (base, tip): (usize, usize),
        joints: &mut BTreeSet<usize>,
        links: &mut BTreeSet<usize>,
    ) -> Result<(), SrdfError> {
        let mut link = tip;
        // The robot is a tree, so this ends at its root.
        while link != base {
            links.insert(link);
            let joint = self.above.get(link).copied().flatten();
            let Some((index, joint)) = joint.and_then(|index| Some((index, self.robot.joints.get(index)?))) else {
                let name = |link: usize| self.robot.links.get(link).map_or_else(String::new, |l| l.name.to_string());
                return Err(SrdfError::NotAbove { base: name(base), tip: name(tip), line: self.line(node) });
            };
            joints.insert(index);
            link = joint.parent;
        }
        links.insert(base);
        Ok(())
    }

    fn state(&mut self, node: Node<'a, 'a>) -> Result<(), SrdfError> {
        let name = self.attribute(node, "name")?;
        let group = self.find("group", node, "group")?;
        if !self.states.insert((group, name)) {
            return Err(self.duplicate(node, name));
        }
        let mut joints: Vec<(AnyJoint, Vec<f64>)> = Vec::new();
        let mut seen = BTreeSet::new();
        for child in node.children().filter(Node::is_element) {
            if child.tag_name().name() != "joint" {
                self.unknown(child, &["joint"]);
                continue;
            }
            let name = self.attribute(child, "name")?;
            if !seen.insert(name) {
                return Err(self.duplicate(child, name));
            }
            match self.known_joint(child)? {
                Some((AnyJoint::Robot(_), 0)) => {
                    self.remark(child, format!("the joint {name:?} is fixed: its value says nothing"));
                }
                Some((joint, count)) => joints.push((joint, self.values(child, count)?)),
                None => {}
            }
        }
        self.out.states.push(GroupState { name: name.to_owned(), group, joints });
        Ok(())
    }

    /// As many finite numbers as the joint has.
    fn values(&self, node: Node<'a, 'a>, count: usize) -> Result<Vec<f64>, SrdfError> {
        let text = self.attribute(node, "value")?;
        let values: Option<Vec<f64>> = text.split_whitespace().map(|word| word.parse().ok()).collect();
        match values {
            Some(values) if values.len() == count && values.iter().all(|value| value.is_finite()) => Ok(values),
            _ => Err(self.value(
                node,
                "value",
                text,
                format!("{count} finite number{}", if count == 1 { "" } else { "s" }),
            )),
        }
    }

    fn end_effector(&mut self, node: Node<'a, 'a>) -> Result<(), SrdfError> {
        let name = self.attribute(node, "name")?;
        if !self.hands.insert(name) {
            return Err(self.duplicate(node, name));
        }
        let parent_group = match node.attribute("parent_group") {
            None | Some("") => None,
            Some(_) => Some(self.find("group", node, "parent_group")?),
        };
        let (parent_link, group) = (self.find("link", node, "parent_link")?, self.find("group", node, "group")?);
        self.out.end_effectors.push(EndEffector { name: name.to_owned(), parent_link, group, parent_group });
        Ok(())
    }

    fn virtual_joint(&mut self, node: Node<'a, 'a>) -> Result<(), SrdfError> {
        self.out.virtual_joints.push(VirtualJoint {
            name: self.attribute(node, "name")?.to_owned(),
            kind: self.kind(node)?,
            parent_frame: self.attribute(node, "parent_frame")?.to_owned(),
            child_link: self.find("link", node, "child_link")?,
        });
        Ok(())
    }

    fn kind(&self, node: Node<'a, 'a>) -> Result<VirtualKind, SrdfError> {
        match self.attribute(node, "type")? {
            "fixed" => Ok(VirtualKind::Fixed),
            "planar" => Ok(VirtualKind::Planar),
            "floating" => Ok(VirtualKind::Floating),
            other => Err(self.value(node, "type", other, "fixed, planar or floating".to_owned())),
        }
    }

    /// Two links; `None`, with a remark, when one is not there: lists of pairs are made for several variants of a robot.
    fn pair(&mut self, node: Node<'a, 'a>) -> Result<Option<(usize, usize)>, SrdfError> {
        let mut links = [0; 2];
        for (link, attribute) in links.iter_mut().zip(["link1", "link2"]) {
            let name = self.attribute(node, attribute)?;
            let Some(index) = self.links.get(name) else {
                let element = node.tag_name().name();
                self.remark(node, format!("<{element}> names the link {name:?}, which the robot does not have"));
                return Ok(None);
            };
            *link = *index;
        }
        Ok(Some((links[0], links[1])))
    }

    /// As [`joint`](Self::joint); `None`, with a remark, when it is not there: files name the joint to the world, or those of
    /// other variants of the robot.
    fn known_joint(&mut self, node: Node<'a, 'a>) -> Result<Option<(AnyJoint, usize)>, SrdfError> {
        let name = self.attribute(node, "name")?;
        if self.virtual_joints.contains_key(name) || self.joints.contains_key(name) {
            return self.joint(node).map(Some);
        }
        let element = node.tag_name().name();
        let hint = nearest(name, self.joints.keys().copied())
            .map_or_else(String::new, |word| format!("; did you mean {word:?}?"));
        self.remark(node, format!("<{element}> names the joint {name:?}, which the robot does not have{hint}"));
        Ok(None)
    }

    /// The joint that is named, and how many numbers say where it stands.
    fn joint(&self, node: Node<'a, 'a>) -> Result<(AnyJoint, usize), SrdfError> {
        if let Some((joint, kind)) = self.virtual_joints.get(self.attribute(node, "name")?) {
            return Ok((AnyJoint::Virtual(*joint), kind.values()));
        }
        let joint = self.find("joint", node, "name")?;
        let is_fixed = self.robot.joints.get(joint).is_none_or(|joint| joint.kind == JointKind::Fixed);
        Ok((AnyJoint::Robot(joint), usize::from(!is_fixed)))
    }

    /// The index of what the attribute names.
    fn find(&self, kind: &'static str, node: Node<'a, 'a>, attribute: &'static str) -> Result<usize, SrdfError> {
        let name = self.attribute(node, attribute)?;
        let names = match kind {
            "link" => &self.links,
            "joint" => &self.joints,
            _ => &self.groups,
        };
        names.get(name).copied().ok_or_else(|| SrdfError::Dangling {
            element: node.tag_name().name().to_owned(),
            kind,
            name: name.to_owned(),
            nearest: nearest(name, names.keys().copied()),
            line: self.line(node),
        })
    }

    fn attribute(&self, node: Node<'a, 'a>, attribute: &'static str) -> Result<&'a str, SrdfError> {
        let value = node.attribute(attribute).map(str::trim).filter(|value| !value.is_empty());
        value.ok_or_else(|| SrdfError::Missing {
            element: node.tag_name().name().to_owned(),
            attribute,
            line: self.line(node),
        })
    }

    /// Adds to every group what its subgroups have.
    fn resolve_groups(&mut self) -> Result<(), SrdfError> {
        // Deepest first: a group is done when all its subgroups are.
        let mut is_done = vec![false; self.out.groups.len()];
        for _ in 0..self.out.groups.len() {
            let is_ready = |(index, group): &(usize, &Group)| {
                is_done.get(*index) == Some(&false)
                    && group.subgroups.iter().all(|sub| is_done.get(*sub) == Some(&true))
            };
            let Some((index, group)) = self.out.groups.iter().enumerate().find(is_ready) else { break };
            let mut whole = group.clone();
            for sub in group.subgroups.iter().filter_map(|sub| self.out.groups.get(*sub)) {
                whole.joints.extend(&sub.joints);
                whole.links.extend(&sub.links);
                whole.virtual_joints.extend(&sub.virtual_joints);
            }
            for list in [&mut whole.joints, &mut whole.links, &mut whole.virtual_joints] {
                list.sort_unstable();
                list.dedup();
            }
            self.out.groups[index] = whole;
            is_done[index] = true;
        }
        match is_done.iter().position(|done| !done) {
            None => Ok(()),
            Some(index) => Err(SrdfError::GroupCycle {
                name: self.out.groups.get(index).map_or_else(String::new, |group| group.name.clone()),
                line: self.group_lines.get(index).copied().unwrap_or_default(),
            }),
        }
    }

    fn unknown(&mut self, node: Node<'a, 'a>, known: &[&str]) {
        let name = node.tag_name().name();
        let hint =
            nearest(name, known.iter().copied()).map_or_else(String::new, |word| format!("; did you mean <{word}>?"));
        self.remark(node, format!("<{name}> is not read{hint}"));
    }

    fn remark(&mut self, node: Node<'_, '_>, text: String) {
        self.out.remarks.push(Remark { line: self.line(node), text });
    }

    fn duplicate(&self, node: Node<'_, '_>, name: &str) -> SrdfError {
        let element = node.tag_name().name().to_owned();
        SrdfError::DuplicateName { element, name: name.to_owned(), line: self.line(node) }
    }

    fn value(&self, node: Node<'_, '_>, attribute: &'static str, value: &str, bound: String) -> SrdfError {
        let element = node.tag_name().name().to_owned();
        let value = value.chars().take(80).collect();
        SrdfError::Value { element, attribute, value, bound, line: self.line(node) }
    }

    fn line(&self, node: Node<'_, '_>) -> u32 {
        self.document.text_pos_at(node.range().start).row
    }
}

/// The elements that are read below the root.
const KNOWN: [&str; 8] = [
    "group",
    "group_state",
    "end_effector",
    "virtual_joint",
    "passive_joint",
    "disable_collisions",
    "enable_collisions",
    "disable_default_collisions",
];

/// The known name that is at most two slips away.
fn nearest<'n>(name: &str, known: impl Iterator<Item = &'n str>) -> Option<String> {
    // What is very long is no slip, and takes long to compare.
    let is_near = |word: &&str| word.len().abs_diff(name.len()) <= 2 && name.len() <= 100;
    let close = known.filter(is_near).map(|word| (strsim::osa_distance(name, word), word));
    close.filter(|(distance, _)| *distance <= 2).min().map(|(_, word)| word.to_owned())
}
