/* Checks of a column's config and inputs: one line per field. */
#include "model/column.h"

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)

static enum err wrong(struct column_fault *fault, const char *field, const char *wanted)
{
    fault->field = field;
    fault->wanted = wanted;
    return ERR_RANGE;
}

static enum err check_between(struct column_fault *fault, const char *field, real_t value,
                              real_t lo, real_t hi, const char *wanted)
{
    if (isfinite(value) && value >= lo && value <= hi)
        return ERR_OK;
    enum err err = wrong(fault, field, wanted);
    return isfinite(value) ? err : ERR_NOT_FINITE;
}

#define TINY        REAL_C(1e-12) /* smallest holdup that counts as above 0 */
#define HUGE_NUMBER REAL_C(1e12)

/* A property that is 0 is not given: then nothing may need it. */
static enum err check_given(struct column_fault *fault, const char *field, real_t value, real_t lo,
                            real_t hi, const char *wanted)
{
    return value == REAL_C(0.0) ? ERR_OK : check_between(fault, field, value, lo, hi, wanted);
}

static enum err check_heats(const struct column_config *c, const struct component *p,
                            struct column_fault *fault)
{
    enum err err;

    if ((err = check_given(fault, "component.vaporisation_heat", p->vaporisation_heat, REAL_C(1.0),
                           REAL_C(1e6), "1 to 1e6 J/mol")) ||
        (err = check_given(fault, "component.boiling_point", p->boiling_point, REAL_C(1.0),
                           REAL_C(2000.0), "1 to 2000 K")) ||
        (err = check_given(fault, "component.heat_capacity", p->heat_capacity, REAL_C(1.0),
                           REAL_C(1e5), "1 to 1e5 J/(mol K)")))
        return err;
    if (p->critical_temperature != REAL_C(0.0) &&
        (!(p->critical_temperature > p->boiling_point &&
           p->critical_temperature > c->temperature_max) ||
         !isfinite(p->critical_temperature)))
        return wrong(fault, "component.critical_temperature",
                     "above boiling_point and temperature_max");
    return ERR_OK;
}

static enum err check_component(const struct column_config *c, const struct component *p,
                                struct column_fault *fault)
{
    enum err err;
    real_t lo = c->temperature_min, hi = c->temperature_max;

    for (int i = 0; i < 7; i++)
        if ((err = check_between(fault, "component.antoine", p->antoine[i], -HUGE_NUMBER,
                                 HUGE_NUMBER, "finite constants")))
            return err;
    if (p->antoine[2] + lo <= REAL_C(0.0) && p->antoine[1] != REAL_C(0.0))
        return wrong(fault, "component.antoine", "C + T above 0 from temperature_min on");
    if ((err = check_given(fault, "component.molar_mass", p->molar_mass, REAL_C(1e-4), REAL_C(10.0),
                           "1e-4 to 10 kg/mol")))
        return err;
    if (p->density[0] != REAL_C(0.0) || p->density[1] != REAL_C(0.0))
        for (int i = 0; i < 2; i++) {
            real_t density = p->density[0] + p->density[1] * (i ? hi : lo);
            if ((err = check_between(fault, "component.density", density, REAL_C(1.0),
                                     REAL_C(30000.0),
                                     "1 to 30000 kg/m3 from temperature_min to temperature_max")))
                return err;
        }
    return check_heats(c, p, fault);
}

/* Checks that every component has what a form needs. */
static enum err need_mass(const struct column_config *c, struct column_fault *fault)
{
    for (size_t j = 0; j < c->components; j++)
        if (c->component[j].molar_mass == REAL_C(0.0))
            return wrong(fault, "component.molar_mass",
                         "1e-4 to 10 kg/mol: a mass or a volume needs it");
    return ERR_OK;
}

