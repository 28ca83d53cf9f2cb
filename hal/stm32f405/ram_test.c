/* The way from reset to start-up: at power-on it tests the memory. March C- over all SRAM and core-coupled memory (CCM), with 0x55555555 and
 * its inverse, finds bits that are stuck, do not turn, or turn with a neighbour, and addresses that reach the wrong word. Nothing lies in
 * memory meanwhile, so it is written in registers alone.
 *
 * At any other reset nothing is tested, because .noinit and the fault record must survive. After a failure the flag of the power-on stays
 * (identity.c), so that every later reset tests again and nobody forgets. The core runs at 16 MHz: 10 accesses and about 52 cycles a word
 * are 160 ms for 192 KiB. A watchdog that runs from the reset on is fed at each of the six passes, at most 24 ms apart; its shortest time is
 * 348 ms (4 * 4096 periods of at most 47 kHz).
 */
#include "board.h"
#include "hal/self_check.h"
#include "registers.h"

/* Twice, because one of these words could be the one that is broken. */
static struct {
    uint32_t magic, at;
} failed[2] __attribute__((section(".noinit"), used));

#define MAGIC 0x52414D46u /* "RAMF" */

uint32_t hal_ram_failed_at(void)
{
    return failed[0].magic == MAGIC ? failed[0].at : failed[1].magic == MAGIC ? failed[1].at : 0;
}

/* r0 first word, r1 behind the last; r2 and r3 the patterns, r6 IWDG_KR, r7 what feeds it. Returns the address of the first word that was
 * wrong in r11, which is kept where it is not 0. Uses r4 and r5. */
__attribute__((naked, used)) static void march(void)
{
    __asm volatile("str r7, [r6]\n\t"
                   "mov r4, r0\n"
                   "1: str r2, [r4], #4\n\t"
                   "cmp r4, r1\n\t"
                   "bcc 1b\n\t"
                   "str r7, [r6]\n\t"
                   "mov r4, r0\n"
                   "2: ldr r5, [r4]\n\t"
                   "cmp r5, r2\n\t"
                   "bne 9f\n\t"
                   "str r3, [r4], #4\n\t"
                   "cmp r4, r1\n\t"
                   "bcc 2b\n\t"
                   "str r7, [r6]\n\t"
                   "mov r4, r0\n"
                   "3: ldr r5, [r4]\n\t"
                   "cmp r5, r3\n\t"
                   "bne 9f\n\t"
                   "str r2, [r4], #4\n\t"
                   "cmp r4, r1\n\t"
                   "bcc 3b\n\t"
                   "str r7, [r6]\n\t"
                   "mov r4, r1\n"
                   "4: ldr r5, [r4, #-4]!\n\t"
                   "cmp r5, r2\n\t"
                   "bne 9f\n\t"
                   "str r3, [r4]\n\t"
                   "cmp r4, r0\n\t"
                   "bhi 4b\n\t"
                   "str r7, [r6]\n\t"
                   "mov r4, r1\n"
                   "5: ldr r5, [r4, #-4]!\n\t"
                   "cmp r5, r3\n\t"
                   "bne 9f\n\t"
                   "str r2, [r4]\n\t"
                   "cmp r4, r0\n\t"
                   "bhi 5b\n\t"
                   "str r7, [r6]\n\t"
                   "mov r4, r0\n"
                   "6: ldr r5, [r4]\n\t"
                   "cmp r5, r2\n\t"
                   "bne 9f\n\t"
                   "adds r4, #4\n\t"
                   "cmp r4, r1\n\t"
                   "bcc 6b\n\t"
                   "bx lr\n"
                   "9: cmp r11, #0\n\t"
                   "it eq\n\t"
                   "moveq r11, r4\n\t"
                   "bx lr");
}

/* The noise of the memory at power-on tells one start from another; the test would wipe it out. */
__attribute__((naked)) void reset_entry(void)
{
    __asm volatile("ldr r0, =%c[csr]\n\t"
                   "ldr r1, [r0]\n\t"
                   "tst r1, %[power_on]\n\t"
                   "beq 8f\n\t"
                   "ldr r0, =%c[enable]\n\t"
                   "ldr r1, [r0]\n\t"
                   "orr r1, r1, %[ccm]\n\t"
                   "str r1, [r0]\n\t"
                   "ldr r1, [r0]\n\t" /* a clock needs two cycles to arrive */
                   "ldr r0, =stack_bottom\n\t"
                   "ldr r1, =stack_top\n\t"
                   "ldr r2, =2166136261\n\t"
                   "ldr r3, =16777619\n"
                   "7: ldr r4, [r0], #4\n\t"
                   "eors r2, r4\n\t"
                   "muls r2, r3\n\t"
                   "cmp r0, r1\n\t"
                   "bcc 7b\n\t"
                   "mov r10, r2\n\t"
                   "mov r11, #0\n\t"
                   "ldr r2, =0x55555555\n\t"
                   "mvn r3, r2\n\t"
                   "ldr r6, =%c[watchdog]\n\t"
                   "ldr r7, =%c[feed]\n\t"
                   "ldr r0, =sram_start\n\t"
                   "ldr r1, =sram_end\n\t"
                   "bl march\n\t"
                   "ldr r0, =%c[ccm_start]\n\t"
                   "ldr r1, =ccm_end\n\t"
                   "bl march\n\t"
                   "str r7, [r6]\n\t"
                   "ldr r0, =startup_noise\n\t"
                   "str r10, [r0]\n\t"
                   "cmp r11, #0\n\t"
                   "beq 8f\n\t"
                   "ldr r0, =failed\n\t"
                   "ldr r1, =%c[magic]\n\t"
                   "str r1, [r0]\n\t"
                   "str r11, [r0, #4]\n\t"
                   "str r1, [r0, #8]\n\t"
                   "str r11, [r0, #12]\n"
                   "8: b startup\n\t"
                   ".ltorg"
                   :
                   : [csr] "i"(RCC_CSR_ADDRESS), [power_on] "i"(RCC_CSR_PORRST),
                     [enable] "i"(RCC_AHB1ENR_ADDRESS), [ccm] "i"(RCC_AHB1ENR_CCM),
                     [watchdog] "i"(IWDG_KR_ADDRESS), [feed] "i"(IWDG_KR_RELOAD),
                     [magic] "i"(MAGIC), [ccm_start] "i"(CCM_START));
}
