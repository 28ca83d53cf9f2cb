#include "kinds/composition/composition_parameters.h"

#include "base/workspace.h"
#include "block/refuse.h"
#include "kinds/column/column.h"
#include "kinds/composition/composition_job.h"
#include "kinds/composition/covariance.h"
#include "model/column_drive.h"

#define PLACE(field)  offsetof(struct composition_settings, field)
#define UNKEPT(field) offsetof(struct composition_record, field)
#define NUMBER_AT(id, place, name, unit, help, lo, hi, initial)                                    \
    {                                                                                              \
        id, BLOCK_FLOAT, place, 1, 1, name, unit, help, lo, hi, initial                            \
    }
#define NUMBER(id, field, name, unit, help, lo, hi, initial)                                       \
    NUMBER_AT(id, PLACE(field), name, unit, help, lo, hi, initial)

const struct block_parameter composition_parameter_rows[COMPOSITION_PARAMETER_ROWS] = {
    {1, BLOCK_U16, PLACE(column), 1, 1, "column", "-",
     "number of the block with the column's table", 0, CONFIG_BLOCKS, 0},
    {2, BLOCK_WORD, PLACE(method), 1, 1, "method", "geometric|rekf|ekf|kalman", "estimation method",
     0, 0, METHOD_GEOMETRIC},
    {3, BLOCK_WORD, PLACE(role), BLOCK_INPUTS_MAX, 1, "is",
     "temperature|feed|feed_temperature|feed_quality|reflux|heat|boilup|pressure|analysis",
     "quantity that the input measures", 0, 0, IS_TEMPERATURE},
    {4, BLOCK_U16, PLACE(place), BLOCK_INPUTS_MAX, PLACE_COLS, "place", "-",
     "temperature: stage, component that it moves (0: it is only compared)", 0, 200, 0},
    {5, BLOCK_FLOAT, UNKEPT(tune), BLOCK_INPUTS_MAX, TUNE_COLS, "tune", "1/h, -",
     "temperature: lambda and zeta", 0, 1e4f, 0},
    {6, BLOCK_FLOAT, PLACE(si), BLOCK_INPUTS_MAX, UNIT_COLS, "si", "-",
     "factor and zero: the input in SI units (K, m3/s, kg/s, mol/s, W, Pa)", -1e9f, 1e9f, 0},
    {7, BLOCK_U16, PLACE(point), BLOCK_POINTS_MAX, PLACE_COLS, "point", "-",
     "stage, component; component 0: temperature", 0, 200, 0},
    {8, BLOCK_FLOAT, PLACE(show), BLOCK_POINTS_MAX, UNIT_COLS, "show", "-",
     "factor and zero: a point from mole fractions or K", -1e9f, 1e9f, 0},
    NUMBER_AT(
        9, UNKEPT(noise), "noise", "K",
        "standard deviation of the readings; 0: ekf with a full covariance estimates it, else 0.2",
        0, 100, 0),
    NUMBER_AT(10, UNKEPT(model), "model", "-",
              "filters: standard deviation that a mole fraction gathers in an hour; 0: 0.011 for "
              "ekf with a full covariance, else 0.1",
              0, 100, 0),
    NUMBER_AT(11, UNKEPT(gate), "gate", "K", "readings farther from the estimate wait; 0: none", 0,
              1000, 10),
    NUMBER_AT(12, UNKEPT(gate_s), "gate_time", "s", "time until they are used", 0, 1e6f, 300),
    NUMBER(13, pull, "pull", "K/h", "alarm: a sensor draws the model by more on average; 0: none",
           0, 1e5f, 0),
    NUMBER(14, watch_s, "watch", "s", "averaging time of the monitor", 1, 1e6f, 1800),
    NUMBER(15, nis, "nis", "-", "alarm: mean squared innovations over the expected ones; 0: none",
           0, 1e6f, 400),
    NUMBER(16, alone_s, "alone", "s", "time that the model counts without any temperature", 0, 1e7f,
           600),
    NUMBER(18, apart, "apart", "K/h",
           "alarm: sensors of a section draw so differently on average; 0: none", 0, 1e5f, 0),
    {19, BLOCK_WORD, PLACE(doubt), 1, 1, "doubt", "bad|uncertain",
     "quality of the estimates under the alarms pull, nis and apart", 0, 0, DOUBT_BAD},
    {20, BLOCK_WORD, PLACE(basis), 1, 1, "basis", "mole|mass", "fractions of the points", 0, 0,
     BASIS_MOLE},
    NUMBER(21, analysis_gate, "far", "-",
           "mole fraction: analyses farther off are rejected; 0: none", 0, 1, 0.05f),
    NUMBER(22, late_s, "late", "s", "time without an analysis until it is missed; 0: never", 0,
           1e7f, 7200),
    NUMBER(23, reach_s, "reach", "s", "age of the oldest sample of an analyser that counts", 1,
           1e6f, 3600),
    {24, BLOCK_WORD, PLACE(covariance), 1, 1, "covariance", "full|band|steady",
     "ekf, kalman: of all mole fractions, of neighbouring stages, or steady gains", 0, 0,
     COVARIANCE_FULL},
    NUMBER(25, cycle_s, "cycle", "s", "ekf, kalman: time between gains; 0: a tick", 0, 60, 0),
    NUMBER(26, feed_z, "feed_z", "-",
           "ekf, kalman: standard deviation of the feed's mole fractions; 0: the table's are right",
           0, 1, 0.1f),
    NUMBER(27, feed_f, "feed_f", "-",
           "ekf, kalman: standard deviation of the feed flow, part of it; 0: it is right; -1: 0.1 "
           "for ekf with a full covariance without the flow among the inputs, else 0",
           -1, 1, -1),
    NUMBER(28, feed_s, "feed_time", "s", "ekf, kalman: correlation time of the feed", 60, 1e7f,
           3600),
    NUMBER(29, analyser, "analyser", "-",
           "ekf, kalman: standard deviation of an analysis, mole fraction", 1e-6f, 1, 5e-4f),
    NUMBER(30, offset, "offset", "-",
           "ekf, kalman: standard deviation of the model's offset at an analysis, mole fraction; "
           "0: none",
           0, 1, 5e-3f),
    NUMBER(
        31, sure, "sure", "-",
        "ekf, kalman: points of a larger standard deviation, mole fraction, are uncertain; 0: none",
        0, 1, 0),
    NUMBER(32, nis_full, "nis_full", "-", "ekf, kalman: replaces nis; 0: none", 0, 1e6f, 4),
    {33, BLOCK_WORD, PLACE(quantity), BLOCK_POINTS_MAX, 1, "of", "stage|feed_fraction|feed_flow",
     "quantity of the point; the feed's flow in the unit of the table", 0, 0, OF_STAGE},
    {34, BLOCK_FLOAT, UNKEPT(back), BLOCK_POINTS_MAX, sizeof(struct block_return) / sizeof(float),
     "return", "EU, EU",
     "for the loop that a loop on the point moves: setpoint when the point is lost, and distance "
     "from the last good one while it is uncertain; both 0: as the cascade began, any",
     -1e9f, 1e9f, 0},
    NUMBER(35, sure_part, "sure_part", "-",
           "ekf, kalman: likewise, part of the smaller of the fraction and the rest; 0: none", 0,
           10, 0.5f),
    NUMBER(36, lasting, "lasting", "-",
           "ekf, kalman: standard deviation of the model's lasting error, part of the same", 0, 10,
           0.25f),
    {17, BLOCK_WORD, PLACE(between), 1, 1, "between", "line|mean",
     "temperatures of truncated stages, from those around them", 0, 0, COLUMN_BETWEEN_LINE},
};

