/* Plants drawn from what is not known of one: gains as interact/pairing.h draws them, time constants and dead times with
 * independent errors of their own. For design/robust.h. */
#ifndef REFLUX_DESIGN_MEMBERS_H
#define REFLUX_DESIGN_MEMBERS_H

#include "design/double_symbols.h"
#include "interact/plant.h"

/* Standard deviations of the times of every element, s, 0 or more. */
struct time_errors {
    real_t dead_time_s[INTERACT_MAX][INTERACT_MAX], time_constant_s[INTERACT_MAX][INTERACT_MAX];
};

struct members {
    const struct interact_plant *plant; /* with the deviations of its gains */
    const struct time_errors *errors;   /* NULL: none */
    real_t floor; /* relative standard deviation of a gain and of a time at least, 0 to 0.5 */
    uint64_t seed;
};

/* Draws row `output` of member number `member`, row 0 first, for struct robust_config; context: a struct members, checked as interact_check() does. A
 * deviate is normal, at most 3. Gains keep their signs. A time is multiplied by 1 + x, or divided by 1 - x where x, deviate times
 * relative deviation, is below 0, so that it stays above 0. Zero and square go with the time constant: damping stays. */
void members_draw(const void *context, uint16_t member, uint8_t output,
                  struct interact_plant *drawn);

#endif
