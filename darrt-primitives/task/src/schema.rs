//! The published JSON Schemas of problem files, plan files and diagnoses, derived from the types so that they cannot say anything
//! else; unknown keys are forbidden everywhere.
//!
//! Editors use them to complete and check files, TOML and JSON alike.

use schemars::JsonSchema;
use serde_json::Value;

/// The JSON Schema of the file format `T`: [`ProblemFile`](crate::problem_file::ProblemFile),
/// [`Diagnosis`](crate::diagnosis::Diagnosis) or
/// [`PlanFile`](crate::plan_file::PlanFile).
pub fn schema<T: JsonSchema>() -> Value {
    let mut schema = schemars::schema_for!(T).to_value();
    crate::problem_file::ranges::write(&mut schema);
    schema
}

/// The text of a schema as it is published in the folder `schemas`, with a final newline.
///
/// # Errors
/// Never in practice: a schema has string keys and finite numbers only.
pub fn schema_text<T: JsonSchema>() -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(&schema::<T>()).map(|text| text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Diagnosis;
    use crate::plan_file::PlanFile;
    use crate::problem_file::ProblemFile;
    use crate::robot_file::RobotFile;

    /// Set to rewrite the published schemas instead of comparing with them.
    const UPDATE: &str = "DARRT_UPDATE_SCHEMAS";

    fn check_published<T: JsonSchema>(name: &str) {
        let path = format!("{}/schemas/{name}.schema.json", env!("CARGO_MANIFEST_DIR"));
        let text = schema_text::<T>().unwrap();
        if std::env::var_os(UPDATE).is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let published = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(published == text, "{path} is stale: run the tests with {UPDATE}=1 and review the change");
    }

    #[test]
    fn the_published_schemas_are_up_to_date() {
        check_published::<ProblemFile>("problem");
        check_published::<PlanFile>("plan");
        check_published::<RobotFile>("robot");
        check_published::<Diagnosis>("diagnosis");
    }

    fn check_closed(value: &Value, path: &str) {
        match value {
            Value::Object(table) => {
                if table.contains_key("properties") {
                    assert_eq!(table.get("additionalProperties"), Some(&Value::Bool(false)), "{path}");
                }
                table.iter().for_each(|(key, value)| check_closed(value, &format!("{path}/{key}")));
            }
            Value::Array(values) => values.iter().for_each(|value| check_closed(value, path)),
            _ => {}
        }
    }

    #[test]
    fn unknown_keys_are_forbidden_everywhere() {
        check_closed(&schema::<ProblemFile>(), "problem");
        check_closed(&schema::<PlanFile>(), "plan");
        check_closed(&schema::<RobotFile>(), "robot");
        check_closed(&schema::<Diagnosis>(), "diagnosis");
    }
}
