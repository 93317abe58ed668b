//! A first robot file for a description: what can be guessed, with comments that say what to look at.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use darrt_primitives::kinematics::urdf::JointKind;
use darrt_primitives::kinematics::{RobotDescription, folders_above, mesh_folders};

use super::load::Loaded;
use crate::robot_file::{RobotFileError, Source};

mod hand;
mod posture;

use hand::HandGuess;

/// So many joints an arm is guessed to have at most: what is further in is a lift or a waist, and rests.
const MOST_ARM_JOINTS: usize = 7;

/// The text of a robot file for the description at `urdf`, to be written into the folder `beside`.
///
/// # Errors
/// [`RobotFileError`] for a description that cannot be read, or in which there is nothing like a hand with two fingers at the end
/// of an arm.
pub fn robot_file(urdf: &Path, beside: &Path) -> Result<String, RobotFileError> {
    let name = urdf.display().to_string();
    let wrong = |source| RobotFileError::Description { file: name.clone(), source };
    let description = RobotDescription::from_file(urdf).map_err(wrong)?;
    let folders = folders_above(urdf);
    let refuse = |why: &str| RobotFileError::Invalid {
        file: name.clone(),
        line: 1,
        key: "robot".to_owned(),
        why: why.to_owned(),
    };
    let hand = hand::guess(&description, &mesh_folders(&folders)).map_err(|why| refuse(&why))?;
    let shapeless = description.links.iter().filter(|link| link.has_visual && link.collision.is_empty());
    let guess = Guess {
        name: file_name(&description, urdf),
        urdf: seen_from(urdf, beside),
        shapeless: shapeless.map(|link| link.name.to_string()).collect(),
        arm: arm(&description, &hand).ok_or_else(|| refuse("has no joint between its root and its hand"))?,
        hand,
        home: Vec::new(),
        base_z: 0.0,
        ignore: Vec::new(),
    };
    // Read with all joints where they are nearest to 0, it tells which postures are of use.
    let home = guess.arm.joints.iter().filter_map(|name| {
        let joint = description.joints.iter().find(|joint| *joint.name == **name)?;
        Some(joint.soft_limit.clamp(0.0))
    });
    let guess = Guess { home: home.collect(), ..guess };
    // What cannot be read is written all the same: `darrt robot check` says what is wrong with it.
    let Ok(robot) = loaded(&guess, urdf).and_then(|loaded| loaded.robot_anywhere()) else { return Ok(guess.text()) };
    let (lowest_m, _) = robot.base_extent_m();
    let base_z = if lowest_m < 0.0 { (-lowest_m * 1e4).ceil() / 1e4 } else { 0.0 };
    let guess = Guess { base_z, ..guess };
    let (home, ignore) = posture::search(&loaded(&guess, urdf)?)?;
    let home = home.unwrap_or_else(|| guess.home.clone());
    Ok(Guess { home, ignore, ..guess }.text())
}

/// As a robot file beside its description.
fn loaded(guess: &Guess, urdf: &Path) -> Result<Loaded, RobotFileError> {
    let mut source = Source::from_text(&guess.text(), "the guess")?;
    source.file.urdf = urdf.to_path_buf();
    Loaded::new(source, None)
}

fn file_name(description: &RobotDescription, urdf: &Path) -> String {
    let stem = urdf.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let name = if description.name.is_empty() { stem } else { description.name.clone() };
    let letter = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c.to_ascii_lowercase() } else { '-' };
    let name: String = name.chars().map(letter).take(60).collect();
    if name.is_empty() { "robot".to_owned() } else { name }
}

fn seen_from(urdf: &Path, folder: &Path) -> PathBuf {
    match (urdf.canonicalize(), folder.canonicalize()) {
        (Ok(urdf), Ok(folder)) => urdf.strip_prefix(&folder).map(Path::to_path_buf).unwrap_or(urdf),
        _ => urdf.to_path_buf(),
    }
}

struct ArmGuess {
    from: String,
    to: String,
    joints: Vec<String>,
}

