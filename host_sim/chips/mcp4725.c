/* MCP4725, a voltage of 12 bits from 0 to its supply. Sections are those of the data sheet DS22039D: 6.1 and figure 6-2 (write commands) and 6.2
 * with figure 6-3 (read command) were read. That figure 6-1 repeats the two bytes of a fast write, that the memory takes up to 50 ms to be
 * written, that it holds 800h when the chip is new, and what the general call does (7.3) is from memory (unverified).
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chips/chip_inside.h"

#define CODES          4096.0
#define MEMORY_NS      CHIP_MS(50)
#define FAST_BYTES     2u
#define COMMAND_BYTES  3u
#define READ_BYTES     5u
#define GENERAL_CALL   0x00u
#define RESET          0x06u
#define WAKE_UP        0x09u
#define READY          0x80u
#define POWERED        0x40u
#define WRITE_REGISTER 2u /* C2, C1, C0 */
#define WRITE_MEMORY   3u

enum { ADDRESS, SUPPLY, STORED };
static const struct chip_property properties[] = {
    [ADDRESS] = {.name = "address",
                 .unit = "",
                 .lo = 0x60,
                 .hi = 0x67,
                 .at_first = 0x60,
                 .parse = chip_parse_hex,
                 .form = "0x60 to 0x67"},
    [SUPPLY] = {.name = "supply", .unit = "V", .lo = 2.7, .hi = 5.5, .at_first = 3.3},
    [STORED] = {.name = "stored", .unit = "", .lo = 0, .hi = 4095, .at_first = 2048},
};

enum { STUCK, NACK };
static const struct chip_input inputs[] = {
    [STUCK] = {"stuck", "", 0, 1, 0, "the output stays as it is"},
    [NACK] = {"nack", "", 0, 1, 0, "it acknowledges its address and no byte"},
};

/* Code and power-down bits. */
struct setting {
    uint16_t code;
    uint8_t down; /* PD1, PD0; 0: the output is on */
};

struct mcp4725 {
    struct chip chip;
    bool made; /* the memory holds something */
    struct setting set, stored, out;
    uint64_t stored_ns; /* until then the memory is being written */
    bool general;
    uint8_t byte[COMMAND_BYTES];
    unsigned n; /* bytes of the command under way */
    unsigned given;
};

static struct mcp4725 *of(struct chip *c)
{
    return (struct mcp4725 *)c;
}

static void take(struct mcp4725 *m, struct setting s)
{
    m->set = s;
    if (m->chip.input[STUCK] == 0.0) {
        m->out = s;
    }
}

static void power_on(struct chip *c, uint64_t now_ns)
{
    struct mcp4725 *m = of(c);
    (void)now_ns;
    if (!m->made) {
        m->stored = (struct setting){.code = (uint16_t)c->property[STORED]};
        m->made = true;
    }
    m->set = m->out = m->stored;
    m->stored_ns = 0;
    m->general = false;
    m->n = m->given = 0;
}

static bool take_address(struct chip *c, uint64_t now_ns, uint8_t address, bool reads)
{
    struct mcp4725 *m = of(c);
    (void)now_ns;
    m->general = address == GENERAL_CALL && !reads;
    m->n = m->given = 0;
    return m->general || address == (uint8_t)c->property[ADDRESS];
}

/* The bytes of a whole command. */
static void carry_out(struct mcp4725 *m, uint64_t now_ns)
{
    unsigned command = m->byte[0] >> 5;
    bool fast = m->n == FAST_BYTES;
    struct setting s = fast ? (struct setting){(uint16_t)((m->byte[0] & 0x0Fu) << 8 | m->byte[1]),
                                               (uint8_t)(m->byte[0] >> 4 & 3u)}
                            : (struct setting){(uint16_t)(m->byte[1] << 4 | m->byte[2] >> 4),
                                               (uint8_t)(m->byte[0] >> 1 & 3u)};
    m->n = 0;
    if (now_ns < m->stored_ns) {
        chip_wrong(&m->chip, "written %.1f ms before the memory is written, which ignores it",
                   (double)(m->stored_ns - now_ns) * 1e-6);
    } else if (fast || command == WRITE_REGISTER) {
        take(m, s);
    } else if (command == WRITE_MEMORY) {
        take(m, s);
        m->stored = s;
        m->stored_ns = now_ns + MEMORY_NS;
    } else {
        chip_wrong(&m->chip, "command %u is reserved", command);
    }
}

static bool take_byte(struct chip *c, uint64_t now_ns, uint8_t byte)
{
    struct mcp4725 *m = of(c);
    if (m->general) {
        if (byte == RESET) {
            power_on(c, now_ns);
        } else if (byte == WAKE_UP) {
            take(m, (struct setting){.code = m->set.code});
        }
        return true;
    }
    if (c->input[NACK] != 0.0) {
        return false;
    }
    m->byte[m->n++] = byte;
    bool fast = (m->byte[0] & 0xC0u) == 0;
    if (m->n == (fast ? FAST_BYTES : COMMAND_BYTES)) {
        carry_out(m, now_ns);
    }
    return true;
}

static uint8_t give_byte(struct chip *c, uint64_t now_ns, bool acknowledged)
{
    const struct mcp4725 *m = of(c);
    bool ready = now_ns >= m->stored_ns;
    (void)acknowledged;
    switch (of(c)->given++ % READ_BYTES) {
    case 0:
        return (uint8_t)((ready ? READY : 0u) | POWERED | (unsigned)m->set.down << 1);
    case 1:
        return (uint8_t)(m->set.code >> 4);
    case 2:
        return (uint8_t)(m->set.code << 4);
    case 3:
        return (uint8_t)((unsigned)m->stored.down << 5 | m->stored.code >> 8);
    default:
        return (uint8_t)m->stored.code;
    }
}

static void stop(struct chip *c, uint64_t now_ns)
{
    struct mcp4725 *m = of(c);
    (void)now_ns;
    if (m->n != 0) {
        chip_wrong(c, "%u byte%s of a command, which has %u", m->n, m->n == 1 ? "" : "s",
                   (m->byte[0] & 0xC0u) == 0 ? FAST_BYTES : COMMAND_BYTES);
    }
    m->n = 0;
    m->general = false;
}

static double volts(const struct chip *c)
{
    const struct mcp4725 *m = (const struct mcp4725 *)c;
    return m->out.down != 0 ? 0.0 : c->property[SUPPLY] * m->out.code / CODES;
}

const struct chip_kind chip_mcp4725 = {.name = "mcp4725",
                                       .bus = CHIP_I2C,
                                       .properties = properties,
                                       .n_properties = CHIP_COUNT(properties),
                                       .inputs = inputs,
                                       .n_inputs = CHIP_COUNT(inputs),
                                       .size = sizeof(struct mcp4725),
                                       .power_on = power_on,
                                       .address = take_address,
                                       .write = take_byte,
                                       .read = give_byte,
                                       .stop = stop,
                                       .volts = volts};
