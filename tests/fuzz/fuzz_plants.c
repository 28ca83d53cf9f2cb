/* The readers of plant files, linear ones and columns, on any text. What is refused is refused with one line that begins with
 * the file's name; what is read keeps the promises of plant.h: channels with names, units and spans, inputs that start
 * inside them; it is created at finite values, or refused in one line too, and runs for a tick.
 *
 * Input: the file. Or, when the first byte is below 32, changes of a plant that is built in, for bytes changed at random rarely
 * leave what is JSON: which plant, then three bytes for each change: which number or text of the file (two), and what stands
 * there instead.
 */
#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "columns/column_plant.h"
#include "fuzz.h"
#include "plants/plant_json.h"
#include "plants/plant_library.h"

#define STATES_RUN                                                                                 \
    200 /* larger columns are read only: their steady states would take all the time */

static void is_line(const char *text)
{
    DEMAND(text[0] != '\0');
    for (; *text; text++)
        DEMAND((unsigned char)*text >= ' ');
}

static void well_formed(const struct plant_class *c)
{
    DEMAND(c->n_channels > 0 && c->tick_s > 0.0);
    DEMAND((c->model != NULL) != (c->column != NULL));
    for (size_t i = 0; i < c->n_channels; i++) {
        const struct plant_channel *k = &c->channels[i];
        DEMAND(k->name[0] != '\0' && strlen(k->name) <= 15 && strlen(k->unit) <= 11);
        DEMAND(k->lo < k->hi && k->lag_s >= 0.0 && k->every_s >= 0.0 && k->delay_s >= 0.0);
        if (k->kind == PLANT_MV || k->kind == PLANT_DISTURBANCE)
            DEMAND(k->nominal >= k->lo && k->nominal <= k->hi);
        if (k->kind == PLANT_MV)
            DEMAND(k->safe >= k->lo && k->safe <= k->hi);
        for (size_t j = 0; j < i; j++)
            DEMAND(strcmp(k->name, c->channels[j].name) != 0);
    }
}

static void run(const struct plant_class *c)
{
    char err[1024] = "";
    struct plant *p = plant_create(c, err, sizeof err);

    if (p == NULL) {
        is_line(err);
        return;
    }
    for (size_t i = 0; i < c->n_channels; i++)
        DEMAND(isfinite(c->value(p, i)));
    if (!c->advance(p, c->tick_s, err, sizeof err))
        is_line(err);
    c->destroy(p);
}

static const char *const instead[] = {
    "0",
    "1",
    "-1",
    "0.5",
    "2",
    "3",
    "1e9",
    "-1e-9",
    "1e-300",
    "1e300",
    "40",
    "99.9",
    "null",
    "true",
    "[]",
    "{}",
    "[1]",
    "[1,2,3]",
    "[[0,1],[1,0]]",
    "\"\"",
    "\"x\"",
    "\"kg/h\"",
    "\"l/h\"",
    "\"%w\"",
    "\"K\"",
    "\"heat\"",
    "\"feed\"",
    "\"boilup\"",
    "\"TCE\"",
    "\"PCE\"",
    "\"Lr\"",
    "\"none\"",
    "\"reflux\"",
    "\"stage\"",
    "\"levels\"",
    "\"of\"",
    "\"level\"",
    "\"wilson\"",
    "\"distillate\"",
    "\"log_fraction\"",
    "\"conservative\"",
    "\"volumetric\"",
};

static bool in_number(char c)
{
    return c != '\0' && strchr("+-.0123456789eE", c) != NULL;
}

/* Length of the number or text that begins at text[at]; 0 where none does. */
static size_t scalar(const char *text, size_t n, size_t at)
{
    size_t end = at + 1;
    if (text[at] == '"') {
        while (end < n && text[end] != '"')
            end++;
        return end < n ? end + 1 - at : 0;
    }
    if (!in_number(text[at]) || text[at] == 'e' || text[at] == 'E')
        return 0;
    while (end < n && in_number(text[end]))
        end++;
    return end - at;
}

/* The text with its scalar number `which` (counted round) replaced; *n becomes its length. */
static char *changed(char *text, size_t *n, size_t which, const char *token)
{
    size_t count = 0, length;
    for (size_t at = 0; at < *n; at += length ? length : 1)
        count += (length = scalar(text, *n, at)) != 0;
    which = count ? which % count : 0;
    for (size_t at = 0; at < *n; at += length ? length : 1) {
        length = scalar(text, *n, at);
        if (length == 0 || which-- > 0)
            continue;
        char *longer = malloc(*n + strlen(token));
        DEMAND(longer != NULL);
        memcpy(longer, text, at);
        memcpy(longer + at, token, strlen(token));
        memcpy(longer + at + strlen(token), text + at + length, *n - at - length);
        *n += strlen(token) - length;
        free(text);
        return longer;
    }
    return text;
}

/* Returns the text that the input stands for. */
static char *text_of(struct feed *f, size_t *n)
{
    size_t plants = 0;
    while (plant_texts[plants].name != NULL)
        plants++;
    if (f->left == 0 || f->data[0] >= ' ') {
        *n = f->left;
        const uint8_t *bytes = feed_bytes(f, n);
        char *text = malloc(*n + 1);
        DEMAND(text != NULL);
        memcpy(text, bytes, *n);
        return text;
    }
    const struct plant_text *from = &plant_texts[feed_byte(f) % plants];
    char *text = malloc(from->length);
    DEMAND(text != NULL);
    memcpy(text, from->text, *n = from->length);
    while (f->left >= 3) {
        size_t which = feed_byte(f);
        which = which << 8 | feed_byte(f);
        text = changed(text, n, which, instead[feed_byte(f) % (sizeof instead / sizeof *instead)]);
    }
    return text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char err[1024] = "";
    struct feed f = {data, size};
    size_t n;
    char *text = text_of(&f, &n);
    struct plant_class *c = plant_json_read("FILE", text, n, err, sizeof err);

    free(text);
    if (c == NULL) {
        is_line(err);
        DEMAND(strncmp(err, "FILE:", 5) == 0);
        return 0;
    }
    well_formed(c);
    if (c->column == NULL ||
        c->column->config->stages * c->column->config->components <= STATES_RUN)
        run(c);
    plant_json_free(c);
    return 0;
}
