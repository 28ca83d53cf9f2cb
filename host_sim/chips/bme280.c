/* BME280 and BMP280, barometers, on I2C. BME280: data sheet BST-BME280-DS002-15, sections as there, from memory but for 4.2.3 (unverified). BMP280:
 * BST-BMP280-DS001-23, table 17 (calibration words) and 8.1 (compensation) were read.
 *
 * Raw codes are those for which the maker's compensation gives the pressure and temperature that are set. Humidity is not modelled: its code stays
 * at 8000h, as where it is not measured.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>
#include <string.h>

#include "chips/chip_inside.h"

/* Registers, 5.3. */
#define CALIBRATION   0x88u /* T1..T3, P1..P9, least significant byte first */
#define CALIBRATION_H 0xE1u
#define H1            0xA1u
#define ID            0xD0u
#define RESET         0xE0u
#define RESET_KEY     0xB6u
#define CTRL_HUM      0xF2u
#define STATUS        0xF3u
#define CTRL_MEAS     0xF4u
#define CONFIG        0xF5u
#define DATA          0xF7u /* pressure, temperature: 20 bits in 3 bytes each; humidity 2 bytes */

#define MEASURING 0x08u
#define COPYING   0x01u /* calibration from the chip's own store */
#define SLEEP     0u
#define NORMAL    3u
#define CODE_OFF  0x80000  /* of what is not measured */
#define START_NS  2000000u /* 1.1: start-up time */

#define WORDS 12u
/* Worked example of the maker, as tests of several public drivers have it: 519888 and 415148 are 25.08 degC and 100653 Pa. */
static const int32_t example[WORDS] = {27504, 26435, -1000, 36477, -10685, 3024,
                                       2855,  140,   -7,    15500, -14600, 6000};
static const uint8_t example_h[7] = {0x6A, 0x01, 0x00, 0x14, 0x0D, 0x00, 0x1E};

enum { ADDRESS, VARIED, NOISE };
static const struct chip_property properties[] = {
    [ADDRESS] = {.name = "address",
                 .unit = "",
                 .lo = 0x76,
                 .hi = 0x77,
                 .at_first = 0x76,
                 .parse = chip_parse_hex,
                 .form = "0x76 or 0x77"},
    /* 1: the seed makes calibration words, as chips differ; 0: those of the worked example. */
    [VARIED] = {.name = "varied", .unit = "", .lo = 0, .hi = 1, .at_first = 1},
    [NOISE] = {.name = "noise", .unit = "Pa", .lo = 0, .hi = 1000, .at_first = 0},
};

enum { PRESSURE, TEMPERATURE, STUCK, NACK };
static const struct chip_input inputs[] = {
    [PRESSURE] = {"pressure", "Pa", 30000, 110000, 101325, "of the air"},
    [TEMPERATURE] = {"temperature", "degC", -40, 85, 20, "of the chip"},
    [STUCK] = {"stuck", "", 0, 1, 0, "measurements leave the result as it is"},
    [NACK] = {"nack", "", 0, 1, 0, "it acknowledges its address and no byte"},
};

struct bme280 {
    struct chip chip;
    int32_t words[WORDS]; /* T1..T3, P1..P9 */
    double slowness;      /* 0 typical, 1 longest time */
    uint8_t ctrl_hum, ctrl_hum_used, ctrl_meas, config;
    int32_t code_p, code_t; /* of the last measurement, 20 bits */
    double filtered_p, filtered_t;
    bool filter_runs; /* it has a first value */
    uint8_t shadow[8];
    uint8_t pointer;
    bool pointed; /* the byte after the address has come */
    bool measuring;
    bool result_asked; /* not yet read, and the end not seen in the status */
    uint64_t start_ns, end_ns, ready_ns;
};

static struct bme280 *of(struct chip *c)
{
    return (struct bme280 *)c;
}

