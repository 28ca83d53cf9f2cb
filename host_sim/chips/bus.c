/* Buses with their chips: who is selected or addressed, whose bits come through, and faults of the lines.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include "chips/bus.h"

#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "chips/chip.h"
#include "chips/chip_inside.h"

struct connection {
    struct chip *chip;
    hal_pin select;
    bool low;       /* SPI: selected */
    bool addressed; /* I2C: acknowledged its address, since the last start */
};

struct chips {
    enum chip_bus kind;
    struct connection place[CHIPS_MAX];
    size_t n;
    double noise;
    bool stuck, floats_low;
    bool acknowledged; /* I2C: the last byte that was read */
    bool held; /* 1-wire: the line was low after the last reset pulse, so that there are no slots */
    uint64_t random;
};

static const char *const bus_names[] = {"spi", "i2c", "wire"};

struct chips *chips_new(enum chip_bus kind, uint64_t seed)
{
    struct chips *b = calloc(1, sizeof(*b));
    if (b != NULL) {
        b->kind = kind;
        b->random = seed;
    }
    return b;
}

void chips_free(struct chips *b)
{
    free(b);
}

bool chips_add(struct chips *b, struct chip *chip, hal_pin select, char *err, size_t err_size)
{
    if (chip->kind->bus != b->kind) {
        return sim_fail(err, err_size, "%s is a chip for %s, not for %s", chip->kind->name,
                        bus_names[chip->kind->bus], bus_names[b->kind]);
    }
    if (b->n == CHIPS_MAX) {
        return sim_fail(err, err_size, "%s: more than %u chips on one bus", chip->kind->name,
                        CHIPS_MAX);
    }
    for (size_t i = 0; b->kind == CHIP_SPI && i < b->n; i++) {
        if (b->place[i].select == select) {
            return sim_fail(err, err_size, "%s has the select of another %s", chip->kind->name,
                            b->place[i].chip->kind->name);
        }
    }
    b->place[b->n++] = (struct connection){.chip = chip, .select = select};
    return true;
}

void chips_replace(struct chips *b, const struct chip *chip, struct chip *by)
{
    for (size_t i = 0; i < b->n; i++) {
        if (b->place[i].chip == chip) {
            b->place[i].chip = by;
            b->place[i].addressed = false;
        }
    }
}

bool chips_held_low(const struct chips *b)
{
    return b->stuck;
}

bool chips_set(struct chips *b, const char *fault, double value, char *err, size_t err_size)
{
    if (strcmp(fault, "noise") == 0) {
        if (!(value >= 0.0 && value <= 1.0)) {
            return sim_fail(err, err_size, "noise is a probability, 0 to 1, not %g", value);
        }
        b->noise = value;
    } else if (strcmp(fault, "stuck") == 0) {
        b->stuck = value != 0.0;
    } else if (strcmp(fault, "floats_low") == 0) {
        b->floats_low = value != 0.0;
    } else {
        return sim_fail(err, err_size, "a bus has no fault %s; it has noise, stuck, floats_low",
                        fault);
    }
    return true;
}

void chips_at(struct chips *b, uint64_t now_ns)
{
    for (size_t i = 0; i < b->n; i++) {
        chip_at(b->place[i].chip, now_ns);
    }
}

const char *chips_wrong(const struct chips *b, unsigned *count)
{
    const char *first = "";
    unsigned wrongs = 0;
    for (size_t i = 0; i < b->n; i++) {
        wrongs += b->place[i].chip->wrongs;
        if (first[0] == '\0') {
            first = b->place[i].chip->wrong;
        }
    }
    if (count != NULL) {
        *count = wrongs;
    }
    return first;
}

/* The low `bits` bits of a byte as they arrive over a noisy line. */
static uint8_t noisy(struct chips *b, uint8_t byte, unsigned bits)
{
    for (unsigned i = 0; b->noise > 0.0 && i < bits; i++) {
        if (chip_uniform(&b->random) < b->noise) {
            byte ^= (uint8_t)(1u << i);
        }
    }
    return byte;
}

/* Chips that are selected, but for the one at this place. */
static bool others_selected(const struct chips *b, size_t place)
{
    for (size_t i = 0; i < b->n; i++) {
        if (i != place && b->place[i].low) {
            return true;
        }
    }
    return false;
}

void chips_select(struct chips *b, uint64_t now_ns, hal_pin pin, bool low)
{
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        if (at->select == pin && at->low != low) {
            at->low = low;
            if (low && others_selected(b, i)) {
                chip_wrong(at->chip, "selected while another chip of the bus is");
            }
            if (at->chip->powered) {
                at->chip->kind->select(at->chip, now_ns, low);
            }
        }
    }
}

