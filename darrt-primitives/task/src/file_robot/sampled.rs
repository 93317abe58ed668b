//! Every pair of links with its reason: is it checked, and what a few thousand configurations say of it.

use std::collections::BTreeMap;

use darrt_core::random::{Purpose, stream};
use darrt_primitives::kinematics::pair_sampling::USUAL_SAMPLES;
use darrt_primitives::kinematics::{PairFate, sample_pairs};
use darrt_primitives::manipulator::{LinkGroup, Manipulator as _};

use super::FileRobot;
use super::load::Loaded;
use crate::robot_file::error::Fault;
use crate::robot_file::{RobotFile, RobotFileError};

/// A pair that touches in so large a share of all configurations is joined there: its shapes reach into each other.
pub(super) const JOINED: f64 = 0.9;

/// Why a pair is checked or is not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Rule {
    /// It is checked.
    Checked,
    /// Nothing that is planned moves them against each other, or they are neighbours.
    Structure,
    /// Both are of one hand.
    Hand,
    /// The robot file says so.
    File,
    /// The SRDF does, for this reason.
    Srdf(String),
}

/// A pair of links.
#[derive(Debug, Clone)]
pub(super) struct Pair {
    /// Their names in the description; pads are called after their tips.
    pub(super) links: [String; 2],
    pub(super) rule: Rule,
    pub(super) fate: PairFate,
}

/// All pairs of links with shapes.
#[derive(Debug, Clone)]
pub(super) struct Pairs {
    pub(super) samples: usize,
    pub(super) all: Vec<Pair>,
}

impl Pair {
    /// In which share of the samples they touched.
    pub(super) fn share(&self, samples: usize) -> f64 {
        match self.fate {
            PairFate::Always => 1.0,
            PairFate::Sometimes { hits } => hits as f64 / samples as f64,
            PairFate::Rigid | PairFate::Adjacent | PairFate::Never => 0.0,
        }
    }

    /// Is it checked, and do its links stand in each other?
    pub(super) fn is_joined(&self, samples: usize) -> bool {
        self.rule == Rule::Checked && self.share(samples) >= JOINED
    }

    /// In words: whether it is checked, why, and what was seen.
    pub(super) fn reason(&self, samples: usize) -> String {
        let seen = match self.fate {
            PairFate::Rigid => "no joint moves them against each other".to_owned(),
            PairFate::Adjacent => "neighbours".to_owned(),
            PairFate::Always => format!("touch in all of {samples} samples"),
            PairFate::Never => format!("touch in none of {samples} samples"),
            PairFate::Sometimes { hits } => format!("touch in {hits} of {samples} samples"),
        };
        match &self.rule {
            Rule::Checked => format!("checked: {seen}"),
            Rule::Structure => match self.fate {
                PairFate::Rigid | PairFate::Adjacent => format!("not checked: {seen}"),
                _ => format!("not checked: neighbours, or nothing that is planned moves them; {seen}"),
            },
            Rule::Hand => format!("not checked: parts of one hand; {seen}"),
            Rule::File => format!("not checked: `ignore`; {seen}"),
            Rule::Srdf(reason) if reason.is_empty() => format!("not checked: disabled by the SRDF; {seen}"),
            Rule::Srdf(reason) => format!("not checked: disabled by the SRDF ({reason}); {seen}"),
        }
    }
}

/// Looks at all pairs of links at random configurations of arm and hand, all else at rest.
///
/// # Errors
/// [`RobotFileError`] for a description or shapes that cannot be used.
pub(super) fn pairs(loaded: &Loaded, robot: &FileRobot) -> Result<Pairs, RobotFileError> {
    let (tree, bodies) = loaded.solids()?;
    let rest = &loaded.amended.rest;
    let held: Vec<_> = rest.iter().filter_map(|(name, value)| Some((tree.variable_index(name)?, *value))).collect();
    let mut rng = stream(0, 3, 0, Purpose::Extend);
    let found = sample_pairs(tree, bodies, &held, (0.0, USUAL_SAMPLES), &mut rng)
        .map_err(|error| loaded.source.located(Fault::new("urdf", format!("cannot be used: {error}"))))?;
    let links: BTreeMap<&str, usize> =
        robot.links().iter().enumerate().map(|(index, link)| (&*link.body.name, index)).collect();
    let all = found.pairs.iter().filter_map(|pair| {
        let [a, b] = [pair.first, pair.second].map(|link| tree.link_names().get(link).map(|name| &**name));
        let (a, b) = (a?, b?);
        let [first, second] = [*links.get(a)?, *links.get(b)?];
        let names = [a, b].map(|name| of_pad(&loaded.source.file, name).to_owned());
        let is_checked = robot.self_pairs().contains(&(first.min(second), first.max(second)));
        let rule = if is_checked { Rule::Checked } else { rule(loaded, robot, [first, second], &names) };
        Some(Pair { links: names, rule, fate: pair.fate })
    });
    Ok(Pairs { samples: found.samples, all: all.collect() })
}

/// The tip that a pad covers; any other link is itself.
fn of_pad<'a>(file: &RobotFile, name: &'a str) -> &'a str {
    let is_tip = |tip: &&str| file.arms().any(|tables| tables.gripper.tips.iter().any(|known| known == tip));
    let tip = name.strip_suffix("_pad").filter(is_tip);
    tip.unwrap_or(name)
}

/// Why a pair is not checked.
fn rule(loaded: &Loaded, robot: &FileRobot, links: [usize; 2], names: &[String; 2]) -> Rule {
    let is_them = |pair: &[String; 2]| pair == names || (pair[0] == names[1] && pair[1] == names[0]);
    if loaded.source.file.ignore.iter().any(is_them) {
        return Rule::File;
    }
    let disabled = loaded.semantic.iter().flat_map(|semantic| &semantic.disabled);
    if let Some(pair) = disabled.into_iter().find(|pair| is_them(&pair.links)) {
        return Rule::Srdf(pair.reason.clone());
    }
    let is_hand = |link: usize| {
        robot.links().get(link).is_some_and(|link| matches!(link.group, LinkGroup::Hand | LinkGroup::Finger))
    };
    let [a, b] = links;
    let is_one_hand = is_hand(a) && is_hand(b) && robot.hand_of_link(a) == robot.hand_of_link(b);
    if is_one_hand { Rule::Hand } else { Rule::Structure }
}
