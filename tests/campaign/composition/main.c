/* Measures how far a `composition` block with default settings is to be believed: a column of a table as the plant, which differs from the block's
 * model by what nobody tells the block. Four thermometers, the lowest of which a PI holds by the heat; in a second run a loop on the
 * estimated bottoms moves the setpoint of that PI, and returns it as the firmware does. Prints a line of each case:
 *
 *     case, part of the time in which top and bottom are called good, part in which they are called good and are off by more than
 *     three of their standard deviations or half the true impurity, the largest error so called good over the true impurity, IAE of
 *     the bottoms over their goal in hours with the temperature held, the same with the estimate held
 *
 *     composition TABLE [HOURS [CASE]]      120; all cases
 *
 * TABLE: what reflux-sim --table prints. Exit status 1 where a case that counts is not reached (reached()). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/channel.h"
#include "base/workspace.h"
#include "block_defaults.h"
#include "composition_whole.h"
#include "courses.h"
#include "kinds/composition/composition_job_state.h"
#include "random_source.h"

#define TICK_S  10.0
#define SENSORS 4u
#define SETTLED 3.0  /* h: nothing counts before */
#define BEGINS  12.0 /* h: what nobody tells begins; in a short run half-way */
#define MMHG    133.322
#define HOLD_S  60.0
#define OUTER_S 5400.0 /* integral time of the loop on the estimate */
#define FEEDS_H 8.0    /* hours from one feed to the next */
enum { TOP, BOTTOM, ENDS };

struct outcome {
    double good[ENDS], wrong[ENDS], worst, iae;
};

struct bench {
    const struct course *course;
    double begins_h;
    struct column_record model, column;
    struct composition_record all;
    struct block_setup setup;
    struct composition_block plant, *block;
    struct block_io io;
    num_t input[BLOCK_INPUTS_MAX], point[BLOCK_POINTS_MAX];
    uint8_t quality[BLOCK_INPUTS_MAX], point_quality[BLOCK_POINTS_MAX];
    float event_value[BLOCK_EVENTS_MAX], age_s[BLOCK_INPUTS_MAX];
    bool asked, done;
    unsigned waited, due;
    unsigned stage[SENSORS], heat, reflux, feed, pressure;
    double lagged[SENSORS], held, setpoint, gain, integral;
};

static struct bench bench;
static struct workspace workspace;
static uint64_t region[WORKSPACE_BYTES / sizeof(uint64_t) + 1];
static struct random_source source;

static double lag_of(const struct course *c)
{
    return c->lag_s > 0 ? c->lag_s : PLAIN_LAG_S;
}

static double noise_of(const struct course *c)
{
    return c->noise > 0 ? c->noise : PLAIN_NOISE;
}

static double random_uniform(void)
{
    return ((double)(random_next(&source) >> 11) + 0.5) / 9007199254740992.0;
}

static double random_normal(void)
{
    double radius = sqrt(-2 * log(random_uniform()));
    return radius * cos(2 * 3.14159265358979 * random_uniform());
}

static void fail(const char *what, const char *why)
{
    fprintf(stderr, "composition: %s %s\n", what, why);
    exit(2);
}

/* ---- table ---- */

static void seal(struct column_record *r)
{
    uint32_t sum = column_table_checksum(r->version, r->size, r->value);
    r->checksum[0] = (uint16_t)(sum >> 16);
    r->checksum[1] = (uint16_t)sum;
}

static void read_table(const char *path, struct column_record *r)
{
    FILE *file = fopen(path, "r");
    char line[400];
    if (!file)
        fail(path, "cannot be read");
    *r = (struct column_record){.version = COLUMN_TABLE_VERSION};
    while (fgets(line, sizeof line, file)) {
        unsigned block, row;
        int at = 0;
        if (sscanf(line, "set block%u.size %u", &block, &row) == 2)
            r->size = (uint16_t)row;
        if (sscanf(line, "set block%u.value.%u %n", &block, &row, &at) != 2)
            continue;
        char *end = line + at;
        for (unsigned k = 8 * (row - 1); *end && *end != '\n' && k < COLUMN_TABLE_MOST; k++)
            r->value[k] = strtof(*end == ',' ? end + 1 : end, &end);
    }
    fclose(file);
    seal(r);
}

