/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "io/output_proof.h"

#define PASSED_MASK   0x3FFFFFFu
#define PASSED_MAX_MS PASSED_MASK /* longer than the longest window, 65535 s */
/* Least part that the last of three windows has of what all three warmed; the same heat gives a third. */
#define STILL_HEATED 0.25f

enum proof_phase {
    PHASE_NONE,         /* nothing can be said */
    PHASE_FULL,         /* on, and of a heater: below the limit */
    PHASE_SETTLING,     /* off; what was before may still show */
    PHASE_REST,         /* off, and of a heater: below the limit */
    PHASE_WARMER,       /* like that, and it was warmer at the end of a window */
    PHASE_TWICE_WARMER, /* of two */
    PHASE_HOT           /* a heater is off, at the limit or above */
};

const char *output_proof_text(uint8_t fault)
{
    static const char *const texts[PROOF_FAULTS] = {
        [PROOF_FINE] = "?",
        [PROOF_NO_HEAT] =
            "on, and nothing warms: fuse, element, wire or relay open, or sensor elsewhere",
        [PROOF_WARMS] =
            "off, and it warms: relay stuck or shorted; `enable` stays off until restart",
        [PROOF_NOT_COOLING] =
            "off, and it does not cool: relay stuck or shorted; `enable` stays off until restart",
        [PROOF_STILL_HOT] = "still not cooler: contactor stuck, or none in its way; pull the plug",
        [PROOF_NO_FLOW] = "on, and nothing flows: dry, blocked, or pump, valve or meter dead",
        [PROOF_FLOWS] = "off, and it flows: leak, siphon, or relay stuck or shorted",
    };
    return texts[fault < PROOF_FAULTS ? fault : PROOF_FINE];
}

static void open_window(struct output_proof *p, enum proof_phase phase, float first)
{
    p->phase = (uint8_t)phase & 7u;
    p->first = p->extreme = first;
    p->passed_ms = 0;
}

static void let_pass(struct output_proof *p, uint32_t ms)
{
    uint32_t room = PASSED_MAX_MS - p->passed_ms;
    p->passed_ms = (p->passed_ms + (ms < room ? ms : room)) & PASSED_MASK;
}

static void know(struct output_proof *p, enum output_proof_fault fault)
{
    p->known_fault = (uint8_t)fault & 7u;
}

/* Whether the window is as long as that. 0 s: never, because then nobody wants to know. */
static bool window_is_over(const struct output_proof *p, uint16_t window_s)
{
    return window_s != 0 && p->passed_ms >= window_s * 1000u;
}

static enum proof_phase phase_by_look(const struct output_proof *p, const struct proof_config *c,
                                      const struct output_proof_look *look)
{
    bool heater = c->kind == PROOF_KIND_WARMS, hot = heater && look->reading >= (float)c->limit;
    if (!look->usable || !float_is_finite(look->reading))
        return PHASE_NONE;
    if (look->part >= OUTPUT_PROOF_FULL)
        return hot ? PHASE_NONE : PHASE_FULL;
    if (!(look->part <= OUTPUT_PROOF_OFF && look->others <= OUTPUT_PROOF_OFF))
        return PHASE_NONE;
    if (hot)
        return PHASE_HOT;
    if (heater && !(look->elsewhere <= OUTPUT_PROOF_OFF))
        return PHASE_NONE;
    bool rests = p->phase >= PHASE_REST && p->phase <= PHASE_TWICE_WARMER;
    return rests ? (enum proof_phase)p->phase : PHASE_SETTLING;
}

/* ---- heater ---- */

static void tell_stuck(struct output_proof *p, enum output_proof_fault fault)
{
    bool already = output_proof_stuck((enum output_proof_fault)p->known_fault);
    know(p, already ? PROOF_STILL_HOT : fault);
}

/* Judges a heater that is on. */
static void judge_heat(struct output_proof *p, const struct proof_config *c, float t)
{
    if (t < p->extreme)
        p->extreme = t;
    bool warmer = t - p->extreme >= c->change, cooled = p->first - t >= c->change;
    if (!warmer && !cooled && !window_is_over(p, c->on_s))
        return;
    if (!cooled && !output_proof_stuck((enum output_proof_fault)p->known_fault))
        know(p, warmer ? PROOF_FINE : PROOF_NO_HEAT);
    open_window(p, PHASE_FULL, t);
}

