#include "kinds/gmv/gmv_record.h"

#include "kinds/gmv/gmv_record_state.h"
#include "num/real.h"

/* Steps at rest of a window, and windows in a row. */
#define WINDOW  64u
#define WINDOWS 2u
/* Samples at rest that make a record; samples that it remembers. */
#define ENOUGH 32u
#define MEMORY 256u
/* Mean squares of a law that does worse, as multiples of the PI's; and its least error, fraction of span, r.m.s. */
#define ERROR_TIMES 4.0f
#define MOVES_TIMES 9.0f
#define ERROR_LEAST 0.005f
/* Moves of MOVES_TIMES are too large even at the PI's error, if they exceed this, r.m.s. */
#define MOVES_LEAST 0.005f
/* A PI that does not move at all counts as moving by this, r.m.s. */
#define STILL 1e-4f
/* The squared mean size of white noise is 2/pi of its mean square. The mean square of its second differences is six times its
 * own. */
#define MEAN_OF_SQUARE   0.63661977f
#define SQUARE_OF_JITTER (1 / (6 * MEAN_OF_SQUARE))

/* Answers to setpoints: steps that are remembered; steps that are enough to compare; least ratio of the law's error to the PI's; least
 * mean error of the law, because noise must not count while an outer loop moves the setpoint a little. */
#define ANSWERS_MEMORY 512u
#define ANSWERS_ENOUGH 128u
#define ANSWER_TIMES   1.3f
#define ANSWER_LEAST   0.002f
/* With fewer answers of the PI, and perhaps nothing at rest, the law must be TIMES_OF_FEW times worse. */
#define FEW_ANSWERS  32u
#define TIMES_OF_FEW 3.0f
/* An answer is complete when the PV is within this part of the next move. */
#define ANSWER_NEAR 0.2f

static void begin_record_window(struct gmv_record *r)
{
    r->window_samples = 0;
    r->error_sum = r->moves_sum = 0;
}

void gmv_record_begin(struct gmv_record *r)
{
    r->steps_at_rest = 0;
    r->worse_windows = 0;
    r->answers = false;
    r->law = (struct gmv_answers){0};
    begin_record_window(r);
}

static void take_in_answer(struct gmv_record *r, struct gmv_answers *whose, float change,
                           float away)
{
    bool cut = r->answers && change > 0 && real_abs(r->before[0]) > ANSWER_NEAR * change;
    r->answers = r->answers || change > 0;
    if (!r->answers)
        return;
    whose->samples = (uint16_t)(whose->samples + (whose->samples < ANSWERS_MEMORY));
    whose->error += (real_abs(away) - whose->error) / (float)whose->samples;
    whose->move += (change - whose->move) / (float)whose->samples;
    whose->cut_share += ((cut ? 1 : 0) - whose->cut_share) / (float)whose->samples;
}

/* Returns whether there are as many samples of the PI's answers and none was cut short. */
static bool answers_are_whole(const struct gmv_record *r, unsigned samples)
{
    return r->pi.samples >= samples && r->pi.move > 0 &&
           r->pi.cut_share * (float)ANSWERS_MEMORY < 0.5f;
}

float gmv_record_answer(const struct gmv_record *r)
{
    return answers_are_whole(r, ANSWERS_ENOUGH) ? r->pi.error / r->pi.move : 0;
}

/* Returns the PI's mean error after setpoints, scaled to the moves under the law. Noise and loads do not scale with the
 * move, so after smaller moves their size at rest is added. */
static float answer_of_pi(const struct gmv_record *r)
{
    float part = r->law.move / r->pi.move;
    float at_rest = r->samples ? real_sqrt(MEAN_OF_SQUARE * r->error) : 0;
    return part * r->pi.error + (part < 1 ? (1 - part) * at_rest : 0);
}

/* Returns the law's error after setpoints as a multiple of the PI's where that is too large; 0: it is not, or there are too few answers. */
static float worse_answers(const struct gmv_record *r)
{
    float most = r->pi.samples >= ANSWERS_ENOUGH ? ANSWER_TIMES : TIMES_OF_FEW;
    float of_pi = answers_are_whole(r, FEW_ANSWERS) ? answer_of_pi(r) : 0, of_law = r->law.error;
    bool enough = r->law.samples >= ANSWERS_ENOUGH && of_law > ANSWER_LEAST;
    return enough && of_pi > 0 && of_law > most * of_pi ? of_law / of_pi : 0;
}

