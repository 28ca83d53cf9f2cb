/* MAX31865, converter for platinum thermometers. Pages are those of the data sheet 19-6478 rev. 3.
 *
 * The time of a conversion lies between the typical and the longest one of page 3, by the seed. A driver that reads earlier than the longest
 * time is told, whatever this chip takes.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>

#include "chips/chip_inside.h"
#include "chips/spi_port.h"

enum { CONFIG, RTD_HIGH, RTD_LOW, HIGH_HIGH, HIGH_LOW, LOW_HIGH, LOW_LOW, STATUS, N_REGISTERS };

/* Configuration, page 13. */
#define BIAS    0x80u
#define AUTO    0x40u
#define ONESHOT 0x20u
#define WIRES_3 0x10u
#define CYCLE   0x0Cu
#define CYCLE_A 0x04u /* automatic */
#define CYCLE_1 0x08u /* manual, first step */
#define CLEAR   0x02u
#define HZ_50   0x01u

/* Fault status, page 16. */
#define ABOVE      0x80u
#define BELOW      0x40u
#define REF_HIGH   0x20u
#define REF_LOW    0x10u
#define RTD_BROKEN 0x08u
#define VOLTAGE    0x04u

#define CYCLE_NS_MAX  600000u /* page 3: automatic fault-detection cycle */
#define CYCLE_NS_TYP  550000u
#define BIAS_START_NS 1000000u /* page 13: 10.5 time constants plus 1 ms */
#define SETTLED       10.5     /* time constants */
#define CODE_MAX      32767

enum { REFERENCE, NOMINAL, WIRES, CAPACITOR, NOISE };
static const struct chip_property properties[] = {
    [REFERENCE] = {.name = "reference", .unit = "ohm", .lo = 50, .hi = 20000, .at_first = 430},
    [NOMINAL] = {.name = "nominal", .unit = "ohm", .lo = 10, .hi = 5000, .at_first = 100},
    [WIRES] = {.name = "wires", .unit = "", .lo = 2, .hi = 4, .at_first = 2},
    [CAPACITOR] = {.name = "capacitor", .unit = "nF", .lo = 0, .hi = 10000, .at_first = 100},
    [NOISE] = {.name = "noise", .unit = "ohm", .lo = 0, .hi = 10, .at_first = 0},
};

enum { TEMPERATURE, LEAD, OPEN, FORCE_OPEN, SHORT, GROUND, OVERVOLTAGE, BROWNOUT };
static const struct chip_input inputs[] = {
    [TEMPERATURE] = {"temperature", "degC", -200, 850, 20, "of the thermometer"},
    [LEAD] = {"lead", "ohm", 0, 100, 0, "resistance of each wire"},
    [OPEN] = {"open", "", 0, 1, 0, "the element is broken"},
    [FORCE_OPEN] = {"force_open", "", 0, 1, 0,
                    "a wire of the current is broken: FORCE- of 4, FORCE+ of 3, one of 2"},
    [SHORT] = {"short", "", 0, 1, 0, "the element is shorted"},
    [GROUND] = {"ground", "", 0, 1, 0, "RTDIN- touches ground"},
    [OVERVOLTAGE] = {"overvoltage", "", 0, 1, 0, "a wire is above the supply or below ground"},
    [BROWNOUT] = {"brownout", "", 0, 1, 0,
                  "registers go to their values of power-on, once when it begins"},
};

struct max31865 {
    struct chip chip;
    struct spi_port port;
    uint8_t reg[N_REGISTERS];
    bool brown;     /* the brown-out that is there has been taken over */
    bool triggered; /* a conversion or cycle starts when the select goes high */
    bool converting;
    double slowness;           /* 0 typical, 1 longest time */
    uint64_t bias_ns;          /* when it went on */
    uint64_t start_ns, end_ns; /* of the conversion */
    uint64_t asked_ns;         /* trigger of the last 1-shot, of automatic mode or of a cycle */
    bool result_asked, cycle_asked; /* and it has not been read too early */
    uint8_t cycle;                  /* bits of the cycle that runs, 0 none */
    bool settles;                   /* since a cycle, that ended: */
    uint64_t cycle_end_ns;
    bool force_switch_open; /* between the two manual steps */
};

