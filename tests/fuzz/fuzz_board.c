#include "fuzz_board.h"

#include <string.h>

#include "base/crc32.h"
#include "exchange/block_settings.h"
#include "exchange/tables.h"
#include "memory_port.h"
#include "plan/plan_build.h"
#include "settings/parameters.h"

#define REMEMBERED 256
#define LINE_SIZE  4096

static struct {
    uint64_t clock_ms;
    uint16_t sequence;
    uint32_t number;
    uint64_t time_ms;
    uint8_t readings[5 * 6];
    float drive[2], level[2]; /* of the plant that answers: reflux and heat, T1 and T10 */
    struct frame_decoder from_firmware, from_plant;
    struct {
        uint32_t number;
        uint64_t time_ms;
    } sample[REMEMBERED]; /* good ones on the line, the newest last written */
    uint32_t n_samples;
    uint8_t announced; /* outputs in the last HELLO on the line */
    bool greeted_otherwise;

    char line[LINE_SIZE];
    size_t n_line;
    unsigned replies, refusals;
    uint32_t settings; /* checksum of lines that show settings */
    bool no_room;      /* one of them shows a block of a kind that is known, as a remark */
    bool unended;      /* people's mode, or a restart: lines mean nothing */

    struct config *reading_back;
} b;

static const char *const names[6] = {"T1", "T10", "feed", "extra", "reflux", "heat"};
static const char *const units[6] = {"degC", "degC", "l/h", "-", "l/h", "kW"};

static void plant_hello(void)
{
    struct link_hello m = {.version = LINK_VERSION,
                           .role = LINK_ROLE_PLANT,
                           .session = 77,
                           .n_measurements = 4,
                           .n_outputs = 2,
                           .tick_ms = 1000,
                           .name = "fuzzed"};
    struct frame f;
    pack_hello(&m, &f);
    fuzz_frame(&f);
}

static void plant_page(uint8_t index)
{
    struct link_page m = {.index = index, .manipulated = index >= 4, .lo = 0, .hi = 200};
    struct frame f;
    if (index >= 6)
        return;
    memcpy(m.name, names[index], strlen(names[index]));
    memcpy(m.unit, units[index], strlen(units[index]));
    m.safe = index == 4 ? 1.0f : 0.0f;
    pack_page(&m, &f);
    fuzz_frame(&f);
}

/* Listens to the line towards the firmware, whoever puts bytes there. */
static void overhear(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct frame f;
        struct link_sample sample;
        if (!frame_decode(&b.from_plant, bytes[i], &f))
            continue;
        if (f.type == LINK_SAMPLE && unpack_sample(&f, &sample) == ERR_OK) {
            b.sample[b.n_samples % REMEMBERED].number = sample.number;
            b.sample[b.n_samples % REMEMBERED].time_ms = sample.time_ms;
            b.n_samples++;
        }
    }
}

static void command_answers_a_sample(const struct link_command *m)
{
    for (uint32_t k = 0; k < REMEMBERED && k < b.n_samples; k++)
        if (b.sample[k].number == m->number && b.sample[k].time_ms == m->time_ms)
            return;
    bool answers_a_sample_that_was_sent = false;
    DEMAND(answers_a_sample_that_was_sent);
}

static void plant_hears(const struct frame *f)
{
    struct link_hello hello;
    struct link_page_request page;
    struct link_ready ready;
    struct link_command command;
    switch (f->type) {
    case LINK_HELLO:
        DEMAND(unpack_hello(f, &hello) == ERR_OK && hello.role == LINK_ROLE_CONTROLLER);
        plant_hello();
        break;
    case LINK_PAGE_REQUEST:
        DEMAND(unpack_page_request(f, &page) == ERR_OK);
        plant_page(page.index);
        break;
    case LINK_READY:
        DEMAND(unpack_ready(f, &ready) == ERR_OK);
        break;
    case LINK_COMMAND:
        DEMAND(unpack_command(f, &command) == ERR_OK);
        command_answers_a_sample(&command);
        for (unsigned i = 0; i < 2 && i < command.n_outputs; i++)
            b.drive[i] = command.output[i].value;
        break;
    default:
        DEMAND(f->type == LINK_KEEP_ALIVE);
    }
}

/* The board has two configurations, and places for their tables. The one that is read back here is a third. */
static bool no_place_for_a_table(const char *name)
{
#if CONFIG_BLOCKS
    size_t n = strlen(name);
    return n > 5 && strcmp(name + n - 5, ".kind") == 0 && tables_free_for(b.reading_back) == 0;
#else
    (void)name;
    return false;
#endif
}

