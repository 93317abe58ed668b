//! The joints of an arm whose number is known when the program runs.

use std::fmt;

use crate::manipulator::JointVector;

/// So many joints an arm has at most.
pub const MAX_JOINTS: usize = 16;

/// Up to [`MAX_JOINTS`] joint values (rad or m), without memory of their own elsewhere.
// What is beyond the count is zero, so that equality is that of the values.
#[derive(Clone, Copy, PartialEq)]
pub struct Joints {
    values: [f64; MAX_JOINTS],
    count: u32,
    hand: u32,
}

impl AsRef<[f64]> for Joints {
    fn as_ref(&self) -> &[f64] {
        self.values.get(..self.count as usize).unwrap_or(&self.values)
    }
}

impl AsMut<[f64]> for Joints {
    fn as_mut(&mut self) -> &mut [f64] {
        let count = (self.count as usize).min(MAX_JOINTS);
        &mut self.values[..count]
    }
}

impl fmt::Debug for Joints {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.as_ref().fmt(f)
    }
}

impl JointVector for Joints {
    fn from_values(values: &[f64]) -> Option<Self> {
        let mut joints = Self::zeros(values.len())?;
        joints.as_mut().copy_from_slice(values);
        Some(joints)
    }

    fn zeros(count: usize) -> Option<Self> {
        let count = u32::try_from(count).ok().filter(|count| *count as usize <= MAX_JOINTS)?;
        Some(Self { values: [0.0; MAX_JOINTS], count, hand: 0 })
    }

    fn hand_at_work(&self) -> usize {
        self.hand as usize
    }

    fn with_hand_at_work(self, hand: usize) -> Self {
        Self { hand: u32::try_from(hand).unwrap_or(u32::MAX), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_is_as_long_as_its_values() {
        for count in 0..=MAX_JOINTS {
            let values: Vec<f64> = (0..count).map(|i| i as f64).collect();
            let mut joints = Joints::from_values(&values).unwrap();
            assert_eq!(joints.as_ref(), values);
            assert_eq!(format!("{joints:?}"), format!("{values:?}"));
            joints.as_mut().fill(1.0);
            assert_eq!(joints.as_ref(), vec![1.0; count]);
            joints.as_mut().fill(0.0);
            assert_eq!(joints, Joints::zeros(count).unwrap());
        }
        assert_ne!(Joints::zeros(2), Joints::zeros(3));
        assert_eq!(Joints::from_values(&[0.0; MAX_JOINTS + 1]), None);
        assert_eq!((<[f64; 2]>::from_values(&[1.0]), <[f64; 2]>::zeros(2)), (None, Some([0.0; 2])));
    }
}