static struct max31865 *of(struct chip *c)
{
    return (struct max31865 *)c;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct max31865 *m = of(c);
    static const uint8_t first[N_REGISTERS] = {[HIGH_HIGH] = 0xFF, [HIGH_LOW] = 0xFF};
    for (unsigned i = 0; i < N_REGISTERS; i++) {
        m->reg[i] = first[i];
    }
    m->converting = m->triggered = m->force_switch_open = false;
    m->result_asked = m->cycle_asked = m->settles = false;
    m->cycle = 0;
    m->bias_ns = now_ns;
    uint64_t own = c->seed ^ 0x31865u;
    m->slowness = chip_uniform(&own);
}

/* Resistance by Callendar and Van Dusen, IEC 60751 (page 10), ohm. */
static double platinum(double nominal, double t)
{
    double ratio = 1.0 + t * (3.9083e-3 + t * -5.775e-7);
    if (t < 0.0) {
        ratio += -4.183e-12 * (t - 100.0) * t * t * t;
    }
    return nominal * ratio;
}

/* What the converter sees between RTDIN+ and RTDIN-, in ohm of the current through the reference; pages 10, 22, 23. */
static double seen_ohm(struct max31865 *m)
{
    const double *in = m->chip.input;
    double ohm = in[SHORT] != 0.0 ? 0.0 : platinum(m->chip.property[NOMINAL], in[TEMPERATURE]);
    unsigned wires = (unsigned)m->chip.property[WIRES];
    bool set_3 = (m->reg[CONFIG] & WIRES_3) != 0;
    if (in[OPEN] != 0.0 || (wires == 2 && in[FORCE_OPEN] != 0.0)) {
        return INFINITY;
    }
    if (in[FORCE_OPEN] != 0.0) { /* indeterminate */
        return chip_uniform(&m->chip.random) * 1.2 * m->chip.property[REFERENCE];
    }
    if (wires == 2) {
        ohm += 2.0 * in[LEAD];
    } else if (wires == 3 && !set_3) {
        ohm += in[LEAD];
    }
    return ohm + m->chip.property[NOISE] * chip_normal(&m->chip.random);
}

static bool bias_on(const struct max31865 *m)
{
    return (m->reg[CONFIG] & (BIAS | AUTO)) != 0;
}

/* The input filter's time constant as page 4, note 4, reckons it: reference and capacitor. */
static double time_constant_ns(const struct max31865 *m)
{
    return m->chip.property[REFERENCE] * m->chip.property[CAPACITOR];
}

static uint64_t settling_ns(const struct max31865 *m)
{
    return BIAS_START_NS + (uint64_t)(SETTLED * time_constant_ns(m));
}

static void convert(struct max31865 *m)
{
    double ratio = seen_ohm(m) / m->chip.property[REFERENCE];
    if (!bias_on(m)) {
        ratio = chip_uniform(&m->chip.random); /* no reference voltage */
    } else {
        double on_ns = (double)(m->start_ns - m->bias_ns);
        ratio *= 1.0 - exp(-on_ns * SETTLED / (double)settling_ns(m));
    }
    int32_t code = chip_code(ratio * 32768.0, 0, CODE_MAX) << 1;
    m->reg[RTD_HIGH] = (uint8_t)(code >> 8);
    m->reg[RTD_LOW] = (uint8_t)code;
    /* All 16 bits take part, so that FFFFh, as at power-on, detects nothing. */
    if (code >= (m->reg[HIGH_HIGH] << 8 | m->reg[HIGH_LOW])) {
        m->reg[STATUS] |= ABOVE;
    }
    if (code <= (m->reg[LOW_HIGH] << 8 | m->reg[LOW_LOW])) {
        m->reg[STATUS] |= BELOW;
    }
}

/* Page 3: typical and longest times, ms. */
static double conversion_ms(const struct max31865 *m, bool single, double slowness)
{
    bool hz_50 = (m->reg[CONFIG] & HZ_50) != 0;
    double typical = single ? (hz_50 ? 62.5 : 52.0) : hz_50 ? 20.0 : 16.7;
    double longest = single ? (hz_50 ? 66.0 : 55.0) : hz_50 ? 21.0 : 17.6;
    return typical + slowness * (longest - typical);
}

static void begin_conversion(struct max31865 *m, uint64_t start_ns, bool single)
{
    m->converting = true; /* The 1-shot bit stays until the conversion has ended (unverified). */
    m->start_ns = start_ns;
    m->end_ns = start_ns + CHIP_MS(conversion_ms(m, single, m->slowness));
}

