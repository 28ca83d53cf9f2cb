/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "outputs/mains.h"

#include "hal/pulse.h"

#define DEAD_MS    5u /* less than 0.75 of half a cycle at 65 Hz */
#define SECOND_MS  1000u
#define PATIENCE_S 3u /* before they are told as missing */
#define US_PER_MS  1000u
#define MHZ        1000u /* in a hertz */
#define SINCE_MOST UINT16_MAX

#define MADE_UP_MAX 8u /* crossings of 65 Hz in MAINS_LOST_MS */

#define MHZ_OF_ONE_IN_A_MS 1000000u

void mains_open(struct mains *m, hal_pin pin)
{
    *m = (struct mains){.pin = pin};
    if (pin == HAL_PIN_NONE || hal_pulse_open(pin) != ERR_OK)
        return;
    hal_pulse_set_dead_time(pin, DEAD_MS);
    m->edges = hal_pulse_count(pin);
}

static uint16_t mains_grown(uint16_t ms, uint32_t elapsed_ms)
{
    return ms + elapsed_ms < SINCE_MOST ? (uint16_t)(ms + elapsed_ms) : SINCE_MOST;
}

static void mains_lose(struct mains *m)
{
    m->missed = m->missed || m->found;
    m->found = false;
    m->counts = false;
}

static void mains_begin_second(struct mains *m)
{
    m->counts = true;
    m->second_ms = 0;
    m->crossings = 0;
}

/* A second is over, from a crossing to a crossing. */
static void mains_judge_second(struct mains *m)
{
    uint32_t mhz = m->crossings * MHZ_OF_ONE_IN_A_MS / m->second_ms;
    uint32_t per_cycle = mhz > MAINS_HZ_HI * MHZ ? 2u : 1u;
    if (mhz < MAINS_HZ_LO * MHZ * per_cycle || mhz > MAINS_HZ_HI * MHZ * per_cycle) {
        mains_lose(m);
    } else {
        m->found = true;
        m->missed = false;
        m->per_cycle = (uint8_t)per_cycle;
        m->period_us = m->second_ms * US_PER_MS / m->crossings;
    }
    mains_begin_second(m);
}

/* Crossings that have not come and should have, at the time they should have come. */
static uint32_t mains_make_up(struct mains *m)
{
    uint32_t n = 0;
    uint32_t since_us = m->since_ms * US_PER_MS;
    while (n < MADE_UP_MAX && since_us >= m->period_us / 4u * 5u) {
        since_us -= m->period_us;
        n++;
    }
    if (n != 0)
        m->since_ms = (uint16_t)(since_us / US_PER_MS);
    return n;
}

/* Whether an edge in this turn is a crossing. */
static bool mains_is_crossing(const struct mains *m)
{
    if (!m->counts)
        return true;
    return m->found ? m->since_ms * US_PER_MS >= m->period_us / 4u * 3u : m->since_ms >= DEAD_MS;
}

uint32_t mains_pass(struct mains *m, uint32_t elapsed_ms)
{
    if (m->pin == HAL_PIN_NONE)
        return 0;
    uint32_t edges = hal_pulse_count(m->pin), n = 0;
    bool edge = edges != m->edges;
    m->edges = edges;
    m->since_ms = mains_grown(m->since_ms, elapsed_ms);
    m->silent_ms = mains_grown(m->silent_ms, elapsed_ms);
    m->second_ms = mains_grown(m->second_ms, elapsed_ms);
    m->unfound_ms = m->found ? 0 : mains_grown(m->unfound_ms, elapsed_ms);
    if (m->silent_ms >= MAINS_LOST_MS)
        mains_lose(m);
    if (edge && mains_is_crossing(m)) {
        m->since_ms = m->silent_ms = 0;
        if (!m->counts)
            mains_begin_second(m);
        else
            n = 1;
    } else if (m->found) {
        n = mains_make_up(m);
    }
    m->crossings = (uint16_t)(m->crossings + n);
    if (n != 0 && m->silent_ms == 0 && m->second_ms >= SECOND_MS)
        mains_judge_second(m);
    return m->found ? n : 0;
}

uint32_t mains_late_ms(const struct mains *m)
{
    return m->since_ms;
}

bool mains_found(const struct mains *m)
{
    return m->found;
}

bool mains_missed(const struct mains *m)
{
    return m->missed || m->unfound_ms >= PATIENCE_S * SECOND_MS;
}

uint32_t mains_cycles_ms(const struct mains *m, uint32_t cycles)
{
    return (cycles * m->per_cycle * m->period_us + US_PER_MS / 2u) / US_PER_MS;
}

uint32_t mains_cycles_crossings(const struct mains *m, uint32_t cycles)
{
    return cycles * m->per_cycle;
}

float mains_hz(const struct mains *m)
{
    return m->found ? 1e6f / (float)(m->per_cycle * m->period_us) : 0.0f;
}
