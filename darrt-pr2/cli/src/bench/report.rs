//! The results as one page that needs no network: tables, curves, boxes, and where the time goes.
//!
//! | question | file |
//! |---|---|
//! | which share was solved by when? | `curves` |
//! | how do the times spread? | `boxes` |
//! | where does the time go? | `shares` |
//! | what do the tables say? | `tables` |
//! | how is a time put on paper? | `axis` |

mod axis;
mod boxes;
mod curves;
mod shares;
mod tables;

use std::collections::BTreeSet;
use std::fmt::Write as _;

use svg::node::Text;

use super::collection::Collection;
use super::kept::Kept;
use super::machine::Machine;
use super::ompl_log::date;
use super::record::Record;
use super::statistics::{Summary, summaries};
use super::variant::VARIANTS;
use axis::LogAxis;
use darrt_task::picture::ink;
use darrt_task::text::counted;

/// Colours of variants; with more variants they come again, dashed.
const COLOURS: [&str; 8] = ["#2148d8", "#e8590c", "#149a3e", "#c01fc0", "#b98900", "#0891b2", "#b91c1c", "#6b7280"];
/// Lines of variants, one after each round of colours.
const DASHES: [&str; 4] = ["", "6 3", "2 3", "8 3 2 3"];

/// How variants look.
#[derive(Debug, Clone)]
struct Look {
    variants: Vec<String>,
}

impl Look {
    /// Colour and dashes.
    fn line(&self, variant: &str) -> (&'static str, &'static str) {
        let place = self.variants.iter().position(|name| name == variant).unwrap_or(0);
        let pick = |from: &[&'static str], at: usize| from.get(at % from.len()).copied().unwrap_or_default();
        (pick(&COLOURS, place), pick(&DASHES, place / COLOURS.len()))
    }
}

/// The text of the page, problems in the order of `known` first; the same results give the same bytes.
///
/// `plans` is where the pages of kept plans are.
pub fn page(all: &Collection, known: &[&str], plans: Option<&Kept<'_>>) -> String {
    let summaries = summaries(all, known);
    let look = Look { variants: all.variants(&VARIANTS.map(|variant| variant.name)) };
    let mut problems: Vec<&str> = summaries.iter().map(|summary| summary.problem.as_str()).collect();
    problems.dedup();
    let axis = LogAxis::over(all.records().map(|run| run.time().value));
    let mut body = head(all, &look);
    section(&mut body, "Times to the solution", &tables::times(&summaries));
    let per_problem = |draw: &dyn Fn(&str, &[&Summary]) -> String| {
        let one =
            |problem: &&str| draw(problem, &summaries.iter().filter(|s| s.problem == *problem).collect::<Vec<_>>());
        format!("<div class=\"grid\">{}</div>", problems.iter().map(one).collect::<String>())
    };
    let curves = per_problem(&|problem, group| curves::draw(problem, group, &axis, &look));
    section(&mut body, "Share of runs solved against time", &format!("{}{CURVES}{curves}", legend(&look)));
    let boxes = per_problem(&|problem, group| {
        let rows: Vec<_> = group.iter().map(|s| (*s, all.group(problem, &s.variant))).collect();
        boxes::draw(problem, &rows, &axis, &look)
    });
    section(&mut body, "Spread of the times", &format!("{BOXES}{boxes}"));
    let name = |s: &Summary| {
        if look.variants.len() == 1 { s.problem.clone() } else { format!("{}, {}", s.problem, s.variant) }
    };
    let rows: Vec<_> = summaries.iter().map(|s| (name(s), all.group(&s.problem, &s.variant))).collect();
    let swatches = format!("{}{}", swatches(&shares::primitives_legend()), swatches(&shares::work_legend()));
    section(&mut body, "Where the time goes", &format!("{SHARES}{swatches}{}", shares::draw(&rows)));
    section(&mut body, "Would restarts help?", &format!("{RESTARTS}{}", tables::restarts(&rows)));
    section(&mut body, "Where extensions end", &format!("{ENDS}{}", tables::ends(&rows)));
    if let Some(links) = plans.and_then(|plans| tables::plans(all, &summaries, plans)) {
        section(&mut body, "Plans that were kept", &links);
    }
    section(&mut body, "How to read this", READING);
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>darrt bench</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n</body>\n</html>\n"
    )
}

const CURVES: &str =
    "<p>Higher and farther left is better. A small upright tick is a run that ended without a plan.</p>";
const BOXES: &str = "<p>Box: quartiles, thick line: median, whiskers: 5th to 95th percentile, dots: runs. A red triangle is a \
    run that ended without a plan; a box or whisker with a dashed, open end goes on beyond what the runs can tell.</p>";
const SHARES: &str = "<p>Means over all runs. Propagation belongs to the primitive that was drawn; collision checks and ways \
    around belong to the kind of motion that was judged, so that the transit before a push counts as a transit. The search \
    for a shorter plan is included.</p>";
