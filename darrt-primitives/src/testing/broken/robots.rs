//! Broken robots: what they are made of, where their links are, how far they travel.

use std::sync::atomic::{AtomicU32, Ordering};

use darrt_core::laws::Broken;
use darrt_geom::body::Body;
use darrt_geom::shape::Shape;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};

use super::{Case, unusable};
use crate::laws::manipulator::{
    ARM_MOVES, BASE_FRAME, BASE_LINKS, COUNTS, FINGERS_FOLLOW, GAP, GAP_METRES, HAND, HAND_FOLLOWS, LIMITS, LINKS,
    PURE, RIGID, SELF_PAIRS, TIPS, TRAVEL, TRAVEL_HELD, TRAVEL_LINKS, TRAVEL_MEASURE, WEIGHTS,
};
use crate::laws::{ManipulatorClaims, check_manipulator};
use crate::testing::gantry::{Configuration, Gantry, link_travel, motion, poses};

/// Two ordinary configurations.
const A: Configuration = Configuration { base: [0.3, -0.4, 0.5], arm: [0.1, 0.2, 1.0, 0.05, 3.0, 1.4, 0.3] };
const B: Configuration = Configuration { base: [-0.5, 0.6, -2.0], arm: [-0.6, 0.8, 0.7, 0.4, -2.9, 0.7, -1.1] };

/// All laws of the gantry with this change.
pub(super) fn robot(change: fn(&mut Gantry)) -> Result<(), Broken> {
    robot_that(change, &ManipulatorClaims::default())
}

/// The same, with claims.
pub(super) fn robot_that(change: fn(&mut Gantry), claims: &ManipulatorClaims) -> Result<(), Broken> {
    let mut robot = Gantry::new().map_err(unusable)?;
    change(&mut robot);
    // The two, and any two more: laws at random places must hold there as well.
    let seed = darrt_core::testing::broken::seed();
    check_manipulator(&robot, [&A, &B], [0.02, 0.08], seed, claims)
}

/// A case about a robot.
pub(super) fn case(
    name: &'static str,
    wrong: &'static str,
    law: &'static str,
    broken: fn() -> Result<(), Broken>,
) -> Case {
    Case { name, wrong, law, broken, honest: || robot(|_| {}) }
}

pub(super) fn cases() -> Vec<Case> {
    [descriptions(), links(), travels()].concat()
}

fn descriptions() -> Vec<Case> {
    vec![
        case("one weight short", "a joint was added, but not its weight", COUNTS, || {
            robot(|robot| {
                robot.weights_m.pop();
            })
        }),
        case("weight of nothing", "a joint whose travel counts nothing: all its values are one", COUNTS, || {
            robot(|robot| robot.weights_m[6] = 0.0)
        }),
        case("half a limit", "an upper limit that was never read from the file", LIMITS, || {
            robot(|robot| robot.limits[2].upper = f64::INFINITY)
        }),
        case("swapped limits", "the limits of the mirrored arm, in the wrong order", LIMITS, || {
            robot(|robot| {
                let [lower, upper] = [robot.limits[5].lower, robot.limits[5].upper];
                robot.limits[5].lower = upper;
                robot.limits[5].upper = lower;
            })
        }),
        case("weights in centimetres", "a table of another unit", WEIGHTS, || {
            robot(|robot| robot.weights_m.iter_mut().for_each(|weight| *weight *= 100.0))
        }),
        case("long fingers", "the tips are told of fingers that were exchanged for others", TIPS, || {
            robot(|robot| {
                for link in &mut robot.links[3..] {
                    let half = Vector3::new(0.2, 0.01, 0.01);
                    let longer = Shape::cuboid(half).and_then(|shape| Body::single(&*link.body.name, shape));
                    link.body = longer.unwrap_or_else(|_| link.body.clone());
                }
            })
        }),
        case("the pair that was forgotten", "the fingers can reach the wagon, and nobody says so", SELF_PAIRS, || {
            let mut robot = Gantry::new().map_err(unusable)?;
            robot.self_pairs.retain(|pair| *pair != (0, 3));
            // The left finger in the wagon, and well above it.
            let low = Configuration { arm: [0.0, 0.0, 0.12, 0.0, 0.1, 0.2, 0.3], ..A };
            let seed = darrt_core::testing::broken::seed();
            check_manipulator(&robot, [&low, &B], [0.02, 0.08], seed, &ManipulatorClaims::default())
        }),
        case("pairs counted from one", "self pairs by another numbering than the links", LINKS, || {
            robot(|robot| robot.self_pairs = vec![(1, 3), (1, 4), (1, 5)])
        }),
        case("two fingers of one name", "nobody can tell which of them touched", LINKS, || {
            robot(|robot| robot.links[4].body.name = robot.links[3].body.name.clone())
        }),
        case("gripper that never opens", "the widest gap is left at its default", HAND, || {
            robot(|robot| robot.hand.max_gap_m = 0.0)
        }),
    ]
}

