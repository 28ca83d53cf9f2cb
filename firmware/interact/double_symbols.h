/* As num/double_symbols.h, for this folder. */
#ifndef REFLUX_INTERACT_DOUBLE_SYMBOLS_H
#define REFLUX_INTERACT_DOUBLE_SYMBOLS_H

#ifdef REFLUX_REAL_DOUBLE
#define interact_check               interact_check_double
#define interact_check_ranges        interact_check_ranges_double
#define pairs_check                  pairs_check_double
#define interact_gains               interact_gains_double
#define interact_response            interact_response_double
#define fopdt_response               fopdt_response_double
#define direction_sd                 direction_sd_double
#define direction_take               direction_take_double
#define direction_correct            direction_correct_double
#define direction_common             direction_common_double
#define direction_draw               direction_draw_double
#define rga_compute                  rga_compute_double
#define rga_at                       rga_at_double
#define rga_number                   rga_number_double
#define rga_of_pair                  rga_of_pair_double
#define rga_smallest_error           rga_smallest_error_double
#define niederlinski_index           niederlinski_index_double
#define rga_determinant_sds          rga_determinant_sds_double
#define integrity_begin              integrity_begin_double
#define integrity_step               integrity_step_double
#define integrity_of_two             integrity_of_two_double
#define gains_begin                  gains_begin_double
#define gains_step                   gains_step_double
#define gains_null_input             gains_null_input_double
#define gains_null_output            gains_null_output_double
#define assignment_solve             assignment_solve_double
#define assignment_by_relative_gains assignment_by_relative_gains_double
#define ranked_begin                 ranked_begin_double
#define ranked_branch                ranked_branch_double
#define ranked_next                  ranked_next_double
#define pairing_config_default       pairing_config_default_double
#define pairing_begin                pairing_begin_double
#define pairing_step                 pairing_step_double
#define candidates_begin             candidates_begin_double
#define candidates_step              candidates_step_double
#define candidates_pairs             candidates_pairs_double
#define structure_config_default     structure_config_default_double
#define structure_cross_way          structure_cross_way_double
#define structure_detect             structure_detect_double
#define cascade_config_default       cascade_config_default_double
#define cascade_detect               cascade_detect_double
#define measure_agrees               measure_agrees_double
#define measure_equivalent           measure_equivalent_double
#define measure_compute              measure_compute_double
#define difference_response          difference_response_double
#define ina_identity                 ina_identity_double
#define ina_operate                  ina_operate_double
#define ina_direct                   ina_direct_double
#define ina_inverse                  ina_inverse_double
#define ina_dominance                ina_dominance_double
#define ina_align                    ina_align_double
#define ina_normalise                ina_normalise_double
#define ina_search_begin             ina_search_begin_double
#define ina_search_step              ina_search_step_double
#define ina_search_config_default    ina_search_config_default_double
#endif

#endif
