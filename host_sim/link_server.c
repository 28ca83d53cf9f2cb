#include "link_server.h"

#include <stdio.h>
#include <string.h>

#include "bench/text.h"

static bool add_page(struct link_server *s, const struct plant_class *class,
                     const struct plant_channel *c, char *err, size_t err_size)
{
    bool manipulated = c->kind == PLANT_MV;
    uint8_t *count = manipulated ? &s->hello.n_outputs : &s->hello.n_measurements;
    uint8_t index = (uint8_t)(s->hello.n_measurements + s->hello.n_outputs);
    if (*count == LINK_CHANNELS_MAX || strlen(c->name) >= CHANNEL_NAME_SIZE ||
        strlen(c->unit) >= CHANNEL_UNIT_SIZE || !(c->lo < c->hi)) {
        return sim_fail(err, err_size,
                        "plant %s, channel %s: the link carries %d channels of a kind, names of %d "
                        "and units of %d characters, and lo must be below hi",
                        class->name, c->name, LINK_CHANNELS_MAX, CHANNEL_NAME_SIZE - 1,
                        CHANNEL_UNIT_SIZE - 1);
    }
    struct link_page *page = &s->page[index];
    *page = (struct link_page){.index = index,
                               .manipulated = manipulated,
                               .lo = (float)c->lo,
                               .hi = (float)c->hi,
                               .safe = manipulated ? (float)c->safe : 0.0f};
    (void)snprintf(page->name, sizeof(page->name), "%s", c->name);
    (void)snprintf(page->unit, sizeof(page->unit), "%s", c->unit);
    *count = (uint8_t)(*count + 1);
    return true;
}

bool link_server_init(struct link_server *s, struct transport *t, const struct plant_class *class,
                      uint32_t tick_ms, uint32_t session, char *err, size_t err_size)
{
    *s = (struct link_server){.transport = t, .state = LINK_GREETING};
    frame_decoder_reset(&s->decoder);
    s->hello = (struct link_hello){
        .version = LINK_VERSION, .role = LINK_ROLE_PLANT, .session = session, .tick_ms = tick_ms};
    (void)snprintf(s->hello.name, sizeof(s->hello.name), "%s", class->name);
    const enum plant_kind kinds[] = {PLANT_MEASUREMENT, PLANT_MV};
    for (size_t k = 0; k < 2; k++) {
        for (size_t i = 0; i < class->n_channels; i++) {
            if (class->channels[i].kind == kinds[k] &&
                !add_page(s, class, &class->channels[i], err, err_size)) {
                return false;
            }
        }
    }
    s->last_heard = transport_now_ms(t);
    return true;
}

static void send_frame(struct link_server *s, struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = s->sequence;
    s->sequence++;
    size_t n = frame_encode(f, wire);
    (void)transport_write(s->transport, wire,
                          n); /* a vanished peer is seen in link_server_turn() */
    s->count.frames_out++;
    s->last_sent = transport_now_ms(s->transport);
}

static void send_hello(struct link_server *s)
{
    struct frame f;
    pack_hello(&s->hello, &f);
    send_frame(s, &f);
    s->last_hello = s->last_sent;
}

/* The plant goes safe if samples were under way. */
static void greet_again(struct link_server *s, const char *why)
{
    if (s->state == LINK_SAMPLING && s->outputs != NULL) {
        output_log_safe(s->outputs, transport_now_ms(s->transport), why,
                        &s->page[s->hello.n_measurements], s->hello.n_outputs);
    }
    s->state = LINK_GREETING;
    s->held = s->waiting;
    send_hello(s);
}

static void on_hello(struct link_server *s, const struct frame *f)
{
    struct link_hello m;
    enum err e = unpack_hello(f, &m);
    if (e != ERR_OK && e != ERR_VERSION) {
        s->count.unexpected++;
        return;
    }
    if (m.role != LINK_ROLE_CONTROLLER) {
        (void)sim_fail(s->error, sizeof(s->error),
                       "plant link: another plant (\"%s\") speaks at the other end of %s", m.name,
                       s->transport->where);
        return;
    }
    if (e == ERR_VERSION) {
        send_hello(s);
        (void)sim_fail(s->error, sizeof(s->error),
                       "plant link: the other side speaks version %u, this side %u",
                       (unsigned)m.version, (unsigned)LINK_VERSION);
        return;
    }
    s->controller_known = true;
    s->controller_session = m.session;
    (void)memcpy(s->controller_name, m.name, sizeof(m.name));
    greet_again(s, "hello");
}

static void on_page_request(struct link_server *s, const struct frame *f)
{
    struct link_page_request m;
    if (unpack_page_request(f, &m) != ERR_OK ||
        m.index >= s->hello.n_measurements + s->hello.n_outputs) {
        s->count.unexpected++;
        return;
    }
    s->pages_asked = true;
    struct frame answer;
    pack_page(&s->page[m.index], &answer);
    send_frame(s, &answer);
}