/* The comparisons of a fault-detection cycle, page 14: before and after the FORCE- switch opens. */
static void compare(struct max31865 *m, bool force_closed, bool force_opened)
{
    const double *in = m->chip.input;
    if (force_closed && (in[OPEN] != 0.0 || in[FORCE_OPEN] != 0.0)) {
        m->reg[STATUS] |= REF_HIGH;
    }
    if (force_opened && in[GROUND] != 0.0) {
        m->reg[STATUS] |= REF_LOW | RTD_BROKEN;
    }
}

static void end_cycle(struct max31865 *m)
{
    compare(m, m->cycle != CYCLE, m->cycle != CYCLE_1);
    m->force_switch_open = m->cycle == CYCLE_1;
    m->settles = true;
    m->cycle_end_ns = m->asked_ns + CYCLE_NS_TYP;
    if (m->cycle != CYCLE_1) { /* the first manual step stays to be read */
        m->reg[CONFIG] &= (uint8_t)~CYCLE;
    }
    m->cycle = 0;
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    struct max31865 *m = of(c);
    bool brown = c->input[BROWNOUT] != 0.0;
    if (brown && !m->brown) {
        power_on(c, now_ns);
    }
    m->brown = brown;
    bool halted = c->input[OVERVOLTAGE] != 0.0;
    while (m->converting && m->end_ns <= now_ns) {
        if (!halted) { /* page 11: no updates while the voltage is wrong */
            convert(m);
        }
        m->converting = false;
        m->reg[CONFIG] &= (uint8_t)~ONESHOT;
        if (m->reg[CONFIG] & AUTO) {
            begin_conversion(m, m->end_ns, false);
        }
    }
    if (m->cycle != 0 && m->asked_ns + CYCLE_NS_TYP <= now_ns) {
        end_cycle(m);
    }
    if (halted) {
        m->reg[STATUS] |= VOLTAGE;
    }
    m->reg[RTD_LOW] = (uint8_t)((m->reg[RTD_LOW] & 0xFEu) | (m->reg[STATUS] != 0));
}

static uint8_t read_register(struct chip *c, uint64_t now_ns, uint8_t address)
{
    struct max31865 *m = of(c);
    if (address >= N_REGISTERS) {
        return 0xFF;
    }
    uint64_t since_ns = now_ns - m->asked_ns;
    double longest_ms = conversion_ms(m, true, 1.0);
    if ((address == RTD_HIGH || address == RTD_LOW) && m->result_asked &&
        since_ns < CHIP_MS(longest_ms)) {
        m->result_asked = false;
        chip_wrong(c,
                   "register %02Xh read %.1f ms after a conversion began, which takes up to %g ms",
                   address, (double)since_ns * 1e-6, longest_ms);
    }
    if (address == STATUS && m->cycle_asked && since_ns < CYCLE_NS_MAX) {
        m->cycle_asked = false;
        chip_wrong(c,
                   "register 07h read %u us after fault detection began, which takes up to %u us",
                   (unsigned)(since_ns / 1000u), CYCLE_NS_MAX / 1000u);
    }
    return m->reg[address];
}

static void check_cycle(struct max31865 *m, uint64_t now_ns, uint8_t value)
{
    struct chip *c = &m->chip;
    if ((value & (BIAS | AUTO)) != BIAS) {
        chip_wrong(c,
                   "register 00h: %02Xh; a fault-detection cycle wants 100X01 or 100X10 in front",
                   value);
    }
    double on_ns = (double)(now_ns - m->bias_ns);
    if ((value & CYCLE) == CYCLE_1 && on_ns < 5.0 * time_constant_ns(m)) {
        chip_wrong(c,
                   "register 00h: manual fault detection %.0f us after VBIAS; 5 time constants are "
                   "%.0f us",
                   on_ns * 1e-3, 5e-3 * time_constant_ns(m));
    }
}

