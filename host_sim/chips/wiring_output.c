/* Lines of a wiring file whose outputs are more than a pin that is on or off: chips with a load, and steppers.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <string.h>

#include "bench/text.h"
#include "chips/chip_inside.h"
#include "chips/wiring_inside.h"

#define CURRENT_LO 4.0 /* mA */
#define CURRENT_HI 20.0
#define VOLTAGE_HI 10.0

/* Takes the word name=value out of a text of words, and copies its value, which is "" where there is none. */
static void take_word(char *text, const char *name, char value[WIRING_TEXT_SIZE])
{
    size_t length = strlen(name);
    value[0] = '\0';
    for (char *word = text; *word != '\0'; word += strcspn(word, " ")) {
        word += strspn(word, " ");
        if (strncmp(word, name, length) != 0)
            continue;
        size_t whole = strcspn(word, " ");
        (void)snprintf(value, WIRING_TEXT_SIZE, "%.*s", (int)(whole - length), word + length);
        (void)memmove(word, word + whole, strlen(word + whole) + 1u);
        return;
    }
}

static struct wiring_output output_of(const struct words *s, const struct own *own,
                                      enum wiring_kind kind)
{
    struct wiring_output o = {.kind = kind,
                              .close_pin = HAL_PIN_NONE,
                              .end_pin = {HAL_PIN_NONE, HAL_PIN_NONE},
                              .clear_pin = HAL_PIN_NONE,
                              .low_active = own->low_active,
                              .lo = own->lo,
                              .hi = own->hi,
                              .lo_in = own->lo_in,
                              .hi_in = own->hi_in,
                              .line = s->line};
    sim_append(o.name, sizeof(o.name), "%s", s->word[0]);
    sim_append(o.quantity, sizeof(o.quantity), "%s", own->quantity);
    return o;
}

bool wiring_chip_output(struct wiring *w, const struct words *s, const struct chip_kind *kind,
                        char *err, size_t err_size)
{
    struct own own;
    char rest[WIRING_TEXT_SIZE], clear[WIRING_TEXT_SIZE];
    enum chip_bus bus;
    unsigned number;
    if (!wiring_properties(s, &own, rest, err, err_size))
        return false;
    if (s->places != 4 || !wiring_bus_named(s->word[2], &bus, &number) || bus != kind->bus)
        return sim_fail(err, err_size, "%s has its place as in spi1 PA4", kind->name);
    if (own.has_active || own.has_travel)
        return sim_fail(err, err_size, "%s has no property active or travel", kind->name);
    take_word(rest, "clear=", clear);
    if (clear[0] == '\0')
        return sim_fail(err, err_size, "%s needs clear=, the pin of its CLEAR", kind->name);
    struct wiring_output o = output_of(s, &own, WIRING_CHIP);
    if (!wiring_take_pin(w, s->word[3], &o.pin, err, err_size) ||
        !wiring_take_pin(w, clear, &o.clear_pin, err, err_size))
        return false;
    if (o.pin == o.clear_pin)
        return sim_fail(err, err_size, "%s stands twice; LATCH and CLEAR are two pins", clear);
    o.chip = wiring_make_chip(w, kind->name, rest, err, err_size);
    if (o.chip == NULL)
        return false;
    if (!own.has_input_range) {
        bool current = o.chip->property[0] == 0.0;
        o.lo_in = current ? CURRENT_LO : 0.0;
        o.hi_in = current ? CURRENT_HI : VOLTAGE_HI;
    }
    if (!chips_add(wiring_make_bus(w, bus, number), o.chip, o.pin, err, err_size))
        return false;
    w->output[w->n_outputs++] = o;
    return true;
}

bool wiring_stepper(struct wiring *w, const struct words *s, char *err, size_t err_size)
{
    struct own own;
    char rest[WIRING_TEXT_SIZE], steps[WIRING_TEXT_SIZE];
    if (!wiring_properties(s, &own, rest, err, err_size))
        return false;
    if (s->places < 3 || s->places > 4)
        return sim_fail(err, err_size,
                        "stepper has the pin of its steps, and one of its direction or none");
    struct wiring_output o = output_of(s, &own, WIRING_STEPPER);
    take_word(rest, "steps=", steps);
    if (!sim_parse_number(steps, &o.steps) || !(o.steps > 0.0))
        return sim_fail(err, err_size, "stepper needs steps=, a number for each ml");
    const char *other = rest + strspn(rest, " ");
    if (*other != '\0' || own.has_input_range || own.has_travel)
        return sim_fail(err, err_size,
                        "stepper has no property %s; it has quantity, active, hi, steps",
                        own.has_travel        ? "travel"
                        : own.has_input_range ? "lo_in or hi_in"
                                              : other);
    if (own.lo != 0.0 || own.hi < 0.0)
        return sim_fail(err, err_size, "a stepper gives from 0 to hi l/h, and has no lo");
    if (!wiring_take_pin(w, s->word[2], &o.pin, err, err_size) ||
        (s->places == 4 && !wiring_take_pin(w, s->word[3], &o.close_pin, err, err_size)))
        return false;
    if (o.pin == o.close_pin)
        return sim_fail(err, err_size, "%s stands twice; steps and direction are two pins",
                        s->word[3]);
    w->output[w->n_outputs++] = o;
    return true;
}
