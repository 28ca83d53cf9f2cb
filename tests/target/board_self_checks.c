/* What a board finds out about itself, on the virtual board with the flashed file: usage: board-self-checks IMAGE CASE. Prints what it saw;
 * status 1 with the reason when that is not what it should be.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chip.h"
#include "link/messages.h"
#include "models/models.h"

#define MS      UINT64_C(1000000)
#define SECOND  (1000u * MS)
#define CONSOLE 0
#define PLANT   1

static const struct chip *chip;
static uint8_t image[1u << 20];
static size_t image_bytes;
static char said[1u << 18];
static size_t n_said;

static _Noreturn void fail(const char *format, ...)
{
    va_list list;
    va_start(list, format);
    (void)vfprintf(stderr, format, list);
    va_end(list);
    (void)fprintf(stderr, "\nthe console said:\n%s\n", said);
    exit(1);
}

static struct board *power_on(const struct surroundings *changes)
{
    char err[256] = "";
    struct surroundings around = *changes;
    around.baud = 115200;
    around.seed = 1;
    struct board *b = board_new(chip, &around, image, image_bytes, false, err, sizeof(err));
    if (b == NULL)
        fail("%s", err);
    n_said = 0;
    said[0] = '\0';
    board_power_on(b);
    return b;
}

static const struct surroundings usual = {
    .crystal_hz = 8000000, .slow_clock_hz = 32000, .supply_mv = 3300, .brown_out_mv = 2830};

static void listen(struct board *b)
{
    n_said += line_take(b, CONSOLE, (uint8_t *)said + n_said, sizeof(said) - 1u - n_said);
    said[n_said] = '\0';
}

static void run(struct board *b, uint64_t ns)
{
    for (uint64_t end = board_ns(b) + ns; board_ns(b) < end && b->verdict[0] == '\0';) {
        board_run(b, board_ns(b) + 10u * MS < end ? board_ns(b) + 10u * MS : end);
        listen(b);
    }
    if (b->verdict[0] != '\0')
        fail("the board ended: %s", b->verdict);
}

static void ask(struct board *b, const char *line)
{
    n_said = 0;
    said[0] = '\0';
    (void)line_give(b, CONSOLE, (const uint8_t *)line, strlen(line));
    (void)line_give(b, CONSOLE, (const uint8_t *)"\r\n", 2);
    run(b, 2u * SECOND);
}

static void wants(const char *words)
{
    if (strstr(said, words) == NULL)
        fail("not said: %s", words);
}

static void wants_not(const char *words)
{
    if (strstr(said, words) != NULL)
        fail("said: %s", words);
}

/* A start without a plant erases the first slot after 2 s. */
static struct board *started(const struct surroundings *around)
{
    struct board *b = power_on(around);
    run(b, 5u * SECOND);
    ask(b, "mode machine");
    wants("ok");
    return b;
}

/* ---- option bytes ---- */

static void options_are_told(void)
{
    struct surroundings around = usual;
    struct board *b = started(&around);
    ask(b, "version");
    wants("brown-out reset level 3; watchdog only from start-up on; program NOT write-protected");
    board_free(b);
    around.hardware_watchdog = true;
    around.write_protect = 0x3FF;
    b = started(&around);
    ask(b, "version");
    wants("; watchdog from reset on; program write-protected");
    wants_not("in part");
    ask(b, "save"); /* sectors 10 and 11 are open */
    wants("ok");
    board_free(b);
    around.write_protect = 0xFFF;
    b = started(&around);
    ask(b, "save");
    wants("err IO");
    board_free(b);
    around.write_protect = 0x3;
    b = started(&around);
    ask(b, "version");
    wants("program write-protected in part");
    board_free(b);
}

