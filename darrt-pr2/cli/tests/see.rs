//! What a run leaves behind to look at: why there is no plan, how the search went, and what is wrong with an idea.

#![allow(clippy::unwrap_used, reason = "a test stops at the first surprise")]

use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

use darrt_task::recording::Recording;
use darrt_task::viewer::data::ViewerData;

use crate::browser::dom;
use crate::program::{darrt, run, text};

/// A mug in a cage of eight posts, and a jar that can be put where it shall be.
fn caged() -> String {
    let post = |i: u32| {
        let (s, c) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        let at = [-0.2 + 0.065 * c, 0.2 + 0.065 * s, 0.89];
        let shape = "{ cylinder = { radius = 0.01, height = 0.3 } }";
        format!("[[obstacle]]\nname = \"post {i}\"\nshape = {shape}\nat = {at:?}\n")
    };
    let mug = |name: &str, y: f64| {
        let shape = "{ cylinder = { radius = 0.035, height = 0.10 } }";
        format!(
            "[[object]]\nname = \"{name}\"\nshape = {shape}\non = \"table\"\nat = [-0.2, {y}]\ngrasps = [\"side\"]\n"
        )
    };
    let goal = |name: &str, y: f64| format!("[[goal.object]]\nobject = \"{name}\"\non = \"table\"\nat = [-0.2, {y}]\n");
    format!(
        "format = \"darrt-problem\"\nversion = 1\nname = \"caged\"\nprimitives = [\"Arm-Transit\", \
         \"Straight-Line-Arm-Transit\", \"Arm-Rigid-Transfer\", \"Base-Transit\", \"Base-Rigid-Transfer\", \"Pick\", \"Place\", \
         \"Push\"]\n[robot]\nbase = [-1.0, 0.0, 0.0]\n[[obstacle]]\nname = \"table\"\nshape = {{ box = {{ size = [0.8, 1.2, \
         0.74] }} }}\nat = [0.0, 0.0, 0.37]\n[[surface]]\nname = \"table\"\ntop_of = \"table\"\n{}{}{}{}{}",
        (0..8).map(post).collect::<String>(),
        mug("mug", 0.2),
        mug("jar", -0.1),
        goal("mug", 0.4),
        goal("jar", -0.4)
    )
}

/// A folder with what a run without a plan leaves behind, made once.
fn failed() -> &'static Path {
    static FOLDER: OnceLock<tempfile::TempDir> = OnceLock::new();
    FOLDER
        .get_or_init(|| {
            let folder = tempfile::tempdir().unwrap();
            std::fs::write(folder.path().join("caged.toml"), caged()).unwrap();
            let run =
                darrt(folder.path(), &["plan", "caged.toml", "--iterations", "600", "--record", "caged.search.json"]);
            let complaint = text(&run.stderr);
            assert_eq!(run.status.code(), Some(5), "{complaint}");
            assert!(complaint.contains("caged.why.html") && complaint.contains("caged.partial.json"), "{complaint}");
            assert!(complaint.lines().filter(|line| !line.contains("doubtful")).count() <= 10, "{complaint}");
            folder
        })
        .path()
}

