#include "model/column_table.h"

#include <string.h>

#include "base/crc32.h"

_Static_assert(sizeof(real_t) == sizeof(float), "a table is read in float");
_Static_assert(COLUMN_TABLE_STAGES <= COLUMN_STAGES_MAX &&
                   COLUMN_TABLE_COMPONENTS <= COLUMN_COMPONENTS_MAX &&
                   COLUMN_TABLE_STAGES <= 2 * COLUMN_TABLE_WORD_STAGES,
               "what is pasted can be computed");

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)

#define TOO_LARGE                                                                                  \
    "the number of values, at most those of " TEXT(COLUMN_TABLE_STAGES) " stages and " TEXT(       \
        COLUMN_TABLE_COMPONENTS) " components"

static enum err wrong_table(struct column_fault *fault, enum err code, const char *field,
                            const char *wanted)
{
    fault->field = field;
    fault->wanted = wanted;
    return code;
}

static void put_le(uint8_t *to, uint32_t bits, unsigned n)
{
    for (unsigned k = 0; k < n; k++)
        to[k] = (uint8_t)(bits >> 8 * k);
}

uint32_t column_table_checksum(uint16_t version, uint16_t size, const float *value)
{
    uint8_t bytes[4];
    uint32_t bits, crc;
    put_le(bytes, version, 2);
    put_le(bytes + 2, size, 2);
    crc = crc32_update(0, bytes, sizeof bytes);
    for (unsigned i = 0; i < size; i++) {
        memcpy(&bits, &value[i], sizeof bits);
        put_le(bytes, bits, 4);
        crc = crc32_update(crc, bytes, sizeof bytes);
    }
    return crc;
}

/* ---- what is pasted, as a whole ---- */

static enum err check_text(const struct column_table_text *t, struct column_fault *fault)
{
    if (t->version != COLUMN_TABLE_VERSION)
        return wrong_table(
            fault, ERR_VERSION, "version",
            TEXT(COLUMN_TABLE_VERSION) ", of a table that is made for this firmware");
    if (t->size < COLUMN_TABLE_FIXED || t->size > COLUMN_TABLE_MOST)
        return wrong_table(fault, ERR_RANGE, "size", TOO_LARGE);
    for (unsigned i = 0; i < COLUMN_TABLE_MOST; i++) {
        if (!isfinite(t->value[i]))
            return wrong_table(fault, ERR_NOT_FINITE, "value", "a number everywhere");
        if (i >= t->size && t->value[i] != 0.0f)
            return wrong_table(fault, ERR_RANGE, "value", "0 behind the values that count");
    }
    if (column_table_checksum(t->version, t->size, t->value) != t->checksum)
        return wrong_table(fault, ERR_CRC, "checksum",
                           "that of version, size and values: paste all lines of the table");
    return ERR_OK;
}

/* ---- single values ---- */

/* A whole number of the table from lo to hi. */
static bool whole(const float *value, unsigned lo, unsigned hi, unsigned *n)
{
    if (!(*value >= (float)lo && *value <= (float)hi))
        return false;
    *n = (unsigned)*value;
    return (float)*n == *value;
}

bool column_table_name(const float *value, char name[COLUMN_TABLE_NAME_SIZE])
{
    size_t length = 0;
    bool over = false;
    memset(name, 0, COLUMN_TABLE_NAME_SIZE);
    for (unsigned i = 0; i < COLUMN_TABLE_NAME; i++) {
        unsigned four;
        if (!whole(&value[i], 0, (1u << 24) - 1u, &four))
            return false;
        for (unsigned k = 0; k < 4; k++, four >>= 6) {
            unsigned letter = four & 63u;
            if (letter && (over || length + 1u >= COLUMN_TABLE_NAME_SIZE))
                return false;
            over = letter == 0;
            if (letter)
                name[length++] = COLUMN_TABLE_LETTERS[letter - 1u];
        }
    }
    return length > 0;
}