/* A watchdog that runs from the reset on, at its shortest and longest, with crystals that are there, are not, and fit no list. */
static void the_hardware_watchdog_is_fed_in_time(void)
{
    static const uint32_t clocks[] = {17000, 32000, 47000},
                          crystals[] = {8000000, 0, 25000000, 5000000};
    for (unsigned i = 0; i < 3; i++)
        for (unsigned k = 0; k < 4; k++) {
            struct surroundings around = usual;
            around.hardware_watchdog = true;
            around.slow_clock_hz = clocks[i];
            around.crystal_hz = crystals[k];
            struct board *b = started(&around);
            printf("watchdog %u Hz, crystal %u Hz: %u resets by the watchdog\n", clocks[i],
                   crystals[k], b->resets[RESET_WATCHDOG]);
            if (b->resets[RESET_WATCHDOG] != 0)
                fail("the watchdog has reset the board");
            board_free(b);
        }
}

/* ---- memory ---- */

static void set_stuck(struct board *b, uint32_t address)
{
    *processor_memory(b, address, 1) |= 0x10u;
}

static void run_stuck(struct board *b, uint32_t address, uint64_t ns)
{
    for (uint64_t end = board_ns(b) + ns; board_ns(b) < end && b->verdict[0] == '\0';) {
        board_run(b, board_ns(b) + 20u * 1000u);
        set_stuck(b, address);
    }
    listen(b);
}

static void a_stuck_bit_of_the_ram_is_told_and_nothing_acts(void)
{
    static const uint32_t cells[] = {0x2001F004u, 0x10000204u, 0x20001000u};
    for (unsigned i = 0; i < 3; i++) {
        char words[40];
        struct board *b = power_on(&usual);
        run_stuck(b, cells[i], 300u * MS);
        run(b, 5u * SECOND);
        ask(b, "mode machine");
        ask(b, "version");
        (void)snprintf(words, sizeof(words), "ram_failed_at %08x", cells[i]);
        wants("RAM FAILED its test");
        wants(words);
        ask(b, "status");
        wants("the RAM failed its test at power-on");
        ask(b, "events");
        wants("alarm RAM_FAILED");
        /* Nobody forgets: the next reset tests again. The cell is well by now. */
        board_ask_reset(b, RESET_PIN);
        run(b, 5u * SECOND);
        ask(b, "mode machine");
        ask(b, "version");
        wants("image whole");
        board_free(b);
    }
}

static void a_good_ram_passes_and_other_resets_keep_what_it_holds(void)
{
    struct board *b = power_on(&usual);
    uint64_t until = 0;
    while (b->core_hz == 16000000u && until < SECOND)
        board_run(b, until += MS);
    printf("from power-on to the clock's full speed: %llu ms\n",
           (unsigned long long)(board_ns(b) / MS));
    if (board_ns(b) > 348u * MS)
        fail("the shortest time of a watchdog from reset on is over");
    run(b, 5u * SECOND);
    ask(b, "mode machine");
    uint32_t boot = 0;
    ask(b, "version");
    wants("image whole");
    if (strstr(said, "boot ") == NULL || sscanf(strstr(said, "boot ") + 5, "%u", &boot) != 1)
        fail("no number of the start");
    board_ask_reset(b, RESET_PIN);
    run(b, 5u * SECOND);
    ask(b, "mode machine");
    ask(b, "version");
    char words[40];
    (void)snprintf(words, sizeof(words), "boot %u", boot + 1u);
    wants(words);
    wants("started by: reset-pin");
    board_free(b);
}

/* ---- image ---- */

static void a_bit_of_the_image_that_changes_in_the_run_is_told(void)
{
    struct board *b = started(&usual);
    ask(b, "version");
    wants("image whole");
    const char *text = "firmware, board, limits"; /* of the help */
    uint8_t *flash = processor_memory(b, 0x08000000u, (uint32_t)image_bytes);
    uint8_t *at = memmem(flash, image_bytes, text, strlen(text));
    if (at == NULL)
        fail("the image has no such text");
    *at ^= 1u;
    uint64_t changed = board_ns(b), found = 0;
    n_said = 0;
    while (found == 0 && board_ns(b) < changed + 60u * SECOND) {
        run(b, 100u * MS);
        if (strstr(said, "IMAGE_DAMAGED") != NULL)
            found = board_ns(b);
    }
    if (found == 0)
        fail("not noticed within a minute");
    printf("noticed after %.1f s\n", (double)(found - changed) / 1e9);
    ask(b, "version");
    wants("image DAMAGED");
    board_free(b);
}

