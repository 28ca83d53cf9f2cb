/* Flash in memory, for the ports that have none: hal/nvm.h with its rules enforced (erased before program but for
 * zeros, whole units, aligned). Shared by the host and the memory port. */
#ifndef REFLUX_HAL_FLASH_MODEL_H
#define REFLUX_HAL_FLASH_MODEL_H

#include <stdbool.h>
#include <stdint.h>

#define FLASH_MODEL_SECTORS      2u
#define FLASH_MODEL_SECTOR_SIZE  16384u
#define FLASH_MODEL_PROGRAM_SIZE 4u
#define FLASH_MODEL_SIZE         (FLASH_MODEL_SECTORS * FLASH_MODEL_SECTOR_SIZE)

extern uint8_t flash_model[FLASH_MODEL_SIZE];
/* Called after each change of n bytes at address; false = the change could not be kept. NULL = keep nothing. */
extern bool (*flash_model_keep)(uint32_t address, uint32_t n);
/* Called with what each read has found, which it may change: flash whose words do not read the same each time. NULL =
 * every word reads as it was written. */
extern void (*flash_model_glance)(uint32_t address, uint8_t *data, uint32_t n);
void flash_model_erase_all(void); /* without keeping */
/* As with a supply too low for a write. */
extern bool flash_model_supply_low;
/* As on a board whose brown-out reset is off. */
extern bool flash_model_brown_out_off;

#endif