static enum err read_shape(const float *v, struct column_config *c, unsigned *activity,
                           struct column_fault *fault)
{
    unsigned stages, components, feed, holdup;
    if (!whole(&v[COLUMN_TABLE_N_STAGES], 4, COLUMN_TABLE_STAGES, &stages))
        return wrong_table(fault, ERR_RANGE, "stages", "4 to " TEXT(COLUMN_TABLE_STAGES));
    if (!whole(&v[COLUMN_TABLE_N_COMPONENTS], 2, COLUMN_TABLE_COMPONENTS, &components))
        return wrong_table(fault, ERR_RANGE, "components", "2 to " TEXT(COLUMN_TABLE_COMPONENTS));
    if (!whole(&v[COLUMN_TABLE_FEED_STAGE], 2, stages - 2u, &feed))
        return wrong_table(fault, ERR_RANGE, "feed_stage", "2 to stages - 2");
    if (!whole(&v[COLUMN_TABLE_HOLDUP], COLUMN_HOLDUP_MOLAR, COLUMN_HOLDUP_CONSERVATIVE, &holdup))
        return wrong_table(fault, ERR_RANGE, "holdup", "0 molar, 1 volumetric or 2 conservative");
    if (!whole(&v[COLUMN_TABLE_ACTIVITY], 0, 2, activity))
        return wrong_table(fault, ERR_RANGE, "activity", "0 ideal, 1 Wilson or 2 NRTL");
    c->stages = stages;
    c->components = components;
    c->feed_stage = feed;
    c->holdup = (enum column_holdup)holdup;
    return ERR_OK;
}

static void read_config(const float *v, struct column_config *c)
{
    c->efficiency = v[COLUMN_TABLE_EFFICIENCY];
    c->pressure_drop = v[COLUMN_TABLE_PRESSURE_DROP];
    c->holdup_reboiler = v[COLUMN_TABLE_HOLDUP_REBOILER];
    c->holdup_tray = v[COLUMN_TABLE_HOLDUP_TRAY];
    c->holdup_condenser = v[COLUMN_TABLE_HOLDUP_CONDENSER];
    c->holdup_temperature_bottom = v[COLUMN_TABLE_HOLDUP_BOTTOM_K];
    c->holdup_temperature_top = v[COLUMN_TABLE_HOLDUP_TOP_K];
    c->temperature_min = v[COLUMN_TABLE_LOWEST_K];
    c->temperature_max = v[COLUMN_TABLE_HIGHEST_K];
    c->limit_softness = v[COLUMN_TABLE_SOFTNESS];
}

static enum err read_component(const float *v, struct column_table *t, size_t j,
                               struct column_fault *fault)
{
    struct component *p = &t->component[j];
    if (!column_table_name(v + COLUMN_TABLE_C_NAME, t->name[j]))
        return wrong_table(fault, ERR_RANGE, "component.name", "1 to 15 letters, digits or _");
    for (size_t k = 0; k < j; k++)
        if (strcmp(t->name[k], t->name[j]) == 0)
            return wrong_table(fault, ERR_RANGE, "component.name", "another for each component");
    memcpy(p->antoine, v + COLUMN_TABLE_C_ANTOINE, sizeof p->antoine);
    p->molar_mass = v[COLUMN_TABLE_C_MASS];
    memcpy(p->density, v + COLUMN_TABLE_C_DENSITY, sizeof p->density);
    p->vaporisation_heat = v[COLUMN_TABLE_C_HEAT];
    p->boiling_point = v[COLUMN_TABLE_C_BOILING];
    p->critical_temperature = v[COLUMN_TABLE_C_CRITICAL];
    p->heat_capacity = v[COLUMN_TABLE_C_CAPACITY];
    t->nominal.feed_fraction[j] = v[COLUMN_TABLE_C_FEED];
    return ERR_OK;
}

