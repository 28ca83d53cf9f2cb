/* The worked frames of tests/reference/link-frames.md are what the codec really makes, and really takes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "link/messages.h"
#include "unity.h"

#define DOCUMENT   "reference/link-frames.md" /* ctest runs in tests/ */
#define PAGE       "../docs/inside/plant-link.md"
#define FIELDS_MAX 64

struct field {
    char key[24];
    char text[128];
};

struct worked_frame {
    struct field field[FIELDS_MAX];
    size_t n_fields;
    size_t next; /* fields are taken in the order of the page */
    uint8_t body[FRAME_BODY_MAX];
    size_t n_body;
    uint8_t wire[FRAME_WIRE_MAX];
    size_t n_wire;
};

static struct worked_frame frames[32];
static size_t n_frames;

void setUp(void) {}

void tearDown(void) {}

static void add_bytes(const char *text, uint8_t *bytes, size_t *n, size_t size)
{
    unsigned byte;
    int used;
    while (sscanf(text, " %2x%n", &byte, &used) == 1) {
        TEST_ASSERT_LESS_THAN_size_t(size, *n);
        bytes[*n] = (uint8_t)byte;
        *n += 1;
        text += used;
    }
}

/* Reads every indented block of "key = value" lines that begins with "message". */
static void read_document(void)
{
    FILE *file = fopen(DOCUMENT, "r");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, "cannot open " DOCUMENT);
    char line[512];
    struct worked_frame *w = NULL;
    while (fgets(line, sizeof(line), file) != NULL) {
        struct field f;
        if (sscanf(line, "    %23[a-z_] = %127[^\n]", f.key, f.text) != 2 || line[0] != ' ') {
            w = NULL;
            continue;
        }
        if (strcmp(f.key, "message") == 0) {
            TEST_ASSERT_LESS_THAN_size_t(sizeof(frames) / sizeof(frames[0]), n_frames);
            w = &frames[n_frames];
            n_frames++;
        }
        if (w == NULL) {
            continue;
        }
        if (strcmp(f.key, "body") == 0) {
            add_bytes(f.text, w->body, &w->n_body, sizeof(w->body));
        } else if (strcmp(f.key, "wire") == 0) {
            add_bytes(f.text, w->wire, &w->n_wire, sizeof(w->wire));
        } else {
            TEST_ASSERT_LESS_THAN_size_t(FIELDS_MAX, w->n_fields);
            w->field[w->n_fields] = f;
            w->n_fields++;
        }
    }
    fclose(file);
}

static const char *take(struct worked_frame *w, const char *key)
{
    TEST_ASSERT_LESS_THAN_size_t_MESSAGE(w->n_fields, w->next, key);
    TEST_ASSERT_EQUAL_STRING(key, w->field[w->next].key);
    const char *text = w->field[w->next].text;
    w->next++;
    return text;
}

static uint64_t take_integer(struct worked_frame *w, const char *key)
{
    char *end;
    uint64_t x = strtoull(take(w, key), &end, 10);
    TEST_ASSERT_EQUAL_CHAR('\0', *end);
    return x;
}

static float take_float(struct worked_frame *w, const char *key)
{
    char *end;
    float x = strtof(take(w, key), &end);
    TEST_ASSERT_EQUAL_CHAR('\0', *end);
    return x;
}

static void build_hello(struct worked_frame *w, struct frame *f)
{
    struct link_hello m = {0};
    m.version = (uint8_t)take_integer(w, "version");
    m.role = (uint8_t)take_integer(w, "role");
    m.session = (uint32_t)take_integer(w, "session");
    m.n_measurements = (uint8_t)take_integer(w, "n_measurements");
    m.n_outputs = (uint8_t)take_integer(w, "n_outputs");
    m.tick_ms = (uint32_t)take_integer(w, "tick_ms");
    strncpy(m.name, take(w, "name"), sizeof(m.name) - 1);
    pack_hello(&m, f);
    struct link_hello back;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_hello(f, &back));
    TEST_ASSERT_EQUAL_UINT32(m.session, back.session);
    TEST_ASSERT_EQUAL_STRING(m.name, back.name);
}

static void build_page(struct worked_frame *w, struct frame *f)
{
    struct link_page m = {0};
    m.index = (uint8_t)take_integer(w, "index");
    m.manipulated = take_integer(w, "manipulated") == 1;
    m.lo = take_float(w, "lo");
    m.hi = take_float(w, "hi");
    m.safe = take_float(w, "safe");
    strncpy(m.name, take(w, "name"), sizeof(m.name) - 1);
    strncpy(m.unit, take(w, "unit"), sizeof(m.unit) - 1);
    pack_page(&m, f);
    struct link_page back;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_page(f, &back));
    TEST_ASSERT_EQUAL_STRING(m.name, back.name);
    TEST_ASSERT_EQUAL_STRING(m.unit, back.unit);
}

static void build_sample(struct worked_frame *w, struct frame *f)
{
    struct link_sample m = {0};
    m.number = (uint32_t)take_integer(w, "number");
    m.time_ms = take_integer(w, "time_ms");
    m.n_measurements = (uint8_t)take_integer(w, "n_measurements");
    m.n_readback = (uint8_t)take_integer(w, "n_readback");
    for (unsigned i = 0; i < m.n_measurements; i++) {
        m.measurement[i].value = take_float(w, "value");
        m.measurement[i].quality = (uint8_t)take_integer(w, "quality");
    }
    for (unsigned i = 0; i < m.n_readback; i++) {
        m.readback[i].value = take_float(w, "value");
        m.readback[i].quality = (uint8_t)take_integer(w, "quality");
    }
    pack_sample(&m, f);
    struct link_sample back;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_sample(f, &back));
    TEST_ASSERT_EQUAL_UINT64(m.time_ms, back.time_ms);
}

