/* Settings of blocks, with kinds that only the tests have: set, pasted by half, stored, cut off while they are stored, and found in
 * sets that nobody has written (records of other lengths, types, rows, kinds). Nothing crashes, every command is answered,
 * and what `save` has said ok to comes back to the letter; after a cut either that or what was there before.
 *
 * Input: steps, each a byte that says what, and what it needs.
 */
#include <string.h>

#include "base/crc32.h"
#include "exchange/config.h"
#include "flash_model.h"
#include "fuzz.h"
#include "fuzz_board.h"

#if CONFIG_BLOCKS

#include "memory_port.h"
#include "numbered_kinds.h"
static const struct block_kind shared_kind;
#define MADE_UP_KINDS_TOO &mean_kind, &both_kind, &shared_kind
#include "made_up_kinds.h"

/* With the parameters of gmv, in one of the places for tables. */
static const struct block_kind shared_kind = {.name = "shared",
                                              .stage = STAGE_CONTROL,
                                              .parameter = gmv_parameters,
                                              .parameters =
                                                  sizeof gmv_parameters / sizeof gmv_parameters[0],
                                              .settings_bytes = sizeof(struct gmv_settings),
                                              .table = true,
                                              .members_most = 2,
                                              .inputs_most = 2,
                                              .points_most = 2,
                                              .bytes = made_up_bytes,
                                              .check = gmv_check,
                                              .configure = made_up_configure,
                                              .step = made_up_rest,
                                              .back_calculate = made_up_rest,
                                              .follow = made_up_rest,
                                              .shift = made_up_rest};

/* ---- at the console ---- */

static const char *const fields[] = {
    "kind",    "kind",     "loops",  "inputs",  "points",  "lambda",  "table.1",
    "table.2", "table.3",  "order",  "order.1", "order.2", "signs.1", "adapt",
    "stage.1", "stage.48", "weight", "rate",    "cross",   "table.4", "stage.0"};
static const char *const values[] = {"-",       "gmv",
                                     "column",  "shared",
                                     "weights", "mean",
                                     "both",    "pid",
                                     "top",     "bottom",
                                     "T1,T10",  "top,bottom",
                                     "mean",    "feed",
                                     "1",       "0.5",
                                     "1,0,0",   "0,1,0",
                                     "0,0,1",   "1,2,3",
                                     "3,3,3",   "off",
                                     "on",      "mystery",
                                     "7",       "1e9",
                                     "nan",     "1,2,3,4,5,6,7,8",
                                     "1,,2",    "plus,plus,minus,minus",
                                     "extra"};
static const char *const commands[] = {"begin",
                                       "apply",
                                       "abandon",
                                       "save",
                                       "load",
                                       "defaults",
                                       "diff",
                                       "dump",
                                       "list block1",
                                       "list block2",
                                       "status",
                                       "events",
                                       "mode top auto",
                                       "mode bottom auto",
                                       "mode top manual",
                                       "out top 4",
                                       "sp top 80",
                                       "help block1.lambda",
                                       "set meas3.name mean",
                                       "set meas3.unit degC",
                                       "set meas3.hi 200",
                                       "set meas4.name extra",
                                       "set loop3.name third",
                                       "set loop3.pv mean",
                                       "set loop3.out -",
                                       "loop top",
                                       "alarm",
                                       "diff defaults",
                                       "set tick.base 1",
                                       "version"};

#define PICK(list, f) (list)[feed_byte(f) % (sizeof(list) / sizeof((list)[0]))]

/* One line is one reply. */
static bool command(const char *line)
{
    (void)fuzz_replies();
    (void)fuzz_refusals();
    fuzz_type(line, strlen(line));
    fuzz_type("\n", 1);
    DEMAND(fuzz_replies() == 1);
    return fuzz_refusals() == 0;
}

static void set(struct feed *f)
{
    char line[120];
    uint8_t block = feed_byte(f);
    const char *field = PICK(fields, f), *value = PICK(values, f);
    (void)snprintf(line, sizeof line, "set block%u.%s %s", 1u + block % (CONFIG_BLOCKS + 1u), field,
                   value);
    (void)command(line);
}

/* ---- in flash ---- */

#define GRAIN 16u

static unsigned left; /* flash operations until the power goes */
static bool cuts;
static uint8_t known[FLASH_MODEL_SIZE];

static bool keep(uint32_t address, uint32_t n)
{
    if (cuts && left == 0) {
        memcpy(flash_model + address, known + address, n);
        return false;
    }
    left -= cuts;
    memcpy(known + address, flash_model + address, n);
    return true;
}

static void start_again(void)
{
    cuts = false;
    fuzz_power_on();
    fuzz_pass(2100); /* no plant: what is stored is read */
    fuzz_pass(100);
    (void)fuzz_replies();
    (void)fuzz_refusals();
}

static void cut_a_save(struct feed *f)
{
    (void)command("abandon");
    bool stored = command("load");
    fuzz_pass(2000);
    uint32_t before = fuzz_settings();
    if (!stored)
        start_again(); /* defaults, or what cannot be loaded */
    set(f);
    set(f);
    uint32_t after = fuzz_settings();
    bool no_room = fuzz_had_no_room();
    memcpy(known, flash_model, sizeof known);
    left = feed_byte(f);
    cuts = true;
    bool ok = command("save");
    cuts = cuts && left == 0;
    start_again();
    uint32_t now = fuzz_settings();
    DEMAND(!stored || no_room || now == before || now == after);
    DEMAND(!ok || no_room || now == after);
}

