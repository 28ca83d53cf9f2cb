/* SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only */
#include "faults.h"

#include "replay.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chip.h"
#include "models/models.h"

#define WAITING 16u
#define S       1e9
#define RAMP_NS UINT64_C(1000000)
/* DS8626 5.3.5, table 19, typical: below the first the chip is held in reset whatever its options, up to the second. The STM32F100 is held in
 * reset below the same voltages as the STM32F405 (unverified). */
#define POWER_MV            1680u
#define POWER_HYSTERESIS_MV 40u
/* RM0090 Rev 4 5.2.2 and DS8626 table 19, typical: of the brown-out reset */
#define BROWN_OUT_HYSTERESIS_MV 100u
/* Memory keeps all that it holds while the supply is 1.0 V or more (unverified). Below that, and in a power cut, it forgets all. */
#define KEEPS_MV 1000u
#define TEXT     64u

struct faults {
    struct board *board;
    struct waiting {
        uint64_t at_ns, at_instruction; /* one of them; the other BOARD_NEVER */
        enum fault_kind kind;
        double value;
        uint64_t ramp_ns; /* as set when it was asked for */
    } waiting[WAITING];
    size_t n;
    uint64_t after_ns, after_instructions, off_ns, next_ramp_ns, ramp_ns;
    uint64_t random;
    uint32_t flip_from, flip_bytes;

    struct board_event power, button, ramp, replug[BOARD_LINES];
    bool supply_holds, forgets;
    enum board_reset held_as;
    uint32_t ramp_from, ramp_to;
    uint64_t ramp_began;
};

/* ---- supply and reset pin ---- */

static void power_back(void *context)
{
    struct faults *f = context;
    board_release(f->board, RESET_POWER, true);
}

static void cut_power(struct faults *f, uint64_t ns)
{
    board_hold(f->board, RESET_POWER);
    board_schedule(f->board, &f->power, board_ns(f->board) + ns);
}

static void button_up(void *context)
{
    struct faults *f = context;
    board_release(f->board, RESET_PIN, false);
}

static void set_supply(struct faults *f, uint32_t mv)
{
    struct board *b = f->board;
    uint32_t level = b->around.brown_out_mv > POWER_MV ? b->around.brown_out_mv : POWER_MV;
    b->around.supply_mv = mv;
    if (mv < level && !f->supply_holds) {
        f->supply_holds = true;
        f->forgets = false;
        f->held_as = level > POWER_MV ? RESET_BROWN_OUT : RESET_POWER;
        board_hold(b, f->held_as);
    }
    if (!f->supply_holds)
        return;
    if (mv < POWER_MV)
        f->held_as = RESET_POWER;
    f->forgets = f->forgets || mv < KEEPS_MV;
    if (mv >= level + (level > POWER_MV ? BROWN_OUT_HYSTERESIS_MV : POWER_HYSTERESIS_MV)) {
        f->supply_holds = false;
        board_release(b, f->held_as, f->forgets);
    }
}

static void ramp_step(void *context)
{
    struct faults *f = context;
    uint64_t spent = board_ns(f->board) - f->ramp_began;
    double part = spent >= f->ramp_ns ? 1.0 : (double)spent / (double)f->ramp_ns;
    double mv = (double)f->ramp_from + part * ((double)f->ramp_to - (double)f->ramp_from);
    set_supply(f, (uint32_t)lround(mv));
    if (part < 1.0)
        board_schedule(f->board, &f->ramp, board_ns(f->board) + RAMP_NS);
}

/* ---- lines ---- */

static void unplug(struct faults *f, unsigned line, uint64_t ns)
{
    struct line *l = &f->board->lines[line];
    l->unplugged = true;
    l->to_head = l->to_tail;
    board_schedule(f->board, &f->replug[line], board_ns(f->board) + ns);
}

static void replug_console(void *context)
{
    ((struct faults *)context)->board->lines[0].unplugged = false;
}

static void replug_link(void *context)
{
    ((struct faults *)context)->board->lines[1].unplugged = false;
}

/* ---- bits ---- */

static uint32_t pick(struct faults *f, uint32_t below)
{
    return random_word(&f->random) % below;
}

