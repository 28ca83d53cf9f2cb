#include "lockstep.h"

#include <math.h>
#include <string.h>

#include "bench/text.h"
#include "lockstep_parts.h"

enum outcome lockstep_stop(struct lockstep *k, const char *reason)
{
    (void)sim_fail(k->error, sizeof(k->error), "%s", reason);
    return STOPPED;
}

/* Lets link and console work until done() holds, for at most span_ms. */
enum outcome lockstep_wait(struct lockstep *k, condition done, uint64_t span_ms)
{
    struct transport *list[2] = {k->link->transport, NULL};
    size_t n = 1;
    if (k->console != NULL) {
        list[n] = k->console->transport;
        n++;
    }
    uint64_t began = transport_now_ms(list[0]);
    for (;;) {
        bool link_speaks = k->pins == NULL || (k->rest != NULL && k->rest->begun);
        if (!link_speaks) {
            pins_side_turn(k->pins);
        } else if (!link_server_turn(k->link)) {
            return lockstep_stop(k, k->link->error);
        }
        if (k->console != NULL && !console_turn(k->console)) {
            return lockstep_stop(k, k->console->error);
        }
        if (*k->interrupted != 0) {
            return STOPPED;
        }
        if (k->met && k->pins == NULL && k->link->greetings != k->greetings_seen) {
            return REGREETED;
        }
        if (done(k)) {
            return GOT_IT;
        }
        uint64_t spent = transport_now_ms(list[0]) - began;
        if (spent >= span_ms) {
            return TOO_LATE;
        }
        uint64_t due = link_speaks ? link_server_due(k->link) : span_ms;
        transport_wait(list, n, due < span_ms - spent ? due : span_ms - spent);
    }
}

enum outcome lockstep_late(struct lockstep *k, const char *what)
{
    (void)sim_fail(k->error, sizeof(k->error),
                   "at plant time %.3f s: no %s within %.3f s (link %s: %u good frames, %s)",
                   (double)k->time_ms / 1000.0, what, (double)k->timeout_ms / 1000.0,
                   k->link->transport->where, k->link->decoder.count.good,
                   k->link->state == LINK_SAMPLING ? "controller ready"
                   : k->link->controller_known     ? "greeting a controller"
                                                   : "no controller has greeted");
    return STOPPED;
}

static bool sampling(const struct lockstep *k)
{
    return k->pins != NULL || k->link->state == LINK_SAMPLING;
}

static bool answered(const struct lockstep *k)
{
    return k->link->answered;
}

static bool row_here(const struct lockstep *k)
{
    return !console_row_missing(k->console, k->number);
}

/* Returns the time that --speed counts by: the virtual board's own, else that of this computer. */
static double pace_clock_s(const struct lockstep *k)
{
    struct transport *t = k->link->transport;
    return transport_keeps_time(t) ? (double)transport_now_ms(t) / 1000.0 : sim_clock_s();
}

static void begin_pace(struct lockstep *k)
{
    k->pace_began = k->speed > 0.0 ? pace_clock_s(k) - (double)k->time_ms / 1000.0 / k->speed : 0.0;
}

/* Waits through a greeting under way and takes note of who is there. True in *restarted when the controller is
 * another one than before, or the same after a restart. */
static enum outcome meet(struct lockstep *k, bool *restarted)
{
    bool met_before = k->met;
    k->met = false; /* READY is what is waited for here, not an interruption */
    enum outcome r = lockstep_wait(k, sampling, k->timeout_ms);
    k->met = met_before;
    if (r == TOO_LATE) {
        return lockstep_late(k, "READY from the controller");
    }
    if (r != GOT_IT) {
        return r;
    }
    /* One that starts again after a silence may hear the plant's HELLO before it has sent its own: it asks for pages, then. */
    *restarted = met_before && (k->link->controller_session != k->session_seen ||
                                k->link->introductions != k->introductions_seen);
    if (*restarted) {
        k->restarts++;
        begin_pace(k); /* plant time stood still, and is not hurried after */
    }
    k->greetings_seen = k->link->greetings;
    k->session_seen = k->link->controller_session;
    k->introductions_seen = k->link->introductions;
    k->met = true;
    instruments_safe(k->instruments);
    return GOT_IT;
}

/* After REGREETED: everything back to where samples can flow. */
enum outcome lockstep_recover(struct lockstep *k, bool *restarted)
{
    bool any = false;
    enum outcome r;
    do {
        bool once = false;
        r = meet(k, &once);
        any = any || once;
        if (r == GOT_IT && any && k->console != NULL) {
            r = lockstep_start_console(k);
        }
    } while (r == REGREETED);
    *restarted = any;
    return r;
}

