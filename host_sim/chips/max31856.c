/* MAX31856, converter for thermocouples. Tables and registers are those of the data sheet, as public drivers quote it.
 *
 * Temperatures come from the reference functions, without the errors that the data sheet allows. The time of a conversion lies between the typical
 * and the longest one, by the seed.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>

#include "chips/chip_inside.h"
#include "chips/spi_port.h"
#include "chips/thermocouple.h"

/* Register memory map, table 6. */
enum {
    CR0,
    CR1,
    MASK,
    CJ_HIGH,
    CJ_LOW,
    TC_HIGH,
    TC_LOW = 7,
    CJ_OFFSET = 9,
    CJ,
    TC = 12,
    STATUS = 15,
    N_REGISTERS
};

/* CR0 */
#define AUTO        0x80u
#define ONESHOT     0x40u
#define OPEN_TEST   0x30u
#define CJ_OFF      0x08u
#define INTERRUPT   0x04u
#define FAULT_CLEAR 0x02u
#define HZ_50       0x01u

/* CR1 */
#define AVERAGE 0x70u
#define TYPE    0x0Fu
#define VOLTAGE 0x08u /* no thermocouple, but voltage with a gain of 8 */
#define GAIN_32 0x04u

/* Status */
#define CJ_RANGE   0x80u
#define TC_RANGE   0x40u
#define CJ_ABOVE   0x20u
#define CJ_BELOW   0x10u
#define TC_ABOVE   0x08u
#define TC_BELOW   0x04u
#define OVER_UNDER 0x02u
#define OPEN_WIRE  0x01u

#define HYSTERESIS    2.0 /* degC, thresholds in comparator mode: fault mode bit of CR0 */
#define TEST_INTERVAL 16u /* conversions: OCFAULT of CR0 */

static bool parse_type(const char *text, double *value)
{
    *value = thermocouple_index(text[0]);
    return *value >= 0.0 && text[1] == '\0';
}

enum { KIND, NOISE };
static const struct chip_property properties[] = {
    [KIND] = {.name = "type",
              .unit = "",
              .lo = 0,
              .hi = 7,
              .at_first = 3,
              .parse = parse_type,
              .form = "a letter of " THERMOCOUPLES},
    [NOISE] = {.name = "noise", .unit = "uV", .lo = 0, .hi = 1000, .at_first = 0},
};

enum { TEMPERATURE, COLD, OPEN, SHORT, OVERVOLTAGE, BROWNOUT };
static const struct chip_input inputs[] = {
    [TEMPERATURE] = {"temperature", "degC", -270, 1820, 20, "of the hot junction"},
    [COLD] = {"cold", "degC", -64, 150, 20, "of the chip and the terminals"},
    [OPEN] = {"open", "", 0, 1, 0, "a wire of the thermocouple is broken"},
    [SHORT] = {"short", "", 0, 1, 0, "its wires touch at the terminals; the chip cannot know"},
    [OVERVOLTAGE] = {"overvoltage", "", 0, 1, 0, "an input is above the supply or below ground"},
    [BROWNOUT] = {"brownout", "", 0, 1, 0,
                  "registers go to their values of power-on, once when it begins"},
};

struct max31856 {
    struct chip chip;
    struct spi_port port;
    uint8_t reg[N_REGISTERS];
    bool brown;     /* the brown-out that is there has been taken over */
    bool triggered; /* a conversion starts when the select goes high */
    bool converting;
    double slowness; /* 0 typical, 1 longest time */
    uint64_t asked_ns,
        end_ns;        /* trigger of the last 1-shot or of automatic mode; end of the conversion */
    bool result_asked; /* and it has not been read too early */
    unsigned conversions; /* in automatic mode, since it began */
};

static struct max31856 *of(struct chip *c)
{
    return (struct max31856 *)c;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct max31856 *m = of(c);
    static const uint8_t first[N_REGISTERS] = {
        [CR1] = 0x03,     [MASK] = 0xFF,        [CJ_HIGH] = 0x7F, [CJ_LOW] = 0xC0,
        [TC_HIGH] = 0x7F, [TC_HIGH + 1] = 0xFF, [TC_LOW] = 0x80};
    for (unsigned i = 0; i < N_REGISTERS; i++) {
        m->reg[i] = first[i];
    }
    m->converting = m->triggered = m->result_asked = false;
    m->asked_ns = now_ns;
    uint64_t own = c->seed ^ 0x31856u;
    m->slowness = chip_uniform(&own);
}