const RESTARTS: &str = "<p>From the iterations that attempts took, those given up as censored: the number of iterations after \
    which starting over would take the least work to be expected (Luby, Sinclair, Zuckerman 1993). A rough hint, the rougher \
    the fewer the runs.</p>";
const ENDS: &str =
    "<p>Every extension of the tree puts every primitive into one row of its column: where it got to.</p>";
const READING: &str = "<p>A run that ends without a plan does not say how long the problem takes, only that it takes longer \
    than the run had: its time is <em>censored</em>. So is the time of a plan that was accepted after the limit. Leaving such runs out, or taking their limit for their time, would make \
    a planner look better than it is. Shares and quantiles are therefore product-limit estimates (Kaplan and Meier) over all \
    runs. <b>&gt; 60</b> means that a quantile lies somewhere beyond 60 s. The interval of the median is where it lies with \
    a confidence of 95 %, by a seeded bootstrap over runs. Means say little about such times, which have long tails; the \
    mean is given because the paper reports one, and where runs are censored it is a lower bound. Iterations and nodes are \
    those within which half of all runs were solved.</p>\
    <p>Times run from the beginning of the search to the accepted plan; the search for a shorter plan and the verification \
    are included, building the problem is not. Restarts within a run are part of its time. The paper's figures are means \
    of ten trials on the authors' machine of 2012.</p>";

fn section(body: &mut String, title: &str, content: &str) {
    // Writing to a string cannot fail.
    let _ = writeln!(body, "<section>\n<h2>{title}</h2>\n{content}\n</section>");
}

/// Title, what ran and where.
fn head(all: &Collection, look: &Look) -> String {
    let solved = all.records().filter(|run| run.is_in_time()).count();
    let times = || all.records().map(|run| run.started_unix_s);
    let (first, last) = (times().min().unwrap_or(0), times().max().unwrap_or(0));
    let problems: BTreeSet<&str> = all.records().map(|run| run.problem.as_str()).collect();
    let versions: BTreeSet<&str> = all.records().map(|run| run.conditions.darrt.as_str()).collect();
    let versions = versions.into_iter().collect::<Vec<_>>().join(", ");
    let mut text = format!(
        "<h1>darrt bench</h1>\n<p class=\"lead\">{}: {} \u{d7} {}. {solved} solved.</p>\n<ul class=\"facts\">\n\
         <li>darrt {}, run from {} to {} (universal time)</li>\n",
        counted(all.len() as u64, "run"),
        counted(problems.len() as u64, "problem"),
        counted(look.variants.len() as u64, "variant"),
        escaped(&versions),
        date(first),
        date(last),
    );
    let machines: BTreeSet<&Machine> = all.records().map(|run| &run.machine).collect();
    for machine in &machines {
        let Machine { host, cpu, cores, jobs, build } = machine;
        let (cores, jobs) = (counted(*cores as u64, "core"), counted(*jobs as u64, "run"));
        let words = format!("{host}: {cpu}, {cores}, {jobs} at a time, program {build}");
        let _ = writeln!(text, "<li>{}</li>", escaped(&words));
    }
    if machines.len() > 1 {
        text.push_str("<li><b>Times of different machines, loads or programs are put together here.</b></li>\n");
    }
    let limits: BTreeSet<String> = all.records().map(|run| limits(&run.conditions)).collect();
    let limits = limits.into_iter().collect::<Vec<_>>().join("; ");
    let _ = writeln!(text, "<li>Limits of a run: {}</li>\n</ul>", escaped(&limits));
    text
}

fn limits(conditions: &super::record::Conditions) -> String {
    let iterations = conditions.iteration_limit.map_or_else(String::new, |n| format!(", {}", counted(n, "iteration")));
    format!("{} s{iterations}", conditions.time_limit_s)
}

/// The variants with their lines.
fn legend(look: &Look) -> String {
    let mut text = "<ul class=\"legend\">".to_owned();
    for variant in &look.variants {
        let (colour, dash) = look.line(variant);
        let about = VARIANTS.iter().find(|known| known.name == *variant).map_or("", |known| known.about);
        let _ = write!(
            text,
            "<li><svg width=\"30\" height=\"10\"><line x1=\"0\" y1=\"5\" x2=\"30\" y2=\"5\" stroke=\"{colour}\" \
             stroke-width=\"2.5\" stroke-dasharray=\"{dash}\"/></svg> <b>{}</b> {}</li>",
            escaped(variant),
            escaped(about)
        );
    }
    text + "</ul>\n"
}

/// Colours with their names.
fn swatches(entries: &[(&str, &str)]) -> String {
    let one = |(name, colour): &(&str, &str)| {
        let square =
            format!("<svg width=\"12\" height=\"12\"><rect width=\"12\" height=\"12\" fill=\"{colour}\"/></svg>");
        format!("<li>{square} {}</li>", escaped(name))
    };
    format!("<ul class=\"legend\">{}</ul>\n", entries.iter().map(one).collect::<String>())
}

/// A text as it stands on the page.
fn escaped(text: &str) -> String {
    Text::new(ink::clean(text)).to_string()
}

