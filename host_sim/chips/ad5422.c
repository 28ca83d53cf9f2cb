/* AD5422, a current or a voltage of 16 bits; the DAC8760 is alike but for what the driver of neither needs: its watchdog, checksum and calibration.
 *
 * Read were: AD5412/AD5422 rev. I, "Readback Operation", table 9 and "Power-On State" (page 29); AD5410/AD5420 rev. F, "Daisy-Chain Operation"
 * (page 18), "Digital Slew Rate Control" and table 20 (page 24); DAC8760, SBAS528D, 8.5.1 (shift register), tables 8-14 and 8-15 (reading), 8-17
 * (control register) and 8-18 (status); DAC8750, SBAS538D, 8.3.5 (clear), 8.3.11 (slew rate), 8.4.1 (ranges) and 8.5 (24 clocks for a frame). The codes
 * of the voltage ranges, the daisy-chain bit, the line from codes to mA and V, and the times are from memory (unverified).
 *
 * There is no select. The chip shifts with each clock of its bus, and takes the last 24 bits when LATCH rises. While SDO is enabled it drives into
 * what others on the bus say.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <math.h>
#include <string.h>

#include "chips/chip_inside.h"

#define FRAME_BITS 24u
#define FULL       65536.0 /* codes */
#define MIDDLE     0x8000u

/* Address bytes. */
enum { NOP = 0x00, WRITE_DATA = 0x01, READ = 0x02, WRITE_CONTROL = 0x55, RESET = 0x56 };
enum { READ_STATUS, READ_DATA, READ_CONTROL }; /* the last two bits of a read */

/* Control. */
#define CLEAR_SELECT 0x8000u
#define OVER_RANGE   0x4000u
#define ENABLED      0x1000u
#define SLEW_CLOCK   0x0F00u
#define SLEW_STEP    0x00E0u
#define SLEWS        0x0010u
#define DAISY_CHAIN  0x0008u
#define RANGE        0x0007u

/* Status. */
#define LOOP_FAULT 0x0004u
#define SLEWING    0x0002u
#define HOT_DIE    0x0001u

/* The pin IOUT loses control so far below its supply, V (features: loop compliance). */
#define COMPLIANCE_V 2.5

/* LATCH stays high so long behind a write of the control register (unverified). */
#define AFTER_CONTROL_NS 5000u

static const struct {
    double lo, hi;
    bool current, exists;
} ranges[] = {{0, 5, false, true},    {0, 10, false, true}, {-5, 5, false, true},
              {-10, 10, false, true}, {0, 0, false, false}, {4, 20, true, true},
              {0, 20, true, true},    {0, 24, true, true}};

/* Steps a second. The first eight are those of the AD5420, the others those of the DAC8750, which are 0.1 to 0.3 % faster. */
static const double slew_hz[] = {257730, 198410, 152440, 131580, 115740, 69440, 37590, 25770,
                                 20150,  16030,  10295,  8280,   6900,   5530,  4240,  3300};

static bool parse_signal(const char *text, double *value)
{
    *value = strcmp(text, "voltage") == 0;
    return *value != 0.0 || strcmp(text, "current") == 0;
}

enum { SIGNAL, LOAD, SUPPLY };
static const struct chip_property properties[] = {
    [SIGNAL] = {.name = "signal",
                .unit = "",
                .lo = 0,
                .hi = 1,
                .at_first = 0,
                .parse = parse_signal,
                .form = "current or voltage"},
    [LOAD] = {.name = "loop", .unit = "ohm", .lo = 0, .hi = 10000, .at_first = 250},
    [SUPPLY] = {.name = "supply", .unit = "V", .lo = 10.8, .hi = 40, .at_first = 24},
};

enum { OPEN, HOT, BROWNOUT };
static const struct chip_input inputs[] = {
    [OPEN] = {"open", "", 0, 1, 0, "a wire to the load is broken"},
    [HOT] = {"hot", "", 0, 1, 0, "the die is above its limit"},
    [BROWNOUT] = {"brownout", "", 0, 1, 0,
                  "registers go to their values of power-on, once when it begins"},
};

struct ad5422 {
    struct chip chip;
    uint32_t shift; /* the last 24 bits */
    unsigned bits;  /* since LATCH fell */
    bool latch_low, wrong_mode;
    bool brown;         /* the brown-out that is there has been taken over */
    bool sdo;           /* it drives its data output */
    uint8_t answer[3];  /* what that says */
    unsigned given;     /* bytes of it */
    uint64_t latch_ns;  /* LATCH rose last */
    bool wrote_control; /* and then the control register was written */
    uint16_t control, data;
    bool clear;        /* level of the pin CLEAR */
    bool cleared;      /* the output is what the pin has made it */
    double from, to;   /* codes of a slope, which begins at since_ns */
    uint64_t since_ns; /* of a slope */
};

