/* The first converter of the STM32F405: regular sequences that a program starts, 12 bits, right-aligned. Read in RM0090 Rev 21: 13.1, 13.2 (what
 * it has). From memory is the rest: registers and bits, 12 cycles beside the sampling time, a clock of at most 36 MHz, 3 us after ADON, EOC at each
 * conversion with EOCS, an overrun that ends the sequence when a result was not read, channel 17 for the chip's reference of 1.21 V, which TSVREFE
 * turns on and which wants 10 us to be sampled, and its value at 3.3 V, which the factory has put at 0x1FFF7A2A (unverified). The reference of the
 * converter is the board's supply.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "pins.h"

enum {
    SR = 0x00,
    CR1 = 0x04,
    CR2 = 0x08,
    SMPR1 = 0x0C,
    SMPR2 = 0x10,
    SQR1 = 0x2C,
    SQR2 = 0x30,
    SQR3 = 0x34,
    DR = 0x4C
};
enum { CCR = 0x04 };          /* of the part that all converters share */
enum { REFERENCE_AT = 0x28 }; /* of the factory's bytes, from 0x1FFF7A00: its upper half */

#define SR_EOC      2u
#define SR_STRT     (UINT32_C(1) << 4)
#define SR_OVR      (UINT32_C(1) << 5)
#define CR1_EOCIE   (UINT32_C(1) << 5)
#define CR1_SCAN    (UINT32_C(1) << 8)
#define CR1_OVRIE   (UINT32_C(1) << 26)
#define CR1_KNOWN   (CR1_EOCIE | CR1_SCAN | CR1_OVRIE)
#define CR2_ADON    1u
#define CR2_EOCS    (UINT32_C(1) << 10)
#define CR2_SWSTART (UINT32_C(1) << 30)
#define CR2_KNOWN   (CR2_ADON | CR2_EOCS | CR2_SWSTART)
#define CCR_TSVREFE (UINT32_C(1) << 23)
#define CHANNEL_REF 17u
#define CHANNELS    18u
#define REF_V       1.21
#define REF_NS      10000u /* of its sampling time */
#define FACTORY_V   3.3
#define SETTLES_NS  3000u
#define MOST_HZ     36000000u
#define FULL        4095u
#define NS_PER_S    UINT64_C(1000000000)

static const struct reg regs[] = {
    {"SR", SR, 0, 0x3Fu, 0},
    {"CR1", CR1, 0, 0x07C0FFFFu, 0x07C0FFFFu},
    {"CR2", CR2, 0, 0x7F7F0F03u, 0x7F7F0F03u},
    {"SMPR1", SMPR1, 0, 0x07FFFFFFu, 0x07FFFFFFu},
    {"SMPR2", SMPR2, 0, 0x3FFFFFFFu, 0x3FFFFFFFu},
    {"SQR1", SQR1, 0, 0x00FFFFFFu, 0x00FFFFFFu},
    {"SQR2", SQR2, 0, 0x3FFFFFFFu, 0x3FFFFFFFu},
    {"SQR3", SQR3, 0, 0x3FFFFFFFu, 0x3FFFFFFFu},
    {"DR", DR, 0, 0xFFFFu, 0},
};

static const struct reg common_regs[] = {{"CCR", CCR, 0, 0x00C3EF1Fu, 0x00C3EF1Fu}};

#define REFERENCE_CODE ((uint32_t)(REF_V / FACTORY_V * FULL + 0.5))
static const struct reg factory_regs[] = {
    {"VREFIN_CAL", REFERENCE_AT, REFERENCE_CODE << 16, UINT32_MAX, 0}};

struct adc {
    struct board_event converted;
    uint64_t on_ns;
    unsigned index, length; /* of the conversion that runs, and of the sequence */
    bool runs;
};

static unsigned channel_at(const struct part *p, unsigned index)
{
    uint32_t word = part_get(p, index < 6u ? SQR3 : index < 12u ? SQR2 : SQR1);
    return word >> 5u * (index % 6u) & 31u;
}

