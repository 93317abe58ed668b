//! Two spaces side by side: base and arm, or two robots.

use rand::Rng;

use super::{ComponentSpace, GroupSet};

/// `A x B`. Its groups are those of `A` followed by those of `B`; its distance is the sum.
#[derive(Debug, Clone, PartialEq)]
pub struct Product<A, B> {
    first: A,
    second: B,
}

impl<A: ComponentSpace, B: ComponentSpace> Product<A, B> {
    /// The product of two spaces.
    pub fn new(first: A, second: B) -> Self {
        Self { first, second }
    }

    /// The first factor.
    pub fn first(&self) -> &A {
        &self.first
    }

    /// The second factor.
    pub fn second(&self) -> &B {
        &self.second
    }

    fn first_groups(&self) -> u32 {
        (0..32).take_while(|i| self.first.groups().contains(*i)).count().try_into().unwrap_or(32)
    }
}

impl<A: ComponentSpace, B: ComponentSpace> ComponentSpace for Product<A, B> {
    type Config = (A::Config, B::Config);

    fn dimension(&self) -> usize {
        self.first.dimension() + self.second.dimension()
    }

    fn contains(&self, q: &Self::Config) -> bool {
        self.first.contains(&q.0) && self.second.contains(&q.1)
    }

    fn distance(&self, a: &Self::Config, b: &Self::Config) -> f64 {
        self.first.distance(&a.0, &b.0) + self.second.distance(&a.1, &b.1)
    }

    fn interpolate(&self, a: &Self::Config, b: &Self::Config, t: f64) -> Self::Config {
        (self.first.interpolate(&a.0, &b.0, t), self.second.interpolate(&a.1, &b.1, t))
    }

    fn sample(&self, rng: &mut dyn Rng) -> Self::Config {
        (self.first.sample(rng), self.second.sample(rng))
    }

    fn tolerance(&self) -> f64 {
        self.first.tolerance() + self.second.tolerance()
    }

    fn groups(&self) -> GroupSet {
        self.first.groups().union(self.second.groups().shifted(self.first_groups()))
    }

    fn overlay(&self, from: &Self::Config, target: &Self::Config, groups: GroupSet) -> Self::Config {
        let of_first = groups.intersection(self.first.groups());
        (
            self.first.overlay(&from.0, &target.0, of_first),
            self.second.overlay(&from.1, &target.1, groups.lowered(self.first_groups())),
        )
    }
}
