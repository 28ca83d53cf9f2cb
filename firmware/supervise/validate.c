#include "supervise/validate.h"

#include "base/elapsed.h"
#include "exchange/span.h"
#include "supervise/blocks.h"
#include "supervise/by_board.h"
#include "supervise/calibration.h"
#include "supervise/estimates.h"
#include "supervise/safe_state.h"
#include "supervise/sampling.h"
#include "supervise/setpoint.h"
#include "supervise/setpoint_cascade.h"
#include "supervise/watch.h"

/* Returns true if the reading has not moved for too long. Counts from the last change of the number that the plant
 * delivered. */
static bool frozen(struct measurement_state *m, float value, float limit_s, uint64_t came_ms)
{
    if (!m->delivered || value != m->last) {
        m->delivered = true;
        m->last = value;
        m->changed_ms = came_ms;
    }
    return limit_s > 0.0f && elapsed_ms(came_ms, m->changed_ms) >= limit_s * 1000.0f;
}

/* Returns true if the reading is further from the last valid value than the process can have moved since. A spike
 * is over with the next reading; a true jump is valid once there was time for it. */
static bool too_fast(const struct measurement_state *m, float value, float limit, uint64_t came_ms)
{
    if (limit == 0.0f || !m->valid)
        return false;
    float way = value > m->last_valid ? value - m->last_valid : m->last_valid - value;
    return way > limit * (elapsed_ms(came_ms, m->valid_ms) / 1000.0f);
}

/* Judges a reading. value: the reading, calibrated. came_ms: plant time at which the sample came. */
static enum measurement_fault judge(struct supervisor *s, uint8_t i, const struct reading *r,
                                    float value, uint64_t came_ms)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    float before = m->last;
    if (r->quality == QUALITY_MISSING)
        return MEASUREMENT_MISSING;
    if (!quality_usable(r->quality))
        return MEASUREMENT_FLAGGED;
    if (!float_is_finite(value))
        return MEASUREMENT_NOT_A_NUMBER;
    /* Interlocks look at `raw`: a number that the plant does not call good must not release one. */
    m->raw = value - measurement_offset_in_force(m, c);
    bool still = frozen(m, r->value, c->frozen_s, came_ms);
    if (!calibration_believes(s->plan, i, value))
        return MEASUREMENT_OUT_OF_RANGE;
    if (still)
        return MEASUREMENT_FROZEN;
    bool fast = too_fast(m, value, c->rate_limit, came_ms);
    if (watch_first_is_wrong(s, i, value, calibrated(c, before), fast))
        return MEASUREMENT_FINE;
    return fast ? MEASUREMENT_TOO_FAST : MEASUREMENT_FINE;
}

/* Takes a usable value, read or substituted. */
static void take(struct measurement_state *m, const struct measurement_config *c, float value,
                 enum quality quality)
{
    num_t x = span_to_fraction(value, c->lo, c->hi);
    /* Nothing older is worth keeping. */
    if (!m->seen || !quality_usable(m->quality))
        lag_reset(&m->filter, x);
    /* A substituted value comes in every tick, which is not the filter's interval. */
    if (m->fault != MEASUREMENT_FINE && sampling_every(c) > 1)
        lag_reset(&m->filter, x);
    m->value = lag_step(&m->filter, x);
    m->seen = true;
    m->quality = quality;
}

/* Reads the source of an inferred value, EU: the value applied to an output, or its read-back, one tick late; or an
 * estimate as it was at the end of the last tick, if it was valid then. */
static bool inferred_from(const struct supervisor *s, uint8_t i, float *value)
{
    uint8_t j = s->plan->infer[i];
    if (!s->plan->config.measurement[i].infer[0] || j == PLAN_NONE)
        return false;
    if (CONFIG_BLOCKS && (j & INFER_IS_ESTIMATE))
        return estimate_stands_in(&s->measurement[j & ~INFER_IS_ESTIMATE], value);
    const struct mv_config *o = &s->plan->config.mv[j];
    *value = span_to_eu(s->mv[j].applied, o->lo, o->hi);
    return s->mv[j].bound;
}

/* The number comes from another source now, and may differ. Loops that act on it continue from their outputs,
 * because the difference between a sensor and the value that stands in for it is no change of the process. */
static void set_inferred(struct supervisor *s, uint8_t i, bool inferred, float value)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    if (m->inferred == inferred)
        return;
    m->inferred = inferred;
    lag_reset(&m->filter, span_to_fraction(value, c->lo, c->hi));
    for (uint8_t k = 0; k < s->placed[PLACED_LOOPS]; k++)
        if (s->plan->loop[k].pv == i && loop_acts(s, k))
            s->loop[k].transfer_pending = true;
}

static bool infer(struct supervisor *s, uint8_t i)
{
    const struct measurement_config *c = &s->plan->config.measurement[i];
    float value;
    if (!inferred_from(s, i, &value))
        return false;
    value = c->infer_offset + c->infer_gain * value;
    if (!near_span(value, c->lo, c->hi))
        return false;
    set_inferred(s, i, true, value);
    take(&s->measurement[i], c, value, QUALITY_UNCERTAIN);
    return true;
}

static void loops_to_manual(struct supervisor *s, uint8_t measurement, enum by_board_cause cause)
{
    for (uint8_t k = 0; k < s->placed[PLACED_LOOPS]; k++)
        if (s->plan->loop[k].pv == measurement) {
            setpoint_return(s, k);
            board_to_manual(s, k, cause);
        }
}

