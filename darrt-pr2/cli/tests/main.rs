//! The tests of this package in one program: what they have in common is compiled and linked once.

mod bad_input;
mod browser;
mod cli_bench;
mod cli_execute;
mod cli_export;
mod cli_plan;
mod cli_robot;
mod cli_robot_new;
mod cli_two_arms;
mod cli_usage;
mod house;
mod no_plan;
mod program;
mod see;
mod verdicts;
mod viewer;
