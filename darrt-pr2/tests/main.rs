//! The tests of this package in one program: what they have in common is compiled and linked once.

mod everyday;
mod laws;
mod no_plan;
mod paper_statements;
mod problem_format_doc;
mod replan;
mod true_shape;
mod verify_plans;
mod why_not;
