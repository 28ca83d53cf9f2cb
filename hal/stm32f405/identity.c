/* Which board this is, why it started, how it starts again, and what is left of a fault. */
#include "hal/identity.h"
#include "board.h"
#include "registers.h"

#define MAGIC 0x52464C58u /* "RFLX" */

enum intent { INTENT_NONE, INTENT_REBOOT, INTENT_FAULT };

/* Lives through a reset, not through a loss of power. */
static struct {
    uint32_t magic;
    uint32_t boots;
    uint32_t boots_inverted; /* random bits do not pass for a record */
    uint32_t intent;
    struct {
        uint32_t pc, lr, psr, cfsr, hfsr, mmfar, bfar, exc_return;
    } fault;
} kept __attribute__((section(".noinit")));

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
    if (intent == INTENT_REBOOT || (flags & RCC_CSR_SFTRST) != 0) {
        return HAL_RESET_REQUESTED;
    }
    /* The pin is pulled by the chip itself too, so its flag accompanies every other one. */
    return (flags & RCC_CSR_PINRST) != 0 ? HAL_RESET_PIN : HAL_RESET_UNKNOWN;
}

void identity_start(void)
{
    bool valid = kept.magic == MAGIC && kept.boots == ~kept.boots_inverted;
    uint32_t flags = RCC_CSR; /* 0 in the emulator */

    cause = find_cause(flags, valid, kept.intent);
    RCC_CSR = flags | RCC_CSR_RMVF;
    if (!valid) {
        kept.magic = MAGIC;
        kept.boots = startup_noise;
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

_Noreturn void identity_fault(const uint32_t *frame, uint32_t exc_return)
{
    kept.fault.cfsr = SCB_CFSR;
    kept.fault.hfsr = SCB_HFSR;
    kept.fault.mmfar = SCB_MMFAR;
    kept.fault.bfar = SCB_BFAR;
    kept.fault.exc_return = exc_return;
    kept.fault.lr = kept.fault.pc = kept.fault.psr = 0;
    if (frame >= stack_bottom && frame + 8 <= stack_top) { /* else the stack itself is gone */
        kept.fault.lr = frame[5];
        kept.fault.pc = frame[6];
        kept.fault.psr = frame[7];
    }
    reset(INTENT_FAULT);
}

const char *hal_board_name(void)
{
    return "stm32f405";
}

const char *hal_board_text(void)
{
    return clock_is_model() ? "STM32F405, Cortex-M4F, in an emulator"
                            : "STM32F405, Cortex-M4F, chip";
}

enum hal_reset hal_reset_cause(void)
{
    return cause;
}

uint32_t hal_boot_id(void)
{
    return kept.boots;
}