static enum err need_volume(const struct column_config *c, struct column_fault *fault)
{
    enum err err = need_mass(c, fault);
    for (size_t j = 0; !err && j < c->components; j++)
        if (c->component[j].density[0] == REAL_C(0.0) && c->component[j].density[1] == REAL_C(0.0))
            return wrong(fault, "component.density", "1 to 30000 kg/m3: a volume needs it");
    return err;
}

static enum err need_basis(const struct column_config *c, enum column_basis basis,
                           struct column_fault *fault)
{
    return basis == COLUMN_FLOW_MASS     ? need_mass(c, fault)
           : basis == COLUMN_FLOW_VOLUME ? need_volume(c, fault)
                                         : ERR_OK;
}

/* capacity: the heat capacity as well. */
static enum err need_heats(const struct column_config *c, bool capacity, struct column_fault *fault)
{
    for (size_t j = 0; j < c->components; j++) {
        const struct component *p = &c->component[j];
        if (p->vaporisation_heat == REAL_C(0.0))
            return wrong(
                fault, "component.vaporisation_heat",
                "1 to 1e6 J/mol: heat, the feed's temperature or the reflux's subcooling needs it");
        if (p->boiling_point == REAL_C(0.0))
            return wrong(fault, "component.boiling_point",
                         "1 to 2000 K: the heat of vaporisation needs it");
        if (p->critical_temperature == REAL_C(0.0))
            return wrong(fault, "component.critical_temperature",
                         "above temperature_max: the heat of vaporisation needs it");
        if (capacity && p->heat_capacity == REAL_C(0.0))
            return wrong(
                fault, "component.heat_capacity",
                "1 to 1e5 J/(mol K): the feed's temperature or the reflux's subcooling needs it");
    }
    return ERR_OK;
}

static enum err check_level(const struct column_level *level, const char *by, const char *gain,
                            struct column_fault *fault)
{
    if ((unsigned)level->by > COLUMN_LEVEL_BY_INTERNAL)
        return wrong(fault, by, "one of enum column_level_by");
    if (level->by == COLUMN_LEVEL_FREE)
        return ERR_OK;
    return check_between(fault, gain, level->gain, TINY, REAL_C(1000.0), "above 0, to 1000 1/s");
}

static enum err check_holdups(const struct column_config *c, struct column_fault *fault)
{
    enum err err;

    if ((err = check_between(fault, "hydraulic_time", c->hydraulic_time, REAL_C(0.0), REAL_C(1e6),
                             "0, or 0.001 to 1e6 s")))
        return err;
    if (c->hydraulic_time > REAL_C(0.0)) {
        if (c->hydraulic_time < REAL_C(0.001))
            return wrong(fault, "hydraulic_time", "0, or 0.001 to 1e6 s");
        if (c->holdup != COLUMN_HOLDUP_MOLAR)
            return wrong(fault, "hydraulic_time", "0 unless the holdup is molar");
        if ((err = check_between(fault, "hydraulic_vapour", c->hydraulic_vapour, REAL_C(-5.0),
                                 REAL_C(5.0), "-5 to 5")))
            return err;
    }
    if ((unsigned)c->levels > COLUMN_LEVELS_HOLDUPS)
        return wrong(fault, "levels", "one of enum column_levels");
    if (!COLUMN_HOLDUPS_MOVE && c->levels != COLUMN_LEVELS_PERFECT)
        return wrong(fault, "levels", "perfect in this build");
    if (!COLUMN_HOLDUPS_MOVE && c->hydraulic_time > REAL_C(0.0))
        return wrong(fault, "hydraulic_time", "0 in this build");
    if (c->levels == COLUMN_LEVELS_PERFECT)
        return ERR_OK;
    if (c->holdup != COLUMN_HOLDUP_MOLAR)
        return wrong(fault, "levels", "perfect unless the holdup is molar");
    if ((err = check_level(&c->condenser_level, "condenser_level.by", "condenser_level.gain",
                           fault)) ||
        (err = check_level(&c->reboiler_level, "reboiler_level.by", "reboiler_level.gain", fault)))
        return err;
    if (c->level_capacity <= REAL_C(1.0))
        return wrong(fault, "level_capacity", "above 1, at most 10");
    return check_between(fault, "level_capacity", c->level_capacity, REAL_C(1.0), REAL_C(10.0),
                         "above 1, at most 10");
}

