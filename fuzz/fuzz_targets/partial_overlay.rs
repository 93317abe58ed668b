//! The laws of partial states on the puck domain.
#![no_main]

use arbitrary::Arbitrary;
use darrt_core::laws::check_partial;
use darrt_fuzz::puck::{StateSketch, TargetSketch, world};
use libfuzzer_sys::fuzz_target;

#[derive(Debug, Arbitrary)]
struct Case {
    pucks: u8,
    states: [StateSketch; 2],
    targets: [TargetSketch; 2],
}

fuzz_target!(|case: Case| {
    let m = world(case.pucks);
    let [state, elsewhere] = case.states.map(|sketch| sketch.state(&m));
    let [target, other] = [case.targets[0].target(&m, &state), case.targets[1].target(&m, &elsewhere)];
    for targets in [[&target, &other], [&other, &target]] {
        check_partial(&m, targets, &state, &elsewhere).unwrap_or_else(|broken| panic!("{broken}"));
    }
});
