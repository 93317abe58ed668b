//! What a person should know of a robot file before planning with it: what was understood, and what is odd.

use std::path::Path;

use darrt_core::random::{Purpose, Stream, stream};
use darrt_primitives::joints::Joints;
use darrt_primitives::kinematics::{KinematicTree, PairFate};
use darrt_primitives::laws::{ManipulatorClaims, ReachClaims, check_manipulator, check_reaches};
use darrt_primitives::manipulator::{Configuration, JointVector as _, LinkGroup, Manipulator as _};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::RngExt as _;

use super::apart::{distances, drawn_arm};
use super::load::Loaded;
use super::sampled::{self, JOINED, Pair, Pairs, Rule};
use super::{FileRobot, abilities, shipped, trial};
use crate::problem_file::Limits;
use crate::robot_file::{RobotFileError, Source};
use crate::text::counted;

/// Pairs of configurations for which the laws are run.
const LAW_PAIRS: u64 = 6;
/// Poses for which the inverse is asked.
const POSES: usize = 200;
/// Share of them that should be found.
const FOUND: f64 = 0.95;
/// From this share on it is said that a pair touches which is not checked.
const SELDOM: f64 = 1e-3;
/// So many of a list are shown.
const SHOWN: usize = 5;
/// Heights at which a hand that points down is tried, metres: from 0 in steps, so many.
const HEIGHTS: (f64, u32) = (0.1, 21);
/// Distances from the base at which it is tried, metres.
const DISTANCES_M: [f64; 7] = [0.2, 0.3, 0.45, 0.6, 0.75, 0.9, 1.05];

/// How far to the left of straight ahead, metres.
const SIDES_M: [f64; 3] = [0.0, -0.3, 0.3];
/// So far before the base a hand works at least, metres.
const BEFORE_M: f64 = 0.17;

/// At which heights, lowest and highest, and how far ahead a hand that points down reaches, metres.
type Reach = Option<([f64; 2], f64)>;

/// What was found.
#[derive(Debug, Clone)]
pub struct Inspection {
    /// The robot's name.
    pub name: String,
    /// What was understood, a line each.
    pub understood: Vec<String>,
    /// What is odd, a line each, with file and line.
    pub odd: Vec<String>,
    /// Every pair of links with shapes, a line each: is it checked, and why.
    pub pairs: Vec<String>,
    /// The names of its postures.
    pub postures: Vec<String>,
    /// Its base drives.
    pub drives: bool,
    /// At which heights the (first) hand that points down reaches, lowest and highest, and how far ahead, metres.
    pub reach_down: Option<([f64; 2], f64)>,
    /// Where the table of its first problem stands.
    pub place: trial::Place,
}

/// Reads a robot file, or a robot that comes with the program, as planning would, and tries it.
///
/// # Errors
/// [`RobotFileError`] for what planning would refuse.
pub fn inspect(name_or_path: &str) -> Result<Inspection, RobotFileError> {
    let shipped = shipped::all().iter().find(|robot| robot.name == name_or_path);
    let loaded = match shipped {
        Some(robot) => Loaded::new(Source::from_text(robot.text, robot.name)?, Some(robot.urdf))?,
        None => Loaded::new(Source::read(Path::new(name_or_path))?, None)?,
    };
    let robot = loaded.robot(Limits::Soft, [0.0; 3])?;
    let mut odd = Vec::new();
    postures(&loaded, &robot, &mut odd);
    let pairs = sampled::pairs(&loaded, &robot)?;
    self_touching(&loaded, &pairs, &mut odd);
    remarks(&loaded, &mut odd);
    joints(&loaded, &mut odd);
    pads(&loaded, &robot, &mut odd);
    for hand in 0..robot.hands() {
        let found = share_found(&robot, hand);
        if found < FOUND {
            odd.push(format!(
                "{}: of {POSES} poses that the {} can reach the numeric inverse finds {:.0} %",
                loaded.source.name,
                named(&robot, hand, "tool"),
                100.0 * found
            ));
        }
    }
    if let Some(broken) = laws(&loaded.with_all_pairs().robot(Limits::Soft, [0.0; 3])?) {
        odd.push(format!("{}: a law of robots does not hold: {broken}", loaded.source.name));
    }
    let reaches: Vec<_> = (0..robot.hands()).map(|hand| reach_down(&robot, hand)).collect();
    for ((hand, reach), tables) in reaches.iter().enumerate().zip(loaded.source.file.arms()) {
        let pushes = matches!(robot.hand_ties_of(hand).pushing(false), Some(Some(_)));
        if reach.is_none() && !pushes {
            odd.push(format!(
                "{}:{}: a {} that points down (tool x axis) reaches nowhere around the base; the primitives push, pick and place with \
                 it",
                loaded.source.name,
                loaded.source.line(&tables.key("tool")),
                named(&robot, hand, "hand")
            ));
        }
    }
    let reach_down = reaches.first().copied().flatten();
    Ok(Inspection {
        name: loaded.source.file.name.clone(),
        understood: understood(&loaded, &robot, &pairs, &reaches),
        pairs: pairs.all.iter().map(|pair| line(pair, pairs.samples)).collect(),
        odd,
        postures: robot.postures.keys().cloned().collect(),
        drives: robot.base_kind.drives(),
        place: trial::place(&robot, (&robot.home, &robot.postures), reach_down),
        reach_down,
    })
}

