//! Why there is no plan, as data: names and numbers, no words.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A place of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// Where it stands at the start.
    Start,
    /// Where its goals want it.
    Goal,
    /// At the edge of what it stands on, with its rim over it.
    Edge,
}

/// Why something stays where an object shall be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Occupant {
    /// It is fixed.
    Fixed,
    /// It is an object that nothing moves.
    Immovable,
    /// It is an object whose own goal is there.
    Goal,
    /// It is a closed mesh around the place.
    Enclosure,
}

impl std::fmt::Display for Occupant {
    /// As it goes on after the name.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Fixed => "",
            Self::Immovable => ", which never moves",
            Self::Goal => ", which has its goal there",
            Self::Enclosure => ", which is closed around it",
        })
    }
}

/// Where one pose of the hand comes to an end, in the order in which it is looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// The object's rim must stick out over an edge, and does not.
    Overhang,
    /// The grasp would not hold the object.
    Hold,
    /// The object does not stand there: beside a surface that it may stand on, or too near to its edge.
    Support,
    /// The object itself meets something there.
    Room,
    /// The hand alone, without an arm, meets something there.
    Hand,
    /// It has no room for the shortest straight way to there.
    Approach,
    /// The arm reaches it from no base pose tried.
    Reach,
    /// Wherever the base would have to stand it meets something, or is out of its bounds.
    Stand,
    /// The arm, or what it holds, meets something there.
    Arm,
    /// The straight way to there, or the lift, is out of reach or meets something.
    Line,
    /// The base cannot drive to where it would stand.
    Drive,
}

/// How many poses of the hand ended at a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StageCount {
    /// The stage.
    pub stage: Stage,
    /// How many.
    pub count: u64,
}

/// How many poses of the hand, or pushes, one body ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Blocker {
    /// The body.
    pub body: String,
    /// How many.
    pub count: u64,
}

/// What became of the poses of the hand that were tried to take an object where it is, or to set it down there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Hands {
    /// The object.
    pub object: String,
    /// Where it is.
    pub place: Place,
    /// Poses of the hand that were tried.
    pub tried: u64,
    /// Poses that can be used.
    pub good: u64,
    /// Where the others ended, in the order of the stages.
    pub ends: Vec<StageCount>,
    /// What ended them at the last of these stages, most first.
    pub blockers: Vec<Blocker>,
    /// Poses of the base that were tried for them.
    pub bases: u64,
    /// If the last stage is `reach` or `stand`: how far from there the hand must be at least to be reached from a base that is
    /// free, metres, of what was tried: straight up and down, and to eight sides. `null` if it is nowhere reached, or not asked.
    pub beyond_m: Option<f64>,
}

impl Hands {
    /// The last stage at which poses ended.
    pub fn last_stage(&self) -> Option<Stage> {
        self.ends.last().map(|end| end.stage)
    }

    /// How many ended at this stage.
    pub fn ended_at(&self, stage: Stage) -> u64 {
        self.ends.iter().find(|end| end.stage == stage).map_or(0, |end| end.count)
    }

    /// How many poses came as far as this stage.
    pub fn came_to(&self, stage: Stage) -> u64 {
        self.good + self.ends.iter().filter(|end| end.stage >= stage).map(|end| end.count).sum::<u64>()
    }
}

/// An edge of a surface to which an object might be pushed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EdgeReach {
    /// The surface.
    pub surface: String,
    /// The middle of the edge, world x and y, metres.
    pub middle: [f64; 2],
    /// The direction away from the surface, unit vector.
    pub outward: [f64; 2],
    /// The poses of the hand that take the object there.
    pub hands: Hands,
}

/// What became of the pushes that were tried, from the start and from where pushes ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pushes {
    /// The object.
    pub object: String,
    /// Pushes that were tried.
    pub tried: u64,
    /// Pushes that are possible.
    pub made: u64,
    /// Ends of pushes at which the object can be taken.
    pub taken: u64,
    /// Ends of pushes at which the object meets its goal.
    pub at_goal: u64,
    /// Pushes that are possible but stop before their end, and those that are not, by what is in the way.
    pub blockers: Vec<Blocker>,
    /// Pushes for which the arm does not reach.
    pub unreachable: u64,
}

/// The free floor around the base.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Where the base can go from its start, square metres of places of its centre.
    pub free_m2: f64,
    /// The cells that were looked at: their width, metres.
    pub cell_m: f64,
    /// And their angle, radians.
    pub cell_rad: f64,
    /// How many poses of the base that would do were looked for.
    pub wanted: u64,
    /// The bodies around it, most contacts first.
    pub walls: Vec<Blocker>,
}

