//! Arms without a closed form of ours, by their published dimensions: what a numeric inverse is tried on.
//!
//! Dimensions and limits are facts from the makers' data sheets and robot descriptions; links have no shapes.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::fmt::Write as _;

/// A joint: where its link stands in the link before, its axis there, and its limits (`None`: continuous).
struct Joint {
    xyz: [f64; 3],
    roll: f64,
    axis: [f64; 3],
    limit: Option<(f64, f64)>,
    slides: bool,
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// Name and robot description of every arm; each goes from the link [`BASE`] to the link [`TOOL`].
pub fn all() -> [(&'static str, String); 4] {
    [("Panda", panda()), ("UR5e", ur5e()), ("Fetch", fetch()), ("Fetch with torso", fetch_with_torso())]
}

/// The link that all of these arms start from.
pub const BASE: &str = "base";
/// The link that all of these arms end in.
pub const TOOL: &str = "tool";

/// Franka Emika Panda: seven joints; the tool lies between the fingertips.
pub fn panda() -> String {
    let limits = [
        (-2.8973, 2.8973),
        (-1.7628, 1.7628),
        (-2.8973, 2.8973),
        (-3.0718, -0.0698),
        (-2.8973, 2.8973),
        (-0.0175, 3.7525),
        (-2.8973, 2.8973),
    ];
    let places = [
        ([0.0, 0.0, 0.333], 0.0),
        ([0.0, 0.0, 0.0], -FRAC_PI_2),
        ([0.0, -0.316, 0.0], FRAC_PI_2),
        ([0.0825, 0.0, 0.0], FRAC_PI_2),
        ([-0.0825, 0.384, 0.0], -FRAC_PI_2),
        ([0.0, 0.0, 0.0], FRAC_PI_2),
        ([0.088, 0.0, 0.0], FRAC_PI_2),
    ];
    let joint = |((xyz, roll), limit)| Joint { xyz, roll, axis: Z, limit: Some(limit), slides: false };
    let joints: Vec<Joint> = places.into_iter().zip(limits).map(joint).collect();
    urdf("panda", &joints, [0.0, 0.0, 0.2104], [0.0, 0.0, -FRAC_PI_4])
}

/// The six-joint arm `UR5e` of Universal Robots, from its Denavit-Hartenberg table.
pub fn ur5e() -> String {
    let places = [
        ([0.0, 0.0, 0.0], 0.0),
        ([0.0, 0.0, 0.1625], FRAC_PI_2),
        ([-0.425, 0.0, 0.0], 0.0),
        ([-0.3922, 0.0, 0.0], 0.0),
        ([0.0, 0.0, 0.1333], FRAC_PI_2),
        ([0.0, 0.0, 0.0997], -FRAC_PI_2),
    ];
    let most = [2.0 * PI, 2.0 * PI, PI, 2.0 * PI, 2.0 * PI, 2.0 * PI];
    let joint = |((xyz, roll), most): (_, f64)| Joint { xyz, roll, axis: Z, limit: Some((-most, most)), slides: false };
    let joints: Vec<Joint> = places.into_iter().zip(most).map(joint).collect();
    urdf("ur5e", &joints, [0.0, 0.0, 0.0996], [0.0; 3])
}

/// Fetch: seven joints, three of them continuous.
pub fn fetch() -> String {
    urdf("fetch", &fetch_joints(), [0.166_45, 0.0, 0.0], [0.0; 3])
}

/// Fetch with its torso: a sliding joint before the seven.
pub fn fetch_with_torso() -> String {
    let torso =
        Joint { xyz: [-0.086_875, 0.0, 0.377_43], roll: 0.0, axis: Z, limit: Some((0.0, 0.386_15)), slides: true };
    let joints: Vec<Joint> = std::iter::once(torso).chain(fetch_joints()).collect();
    urdf("fetch_with_torso", &joints, [0.166_45, 0.0, 0.0], [0.0; 3])
}

fn fetch_joints() -> [Joint; 7] {
    let joint = |x, axis, limit| Joint { xyz: [x, 0.0, 0.0], roll: 0.0, axis, limit, slides: false };
    [
        Joint { xyz: [0.119_525, 0.0, 0.348_58], ..joint(0.0, Z, Some((-1.6056, 1.6056))) },
        Joint { xyz: [0.117, 0.0, 0.06], ..joint(0.0, Y, Some((-1.221, 1.518))) },
        joint(0.219, X, None),
        joint(0.133, Y, Some((-2.251, 2.251))),
        joint(0.197, X, None),
        joint(0.1245, Y, Some((-2.16, 2.16))),
        joint(0.1385, X, None),
    ]
}

/// A planar arm with three joints, 0.9 m long.
pub fn planar() -> String {
    let joint = |x, limit| Joint { xyz: [x, 0.0, 0.0], roll: 0.0, axis: Z, limit, slides: false };
    let joints = [joint(0.0, None), joint(0.4, Some((-2.5, 2.5))), joint(0.3, Some((-2.5, 2.5)))];
    urdf("planar", &joints, [0.2, 0.0, 0.0], [0.0; 3])
}

/// The links are `base`, `link1`, `link2`, ... and `tool`, which is fixed to the last.
fn urdf(name: &str, joints: &[Joint], tool_xyz: [f64; 3], tool_rpy: [f64; 3]) -> String {
    let three = |[x, y, z]: [f64; 3]| format!("{x} {y} {z}");
    let mut text = format!("<robot name='{name}'>\n<link name='{BASE}'/>\n");
    let mut parent = BASE.to_owned();
    for (number, joint) in (1..).zip(joints) {
        let kind = match joint.limit {
            None => "continuous",
            Some(_) if joint.slides => "prismatic",
            Some(_) => "revolute",
        };
        let (xyz, axis) = (three(joint.xyz), three(joint.axis));
        // Writing into a String cannot fail.
        let _ = write!(
            text,
            "<link name='link{number}'/>\n<joint name='joint{number}' type='{kind}'><parent link='{parent}'/>\
             <child link='link{number}'/><origin xyz='{xyz}' rpy='{} 0 0'/><axis xyz='{axis}'/>",
            joint.roll
        );
        if let Some((lower, upper)) = joint.limit {
            let _ = write!(text, "<limit lower='{lower}' upper='{upper}' velocity='1' effort='1'/>");
        }
        text.push_str("</joint>\n");
        parent = format!("link{number}");
    }
    let _ = write!(
        text,
        "<link name='{TOOL}'/>\n<joint name='tool' type='fixed'><parent link='{parent}'/><child link='{TOOL}'/>\
         <origin xyz='{}' rpy='{}'/></joint>\n</robot>\n",
        three(tool_xyz),
        three(tool_rpy)
    );
    text
}
