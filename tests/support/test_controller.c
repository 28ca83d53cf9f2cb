#include "test_controller.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void test_controller_init(struct test_controller *c, uint32_t session, uint64_t now_ms)
{
    *c = (struct test_controller){.session = session, .now_ms = now_ms, .last_heard = now_ms};
    frame_decoder_reset(&c->decoder);
}

static void send_frame(struct test_controller *c, struct frame *f)
{
    f->sequence = c->sequence;
    c->sequence++;
    bool mute = c->mute_from_tick != 0 && c->ticks >= c->mute_from_tick;
    if (!mute && c->n_link_out + FRAME_WIRE_MAX <= sizeof(c->link_out)) {
        c->n_link_out += (unsigned)frame_encode(f, c->link_out + c->n_link_out);
    }
    c->last_sent = c->now_ms;
}

static void say(struct test_controller *c, const char *format, ...)
{
    va_list list;
    va_start(list, format);
    size_t room = sizeof(c->console_out) - c->n_console_out;
    int n = vsnprintf(c->console_out + c->n_console_out, room, format, list);
    va_end(list);
    if (n > 0 && (size_t)n < room) {
        c->n_console_out += (unsigned)n;
    }
}

static void send_hello(struct test_controller *c)
{
    struct link_hello m = {.version = c->refuse_version ? LINK_VERSION + 1 : LINK_VERSION,
                           .role = LINK_ROLE_CONTROLLER,
                           .session = c->session,
                           .name = "test controller"};
    struct frame f;
    pack_hello(&m, &f);
    send_frame(c, &f);
}

static void request_page(struct test_controller *c)
{
    struct link_page_request m = {.index = c->next_page};
    struct frame f;
    pack_page_request(&m, &f);
    send_frame(c, &f);
    c->last_request = c->now_ms;
}

static void send_ready(struct test_controller *c)
{
    struct link_ready m = {.session = c->plant_session};
    struct frame f;
    pack_ready(&m, &f);
    send_frame(c, &f);
    c->state = TEST_READY;
}

static void on_hello(struct test_controller *c, const struct frame *f)
{
    struct link_hello m;
    if (unpack_hello(f, &m) != ERR_OK || m.role != LINK_ROLE_PLANT) {
        return;
    }
    bool pages_kept = c->next_page != 0 && c->next_page == c->n_measurements + c->n_outputs;
    if (m.session == c->plant_session && pages_kept && c->state != TEST_GREETING) {
        send_ready(c);
    } else if (c->state != TEST_GREETING || m.session != c->plant_session) {
        c->state = TEST_GREETING;
        c->greetings++;
        c->answered = c->answered && m.session == c->plant_session;
        c->plant_session = m.session;
        c->n_measurements = m.n_measurements;
        c->n_outputs = m.n_outputs;
        c->next_page = 0;
        request_page(c);
    }
}

static void on_page(struct test_controller *c, const struct frame *f)
{
    struct link_page m;
    if (unpack_page(f, &m) != ERR_OK || c->state != TEST_GREETING || m.index != c->next_page) {
        return;
    }
    c->page[m.index] = m;
    c->next_page++;
    if (c->next_page == c->n_measurements + c->n_outputs) {
        send_ready(c);
    } else {
        request_page(c);
    }
}

static void send_command(struct test_controller *c)
{
    struct frame f;
    pack_command(&c->last, &f);
    send_frame(c, &f);
}

