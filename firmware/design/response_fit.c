#include "design/response_fit.h"

#include "interact/plant.h"

#define ZERO    REAL_C(0.0)
#define ONE     REAL_C(1.0)
#define NOTHING REAL_C(1e30) /* a square that is none */

/* Dead times that are tried at first, and then by a golden section. */
#define TRIED 25u
#define CUTS  23u
/* Weights by the time constant that they find; so often. */
#define ROUNDS 4u

/* Mean square of |model/response - 1|. */
static real_t relative_square(size_t n, const real_t *omega, const struct cplx *response,
                              const struct fopdt *m)
{
    real_t sum = ZERO;
    for (size_t i = 0; i < n; i++)
        sum += cplx_square(cplx_sub(fopdt_response(m, omega[i]), response[i])) /
               cplx_square(response[i]);
    return sum / (real_t)n;
}

/* Gain and time constant for the dead time in *m; one that is not above 0 is the least there is. */
static real_t fit_with_dead_time(size_t n, const real_t *omega, const struct cplx *response,
                                 struct fopdt *m)
{
    m->time_constant_s = ZERO;
    for (unsigned round = 0; round < ROUNDS; round++) {
        real_t one = ZERO, cross = ZERO, square = ZERO, right = ZERO, t = m->time_constant_s;
        for (size_t i = 0; i < n; i++) {
            real_t w = omega[i];
            struct cplx g = cplx_mul(response[i], cplx_turned(w * m->dead_time_s));
            real_t weight = ONE / (cplx_square(g) * (ONE + w * w * t * t));
            one += weight;
            cross += weight * w * g.im;
            square += weight * w * w * cplx_square(g);
            right += weight * g.re;
        }
        /* one K + cross T = right,  cross K + square T = 0 */
        real_t det = one * square - cross * cross;
        if (!(det > ZERO))
            return NOTHING;
        m->gain = right * square / det;
        m->time_constant_s = -cross * right / det;
        if (!(m->time_constant_s > ZERO)) {
            m->time_constant_s = ZERO;
            m->gain = right / one;
        }
    }
    return relative_square(n, omega, response, m);
}

/* With this dead time; the best of all is kept. */
static real_t try_dead_time(struct response_fit *f, size_t n, const real_t *omega,
                            const struct cplx *response, real_t dead)
{
    struct fopdt m = {.dead_time_s = dead};
    real_t square = fit_with_dead_time(n, omega, response, &m);
    if (square < f->square) {
        f->square = square;
        f->best = m;
        f->error = real_sqrt(square);
    }
    return square;
}

enum err response_fit_begin(struct response_fit *f, size_t n, const real_t *omega,
                            const struct cplx *response, real_t dead_most)
{
    if (n < 3 || !(dead_most >= ZERO && real_is_finite(dead_most)))
        return ERR_RANGE;
    for (size_t i = 0; i < n; i++) {
        real_t square = cplx_square(response[i]);
        if (!real_is_finite(omega[i]) || !real_is_finite(square))
            return ERR_NOT_FINITE;
        if (!(omega[i] > ZERO) || !(square > ZERO))
            return ERR_RANGE;
    }
    *f = (struct response_fit){.square = NOTHING, .error = NOTHING, .dead_most = dead_most};
    return ERR_OK;
}

/* Between the neighbours of the best that was tried. */
static void begin_section_of_dead_times(struct response_fit *f)
{
    real_t step = f->dead_most / (real_t)(TRIED - 1u), at = f->best.dead_time_s;
    golden_begin(&f->section, at - step > ZERO ? at - step : ZERO,
                 at + step < f->dead_most ? at + step : f->dead_most);
}

bool response_fit_piece(struct response_fit *f, size_t n, const real_t *omega,
                        const struct cplx *response)
{
    if (f->tried < TRIED) {
        real_t step = f->dead_most / (real_t)(TRIED - 1u);
        (void)try_dead_time(f, n, omega, response, step * (real_t)f->tried);
        if (++f->tried == TRIED)
            begin_section_of_dead_times(f);
        return f->dead_most > ZERO;
    }
    golden_take(&f->section, try_dead_time(f, n, omega, response, golden_next(&f->section)));
    return f->section.taken < CUTS;
}

enum err fopdt_from_response(size_t n, const real_t *omega, const struct cplx *response,
                             real_t dead_most, struct fopdt *model, real_t *error)
{
    struct response_fit f;
    enum err err = response_fit_begin(&f, n, omega, response, dead_most);
    if (err)
        return err;
    while (response_fit_piece(&f, n, omega, response))
        continue;
    if (!(f.square < NOTHING))
        return ERR_RANGE;
    *model = f.best;
    *error = f.error;
    return ERR_OK;
}
