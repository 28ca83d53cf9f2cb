/* XGZP6897D, differential pressure. Registers as github.com/fanfanlatulipe26/XGZP6897D uses them, counts for a pascal from its README, which quotes
 * the maker's table; 20 ms for a conversion as drivers of the XGZP6857D quote its data sheet. The data sheet of this chip was not at hand.
 * Uncalibrated values and the value of register A5h at power-on are from memory (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>

#include "chips/chip_inside.h"

#define PRESSURE    0x06u /* 24 bits, most significant first */
#define TEMPERATURE 0x09u /* 16 bits, 1/256 degC */
#define COMMAND     0x30u
#define SYSTEM      0xA5u
#define RAW         0x02u /* of the system register: values without calibration */
#define BUSY        0x08u /* of the command register: Sco */
#define KIND        0x07u
#define ONCE_T      0x00u
#define ONCE_P      0x01u
#define ONCE_BOTH   0x02u
#define LONGEST_MS  20.0

enum { ADDRESS, SPAN, NOISE };
static const struct chip_property properties[] = {
    [ADDRESS] = {.name = "address",
                 .unit = "",
                 .lo = 0x08,
                 .hi = 0x77,
                 .at_first = 0x6D,
                 .parse = chip_parse_hex,
                 .form = "0x08 to 0x77"},
    [SPAN] = {.name = "span", .unit = "kPa", .lo = 0.5, .hi = 1000, .at_first = 1},
    [NOISE] = {.name = "noise", .unit = "Pa", .lo = 0, .hi = 1000, .at_first = 0},
};

enum { DIFFERENCE, WARMTH, STUCK, NACK };
static const struct chip_input inputs[] = {
    [DIFFERENCE] = {"pressure", "Pa", -1e6, 1e6, 0, "difference of its two ports"},
    [WARMTH] = {"temperature", "degC", -40, 125, 20, "of the chip"},
    [STUCK] = {"stuck", "", 0, 1, 0, "conversions leave the result as it is"},
    [NACK] = {"nack", "", 0, 1, 0, "it acknowledges its address and no byte"},
};

struct xgzp6897 {
    struct chip chip;
    uint8_t command, system;
    int32_t pressure, temperature; /* codes */
    uint8_t pointer;
    bool pointed; /* the byte after the address has come */
    bool converting;
    double slowness; /* part of the longest time */
    uint64_t asked_ns, end_ns;
    bool result_asked; /* not yet read, and Sco not seen as 0 */
};

static struct xgzp6897 *of(struct chip *c)
{
    return (struct xgzp6897 *)c;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct xgzp6897 *x = of(c);
    (void)now_ns;
    x->command = x->system = x->pointer = 0;
    x->pressure = x->temperature = 0;
    x->converting = x->result_asked = false;
    uint64_t own = c->seed ^ 0x6897u;
    x->slowness = 0.6 + 0.4 * chip_uniform(&own);
}

/* Counts for a pascal, by the span: table of the maker. */
static double counts_per_pa(double span_kpa)
{
    static const struct {
        double up_to_kpa, k;
    } rows[] = {{1, 8192}, {2, 4096}, {4, 2048}, {8, 1024}, {16, 512},
                {32, 256}, {65, 128}, {131, 64}, {260, 32}, {500, 16}};
    for (unsigned i = 0; i < CHIP_COUNT(rows); i++) {
        /* P < 1: 8192; 1 <= P < 2: 4096; 2 <= P <= 4: 2048. */
        bool within = i < 2 ? span_kpa < rows[i].up_to_kpa : span_kpa <= rows[i].up_to_kpa;
        if (within) {
            return rows[i].k;
        }
    }
    return 8;
}

