//! Implementors that are wrong on purpose, each in the way people really get it wrong, and each with the
//! law that must reject it and its honest twin: the laws of [`laws`](crate::laws) are themselves tested.
//!
//! The world they live in is [`bench`](mod@bench): carts with turrets on a rail. Its spaces, motions, primitives and
//! validities are sketches made of functions, so that every broken one differs from the honest one in
//! exactly the function that is wrong.

use std::cell::Cell;

use crate::laws::Broken;
use crate::random::{Purpose, Stream, stream};

pub mod bench;
mod distances;
mod goals;
mod motions;
mod outside;
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
        outside::cases(),
    ];
    groups.concat()
}

thread_local! {
    static SEED: Cell<u64> = const { Cell::new(1) };
}

/// The seed that the cases draw their inputs with, where they draw any.
pub fn seed() -> u64 {
    SEED.get()
}

/// A generator for input `i` of a case.
pub fn inputs(i: u64) -> Stream {
    stream(seed(), 7, i, Purpose::Attempt)
}

impl Case {
    /// Checks the broken implementor with inputs drawn by `seed`.
    ///
    /// # Errors
    /// The law that it breaks.
    pub fn check_broken(&self, seed: u64) -> Result<(), Broken> {
        SEED.set(seed);
        (self.broken)()
    }

    /// Checks its honest twin in the same way.
    ///
    /// # Errors
    /// Never, if the law is right.
    pub fn check_honest(&self, seed: u64) -> Result<(), Broken> {
        SEED.set(seed);
        (self.honest)()
    }
}

/// The page that lists every law with the faults that it catches, in Markdown: `groups` are headings and the laws below
/// them, `cases` what is wrong on purpose.
pub fn page(title: &str, groups: &[(&str, &[&'static str])], cases: &[Case]) -> String {
    let mut text = format!("# {title}\n\n");
    for (heading, laws) in groups {
        text.extend(["## ", heading, "\n\n| law | says | catches, for example |\n|---|---|---|\n"]);
        for law in *laws {
            let (name, says) = law.split_once(": ").unwrap_or((law, ""));
            let caught = cases.iter().filter(|case| case.law == *law);
            let faults: Vec<_> = caught.map(|case| format!("*{}*: {}", case.name, case.wrong)).collect();
            text.extend(["| `", name, "` | ", says, " | ", &faults.join("; "), " |\n"]);
        }
        text.push('\n');
    }
    text
}