static void read_activity(const float *v, unsigned model, struct column_table *t)
{
    size_t n = t->config.components, tables = n * n;
    t->activity = (struct activity){0};
    t->config.activity = model ? activity_coefficients : NULL;
    if (model)
        t->activity = (struct activity){.model = model == 1 ? ACTIVITY_WILSON : ACTIVITY_NRTL,
                                        .components = n,
                                        .a = v,
                                        .b = v + tables,
                                        .alpha = model == 1 ? NULL : v + 2 * tables};
}

static enum err read_nominal(const float *v, struct column_table *t, struct column_fault *fault)
{
    struct column_inputs *u = &t->nominal;
    unsigned feed, reflux, by, boilup;
    if (!whole(&v[COLUMN_TABLE_FEED_BASIS], 0, 2, &feed))
        return wrong_table(fault, ERR_RANGE, "feed_basis", "0 mol/s, 1 kg/s or 2 m3/s");
    if (!whole(&v[COLUMN_TABLE_REFLUX_BASIS], 0, 2, &reflux))
        return wrong_table(fault, ERR_RANGE, "reflux_basis", "0 mol/s, 1 kg/s or 2 m3/s");
    if (!whole(&v[COLUMN_TABLE_FEED_BY], 0, 1, &by))
        return wrong_table(fault, ERR_RANGE, "feed_state", "0 temperature or 1 quality");
    if (!whole(&v[COLUMN_TABLE_BOILUP_GIVEN], 0, 1, &boilup))
        return wrong_table(fault, ERR_RANGE, "boilup_given", "0 heat or 1 boil-up");
    u->feed_basis = (enum column_basis)feed;
    u->feed_flow = v[COLUMN_TABLE_FEED];
    u->feed_state = (enum column_feed_state)by;
    u->feed_temperature = by ? 0.0f : v[COLUMN_TABLE_FEED_STATE];
    u->feed_quality = by ? v[COLUMN_TABLE_FEED_STATE] : 0.0f;
    u->reflux_basis = (enum column_basis)reflux;
    u->reflux_flow = v[COLUMN_TABLE_REFLUX];
    u->reflux_subcooling = v[COLUMN_TABLE_SUBCOOLING];
    u->boilup_given = boilup != 0;
    u->boilup = boilup ? v[COLUMN_TABLE_HEAT] : 0.0f;
    u->heat = boilup ? 0.0f : v[COLUMN_TABLE_HEAT];
    u->pressure_top = v[COLUMN_TABLE_PRESSURE];
    t->heat_loss = v[COLUMN_TABLE_HEAT_LOSS];
    if (t->heat_loss < 0.0f || (boilup && t->heat_loss != 0.0f))
        return wrong_table(fault, ERR_RANGE, "heat_loss", "0 or more, with a boil-up 0");
    return ERR_OK;
}

static enum err read_truncated(const float *v, struct column_table *t, struct column_fault *fault)
{
    static const char wanted[] = "stages from 2 to stages - 1, not the feed stage";
    for (unsigned k = 0; k < 2; k++) {
        unsigned bits;
        if (!whole(&v[COLUMN_TABLE_TRUNCATED + k], 0, (1u << COLUMN_TABLE_WORD_STAGES) - 1u, &bits))
            return wrong_table(fault, ERR_RANGE, "truncated", wanted);
        t->truncated[k] = bits;
    }
    for (unsigned s = 1; s <= 2 * COLUMN_TABLE_WORD_STAGES; s++)
        if (column_table_is_truncated(t, s) &&
            (s == 1 || s >= t->config.stages || s == t->config.feed_stage))
            return wrong_table(fault, ERR_RANGE, "truncated", wanted);
    return ERR_OK;
}

/* ---- what must go together ---- */

/* Fractions of a sum of 1, but for the rounding of so few floats. */
#define FRACTIONS_AWAY 1e-5f

