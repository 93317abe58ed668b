//! What a step may do: which object it acts on, what is in the hand, which contacts it may need.

use darrt_primitives::contract::{Contract, HandUse};
use nalgebra::Isometry3;

use super::hands::Hands;
use super::margins::MarginKind;
use super::motion::sound;
use super::refusal::{Refusal, RefusalKind, Site};
use super::robot::Robot;
use super::stage::{PairKind, Rule};
use super::world::World;
use crate::plan_file::{AllowedContact, ContactReason, Pose, Step};

/// How an object is supported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mode {
    /// It stands on the surface with this index.
    Resting { surface: usize },
    /// It is in one of the hands, counted from 0.
    Held { hand: usize, tool_from_object: Pose },
}

/// An object in the hand during a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct Holding {
    pub(super) object: usize,
    pub(super) tool_from_object: Isometry3<f64>,
}

/// What a step does, once its claims have been checked.
#[derive(Debug)]
pub(super) struct Act {
    pub(super) object: Option<usize>,
    pub(super) holding: Option<Holding>,
    pub(super) pushed: Option<usize>,
}

impl Act {
    /// Checks what the step of the hand of `robot` claims against how the objects are supported before it.
    pub(super) fn new(
        site: Site<'_>,
        step: &Step,
        (hands, robot): (&Hands, &Robot),
        world: &World<'_>,
        modes: &[Mode],
    ) -> Result<Self, Refusal> {
        let refuse = |message: String| site.refusal(0.0, RefusalKind::Mode, message);
        let index = |name: &str| world.object(name).ok_or_else(|| refuse(format!("there is no object `{name}`")));
        let object = step.object.as_deref().map(index).transpose()?;
        let pushed = step.pushes.as_deref().map(index).transpose()?;
        let held_by = (0..).zip(modes).find_map(|(i, mode)| match mode {
            Mode::Held { hand, tool_from_object } => Some((i, *hand, *tool_from_object)),
            Mode::Resting { .. } => None,
        });
        if let Some((i, hand, _)) = held_by
            && hand != robot.which
        {
            let (name, holder, tool) = (world.object_name(i), hands.get(hand).tool_name(), robot.tool_name());
            return Err(refuse(format!(
                "the hand of `{holder}` holds `{name}`, but the step is one of the hand of `{tool}`: while something is held, no \
                 other hand is at work"
            )));
        }
        let in_hand = held_by.map(|(i, _, tool_from_object)| (i, tool_from_object));
        let holds = match &step.holds {
            Some(hold) => Some((index(&hold.object)?, hold.tool_from_object)),
            None => None,
        };
        let named = || object.ok_or_else(|| refuse("the step must name its object".to_owned()));
        let called = |i: usize| world.object_name(i);
        let (hand, contract) = (site.contract.hand, site.contract);
        if let Some((i, _)) = in_hand
            && !contract.begins_holding()
        {
            return Err(refuse(format!("the hand holds `{}`; {} needs an empty hand", called(i), site.primitive)));
        }
        match hand {
            HandUse::Takes => {
                let object = named()?;
                if holds.is_none_or(|(held, _)| held != object) {
                    return Err(refuse(format!("picks `{}` and so must hold it", called(object))));
                }
            }
            HandUse::Carries | HandUse::LetsGo => {
                let (held, grasp) = in_hand.ok_or_else(|| refuse("the hand holds nothing".to_owned()))?;
                let (claimed, claimed_grasp) =
                    holds.ok_or_else(|| refuse(format!("the hand holds `{}`, but `holds` is null", called(held))))?;
                if claimed != held || object.is_some_and(|o| o != held) {
                    return Err(refuse(format!("the hand holds `{}`, not what the step says", called(held))));
                }
                if claimed_grasp != grasp {
                    let text = format!("`tool_from_object` of `{}` differs from when it was picked", called(held));
                    return Err(site.refusal(0.0, RefusalKind::Grasp, text));
                }
            }
            HandUse::Empty if holds.is_some() => {
                return Err(refuse("claims to hold something, but nothing was picked".to_owned()));
            }
            HandUse::Empty => {}
        }
        if contract.slides() {
            let object = named()?;
            if pushed != Some(object) {
                return Err(refuse(format!("pushes `{}` and must say so", called(object))));
            }
        } else if pushed.is_some() {
            return Err(refuse(format!("{} pushes nothing", site.primitive)));
        }
        let holding = match holds {
            Some((object, pose)) => {
                let tool_from_object =
                    sound(called(object), pose).map_err(|flaw| site.refusal(0.0, RefusalKind::Malformed, flaw))?;
                Some(Holding { object, tool_from_object })
            }
            None => None,
        };
        Ok(Self { object, holding, pushed })
    }
}

/// Which contacts a step allows.
#[derive(Debug, Default)]
pub(super) struct Permits {
    /// Link and object.
    fingers: Vec<(usize, usize)>,
    /// Object and fixed body.
    support: Vec<(usize, usize)>,
    /// The object at which the hand is at work, and the surfaces on which that may stand.
    work: Option<(usize, Vec<usize>)>,
}

