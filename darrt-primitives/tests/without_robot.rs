//! The rules for the objects alone: they never blame the robot, and say of the objects what all rules say.
#![cfg(feature = "testing")]
#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use std::cell::Cell;
use std::sync::Arc;

use darrt_core::domain::Domain;
use darrt_core::motion::{Instance, Straight};
use darrt_core::primitive::PrimitiveId;
use darrt_core::space::ComponentSpace;
use darrt_core::state::{ComponentSet, State};
use darrt_core::testing::strategies::{config, configs};
use darrt_core::validity::{Blame, BlockKind, FreePrefix, Validity};
use darrt_primitives::mode::Contacts;
use darrt_primitives::testing::strategies::{any_mode, resting};
use darrt_primitives::testing::table::{Table, honest_table};
use darrt_primitives::validity::SceneValidity;
use proptest::prelude::*;

const REGRESSIONS: Option<&str> = Some("tests/regressions/without_robot.txt");

fn rules(m: &Table) -> (SceneValidity, Arc<dyn Validity<Table>>) {
    let all = SceneValidity::new(m);
    let alone = Validity::<Table>::without_robot(&all).unwrap();
    (all, alone)
}

/// Is it an object that breaks the rule, against no part of the robot?
fn blames_object(m: &Table, blame: &Blame) -> bool {
    let is_object = |name: &str| m.movables().iter().any(|movable| &*movable.body.name == name);
    let kinds = [BlockKind::ObjectFixed, BlockKind::ObjectObject, BlockKind::OffSupport, BlockKind::Limits];
    kinds.contains(&blame.kind) && (is_object(&blame.first) || is_object(&blame.second))
}

#[test]
fn what_breaks_them_breaks_all_rules_and_is_an_object() {
    let m = honest_table().unwrap();
    let (all, alone) = rules(&m);
    let relaxed = m.without_robot().unwrap();
    proptest!(config(256, REGRESSIONS), |(state in any_mode(&m))| {
        let contacts = Contacts::default();
        let broken = alone.check(&m, &state, &contacts).err();
        prop_assert!(broken.as_ref().is_none_or(|blame| blames_object(&m, blame)), "{broken:?}");
        if broken.is_some() {
            prop_assert!(all.check(&m, &state, &contacts).is_err());
        }
        // What primitives ask about.
        let asked = relaxed.collision_scene().check(m.manipulator(), &state, &contacts).err();
        prop_assert!(asked.as_ref().is_none_or(|blame| blames_object(&m, blame)), "{asked:?}");
        prop_assert!(relaxed.collision_scene().is_base_clear(m.manipulator(), &state.robot));
    });
}

#[test]
fn the_place_of_the_robot_is_no_matter_to_objects_that_rest() {
    let m = honest_table().unwrap();
    let (all, alone) = rules(&m);
    let robots = (configs(m.robot()), configs(m.robot()));
    let agreed = [Cell::new(0), Cell::new(0)];
    proptest!(config(256, REGRESSIONS), |(state in resting(&m), (a, b) in robots)| {
        let contacts = Contacts::default();
        let verdict = alone.check(&m, &state, &contacts);
        for robot in [&a, &b] {
            let elsewhere = State { robot: *robot, ..state.clone() };
            prop_assert_eq!(&alone.check(&m, &elsewhere, &contacts), &verdict);
            // Unless the robot is at fault, all rules say the same of the objects.
            let whole = all.check(&m, &elsewhere, &contacts);
            if whole.as_ref().err().is_none_or(|blame| blames_object(&m, blame)) {
                prop_assert_eq!(whole.is_ok(), verdict.is_ok());
                let count = &agreed[usize::from(verdict.is_ok())];
                count.set(count.get() + 1);
            }
        }
        if verdict.is_ok() {
            let from = State { robot: a, ..state.clone() };
            let length = m.robot().distance(&a, &b);
            let through = Instance {
                primitive: PrimitiveId::new(10, "Through"),
                motion: Box::new(Straight::new(from.clone(), b, length)),
                contacts,
                moves: ComponentSet::ROBOT,
                object: None,
                reversible: true,
            };
            prop_assert_eq!(alone.free_prefix(&m, &through, &from), FreePrefix::FREE);
        }
    });
    assert!(agreed.iter().all(|count| count.get() > 0), "{agreed:?}");
}
