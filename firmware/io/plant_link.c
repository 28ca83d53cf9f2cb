#include "io/plant_link.h"

#include <string.h>

#include "base/assertion.h"
#include "base/crc32.h"
#include "base/elapsed.h"
#include "hal/clock.h"
#include "hal/identity.h"
#include "hal/uart.h"

/* Requests for a page after which the link reports it as missing. They take as long as LINK_SILENCE_MS. */
#define ASKS_TOLD (1 + LINK_SILENCE_MS / LINK_HELLO_MS)
/* Shortest board time between two reported refusals, because a line may bring any number of plants a second. */
#define TOLD_APART_MS 1000u

_Static_assert(LINK_CHANNELS_ROOM <= IO_CHANNELS_MAX, "the largest sample has room in hal/io.h");

void plant_link_init(struct plant_link *link, struct event_queue *events,
                     const uint64_t *plant_time)
{
    memset(link, 0, sizeof *link);
    frame_decoder_reset(&link->decoder);
    link->session = hal_boot_id();
    link->events = events;
    link->plant_time = plant_time;
    link->state = IO_DOWN;
}

static bool send(struct plant_link *link, struct frame *f, uint64_t now_ms)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = link->sequence;
    size_t n = frame_encode(f, wire);
    if (!hal_uart_write(HAL_UART_LINK, wire, n)) {
        link->stats.congested++;
        return false;
    }
    link->sequence++;
    link->sent_ms = now_ms;
    (void)hal_uart_pump(HAL_UART_LINK);
    return true;
}

static void send_hello(struct plant_link *link, uint64_t now_ms)
{
    struct link_hello m = {
        .version = LINK_VERSION, .role = LINK_ROLE_CONTROLLER, .session = link->session};
    struct frame f;
    strncpy(m.name, hal_board_name(), sizeof m.name - 1);
    pack_hello(&m, &f);
    if (send(link, &f, now_ms))
        link->asked_ms = now_ms;
}

static void tell_refused(struct plant_link *link, enum plant_fault fault, float value)
{
    event_put(link->events, *link->plant_time, EVENT_PLANT_REFUSED, link->name, value,
              (uint8_t)fault);
}

static void send_page_request(struct plant_link *link, uint64_t now_ms)
{
    struct link_page_request m = {.index = link->next_page};
    struct frame f;
    pack_page_request(&m, &f);
    if (!send(link, &f, now_ms))
        return;
    link->asked_ms = now_ms;
    if (link->asks < ASKS_TOLD && ++link->asks == ASKS_TOLD)
        tell_refused(link, PLANT_NO_PAGE, (float)link->next_page);
}

static void send_ready(struct plant_link *link, uint64_t now_ms)
{
    struct link_ready m = {.session = link->plant_session};
    struct frame f;
    pack_ready(&m, &f);
    (void)send(link, &f, now_ms);
}

static unsigned pages(const struct plant_link *link)
{
    return (unsigned)link->count[0] + link->count[1];
}

static void ask_or_finish(struct plant_link *link, uint64_t now_ms)
{
    if (link->next_page < pages(link)) {
        send_page_request(link, now_ms);
        return;
    }
    send_ready(link, now_ms);
    link->state = IO_READY;
    link->generation++;
    event_put(link->events, *link->plant_time, EVENT_LINK_UP, link->name,
              (float)link->tick_ms / 1000.0f, 0);
}

/* Reports another protocol version once. keep_time() answers at the pace of greeting, because two sides that answer at once would
 * never end. */
static void other_version(struct plant_link *link, uint8_t version)
{
    if (!link->version_told)
        event_put(link->events, *link->plant_time, EVENT_LINK_VERSION, NULL, (float)version, 0);
    link->version_told = true;
    if (link->state != IO_DOWN) {
        link->state = IO_DOWN;
        link->generation++;
    }
}

void plant_link_refuse(struct plant_link *link, enum plant_fault fault, float value,
                       uint64_t now_ms)
{
    link->refused = fault;
    link->state = IO_DOWN;
    link->generation++;
    if (link->refusal_reported && (uint32_t)now_ms - link->told_ms < TOLD_APART_MS) {
        link->hello = 0; /* its next HELLO is judged again, and reported when the time has passed */
        return;
    }
    link->refusal_reported = true;
    link->told_ms = (uint32_t)now_ms;
    tell_refused(link, fault, value);
}

void plant_link_judge_anew(struct plant_link *link)
{
    if (link->refused == PLANT_FINE)
        return;
    link->refused = PLANT_FINE;
    link->count[0] = link->count[1] = 0;
}

