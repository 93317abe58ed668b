//! Samplers and distances that are ahead of the others on no problem that was measured: behind the same traits, for comparisons.
//! The planner is better off without them; `darrt bench --variants all` and the criterion groups `*_variants` say by how much.
//!
//! | variant | what is different |
//! |---|---|
//! | [`Frontier`] | some samples lie where extensions were blocked |
//! | [`Weighted`] | robot and objects count differently, or the longest way counts alone |
//! | [`ApproachVisit`] | the robot's first way leads to the contact or grasp |

pub mod approach_visit;
pub mod frontier;
pub mod weighted;

pub use approach_visit::ApproachVisit;
pub use frontier::Frontier;
pub use weighted::Weighted;