const STYLE: &str = "\
body { margin: 0; background: #fff; color: #1f2933; font: 15px/1.5 system-ui, 'Segoe UI', 'Helvetica Neue', Arial, sans-serif }
main { max-width: 1240px; margin: 0 auto; padding: 24px 20px 48px }
h1 { font-size: 26px; margin: 0 }
h2 { font-size: 18px; margin: 36px 0 6px; padding-top: 14px; border-top: 1px solid #cbd2d9 }
p { margin: 6px 0 10px; max-width: 78ch; color: #3e4c59 }
p.lead { font-size: 16px }
ul.facts { margin: 6px 0; padding-left: 18px; color: #5f6c7b; font-size: 13.5px }
ul.legend { list-style: none; margin: 6px 0 8px; padding: 0; display: flex; flex-wrap: wrap; gap: 2px 20px; font-size: 13px; color: #5f6c7b }
ul.legend b { color: #1f2933 }
.grid { display: grid; grid-template-columns: repeat(auto-fit, minmax(440px, 1fr)); gap: 14px 20px; align-items: start }
.grid svg, section > svg { width: 100%; height: auto; display: block }
.wide { overflow-x: auto }
table { border-collapse: collapse; font-size: 13px; font-variant-numeric: tabular-nums; margin: 8px 0 }
th, td { padding: 3px 8px; text-align: right; white-space: nowrap }
th { border-bottom: 2px solid #9aa5b1; font-weight: 600; vertical-align: bottom }
th.name, td.name { text-align: left; padding-left: 0 }
tr.first td { border-top: 1px solid #cbd2d9 }
td.open { color: #b91c1c }
details { margin: 4px 0 }
summary { cursor: pointer; font-size: 14px }
";

/// The runs of one row of a table or a chart, with the row's name.
type Row<'a> = (String, Vec<&'a Record>);

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [&str; 2] = ["plate1", "bowl"];
    use crate::bench::record::tests::sample;

    fn results() -> Collection {
        let mut all = Collection::default();
        for seed in 0..12 {
            let solved = seed % 3 > 0;
            let time = if solved { 0.1 + seed as f64 } else { 60.0 };
            all.add(sample("bowl", "default", seed, 0.1 + seed as f64 / 10.0, true), "a").unwrap();
            all.add(sample("plate <b>3</b>", "full", seed, time, solved), "a").unwrap();
        }
        all
    }

    #[test]
    fn the_page_loads_nothing_and_names_from_files_stay_text() {
        let page = page(&results(), &KNOWN, None);
        for loads in ["http:", "https:", "src=", "href", "url(", "@import", "<script", "<link", "<iframe"] {
            assert!(!page.contains(loads), "{loads}");
        }
        assert!(page.contains("plate &lt;b&gt;3&lt;/b&gt;") && !page.contains("<b>3</b>"));
    }

    #[test]
    fn the_page_tells_machine_limits_and_censoring_and_is_the_same_again() {
        let text = page(&results(), &KNOWN, None);
        for words in
            ["24 runs: 2 problems", "20 solved", "host: CPU, 2 cores, 1 run at a time", "60 s", "censored", "&gt; 60"]
        {
            assert!(text.contains(words), "{words}");
        }
        for (open, close) in [("<svg", "</svg>"), ("<table", "</table>"), ("<section", "</section>"), ("<tr", "</tr>")]
        {
            assert_eq!(text.matches(open).count(), text.matches(close).count(), "{open}");
        }
        assert_eq!(text, page(&results(), &KNOWN, None));
        assert!(page(&Collection::default(), &KNOWN, None).contains("0 runs"));
    }

    #[test]
    fn plans_that_were_kept_are_linked_and_no_others() {
        let mut all = Collection::default();
        for seed in 0..3 {
            let page = (seed < 2).then(|| format!("bowl-default-{seed}.html"));
            all.add(Record { page, ..sample("bowl", "default", seed, 0.1, true) }, "a").unwrap();
        }
        let kept = |is_there| Kept { link: "../plans/".to_owned(), is_there };
        let text = page(&all, &KNOWN, Some(&kept(&|_| true)));
        assert!(text.contains("href=\"../plans/bowl-default-1.html\""));
        assert_eq!(text.matches("href=").count(), 2);
        // Runs of an earlier day may have kept theirs elsewhere.
        let text = page(&all, &KNOWN, Some(&kept(&|name| name == "bowl-default-0.html")));
        assert!(text.matches("href=").count() == 1 && text.contains("bowl-default-0.html"));
        assert!(!page(&all, &KNOWN, None).contains("href="), "nobody knows where they are");
    }

    #[test]
    fn variants_look_different() {
        let look = Look { variants: VARIANTS.map(|variant| variant.name.to_owned()).to_vec() };
        let looks: BTreeSet<_> = VARIANTS.iter().map(|variant| look.line(variant.name)).collect();
        assert_eq!(looks.len(), VARIANTS.len());
    }
}