fn links() -> Vec<Case> {
    static CALLS: AtomicU32 = AtomicU32::new(0);
    vec![
        case("unnormalised quaternion", "a quaternion is scaled after it was normalised", RIGID, || {
            robot(|robot| {
                robot.forward = |q| {
                    let pose = motion::forward(q);
                    let scaled = UnitQuaternion::new_unchecked(Quaternion::from(pose.rotation.coords * 1.001));
                    Isometry3::from_parts(pose.translation, scaled)
                };
            })
        }),
        case(
            "left-handed quaternion",
            "the rotation is read in the other convention: it is inverted",
            BASE_FRAME,
            || {
                robot(|robot| {
                    robot.forward = |q| {
                        let pose = motion::forward(q);
                        Isometry3::from_parts(pose.translation, pose.rotation.inverse())
                    };
                })
            },
        ),
        case(
            "links stay behind",
            "the links are posed in the base's frame, the tool in the world's",
            BASE_FRAME,
            || robot(|robot| robot.poses = |q, gap_m| poses(&Configuration { base: [0.0; 3], ..*q }, gap_m)),
        ),
        case("shaking wagon", "the base's box hangs on the first slide", BASE_LINKS, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[0] *= Translation3::new(q.arm[0], 0.0, 0.0);
                    all
                };
            })
        }),
        case(
            "finger that does not follow",
            "the fingers are posed before the last joint turns",
            FINGERS_FOLLOW,
            || {
                robot(|robot| {
                    robot.poses = |q, gap_m| {
                        let mut all = poses(q, gap_m);
                        let mut unturned = *q;
                        unturned.arm[6] = 0.0;
                        all[4] = poses(&unturned, gap_m)[4];
                        all
                    };
                })
            },
        ),
        case("palm on the wrist", "the palm is posed with the joint before the last one", HAND_FOLLOWS, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    let mut unturned = *q;
                    unturned.arm[6] = 0.0;
                    all[2] = poses(&unturned, gap_m)[2];
                    all
                };
            })
        }),
        case("wrist that stays", "the link is posed from the joints of the start", ARM_MOVES, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[1] = poses(&Configuration { arm: A.arm, ..*q }, gap_m)[1];
                    all
                };
            })
        }),
        case("fingers at rest", "the gap is not handed on to the links", GAP_METRES, || {
            robot(|robot| robot.poses = |q, _| poses(q, 0.02))
        }),
        case("gap in millimetres", "the driver of the gripper speaks millimetres", GAP_METRES, || {
            robot(|robot| robot.poses = |q, gap_m| poses(q, gap_m / 1000.0))
        }),
        case("opens the palm", "the gap is added to the palm as well", GAP, || {
            robot(|robot| {
                robot.poses = |q, gap_m| {
                    let mut all = poses(q, gap_m);
                    all[2] *= Translation3::new(0.0, gap_m, 0.0);
                    all
                };
            })
        }),
        case("hidden state between calls", "forward kinematics filters its own last answer", PURE, || {
            robot(|robot| {
                robot.forward = |q| {
                    let noise = f64::from(CALLS.fetch_add(1, Ordering::Relaxed) % 7) * 1e-13;
                    Translation3::from(Vector3::x() * noise) * motion::forward(q)
                };
            })
        }),
    ]
}

fn travels() -> Vec<Case> {
    vec![
        case("signed travel", "differences are added without their absolute values", TRAVEL_MEASURE, || {
            robot(|robot| robot.travel = |a, b, _| b.arm.iter().zip(&a.arm).map(|(q, p)| q - p).sum())
        }),
        case("travel of the larger is less", "the held reach is subtracted from the radius", TRAVEL_MEASURE, || {
            robot(|robot| robot.travel = |a, b, held_m| motion::travel(a, b, 0.5 - held_m))
        }),
        case("travel bound too small", "only the tool frame is bounded, not what sticks out beyond it", TRAVEL, || {
            robot(|robot| {
                robot.travel = |a, b, held_m| motion::travel(a, b, held_m) - 0.25 * (b.arm[6] - a.arm[6]).abs();
            })
        }),
        case("turns on the spot", "the base's turn moves only the base, not the arm that it carries", TRAVEL, || {
            robot(|robot| {
                robot.travel = |a, b, held_m| {
                    let level = Configuration { base: [b.base[0], b.base[1], a.base[2]], ..*b };
                    motion::travel(a, &level, held_m) + (b.base[2] - a.base[2]).abs() * 0.2
                };
            })
        }),
        case("parked arm", "the base's drive is forgotten for the links that no joint moves", TRAVEL_LINKS, || {
            robot(|robot| {
                robot.link_travel = |a, b, held_m, out| {
                    let bound = link_travel(a, b, held_m, out);
                    out.iter_mut().take(1).for_each(|of_base| *of_base = 0.0);
                    bound
                };
            })
        }),
        case(
            "forgets the held object",
            "travel of the robot alone: what it holds sticks out farther",
            TRAVEL_HELD,
            || robot(|robot| robot.travel = |a, b, _| motion::travel(a, b, 0.0)),
        ),
    ]
}
