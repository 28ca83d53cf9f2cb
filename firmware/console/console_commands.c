/* Console commands about the board as a whole: version, status, log, events, reboot. */
#include <string.h>

#include "base/assertion.h"
#include "console/access_words.h"
#include "console/analyser_words.h"
#include "console/command_table.h"
#include "console/event_sentence.h"
#include "console/line_editor.h"
#include "console/loop_guard_words.h"
#include "console/next_step.h"
#include "console/phrases.h"
#include "console/sequence_words.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/image.h"
#include "hal/nvm.h"
#include "hal/self_check.h"
#include "storage/storage.h"

static void hex(struct text *line, const char *name, uint32_t value)
{
    put_word(line, name);
    text_char(line, ' ');
    text_hex(line, value, 8);
}

/* Writes what is left of the last fault since power-on. */
static void fault_line(struct text *line)
{
    static const char *const names[] = {"hard", "memory", "bus", "usage"};
    struct hal_fault f;
    if (!hal_last_fault(&f))
        return;
    text_str(line, "last fault: ");
    text_str(line, f.exception >= 3 && f.exception <= 6 ? names[f.exception - 3] : "unexpected");
    text_str(line, f.in_tick ? " in the tick," : " in the main loop,");
    hex(line, "pc", f.pc);
    hex(line, "lr", f.lr);
    hex(line, "cfsr", f.status);
    hex(line, "hfsr", f.hard);
    hex(line, "address", f.address);
    text_named_u32(line, "up_ms", f.up_ms);
    text_named_u32(line, "boots_ago", f.boots_ago);
}

static void image_line(const struct client *c, struct text *line)
{
    static const char *const states[] = {"without a checksum", "whole", "DAMAGED",
                                         "not checked: the RAM FAILED its test"};
    REFLUX_ASSERT((unsigned)c->service->image < sizeof states / sizeof states[0]);
    text_str(line, "image ");
    text_str(line, states[c->service->image]);
    if (!hal_image_bytes())
        return;
    hex(line, "crc", hal_image_crc());
    if (BOARD_CHECKS && hal_ram_failed_at())
        hex(line, "ram_failed_at", hal_ram_failed_at());
    text_named_u32(line, "bytes", hal_image_bytes());
}

static void protection_words(struct text *line)
{
    for (unsigned i = HAL_PROTECTION_WATCHDOG; i <= HAL_PROTECTION_PROGRAM; i++) {
        const char *words = hal_protection_text((enum hal_protection)i);
        if (!words)
            continue;
        text_str(line, "; ");
        text_str(line, words);
    }
}