static bool tick_is_over(const struct lockstep *k)
{
    return pins_side_left(k->pins) == 0;
}

/* Until this part of the tick at the board's own pins is over. */
static enum outcome run_board(struct lockstep *k)
{
    uint64_t left_ms;
    while ((left_ms = pins_side_left(k->pins)) > 0) {
        if (lockstep_wait(k, tick_is_over, left_ms) == STOPPED) {
            return STOPPED;
        }
    }
    return GOT_IT;
}

enum outcome lockstep_next_sample(struct lockstep *k)
{
    pins_side_next_sample(k->pins);
    return run_board(k);
}

/* Until the clock of the board is where plant time may begin. */
static enum outcome run_to_start(struct lockstep *k, const struct link_sample *sample)
{
    enum outcome r;
    do {
        pins_side_set_up(k->pins, sample);
        r = run_board(k);
    } while (r == GOT_IT && !pins_side_is_set_up(k->pins));
    return r;
}

/* Until a board that starts has erased its flash, which a new one does. Then it gets the lines of time 0, its settings, before plant time begins.
 * So what its outputs do depends neither on the one nor on how long the other takes, as long as that is less than a tick. */
static enum outcome set_up_board(struct lockstep *k, const struct link_sample *sample)
{
    enum outcome r = run_to_start(k, sample);
    if (r == GOT_IT) {
        pins_side_count(k->pins, false);
        pins_side_begin(k->pins, sample);
        r = run_board(k);
    }
    if (r == GOT_IT) {
        r = lockstep_lines(k, (double)k->time_ms / 1000.0);
    }
    return r == GOT_IT ? run_to_start(k, sample) : r;
}

/* At the board's own pins its clock goes on by a tick. Console lines come when it has taken its sample. */
static enum outcome pass_tick(struct lockstep *k, const struct link_sample *sample)
{
    bool first = k->samples == 0;
    if (k->console != NULL) {
        k->console->before_run = first;
    }
    enum outcome r = first ? set_up_board(k, sample) : GOT_IT;
    if (k->console != NULL) {
        k->console->before_run = false;
    }
    if (r == GOT_IT) {
        if (first) {
            pins_side_count(k->pins, true);
        }
        pins_side_begin(k->pins, sample);
        r = run_board(k);
    }
    if (r == GOT_IT && !first) {
        r = lockstep_lines(k, (double)k->time_ms / 1000.0);
    }
    pins_side_go_on(k->pins);
    if (k->rest != NULL) {
        rest_side_listen(k->rest);
        rest_side_sample(k->rest, sample);
    }
    if (r == GOT_IT) {
        r = run_board(k);
    }
    if (r == GOT_IT && !pins_side_end(k->pins, &k->link->command)) {
        r = lockstep_stop(k, "the board is gone");
    }
    if (k->rest != NULL) {
        rest_side_command(k->rest, &k->link->command);
    }
    return r;
}

/* Sends the sample and waits until it is answered in full, through restarts if need be. */
static enum outcome exchange(struct lockstep *k, const struct link_sample *sample)
{
    (void)link_server_sample(k->link, sample);
    for (;;) {
        enum outcome r = lockstep_wait(k, answered, k->timeout_ms);
        if (r == TOO_LATE) {
            return lockstep_late(k, "COMMAND for the sample");
        }
        if (r == GOT_IT && k->console != NULL) {
            r = lockstep_wait(k, row_here, k->timeout_ms);
            if (r == TOO_LATE) {
                char what[64];
                (void)snprintf(what, sizeof(what), "telemetry row of sample %u", k->number);
                return lockstep_late(k, what);
            }
        }
        if (r != REGREETED) {
            return r;
        }
        bool restarted = false;
        r = lockstep_recover(k, &restarted);
        if (r != GOT_IT) {
            return r;
        }
        if (restarted) {
            k->link->answered = false; /* what was answered before the restart is void */
            k->link->waiting = true;
        }
        if (!k->link->answered) {
            (void)link_server_resend(k->link);
        }
    }
}

static double pace_left(const struct lockstep *k)
{
    return k->pace_began + (double)k->time_ms / 1000.0 / k->speed - pace_clock_s(k);
}

static bool pace_reached(const struct lockstep *k)
{
    return pace_left(k) <= 0.0;
}

