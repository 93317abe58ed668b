//! What the builder makes is what was asked for.

#![allow(clippy::unwrap_used, reason = "a test says no more than that it failed")]

use darrt_core::space::ComponentSpace as _;
use darrt_core::validity::Validity as _;

use super::*;
use crate::testing::gantry::{Gantry, motion};

fn room() -> TabletopBuilder<Gantry> {
    let arm = motion::pointing_down(0.0, 0.0, 1.4, 0.0);
    TabletopBuilder::new(Gantry::new().unwrap(), Configuration { base: [-1.0, 0.0, 0.0], arm })
}

fn tin() -> Movable {
    Movable::new("tin", Shape::cylinder(0.04, 0.05).unwrap()).unwrap()
}

#[test]
fn what_is_put_on_a_table_stands_on_it_and_touches_only_it() {
    let only = Movable { surfaces: [SurfaceId::new(1)].into_iter().collect(), ..tin() };
    let other = Movable { surfaces: smallvec::SmallVec::new(), ..Movable::of_body(only.body.clone()) };
    let other = Movable { body: Body { name: "box".into(), ..other.body.clone() }, ..other };
    let (world, state) = room()
        .table("left", [-0.5, 0.0], [0.8, 1.2], 0.7)
        .table("right", [0.5, 0.0], [0.8, 1.2], 0.5)
        .object(only, "right", [0.5, 0.2], 1.0)
        .object(other, "left", [-0.5, -0.2], 0.0)
        .build()
        .unwrap();
    assert_eq!(world.movables().iter().map(|m| m.surfaces.len()).collect::<Vec<_>>(), [1, 2]);
    for (index, height_m) in [0.5, 0.7].into_iter().enumerate() {
        let id = darrt_core::state::ObjectId::new(index);
        assert!((state.objects[index].translation.z - height_m - 0.05).abs() < 1e-12);
        assert!(world.objects()[index].poses().contains(&state.objects[index]));
        let under = world.surface_under(id, &state.objects[index], 1e-9);
        assert_eq!(under, Some(SurfaceId::new(1 - index)));
    }
    let validity = crate::validity::SceneValidity::new(&world);
    let free = validity.check(&world, &state, &crate::mode::Contacts::default());
    assert!(free.is_ok(), "{free:?}");
}

#[test]
fn the_first_error_is_said() {
    let said = |builder: TabletopBuilder<Gantry>| builder.build().unwrap_err().to_string();
    let table = |b: TabletopBuilder<Gantry>| b.table("left", [0.0; 2], [0.8, 1.2], 0.7);
    let text = said(table(room()).object(tin(), "rihgt", [0.0; 2], 0.0).object(tin(), "other", [0.0; 2], 0.0));
    assert_eq!(text, "there is no surface named \"rihgt\"");
    assert!(said(room().table("left", [0.0; 2], [0.8, -1.2], 0.7)).contains('-'));
    let twice = table(room()).object(tin(), "left", [0.0; 2], 0.0).object(tin(), "left", [0.3, 0.0], 0.0);
    assert!(said(twice).contains("tin"));
    assert!(said(table(table(room()))).contains("left"));
}
