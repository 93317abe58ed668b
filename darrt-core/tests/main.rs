//! The tests of this package in one program: what they have in common is compiled and linked once.

mod laws_broken;
mod laws_everything;
mod laws_guide;
mod laws_page;
mod laws_puck;
mod laws_search;
mod laws_spaces;
mod nearest;
mod variants;
