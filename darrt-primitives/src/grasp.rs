//! grasp.
