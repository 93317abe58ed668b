//! Plan files: refused, or the same plan again when written.
#![no_main]

use darrt_fuzz::text::text;
use darrt_task::plan_file::PlanFile;
use libfuzzer_sys::fuzz_target;

const PLAN: &str = include_str!("../seeds/plan_reader/wave.json");

fuzz_target!(|data: &[u8]| {
    let Ok(plan) = PlanFile::from_json(&text(data, &[PLAN]), "fuzz.json") else { return };
    let text = plan.to_json().expect("JSON has finite numbers only");
    let again = PlanFile::from_json(&text, "again.json").unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(again, plan);
    assert_eq!(again.to_json().expect("as before"), text);
});
