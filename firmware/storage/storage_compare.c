/* Compares settings with the newest stored set, record by record, so that no second configuration takes memory. */
#include <string.h>

#include "settings/words.h"
#include "storage/storage.h"

/* Finds the record of a parameter. Of a block whose stored kind is another, no record counts: under another kind the same ids mean
 * something else. */
static bool find_stored(const struct storage *st, const struct parameter *p,
                        const struct config *config, struct stored_record *found)
{
    uint32_t address = st->newest.address + STORAGE_GRAIN, left = st->newest.length;
    uint32_t id = parameter_id(p);
    bool any = false, same_kind = !parameter_own(p), renamed;
    struct stored_record r;
    struct parameter q;
    while (record_at(address, left, &r)) { /* `left` falls by RECORD_HEAD or more */
        address += RECORD_HEAD + r.size;
        left -= RECORD_HEAD + r.size;
        same_kind = same_kind || record_is_kind(&r, p->index, config);
        if (record_parameter(&r, config, &q, &renamed) && parameter_id(&q) == id &&
            !(any && renamed)) { /* a record under the new id is the newer one */
            *found = r;
            any = true;
        }
    }
    return any && same_kind;
}

static void put_stored(const struct parameter *p, uint8_t type, const uint8_t *data, struct text *t)
{
    uint32_t u32 = get32(data);
    float f;
    memcpy(&f, &u32, sizeof f);
    if (type == STORAGE_FLOAT)
        text_float(t, f);
    else if (type == STORAGE_ROW)
        text_str(t, "another row");
    else if (type == STORAGE_WORD)
        words_put(parameter_word_list(p), data[0], t);
    else if (type != STORAGE_TEXT)
        text_u32(t, type == STORAGE_U16 ? get16(data) : u32);
    else
        text_str(t, !data[0]                 ? "-"
                    : parameter_is_secret(p) ? PARAMETER_SECRET
                                             : (const char *)data);
}

enum err storage_may_compare(struct storage *st, const char **reason)
{
    bool ready = storage_ready(st);
    *reason = ready ? "no whole set is stored" : NULL;
    return !ready ? ERR_BUSY : st->newest.sequence ? ERR_OK : ERR_EMPTY;
}

/* Writes what a load makes of a parameter without a record. A default that follows another parameter is left out of a set only where
 * both are at their initial values. */
static void put_left_out(const struct parameter *p, const struct config *config,
                         struct text *stored)
{
    if (parameter_follows(p, config))
        text_float(stored, parameter_initial(p));
    else
        parameter_default(p, config, stored);
}

static bool value_differs(const struct storage *st, const struct parameter *p,
                          const struct config *config, struct text *stored)
{
    uint8_t here[RECORD_MAX], there[RECORD_MAX] = {0};
    struct stored_record r = {0};
    if (p->field->type == PARAMETER_FIXED)
        return false;
    if (!find_stored(st, p, config, &r)) {
        put_left_out(p, config, stored);
        return !parameter_is_default(p, config);
    }
    uint8_t size = (uint8_t)(r.size - r.wide);
    if (size >= sizeof there || storage_read(r.address + RECORD_HEAD + r.wide, there, size))
        return true;
    put_stored(p, r.type, there, stored);
    /* It only reads: the address of a value is given for writing as well. */
    uint8_t n = record_encode(p, (struct config *)config, here);
    return here[2] != r.type || n != RECORD_HEAD + r.size ||
           memcmp(here + RECORD_HEAD + r.wide, there, size) != 0;
}

/* Returns whether the default of p follows a parameter that differs. */
static bool followed_differs(const struct storage *st, const struct parameter *p,
                             const struct config *config)
{
    char value[CHANNEL_NAME_SIZE];
    struct text ignored = text_on(value, sizeof value);
    struct parameter source = *p;
    if (!parameter_follows(p, config))
        return false;
    for (unsigned i = 0; i < p->group->n_fields; i++) {
        source.field = &p->group->fields[i];
        if (parameter_place(&source, (struct config *)config) == parameter_follows(p, config))
            return value_differs(st, &source, config, &ignored);
    }
    return false;
}

bool storage_differs(const struct storage *st, const struct parameter *p,
                     const struct config *config, struct text *stored)
{
    return value_differs(st, p, config, stored) || followed_differs(st, p, config);
}
