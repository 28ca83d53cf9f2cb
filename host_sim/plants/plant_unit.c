#include "plants/plant_unit.h"

#include <ctype.h>
#include <string.h>

#include "bench/text.h"

#define WRITTEN_MAX 40

/* tools/reflux/plant_file.py has the same table; test_plant_units.py compares the two. */
static const struct {
    const char *sign, *ascii;
} signs[] = {
    {"\u00b0", "deg"}, {"\u00ba", "deg"}, {"\u02da", "deg"}, {"\u2103", "degC"}, {"\u2109", "degF"},
    {"\u00b5", "u"},   {"\u03bc", "u"},   {"\u00b9", "1"},   {"\u00b2", "2"},    {"\u00b3", "3"},
    {"\u207b", "-"},   {"\u00b7", "."},   {"\u22c5", "."},   {"\u03a9", "ohm"},  {"\u2126", "ohm"},
    {"\u00a0", " "},   {"\u2009", " "},   {"\u202f", " "},
};

/* Appends the sign at `written`; returns its length, 0 for one that has no place in a unit. */
static size_t append_sign(const char *written, char *unit, size_t size)
{
    for (size_t k = 0; k < sizeof(signs) / sizeof(signs[0]); k++) {
        size_t n = strlen(signs[k].sign);
        if (strncmp(written, signs[k].sign, n) == 0) {
            sim_append(unit, size, "%s", signs[k].ascii);
            return n;
        }
    }
    if (written[0] < ' ' || written[0] > '~' || written[0] == ',') {
        return 0;
    }
    sim_append(unit, size, "%c", written[0]);
    return 1;
}

static bool stands_alone(const char *unit, size_t at)
{
    bool degree = at >= 3 && strncmp(unit + at - 3, "deg", 3) == 0;
    return at == 0 || degree || !isalnum((unsigned char)unit[at - 1]) ||
           !isalnum((unsigned char)unit[at + 1]);
}

/* Leaves out blanks behind "deg" and beside anything but letters and digits. False: another blank. */
static bool close_up(char *unit)
{
    for (char *blank; (blank = strchr(unit, ' ')) != NULL;) {
        if (!stands_alone(unit, (size_t)(blank - unit))) {
            return false;
        }
        (void)memmove(blank, blank + 1, strlen(blank));
    }
    return true;
}

const char *plant_read_unit(struct json_walk *w, const json_t *object)
{
    const char *written = walk_text(w, object, "unit", WRITTEN_MAX, "-");
    char *unit = walk_memory(w, 2 * WRITTEN_MAX + 1, 1); /* no sign grows to twice its bytes */
    if (w->failed || unit == NULL) {
        return "-";
    }
    size_t mark = walk_key(w, "unit");
    size_t n = 1;
    for (const char *at = written; *at != '\0' && n > 0; at += n) {
        n = append_sign(at, unit, 2 * WRITTEN_MAX + 1);
    }
    if (n == 0 || !close_up(unit)) {
        (void)walk_fail(w,
                        "\"%s\" must be printable ASCII without blanks and commas, as degC or m3/h",
                        written);
    } else if (unit[0] == '\0' || strlen(unit) > PLANT_UNIT_MAX) {
        (void)walk_fail(w, "must have 1 to %zu characters, has %zu", PLANT_UNIT_MAX, strlen(unit));
    }
    walk_up(w, mark);
    return unit;
}
