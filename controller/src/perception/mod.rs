//! How far away things are.
//!
//! Two ways to know: exact rays into the attached world (for testing the law apart from the
//! sensors), and the map of sonar echoes ([`echo_map`]).

pub mod echo_map;