/* Keeps the announcement of a HELLO. *m is all zero where the HELLO could not be read. */
static void meet_plant(struct plant_link *link, const struct link_hello *m)
{
    if (link->state == IO_READY)
        link->generation++; /* another plant has come: the bindings are void */
    link->state = IO_GREETING;
    link->version_told = link->role_told = link->odd = link->odd_told = false;
    link->refused = PLANT_FINE;
    link->plant_session = m->session;
    link->count[0] = m->n_measurements;
    link->count[1] = m->n_outputs;
    link->tick_ms = m->tick_ms;
    memcpy(link->name, m->name, sizeof link->name);
    link->next_page = link->asks = 0;
    link->text_n = 0;
}

static void on_hello(struct plant_link *link, const struct frame *f, uint64_t now_ms)
{
    struct link_hello m = {0};
    enum err err = unpack_hello(f, &m);
    if (err == ERR_VERSION) {
        other_version(link, m.version);
        return;
    }
    /* The checksum covers the whole announcement. A plant that announces something else is another plant. */
    uint32_t hello = crc32_update(0, f->payload, f->n);
    if (hello == link->hello && link->refused) {
        link->stats.refused++;
        return;
    }
    if (hello == link->hello && link->state == IO_READY) {
        send_ready(link, now_ms); /* our READY was lost */
        return;
    }
    if (hello == link->hello && link->state == IO_GREETING)
        return; /* a page request is on its way */
    link->hello = hello;
    meet_plant(link, &m);
    uint8_t most = m.n_measurements > m.n_outputs ? m.n_measurements : m.n_outputs;
    if (err == ERR_FRAME)
        plant_link_refuse(link, PLANT_HELLO, (float)f->n, now_ms);
    else if (most > LINK_CHANNELS_ROOM)
        plant_link_refuse(link, PLANT_TOO_LARGE, (float)most, now_ms);
    else if (m.tick_ms == 0)
        plant_link_refuse(link, PLANT_NO_TICK, 0.0f, now_ms);
    else
        ask_or_finish(link, now_ms);
}

/* Appends a text with its zero to the others. Where there is no room, only the count rises. */
static void keep_text(struct plant_link *link, const char *text)
{
    size_t n = strlen(text) + 1u;
    if (link->text_n + n <= sizeof link->text)
        memcpy(&link->text[link->text_n], text, n);
    link->text_n = (uint16_t)(link->text_n + n);
}

/* Returns whether an earlier page of the same kind has this name, by which a channel is bound. */
static bool name_taken(const struct plant_link *link, const char *name, bool manipulated)
{
    for (uint8_t k = manipulated ? link->count[0] : 0; k < link->next_page; k++)
        if (strcmp(&link->text[link->text_at[k]], name) == 0)
            return true;
    return false;
}

static enum plant_fault page_fault(const struct plant_link *link, enum err err,
                                   const struct link_page *m, bool manipulated)
{
    if (err == ERR_RANGE || err == ERR_NOT_FINITE)
        return PLANT_SPAN;
    if (err || m->manipulated != manipulated)
        return PLANT_PAGE;
    return name_taken(link, m->name, manipulated) ? PLANT_SAME_NAME : PLANT_FINE;
}

static void on_page(struct plant_link *link, const struct frame *f, uint64_t now_ms)
{
    struct link_page m;
    if (link->state != IO_GREETING)
        return;
    bool manipulated = link->next_page >= link->count[0];
    enum err err = unpack_page(f, &m);
    if (!err && m.index != link->next_page)
        return; /* answer to a repeated request, or to one before the plant greeted anew */
    enum plant_fault fault = page_fault(link, err, &m, manipulated);
    if (fault) {
        link->stats.refused++;
        plant_link_refuse(link, fault, (float)link->next_page, now_ms);
        return;
    }
    link->text_at[link->next_page] = (link_place)link->text_n;
    keep_text(link, m.name);
    /* "-" means no unit, which the configuration has as an empty text. */
    keep_text(link, strcmp(m.unit, "-") == 0 ? "" : m.unit);
    if (manipulated)
        link->safe[link->next_page - link->count[0]] = m.safe;
    plant_spans_keep(&link->spans, link->next_page, m.lo, m.hi);
    link->next_page++;
    link->asks = 0;
    if (link->text_n > sizeof link->text)
        plant_link_refuse(link, PLANT_LONG_TEXT, (float)link->text_n, now_ms);
    else
        ask_or_finish(link, now_ms);
}

/* Drops a sample of the wrong shape. Nobody controls a plant that goes on sending such samples, although it hears our
 * keep-alives. After LINK_SILENCE_MS the link refuses the plant, and our HELLO takes it to its safe values. */