/* With --speed X: until the clock has come to this plant time. */
static enum outcome pace(struct lockstep *k)
{
    while (k->speed > 0.0 && !pace_reached(k)) {
        enum outcome r =
            lockstep_wait(k, pace_reached, (uint64_t)fmax(ceil(pace_left(k) * 1000.0), 1.0));
        bool restarted;
        if (r == REGREETED) {
            r = lockstep_recover(k, &restarted);
        }
        if (r == STOPPED) {
            return r;
        }
    }
    return GOT_IT;
}

/* Steps 1 to 4 at the present plant time. */
static enum outcome one_sample(struct lockstep *k)
{
    double time_s = (double)k->time_ms / 1000.0;
    if (k->console != NULL) {
        k->console->plant_time_s = time_s;
    }
    if (!events_apply(k->events, time_s, k->plant, k->instruments, k->error, sizeof(k->error))) {
        return STOPPED;
    }
    enum outcome r = k->pins != NULL ? GOT_IT : lockstep_lines(k, time_s);
    if (r != GOT_IT) {
        return r;
    }
    struct link_sample sample = {.number = k->number, .time_ms = k->time_ms};
    instruments_measure(k->instruments, k->plant, (double)k->tick_ms / 1000.0, &sample);
    r = k->pins != NULL ? pass_tick(k, &sample) : exchange(k, &sample);
    if (r != GOT_IT) {
        return r;
    }
    k->samples++;
    sim_log_row(k->log, k->instruments, k->plant, &sample, &k->link->command);
    progress_show(k->progress, time_s, k->samples);
    return GOT_IT;
}

/* Step 5. */
static enum outcome one_tick(struct lockstep *k)
{
    double tick_s = (double)k->tick_ms / 1000.0;
    instruments_command(k->instruments, &k->link->command);
    if (!instruments_drive(k->instruments, k->plant, tick_s, k->error, sizeof(k->error))) {
        return STOPPED;
    }
    k->number++;
    k->time_ms += k->tick_ms;
    if (!k->class->advance(k->plant, (double)k->time_ms / 1000.0, k->error, sizeof(k->error))) {
        return STOPPED;
    }
    return GOT_IT;
}

static enum outcome greet(struct lockstep *k)
{
    enum outcome r;
    do {
        bool restarted;
        r = meet(k, &restarted);
        if (r == GOT_IT && k->console != NULL) {
            r = lockstep_start_console(k);
        }
    } while (r == REGREETED);
    k->wall_began = sim_clock_s();
    begin_pace(k);
    return r;
}

static enum lockstep_result result_of(struct lockstep *k, enum outcome r)
{
    if (r == GOT_IT) {
        return RUN_DONE;
    }
    if (k->error[0] == '\0' && *k->interrupted == 0) {
        (void)sim_fail(k->error, sizeof(k->error), "the controller kept restarting");
    }
    return k->error[0] == '\0' ? RUN_INTERRUPTED : RUN_FAILED;
}

enum lockstep_result lockstep_run(struct lockstep *k)
{
    enum outcome r = greet(k);
    while (r == GOT_IT) {
        r = one_sample(k);
        uint64_t next_ms = k->time_ms + k->tick_ms;
        if (r == GOT_IT && k->ended) {
            break;
        }
        if (r == GOT_IT && k->duration_s >= 0.0 && (double)next_ms / 1000.0 > k->duration_s) {
            break;
        }
        if (r == GOT_IT) {
            r = one_tick(k);
        }
        if (r == GOT_IT) {
            r = pace(k);
        }
    }
    k->wall_s = sim_clock_s() - k->wall_began;
    return result_of(k, r);
}

enum lockstep_result lockstep_begin(struct lockstep *k)
{
    return result_of(k, greet(k));
}

enum lockstep_result lockstep_line(struct lockstep *k, const char *text)
{
    struct script_line x = {.kind = SCRIPT_SEND, .may_fail = true, .line = 1};
    if (k->console == NULL || strlen(text) >= sizeof(x.text)) {
        (void)sim_fail(k->error, sizeof(k->error),
                       k->console == NULL ? "there is no console"
                                          : "a console line has more than %d bytes",
                       SCRIPT_LINE_SIZE - 1);
        return RUN_FAILED;
    }
    (void)snprintf(x.text, sizeof(x.text), "%s", text);
    k->console->plant_time_s = (double)k->time_ms / 1000.0;
    return result_of(k, lockstep_one_line(k, &x));
}

enum lockstep_result lockstep_step(struct lockstep *k)
{
    enum outcome r = one_sample(k);
    return result_of(k, r == GOT_IT ? one_tick(k) : r);
}
