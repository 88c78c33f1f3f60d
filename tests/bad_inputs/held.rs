//! Rows that no input of the program reaches by itself, and rows that another test runs with more care: number, file,
//! name of the test.

/// Rows whose feature is not there.
pub const NOT_BUILT: [u32; 2] = [78, 82];

pub const ROWS: &[(u32, &str, &str)] = &[
    (19, "tests/formula_values.rs", "every_reference_value_is_met"),
    (27, "tests/grazing_stability.rs", "nothing_is_lost_and_nothing_is_infinite_however_grazing_the_light"),
    (28, "tests/grazing_stability.rs", "a_ray_crosses_as_many_cells_as_its_rise_over_the_patch_says"),
    (30, "src/campaign/angles.rs", "azimuths_that_are_the_same_reduce_to_the_same_bits"),
    (35, "tests/config_faults.rs", "ranges_count_their_points_by_whole_steps"),
    (38, "tests/formula_values.rs", "the_closed_forms_of_the_lobe_hold_at_normal_incidence"),
    (40, "tests/formula_values.rs", "every_reference_value_is_met"),
    (41, "src/theory/microfacet.rs", "below_the_horizon_there_is_no_light"),
    (42, "src/theory/ndf.rs", "no_normal_gives_anything_but_a_number"),
    (50, "tests/grazing_stability.rs", "heights_a_million_cells_up_give_the_same_table"),
    (51, "tests/grazing_stability.rs", "heights_and_pitch_scaled_by_a_power_of_two_give_the_same_bits"),
    (52, "tests/watertight.rs", "walk_agrees_with_a_loop_over_all_facets_at_edges_vertices_and_seams"),
    (52, "tests/watertight.rs", "no_ray_aimed_at_an_edge_leaks"),
    (53, "tests/energy.rs", "every_start_has_one_fate_and_the_light_sums_to_one"),
    (55, "src/optics/fresnel.rs", "reflected_and_lost_light_make_one"),
    (57, "tests/formula_values.rs", "every_reference_value_is_met"),
    (58, "src/optics/fresnel.rs", "a_conductor_without_absorption_is_the_dielectric"),
    (59, "tests/formula_values.rs", "every_reference_value_is_met"),
    (65, "src/instrument/grid.rs", "projected_solid_angles_sum_to_pi"),
    (66, "tests/energy.rs", "every_value_has_an_error_bar"),
    (70, "src/rng.rs", "seeds_that_differ_in_the_top_bit_give_other_streams"),
    (71, "tests/cli.rs", "results_are_the_same_bytes_for_any_number_of_threads"),
    (72, "tests/cli.rs", "results_are_the_same_bytes_for_any_number_of_threads"),
    (77, "src/files.rs", "a_failed_write_leaves_the_old_file_whole"),
    (79, "tests/kills_and_resume.rs", "a_killed_run_ends_with_the_bytes_of_one_that_was_not"),
    (79, "tests/kills_and_resume.rs", "the_first_signal_keeps_what_is_measured_and_says_how_to_go_on"),
    (80, "src/files/sealed.rs", "every_cut_and_every_flipped_bit_is_noticed"),
    (80, "tests/kills_and_resume.rs", "a_damaged_checkpoint_gives_way_to_the_one_before"),
    (81, "tests/kills_and_resume.rs", "another_campaign_is_refused_by_the_key_that_differs"),
    (84, "tests/cli.rs", "a_closed_pipe_ends_the_printing_and_not_the_run"),
    (90, "src/table/store.rs", "nan_and_infinity_are_refused_before_writing"),
    (92, "src/cli/mod.rs", "a_panic_in_a_worker_is_an_internal_error_in_one_line"),
    (97, "tests/lanes.rs", "every_kernel_gives_the_same_bits"),
    // Elsewhere a sine may differ in its last bit, and the draws with it: the same figures within their errors.
    (98, "tests/coverage.rs", "an_interval_misses_what_other_seeds_find_in_one_bin_of_twenty"),
];
