/* Records the writes of a save or a start to the flash and replays them up to a cut; then a start, which must find the settings from
 * before or those of the save, whole. */
#ifndef REFLUX_TESTS_FLASH_RECORDING_H
#define REFLUX_TESTS_FLASH_RECORDING_H

#include "random_source.h"
#include "storage_bench.h"

static struct random_source random_source;
static unsigned long states;
static uint32_t stride = 5; /* one state of so many; odd, so that all bits have their turn */

/* The first of a row of states that is tried. */
static inline uint32_t some(void)
{
    return stride > 1 ? random_below(&random_source, stride) : 0;
}

/* ---- recording what a save or a start does to the flash ---- */

#define STEPS_MAX 600u

struct step {
    uint32_t address, n;
    bool erase;
    uint8_t data[STORAGE_PIECE];
};

static struct recording {
    uint8_t before[FLASH_MODEL_SIZE];
    struct step step[STEPS_MAX];
    unsigned n;
} first;

static struct recording *recording;

static inline bool keep(uint32_t address, uint32_t n)
{
    if (!recording)
        return true;
    TEST_ASSERT_TRUE(recording->n < STEPS_MAX);
    struct step *s = &recording->step[recording->n++];
    *s = (struct step){.address = address, .n = n, .erase = n == FLASH_MODEL_SECTOR_SIZE};
    if (!s->erase) {
        TEST_ASSERT_TRUE(n <= STORAGE_PIECE);
        memcpy(s->data, flash_model + address, n);
    }
    return true;
}

static inline void record_into(struct recording *r)
{
    memcpy(r->before, flash_model, sizeof flash_model);
    r->n = 0;
    recording = r;
}

static inline void stop_recording(void)
{
    recording = NULL;
}

/* The flash after the first `steps` of the recording. */
static inline void replay(const struct recording *r, unsigned steps)
{
    memcpy(flash_model, r->before, sizeof flash_model);
    for (unsigned i = 0; i < steps; i++) {
        const struct step *s = &r->step[i];
        if (s->erase)
            memset(flash_model + s->address, 0xFF, s->n);
        else
            memcpy(flash_model + s->address, s->data, s->n);
    }
}

/* ... and the first `bits` of the step after them, which programs. */
static inline void tear_program(const struct recording *r, unsigned step, uint32_t bits)
{
    const struct step *s = &r->step[step];
    replay(r, step);
    for (uint32_t i = 0; i < (bits + 7u) / 8u; i++) {
        uint32_t whole = bits - 8u * i;
        uint32_t left = whole >= 8u ? 0 : 0xFFu << whole; /* bits still as erased */
        uint8_t torn = (uint8_t)(s->data[i] | left);
        flash_model[s->address + i] &= torn;
    }
}

/* ... or an erase that has come as far as way number `way` says. */
#define ERASE_WAYS 120u

static inline void tear_erase(const struct recording *r, unsigned step, unsigned way)
{
    const struct step *s = &r->step[step];
    uint8_t *sector = flash_model + s->address;
    replay(r, step);
    if (way == 0)
        return;
    if (way == 1) {
        memset(sector, 0xFF, s->n);
    } else if (way < 10) { /* a beginning */
        memset(sector, 0xFF, s->n / 10u * way);
    } else if (way < 60) { /* random words everywhere */
        for (uint32_t i = 0; i < s->n; i++)
            sector[i] = (uint8_t)random_next(&random_source);
    } else if (way < 100) { /* some words random, the others as they were */
        for (uint32_t i = 0; i < s->n; i += 4)
            if (random_below(&random_source, 4) == 0)
                for (uint32_t k = 0; k < 4; k++)
                    sector[i + k] = (uint8_t)random_next(&random_source);
    } else { /* almost: one bit has stayed */
        memset(sector, 0xFF, s->n);
        sector[random_below(&random_source, s->n)] ^=
            (uint8_t)(1u << random_below(&random_source, 8));
    }
}

/* ---- what a start must find ---- */

static struct config nothing, older, newer;

static inline bool stored(const struct config *config)
{
    return bench_is(config) && (bench_is(&nothing) || seen[EVENT_STORAGE_LOADED] == 1);
}

static inline void fail(const char *what, unsigned step, uint32_t part)
{
    char text[160];
    snprintf(text, sizeof text, "%s: step %u, part %u", what, step, (unsigned)part);
    TEST_FAIL_MESSAGE(text);
}

static inline void expect_one_of(const struct config *a, const struct config *b, const char *what,
                                 unsigned step, uint32_t part)
{
    bench_boot();
    states++;
    if (!stored(a) && !stored(b))
        fail(what, step, part);
    if (bench_is(&nothing) && fw.storage.remains != (seen[EVENT_STORAGE_DAMAGED] == 1))
        fail("no alarm", step, part);
}

/* Every cut of what has been recorded; the last step whole is no cut any more. */
static inline void cut_everywhere(const struct recording *r, const struct config *before,
                                  const struct config *after)
{
    for (unsigned step = 0; step < r->n; step++) {
        if (r->step[step].erase) {
            for (unsigned way = some(); way < ERASE_WAYS; way += stride) {
                tear_erase(r, step, way);
                expect_one_of(before, after, "erase", step, way);
            }
            continue;
        }
        bool last = step + 1 == r->n;
        for (uint32_t bits = some(); bits < 8u * r->step[step].n + last; bits += stride) {
            tear_program(r, step, bits);
            expect_one_of(before, after, "program", step, bits);
        }
    }
    replay(r, r->n);
    expect_one_of(after, after, "end", r->n, 0);
}

static inline void record_save(struct recording *r, const struct config *config)
{
    bench_put(config);
    record_into(r);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    stop_recording();
}

#endif
