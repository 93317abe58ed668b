//! Is the end of a propagation nearer to the target in something that the primitive moves?

use crate::domain::Domain;
use crate::laws::Broken;
use crate::motion::Instance;
use crate::partial::PartialState;
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, State};

use super::PROGRESS;

/// One named component that moves, and how far it is from its target before and after.
struct Gap {
    component: ComponentId,
    before: f64,
    after: f64,
    /// Not farther than this it is at the target.
    tolerance: f64,
}

/// What ends as near as this to its target without being there, and has come from so much farther away, has missed it, metres.
const MISS_M: f64 = 1e-5;
const MISS_SHARE: f64 = 1e-4;

/// If named objects move, each of them must end nearer to its target, by `least_m` or up to it. Otherwise the robot must, or an
/// object must have been approached or manipulated to another mode: a grasp moves nothing, and yet the
/// object can be carried afterwards.
pub(super) fn progress<D: Domain>(
    m: &D,
    from: &State<D>,
    to: &PartialState<D>,
    end: &State<D>,
    (instances, least_m): (&[Instance<D>], f64),
) -> Result<(), Broken> {
    let moved = instances.iter().fold(ComponentSet::EMPTY, |set, instance| set.union(instance.moves));
    let gaps = gaps(m, from, to, end, moved);
    let is_nearer = |gap: &Gap| gap.after <= (gap.before - least_m).max(gap.tolerance) && gap.after < gap.before;
    // What was at its target, and what stays where it is, is no progress and no harm.
    let moves = |gap: &&Gap| gap.component != ComponentId::Robot && gap.before > gap.tolerance;
    let mut objects = gaps.iter().filter(moves).peekable();
    let holds = if objects.peek().is_some() {
        objects.all(is_nearer)
    } else {
        let prepares = from.mode != end.mode && instances.iter().any(|instance| instance.object.is_some());
        prepares || gaps.iter().any(is_nearer)
    };
    // Nobody comes so near to a target by chance: it is missed by rounding, or by another one that is nearly the same.
    let misses = |gap: &Gap| gap.after > gap.tolerance && gap.after <= MISS_M.min(MISS_SHARE * gap.before);
    let is_missed = gaps.iter().any(misses);
    if holds && !is_missed {
        return Ok(());
    }
    let text = |metres: fn(&Gap) -> f64| {
        let parts: Vec<_> =
            gaps.iter().map(|gap| format!("{} {:?} m", m.component_name(gap.component), metres(gap))).collect();
        if parts.is_empty() { "no named component moves".to_owned() } else { parts.join(", ") }
    };
    Err(Broken::new(
        PROGRESS,
        format!("to the target after: {}", text(|gap| gap.after)),
        format!("{}before: {}", if is_missed { "at it, not beside it; " } else { "" }, text(|gap| gap.before)),
    ))
}

fn gaps<D: Domain>(m: &D, from: &State<D>, to: &PartialState<D>, end: &State<D>, moved: ComponentSet) -> Vec<Gap> {
    let mut gaps = Vec::new();
    if moved.contains(ComponentId::Robot) && to.robot().is_some() {
        let gap = |s: &State<D>| m.robot().distance(&s.robot, &to.robot_overlay(m, &s.robot));
        let tolerance = m.robot().tolerance();
        gaps.push(Gap { component: ComponentId::Robot, before: gap(from), after: gap(end), tolerance });
    }
    for (id, target) in to.objects() {
        let component = ComponentId::Object(id);
        if moved.contains(component)
            && let (Some(space), Some(p), Some(q)) = (m.objects().get(id.index()), from.object(id), end.object(id))
        {
            let (before, after) = (space.distance(p, target), space.distance(q, target));
            gaps.push(Gap { component, before, after, tolerance: space.tolerance() });
        }
    }
    gaps
}