fn line(pair: &Pair, samples: usize) -> String {
    format!("{} with {}: {}", pair.links[0], pair.links[1], pair.reason(samples))
}

/// A thing of the robot that each of its hands has: which one of two, by its number from 1.
fn named(robot: &FileRobot, hand: usize, what: &str) -> String {
    if robot.hands() == 1 { what.to_owned() } else { format!("{what} {}", hand + 1) }
}

fn understood(loaded: &Loaded, robot: &FileRobot, pairs: &Pairs, reaches: &[Reach]) -> Vec<String> {
    let file = &loaded.source.file;
    let mut lines = vec![format!("base:     {:?}", file.base.kind).to_lowercase()];
    lines.extend(abilities::lines(robot));
    for ((name, limit), speed) in loaded.amended.arm_joints.iter().zip(&robot.limits).zip(&robot.speeds.joints) {
        let range = if limit.is_unlimited() {
            "without limits".to_owned()
        } else {
            format!("{:.3} to {:.3}", limit.lower, limit.upper)
        };
        lines.push(format!("joint:    {name}, {range}, planned at {speed:.2} per second"));
    }
    for (group, what) in [
        (LinkGroup::Base, "rigid to the base"),
        (LinkGroup::Arm, "of the arm"),
        (LinkGroup::Hand, "of the hand"),
        (LinkGroup::Finger, "of the fingers"),
    ] {
        let names: Vec<_> = robot.links().iter().filter(|l| l.group == group).map(|l| &*l.body.name).collect();
        lines.push(format!("links:    {} {what}: {}", names.len(), names.join(", ")));
    }
    for (number, arm) in loaded.amended.arms().enumerate() {
        let hand = robot.hand_of(number);
        let which = if robot.hands() == 1 {
            String::new()
        } else {
            format!("{} at `{}`, moved by {} joints, ", number + 1, arm.tool_link, arm.joints.len())
        };
        lines.push(format!(
            "hand:     {which}opens to {:.1} mm, reaches {:.1} mm beyond the tool frame when closed, tips {:.1} mm wide",
        1e3 * hand.max_gap_m(),
        1e3 * hand.tip_beyond_tool_m(0.0),
        2e3 * hand.tip_half_width_m()
    ));
    }
    let straightened = &loaded.amended.straightened;
    if !straightened.is_empty() {
        lines.push(format!("straight: angles of {} are taken as right ones", straightened.join(", ")));
    }
    if let Some(semantic) = &loaded.semantic {
        lines.push(format!("srdf:     {}", semantic.path.display()));
    }
    let count = |is_it: &dyn Fn(&Pair) -> bool| pairs.all.iter().filter(|pair| is_it(pair)).count();
    lines.push(format!(
        "pairs:    {} of links are kept apart, {} of which touch in none of {} samples; not checked are {} by `ignore`, {} by the \
         SRDF, {} of the hand, {} that are neighbours or that nothing moves",
        robot.self_pairs().len(),
        count(&|pair| pair.rule == Rule::Checked && pair.fate == PairFate::Never),
        pairs.samples,
        count(&|pair| pair.rule == Rule::File),
        count(&|pair| matches!(pair.rule, Rule::Srdf(_))),
        count(&|pair| pair.rule == Rule::Hand),
        count(&|pair| pair.rule == Rule::Structure)
    ));
    for (hand, reach) in reaches.iter().enumerate() {
        let Some(([low, high], distance)) = reach else { continue };
        lines.push(format!(
            "reach:    pointing down {distance} m ahead, {} from {low:.1} to {high:.1} m above the floor",
            named(robot, hand, "tool")
        ));
    }
    lines
}