enum err column_validate(const struct column_config *c, struct column_fault *fault)
{
    enum err err;

    fault->field = "";
    fault->wanted = "";
    if (c->stages < 4 || c->stages > COLUMN_STAGES_MAX)
        return wrong(fault, "stages", "4 to " TEXT(COLUMN_STAGES_MAX));
    if (c->components < 2 || c->components > COLUMN_COMPONENTS_MAX)
        return wrong(fault, "components", "2 to " TEXT(COLUMN_COMPONENTS_MAX));
    if (c->feed_stage < 2 || c->feed_stage > c->stages - 2)
        return wrong(fault, "feed_stage", "2 to stages - 2");
    if (!c->component)
        return wrong(fault, "component", "an array of as many entries as components says");
    if ((err = check_between(fault, "efficiency", c->efficiency, REAL_C(0.01), REAL_C(1.0),
                             "0.01 to 1")))
        return err;
    if ((err = check_between(fault, "pressure_drop", c->pressure_drop, REAL_C(0.0), REAL_C(1e7),
                             "0 to 1e7 Pa")))
        return err;
    if ((unsigned)c->holdup > COLUMN_HOLDUP_CONSERVATIVE)
        return wrong(fault, "holdup", "one of enum column_holdup");
    if ((err = check_between(fault, "holdup_reboiler", c->holdup_reboiler, TINY, HUGE_NUMBER,
                             "above 0")) ||
        (err = check_between(fault, "holdup_tray", c->holdup_tray, TINY, HUGE_NUMBER, "above 0")) ||
        (err = check_between(fault, "holdup_condenser", c->holdup_condenser, TINY, HUGE_NUMBER,
                             "above 0")))
        return err;
    if ((err = check_between(fault, "temperature_min", c->temperature_min, REAL_C(50.0),
                             REAL_C(1000.0), "50 to 1000 K")) ||
        (err = check_between(fault, "temperature_max", c->temperature_max,
                             c->temperature_min + REAL_C(1.0), REAL_C(1000.0),
                             "temperature_min + 1 to 1000 K")))
        return err;
    if (c->holdup != COLUMN_HOLDUP_MOLAR &&
        ((err = check_between(fault, "holdup_temperature_bottom", c->holdup_temperature_bottom,
                              c->temperature_min, c->temperature_max,
                              "temperature_min to temperature_max")) ||
         (err = check_between(fault, "holdup_temperature_top", c->holdup_temperature_top,
                              c->temperature_min, c->temperature_max,
                              "temperature_min to temperature_max"))))
        return err;
    if ((err = check_between(fault, "limit_softness", c->limit_softness, REAL_C(0.001), REAL_C(0.5),
                             "0.001 to 0.5")))
        return err;
    for (size_t j = 0; j < c->components; j++)
        if ((err = check_component(c, &c->component[j], fault)))
            return err;
    if (c->holdup != COLUMN_HOLDUP_MOLAR && (err = need_volume(c, fault)))
        return err;
    return check_holdups(c, fault);
}

/* The feed's state and the boil-up: what is given, and what it needs. */
static enum err check_heat_inputs(const struct column_config *c, const struct column_inputs *u,
                                  struct column_fault *fault)
{
    enum err err;
    bool capacity = u->reflux_subcooling > REAL_C(0.0);