static void configure(struct max31865 *m, uint64_t now_ns, uint8_t value)
{
    struct chip *c = &m->chip;
    uint8_t before = m->reg[CONFIG];
    if (((value ^ before) & HZ_50) && (m->converting || (before & AUTO))) {
        chip_wrong(c, "register 00h: notch changed while it converts");
    }
    if (((value & WIRES_3) != 0) != (c->property[WIRES] == 3.0)) {
        chip_wrong(c, "register 00h: 3-wire bit is %u with %g wires", (value & WIRES_3) != 0,
                   c->property[WIRES]);
    }
    bool oneshot = (value & ONESHOT) != 0;
    uint8_t cycle = value & CYCLE;
    if (oneshot && cycle != 0) { /* page 14: both are ignored */
        chip_wrong(c, "register 00h: 1-shot and fault detection in one write");
        oneshot = false;
        cycle = 0;
    }
    if (oneshot && (value & AUTO)) {
        chip_wrong(c, "register 00h: 1-shot in automatic mode");
        oneshot = false;
    }
    if (oneshot && m->converting) {
        chip_wrong(c, "register 00h: 1-shot while it converts");
    }
    if ((value & CLEAR) && (value & (ONESHOT | CYCLE)) == 0) {
        m->reg[STATUS] = 0;
    }
    bool was_on = bias_on(m);
    m->reg[CONFIG] =
        (uint8_t)((value & ~(CLEAR | ONESHOT | CYCLE)) | (oneshot ? ONESHOT : 0) | cycle);
    if (bias_on(m) && !was_on) {
        m->bias_ns = now_ns;
    }
    if (cycle != 0) {
        check_cycle(m, now_ns, value);
    }
    m->triggered = oneshot || cycle != 0 || ((value & AUTO) && !(before & AUTO));
    if ((before & AUTO) && !(value & AUTO)) {
        m->converting = m->result_asked = false;
    }
}

static void write_register(struct chip *c, uint64_t now_ns, uint8_t address, uint8_t value)
{
    struct max31865 *m = of(c);
    if (address == CONFIG) {
        configure(m, now_ns, value);
    } else if (address >= HIGH_HIGH && address <= LOW_LOW) {
        m->reg[address] = value;
    } else {
        chip_wrong(c, "register %02Xh written; it is read-only", address);
    }
}

/* The select has gone high behind a write of the configuration. */
static void trigger(struct max31865 *m, uint64_t now_ns)
{
    struct chip *c = &m->chip;
    uint8_t config = m->reg[CONFIG];
    m->triggered = false;
    m->asked_ns = now_ns;
    if (config & CYCLE) {
        /* Page 14: the second manual step without the first one is an automatic cycle. */
        bool second = (config & CYCLE) == CYCLE && m->force_switch_open;
        m->cycle = second ? CYCLE : (config & CYCLE) == CYCLE ? CYCLE_A : config & CYCLE;
        m->converting = m->result_asked = false;
        m->cycle_asked = true;
        return;
    }
    if (m->force_switch_open) {
        chip_wrong(c, "register 00h: a conversion between the two steps of manual fault detection");
        m->force_switch_open = false;
    }
    double again_ns = BIAS_START_NS + 5.0 * time_constant_ns(m);
    if (m->settles && (double)(now_ns - m->cycle_end_ns) < again_ns) { /* page 19 */
        chip_wrong(
            c, "a conversion %.3f ms after fault detection; 5 time constants and 1 ms are %.3f ms",
            (double)(now_ns - m->cycle_end_ns) * 1e-6, again_ns * 1e-6);
    }
    m->settles = false;
    uint64_t on_ns = now_ns - m->bias_ns;
    if (!(config & AUTO) && !(config & BIAS)) {
        chip_wrong(c, "register 00h: 1-shot without VBIAS");
    } else if (!(config & AUTO) && on_ns < settling_ns(m)) {
        chip_wrong(
            c, "register 00h: 1-shot %.3f ms after VBIAS; 10.5 time constants and 1 ms are %.3f ms",
            (double)on_ns * 1e-6, (double)settling_ns(m) * 1e-6);
    }
    m->result_asked = true;
    m->cycle_asked = false;
    begin_conversion(m, now_ns, true);
}

static void select_line(struct chip *c, uint64_t now_ns, bool low)
{
    struct max31865 *m = of(c);
    /* Within one select the registers stay as they are, so that both bytes are of one conversion (unverified). */
    catch_up(c, now_ns);
    spi_port_select(&m->port, c, now_ns, low);
    if (!low && m->triggered) {
        trigger(m, now_ns);
    }
}

static uint8_t exchange(struct chip *c, uint64_t now_ns, unsigned mode, uint8_t out)
{
    static const struct spi_registers registers = {read_register, write_register};
    return spi_port_exchange(&of(c)->port, c, now_ns, mode, out, &registers);
}

const struct chip_kind chip_max31865 = {.name = "max31865",
                                        .bus = CHIP_SPI,
                                        .properties = properties,
                                        .n_properties = CHIP_COUNT(properties),
                                        .inputs = inputs,
                                        .n_inputs = CHIP_COUNT(inputs),
                                        .size = sizeof(struct max31865),
                                        .power_on = power_on,
                                        .catch_up = catch_up,
                                        .select = select_line,
                                        .exchange = exchange};
