//! The laws of every trait as plain functions: how an implementor knows that a robot, a primitive or a
//! space is right.
//!
//! | your type implements | call | the laws |
//! |---|---|---|
//! | [`ComponentSpace`](crate::space::ComponentSpace) | [`check_component_space`], [`check_space_covers`], [`check_covering`] | [`space`] |
//! | [`Domain`](crate::domain::Domain) | [`check_domain`], [`check_partial`] | [`domain`], [`partial`] |
//! | [`Distance`](crate::distance::Distance) | [`check_distance`], [`check_metric`], [`check_lower_bound`], [`check_nearest`] | [`distance`], [`nearest`] |
//! | [`Motion`](crate::motion::Motion) | [`check_motion`], [`check_instance`] | [`motion`] |
//! | [`Primitive`](crate::primitive::Primitive) | [`check_primitive`], [`try_primitive`], [`check_contacts`] | [`primitive`] |
//! | [`Validity`](crate::validity::Validity) | [`check_validity`], [`check_by_oracle`], [`check_against_oracle`], [`check_enlarged`] | [`validity`] |
//! | [`Goal`](crate::goal::Goal) | [`check_goal`] | [`goal`] |
//! | [`Sampler`](crate::sample::Sampler) | [`check_sampler`], [`check_sampler_covers`], [`check_sampler_learns`] | [`sampler`] |
//! | [`Verifier`](crate::verify::Verifier) | [`check_verifier`], [`check_ways`] | [`verifier`] |
//! | [`LocalRepair`](crate::local_repair::LocalRepair) | [`check_local_repair`] | [`local_repair`] |
//! | [`ExecutionCost`](crate::cost::ExecutionCost) | [`check_cost`] | [`cost`] |
//! | all of them together | [`check_planner`], [`check_accounts`], [`check_cancel`] | [`planner`] |
//! | whatever you brought | [`check_everything`], [`check_thoroughly`] | all |
//! | every call | | [`watch`] |
//!
//! Each function takes concrete inputs and returns the first law that is broken. Call them from a property
//! test (the inputs then shrink), a fuzz target, a doctest or a debug assertion; the feature `testing`
//! has proptest strategies for the states and targets of any domain in
//! [`testing::strategies`](crate::testing::strategies), and for every law here an implementor in
//! [`testing::broken`](crate::testing::broken) that it rejects.
//!
//! # Example
//! ```
//! use darrt_core::laws::{SpaceClaims, check_component_space};
//! use darrt_core::space::So2;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let circle = So2::new(1.0)?;
//! check_component_space(&circle, &SpaceClaims::default(), [&3.1, &-3.1, &0.0], [0.25, 0.5], 7)?;
//! # Ok(())
//! # }
//! ```

use std::fmt::{self, Debug};

pub mod cost;
pub mod distance;
pub mod domain;
pub mod everything;
mod feed;
pub mod goal;
pub mod local_repair;
pub mod motion;
pub mod nearest;
pub mod partial;
pub mod planner;
pub mod primitive;
pub mod sampler;
pub mod space;
pub mod validity;
pub mod verifier;
pub mod watch;

pub use cost::check_cost;
pub use distance::{DistanceClaims, check_distance, check_lower_bound, check_metric, check_not_above};
pub use domain::check_domain;
pub use everything::{Effort, Report, Subjects, check_everything, check_thoroughly};
pub use goal::check_goal;
pub use local_repair::check_local_repair;
pub use motion::{MotionClaims, check_instance, check_motion};
pub use nearest::check_nearest;
pub use partial::check_partial;
pub use planner::{check_accounts, check_cancel, check_planner};
pub use primitive::{PrimitiveClaims, Tried, check_contacts, check_primitive, try_primitive};
pub use sampler::{check_sampler, check_sampler_covers, check_sampler_learns};
pub use space::{SpaceClaims, check_component_space, check_covering, check_space_covers};
pub use validity::{ValidityClaims, check_against_oracle, check_by_oracle, check_enlarged, check_validity};
pub use verifier::{Judged, Tampered, check_verifier, check_ways};
pub use watch::{or_abandon, with_patience};

/// A law that does not hold, with everything needed to see why and to see it again.
#[derive(Debug, Clone, PartialEq)]
pub struct Broken {
    /// The law: its short name, a colon, and what it says. One of [`all`].
    pub law: &'static str,
    /// Who breaks it: a component, an instance, a primitive; empty if there is only one candidate.
    pub component: Box<str>,
    /// The parameter (of a motion or an interpolation) at which it shows.
    pub parameter: Option<f64>,
    /// What was found.
    pub left: Box<str>,
    /// What it was held against.
    pub right: Box<str>,
    /// By how much the two may differ; 0 means bit for bit.
    pub tolerance: f64,
    /// The call that shows it again.
    pub replay: Box<str>,
}

impl Broken {
    /// `law` is broken: `left` was found where `right` was asked for.
    pub fn new(law: &'static str, left: impl Into<Box<str>>, right: impl Into<Box<str>>) -> Self {
        Self {
            law,
            component: Box::default(),
            parameter: None,
            left: left.into(),
            right: right.into(),
            tolerance: 0.0,
            replay: Box::default(),
        }
    }