impl Permits {
    /// Refuses contacts that no such step may need.
    pub(super) fn new(
        site: Site<'_>,
        step: &Step,
        act: &Act,
        robot: &Robot,
        world: &World<'_>,
        modes: &[Mode],
    ) -> Result<Self, Refusal> {
        let mut permits = Self { work: work(site.contract, act, world, modes), ..Self::default() };
        for contact in &step.allowed_contacts {
            let (a, b) = (contact.a.as_str(), contact.b.as_str());
            let found = permits.admit(site, contact, (a, b), act, robot, world, modes)
                || permits.admit(site, contact, (b, a), act, robot, world, modes);
            if !found {
                let text = format!(
                    "allows {a} to touch {b}; only a finger of the manipulating hand may touch the step's object, and in \
                     Pick and Place the object what carries it"
                );
                return Err(site.refusal(0.0, RefusalKind::AllowedContact, text).about(a, b));
            }
        }
        Ok(permits)
    }

    #[expect(clippy::too_many_arguments, reason = "one contact against all that it may refer to")]
    fn admit(
        &mut self,
        site: Site<'_>,
        contact: &AllowedContact,
        (a, b): (&str, &str),
        act: &Act,
        robot: &Robot,
        world: &World<'_>,
        modes: &[Mode],
    ) -> bool {
        let actor = act.holding.map(|holding| holding.object).or(act.object);
        if contact.reason != ContactReason::Support {
            let (Some(link), Some(object)) = (robot.tree.link_index(a), world.object(b)) else { return false };
            let is_fit = robot.is_finger(a) && actor == Some(object) && site.contract.fingers_touch;
            if is_fit {
                self.fingers.push((link, object));
            }
            return is_fit;
        }
        let fixed = world.fixed.iter().position(|(solid, _)| solid.name() == b);
        let (Some(object), Some(fixed), Some(holding)) = (world.object(a), fixed, act.holding) else { return false };
        let surfaces: Vec<usize> = match (site.contract.hand, modes.get(object)) {
            (HandUse::Takes, Some(Mode::Resting { surface })) => vec![*surface],
            (HandUse::LetsGo, _) => world.movables.get(object).map(|m| m.surfaces.clone()).unwrap_or_default(),
            _ => return false,
        };
        let is_fit =
            holding.object == object && surfaces.into_iter().any(|surface| world.carries(object, surface, fixed));
        if is_fit {
            self.support.push((object, fixed));
        }
        is_fit
    }

    /// How a pair is treated in a step.
    pub(super) fn rule(&self, pair: PairKind, act: &Act, robot: &Robot, world: &World<'_>, modes: &[Mode]) -> Rule {
        let is_held = |object| act.holding.is_some_and(|holding| holding.object == object);
        let is_handled = |object| self.work.as_ref().is_some_and(|(own, _)| *own == object);
        let is_under = |fixed| {
            self.work.as_ref().is_some_and(|(own, surfaces)| surfaces.iter().any(|s| world.carries(*own, *s, fixed)))
        };
        let is_hand = |link| robot.hand.binary_search(&link).is_ok();
        let of_object = |object| if is_held(object) { MarginKind::Held } else { MarginKind::Object };
        let kind = match pair {
            PairKind::LinkObject { link, object } if self.fingers.contains(&(link, object)) => return Rule::Free,
            PairKind::LinkObject { link, object } if is_hand(link) && (is_handled(object) || is_held(object)) => {
                MarginKind::Near
            }
            PairKind::LinkFixed { link, fixed } if is_hand(link) && is_under(fixed) => MarginKind::Near,
            PairKind::LinkObject { .. } | PairKind::LinkFixed { .. } => MarginKind::Robot,
            PairKind::ObjectFixed { object, fixed } => {
                let stands = match modes.get(object) {
                    Some(Mode::Resting { surface }) if !is_held(object) => world.carries(object, *surface, fixed),
                    _ => self.support.contains(&(object, fixed)),
                };
                if stands {
                    return Rule::Standing;
                }
                if is_handled(object) && is_under(fixed) { MarginKind::Near } else { of_object(object) }
            }
            PairKind::Objects(a, b) => {
                if is_held(a) {
                    MarginKind::Held
                } else {
                    of_object(b)
                }
            }
            PairKind::Links => MarginKind::Itself,
        };
        Rule::Apart(kind)
    }
}

/// The object at which the hand is at work in such a step, and the surfaces on which it stands, or may be set down.
fn work(contract: Contract, act: &Act, world: &World<'_>, modes: &[Mode]) -> Option<(usize, Vec<usize>)> {
    if contract.is_free() {
        return None;
    }
    let object = act.holding.map(|holding| holding.object).or(act.object)?;
    let surfaces = match modes.get(object)? {
        Mode::Resting { surface } => vec![*surface],
        Mode::Held { .. } => world.movables.get(object)?.surfaces.clone(),
    };
    Some((object, surfaces))
}
