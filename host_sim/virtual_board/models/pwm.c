/* Timers that make pulse widths at pins: TIM3 and TIM4, TIM5 of 32 bits, TIM12 with two channels. From memory: registers and bits, PWM mode 1 (the
 * output is active while the counter is below CCR), a compare value without preload that acts at once, a prescaler that an update takes over,
 * and the pins of the package with 64 pins (unverified). The world is told of each change; edges are not told one by one.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum {
    CR1 = 0x00,
    DIER = 0x0C,
    SR = 0x10,
    EGR = 0x14,
    CCMR1 = 0x18,
    CCMR2 = 0x1C,
    CCER = 0x20,
    CNT = 0x24,
    PSC = 0x28,
    ARR = 0x2C,
    CCR1 = 0x34
};

#define CR1_CEN   1u
#define EGR_UG    1u
#define CCER_E    1u
#define CCER_P    2u
#define MODE_PWM1 0x60u
#define CHANNELS  4u
#define PLACES    2u /* pins that a channel may have */
#define NO_PIN    0xFFu

#define REGS(most)                                                                                 \
    {"CR1", CR1, 0, 0x3FFu, 0x3FFu}, {"DIER", DIER, 0, 0x5F5Fu, 0x5F5Fu},                          \
        {"SR", SR, 0, 0x1E5Fu, 0}, {"EGR", EGR, 0, 0x5Fu, 0},                                      \
        {"CCMR1", CCMR1, 0, 0xFFFFu, 0xFFFFu}, {"CCMR2", CCMR2, 0, 0xFFFFu, 0xFFFFu},              \
        {"CCER", CCER, 0, 0xBBBBu, 0xBBBBu}, {"PSC", PSC, 0, 0xFFFFu, 0xFFFFu},                    \
        {"ARR", ARR, most, most, most}, {"CCR1", CCR1, 0, most, most},                             \
        {"CCR2", CCR1 + 4, 0, most, most}, {"CCR3", CCR1 + 8, 0, most, most},                      \
    {                                                                                              \
        "CCR4", CCR1 + 12, 0, most, most                                                           \
    }

static const struct reg regs16[] = {REGS(0xFFFFu)};
static const struct reg regs32[] = {REGS(UINT32_MAX)};

static const struct timer_pins {
    uint8_t timer, function;
    uint8_t pins[CHANNELS][PLACES];
} timer_pins[] = {
    {3,
     2,
     {{PIN_NUMBER('A', 6), PIN_NUMBER('C', 6)},
      {PIN_NUMBER('A', 7), PIN_NUMBER('C', 7)},
      {PIN_NUMBER('B', 0), PIN_NUMBER('C', 8)},
      {PIN_NUMBER('B', 1), PIN_NUMBER('C', 9)}}},
    {4,
     2,
     {{PIN_NUMBER('B', 6), NO_PIN},
      {PIN_NUMBER('B', 7), NO_PIN},
      {PIN_NUMBER('B', 8), NO_PIN},
      {PIN_NUMBER('B', 9), NO_PIN}}},
    {5,
     2,
     {{PIN_NUMBER('A', 0), NO_PIN},
      {PIN_NUMBER('A', 1), NO_PIN},
      {NO_PIN, NO_PIN},
      {NO_PIN, NO_PIN}}},
    {12,
     9,
     {{PIN_NUMBER('B', 14), NO_PIN},
      {PIN_NUMBER('B', 15), NO_PIN},
      {NO_PIN, NO_PIN},
      {NO_PIN, NO_PIN}}},
};

struct pwm {
    uint32_t divider; /* in force */
    struct {
        double hz, high;
    } told[CHANNELS][PLACES];
};

static const struct timer_pins *pins_of(const struct part *p)
{
    size_t i = 0;
    while (timer_pins[i].timer != p->row->number)
        i++;
    return &timer_pins[i];
}

static double hz_of(const struct part *p)
{
    const struct pwm *t = p->state;
    return (double)timer_clock_hz(p->board, p->row->bus) / (t->divider + 1.0) /
           ((double)part_get(p, ARR) + 1.0);
}

