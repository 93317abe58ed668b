//! A long plan told in a picture of bounded length.

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
    /// The same story; a long one with like steps in a row made one, and of what is still too much only every so manyth
    /// state drawn. The note says how much that leaves out.
    pub(super) fn abridged(&self) -> Self {
        let count = self.steps.len();
        if count <= MOST {
            return self.clone();
        }
        let (steps, mut tellings) = merged(&self.steps);
        // Evenly, the last among them: it is the goal.
        let last = steps.len().saturating_sub(1);
        let drawn: Vec<usize> = (0..MOST).map(|i| i * last / (MOST - 1)).collect();
        if steps.len() > MOST {
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

/// Steps of one primitive and object in a row become one.
fn merged(steps: &[StoryStep]) -> (Vec<StoryStep>, Vec<Telling>) {
    let mut merged: Vec<StoryStep> = Vec::new();
    let mut tellings: Vec<Telling> = Vec::new();
    for (index, step) in steps.iter().enumerate() {
        match (merged.last_mut(), tellings.last_mut()) {
            (Some(same), Some(telling)) if same.primitive == step.primitive && same.object == step.object => {
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