/* One tick: output i = 40 % of its span less 0.2 % per unit of measurement i. */
static void tick(struct test_controller *c, const struct link_sample *m)
{
    c->ticks++;
    c->last = (struct link_command){
        .number = m->number, .time_ms = m->time_ms, .n_outputs = c->n_outputs};
    for (uint8_t i = 0; i < c->n_outputs; i++) {
        const struct link_page *page = &c->page[c->n_measurements + i];
        float y = i < m->n_measurements ? m->measurement[i].value : 0.0f;
        c->last.output[i].value = page->lo + (page->hi - page->lo) * (0.4f - 0.002f * y);
        c->last.output[i].drive = true;
    }
    c->answered = true;
    if (c->drop_command_every == 0 || c->ticks % c->drop_command_every != 0) {
        send_command(c);
    }
    if (c->log) {
        say(c, "T,1,%" PRIu32 ",%.3f,%.9g\r\n", m->number, (double)m->time_ms / 1000.0,
            (double)m->measurement[0].value);
    }
}

static void on_sample(struct test_controller *c, const struct frame *f)
{
    struct link_sample m;
    if (c->state != TEST_READY || unpack_sample(f, &m) != ERR_OK) {
        return;
    }
    if (c->answered && m.number == c->last.number && m.time_ms == c->last.time_ms) {
        c->duplicates++;
        send_command(c);
    } else {
        tick(c, &m);
    }
}

void test_controller_link(struct test_controller *c, const uint8_t *bytes, unsigned n)
{
    for (unsigned i = 0; i < n; i++) {
        struct frame f;
        if (!frame_decode(&c->decoder, bytes[i], &f)) {
            continue;
        }
        c->last_heard = c->now_ms;
        if (f.type == LINK_HELLO) {
            on_hello(c, &f);
        } else if (f.type == LINK_PAGE) {
            on_page(c, &f);
        } else if (f.type == LINK_SAMPLE) {
            on_sample(c, &f);
        }
    }
}

static void command_line(struct test_controller *c)
{
    const char *line = c->line;
    if (line[0] == '\0') {
        /* nothing was said, nothing is answered */
    } else if (strcmp(line, "mode machine") == 0) {
        c->machine = true;
        say(c, "ok\r\n");
    } else if (strcmp(line, "log on") == 0) {
        c->log = true;
        say(c, "ok\r\nH,format,number,time[s],y[degC]\r\n");
    } else if (strcmp(line, "log off") == 0) {
        c->log = false;
        say(c, "ok\r\n");
    } else if (strcmp(line, "status") == 0) {
        say(c, "state ready\r\n! 3 something happened meanwhile\r\nticks %" PRIu32 "\r\nok\r\n",
            c->ticks);
    } else if (strcmp(line, "reboot") == 0) {
        say(c, "ok\r\n");
        c->reboot_wanted = true;
    } else if (strcmp(line, "sleep") == 0) {
        /* never answered */
    } else {
        say(c, "err UNKNOWN no such command\r\n");
    }
    if (!c->machine) {
        say(c, "> ");
    }
}

void test_controller_console(struct test_controller *c, const char *bytes, unsigned n)
{
    for (unsigned i = 0; i < n; i++) {
        if (!c->machine) {
            say(c, "%c", bytes[i]); /* echo, for people */
        }
        if (bytes[i] == '\n') {
            c->line[c->n_line] = '\0';
            c->n_line = 0;
            command_line(c);
        } else if (bytes[i] != '\r' && c->n_line < sizeof(c->line) - 1) {
            c->line[c->n_line] = bytes[i];
            c->n_line++;
        }
    }
}

void test_controller_turn(struct test_controller *c, uint64_t now_ms)
{
    c->now_ms = now_ms;
    if (c->state != TEST_DOWN && now_ms - c->last_heard >= LINK_SILENCE_MS) {
        c->state = TEST_DOWN;
    }
    if (c->state == TEST_DOWN && (c->sequence == 0 || now_ms - c->last_sent >= LINK_HELLO_MS)) {
        send_hello(c);
    } else if (c->state == TEST_GREETING && now_ms - c->last_request >= LINK_HELLO_MS) {
        request_page(c);
    } else if (now_ms - c->last_sent >= LINK_KEEP_ALIVE_MS) {
        struct frame f;
        pack_keep_alive(&f);
        send_frame(c, &f);
    }
}
