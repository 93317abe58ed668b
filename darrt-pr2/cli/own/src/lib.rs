//! A program of one's own: the PR2 with Pull, a cost that spares the arm, and a sampler that looks mostly at objects.

pub mod gentle;
pub mod mostly;
pub mod pull;

use darrt_pr2::robot::Pr2;
use darrt_task::registry::Registry;

/// What this program knows: all that `darrt` knows, and three things more.
pub fn registry() -> Registry<Pr2> {
    darrt_pr2::registry()
        .with_primitive::<pull::Pull>()
        .with_cost("gentle", || Box::new(gentle::Gentle))
        .with_sampler("mostly-objects", |_| Ok(Box::new(mostly::MostlyObjects)))
}
