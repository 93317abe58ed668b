use super::*;
use crate::problem_file::PrimitiveName;
use crate::testing::{builtin, builtin_names, facts};

/// Straight lines in joint space and between poses: `count` states from `from` to `to`.
fn between(from: &Snapshot, to: &Snapshot, count: u32) -> Vec<Snapshot> {
    let line = |a: f64, b: f64, s: f64| a + (b - a) * s;
    let state = |i: u32| {
        let s = f64::from(i) / f64::from(count - 1);
        let mut state = from.clone();
        for (value, (a, b)) in state.robot.base.iter_mut().zip(from.robot.base.iter().zip(to.robot.base)) {
            *value = line(*a, b, s);
        }
        for (joint, (a, b)) in state.robot.joints.iter_mut().zip(from.robot.joints.iter().zip(&to.robot.joints)) {
            *joint = line(*a, *b, s);
        }
        state.objects[0] = from.objects[0].lerp_slerp(&to.objects[0], s);
        state
    };
    (0..count).map(state).collect()
}

/// A plan that pushes, takes, carries and places the plate of Plate1; it need not be possible.
fn story() -> Story {
    const ABOVE: [f64; 7] = [0.287_708, 0.114_089, -1.0, -0.794_637, -2.071_325, -1.878_958, -0.601_32];
    const CONTACT: [f64; 7] = [0.240_989, 0.225_073, -1.17, -0.825_254, -2.010_273, -1.699_174, -0.579_167];
    const PUSHED: [f64; 7] = [-0.749_999, 0.024_19, -1.69, -1.218_877, -1.552_387, -1.450_569, -1.101_583];
    let problem = builtin("plate1").unwrap();
    let facts = facts(&problem);
    let mut story = Story::of_problem(&problem, &facts).unwrap();
    let variables: Vec<_> =
        facts.arm_joints.iter().map(|name| story.model.tree().variable_index(name).unwrap()).collect();
    let arm = |s: &mut Snapshot, values: [f64; 7]| {
        variables.iter().zip(values).for_each(|(variable, value)| s.robot.joints[*variable] = value);
    };
    let mut at = story.start.clone();
    let mut steps = Vec::new();
    let mut step = |primitive, act, change: &dyn Fn(&mut Snapshot)| {
        let from = at.clone();
        change(&mut at);
        let object = (from.objects != at.objects).then_some(0);
        steps.push(StoryStep { primitive, act, hand: 0, object, snapshots: between(&from, &at, 15) });
    };
    step(PrimitiveName::ARM_TRANSIT, Act::Transit, &|s| arm(s, ABOVE));
    step(PrimitiveName::STRAIGHT_LINE_ARM_TRANSIT, Act::Transit, &|s| arm(s, CONTACT));
    step(PrimitiveName::PUSH, Act::Push, &|s| {
        arm(s, PUSHED);
        s.objects[0].translation.y -= 0.58;
    });
    step(PrimitiveName::BASE_TRANSIT, Act::Transit, &|s| s.robot.base = [-0.2, -1.3, 1.57]);
    step(PrimitiveName::PICK, Act::Pick, &|s| {
        arm(s, [-0.5, 0.4, -1.0, -1.4, -1.5, -1.2, 0.4]);
        s.objects[0].translation.z += 0.12;
    });
    step(PrimitiveName::BASE_RIGID_TRANSFER, Act::Transfer, &|s| {
        s.robot.base = [-1.13, -1.16, -2.67];
        s.objects[0].translation.vector += nalgebra::Vector3::new(-1.6, -0.4, 0.0);
    });
    step(PrimitiveName::PLACE, Act::Place, &|s| {
        s.objects[0].translation.vector = nalgebra::Vector3::new(-2.14, -1.09, 1.01);
    });
    story.steps = steps;
    story.note = "Seed 1.".to_owned();
    story
}

#[test]
fn every_embedded_problem_has_a_picture() {
    for name in builtin_names() {
        let problem = builtin(name).unwrap();
        let story = Story::of_problem(&problem, &facts(&problem)).unwrap();
        let image = draw(&story, Extent::Whole);
        assert!(image.starts_with("<?xml") && image.trim_end().ends_with("</svg>"), "{name}");
        assert!(!image.contains("NaN") && !image.contains("inf"), "{name}");
    }
}

#[test]
fn pictures_need_nothing_from_elsewhere_and_are_the_same_twice() {
    let story = story();
    let page = draw(&story, Extent::Whole);
    for foreign in ["href=", "src=", "url(", "<script", "@import"] {
        assert!(!page.contains(foreign), "{foreign}");
    }
    assert_eq!(page, draw(&story, Extent::Whole));
}