static uint64_t clock_hz(const struct part *p)
{
    uint32_t ccr = part_get(bus_part(p->board, "ADC"), CCR);
    return bus_clock_hz(p->board, p->row->bus) / (UINT64_C(2) * ((ccr >> 16 & 3u) + 1u));
}

static uint32_t sampling_cycles(const struct part *p, unsigned channel)
{
    static const uint16_t cycles[] = {3, 15, 28, 56, 84, 112, 144, 480};
    uint32_t word = part_get(p, channel < 10u ? SMPR2 : SMPR1);
    return cycles[word >> 3u * (channel % 10u) & 7u];
}

static void update_irq(struct part *p)
{
    uint32_t sr = part_get(p, SR), cr1 = part_get(p, CR1);
    interrupt_line(p->board, p->row->irq,
                   ((cr1 & CR1_EOCIE) != 0 && (sr & SR_EOC) != 0) ||
                       ((cr1 & CR1_OVRIE) != 0 && (sr & SR_OVR) != 0));
}

/* Pins of the channels 0 to 15. */
static unsigned pin_of(unsigned channel)
{
    return channel < 8u    ? PIN_NUMBER('A', channel)
           : channel < 10u ? PIN_NUMBER('B', channel - 8u)
                           : PIN_NUMBER('C', channel - 10u);
}

static double volts(struct part *p, unsigned channel)
{
    struct board *b = p->board;
    if (channel == CHANNEL_REF)
        return (part_get(bus_part(b, "ADC"), CCR) & CCR_TSVREFE) != 0 ? REF_V : 0;
    return b->world.pin_volts == NULL
               ? 0
               : b->world.pin_volts(b->world.context, board_ns(b), pin_of(channel));
}

static uint32_t code(struct part *p, unsigned channel)
{
    double part = volts(p, channel) * 1000.0 / p->board->around.supply_mv;
    return part <= 0 ? 0 : part >= 1 ? FULL : (uint32_t)(part * FULL + 0.5);
}

static void begin(struct part *p)
{
    struct adc *a = p->state;
    struct board *b = p->board;
    unsigned channel = channel_at(p, a->index);
    uint64_t hz = clock_hz(p), sampling = sampling_cycles(p, channel) * NS_PER_S / hz;
    if (channel >= CHANNELS || channel == 16u)
        board_verdict(b, "channel %u of %s is not modelled", channel, p->row->name);
    else if (channel < 16u && !pin_is_analog(b, pin_of(channel)))
        board_verdict(b, "%s converts channel %u, whose pin is no analogue input", p->row->name,
                      channel);
    else if (channel == CHANNEL_REF && sampling < REF_NS)
        board_verdict(b, "%s samples its reference for %llu ns, which wants %u", p->row->name,
                      (unsigned long long)sampling, REF_NS);
    board_schedule(b, &a->converted, board_ns(b) + sampling + (12u * NS_PER_S + hz - 1u) / hz);
}

static void converted(void *context)
{
    struct part *p = context;
    struct adc *a = p->state;
    uint32_t sr = part_get(p, SR);
    if ((sr & SR_EOC) != 0) { /* it was not read: the sequence ends (with EOCS) */
        part_set(p, SR, sr | SR_OVR);
        a->runs = false;
        update_irq(p);
        return;
    }
    part_set(p, DR, code(p, channel_at(p, a->index)));
    part_set(p, SR, sr | SR_EOC);
    a->index++;
    a->runs = a->index < a->length;
    if (a->runs)
        begin(p);
    update_irq(p);
}

static void start(struct part *p)
{
    struct adc *a = p->state;
    a->converted = (struct board_event){.due = converted, .context = p};
    board_add_event(p->board, &a->converted);
}

static void clear(struct part *p)
{
    struct adc *a = p->state;
    for (size_t k = 0; k < p->row->class->n_regs; k++)
        p->words[k] = p->row->class->regs[k].reset;
    a->runs = false;
    board_schedule(p->board, &a->converted, BOARD_NEVER);
    interrupt_line(p->board, p->row->irq, false);
}

