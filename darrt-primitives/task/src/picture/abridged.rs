//! A long plan told in a picture of bounded length.

use std::collections::BTreeSet;

use super::act::Act;
use super::story::{Story, StoryStep};

/// Plans of at most this many steps are drawn step by step; of longer ones so many states are drawn.
pub(super) const MOST: usize = 30;

/// Which steps of the plan one step of an abridged story stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Telling {
    /// Number of the first step, from 1.
    pub(super) first: usize,
    /// Number of the last step.
    pub(super) last: usize,
    /// Whether the robot is drawn there; the ways of the objects are drawn in any case.
    pub(super) is_drawn: bool,
}

impl Telling {
    /// A step that stands for itself.
    pub(super) fn single(index: usize) -> Self {
        Self { first: index + 1, last: index + 1, is_drawn: true }
    }

    /// `7`, or `7-9`.
    pub(super) fn label(self) -> String {
        if self.first == self.last { self.first.to_string() } else { format!("{}\u{2013}{}", self.first, self.last) }
    }
}

impl Story {
    /// The same story. In a long one like steps in a row become one, and if that is still too much only some of the states
    /// are drawn; the note says how much that leaves out.
    pub(super) fn abridged(&self) -> Self {
        let count = self.steps.len();
        if count <= MOST {
            return self.clone();
        }
        let (steps, mut tellings) = merged(&self.steps);
        if steps.len() > MOST {
            let drawn = chosen(&steps);
            for (index, telling) in tellings.iter_mut().enumerate() {
                telling.is_drawn = drawn.contains(&index);
            }
        }
        let left_out: usize = tellings.iter().filter(|t| !t.is_drawn).map(|t| t.last + 1 - t.first).sum();
        let joined = "Steps of one kind in a row are drawn as one.".to_owned();
        let fewer = format!("{left_out} of the {count} steps are not drawn; the ways of the objects are complete.");
        let sentences = [self.note.clone(), joined, if left_out > 0 { fewer } else { String::new() }];
        let note = sentences.into_iter().filter(|sentence| !sentence.is_empty()).collect::<Vec<_>>().join(" ");
        Self { note, steps, tellings, ..self.clone() }
    }

    /// Which steps of the plan the step at `index` stands for.
    pub(super) fn telling(&self, index: usize) -> Telling {
        self.tellings.get(index).copied().unwrap_or_else(|| Telling::single(index))
    }

    /// The steps at whose end the robot is drawn, with their indices.
    pub(super) fn drawn_steps(&self) -> impl Iterator<Item = (usize, &StoryStep)> {
        self.steps.iter().enumerate().filter(|(index, _)| self.telling(*index).is_drawn)
    }
}

/// The steps that are drawn: first those that change how an object stands, then the others, each kind evenly.
fn chosen(steps: &[StoryStep]) -> BTreeSet<usize> {
    let tells = |index: &usize| {
        let act = steps.get(*index).map(|step| step.act);
        let acts = act.is_some_and(Act::manipulates);
        // The last state is the goal.
        acts || index + 1 == steps.len()
    };
    let (first, then): (Vec<usize>, Vec<usize>) = (0..steps.len()).partition(tells);
    let mut drawn: BTreeSet<usize> = evenly(&first, MOST).collect();
    drawn.extend(evenly(&then, MOST - drawn.len().min(MOST)));
    drawn
}

/// At most `count` of the indices at even distances, the last among them.
fn evenly(indices: &[usize], count: usize) -> impl Iterator<Item = usize> {
    let taken = count.min(indices.len());
    let place = move |i: usize| (i + 1) * indices.len() / taken.max(1) - 1;
    (0..taken).filter_map(move |i| indices.get(place(i)).copied())
}

/// Steps of one primitive, hand and object in a row become one.
fn merged(steps: &[StoryStep]) -> (Vec<StoryStep>, Vec<Telling>) {
    let mut merged: Vec<StoryStep> = Vec::new();
    let mut tellings: Vec<Telling> = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        match (merged.last_mut(), tellings.last_mut()) {
            (Some(same), Some(telling))
                if same.primitive == step.primitive && same.hand == step.hand && same.object == step.object =>
            {
                same.snapshots.extend(step.snapshots.iter().cloned());
                telling.last = index + 1;
            }
            _ => {
                merged.push(step.clone());
                tellings.push(Telling::single(index));
            }
        }
    }
    (merged, tellings)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_choices_end_with_the_last() {
        let choice = |length: usize, count| evenly(&(0..length).collect::<Vec<_>>(), count).collect::<Vec<_>>();
        assert_eq!(choice(10, 5), [1, 3, 5, 7, 9]);
        assert_eq!(choice(7, 3), [1, 3, 6]);
        assert_eq!(choice(3, 5), [0, 1, 2]);
        assert!(choice(3, 0).is_empty() && choice(0, 3).is_empty());
    }
}
