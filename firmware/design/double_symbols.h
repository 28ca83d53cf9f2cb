/* As num/double_symbols.h, for this folder. */
#ifndef REFLUX_DESIGN_DOUBLE_SYMBOLS_H
#define REFLUX_DESIGN_DOUBLE_SYMBOLS_H

#ifdef REFLUX_REAL_DOUBLE
#define tuning_cohen_coon_pi                tuning_cohen_coon_pi_double
#define tuning_cohen_coon_pid               tuning_cohen_coon_pid_double
#define tuning_simc_pi                      tuning_simc_pi_double
#define tuning_simc_pid                     tuning_simc_pid_double
#define tuning_tyreus_luyben_pi             tuning_tyreus_luyben_pi_double
#define loops_check                         loops_check_double
#define loops_z_less_1                      loops_z_less_1_double
#define loops_sample                        loops_sample_double
#define loops_controller                    loops_controller_double
#define loops_open                          loops_open_double
#define loops_advance                       loops_advance_double
#define modes_of                            modes_of_double
#define modes_rise                          modes_rise_double
#define modes_noise                         modes_noise_double
#define first_order_of                      first_order_of_double
#define nyquist_begin                       nyquist_begin_double
#define nyquist_step                        nyquist_step_double
#define nyquist_begin_peaks                 nyquist_begin_peaks_double
#define peaks_begin                         peaks_begin_double
#define peaks_values                        peaks_values_double
#define peaks_change                        peaks_change_double
#define peaks_keep                          peaks_keep_double
#define peaks_excess                        peaks_excess_double
#define trial_begin                         trial_begin_double
#define trial_step                          trial_step_double
#define detune_config_default               detune_config_default_double
#define detune_begin                        detune_begin_double
#define detune_step                         detune_step_double
#define detune_largest_gain                 detune_largest_gain_double
#define robust_moves                        robust_moves_double
#define robust_move                         robust_move_double
#define robust_make_move                    robust_make_move_double
#define robust_pass_begin                   robust_pass_begin_double
#define robust_pass_plant                   robust_pass_plant_double
#define robust_pass_step                    robust_pass_step_double
#define robust_choose                       robust_choose_double
#define robust_rise                         robust_rise_double
#define robust_config_check                 robust_config_check_double
#define robust_config_default               robust_config_default_double
#define robust_begin                        robust_begin_double
#define robust_step                         robust_step_double
#define members_draw                        members_draw_double
#define static_decoupler_config_default     static_decoupler_config_default_double
#define static_decoupler                    static_decoupler_double
#define polynomial_decoupler_config_default polynomial_decoupler_config_default_double
#define polynomial_decoupler_design         polynomial_decoupler_design_double
#define polynomial_decoupler_check          polynomial_decoupler_check_double
#define pole_placement_judge                pole_placement_judge_double
#define polynomial_decoupler_zeros          polynomial_decoupler_zeros_double
#define state_decoupler_config_default      state_decoupler_config_default_double
#define state_decoupler_design              state_decoupler_design_double
#define state_decoupler_begin               state_decoupler_begin_double
#define state_decoupler_part                state_decoupler_part_double
#define state_zeros_find                    state_zeros_find_double
#define state_loop_radius                   state_loop_radius_double
#define pole_placement_goal_default         pole_placement_goal_default_double
#define pole_placement_design               pole_placement_design_double
#define decoupler_partial                   decoupler_partial_double
#define decoupler_one_way                   decoupler_one_way_double
#define decoupler_by_directions             decoupler_by_directions_double
#define feedforward_case_of                 feedforward_case_of_double
#define feedforward_case_name               feedforward_case_name_double
#define feedforward_shinskey                feedforward_shinskey_double
#define feedforward_exact                   feedforward_exact_double
#define feedforward_rule_response           feedforward_rule_response_double
#define fopdt_from_response                 fopdt_from_response_double
#define response_fit_begin                  response_fit_begin_double
#define response_fit_piece                  response_fit_piece_double
#define feedforward_miss_of                 feedforward_miss_of_double
#define feedforward_misses                  feedforward_misses_double
#endif

#endif
