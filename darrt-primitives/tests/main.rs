//! The tests of this package in one program: what they have in common is compiled and linked once.

mod actions;
mod approach;
mod base_path;
mod laws_broken;
mod laws_gantry;
mod laws_modes;
mod laws_page;
mod laws_sequences;
mod line;
mod two_hands;
mod without_robot;