/// The last joints between root and hand.
fn arm(description: &RobotDescription, hand: &HandGuess) -> Option<ArmGuess> {
    let index = |name: &str| description.links.iter().position(|link| *link.name == *name);
    let mut at = index(&hand.link)?;
    let mut to = None;
    let mut joints = Vec::new();
    let mut from = at;
    while let Some(joint) = description.joints.iter().find(|joint| joint.child == at) {
        at = joint.parent;
        if joint.kind == JointKind::Fixed || joint.mimic.is_some() {
            continue;
        }
        if joints.len() == MOST_ARM_JOINTS {
            break;
        }
        to.get_or_insert(joint.child);
        joints.push(joint.name.to_string());
        from = joint.parent;
    }
    joints.reverse();
    let name = |link: usize| description.links.get(link).map(|link| link.name.to_string());
    Some(ArmGuess { from: name(from)?, to: name(to?)?, joints })
}

/// What goes into the file.
struct Guess {
    name: String,
    urdf: PathBuf,
    shapeless: Vec<String>,
    arm: ArmGuess,
    hand: HandGuess,
    home: Vec<f64>,
    /// How far the root must be raised, metres.
    base_z: f64,
    ignore: Vec<[String; 2]>,
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn numbers(values: &[f64]) -> String {
    let values = values.iter().map(|value| {
        let rounded = (value * 1e6).round() / 1e6;
        // No minus before a zero.
        format!("{}", rounded + 0.0)
    });
    format!("[{}]", values.collect::<Vec<_>>().join(", "))
}

impl Guess {
    fn text(&self) -> String {
        let names =
            |list: &[String]| format!("[{}]", list.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(", "));
        let mut out = String::new();
        let mut line = |text: String| {
            // Writing to a text does not fail.
            let _ = writeln!(out, "{text}");
        };
        line(
            "# A first robot file, guessed from the description. Look at every line with a question mark, then run"
                .to_owned(),
        );
        line("# `darrt robot check` on it. `docs/robot-format.md` explains all keys.".to_owned());
        line("format = \"darrt-robot\"\nversion = 1".to_owned());
        line(format!("name = {}", quoted(&self.name)));
        line(format!("urdf = {}", quoted(&self.urdf.to_string_lossy())));
        if !self.shapeless.is_empty() {
            line(format!(
                "# ? These links are seen but have no collision shape: planned as if they were air.\nshapeless = {}",
                names(&self.shapeless)
            ));
        }
        line("home = \"home\"".to_owned());
        if !self.ignore.is_empty() {
            line("# ? These pairs touch in nearly all configurations that were tried: are they joined?".to_owned());
            let pairs: Vec<_> = self.ignore.iter().map(|pair| format!("  {},", names(pair))).collect();
            line(format!("ignore = [\n{}\n]", pairs.join("\n")));
        }
        line(
            "\n[base]\nkind = \"planar\"                 # ? fixed: bolted down; planar: drives any way; rail"
                .to_owned(),
        );
        if self.base_z > 0.0 {
            line(format!("xyz = [0, 0, {}]            # its lowest point is on the floor", self.base_z));
        }
        line(format!("\n[arm]                           # joints: {}", self.arm.joints.join(", ")));
        line(format!("from = {}\nto = {}", quoted(&self.arm.from), quoted(&self.arm.to)));
        line("payload_kg = 1.0                # ? see the data sheet\npush_force_n = 20               # ? sideways, at the hand".to_owned());
        line("\n[tool]                          # ? x out of the hand, y the way the fingers open, in the middle between the pads".to_owned());
        let hand = &self.hand;
        line(format!("link = {}\nxyz = {}\nrpy = {}", quoted(&hand.link), numbers(&hand.xyz), numbers(&hand.rpy)));
        line(format!("\n[gripper]\njoint = {}", quoted(&hand.joint)));
        line(format!("tips = {}      # that on the side of the tool's +y first", names(&hand.tips)));
        line(format!(
            "pad_length_m = {}            # ? from the tip back",
            numbers(&[hand.pad_length_m]).trim_matches(['[', ']'])
        ));
        line("grip_force_n = 30               # ? of each finger".to_owned());
        for (name, multiplier) in &hand.follow {
            line(format!(
                "follow.{} = {{ multiplier = {multiplier} }}     # ? the description lets it move freely",
                quoted(name)
            ));
        }
        line(format!(
            "\n[postures]                      # a value for each joint of the arm\nhome = {}",
            numbers(&self.home)
        ));
        out
    }
}
