//! What a primitive may move, hold and touch, as data: all that a judge of plans knows of it.
//!
//! A contract permits; it cannot excuse. Whatever it says, an object moves only as its rule lets it, nothing penetrates
//! anything, nothing jumps, and nothing stays in the air.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What every instance of a primitive keeps to.
///
/// # Example
/// A hand that draws an object along is, to the judge, a push: two fingers at the rim and friction under the object.
/// ```
/// use darrt_primitives::contract::{Contract, HandUse, HandWay, MovingPart, ObjectRule};
///
/// let pull = Contract { object: ObjectRule::Pushed, ..Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Own) };
/// assert!(pull.fingers_touch && !pull.is_free());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contract {
    /// What of the robot moves.
    pub moves: MovingPart,
    /// What is in the hand before, meanwhile and after.
    pub hand: HandUse,
    /// How the object that the step is about moves while it is not in the hand.
    pub object: ObjectRule,
    /// Which way the hand goes.
    pub way: HandWay,
    /// May the fingers touch the object that the step is about?
    pub fingers_touch: bool,
}

/// What of the robot moves. Base and arm never move together, because their precision differs (paper section 5.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum MovingPart {
    /// The base; the arm keeps its joints.
    Base,
    /// The arm; the base stands.
    Arm,
}

/// What is in the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HandUse {
    /// Nothing, all along.
    Empty,
    /// Nothing at first: the hand closes on a resting object at the beginning, which then moves with it.
    Takes,
    /// An object, all along.
    Carries,
    /// An object that at the end stands on a surface, where the hand opens.
    LetsGo,
}

/// How an object moves while it is not in the hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ObjectRule {
    /// Not at all.
    Rests,
    /// It slides on its support before two fingertips at its rim, which stay on it by the friction of the problem.
    Pushed,
    /// It slides on its support under fingertips that press on it from above, and stands to the hand as before.
    Dragged,
}

/// Which way the hand goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum HandWay {
    /// Any: the hand is at work on nothing, and another way between the same ends would do as well.
    Free,
    /// A straight line, without turning.
    Straight,
    /// Its own, near the object that it is at work on.
    Own,
}

impl Contract {
    /// A contract of a hand that touches nothing when it goes a free way empty, and else the object of the step, which
    /// moves with the hand or rests.
    pub const fn of(moves: MovingPart, hand: HandUse, way: HandWay) -> Self {
        let fingers_touch = !matches!((hand, way), (HandUse::Empty, HandWay::Free));
        Self { moves, hand, object: ObjectRule::Rests, way, fingers_touch }
    }

    /// Would another way between the same ends do as well?
    pub const fn is_free(&self) -> bool {
        matches!(self.way, HandWay::Free)
    }

    /// Is an object in the hand when it begins?
    pub const fn begins_holding(&self) -> bool {
        matches!(self.hand, HandUse::Carries | HandUse::LetsGo)
    }

    /// Does it move the base?
    pub const fn drives(&self) -> bool {
        matches!(self.moves, MovingPart::Base)
    }

    /// Does it take an object from its support, or put it on one?
    pub const fn lifts(&self) -> bool {
        matches!(self.hand, HandUse::Takes | HandUse::LetsGo)
    }

    /// Does an object slide on its support?
    pub const fn slides(&self) -> bool {
        !matches!(self.object, ObjectRule::Rests)
    }

    /// Does it change where an object stands, or whether it is held?
    pub const fn manipulates(&self) -> bool {
        self.lifts() || self.slides()
    }

    /// What makes it impossible to keep, in words; `None` for one that is sound.
    pub const fn flaw(&self) -> Option<&'static str> {
        if self.drives() && !self.is_free() {
            return Some("the base drives any way, but the hand goes its own");
        }
        if self.is_free() && self.manipulates() {
            return Some("what may go any way cannot take, set down or slide an object");
        }
        if self.is_free() && self.fingers_touch && !self.begins_holding() {
            return Some("an empty hand that may go any way touches nothing");
        }
        if self.slides() && !matches!(self.hand, HandUse::Empty) {
            return Some("an object slides only while the hand is empty");
        }
        if self.manipulates() && !self.fingers_touch {
            return Some("an object is taken, set down or slides without being touched");
        }
        None
    }
}
