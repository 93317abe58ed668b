//! The published JSON Schema of the problem format, derived from the types so that it cannot say anything else.

use serde_json::Value;

use crate::problem_file::ProblemFile;

/// The JSON Schema of a problem file; unknown keys are forbidden everywhere.
///
/// Editors use it to complete and check problem files, TOML and JSON alike.
pub fn problem_schema() -> Value {
    schemars::schema_for!(ProblemFile).to_value()
}

/// The text of the schema as it is published in `schemas/problem.schema.json`, with a final newline.
///
/// # Errors
/// Never in practice: a schema has string keys and finite numbers only.
pub fn problem_schema_text() -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(&problem_schema()).map(|text| text + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Set to rewrite the published schema instead of comparing with it.
    const UPDATE: &str = "DARRT_UPDATE_SCHEMAS";

    #[test]
    fn the_published_schema_is_up_to_date() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/schemas/problem.schema.json");
        let text = problem_schema_text().unwrap();
        if std::env::var_os(UPDATE).is_some() {
            std::fs::write(path, &text).unwrap();
        }
        let published = std::fs::read_to_string(path).unwrap_or_default();
        assert!(published == text, "{path} is stale: run the tests with {UPDATE}=1 and review the change");
    }

    #[test]
    fn unknown_keys_are_forbidden_in_every_table() {
        fn walk(value: &Value, path: &str) {
            match value {
                Value::Object(table) => {
                    if table.contains_key("properties") {
                        assert_eq!(table.get("additionalProperties"), Some(&Value::Bool(false)), "{path}");
                    }
                    table.iter().for_each(|(key, value)| walk(value, &format!("{path}/{key}")));
                }
                Value::Array(values) => values.iter().for_each(|value| walk(value, path)),
                _ => {}
            }
        }
        walk(&problem_schema(), "");
    }
}