static void fall_back(struct supervisor *s, uint8_t i, float reading)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    if (!m->alarm) {
        m->alarm = true;
        event_put(s->events, s->time_ms, EVENT_MEASUREMENT_BAD, c->name,
                  float_is_finite(reading) ? reading : m->last_valid, m->fault);
    }
    m->lost = !m->valid || sampling_without_s(s, i) > c->sensor_hold_s;
    if (infer(s, i))
        return;
    if (!m->lost && c->fallback != FALLBACK_MANUAL) {
        m->quality = QUALITY_UNCERTAIN; /* held */
        return;
    }
    if (c->fallback == FALLBACK_SUBSTITUTE) {
        take(m, c, c->substitute, QUALITY_UNCERTAIN);
        return;
    }
    bool news = m->quality != QUALITY_BAD;
    m->quality = QUALITY_BAD;
    loops_to_manual(s, i, BY_BOARD_BAD);
    if (news && c->fallback == FALLBACK_SAFE)
        supervisor_outputs_safe(s, c->name);
}

/* Keeps loops from an estimate that has been uncertain for longer than `hold`. */
static void keep_from_loops(struct supervisor *s, uint8_t i)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    m->doubted = true;
    if (!loop_acts_on(s, i))
        return;
    loops_to_manual(s, i, BY_BOARD_DOUBTED);
    event_put(s->events, s->time_ms, EVENT_DOUBTFUL, c->name, m->raw, 0);
    if (c->fallback == FALLBACK_SAFE)
        supervisor_outputs_safe(s, c->name);
}

/* Takes an uncertain estimate. Returns false if the reading is none. */
static bool take_uncertain_estimate(struct supervisor *s, uint8_t i, enum quality quality)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    m->doubted = false;
    if (!CONFIG_BLOCKS || !plan_is_estimate(s->plan, i) || quality == QUALITY_GOOD)
        return false;
    bool doubted = sampling_without_s(s, i) > c->sensor_hold_s; /* since the last good one */
    if (doubted && infer(s, i))
        return true;
    set_inferred(s, i, false, m->raw);
    if (doubted && c->fallback == FALLBACK_SUBSTITUTE) {
        take(m, c, c->substitute, QUALITY_UNCERTAIN);
        return true;
    }
    take(m, c, m->raw, QUALITY_UNCERTAIN);
    if (doubted)
        keep_from_loops(s, i);
    return true;
}

void validate_measurement(struct supervisor *s, uint8_t i, const struct reading *r)
{
    struct measurement_state *m = &s->measurement[i];
    const struct measurement_config *c = &s->plan->config.measurement[i];
    if (!m->bound) {
        /* Nobody looks at an unbound measurement, and its old value says nothing about the values after it is bound
         * again. */
        m->quality = QUALITY_MISSING;
        m->valid = m->delivered = false;
        return;
    }
    if (!sampling_due(s, i, c))
        return; /* its value and quality stay as they are */
    uint64_t came_ms = sampling_ms(s, m, c);
    float value = calibrated(c, r->value);
    m->fault = (uint8_t)judge(s, i, r, value, came_ms);
    watch_age(m, value);
    if (m->fault != MEASUREMENT_FINE) {
        fall_back(s, i, value);
        return;
    }
    bool outside = m->raw < c->lo || m->raw > c->hi;
    enum quality quality = outside ? QUALITY_UNCERTAIN : r->quality;
    if (!take_uncertain_estimate(s, i, quality)) {
        set_inferred(s, i, false, m->raw);
        take(m, c, m->raw, quality);
        m->valid_ms = came_ms;
    }
    m->valid = true;
    m->lost = false;
    m->last_valid = value;
    if (m->alarm) {
        m->alarm = false;
        event_put(s->events, s->time_ms, EVENT_MEASUREMENT_GOOD, c->name, value, 0);
    }
}

/* Reports following. Control works with the value that was really applied from the first difference on; the
 * operator hears of it after follow_s. */
static void report_following(struct supervisor *s, uint8_t j, bool differs, float value)
{
    struct mv_state *o = &s->mv[j];
    const struct mv_config *c = &s->plan->config.mv[j];
    if (differs && !o->not_following)
        o->differs_ms = s->time_ms;
    o->not_following = differs;
    bool alarm =
        differs && (o->alarm || elapsed_ms(s->time_ms, o->differs_ms) >= c->follow_s * 1000.0f);
    if (alarm != o->alarm)
        event_put(s->events, s->time_ms, alarm ? EVENT_NOT_FOLLOWING : EVENT_FOLLOWING, c->name,
                  value, 0);
    o->alarm = alarm;
}

void validate_readback_sent(struct supervisor *s, uint8_t j, const struct reading *r)
{
    struct mv_state *o = &s->mv[j];
    const struct mv_config *c = &s->plan->config.mv[j];
    bool differs = false;
    if (o->bound && o->sent && quality_usable(r->quality) && float_is_finite(r->value) &&
        near_span(r->value, c->lo, c->hi)) {
        o->readback = span_to_fraction(r->value, c->lo, c->hi);
        num_t gap = num_abs(num_sub(o->readback, o->constrained));
        /* It must come back within half the band, so that noise at the edge is not reported in every tick. */
        float band = o->not_following ? 0.5f * c->readback_band : c->readback_band;
        differs = num_lt(num_from_float(band), gap);
    }
    report_following(s, j, differs, r->value);
}
