//! What costs more than it saves in the time that such problems take; for comparisons, and for many queries with one robot.

pub mod reachability;
