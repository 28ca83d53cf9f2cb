/* The walk's firmware and plant: what is typed and heard, samples, what has to hold after each, and twins (copies of the whole
 * process) in which something is tried from the same moment. */
#ifndef REFLUX_TESTS_WALK_BENCH_H
#define REFLUX_TESTS_WALK_BENCH_H

#include <math.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/app.h"
#include "hal/identity.h"
#include "operate/operate.h"
#include "walk_kinds.h"

#define event event_of_plant /* the firmware has another */
#include "plant_board.h"
#undef event

#define TICK_MS    60000u
#define TICK_S     60.0
#define LOG_LINES  60u
#define PARAMETERS 1500
#define ROUNDING   4e-6 /* of a span */

static struct random_source source;
static struct {
    unsigned seed, step;
    char done[LOG_LINES][160];
    unsigned n_done;
    bool prints;
    uint32_t stored_tick_ms;
    bool stored;               /* a set is in storage, */
    char stored_dump[60000];   /* which is this */
    char name[PARAMETERS][32]; /* of all parameters */
    unsigned names;
    double sent[2]; /* the last commands, of a tick with nothing odd in it */
    bool sent_counts[2];
    uint32_t serial;
} walk;

void setUp(void) {}

static void what_was_done(void)
{
    printf("seed %u step %u; done last:\n", walk.seed, walk.step);
    for (unsigned k = walk.n_done < LOG_LINES ? 0 : walk.n_done - LOG_LINES; k < walk.n_done; k++)
        printf("  %s\n", walk.done[k % LOG_LINES]);
    fflush(stdout);
}

void tearDown(void)
{
    if (Unity.CurrentTestFailed)
        what_was_done();
}

static void does(const char *what)
{
    snprintf(walk.done[walk.n_done++ % LOG_LINES], sizeof walk.done[0], "%u: %s", walk.step, what);
    if (walk.prints) {
        fprintf(stderr, "%u: %s\n", walk.step, what);
    }
}

#define HOLDS(condition, ...)                                                                      \
    do {                                                                                           \
        if (!(condition)) {                                                                        \
            char text_[400];                                                                       \
            snprintf(text_, sizeof text_, __VA_ARGS__);                                            \
            TEST_FAIL_MESSAGE(text_);                                                              \
        }                                                                                          \
    } while (0)

static uint32_t below(uint32_t n)
{
    return random_below(&source, n);
}

static bool one_in(uint32_t n)
{
    return below(n) == 0;
}

#define ANY(list) ((list)[below(sizeof(list) / sizeof((list)[0]))])

static const struct service *service(void)
{
    return app_door(app_instance())->service;
}

/* ---- what is said ---- */