static char type_of(const struct max31856 *m)
{
    return THERMOCOUPLES[m->reg[CR1] & 7u];
}

static int signed_16(const uint8_t *bytes)
{
    return (int16_t)(uint16_t)(bytes[0] << 8 | bytes[1]);
}

/* Averaging, CR1. */
static unsigned samples(const struct max31856 *m)
{
    unsigned code = (m->reg[CR1] & AVERAGE) >> 4;
    return code >= 4 ? 16u : 1u << code;
}

/* Time of a conversion, ms: electrical characteristics, and CR0 and CR1 for cold junction and averaging. Times of automatic mode and of the
 * open-circuit test (table 4) are from memory (unverified). */
static double conversion_ms(const struct max31856 *m, bool single, bool tests_open, double slowness)
{
    static const double open_ms[4][2] = {{0, 0}, {13.3, 15}, {33.4, 37}, {113.4, 125}};
    static const double open_no_cj_ms[4][2] = {{0, 0}, {40, 44}, {60, 66}, {140, 154}};
    bool hz_50 = (m->reg[CR0] & HZ_50) != 0;
    bool cj_off = (m->reg[CR0] & CJ_OFF) != 0;
    double typical = single ? (hz_50 ? 169.0 : 143.0) : hz_50 ? 98.0 : 82.0;
    double longest = single ? (hz_50 ? 185.0 : 155.0) : hz_50 ? 110.0 : 90.0;
    double ms = typical + slowness * (longest - typical);
    ms -= cj_off ? 25.0 : 0.0;
    ms += (samples(m) - 1) * (single ? (hz_50 ? 40.0 : 33.33) : hz_50 ? 20.0 : 16.67);
    if (tests_open) {
        const double *test = (cj_off ? open_no_cj_ms : open_ms)[(m->reg[CR0] & OPEN_TEST) >> 4];
        ms += test[0] + slowness * (test[1] - test[0]);
    }
    return ms;
}

/* The conversion that runs tests for an open circuit: each 1-shot, in automatic mode the first of sixteen. */
static bool tests_open(const struct max31856 *m)
{
    bool turn = !(m->reg[CR0] & AUTO) || m->conversions % TEST_INTERVAL == 0;
    return (m->reg[CR0] & OPEN_TEST) && turn;
}

/* Cold junction as the chip has it, degC. */
static double cold_degc(const struct max31856 *m)
{
    return (double)(signed_16(&m->reg[CJ]) >> 2) / 64.0;
}

static void measure_cold(struct max31856 *m)
{
    if (m->reg[CR0] & CJ_OFF) {
        return;
    }
    double degc = m->chip.input[COLD] + (int8_t)m->reg[CJ_OFFSET] / 16.0;
    uint16_t code = (uint16_t)(chip_code(degc * 64.0, -8192, 8191) * 4);
    m->reg[CJ] = (uint8_t)(code >> 8);
    m->reg[CJ + 1] = (uint8_t)code;
}

/* Voltage between T+ and T-, mV. An open input is biased to nothing, so that it looks like the cold junction. */
static double seen_mv(struct max31856 *m)
{
    const double *in = m->chip.input;
    char type = THERMOCOUPLES[(unsigned)m->chip.property[KIND]];
    double mv = in[OPEN] != 0.0 || in[SHORT] != 0.0
                    ? 0.0
                    : thermocouple_mv(type, in[TEMPERATURE]) - thermocouple_mv(type, in[COLD]);
    double scatter = m->chip.property[NOISE] * 1e-3 * chip_normal(&m->chip.random);
    return mv + scatter / sqrt((double)samples(m));
}

/* Ranges of table 1, hot and cold (status register), degC, in the order of THERMOCOUPLES. Hot ranges are from memory
 * (unverified). */
