#include "adapt/gmv_record.h"

#include "num/real.h"

#define WINDOW  64u  /* steps at rest */
#define WINDOWS 2u   /* one after the other */
#define ENOUGH  32u  /* samples at rest that make a record */
#define MEMORY  256u /* samples */
/* The law does worse: mean squares, times the PI's. */
#define ERROR_TIMES 4.0f
#define MOVES_TIMES 9.0f
#define ERROR_LEAST 0.005f /* of span, r.m.s. */
/* As many moves are too many wherever the error is no smaller than the PI's, if they are as large as this, r.m.s. */
#define MOVES_LEAST 0.005f
/* A PI that does not move at all has moved by as much, r.m.s. */
#define STILL 1e-4f

static void begin_record_window(struct gmv_record *r)
{
    r->seen = 0;
    r->error_sum = r->moves_sum = 0;
}

void gmv_record_begin(struct gmv_record *r)
{
    r->rests = 0;
    r->beyond = 0;
    begin_record_window(r);
}

static bool setpoint_rests(struct gmv_record *r, float setpoint, uint32_t settled)
{
    if (setpoint != r->setpoint)
        r->rests = 0;
    else if (r->rests < UINT32_MAX)
        r->rests++;
    r->setpoint = setpoint;
    return r->rests >= settled;
}

static void take_in_means(struct gmv_record *r, uint16_t *samples, float away, float moved)
{
    *samples = (uint16_t)(*samples + (*samples < MEMORY));
    r->error += (away * away - r->error) / (float)*samples;
    r->moves += (moved * moved - r->moves) / (float)*samples;
}

static void sum_window(struct gmv_record *r, float away, float moved)
{
    r->error_sum += away * away;
    r->moves_sum += moved * moved;
    r->seen++;
}

void gmv_record_pi(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled)
{
    bool rests = setpoint_rests(r, setpoint, settled);
    if (r->samples) {
        if (rests)
            take_in_means(r, &r->samples, away, moved);
        return;
    }
    take_in_means(r, &r->of_all, away, moved);
    if (!rests)
        return;
    sum_window(r, away, moved);
    if (r->seen < ENOUGH)
        return;
    r->error = r->error_sum / (float)ENOUGH;
    r->moves = r->moves_sum / (float)ENOUGH;
    r->samples = ENOUGH;
    begin_record_window(r);
}

static float at_least(float x, float least)
{
    return x > least ? x : least;
}

/* Mean squares of the law. */
static bool is_worse(const struct gmv_record *r, float error, float moves)
{
    if (!(moves > MOVES_TIMES * at_least(r->moves, STILL * STILL)))
        return false;
    return (error > ERROR_TIMES * r->error && error > ERROR_LEAST * ERROR_LEAST) ||
           (error >= r->error && moves > MOVES_LEAST * MOVES_LEAST);
}

bool gmv_record_law(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled)
{
    bool rests = setpoint_rests(r, setpoint, settled);
    if (!rests || (!r->samples && r->of_all < ENOUGH))
        return false;
    sum_window(r, away, moved);
    if (r->seen < WINDOW)
        return false;
    bool worse = is_worse(r, r->error_sum / (float)WINDOW, r->moves_sum / (float)WINDOW);
    r->beyond = worse ? (uint8_t)(r->beyond + 1u) : 0;
    if (r->beyond >= WINDOWS)
        return true;
    begin_record_window(r);
    return false;
}

bool gmv_record_would(const struct gmv_record *r, float error_times, float moves_times)
{
    return r->samples && is_worse(r, error_times * r->error, moves_times * r->moves);
}

float gmv_record_times(const struct gmv_record *r)
{
    return real_sqrt(r->moves_sum / ((float)WINDOW * at_least(r->moves, STILL * STILL)));
}
