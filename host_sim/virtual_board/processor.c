/* The core: code is run by the Unicorn library; sleep, stalls and time are here. Interrupts are taken between blocks of code, never within
 * one. Traps of unaligned access are not modelled.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core.h"
#include "faults.h"
#include "replay.h"
#include "thumb.h"

#define XPSR_IT 0x0600FC00u
#define WFI     0xBF30u

uint32_t core_access_pc(struct processor *p)
{
    struct board *b = p->board;
    if (p->exact) {
        b->found = p->exact_from != BOARD_NEVER;
        b->found_pc = p->pc;
        if (b->found)
            board_pause(b);
        return p->pc;
    }
    if (p->looked_for != b->cycles) {
        p->looked_for = b->cycles;
        p->looked_pc = p->block;
        p->looked_known = replay_find_pc(b, p->block_began, &p->looked_pc);
    }
    p->pc_known = p->looked_known;
    return p->looked_known ? p->looked_pc : p->block;
}

uint32_t processor_pc(struct board *b)
{
    struct processor *p = b->processor;
    if (p->failed_pc != 0)
        return p->failed_pc;
    return p->running ? core_access_pc(p) : core_get(p, UC_ARM_REG_PC) & ~1u;
}

bool processor_pc_is_exact(struct board *b)
{
    (void)processor_pc(b);
    return b->processor->pc_known;
}

uint32_t processor_image_bytes(const struct board *b)
{
    return b->processor->image_bytes;
}

struct interrupts *processor_interrupts(struct board *b)
{
    return b->processor->interrupts;
}

void processor_attend(struct board *b)
{
    b->processor->attend = true;
}

void processor_break(struct board *b)
{
    b->processor->slice_end = 0;
}

static bool takes_interrupts(const struct processor *p)
{
    return (core_get(p, UC_ARM_REG_XPSR) & XPSR_IT) ==
           0; /* the library cannot give back a half-done IT block */
}

/* While the flash answers no fetch: code in RAM runs on until an interrupt is taken, whose vector is in the flash. (That a read of data
 * from the flash stops the core as well is not modelled.) */
static bool runs_from_ram(const struct processor *p)
{
    return !p->locked_up && !in_flash(p, core_get(p, UC_ARM_REG_PC)) &&
           (!takes_interrupts(p) || interrupts_pick(p->interrupts, core_masks(p), false) == 0);
}

/* Nothing runs: time goes on to what comes next. */
static void pass_time(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    uint64_t next = board_cycles_at(b, b->next_ns), tick = systick_next(p->interrupts);
    if (tick < next)
        next = tick;
    if (b->stalled_until_ns != 0) {
        uint64_t stalled = board_cycles_at(b, b->stalled_until_ns);
        if (stalled < next)
            next = stalled;
    }
    uint64_t fault_at = faults_next(b, true);
    if (fault_at < next)
        next = fault_at;
    if (until < next)
        next = until;
    if (next > b->cycles)
        b->cycles = next;
}

void processor_exact_from(struct board *b, uint64_t cycle)
{
    b->processor->exact_from = cycle;
}

static uc_err start_library(struct processor *p)
{
    p->running = true;
    p->pc_known = p->exact;
    uc_err e = uc_emu_start(p->uc, core_get(p, UC_ARM_REG_PC) | 1u, UINT32_MAX - 1u, 0, 0);
    p->running = false;
    p->pc_known = true;
    return e;
}

static void on_step_end(uc_engine *uc, uint64_t address, uint32_t bytes, void *context)
{
    (void)address;
    (void)bytes;
    (void)context;
    (void)uc_emu_stop(uc);
}

/* Runs a block up to an instruction. Its translation is made anew with a hook there, and once more without. */
static uc_err step_to(struct processor *p, uint32_t block, uint32_t bytes, uint32_t to)
{
    uc_hook hook;
    if (uc_hook_add(p->uc, &hook, UC_HOOK_CODE, (void *)on_step_end, p, to, to) != UC_ERR_OK)
        return UC_ERR_HOOK;
    (void)uc_ctl_remove_cache(p->uc, block, block + bytes);
    p->stepping = true;
    uc_err e = start_library(p);
    p->stepping = false;
    (void)uc_hook_del(p->uc, hook);
    (void)uc_ctl_remove_cache(p->uc, block, block + bytes);
    return e;
}

/* Runs a block as far as the next fault of the hardware, or as far as an instruction for the unit for numbers while that is off. An
 * IT instruction and those that it governs are one place: where the fault falls among them, it comes before. */
