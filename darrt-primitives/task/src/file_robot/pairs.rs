//! Which links are checked against each other.

use std::collections::BTreeSet;

use darrt_primitives::kinematics::KinematicTree;
use darrt_primitives::manipulator::{LinkGroup, RobotLink};

use super::chain::Place;
use super::semantic::Semantic;
use crate::robot_file::error::Fault;
use crate::robot_file::{RobotFileError, Source};

/// All pairs that can move against each other, but for neighbours, parts of one hand, and those that the file or its SRDF says to
/// ignore; indices into `links`. `numbers` are the links in the tree, `owners` the arms that they belong to.
pub(super) fn pairs(
    (source, semantic): (&Source, Option<&Semantic>),
    tree: &KinematicTree,
    numbers: &[usize],
    (places, owners): (&[Place], &[usize]),
    links: &[RobotLink],
) -> Result<Vec<(usize, usize)>, RobotFileError> {
    for (index, pair) in source.file.ignore.iter().enumerate() {
        if let Some(name) = pair.iter().find(|name| tree.link_index(name).is_none()) {
            let known = tree.link_names().iter().map(|name| &**name);
            return Err(source.located(Fault::unknown(format!("ignore[{index}]"), "link", name, known)));
        }
    }
    // A link's shapes may be those of a pad beside it.
    let of_link = |name: &str| -> Vec<usize> {
        let pad = format!("{name}_pad");
        let named = links.iter().enumerate().filter(|(_, l)| *l.body.name == *name || *l.body.name == *pad);
        named.map(|(index, _)| index).collect()
    };
    let mut ignored = BTreeSet::new();
    let disabled = semantic.into_iter().flat_map(|semantic| &semantic.disabled).map(|disabled| &disabled.links);
    for [a, b] in source.file.ignore.iter().chain(disabled) {
        let others = of_link(b);
        ignored.extend(of_link(a).into_iter().flat_map(|a| others.iter().map(move |b| (a.min(*b), a.max(*b)))));
    }
    let is_hand = |link: usize| links.get(link).is_some_and(|l| matches!(l.group, LinkGroup::Hand | LinkGroup::Finger));
    let is_of_one_arm = |a: usize, b: usize| owners.get(a) == owners.get(b);
    let is_rigid = |a: usize, b: usize| match (places.get(a), places.get(b)) {
        (Some(at), Some(bt)) => {
            is_of_one_arm(a, b) && at.anchor == bt.anchor && at.steps.is_empty() && bt.steps.is_empty()
        }
        _ => false,
    };
    let all = (0..links.len()).flat_map(|a| (a + 1..links.len()).map(move |b| (a, b)));
    let kept = all.filter(|&(a, b)| {
        let neighbours = || match (numbers.get(a), numbers.get(b)) {
            (Some(a), Some(b)) => above(tree, numbers, *a) == Some(*b) || above(tree, numbers, *b) == Some(*a),
            _ => false,
        };
        let is_of_hand = is_hand(a) && is_hand(b) && is_of_one_arm(a, b);
        !(is_rigid(a, b) || is_of_hand || neighbours() || ignored.contains(&(a, b)))
    });
    Ok(kept.collect())
}

/// The nearest link above that has a shape.
fn above(tree: &KinematicTree, numbers: &[usize], link: usize) -> Option<usize> {
    let mut at = tree.parent(link)?;
    while !numbers.contains(&at) {
        at = tree.parent(at)?;
    }
    Some(at)
}
