/* Power cuts on the flash of the board in memory, with words that do not read the same each time.
 *
 * The model: a cut interrupts one operation (program or erase). From then on every word of that operation reads what
 * stood there before or what was to stand there, independently at each reading, until it is programmed or erased
 * again; cut again before that, it may read any of the three, and so on. All other words are stable. What the firmware
 * asks for after the cut does not happen, until the power is back.
 *
 * Words are program units: 32 bits on the STM32F405, 16 on the STM32F100; cut_word says which. */
#ifndef REFLUX_TESTS_FLASH_CUT_H
#define REFLUX_TESTS_FLASH_CUT_H

#include <limits.h>
#include <stdbool.h>
#include <string.h>

#include "flash_model.h"
#include "random_source.h"

#define CUT_OTHERS                                                                                 \
    3u /* more than one cut in the same word: so many other values of it are remembered */
#define CUT_HALVES (FLASH_MODEL_SIZE / 2u)
#define CUT_NEVER  UINT_MAX

/* Ways in which unstable words are read. */
enum cut_view {
    CUT_AT_RANDOM,
    CUT_BY_START, /* at random, but all through one start the same: reading twice does not help */
    CUT_LATER,    /* as before the operation for so many readings, then as after it */
    CUT_EARLIER,  /* the other way round */
    CUT_VIEWS
};

static struct {
    uint8_t known[FLASH_MODEL_SIZE]; /* the flash, to see what an operation changes */
    uint8_t other[CUT_OTHERS][FLASH_MODEL_SIZE];
    uint8_t others[CUT_HALVES]; /* how many of them; 0 = stable */
    unsigned unstable;          /* half-words that are not */
    unsigned left;              /* operations until the cut */
    unsigned fails;      /* operations until one that is done by half and reported as not done */
    unsigned operations; /* that have been asked for, since the power is on */
    bool off;
    uint32_t word; /* 2 or 4 bytes */
    enum cut_view view;
    unsigned turn; /* of CUT_LATER and CUT_EARLIER: readings */
    unsigned readings, start;
    unsigned wrong; /* this reading since the power is on gets a word wrong; CUT_NEVER */
    /* what is programmed over unstable words leaves only the bits that all of their values leave */
    bool blend;
    struct random_source random;
} cut;

/* It is stable from now on. Does it hold what was to be written? */
static inline bool cut_settle(uint32_t half, bool erased)
{
    uint8_t *there = flash_model + 2u * half;
    uint8_t was[2] = {there[0], there[1]};
    if (!cut.others[half])
        return true;
    for (unsigned i = 0; cut.blend && !erased && i < cut.others[half]; i++) {
        there[0] &= cut.other[i][2u * half];
        there[1] &= cut.other[i][2u * half + 1u];
    }
    cut.unstable--;
    cut.others[half] = 0;
    return memcmp(was, there, 2) == 0;
}

/* One more value the half-word may read. */
static inline void cut_remember(uint32_t half, const uint8_t *value)
{
    if (memcmp(value, flash_model + 2u * half, 2) == 0)
        return;
    for (unsigned i = 0; i < cut.others[half]; i++)
        if (memcmp(value, cut.other[i] + 2u * half, 2) == 0)
            return;
    cut.unstable += cut.others[half] == 0;
    if (cut.others[half] < CUT_OTHERS)
        cut.others[half]++;
    memcpy(cut.other[cut.others[half] - 1u] + 2u * half, value, 2);
}

/* flash_model_keep: the operation has been done to flash_model. */
static inline bool cut_keep(uint32_t address, uint32_t n)
{
    if (cut.off) {
        memcpy(flash_model + address, cut.known + address, n);
        return false;
    }
    bool whole = cut.fails != 0;
    cut.operations++;
    if (!whole)
        memcpy(flash_model + address + n / 2u, cut.known + address + n / 2u, n - n / 2u);
    if (cut.fails != CUT_NEVER)
        cut.fails = cut.fails > 0 ? cut.fails - 1u : CUT_NEVER;
    cut.off = cut.left == 0;
    if (cut.left != CUT_NEVER && cut.left > 0)
        cut.left--;
    for (uint32_t half = address / 2u; half < (address + n) / 2u; half++) {
        if (cut.off)
            cut_remember(half, cut.known + 2u * half);
        else
            whole = cut_settle(half, n == FLASH_MODEL_SECTOR_SIZE) && whole;
    }
    memcpy(cut.known + address, flash_model + address, n);
    return !cut.off && whole;
}

/* Which of so many values is read this time. */
static inline unsigned cut_choose(uint32_t word, unsigned values)
{
    struct random_source by_start = {cut.start * 2654435761u ^ word * 40503u};
    switch (cut.view) {
    case CUT_BY_START:
        (void)random_next(&by_start);
        return random_below(&by_start, values);
    case CUT_LATER:
        return cut.readings < cut.turn ? values - 1u : 0;
    case CUT_EARLIER:
        return cut.readings < cut.turn ? 0 : values - 1u;
    default:
        return random_below(&cut.random, values);
    }
}

/* flash_model_glance */
static inline void cut_glance(uint32_t address, uint8_t *data, uint32_t n)
{
    unsigned choice = 0;
    uint32_t last = UINT32_MAX;
    if (cut.readings++ == cut.wrong) {
        uint32_t size = n < 4 ? n : 4, at = size * random_below(&cut.random, n / size);
        uint32_t way = random_below(&cut.random, 3); /* as if erased, as if zero, one bit */
        for (uint32_t i = at; i < at + size; i++)
            data[i] = way == 0 ? 0xFF : way == 1 ? 0 : (uint8_t)(data[i] ^ (i == at));
    }
    if (!cut.unstable)
        return;
    for (uint32_t i = address; i < address + n; i++) {
        unsigned others = cut.others[i / 2u];
        if (!others)
            continue;
        if (i / cut.word != last)
            choice = cut_choose(i / cut.word, CUT_OTHERS + 1u);
        last = i / cut.word;
        unsigned which = choice % (others + 1u);
        if (cut.view == CUT_LATER || cut.view == CUT_EARLIER)
            which = choice ? others : 0;
        if (which)
            data[i - address] = cut.other[which - 1u][i];
    }
}

static inline void cut_power_on(void)
{
    cut.off = false;
    cut.left = cut.fails = CUT_NEVER;
    cut.operations = cut.readings = 0;
    cut.wrong = CUT_NEVER;
    cut.start++;
}

/* All of the flash is as it is now, and stable. */
static inline void cut_begin(uint64_t seed)
{
    memcpy(cut.known, flash_model, sizeof cut.known);
    memset(cut.others, 0, sizeof cut.others);
    cut.unstable = 0;
    cut.word = 4;
    cut.view = CUT_AT_RANDOM;
    cut.blend = false;
    cut.start = (unsigned)seed;
    cut.random.state = seed;
    cut_power_on();
    flash_model_keep = cut_keep;
    flash_model_glance = cut_glance;
}

#endif
