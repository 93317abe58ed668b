//! A recorded search as a graph: DOT for Graphviz, `GraphML` for Gephi, yEd, `NetworkX`.
//!
//! One graph for all attempts; node `a0n12` is node 12 of attempt 0. Nodes that were taken back are marked, not left out.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::{Attempt, Node, Recording};
use crate::viewer::data::PoseData;

/// One node with all that is known of it.
struct Row<'a> {
    id: String,
    parent: Option<String>,
    node: &'a Node,
    attempt: u64,
    primitive: &'a str,
    /// By object.
    objects: Vec<Option<PoseData>>,
    is_removed: bool,
    /// What blocked extensions that ended here, and how often.
    blocked: BTreeMap<String, u64>,
}

impl Row<'_> {
    /// `Push, 3`, then where the objects that the step moved are, then what was in the way.
    fn label(&self, names: &[&str]) -> String {
        let mut label = format!("{} {}", self.primitive, self.node.1);
        for (object, [x, y, ..]) in &self.node.4 {
            let name = names.get(usize::from(*object)).copied().unwrap_or_default();
            let _ = write!(label, "\n{name} {x:.2} {y:.2}");
        }
        if let Some((pair, count)) = self.blocked.iter().max_by_key(|(_, count)| **count) {
            let _ = write!(label, "\nblocked: {pair} ({count})");
        }
        label
    }
}

fn rows<'a>(recording: &'a Recording, attempt: &'a Attempt) -> Vec<Row<'a>> {
    let id = |node: u32| format!("a{}n{node}", attempt.attempt);
    let body = |index: u32| recording.bodies.get(index as usize).map_or("", String::as_str);
    let mut blocked: BTreeMap<u32, BTreeMap<String, u64>> = BTreeMap::new();
    for entry in &attempt.blocked {
        let pair = format!("{} and {}", body(entry.2), body(entry.3));
        *blocked.entry(entry.1).or_default().entry(pair).or_default() += 1;
    }
    let mut rows: Vec<Row<'a>> = Vec::with_capacity(attempt.nodes.len());
    for ((index, node), is_alive) in (0..).zip(&attempt.nodes).zip(attempt.alive()) {
        let parent = node.0.and_then(|parent| rows.get(parent as usize));
        let mut objects = parent.map_or_else(|| vec![None; recording.problem.objects.len()], |row| row.objects.clone());
        for (object, pose) in &node.4 {
            if let Some(place) = objects.get_mut(usize::from(*object)) {
                *place = Some(*pose);
            }
        }
        let primitive = node.2.and_then(|primitive| recording.primitives.get(usize::from(primitive)));
        rows.push(Row {
            id: id(index),
            parent: node.0.map(id),
            node,
            attempt: attempt.attempt,
            primitive: primitive.map_or("start", String::as_str),
            objects,
            is_removed: !is_alive,
            blocked: blocked.remove(&index).unwrap_or_default(),
        });
    }
    rows
}

fn names(recording: &Recording) -> Vec<&str> {
    recording.problem.objects.iter().map(|object| object.name.as_str()).collect()
}

/// The search as DOT. Nodes at which an extension was blocked are red, those that were taken back are dashed.
pub fn dot(recording: &Recording) -> String {
    let quoted = |text: &str| {
        let inside = text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
        format!("\"{}\"", inside.replace(|c: char| c.is_control(), " "))
    };
    let names = names(recording);
    let mut out = format!("digraph {} {{\n  node [shape=box, fontsize=9];\n", quoted(&recording.problem.name));
    for row in recording.attempts.iter().flat_map(|attempt| rows(recording, attempt)) {
        let mut style = String::new();
        if !row.blocked.is_empty() {
            style.push_str(", color=red");
        }
        if row.is_removed {
            style.push_str(", style=dashed");
        }
        let _ = writeln!(out, "  {} [label={}{style}];", row.id, quoted(&row.label(&names)));
        if let Some(parent) = &row.parent {
            let _ = writeln!(out, "  {parent} -> {};", row.id);
        }
    }
    out.push_str("}\n");
    out
}

/// The search as `GraphML`: what is known of a node are its attributes.
pub fn graphml(recording: &Recording) -> String {
    let names = names(recording);
    let escaped = |text: &str| {
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;");
        text.replace(|c: char| c.is_control(), " ")
    };
    let mut out = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<graphml xmlns=\"http://graphml.graphdrawing.org/xmlns\">\n",
    );
    let mut keys = vec![
        ("attempt".to_owned(), "long"),
        ("iteration".to_owned(), "long"),
        ("primitive".to_owned(), "string"),
        ("base_x_m".to_owned(), "double"),
        ("base_y_m".to_owned(), "double"),
        ("base_yaw_rad".to_owned(), "double"),
        ("removed".to_owned(), "boolean"),
        ("blocked".to_owned(), "long"),
        ("blocked_by".to_owned(), "string"),
    ];
    for name in &names {
        keys.extend(["x_m", "y_m", "z_m"].map(|axis| (format!("{name} {axis}"), "double")));
    }
    for (index, (name, kind)) in keys.iter().enumerate() {
        let name = escaped(name);
        let _ = writeln!(out, "  <key id=\"k{index}\" for=\"node\" attr.name=\"{name}\" attr.type=\"{kind}\"/>");
    }
    let _ = writeln!(out, "  <graph id=\"{}\" edgedefault=\"directed\">", escaped(&recording.problem.name));
    for row in recording.attempts.iter().flat_map(|attempt| rows(recording, attempt)) {
        let [x, y, yaw] = row.node.3;
        let by: Vec<_> = row.blocked.iter().map(|(pair, count)| format!("{pair} ({count})")).collect();
        let mut values = vec![
            row.attempt.to_string(),
            row.node.1.to_string(),
            escaped(row.primitive),
            x.to_string(),
            y.to_string(),
            yaw.to_string(),
            row.is_removed.to_string(),
            row.blocked.values().sum::<u64>().to_string(),
            escaped(&by.join(", ")),
        ];
        for place in &row.objects {
            let [x, y, z, ..] = place.unwrap_or_default();
            values.extend([x, y, z].map(|value| value.to_string()));
        }
        let _ = write!(out, "    <node id=\"{}\">", row.id);
        for (index, value) in values.iter().enumerate() {
            let _ = write!(out, "<data key=\"k{index}\">{value}</data>");
        }
        out.push_str("</node>\n");
        if let Some(parent) = &row.parent {
            let _ = writeln!(out, "    <edge source=\"{parent}\" target=\"{}\"/>", row.id);
        }
    }
    out.push_str("  </graph>\n</graphml>\n");
    out
}
