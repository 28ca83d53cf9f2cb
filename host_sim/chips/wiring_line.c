/* Lines of a wiring file.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <ctype.h>
#include <string.h>

#include "bench/text.h"
#include "chips/chip_inside.h"
#include "chips/wiring_inside.h"

const char *const wiring_bus_names[WIRING_BUS_KINDS] = {"spi", "i2c", "wire"};
static const char *const output_kinds[] = {"ssr", "relay", "pwm", "valve", "stepper"};

bool wiring_bus_named(const char *name, enum chip_bus *kind, unsigned *number)
{
    for (unsigned k = 0; k < WIRING_BUS_KINDS; k++) {
        size_t length = strlen(wiring_bus_names[k]);
        if (strncmp(name, wiring_bus_names[k], length) == 0 && name[length] >= '1' &&
            name[length] <= '9' && name[length + 1] == '\0') {
            *kind = (enum chip_bus)k;
            *number = (unsigned)(name[length] - '0');
            return true;
        }
    }
    return false;
}

/* PA4. */
static bool read_pin(const char *text, hal_pin *pin)
{
    uint64_t number;
    if (text[0] != 'P' || text[1] < 'A' || text[1] > 'I' || !isdigit((unsigned char)text[2]) ||
        !sim_parse_unsigned(text + 2, &number) || number > 15) {
        return false;
    }
    *pin = HAL_PIN(text[1], (int)number);
    return true;
}

static bool no_pin(const char *text, char *err, size_t err_size)
{
    return sim_fail(err, err_size, "%s is no pin; pins are PA0 to PI15", text);
}

bool wiring_take_pin(const struct wiring *w, const char *text, hal_pin *pin, char *err,
                     size_t err_size)
{
    if (!read_pin(text, pin)) {
        return no_pin(text, err, err_size);
    }
    for (size_t i = 0; i < w->n_sensors; i++) {
        if (w->sensor[i].select == *pin) {
            return sim_fail(err, err_size, "%s is the %s of %s in line %u; each has its own pin",
                            text, w->sensor[i].bus == CHIP_PIN ? "pin" : "select",
                            w->sensor[i].name, w->sensor[i].line);
        }
    }
    for (size_t i = 0; i < w->n_outputs; i++) {
        const struct wiring_output *o = &w->output[i];
        if (o->pin == *pin || o->close_pin == *pin || o->end_pin[0] == *pin ||
            o->end_pin[1] == *pin || o->clear_pin == *pin) {
            return sim_fail(err, err_size, "%s is a pin of %s in line %u; each has its own pin",
                            text, w->output[i].name, w->output[i].line);
        }
    }
    return true;
}

