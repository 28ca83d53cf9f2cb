/* The workspace lies in the 64 KiB of core-coupled memory (CCM). It is no part of the bus matrix: only the processor reaches it (RM0090
 * 2.1), by loads and stores. So nothing else lies there; stm32f405.ld and tools/image see to it.
 *
 * QEMU 7.2 has no CCM, and a load there is a bus fault. Its SRAM goes on for 64 KiB behind the chip's 128 KiB, and the end of that holds
 * the workspace instead. Start-up finds out by reading one word of the CCM. Meanwhile interrupts are held off, and a vector table of its
 * own makes a bus fault skip the load. The first barrier lets faults of earlier accesses find the usual table.
 */
#include "hal/workspace.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include "base/workspace.h"
#include "board.h"
#include "registers.h"

#define LOAD_BYTES 4u /* of ldr.w */
#define FRAME_PC   6  /* word of an exception frame: PM0214 2.3.7 */

static _Alignas(max_align_t) uint8_t workspace_memory[WORKSPACE_BYTES];
extern uint8_t workspace_stand_in[]; /* from the linker script */

static volatile bool ccm_faulted;

void probe_fault(void);
void probe_skip_load(uint32_t *frame);

/* SCB_VTOR wants the alignment that a table with all of the chip's interrupts needs (PM0214 4.4.4). Interrupts have no entries, because
 * none can occur while this table is in force. */
__attribute__((section(".vectors.probe"),
               aligned(512))) static const union vector probe_vectors[] = {
    [0] = {.address = stack_top},   [1] = {.handler = reset_entry}, [2] = {.handler = fault_entry},
    [3] = {.handler = fault_entry}, [4] = {.handler = fault_entry}, [5] = {.handler = probe_fault},
    [6] = {.handler = fault_entry},
};
_Static_assert(16 + CHIP_INTERRUPTS <= 128, "SCB_VTOR wants a coarser alignment");

__attribute__((naked)) void probe_fault(void)
{
    __asm volatile("mrs r0, msp\n\t"
                   "b probe_skip_load");
}

__attribute__((used)) void probe_skip_load(uint32_t *frame)
{
    frame[FRAME_PC] += LOAD_BYTES;
    SCB_CFSR = SCB_CFSR_PRECISERR | SCB_CFSR_BFARVALID; /* writing one clears */
    ccm_faulted = true;
}

static bool ccm_answers(void)
{
    uint32_t word, mask = mask_raise(PRIORITY_UART), vectors = SCB_VTOR;
    __asm volatile("dsb" ::: "memory");
    SCB_VTOR = (uint32_t)(uintptr_t)probe_vectors;
    __asm volatile("dsb\n\t"
                   "isb\n\t"
                   "ldr.w %0, [%1]\n\t"
                   "dsb"
                   : "=&r"(word)
                   : "r"(workspace_memory)
                   : "memory");
    SCB_VTOR = vectors;
    __asm volatile("dsb\n\tisb" ::: "memory");
    mask_restore(mask);
    return !ccm_faulted;
}

void *hal_workspace(void)
{
    /* The clock of the CCM runs from a reset on (RM0090 7.3.10). ST's boot loader is said to stop it before it starts a program. */
    RCC_AHB1ENR |= RCC_AHB1ENR_CCM;
    (void)RCC_AHB1ENR;
    return memset(ccm_answers() ? workspace_memory : workspace_stand_in, 0, WORKSPACE_BYTES);
}
