//! Configurations one after the other, without repeating what stays.

use crate::manipulator::{Configuration, JointVector};

/// A start and what follows it.
#[derive(Debug)]
pub(crate) struct Configurations<J> {
    start: Configuration<J>,
    rest: Rest<J>,
}

/// What follows the start. On most ways either the base or the arm rests from end to end.
#[derive(Debug)]
enum Rest<J> {
    Arms(Box<[J]>),
    Bases(Box<[[f64; 3]]>),
    Both(Box<[Configuration<J>]>),
}

impl<J: JointVector> Configurations<J> {
    /// From `start` through `rest`.
    pub(crate) fn new(start: Configuration<J>, rest: impl ExactSizeIterator<Item = Configuration<J>> + Clone) -> Self {
        let rest = if rest.clone().all(|q| is_same(&q.base, &start.base)) {
            Rest::Arms(rest.map(|q| q.arm).collect())
        } else if rest.clone().all(|q| is_same_arm(&q.arm, &start.arm)) {
            Rest::Bases(rest.map(|q| q.base).collect())
        } else {
            Rest::Both(rest.collect())
        };
        Self { start, rest }
    }

    /// Where it starts.
    pub(crate) fn start(&self) -> &Configuration<J> {
        &self.start
    }

    /// Where it ends.
    pub(crate) fn last(&self) -> Configuration<J> {
        let rest = match &self.rest {
            Rest::Arms(arms) => arms.len(),
            Rest::Bases(bases) => bases.len(),
            Rest::Both(robots) => robots.len(),
        };
        self.get(rest).unwrap_or(self.start)
    }

    /// The configuration at `index`, 0 for the start; `None` past the end.
    pub(crate) fn get(&self, index: usize) -> Option<Configuration<J>> {
        let Some(after) = index.checked_sub(1) else { return Some(self.start) };
        match &self.rest {
            Rest::Arms(arms) => arms.get(after).map(|arm| Configuration { arm: *arm, ..self.start }),
            Rest::Bases(bases) => bases.get(after).map(|base| Configuration { base: *base, ..self.start }),
            Rest::Both(robots) => robots.get(after).copied(),
        }
    }
}

fn is_same_arm<J: JointVector>(a: &J, b: &J) -> bool {
    a.hand_at_work() == b.hand_at_work() && is_same(a.as_ref(), b.as_ref())
}

/// Bit for bit, so that what is read is what was written: for `==` the zeros are one.
fn is_same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(start: Configuration<[f64; 2]>, rest: &[Configuration<[f64; 2]>]) -> Configurations<[f64; 2]> {
        let way = Configurations::new(start, rest.iter().copied());
        let all: Vec<_> = (0..).map_while(|i| way.get(i)).collect();
        let given: Vec<_> = [start].iter().chain(rest).copied().collect();
        // As text, in which the zeros differ.
        assert_eq!(format!("{all:?}"), format!("{given:?}"));
        assert_eq!(Some(&way.last()), given.last());
        way
    }

    #[test]
    fn a_way_gives_what_it_was_given_and_keeps_no_more_than_moves() {
        let at = |x, arm| Configuration { base: [x, 1.0, 2.0], arm };
        let start = at(0.0, [0.0, 3.0]);
        assert!(matches!(kept(start, &[]).rest, Rest::Arms(_)));
        assert!(matches!(kept(start, &[at(0.0, [4.0, 3.0]), at(0.0, [5.0, 3.0])]).rest, Rest::Arms(_)));
        assert!(matches!(kept(start, &[at(4.0, [0.0, 3.0])]).rest, Rest::Bases(_)));
        assert!(matches!(kept(start, &[at(4.0, [0.0, 3.0]), at(4.0, [1.0, 3.0])]).rest, Rest::Both(_)));
        // A zero of the other sign is another number.
        assert!(matches!(kept(start, &[at(-0.0, [0.0, 3.0])]).rest, Rest::Bases(_)));
        assert!(matches!(kept(start, &[at(-0.0, [-0.0, 3.0])]).rest, Rest::Both(_)));
    }
}