static void put32(uint8_t *at, uint32_t x)
{
    for (unsigned i = 0; i < 4; i++)
        at[i] = (uint8_t)(x >> (8u * i));
}

static void checked_grain(uint8_t *at, const char *magic, uint32_t a, uint32_t b)
{
    memcpy(at, magic, 4);
    put32(at + 4, a);
    put32(at + 8, b);
    put32(at + 12, crc32_update(0, at, 12));
}

/* A record of a block: fields, rows and lengths as they should be, or nearly. */
static size_t put_record(uint8_t *at, struct feed *f)
{
    static const char *const kinds[] = {"gmv",  "column",  "weights", "mean",
                                        "both", "mystery", "shared",  ""};
    static const uint8_t field[] = {1, 1, 2, 3, 4, 65, 66, 66, 67, 68, 73, 127, 128, 255, 5, 0};
    uint8_t what = feed_byte(f), which = PICK(field, f), type = what >> 4;
    size_t n = feed_byte(f) % 80u;
    const uint8_t *data = feed_bytes(f, &n);
    at[0] = at[1] = 0;
    put32(at + 4,
          16u << 24 | (uint32_t)which << 16 | (uint32_t)(feed_byte(f) % 5u) << 6 | (what & 7u));
    if (which >= 1 && which <= 4 && type < 12) { /* a text of some use */
        const char *text = which == 1 ? PICK(kinds, f) : which == 2 ? "top" : PICK(values, f);
        n = strlen(text);
        data = (const uint8_t *)text;
        type = 5;
    }
    at[2] = type % 8u;
    at[3] = (uint8_t)(4u + n + (what & 8u ? feed_byte(f) & 1u : 0));
    if (n)
        memcpy(at + 8, data, n);
    return 8u + n;
}

/* Stores the set again as a newer one, with such records behind it. */
static void put_a_set(struct feed *f)
{
    static uint8_t set[12000];
    uint8_t *slot = flash_model;
    uint32_t length = 0;
    /* The first set of the first slot is that of begin(). */
    if (memcmp(slot, "RXSM", 4) == 0 && memcmp(slot + GRAIN, "RXSH", 4) == 0)
        length = slot[GRAIN + 8] | (uint32_t)slot[GRAIN + 9] << 8;
    if (length > 4000)
        length = 0;
    memset(set, 0, sizeof set);
    memcpy(set + GRAIN, slot + (size_t)2 * GRAIN, length);
    for (unsigned n = feed_byte(f) % 24u; n; n--)
        length += (uint32_t)put_record(set + GRAIN + length, f);
    uint32_t body = (length + GRAIN - 1u) / GRAIN * GRAIN;
    checked_grain(set, "RXSH", 77, length | 1u << 16);
    uint8_t *tail = set + GRAIN + body;
    memcpy(tail, "RXST", 4);
    put32(tail + 4, length);
    put32(tail + 8, 77);
    put32(tail + 12, crc32_update(0, set, GRAIN + body + 12u));
    memory_port_erase_all();
    checked_grain(slot, "RXSM", 1, 1);
    memcpy(slot + GRAIN, set, body + 2u * GRAIN);
    start_again();
}

static void begin(void)
{
    static uint8_t configured[FLASH_MODEL_SIZE];
    static bool known_already;
    flash_model_keep = NULL;
    if (!known_already) {
        fuzz_start(true);
        DEMAND(command("save"));
        memcpy(configured, flash_model, sizeof configured);
        known_already = true;
    }
    memory_port_erase_all();
    memcpy(flash_model, configured, sizeof configured);
    memcpy(known, configured, sizeof known);
    flash_model_keep = keep;
    start_again();
}

/* ---- steps ---- */

static void step(struct feed *f)
{
    uint8_t what = feed_byte(f);
    struct feed nothing = {(const uint8_t *)"", 0};
    switch (what & 7u) {
    case 0:
    case 1:
    case 2:
        set(f);
        break;
    case 3:
    case 4:
        (void)command(PICK(commands, f));
        break;
    case 5:
        fuzz_pass(300);
        fuzz_sample(what & 8u ? f : &nothing, false);
        if (what & 16u)
            fuzz_stretch(what >> 5);
        break;
    case 6:
        cut_a_save(f);
        break;
    default:
        put_a_set(f);
    }
}

/* A set that `save` answered with ok comes back. */
static void what_is_saved_comes_back(void)
{
    (void)command("abandon");
    if (!command("save"))
        return;
    uint32_t before = fuzz_settings();
    bool no_room = fuzz_had_no_room(); /* by now there may be room for it again */
    start_again();
    DEMAND(no_room || fuzz_settings() == before);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    begin();
    for (unsigned n = 0; f.left && n < 100; n++)
        step(&f);
    if (fuzz_is_chosen(data, size))
        fuzz_settings_are_sound();
    what_is_saved_comes_back();
    flash_model_keep = NULL;
    return 0;
}

#else /* a board without blocks */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    (void)data;
    (void)size;
    return 0;
}

#endif
