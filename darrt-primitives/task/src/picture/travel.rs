//! How far base, hand and object go in one step.

use darrt_primitives::manipulator::world_from_base;
use nalgebra::Isometry3;

use super::story::{Snapshot, Story, StoryStep};

/// Lengths of ways in metres and sums of turns in radians, over the states of one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Travel {
    /// Way of the base.
    pub base_m: f64,
    /// Turns of the base.
    pub base_turn: f64,
    /// Way of the hand at work as seen from the base: what the arm does.
    pub hand_m: f64,
    /// Turns of the hand as seen from the base.
    pub hand_turn: f64,
    /// Turns of all joints of the planned arms together.
    pub arm_turn: f64,
    /// Way of the object that moves farthest, in the world.
    pub object_m: f64,
    /// Turns of that object.
    pub object_turn: f64,
    /// Index of that object; `None` when all rest.
    pub object: Option<usize>,
}

/// Below this nothing has moved (m, rad).
const STILL: f64 = 1e-6;

impl Travel {
    /// Measures one step of a story.
    pub fn of(story: &Story, step: &StoryStep) -> Self {
        let pairs = || step.snapshots.iter().zip(step.snapshots.iter().skip(1));
        let mut travel = Self::default();
        for (before, after) in pairs() {
            let ([x, y, yaw], [u, v, w]) = (before.robot.base, after.robot.base);
            travel.base_m += (u - x).hypot(v - y);
            travel.base_turn += turned(w - yaw);
            travel.arm_turn += story.model.arm_turns(&before.robot, &after.robot);
            let hand = [before, after].map(|snapshot| base_from_tool(story, snapshot, step.hand));
            add(&mut travel.hand_m, &mut travel.hand_turn, &hand);
        }
        for object in 0..story.start.objects.len() {
            let (mut way, mut turn) = (0.0, 0.0);
            for (before, after) in pairs() {
                if let (Some(a), Some(b)) = (before.objects.get(object), after.objects.get(object)) {
                    add(&mut way, &mut turn, &[*a, *b]);
                }
            }
            if way.max(turn) > STILL && way >= travel.object_m {
                (travel.object_m, travel.object_turn, travel.object) = (way, turn, Some(object));
            }
        }
        travel
    }

    /// Adds lengths and turns of another step; the object is that of the longer way.
    #[must_use]
    pub fn plus(self, other: &Self) -> Self {
        Self {
            base_m: self.base_m + other.base_m,
            base_turn: self.base_turn + other.base_turn,
            hand_m: self.hand_m + other.hand_m,
            hand_turn: self.hand_turn + other.hand_turn,
            arm_turn: self.arm_turn + other.arm_turn,
            object_m: self.object_m + other.object_m,
            object_turn: self.object_turn + other.object_turn,
            object: if other.object_m > self.object_m { other.object } else { self.object },
        }
    }

    /// In words, the parts that moved only: `base 0.52 m 14°, hand 0.31 m 5°`.
    pub fn in_words(&self) -> String {
        let entries = [
            ("base", self.base_m, self.base_turn),
            ("hand", self.hand_m, self.hand_turn),
            ("object", self.object_m, self.object_turn),
        ];
        let moved = entries.iter().filter_map(|(what, way, turn)| {
            let amount = amount(*way, *turn);
            (!amount.is_empty()).then(|| format!("{what} {amount}"))
        });
        moved.collect::<Vec<_>>().join(", ")
    }
}

/// `0.52 m 14°`, without what is nothing; what moves hardly at all is `<1 mm`.
pub fn amount(way: f64, turn: f64) -> String {
    let degrees = turn.to_degrees();
    match (way >= 0.0005, degrees >= 0.5) {
        (true, true) => format!("{} {degrees:.0}\u{b0}", metres(way)),
        (true, false) => metres(way),
        (false, true) => format!("{degrees:.0}\u{b0}"),
        (false, false) if way > STILL => "<1 mm".to_owned(),
        (false, false) if turn > STILL => "<1\u{b0}".to_owned(),
        (false, false) => String::new(),
    }
}

fn metres(way: f64) -> String {
    if way < 0.01 { format!("{way:.3} m") } else { format!("{way:.2} m") }
}

fn add(way: &mut f64, turn: &mut f64, [before, after]: &[Isometry3<f64>; 2]) {
    *way += (after.translation.vector - before.translation.vector).norm();
    *turn += before.rotation.angle_to(&after.rotation);
}

fn base_from_tool(story: &Story, snapshot: &Snapshot, hand: usize) -> Isometry3<f64> {
    world_from_base(&snapshot.robot.base).inverse() * story.world_from_tool(snapshot, hand)
}

/// The size of a turn, the short way round.
fn turned(angle: f64) -> f64 {
    let turn = angle.rem_euclid(std::f64::consts::TAU);
    turn.min(std::f64::consts::TAU - turn)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Act;
    use crate::problem_file::PrimitiveName;
    use crate::testing::{builtin, facts};

    #[test]
    fn ways_and_turns_add_up() {
        let problem = builtin("plate1").unwrap();
        let story = Story::of_problem(&problem, &facts(&problem)).unwrap();
        let mut second = story.start.clone();
        second.robot.base[0] += 0.3;
        second.robot.base[2] = 6.0;
        let mut third = second.clone();
        third.robot.base[1] -= 0.4;
        third.objects[0].translation.x += 0.5;
        let snapshots = vec![story.start.clone(), second, third];
        let (primitive, act) = (PrimitiveName::BASE_RIGID_TRANSFER, Act::Transfer);
        let step = StoryStep { primitive, act, hand: 0, object: Some(0), snapshots };
        let travel = Travel::of(&story, &step);
        assert!((travel.base_m - 0.7).abs() < 1e-12);
        assert!((travel.base_turn - (std::f64::consts::TAU - 6.0)).abs() < 1e-12);
        assert!(travel.hand_m < 1e-12 && (travel.object_m - 0.5).abs() < 1e-12);
        assert_eq!(travel.object, Some(0));
        assert_eq!(travel.in_words(), "base 0.70 m 16\u{b0}, object 0.50 m");
        assert_eq!(travel.plus(&travel).in_words(), "base 1.40 m 32\u{b0}, object 1.00 m");
        assert_eq!(Travel::default().in_words(), "");
        assert_eq!([amount(2e-5, 1e-7), amount(0.0, 1e-3), amount(1e-9, 1e-9)], ["<1 mm", "<1\u{b0}", ""]);
    }
}
