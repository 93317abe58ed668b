//! A problem for another robot than the one it was written for.

use std::path::Path;

use darrt_primitives::contract::{Contract, HandUse};

use super::FileRobot;
use super::load::Loaded;
use super::shipped;
use crate::problem_file::{PrimitiveName, ProblemFile};
use crate::robot::{RobotError, TaskRobot as _};
use crate::tied_hand::why_not_lifted;

/// The problem with the robot that a person names on a command line, one of [`shipped`] or a robot file, in the place of its own:
/// the base where it was, the arm at home, through its own postures. Primitives that drive are taken from a robot that is
/// bolted down, and those with something in the hand from one that does not lift. Also what was changed besides, in words.
///
/// # Errors
/// [`RobotError`] when there is no such robot, or the problem asks for joints of the other one.
pub fn with_robot(
    mut problem: ProblemFile,
    name_or_path: &str,
    contracts: impl Fn(&PrimitiveName) -> Option<Contract>,
) -> Result<(ProblemFile, Vec<String>), RobotError> {
    let robot = &mut problem.robot;
    let path = Path::new(name_or_path);
    let is_shipped = shipped::all().iter().any(|robot| robot.name == name_or_path);
    let is_path = !is_shipped && (path.extension().is_some() || path.exists());
    (robot.model, robot.file) =
        if is_path { (None, Some(path.to_path_buf())) } else { (Some(name_or_path.to_owned()), None) };
    (robot.urdf, robot.torso_m, robot.posture, robot.joints) = (None, None, None, None);
    (robot.other_posture, robot.other_joints) = (None, None);
    robot.shapeless.clear();
    robot.arm = crate::problem_file::ArmSide::default();
    if problem.goal.robot.as_ref().is_some_and(|goal| goal.joints.is_some()) {
        let why = "asks for joints of the robot that the problem was written for".to_owned();
        return Err(RobotError::Key { key: "goal.robot.joints", why });
    }
    let mut changes = Vec::new();
    problem.transit.postures = FileRobot::posture_names(&problem.robot)?;
    let loaded = Loaded::of(&problem.robot)?;
    let file = &loaded.source.file;
    let mut leave_out = |is_of: &dyn Fn(&Contract) -> bool, why: &str| {
        let is_taken = |name: &PrimitiveName| contracts(name).is_some_and(|contract| is_of(&contract));
        let (taken, kept): (Vec<_>, Vec<_>) = problem.primitives.drain(..).partition(is_taken);
        problem.primitives = kept;
        problem.primitive_settings.retain(|name, _| !taken.contains(name));
        if !taken.is_empty() {
            let names: Vec<_> = taken.iter().map(PrimitiveName::as_str).collect();
            changes.push(format!("without {}: {why}", names.join(" and ")));
        }
    };
    if !file.base.kind.drives() {
        leave_out(&Contract::drives, &format!("the base of {} does not drive", file.name));
    }
    // One hand that is lifted is enough.
    let whys: Option<Vec<_>> = loaded.hand_ties()?.iter().map(why_not_lifted).collect();
    if let Some(why) = whys.and_then(|whys| whys.into_iter().next()) {
        leave_out(&|contract| contract.hand != HandUse::Empty, &format!("{}: {why}", file.name));
    }
    Ok((problem, changes))
}