static void on_ready(struct link_server *s, const struct frame *f)
{
    struct link_ready m;
    if (unpack_ready(f, &m) != ERR_OK || m.session != s->hello.session) {
        s->count.unexpected++;
        return;
    }
    if (s->state == LINK_GREETING) {
        s->state = LINK_SAMPLING;
        s->greetings++;
        s->introductions += s->pages_asked ? 1u : 0u;
        s->pages_asked = false;
    }
}

static void on_command(struct link_server *s, const struct frame *f)
{
    struct link_command m;
    if (unpack_command(f, &m) != ERR_OK || s->state != LINK_SAMPLING || !s->waiting ||
        m.number != s->sample_number || m.time_ms != s->sample_time_ms ||
        m.n_outputs != s->hello.n_outputs) {
        s->count.unexpected++;
        return;
    }
    s->command = m;
    s->waiting = false;
    s->held = false;
    s->answered = true;
    if (s->outputs != NULL) {
        output_log_command(s->outputs, transport_now_ms(s->transport), &m);
    }
}

static void on_frame(struct link_server *s, const struct frame *f)
{
    s->count.frames_in++;
    s->last_heard = transport_now_ms(s->transport);
    if (s->count.sequence_known) {
        s->count.lost += (uint16_t)(f->sequence - s->count.expected_sequence);
    }
    switch (f->type) {
    case LINK_HELLO:
        s->count.sequence_known = false; /* a restarted controller counts from anew */
        on_hello(s, f);
        break;
    case LINK_PAGE_REQUEST:
        on_page_request(s, f);
        break;
    case LINK_READY:
        on_ready(s, f);
        break;
    case LINK_COMMAND:
        on_command(s, f);
        break;
    case LINK_KEEP_ALIVE:
        break;
    default:
        s->count.unexpected++;
        break;
    }
    s->count.sequence_known = true;
    s->count.expected_sequence = (uint16_t)(f->sequence + 1u);
}

static void do_what_is_due(struct link_server *s)
{
    uint64_t now = transport_now_ms(s->transport);
    if (s->state == LINK_SAMPLING && now - s->last_heard >= LINK_SILENCE_MS) {
        s->silences++;
        greet_again(s, "silence");
    } else if (s->state == LINK_GREETING && now - s->last_hello >= LINK_HELLO_MS) {
        send_hello(s);
    } else if (s->state == LINK_SAMPLING && s->waiting && !s->held &&
               now - s->sample_sent >= LINK_REPEAT_MS) {
        s->count.repeats++;
        (void)link_server_resend(s);
    } else if (now - s->last_sent >= LINK_KEEP_ALIVE_MS) {
        struct frame f;
        pack_keep_alive(&f);
        send_frame(s, &f);
    }
}

bool link_server_turn(struct link_server *s)
{
    uint8_t bytes[1024];
    size_t n = transport_read(s->transport, bytes, sizeof(bytes));
    for (size_t i = 0; i < n; i++) {
        struct frame f;
        if (frame_decode(&s->decoder, bytes[i], &f)) {
            on_frame(s, &f);
        }
    }
    if (!s->transport->gone) {
        do_what_is_due(s);
    }
    if (s->transport->gone && s->error[0] == '\0') {
        (void)sim_fail(s->error, sizeof(s->error), "plant link %.90s: %.60s", s->transport->where,
                       s->transport->reason);
    }
    return s->error[0] == '\0';
}

static uint64_t until(uint64_t now, uint64_t since, uint64_t span)
{
    return now - since >= span ? 0 : span - (now - since);
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

uint64_t link_server_due(struct link_server *s)
{
    uint64_t now = transport_now_ms(s->transport);
    uint64_t due = until(now, s->last_sent, LINK_KEEP_ALIVE_MS);
    if (s->state == LINK_GREETING) {
        return least(due, until(now, s->last_hello, LINK_HELLO_MS));
    }
    due = least(due, until(now, s->last_heard, LINK_SILENCE_MS));
    return s->waiting && !s->held ? least(due, until(now, s->sample_sent, LINK_REPEAT_MS)) : due;
}

bool link_server_resend(struct link_server *s)
{
    send_frame(s, &s->sample);
    s->sample_sent = s->last_sent;
    s->held = false;
    return !s->transport->gone;
}

bool link_server_sample(struct link_server *s, const struct link_sample *sample)
{
    pack_sample(sample, &s->sample);
    s->sample_number = sample->number;
    s->sample_time_ms = sample->time_ms;
    s->waiting = true;
    s->answered = false;
    /* While greeting it goes out later, by link_server_resend(). */
    s->held = s->state != LINK_SAMPLING;
    return s->held || link_server_resend(s);
}