static void reset(struct part *p, enum board_reset kind)
{
    (void)kind;
    clear(p);
}

static uint32_t read(struct part *p, uint32_t offset, uint32_t stored)
{
    if (offset == DR) {
        part_set(p, SR, part_get(p, SR) & ~SR_EOC);
        update_irq(p);
    }
    return stored;
}

static void start_sequence(struct part *p)
{
    struct adc *a = p->state;
    struct board *b = p->board;
    const char *name = p->row->name;
    part_set(p, CR2, part_get(p, CR2) & ~CR2_SWSTART);
    a->length = (part_get(p, SQR1) >> 20 & 15u) + 1u;
    if ((part_get(p, CR2) & CR2_ADON) == 0 || board_ns(b) < a->on_ns + SETTLES_NS)
        board_verdict(b, "%s is started before it has been on for %u ns", name, SETTLES_NS);
    else if (a->runs)
        board_verdict(b, "%s is started while a sequence runs", name);
    else if ((part_get(p, SR) & SR_OVR) != 0)
        board_verdict(b, "%s is started with its overrun not cleared", name);
    else if (clock_hz(p) > MOST_HZ)
        board_verdict(b, "%s runs with %llu Hz; at most 36 MHz", name,
                      (unsigned long long)clock_hz(p));
    else if (a->length > 1 && (part_get(p, CR1) & CR1_SCAN) == 0)
        board_verdict(b, "%s is started on several channels without a scan", name);
    else if ((part_get(p, CR2) & CR2_EOCS) == 0)
        board_verdict(b, "%s without EOCS is not modelled", name);
    else {
        part_set(p, SR, part_get(p, SR) | SR_STRT);
        a->index = 0;
        a->runs = true;
        begin(p);
    }
}

static void write(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    struct adc *a = p->state;
    struct board *b = p->board;
    if (offset == SR) {
        part_set(p, SR, before & written);
    } else if (offset == CR1) {
        if ((written & ~CR1_KNOWN) != 0)
            board_verdict(b, "%s_CR1 of 0x%x is not modelled", p->row->name, written);
    } else if (offset == CR2) {
        if ((written & ~CR2_KNOWN) != 0)
            board_verdict(b, "%s_CR2 of 0x%x is not modelled", p->row->name, written);
        if ((written & ~before & CR2_ADON) != 0)
            a->on_ns = board_ns(b);
        if ((written & CR2_ADON) == 0) { /* a conversion that runs ends */
            a->runs = false;
            board_schedule(b, &a->converted, BOARD_NEVER);
        }
        if ((written & CR2_SWSTART) != 0)
            start_sequence(p);
    } else if (a->runs && offset >= SMPR1 && offset <= SQR3) {
        board_verdict(b, "the sequence of %s changes while it runs", p->row->name);
    }
    update_irq(p);
}

static void write_common(struct part *p, uint32_t offset, uint32_t before, uint32_t written)
{
    (void)offset;
    (void)before;
    if ((written & ~(CCR_TSVREFE | UINT32_C(3) << 16)) != 0)
        board_verdict(p->board, "ADC_CCR of 0x%x is not modelled", written);
}

const struct part_class adc_class = {.name = "converter",
                                     .regs = regs,
                                     .n_regs = sizeof(regs) / sizeof(regs[0]),
                                     .state_bytes = sizeof(struct adc),
                                     .widths = WIDTH_WORD,
                                     .start = start,
                                     .reset = reset,
                                     .restart = clear,
                                     .read = read,
                                     .write = write};
const struct part_class adc_common_class = {.name = "what the converters share",
                                            .regs = common_regs,
                                            .n_regs = 1,
                                            .widths = WIDTH_WORD,
                                            .write = write_common};
const struct part_class factory_class = {.name = "bytes of the factory",
                                         .regs = factory_regs,
                                         .n_regs = 1,
                                         .widths = WIDTH_BYTE | WIDTH_HALF | WIDTH_WORD};