/* The part of a memory that flip_from and flip_bytes leave; 0 bytes with a verdict: none. */
static uint32_t narrow(struct faults *f, uint32_t *base, uint32_t size)
{
    uint64_t from = f->flip_from > *base ? f->flip_from : *base, end = (uint64_t)*base + size;
    uint64_t wanted = f->flip_bytes != 0 ? (uint64_t)f->flip_from + f->flip_bytes : end;
    if (wanted < end)
        end = wanted;
    if (from >= end) {
        board_verdict(f->board, "flip_from 0x%08x, flip_bytes %u: nothing of that memory is there",
                      f->flip_from, f->flip_bytes);
        return 0;
    }
    *base = (uint32_t)from;
    return (uint32_t)(end - from);
}

static void flip_memory(struct faults *f, enum memory_kind kind, uint32_t bits)
{
    const struct chip *chip = f->board->chip;
    for (size_t i = 0; i < chip->n_memory; i++) {
        const struct chip_memory *m = &chip->memory[i];
        if (m->kind != kind)
            continue;
        uint32_t base = m->base,
                 size = narrow(f, &base,
                               kind == MEMORY_FLASH ? processor_image_bytes(f->board) : m->size);
        for (uint32_t k = 0; k < bits && size > 0; k++) {
            uint32_t at = base + pick(f, size), bit = pick(f, 8);
            f->board->flipped = at;
            *processor_memory(f->board, at, 1) ^= (uint8_t)(1u << bit);
            board_note(f->board, "flip 0x%08x bit %u", at, bit);
        }
        if (kind == MEMORY_FLASH)
            processor_forget_code(f->board);
        return;
    }
}

static uint32_t count_used(const uint8_t *bytes, uint32_t size)
{
    uint32_t used = 0;
    for (uint32_t i = 0; i < size; i++)
        used += bytes[i] != 0xFFu;
    return used;
}

static void flip_stored(struct faults *f, uint32_t bits)
{
    struct stored_flash *s = stored_flash(f->board);
    uint32_t base = f->board->chip->stored_base;
    uint32_t size = narrow(f, &base, f->board->chip->stored_size);
    uint8_t *bytes = s->bytes + (base - f->board->chip->stored_base);
    uint32_t used = count_used(bytes, size);
    for (uint32_t k = 0; k < bits && used > 0; k++) {
        uint32_t which = pick(f, used), at = 0, bit = pick(f, 8);
        while (bytes[at] == 0xFFu || which-- > 0)
            at++;
        f->board->flipped = base + at;
        bytes[at] ^= (uint8_t)(1u << bit);
        board_note(f->board, "flip 0x%08x bit %u", base + at, bit);
        used = count_used(bytes, size);
    }
}

static void flip_registers(struct faults *f, uint32_t bits)
{
    uint32_t registers = f->board->chip->fpu ? 48u : 16u;
    for (uint32_t k = 0; k < bits; k++) {
        uint32_t number = pick(f, registers), bit = pick(f, 32);
        f->board->flipped = number;
        processor_flip_register(f->board, number, bit);
        board_note(f->board, "flip %c%u bit %u", number < 16u ? 'R' : 'S',
                   number < 16u ? number : number - 16u, bit);
    }
}

/* ---- doing ---- */