/* Takes a sample. True: it is at rest. Until the setpoint has settled the sample belongs to the answers of `whose`, except where the MV
 * stands still. */
static bool setpoint_rests(struct gmv_record *r, float setpoint, float away, float moved,
                           uint32_t settled, struct gmv_answers *whose)
{
    bool answers = r->steps_at_rest + 1u < settled && real_abs(moved) >= GMV_STANDS_STILL;
    float change = r->has_setpoint ? real_abs(setpoint - r->setpoint) : 0;
    r->has_setpoint = true;
    if (change > 0 || answers)
        take_in_answer(r, whose, change, away);
    if (setpoint != r->setpoint)
        r->steps_at_rest = 0;
    else if (r->steps_at_rest < UINT32_MAX)
        r->steps_at_rest++;
    r->setpoint = setpoint;
    return r->steps_at_rest >= settled;
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
    r->window_samples++;
}

/* Takes the second difference of three readings at rest. Keeps its mean size, because a rare load must not count as noise. */
static void take_in_jitter(struct gmv_record *r, float away, bool rests)
{
    float second = real_abs(away - 2 * r->before[0] + r->before[1]);
    if (rests) {
        r->jitters = (uint16_t)(r->jitters + (r->jitters < MEMORY));
        r->jitter += (second - r->jitter) / (float)r->jitters;
    }
    r->before[1] = r->before[0];
    r->before[0] = away;
}

void gmv_record_pi(struct gmv_record *r, float setpoint, float away, float moved, uint32_t settled)
{
    bool rests = setpoint_rests(r, setpoint, away, moved, settled, &r->pi);
    take_in_jitter(r, away, rests);
    if (r->samples) {
        if (rests)
            take_in_means(r, &r->samples, away, moved);
        return;
    }
    take_in_means(r, &r->any_samples, away, moved);
    if (!rests)
        return;
    sum_window(r, away, moved);
    if (r->window_samples < ENOUGH)
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

/* Returns whether these mean squares of the law are worse than the PI's. */
static bool is_worse(const struct gmv_record *r, float error, float moves)
{
    if (!(moves > MOVES_TIMES * at_least(r->moves, STILL * STILL)))
        return false;
    return (error > ERROR_TIMES * r->error && error > ERROR_LEAST * ERROR_LEAST) ||
           (error >= r->error && moves > MOVES_LEAST * MOVES_LEAST);
}

/* Returns the moves of the window that is over as a multiple of the PI's. */
static float times_the_moves(const struct gmv_record *r)
{
    return real_sqrt(r->moves_sum / ((float)WINDOW * at_least(r->moves, STILL * STILL)));
}

static float worse_at_rest(struct gmv_record *r, float away, float moved)
{
    if (!r->samples && r->any_samples < ENOUGH)
        return 0;
    sum_window(r, away, moved);
    if (r->window_samples < WINDOW)
        return 0;
    bool worse = is_worse(r, r->error_sum / (float)WINDOW, r->moves_sum / (float)WINDOW);
    float times = times_the_moves(r);
    r->worse_windows = worse ? (uint8_t)(r->worse_windows + 1u) : 0;
    begin_record_window(r);
    return r->worse_windows >= WINDOWS ? times : 0;
}

float gmv_record_law(struct gmv_record *r, float setpoint, float away, float moved,
                     uint32_t settled)
{
    bool rests = setpoint_rests(r, setpoint, away, moved, settled, &r->law);
    float times = worse_answers(r);
    if (times > 0)
        return times;
    return rests ? worse_at_rest(r, away, moved) : 0;
}

uint32_t gmv_record_rests(const struct gmv_record *r)
{
    return r->steps_at_rest;
}

float gmv_record_error(const struct gmv_record *r)
{
    return r->error;
}

float gmv_record_noise(const struct gmv_record *r)
{
    float square = SQUARE_OF_JITTER * r->jitter * r->jitter;
    return square < r->error ? square : r->error;
}

bool gmv_record_would(const struct gmv_record *r, float error, float moves)
{
    return r->samples && is_worse(r, error, moves);
}
