//! What rests on what, what is held, and how the hand stands to the objects: the mode of a state.

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
}

/// The mode. Legal transitions are the methods; each returns `None` when it is not legal from here.
///
/// | from | transition | to |
/// |---|---|---|
/// | resting, hand free | [`Mode::engaged_with`] | resting, hand beside it |
/// | resting, hand beside it | [`Mode::disengaged`] | resting, hand free |
/// | resting, nothing held | [`Mode::attached`] | held |
/// | held | [`Mode::released_on`] | resting, hand beside it |
#[derive(Debug, Clone, PartialEq)]
pub struct Mode {
    rests_on: SmallVec<[Option<SurfaceId>; 8]>,
    held: Option<Held>,
    /// The object beside, around or under which the hand stands: it must retreat in a straight line before it may do
    /// anything else.
    engaged: Option<ObjectId>,
    gap_m: f64,
}

impl Mode {
    /// Every object rests on the given surface, the hand is free and open by `gap_m`.
    pub fn resting(rests_on: impl IntoIterator<Item = SurfaceId>, gap_m: f64) -> Self {
        Self { rests_on: rests_on.into_iter().map(Some).collect(), held: None, engaged: None, gap_m }
    }

    /// The surface that `object` rests on; `None` while it is held.
    pub fn support_of(&self, object: ObjectId) -> Option<SurfaceId> {
        self.rests_on.get(object.index()).copied().flatten()
    }

    /// What the hand holds.
    pub fn held(&self) -> Option<&Held> {
        self.held.as_ref()
    }

    /// The object that the hand must first retreat from.
    pub fn engaged(&self) -> Option<ObjectId> {
        self.engaged
    }

    /// Gap between the finger pads, metres.
    pub fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// Is the hand free: nothing held and nothing to retreat from?
    pub fn is_hand_free(&self) -> bool {
        self.held.is_none() && self.engaged.is_none()
    }

    /// The same with another opening of the empty hand. `None` while something is held.
    pub fn opened_to(&self, gap_m: f64) -> Option<Self> {
        self.held.is_none().then(|| Self { gap_m, ..self.clone() })
    }

    /// The hand has come beside `object`. `None` if it holds something or the object does not rest.
    pub fn engaged_with(&self, object: ObjectId) -> Option<Self> {
        (self.held.is_none() && self.support_of(object).is_some())
            .then(|| Self { engaged: Some(object), ..self.clone() })
    }

    /// The hand has retreated. `None` if it was not beside anything.
    pub fn disengaged(&self) -> Option<Self> {
        self.engaged.is_some().then(|| Self { engaged: None, ..self.clone() })
    }

    /// The hand has closed on a resting object. `None` if it already holds something or the object does not rest.
    pub fn attached(&self, held: Held, gap_m: f64) -> Option<Self> {
        if self.held.is_some() || self.support_of(held.object).is_none() {
            return None;
        }
        let mut mode = Self { held: Some(held), engaged: None, gap_m, ..self.clone() };
        *mode.rests_on.get_mut(held.object.index())? = None;
        Some(mode)
    }

    /// The held object stands on `surface` and the hand has opened to `gap_m` around it. `None` if nothing is held.
    pub fn released_on(&self, surface: SurfaceId, gap_m: f64) -> Option<Self> {
        let object = self.held?.object;
        let mut mode = Self { held: None, engaged: Some(object), gap_m, ..self.clone() };
        *mode.rests_on.get_mut(object.index())? = Some(surface);
        Some(mode)
    }
}

/// Why two bodies may touch during an instance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TouchReason {
    /// The fingers push it.
    Push,
    /// The fingers close on it, or open from it.
    Grasp,
    /// The fingers slide off it.
    Retreat,
    /// It is lifted from, or set down on, the surface.
    Support,
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
