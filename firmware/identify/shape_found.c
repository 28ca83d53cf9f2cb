#include "identify/shape_found.h"

#include <string.h>

#include "base/assertion.h"
#include "identify/common.h"
#include "num/random.h"

#define GAIN_SURE REAL_C(3.0) /* deviations from which on a gain keeps its sign */
#define GAIN_LEFT REAL_C(0.1) /* share of it that a member has at least */
#define LAG_LEFT  REAL_C(0.05)
/* Square over the square of the lag, at damping 0.09. */
#define SQUARE_MOST REAL_C(30.0)

/* Index of the residence time, which takes the place of the lag where covariances are kept. */
#define RESIDENCE SHAPE_LAG

static void to_numbers(const struct shape *s, real_t *number)
{
    number[SHAPE_GAIN] = s->gain;
    number[SHAPE_DEAD] = s->dead_time_s;
    number[RESIDENCE] = shape_residence_s(s);
    number[SHAPE_SQUARE] = s->square_s2;
    number[SHAPE_ZERO] = s->zero_s;
}

static void from_numbers(const real_t *number, struct shape *s)
{
    *s = (struct shape){.gain = number[SHAPE_GAIN],
                        .dead_time_s = number[SHAPE_DEAD],
                        .lag_s = number[RESIDENCE] - number[SHAPE_DEAD] + number[SHAPE_ZERO],
                        .square_s2 = number[SHAPE_SQUARE],
                        .zero_s = number[SHAPE_ZERO]};
}

/* The upper half of a float, rounded: sign, exponent and 8 bits of mantissa. */
static uint16_t to_half(real_t x)
{
    float value = (float)x;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return (uint16_t)((bits + 0x8000u) >> 16);
}

static real_t from_half(uint16_t half)
{
    uint32_t bits = (uint32_t)half << 16;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (real_t)value;
}

/* Row i, column j of a lower triangle with its diagonal. */
static uint32_t lower(uint32_t i, uint32_t j)
{
    return i * (i + 1u) / 2u + j;
}

void shape_found_pack(struct shape_found *f, const struct shape *chosen, uint8_t parameters,
                      const struct shape *other, uint8_t other_parameters, real_t other_weight,
                      const real_t *within, real_t lag_variance)
{
    real_t a[SHAPE_PARAMETERS], b[SHAPE_PARAMETERS];
    f->shape = *chosen;
    f->parameters = parameters;
    f->other_parameters = other_parameters;
    f->other_weight = (uint8_t)(REAL_C(255.0) * other_weight + REAL_C(0.5));
    real_t weight = (real_t)f->other_weight / REAL_C(255.0);
    to_numbers(chosen, a);
    to_numbers(other, b);
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++) {
        f->other[i] = to_half(b[i]);
        real_t apart = from_half(f->other[i]) - a[i];
        f->sd[i] = real_sqrt(within[lower(i, i)] + weight * apart * apart);
        for (uint32_t j = 0; j < i; j++) {
            real_t size = real_sqrt(within[lower(i, i)] * within[lower(j, j)]);
            real_t r = size > ZERO ? REAL_C(127.0) * within[lower(i, j)] / size : ZERO;
            r += r < ZERO ? REAL_C(-0.5) : REAL_C(0.5);
            /* Infinite covariances have no correlation. */
            r = real_within(r, REAL_C(-127.5), REAL_C(127.5)) ? r : ZERO;
            f->correlation[i * (i - 1u) / 2u + j] = (int8_t)r;
        }
    }
    f->residence_sd_s = f->sd[RESIDENCE];
    f->residence_drawn_sd_s = real_sqrt(within[lower(RESIDENCE, RESIDENCE)]);
    f->sd[SHAPE_LAG] = real_sqrt(lag_variance);
}

void shape_found_add_tails(struct shape_found *f, real_t variance)
{
    if (variance > ZERO)
        f->residence_sd_s = real_sqrt(f->residence_sd_s * f->residence_sd_s + variance);
}

real_t shape_found_other(const struct shape_found *f, struct shape *other)
{
    real_t number[SHAPE_PARAMETERS];
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++)
        number[i] = from_half(f->other[i]);
    from_numbers(number, other);
    return (real_t)f->other_weight / REAL_C(255.0);
}

/* Deviations of one shape, with the residence time, without the difference between the two; the difference. Returns the weight
 * of the other. */
static real_t deviations_within(const struct shape_found *f, real_t *sd, real_t *apart)
{
    struct shape other;
    real_t weight = shape_found_other(f, &other), a[SHAPE_PARAMETERS];
    to_numbers(&f->shape, a);
    to_numbers(&other, apart);
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++) {
        apart[i] -= a[i];
        real_t variance = f->sd[i] * f->sd[i] - weight * apart[i] * apart[i];
        sd[i] = variance > ZERO ? real_sqrt(variance) : ZERO;
    }
    sd[RESIDENCE] = f->residence_drawn_sd_s;
    return weight;
}