static void events_are_whole(void)
{
    static char copy[SAID_MAX];
    char *save = NULL;
    memcpy(copy, board.said, board.n_said + 1);
    for (char *line = strtok_r(copy, "\n", &save); line; line = strtok_r(NULL, "\n", &save)) {
        char level[16], code[32], subject[32], value[32];
        double time;
        for (const char *c = line; *c; c++)
            HOLDS((*c >= ' ' && *c <= '~') || *c == '\r', "rubbish: %s", line);
        if (strncmp(line, "! ", 2) != 0)
            continue;
        HOLDS(sscanf(line, "! %lf %15s %31s %31s %31s", &time, level, code, subject, value) >= 4 &&
                  (strcmp(level, "info") == 0 || strcmp(level, "warning") == 0 ||
                   strcmp(level, "alarm") == 0) &&
                  strspn(code, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_") == strlen(code),
              "event: %s", line);
        if (walk.prints)
            fprintf(stderr, "    %s\n", line);
    }
}

/* Types a line; returns whether it was done. */
static bool types(const char *line)
{
    does(line);
    const char *end = ask(line);
    if (walk.prints)
        fprintf(stderr, "    -> %s\n", end);
    events_are_whole();
    if (strcmp(end, "ok") != 0)
        snprintf(walk.done[walk.n_done++ % LOG_LINES], sizeof walk.done[0], "      -> %.120s", end);
    return strcmp(end, "ok") == 0;
}

static void dumped(char *text, size_t size)
{
    ask_ok("dump");
    text[0] = '\0';
    for (unsigned i = 0; i < n_reply; i++) {
        HOLDS(strlen(text) + strlen(reply[i]) + 2 < size, "dump too long");
        strcat(text, reply[i]);
        strcat(text, "\n");
    }
}

/* ---- in a twin ---- */

/* Runs `twin` in a copy of everything; true if it came to its end. */
static void in_a_twin(void (*twin)(void *), void *result, size_t size)
{
    int ends[2];
    fflush(stdout);
    TEST_ASSERT_EQUAL(0, pipe(ends));
    pid_t child = fork();
    if (child == 0) {
        close(ends[0]);
        twin(result);
        ssize_t n = Unity.CurrentTestFailed ? 0 : write(ends[1], result, size);
        _exit(n == (ssize_t)size ? 0 : 1);
    }
    close(ends[1]);
    ssize_t n = read(ends[0], result, size);
    int status;
    close(ends[0]);
    TEST_ASSERT_EQUAL(child, waitpid(child, &status, 0));
    HOLDS(n == (ssize_t)size, "a twin failed (see above)");
}

static char dump_a[60000], dump_b[60000];

static void differs_where(const char *a, const char *b, const char *what)
{
    if (strcmp(a, b) == 0)
        return;
    size_t i = 0;
    while (a[i] == b[i])
        i++;
    while (i && a[i - 1] != '\n')
        i--;
    printf("%s: %.*s instead of %.*s\n", what, (int)strcspn(b + i, "\n"), b + i,
           (int)strcspn(a + i, "\n"), a + i);
    TEST_FAIL_MESSAGE(what);
}

/* ---- samples ---- */

static struct link_sample last_sample;
static float odd_value[2];
static int odd_quality[2]; /* -1: as it is */
static unsigned odd_left[2];

static void plant_moves(unsigned ticks)
{
    double tick_s = board.tick_ms / 1000.0;
    while (ticks--) {
        TEST_ASSERT_TRUE_MESSAGE(
            instruments_drive(&instruments, plant, tick_s, plant_err, sizeof plant_err), plant_err);
        board.time_ms += board.tick_ms;
        TEST_ASSERT_TRUE_MESSAGE(
            kind->advance(plant, (double)board.time_ms / 1000.0, plant_err, sizeof plant_err),
            plant_err);
    }
}

static void sample_comes(void)
{
    struct frame f;
    instruments_measure(&instruments, plant, board.tick_ms / 1000.0, &last_sample);
    last_sample.number = ++board.number;
    last_sample.time_ms = board.time_ms;
    for (unsigned i = 0; i < 2; i++) {
        if (!odd_left[i])
            continue;
        odd_left[i]--;
        last_sample.measurement[i].value = odd_value[i];
        if (odd_quality[i] >= 0)
            last_sample.measurement[i].quality = (enum quality)odd_quality[i];
    }
    pack_sample(&last_sample, &f);
    link_give(&f);
}

/* ---- what has to hold ---- */

static const struct interlock_config *holder_of(const struct config *c, const struct supervisor *s,
                                                const char *mv)
{
    for (unsigned i = 0; i < s->placed[PLACED_INTERLOCKS]; i++)
        if (s->interlock[i].active && c->interlock[i].measurement[0] &&
            strcmp(c->interlock[i].mv, mv) == 0)
            return &c->interlock[i];
    return NULL;
}

/* A number beyond a limit without delay holds, whatever else is wrong with it. */
static bool must_be_held(const struct config *c, const struct supervisor *s, const char *mv)
{
    for (unsigned i = 0; i < s->placed[PLACED_INTERLOCKS]; i++) {
        const struct interlock_config *l = &c->interlock[i];
        if (!l->measurement[0] || strcmp(l->mv, mv) != 0 || l->delay_s != 0)
            continue;
        for (unsigned k = 0, at = 0; k < kind->n_channels; k++) {
            if (kind->channels[k].kind != PLANT_MEASUREMENT)
                continue;
            unsigned which = at++;
            if (strcmp(kind->channels[k].name, l->measurement) != 0 || which >= 2)
                continue;
            for (unsigned m = 0; m < s->placed[PLACED_MEASUREMENTS]; m++) {
                const struct measurement_config *mc = &c->measurement[m];
                if (strcmp(mc->name, l->measurement) != 0 || !s->measurement[m].bound ||
                    mc->analyser.every > 1 || mc->offset.eu != 0)
                    continue;
                float x = last_sample.measurement[which].value;
                if (last_sample.measurement[which].quality > QUALITY_UNCERTAIN || !isfinite(x))
                    continue;
                if (l->side == INTERLOCK_ABOVE ? x > l->limit : x < l->limit)
                    return true;
            }
        }
    }
    return false;
}

static void output_holds(unsigned j, bool ticked, bool was_run)
{
    const struct service *sv = service();
    const struct supervisor *s = sv->supervisor;
    const struct config *c = &service_in_force(sv)->config;
    const struct plant_channel *p = &kind->channels[instruments.actuator[j].channel];
    double u = (double)board.command.output[j].value, span = p->hi - p->lo;
    HOLDS(isfinite(u), "%s: command %g", p->name, u);
    bool counted = walk.sent_counts[j];
    double before = walk.sent[j];
    walk.sent[j] = u;
    walk.sent_counts[j] = false;
    if (!ticked)
        return;
    unsigned i = 0;
    while (i < s->placed[PLACED_MVS] && strcmp(c->mv[i].name, p->name) != 0)
        i++;
    if (i == s->placed[PLACED_MVS] || !s->mv[i].bound) {
        HOLDS(!board.command.output[j].drive || fabs(u - p->safe) < ROUNDING * span,
              "%s: %g, nobody's, safe %g", p->name, u, p->safe);
        return;
    }
    const struct mv_config *m = &c->mv[i];
    double most = ROUNDING * ((double)m->hi - (double)m->lo + span), safe = (double)m->safe,
           rate = (double)m->rate_per_s;
    HOLDS(u >= (double)m->lo - most && u <= (double)m->hi + most,
          "%s: command %.9g outside its span", p->name, u);
    const struct interlock_config *held = holder_of(c, s, p->name);
    HOLDS(held || !must_be_held(c, s, p->name), "%s: no interlock", p->name);
    HOLDS((held != NULL) == s->mv[i].interlocked, "%s: interlocked %d", p->name,
          s->mv[i].interlocked);
    if (held) {
        double value = (double)held->value;
        HOLDS(fabs(u - value) <= most, "%s: %g, interlocked at %g", p->name, u, value);
        return;
    }
    if (s->state == SUPERVISOR_SAFE) {
        HOLDS(fabs(u - safe) <= most, "%s: %.9g, safe is %.9g (state %d, said %d)", p->name, u,
              safe, s->state, board.command.safe);
        return;
    }
    bool acts = false;
    for (unsigned l = 0; l < s->placed[PLACED_LOOPS]; l++)
        if (c->loop[l].name[0] && strcmp(c->loop[l].out, p->name) == 0) {
            acts = s->loop[l].mode != LOOP_MANUAL;
        }
    double lo = (double)m->min, hi = (double)m->max;
    if (!acts) {
        lo = fmin(lo, safe);
        hi = fmax(hi, safe);
    }
    if (acts || !s->mv[i].beyond)
        HOLDS(u >= lo - most && u <= hi + most, "%s: %.9g outside %.9g..%.9g, acts %d", p->name, u,
              lo, hi, acts);
    if (was_run && counted && rate > 0 && walk.serial == sv->serial)
        HOLDS(fabs(u - before) <= rate * (double)s->tick_s * 1.0001 + most,
              "%s: from %.9g to %.9g, rate %g", p->name, before, u, rate);
    walk.sent_counts[j] = was_run && !s->mv[i].beyond && u >= (double)m->min && u <= (double)m->max;
}

static void takes_a_sample(unsigned n)
{
    struct supervisor *s = service()->supervisor;
    unsigned before = board.commands;
    board_forget();
    bool was_run = s->state == SUPERVISOR_RUN;
    for (unsigned k = 0; k < n; k++) {
        if (k)
            plant_moves(1);
        sample_comes();
    }
    uint32_t ticks = s->ticks;
    board_run();
    events_are_whole();
    if (!board.ready || board.mute) {
        instruments_safe(&instruments);
        walk.sent_counts[0] = walk.sent_counts[1] = false;
        return;
    }
    HOLDS(board.commands == before + n, "%u commands for %u samples", board.commands - before, n);
    for (unsigned j = 0; j < board.n_outputs; j++)
        output_holds(j, service()->supervisor->ticks != ticks, was_run && n == 1);
    walk.serial = service()->serial;
    instruments_command(&instruments, &board.command);
}

static void goes_on(unsigned n)
{
    while (n--) {
        takes_a_sample(1);
        plant_moves(1);
    }
}

/* ---- twins ---- */

#define TWIN_TICKS 3u
struct moved {
    double out[TWIN_TICKS][2];
    uint32_t state;
};

static void moves(struct moved *m)
{
    for (unsigned k = 0; k < TWIN_TICKS; k++) {
        goes_on(1);
        for (unsigned j = 0; j < 2; j++)
            m->out[k][j] = (double)board.command.output[j].value;
    }
    m->state = service()->supervisor->state;
}

static void twin_goes_on(void *result)
{
    unsigned mischief = imp_mischief;
    imp_mischief = 0;
    moves(result);
    imp_mischief = mischief;
}

static void twin_applies_nothing(void *result)
{
    ask_ok("begin");
    ask_ok("apply");
    twin_goes_on(result);
}

static void pastes(char *text)
{
    char *save = NULL;
    for (char *line = strtok_r(text, "\n", &save); line; line = strtok_r(NULL, "\n", &save))
        if (strcmp(line, "ok") != 0)
            ask_ok(line);
}

static void twin_pastes_its_dump(void *result)
{
    dumped(dump_a, sizeof dump_a);
    memcpy(dump_b, dump_a, sizeof dump_a);
    pastes(dump_b);
    dumped(dump_b, sizeof dump_b);
    differs_where(dump_a, dump_b, "dump pasted back");
    twin_goes_on(result);
}

/* Power on; what is stored has been read when this returns. */
static void powers_on(void)
{
    watch_proposes.n = pair_proposes.n = 0;
    imp_mischief = 0;
    memory_port_start();
    board.ready = false;
    board.mute = true;
    board_run();
    type("mode machine\n");
    pass(2600);
    plant_connect();
    goes_on(3);
    board_forget();
}

static void twin_saves_and_starts(void *result)
{
    dumped(dump_a, sizeof dump_a);
    memset(result, 0, sizeof(struct moved));
    if (strcmp(ask("save"), "ok") != 0)
        return;
    powers_on();
    dumped(dump_b, sizeof dump_b);
    differs_where(dump_a, dump_b, "after save and start");
    memset(result, 0, sizeof(struct moved));
}

static bool busy(void)
{
    const struct service *sv = service();
    for (unsigned n = 0; n < CONFIG_BLOCKS; n++)
        if (sv->supervisor->switch_off[n].state != SWITCH_OFF_FREE)
            return true;
    return sv->staging || sv->in_force != sv->newest ||
           sv->supervisor->proposal.state != PROPOSAL_FREE || sv->supervisor->sequence.state != 0 ||
           sv->supervisor->testing;
}

static void compares(void (*twin)(void *), const char *what)
{
    static struct moved a, b;
    (void)types("abandon");
    goes_on(1); /* what was asked for is done */
    watch_proposes.n = pair_proposes.n = 0;
    if (busy() || !board.ready || service()->supervisor->state != SUPERVISOR_RUN)
        return;
    does(what);
    in_a_twin(twin_goes_on, &a, sizeof a);
    in_a_twin(twin, &b, sizeof b);
    for (unsigned k = 0; k < TWIN_TICKS; k++)
        for (unsigned j = 0; j < 2; j++)
            HOLDS(fabs(a.out[k][j] - b.out[k][j]) <= 1e-6 * 4,
                  "%s: output %u is %.9g, would be %.9g after %u", what, j, b.out[k][j],
                  a.out[k][j], k + 1);
}

static void restores(void)
{
    struct moved nothing;
    (void)types("abandon");
    if (busy())
        return;
    does("save and start, in a twin");
    in_a_twin(twin_saves_and_starts, &nothing, sizeof nothing);
}

#endif
