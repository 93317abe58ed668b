//! Robots, Jacobians and table-top instances that are wrong on purpose, each in the way people really get it wrong, and
//! each with the law that must reject it and its honest twin: the laws of [`laws`](crate::laws) are themselves tested.
//!
//! The robots are a [`Gantry`](super::gantry::Gantry), a [`Crane`](super::crane::Crane) or [`Twins`](super::twins::Twins) with one function changed, the instances what the actions do at
//! the [`table`](mod@super::table) with one thing changed.

use std::fmt;

use darrt_core::laws::Broken;
pub use darrt_core::testing::broken::Case;

mod bench;
mod contracts;
mod grasps;
mod hands;
mod instances;
mod inverses;
mod jacobians;
mod limits;
mod moments;
mod pushes;
mod robots;
mod several;
mod tied;
mod vectors;

/// All broken implementors of this crate's traits.
pub fn cases() -> Vec<Case> {
    [
        robots::cases(),
        inverses::cases(),
        limits::cases(),
        jacobians::cases(),
        instances::cases(),
        pushes::cases(),
        moments::cases(),
        grasps::cases(),
        hands::cases(),
        contracts::cases(),
        vectors::cases(),
        tied::cases(),
        several::cases(),
    ]
    .concat()
}

/// The bench itself is at fault: never for the constants here.
fn unusable(why: impl fmt::Display) -> Broken {
    Broken::new("testing.bench: the honest twin can be built", why.to_string(), "a bench")
}