uint8_t chips_exchange(struct chips *b, uint64_t now_ns, unsigned mode, uint8_t out)
{
    uint8_t in = 0xFF;
    bool driven = false;
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        if ((at->low || at->chip->kind->shifts_always) && chip_answers(at->chip)) {
            /* Two that are selected at once: the lower level wins. */
            in &= at->chip->kind->exchange(at->chip, now_ns, mode, noisy(b, out, 8));
            driven = driven || at->low;
        }
    }
    if (!driven && b->floats_low) {
        in = 0;
    }
    return b->stuck ? 0 : noisy(b, in, 8);
}

void chips_clock_bits(struct chips *b, uint64_t now_ns, unsigned bits)
{
    (void)now_ns;
    for (size_t i = 0; i < b->n; i++) {
        if (b->place[i].low) {
            b->place[i].chip->stray_bits = bits;
        }
    }
}

/* The end of a read: a chip whose last byte was acknowledged goes on to drive the data line. */
static void end_read(struct chips *b)
{
    for (size_t i = 0; i < b->n && b->acknowledged; i++) {
        if (b->place[i].addressed) {
            chip_wrong(b->place[i].chip, "a read ends behind a byte that was acknowledged");
        }
    }
    b->acknowledged = false;
}

enum chips_answer chips_start(struct chips *b, uint64_t now_ns, uint8_t address, bool read)
{
    end_read(b);
    if (b->stuck) {
        return CHIPS_HELD_LOW;
    }
    uint8_t on_line = noisy(b, (uint8_t)((unsigned)address << 1 | (read ? 1u : 0u)), 8);
    bool acknowledged = false;
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        at->addressed = chip_answers(at->chip) &&
                        at->chip->kind->address(at->chip, now_ns, on_line >> 1, on_line & 1u);
        acknowledged = acknowledged || at->addressed;
    }
    return noisy(b, acknowledged, 1) ? CHIPS_ANSWER : CHIPS_SILENT;
}

bool chips_write(struct chips *b, uint64_t now_ns, uint8_t byte)
{
    uint8_t on_line = b->stuck ? 0 : noisy(b, byte, 8);
    bool acknowledged = false;
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        if (at->addressed && chip_answers(at->chip)) {
            acknowledged = at->chip->kind->write(at->chip, now_ns, on_line) || acknowledged;
        }
    }
    return b->stuck || noisy(b, acknowledged, 1);
}

uint8_t chips_read(struct chips *b, uint64_t now_ns, bool acknowledge)
{
    uint8_t in = 0xFF; /* pulled up */
    b->acknowledged = acknowledge;
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        if (at->addressed && chip_answers(at->chip)) {
            in &= at->chip->kind->read(at->chip, now_ns, acknowledge);
        }
    }
    return b->stuck ? 0 : noisy(b, in, 8);
}

void chips_stop(struct chips *b, uint64_t now_ns)
{
    end_read(b);
    for (size_t i = 0; i < b->n; i++) {
        struct connection *at = &b->place[i];
        if (at->addressed && chip_answers(at->chip)) {
            at->chip->kind->stop(at->chip, now_ns);
        }
        at->addressed = false;
    }
}

/* Line of a wire as the chips leave it. */
static bool line_high(struct chips *b, uint64_t now_ns)
{
    bool high = !b->stuck;
    for (size_t i = 0; i < b->n; i++) {
        struct chip *c = b->place[i].chip;
        high = (!chip_answers(c) || c->kind->bit_in(c, now_ns)) && high;
    }
    return high;
}

enum chips_answer chips_reset(struct chips *b, uint64_t now_ns)
{
    bool present = false;
    for (size_t i = 0; i < b->n; i++) {
        struct chip *c = b->place[i].chip;
        present = (chip_answers(c) && c->kind->presence(c, now_ns)) || present;
    }
    b->held = !line_high(b, now_ns); /* nobody has anything to send after a reset */
    if (b->held) {
        return CHIPS_HELD_LOW;
    }
    return noisy(b, present, 1) ? CHIPS_ANSWER : CHIPS_SILENT;
}

bool chips_slot(struct chips *b, uint64_t now_ns, bool out)
{
    if (b->held) {
        return false;
    }
    bool high = line_high(b, now_ns) && out;
    for (size_t i = 0; i < b->n; i++) {
        struct chip *c = b->place[i].chip;
        if (chip_answers(c)) {
            c->kind->bit_out(c, now_ns, noisy(b, high, 1));
        }
    }
    return noisy(b, high, 1);
}
