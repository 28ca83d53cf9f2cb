/* Inner values that a block of the kind `gmv` shows. */
#ifndef REFLUX_GMV_GMV_VALUES_H
#define REFLUX_GMV_GMV_VALUES_H

#include <stddef.h>

#include "kinds/gmv/gmv.h"
#include "kinds/gmv/gmv_supervise.h"

struct gmv_view {
    const struct gmv *gmv;
    const struct gmv_status *status;
    /* Mean information of a sample of each loop. */
    const float *information;
    /* Number of adopted parameters that are in the settings. */
    uint8_t stored;
    /* Lambda in use as a multiple of the setting. */
    float lambda_times;
};

/* Returns the name of the n-th value, or NULL past the end. */
const char *gmv_value(const struct gmv_view *view, size_t n, float *value);

#endif