static bool has_humidity(const struct bme280 *b)
{
    return b->chip.kind == &chip_bme280;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct bme280 *b = of(c);
    uint64_t own = c->seed ^ 0x280u;
    b->slowness = chip_uniform(&own);
    for (unsigned i = 0; i < WORDS; i++) {
        double spread = 0.02 * (2.0 * chip_uniform(&own) - 1.0) * c->property[VARIED];
        b->words[i] = example[i] + (int32_t)(spread * example[i]);
    }
    b->ctrl_hum = b->ctrl_hum_used = b->ctrl_meas = b->config = 0;
    b->code_p = b->code_t = CODE_OFF;
    b->filter_runs = b->measuring = b->result_asked = false;
    b->ready_ns = now_ns + START_NS;
}

/* Fine temperature, 1/5120 degC, from a code: BMP280 8.1. */
static double fine(const struct bme280 *b, double code)
{
    double x = code / 16384.0 - b->words[0] / 1024.0;
    return x * b->words[1] + x * x / 64.0 * b->words[2];
}

/* Pressure, Pa, from a code and the fine temperature: BMP280 8.1. */
static double pressure(const struct bme280 *b, double code, double t_fine)
{
    const int32_t *p = &b->words[2]; /* p[1] is P1 */
    double v = t_fine / 2.0 - 64000.0;
    double offset = (v * v * p[6] / 32768.0 + v * p[5] * 2.0) / 4.0 + p[4] * 65536.0;
    double scale = (p[3] * v * v / 524288.0 + p[2] * v) / 524288.0;
    scale = (1.0 + scale / 32768.0) * p[1];
    double pa = (1048576.0 - code - offset / 4096.0) * 6250.0 / scale;
    return pa + (p[9] * pa * pa / 2147483648.0 + pa * p[8] / 32768.0 + p[7]) / 16.0;
}

