//! Options that change what a problem says about safety, and the words for it.

use clap::Args;

use super::exit::Failure;
use darrt_task::problem_file::{LengthRange, ProblemFile, Safety};
use darrt_task::verify::Warning;

/// Of the warnings about a plan so many are printed with it.
const NOTICES: usize = 6;

/// Margins in the place of those of the problem.
#[derive(Debug, Clone, Default, Args)]
#[command(next_help_heading = "Safety (instead of what the problem says)")]
pub struct SafetyOptions {
    /// Wanted distance of the robot, and of what it holds, from everything else
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub margin: Option<f64>,
    /// Wanted distance of a pushed object from other things
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub object_margin: Option<f64>,
    /// Least distance of whatever need not be near
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub least_margin: Option<f64>,
    /// Least distance of hand and handled object from that and from what carries it
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub contact_margin: Option<f64>,
    /// How far inside the edges of surfaces objects are set down and pushed
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub edge_margin: Option<f64>,
    /// How far behind an object the hand comes down to push it; half of it will do
    #[arg(long, value_name = "METRES", allow_hyphen_values = true)]
    pub standoff: Option<f64>,
    /// How far any object may lean while it is carried
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub max_tilt: Option<f64>,
}

impl SafetyOptions {
    /// `problem` with these; `name` is what the user called it.
    ///
    /// # Errors
    /// Bad input for a number that the problem may not have.
    pub(crate) fn applied(&self, mut problem: ProblemFile, name: &str) -> Result<ProblemFile, Failure> {
        let safety = &mut problem.safety;
        let changes = [
            (&mut safety.robot_margin_m, self.margin),
            (&mut safety.held_margin_m, self.margin),
            (&mut safety.object_margin_m, self.object_margin),
            (&mut safety.least_margin_m, self.least_margin),
            (&mut safety.contact_margin_m, self.contact_margin),
            (&mut safety.edge_margin_m, self.edge_margin),
        ];
        for (slot, value) in changes {
            *slot = value.unwrap_or(*slot);
        }
        if let Some(wanted_m) = self.standoff {
            problem.push.standoff_m = LengthRange::wanted(wanted_m);
        }
        if self.max_tilt.is_some() {
            problem.objects.iter_mut().for_each(|object| object.max_tilt_deg = self.max_tilt);
        }
        problem.validate(&format!("{name} with the options given"))?;
        Ok(problem)
    }
}

/// The margins in one line.
pub(crate) fn margins(problem: &ProblemFile) -> String {
    let Safety { robot_margin_m, held_margin_m, object_margin_m, least_margin_m, contact_margin_m, edge_margin_m } =
        problem.safety;
    let [robot, held, object, least, contact, edge] =
        [robot_margin_m, held_margin_m, object_margin_m, least_margin_m, contact_margin_m, edge_margin_m]
            .map(|metres| (metres * 1e5).round() / 100.0);
    format!(
        "margins:  robot {robot} mm, held object {held}, pushed object {object}, least {least}, at work {contact}; edges {edge}"
    )
}

/// The first warnings, and how many more there are; nothing if there are none.
pub(crate) fn notices(warnings: &[Warning]) -> String {
    let mut lines: Vec<String> = warnings.iter().take(NOTICES).map(|warning| format!("notice:   {warning}")).collect();
    if warnings.len() > NOTICES {
        lines.push(format!("notice:   and {} more, which `darrt check` tells", warnings.len() - NOTICES));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use darrt_pr2::problems::builtin;
    use darrt_task::verify::WarningKind;

    #[test]
    fn options_take_the_place_of_what_the_problem_says() {
        let problem = builtin("plate3").unwrap();
        assert_eq!(SafetyOptions::default().applied(problem.clone(), "plate3").unwrap(), problem);
        let options = SafetyOptions { margin: Some(0.03), max_tilt: Some(20.0), ..SafetyOptions::default() };
        let changed = options.applied(problem.clone(), "plate3").unwrap();
        assert_eq!((changed.safety.robot_margin_m, changed.safety.held_margin_m), (0.03, 0.03));
        assert_eq!(changed.safety.least_margin_m, problem.safety.least_margin_m);
        assert!(changed.objects.iter().all(|object| object.max_tilt_deg() == 20.0));
        let options = SafetyOptions { margin: Some(0.001), ..SafetyOptions::default() };
        let message = options.applied(problem, "plate3").unwrap_err().message;
        assert!(message.contains("safety.robot_margin_m") && message.contains("0.001"), "{message}");
    }

    #[test]
    fn few_notices_are_printed_and_the_rest_counted() {
        let warning =
            Warning { kind: WarningKind::Turning, step: None, bodies: Vec::new(), found: 400.0, wanted: 360.0 };
        let text = notices(&vec![warning; NOTICES + 2]);
        assert!(
            text.lines().count() == NOTICES + 1 && text.ends_with("and 2 more, which `darrt check` tells"),
            "{text}"
        );
        assert_eq!(notices(&[]), "");
    }
}
