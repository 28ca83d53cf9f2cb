#include "plants/plant_parts.h"

#include <math.h>
#include <string.h>

#define NAME_LONGEST 15

bool plant_name_allowed(const char *name)
{
    return strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
           strlen(name);
}

void plant_read_name(struct json_walk *w, const json_t *object, struct plant_channel *channels,
                     size_t n)
{
    struct plant_channel *c = &channels[n];
    c->name = walk_text(w, object, "name", NAME_LONGEST, NULL);
    c->help = walk_text(w, object, "help", PLANT_TEXT_MAX, "");
    size_t mark = walk_key(w, "name");
    if (!plant_name_allowed(c->name)) {
        (void)walk_fail(w, "\"%s\" may only have letters, digits and underscores", c->name);
    }
    for (size_t i = 0; i < n; i++) {
        if (strcmp(channels[i].name, c->name) == 0) {
            (void)walk_fail(w, "\"%s\" is the name of an earlier channel too", c->name);
        }
    }
    walk_up(w, mark);
}

void plant_read_head(struct json_walk *w, const json_t *root, const struct file_key *keys,
                     struct plant_class *c)
{
    c->name = walk_text(w, root, "name", 40, NULL);
    size_t mark = walk_key(w, "name");
    if (strspn(c->name, "abcdefghijklmnopqrstuvwxyz0123456789-_") != strlen(c->name)) {
        (void)walk_fail(w, "\"%s\" may only have small letters, digits, - and _", c->name);
    }
    walk_up(w, mark);
    c->title = walk_text(w, root, "title", 120, NULL);
    c->source = walk_text(w, root, "source", PLANT_TEXT_MAX, NULL);
    c->ours = walk_text(w, root, "ours", 2 * PLANT_TEXT_MAX, "nothing");
    c->tick_s = walk_field(w, root, keys, "tick_s");
    if (fabs(c->tick_s * 1000.0 - round(c->tick_s * 1000.0)) > 1e-6) {
        mark = walk_key(w, "tick_s");
        (void)walk_fail(w, "%g must be a whole number of milliseconds", c->tick_s);
        walk_up(w, mark);
    }
}