static enum err check_profile(const struct column_table *t, struct column_fault *fault)
{
    size_t integrated = t->config.components - 1u;
    for (size_t s = 0; s < t->config.stages; s++) {
        float sum = 0.0f;
        for (size_t j = 0; j < integrated; j++) {
            float x = t->profile[s * integrated + j];
            if (!(x >= 0.0f && x <= 1.0f))
                return wrong_table(fault, ERR_RANGE, "profile", "mole fractions, 0 to 1");
            sum += x;
        }
        if (sum > 1.0f + FRACTIONS_AWAY)
            return wrong_table(fault, ERR_RANGE, "profile",
                               "mole fractions of a stage, 1 together");
    }
    return ERR_OK;
}

static enum err check_feed(const struct column_table *t, struct column_fault *fault)
{
    float sum = -1.0f;
    for (size_t j = 0; j < t->config.components; j++)
        sum += t->nominal.feed_fraction[j];
    return sum >= -FRACTIONS_AWAY && sum <= FRACTIONS_AWAY
               ? ERR_OK
               : wrong_table(fault, ERR_RANGE, "feed_fraction", "fractions with a sum of 1");
}

static enum err check_whole(const struct column_table *t, struct column_fault *fault)
{
    size_t row, column;
    enum err err = column_validate(&t->config, fault);
    if (!err && t->config.activity)
        err = activity_validate(&t->activity, t->config.temperature_min, t->config.temperature_max,
                                fault, &row, &column);
    if (!err)
        err = column_validate_inputs(&t->config, &t->nominal, fault);
    if (!err)
        err = check_feed(t, fault);
    return err ? err : check_profile(t, fault);
}

enum err column_table_read(const struct column_table_text *text, struct column_table *t,
                           struct column_fault *fault)
{
    const float *v = text->value;
    unsigned activity = 0;
    memset(t, 0, sizeof *t);
    *fault = (struct column_fault){.field = "", .wanted = ""};
    enum err err = check_text(text, fault);
    if (!err)
        err = read_shape(v, &t->config, &activity, fault);
    if (err)
        return err;
    size_t components = t->config.components;
    if (text->size != COLUMN_TABLE_VALUES(t->config.stages, components, activity))
        return wrong_table(fault, ERR_RANGE, "size",
                           "that of its stages, components and activity model");
    if (!column_table_name(v + COLUMN_TABLE_TITLE, t->title))
        return wrong_table(fault, ERR_RANGE, "name", "1 to 15 letters, digits or _");
    read_config(v, &t->config);
    err = read_nominal(v, t, fault);
    if (!err)
        err = read_truncated(v, t, fault);
    const float *at = v + COLUMN_TABLE_FIXED;
    for (size_t j = 0; !err && j < components; j++, at += COLUMN_TABLE_C_VALUES)
        err = read_component(at, t, j, fault);
    if (err)
        return err;
    read_activity(at, activity, t);
    t->profile = at + COLUMN_TABLE_ACTIVITY_VALUES(activity, components);
    column_table_moved(t);
    return check_whole(t, fault);
}

void column_table_moved(struct column_table *t)
{
    t->config.component = t->component;
    t->config.activity_context = t->config.activity ? &t->activity : NULL;
    for (size_t j = 0; j < t->config.components; j++)
        t->component[j].name = t->name[j];
}

bool column_table_is_truncated(const struct column_table *t, size_t stage)
{
    size_t bit = stage - 1u;
    return stage >= 1 && bit / COLUMN_TABLE_WORD_STAGES < 2 &&
           (t->truncated[bit / COLUMN_TABLE_WORD_STAGES] >> bit % COLUMN_TABLE_WORD_STAGES & 1u);
}

size_t column_table_states(const struct column_table *t)
{
    const float bits[2] = {(float)t->truncated[0], (float)t->truncated[1]};
    return t->config.stages * (t->config.components - 1u) - column_table_count(bits);
}

unsigned column_table_count(const float value[2])
{
    unsigned n = 0;
    for (unsigned k = 0; k < 2; k++)
        for (uint32_t bits = (uint32_t)value[k]; bits; bits &= bits - 1u)
            n++;
    return n;
}