/* ---- the block ---- */

static unsigned add_input(struct bench *b, enum composition_input is, double most)
{
    unsigned k = b->setup.inputs++;
    b->all.s.role[k] = (uint8_t)is;
    b->setup.input[k] = (struct block_signal){0, (float)most, false};
    return k;
}

static void put(struct bench *b, unsigned k, double value)
{
    b->input[k] = num_from_float((float)value / b->setup.input[k].hi);
}

static void tick(struct bench *b)
{
    b->io.requests.raised = b->io.requests.ask_work = 0;
    b->io.requests.work_done = b->io.requests.work_wanted = false;
    if (b->asked) {
        b->waited += b->waited < b->due ? 1u : 0;
        b->io.requests.work_done = b->done && b->waited >= b->due;
        b->io.requests.work_wanted = b->asked = !b->io.requests.work_done;
    }
    composition_kind.step(b->block, &b->io);
    if (b->io.requests.ask_work && !b->asked) {
        b->asked = true;
        b->done = false;
        b->waited = 0;
        b->due = b->io.requests.ask_work;
    }
    workspace_tick(&workspace);
    while (b->asked && !b->done)
        b->done = !composition_kind.work(b->block);
}

/* ---- the plant ---- */

static double value_of(const struct bench *b, unsigned place)
{
    return (double)b->model.value[place];
}

static double temperature(const struct bench *b, unsigned stage)
{
    return (double)b->plant.model.column.temperature[stage - 1];
}

static void evaluate(struct bench *b)
{
    struct composition_model *m = &b->plant.model;
    struct column_fault why;
    if (column_set_inputs(&m->column, &m->inputs, &why) ||
        column_truncated_rates(&m->column, m->truncated, COLUMN_BETWEEN_LINE, m->x, m->rates))
        fail("the plant", "has no state");
}

static void plant_step(struct bench *b, double heat, double reflux)
{
    b->plant.model.inputs.heat = (real_t)heat;
    b->plant.model.inputs.reflux_flow = (real_t)reflux;
    if (composition_model_predict(&b->plant.model))
        fail("the plant", "has no solution");
    evaluate(b);
}

/* Impurity of the product: the second component in the distillate, the first in the bottoms. */
static double impurity(const struct bench *b, unsigned end)
{
    const struct column *c = &b->plant.model.column;
    size_t stages = b->plant.model.table.config.stages;
    return end == TOP ? (double)column_fraction(c, b->plant.model.x, stages - 1, 1)
                      : (double)column_fraction(c, b->plant.model.x, 0, 0);
}

/* In each section where the profile is steepest, and half-way from there to the product. */
static void place_thermometers(struct bench *b)
{
    unsigned stages = (unsigned)value_of(b, COLUMN_TABLE_N_STAGES);
    unsigned feed = (unsigned)value_of(b, COLUMN_TABLE_FEED_STAGE), best[2] = {2, stages - 1};
    double most[2] = {0, 0};
    for (unsigned s = 2; s < stages; s++) {
        double step = fabs(temperature(b, s + 1) - temperature(b, s - 1));
        if (s == feed || step <= most[s > feed])
            continue;
        most[s > feed] = step;
        best[s > feed] = s;
    }
    b->stage[0] = best[0];
    b->stage[1] = best[0] > 3 ? (best[0] + 1) / 2 : best[0] + 2;
    b->stage[2] = best[1];
    b->stage[3] = best[1] < stages - 2 ? (best[1] + stages) / 2 : best[1] - 2;
}

