#include "commission/test_verdict.h"

#include "base/assertion.h"

#define PART_POINTS   2u /* at least, in each part that is averaged */
#define ASYMMETRY_SDS REAL_C(3.0)
#define STANDS_OUT    REAL_C(6.0) /* standard deviations of the changes */

/* One level between two edges, in points. */
struct level {
    uint32_t from, to;
};

static struct level level_between(const struct record *r, uint32_t begin, uint32_t end)
{
    struct level l = {begin / r->block + 1u, end / r->block};
    if (l.to > r->points)
        l.to = r->points;
    return l;
}

/* Mean deviation from the baseline over the points from..to. */
static real_t mean_over(const struct record *r, uint8_t j, const struct baseline *b, uint32_t from,
                        uint32_t to)
{
    REFLUX_ASSERT(j < CHANNEL_MAX && from < to && to <= r->points);
    real_t sum = REAL_C(0.0);
    for (uint32_t i = from; i < to; i++) /* RECORD_POINTS at most */
        sum += r->y[j][i] - b->offset - b->slope_per_s * record_time(r, i);
    return sum / (real_t)(to - from);
}

/* Changes in the first and second half of a level, from means of a sixth each at its ends and in the middle. */
static bool level_halves(const struct record *r, uint8_t j, const struct baseline *b,
                         const struct level *l, real_t *first, real_t *second)
{
    if (l->to < l->from + 6u * PART_POINTS)
        return false;
    uint32_t n = (l->to - l->from) / 6u, middle = (l->from + l->to) / 2u;
    real_t begins = r->y[j][l->from] - b->offset - b->slope_per_s * record_time(r, l->from);
    real_t half = mean_over(r, j, b, middle - n / 2u, middle - n / 2u + n);
    real_t ends = mean_over(r, j, b, l->to - n, l->to);
    *first = half - begins;
    *second = ends - half;
    return true;
}

static real_t end_of(const struct record *r, uint8_t j, const struct baseline *b,
                     const struct level *l)
{
    uint32_t n = (l->to - l->from) / 4u;
    return mean_over(r, j, b, l->to - n, l->to);
}

static bool long_enough(const struct level *l)
{
    return l->to >= l->from + 4u * PART_POINTS;
}

/* Returns 1 where the input paused at 0 between the halves, else 0. */
static uint32_t test_verdict_paused(const struct excitation *u)
{
    return u->edges > 3u && u->edge[u->edges - 3u].change < REAL_C(0.0);
}

void test_verdict_of(const struct record *r, uint8_t j, const struct baseline *b, real_t amplitude,
                     real_t drift, struct test_verdict *result)
{
    *result = (struct test_verdict){0};
    uint32_t edges = r->input.edges;
    if (edges < 3u)
        return;
    uint32_t paused = test_verdict_paused(&r->input);
    uint32_t up_s = r->input.edge[edges - 3u - paused].sample;
    uint32_t turn_s = r->input.edge[edges - 2u - paused].sample;
    uint32_t down_s = r->input.edge[edges - 2u].sample, back_s = r->input.edge[edges - 1u].sample;
    struct level up = level_between(r, up_s, turn_s), down = level_between(r, down_s, back_s);
    struct level back = level_between(r, back_s, r->samples);
    real_t up1, up2, down1, down2;
    if (level_halves(r, j, b, &up, &up1, &up2) && level_halves(r, j, b, &down, &down1, &down2)) {
        real_t first = real_abs(up1 - down1), second = real_abs(up2 - down2);
        real_t noise = b->noise_sd / real_sqrt((real_t)r->block);
        uint32_t shorter =
            down.to - down.from < up.to - up.from ? down.to - down.from : up.to - up.from;
        uint32_t averaged = shorter / 6u;
        result->first = first;
        result->second = second;
        result->change_sd = REAL_C(2.0) * noise / real_sqrt((real_t)averaged);
        result->moves = first + second > STANDS_OUT * noise;
        if (result->moves)
            result->climbs = second / (first > noise ? first : noise);
    }
    /* The negative half was cut short: its end is no level. */
    if (down.to - down.from + 2u < up.to - up.from)
        return;
    if (!long_enough(&up) || !long_enough(&down) || !long_enough(&back))
        return;
    real_t u = end_of(r, j, b, &up), d = end_of(r, j, b, &down), rest = end_of(r, j, b, &back);
    real_t gain[3] = {u / amplitude, (u - d) / (REAL_C(2.0) * amplitude), (rest - d) / amplitude};
    real_t lo = gain[0], hi = gain[0];
    for (unsigned i = 1; i < 3; i++) {
        lo = gain[i] < lo ? gain[i] : lo;
        hi = gain[i] > hi ? gain[i] : hi;
    }
    uint32_t n =
        (down.to - down.from < up.to - up.from ? down.to - down.from : up.to - up.from) / 4u;
    real_t noise = b->noise_sd / real_sqrt((real_t)r->block * (real_t)n); /* of a level */
    real_t three = real_sqrt(REAL_C(3.0)) * noise; /* of both levels and the rest together */
    result->spread = hi - lo;
    result->level = gain[1];
    result->level_sd = noise / (real_sqrt(REAL_C(2.0)) * amplitude);
    result->left = real_abs(rest) / (REAL_C(2.0) * amplitude);
    /* A drift that stopped, or turned, at the end of the first half. */
    real_t half_s = record_time(r, up.to) - record_time(r, up.from);
    real_t uncertain = real_sqrt(three * three + b->offset_sd * b->offset_sd);
    real_t explained = ASYMMETRY_SDS * uncertain + real_abs(drift) * half_s;
    real_t asymmetry = gain[0] - gain[2];
    if (real_abs(asymmetry) * amplitude > explained)
        result->asymmetry = asymmetry;
}

real_t test_verdict_level_of(const struct record *r, real_t dead_time_s, real_t time_constant_s)
{
    const struct excitation *u = &r->input;
    if (u->edges < 3u || !(time_constant_s > REAL_C(0.0)))
        return REAL_C(1.0);
    uint32_t paused = test_verdict_paused(u), turn = u->edges - 2u - paused;
    real_t up = (real_t)(u->edge[turn].sample - u->edge[turn - 1u].sample) * r->h_s;
    real_t down = (real_t)(u->edge[u->edges - 1u].sample - u->edge[u->edges - 2u].sample) * r->h_s;
    real_t end = REAL_C(0.875); /* the middle of the last quarter */
    real_t left_up = end * up - dead_time_s, left_down = end * down - dead_time_s;
    real_t turned = up - dead_time_s;
    if (left_up <= REAL_C(0.0) || left_down <= REAL_C(0.0))
        return REAL_C(0.0);
    real_t high = REAL_C(1.0) - real_exp(-left_up / time_constant_s);
    real_t from = paused ? REAL_C(0.0) : REAL_C(1.0) - real_exp(-turned / time_constant_s);
    real_t low = -REAL_C(1.0) + (REAL_C(1.0) + from) * real_exp(-left_down / time_constant_s);
    return (high - low) * REAL_C(0.5);
}
