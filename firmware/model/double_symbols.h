/* The model is built twice, in float and in double, and a host program may hold both (a simulated plant next
 * to a firmware with estimators). So the double build's functions carry a suffix of their own; sources and
 * callers never see it. One line for every public function of this folder. */
#ifndef REFLUX_MODEL_DOUBLE_SYMBOLS_H
#define REFLUX_MODEL_DOUBLE_SYMBOLS_H

#ifdef REFLUX_REAL_DOUBLE
#define component_vapour_pressure   component_vapour_pressure_double
#define component_vapour_pressures  component_vapour_pressures_double
#define component_vaporisation_heat component_vaporisation_heat_double
#define component_molar_volume      component_molar_volume_double
#define mixture_molar_mass          mixture_molar_mass_double
#define mixture_molar_volume        mixture_molar_volume_double
#define mixture_vaporisation_heat   mixture_vaporisation_heat_double
#define mixture_heat_capacity       mixture_heat_capacity_double
#define mole_from_mass_fractions    mole_from_mass_fractions_double
#define mass_fraction_of            mass_fraction_of_double
#define vle_bubble_point            vle_bubble_point_double
#define vle_slopes                  vle_slopes_double
#define column_validate             column_validate_double
#define column_validate_inputs      column_validate_inputs_double
#define column_init                 column_init_double
#define column_set_inputs           column_set_inputs_double
#define column_evaluate             column_evaluate_double
#define column_rates                column_rates_double
#define column_rates_again          column_rates_again_double
#define column_fraction             column_fraction_double
#define column_jacobian_shape       column_jacobian_shape_double
#define column_jacobian             column_jacobian_double
#endif

#endif