static void configure(struct bench *b)
{
    const struct course *course = b->course;
    struct block_fault fault;
    unsigned stages = (unsigned)value_of(b, COLUMN_TABLE_N_STAGES);
    b->all.s.method = METHOD_GEOMETRIC;
    b->all.s.column = 2;
    b->all.s.point[TOP][AT_STAGE] = (uint16_t)stages;
    b->all.s.point[TOP][OF_COMPONENT] = 2;
    b->all.s.point[BOTTOM][AT_STAGE] = b->all.s.point[BOTTOM][OF_COMPONENT] = 1;
    b->setup.points = ENDS;
    b->setup.point[TOP] = b->setup.point[BOTTOM] = (struct block_signal){0, 1, false};
    for (unsigned k = 0; k < SENSORS; k++) {
        (void)add_input(b, IS_TEMPERATURE, 600);
        b->all.s.place[k][AT_STAGE] = (uint16_t)(k + 2);
        b->all.s.place[k][OF_COMPONENT] = 1;
    }
    b->setup.named = &b->column;
    if (composition_kind.check(&b->setup, &fault) ||
        composition_kind.configure(&b->plant, &b->setup, false))
        fail("the column", fault.wanted);
    evaluate(b);
    place_thermometers(b);
    for (unsigned k = 0; k < SENSORS; k++)
        b->all.s.place[k][AT_STAGE] = (uint16_t)b->stage[k];
    b->reflux = add_input(b, IS_REFLUX, 4 * value_of(b, COLUMN_TABLE_REFLUX));
    b->heat = add_input(b, IS_HEAT, 4 * value_of(b, COLUMN_TABLE_HEAT));
    if (course->has_meter)
        b->feed = add_input(b, IS_FEED, 4 * value_of(b, COLUMN_TABLE_FEED));
    if (course->has_pressure)
        b->pressure = add_input(b, IS_PRESSURE, 2 * value_of(b, COLUMN_TABLE_PRESSURE));
    b->all.s.method = METHOD_EKF;
    b->setup.named = &b->model;
    if (composition_kind.check(&b->setup, &fault))
        fail(fault.field, fault.wanted);
    b->block = calloc(1, composition_kind.bytes(&b->setup));
    if (!b->block || composition_kind.configure(b->block, &b->setup, false))
        fail("the block", "is refused");
}

/* ---- control ---- */

/* PI on the first thermometer by SIMC, as part of the nominal heat. */
static double held_by_heat(struct bench *b, double reading)
{
    double time = 8 * (lag_of(b->course) + 2 * TICK_S), error = b->setpoint - reading;
    double part = 1 + b->gain * error + b->integral;
    part = part < 0.5 ? 0.5 : part > 2 ? 2 : part;
    b->integral = part - 1 - b->gain * error * (1 - TICK_S / time);
    return part;
}

/* Finds how fast the temperature answers to the heat, and tunes the PI by it. */
static void tune(struct bench *b)
{
    static struct composition_block before;
    double heat = value_of(b, COLUMN_TABLE_HEAT), reflux = value_of(b, COLUMN_TABLE_REFLUX);
    memcpy(&before, &b->plant, sizeof before);
    b->held = b->setpoint = temperature(b, b->stage[0]);
    for (unsigned k = 0; k < 18; k++)
        plant_step(b, 1.01 * heat, reflux);
    double slope = (temperature(b, b->stage[0]) - b->held) / (18 * TICK_S * 0.01);
    b->gain = 1 / (fmax(slope, 1e-4) * 2 * (lag_of(b->course) + 2 * TICK_S));
    memcpy(&b->plant, &before, sizeof before);
    evaluate(b);
}

/* Bottoms by the setpoint, mole fraction per K. */
static double slope_of_setpoint(struct bench *b)
{
    static struct composition_block before;
    double ends[2];
    memcpy(&before, &b->plant, sizeof before);
    for (unsigned up = 0; up < 2; up++) {
        b->integral = 0;
        b->setpoint = b->held + (up ? 0.3 : -0.3);
        for (double t = 0; t < 24 * 3600; t += TICK_S)
            plant_step(
                b, value_of(b, COLUMN_TABLE_HEAT) * held_by_heat(b, temperature(b, b->stage[0])),
                value_of(b, COLUMN_TABLE_REFLUX));
        ends[up] = impurity(b, BOTTOM);
        memcpy(&b->plant, &before, sizeof before);
    }
    evaluate(b);
    b->integral = 0;
    b->setpoint = b->held;
    return (ends[1] - ends[0]) / 0.6;
}