    if ((unsigned)u->feed_state > COLUMN_FEED_QUALITY)
        return wrong(fault, "feed_state", "one of enum column_feed_state");
    if (u->feed_state == COLUMN_FEED_QUALITY) {
        if ((err = check_between(fault, "feed_quality", u->feed_quality, REAL_C(0.0), REAL_C(2.0),
                                 "0 to 2")))
            return err;
        if (u->feed_basis == COLUMN_FLOW_VOLUME)
            return wrong(fault, "feed_basis", "moles or mass: a feed with a quality has no volume");
    } else {
        capacity = true;
        if ((err = check_between(fault, "feed_temperature", u->feed_temperature, c->temperature_min,
                                 c->temperature_max, "temperature_min to temperature_max")))
            return err;
    }
    if ((err =
             u->boilup_given
                 ? check_between(fault, "boilup", u->boilup, REAL_C(0.0), HUGE_NUMBER, "0 or more")
                 : check_between(fault, "heat", u->heat, REAL_C(0.0), HUGE_NUMBER, "0 or more")))
        return err;
    return capacity || !u->boilup_given ? need_heats(c, capacity, fault) : ERR_OK;
}

/* Products that are inputs. */
static enum err check_products(const struct column_config *c, const struct column_inputs *u,
                               struct column_fault *fault)
{
    enum err err;

    if (c->levels == COLUMN_LEVELS_PERFECT)
        return ERR_OK;
    if (c->condenser_level.by != COLUMN_LEVEL_BY_PRODUCT) {
        if ((unsigned)u->distillate_basis > COLUMN_FLOW_VOLUME)
            return wrong(fault, "distillate_basis", "one of enum column_basis");
        if ((err = check_between(fault, "distillate_flow", u->distillate_flow, REAL_C(0.0),
                                 HUGE_NUMBER, "0 or more")) ||
            (err = need_basis(c, u->distillate_basis, fault)))
            return err;
    }
    if (c->reboiler_level.by != COLUMN_LEVEL_BY_PRODUCT) {
        if ((unsigned)u->bottoms_basis > COLUMN_FLOW_VOLUME)
            return wrong(fault, "bottoms_basis", "one of enum column_basis");
        if ((err = check_between(fault, "bottoms_flow", u->bottoms_flow, REAL_C(0.0), HUGE_NUMBER,
                                 "0 or more")) ||
            (err = need_basis(c, u->bottoms_basis, fault)))
            return err;
    }
    return ERR_OK;
}

enum err column_validate_inputs(const struct column_config *c, const struct column_inputs *u,
                                struct column_fault *fault)
{
    enum err err;
    real_t sum = REAL_C(0.0);

    fault->field = "";
    fault->wanted = "";
    if ((unsigned)u->feed_basis > COLUMN_FLOW_VOLUME)
        return wrong(fault, "feed_basis", "one of enum column_basis");
    if ((unsigned)u->reflux_basis > COLUMN_FLOW_VOLUME)
        return wrong(fault, "reflux_basis", "one of enum column_basis");
    if ((err = check_between(fault, "feed_flow", u->feed_flow, REAL_C(0.0), HUGE_NUMBER,
                             "0 or more")) ||
        (err = check_between(fault, "reflux_flow", u->reflux_flow, REAL_C(0.0), HUGE_NUMBER,
                             "0 or more")) ||
        (err = check_between(fault, "reflux_subcooling", u->reflux_subcooling, REAL_C(0.0),
                             REAL_C(100.0), "0 to 100 K")) ||
        (err = check_heat_inputs(c, u, fault)) ||
        (err = check_between(fault, "pressure_top", u->pressure_top, REAL_C(100.0), REAL_C(1e7),
                             "100 to 1e7 Pa")) ||
        (err = need_basis(c, u->feed_basis, fault)) ||
        (err = need_basis(c, u->reflux_basis, fault)) || (err = check_products(c, u, fault)))
        return err;
    for (size_t j = 0; j < c->components; j++) {
        if ((err = check_between(fault, "feed_fraction", u->feed_fraction[j], REAL_C(0.0),
                                 REAL_C(1.0), "0 to 1 each")))
            return err;
        sum += u->feed_fraction[j];
    }
    if (real_abs(sum - REAL_C(1.0)) > REAL_C(1e-3))
        return wrong(fault, "feed_fraction", "a sum of 1 within 1e-3");
    return ERR_OK;
}
