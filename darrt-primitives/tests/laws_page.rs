//! The page that lists every law of this crate with the faults it catches is up to date. To write it anew:
//! `DARRT_UPDATE_PAGES=1 cargo test -p darrt-primitives --test tests laws_page`.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_core::testing::broken::page;
use darrt_primitives::laws;
use darrt_primitives::testing::broken::cases;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/laws.md");

#[test]
fn the_page_lists_every_law_with_what_it_catches() {
    let groups: [(&str, &[&'static str]); 4] = [
        ("Robots: `check_manipulator`, `check_reaches`, `check_joint_vector`", laws::manipulator::LAWS),
        ("Jacobians: `check_jacobian`, `check_chain`", laws::jacobian::LAWS),
        ("Grasps: `check_grasps`", laws::grasp::LAWS),
        ("Instances at tables: `check_tabletop`, `check_finger_contacts`, `check_contracts`", laws::tabletop::LAWS),
    ];
    let listed: usize = groups.iter().map(|(_, laws)| laws.len()).sum();
    assert_eq!(listed, laws::all().count());
    let text = page("Every law of robots, grasps and instances at tables", &groups, &cases());
    if std::env::var_os("DARRT_UPDATE_PAGES").is_some() {
        std::fs::create_dir_all(std::path::Path::new(FILE).parent().unwrap()).unwrap();
        std::fs::write(FILE, &text).unwrap();
    }
    assert_eq!(std::fs::read_to_string(FILE).unwrap(), text, "DARRT_UPDATE_PAGES=1 writes it anew");
}
