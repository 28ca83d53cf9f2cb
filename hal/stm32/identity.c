/* Which board this is, why it started, how it starts again, and what is left of a fault. */
#include "hal/identity.h"
#include "board.h"
#include "hal/clock.h"
#include "hal/retained.h"
#include "hal/self_check.h"
#include "registers.h"

#define MAGIC         0x52464C58u /* "RFLX" */
#define EXCEPTION_NMI 2u

enum intent { INTENT_NONE, INTENT_REBOOT, INTENT_FAULT, INTENT_CRYSTAL };

/* Lives through a reset, not through a loss of power. */
static struct {
    uint32_t magic;
    uint32_t boots;
    uint32_t boots_inverted; /* random bits do not pass for a record */
    uint32_t intent;
    uint32_t crystal_failed; /* MAGIC: since power-on */
    uint32_t fault_magic;    /* there is a fault, of start number fault_boot */
    uint32_t fault_boot;
    struct hal_fault fault;
} kept __attribute__((section(".noinit")));

static struct hal_retained_memory retained __attribute__((section(".noinit")));

static enum hal_reset cause;

static enum hal_reset find_cause(uint32_t flags, bool kept_valid, uint32_t intent)
{
    if ((flags & (RCC_CSR_IWDGRST | RCC_CSR_WWDGRST)) != 0) {
        return HAL_RESET_WATCHDOG;
    }
    if ((flags & (RCC_CSR_PORRST | RCC_CSR_BORRST)) != 0 || !kept_valid) {
        return HAL_RESET_POWER_ON;
    }
    if (intent == INTENT_FAULT) {
        return HAL_RESET_FAULT;
    }
    if (intent == INTENT_CRYSTAL) {
        return HAL_RESET_CRYSTAL;
    }
    if (intent == INTENT_REBOOT || (flags & RCC_CSR_SFTRST) != 0) {
        return HAL_RESET_REQUESTED;
    }
    /* The pin is pulled by the chip itself too, so its flag accompanies every other one. */
    return (flags & RCC_CSR_PINRST) != 0 ? HAL_RESET_PIN : HAL_RESET_UNKNOWN;
}

static bool kept_valid(void)
{
    return kept.magic == MAGIC && kept.boots == ~kept.boots_inverted;
}

bool identity_crystal_failed(void)
{
    return kept_valid() && kept.crystal_failed == MAGIC &&
           (RCC_CSR & (RCC_CSR_PORRST | RCC_CSR_BORRST)) == 0;
}

void identity_start(void)
{
    bool valid = kept_valid();
    uint32_t flags = RCC_CSR; /* 0 in the emulator */

    cause = find_cause(flags, valid, kept.intent);
    if (!BOARD_CHECKS || hal_ram_failed_at() == 0) { /* else the next start tests the RAM again */
        RCC_CSR = flags | RCC_CSR_RMVF;
    }
    if (!valid) {
        kept.magic = MAGIC;
        kept.boots = startup_noise;
        kept.fault_magic = 0;
    }
    if (cause == HAL_RESET_POWER_ON) {
        kept.crystal_failed = 0;
    }
    kept.boots++;
    kept.boots_inverted = ~kept.boots;
    kept.intent = INTENT_NONE;
}

static _Noreturn void reset(uint32_t intent)
{
    kept.intent = intent;
    __asm volatile("cpsid i\n\tdsb" ::: "memory");
    SCB_AIRCR = SCB_AIRCR_RESET;
    __asm volatile("dsb" ::: "memory");
    for (;;) {
    }
}

_Noreturn void hal_reboot(void)
{
    reset(INTENT_REBOOT);
}

/* The clock security system has seen the crystal fail: the core runs on from the internal oscillator, and everything that was
 * reckoned from the clock is wrong (baud rates, milliseconds, wait states). A fresh start reckons anew, without the
 * crystal, until the next power-on. */
static _Noreturn void crystal_failed(void)
{
    RCC_CIR |= RCC_CIR_CSSC;
    kept.crystal_failed = MAGIC;
    reset(INTENT_CRYSTAL);
}

_Noreturn void identity_fault(const uint32_t *frame, uint32_t exc_return)
{
    struct hal_fault fault = {.status = SCB_CFSR, .hard = SCB_HFSR};
    (void)exc_return;
    __asm volatile("mrs %0, ipsr" : "=r"(fault.exception));
    if (fault.exception == EXCEPTION_NMI && (RCC_CIR & RCC_CIR_CSSF) != 0) {
        crystal_failed();
    }
    if ((fault.status & SCB_CFSR_BFARVALID) != 0) {
        fault.address = SCB_BFAR;
    } else if ((fault.status & SCB_CFSR_MMARVALID) != 0) {
        fault.address = SCB_MMFAR;
    }
    if (frame >= stack_bottom && frame + 8 <= stack_top) { /* else the stack itself is gone */
        fault.lr = frame[5];
        fault.pc = frame[6];
        fault.psr = frame[7];
    }
    fault.in_tick = (fault.psr & 0x1FFu) == 14u; /* PendSV */
    fault.up_ms = (uint32_t)hal_clock_ms();
    kept.fault = fault;
    kept.fault_boot = kept.boots;
    kept.fault_magic = MAGIC;
    reset(INTENT_FAULT);
}

bool hal_last_fault(struct hal_fault *fault)
{
    if (kept.fault_magic != MAGIC) {
        return false;
    }
    *fault = kept.fault;
    fault->boots_ago = kept.boots - kept.fault_boot;
    return true;
}

void *hal_retained(enum hal_retained_area area, size_t n)
{
    return hal_retained_in(&retained, area, n);
}

enum hal_reset hal_reset_cause(void)
{
    return cause;
}

uint32_t hal_boot_id(void)
{
    return kept.boots;
}
