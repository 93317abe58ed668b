//! Robot-independent building blocks for manipulation primitives.

pub mod contact;
pub mod error;
pub mod grasp;
pub mod kinematics;
pub mod push;
