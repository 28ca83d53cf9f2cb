#include "kinds/ahead/column_ahead_parameters.h"

#include "block/refuse.h"
#include "kinds/column/column.h"
#include "model/column_drive.h"

#define AT(field) offsetof(struct ahead_settings, field)

const struct block_parameter ahead_parameters[AHEAD_PARAMETERS] = {
    {1, BLOCK_U16, AT(column), 1, 1, "column", "-", "number of the block with the column's table",
     0, CONFIG_BLOCKS, 0},
    {2, BLOCK_WORD, AT(role), BLOCK_INPUTS_MAX, 1, "is",
     "temperature|fraction|feed_fraction|feed|feed_temperature|feed_quality|reflux|heat|boilup|"
     "pressure",
     "quantity that the input measures", 0, 0, AHEAD_TEMPERATURE},
    {3, BLOCK_U16, AT(place), BLOCK_INPUTS_MAX, AHEAD_PLACE, "place", "-",
     "temperature: stage, component that it moves; fraction: stage, component; feed fraction: 0, "
     "component",
     0, 200, 0},
    {4, BLOCK_FLOAT, AT(si), BLOCK_INPUTS_MAX, AHEAD_UNIT, "si", "-",
     "factor and zero: the input in SI units (K, m3/s, kg/s, mol/s, W, Pa)", -1e9f, 1e9f, 0},
    {5, BLOCK_U16, AT(moves), 1, AHEAD_LOOPS, "moves", "-",
     "number of the input that is the MV of the loop", 0, BLOCK_INPUTS_MAX, 0},
    {6, BLOCK_U16, AT(target), AHEAD_LOOPS, AHEAD_PLACE, "target", "-",
     "stage, component; component 0: temperature", 0, 200, 0},
    {7, BLOCK_FLOAT, AT(pv_si), AHEAD_LOOPS, AHEAD_UNIT, "pv_si", "-",
     "factor and zero: the PV in K or as a fraction", -1e9f, 1e9f, 0},
    {8, BLOCK_FLOAT, AT(tau_s), 1, AHEAD_LOOPS, "tau", "s", "time constants of the closed loops", 0,
     1e6f, 0},
    {9, BLOCK_FLOAT, AT(miss_s), 1, 1, "miss", "s",
     "time in which prediction errors are believed; 0: at once", 0, 1e6f, 0},
    {10, BLOCK_FLOAT, AT(alarm), 1, AHEAD_LOOPS, "far", "EU",
     "alarm: larger prediction error; 0: none", 0, 1e6f, 0},
    {11, BLOCK_FLOAT, AT(trust), 1, 1, "trust", "-",
     "part of the difference to the inputs that a step corrects", 0.01f, 1, 1},
    {12, BLOCK_WORD, AT(basis), 1, 1, "basis", "mole|mass", "fractions on stages", 0, 0,
     AHEAD_MOLE},
    {13, BLOCK_U16, AT(parts), 1, 1, "parts", "-", "steps of the model in an interval", 1, 16, 3},
    {14, BLOCK_FLOAT, AT(doubt), 1, 1, "doubt", "-",
     "part of the last steps in which no change was the better prediction: above it, the block "
     "gives up; 0: never",
     0, 1, 0.4f},
};

static bool is_flow(uint8_t role)
{
    return role == AHEAD_FEED || role == AHEAD_REFLUX || role == AHEAD_HEAT || role == AHEAD_BOILUP;
}

static enum err check_stage(const struct block_setup *setup, const struct column_table *table,
                            unsigned k, struct block_fault *fault)
{
    const struct ahead_settings *s = setup->settings;
    unsigned stage = s->place[k][AHEAD_STAGE], component = s->place[k][AHEAD_COMPONENT];
    if (setup->input[k].is_mv)
        return block_refuse(fault, 0, "is", "says of an MV that it is of a stage");
    if (stage < 1 || stage > table->config.stages)
        return block_refuse(fault, 0, "place", "needs a stage, 1 to that of the condenser");
    if (component < 1 || component > table->config.components - 1)
        return block_refuse(fault, 0, "place",
                            "needs a component of the table, not the closing one");
    for (unsigned i = 0; i < k; i++)
        if (ahead_is_of_stage(s->role[i]) && s->place[i][AHEAD_STAGE] == stage &&
            s->place[i][AHEAD_COMPONENT] == component)
            return block_refuse(fault, 0, "place", "must have each stage and component once");
    return ERR_OK;
}

