/* ADS1115, converter with four inputs. Sections are those of the data sheet SBAS444E; 7.4.2.1 (single-shot mode) was read.
 * Registers are as public drivers and TI's answers at e2e.ti.com have them. That a conversion in continuous mode ends with the
 * settings that it began with is from memory (unverified). The comparator's thresholds are registers and do nothing.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>

#include "chips/chip_inside.h"

enum { CONVERSION, CONFIG, LOW_THRESHOLD, HIGH_THRESHOLD, N_REGISTERS };

#define OS              0x8000u
#define SINGLE          0x0100u
#define CONFIG_AT_FIRST 0x8583u
#define WAKE_NS         25000u /* 7.4.2.1 */
#define RATE_ERROR      0.1    /* data rate, electrical characteristics */
#define GENERAL_CALL    0x00u
#define RESET           0x06u

enum { ADDRESS, SUPPLY, NOISE };
static const struct chip_property properties[] = {
    [ADDRESS] = {.name = "address",
                 .unit = "",
                 .lo = 0x48,
                 .hi = 0x4B,
                 .at_first = 0x48,
                 .parse = chip_parse_hex,
                 .form = "0x48 to 0x4b"},
    [SUPPLY] = {.name = "supply", .unit = "V", .lo = 2.0, .hi = 5.5, .at_first = 3.3},
    [NOISE] = {.name = "noise", .unit = "uV", .lo = 0, .hi = 10000, .at_first = 0},
};

enum { IN0, IN1, IN2, IN3, STUCK, NACK };
static const struct chip_input inputs[] = {
    [IN0] = {"in0", "V", -10, 30, 0,
             "voltage at AIN0; the chip's protection keeps it within 0.3 V of its supply"},
    [IN1] = {"in1", "V", -10, 30, 0, "at AIN1"},
    [IN2] = {"in2", "V", -10, 30, 0, "at AIN2"},
    [IN3] = {"in3", "V", -10, 30, 0, "at AIN3"},
    [STUCK] = {"stuck", "", 0, 1, 0, "conversions leave the result as it is"},
    [NACK] = {"nack", "", 0, 1, 0, "it acknowledges its address and no byte"},
};

struct ads1115 {
    struct chip chip;
    uint16_t reg[N_REGISTERS];
    uint8_t pointer;
    bool general;        /* the general call is addressed */
    unsigned written;    /* bytes since the address */
    uint8_t high;        /* first byte of a register that is written */
    uint16_t latched;    /* register that is read */
    unsigned read_bytes; /* of it */
    double rate_factor;  /* of the data rate, 1 +- RATE_ERROR */
    bool converting;
    uint16_t running;          /* configuration of the conversion that runs */
    uint64_t asked_ns, end_ns; /* when the configuration asked for it, when it ends */
    bool result_asked;         /* by a single shot, not yet read, and OS not seen as 1 */
};

static struct ads1115 *of(struct chip *c)
{
    return (struct ads1115 *)c;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct ads1115 *a = of(c);
    (void)now_ns;
    a->reg[CONVERSION] = 0;
    a->reg[CONFIG] = CONFIG_AT_FIRST & ~OS;
    a->reg[LOW_THRESHOLD] = 0x8000;
    a->reg[HIGH_THRESHOLD] = 0x7FFF;
    a->pointer = CONVERSION;
    a->converting = a->result_asked = a->general = false;
    uint64_t own = c->seed ^ 0x1115u;
    a->rate_factor = 1.0 + RATE_ERROR * (2.0 * chip_uniform(&own) - 1.0);
}

static double rate(uint16_t config)
{
    static const double rates[8] = {8, 16, 32, 64, 128, 250, 475, 860};
    return rates[(config >> 5) & 7u];
}

static double full_scale(uint16_t config)
{
    static const double volts[8] = {6.144, 4.096, 2.048, 1.024, 0.512, 0.256, 0.256, 0.256};
    return volts[(config >> 9) & 7u];
}

/* Voltage of an input behind its protection. */
static double volts_at(const struct ads1115 *a, unsigned input)
{
    double v = a->chip.input[IN0 + input];
    return fmin(fmax(v, -0.3), a->chip.property[SUPPLY] + 0.3);
}

static double volts(const struct ads1115 *a, uint16_t config)
{
    static const struct {
        uint8_t plus, minus;
    } pairs[4] = {{0, 1}, {0, 3}, {1, 3}, {2, 3}};
    unsigned mux = (config >> 12) & 7u;
    return mux >= 4 ? volts_at(a, mux - 4u)
                    : volts_at(a, pairs[mux].plus) - volts_at(a, pairs[mux].minus);
}