static const struct {
    double lo, hi, cold_lo;
} ranges[] = {{250, 1820, 0},    {-200, 1000, -55}, {-210, 1200, -55}, {-200, 1372, -55},
              {-200, 1300, -55}, {-50, 1768, -50},  {-50, 1768, -50},  {-200, 400, -55}};

/* Sets or clears a bit of the status. In interrupt mode a bit stays until it is cleared. */
static void fault(struct max31856 *m, uint8_t bit, bool is_there)
{
    if (is_there) {
        m->reg[STATUS] |= bit;
    } else if (!(m->reg[CR0] & INTERRUPT)) {
        m->reg[STATUS] &= (uint8_t)~bit;
    }
}

/* A value against its thresholds, with hysteresis where the bit is set already. */
static void compare(struct max31856 *m, double degc, double low, double high, uint8_t below,
                    uint8_t above)
{
    double under = m->reg[STATUS] & below ? HYSTERESIS : 0.0;
    double over = m->reg[STATUS] & above ? HYSTERESIS : 0.0;
    fault(m, above, degc > high - over);
    fault(m, below, degc < low + under);
}

static void put_code(struct max31856 *m, int32_t code)
{
    uint32_t bits = (uint32_t)code << 5; /* 19 of 24 bits */
    m->reg[TC] = (uint8_t)(bits >> 16);
    m->reg[TC + 1] = (uint8_t)(bits >> 8);
    m->reg[TC + 2] = (uint8_t)bits;
}

static void linearise(struct max31856 *m)
{
    unsigned i = m->reg[CR1] & 7u;
    double cold = cold_degc(m);
    double mv = seen_mv(m) + thermocouple_mv(type_of(m), cold);
    double lo;
    double hi;
    (void)thermocouple_range(type_of(m), &lo, &hi);
    lo = type_of(m) == 'B' ? 42.0 : lo; /* below, the voltage falls with temperature */
    double degc = thermocouple_degc(type_of(m), mv, lo, hi);
    put_code(m, chip_code(degc * 128.0, -262144, 262143));
    fault(m, TC_RANGE,
          mv < thermocouple_mv(type_of(m), ranges[i].lo) ||
              mv > thermocouple_mv(type_of(m), ranges[i].hi));
    fault(m, CJ_RANGE, cold < ranges[i].cold_lo || cold > 125.0);
    compare(m, cold, (int8_t)m->reg[CJ_LOW], (int8_t)m->reg[CJ_HIGH], CJ_BELOW, CJ_ABOVE);
    compare(m, degc, signed_16(&m->reg[TC_LOW]) / 16.0, signed_16(&m->reg[TC_HIGH]) / 16.0,
            TC_BELOW, TC_ABOVE);
}

static void convert(struct max31856 *m)
{
    measure_cold(m);
    if (tests_open(m)) {
        fault(m, OPEN_WIRE, m->chip.input[OPEN] != 0.0);
    } else if (!(m->reg[CR0] & OPEN_TEST)) {
        fault(m, OPEN_WIRE, false);
    }
    if (m->reg[CR1] & VOLTAGE) { /* code = gain x 1.6 x 2^17 x V */
        double gain = m->reg[CR1] & GAIN_32 ? 32.0 : 8.0;
        put_code(m, chip_code(gain * 1.6 * 131072.0 * 1e-3 * seen_mv(m), -262144, 262143));
    } else {
        linearise(m);
    }
    m->conversions++;
}

static void begin_conversion(struct max31856 *m, uint64_t start_ns, bool single)
{
    m->converting = true;
    m->end_ns = start_ns + CHIP_MS(conversion_ms(m, single, tests_open(m), m->slowness));
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct max31856 *m = of(c);
    bool brown = c->input[BROWNOUT] != 0.0;
    if (brown && !m->brown) {
        power_on(c, now_ns);
    }
    m->brown = brown;
    bool halted = c->input[OVERVOLTAGE] != 0.0;
    while (m->converting && m->end_ns <= now_ns) {
        if (!halted) { /* the old value stays, and no other fault is seen: OVUV of the status register */
            convert(m);
        }
        m->converting = false;
        m->reg[CR0] &= (uint8_t)~ONESHOT;
        if (m->reg[CR0] & AUTO) {
            begin_conversion(m, m->end_ns, false);
        }
    }
    fault(m, OVER_UNDER, halted);
}

