//! arg min over the nodes of the tree. The obvious linear scan is the reference for every faster one.
//!
//! | search | for |
//! |---|---|
//! | [`linear`] | any measure |
//! | [`pruned`] | a measure that can be bounded from below by what [`bounds::Ways`] tells |

pub mod bounds;
pub mod linear;
pub(crate) mod mirror;
pub mod pruned;