static void begin_conversion(struct ads1115 *a, uint64_t start_ns, bool wakes)
{
    a->converting = true;
    a->running = a->reg[CONFIG];
    a->end_ns =
        start_ns + (wakes ? WAKE_NS : 0u) + (uint64_t)(1e9 / (rate(a->running) * a->rate_factor));
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct ads1115 *a = of(c);
    while (a->converting && a->end_ns <= now_ns) {
        double v = volts(a, a->running) + c->property[NOISE] * 1e-6 * chip_normal(&c->random);
        int32_t code = chip_code(v / full_scale(a->running) * 32768.0, -32768, 32767);
        if (c->input[STUCK] == 0.0) {
            a->reg[CONVERSION] = (uint16_t)code;
        }
        a->converting = false;
        if (!(a->reg[CONFIG] & SINGLE)) {
            begin_conversion(a, a->end_ns, false);
        }
    }
}

static double longest_ms(const struct ads1115 *a)
{
    return 1e3 / (rate(a->running) * (1.0 - RATE_ERROR)) + WAKE_NS * 1e-6;
}

/* A register as it is at the start of a read. */
static void latch(struct ads1115 *a, uint64_t now_ns)
{
    bool ready = !a->converting || !(a->reg[CONFIG] & SINGLE);
    a->latched = a->reg[a->pointer];
    if (a->pointer == CONFIG) {
        a->latched |= ready ? OS : 0;
        a->result_asked =
            a->result_asked && a->converting; /* OS has been seen: the result may be read */
    }
    double since_ms = (double)(now_ns - a->asked_ns) * 1e-6;
    if (a->pointer == CONVERSION && a->result_asked && since_ms < longest_ms(a)) {
        chip_wrong(&a->chip,
                   "register 0 read %.2f ms after a conversion began, which takes up to %.2f ms",
                   since_ms, longest_ms(a));
    }
    if (a->pointer == CONVERSION) {
        a->result_asked = false;
    }
    a->read_bytes = 0;
}

static bool take_address(struct chip *c, uint64_t now_ns, uint8_t address, bool reads)
{
    struct ads1115 *a = of(c);
    catch_up(c, now_ns);
    a->general = address == GENERAL_CALL && !reads;
    if (a->general) {
        return true;
    }
    if (address != (uint8_t)c->property[ADDRESS]) {
        return false;
    }
    a->written = 0;
    if (reads) {
        latch(a, now_ns);
    }
    return true;
}

static void configure(struct ads1115 *a, uint64_t now_ns, uint16_t value)
{
    uint16_t before = a->reg[CONFIG];
    a->reg[CONFIG] = value & (uint16_t)~OS;
    if (!(value & SINGLE)) {
        if (before & SINGLE) {
            a->asked_ns = now_ns;
            a->result_asked = true;
        }
        if (!a->converting || (before & SINGLE)) { /* else the running one ends as it began */
            begin_conversion(a, now_ns, true);
        }
    } else if (value & OS) {
        if (a->converting && (before & SINGLE)) {
            chip_wrong(&a->chip, "register 1: OS written while it converts has no effect");
            return;
        }
        begin_conversion(a, now_ns, true);
        a->asked_ns = now_ns;
        a->result_asked = true;
    }
}

static bool take_byte(struct chip *c, uint64_t now_ns, uint8_t byte)
{
    struct ads1115 *a = of(c);
    if (a->general) {
        if (byte == RESET) {
            power_on(c, now_ns);
        }
        return true;
    }
    if (c->input[NACK] != 0.0) {
        return false;
    }
    a->written++;
    if (a->written == 1) {
        a->pointer = byte & 3u;
        if (byte > 3u) {
            chip_wrong(c, "pointer %02Xh; there are registers 0 to 3", byte);
        }
    } else if (a->written == 2) {
        a->high = byte;
    } else if (a->written == 3) {
        uint16_t value = (uint16_t)(a->high << 8 | byte);
        if (a->pointer == CONVERSION) {
            chip_wrong(c, "register 0 written; it is read-only");
        } else if (a->pointer == CONFIG) {
            configure(a, now_ns, value);
        } else {
            a->reg[a->pointer] = value;
        }
    } else {
        chip_wrong(c, "register %u: more than two bytes written", a->pointer);
    }
    return true;
}

static uint8_t give_byte(struct chip *c, uint64_t now_ns, bool acknowledged)
{
    struct ads1115 *a = of(c);
    (void)now_ns;
    (void)acknowledged;
    a->read_bytes++;
    return a->read_bytes == 1   ? (uint8_t)(a->latched >> 8)
           : a->read_bytes == 2 ? (uint8_t)a->latched
                                : 0xFF;
}

static void stop(struct chip *c, uint64_t now_ns)
{
    struct ads1115 *a = of(c);
    (void)now_ns;
    if (a->written == 2) {
        chip_wrong(c, "register %u: one byte written of two", a->pointer);
    }
    a->written = 0;
    a->general = false;
}

const struct chip_kind chip_ads1115 = {.name = "ads1115",
                                       .bus = CHIP_I2C,
                                       .properties = properties,
                                       .n_properties = CHIP_COUNT(properties),
                                       .inputs = inputs,
                                       .n_inputs = CHIP_COUNT(inputs),
                                       .size = sizeof(struct ads1115),
                                       .power_on = power_on,
                                       .catch_up = catch_up,
                                       .address = take_address,
                                       .write = take_byte,
                                       .read = give_byte,
                                       .stop = stop};
