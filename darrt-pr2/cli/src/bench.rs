//! Benchmarks: problems x variants x seeds, run in parallel, kept as JSON lines, told as tables, pictures and logs.
//!
//! The way of the data: [`job`] (what is to be run) → [`run`](mod@run) (the workers) → [`record`] (one line per run) →
//! [`journal`] (the file of lines, taken up again after a kill) → [`collection`] (lines of one or several files, nothing
//! twice) → [`statistics`] → the table of the command line, [`ompl_log`], [`report`].
//!
//! | question | file |
//! |---|---|
//! | which problems, variants and seeds, in which order, on which machine? | [`job`], [`variant`], [`shard`] |
//! | what is one run, and may two be compared? | [`record`], [`machine`], [`digest`] |
//! | how are runs that ended without a plan counted? | [`survival`], [`bootstrap`], [`statistics`] |
//! | would restarts help? | [`restarts`] |
//! | where are the plans? | `kept` |

pub mod bootstrap;
pub mod collection;
pub mod digest;
pub mod error;
pub mod job;
pub mod journal;
pub(crate) mod kept;
pub mod machine;
pub mod ompl_log;
pub mod record;
pub mod report;
pub mod restarts;
pub mod run;
pub mod shard;
pub mod statistics;
pub mod survival;
pub mod variant;

pub use collection::Collection;
pub use error::BenchError;
pub use job::{Job, JobSet, Subject};
pub use journal::Journal;
pub use record::{Key, Record};
pub use shard::Shard;
pub use variant::Variant;
