//! The laws of a robot and of table-top instances as plain functions, besides those of [`darrt_core::laws`].
//!
//! | you have | call | the laws |
//! |---|---|---|
//! | a [`Manipulator`](crate::manipulator::Manipulator) | [`check_manipulator`], [`check_reaches`] | [`manipulator`] |
//! | a [`JointVector`](crate::manipulator::JointVector) | [`check_joint_vector`]; by [`check_manipulator`] as well | [`manipulator`] |
//! | a [`GraspFamily`](crate::grasp::GraspFamily) | [`check_grasps`] | [`grasp`] |
//! | a Jacobian | [`check_jacobian`], [`check_chain`] | [`jacobian`] |
//! | instances on a [`Tabletop`](crate::tabletop::Tabletop) | [`check_tabletop`], [`check_tabletop_instance`], [`check_finger_contacts`], [`check_contracts`] | [`tabletop`] |
//!
//! Each function takes concrete inputs and returns the first law that is broken, as a
//! [`Broken`](darrt_core::laws::Broken) with the parameter, the two values and the call that shows it again. The
//! feature `testing` has proptest strategies for table-top states in `testing::strategies`, and for every law here an
//! implementor in `testing::broken` that it rejects.
//!
//! # Example
//! Your own robot in place of the gantry (feature `testing`):
//! ```
//! # #[cfg(feature = "testing")] {
//! use darrt_core::testing::strategies::{config, configs, seeds};
//! use darrt_primitives::mobile_arm_space::MobileArmSpace;
//! use darrt_primitives::laws::{ManipulatorClaims, check_manipulator};
//! use darrt_primitives::manipulator::Manipulator;
//! use darrt_primitives::testing::gantry::{Gantry, Joints};
//! use proptest::proptest;
//!
//! let robot = Gantry::new().unwrap();
//! let space = MobileArmSpace::<Joints>::new([-2.0; 2], [2.0; 2], robot.limits(), robot.joint_weights_m()).unwrap();
//! proptest!(config(16, None), |(a in configs(&space), b in configs(&space), seed in seeds())| {
//!     check_manipulator(&robot, [&a, &b], [0.02, 0.08], seed, &ManipulatorClaims::default())?;
//! });
//! # }
//! ```

pub mod grasp;
pub mod jacobian;
pub mod manipulator;
pub mod tabletop;

pub use grasp::check_grasps;
pub use jacobian::{check_chain, check_jacobian};
pub use manipulator::{ManipulatorClaims, ReachClaims, check_joint_vector, check_manipulator, check_reaches};
pub use tabletop::{
    TabletopClaims, body_travel, check_contracts, check_finger_contacts, check_tabletop, check_tabletop_instance,
};

/// Every law of this crate.
pub fn all() -> impl Iterator<Item = &'static str> {
    [manipulator::LAWS, jacobian::LAWS, tabletop::LAWS, grasp::LAWS].into_iter().flatten().copied()
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_core::laws::name_of;

    #[test]
    fn laws_have_distinct_names_and_say_something() {
        let mut names: Vec<_> = all().chain(darrt_core::laws::all()).map(name_of).collect();
        let count = names.len();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), count);
        assert!(all().all(|law| law.split_once(": ").is_some_and(|(_, says)| says.len() > 10)));
    }
}
