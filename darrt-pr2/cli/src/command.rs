//! The commands, one file each.

pub(crate) mod bench;
mod bench_table;
pub(crate) mod check;
pub(crate) mod execute;
pub(crate) mod explain;
pub(crate) mod export;
pub(crate) mod generate;
pub(crate) mod plan;
pub(crate) mod problems;
pub(crate) mod robot;
pub(crate) mod schema;
pub(crate) mod show;
mod source;
mod tape;
pub(crate) mod why_not;