static real_t correlation_of(const struct shape_found *f, uint32_t i, uint32_t j)
{
    if (i == j)
        return ONE;
    uint32_t row = i > j ? i : j, column = i > j ? j : i;
    uint32_t n = row * (row - 1u) / 2u + column;
    return (real_t)f->correlation[n] / REAL_C(127.0);
}

/* Row of the lag in terms of the numbers that are kept. */
static const real_t lag_of_numbers[SHAPE_PARAMETERS] = {ZERO, -ONE, ONE, ZERO, ONE};

void shape_found_covariance(const struct shape_found *f, real_t *covariance)
{
    real_t sd[SHAPE_PARAMETERS], apart[SHAPE_PARAMETERS], lag[SHAPE_PARAMETERS];
    real_t weight = deviations_within(f, sd, apart);
    real_t *c = covariance;
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++)
        for (uint32_t j = 0; j < SHAPE_PARAMETERS; j++)
            c[SHAPE_PARAMETERS * i + j] =
                correlation_of(f, i, j) * sd[i] * sd[j] + weight * apart[i] * apart[j];
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++) {
        lag[i] = ZERO;
        for (uint32_t j = 0; j < SHAPE_PARAMETERS; j++)
            lag[i] += lag_of_numbers[j] * c[SHAPE_PARAMETERS * i + j];
    }
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++)
        c[SHAPE_PARAMETERS * i + SHAPE_LAG] = c[SHAPE_PARAMETERS * SHAPE_LAG + i] = lag[i];
    c[SHAPE_PARAMETERS * SHAPE_LAG + SHAPE_LAG] = f->sd[SHAPE_LAG] * f->sd[SHAPE_LAG];
}

/* Root of the matrix of correlations, lower triangle by rows; what rounding has made impossible counts as 0. */
static void root_of_correlations(const struct shape_found *f, real_t *root)
{
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            real_t sum = correlation_of(f, i, j);
            for (uint32_t k = 0; k < j; k++)
                sum -= root[lower(i, k)] * root[lower(j, k)];
            if (i == j)
                root[lower(i, i)] = sum > ZERO ? real_sqrt(sum) : ZERO;
            else if (root[lower(j, j)] > REAL_C(0.05))
                root[lower(i, j)] = sum / root[lower(j, j)];
            else
                root[lower(i, j)] = ZERO;
        }
    }
}

static void bound_member(const struct shape_found *f, const struct shape *centre, struct shape *s)
{
    real_t gain = centre->gain;
    if (real_abs(gain) > GAIN_SURE * f->sd[SHAPE_GAIN]) {
        real_t least = GAIN_LEFT * gain;
        if (gain > ZERO ? s->gain < least : s->gain > least)
            s->gain = least;
    }
    if (s->dead_time_s < ZERO)
        s->dead_time_s = ZERO;
    if (s->lag_s < LAG_LEFT * centre->lag_s)
        s->lag_s = LAG_LEFT * centre->lag_s;
    real_t most = SQUARE_MOST * s->lag_s * s->lag_s;
    if (s->square_s2 < ZERO)
        s->square_s2 = ZERO;
    if (s->square_s2 > most)
        s->square_s2 = most;
}

void shape_found_draw(const struct shape_found *f, uint32_t seed, uint32_t n, struct shape *member)
{
    struct random source = random_from(((uint64_t)seed << 32) | n);
    real_t sd[SHAPE_PARAMETERS], apart[SHAPE_PARAMETERS], root[15], normal[SHAPE_PARAMETERS];
    real_t number[SHAPE_PARAMETERS];
    (void)deviations_within(f, sd, apart);
    root_of_correlations(f, root);
    bool other = (random_bits(&source) >> 56) < f->other_weight;
    uint32_t parameters = other ? f->other_parameters : f->parameters;
    for (uint32_t i = 0; i < SHAPE_PARAMETERS; i++)
        normal[i] = random_normal(&source);
    struct shape centre = f->shape;
    if (other)
        (void)shape_found_other(f, &centre);
    to_numbers(&centre, number);
    for (uint32_t i = 0; i < parameters && i < SHAPE_PARAMETERS; i++) {
        real_t sum = ZERO;
        for (uint32_t j = 0; j <= i; j++)
            sum += root[lower(i, j)] * normal[j];
        number[i] += sd[i] * sum;
    }
    from_numbers(number, member);
    bound_member(f, &centre, member);
}
