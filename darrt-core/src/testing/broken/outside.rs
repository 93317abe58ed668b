//! Implementors that break what strangers break: found by looking from outside, at random inputs, in the corners, at what is
//! no number, and at what is done too much rather than too little.

use super::Case;

mod arrivals;
mod domains;
mod goals;
mod hangs;
mod held;
mod measures;
mod motions;
mod primitives;
mod spaces;
mod strangers;
mod validities;
mod verifiers;
mod ways;
mod ways_in;
mod wholes;

pub(super) fn cases() -> Vec<Case> {
    [
        spaces::cases(),
        domains::cases(),
        motions::cases(),
        primitives::cases(),
        validities::cases(),
        goals::cases(),
        verifiers::cases(),
        hangs::cases(),
        wholes::cases(),
        strangers::cases(),
        ways::cases(),
        ways_in::cases(),
        arrivals::cases(),
        measures::cases(),
        held::cases(),
    ]
    .concat()
}

/// How many inputs each case draws: the default effort of a property test.
const CASES: u64 = 256;
