//! Parts of instances, one after the other, as one motion.

use std::fmt;
use std::sync::Arc;

use super::{Instance, Motion};
use crate::domain::Domain;
use crate::state::State;

/// An instance from one parameter to a later one.
pub struct Section<D: Domain> {
    /// The instance.
    pub instance: Arc<Instance<D>>,
    /// Where it begins, in `[0, 1)`.
    pub from: f64,
    /// Where it ends, in `(from, 1]`.
    pub to: f64,
}

impl<D: Domain> Clone for Section<D> {
    fn clone(&self) -> Self {
        Self { instance: Arc::clone(&self.instance), from: self.from, to: self.to }
    }
}

// Not derived, here and below: that would ask the domain to be printable.
impl<D: Domain> fmt::Debug for Section<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Section")
            .field("instance", &self.instance)
            .field("from", &self.from)
            .field("to", &self.to)
            .finish()
    }
}

impl<D: Domain> Section<D> {
    /// Metres of travel.
    pub fn length(&self) -> f64 {
        self.instance.motion.length() * (self.to - self.from)
    }

    /// The state at `share` in `[0, 1]` of it, both ends bit for bit those of the instance.
    pub fn at_into(&self, m: &D, share: f64, out: &mut State<D>) {
        let t = if share >= 1.0 { self.to } else { self.from + share.max(0.0) * (self.to - self.from) };
        self.instance.motion.at_into(m, t, out);
    }

    /// The same as a new value.
    pub fn at(&self, m: &D, share: f64, like: &State<D>) -> State<D> {
        let mut out = like.clone();
        self.at_into(m, share, &mut out);
        out
    }

    fn is_sound(&self) -> bool {
        let length_m = self.length();
        0.0 <= self.from && self.from < self.to && self.to <= 1.0 && length_m.is_finite() && length_m >= 0.0
    }
}

/// Runs its sections in order; the parameter is proportional to their travel.
///
/// It keeps the laws of [`Motion`] if every section ends where the next begins, bit for bit, and all have one mode from the
/// end of the first to the beginning of the last.
pub struct Spliced<D: Domain> {
    sections: Vec<Section<D>>,
    /// Parameter at which each section ends, never decreasing.
    ends: Vec<f64>,
    knots: Vec<f64>,
    length_m: f64,
}

impl<D: Domain> Spliced<D> {
    /// The motion of `sections`; `None` if there are none, or if one of them does not lie in `[0, 1]`, has no beginning before
    /// its end or no finite length.
    pub fn new(sections: Vec<Section<D>>) -> Option<Self> {
        if sections.is_empty() || !sections.iter().all(Section::is_sound) {
            return None;
        }
        let length_m: f64 = sections.iter().map(Section::length).sum();
        let (mut ends, mut knots) = (Vec::new(), Vec::new());
        let (mut travelled_m, mut begin) = (0.0, 0.0);
        for (i, section) in sections.iter().enumerate() {
            travelled_m += section.length();
            let is_last = i + 1 == sections.len();
            let end = if is_last || length_m <= 0.0 { 1.0 } else { (travelled_m / length_m).min(1.0) };
            let within = section.instance.motion.knots().iter().filter(|k| section.from < **k && **k < section.to);
            let share = |k: &f64| (k - section.from) / (section.to - section.from);
            knots.extend(within.map(|k| begin + share(k) * (end - begin)));
            knots.push(end);
            ends.push(end);
            begin = end;
        }
        Some(Self { sections, ends, knots, length_m })
    }

    /// The same as an instance that is called, touches and moves what `like` does.
    pub fn instance(sections: Vec<Section<D>>, like: &Instance<D>) -> Option<Instance<D>> {
        let Instance { primitive, moves, object, reversible, .. } = *like;
        let motion = Box::new(Self::new(sections)?);
        Some(Instance { primitive, motion, contacts: like.contacts.clone(), moves, object, reversible })
    }
}

impl<D: Domain> Motion<D> for Spliced<D> {
    fn length(&self) -> f64 {
        self.length_m
    }

    fn knots(&self) -> &[f64] {
        &self.knots
    }

    fn at_into(&self, m: &D, t: f64, out: &mut State<D>) {
        // A first or last section of no length would be hidden by its neighbour.
        let index = match t {
            t if t <= 0.0 => 0,
            t if t >= 1.0 => self.sections.len().saturating_sub(1),
            t => self.ends.partition_point(|end| *end < t),
        };
        let (Some(section), Some(end)) = (self.sections.get(index), self.ends.get(index)) else { return };
        let begin = index.checked_sub(1).and_then(|before| self.ends.get(before)).copied().unwrap_or(0.0);
        let share = match t {
            t if t <= 0.0 => 0.0,
            t if t >= *end => 1.0,
            t => (t - begin) / (end - begin),
        };
        section.at_into(m, share, out);
    }
}

impl<D: Domain> fmt::Debug for Spliced<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Spliced").field("sections", &self.sections).field("ends", &self.ends).finish_non_exhaustive()
    }
}