fn data_in(page: &Path) -> ViewerData {
    let page = std::fs::read_to_string(page).unwrap();
    let (_, rest) = page.split_once("<script id=\"data\" type=\"application/json\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_failed_run_leaves_a_page_with_causes_bodies_and_what_was_in_the_way() {
    let data = data_in(&failed().join("caged.why.html"));
    let why = data.why.unwrap();
    assert!(why.headline.starts_with("iteration limit"), "{}", why.headline);
    let of_mug = why.causes.iter().find(|cause| cause.bodies.first().is_some_and(|body| body == "mug")).unwrap();
    assert!(of_mug.bodies.iter().any(|body| body.starts_with("post")), "{of_mug:?}");
    // What can be clicked can be found in the scene.
    let known: Vec<&str> = data
        .bodies
        .iter()
        .map(|body| body.name.as_str())
        .chain(data.objects.iter().map(|object| object.name.as_str()))
        .chain(data.robot.links.iter().map(|link| link.name.as_str()))
        .collect();
    for cause in &why.causes {
        assert!(cause.bodies.iter().all(|body| known.contains(&body.as_str())), "{cause:?}");
    }
    assert!(why.blocks.windows(2).all(|pair| pair[0].count >= pair[1].count));
    assert!(why.blocks.iter().any(|block| block.second.starts_with("post")), "{:?}", why.blocks);
    let nearest = why.nearest.unwrap();
    assert_eq!(nearest.state.objects.len(), data.objects.len());
    assert!(nearest.to_go_m > 0.0 && nearest.state.objects != data.start.objects);
    // The beginning of the plan is played, and ends with the jar at its goal.
    let jar = data.objects.iter().position(|object| object.name == "jar").unwrap();
    let last = data.steps.iter().rev().flat_map(|step| &step.objects).find(|track| track.object == jar);
    assert!(!data.steps.is_empty() && (last.is_some() || data.steps.iter().any(|step| step.holds.is_some())));
    assert_eq!(data.search.unwrap().attempts.len(), 1);
}

#[test]
fn a_problem_that_is_refused_leaves_a_page_too() {
    let folder = tempfile::tempdir().unwrap();
    let wall = "[[obstacle]]\nname = \"wall\"\nshape = { box = { size = [0.2, 0.2, 0.4] } }\nat = [-0.2, -0.4, 0.94]\n";
    let problem = caged().replacen("[[object]]", &format!("{wall}[[object]]"), 1);
    std::fs::write(folder.path().join("p.toml"), problem).unwrap();
    let run = darrt(folder.path(), &["plan", "p.toml"]);
    assert_eq!(run.status.code(), Some(6), "{}", text(&run.stderr));
    let data = data_in(&folder.path().join("p.why.html"));
    let why = data.why.unwrap();
    assert_eq!(why.causes[0].bodies, ["jar", "wall"]);
    assert!(why.causes[0].at.is_some() && data.steps.is_empty());
    // Who wants no picture gets none.
    std::fs::remove_file(folder.path().join("p.why.html")).unwrap();
    darrt(folder.path(), &["plan", "p.toml", "--no-picture"]);
    assert!(!folder.path().join("p.why.html").exists());
}

#[test]
fn a_recorded_search_is_whole_and_can_be_seen_at_any_iteration() {
    let recording = Recording::read(&failed().join("caged.search.json")).unwrap();
    let attempt = &recording.attempts[0];
    assert_eq!((attempt.iterations, attempt.nodes[0].0, recording.solved), (600, None, None));
    assert!(attempt.nodes.len() > 100 && !attempt.blocked.is_empty());
    let shown = darrt(failed(), &["show", "caged.search.json", "-o", "tree.graphml", "--iteration", "100"]);
    assert!(shown.status.success(), "{}", text(&shown.stderr));
    let graph = std::fs::read_to_string(failed().join("tree.graphml")).unwrap();
    let early = attempt.until(100);
    assert!(early.nodes.len() < attempt.nodes.len() && early.blocked.len() < attempt.blocked.len());
    assert_eq!(graph.matches("<node ").count(), early.nodes.len());
    assert_eq!(graph.matches("<edge ").count(), early.nodes.len() - 1);
    let tree = roxmltree::Document::parse(&graph).unwrap();
    let blocked = tree.descendants().filter(|node| node.attribute("attr.name") == Some("blocked")).count();
    assert_eq!(blocked, 1);

    let shown = darrt(failed(), &["show", "caged.search.json", "-o", "tree.dot"]);
    assert!(shown.status.success(), "{}", text(&shown.stderr));
    let dot = std::fs::read_to_string(failed().join("tree.dot")).unwrap();
    assert_eq!(dot.matches(" -> ").count(), attempt.nodes.len() - 1);
    assert!(dot.contains("blocked: ") && dot.contains("and post"), "the body that blocked is named");

    darrt(failed(), &["show", "caged.search.json", "-o", "tree.html", "--iteration", "100"]);
    assert_eq!(data_in(&failed().join("tree.html")).search.unwrap().attempts, [early]);
}

#[test]
fn the_same_search_has_the_same_recording_on_any_number_of_threads_and_the_same_plan() {
    let folder = tempfile::tempdir().unwrap();
    let run = |threads: &str, record: &str| {
        let mut arguments = vec!["plan", "plate1", "--restart", "40", "--threads", threads, "--no-picture", "--quiet"];
        if !record.is_empty() {
            arguments.extend(["--record", record]);
        }
        let run = darrt(folder.path(), &arguments);
        assert!(run.status.success(), "{}", text(&run.stderr));
        std::fs::read_to_string(folder.path().join("plate1.plan.json")).unwrap()
    };
    let plans = [run("1", "one.json"), run("3", "three.json"), run("1", "")];
    assert!(plans.windows(2).all(|pair| pair[0] == pair[1]));
    let [one, three] = ["one.json", "three.json"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(one == three);
    let recording = Recording::read(&folder.path().join("one.json")).unwrap();
    assert_eq!(recording.solved, recording.attempts.last().map(|attempt| attempt.attempt));
}

#[test]
fn bad_recordings_and_options_are_refused_with_the_place() {
    let mut recording = Recording::read(&failed().join("caged.search.json")).unwrap();
    let refused = |recording: &Recording| {
        recording.write(&failed().join("bad.json")).unwrap();
        let shown = darrt(failed(), &["show", "bad.json", "-o", "bad.dot"]);
        assert_eq!(shown.status.code(), Some(2));
        text(&shown.stderr)
    };
    recording.attempts[0].nodes[5].0 = Some(5);
    let complaint = refused(&recording);
    assert!(complaint.contains("`attempts[0].nodes[5][0]` is 5, must be below 5"), "{complaint}");
    recording.attempts[0].nodes[5].0 = Some(4);
    recording.attempts[0].blocked[0].2 = 100_000;
    let complaint = refused(&recording);
    assert!(complaint.contains("`attempts[0].blocked[0][2]` is 100000"), "{complaint}");
    recording.version = 2;
    assert!(refused(&recording).contains("version 2"));
    for (arguments, words) in [
        (vec!["show", "caged.search.json", "-o", "tree.svg"], ".graphml"),
        (vec!["show", "caged.search.json", "--attempt", "7", "-o", "tree.dot"], "its attempts: 0"),
        (vec!["show", "caged.toml", "--iteration", "7"], "recorded searches"),
        (vec!["plan", "caged.search.json"], "recorded search"),
        (vec!["check", "caged.search.json"], "recorded search"),
        (vec!["plan", "caged.toml", "--search", "hierarchical", "--record", "h.json"], "--search"),
    ] {
        let run = darrt(failed(), &arguments);
        let complaint = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {complaint}");
        assert!(complaint.contains(words), "{arguments:?}: {complaint}");
    }
}

/// A browser that notes what it is asked to open, or fails.
#[cfg(target_os = "linux")]
#[test]
fn pages_are_opened_by_the_systems_program_and_it_is_said_when_there_is_none() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = tempfile::tempdir().unwrap();
    let bin = folder.path().join("bin");
    std::fs::create_dir(&bin).unwrap();
    let show = || {
        Command::new(env!("CARGO_BIN_EXE_darrt"))
            .current_dir(folder.path())
            .env("PATH", &bin)
            .args(["show", "bowl", "--open", "-o", "bowl.html"])
            .output()
            .unwrap()
    };
    let run = show();
    let complaint = text(&run.stderr);
    assert_eq!(run.status.code(), Some(4), "{complaint}");
    assert!(complaint.contains("bowl.html: is written, but no browser was found"), "{complaint}");
    assert!(folder.path().join("bowl.html").exists());
    let opener = bin.join("xdg-open");
    std::fs::write(&opener, "#!/bin/sh\necho \"$1\" > opened\n").unwrap();
    std::fs::set_permissions(&opener, std::fs::Permissions::from_mode(0o755)).unwrap();
    let run = show();
    assert!(run.status.success(), "{}", text(&run.stderr));
    let opened = std::fs::read_to_string(folder.path().join("opened")).unwrap();
    assert_eq!(Path::new(opened.trim()), folder.path().join("bowl.html").canonicalize().unwrap());
}

#[test]
fn ideas_are_judged_and_planned_on_from() {
    let run = darrt(failed(), &["why-not", "caged.toml", "--base", "-0.6,0,0"]);
    let printed = text(&run.stdout);
    assert_eq!(run.status.code(), Some(1), "{printed}{}", text(&run.stderr));
    assert!(printed.contains("the base cannot stand there") && printed.contains("`table`"), "{printed}");
    // What works is given as it is asked for.
    let variant = printed.lines().find(|line| line.contains("--base")).unwrap().trim();
    let again: Vec<&str> = ["why-not", "caged.toml"].into_iter().chain(variant.split(' ')).collect();
    let run = darrt(failed(), &again);
    assert_eq!(run.status.code(), Some(0), "{}{}", text(&run.stdout), text(&run.stderr));

    let run = darrt(failed(), &["why-not", "caged.partial.json", "--iterations", "50"]);
    let printed = text(&run.stdout);
    assert_eq!(run.status.code(), Some(1), "{printed}{}", text(&run.stderr));
    assert!(printed.contains("steps are right") && printed.contains("`mug`") && printed.contains("post"), "{printed}");

    let plan = std::fs::read_to_string(failed().join("caged.partial.json")).unwrap();
    let mut plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
    plan["steps"][1]["waypoints"][0]["base"][0] = 3.5.into();
    std::fs::write(failed().join("wrong.json"), plan.to_string()).unwrap();
    let run = darrt(failed(), &["why-not", "wrong.json", "--iterations", "50"]);
    let printed = text(&run.stdout);
    assert_eq!(run.status.code(), Some(1), "{printed}{}", text(&run.stderr));
    assert!(printed.contains("wrong first: step 2"), "{printed}");

    for (arguments, words) in [
        (vec!["why-not", "caged.toml"], "--tool"),
        (vec!["why-not", "caged.partial.json", "--base", "0,0,0"], "is a plan"),
        (vec!["why-not", "caged.toml", "--tool", "0,0,1"], "must be 6 numbers"),
        (vec!["why-not", "caged.toml", "--joints", "0,0"], "2 joints are given, the arm has 7"),
        (vec!["why-not", "caged.toml", "--tool", "0,0,1,0,0,0", "--take", "cup"], "no object `cup`"),
    ] {
        let run = darrt(failed(), &arguments);
        let complaint = text(&run.stderr);
        assert_eq!(run.status.code(), Some(2), "{arguments:?}: {complaint}");
        assert!(complaint.contains(words), "{arguments:?}: {complaint}");
    }
}

#[test]
fn the_report_of_a_benchmark_leads_to_the_plans_that_were_kept() {
    let folder = tempfile::tempdir().unwrap();
    let run = darrt(
        folder.path(),
        &["bench", "bowl", "--seeds", "2", "--keep", "my plans", "--report", "page.html", "--quiet"],
    );
    assert!(run.status.success(), "{}", text(&run.stderr));
    let page = std::fs::read_to_string(folder.path().join("page.html")).unwrap();
    let links: Vec<&str> = page.split("href=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(links, ["my%20plans/bowl-default-0.html", "my%20plans/bowl-default-1.html"]);
    for link in links {
        let kept = folder.path().join(link.replace("%20", " "));
        assert!(!data_in(&kept).steps.is_empty());
        let plan = kept.with_extension("plan.json");
        assert_eq!(darrt(folder.path(), &["check", plan.to_str().unwrap()]).status.code(), Some(0));
    }
}

#[test]
fn a_browser_shows_the_causes_without_a_complaint() {
    let Some(page) = dom(&failed().join("caged.why.html")) else { return };
    let list = |id: &str| page.split_once(&format!("id=\"{id}\">")).map(|(_, rest)| rest).unwrap();
    let causes = list("causes").split("</ul>").next().unwrap();
    assert!(causes.contains("aria-pressed=\"false\"") && causes.contains("`mug`"), "{causes}");
    assert!(list("heat").contains("post") && list("grown").starts_with("iteration 600 of 600"));
}

#[test]
fn a_plan_moves_in_one_svg_file_with_one_frame_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let run = darrt(folder, &["plan", "bowl", "--no-improve", "--no-picture", "-q", "-o", "bowl.json"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let run = darrt(folder, &["show", "bowl.json", "--moving"]);
    assert!(run.status.success(), "{}", text(&run.stderr));
    let picture = std::fs::read_to_string(folder.join("bowl.svg")).unwrap();
    assert!(!picture.contains("<script") && !picture.contains("href"), "it needs nothing else");
    let document = roxmltree::Document::parse(&picture).unwrap();
    let frames: Vec<_> = document.descendants().filter(|node| node.attribute("style").is_some()).collect();
    assert!((20..=65).contains(&frames.len()), "{}", frames.len());
    // The frames follow each other without gap: each begins a tenth of a second behind the one before.
    let delay = |node: &roxmltree::Node<'_, '_>| {
        let style = node.attribute("style").unwrap();
        style.strip_prefix("animation-delay:").unwrap().strip_suffix('s').unwrap().parse::<f64>().unwrap()
    };
    assert!(frames.windows(2).all(|pair| (delay(&pair[1]) - delay(&pair[0]) - 0.1).abs() < 1e-6));
    // The robot stands elsewhere in nearly all of them, and the names of the steps are those of the plan, in its order.
    let shapes = |node: &roxmltree::Node<'_, '_>| {
        let polygons = node.descendants().filter(|node| node.has_tag_name("polygon"));
        polygons.map(|polygon| polygon.attribute("points").unwrap().to_owned()).collect::<Vec<_>>()
    };
    let still = frames.windows(2).filter(|pair| shapes(&pair[0]) == shapes(&pair[1])).count();
    assert!(still * 4 < frames.len(), "{still} of {} frames are as the one before", frames.len());
    let plan: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.join("bowl.json")).unwrap()).unwrap();
    for frame in &frames {
        let said = frame.descendants().find(|node| node.has_tag_name("text")).unwrap().text().unwrap();
        let (number, name) = said.split_once(". ").unwrap();
        let step = &plan["steps"][number.parse::<usize>().unwrap() - 1];
        assert!(name.starts_with(step["primitive"].as_str().unwrap()), "{said}");
    }
    for (arguments, why) in [
        (["show", "bowl.json", "--moving", "-o", "b.png"].as_slice(), "--moving makes an .svg file"),
        (&["show", "bowl", "--moving"], "bowl: is no plan"),
    ] {
        let run = darrt(folder, arguments);
        assert_eq!(run.status.code(), Some(2));
        assert!(text(&run.stderr).contains(why), "{}", text(&run.stderr));
    }
}

#[test]
fn a_robot_is_shown_with_a_slider_for_every_joint() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    run(folder, &["show", "table-arm"], 0);
    let data = data_in(&folder.join("table-arm.robot.html"));
    assert!(data.steps.is_empty() && data.robot.variables.len() >= 7, "{}", data.robot.variables.len());
    // The same from its own file, which is no problem and no plan, and says what to do with it.
    let (printed, _) = run(folder, &["robot", "list", "--print", "table-arm"], 0);
    std::fs::write(folder.join("my arm.toml"), printed.replace("\"table-arm.urdf\"", "\"arm.urdf\"")).unwrap();
    let (_, complaint) = run(folder, &["plan", "my arm.toml"], 2);
    assert!(
        complaint.contains("is a robot file, not a problem") && complaint.contains("--robot 'my arm.toml'"),
        "{complaint}"
    );
    let (_, complaint) = run(folder, &["show", "table-arm", "--moving"], 2);
    assert!(complaint.contains("--moving is not for robots"), "{complaint}");
    let page = std::fs::read_to_string(folder.join("table-arm.robot.html")).unwrap();
    // A script in the page moves a slider as a hand would.
    let probe = "<script>{ const slider = document.querySelector('.joint input'), tool = () => moment.links[robot.tool].join();\
                 const before = tool(); slider.value = (Number(slider.min) + Number(slider.max)) / 2 + 0.3;\
                 slider.dispatchEvent(new Event('input')); document.title = before === tool() ? 'still' : 'moved'; }</script></body>";
    std::fs::write(folder.join("probe.html"), page.replace("</body>", probe)).unwrap();
    let Some(dom) = dom(&folder.join("probe.html")) else { return };
    assert!(dom.contains("<title>moved</title>"), "{}", &dom[..dom.len().min(400)]);
}