static bool version_line(struct client *c, unsigned n, struct text *line)
{
    struct hal_nvm_geometry nvm;
    switch (n) {
    case 0:
        text_str(line, "reflux " REFLUX_VERSION " on ");
        text_str(line, hal_board_name());
        text_str(line, ", numbers " NUM_FORMAT ", plant link version ");
        text_u32(line, LINK_VERSION);
        return true;
    case 1:
        text_str(line, hal_board_text());
        return true;
    case 2:
        text_str(line, "clock");
        text_named_u32(line, "Hz", hal_core_hz());
        text_str(line, ", ");
        text_str(line, hal_clock_source());
        return true;
    case 3:
        text_str(line, "limits:");
        text_named_u32(line, "channels", CHANNEL_MAX);
        text_named_u32(line, "loops", CONFIG_LOOPS);
        text_named_u32(line, "feedforwards", CONFIG_FEEDFORWARDS);
        text_named_u32(line, "interlocks", CONFIG_INTERLOCKS);
        text_named_u32(line, "events", EVENT_HISTORY);
        text_named_u32(line, "alarms", CONFIG_ALARMS);
        text_named_u32(line, "arena bytes", PLAN_ARENA_BYTES);
        text_named_u32(line, "steps", CONFIG_STEPS);
        return true;
    case 4:
        text_str(line, "limits: plant");
        text_named_u32(line, "channels", LINK_CHANNELS_ROOM);
        text_named_u32(line, "name bytes", LINK_TEXT_BYTES);
        text_named_u32(line, "requests", REQUEST_QUEUE_SIZE);
        text_named_u32(line, "rows", TELEMETRY_QUEUE_SIZE);
        text_named_u32(line, "line", LINE_EDITOR_MAX);
        text_str(line, LINE_EDITOR_HISTORY > 1 ? ", recalls lines" : ", recalls no lines");
        return true;
    case 5:
        hal_nvm_get_geometry(&nvm);
        text_str(line, c->service->watchdog ? "watchdog runs" : "no watchdog");
        text_str(line, ", flash for storage, bytes: ");
        text_u32(line, nvm.sectors * nvm.sector_size);
        text_str(line, "; supply ");
        text_str(line, hal_supply_text());
        if (BOARD_CHECKS)
            protection_words(line);
        return true;
    case 6:
        image_line(c, line);
        return true;
    case 7:
        text_str(line, "started by: ");
        text_str(line, hal_reset_name(hal_reset_cause()));
        text_named_u32(line, "boot", hal_boot_id());
        if (c->service->early_resets)
            text_named_u32(line, "early_resets", c->service->early_resets);
        return true;
    case 8:
        fault_line(line);
        return true;
    case 9:
        access_words(&c->session, line);
        return true;
    case 10:
        text_str(line, "storage: ");
        storage_text(c->service->storage, line);
        return true;
    case 11:
        if (!CONFIG_STEPS || !COMMISSION_CHANNELS)
            text_str(line, "left out of this build:");
        if (!CONFIG_STEPS)
            text_str(line, " sequences");
        if (!COMMISSION_CHANNELS)
            text_str(line, " automatic-start-up");
        return true;
    default:
        return false;
    }
}

void command_version(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_list(c, version_line, "");
}

/* Returns why a channel is not bound. Settings that have just been applied meet the plant at its next sample. */
static const char *unbound_word(const struct service *s, bool manipulated, const char *name,
                                const char *unit)
{
    if (!CONFIG_PEOPLE || s->io.state(s->io.context) != IO_READY ||
        !service_tick_fits(s, service_in_force(s)))
        return not_announced(s);
    uint8_t index = service_find_announced(s, manipulated, name);
    bool same = index != PLAN_NONE &&
                strcmp(s->io.channel(s->io.context, manipulated, index).unit, unit) == 0;
    return same ? "waits for the plant's next sample" : not_announced(s);
}

/* Writes where the plant is, and whether it is there. */
static void source_words(const struct service *s, struct text *line)
{
    static const char *const link_names[] = {"down", "greeting", "ready"};
    const struct pins_config *pins = &service_in_force(s)->config.pins;
    if (pins_are_source(pins))
        text_str(line, ", plant at the board's pins");
    if (!pins_leave_link(pins))
        return;
    if (!CONFIG_LINK) {
        text_str(line, ", no plant: this board has no plant link, `set io.source board`");
        return;
    }
    text_str(line, ", plant link ");
    text_str(line, link_names[s->link->state]);
    if (s->link->state == IO_READY)
        put_word(line, s->link->name);
}

