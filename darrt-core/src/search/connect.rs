//! `DARRTConnect`: a tree from the start and one that leads to the goal, which try to meet.
//!
//! The second tree holds states from which a chain of instances leads to a state of the goal. Nothing in it is run backwards
//! that may not be: a sampled state becomes a node when an ordinary, forward extension from it arrives exactly at a node, so a
//! push ends there and never begins; and from a node the tree also grows along instances that are reversible, turned around.
//!
//! Every iteration makes one extension: one tree grows, then the other tree tries to reach what it has grown to.
//!
//! # Source
//! Kuffner, `LaValle`, RRT-Connect, 2000; the authors' later software, which grew its goal tree by forward local plans too.

use std::sync::Arc;

use super::{Darrt, Grown, Part, Planner, Start, Step, Strategy};
use crate::domain::Domain;
use crate::extend::Extension;
use crate::motion::Reversed;
use crate::observe::accounts::Accounts;
use crate::partial::PartialState;
use crate::path::path;
use crate::pipeline::Unproved;
use crate::plan::{Plan, Step as PlanStep};
use crate::problem::Problem;
use crate::random::{Purpose, stream};
use crate::record::Growth;
use crate::state::State;
use crate::tree::NodeId;
use crate::verify::{Refusal, Solution};

/// A goal state more is looked for when there is fewer than one for so many nodes of the goal tree.
const NODES_PER_GOAL: usize = 500;
/// Most nodes of the goal tree.
const MOST_NODES: usize = 5_000;

/// Two trees.
#[derive(Debug)]
pub struct Connect<'p, D: Domain> {
    forward: Darrt<'p, D>,
    goal_nodes: Vec<GoalNode<D>>,
    goals: usize,
    phase: Phase,
}

/// A state from which the goal is reached.
#[derive(Debug)]
struct GoalNode<D: Domain> {
    state: State<D>,
    /// How, and where that leads; `None` in the goal.
    next: Option<(usize, PlanStep<D>)>,
}

/// What the next extension is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    GrowForward,
    /// From this node of the tree towards the nearest goal node.
    ReachForGoal(NodeId),
    GrowBackward,
    /// From the nearest node of the tree towards this goal node.
    ReachFor(usize),
}

impl<'p, D: Domain> Connect<'p, D> {
    /// Both trees, the second one still empty.
    pub fn new(problem: &Problem<D>, strategy: &'p Strategy<D>, start: Start<'p>) -> Self {
        let forward = Darrt::begin(problem, strategy, start);
        Self { forward, goal_nodes: Vec::new(), goals: 0, phase: Phase::GrowForward }
    }

    fn grow_forward(&mut self) -> Step<D> {
        let s = self.forward.draw();
        self.grow_from(&s)
    }

    fn grow_from(&mut self, s: &PartialState<D>) -> Step<D> {
        let t = self.forward.nearest(s);
        let Grown { step, last, .. } = self.forward.grow(t, s);
        let has_target = step.added > 0 && !self.goal_nodes.is_empty();
        self.phase = if has_target { Phase::ReachForGoal(last) } else { Phase::GrowBackward };
        step
    }

    /// Extends `node` towards the state of `goal_node`, and joins the trees if it arrives there exactly.
    fn reach(&mut self, node: NodeId, goal_node: usize) -> Step<D> {
        let m = self.forward.problem.domain();
        let Some(target) = self.goal_nodes.get(goal_node).map(|goal| PartialState::of_state(m, &goal.state)) else {
            return self.grow_forward();
        };
        self.forward.iteration += 1;
        let Grown { mut step, last, is_met } = self.forward.grow(node, &target);
        let arrived = self.forward.tree().node(last).zip(self.goal_nodes.get(goal_node));
        if step.solution.is_none() && is_met && arrived.is_some_and(|(here, there)| here.state == there.state) {
            match self.join(last, goal_node) {
                Some(Ok(solution)) => step.solution = Some(solution),
                Some(Err(unproved)) => {
                    let removed = self.forward.note_unproved(unproved, last, &mut step);
                    if removed == 0 {
                        // What leads from there to the goal is not what it seems.
                        self.goal_nodes.truncate(goal_node);
                        self.goals = self.goal_nodes.iter().filter(|node| node.next.is_none()).count();
                    }
                }
                None => {}
            }
        }
        step
    }

    /// The plan to `node` and on along the goal tree from `goal_node`.
    fn join(&self, node: NodeId, goal_node: usize) -> Option<Result<Solution<D>, Unproved<D>>> {
        let beginning = Plan::to_node(self.forward.tree(), node)?;
        let mut steps = beginning.steps().to_vec();
        let mut at = self.goal_nodes.get(goal_node)?;
        while let Some((next, step)) = &at.next {
            steps.push(step.clone());
            at = self.goal_nodes.get(*next)?;
        }
        Some(self.forward.prove_plan(&Plan::new(beginning.start().clone(), steps)))
    }