static uc_err run_partly(struct processor *p, uint32_t block, uint32_t bytes)
{
    struct board *b = p->board;
    const uint8_t *code = processor_memory(b, block, bytes);
    uint32_t fpu = p->fpu_on || code == NULL ? bytes : thumb_first_fpu(code, bytes);
    uint32_t room = p->fault_at - b->cycles < bytes ? (uint32_t)(p->fault_at - b->cycles) : bytes;
    uint32_t to = code == NULL ? 0 : thumb_offset(code, bytes, room);
    bool no_fpu = fpu < to || (fpu < bytes && fpu <= to);
    uint32_t place = no_fpu ? fpu : to, governed = code == NULL ? 0 : thumb_it_start(code, place);
    uc_err e = UC_ERR_OK;
    if (governed != 0) {
        uint32_t n = thumb_count(code, governed);
        e = step_to(p, block, bytes, block + governed);
        b->cycles += n;
        b->instructions += n;
    }
    if (e != UC_ERR_OK || p->left || p->failed || p->divided_by_zero)
        return e;
    if (no_fpu) {
        exception_fault(p, EXCEPTION_USAGE_FAULT, CFSR_NOCP, 0, block + place);
        return e;
    }
    faults_run_at_stop(b);
    return e;
}

static void run_code(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    uint64_t end = board_cycles_at(b, b->next_ns), tick = systick_next(p->interrupts);
    if (tick < end)
        end = tick;
    if (until < end)
        end = until;
    p->slice_end = end;
    p->first = true;
    p->cut = p->left = p->failed = false;
    p->attend = interrupts_any(p->interrupts);
    p->fault_at = faults_next(b, false);
    if (b->cycles >= p->exact_from && !p->exact)
        code_hooks_exact(p);
    p->partly = 0;
    p->divided_by_zero = false;
    uc_err e = start_library(p);
    if (p->cut)
        core_set(p, UC_ARM_REG_PC, p->resume | 1u);
    if (p->partly != 0) {
        uint32_t bytes = p->partly;
        p->cut = false;
        e = run_partly(p, p->resume, bytes);
        if (e == UC_ERR_OK && !p->left && !p->failed && !p->divided_by_zero)
            return;
    }
    if (p->left) {
        exception_leave(p);
    } else if (p->divided_by_zero) {
        exception_fault(p, EXCEPTION_USAGE_FAULT, CFSR_DIVBYZERO, 0, core_get(p, UC_ARM_REG_PC));
    } else if (p->failed) {
        exception_of_access(p);
    } else if (e == UC_ERR_INSN_INVALID) {
        exception_fault(p, EXCEPTION_USAGE_FAULT, CFSR_UNDEFINSTR, 0, core_get(p, UC_ARM_REG_PC));
    } else if (e != UC_ERR_OK) {
        board_verdict(b, "the processor library: %s", uc_strerror(e));
    } else if (!p->cut) {
        uint32_t pc = core_get(p, UC_ARM_REG_PC) & ~1u;
        const uint8_t *before = processor_memory(b, pc - 2u, 2);
        p->sleeping = before != NULL && (before[0] | before[1] << 8) == WFI;
        if (!p->sleeping)
            board_verdict(b, "the processor library came back at 0x%08x for no reason", pc);
    }
}

void processor_run(struct board *b, uint64_t until)
{
    struct processor *p = b->processor;
    while (b->verdict[0] == '\0' && !b->paused && !b->reset_asked && !b->clock_changed &&
           b->cycles < until) {
        board_run_events(b);
        faults_run(b);
        if (b->held) {
            pass_time(b, until);
            continue;
        }
        systick_run(p->interrupts);
        if (b->reset_asked || b->paused || b->clock_changed)
            break;
        if (b->stalled_until_ns != 0 && board_ns(b) >= b->stalled_until_ns)
            b->stalled_until_ns = 0;
        if (b->stalled_until_ns != 0 && !runs_from_ram(p)) {
            pass_time(b, until);
            continue;
        }
        if (p->protection_changed)
            address_protect(p);
        if (p->stored_changed)
            address_map_stored(p);
        if (p->locked_up && interrupts_pick(p->interrupts, core_masks(p), false) == 0) {
            pass_time(b, until);
            continue;
        }
        p->locked_up = false;
        if (p->sleeping) {
            if (interrupts_pick(p->interrupts, core_masks(p), true) == 0) {
                pass_time(b, until);
                continue;
            }
            p->sleeping = false;
        }
        unsigned n = takes_interrupts(p) ? interrupts_pick(p->interrupts, core_masks(p), false) : 0;
        unsigned active = interrupts_active(p->interrupts);
        bool hangs = (b->hang_main && active == 0) ||
                     (b->hang_tick && active == EXCEPTION_PENDSV) ||
                     (b->hang_clock && active == EXCEPTION_SYSTICK);
        if (n == 0 && hangs)
            pass_time(b, until);
        else if (n != 0)
            exception_enter(p, n, core_get(p, UC_ARM_REG_PC));
        else
            run_code(b, until);
    }
}