static void carry_out(struct faults *f, enum fault_kind kind, double value)
{
    struct board *b = f->board;
    uint32_t number = (uint32_t)value;
    uint64_t ns = (uint64_t)llround(value * S);
    board_note(b, "fault %s %g", fault_table[kind].name, value);
    switch (kind) {
    case FAULT_POWER_CUT:
        cut_power(f, ns);
        break;
    case FAULT_SUPPLY:
        set_supply(f, (uint32_t)lround(value * 1000.0));
        break;
    case FAULT_SUPPLY_RAMP:
        f->ramp_from = b->around.supply_mv;
        f->ramp_to = (uint32_t)lround(value * 1000.0);
        f->ramp_began = board_ns(b);
        board_schedule(b, &f->ramp, board_ns(b) + RAMP_NS);
        break;
    case FAULT_CRYSTAL:
        b->around.crystal_hz = number;
        crystal_changed(b);
        break;
    case FAULT_SLOW_CLOCK:
        b->around.slow_clock_hz = number;
        break;
    case FAULT_BUTTON:
        board_hold(b, RESET_PIN);
        board_schedule(b, &f->button, board_ns(b) + ns);
        break;
    case FAULT_HANG_MAIN:
        b->hang_main = number != 0;
        break;
    case FAULT_HANG_TICK:
        b->hang_tick = number != 0;
        break;
    case FAULT_HANG_CLOCK:
        b->hang_clock = number != 0;
        break;
    case FAULT_FLIP_RAM:
        flip_memory(f, MEMORY_RAM, number);
        break;
    case FAULT_FLIP_CCM:
        flip_memory(f, MEMORY_CORE_RAM, number);
        break;
    case FAULT_FLIP_FLASH:
        flip_memory(f, MEMORY_FLASH, number);
        break;
    case FAULT_FLIP_STORED:
        flip_stored(f, number);
        break;
    case FAULT_FLIP_REGISTER:
        flip_registers(f, number);
        break;
    case FAULT_SET_R0:
        processor_set_register(b, 0, number);
        break;
    case FAULT_JUMP:
        processor_set_register(b, REGISTER_PC, number);
        break;
    case FAULT_NOISE_CONSOLE:
        b->lines[0].corrupt_per_million = number;
        break;
    case FAULT_NOISE_LINK:
        b->lines[1].corrupt_per_million = number;
        break;
    case FAULT_FLASH_CUT_WORD:
        stored_flash(b)->cut_word = stored_flash(b)->words + number;
        break;
    case FAULT_FLASH_CUT_ERASE:
        stored_flash(b)->cut_erase = stored_flash(b)->erase_count + 1u;
        stored_flash(b)->cut_per_mille = number;
        break;
    case FAULT_UNPLUG_CONSOLE:
        unplug(f, 0, ns);
        break;
    case FAULT_UNPLUG_LINK:
        unplug(f, 1, ns);
        break;
    default:
        break;
    }
    processor_break(b);
}

static bool set_up(struct faults *f, enum fault_kind kind, double value)
{
    switch (kind) {
    case FAULT_AFTER_NS:
        f->after_ns = (uint64_t)value;
        return true;
    case FAULT_AFTER_INSTRUCTIONS:
        f->after_instructions = (uint64_t)value;
        return true;
    case FAULT_RAMP_TIME:
        f->next_ramp_ns = (uint64_t)llround(value * S);
        return true;
    case FAULT_OFF_TIME:
        f->off_ns = (uint64_t)llround(value * S);
        return true;
    case FAULT_PLACE:
        f->random = random_state((uint64_t)value);
        return true;
    case FAULT_FLIP_FROM:
        f->flip_from = (uint32_t)value;
        return true;
    case FAULT_FLIP_BYTES:
        f->flip_bytes = (uint32_t)value;
        return true;
    default:
        return false;
    }
}

static bool has_memory(const struct chip *chip, enum memory_kind kind)
{
    for (size_t i = 0; i < chip->n_memory; i++)
        if (chip->memory[i].kind == kind)
            return true;
    return false;
}

bool faults_add(struct board *b, enum fault_kind kind, double value, char *err, size_t err_size)
{
    struct faults *f = b->faults;
    char line[TEXT];
    if (kind >= FAULT_KINDS) {
        (void)snprintf(err, err_size, "the board knows no such fault");
        return false;
    }
    const struct fault_row *row = &fault_table[kind];
    if (!(value >= row->lo && value <= row->hi) || (row->whole && value != floor(value))) {
        (void)snprintf(err, err_size, "board.%s must be %s%g to %g %s", row->name,
                       row->whole ? "a whole number from " : "", row->lo, row->hi, row->unit);
        return false;
    }
    if (kind == FAULT_FLIP_CCM && !has_memory(b->chip, MEMORY_CORE_RAM)) {
        (void)snprintf(err, err_size, "board.flip_ccm: the %s has no such memory", b->chip->name);
        return false;
    }
    int n = snprintf(line, sizeof(line), "%s %.17g\n", row->name, value);
    replay_note(b, REPLAY_FAULT, line, (size_t)n);
    if (set_up(f, kind, value))
        return true;
    if (f->n == WAITING) {
        (void)snprintf(err, err_size, "more than %u faults wait for their moment", WAITING);
        return false;
    }
    struct waiting *w = &f->waiting[f->n++];
    *w = (struct waiting){.at_ns = board_ns(b) + f->after_ns,
                          .at_instruction = BOARD_NEVER,
                          .kind = kind,
                          .value = value,
                          .ramp_ns = f->next_ramp_ns};
    if (f->after_instructions != 0) {
        w->at_instruction = b->instructions + f->after_instructions;
        w->at_ns = BOARD_NEVER;
    }
    f->after_ns = f->after_instructions = 0;
    return true;
}