    /// A new goal node from a sample: by a forward extension from a state that differs from a goal node in what the sample
    /// names, or along what is reversible from that node.
    fn grow_backward(&mut self) -> Step<D> {
        self.look_for_goal();
        let is_full = self.goal_nodes.len() >= MOST_NODES;
        if self.goal_nodes.is_empty() || is_full {
            return self.grow_forward();
        }
        let s = self.forward.draw();
        let (m, node_of) = (self.forward.problem.domain(), |n: usize| self.goal_nodes.get(n));
        let nearest = self.nearest_goal_node(|node| s.overlay(m, &node.state));
        let Some((n, node)) = nearest.and_then(|n| Some((n, node_of(n)?))) else { return self.grow_from(&s) };
        let q = s.overlay(m, &node.state);
        let Darrt { problem, seed, attempt, iteration, .. } = &self.forward;
        let choose = &mut stream(*seed, *attempt, *iteration, Purpose::Extend);
        let is_valid = problem.validity().check(m, &q, &D::Contacts::default()).is_ok();
        let (extension, links) = if is_valid && iteration.is_multiple_of(2) {
            let extension = self.forward.extender().extend(&q, &PartialState::of_state(m, &node.state), choose);
            let links = arriving(node, &q, &extension);
            (extension, links)
        } else {
            let extension = self.forward.extender().extend(&node.state, &s, choose);
            let links = turned_around(&extension);
            (extension, links)
        };
        self.forward.extended = None;
        let first = self.goal_nodes.len();
        for Link { state, to, step } in links {
            let next = to.map_or(n, |link| first + link);
            self.goal_nodes.push(GoalNode { state, next: Some((next, step)) });
        }
        self.forward.accounts.count(&extension.buckets, 0, extension.is_met, extension.blame.as_ref());
        let has_grown = self.goal_nodes.len() > first;
        self.phase = if has_grown { Phase::ReachFor(self.goal_nodes.len() - 1) } else { Phase::GrowForward };
        Step { added: 0, blame: extension.blame, solution: None, refusal: None, withdrawn: None, stop: None }
    }
}

/// A node of the goal tree to be.
struct Link<D: Domain> {
    state: State<D>,
    /// To which of the other links it leads; `None`: to the node that the extension was about.
    to: Option<usize>,
    step: PlanStep<D>,
}

/// The states at which the instances of an extension begin, the last of them first, if it arrives at `node` exactly.
fn arriving<D: Domain>(node: &GoalNode<D>, q: &State<D>, extension: &Extension<D>) -> Vec<Link<D>> {
    let ends = extension.reached.last().is_some_and(|last| extension.is_met && last.state == node.state);
    if !ends {
        return Vec::new();
    }
    let mut links = Vec::new();
    let mut from = q;
    for (i, reached) in extension.reached.iter().enumerate() {
        let next = extension.reached.get(i + 1);
        if next.is_none_or(|next| !Arc::ptr_eq(&next.instance, &reached.instance)) {
            let step =
                PlanStep { instance: Arc::clone(&reached.instance), until: reached.t, primitive: reached.primitive };
            links.push(Link { state: from.clone(), to: None, step });
            from = &reached.state;
        }
    }
    links.reverse();
    for (i, link) in links.iter_mut().enumerate() {
        link.to = i.checked_sub(1);
    }
    links
}

/// The ends of the reversible instances at the beginning of an extension from a goal node, each with the way back.
fn turned_around<D: Domain>(extension: &Extension<D>) -> Vec<Link<D>> {
    let mut links: Vec<Link<D>> = Vec::new();
    for (i, reached) in extension.reached.iter().enumerate() {
        let next = extension.reached.get(i + 1);
        if next.is_some_and(|next| Arc::ptr_eq(&next.instance, &reached.instance)) {
            continue;
        }
        let Some(back) = Reversed::instance(&reached.instance, reached.t) else { break };
        let step = PlanStep { instance: Arc::new(back), until: 1.0, primitive: reached.primitive };
        links.push(Link { state: reached.state.clone(), to: links.len().checked_sub(1), step });
    }
    links
}

impl<D: Domain> Connect<'_, D> {
    /// The goal node to which the way from `departure` is shortest; the lowest index wins a tie.
    fn nearest_goal_node(&self, departure: impl Fn(&GoalNode<D>) -> State<D>) -> Option<usize> {
        let m = self.forward.problem.domain();
        let distance = &self.forward.strategy.distance;
        let way = |node: &GoalNode<D>| distance.distance(m, &departure(node), &PartialState::of_state(m, &node.state));
        let ways = self.goal_nodes.iter().enumerate().map(|(i, node)| (i, way(node)));
        ways.min_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0))).map(|(i, _)| i)
    }

    /// Adds a state of the goal, if there are few and one is found: where a path from the start to a sample of the goal leads,
    /// whatever is in its way, so that its mode is one that can come about.
    fn look_for_goal(&mut self) {
        if self.goals > self.goal_nodes.len() / NODES_PER_GOAL {
            return;
        }
        let Darrt { problem, strategy, seed, attempt, iteration, .. } = &self.forward;
        let m = problem.domain();
        let rng = &mut stream(*seed, *attempt, *iteration, Purpose::Goal);
        let Some(target) = problem.goal().sample(m, rng) else { return };
        let way = path(m, problem.primitives(), problem.start(), &target, strategy.extend.max_depth, rng);
        let Some(state) = way.states.last() else { return };
        let is_valid = problem.validity().check(m, state, &D::Contacts::default()).is_ok();
        if is_valid && problem.goal().is_satisfied(m, state) {
            self.goal_nodes.push(GoalNode { state: state.clone(), next: None });
            self.goals += 1;
        }
    }
}

