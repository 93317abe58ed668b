//! gripper.
