/* Non-volatile memory: the last 8 KiB of the flash, as two sectors of four pages each (PM0063).
 *
 * The emulator's flash silently ignores all of this, so that every operation there ends in ERR_IO.
 * The erase of a sector takes up to 160 ms, in which the core stands still whenever it needs an instruction from
 * the flash. Flash is programmed by half-words, with the internal oscillator running (it always is). A half-word that is
 * not erased takes nothing but zero (PM0063, programming of the main memory).
 */
#include "hal/nvm.h"
#include "board.h"
#include "hal/watchdog.h"
#include "registers.h"

#define AREA        0x0801E000u
#define SECTORS     2u
#define SECTOR_SIZE 0x1000u
#define PAGE_SIZE   0x400u
#define HALF        2u

/* Turns of the waiting loop, about ten cycles each when nothing stalls it: 8 ms and 0.8 s at 24 MHz. */
#define PROGRAM_TURNS 20000u
#define ERASE_TURNS   2000000u

void hal_nvm_get_geometry(struct hal_nvm_geometry *geometry)
{
    *geometry = (struct hal_nvm_geometry){
        .sectors = SECTORS, .sector_size = SECTOR_SIZE, .program_size = HALF, .erased = 0xFF};
}

static bool inside(uint32_t address, uint32_t n)
{
    return address <= SECTORS * SECTOR_SIZE && n <= SECTORS * SECTOR_SIZE - address;
}

/* volatile: the compiler must not think it knows what is there. */
static uint16_t half_at(uint32_t address)
{
    return REG16(AREA + address);
}

static uint16_t half_of(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] | ((unsigned)bytes[1] << 8));
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
    FLASH_SR = FLASH_SR_ERRORS | FLASH_SR_EOP;
    return wait_done(PROGRAM_TURNS);
}

enum err hal_nvm_read(uint32_t address, void *data, uint32_t n)
{
    uint8_t *to = data;
    if (!inside(address, n)) {
        return ERR_RANGE;
    }
    for (uint32_t i = 0; i < n; i++) {
        to[i] = REG8(AREA + address + i);
    }
    return ERR_OK;
}

enum err hal_nvm_program(uint32_t address, const void *data, uint32_t n)
{
    const uint8_t *from = data;
    if (!inside(address, n) || address % HALF != 0 || n % HALF != 0) {
        return ERR_RANGE;
    }
    for (uint32_t i = 0; i < n; i += HALF) {
        if (half_at(address + i) != UINT16_MAX && half_of(from + i) != 0) {
            return ERR_IO;
        }
    }
    enum err result = unlock();
    if (result == ERR_OK) {
        FLASH_CR = FLASH_CR_PG;
        __asm volatile("dsb" ::: "memory"); /* flash and registers are not in order */
        for (uint32_t i = 0; i < n && result == ERR_OK; i += HALF) {
            if (supply_is_low()) {
                result = ERR_STATE;
                break;
            }
            REG16(AREA + address + i) = half_of(from + i);
            __asm volatile("dsb" ::: "memory");
            result = wait_done(PROGRAM_TURNS);
        }
    }
    FLASH_CR = FLASH_CR_LOCK;
    for (uint32_t i = 0; i < n && result == ERR_OK; i += HALF) {
        if (half_at(address + i) != half_of(from + i)) {
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
    enum err result = unlock();
    for (uint32_t page = 0; page < SECTOR_SIZE && result == ERR_OK; page += PAGE_SIZE) {
        if (supply_is_low()) {
            result = ERR_STATE;
            break;
        }
        hal_watchdog_feed(); /* nothing else runs until the page is done */
        FLASH_CR = FLASH_CR_PER;
        FLASH_AR = AREA + sector * SECTOR_SIZE + page;
        FLASH_CR = FLASH_CR_PER | FLASH_CR_STRT;
        __asm volatile("dsb" ::: "memory");
        result = wait_done(ERASE_TURNS);
    }
    FLASH_CR = FLASH_CR_LOCK;
    hal_watchdog_feed();
    for (uint32_t i = 0; i < SECTOR_SIZE && result == ERR_OK; i += HALF) {
        if (half_at(sector * SECTOR_SIZE + i) != UINT16_MAX) {
            result = ERR_IO;
        }
    }
    return result;
}