fn rng(number: u64) -> Stream {
    stream(0, number, 0, Purpose::Extend)
}

fn drawn(robot: &FileRobot, hand: usize, rng: &mut Stream) -> Option<Configuration<Joints>> {
    Some(Configuration { base: [0.0; 3], arm: drawn_arm(robot, rng)?.with_hand_at_work(hand) })
}

/// How far the hand is open while links are looked at, metres.
fn gap_m(robot: &FileRobot) -> f64 {
    0.8 * robot.hand().max_gap_m()
}

/// How many poses that the tool of a hand can reach are found.
fn share_found(robot: &FileRobot, hand: usize) -> f64 {
    let mut rng = rng(1);
    let found = (0..POSES).filter(|_| {
        drawn(robot, hand, &mut rng)
            .is_some_and(|q| robot.inverse_from(&q.arm, &q.base, &robot.world_from_tool(&q), &mut rng).is_some())
    });
    found.count() as f64 / POSES as f64
}

/// The first law that is broken, in words.
fn laws(robot: &FileRobot) -> Option<String> {
    (0..robot.hands()).find_map(|hand| laws_at_work(robot, hand))
}

/// The same while one of the hands is at work.
fn laws_at_work(robot: &FileRobot, hand: usize) -> Option<String> {
    let mut rng = rng(2);
    let max_gap_m = robot.hand_of(hand).max_gap_m();
    // A base that is bolted down has one place.
    let place = |rng: &mut Stream| {
        if robot.base_kind.drives() {
            [rng.random_range(-1.0..1.0), 0.3, rng.random_range(-3.0..3.0)]
        } else {
            [0.0; 3]
        }
    };
    let mut configurations = Vec::new();
    for seed in 0..LAW_PAIRS {
        let (mut a, mut b) = (drawn(robot, hand, &mut rng)?, drawn(robot, hand, &mut rng)?);
        (a.base, b.base) = (place(&mut rng), place(&mut rng));
        let gaps = [0.25 * max_gap_m, max_gap_m];
        if let Err(broken) = check_manipulator(robot, [&a, &b], gaps, seed, &ManipulatorClaims::default()) {
            return Some(broken.to_string());
        }
        configurations.extend([a, b]);
    }
    check_reaches(robot, &configurations, 0, &ReachClaims { inverse: 0.5, base: 0.2, ..ReachClaims::default() })
        .err()
        .map(|broken| broken.to_string())
}

/// Postures in which links touch.
fn postures(loaded: &Loaded, robot: &FileRobot, odd: &mut Vec<String>) {
    for (name, arm) in &robot.postures {
        let pairs = robot.self_pairs();
        let touching = distances(robot, arm, gap_m(robot), pairs).zip(pairs).filter(|(distance, _)| *distance <= 0.0);
        let names: Vec<_> = touching.map(|(_, pair)| pair_name(robot, *pair)).collect();
        if !names.is_empty() {
            let place = format!("{}:{}", loaded.source.name, loaded.source.line(&format!("postures.{name}")));
            odd.push(format!(
                "{place}: in the posture `{name}` {} touch: {}",
                counted(names.len() as u64, "pair"),
                names.join(", ")
            ));
        }
    }
}

fn pair_name(robot: &FileRobot, (a, b): (usize, usize)) -> String {
    let name = |link: usize| robot.links().get(link).map_or("link", |l| &*l.body.name);
    format!("{} with {}", name(a), name(b))
}

/// Pairs that are checked and touch nearly always, with which nothing could ever be planned, and pairs that are not checked and
/// touch now and then, which no plan avoids.
fn self_touching(loaded: &Loaded, pairs: &Pairs, odd: &mut Vec<String>) {
    let name = &loaded.source.name;
    for pair in pairs.all.iter().filter(|pair| pair.is_joined(pairs.samples)) {
        odd.push(format!(
            "{name}: {} with {} touch in {:.0} % of all configurations; if they are joined, add them to `ignore`",
            pair.links[0],
            pair.links[1],
            100.0 * pair.share(pairs.samples)
        ));
    }
    for (key, is_of) in
        [("ignore", (|rule| *rule == Rule::File) as fn(&Rule) -> bool), ("srdf", |rule| matches!(rule, Rule::Srdf(_)))]
    {
        let seldom = |pair: &&Pair| is_of(&pair.rule) && (SELDOM..JOINED).contains(&pair.share(pairs.samples));
        let named = pairs.all.iter().filter(seldom).map(|pair| {
            format!("{} with {} ({:.0} %)", pair.links[0], pair.links[1], 100.0 * pair.share(pairs.samples))
        });
        let named: Vec<_> = named.collect();
        if !named.is_empty() {
            odd.push(format!(
                "{name}:{}: `{key}` says not to check {}, of which the shapes touch in some configurations: {}",
                loaded.source.line(key),
                counted(named.len() as u64, "pair"),
                shortened(&named)
            ));
        }
    }
}

