//! arg min over the nodes of the tree. The obvious linear scan is the reference for every faster one.

pub mod linear;
