#include "kinds/gmv/gmv_shadow.h"

#include "base/assertion.h"
#include "kinds/gmv/gmv_settings.h"
#include "kinds/gmv/gmv_shadow_state.h"
#include "num/real.h"

enum err gmv_shadow_configure(struct gmv_shadow *s, const struct block_setup *setup, unsigned i,
                              bool retune)
{
    REFLUX_ASSERT(i < GMV_LOOPS);
    const struct gmv_settings *from = setup->settings;
    struct pid_config c = pid_default_config();
    c.gain = real_abs(from->tune_gain[i]);
    c.action = from->tune_gain[i] < 0 ? PID_DIRECT : PID_REVERSE;
    c.ti_s = from->tune_ti_s[i];
    c.out_lo = -PID_OUTPUT_MAX; /* the loop's own limits come after it */
    c.out_hi = PID_OUTPUT_MAX;
    return retune ? pid_retune(&s->pi[i], &c, setup->interval_s)
                  : pid_init(&s->pi[i], &c, setup->interval_s);
}