static void convert(struct xgzp6897 *x)
{
    struct chip *c = &x->chip;
    double span_pa = 1e3 * c->property[SPAN];
    double pa = c->input[DIFFERENCE] + c->property[NOISE] * chip_normal(&c->random);
    double within = fmin(fmax(pa, -span_pa), span_pa);
    unsigned kind = x->command & KIND;
    if (kind != ONCE_T) {
        double counts = within * counts_per_pa(c->property[SPAN]);
        x->pressure = chip_code(x->system & RAW ? 0.4 * counts + 1e5 : counts, -8388608, 8388607);
    }
    if (kind != ONCE_P) {
        x->temperature = chip_code(c->input[WARMTH] * 256.0, -32768, 32767);
    }
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct xgzp6897 *x = of(c);
    if (x->converting && x->end_ns <= now_ns) {
        x->converting = false;
        x->command &= (uint8_t)~BUSY;
        if (c->input[STUCK] == 0.0) {
            convert(x);
        }
    }
}

static bool take_address(struct chip *c, uint64_t now_ns, uint8_t address, bool reads)
{
    struct xgzp6897 *x = of(c);
    catch_up(c, now_ns);
    if (address != (uint8_t)c->property[ADDRESS]) {
        return false;
    }
    x->pointed = reads;
    return true;
}

static void set_command(struct xgzp6897 *x, uint64_t now_ns, uint8_t byte)
{
    struct chip *c = &x->chip;
    if ((byte & KIND) > ONCE_BOTH) {
        chip_wrong(c, "register 30h: %02Xh; only single conversions are modelled", byte);
        return;
    }
    if (!(byte & BUSY)) {
        x->command = byte;
        return;
    }
    if (x->converting) {
        chip_wrong(c, "register 30h: a conversion is asked for while one runs");
    }
    x->command = byte;
    x->converting = x->result_asked = true;
    x->asked_ns = now_ns;
    x->end_ns = now_ns + CHIP_MS(LONGEST_MS * x->slowness);
}

static bool take_byte(struct chip *c, uint64_t now_ns, uint8_t byte)
{
    struct xgzp6897 *x = of(c);
    if (c->input[NACK] != 0.0) {
        return false;
    }
    if (!x->pointed) {
        x->pointer = byte;
        x->pointed = true;
        return true;
    }
    if (x->pointer == COMMAND) {
        set_command(x, now_ns, byte);
    } else if (x->pointer == SYSTEM) {
        x->system = byte;
    } else {
        chip_wrong(c, "register %02Xh written; it is read-only", x->pointer);
    }
    x->pointer++;
    return true;
}

static uint8_t give_byte(struct chip *c, uint64_t now_ns, bool acknowledged)
{
    struct xgzp6897 *x = of(c);
    (void)acknowledged;
    uint8_t at = x->pointer++;
    if (at == COMMAND) {
        x->result_asked = x->result_asked && x->converting; /* Sco has been seen */
        return x->command;
    }
    if (at == SYSTEM) {
        return x->system;
    }
    if (at < PRESSURE || at > TEMPERATURE + 1u) {
        return 0;
    }
    double since_ms = (double)(now_ns - x->asked_ns) * 1e-6;
    if (x->result_asked && since_ms < LONGEST_MS) {
        chip_wrong(c,
                   "register %02Xh read %.1f ms after a conversion began, which takes up to %g ms",
                   at, since_ms, LONGEST_MS);
    }
    x->result_asked = false;
    unsigned last = at < TEMPERATURE ? PRESSURE + 2u : TEMPERATURE + 1u;
    int32_t code = at < TEMPERATURE ? x->pressure : x->temperature;
    return (uint8_t)((uint32_t)code >> (8u * (last - at)));
}

static void stop(struct chip *c, uint64_t now_ns)
{
    (void)c;
    (void)now_ns;
}

const struct chip_kind chip_xgzp6897 = {.name = "xgzp6897",
                                        .bus = CHIP_I2C,
                                        .properties = properties,
                                        .n_properties = CHIP_COUNT(properties),
                                        .inputs = inputs,
                                        .n_inputs = CHIP_COUNT(inputs),
                                        .size = sizeof(struct xgzp6897),
                                        .power_on = power_on,
                                        .catch_up = catch_up,
                                        .address = take_address,
                                        .write = take_byte,
                                        .read = give_byte,
                                        .stop = stop};
