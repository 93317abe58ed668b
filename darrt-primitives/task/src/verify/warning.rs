//! What the verifier accepts and a careful engineer would ask about.

use std::fmt;

use serde::Serialize;

/// What a warning is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum WarningKind {
    /// Two bodies are nearer at the start than the least margin.
    StartNear,
    /// The goal puts an object nearer to another body than the least margin.
    GoalNear,
    /// The robot comes nearer to something than is wanted.
    RobotMargin,
    /// The held object comes nearer to something than is wanted.
    HeldMargin,
    /// A pushed object comes nearer to something than is wanted.
    ObjectMargin,
    /// An object is set down, or pushed, nearer to an edge than is wanted.
    Edge,
    /// What is carried leans nearly as far as it may.
    Tilt,
    /// The base drives much farther than the straight way.
    Drive,
    /// The base turns round and round.
    Turning,
    /// The base drives with the hand far out.
    ArmOut,
    /// The hand comes down nearer to what it pushes than the place of that may be off.
    Standoff,
}

impl WarningKind {
    /// The unit of its numbers.
    pub fn unit(self) -> &'static str {
        if matches!(self, Self::Tilt | Self::Turning) { "degrees" } else { "metres" }
    }
}

/// One thing that a careful engineer would ask about.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Warning {
    /// What it is about.
    pub kind: WarningKind,
    /// The step, from 1; `None` where it is about the problem or the plan as a whole.
    pub step: Option<u32>,
    /// The bodies concerned: objects, links, obstacles, surfaces.
    pub bodies: Vec<String>,
    /// What was found, in the unit of the kind.
    pub found: f64,
    /// What was wanted: at least so much of a distance, at most so much of a way or an angle.
    pub wanted: f64,
}

impl Warning {
    pub(super) fn new(kind: WarningKind, step: Option<u32>, bodies: &[&str], found: f64, wanted: f64) -> Self {
        Self { kind, step, bodies: bodies.iter().map(|body| (*body).to_owned()).collect(), found, wanted }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use WarningKind as K;
        let body = |index: usize| self.bodies.get(index).map_or("something", |body| body);
        let (a, b, found, wanted) = (body(0), body(1), self.found, self.wanted);
        let mm = |metres: f64| metres * 1000.0;
        if let Some(step) = self.step {
            write!(f, "step {step}: ")?;
        }
        match self.kind {
            K::StartNear => write!(
                f,
                "{a} and {b} are {:.2} mm apart at the start, nearer than the least margin of {} mm",
                mm(found),
                mm(wanted)
            ),
            K::GoalNear => write!(
                f,
                "the goal leaves {:.2} mm between {a} and {b}, less than the least margin of {} mm",
                mm(found),
                mm(wanted)
            ),
            K::RobotMargin | K::HeldMargin | K::ObjectMargin => {
                write!(f, "{a} comes within {:.1} mm of {b}, {} mm are wanted", mm(found), mm(wanted))
            }
            K::Edge => {
                write!(
                    f,
                    "the centre of {a} ends {:.1} mm inside the edge of {b}, {} mm are wanted",
                    mm(found),
                    mm(wanted)
                )
            }
            K::Tilt => write!(f, "{a} leans {found:.1} degrees, {wanted} are allowed"),
            K::Drive => write!(f, "the base drives {found:.2} m; twice the straight way and a metre are {wanted:.2} m"),
            K::Turning => write!(f, "the base turns by {found:.0} degrees in all, more than {wanted:.0}"),
            K::ArmOut => write!(f, "the base drives with the hand {found:.2} m from its centre, more than {wanted} m"),
            K::Standoff => write!(
                f,
                "the hand comes down {:.0} mm behind {a}, whose place may be off by {:.0} mm",
                mm(found),
                mm(wanted)
            ),
        }
    }
}
