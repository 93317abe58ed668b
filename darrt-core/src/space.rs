//! The configuration space of one movable component, and the stock spaces.
//!
//! May touch: nothing of the search. Everything here is a pure function of its arguments and the
//! caller's generator.

use std::fmt::Debug;

use rand::Rng;

pub mod fixed;
pub mod numbers;
pub mod product;
pub mod real_box;
pub mod se2;
pub mod se3;
pub mod so2;

pub use fixed::Fixed;
pub use product::Product;
pub use real_box::RealBox;
pub use se2::Se2;
pub use se3::Se3;
pub use so2::So2;

/// A set of the independently nameable parts of one component, for example base and arm of a robot.
///
/// A target may name only some groups of the robot: "the base there, the arm as it is". Bit `i` stands
/// for group `i`; at most 32 groups.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct GroupSet(u32);

impl GroupSet {
    /// No group.
    pub const NONE: Self = Self(0);

    /// The groups `0 .. count` (`count` is clamped to 32).
    pub const fn first(count: u32) -> Self {
        if count >= 32 { Self(u32::MAX) } else { Self((1 << count) - 1) }
    }

    /// The single group `index` (empty when `index >= 32`).
    pub const fn only(index: u32) -> Self {
        if index >= 32 { Self(0) } else { Self(1 << index) }
    }

    /// Is group `index` in the set?
    pub const fn contains(self, index: u32) -> bool {
        index < 32 && self.0 & (1 << index) != 0
    }

    /// Is every group of `other` in this set?
    pub const fn covers(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Groups in either set.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Groups in both sets.
    #[must_use]
    pub const fn intersection(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// Groups shifted up by `by`, for products of spaces.
    #[must_use]
    pub const fn shifted(self, by: u32) -> Self {
        if by >= 32 { Self(0) } else { Self(self.0 << by) }
    }

    /// Groups shifted down by `by`, for products of spaces.
    #[must_use]
    pub const fn lowered(self, by: u32) -> Self {
        if by >= 32 { Self(0) } else { Self(self.0 >> by) }
    }

    /// Is the set empty?
    pub const fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// A kind of place at which an object can be drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Where it stands on something.
    OnSupport,
    /// Where it stands close to an edge of what it stands on.
    SupportEdge,
}

/// Configuration space of one movable component, `m` in `{R, o_1 ... o_n}` (paper section 3).
///
/// # Laws
/// - `distance(a, a) == 0`, `distance(a, b) == distance(b, a)`, both finite and non-negative.
/// - `interpolate(a, b, 0.0) == a` and `interpolate(a, b, 1.0) == b`, bit for bit; in between it stays in
///   the space and its distance to `a` never shrinks.
/// - `sample` is contained in the space.
/// - Between the index coordinates of two configurations, each coordinate of the groups that `overlay` takes over counted, lie at most
///   as many metres as between the first and the overlay.
/// - `overlay(from, target, all groups) == target` and `overlay(from, target, none) == from`.
///
/// # Example
/// A point on a segment of two metres:
/// ```
/// use darrt_core::space::ComponentSpace;
/// use rand::{Rng, RngExt};
///
/// #[derive(Debug)]
/// struct Segment;
/// impl ComponentSpace for Segment {
///     type Config = f64;
///     fn dimension(&self) -> usize { 1 }
///     fn contains(&self, q: &f64) -> bool { (0.0..=2.0).contains(q) }
///     fn distance(&self, a: &f64, b: &f64) -> f64 { (a - b).abs() }
///     fn interpolate(&self, a: &f64, b: &f64, t: f64) -> f64 {
///         if t >= 1.0 { *b } else { a + (b - a) * t }
///     }
///     fn sample(&self, rng: &mut dyn Rng) -> f64 { rng.random_range(0.0..=2.0) }
/// }
/// assert_eq!(Segment.distance(&0.5, &1.5), 1.0);
/// ```
pub trait ComponentSpace: Send + Sync {
    /// One configuration. Cheap to clone: it is copied into every node of the tree.
    type Config: Clone + PartialEq + Debug + Send + Sync + 'static;

    /// Degrees of freedom.
    fn dimension(&self) -> usize;

    /// Is `q` finite and inside the bounds?
    fn contains(&self, q: &Self::Config) -> bool;

    /// Metres that the reference points must travel from `a` to `b`.
    fn distance(&self, a: &Self::Config, b: &Self::Config) -> f64;

    /// The configuration at `t` in `[0, 1]` on the way from `a` to `b`; the ends bit for bit.
    fn interpolate(&self, a: &Self::Config, b: &Self::Config, t: f64) -> Self::Config;

    /// A random configuration.
    fn sample(&self, rng: &mut dyn Rng) -> Self::Config;

    /// A random configuration at such a place; `None` if the space knows none.
    fn sample_at(&self, _place: Place, _rng: &mut dyn Rng) -> Option<Self::Config> {
        None
    }

    /// The distance (in the unit of [`distance`](Self::distance)) up to which two configurations count as
    /// the same when a target is compared with a state. Default: a nanometre.
    fn tolerance(&self) -> f64 {
        1e-9
    }

    /// The groups that a target may name on their own. Default: one, the whole component.
    fn groups(&self) -> GroupSet {
        GroupSet::first(1)
    }

    /// Calls `mark` with the group and the value, in metres, of coordinates whose Euclidean distance is never above
    /// [`distance`](Self::distance): always as many, in the same order, of the same groups. They let the search for the
    /// nearest node pass over most of the tree. Default: none.
    fn index_coordinates(&self, _q: &Self::Config, _mark: &mut dyn FnMut(u32, f64)) {}

    /// Calls `visit` with every number that `q` is made of, always as many and in the same order. The laws put NaN, infinities
    /// and the corners of the space there; nothing else asks. Default: the numbers of the types that
    /// [`visit_known`](numbers::visit_known) knows. A space with a type of its own for configurations should show them.
    fn numbers(&self, q: &mut Self::Config, visit: &mut dyn FnMut(&mut f64)) {
        numbers::visit_known(q, visit);
    }

    /// `target` in the groups of `groups`, `from` in all others.
    fn overlay(&self, from: &Self::Config, target: &Self::Config, groups: GroupSet) -> Self::Config {
        if groups.covers(self.groups()) { target.clone() } else { from.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_sets_are_sets_of_at_most_32() {
        assert_eq!(GroupSet::first(0), GroupSet::NONE);
        assert_eq!(GroupSet::first(2), GroupSet::only(0).union(GroupSet::only(1)));
        assert!(GroupSet::first(99).contains(31) && !GroupSet::first(99).contains(32));
        assert!(GroupSet::only(32).is_empty() && GroupSet::only(31).shifted(1).is_empty());
        assert_eq!(GroupSet::only(3).shifted(2).lowered(5), GroupSet::only(0));
        assert!(GroupSet::only(3).shifted(32).is_empty() && GroupSet::only(3).lowered(32).is_empty());
        assert!(GroupSet::first(3).covers(GroupSet::only(2)) && !GroupSet::only(2).covers(GroupSet::first(3)));
        assert_eq!(GroupSet::first(3).intersection(GroupSet::only(2)), GroupSet::only(2));
    }

    #[test]
    fn a_fixed_component_never_moves() {
        let rock = Fixed::new("rock");
        assert_eq!(rock.dimension(), 0);
        assert!(rock.contains(&"rock") && !rock.contains(&"paper"));
        assert_eq!(rock.sample(&mut crate::random::stream(0, 0, 0, crate::random::Purpose::Sample)), "rock");
    }
}