static void check_setting(char *line)
{
    struct parameter p;
    char *name = line + 4, *value = strchr(name, ' ');
    DEMAND(value != NULL);
    *value++ = '\0';
    DEMAND(parameter_find_in(b.reading_back, name, &p) == ERR_OK);
    enum err refused = parameter_set(&p, b.reading_back, value);
    if (refused != ERR_OK && no_place_for_a_table(name))
        b.reading_back = NULL;
    else
        DEMAND(refused == ERR_OK);
}

static void line_said(void)
{
    b.line[b.n_line] = '\0';
    b.n_line = 0;
    size_t n = strlen(b.line);
    if (strncmp(b.line, "set ", 4) == 0 || strncmp(b.line, "# set ", 6) == 0)
        b.settings = crc32_update(b.settings, b.line, n + 1);
    const char *kind = strstr(b.line, ".kind ");
    if (strncmp(b.line, "# set block", 11) == 0 && kind)
        b.no_room = b.no_room || block_kind_find(kind + 6) != PLAN_NONE;
    b.refusals += strncmp(b.line, "err ", 4) == 0;
    if (strcmp(b.line, "ok") == 0 || strncmp(b.line, "err ", 4) == 0)
        b.replies++;
    else if (b.reading_back && strncmp(b.line, "set ", 4) == 0)
        check_setting(b.line);
}

static void said(const char *text, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        if (text[i] == '\n') {
            line_said();
            continue;
        }
        if (b.n_line == LINE_SIZE - 1)
            b.n_line = 0; /* echo for people, who get no end of line */
        b.line[b.n_line++] = text[i];
    }
}

static void run(void)
{
    for (unsigned round = 0;; round++) {
        char bytes[2048];
        bool any = false;
        size_t n;
        DEMAND(round < 2000); /* comes to rest */
        memory_port_run();
        while ((n = memory_port_take(HAL_UART_CONSOLE, bytes, sizeof bytes)) != 0) {
            said(bytes, n);
            any = true;
        }
        while ((n = memory_port_take(HAL_UART_LINK, bytes, sizeof bytes)) != 0) {
            any = true;
            for (size_t i = 0; i < n; i++) {
                struct frame f;
                if (frame_decode(&b.from_firmware, (uint8_t)bytes[i], &f))
                    plant_hears(&f);
            }
        }
        if (!any)
            break;
    }
    /* Every frame that the firmware puts on a perfect line is whole. */
    DEMAND(b.from_firmware.count.bad_crc == 0 && b.from_firmware.count.malformed == 0);
    DEMAND(b.from_firmware.count.overlong == 0);
}

void fuzz_type(const void *text, size_t n)
{
    for (const char *at = text; n;) {
        size_t part = n < 1024 ? n : 1024;
        (void)memory_port_give(HAL_UART_CONSOLE, at, part);
        run();
        at += part;
        n -= part;
    }
}

void fuzz_link(const void *bytes, size_t n)
{
    overhear(bytes, n);
    DEMAND(memory_port_give(HAL_UART_LINK, bytes, n) == n);
    run();
}

void fuzz_frame(struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = b.sequence++;
    size_t n = frame_encode(f, wire);
    DEMAND(n != 0);
    overhear(wire, n);
    DEMAND(memory_port_give(HAL_UART_LINK, wire, n) == n);
}

void fuzz_sample(struct feed *f, bool again)
{
    static const float tenth[4] = {10, 10, 1, 1};
    struct link_sample m = {.n_measurements = 4, .n_readback = 2};
    struct frame frame;
    if (!again) {
        b.number++;
        b.time_ms += 1000;
        size_t n = 6;
        const uint8_t *bytes = feed_bytes(f, &n);
        memset(b.readings, 100, sizeof b.readings);
        if (n)
            memcpy(b.readings, bytes, n);
    }
    m.number = b.number;
    m.time_ms = b.time_ms;
    for (unsigned i = 0; i < 4; i++) {
        m.measurement[i].value = (float)b.readings[i] * tenth[i] / 10.0f;
        m.measurement[i].quality = b.readings[i] >= 252 ? b.readings[i] & 3u : QUALITY_GOOD;
    }
    for (unsigned i = 0; i < 2; i++)
        m.readback[i].value = (float)b.readings[4 + i] / 50.0f;
    pack_sample(&m, &frame);
    fuzz_frame(&frame);
    run();
}

