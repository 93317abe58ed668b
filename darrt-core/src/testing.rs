//! Support for tests and a first domain to read and copy (feature `testing`).

pub mod broken;
pub mod puck;
pub mod strategies;
