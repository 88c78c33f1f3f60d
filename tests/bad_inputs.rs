//! Promise: whatever the program is given, it answers with the right exit code and one clear line, and leaves every
//! file as it was.
//!
//! One numbered list of bad inputs and stress cases, each run by the real program. Rows about formulae and rays, which
//! no input of the program reaches by itself, name the test that holds them.

use std::collections::BTreeSet;

#[path = "bad_inputs/beyond.rs"]
mod beyond;
#[path = "common/campaign_text.rs"]
mod campaign_text;
#[path = "bad_inputs/campaigns.rs"]
mod campaigns;
#[path = "bad_inputs/commands.rs"]
mod commands;
#[path = "bad_inputs/files.rs"]
mod files;
#[path = "bad_inputs/held.rs"]
mod held;
#[path = "bad_inputs/physics.rs"]
mod physics;
#[path = "bad_inputs/row.rs"]
mod row;

#[test]
fn the_text_of_a_campaign_is_answered_row_by_row() {
    row::all_hold(campaigns::rows());
}

#[test]
fn values_outside_physics_are_answered_row_by_row() {
    row::all_hold(physics::rows());
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
    for (number, file, test) in held::ROWS {
        let path = format!("{}/{file}", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("row {number}: {path}: {e}"));
        assert!(text.contains(&format!("fn {test}(")), "row {number}: no test `{test}` in {file}");
    }
}

#[test]
fn the_list_is_complete() {
    let run = [campaigns::rows(), physics::rows(), commands::rows(), files::rows()];
    let numbers: BTreeSet<u32> =
        run.iter().flatten().map(|row| row.number).chain(held::ROWS.iter().map(|row| row.0)).collect();
    let missing: Vec<u32> = (1..=100).filter(|number| !numbers.contains(number)).collect();
    assert_eq!(missing, [0; 0], "rows without a test");
}