/* Judges a heater that is off, below the limit. `extreme` is the reading that the first of the warmer windows began with. */
static void judge_rest(struct output_proof *p, const struct proof_config *c, float t)
{
    if (c->on_s == 0 || p->passed_ms < c->on_s * 500u)
        return;
    float risen = t - p->first, began = p->phase == PHASE_REST ? p->first : p->extreme;
    bool warmer = risen >= 0.5f * c->change;
    enum proof_phase next = PHASE_REST;
    if (warmer && p->phase == PHASE_REST) {
        next = PHASE_WARMER;
    } else if (warmer && p->phase == PHASE_WARMER) {
        next = PHASE_TWICE_WARMER;
    } else if (warmer && risen < STILL_HEATED * (t - began)) {
        next = PHASE_WARMER; /* it dies away: the count begins anew with this window */
        began = p->first;
    } else if (warmer) {
        tell_stuck(p, PROOF_WARMS);
    }
    open_window(p, next, t);
    p->extreme = began;
}

/* Judges a heater that is off, at the limit or above. */
static void judge_cooling(struct output_proof *p, const struct proof_config *c, float t)
{
    if (t > p->extreme)
        p->extreme = t;
    if (t <= p->extreme - c->change) {
        open_window(p, PHASE_HOT, t);
    } else if (window_is_over(p, c->off_s)) {
        tell_stuck(p, PROOF_NOT_COOLING);
        open_window(p, PHASE_HOT, t);
    }
}

static void step_heater(struct output_proof *p, const struct proof_config *c, float t)
{
    /* So far above the limit, below which it was said to be dead, it has come by heat. */
    if (p->known_fault == PROOF_NO_HEAT && t >= (float)c->limit + c->change)
        know(p, PROOF_FINE);
    switch ((enum proof_phase)p->phase) {
    case PHASE_FULL:
        judge_heat(p, c, t);
        break;
    case PHASE_SETTLING:
        if (window_is_over(p, c->on_s))
            open_window(p, PHASE_REST, t);
        break;
    case PHASE_REST:
    case PHASE_WARMER:
    case PHASE_TWICE_WARMER:
        judge_rest(p, c, t);
        break;
    case PHASE_HOT:
        judge_cooling(p, c, t);
        break;
    default:
        break;
    }
}

/* ---- pump or valve ---- */

/* The mean of the window is above the change, or not: fault is where it must not be so, other_fault what this says nothing of. */
static void judge_mean(struct output_proof *p, const struct proof_config *c, uint16_t window_s,
                       enum output_proof_fault fault)
{
    if (!window_is_over(p, window_s))
        return;
    float least = c->change * ((float)p->passed_ms / 1000.0f);
    bool flows = fault == PROOF_FLOWS ? p->extreme > least : p->extreme >= least;
    if (flows == (fault == PROOF_FLOWS))
        know(p, fault);
    else if (p->known_fault == (unsigned)fault)
        know(p, PROOF_FINE);
    open_window(p, (enum proof_phase)p->phase, 0.0f);
}

static void step_flow(struct output_proof *p, const struct proof_config *c, float flow,
                      uint32_t since_ms)
{
    float most = OUTPUT_PROOF_SPIKE * c->change;
    float counted = flow > most ? most : flow > 0.0f ? flow : 0.0f;
    p->extreme += counted * ((float)since_ms / 1000.0f);
    if (p->phase == PHASE_FULL)
        judge_mean(p, c, c->on_s, PROOF_NO_FLOW);
    else if (p->phase == PHASE_SETTLING && window_is_over(p, c->off_s))
        open_window(p, PHASE_REST, 0.0f);
    else if (p->phase == PHASE_REST)
        judge_mean(p, c, c->off_s, PROOF_FLOWS);
}

enum output_proof_fault output_proof_step(struct output_proof *p, const struct proof_config *c,
                                          const struct output_proof_look *look)
{
    enum proof_phase phase = phase_by_look(p, c, look);
    if (c->kind == PROOF_KIND_NONE)
        return PROOF_FINE;
    if (phase == PHASE_HOT && p->phase == PHASE_TWICE_WARMER)
        tell_stuck(p, PROOF_WARMS);
    if ((unsigned)phase != p->phase)
        open_window(p, phase, c->kind == PROOF_KIND_WARMS ? look->reading : 0.0f);
    else
        let_pass(p, look->since_ms);
    if (phase != PHASE_NONE && c->kind == PROOF_KIND_WARMS)
        step_heater(p, c, look->reading);
    else if (phase != PHASE_NONE && p->passed_ms != 0)
        step_flow(p, c, look->reading, look->since_ms);
    return (enum output_proof_fault)p->known_fault;
}