/* Code at which the rising function f crosses the value, not rounded. */
static double inverse(const struct bme280 *b, double value, double t_fine,
                      double (*f)(const struct bme280 *, double, double))
{
    double lo = 0.0;
    double hi = 1048575.0;
    for (unsigned i = 0; i < 60; i++) {
        double middle = 0.5 * (lo + hi);
        if (f(b, middle, t_fine) < value) {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    return 0.5 * (lo + hi);
}

static double rising_temperature(const struct bme280 *b, double code, double t_fine)
{
    (void)t_fine;
    return fine(b, code) / 5120.0;
}

static double falling_pressure(const struct bme280 *b, double code, double t_fine)
{
    return -pressure(b, code, t_fine); /* it falls with the code */
}

static unsigned samples(unsigned code)
{
    return code == 0 ? 0u : code >= 5 ? 16u : 1u << (code - 1u);
}

static unsigned over_t(const struct bme280 *b)
{
    return b->ctrl_meas >> 5;
}

static unsigned over_p(const struct bme280 *b)
{
    return (b->ctrl_meas >> 2) & 7u;
}

/* 9.1: time of a measurement, ms, typical and longest. */
static double measurement_ms(const struct bme280 *b, double slowness)
{
    unsigned t = samples(over_t(b));
    unsigned p = samples(over_p(b));
    unsigned h = has_humidity(b) ? samples(b->ctrl_hum_used & 7u) : 0;
    double typical = 1.0 + 2.0 * t + (p ? 2.0 * p + 0.5 : 0.0) + (h ? 2.0 * h + 0.5 : 0.0);
    double longest = 1.25 + 2.3 * t + (p ? 2.3 * p + 0.575 : 0.0) + (h ? 2.3 * h + 0.575 : 0.0);
    return typical + slowness * (longest - typical);
}

/* 5.4.6: pause in normal mode, ms. */
static double standby_ms(const struct bme280 *b)
{
    static const double bme[8] = {0.5, 62.5, 125, 250, 500, 1000, 10, 20};
    static const double bmp[8] = {0.5, 62.5, 125, 250, 500, 1000, 2000, 4000};
    return (has_humidity(b) ? bme : bmp)[b->config >> 5];
}

/* 3.4.4: IIR filter of the raw values, and the resolution: 20 bits with it, else 16 and one more for each doubling of samples. */
static int32_t filtered(const struct bme280 *b, double *memory, double code, unsigned over)
{
    static const double coefficients[8] = {1, 2, 4, 8, 16, 16, 16, 16};
    double coefficient = coefficients[(b->config >> 2) & 7u];
    *memory = b->filter_runs ? (*memory * (coefficient - 1.0) + code) / coefficient : code;
    unsigned missing = coefficient > 1.0 || over >= 5 ? 0u : 5u - over;
    double step = (double)(1u << missing);
    return chip_code(*memory / step, 0, 0xFFFFF >> missing) << missing;
}

static void measure(struct bme280 *b)
{
    struct chip *c = &b->chip;
    double degc = c->input[TEMPERATURE];
    double pa = c->input[PRESSURE] + c->property[NOISE] * chip_normal(&c->random);
    bool both = over_t(b) != 0 && over_p(b) != 0;
    if (over_t(b) != 0) {
        double code = inverse(b, degc, 0.0, rising_temperature);
        b->code_t = filtered(b, &b->filtered_t, code, over_t(b));
    } else {
        b->code_t = CODE_OFF;
    }
    if (over_p(b) != 0) {
        /* With the temperature as a driver has it: 8.1 cuts it to an integer. */
        double t_fine = over_t(b) != 0 ? trunc(fine(b, b->code_t)) : degc * 5120.0;
        double code = inverse(b, -pa, t_fine, falling_pressure);
        b->code_p = filtered(b, &b->filtered_p, code, over_p(b));
    } else {
        b->code_p = CODE_OFF;
    }
    b->filter_runs = both;
}

static void begin(struct bme280 *b, uint64_t start_ns)
{
    b->measuring = true;
    b->ctrl_hum_used = b->ctrl_hum;
    b->start_ns = start_ns;
    b->end_ns = start_ns + CHIP_MS(measurement_ms(b, b->slowness));
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct bme280 *b = of(c);
    while (b->measuring && b->end_ns <= now_ns) {
        if (c->input[STUCK] == 0.0) {
            measure(b);
        }
        b->measuring = false;
        if ((b->ctrl_meas & 3u) == NORMAL) {
            begin(b, b->end_ns + CHIP_MS(standby_ms(b)));
        } else {
            b->ctrl_meas &= 0xFCu; /* back to sleep */
        }
    }
}

/* 4.1: a read sees one measurement. */
static void fill_shadow(struct bme280 *b)
{
    uint32_t p = (uint32_t)b->code_p;
    uint32_t t = (uint32_t)b->code_t;
    uint8_t bytes[8] = {(uint8_t)(p >> 12),
                        (uint8_t)(p >> 4),
                        (uint8_t)(p << 4),
                        (uint8_t)(t >> 12),
                        (uint8_t)(t >> 4),
                        (uint8_t)(t << 4),
                        0x80,
                        0x00};
    memcpy(b->shadow, bytes, sizeof(bytes));
}

static bool take_address(struct chip *c, uint64_t now_ns, uint8_t address, bool reads)
{
    struct bme280 *b = of(c);
    catch_up(c, now_ns);
    if (address != (uint8_t)c->property[ADDRESS]) {
        return false;
    }
    if (now_ns < b->ready_ns) {
        chip_wrong(c, "addressed %.2f ms before the end of its start-up time of 2 ms",
                   (double)(b->ready_ns - now_ns) * 1e-6);
    }
    b->pointed = reads;
    if (reads) {
        fill_shadow(b);
    }
    return true;
}

static void set_mode(struct bme280 *b, uint64_t now_ns, uint8_t value)
{
    unsigned mode = value & 3u;
    if (b->measuring && b->start_ns <= now_ns && mode != SLEEP) {
        chip_wrong(&b->chip, "register F4h: a measurement is asked for while one runs");
    }
    b->ctrl_meas = value;
    b->measuring = b->result_asked = false;
    if (mode != SLEEP) {
        begin(b, now_ns);
        b->result_asked = true;
    }
}

static void write_register(struct bme280 *b, uint64_t now_ns, uint8_t at, uint8_t value)
{
    struct chip *c = &b->chip;
    if (at == RESET) {
        if (value == RESET_KEY) {
            power_on(c, now_ns);
        }
    } else if (at == CTRL_MEAS) {
        set_mode(b, now_ns, value);
    } else if (at == CTRL_HUM && has_humidity(b)) {
        b->ctrl_hum = value;
    } else if (at == CONFIG && (b->ctrl_meas & 3u) == NORMAL) {
        chip_wrong(c, "register F5h written in normal mode, where it may be ignored");
    } else if (at == CONFIG) {
        b->config = value;
        b->filter_runs = false;
    } else {
        chip_wrong(c, "register %02Xh written; it is read-only", at);
    }
}

/* 6.2.1: pairs of register and value; the address does not go up by itself. */
static bool take_byte(struct chip *c, uint64_t now_ns, uint8_t byte)
{
    struct bme280 *b = of(c);
    if (c->input[NACK] != 0.0) {
        return false;
    }
    if (!b->pointed) {
        b->pointer = byte;
    } else {
        write_register(b, now_ns, b->pointer, byte);
    }
    b->pointed = !b->pointed;
    return true;
}

static uint8_t calibration(const struct bme280 *b, unsigned i)
{
    return (uint8_t)((uint32_t)b->words[i / 2u] >> (8u * (i % 2u)));
}

static uint8_t read_data(struct bme280 *b, uint64_t now_ns, uint8_t at)
{
    double longest_ms = measurement_ms(b, 1.0);
    double since_ms = (double)(now_ns - b->start_ns) * 1e-6;
    if (b->result_asked && b->start_ns <= now_ns && since_ms < longest_ms) {
        chip_wrong(
            &b->chip,
            "register %02Xh read %.2f ms after a measurement began, which takes up to %.2f ms", at,
            since_ms, longest_ms);
    }
    b->result_asked = false;
    return b->shadow[at - DATA];
}

static uint8_t give_byte(struct chip *c, uint64_t now_ns, bool acknowledged)
{
    struct bme280 *b = of(c);
    (void)acknowledged;
    bool humid = has_humidity(b);
    uint8_t at = b->pointer++;
    unsigned n_data = humid ? 8u : 6u;
    bool measuring = b->measuring && b->start_ns <= now_ns;
    if (at >= CALIBRATION && at < CALIBRATION + 2u * WORDS) {
        return calibration(b, at - CALIBRATION);
    }
    if (humid && at >= CALIBRATION_H && at < CALIBRATION_H + sizeof(example_h)) {
        return example_h[at - CALIBRATION_H];
    }
    if (at >= DATA && at < DATA + n_data) {
        return read_data(b, now_ns, at);
    }
    switch (at) {
    case H1:
        return humid ? 75 : 0;
    case ID:
        return humid ? 0x60 : 0x58;
    case CTRL_HUM:
        return humid ? b->ctrl_hum : 0;
    case STATUS:
        b->result_asked = b->result_asked && measuring; /* the end has been seen */
        return (uint8_t)((measuring ? MEASURING : 0u) | (now_ns < b->ready_ns ? COPYING : 0u));
    case CTRL_MEAS:
        return b->ctrl_meas;
    case CONFIG:
        return b->config;
    default:
        return 0;
    }
}

static void stop(struct chip *c, uint64_t now_ns)
{
    (void)c;
    (void)now_ns;
}

#define BAROMETER(called)                                                                          \
    {                                                                                              \
        .name = (called), .bus = CHIP_I2C, .properties = properties,                               \
        .n_properties = CHIP_COUNT(properties), .inputs = inputs, .n_inputs = CHIP_COUNT(inputs),  \
        .size = sizeof(struct bme280), .power_on = power_on, .catch_up = catch_up,                 \
        .address = take_address, .write = take_byte, .read = give_byte, .stop = stop               \
    }

const struct chip_kind chip_bme280 = BAROMETER("bme280");
const struct chip_kind chip_bmp280 = BAROMETER("bmp280");
