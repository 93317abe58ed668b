//! Implementors that are wrong on purpose, each in the way people really get it wrong, and each with the
//! law that must reject it and its honest twin: the laws of [`laws`](crate::laws) are themselves tested.
//!
//! The world they live in is [`bench`](mod@bench): carts with turrets on a rail. Its spaces, motions, primitives and
//! validities are sketches made of functions, so that every broken one differs from the honest one in
//! exactly the function that is wrong.

use crate::laws::Broken;

pub mod bench;
mod distances;
mod goals;
mod motions;
mod planners;
mod primitives;
mod samplers;
mod spaces;
mod validities;

/// One broken implementor.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// Its name.
    pub name: &'static str,
    /// What is wrong with it, or how people come to write it.
    pub wrong: &'static str,
    /// The law that rejects it.
    pub law: &'static str,
    /// Checks it: must fail.
    pub broken: fn() -> Result<(), Broken>,
    /// Checks its honest twin in the same way: must pass.
    pub honest: fn() -> Result<(), Broken>,
}

/// All broken implementors.
pub fn cases() -> Vec<Case> {
    let groups = [
        spaces::cases(),
        distances::cases(),
        motions::cases(),
        primitives::cases(),
        validities::cases(),
        goals::cases(),
        samplers::cases(),
        planners::cases(),
    ];
    groups.concat()
}
