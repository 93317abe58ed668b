//! arg min over the nodes of the tree. The obvious linear scan is the reference for every faster one.
//!
//! | search | for |
//! |---|---|
//! | [`linear`] | any measure |
//! | [`pruned`] | a measure that can be bounded from below by what [`bounds::Ways`] tells |

pub mod bounds;
pub(crate) mod coordinate_index;
pub mod linear;
pub mod pruned;
