//! Support for tests of robots and table-top instances (feature `testing`): a robot to read and copy, a table, an
//! oracle, deliberate law-breakers and proptest strategies.

pub mod arms;
pub mod broken;
pub mod crane;
pub mod gantry;
pub mod scene_oracle;
pub mod strategies;
pub mod table;
pub mod twins;
pub mod yardstick;
