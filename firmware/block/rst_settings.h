/* Settings of the kind `rst`, for the kind and for the blocks that propose them. */
#ifndef REFLUX_BLOCK_RST_SETTINGS_H
#define REFLUX_BLOCK_RST_SETTINGS_H

#define RST_COEFFICIENTS 8

struct rst_settings {
    /* Interval of z^-1: must be the interval of the loop's steps. */
    float period_s;
    /* P starts at z^-1; Q and R start at z^0, and R(1) = Q(1). */
    float p[RST_COEFFICIENTS];
    float q[RST_COEFFICIENTS], r[RST_COEFFICIENTS];
};

/* Ids of the parameters. */
enum { RST_ID_PERIOD = 1, RST_ID_P, RST_ID_Q, RST_ID_R };

#endif