static bool status_line(struct client *c, unsigned n, struct text *line)
{
    const struct service *s = c->service;
    const struct plan *plan = service_in_force(s);
    if (n == 0) {
        text_str(line, s->supervisor->state == SUPERVISOR_RUN ? "state run" : "state safe");
        source_words(s, line);
        text_str(line, ", plant time ");
        text_seconds(line, s->supervisor->time_ms);
        text_str(line, s->samples.stalled ? " s stands still, base tick " : " s, base tick ");
        text_float(line, plan->tick_s);
        text_str(line, " s");
        text_named_u32(line, "ticks", s->supervisor->ticks);
        if (operate_is_open(&c->session))
            text_str(line, ", transaction open");
        text_str(line, ", storage ");
        text_str(line, storage_word(s->storage));
        if (!operate_is_engineer(&c->session))
            text_str(line, ", console locked");
        return true;
    }
    n -= 1;
    if (n == 0) {
        if (!client_settings(c)->console_key[0])
            access_words(&c->session, line);
        return true;
    }
    n -= 1;
    if (n == 0) {
        if (BOARD_CHECKS && s->image == HAL_IMAGE_RAM_FAILED)
            text_str(line, event_text(EVENT_RAM_FAILED));
        else if (s->image == HAL_IMAGE_DAMAGED)
            text_str(line, event_text(EVENT_IMAGE_DAMAGED)); /* no loop acts */
        else
            by_board_status(s, line);
        return true;
    }
    n -= 1;
    if (n < CHANNEL_MAX) {
        static const char *const qualities[] = {"good", "uncertain", "bad", "missing"};
        const struct measurement_config *m = &plan->config.measurement[n];
        if (!m->name[0])
            return true;
        text_str(line, m->name);
        text_str(line, " = ");
        reply_amount(c, line, span_to_eu(s->supervisor->measurement[n].value, m->lo, m->hi),
                     m->unit);
        put_word(line, s->supervisor->measurement[n].bound
                           ? qualities[s->supervisor->measurement[n].quality]
                           : unbound_word(s, false, m->name, m->unit));
        offset_words(&s->supervisor->measurement[n], m, line);
        sampled_words(s->supervisor, n, m, line);
        return true;
    }
    n -= CHANNEL_MAX;
    if (n < CHANNEL_MAX) {
        const struct mv_config *o = &plan->config.mv[n];
        if (!o->name[0])
            return true;
        text_str(line, o->name);
        text_str(line, " = ");
        float applied = span_to_eu(s->supervisor->mv[n].applied, o->lo, o->hi);
        reply_amount(c, line, applied, o->unit);
        if (s->supervisor->mv[n].interlocked)
            text_str(line, " interlocked");
        else if (s->supervisor->mv[n].beyond && (applied < o->min || applied > o->max))
            text_str(line, " outside its limits, left there by an interlock");
        if (s->supervisor->mv[n].not_following)
            text_str(line, " not following its command");
        if (!s->supervisor->mv[n].bound)
            put_word(line, unbound_word(s, true, o->name, o->unit));
        return true;
    }
    return next_step_line(c, n - CHANNEL_MAX, line);
}

void command_status(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_list(c, status_line, "");
}

void command_log(struct client *c, unsigned n, char **word)
{
    uint32_t every = 1;
    if (n == 1 && strcmp(word[0], "off") == 0) {
        c->service->telemetry.every = 0;
        reply_ok(c);
        return;
    }
    if (strcmp(word[0], "on") != 0) {
        reply_usage(c, word[0], "log");
        return;
    }
    if (n == 2 && (text_parse_u32(word[1], &every) != ERR_OK || every < 1 || every > 1000000)) {
        reply_err_about(c, ERR_RANGE, word[1], "expected ticks between rows, 1 .. 1000000");
        return;
    }
    c->service->telemetry.every = every;
    reply_after_header(c);
}

static bool history_line(struct client *c, unsigned n, struct text *line)
{
    const struct event_log *log = &c->service->history;
    uint32_t sequence = event_log_oldest(log) + n;
    if (sequence >= log->count)
        return false;
    struct event e;
    text_str(line, "  ");
    if (!event_log_get(log, sequence, &e)) {
        text_str(line, "damaged"); /* or a reset came while it was written */
        return true;
    }
    if (e.boot != log->boot) {
        text_str(line, "boot ");
        text_u32(line, hal_boot_id() - (uint16_t)(log->boot - e.boot));
        text_char(line, ' ');
    }
    event_for_client(c, &e, line);
    return true;
}

void command_events(struct client *c, unsigned n, char **word)
{
    (void)n;
    (void)word;
    reply_list(c, history_line, "");
}

void command_reboot(struct client *c, unsigned n, char **word)
{
    struct answer a;
    (void)n;
    (void)word;
    enum err err = operate_reboot(&c->session, &a);
    if (!err)
        reply_then_reboot(c);
    reply_answer(c, err, &a);
}