bool faults_add_text(struct board *b, const char *text, size_t n, char *err, size_t err_size)
{
    while (n > 0) {
        char line[TEXT + 1], name[TEXT + 1];
        size_t length = 0;
        double value = 0.0;
        int end = 0;
        while (length < n && text[length] != '\n')
            length++;
        if (length > TEXT) {
            (void)snprintf(err, err_size, "a fault's line has at most %u characters", TEXT);
            return false;
        }
        (void)memcpy(line, text, length);
        line[length] = '\0';
        if (sscanf(line, "%64s %lf%n", name, &value, &end) != 2 || line[end] != '\0') {
            (void)snprintf(err, err_size, "\"%s\" is no fault; expected NAME VALUE", line);
            return false;
        }
        if (!faults_add(b, fault_find(name), value, err, err_size))
            return false;
        length += length < n;
        text += length;
        n -= length;
    }
    return true;
}

uint64_t faults_next(const struct board *b, bool asleep)
{
    const struct faults *f = b->faults;
    uint64_t next = BOARD_NEVER;
    for (size_t i = 0; i < f->n; i++) {
        const struct waiting *w = &f->waiting[i];
        uint64_t at = board_cycles_at(b, w->at_ns);
        if (w->at_instruction != BOARD_NEVER)
            at = w->at_instruction <= b->instructions ? b->cycles
                 : asleep                             ? BOARD_NEVER
                          : b->cycles + (w->at_instruction - b->instructions);
        next = at < next ? at : next;
    }
    return next;
}

static void run(struct board *b, uint64_t now, uint64_t instruction)
{
    struct faults *f = b->faults;
    size_t i = 0;
    while (i < f->n) {
        struct waiting w = f->waiting[i];
        bool due =
            w.at_instruction != BOARD_NEVER ? w.at_instruction <= instruction : w.at_ns <= now;
        if (!due) {
            i++;
            continue;
        }
        (void)memmove(&f->waiting[i], &f->waiting[i + 1], (f->n - i - 1u) * sizeof(w));
        f->n--;
        if (w.kind == FAULT_SUPPLY_RAMP)
            f->ramp_ns = w.ramp_ns;
        carry_out(f, w.kind, w.value);
    }
}

void faults_run(struct board *b)
{
    if (b->faults->n != 0)
        run(b, board_ns(b), b->instructions);
}

void faults_run_at_stop(struct board *b)
{
    uint64_t ahead = faults_next(b, false) - b->cycles; /* instructions of an IT block, at most */
    run(b, board_ns(b) + (ahead * 1000000000u + b->core_hz - 1u) / b->core_hz,
        b->instructions + ahead);
}

bool faults_take_flash_cut(struct board *b)
{
    struct stored_flash *s = stored_flash(b);
    if (!s->cut)
        return false;
    cut_power(b->faults, b->faults->off_ns);
    s->cut = false;
    s->cut_word = s->cut_erase = 0;
    return true;
}

struct faults *faults_new(struct board *b)
{
    struct faults *f = calloc(1, sizeof(*f));
    if (f == NULL)
        abort();
    f->board = b;
    f->off_ns = f->next_ramp_ns = (uint64_t)S;
    f->random = random_state(b->around.seed);
    struct {
        struct board_event *event;
        void (*due)(void *);
    } events[] = {{&f->power, power_back},
                  {&f->button, button_up},
                  {&f->ramp, ramp_step},
                  {&f->replug[0], replug_console},
                  {&f->replug[1], replug_link}};
    for (size_t i = 0; i < sizeof(events) / sizeof(events[0]); i++) {
        *events[i].event =
            (struct board_event){.due = events[i].due, .context = f, .outlives_reset = true};
        board_add_event(b, events[i].event);
    }
    return f;
}

void faults_free(struct faults *f)
{
    free(f);
}