#[test]
fn every_step_has_a_number_a_name_and_a_distance() {
    let story = story();
    let image = draw(&story, Extent::Whole);
    for (number, step) in (1..).zip(&story.steps) {
        assert!(image.contains(&format!("<title>step {number}: {}</title>", step.primitive)) || step.object.is_none());
        assert!(image.contains(&format!(">{number}</text>")), "step {number}");
    }
    assert!(image.contains("object 0.58 m"));
    let overview = draw(&story, Extent::Overview);
    assert!(overview.len() < image.len() && !overview.contains("object 0.58 m"));
    assert!(image.contains("Seed 1."));
}

#[test]
fn hostile_names_do_not_break_the_file() {
    let mut story = story();
    story.problem.title = "<script>&\u{1}\"".to_owned();
    let page = draw(&story, Extent::Whole);
    assert!(!page.contains("<script") && page.contains("&lt;script&gt;&amp; \""));
    assert_eq!(page.matches("<svg ").count(), page.matches("</svg>").count());
}

#[test]
fn the_format_follows_the_ending() {
    let format = |path: &str| Format::of_path(Path::new(path));
    assert_eq!(format("a/b.SVG").unwrap(), Format::Svg);
    assert_eq!(format("b.htm").unwrap(), Format::Html);
    assert_eq!((format("b.png").unwrap(), format("b.GLB").unwrap()), (Format::Png, Format::Glb));
    for bad in ["b", "b.gif", "svg"] {
        assert!(format(bad).unwrap_err().to_string().contains(".html, .svg, .png or .glb"), "{bad}");
    }
}

/// The plan of [`story`] again and again, each push and carry in several pieces.
fn long_story(rounds: usize) -> Story {
    let mut long = story();
    let round = long.steps.clone();
    long.steps.clear();
    for step in round.iter().cycle().take(rounds * round.len()) {
        long.steps.extend(std::iter::repeat_n(step.clone(), 3));
    }
    long
}

#[test]
fn long_plans_are_drawn_in_part_and_say_so() {
    let badges = |image: &str| image.matches("font-weight=\"bold\"").count();
    let long = long_story(10);
    assert_eq!(long.steps.len(), 210);
    let image = draw(&long, Extent::Whole);
    // 70 steps when like ones are joined, 30 of them drawn.
    assert!(image.contains("Steps of one kind in a row are drawn as one. 120 of the 210 steps are not drawn"));
    assert!(image.contains("<title>step 208\u{2013}210: Place</title>") && image.contains(">210</text>"));
    assert!(image.contains("(208\u{2013}210)"));
    // Its number in three views, the close-up and its frame, and the heading of the frame.
    assert!(badges(&image) < 6 * 30 + 10, "{}", badges(&image));
    // The ways are whole: a title for each of the joined steps.
    for first in (1..=208).step_by(3) {
        assert!(image.contains(&format!("<title>step {first}\u{2013}{}", first + 2)), "{first}");
    }
    let joined = draw(&long_story(3), Extent::Whole);
    assert!(joined.contains("drawn as one.") && !joined.contains("are not drawn"));
    assert!(!draw(&story(), Extent::Whole).contains("drawn as one"));
}

#[test]
fn the_picture_shows_the_way_of_the_hand_at_work_and_names_it() {
    use crate::testing::{LEFT_TOOL, both_hands, left_handed};
    let plan = left_handed();
    let story = Story::of_plan(&plan, &both_hands(&plan.problem)).unwrap();
    let mut alone = plan.clone();
    alone.steps.iter_mut().for_each(|step| step.tool = None);
    let one = Story::of_plan(&alone, &facts(&plan.problem)).unwrap();
    for (step, same) in story.steps.iter().zip(&one.steps) {
        assert_eq!((story.tool_of(step), one.tool_of(same)), (Some("l"), None));
        let [of_both, of_one] = [Travel::of(&story, step), Travel::of(&one, same)];
        assert!((of_both.hand_m - of_one.hand_m).abs() < 1e-12);
    }
    let mut lie = plan;
    lie.steps[0].tool = Some("hook".to_owned());
    let error = Story::of_plan(&lie, &both_hands(&lie.problem)).unwrap_err().to_string();
    assert!(error.contains("`steps[0].tool`") && error.contains(LEFT_TOOL), "{error}");
}