impl<D: Domain> Planner<D> for Connect<'_, D> {
    fn prove_start(&mut self) -> Option<Result<Solution<D>, Refusal>> {
        self.forward.prove_start()
    }

    fn step(&mut self) -> Step<D> {
        match self.phase {
            Phase::GrowForward => self.grow_forward(),
            Phase::GrowBackward => self.grow_backward(),
            Phase::ReachForGoal(node) => {
                self.phase = Phase::GrowBackward;
                let here = self.forward.tree().node(node).map(|node| node.state.clone());
                match here.and_then(|here| self.nearest_goal_node(|_| here.clone())) {
                    Some(goal_node) => self.reach(node, goal_node),
                    None => self.grow_forward(),
                }
            }
            Phase::ReachFor(goal_node) => {
                self.phase = Phase::GrowForward;
                let m = self.forward.problem.domain();
                let target = self.goal_nodes.get(goal_node).map(|goal| PartialState::of_state(m, &goal.state));
                match target.map(|target| self.forward.nearest(&target)) {
                    Some(node) => self.reach(node, goal_node),
                    None => self.grow_forward(),
                }
            }
        }
    }

    fn iteration(&self) -> u64 {
        self.forward.iteration()
    }

    fn nodes(&self) -> usize {
        self.forward.tree().len() + self.goal_nodes.len()
    }

    fn accounts(&self) -> Accounts {
        self.forward.accounts().clone()
    }

    fn nearest_to_goal(&self) -> f64 {
        self.forward.nearest_to_goal()
    }

    fn nearest(&self) -> Option<&State<D>> {
        Planner::nearest(&self.forward)
    }

    fn keep_track(&mut self) {
        self.forward.keep_track();
    }

    fn growth(&self) -> Option<Growth<'_, D>> {
        self.forward.growth()
    }

    fn parts(&self) -> Vec<Part<D>> {
        self.forward.parts()
    }
}

#[cfg(all(test, feature = "testing"))]
#[allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]
mod tests {
    use super::*;
    use crate::budget::Interrupt;
    use crate::testing::puck::{paper_strategy, problems};

    fn start(seed: u64) -> Start<'static> {
        Start { seed, attempt: 0, node_limit: usize::MAX, interrupt: Interrupt::NEVER, is_part: false }
    }

    #[test]
    fn every_goal_node_leads_to_the_next_bit_for_bit_and_no_push_runs_backwards() {
        let (problem, strategy) = (problems::two_pucks().unwrap(), paper_strategy().unwrap());
        let m = problem.domain();
        let mut connect = Connect::new(&problem, &strategy, start(1));
        (0..600).for_each(|_| drop(connect.step()));
        let (mut pushes, mut turned) = (0, 0);
        for node in &connect.goal_nodes {
            let Some((next, step)) = &node.next else {
                assert!(problem.goal().is_satisfied(m, &node.state));
                continue;
            };
            assert_eq!(step.instance.at(m, 0.0, problem.start()), node.state);
            assert_eq!(step.instance.at(m, step.until, problem.start()), connect.goal_nodes[*next].state);
            let free = problem.validity().free_prefix(m, &step.instance, &node.state);
            assert!(free.fraction >= step.until, "{}: {:?}", step.instance.primitive, free.blame);
            let is_turned = format!("{:?}", step.instance.motion).starts_with("Reversed");
            turned += u32::from(is_turned);
            pushes += u32::from(step.instance.primitive.name() == "Push");
            assert!(!is_turned || step.instance.primitive.name() != "Push");
        }
        assert!(pushes > 0 && turned > 0, "{pushes} pushes, {turned} turned around");
    }

    #[test]
    fn the_trees_meet() {
        let strategy = paper_strategy().unwrap();
        let mut met = 0;
        for (seed, (_, make)) in (0..5).flat_map(|seed| problems::ALL.map(|problem| (seed, problem))) {
            let problem = make().unwrap();
            let mut connect = Connect::new(&problem, &strategy, start(seed));
            for _ in 0..300 {
                let phase = connect.phase;
                if connect.step().solution.is_some() {
                    met += u32::from(matches!(phase, Phase::ReachFor(_) | Phase::ReachForGoal(_)));
                    break;
                }
            }
        }
        assert!(met >= 5, "{met}");
    }
}