static void build_command(struct worked_frame *w, struct frame *f)
{
    struct link_command m = {0};
    m.number = (uint32_t)take_integer(w, "number");
    m.time_ms = take_integer(w, "time_ms");
    m.safe = take_integer(w, "flags") == 1;
    m.n_outputs = (uint8_t)take_integer(w, "n_outputs");
    for (unsigned i = 0; i < m.n_outputs; i++) {
        m.output[i].value = take_float(w, "value");
        m.output[i].drive = take_integer(w, "drive") == 1;
    }
    pack_command(&m, f);
    struct link_command back;
    TEST_ASSERT_EQUAL_INT(ERR_OK, unpack_command(f, &back));
    TEST_ASSERT_EQUAL(m.safe, back.safe);
}

/* Builds the message from the fields on the page; returns its type. */
static int build(struct worked_frame *w, struct frame *f)
{
    w->next = 0;
    const char *name = take(w, "message");
    f->sequence = (uint16_t)take_integer(w, "sequence");
    if (strcmp(name, "HELLO") == 0) {
        build_hello(w, f);
    } else if (strcmp(name, "PAGE_REQUEST") == 0) {
        struct link_page_request m = {.index = (uint8_t)take_integer(w, "index")};
        pack_page_request(&m, f);
    } else if (strcmp(name, "PAGE") == 0) {
        build_page(w, f);
    } else if (strcmp(name, "READY") == 0) {
        struct link_ready m = {.session = (uint32_t)take_integer(w, "session")};
        pack_ready(&m, f);
    } else if (strcmp(name, "SAMPLE") == 0) {
        build_sample(w, f);
    } else if (strcmp(name, "COMMAND") == 0) {
        build_command(w, f);
    } else if (strcmp(name, "KEEP_ALIVE") == 0) {
        pack_keep_alive(f);
    } else {
        TEST_FAIL_MESSAGE(name);
    }
    TEST_ASSERT_EQUAL_size_t_MESSAGE(w->n_fields, w->next, "fields left over");
    return f->type;
}

static void assert_payload(const struct worked_frame *w, const struct frame *f)
{
    TEST_ASSERT_TRUE(f->n == 0 || memcmp(w->body + 3, f->payload, f->n) == 0);
}

static void every_worked_frame_is_what_the_codec_makes(void)
{
    for (size_t k = 0; k < n_frames; k++) {
        struct frame f;
        (void)build(&frames[k], &f);
        TEST_ASSERT_EQUAL_size_t(frames[k].n_body, 3u + f.n);
        assert_payload(&frames[k], &f);
        uint8_t wire[FRAME_WIRE_MAX];
        size_t n = frame_encode(&f, wire);
        TEST_ASSERT_EQUAL_size_t(frames[k].n_wire, n);
        TEST_ASSERT_EQUAL_HEX8_ARRAY(frames[k].wire, wire, n);
    }
}

static void every_worked_frame_is_taken_by_the_decoder(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    for (size_t k = 0; k < n_frames; k++) {
        struct frame f;
        bool taken = false;
        for (size_t i = 0; i < frames[k].n_wire; i++) {
            taken = frame_decode(&d, frames[k].wire[i], &f);
        }
        TEST_ASSERT_TRUE(taken);
        TEST_ASSERT_EQUAL_size_t(frames[k].n_body, 3u + f.n);
        TEST_ASSERT_EQUAL_UINT8(frames[k].body[0], f.type);
        TEST_ASSERT_EQUAL_UINT16(frames[k].body[1] | (frames[k].body[2] << 8), f.sequence);
        assert_payload(&frames[k], &f);
    }
    TEST_ASSERT_EQUAL_UINT32(n_frames, d.count.good);
}

static void every_message_has_a_worked_frame(void)
{
    for (int type = LINK_HELLO; type <= LINK_KEEP_ALIVE; type++) {
        unsigned found = 0;
        for (size_t k = 0; k < n_frames; k++) {
            struct frame f;
            found += build(&frames[k], &f) == type ? 1u : 0u;
        }
        TEST_ASSERT_GREATER_THAN_UINT(0, found);
    }
}

static void the_intervals_on_the_page_are_those_of_the_code(void)
{
    FILE *file = fopen(PAGE, "r");
    TEST_ASSERT_NOT_NULL(file);
    char line[512];
    unsigned hello = 0;
    unsigned keep_alive = 0;
    unsigned silence = 0;
    while (fgets(line, sizeof(line), file) != NULL) {
        (void)sscanf(line,
                     "Numbers: greeting interval **%u ms**, keep-alive interval **%u ms**, "
                     "silence **%u ms**",
                     &hello, &keep_alive, &silence);
    }
    fclose(file);
    TEST_ASSERT_EQUAL_UINT(LINK_HELLO_MS, hello);
    TEST_ASSERT_EQUAL_UINT(LINK_KEEP_ALIVE_MS, keep_alive);
    TEST_ASSERT_EQUAL_UINT(LINK_SILENCE_MS, silence);
}

int main(void)
{
    UNITY_BEGIN();
    read_document();
    RUN_TEST(every_message_has_a_worked_frame);
    RUN_TEST(every_worked_frame_is_what_the_codec_makes);
    RUN_TEST(every_worked_frame_is_taken_by_the_decoder);
    RUN_TEST(the_intervals_on_the_page_are_those_of_the_code);
    return UNITY_END();
}
