#ifndef REFLUX_SIGNAL_INTEGRAL_CLAMP_H
#define REFLUX_SIGNAL_INTEGRAL_CLAMP_H

/* Directions in which the integral of a controller may not move, because what it drives is at a limit. */
enum integral_clamp { INTEGRAL_FREE = 0, INTEGRAL_CLAMP_UP = 1, INTEGRAL_CLAMP_DOWN = 2 };

#endif
