//! Plans and outcomes can be printed in every domain, also in one that cannot be printed itself.

use std::fmt::Debug;

use darrt_core::domain::Domain;
use darrt_core::plan::{Plan, Step};
use darrt_core::solve::Outcome;
use darrt_core::verify::Solution;

use super::support::World;

fn printable<T: Debug>() {}

/// Compiles only as long as nothing asks `D` itself to be printable.
fn all_printable<D: Domain>() {
    printable::<Step<D>>();
    printable::<Plan<D>>();
    printable::<Solution<D>>();
    printable::<Outcome<D>>();
}

#[test]
fn plans_and_outcomes_ask_nothing_of_the_domain() {
    all_printable::<World>();
}