static struct ad5422 *of(struct chip *c)
{
    return (struct ad5422 *)c;
}

/* ---- the output ---- */

static double code_at(const struct ad5422 *m, uint64_t now_ns)
{
    if (m->from == m->to)
        return m->to;
    double hz = slew_hz[(m->control & SLEW_CLOCK) >> 8];
    double step = (double)(1u << ((m->control & SLEW_STEP) >> 5));
    double moved = step * floor((double)(now_ns - m->since_ns) * 1e-9 * hz);
    if (moved >= fabs(m->to - m->from))
        return m->to;
    return m->to > m->from ? m->from + moved : m->from - moved;
}

static void go_to(struct ad5422 *m, uint64_t now_ns, double code)
{
    m->from = m->control & SLEWS ? code_at(m, now_ns) : code;
    m->to = code;
    m->since_ns = now_ns;
}

/* What CLEAR makes of the output: zero, and with CLRSEL the middle of a voltage from 0 or the bottom of one of both signs. */
static uint16_t code_of_clear(const struct ad5422 *m)
{
    unsigned range = m->control & RANGE;
    bool both_signs = ranges[range].lo < 0.0;
    bool selected = !ranges[range].current && (m->control & CLEAR_SELECT);
    return both_signs != selected ? MIDDLE : 0;
}

/* mA or V that the code asks for; 0 where the range is not the one of this output, which then is not driven. */
static double wanted(const struct ad5422 *m, uint64_t now_ns, bool current)
{
    unsigned range = m->control & RANGE;
    if (!(m->control & ENABLED) || ranges[range].current != current)
        return 0.0;
    double span = ranges[range].hi - ranges[range].lo;
    double x = ranges[range].lo + span * code_at(m, now_ns) / FULL;
    return !current && (m->control & OVER_RANGE) ? 1.1 * x : x;
}

/* The most that the supply can drive through the loop, mA. */
static double most_ma(const struct ad5422 *m)
{
    const double *p = m->chip.property;
    double most = p[LOAD] > 0.0 ? (p[SUPPLY] - COMPLIANCE_V) / p[LOAD] * 1e3 : INFINITY;
    return m->chip.input[OPEN] != 0.0 ? 0.0 : most;
}

static double drives(struct chip *c, uint64_t now_ns)
{
    const struct ad5422 *m = of(c);
    bool current = c->property[SIGNAL] == 0.0;
    double x = wanted(m, now_ns, current);
    if (!current)
        return c->input[OPEN] != 0.0 ? 0.0 : x;
    return fmin(x, most_ma(m));
}

static uint16_t status(const struct ad5422 *m, uint64_t now_ns)
{
    unsigned bits = m->chip.input[HOT] != 0.0 ? HOT_DIE : 0;
    bool loop = m->chip.property[SIGNAL] == 0.0;
    double limit = loop ? most_ma(m) : 0.0; /* nothing is at IOUT where VOUT has the load */
    bits |= wanted(m, now_ns, true) > limit ? LOOP_FAULT : 0u;
    bits |= code_at(m, now_ns) != m->to ? SLEWING : 0u;
    return (uint16_t)bits;
}

/* ---- registers ---- */

static void start(struct ad5422 *m)
{
    m->control = m->data = 0;
    m->from = m->to = 0.0;
    m->cleared = m->clear;
    m->sdo = m->wrote_control = false;
    m->shift = 0;
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    (void)now_ns;
    start(of(c));
}

static void catch_up(struct chip *c, uint64_t now_ns)
{
    (void)now_ns;
    bool brown = c->input[BROWNOUT] != 0.0;
    if (brown && !of(c)->brown)
        start(of(c));
    of(c)->brown = brown;
}

/* A write halts a slope where it is; another range takes the data with it. */
static void write_control(struct ad5422 *m, uint64_t now_ns, uint16_t value)
{
    struct chip *c = &m->chip;
    double code = code_at(m, now_ns);
    bool other_range = ((value ^ m->control) & RANGE) != 0;
    if (!ranges[value & RANGE].exists)
        chip_wrong(c, "control register %04Xh: there is no range %u", value, value & RANGE);
    if (value & DAISY_CHAIN)
        chip_wrong(c, "control register %04Xh: this chip is alone, not in a daisy chain", value);
    if (other_range && (m->control & ENABLED))
        chip_wrong(c, "control register %04Xh: another range while the output is enabled", value);
    m->control = value;
    m->wrote_control = true;
    if (other_range) {
        m->data = code_of_clear(m);
        code = m->data;
    }
    m->from = m->to = code;
}

