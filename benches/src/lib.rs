//! Fixtures that the benchmarks share: everything is drawn from fixed seeds, so that two runs measure the same work.
//!
//! | fixture | for |
//! |---|---|
//! | [`arm`] | configurations and reachable poses of the PR2's right arm |
//! | [`room`] | the PR2 in the scene of Plate3, and random states there |
//! | [`trees`] | trees of any size in any domain |
//! | [`boxes`] | the PR2 before a table with ten boxes |
//! | [`pucks`] | trees, strategies and runs of the puck domain |

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::missing_panics_doc,
    reason = "fixtures are fixed: one that cannot be built must stop the benchmark, with the place and the error"
)]

pub mod arm;
pub mod boxes;
pub mod drives;
pub mod pucks;
pub mod room;
pub mod trees;

/// The generator for the `index`-th piece of a fixture.
pub fn stream(index: u64) -> darrt_core::random::Stream {
    darrt_core::random::stream(2012, 0, index, darrt_core::random::Purpose::Sample)
}