static bool take_name(const struct wiring *w, const char *name, char *err, size_t err_size)
{
    static const char letters[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-";
    enum chip_bus kind;
    unsigned number;
    if (strspn(name, letters) != strlen(name) || !isalpha((unsigned char)name[0]) ||
        strlen(name) >= WIRING_NAME_SIZE) {
        return sim_fail(
            err, err_size,
            "%s is no name; it has up to %u letters, digits, - and _, a letter in front", name,
            WIRING_NAME_SIZE - 1);
    }
    if (wiring_bus_named(name, &kind, &number)) {
        return sim_fail(err, err_size, "%s is the name of a bus", name);
    }
    for (size_t i = 0; i < w->n_sensors + w->n_outputs; i++) {
        bool sensor = i < w->n_sensors;
        const char *other = sensor ? w->sensor[i].name : w->output[i - w->n_sensors].name;
        if (strcmp(name, other) == 0) {
            return sim_fail(err, err_size, "%s is there already, in line %u", name,
                            sensor ? w->sensor[i].line : w->output[i - w->n_sensors].line);
        }
    }
    return true;
}

/* A property of the line's own. taken: it is one. */
static bool own_property(struct own *own, const char *word, bool *taken, char *err, size_t err_size)
{
    const struct {
        const char *name;
        double *value;
        bool *given;
    } numbers[] = {{"lo=", &own->lo, NULL},
                   {"hi=", &own->hi, NULL},
                   {"lo_in=", &own->lo_in, &own->has_input_range},
                   {"hi_in=", &own->hi_in, &own->has_input_range},
                   {"travel=", &own->travel_s, &own->has_travel}};
    *taken = true;
    for (size_t i = 0; i < CHIP_COUNT(numbers); i++) {
        size_t length = strlen(numbers[i].name);
        if (strncmp(word, numbers[i].name, length) == 0) {
            if (!sim_parse_number(word + length, numbers[i].value)) {
                return sim_fail(err, err_size, "%.*s is a number, not %s", (int)length - 1, word,
                                word + length);
            }
            if (numbers[i].given != NULL) {
                *numbers[i].given = true;
            }
            return true;
        }
    }
    if (strncmp(word, "quantity=", 9) == 0) {
        own->quantity = word + 9;
        size_t length = strlen(own->quantity);
        return (length > 0 && length < WIRING_NAME_SIZE) ||
               sim_fail(err, err_size, "quantity is a name of up to %u characters",
                        WIRING_NAME_SIZE - 1);
    }
    if (strncmp(word, "active=", 7) == 0) {
        own->low_active = strcmp(word + 7, "low") == 0;
        own->has_active = true;
        return own->low_active || strcmp(word + 7, "high") == 0 ||
               sim_fail(err, err_size, "active is high or low, not %s", word + 7);
    }
    *taken = false;
    return true;
}

bool wiring_properties(const struct words *s, struct own *own, char *rest, char *err,
                       size_t err_size)
{
    *own = (struct own){.hi = 1.0, .hi_in = 1.0, .quantity = s->word[0]};
    rest[0] = '\0';
    for (size_t i = s->places; i < s->n; i++) {
        bool taken;
        if (strchr(s->word[i], '=') == NULL) {
            return sim_fail(err, err_size, "%s stands behind properties, which are name=value",
                            s->word[i]);
        }
        if (!own_property(own, s->word[i], &taken, err, err_size)) {
            return false;
        }
        if (!taken) {
            sim_append(rest, WIRING_TEXT_SIZE, "%s%s", rest[0] == '\0' ? "" : " ", s->word[i]);
        }
    }
    if (own->lo == own->hi || own->lo_in == own->hi_in) {
        return sim_fail(err, err_size, "lo and hi, lo_in and hi_in are two values each, not one");
    }
    return true;
}

static bool read_output(struct wiring *w, const struct words *s, enum wiring_kind kind, char *err,
                        size_t err_size)
{
    struct own own;
    char rest[WIRING_TEXT_SIZE];
    struct wiring_output o = {.kind = kind,
                              .close_pin = HAL_PIN_NONE,
                              .end_pin = {HAL_PIN_NONE, HAL_PIN_NONE},
                              .clear_pin = HAL_PIN_NONE,
                              .line = s->line};
    size_t pins = s->places - 2;
    bool turns = kind == WIRING_VALVE && (pins == 2 || pins == 4);
    if (pins != 1 && !turns) {
        return sim_fail(err, err_size, "%s stands with %s; it has %s", s->word[1],
                        pins == 0 ? "no pin" : "too many pins",
                        kind == WIRING_VALVE ? "one pin, or two that open and close it, and then "
                                               "two or none of contacts at its ends"
                                             : "one pin");
    }
    if (!wiring_properties(s, &own, rest, err, err_size)) {
        return false;
    }
    hal_pin *const taken[] = {&o.pin, &o.close_pin, &o.end_pin[0], &o.end_pin[1]};
    for (size_t i = 0; i < pins; i++) {
        if (!wiring_take_pin(w, s->word[2 + i], taken[i], err, err_size)) {
            return false;
        }
        for (size_t k = 0; k < i; k++) {
            if (*taken[k] == *taken[i]) {
                return sim_fail(err, err_size,
                                "%s stands twice; a valve has a pin for each way and each end",
                                s->word[2 + i]);
            }
        }
    }
    if (rest[0] != '\0' || own.has_input_range) {
        return sim_fail(err, err_size, "%s has no property %s; it has quantity, active, lo, hi%s",
                        s->word[1], rest[0] != '\0' ? rest : "lo_in or hi_in",
                        kind == WIRING_VALVE ? ", travel" : "");
    }
    if (own.has_travel != turns || (turns && !(own.travel_s > 0.0))) {
        return sim_fail(
            err, err_size,
            "travel=, in s, stands with a valve that pins open and close and nowhere else");
    }
    sim_append(o.name, sizeof(o.name), "%s", s->word[0]);
    sim_append(o.quantity, sizeof(o.quantity), "%s", own.quantity);
    o.low_active = own.low_active;
    o.lo = own.lo;
    o.hi = own.hi;
    o.travel_s = own.travel_s;
    w->output[w->n_outputs++] = o;
    return true;
}

/* The word for an input of the chip: a name, a number of one of several, or nothing for the first. */
static bool read_input(const struct chip_kind *kind, const char *word, struct wiring_sensor *sensor,
                       char *err, size_t err_size)
{
    bool several = strcmp(kind->inputs[0].name, "in0") == 0;
    char name[WIRING_NAME_SIZE + 2] = "";
    if (word == NULL && several) {
        return sim_fail(err, err_size,
                        "%s has several inputs; the number of one stands behind the address",
                        kind->name);
    }
    sim_append(name, sizeof(name), "%s%s", several && isdigit((unsigned char)word[0]) ? "in" : "",
               word == NULL ? kind->inputs[0].name : word);
    int i = chip_input_index(kind, name);
    if (i < 0 || kind->inputs[i].unit[0] == '\0') {
        (void)sim_fail(err, err_size, "%s does not measure %s; it measures", kind->name, word);
        for (size_t k = 0; k < kind->n_inputs; k++) {
            if (kind->inputs[k].unit[0] != '\0') {
                sim_append(err, err_size, " %s", kind->inputs[k].name);
            }
        }
        return false;
    }
    sensor->input = kind->inputs[i].name;
    return true;
}

/* Bus and place on it. */
static bool read_place(const struct words *s, const struct chip_kind *kind,
                       struct wiring_sensor *sensor, char *err, size_t err_size)
{
    static const char *const examples[] = {"spi1 PA4", "i2c1 0x48", "wire1"};
    if (kind->bus == CHIP_PIN) {
        return s->places == 3 ||
               sim_fail(err, err_size, "%s stands at one pin, as in PC0", kind->name);
    }
    size_t needed = kind->bus == CHIP_ONEWIRE ? 3u : 4u;
    enum chip_bus bus = kind->bus;
    if (s->places < 3 || !wiring_bus_named(s->word[2], &bus, &sensor->bus_number)) {
        return sim_fail(err, err_size, "%s stands on a bus, as in %s", kind->name,
                        examples[kind->bus]);
    }
    if (bus != kind->bus) {
        return sim_fail(err, err_size, "%s is no bus for a %s; it stands on one as in %s",
                        s->word[2], kind->name, examples[kind->bus]);
    }
    if (s->places < needed || s->places > needed + 1u) {
        return sim_fail(err, err_size, "%s has its place as in %s%s", kind->name,
                        examples[kind->bus], s->places > needed ? ", and one input" : "");
    }
    if (kind->bus == CHIP_SPI && !read_pin(s->word[3], &sensor->select)) {
        return no_pin(s->word[3], err, err_size);
    }
    double address = 0.0;
    if (kind->bus == CHIP_I2C && (!chip_parse_hex(s->word[3], &address) || address > 0x7F)) {
        return sim_fail(err, err_size, "%s is no address; one is written 0x48", s->word[3]);
    }
    sensor->address = (uint8_t)address;
    return read_input(kind, s->places > needed ? s->word[needed] : NULL, sensor, err, err_size);
}

struct chips *wiring_make_bus(struct wiring *w, enum chip_bus kind, unsigned number)
{
    struct chips **b = &w->bus[kind][number - 1];
    if (*b == NULL) {
        *b = chips_new(kind, w->seed * 31u + (uint64_t)kind * 10u + number);
    }
    return *b;
}

struct chip *wiring_make_chip(struct wiring *w, const char *kind, const char *properties, char *err,
                              size_t err_size)
{
    struct chip *c =
        chip_new(kind, properties, w->seed + 1000003u * (w->n_chips + 1u), err, err_size);
    if (c != NULL) {
        w->chip[w->n_chips++] = c;
    }
    return c;
}

/* The chip that is at this place already. True in `there`; false is returned where this line does not go with it. */
static bool share_chip(const struct wiring *w, const struct chip_kind *kind, const char *rest,
                       const char *place, struct wiring_sensor *sensor, bool *there, char *err,
                       size_t err_size)
{
    for (size_t i = 0; i < w->n_sensors; i++) {
        const struct wiring_sensor *o = &w->sensor[i];
        bool same_place =
            kind->bus == o->bus && kind->bus != CHIP_ONEWIRE && kind->bus != CHIP_PIN &&
            (kind->bus == CHIP_SPI
                 ? o->select == sensor->select
                 : o->address == sensor->address && o->bus_number == sensor->bus_number);
        if (!same_place) {
            continue;
        }
        if (o->chip->kind != kind || o->bus_number != sensor->bus_number) {
            return sim_fail(err, err_size,
                            "%s has %s already, %s in line %u; each chip has its own", place,
                            o->chip->kind->name, o->name, o->line);
        }
        if (strcmp(o->input, sensor->input) == 0) {
            return sim_fail(err, err_size,
                            "%s at %s is %s in line %u already; each has an input of its own",
                            sensor->input, place, o->name, o->line);
        }
        if (rest[0] != '\0') {
            return sim_fail(err, err_size, "properties of the chip stand in line %u, with %s",
                            o->line, o->name);
        }
        sensor->chip = o->chip;
        *there = true;
    }
    return true;
}

static bool make_chip(struct wiring *w, const struct chip_kind *kind, const char *rest,
                      struct wiring_sensor *sensor, char *err, size_t err_size)
{
    char properties[WIRING_TEXT_SIZE + 32u];
    if (kind->bus == CHIP_I2C && strstr(rest, "address=") != NULL) {
        return sim_fail(err, err_size, "the address stands behind the bus, not as a property");
    }
    (void)snprintf(properties, sizeof(properties),
                   kind->bus == CHIP_I2C ? "%s address=0x%02x" : "%s", rest, sensor->address);
    sensor->chip = wiring_make_chip(w, kind->name, properties, err, err_size);
    if (sensor->chip == NULL) {
        return false;
    }
    for (size_t i = 0; kind->bus == CHIP_ONEWIRE && i < w->n_sensors; i++) {
        const struct wiring_sensor *o = &w->sensor[i];
        /* Addresses that the seed makes are not there yet: NAN is never the same. */
        if (o->chip->kind == kind && o->chip->property[0] == sensor->chip->property[0]) {
            return sim_fail(err, err_size,
                            "the rom is that of %s in line %u; each chip has its own", o->name,
                            o->line);
        }
    }
    return kind->bus == CHIP_PIN || chips_add(wiring_make_bus(w, sensor->bus, sensor->bus_number),
                                              sensor->chip, sensor->select, err, err_size);
}

static bool read_sensor(struct wiring *w, const struct words *s, const struct chip_kind *kind,
                        char *err, size_t err_size)
{
    struct own own;
    char rest[WIRING_TEXT_SIZE];
    struct wiring_sensor sensor = {
        .bus = kind->bus, .select = HAL_PIN_NONE, .input = kind->inputs[0].name, .line = s->line};
    bool there = false;
    if (!wiring_properties(s, &own, rest, err, err_size) ||
        !read_place(s, kind, &sensor, err, err_size)) {
        return false;
    }
    if (own.has_active || own.has_travel) {
        return sim_fail(err, err_size, "active and travel are properties of outputs");
    }
    bool one_word = kind->bus == CHIP_ONEWIRE || kind->bus == CHIP_PIN;
    const char *place = s->word[one_word ? 2 : 3];
    if (!share_chip(w, kind, rest, place, &sensor, &there, err, err_size)) {
        return false;
    }
    if (!there && (kind->bus == CHIP_SPI || kind->bus == CHIP_PIN) &&
        !wiring_take_pin(w, place, &sensor.select, err, err_size)) {
        return false;
    }
    if (!there && !make_chip(w, kind, rest, &sensor, err, err_size)) {
        return false;
    }
    sim_append(sensor.name, sizeof(sensor.name), "%s", s->word[0]);
    sim_append(sensor.quantity, sizeof(sensor.quantity), "%s", own.quantity);
    sensor.lo = own.lo;
    sensor.hi = own.hi;
    sensor.lo_in = own.lo_in;
    sensor.hi_in = own.hi_in;
    w->sensor[w->n_sensors++] = sensor;
    return true;
}

static bool no_kind(const char *word, char *err, size_t err_size)
{
    size_t n;
    const struct chip_kind *const *kinds = chip_kinds(&n);
    (void)sim_fail(err, err_size, "%s is no chip and no output; there are", word);
    for (size_t i = 0; i < n; i++) {
        sim_append(err, err_size, " %s,", kinds[i]->name);
    }
    sim_append(err, err_size, " ssr, relay, pwm, valve, stepper");
    return false;
}

bool wiring_line(struct wiring *w, char *text, unsigned line, char *err, size_t err_size)
{
    struct words s = {.line = line};
    text[strcspn(text, "#")] = '\0';
    for (char *word = strtok(text, " \t\r\n"); word != NULL; word = strtok(NULL, " \t\r\n")) {
        if (s.n == WIRING_WORDS_MAX) {
            return sim_fail(err, err_size, "more than %u words", WIRING_WORDS_MAX);
        }
        s.word[s.n++] = word;
    }
    if (s.n == 0) {
        return true;
    }
    while (s.places < s.n && strchr(s.word[s.places], '=') == NULL) {
        s.places++;
    }
    if (s.places < 2) {
        return sim_fail(err, err_size,
                        "a line is a name, a chip or output, its place and properties");
    }
    if (w->n_sensors == WIRING_LINES_MAX || w->n_outputs == WIRING_LINES_MAX) {
        return sim_fail(err, err_size, "more than %u of a kind", WIRING_LINES_MAX);
    }
    if (!take_name(w, s.word[0], err, err_size)) {
        return false;
    }
    for (size_t i = 0; i < CHIP_COUNT(output_kinds); i++) {
        if (strcmp(s.word[1], output_kinds[i]) == 0) {
            return i == WIRING_STEPPER ? wiring_stepper(w, &s, err, err_size)
                                       : read_output(w, &s, (enum wiring_kind)i, err, err_size);
        }
    }
    size_t n;
    const struct chip_kind *const *kinds = chip_kinds(&n);
    for (size_t i = 0; i < n; i++) {
        if (strcmp(s.word[1], kinds[i]->name) == 0) {
            return kinds[i]->drives != NULL ? wiring_chip_output(w, &s, kinds[i], err, err_size)
                                            : read_sensor(w, &s, kinds[i], err, err_size);
        }
    }
    return no_kind(s.word[1], err, err_size);
}
