//! Lengths that the planner fits to the room.

use darrt_primitives::error::PrimitiveError;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};

/// A length in metres that the planner fits to the room: `[least, wanted]`, or the wanted one alone, of which half will do.
///
/// The planner tries the wanted length first and shorter ones, down to the least, where something is in the way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(from = "Written", into = "[f64; 2]")]
pub struct LengthRange {
    /// The least that will do.
    pub least_m: f64,
    /// The best length.
    pub wanted_m: f64,
}

/// What a file may say.
#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a length or `[least, wanted]`")]
enum Written {
    /// The wanted length; half of it will do.
    Wanted(f64),
    /// The least length and the wanted one.
    Range([f64; 2]),
}

impl LengthRange {
    /// From the least length to the wanted one.
    pub const fn new(least_m: f64, wanted_m: f64) -> Self {
        Self { least_m, wanted_m }
    }

    /// This length, of which half will do.
    pub const fn wanted(wanted_m: f64) -> Self {
        Self { least_m: wanted_m / 2.0, wanted_m }
    }

    /// The same for the planner.
    ///
    /// # Errors
    /// When a length is negative or not finite, or the least one is above the wanted one.
    pub fn planned(self) -> Result<darrt_primitives::length_range::LengthRange, PrimitiveError> {
        darrt_primitives::length_range::LengthRange::new(self.least_m, self.wanted_m)
    }
}

impl From<Written> for LengthRange {
    fn from(written: Written) -> Self {
        match written {
            Written::Wanted(wanted_m) => Self::wanted(wanted_m),
            Written::Range([least_m, wanted_m]) => Self { least_m, wanted_m },
        }
    }
}

impl From<LengthRange> for [f64; 2] {
    fn from(range: LengthRange) -> Self {
        [range.least_m, range.wanted_m]
    }
}

impl JsonSchema for LengthRange {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "LengthRange".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut schema = Written::json_schema(generator);
        let text = "A length in metres that the planner fits to the room: `[least, wanted]`, or the wanted one alone, of \
                    which half will do.";
        schema.insert("description".to_owned(), text.into());
        schema
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<LengthRange, String> {
        #[derive(Deserialize)]
        struct Line {
            length: LengthRange,
        }
        toml::from_str(&format!("length = {text}")).map(|line: Line| line.length).map_err(|error| error.to_string())
    }

    #[test]
    fn a_number_is_what_is_wanted_and_half_of_it_will_do() {
        assert_eq!(read("0.1"), Ok(LengthRange::new(0.05, 0.1)));
        assert_eq!(read("1"), Ok(LengthRange::new(0.5, 1.0)));
        assert_eq!(read("[0.02, 0.1]"), Ok(LengthRange::new(0.02, 0.1)));
        for wrong in ["[0.1]", "[0.1, 0.2, 0.3]", "\"long\"", "{ least = 0.1 }"] {
            let said = read(wrong).unwrap_err();
            assert!(said.contains("a length or `[least, wanted]`"), "{wrong}: {said}");
        }
    }

    #[test]
    fn what_is_written_is_read_again() {
        let range = LengthRange::new(0.02, 0.1);
        let text = serde_json::to_string(&range).unwrap();
        assert_eq!(text, "[0.02,0.1]");
        assert_eq!(serde_json::from_str::<LengthRange>(&text).unwrap(), range);
    }
}