static void odd_sample(struct plant_link *link, const struct frame *f, uint64_t now_ms)
{
    float measurements = f->n > SAMPLE_COUNT_AT ? (float)f->payload[SAMPLE_COUNT_AT] : 0.0f;
    link->stats.refused++;
    if (!link->odd_told)
        event_put(link->events, *link->plant_time, EVENT_SAMPLE_REFUSED, link->name, measurements,
                  0);
    link->odd_told = true;
    if (!link->odd)
        link->odd_ms = (uint32_t)now_ms;
    link->odd = true;
    if ((uint32_t)now_ms - link->odd_ms >= LINK_SILENCE_MS)
        plant_link_refuse(link, PLANT_SHAPE, measurements, now_ms);
}

static bool on_sample(struct plant_link *link, const struct frame *f, uint64_t now_ms,
                      struct io_sample *sample)
{
    struct link_sample m;
    if (link->state != IO_READY)
        return false; /* the plant will hear our HELLO */
    if (unpack_sample(f, &m) != ERR_OK || m.n_measurements != link->count[0] ||
        (m.n_readback != 0 && m.n_readback != link->count[1])) {
        odd_sample(link, f, now_ms);
        return false;
    }
    link->odd = false;
    link->stats.samples++;
    sample->number = m.number;
    sample->time = m.time_ms;
    sample->n_measurements = m.n_measurements;
    sample->n_readback = m.n_readback;
    for (unsigned i = 0; i < m.n_measurements; i++)
        sample->measurement[i] =
            (struct io_reading){m.measurement[i].value, (enum quality)m.measurement[i].quality};
    for (unsigned i = 0; i < m.n_readback; i++)
        sample->readback[i] =
            (struct io_reading){m.readback[i].value, (enum quality)m.readback[i].quality};
    return true;
}

static void keep_alive(struct plant_link *link, uint64_t now_ms)
{
    if (link->state != IO_READY || now_ms - link->sent_ms < LINK_KEEP_ALIVE_MS)
        return;
    struct frame f;
    pack_keep_alive(&f);
    (void)send(link, &f, now_ms);
}

size_t plant_link_keep_alive(struct plant_link *link, uint8_t *wire)
{
    uint8_t whole[FRAME_WIRE_MAX];
    struct frame f;
    if (link->state != IO_READY)
        return 0;
    pack_keep_alive(&f);
    f.sequence = link->sequence++;
    size_t n = frame_encode(&f, whole);
    REFLUX_ASSERT(n == LINK_KEEP_ALIVE_BYTES);
    memcpy(wire, whole, LINK_KEEP_ALIVE_BYTES);
    return n;
}

static void keep_time(struct plant_link *link, uint64_t now_ms)
{
    if (link->state != IO_DOWN && now_ms - link->heard_ms > LINK_SILENCE_MS) {
        link->state = IO_DOWN;
        link->generation++;
        link->stats.silences++;
        event_put(link->events, *link->plant_time, EVENT_LINK_DOWN, link->name,
                  elapsed_ms(now_ms, link->heard_ms) / 1000.0f, 0);
    }
    if (now_ms - link->heard_ms > LINK_SILENCE_MS)
        plant_link_judge_anew(link); /* the plant has gone */
    bool ask_again = now_ms - link->asked_ms >= LINK_HELLO_MS;
    if (link->state == IO_DOWN && (ask_again || link->asked_ms == 0))
        send_hello(link, now_ms);
    else if (link->state == IO_GREETING && ask_again)
        send_page_request(link, now_ms);
    else
        keep_alive(link, now_ms);
}

/* Returns whether a plant may have sent the frame: a HELLO has the role of a plant, and no frame is one that only controllers send. */
static bool from_a_plant(const struct frame *f)
{
    if (f->type == LINK_HELLO)
        return f->n < 2 || f->payload[1] == LINK_ROLE_PLANT;
    return f->type != LINK_PAGE_REQUEST && f->type != LINK_READY && f->type != LINK_COMMAND;
}

