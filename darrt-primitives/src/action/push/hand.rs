//! Where a hand stands to push, and how it comes there: gap, lean, heights, and the room behind and above the contact.

use darrt_core::primitive::Infeasible;
use darrt_core::state::ObjectId;
use darrt_geom::support::SupportSurface;
use nalgebra::{Isometry3, Point2, Unit, Vector2, Vector3};

use crate::action::line::{moved, room_for_hand};
use crate::action::slide::{SlidingHand, contacts};
use crate::action::stance::Probe;
use crate::contact::{Fingertips, HandStance, PushHeights, RimContact};
use crate::hand_ties::HandTies;
use crate::length_range::LengthRange;
use crate::manipulator::{JointVector as _, Manipulator};
use crate::mode::{Contacts, SurfaceId};
use crate::primitive;
use crate::push::Friction;
use crate::push::steady::{SlidingDisc, SteadyPush};
use crate::tabletop::{Movable, Tabletop, TabletopState};

/// Just before the contact the hand, which need not touch the object with anything but its fingertips, is this much farther
/// from it than the contact margin, metres.
const BEFORE_CONTACT_M: f64 = 1e-3;
/// The fingertips push no lower than at this part of an object's height. So the palm above them clears plates that are 30 mm
/// high instead of 23, and the tips keep more room above the table.
const TIPS_AT: f64 = 1.0 / 3.0;
/// Most that fingertips which lean over the edge of an object may press it down, as a part of their push times friction:
/// at 1 the object jams.
const MOST_JAMMING: f64 = 0.5;

/// A round object that rests where it may be pushed, and two fingers that fit it.
pub(in crate::action) struct Pushable<'a> {
    pub(in crate::action) object: ObjectId,
    pub(in crate::action) on: SurfaceId,
    pub(in crate::action) surface: &'a SupportSurface,
    pub(super) pose: &'a Isometry3<f64>,
    pub(super) gap_m: f64,
    pub(super) contact: RimContact,
    disc: SlidingDisc,
    heights: PushHeights,
    /// Lowest that the fingertips may be, metres above the surface.
    least_tips_m: f64,
    ties: HandTies,
}

impl<'a> Pushable<'a> {
    /// The object as it rests in `from`.
    ///
    /// # Errors
    /// [`Infeasible::NoContact`] for what cannot be pushed, [`Infeasible::OffSupport`] for what does not rest.
    pub(in crate::action) fn new<M: Manipulator>(
        m: &'a Tabletop<M>,
        from: &'a TabletopState<M>,
        object: ObjectId,
    ) -> Result<Self, Infeasible> {
        let settings = &m.settings().push;
        let movable = m.movable(object).filter(|o| o.is_pushable).ok_or(Infeasible::NoContact)?;
        let disc = disc(movable).ok_or(Infeasible::NoContact)?;
        let on = from.mode.support_of(object).ok_or(Infeasible::OffSupport)?;
        let surface = m.surface(on).ok_or(Infeasible::OffSupport)?;
        let pose = from.object(object).ok_or(Infeasible::NoContact)?;
        let at_work = from.robot.arm.hand_at_work();
        let hand = m.manipulator().hand_of(at_work);
        let gap_m = disc.finger_gap_m(settings.gap_m.min(hand.max_gap_m()));
        let tips = Fingertips { beyond_tool: hand.tip_beyond_tool_m(gap_m), half_width: hand.tip_half_width_m() };
        let contact = RimContact::new(disc.radius_m, gap_m, tips).map_err(|_| Infeasible::NoContact)?;
        let top = 2.0 * movable.half_height_m;
        let least_tips_m = settings.fingertip_clearance_m;
        let heights = PushHeights { tips: least_tips_m.max(TIPS_AT * top), top };
        let ties = m.manipulator().hand_ties_of(at_work);
        let pushable = Self { object, on, surface, pose, gap_m, contact, disc, heights, least_tips_m, ties };
        let is_beside = |stance: &HandStance| pushable.heights_of(stance).is_some();
        // The fingertips would pass above it.
        if pushable.stances(m, false).any(|stance| is_beside(&stance)) {
            Ok(pushable)
        } else {
            Err(Infeasible::NoContact)
        }
    }