/* At 100 and 110 degC with reflux 4 l/h and heat 1 kW, within seconds. */
static void answer_to_the_outputs(void)
{
    float reflux = b.drive[0] - 4.0f, heat = b.drive[1] - 1.0f;
    float rest[2] = {100.0f + 5.0f * heat - 2.0f * reflux, 110.0f + 20.0f * heat - reflux};
    for (unsigned i = 0; i < 2; i++) {
        b.level[i] += 0.3f * (rest[i] - b.level[i]);
        DEMAND(b.level[i] > -1e9f && b.level[i] < 1e9f); /* commands are numbers */
    }
}

void fuzz_stretch(unsigned n)
{
    struct link_sample m = {.n_measurements = 4, .n_readback = 2};
    struct frame frame;
    while (n--) {
        answer_to_the_outputs();
        m.number = ++b.number;
        m.time_ms = b.time_ms += 1000;
        for (unsigned i = 0; i < 4; i++)
            m.measurement[i].value = i < 2 ? b.level[i] : 5.0f;
        for (unsigned i = 0; i < 2; i++)
            m.readback[i].value = b.drive[i];
        pack_sample(&m, &frame);
        fuzz_frame(&frame);
        run();
    }
}

void fuzz_pass(uint64_t ms)
{
    b.clock_ms += ms;
    memory_port_set_clock(b.clock_ms);
    run();
}

unsigned fuzz_reboots(void)
{
    return memory_port_reboots();
}

unsigned fuzz_replies(void)
{
    unsigned n = b.replies;
    b.replies = 0;
    return n;
}

unsigned fuzz_refusals(void)
{
    unsigned n = b.refusals;
    b.refusals = 0;
    return n;
}

uint32_t fuzz_settings(void)
{
    static const char dump[] = "dump\n";
    b.settings = 0;
    b.no_room = false;
    fuzz_type(dump, sizeof dump - 1);
    return b.settings;
}

bool fuzz_had_no_room(void)
{
    return b.no_room;
}

static void type_line(const char *text)
{
    fuzz_type(text, strlen(text));
}

void fuzz_settings_are_sound(void)
{
    static struct config config;
    static struct plan plan;
    struct config_fault fault;
    type_line("\x15\n\x15mode machine\n");
    (void)fuzz_replies();
    parameters_defaults(&config);
    b.reading_back = &config;
    type_line("diff defaults\n");
    DEMAND(fuzz_replies() == 1);
    type_line("abandon\n"); /* where there is nothing to abandon, it says so */
    DEMAND(fuzz_replies() == 1);
    parameters_defaults(&config);
    b.reading_back = &config;
    type_line("diff defaults\n");
    DEMAND(fuzz_replies() == 1);
    if (b.reading_back != NULL) /* read back whole */
        DEMAND(plan_build(&plan, &config, 0.0f, &fault) == ERR_OK);
    b.reading_back = NULL;
}

bool fuzz_is_chosen(const uint8_t *data, size_t size)
{
    return crc32_update(0, data, size) % 8 == 0;
}

static const char configuration[] =
    "begin\nset meas1.name T1\nset meas1.unit degC\nset meas1.lo 60\nset meas1.hi 160\n"
    "set meas2.name T10\nset meas2.unit degC\nset meas2.lo 60\nset meas2.hi 160\n"
    "set mv1.name reflux\nset mv1.unit l/h\nset mv1.hi 10\nset mv1.max 10\n"
    "set mv2.name heat\nset mv2.unit kW\nset mv2.hi 2\nset mv2.max 2\nset mv2.safe 0.5\n"
    "set loop1.name top\nset loop1.pv T1\nset loop1.out reflux\nset loop1.action direct\n"
    "set loop1.ti 200\nset loop2.name bottom\nset loop2.pv T10\nset loop2.out heat\n"
    "set loop2.gain 1.5\nset loop2.ti 300\napply\n";

void fuzz_power_on(void)
{
    memset(&b, 0, sizeof b);
    frame_decoder_reset(&b.from_firmware);
    frame_decoder_reset(&b.from_plant);
    b.level[0] = 100.0f;
    b.level[1] = 110.0f;
    memory_port_start();
    run();
    type_line("mode machine\n");
}

void fuzz_start(bool loops)
{
    struct feed nothing = {(const uint8_t *)"", 0};
    memory_port_erase_all();
    fuzz_power_on();
    if (!loops) {
        (void)fuzz_replies();
        return;
    }
    type_line(configuration);
    DEMAND(fuzz_replies() == 30);
    fuzz_pass(300); /* hello, pages, ready */
    fuzz_sample(&nothing, false);
    fuzz_sample(&nothing, false);
}