/// The first of a list, and how many there are besides.
fn shortened(list: &[String]) -> String {
    let shown = list.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    match list.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown}, and {more} more"),
    }
}

/// What the SRDF says that was not understood.
fn remarks(loaded: &Loaded, odd: &mut Vec<String>) {
    let Some(semantic) = &loaded.semantic else { return };
    let said = semantic.description.remarks.iter();
    let said: Vec<_> = said.map(|remark| format!("line {}: {}", remark.line, remark.text)).collect();
    if !said.is_empty() {
        odd.push(format!("{}: {}", semantic.path.display(), shortened(&said)));
    }
}

/// Joints of an arm of which the description says less than planning with times needs, or allows less than the robot file says.
fn joints(loaded: &Loaded, odd: &mut Vec<String>) {
    let Ok(tree) = KinematicTree::new(&loaded.amended.description) else { return };
    let file = &loaded.source.name;
    for (tables, arm) in loaded.source.file.arms().zip(loaded.amended.arms()) {
        let key = tables.key("arm.speeds");
        for (index, name) in arm.joints.iter().enumerate() {
            let variable = tree.variable_index(name).and_then(|index| tree.variables().get(index));
            let Some(most) = variable.map(|v| v.max_velocity) else { continue };
            match tables.arm.speeds.as_ref().map(|speeds| speeds.get(index)) {
                None if most <= 0.0 => odd.push(format!(
                    "{file}: the description gives `{name}` no speed, it is planned with 1 per second: see `{key}`"
                )),
                Some(Some(speed)) if most > 0.0 && *speed > most => odd.push(format!(
                    "{file}:{}: `{key}` has {speed} for `{name}`, the description allows {most}: its clock keeps to that",
                    loaded.source.line(&key)
                )),
                _ => {}
            }
        }
    }
}

/// Pads that are longer than the tips: a length that was not measured, or a tool frame that does not look out of the hand.
fn pads(loaded: &Loaded, robot: &FileRobot, odd: &mut Vec<String>) {
    for (number, tables) in loaded.source.file.arms().enumerate() {
        let hand = robot.hand_of(number);
        let (said_m, long_m) = (tables.gripper.pad_length_m, hand.pad_length_m());
        if long_m >= said_m {
            continue;
        }
        let [said, long, wide] = [said_m, long_m, 2.0 * hand.tip_half_width_m()].map(|metres| 1000.0 * metres);
        let key = tables.key("gripper.pad_length_m");
        odd.push(format!(
            "{}:{}: `{key}` is {said:.1} mm, but the tips are {long:.1} mm long (along x of the tool frame) and \
             {wide:.1} mm wide (z): they count as long as they are; does x point out of the hand?",
            loaded.source.name,
            loaded.source.line(&key),
        ));
    }
}

/// At which heights one of the hands that points down reaches, at the distance where the range is the largest.
fn reach_down(robot: &FileRobot, hand: usize) -> Reach {
    let mut rng = rng(4);
    let mut best: Reach = None;
    let down = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), std::f64::consts::FRAC_PI_2);
    // Not above what carries the arm, where no table can be.
    let (_, front) = robot.base_extent_m();
    for distance in DISTANCES_M.into_iter().filter(|distance| *distance >= front + BEFORE_M) {
        let mut reached = (0..HEIGHTS.1).map(|i| f64::from(i) * HEIGHTS.0).filter(|height| {
            // In front, and a little to either side: an arm may be mounted there.
            SIDES_M.into_iter().any(|side| {
                let tool = Isometry3::from_parts(Vector3::new(distance, side, *height).into(), down);
                robot.arm_at(hand, &tool, &mut rng).is_some()
            })
        });
        let Some(low) = reached.next() else { continue };
        let high = reached.last().unwrap_or(low);
        if best.is_none_or(|([l, h], _)| high - low > h - l) {
            best = Some(([low, high], distance));
        }
    }
    best
}
