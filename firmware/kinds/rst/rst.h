/* The kind `rst` is a controller of one loop by three polynomials in z^-1, with integral action and two degrees of freedom:
 *
 *     K P u = R w - Q y,   K = 1 - z^-1,   P = 1 + p[0] z^-1 + ...,   Q = q[0] + q[1] z^-1 + ...
 *
 * Source of the form: Kotyk and Machacek (1995), Eq. 4; design/pole_placement.h finds P, Q and R. All signals are fractions of span, so
 * Q and R are MV span per span of the measurement.
 *
 * It is computed in differences, Q y = Q(1) y + Q~ (y - y(t-1)) and R likewise with R(1) taken as Q(1): where measurement and setpoint
 * agree nothing moves, however large and opposite the coefficients are. The inputs of the past are those that took effect, so what
 * an output at its limit has missed is over after as many steps as P has coefficients. */
#ifndef REFLUX_RST_RST_H
#define REFLUX_RST_RST_H

#include "block/block.h"
#include "block/rst_settings.h"

#if CONFIG_BLOCKS

extern const struct block_kind rst_kind;

#endif
#endif
