//! Promise: the examples run as they are.

#[path = "../../examples/compare_with_theory.rs"]
mod compare_with_theory;
#[allow(dead_code, reason = "the test gives the file, which `main` takes from the command line")]
#[path = "../../examples/export_for_mitsuba.rs"]
mod export_for_mitsuba;
#[path = "../../examples/measure.rs"]
mod measure;

#[test]
fn the_examples_run() {
    measure::main().expect("a measurement");
    compare_with_theory::main().expect("a comparison");
    let folder = tempfile::tempdir().expect("temporary folder");
    let file = folder.path().join("brushed.bsdf");
    export_for_mitsuba::write(&file).expect("an export");
    assert!(file.metadata().expect("written").len() > 10_000);
}
