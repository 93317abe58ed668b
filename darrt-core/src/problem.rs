//! A planning problem, everything checked once at construction.

use std::sync::Arc;

use crate::domain::Domain;
use crate::error::Error;
use crate::goal::Goal;
use crate::plan::Plan;
use crate::primitive::Primitive;
use crate::random::{Purpose, stream};
use crate::space::ComponentSpace;
use crate::state::{ComponentId, ComponentSet, ObjectId, State};
use crate::validity::Validity;
use crate::verify::{Refusal, Verified, Verifier};

/// The input of Algorithm 1: M, B, A, `c_I` and G, and the judge of the result.
///
/// Clones share everything but the start.
pub struct Problem<D: Domain> {
    domain: Arc<D>,
    start: State<D>,
    goal: Arc<dyn Goal<D>>,
    primitives: Arc<[Box<dyn Primitive<D>>]>,
    validity: Arc<dyn Validity<D>>,
    verifier: Arc<dyn Verifier<D>>,
}

impl<D: Domain> Clone for Problem<D> {
    fn clone(&self) -> Self {
        Self {
            domain: Arc::clone(&self.domain),
            start: self.start.clone(),
            goal: Arc::clone(&self.goal),
            primitives: Arc::clone(&self.primitives),
            validity: Arc::clone(&self.validity),
            verifier: Arc::clone(&self.verifier),
        }
    }
}

/// Accepts every plan.
#[derive(Debug)]
struct Unjudged;

impl<D: Domain> Verifier<D> for Unjudged {
    fn verify(&self, _: &D, _: &State<D>, _: &dyn Goal<D>, _: &Plan<D>) -> Result<Verified, Refusal> {
        Ok(Verified::default())
    }
}

/// Goal, primitives, validity and verifier.
pub(crate) type SharedParts<D> =
    (Arc<dyn Goal<D>>, Arc<[Box<dyn Primitive<D>>]>, Arc<dyn Validity<D>>, Arc<dyn Verifier<D>>);

/// The parts of a [`Problem`], by name.
pub struct Parts<D: Domain> {
    /// M.
    pub domain: D,
    /// The initial configuration and its mode.
    pub start: State<D>,
    /// G.
    pub goal: Box<dyn Goal<D>>,
    /// A.
    pub primitives: Vec<Box<dyn Primitive<D>>>,
    /// B, and every other rule.
    pub validity: Box<dyn Validity<D>>,
    /// The judge.
    pub verifier: Box<dyn Verifier<D>>,
}

impl<D: Domain> Problem<D> {
    /// Checks the parts and puts them together.
    ///
    /// # Errors
    /// [`Error`] if the domain has too many objects, the start has the wrong number of objects, lies outside
    /// its space or is not valid, a goal sample lies outside its space, there is no primitive, or two
    /// primitives share a name.
    pub fn new(parts: Parts<D>) -> Result<Self, Error> {
        let Parts { domain, start, goal, primitives, validity, verifier } = parts;
        Self::of_shared(Arc::new(domain), start, (goal.into(), primitives.into(), validity.into(), verifier.into()))
    }

    /// The same of parts that others hold as well.
    pub(crate) fn of_shared(domain: Arc<D>, start: State<D>, shared: SharedParts<D>) -> Result<Self, Error> {
        let (goal, primitives, validity, verifier) = shared;
        let objects = domain.objects().len();
        if objects > ComponentSet::MAX_OBJECTS {
            return Err(Error::TooManyObjects { found: objects, bound: ComponentSet::MAX_OBJECTS });
        }
        if start.objects.len() != objects {
            return Err(Error::ObjectCount { what: "the start", found: start.objects.len(), expected: objects });
        }
        check_start_inside(&*domain, &start)?;
        if primitives.is_empty() {
            return Err(Error::NoPrimitives);
        }
        for (i, a) in primitives.iter().enumerate() {
            if primitives.iter().take(i).any(|b| a.id() == b.id()) {
                return Err(Error::DuplicatePrimitive(a.name()));
            }
        }
        validity.check(&domain, &start, &D::Contacts::default()).map_err(Error::StartInvalid)?;
        for i in 0..16 {
            if let Some(target) = goal.sample(&domain, &mut stream(0, 0, i, Purpose::Attempt)) {
                target.check(&domain)?;
            }
        }
        Ok(Self { domain, start, goal, primitives, validity, verifier })
    }

    /// A part of this problem for a search of its own: from `start` to `goal`, and whatever leads there is accepted. What is
    /// put together from such parts must be judged as a whole.
    pub(crate) fn part(&self, start: State<D>, goal: Arc<dyn Goal<D>>) -> Self {
        Self { start, goal, verifier: Arc::new(Unjudged), ..self.clone() }
    }

    /// The same for a robot that can pass through everything, with rules for the objects alone.
    pub(crate) fn under(&self, validity: Arc<dyn Validity<D>>) -> Self {
        let domain = self.domain.without_robot().map_or_else(|| Arc::clone(&self.domain), Arc::new);
        Self { domain, validity, ..self.clone() }
    }

    /// G, to be shared.
    pub(crate) fn shared_goal(&self) -> Arc<dyn Goal<D>> {
        Arc::clone(&self.goal)
    }

    /// Goal, primitives, validity and verifier, to be shared.
    pub(crate) fn shared_parts(&self) -> SharedParts<D> {
        let (goal, primitives) = (Arc::clone(&self.goal), Arc::clone(&self.primitives));
        (goal, primitives, Arc::clone(&self.validity), Arc::clone(&self.verifier))
    }

    /// M, to be shared.
    pub fn shared_domain(&self) -> Arc<D> {
        Arc::clone(&self.domain)
    }

    /// M.
    pub fn domain(&self) -> &D {
        &self.domain
    }

    /// The initial state.
    pub fn start(&self) -> &State<D> {
        &self.start
    }

    /// G.
    pub fn goal(&self) -> &dyn Goal<D> {
        &*self.goal
    }

    /// A.
    pub fn primitives(&self) -> &[Box<dyn Primitive<D>>] {
        &self.primitives
    }

    /// B.
    pub fn validity(&self) -> &dyn Validity<D> {
        &*self.validity
    }

    /// The judge.
    pub fn verifier(&self) -> &dyn Verifier<D> {
        &*self.verifier
    }
}

impl<D: Domain> std::fmt::Debug for Parts<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.primitives.iter().map(|p| p.name()).collect();
        f.debug_struct("Parts").field("start", &self.start).field("primitives", &names).finish_non_exhaustive()
    }
}

impl<D: Domain> std::fmt::Debug for Problem<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let names: Vec<_> = self.primitives.iter().map(|p| p.name()).collect();
        f.debug_struct("Problem").field("start", &self.start).field("primitives", &names).finish_non_exhaustive()
    }
}

fn check_start_inside<D: Domain>(m: &D, start: &State<D>) -> Result<(), Error> {
    let outside = |component: ComponentId, config: String| Error::StartOutside {
        component: m.component_name(component).into_owned(),
        config,
    };
    if !m.robot().contains(&start.robot) {
        return Err(outside(ComponentId::Robot, format!("{:?}", start.robot)));
    }
    for (i, (space, config)) in m.objects().iter().zip(&start.objects).enumerate() {
        if !space.contains(config) {
            return Err(outside(ComponentId::Object(ObjectId::new(i)), format!("{config:?}")));
        }
    }
    Ok(())
}
