//! The tables of the page.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use darrt_core::observe::accounts::Bucket;

use super::{Row, escaped};
use crate::bench::collection::Collection;
use crate::bench::kept::{Kept, encoded};
use crate::bench::record::Record;
use crate::bench::restarts;
use crate::bench::statistics::Summary;
use crate::bench::survival::Quantile;

/// Times, one row per problem and variant.
pub(super) fn times(summaries: &[Summary]) -> String {
    let mut text = "<div class=\"wide\"><table>\n<tr><th class=\"name\">problem</th><th class=\"name\">variant</th>\
                    <th>solved</th><th>median<br>s</th><th>95 %<br>interval</th><th>lower<br>quartile</th>\
                    <th>upper<br>quartile</th><th>95th per-<br>centile</th><th>mean<br>s</th><th>itera-<br>tions</th>\
                    <th>nodes</th><th>restarts</th><th>steps</th><th>paper,<br>mean s</th></tr>\n"
        .to_owned();
    let mut before = "";
    for summary in summaries {
        let is_first = summary.problem != before;
        before = &summary.problem;
        let (class, name) = if is_first { (" class=\"first\"", summary.problem.as_str()) } else { ("", "") };
        let time = |q: f64| cell(summary.time.quantile(q), &summary.time.quantile(q).to_string());
        let interval = summary
            .median_interval
            .map_or_else(|| "<td></td>".to_owned(), |[low, high]| cell(high, &format!("{low} \u{2013} {high}")));
        let mean = summary.time.restricted_mean();
        let count = |count: Option<f64>| count.map_or_else(|| "\u{2013}".to_owned(), |count| format!("{count:.0}"));
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "<tr{class}><td class=\"name\">{}</td><td class=\"name\">{}</td><td>{}/{}</td>{}{interval}{}{}{}{}<td>{}</td><td>{}</td>\
             <td>{}</td><td>{}</td><td>{}</td></tr>",
            escaped(name),
            escaped(&summary.variant),
            summary.solved,
            summary.runs,
            time(0.5),
            time(0.25),
            time(0.75),
            time(0.95),
            cell(mean, &mean.to_string()),
            count(summary.iterations),
            count(summary.nodes),
            summary.restarts,
            count(summary.steps),
            summary.paper_s.map_or_else(String::new, |paper| paper.to_string()),
        );
    }
    text + "</table></div>\n"
}

/// A number; marked where it is only a lower bound.
fn cell(quantile: Quantile, words: &str) -> String {
    let class = if quantile.value().is_some() { "" } else { " class=\"open\"" };
    format!("<td{class}>{}</td>", escaped(words))
}

/// Links to the pages of the plans that were kept, by problem and variant; `None` if there are none.
pub(super) fn plans(all: &Collection, summaries: &[Summary], kept: &Kept<'_>) -> Option<String> {
    let mut text = String::new();
    for summary in summaries {
        let runs = all.group(&summary.problem, &summary.variant);
        let link = |run: &&Record| {
            let page = run.page.as_ref().filter(|page| (kept.is_there)(page))?;
            let (folder, page) = (&kept.link, encoded(page));
            let steps = run.plan.as_ref().map_or_else(String::new, |plan| format!(" ({} steps)", plan.steps));
            Some(format!("<a href=\"{folder}{page}\">seed {}{steps}</a>", run.seed))
        };
        let links: Vec<_> = runs.iter().filter_map(link).collect();
        if !links.is_empty() {
            let name = escaped(&format!("{}, {}", summary.problem, summary.variant));
            let _ = writeln!(text, "<p><b>{name}</b>: {}</p>", links.join(", "));
        }
    }
    (!text.is_empty()).then_some(text)
}

/// When to start over, one row per group of runs.
pub(super) fn restarts(rows: &[Row<'_>]) -> String {
    let mut text =
        "<div class=\"wide\"><table>\n<tr><th class=\"name\">runs of</th><th>attempts</th><th>start over after\
                    <br>iterations</th><th>expected<br>iterations</th><th>without<br>restarts</th></tr>\n"
            .to_owned();
    for (name, runs) in rows {
        let Some(advice) = restarts::advice(runs) else { continue };
        let _ = writeln!(
            text,
            "<tr><td class=\"name\">{}</td><td>{}</td><td>{}</td><td>{:.0}</td><td>{}</td></tr>",
            escaped(name),
            advice.attempts,
            advice.restart.map_or_else(|| "never".to_owned(), |restart| format!("{restart:.0}")),
            advice.expected,
            advice.without.map_or_else(|| "unknown".to_owned(), |without| format!("{without:.0}")),
        );
    }
    text + "</table></div>\n"
}

/// How many extensions each primitive ended in which way, a folded table per row.
pub(super) fn ends(rows: &[Row<'_>]) -> String {
    let mut text = String::new();
    for (name, runs) in rows {
        let (name, table) = (escaped(name), ends_of(runs));
        let _ = writeln!(text, "<details><summary>{name}</summary><div class=\"wide\">{table}</div></details>");
    }
    text
}

fn ends_of(runs: &[&Record]) -> String {
    let mut names: Vec<&str> = Vec::new();
    let mut counts: BTreeMap<(&str, &str), u64> = BTreeMap::new();
    for primitive in runs.iter().flat_map(|run| &run.primitives) {
        if !names.contains(&primitive.name.as_str()) {
            names.push(&primitive.name);
        }
        for (end, count) in &primitive.ends {
            *counts.entry((end, &primitive.name)).or_default() += count;
        }
    }
    let mut table = "<table>\n<tr><th class=\"name\">ends in</th>".to_owned();
    for name in &names {
        let _ = write!(table, "<th>{}</th>", escaped(name).replace('-', "-<wbr>"));
    }
    table.push_str("</tr>\n");
    for end in Bucket::ALL.map(Bucket::heading) {
        let of = |name: &&str| counts.get(&(end, *name)).copied();
        if names.iter().any(|name| of(name).is_some()) {
            let cells = names.iter().map(of).map(|count| match count {
                Some(count) => format!("<td>{count}</td>"),
                None => "<td>\u{b7}</td>".to_owned(),
            });
            let cells: Vec<_> = cells.collect();
            let _ = writeln!(table, "<tr><td class=\"name\">{end}</td>{}</tr>", cells.concat());
        }
    }
    table + "</table>"
}
