//! Broken joint vectors.

use darrt_core::laws::Broken;

use super::Case;
use crate::laws::check_joint_vector;
use crate::laws::manipulator::VECTOR;
use crate::manipulator::JointVector;

/// What is wrong with it.
const NOTHING: u8 = 0;
const CUT: u8 = 1;
const REVERSED: u8 = 2;
const LAST_IS_DEAF: u8 = 3;
const ONE_SLOT_SHORT: u8 = 4;
const AT_ONE: u8 = 5;
const NEARLY_EQUAL: u8 = 6;

/// Five joints.
#[derive(Debug, Clone, Copy)]
struct Five<const FAULT: u8>([f64; 5]);

impl<const FAULT: u8> PartialEq for Five<FAULT> {
    fn eq(&self, other: &Self) -> bool {
        match FAULT {
            LAST_IS_DEAF => self.0[..4] == other.0[..4],
            NEARLY_EQUAL => self.0.iter().zip(&other.0).all(|(a, b)| (a - b).abs() < 0.01),
            _ => self.0 == other.0,
        }
    }
}

impl<const FAULT: u8> AsRef<[f64]> for Five<FAULT> {
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl<const FAULT: u8> AsMut<[f64]> for Five<FAULT> {
    fn as_mut(&mut self) -> &mut [f64] {
        if FAULT == ONE_SLOT_SHORT { &mut self.0[1..] } else { &mut self.0 }
    }
}

impl<const FAULT: u8> JointVector for Five<FAULT> {
    fn from_values(values: &[f64]) -> Option<Self> {
        match FAULT {
            CUT => values.get(..5)?.try_into().ok().map(Self),
            REVERSED => <[f64; 5]>::try_from(values).ok().map(|[a, b, c, d, e]| Self([e, d, c, b, a])),
            _ => values.try_into().ok().map(Self),
        }
    }

    fn zeros(count: usize) -> Option<Self> {
        (count == 5).then_some(Self([if FAULT == AT_ONE { 1.0 } else { 0.0 }; 5]))
    }
}

fn check<const FAULT: u8>() -> Result<(), Broken> {
    check_joint_vector::<Five<FAULT>>(5)
}

pub(super) fn cases() -> Vec<Case> {
    let case = |name, wrong, broken| Case { name, wrong, law: VECTOR, broken, honest: check::<NOTHING> };
    vec![
        case("six joints cut to five", "takes the first values of however many", check::<CUT>),
        case("the last joint first", "joints are numbered from the hand", check::<REVERSED>),
        case("deaf to the last joint", "a joint was added, but not to the comparison", check::<LAST_IS_DEAF>),
        case("one slot short", "the first joint cannot be written to", check::<ONE_SLOT_SHORT>),
        case(
            "zeros that are ones",
            "zero where the joints are homed, not where they are counted from",
            check::<AT_ONE>,
        ),
        case("nearly equal", "compares within a hundredth", check::<NEARLY_EQUAL>),
    ]
}
