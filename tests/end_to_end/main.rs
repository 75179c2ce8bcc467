//! The program as a user runs it: real processes, real files.

mod bad_input;
mod broken_controllers;
mod comparison;
mod exact_replay;
mod explain;
mod fixtures;
mod help;
mod interruption;
mod map;
mod odd_logs;
mod other_plant;
mod plot;
mod program;
mod self_test;
mod side_by_side;