/// One reason why there is no plan.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "cause", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Cause {
    /// Something that never moves is where an object shall be, or two objects shall be in one place.
    GoalOccupied {
        /// The object.
        object: String,
        /// What is there.
        by: String,
        /// Why it stays there.
        occupant: Occupant,
        /// The place, metres.
        at: [f64; 3],
    },
    /// A primitive or a grasp is missing, or would not hold.
    InfeasibleGoal {
        /// The object.
        object: String,
        /// What is missing, in words.
        lack: String,
    },
    /// A primitive is missing of which another one is made.
    MissingPrimitive {
        /// The one that is allowed.
        primitive: String,
        /// The one that it needs.
        needs: String,
    },
    /// No surface has room for the object where its goal wants it.
    NoRoom {
        /// The object.
        object: String,
        /// Places of the goal that were tried.
        tried: u64,
        /// How far inside the edges of what it may stand on the best of them is, metres; negative beside them.
        inside_m: Option<f64>,
        /// How far it would have to be, metres.
        wanted_m: f64,
    },
    /// No pose of the hand takes an object, or sets it down.
    NoHand {
        /// What became of them.
        hands: Hands,
    },
    /// Poses of the hand take the object at the start, others set it down at its goal, but none does both.
    NoCommonGrasp {
        /// The object.
        object: String,
        /// Grasps that take it at the start.
        at_start: u64,
        /// Places of the goal that were tried for each.
        tries: u64,
        /// What was in the way of the others, most first.
        blockers: Vec<Blocker>,
    },
    /// No push brings the object to where it can be taken, or to its goal.
    NoPush {
        /// What became of the pushes.
        pushes: Pushes,
        /// The edges of what it stands on; empty if it need not come to one.
        edges: Vec<EdgeReach>,
    },
    /// The base cannot drive to where it must stand.
    CutOff {
        /// The object that it must come to.
        object: String,
        /// Where the object is.
        place: Place,
        /// The floor.
        floor: Floor,
    },
    /// Another object must be moved first; that is no reason by itself.
    Behind {
        /// The object.
        object: String,
        /// Where it is.
        place: Place,
        /// Objects in the way, most first.
        others: Vec<Blocker>,
    },
    /// The robot comes to none of the places where its own goal wants it.
    NoRobotGoal {
        /// Places that were tried; 0 if the arm reaches none.
        tried: u64,
        /// What was in the way, most first.
        blockers: Vec<Blocker>,
        /// How far the wanted pose of the tool is from the nearest that the arm reaches from any base tried, metres, if it reaches
        /// that of none.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        beyond_m: Option<f64>,
    },
    /// What made a plan unlikely before the search, and was not refuted by a plan.
    Doubted {
        /// In words.
        what: String,
    },
    /// No step can do what a rule of the problem requires.
    InfeasibleRule {
        /// Which rule of `steer`, from 0.
        rule: u64,
        /// What is missing, by object.
        lack: String,
    },
    /// Rules of the problem kept steps from being taken; that is no reason by itself.
    Steered {
        /// Which steps, most first.
        steps: Vec<Blocker>,
    },
    /// A plan was found, and the verifier refused it.
    Refused {
        /// Why.
        reason: String,
    },
}

impl Cause {
    /// Does it keep every plan away, as far as was looked? The others only make one harder to find.
    pub fn is_decisive(&self) -> bool {
        !matches!(self, Self::Behind { .. } | Self::Doubted { .. } | Self::Steered { .. } | Self::Refused { .. })
    }

    /// Does it say that an object cannot be brought to its goal from anywhere?
    pub fn is_about_arriving(&self) -> bool {
        match self {
            Self::NoHand { hands } => hands.place == Place::Goal,
            Self::NoRoom { .. } => true,
            _ => false,
        }
    }

    /// All bodies that it names, the object that it is about first, each once.
    pub fn bodies(&self) -> Vec<String> {
        let of = |blockers: &[Blocker]| blockers.iter().map(|blocker| blocker.body.clone()).collect::<Vec<_>>();
        let others = match self {
            Self::GoalOccupied { by, .. } => vec![by.clone()],
            Self::NoHand { hands } => of(&hands.blockers),
            Self::NoCommonGrasp { blockers, .. } | Self::NoRobotGoal { blockers, .. } => of(blockers),
            Self::NoPush { pushes, edges } => {
                let at_edges = edges.iter().flat_map(|edge| of(&edge.hands.blockers));
                of(&pushes.blockers).into_iter().chain(at_edges).collect()
            }
            Self::CutOff { floor, .. } => of(&floor.walls),
            Self::Behind { others, .. } => of(others),
            _ => Vec::new(),
        };
        let mut all: Vec<String> = Vec::new();
        for body in self.object().map(str::to_owned).into_iter().chain(others) {
            if !all.contains(&body) {
                all.push(body);
            }
        }
        all
    }

    /// The object that it is about.
    pub fn object(&self) -> Option<&str> {
        match self {
            Self::GoalOccupied { object, .. }
            | Self::InfeasibleGoal { object, .. }
            | Self::NoRoom { object, .. }
            | Self::NoCommonGrasp { object, .. }
            | Self::CutOff { object, .. }
            | Self::Behind { object, .. } => Some(object),
            Self::NoHand { hands } => Some(&hands.object),
            Self::NoPush { pushes, .. } => Some(&pushes.object),
            Self::MissingPrimitive { .. }
            | Self::InfeasibleRule { .. }
            | Self::NoRobotGoal { .. }
            | Self::Doubted { .. }
            | Self::Steered { .. }
            | Self::Refused { .. } => None,
        }
    }
}