    /// How the hand may stand, in the order in which it is tried; `twin` is for those that may stand either way round.
    pub(in crate::action) fn stances<M: Manipulator>(
        &self,
        m: &'a Tabletop<M>,
        twin: bool,
    ) -> impl Iterator<Item = HandStance> + use<'a, M> {
        let tied = self.ties.pushing(twin);
        let leans = if tied.is_some() { &[][..] } else { &m.settings().push.leans_rad };
        leans.iter().map(move |lean| HandStance { twin, lean: *lean }).chain(tied.flatten())
    }

    /// At which heights a hand in this stance pushes; `None` where it would meet the surface or pass above the object.
    fn heights_of(&self, stance: &HandStance) -> Option<PushHeights> {
        let PushHeights { mut tips, top } = self.heights;
        if let Some(tied_m) = self.ties.height_m {
            let at_surface = PushHeights { tips: 0.0, top };
            tips = tied_m - self.surface.height() - self.contact.tool_height(&at_surface, stance);
        }
        (tips >= self.least_tips_m && tips < top).then_some(PushHeights { tips, top })
    }

    /// What the push needs, if it holds.
    ///
    /// # Errors
    /// [`Infeasible::UnstablePush`].
    pub(super) fn steady<M: Manipulator>(&self, m: &Tabletop<M>) -> Result<SteadyPush, Infeasible> {
        let (error_m, has_n) = (m.settings().push.position_error_m, m.manipulator().push_force_n());
        self.disc.steady_push(self.gap_m, error_m, has_n).map_err(|_| Infeasible::UnstablePush)
    }

    /// How far inside an edge it may stop that a push goes to, least and most, metres.
    pub(in crate::action) fn edge_distances_m<M: Manipulator>(m: &Tabletop<M>) -> [f64; 2] {
        let settings = m.settings();
        settings.push.edge_distance_m.map(|distance| distance.max(settings.safety.edge_margin_m))
    }

    /// The largest curvature of its way at which it stays at the fingers, 1/m.
    pub(super) fn max_curvature(&self) -> f64 {
        self.disc.max_curvature(self.gap_m).unwrap_or(0.0)
    }

    /// Over which point of the floor its centre is.
    pub(in crate::action) fn center(&self) -> Point2<f64> {
        Point2::new(self.pose.translation.x, self.pose.translation.y)
    }

    /// How far behind the centre the tool stands to push in this stance, and how high, world z; metres. `None` where such a
    /// hand does not push, but passes above the object or presses it down.
    pub(in crate::action) fn tool_place(&self, stance: &HandStance) -> Option<(f64, f64)> {
        let heights = self.heights_of(stance)?;
        let jams = self.disc.table.coefficient() * self.contact.pressing_down(&heights, stance);
        let setback_m = self.contact.setback(&heights, stance).ok().filter(|_| jams <= MOST_JAMMING)?;
        Some((setback_m, self.surface.height() + self.contact.tool_height(&heights, stance)))
    }

    /// The hand behind the object to push it along `direction`.
    fn at_contact(&self, direction: &Unit<Vector2<f64>>, stance: &HandStance) -> Option<Isometry3<f64>> {
        self.tool_place(stance)?;
        let (height_m, heights) = (self.surface.height(), self.heights_of(stance)?);
        self.contact.world_from_tool(&self.center(), direction, height_m, &heights, stance).ok()
    }
}

/// A movable object as a disc that slides; `None` if it is not round or a number of it cannot be used.
fn disc(movable: &Movable) -> Option<SlidingDisc> {
    Some(SlidingDisc {
        radius_m: movable.round_radius_m?,
        mass_kg: movable.mass_kg,
        table: Friction::new(movable.friction.table).ok()?,
        fingers: Friction::new(movable.friction.fingers).ok()?,
    })
}

/// A hand behind an object with room around it.
pub(super) struct HandPlace {
    pub(super) at_contact: Isometry3<f64>,
    /// Unit vectors of the world: ahead along the push, and where the hand points.
    pub(super) ahead: Vector3<f64>,
    pub(super) pointing: Vector3<f64>,
    /// How far behind the contact it comes down, and how long it comes straight down before.
    pub(super) standoff_m: LengthRange,
    pub(super) approach_m: LengthRange,
}

impl HandPlace {
    /// The hand in this stance, as far as hand and object alone can tell; with this
    /// [care](darrt_core::validity::Validity::most_care) at least.
    ///
    /// # Errors
    /// [`Infeasible::NoContact`] where such a hand does not push, [`Infeasible::Blocked`].
    pub(super) fn new<M: Manipulator>(
        m: &Tabletop<M>,
        pushable: &Pushable<'_>,
        direction: &Unit<Vector2<f64>>,
        stance: &HandStance,
        care: usize,
        probe: &Probe<'_, M>,
    ) -> Result<Self, Infeasible> {
        let settings = m.settings();
        let at_contact = pushable.at_contact(direction, stance).ok_or(Infeasible::NoContact)?;
        let ahead = Vector3::new(direction.x, direction.y, 0.0);
        let pointing = at_contact.rotation * Vector3::x();
        probe.check_hand(&at_contact, &contacts(pushable.object)).map_err(Infeasible::Blocked)?;
        // Nothing but the fingertips is at the object: with all of the hand beside it, the hand is clear of it.
        let before_m = settings.safety.contact_margin_m + BEFORE_CONTACT_M;
        let none = Contacts::default();
        let why =
            |at: &Isometry3<f64>| probe.check_hand(at, &none).err().map_or(Infeasible::NoContact, Infeasible::Blocked);
        let before = moved(&at_contact, &-ahead, before_m);
        let is_clear = |at: &Isometry3<f64>, more: usize| probe.is_hand_clear(at, &none, more.max(care));
        if !is_clear(&before, 0) {
            return Err(why(&before));
        }
        let standoff_m =
            room_for_hand(m, settings.push.standoff_m, &at_contact, &-ahead, is_clear).map_err(|at| why(&at))?;
        let behind = moved(&at_contact, &-ahead, standoff_m.wanted_m());
        let approach_m =
            room_for_hand(m, settings.push.approach_m, &behind, &-pointing, is_clear).map_err(|at| why(&at))?;
        Ok(Self { at_contact, ahead, pointing, standoff_m, approach_m })
    }

    /// The hand as it goes to work on what it pushes.
    pub(super) fn hand(&self, pushable: &Pushable<'_>) -> SlidingHand {
        SlidingHand {
            primitive: primitive::PUSH,
            object: pushable.object,
            on: pushable.on,
            at_contact: self.at_contact,
            ahead: self.ahead,
            down: self.pointing,
            standoff_m: self.standoff_m,
            approach_m: self.approach_m,
            gap_m: pushable.gap_m,
        }
    }
}
