//! What a primitive says of itself to a registry.

use std::collections::BTreeSet;

use darrt_core::laws::watch::{entering, watched};
use darrt_core::laws::{Broken, ensure, equal};
use darrt_core::primitive::{Primitive, PrimitiveId};

use super::{CONTRACT, NAMED, SETTINGS};
use crate::registry::TaskPrimitive;
use crate::robot::TaskRobot;

/// No primitive has this setting.
const NO_KEY: &str = "no_setting_of_this_name";
/// Where a registry may put it.
const PLACES: [u16; 2] = [8, 11];

/// All laws of how a primitive is registered. What it does is a matter of
/// [`check_primitive`](darrt_core::laws::check_primitive) and [`check_contracts`](darrt_primitives::laws::check_contracts).
///
/// # Errors
/// The first law that is [`Broken`].
pub fn check_task_primitive<M: TaskRobot, P: TaskPrimitive<M>>() -> Result<(), Broken> {
    let about = || format!("check_task_primitive::<_, {}>()", P::NAME);
    watched(&about, run::<M, P>).map_err(|broken| broken.replayed_by(about))
}

fn run<M: TaskRobot, P: TaskPrimitive<M>>() -> Result<(), Broken> {
    let is_name = |name: &str| !name.is_empty() && !name.contains(char::is_whitespace);
    ensure(NAMED, is_name(P::NAME), || format!("{:?}", P::NAME), "a name without blanks")?;
    let needs: BTreeSet<_> = P::NEEDS.iter().collect();
    let holds = needs.len() == P::NEEDS.len() && !needs.contains(&P::NAME) && P::NEEDS.iter().all(|name| is_name(name));
    ensure(NAMED, holds, || format!("needs {:?}", P::NEEDS), "names of other primitives, each once")?;
    let flaw = P::CONTRACT.flaw();
    ensure(CONTRACT, flaw.is_none(), || flaw.unwrap_or_default().to_owned(), "a contract that can be kept")?;
    let refused = |why: String| Broken::new(SETTINGS, why, "a primitive");
    for place in PLACES {
        let id = PrimitiveId::new(place, P::NAME);
        entering("new");
        let primitive = P::new(id, P::Settings::default()).map_err(|why| refused(why).of("default settings"))?;
        let found = Primitive::id(&primitive);
        equal(NAMED, &(found.index(), found.name()), &(id.index(), id.name())).map_err(|broken| broken.of("id"))?;
        equal(NAMED, &primitive.name(), &P::NAME).map_err(|broken| broken.of("name"))?;
    }
    let read = |text: &str| serde_json::from_str::<P::Settings>(text).map_err(|error| error.to_string());
    let empty = read("{}").and_then(|settings| P::new(PrimitiveId::new(PLACES[0], P::NAME), settings).map(|_| ()));
    empty.map_err(|why| refused(why).of("no settings: every key has a default"))?;
    let is_refused = read(&format!("{{\"{NO_KEY}\": 1}}")).is_err();
    ensure(SETTINGS, is_refused, || format!("`{NO_KEY}` is read"), "an error: no key is dropped in silence")
}

#[cfg(test)]
mod tests {
    use darrt_core::partial::PartialState;
    use darrt_core::primitive::{Infeasible, Instances};
    use darrt_primitives::contract::{Contract, HandUse, HandWay, MovingPart};
    use darrt_primitives::tabletop::{Tabletop, TabletopState};

    use super::*;
    use crate::file_robot::FileRobot;

    /// Wrong in one way, or in none.
    struct Wave<const WRONG: u8>(PrimitiveId);

    #[derive(Clone, Copy, serde::Deserialize)]
    #[serde(deny_unknown_fields, default)]
    struct Strict {
        height_m: f64,
    }

    impl Default for Strict {
        fn default() -> Self {
            Self { height_m: 0.2 }
        }
    }

    /// The same, but `height_m` has no default in files, and other keys are passed over.
    #[derive(serde::Deserialize)]
    struct Lax {
        height_m: f64,
    }

    impl Default for Lax {
        fn default() -> Self {
            Self { height_m: 0.2 }
        }
    }

    #[derive(serde::Deserialize, Default)]
    struct Deaf {}

    impl<const WRONG: u8> Primitive<Tabletop<FileRobot>> for Wave<WRONG> {
        fn id(&self) -> PrimitiveId {
            if WRONG == 1 { PrimitiveId::new(8, "Wave") } else { self.0 }
        }
        fn name(&self) -> &'static str {
            if WRONG == 2 { "wave" } else { self.id().name() }
        }
        fn useful(
            &self,
            _: &Tabletop<FileRobot>,
            _: &TabletopState<FileRobot>,
            _: &PartialState<Tabletop<FileRobot>>,
        ) -> bool {
            false
        }
        fn propagate(
            &self,
            _: &Tabletop<FileRobot>,
            _: &TabletopState<FileRobot>,
            _: &PartialState<Tabletop<FileRobot>>,
            _: &mut dyn rand::Rng,
        ) -> Result<Instances<Tabletop<FileRobot>>, Infeasible> {
            Err(Infeasible::NoProgress)
        }
    }

    const FREE: Contract = Contract::of(MovingPart::Arm, HandUse::Empty, HandWay::Free);

    /// Its own settings, and one thing that is wrong.
    macro_rules! wave {
        ($wrong:literal, $name:literal, $contract:expr, $needs:expr, $settings:ty, $new:expr) => {
            impl TaskPrimitive<FileRobot> for Wave<$wrong> {
                const NAME: &'static str = $name;
                const CONTRACT: Contract = $contract;
                const NEEDS: &'static [&'static str] = $needs;
                type Settings = $settings;
                fn new(id: PrimitiveId, settings: $settings) -> Result<Self, String> {
                    let accept: fn($settings) -> Result<(), String> = $new;
                    accept(settings).map(|()| Self(id))
                }
            }
        };
    }

    fn positive(settings: Strict) -> Result<(), String> {
        if settings.height_m > 0.0 { Ok(()) } else { Err("`height_m` must be above 0".to_owned()) }
    }

    wave!(0, "Wave", FREE, &["Arm-Transit"], Strict, positive);
    wave!(1, "Wave", FREE, &[], Strict, positive);
    wave!(2, "Wave", FREE, &[], Strict, positive);
    wave!(3, "My wave", FREE, &[], Strict, positive);
    wave!(4, "Wave", FREE, &["Wave"], Strict, positive);
    wave!(5, "Wave", FREE, &[], Strict, |_| Err("`height_m` must be set".to_owned()));
    wave!(6, "Wave", FREE, &[], Lax, |lax| positive(Strict { height_m: lax.height_m }));
    wave!(7, "Wave", FREE, &[], Deaf, |_| Ok(()));
    wave!(8, "Wave", FREE, &["Arm-Transit", "Arm-Transit"], Strict, positive);

    #[test]
    fn primitives_that_are_registered_wrongly_break_the_law_they_should() {
        let law = |found: Result<(), Broken>| found.map_err(|broken| broken.law);
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<0>>()), Ok(()));
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<1>>()), Err(NAMED), "a place of its own");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<2>>()), Err(NAMED), "another name");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<3>>()), Err(NAMED), "two words");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<4>>()), Err(NAMED), "needs itself");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<5>>()), Err(SETTINGS), "not as it is by default");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<6>>()), Err(SETTINGS), "a key without default");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<7>>()), Err(SETTINGS), "reads anything");
        assert_eq!(law(check_task_primitive::<FileRobot, Wave<8>>()), Err(NAMED), "needs one twice");
    }
}
