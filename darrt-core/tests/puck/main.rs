//! The planner on the puck world: what it solves, when it stops, what it counts, and what it survives.

#[cfg(test)]
mod accounts;
#[cfg(test)]
mod around;
#[cfg(test)]
mod clearance;
#[cfg(test)]
mod deferred;
#[cfg(test)]
mod extension;
#[cfg(test)]
mod improved;
#[cfg(test)]
mod misbehaviour;
#[cfg(test)]
mod path;
#[cfg(test)]
mod primitives;
#[cfg(test)]
mod printing;
#[cfg(test)]
mod problem_errors;
#[cfg(test)]
mod refusals;
#[cfg(test)]
mod replay;
#[cfg(test)]
mod shortened;
#[cfg(test)]
mod smoothed;
#[cfg(test)]
mod solved;
#[cfg(test)]
mod stops;
#[cfg(test)]
mod support;
#[cfg(test)]
mod targets;
#[cfg(test)]
mod threads;
