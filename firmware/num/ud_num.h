/* UD arithmetic of the build under one set of names: num/ud.h in float, num/ud_scaled.h in fixed point. */
#ifndef REFLUX_NUM_UD_NUM_H
#define REFLUX_NUM_UD_NUM_H

#include "num/ud.h"
#include "num/ud_scaled.h"

#ifdef REFLUX_FIXED_POINT
#define UD_NUM(name) ud_scaled_##name
#else
typedef float ud_cell_t;
#define UD_NUM(name) ud_##name
#define ud_cells     ud_count
#endif

#define ud_num_cells        UD_NUM(cells)
#define ud_num_set_diagonal UD_NUM(set_diagonal)
#define ud_num_project      UD_NUM(project)
#define ud_num_variance     UD_NUM(variance)
#define ud_num_correct      UD_NUM(correct)
#define ud_num_add          UD_NUM(add)
#define ud_num_scale        UD_NUM(scale)
#define ud_num_multiply     UD_NUM(multiply)
#define ud_num_solve        UD_NUM(solve)
#define ud_num_trace        UD_NUM(trace)
#define ud_num_element      UD_NUM(element)
#define ud_num_extremes     UD_NUM(extremes)
#define ud_num_clamp        UD_NUM(clamp)

#endif
