/* Non-volatile memory: sectors 10 and 11 of the flash, the last 256 KiB (RM0090 chapter 3).
 *
 * The emulator's flash silently ignores all of this, so that every operation there ends in ERR_IO.
 * An erase takes 1 s, at most 2 s (128 KiB, 32 bits in parallel; 4 s by single bytes: the STM32F405's data sheet,
 * DS8626, flash memory programming). The core stands still then whenever it needs anything from the flash, and that is also the vector of
 * an interrupt. So a loop in RAM waits for the end, with interrupts held off. It feeds the watchdog, because the usual 2 s are 1.4 s where
 * the watchdog's clock is fast; it watches the supply; and it keeps the plant link alive. The board's clock stands still meanwhile.
 */
#include <string.h>

#include "app/app.h"
#include "board.h"
#include "hal/nvm.h"
#include "hal/tick.h"
#include "registers.h"

#define AREA         0x080C0000u
#define FIRST_SECTOR 10u
#define SECTORS      2u
#define SECTOR_SIZE  0x20000u
#define WORD         4u /* program unit: 32 bits in parallel, good for 2.7 V to 3.6 V */

#define PROGRAM_TURNS 200000u /* of about ten cycles: 12 ms at 168 MHz */
#define ERASE_MS      5000u

/* The last frame may be 500 ms old when an erase begins. After the last keep-alive, at 2.25 s, the flash is taken for broken: the board
 * falls silent, and 2 s later the plant goes safe. */
#define ALIVE_FIRST_MS 250u
#define ALIVE_EVERY_MS 500u
#define ALIVE_FRAMES   5u

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
    __asm volatile("dsb" ::: "memory"); /* flash and registers are not in order */
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
        __asm volatile("dsb" ::: "memory");
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

struct erase {
    uint32_t control; /* of FLASH_CR */
    bool supply_fell;
    size_t alive_bytes; /* of one frame; 0: no plant is there */
    uint8_t alive[ALIVE_FRAMES][APP_KEEP_ALIVE_BYTES];
};

/* Interrupts are held off. */
RAM_CODE("erase") CALLED_FROM_FLASH static void erase_from_ram(struct erase *e)
{
    uint32_t ms = 0, next_ms = ALIVE_FIRST_MS;
    size_t frame = 0, at = 0;
    FLASH_CR = e->control | FLASH_CR_STRT;
    __asm volatile("dsb" ::: "memory");
    while ((FLASH_SR & FLASH_SR_BSY) != 0 && ms < ERASE_MS) {
        IWDG_KR = IWDG_KR_RELOAD;
        e->supply_fell |= (PWR_CSR & PWR_CSR_PVDO) != 0;
        ms += (SYST_CSR & SYST_CSR_COUNTFLAG) != 0;
        bool due = frame < ALIVE_FRAMES && e->alive_bytes != 0 && ms >= next_ms;
        if (uart_serve_link(due ? &e->alive[frame][at] : NULL) && ++at == e->alive_bytes) {
            at = 0;
            frame++;
            next_ms += ALIVE_EVERY_MS;
        }
        /* Sleeps until a byte comes or a millisecond is over: what is pending wakes, although it is masked. */
        SCB_ICSR = SCB_ICSR_PENDSTCLR | SCB_ICSR_PENDSVCLR;
        NVIC_ICPR(USART2_IRQ / 32u) = BIT(USART2_IRQ % 32u);
        __asm volatile("dsb\n\twfi" ::: "memory");
    }
}

static bool erase_sector(uint32_t sector)
{
    struct erase e = {.control =
                          FLASH_CR_PSIZE32 | FLASH_CR_SER | FLASH_CR_SNB(FIRST_SECTOR + sector)};
    hal_tick_lock();
    for (unsigned i = 0; i < ALIVE_FRAMES; i++) {
        e.alive_bytes = app_keep_alive(app_instance(), e.alive[i]);
    }
    hal_tick_unlock();
    FLASH_CR = e.control;
    __asm volatile("cpsid i" ::: "memory");
    uart_hold_interrupts(true);
    erase_from_ram(&e);
    uart_hold_interrupts(false);
    __asm volatile("cpsie i\n\tisb" ::: "memory");
    hal_tick_request(); /* bytes wait for it */
    return !e.supply_fell;
}

enum err hal_nvm_erase(uint32_t sector)
{
    if (sector >= SECTORS) {
        return ERR_RANGE;
    }
    if (supply_is_low()) {
        return ERR_STATE;
    }
    enum err result = unlock();
    if (result == ERR_OK) {
        bool supplied = erase_sector(sector);
        result = wait_done(PROGRAM_TURNS);
        if (!supplied) {
            result = ERR_STATE;
        }
    }
    lock_and_forget_cache();
    for (uint32_t i = 0; i < SECTOR_SIZE && result == ERR_OK; i += WORD) {
        if (*word_at(sector * SECTOR_SIZE + i) != UINT32_MAX) {
            result = ERR_IO;
        }
    }
    return result;
}
