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

    fn numbers(&self, q: &mut Self::Config, visit: &mut dyn FnMut(&mut f64)) {
        self.first.numbers(&mut q.0, visit);
        self.second.numbers(&mut q.1, visit);
    }

    fn index_coordinates(&self, q: &Self::Config, mark: &mut dyn FnMut(u32, f64)) {
        self.first.index_coordinates(&q.0, mark);
        let by = self.first_groups();
        self.second.index_coordinates(&q.1, &mut |group, x| mark(group.saturating_add(by), x));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::{Fixed, RealBox, Se2};

    type BaseArmTool = Product<Product<Se2, RealBox<7>>, Fixed<u8>>;

    fn robot() -> BaseArmTool {
        let base = Se2::new([0.0; 2], [5.0; 2], 0.5).unwrap();
        let arm = RealBox::new([-3.0; 7], [3.0; 7]).unwrap();
        Product::new(Product::new(base, arm), Fixed::new(1))
    }

    #[test]
    fn groups_of_nested_products_line_up() {
        assert_eq!(robot().groups(), GroupSet::first(3));
        assert_eq!(robot().dimension(), 10);
    }

    #[test]
    fn an_overlay_takes_the_named_groups_only() {
        let from = (([1.0, 1.0, 0.0], [0.0; 7]), 1);
        let to = (([2.0, 2.0, 1.0], [1.0; 7]), 2);
        for (groups, expected) in [
            (GroupSet::NONE, from),
            (GroupSet::only(0), ((to.0.0, from.0.1), 1)),
            (GroupSet::only(1), ((from.0.0, to.0.1), 1)),
            (GroupSet::only(2), (from.0, 2)),
            (GroupSet::first(2), (to.0, 1)),
            (GroupSet::first(3), to),
        ] {
            assert_eq!(robot().overlay(&from, &to, groups), expected, "{groups:?}");
        }
    }

    #[test]
    fn distances_add_and_ends_are_exact() {
        let a = (([1.0, 1.0, 0.0], [0.0; 7]), 1);
        let b = (([1.0, 2.0, 1.0], [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 1);
        assert!((robot().distance(&a, &b) - 2.5).abs() < 1e-12);
        assert_eq!(robot().interpolate(&a, &b, 0.0), a);
        assert_eq!(robot().interpolate(&a, &b, 1.0), b);
        assert!(robot().contains(&a) && !robot().contains(&(a.0, 2)));
    }
}
