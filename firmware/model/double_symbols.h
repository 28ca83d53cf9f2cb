/* The model is built in float, in double and in long double, and a host program may hold all of them (a simulated
 * plant and its derivatives next to a firmware with estimators). So the functions of the wider builds carry a suffix
 * of their own; sources and callers never see it. One line for every public function of this folder. */
#ifndef REFLUX_MODEL_DOUBLE_SYMBOLS_H
#define REFLUX_MODEL_DOUBLE_SYMBOLS_H

#if defined REFLUX_REAL_DOUBLE
#define MODEL_SYMBOL(name) name##_double
#elif defined REFLUX_REAL_LONG
#define MODEL_SYMBOL(name) name##_long
#endif

#ifdef MODEL_SYMBOL
#define component_vapour_pressure   MODEL_SYMBOL(component_vapour_pressure)
#define component_vapour_pressures  MODEL_SYMBOL(component_vapour_pressures)
#define component_vaporisation_heat MODEL_SYMBOL(component_vaporisation_heat)
#define component_molar_volume      MODEL_SYMBOL(component_molar_volume)
#define mixture_molar_mass          MODEL_SYMBOL(mixture_molar_mass)
#define mixture_molar_volume        MODEL_SYMBOL(mixture_molar_volume)
#define mixture_vaporisation_heat   MODEL_SYMBOL(mixture_vaporisation_heat)
#define mixture_heat_capacity       MODEL_SYMBOL(mixture_heat_capacity)
#define mole_from_mass_fractions    MODEL_SYMBOL(mole_from_mass_fractions)
#define mass_fraction_of            MODEL_SYMBOL(mass_fraction_of)
#define vle_bubble_point            MODEL_SYMBOL(vle_bubble_point)
#define vle_bubble_point_near       MODEL_SYMBOL(vle_bubble_point_near)
#define vle_full_slopes             MODEL_SYMBOL(vle_full_slopes)
#define activity_validate           MODEL_SYMBOL(activity_validate)
#define activity_coefficients       MODEL_SYMBOL(activity_coefficients)
#define vle_slopes                  MODEL_SYMBOL(vle_slopes)
#define column_validate             MODEL_SYMBOL(column_validate)
#define column_validate_inputs      MODEL_SYMBOL(column_validate_inputs)
#define column_init                 MODEL_SYMBOL(column_init)
#define column_set_inputs           MODEL_SYMBOL(column_set_inputs)
#define column_evaluate             MODEL_SYMBOL(column_evaluate)
#define column_evaluate_near        MODEL_SYMBOL(column_evaluate_near)
#define column_rates                MODEL_SYMBOL(column_rates)
#define column_rates_again          MODEL_SYMBOL(column_rates_again)
#define column_fraction             MODEL_SYMBOL(column_fraction)
#define column_take_reference       MODEL_SYMBOL(column_take_reference)
#define column_holdup_state         MODEL_SYMBOL(column_holdup_state)
#define column_relative_holdup      MODEL_SYMBOL(column_relative_holdup)
#define column_full_composition     MODEL_SYMBOL(column_full_composition)
#define column_soft_limit           MODEL_SYMBOL(column_soft_limit)
#define column_moles_per_unit       MODEL_SYMBOL(column_moles_per_unit)
#define column_wanted_flows         MODEL_SYMBOL(column_wanted_flows)
#define column_limit_feed           MODEL_SYMBOL(column_limit_feed)
#define column_level_flows          MODEL_SYMBOL(column_level_flows)
#define column_tray_flows           MODEL_SYMBOL(column_tray_flows)
#define column_flows_at             MODEL_SYMBOL(column_flows_at)
#define column_flows_with_feed      MODEL_SYMBOL(column_flows_with_feed)
#define column_balances             MODEL_SYMBOL(column_balances)
#define column_holdup_rates         MODEL_SYMBOL(column_holdup_rates)
#define column_jacobian_shape       MODEL_SYMBOL(column_jacobian_shape)
#define column_jacobian             MODEL_SYMBOL(column_jacobian)
#define column_truncated_rates      MODEL_SYMBOL(column_truncated_rates)
#define column_implicit_step        MODEL_SYMBOL(column_implicit_step)
#define column_move                 MODEL_SYMBOL(column_move)
#define column_transition_make      MODEL_SYMBOL(column_transition_make)
#define column_transition_apply     MODEL_SYMBOL(column_transition_apply)
#define column_feed_slopes          MODEL_SYMBOL(column_feed_slopes)
#define column_feed_moles_slope     MODEL_SYMBOL(column_feed_moles_slope)
#define column_feed_flow_slope      MODEL_SYMBOL(column_feed_flow_slope)
#endif

#endif