/* ---- a run ---- */

static void disturb(struct bench *b, double hour, double by_z, double by_flow)
{
    const struct course *course = b->course;
    struct column_inputs *in = &b->plant.model.inputs;
    const struct column_inputs *nominal = &b->plant.model.table.nominal;
    bool on = hour >= b->begins_h;
    double first = (double)nominal->feed_fraction[0], z = first + by_z + (on ? course->z : 0);
    in->feed_fraction[0] = (real_t)z;
    for (size_t j = 1; j < b->plant.model.table.config.components; j++)
        in->feed_fraction[j] = nominal->feed_fraction[j] * (real_t)((1 - z) / (1 - first));
    in->feed_flow = nominal->feed_flow * (real_t)(1 + by_flow + (on ? course->flow : 0));
    in->pressure_top = nominal->pressure_top + (real_t)(on ? course->pressure * MMHG : 0);
}

static void measure(struct bench *b, double hour, double *reading)
{
    const struct course *course = b->course;
    for (unsigned k = 0; k < SENSORS; k++) {
        b->lagged[k] +=
            (temperature(b, b->stage[k]) - b->lagged[k]) * TICK_S / (lag_of(course) + TICK_S);
        bool off = hour >= b->begins_h && k == course->biased;
        reading[k] = b->lagged[k] + noise_of(course) * random_normal() + (off ? course->bias : 0);
        reading[k] = round(100 * reading[k]) / 100;
        put(b, k, reading[k]);
    }
    if (course->has_meter)
        put(b, b->feed, (double)b->plant.model.inputs.feed_flow);
    if (course->has_pressure)
        put(b, b->pressure, (double)b->plant.model.inputs.pressure_top);
}

/* weight: of a tick, part of the time that counts. */
static void judge(struct bench *b, struct outcome *o, double weight)
{
    for (unsigned end = 0; end < ENDS; end++) {
        double truth = impurity(b, end), error = fabs((double)num_to_float(b->point[end]) - truth);
        struct composition_parts parts = whole_parts(b->block);
        double sd = (double)composition_judge_sd(&parts, end);
        if (b->point_quality[end] != QUALITY_GOOD)
            continue;
        o->good[end] += weight;
        o->wrong[end] += error > 3 * sd || error > truth / 2 ? weight : 0;
        o->worst = fmax(o->worst, error / truth);
    }
}

/* Returns the setpoint when the estimate is lost: then the loop is in manual, and stays there. */
static bool outer_loop(struct bench *b, double goal, double slope, double *doubted_s)
{
    double estimate = (double)num_to_float(b->point[BOTTOM]), most = goal / fabs(slope);
    double wanted = (goal - estimate) / slope;
    *doubted_s = b->point_quality[BOTTOM] == QUALITY_GOOD ? 0 : *doubted_s + TICK_S;
    if (*doubted_s > HOLD_S) {
        b->setpoint = b->held;
        return false;
    }
    b->setpoint += fmax(-most, fmin(most, wanted)) * TICK_S / OUTER_S;
    return true;
}

static void begin(struct bench *b, const struct column_record *table, const struct course *course)
{
    memset(b, 0, sizeof *b);
    b->course = course;
    b->model = b->column = *table;
    if (course->efficiency > 0)
        b->column.value[COLUMN_TABLE_EFFICIENCY] *= (float)course->efficiency;
    seal(&b->column);
    block_put_defaults(&b->all, &composition_kind);
    b->setup.settings = &b->all;
    b->setup.interval_s = (float)TICK_S;
    b->io.inputs.value = b->input;
    b->io.inputs.quality = b->quality;
    b->io.points.value = b->point;
    b->io.points.quality = b->point_quality;
    b->io.requests.event_value = b->event_value;
    b->io.inputs.age_s = b->age_s;
    workspace_init(&workspace, region, WORKSPACE_BYTES);
    workspace_share(&workspace);
    source.state = 1;
    configure(b);
    for (unsigned k = 0; course->efficiency > 0 && k < 20000; k++)
        plant_step(b, value_of(b, COLUMN_TABLE_HEAT), value_of(b, COLUMN_TABLE_REFLUX));
    tune(b);
    for (unsigned k = 0; k < SENSORS; k++)
        b->lagged[k] = temperature(b, b->stage[k]);
}

