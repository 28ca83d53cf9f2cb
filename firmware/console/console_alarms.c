/* Console commands on what is wrong: alarm, alarm ack, alarm shelve. */
#include <string.h>

#include "console/console.h"
#include "exchange/alarm_names.h"
#include "hal/tick.h"
#include "supervise/alarms.h"

static void entry_line(const struct service *s, uint8_t i, struct text *line)
{
    static const char *const priorities[] = {"low", "medium", "high"};
    const struct config *config = &service_in_force(s)->config;
    const struct alarm_config *c = &config->alarm[i];
    const struct alarm_state *a = &s->supervisor->alarm[i];
    char name[CHANNEL_NAME_SIZE];
    if (i >= s->supervisor->placed[PLACED_ALARMS] ||
        !(a->listed || a->first || a->shelved_until_ms))
        return;
    alarm_name(config, i, name);
    text_str(line, a->shelved_until_ms ? "SHELVED " : a->condition ? "ALARM_ON " : "ALARM_OFF ");
    text_str(line, name);
    text_str(line, " alarm");
    text_u32(line, i + 1u);
    text_char(line, ' ');
    text_str(line, priorities[c->priority]);
    if (a->shelved_until_ms) {
        text_str(line, " until ");
        text_seconds(line, a->shelved_until_ms);
        return;
    }
    text_str(line, a->acknowledged || !a->listed ? " acknowledged" : " unacknowledged");
    if (a->first)
        text_str(line, " first of its group");
}

/* What is wrong now, a line each: link, measurements, outputs, interlocks, limits. */
static bool alarm_line(struct console *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct supervisor *sup = s->supervisor;
    const struct plan *plan = service_in_force(s);
    if (n == 0) {
        if (s->link->refused) {
            text_str(line, "PLANT_REFUSED ");
            text_str(line, s->link->name[0] ? s->link->name : "-");
            text_char(line, ' ');
            text_str(line, plant_fault_text((uint8_t)s->link->refused));
        } else if (s->io.state(s->io.context) != IO_READY) {
            text_str(line, "LINK_DOWN no plant is connected");
        } else if (sup->state == SUPERVISOR_SAFE && sup->safe_reason[0]) {
            text_str(line, "SAFE_STATE loops in manual, outputs at safe values since: ");
            hal_tick_lock(); /* the tick may be about to say another */
            text_str(line, sup->safe_reason);
            hal_tick_unlock();
        }
        return true;
    }
    if (n == 1) {
        if (s->samples.stalled)
            text_str(line, "SAMPLE_STALLED samples come, but plant time does not move on");
        return true;
    }
    n -= 2;
    if (n < CHANNEL_MAX) {
        if (n < sup->placed[PLACED_MEASUREMENTS] && sup->measurement[n].alarm) {
            text_str(line, "MEASUREMENT_BAD ");
            text_str(line, plan->config.measurement[n].name);
            text_char(line, ' ');
            text_str(line, sup->measurement[n].bound
                               ? measurement_fault_text(sup->measurement[n].fault)
                               : "not announced by the plant");
        }
#if CONFIG_LOOP_GUARD
        if (n < sup->placed[PLACED_MEASUREMENTS] && sup->measurement[n].doubt.lasting.active) {
            text_str(line, "DOUBTFUL ");
            text_str(line, plan->config.measurement[n].name);
            text_str(line, " is uncertain and a loop acts on it");
        }
#endif
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CHANNEL_MAX) {
        if (n < sup->placed[PLACED_MVS] && sup->mv[n].alarm) {
            text_str(line, "NOT_FOLLOWING ");
            text_str(line, plan->config.mv[n].name);
        }
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CONFIG_INTERLOCKS) {
        if (n < sup->placed[PLACED_INTERLOCKS] && sup->interlock[n].active) {
            text_str(line, "INTERLOCK_ON lock");
            text_u32(line, n + 1u);
            text_str(line, " holds ");
            text_str(line, plan->config.interlock[n].mv);
        }
        return true;
    }
    n -= CONFIG_INTERLOCKS;
#if CONFIG_LOOP_GUARD
    if (n < CONFIG_LOOPS) {
        if (n < sup->placed[PLACED_LOOPS] && sup->loop[n].deviation.lasting.active) {
            text_str(line, "DEVIATION ");
            text_str(line, plan->config.loop[n].name);
            text_str(line, " is far from its setpoint");
        }
        return true;
    }
    n -= CONFIG_LOOPS;
#endif
#if CONFIG_BLOCKS
    if (n < CONFIG_BLOCKS * (BLOCK_EVENTS_MAX + 1u)) {
        block_alarm_line(c, (uint8_t)(n / (BLOCK_EVENTS_MAX + 1u)), n % (BLOCK_EVENTS_MAX + 1u),
                         line);
        return true;
    }
    n -= CONFIG_BLOCKS * (BLOCK_EVENTS_MAX + 1u);
#endif
#if CONFIG_STEPS
    if (n == 0) {
        if (sup->sequence.state == SEQUENCE_HELD ||
            (sup->sequence.state == SEQUENCE_ABORTED && sup->state == SUPERVISOR_SAFE)) {
            text_str(line, "SEQUENCE ");
            sequence_headline(s, line);
        }
        return true;
    }
    n -= 1;
#endif
    if (n >= CONFIG_ALARMS)
        return false;
    entry_line(s, (uint8_t)n, line);
    return true;
}

#define WANTED "wanted: alarm, alarm ack ALARM|all, or alarm shelve ALARM SECONDS"

void command_alarm(struct console *c, unsigned n, char **word)
{
    struct answer a;
    float seconds = 0.0f;
    if (n == 0) {
        console_list(c, alarm_line, "");
        return;
    }
    bool ack = strcmp(word[0], "ack") == 0;
    if (n != (ack ? 2u : 3u) || !(ack || strcmp(word[0], "shelve") == 0)) {
        console_err_about(c, ERR_PARSE, word[0], WANTED);
        return;
    }
    if (ack) {
        const char *name = strcmp(word[1], "all") == 0 ? NULL : word[1];
        console_answer(c, operate_acknowledge(&c->session, name, &a), &a);
        return;
    }
    enum err number = text_parse_float(word[2], &seconds);
    if (number)
        seconds = -1.0f;
    enum err err = operate_shelve(&c->session, word[1], seconds, &a);
    if (err == ERR_RANGE) {
        a.subject = word[2];
        err = number ? number : err;
    }
    console_answer(c, err, &a);
}
