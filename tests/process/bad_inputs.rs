//! Promise: whatever the program is given, it answers with the right exit code and one clear line, and leaves every
//! file as it was.
//!
//! One list of bad inputs and stress cases, each run by the real program. Rows about formulae and rays, which
//! no input of the program reaches by itself, name the test that holds them.

use std::collections::BTreeSet;

mod beyond;
mod campaigns;
mod commands;
mod densities;
mod files;
mod held;
mod names;
mod physics;
mod row;
mod uncertainties;

#[test]
fn the_text_of_a_campaign_is_answered_row_by_row() {
    row::all_hold(campaigns::rows());
}

#[test]
fn values_outside_physics_are_answered_row_by_row() {
    row::all_hold(physics::rows());
}

#[test]
fn densities_and_lengths_are_answered_row_by_row() {
    row::all_hold(densities::rows());
}

#[test]
fn uncertainties_are_answered_row_by_row() {
    row::all_hold(uncertainties::rows());
}

#[test]
fn command_lines_and_surroundings_are_answered_row_by_row() {
    row::all_hold(commands::rows());
}

#[test]
fn files_of_tables_and_maps_are_answered_row_by_row() {
    row::all_hold(files::rows());
}

#[test]
fn what_an_attacker_or_a_tired_user_gives_is_answered_too() {
    row::all_hold(beyond::rows());
}

#[test]
fn rows_held_elsewhere_name_a_test_that_is_there() {
    for (name, file, test) in held::ROWS {
        let path = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{name}: {path}: {e}"));
        assert!(text.contains(&format!("fn {test}(")), "{name}: no test `{test}` in {file}");
    }
}

#[test]
fn the_list_is_complete() {
    let run = [campaigns::rows(), physics::rows(), commands::rows(), files::rows()];
    let mut there: BTreeSet<&str> = run.iter().flatten().map(|row| row.name).collect();
    there.extend(held::ROWS.iter().map(|row| row.0));
    let missing: Vec<&str> = names::NAMES.into_iter().filter(|name| !there.contains(name)).collect();
    assert!(missing.is_empty(), "without a row: {missing:?}");
    let unlisted: Vec<&str> = there.into_iter().filter(|name| !names::NAMES.contains(name)).collect();
    assert!(unlisted.is_empty(), "not in the list: {unlisted:?}");
}
