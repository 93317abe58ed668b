//! SVG elements with rounded numbers and escaped text.

use nalgebra::Point2;
use svg::Node as _;
use svg::node::Text;
use svg::node::element::Element;

/// How a shape is painted.
#[derive(Debug, Clone, Copy)]
pub struct Ink<'a> {
    /// Colour of the inside; `none` for none.
    pub fill: &'a str,
    /// Opacity of the inside, 0 to 1.
    pub opacity: f64,
    /// Colour of the line; `none` for none.
    pub line: &'a str,
    /// Width of the line in page units.
    pub width: f64,
    /// Dashes and gaps in page units; empty for a full line.
    pub dash: &'a str,
}

impl<'a> Ink<'a> {
    /// An opaque inside without a line.
    pub fn filled(fill: &'a str) -> Self {
        Self { fill, opacity: 1.0, line: "none", width: 0.0, dash: "" }
    }

    /// A line without an inside.
    pub fn lined(line: &'a str, width: f64) -> Self {
        Self { fill: "none", opacity: 1.0, line, width, dash: "" }
    }

    /// The same with this opacity of the inside.
    #[must_use]
    pub fn opacity(self, opacity: f64) -> Self {
        Self { opacity, ..self }
    }

    /// The same with a line.
    #[must_use]
    pub fn line(self, line: &'a str, width: f64) -> Self {
        Self { line, width, ..self }
    }

    /// The same with a dashed line.
    #[must_use]
    pub fn dash(self, dash: &'a str) -> Self {
        Self { dash, ..self }
    }

    fn paint(&self, element: &mut Element) {
        element.assign("fill", self.fill);
        if self.fill != "none" && self.opacity < 1.0 {
            element.assign("fill-opacity", rounded(self.opacity));
        }
        if self.line != "none" {
            element.assign("stroke", self.line);
            element.assign("stroke-width", rounded(self.width));
            element.assign("stroke-linejoin", "round");
            element.assign("stroke-linecap", "round");
        }
        if !self.dash.is_empty() {
            element.assign("stroke-dasharray", self.dash);
            element.assign("stroke-linecap", "butt");
        }
    }
}

/// A number with two decimals at most and no negative zero.
pub fn rounded(value: f64) -> f64 {
    (value * 100.0).round() / 100.0 + 0.0
}

/// A closed polygon.
pub fn polygon(points: &[Point2<f64>], ink: &Ink<'_>) -> Element {
    with_points("polygon", points, ink)
}

/// An open line through points.
pub fn polyline(points: &[Point2<f64>], ink: &Ink<'_>) -> Element {
    with_points("polyline", points, ink)
}

fn with_points(name: &str, points: &[Point2<f64>], ink: &Ink<'_>) -> Element {
    let list: Vec<String> = points.iter().map(|p| format!("{},{}", rounded(p.x), rounded(p.y))).collect();
    let mut element = Element::new(name);
    element.assign("points", list.join(" "));
    ink.paint(&mut element);
    element
}

/// A circle.
pub fn circle(centre: &Point2<f64>, radius: f64, ink: &Ink<'_>) -> Element {
    let mut element = Element::new("circle");
    element.assign("cx", rounded(centre.x));
    element.assign("cy", rounded(centre.y));
    element.assign("r", rounded(radius));
    ink.paint(&mut element);
    element
}

/// A rectangle from its top left corner, with rounded corners.
pub fn rectangle(corner: &Point2<f64>, width: f64, height: f64, radius: f64, ink: &Ink<'_>) -> Element {
    let mut element = Element::new("rect");
    element.assign("x", rounded(corner.x));
    element.assign("y", rounded(corner.y));
    element.assign("width", rounded(width));
    element.assign("height", rounded(height));
    if radius > 0.0 {
        element.assign("rx", rounded(radius));
    }
    ink.paint(&mut element);
    element
}

/// Where a text is fastened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its start.
    Start,
    /// At its middle.
    Middle,
    /// At its end.
    End,
}

/// One line of text whose baseline starts, is centred or ends at `at`.
pub fn text(at: &Point2<f64>, size: f64, colour: &str, anchor: Anchor, content: &str) -> Element {
    let mut element = Element::new("text");
    element.assign("x", rounded(at.x));
    element.assign("y", rounded(at.y));
    element.assign("font-size", rounded(size));
    element.assign("fill", colour);
    match anchor {
        Anchor::Start => {}
        Anchor::Middle => element.assign("text-anchor", "middle"),
        Anchor::End => element.assign("text-anchor", "end"),
    }
    element.append(Text::new(clean(content)));
    element
}

/// Draws the text again in white behind itself, so that it can be read on any ground.
pub fn haloed(mut element: Element) -> Element {
    element.assign("paint-order", "stroke");
    element.assign("stroke", "#ffffff");
    element.assign("stroke-width", 3);
    element.assign("stroke-linejoin", "round");
    element
}

/// The same text in bold.
pub fn bold(mut element: Element) -> Element {
    element.assign("font-weight", "bold");
    element
}

/// A group with a tip that browsers show under the pointer.
pub fn group(tip: &str) -> Element {
    let mut element = Element::new("g");
    if !tip.is_empty() {
        let mut title = Element::new("title");
        title.append(Text::new(clean(tip)));
        element.append(title);
    }
    element
}

/// Width of a text in page units, roughly.
pub fn text_width(content: &str, size: f64) -> f64 {
    content.chars().count() as f64 * size * 0.54
}

/// Breaks a text into lines of about `width` page units, at spaces.
pub fn wrapped(content: &str, size: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in content.split_whitespace() {
        match lines.last_mut() {
            Some(line) if text_width(line, size) + text_width(word, size) + size * 0.54 <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// The text without characters that XML forbids.
pub fn clean(content: &str) -> String {
    content.chars().map(|c| if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_text_is_escaped() {
        let ink = Ink::filled("red").opacity(1.0 / 3.0).line("blue", 1.0).dash("2 1");
        let drawn = polygon(&[Point2::new(1.0 / 3.0, -0.001), Point2::new(2.0, 3.0)], &ink).to_string();
        assert!(drawn.contains("points=\"0.33,0 2,3\""), "{drawn}");
        assert!(drawn.contains("fill-opacity=\"0.33\"") && drawn.contains("stroke-dasharray=\"2 1\""));
        let written = text(&Point2::origin(), 12.0, "black", Anchor::Middle, "a<b>&\u{0}c").to_string();
        assert!(written.contains(">a&lt;b&gt;&amp; c</text>"), "{written}");
    }

    #[test]
    fn long_texts_are_wrapped_at_spaces() {
        let lines = wrapped("one two three four", 10.0, 50.0);
        assert_eq!(lines, ["one two", "three", "four"]);
        assert_eq!(wrapped("unbreakable", 10.0, 1.0), ["unbreakable"]);
        assert!(wrapped("  ", 10.0, 50.0).is_empty());
    }
}
