/* Non-volatile memory: sectors 10 and 11 of the flash, the last 256 KiB (RM0090 chapter 3).
 *
 * The emulator's flash silently ignores all of this, so that every operation there ends in ERR_IO.
 * An erase takes 1 s, at most 2 s (128 KiB, 32 bits in parallel; 4 s by single bytes: the STM32F405's data sheet,
 * DS8626, flash memory programming). The core stands still then whenever it needs an instruction from the flash, so
 * nobody feeds the watchdog, and the usual 2 s of it are 1.4 s where its clock is fast: it gets a longer time-out
 * for the erase, and the usual one after it.
 */
#include <string.h>

#include "board.h"
#include "hal/nvm.h"
#include "registers.h"

#define AREA         0x080C0000u
#define FIRST_SECTOR 10u
#define SECTORS      2u
#define SECTOR_SIZE  0x20000u
#define WORD         4u /* program unit: 32 bits in parallel, good for 2.7 V to 3.6 V */

/* Turns of the waiting loop, about ten cycles each when nothing stalls it: 12 ms and 4.8 s at 168 MHz. */
#define PROGRAM_TURNS 200000u
#define ERASE_TURNS   80000000u
#define ERASE_MS      8000u /* for the watchdog: 5.4 s where its clock is fast */

void hal_nvm_get_geometry(struct hal_nvm_geometry *geometry)
{
    *geometry = (struct hal_nvm_geometry){
        .sectors = SECTORS, .sector_size = SECTOR_SIZE, .program_size = WORD, .erased = 0xFF};
}

static bool inside(uint32_t address, uint32_t n)
{
    return address <= SECTORS * SECTOR_SIZE && n <= SECTORS * SECTOR_SIZE - address;
}

/* volatile: the compiler must not think it knows what is there. */
static const volatile uint32_t *word_at(uint32_t address)
{
    return (const volatile uint32_t *)(uintptr_t)(AREA + address);
}

static enum err wait_done(uint32_t turns)
{
    while ((FLASH_SR & FLASH_SR_BSY) != 0) {
        if (turns-- == 0) {
            return ERR_TIMEOUT;
        }
    }
    return (FLASH_SR & FLASH_SR_ERRORS) != 0 ? ERR_IO : ERR_OK;
}

static enum err unlock(void)
{
    if ((FLASH_CR & FLASH_CR_LOCK) != 0) {
        FLASH_KEYR = FLASH_KEY1;
        FLASH_KEYR = FLASH_KEY2;
    }
    FLASH_SR = FLASH_SR_ERRORS;
    return wait_done(PROGRAM_TURNS);
}

/* The data cache still holds what was there before. */
static void lock_and_forget_cache(void)
{
    FLASH_CR = FLASH_CR_LOCK;
    uint32_t acr = FLASH_ACR;
    FLASH_ACR = acr & ~FLASH_ACR_DCEN;
    FLASH_ACR = (acr & ~FLASH_ACR_DCEN) | FLASH_ACR_DCRST;
    FLASH_ACR = acr & ~FLASH_ACR_DCEN;
    FLASH_ACR = acr;
    __asm volatile("dsb\n\tisb" ::: "memory");
}

enum err hal_nvm_read(uint32_t address, void *data, uint32_t n)
{
    if (!inside(address, n)) {
        return ERR_RANGE;
    }
    const volatile uint8_t *from = (const volatile uint8_t *)word_at(0) + address;
    uint8_t *to = data;
    /* From the flash each time: a reading that went wrong would stay in the data cache. */
    uint32_t acr = FLASH_ACR;
    FLASH_ACR = acr & ~FLASH_ACR_DCEN;
    for (uint32_t i = 0; i < n; i++) {
        to[i] = from[i];
    }
    FLASH_ACR = acr;
    return ERR_OK;
}

enum err hal_nvm_program(uint32_t address, const void *data, uint32_t n)
{
    const uint8_t *from = data;
    if (!inside(address, n) || address % WORD != 0 || n % WORD != 0) {
        return ERR_RANGE;
    }
    for (uint32_t i = 0; i < n; i += WORD) {
        uint32_t word;
        memcpy(&word, from + i, WORD);
        if (*word_at(address + i) != UINT32_MAX && word != 0) {
            return ERR_IO;
        }
    }
    enum err result = unlock();
    if (result == ERR_OK) {
        FLASH_CR = FLASH_CR_PSIZE32 | FLASH_CR_PG;
        for (uint32_t i = 0; i < n && result == ERR_OK; i += WORD) {
            if (supply_is_low()) {
                result = ERR_STATE;
                break;
            }
            uint32_t word;
            memcpy(&word, from + i, WORD);
            REG32(AREA + address + i) = word;
            __asm volatile("dsb" ::: "memory");
            result = wait_done(PROGRAM_TURNS);
        }
    }
    lock_and_forget_cache();
    for (uint32_t i = 0; i < n && result == ERR_OK; i += WORD) {
        uint32_t word;
        memcpy(&word, from + i, WORD);
        if (*word_at(address + i) != word) {
            result = ERR_IO;
        }
    }
    return result;
}

enum err hal_nvm_erase(uint32_t sector)
{
    if (sector >= SECTORS) {
        return ERR_RANGE;
    }
    if (supply_is_low()) {
        return ERR_STATE;
    }
    struct watchdog_time usual = watchdog_change(watchdog_time(ERASE_MS, LSI_PER_MS));
    enum err result = unlock();
    if (result == ERR_OK) {
        FLASH_CR = FLASH_CR_PSIZE32 | FLASH_CR_SER | FLASH_CR_SNB(FIRST_SECTOR + sector);
        FLASH_CR |= FLASH_CR_STRT;
        __asm volatile("dsb" ::: "memory");
        result = wait_done(ERASE_TURNS);
    }
    lock_and_forget_cache();
    (void)watchdog_change(usual);
    for (uint32_t i = 0; i < SECTOR_SIZE && result == ERR_OK; i += WORD) {
        if (*word_at(sector * SECTOR_SIZE + i) != UINT32_MAX) {
            result = ERR_IO;
        }
    }
    return result;
}