static void begin_answer(struct ad5422 *m, uint64_t now_ns, uint16_t which)
{
    uint16_t value = (which & 3u) == READ_STATUS    ? status(m, now_ns)
                     : (which & 3u) == READ_DATA    ? m->data
                     : (which & 3u) == READ_CONTROL ? m->control
                                                    : 0;
    if ((which & 3u) > READ_CONTROL)
        chip_wrong(&m->chip, "read of address %u; there are 0 to 2", which & 3u);
    m->answer[0] = (uint8_t)chip_random(&m->chip.random); /* no data sheet says what it is */
    m->answer[1] = (uint8_t)(value >> 8);
    m->answer[2] = (uint8_t)value;
    m->given = 0;
    m->sdo = true;
}

static void take_frame(struct ad5422 *m, uint64_t now_ns)
{
    unsigned address = (unsigned)(m->shift >> 16) & 0xFFu;
    uint16_t value = (uint16_t)m->shift;
    if (m->sdo && address != NOP)
        chip_wrong(&m->chip, "command %02Xh where a NOP has to fetch the answer to a read",
                   address);
    m->sdo = m->wrote_control = false;
    switch (address) {
    case NOP:
        break;
    case WRITE_DATA:
        if (!m->clear) { /* no new value can be programmed before CLEAR is low */
            m->data = value;
            m->cleared = false;
            go_to(m, now_ns, value);
        }
        break;
    case READ:
        begin_answer(m, now_ns, value);
        break;
    case WRITE_CONTROL:
        write_control(m, now_ns, value);
        break;
    case RESET:
        if (value & 1u)
            start(m);
        break;
    default:
        chip_wrong(&m->chip, "command %02Xh; there is none", address);
    }
}

/* ---- pins ---- */

static void latch(struct chip *c, uint64_t now_ns, bool low)
{
    struct ad5422 *m = of(c);
    if (c->dead)
        return;
    catch_up(c, now_ns);
    uint64_t high_ns = now_ns - m->latch_ns;
    if (low && m->wrote_control && high_ns > 0 && high_ns < AFTER_CONTROL_NS)
        chip_wrong(c, "LATCH was high for %u ns after the control register; at least %u ns",
                   (unsigned)high_ns, AFTER_CONTROL_NS);
    m->latch_low = low;
    if (low) {
        m->bits = 0;
        m->wrong_mode = false;
        c->stray_bits = 0;
        return;
    }
    m->latch_ns = now_ns;
    bool pulse = m->bits == 0 && c->stray_bits == 0;
    if (!pulse && m->bits + c->stray_bits != FRAME_BITS)
        chip_wrong(c, "LATCH rose after %u bits; a frame has 24", m->bits + c->stray_bits);
    m->shift <<= c->stray_bits;
    c->stray_bits = 0;
    if (!pulse)
        take_frame(m, now_ns);
    if (m->cleared &&
        !m->clear) { /* a pulse without clocks does so, and perhaps any (unverified) */
        m->cleared = false;
        go_to(m, now_ns, m->data);
    }
}

static void clear(struct chip *c, uint64_t now_ns, bool high)
{
    struct ad5422 *m = of(c);
    m->clear = high;
    if (high && !m->cleared) {
        m->cleared = true;
        go_to(m, now_ns, code_of_clear(m));
    }
}

static uint8_t exchange(struct chip *c, uint64_t now_ns, unsigned mode, uint8_t out)
{
    struct ad5422 *m = of(c);
    (void)now_ns;
    uint8_t in = 0xFF; /* SDO is not driven */
    if (m->sdo) {
        if (!m->latch_low)
            chip_wrong(c, "another chip is talked to while SDO is enabled; a NOP comes first");
        in = m->given < sizeof(m->answer) ? m->answer[m->given] : (uint8_t)chip_random(&c->random);
        m->given++;
    }
    m->bits += m->latch_low ? 8u : 0u;
    if (mode != 0 && mode != 3) { /* data are taken while the clock rises */
        if (m->latch_low && !m->wrong_mode)
            chip_wrong(c, "SPI mode %u; it takes modes 0 and 3", mode);
        m->wrong_mode = m->latch_low;
        out = (uint8_t)chip_random(&c->random);
        in = m->sdo ? (uint8_t)chip_random(&c->random) : in;
    }
    m->shift = (m->shift << 8 | out) & 0xFFFFFFu;
    return in;
}

const struct chip_kind chip_ad5422 = {.name = "ad5422",
                                      .bus = CHIP_SPI,
                                      .properties = properties,
                                      .n_properties = CHIP_COUNT(properties),
                                      .inputs = inputs,
                                      .n_inputs = CHIP_COUNT(inputs),
                                      .size = sizeof(struct ad5422),
                                      .power_on = power_on,
                                      .catch_up = catch_up,
                                      .select = latch,
                                      .exchange = exchange,
                                      .shifts_always = true,
                                      .clear = clear,
                                      .drives = drives};
