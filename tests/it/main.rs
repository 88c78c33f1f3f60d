//! What the program promises, area by area, as the folders of `src` are called.
//!
//! `cargo test --test it NAME` runs the tests whose path holds `NAME`: a test, a file (`lanes`) or an area (`trace::`).
//! What is done to the running program from outside (signals, a full disk, no memory) is in `tests/process`.

#[path = "../support/mod.rs"]
mod support;

mod advice;
mod bench;
mod cli;
mod companions;
mod diffuse_values;
mod examples;
mod fit;
mod fit_clear;
mod fit_errors;
mod foreign_files;
mod foreign_words;
mod formula_values;
mod fuzzed;
mod late_files;
mod layering;
mod layout;
mod mentions;
mod properties;
mod render;
mod report;
mod report_through;
mod scan_law;
mod slopes;
mod streams;
mod study;
mod sweeps;
mod transmission_values;

mod appearance {
    mod colours;
    mod command;
    mod gloss;
    mod readings;
}
mod albedo {
    mod files;
    mod formula;
    mod measured;
}
mod budget {
    mod command;
    mod coverage;
    mod geometry;
    mod methods;
    mod schema;
    mod sensitivities;
}
mod campaign {
    mod config_faults;
    mod config_round_trip;
}
mod surface {
    mod areal;
    mod certificate;
    mod height_maps;
    mod meshes;
    mod mirrored_maps;
    mod prepared_maps;
    mod psd;
    mod scans;
}
mod trace {
    mod corridors;
    mod fair_starts;
    mod grains;
    mod lanes;
    mod long_rays;
    mod masking_given_the_normal;
    mod masking_of_smith;
    mod watertight;
}
mod measure {
    mod coverage;
    mod energy;
    mod exact_shapes;
    mod golden_tables;
    mod grains;
    mod grazing_stability;
    mod instruments;
    mod lost_light;
    mod materials;
    mod reproducibility;
    mod savings;
    mod skips;
    mod stopping;
    mod turned_sample;
}
mod facets {
    mod critical_means;
    mod faults;
    mod furnace;
    mod interface;
    mod lanes;
    mod layered;
    mod layered_values;
    mod mueller;
    mod patches;
    mod reciprocity;
    mod smith_walk;
}
mod table {
    mod export_round_trip;
    mod large_tables;
}
mod interchange {
    mod between_through;
    mod interchange_albedo;
    mod interchange_angles;
    mod interchange_arrays;
    mod interchange_bird;
    mod interchange_fred;
    mod interchange_maps;
    mod interchange_merl;
    mod interchange_openmaterial;
    mod interchange_points;
    mod interchange_radiance;
    mod interchange_rgl;
    mod interchange_speos;
    mod interchange_ssdd;
    mod interchange_text;
    mod interchange_zemax;
    mod ragged_scans;
    mod round_trips;
    mod through;
}
mod validate {
    mod bin_means;
    mod common_grid;
    mod compare;
    mod discrepancy;
    mod grains;
    mod reciprocity;
    mod smith_surface;
    mod transmittance;
    mod verdicts;
    mod visibility_off;
    mod wave_limits;
}
