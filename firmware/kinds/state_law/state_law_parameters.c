#include "kinds/state_law/state_law_parameters.h"

#include "block/refuse.h"
#include "kinds/state_law/state_law_column.h"
#include "lti/state_model.h"

#define AT(field) offsetof(struct state_law_settings, field)
#define FOUND(id, field, name)                                                                     \
    {                                                                                              \
        id, BLOCK_FLOAT, AT(field), 1, 1, name, "-", "found", -1e4f, 1e4f, 0                       \
    }
#define OF_G(i, j)                                                                                 \
    FOUND(STATE_LAW_ID_G + ((i)-1) * STATE_LAW_LOOPS + ((j)-1), g[(i)-1][(j)-1], "g" #i "_" #j)
#define OF_F(i, k)                                                                                 \
    FOUND(STATE_LAW_ID_F + ((i)-1) * STATE_FEEDBACK_INPUTS + ((k)-1), f[(i)-1][(k)-1],             \
          "f" #i "_" #k)
#define ALL_F(i)                                                                                   \
    OF_F(i, 1), OF_F(i, 2), OF_F(i, 3), OF_F(i, 4), OF_F(i, 5), OF_F(i, 6), OF_F(i, 7), OF_F(i, 8)

const struct block_parameter state_law_parameters[STATE_LAW_PARAMETERS] = {
    {1, BLOCK_U16, AT(column), 1, 1, "column", "-",
     "number of the block with the column's table; 0: an experiment finds the law", 0,
     CONFIG_BLOCKS, 0},
    {2, BLOCK_FLOAT, AT(period_s), 1, 1, "period", "s", "interval of the loops", 0, 1e5f, 0},
    {3, BLOCK_FLOAT, AT(tau_s), 1, STATE_LAW_LOOPS, "tau", "s",
     "time constants of the closed loops", 0, 1e6f, 0},
    {4, BLOCK_FLOAT, AT(ti_s), 1, STATE_LAW_LOOPS, "ti", "s", "integral times; 0: none", 0, 1e6f,
     0},
    {5, BLOCK_FLOAT, AT(td_s), 1, STATE_LAW_LOOPS, "td", "s",
     "derivative times, of measurements; 0: none", 0, 1e6f, 0},
    {6, BLOCK_WORD, AT(role), BLOCK_INPUTS_MAX, 1, "is",
     "temperature|fraction|feed|feed_fraction|feed_temperature|feed_quality|reflux|heat|boilup",
     "quantity that the input measures", 0, 0, STATE_LAW_TEMPERATURE},
    {7, BLOCK_U16, AT(place), BLOCK_INPUTS_MAX, STATE_LAW_PLACE, "place", "-",
     "temperature: stage; fraction: stage, component; feed fraction: 0, component", 0, 200, 0},
    {8, BLOCK_FLOAT, AT(si), BLOCK_INPUTS_MAX, 1, "si", "-",
     "SI units (K, m3/s, kg/s, mol/s, W) for a unit of the input; 0: 1", -1e9f, 1e9f, 0},
    {9, BLOCK_WORD, AT(basis), 1, 1, "basis", "mole|mass", "fractions on stages", 0, 0,
     STATE_LAW_MOLE},
    {10, BLOCK_FLOAT, AT(left), 1, 1, "left", "%",
     "part of the largest element of F that inputs may leave out", 0, 100, 1},
    {11, BLOCK_WORD, AT(adopt), 1, 1, "adopt", "ask|at_once", "adoption of a law that was found", 0,
     0, STATE_LAW_WHEN_ACCEPTED},
    {STATE_LAW_ID_MADE, BLOCK_FLOAT, AT(made_s), 1, 1, "made", "s",
     "interval of the law that follows; 0: none, or not whole", 0, 1e5f, 0},
    OF_G(1, 1),
    OF_G(1, 2),
    OF_G(2, 1),
    OF_G(2, 2),
    ALL_F(1),
    ALL_F(2),
};
_Static_assert(STATE_LAW_LOOPS == 2 && STATE_FEEDBACK_INPUTS == 8, "rows of the law");

static enum err check_law_inputs(const struct block_setup *setup, struct block_fault *fault)
{
    unsigned loops = state_law_loops(setup->input, setup->inputs), others = setup->inputs - loops;
    bool in_order = loops >= 1 && loops <= STATE_LAW_LOOPS && others >= loops &&
                    others <= STATE_FEEDBACK_INPUTS;
    for (unsigned k = 0; in_order && k < setup->inputs; k++)
        in_order = setup->input[k].is_mv == (k >= others);
    return in_order ? ERR_OK
                    : block_refuse(fault, 0, "inputs",
                                   "needs the measurements of one or two loops, further ones "
                                   "to 8 in all, then as many MVs as loops");
}

static enum err check_law_stage(const struct block_setup *setup, const struct column_table *table,
                                unsigned k, struct block_fault *fault)
{
    const struct state_law_settings *s = setup->settings;
    const uint16_t *place = s->place[k];
    if (setup->input[k].is_mv)
        return block_refuse(fault, 0, "is",
                            "must be reflux, heat, boilup or feed where the input is an MV");
    if (place[STATE_LAW_STAGE] < 1 || place[STATE_LAW_STAGE] > table->config.stages)
        return block_refuse(fault, 0, "place",
                            "needs a stage, 1 to that of the condenser, for each "
                            "temperature and fraction");
    if (s->role[k] == STATE_LAW_FRACTION &&
        (place[STATE_LAW_COMPONENT] < 1 || place[STATE_LAW_COMPONENT] > table->config.components))
        return block_refuse(fault, 0, "place", "needs a component of the table");
    return ERR_OK;
}

static bool is_law_flow(uint8_t role)
{
    return role == STATE_LAW_FEED || role >= STATE_LAW_REFLUX;
}

static enum err check_law_drive(const struct block_setup *setup, const struct column_table *table,
                                unsigned k, struct block_fault *fault)
{
    const struct state_law_settings *s = setup->settings;
    const struct column_inputs *in = &table->nominal;
    const uint16_t *place = s->place[k];
    bool of_feed = s->role[k] == STATE_LAW_FEED_FRACTION;
    if (k < state_law_loops(setup->input, setup->inputs))
        return block_refuse(fault, k, "is",
                            "must be temperature or fraction of what a loop controls");
    if (setup->input[k].is_mv && !is_law_flow(s->role[k]))
        return block_refuse(fault, 0, "is",
                            "must be reflux, heat, boilup or feed where the input is an MV");
    for (unsigned i = 0; i < k; i++)
        if (s->role[i] == s->role[k] &&
            (!of_feed || s->place[i][STATE_LAW_COMPONENT] == place[STATE_LAW_COMPONENT]))
            return block_refuse(fault, 0, "is", "must have each but those of stages once");
    if (of_feed && (place[STATE_LAW_COMPONENT] < 1 ||
                    place[STATE_LAW_COMPONENT] > table->config.components - 1))
        return block_refuse(fault, 0, "place",
                            "needs a component of the table, not the closing one");
    if (s->role[k] == (in->boilup_given ? STATE_LAW_HEAT : STATE_LAW_BOILUP))
        return block_refuse(fault, 0, "is", "must have heat or boilup, whichever the table has");
    if (s->role[k] == (in->feed_state == COLUMN_FEED_TEMPERATURE ? STATE_LAW_FEED_QUALITY
                                                                 : STATE_LAW_FEED_TEMPERATURE))
        return block_refuse(fault, 0, "is",
                            "must have the feed's temperature or quality, whichever the "
                            "table has");
    return ERR_OK;
}

static bool has_no_masses(const struct column_table *table)
{
    bool none = false;
    for (size_t j = 0; j < table->config.components; j++)
        none = none || !(table->component[j].molar_mass > 0);
    return none;
}

static enum err check_law_column(const struct block_setup *setup, struct block_fault *fault)
{
    const struct state_law_settings *s = setup->settings;
    struct column_table table;
    struct column_fault reason;
    if (!setup->named || column_record_read(setup->named, &table, &reason))
        return block_refuse(fault, 0, "column", "must name a block with a table that is in order");
    if (table.config.stages * (table.config.components - 1) > STATE_MODEL_STATES)
        return block_refuse(fault, 0, "column",
                            "must be of 16 mole fractions at most: stages times components "
                            "but one");
    if (s->basis == STATE_LAW_MASS && has_no_masses(&table))
        return block_refuse(fault, 0, "basis", "must be mole where the table has no molar masses");
    enum err err = ERR_OK;
    for (unsigned k = 0; !err && k < setup->inputs; k++)
        err = state_law_is_of_stage(s->role[k]) ? check_law_stage(setup, &table, k, fault)
                                                : check_law_drive(setup, &table, k, fault);
    return err;
}

enum err state_law_check_settings(const struct block_setup *setup, struct block_fault *fault)
{
    const struct state_law_settings *s = setup->settings;
    enum err err = check_law_inputs(setup, fault);
    if (err)
        return err;
    if (!(s->period_s >= 1e-3f))
        return block_refuse(fault, 0, "period", "must be the interval of the loops");
    for (unsigned i = 0; i < state_law_loops(setup->input, setup->inputs); i++)
        if (!(s->tau_s[i] > 0))
            return block_refuse(fault, i, "tau", "must be above 0: the loop's time constant");
    return s->column ? check_law_column(setup, fault) : ERR_OK;
}