static bool on_frame(struct plant_link *link, const struct frame *f, uint64_t now_ms,
                     struct io_sample *sample)
{
    if (!from_a_plant(f)) { /* no sign of life either, because the frame may be our own echo */
        link->stats.refused++;
        if (!link->role_told)
            tell_refused(link, PLANT_ROLE, (float)f->type);
        link->role_told = true;
        return false;
    }
    uint16_t gap = (uint16_t)(f->sequence - link->heard_sequence - 1u);
    if (link->state == IO_READY && gap < 0x8000u)
        link->stats.lost_frames += gap;
    link->heard_sequence = f->sequence;
    link->heard_ms = now_ms;
    switch (f->type) {
    case LINK_HELLO:
        on_hello(link, f, now_ms);
        return false;
    case LINK_PAGE:
        on_page(link, f, now_ms);
        return false;
    case LINK_SAMPLE:
        return on_sample(link, f, now_ms, sample);
    case LINK_KEEP_ALIVE:
        return false;
    default:
        link->stats.refused++;
        return false;
    }
}

static bool poll(void *context, uint64_t now_ms, struct io_sample *sample)
{
    struct plant_link *link = context;
    struct frame f;
    for (;;) { /* ends when the receive ring, which is finite, is empty; a sample returns at once */
        uint32_t begun = hal_cycles();
        bool taken = link->rx_at < link->rx_n, complete = false;
        while (link->rx_at < link->rx_n && !complete) {
            bool delivered;
            size_t size = frame_decode_bytes(&link->decoder, &link->rx[link->rx_at],
                                             (size_t)(link->rx_n - link->rx_at), &f, &delivered);
            link->rx_at = (uint8_t)(link->rx_at + size);
            if (!delivered)
                continue;
            complete = on_frame(link, &f, now_ms, sample);
            if (!complete) { /* this frame is no part of the cost of a sample */
                begun = hal_cycles();
                link->reception = 0;
            }
        }
        if (taken) /* a look that finds no bytes is no reception */
            link->reception += hal_cycles() - begun;
        if (complete) {
            sample->reception = link->reception;
            link->reception = 0;
            return true;
        }
        link->rx_at = 0;
        link->rx_n = (uint8_t)hal_uart_read(HAL_UART_LINK, link->rx, sizeof link->rx);
        if (link->rx_n == 0)
            break;
    }
    keep_time(link, now_ms);
    (void)hal_uart_pump(HAL_UART_LINK);
    return false;
}

static enum io_state state(const void *context)
{
    return ((const struct plant_link *)context)->state;
}

static uint32_t generation(const void *context)
{
    return ((const struct plant_link *)context)->generation;
}

/* Returns the number of announced channels; 0 during the greeting, and for a refused plant. */
static uint8_t port_count(const void *context, bool manipulated)
{
    const struct plant_link *link = context;
    return link->next_page == pages(link) && !link->refused ? link->count[manipulated] : 0;
}

static struct io_channel channel(const void *context, bool manipulated, uint8_t index)
{
    const struct plant_link *link = context;
    unsigned page = index + (manipulated ? link->count[0] : 0u);
    const char *name = &link->text[link->text_at[page]];
    struct io_channel c = {.name = name,
                           .unit = name + strlen(name) + 1,
                           .safe = manipulated ? link->safe[index] : 0.0f};
    plant_spans_give(&link->spans, page, &c.lo, &c.hi);
    return c;
}

static uint32_t tick_ms(const void *context)
{
    return ((const struct plant_link *)context)->tick_ms;
}

static enum err answer_sample(struct plant_link *link, const struct io_command *c, uint8_t first,
                              uint32_t number, plant_time_ms time, uint64_t now_ms)
{
    struct link_command m; /* not cleared, because nobody reads the outputs after n_outputs */
    struct frame f;
    if (link->state != IO_READY)
        return ERR_STATE;
    m.number = number;
    m.time_ms = time;
    m.safe = c->safe;
    m.n_outputs = (uint8_t)(c->n_outputs - first);
    for (unsigned i = 0; i < m.n_outputs; i++) {
        m.output[i].value = c->output[first + i].value;
        m.output[i].drive = c->output[first + i].drive;
    }
    pack_command(&m, &f);
    if (!send(link, &f, now_ms))
        return ERR_FULL;
    link->stats.commands++;
    return ERR_OK;
}

static enum err port_command(void *context, const struct io_command *c, uint64_t now_ms)
{
    return answer_sample(context, c, 0, c->number, c->time, now_ms);
}

#if CONFIG_DEVICES
enum err plant_link_answer(struct plant_link *link, const struct io_command *c, uint8_t first,
                           uint32_t number, plant_time_ms time, uint64_t now_ms)
{
    return answer_sample(link, c, first, number, time, now_ms);
}
#endif

struct io_port plant_link_port(struct plant_link *link)
{
    return (struct io_port){.context = link,
                            .poll = poll,
                            .state = state,
                            .generation = generation,
                            .count = port_count,
                            .channel = channel,
                            .tick_ms = tick_ms,
                            .command = port_command};
}