static uint8_t read_register(struct chip *c, uint64_t now_ns, uint8_t address)
{
    struct max31856 *m = of(c);
    if (address >= N_REGISTERS) {
        return 0xFF;
    }
    bool tests = (m->reg[CR0] & OPEN_TEST) != 0;
    double longest_ms = conversion_ms(m, true, tests, 1.0);
    uint64_t since_ns = now_ns - m->asked_ns;
    if (address >= TC && address < STATUS && m->result_asked && since_ns < CHIP_MS(longest_ms)) {
        m->result_asked = false;
        chip_wrong(c,
                   "register %02Xh read %.1f ms after a conversion began, which takes up to %g ms",
                   address, (double)since_ns * 1e-6, longest_ms);
    }
    return m->reg[address];
}

static void configure(struct max31856 *m, uint8_t value)
{
    struct chip *c = &m->chip;
    uint8_t before = m->reg[CR0];
    if (((value ^ before) & HZ_50) && (m->converting || (before & AUTO))) {
        chip_wrong(c, "register 00h: notch changed while it converts");
    }
    if ((value & ONESHOT) && (value & AUTO)) {
        chip_wrong(c, "register 00h: 1-shot in automatic mode");
    } else if ((value & ONESHOT) && m->converting) {
        chip_wrong(c, "register 00h: 1-shot while it converts");
    }
    bool oneshot = (value & ONESHOT) && !(value & AUTO);
    if ((value & FAULT_CLEAR) && (value & INTERRUPT)) {
        m->reg[STATUS] = 0;
    }
    m->reg[CR0] = (uint8_t)((value & ~(FAULT_CLEAR | ONESHOT)) | (oneshot ? ONESHOT : 0));
    m->triggered = oneshot || ((value & AUTO) && !(before & AUTO));
    if ((before & AUTO) && !(value & AUTO)) {
        m->converting = m->result_asked = false;
    }
}

static void write_register(struct chip *c, uint64_t now_ns, uint8_t address, uint8_t value)
{
    struct max31856 *m = of(c);
    (void)now_ns;
    if (address >= TC) {
        chip_wrong(c, "register %02Xh written; it is read-only", address);
        return;
    }
    if ((address == CJ || address == CJ + 1) && !(m->reg[CR0] & CJ_OFF)) {
        chip_wrong(c, "register %02Xh written while the chip measures the cold junction itself",
                   address);
        return;
    }
    if (address == CR0) {
        configure(m, value);
        return;
    }
    if (address == CR1 && ((value ^ m->reg[CR1]) & AVERAGE) && m->converting) {
        chip_wrong(c, "register 01h: averaging changed while it converts");
    }
    m->reg[address] = value;
}

static void select_line(struct chip *c, uint64_t now_ns, bool low)
{
    struct max31856 *m = of(c);
    /* Within one select the registers stay as they are, so that all bytes are of one conversion (unverified). */
    catch_up(c, now_ns);
    spi_port_select(&m->port, c, now_ns, low);
    if (!low && m->triggered) {
        m->triggered = false;
        m->conversions = 0;
        m->asked_ns = now_ns;
        m->result_asked = true;
        begin_conversion(m, now_ns, true);
    }
}

static uint8_t exchange(struct chip *c, uint64_t now_ns, unsigned mode, uint8_t out)
{
    static const struct spi_registers registers = {read_register, write_register};
    return spi_port_exchange(&of(c)->port, c, now_ns, mode, out, &registers);
}

const struct chip_kind chip_max31856 = {.name = "max31856",
                                        .bus = CHIP_SPI,
                                        .properties = properties,
                                        .n_properties = CHIP_COUNT(properties),
                                        .inputs = inputs,
                                        .n_inputs = CHIP_COUNT(inputs),
                                        .size = sizeof(struct max31856),
                                        .power_on = power_on,
                                        .catch_up = catch_up,
                                        .select = select_line,
                                        .exchange = exchange};