static enum err check_drive(const struct block_setup *setup, const struct column_table *table,
                            unsigned k, struct block_fault *fault)
{
    const struct ahead_settings *s = setup->settings;
    bool of_component = s->role[k] == AHEAD_FEED_FRACTION;
    for (unsigned i = 0; i < k; i++)
        if (s->role[i] == s->role[k] &&
            (!of_component || s->place[i][AHEAD_COMPONENT] == s->place[k][AHEAD_COMPONENT]))
            return block_refuse(fault, 0, "is", "must have each but those of stages once");
    if (of_component && (s->place[k][AHEAD_COMPONENT] < 1 ||
                         s->place[k][AHEAD_COMPONENT] > table->config.components - 1))
        return block_refuse(fault, 0, "place",
                            "needs a component of the table, not the closing one");
    const char *wanted =
        of_component ? NULL
                     : column_drive_refused(table, (enum column_drive)(s->role[k] - AHEAD_FEED));
    return wanted ? block_refuse(fault, 0, "is", wanted) : ERR_OK;
}

static enum err check_ahead_loop(const struct block_setup *setup, const struct column_table *table,
                                 unsigned i, struct block_fault *fault)
{
    const struct ahead_settings *s = setup->settings;
    unsigned k = s->moves[i], stage = s->target[i][AHEAD_STAGE];
    if (!setup->member[i].drives_mv)
        return block_refuse(fault, i, "loops", "needs loops that move an MV, not another loop");
    if (k < 1 || k > setup->inputs || !setup->input[k - 1].is_mv || !is_flow(s->role[k - 1]))
        return block_refuse(
            fault, i, "moves",
            "needs the number of an input that is the loop's MV: feed, reflux, heat "
            "or boilup");
    for (unsigned j = 0; j < i; j++)
        if (s->moves[j] == k)
            return block_refuse(fault, i, "moves", "must have another MV for each loop");
    if (stage < 1 || stage > table->config.stages)
        return block_refuse(fault, i, "target", "needs a stage, 1 to that of the condenser");
    if (s->target[i][AHEAD_COMPONENT] > table->config.components - 1)
        return block_refuse(fault, i, "target",
                            "must have a component of the table, not the closing one, or 0");
    if (!(s->tau_s[i] > 0))
        return block_refuse(fault, i, "tau", "must be above 0: the loop's time constant");
    return ERR_OK;
}

static bool has_masses(const struct column_table *table)
{
    for (size_t j = 0; j < table->config.components; j++)
        if (!(table->component[j].molar_mass > 0))
            return false;
    return true;
}

enum err ahead_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct ahead_settings *s = setup->settings;
    struct column_table table;
    struct column_fault reason;
    if (setup->members < 1 || setup->members > AHEAD_LOOPS)
        return block_refuse(fault, 0, "loops", "needs one to four");
    if (!setup->named || !s->column)
        return block_refuse(fault, 0, "column", "needs the number of a block of the kind column");
    if (column_record_read(setup->named, &table, &reason))
        return block_refuse(fault, 0, "column", "must name a block with a table that is in order");
    if (table.truncated[0] || table.truncated[1])
        return block_refuse(fault, 0, "column", "must be a table without truncated stages");
    if (s->basis == AHEAD_MASS && !has_masses(&table))
        return block_refuse(fault, 0, "basis", "must be mole where the table has no molar masses");
    enum err err = ERR_OK;
    for (unsigned k = 0; !err && k < setup->inputs; k++)
        err = ahead_is_of_stage(s->role[k]) ? check_stage(setup, &table, k, fault)
                                            : check_drive(setup, &table, k, fault);
    for (unsigned i = 0; !err && i < setup->members; i++)
        err = check_ahead_loop(setup, &table, i, fault);
    return err;
}