/* ---- checks ---- */

static enum err check_sensor(const struct composition_settings *s, const struct column_table *table,
                             const struct block_setup *setup, unsigned k, struct block_fault *fault)
{
    unsigned stage = s->place[k][AT_STAGE], component = s->place[k][OF_COMPONENT];
    if (setup->input[k].is_mv)
        return block_refuse(fault, 0, "is", "says of an MV that it is a temperature");
    if (stage < 1 || stage > table->config.stages)
        return block_refuse(fault, 0, "place",
                            "needs the stage of each temperature, 1 to that of the condenser");
    if (component > table->config.components - 1)
        return block_refuse(fault, 0, "place",
                            "must have a component of the table but the closing one, or 0");
    if (column_table_is_truncated(table, stage))
        return block_refuse(fault, 0, "place", "must not be a truncated stage");
    for (unsigned i = 0; i < k; i++)
        if (composition_is_sensor(s, i) && s->place[i][AT_STAGE] == stage)
            return block_refuse(fault, 0, "place", "must have another stage for each temperature");
    return ERR_OK;
}

static enum err check_analysis(const struct composition_settings *s,
                               const struct column_table *table, const struct block_setup *setup,
                               unsigned k, struct block_fault *fault)
{
    unsigned others = 0;
    for (unsigned i = 0; i < k; i++)
        others += s->role[i] == IS_ANALYSIS ? 1u : 0u;
    if (others >= ANALYSES_MAX)
        return block_refuse(fault, 0, "is", "must have two analyses at most");
    if (setup->input[k].is_mv)
        return block_refuse(fault, 0, "is", "says of an MV that it is an analysis");
    if (s->place[k][AT_STAGE] < 1 || s->place[k][AT_STAGE] > table->config.stages ||
        s->place[k][OF_COMPONENT] < 1 || s->place[k][OF_COMPONENT] > table->config.components)
        return block_refuse(fault, 0, "place", "needs stage and component of each analysis");
    const struct composition_record *r = setup->settings;
    if (r->tune[k][TUNE_LAMBDA] > 1)
        return block_refuse(fault, 0, "tune", "must be a share, at most 1, for an analysis");
    return ERR_OK;
}

static enum err check_flow(const struct composition_settings *s, const struct column_table *table,
                           unsigned k, struct block_fault *fault)
{
    for (unsigned i = 0; i < k; i++)
        if (s->role[i] == s->role[k])
            return block_refuse(fault, 0, "is", "must have each but the temperatures once");
    const char *wanted = column_drive_refused(table, (enum column_drive)(s->role[k] - IS_FEED));
    return wanted ? block_refuse(fault, 0, "is", wanted) : ERR_OK;
}

