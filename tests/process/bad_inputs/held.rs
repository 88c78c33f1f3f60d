//! Rows that no input of the program reaches by itself, and rows that another test runs with more care: name of the row,
//! file, name of the test.

pub const ROWS: &[(&str, &str, &str)] = &[
    ("alpha very unequal", "tests/it/formula_values.rs", "every_reference_value_is_met"),
    (
        "theta nearly 90",
        "tests/it/measure/grazing_stability.rs",
        "nothing_is_lost_and_nothing_is_infinite_however_grazing_the_light",
    ),
    (
        "theta so grazing that rays never end",
        "tests/it/measure/grazing_stability.rs",
        "a_ray_crosses_as_many_cells_as_its_rise_over_the_patch_says",
    ),
    ("phi the same modulo 360", "src/sphere.rs", "azimuths_that_are_the_same_reduce_to_the_same_bits"),
    (
        "range with an inexact step",
        "tests/it/campaign/config_faults.rs",
        "ranges_count_their_points_by_whole_steps",
    ),
    (
        "normal incidence",
        "tests/it/formula_values.rs",
        "the_closed_forms_of_the_lobe_hold_at_normal_incidence",
    ),
    ("formula at its limits", "tests/it/formula_values.rs", "every_reference_value_is_met"),
    ("below the horizon", "src/theory/microfacet.rs", "below_the_horizon_there_is_no_light"),
    ("normal beyond the law", "src/theory/ndf.rs", "no_normal_gives_anything_but_a_number"),
    (
        "heights a million cells up",
        "tests/it/measure/grazing_stability.rs",
        "heights_a_million_cells_up_give_the_same_table",
    ),
    (
        "heights and pitch scaled",
        "tests/it/measure/grazing_stability.rs",
        "heights_and_pitch_scaled_by_a_power_of_two_give_the_same_bits",
    ),
    (
        "ray at an edge or seam",
        "tests/it/trace/watertight.rs",
        "walk_agrees_with_a_loop_over_all_facets_at_edges_vertices_and_seams",
    ),
    ("ray at an edge or seam", "tests/it/trace/watertight.rs", "no_ray_aimed_at_an_edge_leaks"),
    (
        "start with two fates",
        "tests/it/measure/energy.rs",
        "every_start_has_one_fate_and_the_light_sums_to_one",
    ),
    ("reflected and lost light", "src/optics/fresnel/mod.rs", "reflected_and_lost_light_make_one"),
    (
        "conductor without absorption",
        "src/optics/fresnel/mod.rs",
        "a_conductor_without_absorption_is_the_dielectric",
    ),
    ("no bins", "src/instrument/region.rs", "projected_solid_angles_sum_to_pi"),
    ("bin without hits", "tests/it/measure/energy.rs", "every_value_has_an_error_bar"),
    ("seeds alike but for a bit", "src/rng.rs", "seeds_that_differ_in_the_top_bit_give_other_streams"),
    ("threads", "tests/it/cli.rs", "results_are_the_same_bytes_for_any_number_of_threads"),
    ("threads in the environment", "tests/it/cli.rs", "results_are_the_same_bytes_for_any_number_of_threads"),
    ("disk full", "src/files/mod.rs", "a_failed_write_leaves_the_old_file_whole"),
    (
        "disk full for a while",
        "tests/process/full_disk.rs",
        "a_run_whose_disk_is_full_for_a_while_goes_on_and_is_kept_again",
    ),
    ("killed", "tests/process/kills_in_bands.rs", "a_run_in_bands_that_is_killed_ends_with_the_same_bytes"),
    ("killed", "tests/process/kills_and_resume.rs", "a_killed_run_ends_with_the_bytes_of_one_that_was_not"),
    (
        "killed",
        "tests/process/kills_and_resume.rs",
        "the_first_signal_keeps_what_is_measured_and_says_how_to_go_on",
    ),
    ("checkpoint damaged", "src/files/sealed.rs", "every_cut_and_every_flipped_bit_is_noticed"),
    (
        "checkpoint damaged",
        "tests/process/kills_and_resume.rs",
        "a_damaged_checkpoint_gives_way_to_the_one_before",
    ),
    (
        "checkpoint of another campaign",
        "tests/process/kills_and_resume.rs",
        "another_campaign_is_refused_by_the_key_that_differs",
    ),
    (
        "two processes",
        "tests/process/files_under_failure.rs",
        "a_second_process_is_refused_and_a_dead_one_is_not_waited_for",
    ),
    (
        "disk full",
        "tests/process/files_under_failure.rs",
        "a_file_that_may_not_grow_leaves_the_old_files_whole",
    ),
    ("disk full", "tests/process/failing_calls.rs", "every_call_of_a_measurement_may_fail"),
    ("closed pipe", "tests/it/cli.rs", "a_closed_pipe_ends_the_printing_and_not_the_run"),
    ("value beyond the format", "src/table/store.rs", "nan_and_infinity_are_refused_before_writing"),
    ("panic in a worker", "src/cli/mod.rs", "a_panic_in_a_worker_is_an_internal_error_in_one_line"),
    ("kernels of another processor", "tests/it/trace/lanes.rs", "every_kernel_gives_the_same_bits"),
    // Elsewhere a sine may differ in its last bit, and the draws with it: the same figures within their errors.
    (
        "sine of another library",
        "tests/it/measure/coverage.rs",
        "an_interval_misses_what_other_seeds_find_in_one_bin_of_twenty",
    ),
];
