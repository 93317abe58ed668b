//! The page that lists every law with the faults it catches is up to date. To write it anew:
//! `DARRT_UPDATE_PAGES=1 cargo test -p darrt-core --features testing --test tests laws_page`.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_core::laws;
use darrt_core::testing::broken::{cases, page};

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/laws.md");

#[test]
fn the_page_lists_every_law_with_what_it_catches() {
    let groups: [(&str, &[&'static str]); 15] = [
        ("Every call", laws::watch::LAWS),
        ("Component spaces: `check_component_space`, `check_space_covers`, `check_covering`", laws::space::LAWS),
        ("Domains: `check_domain`", laws::domain::LAWS),
        ("Targets: `check_partial`", laws::partial::LAWS),
        ("Distances: `check_distance`, `check_metric`, `check_lower_bound`, `check_not_above`", laws::distance::LAWS),
        ("The nearest node: `check_nearest`", laws::nearest::LAWS),
        ("Motions and instances: `check_motion`, `check_instance`", laws::motion::LAWS),
        ("Primitives: `check_primitive`, `try_primitive`, `check_contacts`", laws::primitive::LAWS),
        (
            "Validities: `check_validity`, `check_by_oracle`, `check_against_oracle`, `check_enlarged`",
            laws::validity::LAWS,
        ),
        ("Goals: `check_goal`", laws::goal::LAWS),
        ("Samplers: `check_sampler`, `check_sampler_covers`", laws::sampler::LAWS),
        ("Verifiers: `check_verifier`, `check_ways`", laws::verifier::LAWS),
        ("Ways around: `check_local_repair`", laws::local_repair::LAWS),
        ("Costs: `check_cost`", laws::cost::LAWS),
        ("The planner: `check_planner`, `check_accounts`, `check_cancel`", laws::planner::LAWS),
    ];
    let listed: usize = groups.iter().map(|(_, laws)| laws.len()).sum();
    assert_eq!(listed, laws::all().count());
    let text = page("Every law with the faults it catches", &groups, &cases());
    if std::env::var_os("DARRT_UPDATE_PAGES").is_some() {
        std::fs::write(FILE, &text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(FILE).unwrap(), text, "DARRT_UPDATE_PAGES=1 writes it anew");
}