void processor_reset(struct board *b)
{
    struct processor *p = b->processor;
    static const int cleared[] = {UC_ARM_REG_BASEPRI, UC_ARM_REG_PRIMASK, UC_ARM_REG_FAULTMASK,
                                  UC_ARM_REG_CONTROL, UC_ARM_REG_LR};
    uint32_t vector[2];
    (void)memcpy(vector, p->memory[0], sizeof(vector));
    p->fpu_on = false;
    b->clock_ms = 0;
    interrupts_reset(p->interrupts);
    p->sleeping = p->locked_up = p->left = p->failed = false;
    p->protection_changed = true;
    p->rules = (struct barrier_rules){.on = p->rules.on};
    for (size_t i = 0; i < sizeof(cleared) / sizeof(cleared[0]); i++)
        core_set(p, cleared[i], 0);
    core_set(p, UC_ARM_REG_XPSR, XPSR_THUMB);
    core_set(p, UC_ARM_REG_SP, vector[0] & ~3u);
    core_set(p, UC_ARM_REG_PC, vector[1]);
    p->pc = p->block = vector[1] & ~1u;
}

void processor_set_fpu(struct board *b, bool on)
{
    b->processor->fpu_on = on;
}

static int register_name(uint32_t number)
{
    static const int names[] = {UC_ARM_REG_R13, UC_ARM_REG_R14, UC_ARM_REG_R15};
    return number < 13   ? UC_ARM_REG_R0 + (int)number
           : number < 16 ? names[number - 13u]
                         : UC_ARM_REG_S0 + (int)number - 16;
}

void processor_set_register(struct board *b, uint32_t number, uint32_t value)
{
    core_set(b->processor, register_name(number), number == REGISTER_PC ? value | 1u : value);
}

void processor_flip_register(struct board *b, uint32_t number, uint32_t bit)
{
    uint32_t word = core_get(b->processor, register_name(number));
    processor_set_register(b, number, word ^ UINT32_C(1) << bit);
}

void processor_forget_code(struct board *b)
{
    struct processor *p = b->processor;
    (void)memset(p->counted, 0, flash_of(b->chip)->size / 2u * sizeof(*p->counted));
    code_hooks_forget(p);
}

bool processor_start(struct board *b, const uint8_t *image, size_t image_bytes, bool exact,
                     char *err, size_t err_size)
{
    const struct chip_memory *flash = flash_of(b->chip);
    struct processor *p = calloc(1, sizeof(*p));
    b->processor = p;
    p->board = b;
    p->exact = p->rules.on = exact;
    p->counted = calloc(flash->size / 2u, sizeof(*p->counted));
    p->interrupts = interrupts_new(b);
    if (image_bytes > flash->size || image_bytes < 8) {
        (void)snprintf(err, err_size, "an image of %zu bytes; the %s has %u of flash", image_bytes,
                       b->chip->name, flash->size);
        return false;
    }
    if (uc_open(UC_ARCH_ARM, UC_MODE_THUMB | UC_MODE_MCLASS, &p->uc) != UC_ERR_OK ||
        uc_ctl_set_cpu_model(p->uc, b->chip->cpu_model) != UC_ERR_OK || !address_map_memory(b, p) ||
        !address_map_windows(b, p)) {
        (void)snprintf(err, err_size, "the processor library could not be set up");
        return false;
    }
    (void)memcpy(p->memory[0], image, image_bytes);
    p->image_bytes = (uint32_t)image_bytes;
    p->fault_at = p->exact_from = BOARD_NEVER;
    if (!code_hooks_add(p)) {
        (void)snprintf(err, err_size, "the processor library took no hooks");
        return false;
    }
    if (b->chip->fpu) { /* the library looks at registers that this core does not have */
        core_set(p, UC_ARM_REG_C1_C0_2, 0xFu << 20);
        core_set(p, UC_ARM_REG_FPEXC, 0x40000000u);
    }
    return true;
}

void processor_stop(struct board *b)
{
    struct processor *p = b->processor;
    (void)uc_close(p->uc);
    for (size_t i = 0; i < b->chip->n_memory; i++)
        free(p->memory[i]);
    free(p->counted);
    interrupts_free(p->interrupts);
    free(p);
}