static enum err check_all_inputs(const struct block_setup *setup, const struct column_table *table,
                                 struct block_fault *fault)
{
    const struct composition_settings *s = setup->settings;
    unsigned moves = 0;
    for (unsigned k = 0; k < setup->inputs; k++) {
        enum err err = composition_is_sensor(s, k) ? check_sensor(s, table, setup, k, fault)
                       : s->role[k] == IS_ANALYSIS ? check_analysis(s, table, setup, k, fault)
                                                   : check_flow(s, table, k, fault);
        if (err)
            return err;
        if (composition_is_sensor(s, k) && s->place[k][OF_COMPONENT] > 0)
            moves++;
    }
    if (!moves)
        return block_refuse(fault, 0, "place",
                            "needs one temperature at least that moves a component");
    return ERR_OK;
}

static enum err check_points(const struct block_setup *setup, const struct column_table *table,
                             struct block_fault *fault)
{
    const struct composition_settings *s = setup->settings;
    if (!setup->points)
        return block_refuse(fault, 0, "points", "needs one at least");
    for (unsigned k = 0; k < setup->points; k++) {
        unsigned component = s->point[k][OF_COMPONENT];
        bool of_feed = s->quantity[k] == OF_FEED_FRACTION;
        if (s->quantity[k] != OF_STAGE && s->point[k][AT_STAGE] != 0)
            return block_refuse(fault, 0, "point", "must have stage 0 where it is of the feed");
        if (of_feed && (component < 1 || component > table->config.components - 1))
            return block_refuse(fault, 0, "point",
                                "of the feed needs a component that is not the closing one");
        if (s->quantity[k] == OF_FEED_FLOW && component != 0)
            return block_refuse(fault, 0, "point", "of the feed's flow must have component 0");
        if (s->quantity[k] != OF_STAGE)
            continue;
        if (s->point[k][AT_STAGE] < 1 || s->point[k][AT_STAGE] > table->config.stages)
            return block_refuse(fault, 0, "point",
                                "needs a stage for each point, 1 to that of the condenser");
        if (component > table->config.components)
            return block_refuse(fault, 0, "point", "must have a component of the table, or 0");
    }
    return ERR_OK;
}

/* Checks what complete innovation needs. */
static enum err check_covariance(const struct block_setup *setup, const struct column_table *table,
                                 struct block_fault *fault)
{
    const struct composition_settings *s = setup->settings;
    size_t m = table->config.components - 1, stages = table->config.stages;
    if (!composition_is_complete(s))
        return ERR_OK;
    if (table->truncated[0] || table->truncated[1])
        return block_refuse(fault, 0, "method",
                            "must be geometric or rekf for a table with truncated stages");
    size_t extras = composition_extras(s, setup->inputs, m), moves = 0;
    for (unsigned k = 0; k < setup->inputs; k++)
        moves += composition_is_sensor(s, k) && s->place[k][OF_COMPONENT] > 0 ? 1u : 0u;
    if (s->feed_z > 0 && moves < m)
        return block_refuse(fault, 0, "feed_z",
                            "must be 0 with fewer temperatures that move the model than "
                            "mole fractions of the feed that they would have to find");
    if (extras > COVARIANCE_EXTRAS_MAX)
        return block_refuse(fault, 0, "is", "must have two analyses at most");
    if (composition_job_bytes(s->covariance, stages, m, extras) <= WORKSPACE_BYTES)
        return ERR_OK;
    if (composition_job_bytes(COVARIANCE_BAND, stages, m, extras) <= WORKSPACE_BYTES)
        return block_refuse(fault, 0, "covariance",
                            "must be band: a full one of so many states has no room in the "
                            "board's workspace");
    return block_refuse(fault, 0, "method",
                        "must be geometric or rekf: no covariance has room in the board's "
                        "workspace");
}

enum err composition_check(const struct block_setup *setup, struct block_fault *fault)
{
    const struct composition_settings *s = setup->settings;
    struct column_table table;
    struct column_fault reason;
    if (!setup->named || !s->column)
        return block_refuse(fault, 0, "column", "needs the number of a block of the kind column");
    if (column_record_read(setup->named, &table, &reason))
        return block_refuse(fault, 0, "column", "must name a block with a table that is in order");
    if (setup->members)
        return block_refuse(fault, 0, "loops", "must be none");
    for (size_t j = 0; s->basis == BASIS_MASS && j < table.config.components; j++)
        if (!(table.component[j].molar_mass > 0))
            return block_refuse(fault, 0, "basis",
                                "must be mole where the table has no molar masses");
    if (table.config.activity && (table.truncated[0] || table.truncated[1]))
        return block_refuse(
            fault, 0, "column",
            "must be a table without truncated stages where it has activity coefficients");
    enum err err = check_covariance(setup, &table, fault);
    if (!err)
        err = check_all_inputs(setup, &table, fault);
    return err ? err : check_points(setup, &table, fault);
}
