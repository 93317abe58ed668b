//! What rests on what, what is held, and how the hand stands to the objects: the mode of a state.

use std::sync::Arc;

use darrt_core::state::ObjectId;
use nalgebra::Isometry3;
use smallvec::SmallVec;

/// Index of a support surface in its domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SurfaceId(u8);

impl SurfaceId {
    /// The surface with this index; indices past 255 saturate and so name no surface.
    pub fn new(index: usize) -> Self {
        Self(u8::try_from(index).unwrap_or(u8::MAX))
    }

    /// Position in the domain's list.
    pub fn index(self) -> usize {
        usize::from(self.0)
    }
}

/// An object in the hand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held {
    /// Which object.
    pub object: ObjectId,
    /// The grasp: rigid for as long as it is held.
    pub tool_from_object: Isometry3<f64>,
    /// How far the object's z axis may lean from the vertical before the grasp yields, radians; pi: never.
    pub max_tilt_rad: f64,
}

/// The mode. Legal transitions are the methods; each returns `None` when it is not legal from here.
///
/// | from | transition | to |
/// |---|---|---|
/// | resting, hand free | [`Mode::engaged_with`] | resting, hand beside it |
/// | resting, hand beside it | [`Mode::disengaged`] | resting, hand free |
/// | resting, nothing held | [`Mode::attached`] | held |
/// | held | [`Mode::released_on`] | resting, hand beside it |
///
/// A clone shares what it was cloned from: most nodes and motions of a tree are in one of few modes.
#[derive(Debug, PartialEq)]
pub struct Mode {
    facts: Arc<Facts>,
    /// The object beside, around or under which the hand stands: it must retreat in a straight line before it may do
    /// anything else. Not among the facts, so that they are shared before, beside it and after.
    engaged: Option<ObjectId>,
    /// See [`Mode::hand`].
    hand: u16,
    /// See [`Mode::done`].
    done: u64,
}

/// What a mode says of every object and of the fingers.
#[derive(Debug, Clone, PartialEq)]
struct Facts {
    rests_on: SmallVec<[Option<SurfaceId>; 8]>,
    /// Apart, because in most modes there is none.
    held: Option<Box<Held>>,
    gap_m: f64,
}

impl Clone for Mode {
    fn clone(&self) -> Self {
        Self { facts: Arc::clone(&self.facts), engaged: self.engaged, hand: self.hand, done: self.done }
    }

    /// Motions write their mode again and again into the same state: nothing is counted as long as it stays.
    fn clone_from(&mut self, source: &Self) {
        if !Arc::ptr_eq(&self.facts, &source.facts) {
            self.facts = Arc::clone(&source.facts);
        }
        (self.engaged, self.hand, self.done) = (source.engaged, source.hand, source.done);
    }
}

impl Mode {
    /// Every object rests on the given surface, the hand is free and open by `gap_m`.
    pub fn resting(rests_on: impl IntoIterator<Item = SurfaceId>, gap_m: f64) -> Self {
        let rests_on = rests_on.into_iter().map(Some).collect();
        Self { facts: Arc::new(Facts { rests_on, held: None, gap_m }), engaged: None, hand: 0, done: 0 }
    }

    /// The surface that `object` rests on; `None` while it is held.
    pub fn support_of(&self, object: ObjectId) -> Option<SurfaceId> {
        self.facts.rests_on.get(object.index()).copied().flatten()
    }

    /// What the hand holds.
    pub fn held(&self) -> Option<&Held> {
        self.facts.held.as_deref()
    }

    /// The object that the hand must first retreat from.
    pub fn engaged(&self) -> Option<ObjectId> {
        self.engaged
    }

    /// Gap between the finger pads, metres.
    pub fn gap_m(&self) -> f64 {
        self.facts.gap_m
    }

    /// Is the hand free: nothing held and nothing to retreat from?
    pub fn is_hand_free(&self) -> bool {
        self.facts.held.is_none() && self.engaged.is_none()
    }

    /// Which of the robot's hands is at work: of this one the mode says what it holds, where it stands and how far it is open.
    /// 0, unless the robot has several ([`Manipulator::hands`](crate::manipulator::Manipulator::hands)).
    pub fn hand(&self) -> usize {
        usize::from(self.hand)
    }

    /// The same with another hand at work, if the one at work is free; else the same.
    #[must_use]
    pub fn with_hand(self, hand: usize) -> Self {
        let hand = if self.is_hand_free() { u16::try_from(hand).unwrap_or(u16::MAX) } else { self.hand };
        Self { hand, ..self }
    }

    /// What has been done on the way here of up to 64 things that somebody wants to be done on the way, one bit each: what a
    /// plan must contain is part of the state, so that a goal can ask for it. No transition forgets it.
    pub fn done(&self) -> u64 {
        self.done
    }

    /// Notes that these things have been done too.
    pub fn note_done(&mut self, done: u64) {
        self.done |= done;
    }

    /// The same with another opening of the empty hand. `None` while something is held.
    pub fn opened_to(&self, gap_m: f64) -> Option<Self> {
        if self.facts.held.is_some() {
            return None;
        }
        let mut mode = self.clone();
        // Not `==`, for which the zeros are one.
        if self.facts.gap_m.to_bits() != gap_m.to_bits() {
            mode.facts = Arc::new(Facts { gap_m, ..Facts::clone(&self.facts) });
        }
        Some(mode)
    }

    /// The hand has come beside `object`. `None` if it holds something or the object does not rest.
    pub fn engaged_with(&self, object: ObjectId) -> Option<Self> {
        (self.facts.held.is_none() && self.support_of(object).is_some())
            .then(|| Self { engaged: Some(object), ..self.clone() })
    }

    /// The hand has retreated. `None` if it was not beside anything.
    pub fn disengaged(&self) -> Option<Self> {
        self.engaged.is_some().then(|| Self { engaged: None, ..self.clone() })
    }

    /// The hand has closed on a resting object. `None` if it already holds something or the object does not rest.
    pub fn attached(&self, held: Held, gap_m: f64) -> Option<Self> {
        if self.facts.held.is_some() || self.support_of(held.object).is_none() {
            return None;
        }
        let mut facts = Facts { held: Some(Box::new(held)), gap_m, ..Facts::clone(&self.facts) };
        *facts.rests_on.get_mut(held.object.index())? = None;
        Some(Self { facts: Arc::new(facts), engaged: None, ..*self })
    }

    /// The held object stands on `surface` and the hand has opened to `gap_m` around it. `None` if nothing is held.
    pub fn released_on(&self, surface: SurfaceId, gap_m: f64) -> Option<Self> {
        let object = self.held()?.object;
        let mut facts = Facts { held: None, gap_m, ..Facts::clone(&self.facts) };
        *facts.rests_on.get_mut(object.index())? = Some(surface);
        Some(Self { facts: Arc::new(facts), engaged: Some(object), ..*self })
    }
}

/// What the fingers do to an object that they may touch: they move it, hold it, or leave it. A contact of any other name is one
/// of these, for there is nothing else that a law could ask of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchReason {
    /// The fingers push it.
    Push,
    /// The fingers close on it, or open from it.
    Grasp,
    /// The fingers slide off it.
    Retreat,
}

/// What an instance may touch besides what the mode itself allows (a resting object touches its support, a held one
/// the fingers).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Contacts {
    /// The object that the fingers may touch.
    pub fingers: Option<(ObjectId, TouchReason)>,
    /// The object that may touch the bodies under a surface.
    pub support: Option<(ObjectId, SurfaceId)>,
}
