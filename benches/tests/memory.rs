//! What the planner allocates for the PR2, counted: bytes for each node of a tree, and allocations along a motion.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test says no more than that it failed")]

use std::collections::BTreeMap;
use std::sync::Arc;

use allocation_counter::measure;
use darrt_benches::room::prepared;
use darrt_benches::{stream, trees};
use darrt_core::budget::Interrupt;
use darrt_core::extend::Extender;
use darrt_core::search::Darrt;
use darrt_core::state::State;
use darrt_pr2::World;

/// At most half a kilobyte for each node.
const BYTES_PER_NODE: u64 = 512;

/// With the instances: motions are deferred, so nearly every node has an instance of its own, which holds where it starts and
/// its waypoints. A million of them fit into a gigabyte.
const GROWN_BYTES_PER_NODE: u64 = 1000;

/// Random nodes with one instance among them: what the tree itself takes.
#[test]
fn a_million_nodes_fit_into_half_a_gigabyte() {
    let (prepared, _) = prepared();
    let problem = &prepared.problem;
    let mut tree = None;
    let count = 100_000;
    let info = measure(|| tree = Some(trees::random(problem.domain(), problem.start(), count)));
    let per_node = u64::try_from(info.bytes_current).unwrap() / count;
    let peak = info.bytes_max / count;
    println!("{per_node} bytes for a node, {peak} at the peak, of which its state {}", size_of::<State<World>>());
    assert!(per_node <= BYTES_PER_NODE, "{per_node} bytes per node");
    assert!(tree.is_some());
}

/// A tree that the planner has grown: with the instances of its edges.
#[test]
fn a_million_nodes_with_their_motions_fit_into_a_gigabyte() {
    let (prepared, strategy) = prepared();
    let mut darrt = Darrt::new(&prepared.problem, &strategy, 7, 0, usize::MAX);
    // Until there is a tree of some size: as repairs take back what is blocked, it also shrinks.
    (0..2000).for_each(|_| drop(darrt.step()));
    let nodes = darrt.tree().len() as u64;
    let mut instances: Vec<_> =
        darrt.tree().iter().filter_map(|(_, n)| n.edge.as_ref()).map(|e| Arc::clone(&e.instance)).collect();
    instances.dedup_by(|a, b| Arc::ptr_eq(a, b));
    let mut kinds: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    for instance in &instances {
        let kind = kinds.entry(instance.primitive.name()).or_default();
        *kind = (kind.0 + 1, kind.1 + instance.motion.knots().len());
    }
    println!("instances and their waypoints, by kind: {kinds:?}");
    // What is freed with the tree is what it took; caches of the collision check are no part of it.
    let count = instances.len();
    drop(instances);
    let freed = measure(|| drop(darrt));
    let per_node = u64::try_from(-freed.bytes_current).unwrap() / nodes;
    println!("{nodes} nodes, {count} instances, {per_node} bytes for a node");
    assert!(nodes > 1_000 && per_node <= GROWN_BYTES_PER_NODE, "{per_node} bytes per node");
}

/// The motions of some extensions, evaluated at ten and at a thousand states, and checked as wholes.
#[test]
fn a_motion_is_evaluated_and_checked_without_allocating_per_state() {
    let (prepared, strategy) = prepared();
    let problem = &prepared.problem;
    let m = problem.domain();
    let extender = Extender { problem, options: &strategy.extend, local_repair: None, interrupt: Interrupt::NEVER };
    let mut lengths_m = Vec::new();
    for (i, to) in (0..).zip(trees::targets(problem, &strategy, 40)) {
        let reached = extender.extend(problem.start(), &to, &mut stream(i)).reached;
        let mut from = problem.start().clone();
        let mut state = from.clone();
        for r in reached {
            let mut evaluate = |count: u32| {
                let ts = (0..count).map(|i| f64::from(i) / f64::from(count));
                measure(|| ts.for_each(|t| r.instance.motion.at_into(m, t, &mut state))).count_total
            };
            assert_eq!((evaluate(10), evaluate(1000)), (0, 0), "{}", r.instance.primitive);
            let whole = measure(|| drop(problem.validity().free_prefix(m, &r.instance, &from)));
            lengths_m.push((r.instance.motion.length(), whole.count_total));
            from = r.state;
        }
    }
    lengths_m.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (Some(shortest), Some(longest)) = (lengths_m.first(), lengths_m.last()) else { panic!("no extension") };
    println!("allocations of a check: {shortest:?} to {longest:?} (metres, allocations) of {}", lengths_m.len());
    let most = lengths_m.iter().map(|(_, n)| *n).max().unwrap();
    assert!(longest.0 > 10.0 * shortest.0);
    assert!(most <= 64, "{most} allocations in one check");
}
