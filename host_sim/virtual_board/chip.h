/* What a chip is made of: which model stands at which address, on which clock and interrupt. A chip is one table of this kind.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#ifndef REFLUX_VIRTUAL_BOARD_CHIP_H
#define REFLUX_VIRTUAL_BOARD_CHIP_H

#include "board.h"

/* A register. Bits outside `defined` are reserved: they are written as they are after reset. Bits outside `writable` ignore what is written. */
struct reg {
    const char *name;
    uint16_t offset;
    uint32_t reset, defined, writable;
};

enum access_width { WIDTH_BYTE = 1, WIDTH_HALF = 2, WIDTH_WORD = 4 };

/* A model of one kind of part. */
struct part_class {
    const char *name;
    const struct reg *regs;
    size_t n_regs;
    size_t state_bytes;
    uint8_t widths; /* of access that the manual allows: a sum of enum access_width */
    bool (*only_words)(uint32_t offset); /* NULL, or of which registers only words */
    void (*start)(struct part *p);       /* once */
    void (*stop)(struct part *p);        /* gives back what it has beside its state */
    void (*reset)(struct part *p, enum board_reset kind);
    /* A reset of this part alone, by the RCC; NULL: not modelled. */
    void (*restart)(struct part *p);
    /* What is read in place of the stored word; NULL: the stored word. */
    uint32_t (*read)(struct part *p, uint32_t offset, uint32_t stored);
    /* After the word has been stored; before: what was there. NULL: nothing happens. */
    void (*write)(struct part *p, uint32_t offset, uint32_t before, uint32_t written);
};

struct chip_part {
    const char *name;
    const struct part_class *class;
    uint32_t base, size;
    const char *bus;        /* "ahb1" (one chip: "ahb"), "apb1", "apb2", "core": whose clock */
    uint16_t enable_offset; /* of the RCC; 0: always on */
    uint8_t enable_bit;
    uint8_t irq;    /* 0xFF: none */
    uint8_t number; /* which of several of its class */
};

enum memory_kind { MEMORY_FLASH, MEMORY_RAM, MEMORY_CORE_RAM };

struct chip_memory {
    enum memory_kind kind;
    uint32_t base, size;
};

/* The RCC's model, asked by others. Hz; bus: as in struct chip_part. */
struct clocks {
    uint64_t (*bus_hz)(struct board *b, const char *bus);
    uint64_t (*timer_hz)(struct board *b, const char *bus);
    uint64_t (*rtc_hz)(struct board *b); /* 0: none chosen, or it does not run */
    bool (*crystal_runs)(struct board *b);
    void (*crystal_changed)(struct board *b); /* around.crystal_hz is another */
};

/* The pins of a chip, asked by others; pin: of this port, 0 to 15. */
struct pins_model {
    enum pin_drive (*drive)(const struct part *p, unsigned pin);
    bool (*pulled_up)(const struct part *p, unsigned pin); /* where nothing is wired to it */
    bool (*is_analog)(const struct part *p, unsigned pin);
    bool (*is_open_drain)(const struct part *p, unsigned pin);
    unsigned (*speed)(const struct part *p, unsigned pin); /* pins.h */
};

struct chip {
    const char *name;
    int cpu_model; /* of the processor library */
    bool fpu;
    uint32_t cpuid;
    uint32_t mpu_regions;
    uint32_t ccr_reset;
    uint8_t priority_bits;
    uint16_t interrupts;
    uint32_t internal_hz;
    uint32_t slow_clock_hz, slow_clock_least,
        slow_clock_most; /* of the watchdog: nominal, and over chips and temperature */
    const struct chip_memory *memory;
    size_t n_memory;
    uint32_t stored_base, stored_size; /* flash that the firmware writes */
    uint32_t factory_base;             /* page with bytes of the factory; 0: not modelled */
    uint32_t flash_control;            /* address of FLASH_CR */
    uint32_t flash_cache; /* of FLASH_ACR, whose bit 10 turns a cache of data on; 0: none */
    void (*store)(struct board *b, uint32_t at, unsigned bytes, uint32_t word); /* into it */
    const struct clocks *clocks;
    uint8_t (*pin_function)(struct board *b, char port, unsigned pin); /* models/models.h */
    const struct pins_model *pins;
    uint8_t usart_function; /* what that says of a pin that is given to a serial port */
    const struct chip_part *parts;
    size_t n_parts;
};

struct part {
    struct board *board;
    const struct chip_part *row;
    uint32_t *words; /* in the order of the class's registers, and one for what is none of them */
    uint8_t *index;  /* of the word at each offset, in words */
    void *state;
    bool held_in_reset; /* by the RCC */
};

extern const struct chip chip_stm32f405, chip_stm32f100;

/* chips.c: the first chip whose name is in the text, capitals or not; NULL: none. */
const struct chip *chip_named_in(const char *text);

/* models/stored_flash.c; at: from the beginning of what is stored */
uint32_t stored_flash_read(struct board *b, uint32_t at, unsigned bytes);
/* Its bytes, where a read gives these and has no other effect; NULL: reads and stores go to the model. */
uint8_t *stored_flash_plain(struct board *b);

/* bus.c */
void bus_start(struct board *b);
void bus_stop(struct board *b);
void bus_reset(struct board *b, enum board_reset kind);
uint32_t bus_read(struct board *b, uint32_t address, unsigned bytes);
void bus_write(struct board *b, uint32_t address, unsigned bytes, uint32_t value);
/* name: one that lives as long as the board, a literal. NULL: the chip has none. */
struct part *bus_part(struct board *b, const char *name);
struct part *pins_part(struct board *b, char port); /* port: 'A' to 'D'; NULL: the chip has none */
uint32_t part_get(const struct part *p, uint32_t offset);
void part_set(struct part *p, uint32_t offset, uint32_t word);

/* processor.c */
bool processor_start(struct board *b, const uint8_t *image, size_t image_bytes, bool exact,
                     char *err, size_t err_size);
void processor_stop(struct board *b);
void processor_reset(struct board *b);
void processor_scramble(struct board *b); /* memory at power-on */
void processor_run(struct board *b, uint64_t until_cycles);
uint32_t processor_pc(struct board *b); /* of the instruction that runs, or comes next */
uint8_t *processor_memory(struct board *b, uint32_t address,
                          uint32_t bytes); /* NULL: not memory, or not all of it */
void processor_attend(
    struct board *b); /* an interrupt may have become pending: look at the next block */
/* A reset ends what runs at the next block. */
void processor_break(struct board *b);
void processor_protection_changed(struct board *b);
void processor_stored_changed(struct board *b); /* stored_flash_plain() may say another thing */

/* For faults: sets R0 to R15, S0 to S31, or flips a bit of one; forgets how code was counted and translated. */
#define REGISTER_PC 15u
void processor_set_register(struct board *b, uint32_t number, uint32_t value);
void processor_flip_register(struct board *b, uint32_t number, uint32_t bit);
void processor_forget_code(struct board *b);
uint32_t processor_image_bytes(const struct board *b);
/* Steps by instructions from the block on that begins at this cycle or after it; the first access that fails is then `found`. */
void processor_exact_from(struct board *b, uint64_t cycle);
bool processor_pc_is_exact(struct board *b);
void processor_set_fpu(struct board *b, bool on);

/* system_control.c */
struct interrupts;
struct interrupts *interrupts_new(struct board *b);
void interrupts_free(struct interrupts *i);
void interrupts_reset(struct interrupts *i);
struct interrupts *processor_interrupts(struct board *b);
void interrupt_line(struct board *b, unsigned irq, bool high);
void interrupt_nmi(struct board *b, bool high);

#endif