/* ---- flash ---- */

static void a_supply_that_dips_in_an_erase_spoils_it(void)
{
    struct board *b = power_on(&usual);
    while (stored_flash(b)->erase_count == 0 && b->stalled_until_ns < board_ns(b) + 100u * MS)
        board_run(b, board_ns(b) + MS);
    run(b, 300u * MS);
    b->around.supply_mv = 2880; /* below the detector's level, not below that of the reset */
    run(b, 100u * MS);
    b->around.supply_mv = 3300;
    run(b, 3u * SECOND);
    ask(b, "mode machine");
    ask(b, "version");
    wants("storage: failed");
    ask(b, "save"); /* erases again */
    wants("ok");
    if (stored_flash(b)->erase_count != 2)
        fail("%llu erases", (unsigned long long)stored_flash(b)->erase_count);
    board_free(b);
}

static void a_save_without_brown_out_reset_wants_a_word_more(void)
{
    struct surroundings around = usual;
    around.brown_out_mv = 0;
    struct board *b = started(&around);
    ask(b, "save");
    wants("err STATE");
    wants("brown-out reset is off");
    ask(b, "save unsafe");
    wants("ok");
    ask(b, "save replace unsafe");
    wants("ok");
    ask(b, "save safe");
    wants("err ");
    board_free(b);
}

/* ---- the plant link in an erase ---- */

static uint16_t sequence;

static void send(struct board *b, struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = sequence++;
    (void)line_give(b, PLANT, wire, frame_encode(f, wire));
}

static void say_page(struct board *b, uint8_t index)
{
    struct frame f;
    struct link_page page = {.index = index, .manipulated = index == 1, .lo = 0, .hi = 100};
    (void)snprintf(page.name, sizeof(page.name), "%s", index == 1 ? "u1" : "T1");
    (void)snprintf(page.unit, sizeof(page.unit), "%s", index == 1 ? "%" : "degC");
    pack_page(&page, &f);
    send(b, &f);
}

/* A plant of one input and one output; the longest silence of the board while its first slot is erased. */
static void the_link_lives_through_an_erase(void)
{
    struct board *b = power_on(&usual);
    struct frame_decoder decoder = {.n = 0};
    uint64_t heard = 0, silence = 0, asked = 0, in_erase = 0;
    struct link_sample sample = {
        .number = 1, .time_ms = 1000, .n_measurements = 1, .measurement = {{50.0f, 0}}};
    bool ready = false, waits = false;
    unsigned alive = 0, gone = 0;
    while (board_ns(b) < 12u * SECOND && b->verdict[0] == '\0') {
        uint8_t bytes[256];
        struct frame f;
        board_run(b, board_ns(b) + MS);
        bool erases = b->stalled_until_ns > board_ns(b) + MS;
        in_erase += erases;
        size_t n = line_take(b, PLANT, bytes, sizeof(bytes));
        for (size_t i = 0; i < n; i++) {
            if (!frame_decode(&decoder, bytes[i], &f))
                continue;
            if (ready && board_ns(b) - heard > silence)
                silence = board_ns(b) - heard;
            heard = board_ns(b);
            alive += erases && f.type == LINK_KEEP_ALIVE;
            if (f.type == LINK_PAGE_REQUEST)
                say_page(b, f.payload[0]);
            if (f.type == LINK_READY)
                ready = true;
            if (f.type == LINK_HELLO)
                gone += ready;
            if (f.type == LINK_COMMAND && waits) {
                waits = false;
                sample.number++;
                sample.time_ms += 1000;
            }
        }
        if (!ready && board_ns(b) >= asked + 250u * MS) {
            struct link_hello hello = {.version = LINK_VERSION,
                                       .role = LINK_ROLE_PLANT,
                                       .session = 7,
                                       .n_measurements = 1,
                                       .n_outputs = 1,
                                       .tick_ms = 1000,
                                       .name = "small"};
            pack_hello(&hello, &f);
            send(b, &f);
            asked = board_ns(b);
        }
        if (ready && board_ns(b) >= asked + 500u * MS) {
            pack_sample(&sample, &f);
            send(b, &f);
            waits = true;
            asked = board_ns(b);
        }
    }
    printf("erases %llu, %llu ms; keep-alives in them %u; longest silence of the board %llu ms\n",
           (unsigned long long)stored_flash(b)->erase_count, (unsigned long long)in_erase, alive,
           (unsigned long long)(silence / MS));
    if (b->verdict[0] != '\0')
        fail("the board ended: %s", b->verdict);
    if (stored_flash(b)->erase_count != 1 || alive < 2 || silence > 700u * MS || gone != 0 ||
        decoder.count.bad_crc + decoder.count.malformed != 0)
        fail("restarts of the link %u, damaged frames %u", gone,
             decoder.count.bad_crc + decoder.count.malformed);
    board_free(b);
}

