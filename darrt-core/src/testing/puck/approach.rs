//! The way to a point on a puck's rim, around that puck: shared by Push and Pick.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use super::plane;
use super::transit::drive;
use super::world::{Point, PuckWorld};
use crate::motion::Instance;
use crate::state::{ObjectId, State};

/// Radius of the ring on which the robot goes around, in touch distances. Chords of an eighth of the ring
/// come as near as `cos(pi / 8) = 0.924` of it, which keeps the robot off the puck.
const RING: f64 = 1.15;

/// The robot to `contact` on the rim of `puck`, straight if the puck is not in the way, else around it.
/// Other pucks and obstacles are not looked at: that is the planner's business.
pub fn approach(
    m: &PuckWorld,
    from: &State<PuckWorld>,
    puck: ObjectId,
    contact: Point,
) -> Option<(Instance<PuckWorld>, State<PuckWorld>)> {
    let centre = from.object(puck)?;
    let via = detour(centre, m.touch_distance(puck), &from.robot, &contact);
    drive(m, from, &via, contact, Some(puck))
}

/// Points through which a point robot gets from `from` to `to` outside the circle of `radius`, on which or
/// outside of which both lie.
fn detour(centre: &Point, radius: f64, from: &Point, to: &Point) -> Vec<Point> {
    if is_clear(centre, radius, from, to) {
        return Vec::new();
    }
    let angle = |p: &Point| (p[1] - centre[1]).atan2(p[0] - centre[0]);
    let (start, end) = (angle(from), angle(to));
    let turn = (end - start + PI).rem_euclid(TAU) - PI;
    let corners = (turn.abs() / FRAC_PI_4).ceil().clamp(1.0, 8.0);
    let mut via = Vec::new();
    // Backwards from the contact, until the rest of the way is free.
    let mut i = corners;
    while i >= 0.0 {
        let theta = start + turn * i / corners;
        let corner = plane::along(centre, &[theta.cos(), theta.sin()], RING * radius);
        via.push(corner);
        if is_clear(centre, radius, from, &corner) {
            break;
        }
        i -= 1.0;
    }
    via.reverse();
    via
}

/// Does the segment stay outside the circle, but for the places where its ends touch it?
fn is_clear(centre: &Point, radius: f64, a: &Point, b: &Point) -> bool {
    let Some(direction) = plane::direction(a, b) else { return true };
    let to_centre = plane::subtract(centre, a);
    let s = (to_centre[0] * direction[0] + to_centre[1] * direction[1]).clamp(0.0, plane::distance(a, b));
    plane::distance(&plane::along(a, &direction, s), centre) >= radius - 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    const CENTRE: Point = [1.0, 2.0];

    #[test]
    fn straight_where_the_puck_is_not_in_the_way() {
        assert_eq!(detour(&CENTRE, 0.5, &[-1.0, 2.0], &[0.5, 2.0]), Vec::<Point>::new());
        assert_eq!(detour(&CENTRE, 0.5, &[0.5, 2.0], &[0.5, 2.0]), Vec::<Point>::new());
    }

    #[test]
    fn around_from_every_side_and_distance_to_every_side() {
        for i in 0..24_u8 {
            for j in 0..24_u8 {
                for from_m in [0.5, 0.55, 3.0] {
                    let at = |k: u8, r: f64| {
                        let theta = f64::from(k) * TAU / 24.0;
                        plane::along(&CENTRE, &[theta.cos(), theta.sin()], r)
                    };
                    let (from, to) = (at(i, from_m), at(j, 0.5));
                    let mut way = vec![from];
                    way.extend(detour(&CENTRE, 0.5, &from, &to));
                    way.push(to);
                    assert!(way.windows(2).all(|segment| is_clear(&CENTRE, 0.5, &segment[0], &segment[1])), "{way:?}");
                }
            }
        }
    }
}
