//! What is said at the end: a table, warnings, and the broken laws.

use std::fmt;

use crate::laws::Broken;

/// What became of one subject.
#[derive(Debug, Clone, PartialEq)]
pub enum Verdict {
    /// Every law that was looked at holds.
    Holds,
    /// A law is broken.
    Broken(Box<Broken>),
    /// Nothing could be looked at: why.
    NotTried(String),
}

/// One subject and what was found out about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The subject.
    pub subject: String,
    /// How many laws were looked at.
    pub laws: usize,
    /// In how many cases.
    pub cases: u64,
    /// What came out.
    pub verdict: Verdict,
    /// What is no broken law, but should make one think.
    pub warnings: Vec<String>,
    /// The case that shows the broken law; `None` if it shows when all of them are seen together.
    pub case: Option<u64>,
}

/// `-ln(0.05)`: with so many times `1 / rate` cases a fault of this rate is missed once in twenty times.
const CONFIDENCE: f64 = 2.995_732_273_553_991;

impl Row {
    pub(super) fn new(subject: impl Into<String>, laws: usize) -> Self {
        let subject = subject.into();
        Self { subject, laws, cases: 0, verdict: Verdict::Holds, warnings: Vec::new(), case: None }
    }

    pub(super) fn broken(subject: impl Into<String>, broken: Broken) -> Self {
        Self { verdict: Verdict::Broken(Box::new(broken)), ..Self::new(subject, 1) }
    }

    pub(super) fn warn(&mut self, warning: impl Into<String>) {
        self.warnings.push(warning.into());
    }

    /// Faults that show in one of so many cases, or more often, were found with 95 % confidence; rarer ones may have been
    /// missed. `None` for no cases.
    pub fn found_one_in(&self) -> Option<f64> {
        (self.cases > 0).then(|| (self.cases as f64 / CONFIDENCE).max(1.0))
    }
}

/// What was found out about everything.
#[derive(Clone, PartialEq)]
pub struct Report {
    /// Rows in the order in which the subjects were looked at.
    pub rows: Vec<Row>,
    /// What the inputs were drawn with.
    pub seed: u64,
    /// How often everything was looked at.
    pub rounds: u64,
}

impl Report {
    pub(super) fn new(seed: u64) -> Self {
        Self { rows: Vec::new(), seed, rounds: 1 }
    }

    pub(super) fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    /// Adds what another round found out.
    pub(super) fn merge(&mut self, other: Self) {
        self.rounds += other.rounds;
        for row in other.rows {
            match self.rows.iter_mut().find(|known| known.subject == row.subject) {
                Some(known) => {
                    known.cases += row.cases;
                    known.case = row.case;
                    // What was never seen in one round may have been seen in another.
                    known.warnings.retain(|warning| row.warnings.contains(warning));
                    known.verdict = row.verdict;
                }
                None => self.rows.push(row),
            }
        }
    }

    /// Is no law broken?
    pub fn holds(&self) -> bool {
        self.broken().next().is_none()
    }

    /// The broken laws.
    pub fn broken(&self) -> impl Iterator<Item = &Broken> {
        self.rows.iter().filter_map(|row| match &row.verdict {
            Verdict::Broken(broken) => Some(&**broken),
            _ => None,
        })
    }

    /// All warnings, each with its subject.
    pub fn warnings(&self) -> impl Iterator<Item = (&str, &str)> {
        self.rows.iter().flat_map(|row| row.warnings.iter().map(|warning| (&*row.subject, &**warning)))
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wide = self.rows.iter().map(|row| row.subject.len()).max().unwrap_or(0).clamp(8, 40);
        writeln!(f, "{:<wide$}  {:>4}  {:>6}  {:<24}  would still be missed", "subject", "laws", "cases", "verdict")?;
        for row in &self.rows {
            let verdict = match &row.verdict {
                Verdict::Holds => "holds".to_owned(),
                Verdict::Broken(broken) => format!("BROKEN {}", broken.name()),
                Verdict::NotTried(why) => format!("not tried: {why}"),
            };
            let missed = match (&row.verdict, row.found_one_in()) {
                (Verdict::Holds, Some(rate)) => format!("faults rarer than 1 in {rate:.0} cases"),
                _ => String::new(),
            };
            let line = format!("{:<wide$}  {:>4}  {:>6}  {verdict:<24}  {missed}", row.subject, row.laws, row.cases);
            writeln!(f, "{}", line.trim_end())?;
        }
        let rounds = if self.rounds > 1 { format!(", {} rounds", self.rounds) } else { String::new() };
        writeln!(f, "seed {}{rounds}; each \"missed\" at 95 % confidence", self.seed)?;
        for (subject, warning) in self.warnings() {
            writeln!(f, "warning: {subject}: {warning}")?;
        }
        for row in &self.rows {
            if let Verdict::Broken(broken) = &row.verdict {
                writeln!(f, "\n{}: {}", row.subject, shortened(&broken.to_string()))?;
                match row.case {
                    Some(case) => writeln!(f, "  again:   .only({:?}, {case})", row.subject)?,
                    None => writeln!(f, "  again:   .only({:?}, None)", row.subject)?,
                }
            }
        }
        Ok(())
    }
}

/// Lines are cut: a report fits a screen, and `again` shows the case in all its length.
fn shortened(text: &str) -> String {
    const MOST: usize = 400;
    let line = |line: &str| match line.char_indices().nth(MOST) {
        Some((at, _)) => format!("{} ...", line.get(..at).unwrap_or(line)),
        None => line.to_owned(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

// A test that returns the report as its error prints it like this.
impl fmt::Debug for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

impl std::error::Error for Report {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::space;

    #[test]
    fn a_table_of_one_line_each_and_the_broken_laws_below() {
        let mut report = Report::new(3);
        report.push(Row { cases: 300, ..Row::new("robot", 20) });
        report.push(Row { case: Some(7), ..Row::broken("cart", Broken::new(space::SELF, "1.0", "0.0")) });
        let text = report.to_string();
        assert!(
            text.contains("robot       20     300  holds                     faults rarer than 1 in 100 cases"),
            "{text}"
        );
        assert!(text.contains("BROKEN space.self") && text.contains(".only(\"cart\", 7)"), "{text}");
        assert!(!report.holds() && format!("{report:?}").contains("BROKEN"));
    }

    #[test]
    fn rounds_add_up() {
        let row = |cases, warning: &str| {
            let mut row = Row { cases, ..Row::new("robot", 20) };
            row.warn(warning);
            row
        };
        let (mut report, mut other) = (Report::new(0), Report::new(1));
        report.push(row(10, "never"));
        other.push(row(20, "often"));
        report.merge(other);
        assert_eq!((report.rows[0].cases, report.rounds, report.warnings().count()), (30, 2, 0));
    }
}