    /// The short name of the law: what stands before the colon.
    pub fn name(&self) -> &'static str {
        name_of(self.law)
    }

    /// This, shown at parameter `t`.
    #[must_use]
    pub fn at(mut self, t: f64) -> Self {
        self.parameter = Some(t);
        self
    }

    /// This, with the difference that would have been allowed.
    #[must_use]
    pub fn within(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// This, put down to `component`; a name given earlier is kept behind it.
    #[must_use]
    pub fn of(mut self, component: impl fmt::Display) -> Self {
        self.component = if self.component.is_empty() {
            component.to_string().into()
        } else {
            format!("{component}, {}", self.component).into()
        };
        self
    }

    /// This, with the call that shows it again, unless one is already given.
    #[must_use]
    pub fn replayed_by(mut self, call: impl FnOnce() -> String) -> Self {
        if self.replay.is_empty() {
            self.replay = call().into();
        }
        self
    }
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, says) = self.law.split_once(": ").unwrap_or((self.law, ""));
        write!(f, "broken law {name}: {says}")?;
        if !self.component.is_empty() {
            write!(f, "\n  by:      {}", self.component)?;
        }
        if let Some(t) = self.parameter {
            write!(f, "\n  at t =   {t:?}")?;
        }
        write!(f, "\n  found:   {}\n  against: {}", self.left, self.right)?;
        if self.tolerance > 0.0 {
            write!(f, "\n  allowed: a difference of {:?}", self.tolerance)?;
        }
        if !self.replay.is_empty() {
            write!(f, "\n  replay:  {}", self.replay)?;
        }
        Ok(())
    }
}

impl std::error::Error for Broken {}

/// The short name of a law: what stands before the colon.
pub fn name_of(law: &'static str) -> &'static str {
    law.split_once(':').map_or(law, |(name, _)| name)
}

/// Every law that the kit knows.
pub fn all() -> impl Iterator<Item = &'static str> {
    let groups: [&[&str]; 15] = [
        watch::LAWS,
        space::LAWS,
        domain::LAWS,
        partial::LAWS,
        distance::LAWS,
        nearest::LAWS,
        motion::LAWS,
        primitive::LAWS,
        validity::LAWS,
        goal::LAWS,
        sampler::LAWS,
        planner::LAWS,
        verifier::LAWS,
        local_repair::LAWS,
        cost::LAWS,
    ];
    groups.into_iter().flatten().copied()
}

/// Equal, and printed alike: with floating-point numbers inside, bit for bit (a zero keeps its sign).
fn identical<T: PartialEq + Debug>(law: &'static str, found: &T, against: &T) -> Result<(), Broken> {
    let (left, right) = (format!("{found:?}"), format!("{against:?}"));
    if found == against && left == right { Ok(()) } else { Err(Broken::new(law, left, right)) }
}

/// Equal, or printed alike: two values that are both NaN in the same place agree, so that what is wrong with them is told by
/// the law that they break and not by one about repetition.
fn alike<T: PartialEq + Debug>(law: &'static str, found: &T, against: &T) -> Result<(), Broken> {
    if found == against {
        return Ok(());
    }
    let (left, right) = (format!("{found:?}"), format!("{against:?}"));
    if left == right { Ok(()) } else { Err(Broken::new(law, left, right)) }
}

/// Equal by `==`; a value that is not equal to itself (NaN) fails. For laws of your own.
///
/// # Errors
/// [`Broken`] with both values.
pub fn equal<T: PartialEq + Debug>(law: &'static str, found: &T, against: &T) -> Result<(), Broken> {
    if found == against { Ok(()) } else { Err(Broken::new(law, format!("{found:?}"), format!("{against:?}"))) }
}

/// `found <= bound + slack`; NaN fails. For laws of your own.
///
/// # Errors
/// [`Broken`] with both numbers and the slack.
pub fn at_most(law: &'static str, found: f64, bound: f64, slack: f64) -> Result<(), Broken> {
    if found <= bound + slack {
        Ok(())
    } else {
        Err(Broken::new(law, format!("{found:?}"), format!("at most {bound:?}")).within(slack))
    }
}

/// Finite and not negative. For laws of your own.
///
/// # Errors
/// [`Broken`] with the number.
pub fn measure(law: &'static str, found: f64) -> Result<(), Broken> {
    if found.is_finite() && found >= 0.0 {
        Ok(())
    } else {
        Err(Broken::new(law, format!("{found:?}"), "a finite number that is not negative"))
    }
}

/// `holds`, or what was found and what was asked for. For laws of your own.
///
/// # Errors
/// [`Broken`] with both texts.
pub fn ensure(
    law: &'static str,
    holds: bool,
    found: impl FnOnce() -> String,
    against: &'static str,
) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(Broken::new(law, found(), against)) }
}

#[cfg(test)]
mod tests;