/* slope: of the bottoms by the setpoint of the temperature; 0: no loop acts on the estimate. */
static struct outcome run(const struct column_record *table, const struct course *course,
                          double hours, double slope)
{
    struct bench *b = &bench;
    struct outcome o = {{0}, {0}, 0, 0};
    begin(b, table, course);
    b->begins_h = fmin(BEGINS, hours / 2);
    double heat = value_of(b, COLUMN_TABLE_HEAT), reflux = value_of(b, COLUMN_TABLE_REFLUX);
    bool has_outer = slope < 0 || slope > 0;
    double goal = impurity(b, BOTTOM), doubted_s = 0;
    double by_z = 0, by_flow = 0, reading[SENSORS];
    for (unsigned long t = 0; (double)t * TICK_S < hours * 3600; t++) {
        double hour = (double)t * TICK_S / 3600;
        if (course->feeds && t > 0 && t % (unsigned long)(FEEDS_H * 3600 / TICK_S) == 0) {
            by_z = 0.1 * (random_uniform() - 0.5);
            by_flow = 0.2 * (random_uniform() - 0.5);
        }
        disturb(b, hour, by_z, by_flow);
        measure(b, hour, reading);
        double part = held_by_heat(b, reading[0]);
        put(b, b->reflux, reflux);
        put(b, b->heat, heat * part);
        if (t == 0)
            composition_kind.follow(b->block, &b->io);
        tick(b);
        if (hour >= SETTLED) {
            judge(b, &o, TICK_S / 3600 / (hours - SETTLED));
            o.iae += fabs(impurity(b, BOTTOM) / goal - 1) * TICK_S / 3600;
            has_outer = has_outer && outer_loop(b, goal, slope, &doubted_s);
        }
        plant_step(b, heat * part * (1 - (hour >= b->begins_h ? course->loss : 0)), reflux);
    }
    free(b->block);
    return o;
}

static bool reached(const struct course *course, const struct outcome *o, double ratio)
{
    bool must_be_good = !strcmp(course->name, REST) || course->feeds;
    return o->wrong[TOP] <= 0.005 && o->wrong[BOTTOM] <= 0.005 && ratio <= 3 &&
           (!must_be_good || (o->good[TOP] >= 0.9 && o->good[BOTTOM] >= 0.9));
}

int main(int argc, char **argv)
{
    static struct column_record table;
    if (argc < 2)
        fail("usage:", "composition TABLE [HOURS [CASE]]");
    double hours = argc > 2 ? strtod(argv[2], NULL) : 120;
    bool all = true;
    read_table(argv[1], &table);
    begin(&bench, &table, &courses[0]);
    double slope = slope_of_setpoint(&bench);
    free(bench.block);
    printf("case,good_top,good_bottom,wrong_top,wrong_bottom,worst,iae_temperature,iae_estimate\n");
    for (unsigned k = 0; k < sizeof courses / sizeof courses[0]; k++) {
        if (argc > 3 && strcmp(argv[3], courses[k].name))
            continue;
        struct outcome o = run(&table, &courses[k], hours, 0);
        double iae = run(&table, &courses[k], hours, slope).iae;
        printf("\"%s\",%.4f,%.4f,%.5f,%.5f,%.3f,%.4f,%.4f\n", courses[k].name, o.good[TOP],
               o.good[BOTTOM], o.wrong[TOP], o.wrong[BOTTOM], o.worst, o.iae, iae);
        all = all && (k >= COUNTED || reached(&courses[k], &o, iae / o.iae));
    }
    return all ? 0 : 1;
}