/* ---- the core, on either chip ---- */

static void expect(struct board *b, const char *what, uint32_t address, uint32_t mask,
                   uint32_t bits)
{
    uint32_t word = bus_read(b, address, 4) & mask;
    if (word != bits)
        fail("%s is 0x%08x, not 0x%08x", what, word, bits);
}

/* PM0214 4.4 and 4.6: the table of vectors in the flash itself, faults told apart, division by zero a fault, frames aligned to eight bytes;
 * where there is a unit for numbers, both coprocessors open to all code. */
static void start_up_sets_the_core(void)
{
    struct surroundings around = usual;
    around.slow_clock_hz = chip->slow_clock_hz;
    struct board *b = power_on(&around);
    run(b, SECOND);
    wants("STARTED");
    expect(b, "VTOR", 0xE000ED08u, UINT32_MAX, chip->memory[0].base);
    expect(b, "SHCSR", 0xE000ED24u, 0x00070000u, 0x00070000u);
    expect(b, "CCR", 0xE000ED14u, 0x210u, 0x210u);
    if (chip->fpu)
        expect(b, "CPACR", 0xE000ED88u, UINT32_MAX, 0x00F00000u);
    board_free(b);
}

int main(int argc, char **argv)
{
    static const struct {
        const char *name;
        void (*run)(void);
    } cases[] = {
        {"options", options_are_told},
        {"watchdog", the_hardware_watchdog_is_fed_in_time},
        {"stuck", a_stuck_bit_of_the_ram_is_told_and_nothing_acts},
        {"memory", a_good_ram_passes_and_other_resets_keep_what_it_holds},
        {"image", a_bit_of_the_image_that_changes_in_the_run_is_told},
        {"dip", a_supply_that_dips_in_an_erase_spoils_it},
        {"save", a_save_without_brown_out_reset_wants_a_word_more},
        {"link", the_link_lives_through_an_erase},
        {"core", start_up_sets_the_core},
    };
    FILE *f = argc == 3 ? fopen(argv[1], "rb") : NULL;
    if (f == NULL) {
        (void)fprintf(stderr, "usage: board-self-checks IMAGE CASE\n");
        return 2;
    }
    image_bytes = fread(image, 1, sizeof(image), f);
    (void)fclose(f);
    chip = chip_named_in(strrchr(argv[1], '/') != NULL ? strrchr(argv[1], '/') : argv[1]);
    if (chip == NULL)
        fail("no chip of that name: %s", argv[1]);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        if (strcmp(cases[i].name, argv[2]) == 0) {
            cases[i].run();
            return 0;
        }
    }
    (void)fprintf(stderr, "board-self-checks: no case %s\n", argv[2]);
    return 2;
}
