//! The results of a benchmark as tables.

use crate::bench::statistics::Summary;
use crate::bench::survival::Quantile;
use crate::bench::variant::VARIANTS;
use crate::table;

/// How long the planner took: one row per problem and variant.
pub(crate) fn times(summaries: &[Summary]) -> String {
    let header = ["problem", "variant", "solved", "median s", "95 % interval", "quartiles", "95th"];
    let text = rows(&header, summaries, |summary| {
        let time = |q: f64| summary.time.quantile(q).to_string();
        vec![
            format!("{}/{}", summary.solved, summary.runs),
            time(0.5),
            summary.median_interval.map_or_else(String::new, |[low, high]| range(low, high)),
            range(summary.time.quantile(0.25), summary.time.quantile(0.75)),
            time(0.95),
        ]
    });
    let is_censored = summaries.iter().any(|summary| summary.solved < summary.runs);
    let note = if is_censored {
        "\n> : so many runs ended without a plan that all that is known is a lower bound"
    } else {
        ""
    };
    format!("{}{note}\n", text.trim_end())
}

/// What the search needed: one row per problem and variant, medians, and the seconds that the paper gives.
pub(crate) fn efforts(summaries: &[Summary]) -> String {
    rows(&["problem", "variant", "iterations", "nodes", "restarts", "paper s"], summaries, |summary| {
        vec![
            whole(summary.iterations),
            whole(summary.nodes),
            summary.restarts.to_string(),
            summary.paper_s.map_or_else(String::new, |paper| paper.to_string()),
        ]
    })
}

/// The plans: one row per problem and variant, medians.
pub(crate) fn plans(summaries: &[Summary]) -> String {
    let header = [
        "problem",
        "variant",
        "steps",
        "driven\nm",
        "95th",
        "turned\n\u{b0}",
        "arm\nrad",
        "hand\nm",
        "execution\ns",
        "clearance\nmm",
    ];
    rows(&header, summaries, |summary| {
        let quality = &summary.quality;
        vec![
            whole(summary.steps),
            hundredths(quality.base_m),
            hundredths(quality.base_95_m),
            whole(quality.turn_deg),
            whole(quality.arm_rad),
            hundredths(quality.hand_m),
            whole(quality.execution_s),
            whole(quality.clearance_m.map(|metres| metres * 1e3)),
        ]
    })
}

/// A table that names problem and variant, the problem once, then tells `numbers`.
fn rows(header: &[&str], summaries: &[Summary], numbers: impl Fn(&Summary) -> Vec<String>) -> String {
    let mut table = table::unbroken(header);
    let mut problem = "";
    for summary in summaries {
        let name = if summary.problem == problem { "" } else { summary.problem.as_str() };
        problem = &summary.problem;
        table.add_row([name.to_owned(), summary.variant.clone()].into_iter().chain(numbers(summary)));
    }
    table::finished(table, 2..header.len())
}

fn hundredths(value: Option<f64>) -> String {
    value.map_or_else(|| "\u{2013}".to_owned(), |value| format!("{value:.2}"))
}

fn range(low: Quantile, high: Quantile) -> String {
    match (low, high) {
        (Quantile::Beyond(_), Quantile::Beyond(_)) => low.to_string(),
        _ => format!("{low} \u{2013} {high}"),
    }
}

fn whole(count: Option<f64>) -> String {
    count.map_or_else(|| "\u{2013}".to_owned(), |count| format!("{count:.0}"))
}

/// The variants and what they change.
pub(crate) fn variants() -> String {
    let mut table = table::with_header(["variant", "what it changes"]);
    for variant in VARIANTS {
        table.add_row([variant.name, variant.about]);
    }
    table::finished(table, [])
}