/* Part of a period in which a channel's pin is high; less than 0: the channel is off. */
static double high_of(const struct part *p, unsigned channel)
{
    uint32_t ccer = part_get(p, CCER) >> 4 * channel;
    if ((ccer & CCER_E) == 0 || (part_get(p, CR1) & CR1_CEN) == 0)
        return -1;
    double part = (double)part_get(p, CCR1 + 4u * channel) / ((double)part_get(p, ARR) + 1.0);
    part = part < 1 ? part : 1;
    return (ccer & CCER_P) != 0 ? 1 - part : part;
}

static void tell(struct part *p)
{
    struct pwm *t = p->state;
    struct board *b = p->board;
    const struct timer_pins *of = pins_of(p);
    for (unsigned channel = 0; channel < CHANNELS; channel++)
        for (unsigned place = 0; place < PLACES; place++) {
            unsigned pin = of->pins[channel][place];
            if (pin == NO_PIN)
                continue;
            double high = pin_has_function(b, pin, of->function) ? high_of(p, channel) : -1;
            double hz = high < 0 ? 0 : hz_of(p);
            if (hz == t->told[channel][place].hz && high == t->told[channel][place].high)
                continue;
            t->told[channel][place].hz = hz;
            t->told[channel][place].high = high;
            if (b->world.pin_pulses != NULL)
                b->world.pin_pulses(b->world.context, board_ns(b), pin, hz, high < 0 ? 0 : high);
        }
}

void pwm_look(struct board *b)
{
    static const char *const names[] = {"TIM3", "TIM4", "TIM5", "TIM12"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        tell(bus_part(b, names[i]));
}

static void clear(struct part *p)
{
    struct pwm *t = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    t->divider = 0;
}

static void start(struct part *p)
{
    struct pwm *t = p->state;
    for (unsigned channel = 0; channel < CHANNELS; channel++)
        for (unsigned place = 0; place < PLACES; place++)
            t->told[channel][place].high = -1;
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    clear(p);
    tell(p);
}

static void check_modes(const struct part *p, uint32_t written)
{
    for (unsigned shift = 0; shift < 16u; shift += 8u)
        if ((written >> shift & 0xFFu) != 0 && (written >> shift & 0xFFu) != MODE_PWM1)
            board_verdict(p->board, "a channel of %s in a mode of 0x%x is not modelled",
                          p->row->name, written >> shift & 0xFFu);
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct pwm *t = p->state;
    if (offset == SR) {
        part_set(p, SR, before & written);
    } else if (offset == EGR && (written & EGR_UG) != 0) {
        t->divider = part_get(p, PSC);
        part_set(p, SR, part_get(p, SR) | 1u);
    } else if (offset == CCMR1 || offset == CCMR2) {
        check_modes(p, written);
    } else if ((offset == CR1 && (written & ~CR1_CEN) != 0) || (offset == DIER && written != 0)) {
        board_verdict(p->board, "0x%x in register 0x%x of %s is not modelled", written, offset,
                      p->row->name);
    }
    if ((part_get(p, CR1) & CR1_CEN) != 0 && part_get(p, PSC) != t->divider)
        board_verdict(p->board, "%s runs with a prescaler that no update has taken over",
                      p->row->name);
    tell(p);
}

const struct part_class pwm_class = {.name = "timer with pulse widths",
                                     .regs = regs16,
                                     .n_regs = sizeof(regs16) / sizeof(regs16[0]),
                                     .state_bytes = sizeof(struct pwm),
                                     .widths = WIDTH_HALF | WIDTH_WORD,
                                     .start = start,
                                     .reset = reset,
                                     .restart = clear,
                                     .write = write};
const struct part_class pwm32_class = {.name = "timer with pulse widths, of 32 bits",
                                       .regs = regs32,
                                       .n_regs = sizeof(regs32) / sizeof(regs32[0]),
                                       .state_bytes = sizeof(struct pwm),
                                       .widths = WIDTH_HALF | WIDTH_WORD,
                                       .start = start,
                                       .reset = reset,
                                       .restart = clear,
                                       .write = write};
