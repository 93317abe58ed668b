//! A guess as the text of a robot file.

use std::fmt::Write as _;
use std::path::PathBuf;

use super::ArmGuess;
use super::hand::HandGuess;
use super::rest::Limb;

/// A posture of the arm that the SRDF names.
pub(super) struct State {
    pub(super) name: String,
    pub(super) values: Vec<f64>,
    /// Is it within the limits of the joints?
    pub(super) is_within: bool,
}

/// What goes into the file.
pub(super) struct Guess {
    pub(super) name: String,
    pub(super) urdf: PathBuf,
    /// The SRDF found beside it.
    pub(super) srdf: Option<PathBuf>,
    pub(super) packages: Vec<(String, PathBuf)>,
    pub(super) shapeless: Vec<String>,
    pub(super) arm: ArmGuess,
    pub(super) hand: HandGuess,
    /// The kind of the base.
    pub(super) base: &'static str,
    /// Where other limbs rest.
    pub(super) rest: Vec<Limb>,
    /// Where the joints stand that lift the arm, metres.
    pub(super) lifts: Vec<(String, f64)>,
    /// Postures of the arm that the SRDF names.
    pub(super) states: Vec<State>,
    /// SRDFs that cannot be read, and why.
    pub(super) unread: Vec<(PathBuf, String)>,
    pub(super) home: Vec<f64>,
    /// Another posture, the hand pointing down.
    pub(super) hand_down: Option<Vec<f64>>,
    /// How far the root must be raised, metres.
    pub(super) base_z: f64,
    /// It is raised as if it stood on something.
    pub(super) pedestal: bool,
    /// With the share of configurations in which they touch.
    pub(super) ignore: Vec<([String; 2], String)>,
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn number(value: f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    // No minus before a zero.
    format!("{}", rounded + 0.0)
}

fn numbers(values: &[f64]) -> String {
    let values = values.iter().map(|value| number(*value));
    format!("[{}]", values.collect::<Vec<_>>().join(", "))
}

impl Guess {
    pub(super) fn text(&self) -> String {
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
        if let Some(srdf) = &self.srdf {
            line(format!(
                "srdf = {}      # found beside it: the pairs that it disables are not checked",
                quoted(&srdf.to_string_lossy())
            ));
        }
        for (path, why) in &self.unread {
            let why = why.split_whitespace().collect::<Vec<_>>().join(" ");
            line(format!("# ? {} lies beside it and {why}", path.display()));
        }
        for (name, path) in &self.packages {
            line(format!("packages.{} = {}", quoted(name), quoted(&path.to_string_lossy())));
        }
        if !self.shapeless.is_empty() {
            line(format!(
                "# ? These links are seen but have no collision shape: planned as if they were air.\nshapeless = {}",
                names(&self.shapeless)
            ));
        }
        line("home = \"home\"".to_owned());
        if !self.ignore.is_empty() {
            line("# ? These pairs touch in so many of all configurations of the arm: are they joined?".to_owned());
            let pairs = self.ignore.iter().map(|(pair, why)| format!("  {}, # {why}", names(pair)));
            let pairs: Vec<_> = pairs.collect();
            line(format!("ignore = [\n{}\n]", pairs.join("\n")));
        }
        line(format!(
            "\n[base]\nkind = {}                 # ? fixed: bolted down; planar: drives any way; differential; rail",
            quoted(self.base)
        ));
        if self.base_z > 0.0 {
            let why = if self.pedestal {
                "# ? as if it stood on something so high; 0 if it stands on the floor"
            } else {
                "# its lowest point is on the floor"
            };
            line(format!("xyz = [0, 0, {}]            {why}", self.base_z));
        }
        line(format!("\n[arm]                           # joints: {}", self.arm.joints.join(", ")));
        line(format!("from = {}\nto = {}", quoted(&self.arm.from), quoted(&self.arm.to)));
        line("payload_kg = 2.0                # ? see the data sheet\npush_force_n = 30               # ? sideways, at the hand".to_owned());
        line("\n[tool]                          # ? x out of the hand, y the way the fingers open, in the middle between the pads".to_owned());
        let hand = &self.hand;
        if let Some(built) = &hand.built {
            line(format!("link = \"hand\"\nxyz = {}", numbers(&hand.xyz)));
            line("\n[hand]                          # ? the description has none: this one of boxes, in the place of yours".to_owned());
            line(format!("on = {}\nxyz = {}\nrpy = {}", quoted(&built.on), numbers(&built.xyz), numbers(&built.rpy)));
            line(format!("palm_m = {}    # along x, y, z", numbers(&built.palm_m)));
            line(format!("finger_m = {}    # length, thickness, width", numbers(&built.finger_m)));
            line(format!("opening_m = {}", built.opening_m));
        } else {
            line(format!("link = {}\nxyz = {}\nrpy = {}", quoted(&hand.link), numbers(&hand.xyz), numbers(&hand.rpy)));
        }
        line(format!("\n[gripper]\njoint = {}", quoted(&hand.joint)));
        line(format!("tips = {}      # that on the side of the tool's +y first", names(&hand.tips)));
        line(format!("pad_length_m = {}            # ? from the tip back", number(hand.pad_length_m)));
        line("grip_force_n = 100              # ? of each finger; see the data sheet".to_owned());
        for (name, multiplier) in &hand.follow {
            line(format!(
                "follow.{} = {{ multiplier = {multiplier} }}     # ? the description lets it move freely",
                quoted(name)
            ));
        }
        self.standing(&mut line);
        out
    }

    /// Where the arm and the other limbs stand.
    fn standing(&self, line: &mut dyn FnMut(String)) {
        line(format!(
            "\n[postures]                      # a value for each joint of the arm\nhome = {}",
            numbers(&self.home)
        ));
        if let Some(values) = &self.hand_down {
            line(format!("hand-down = {}", numbers(values)));
        }
        for State { name, values, is_within } in
            self.states.iter().filter(|state| !["home", "hand-down"].contains(&&*state.name))
        {
            if *is_within {
                line(format!("{} = {}      # of the SRDF", quoted(name), numbers(values)));
            } else {
                line(format!("# beyond the limits of the joints: {} = {}", quoted(name), numbers(values)));
            }
        }
        if !(self.rest.is_empty() && self.lifts.is_empty()) {
            line("\n[rest]                          # ? where other limbs are out of the way".to_owned());
        }
        for (name, value) in &self.lifts {
            line(format!("{} = {}      # ? a lift, halfway up", quoted(name), number(*value)));
        }
        for limb in &self.rest {
            if let Some(state) = &limb.state {
                line(format!("# the posture {state} of the SRDF"));
            }
            for (name, value) in &limb.joints {
                line(format!("{} = {}", quoted(name), number(*value)));
            }
        }
    }
}
