/* As num/double_symbols.h, for this folder. */
#ifndef REFLUX_LTI_DOUBLE_SYMBOLS_H
#define REFLUX_LTI_DOUBLE_SYMBOLS_H

#ifdef REFLUX_REAL_DOUBLE
#define difference_check   difference_check_double
#define difference_gain    difference_gain_double
#define difference_step    difference_step_double
#define state_model_check  state_model_check_double
#define state_model_sample state_model_sample_double
#endif

#endif
