#include "flash_model.h"

#include <string.h>

#include "hal/nvm.h"
#include "hal/self_check.h"

uint8_t flash_model[FLASH_MODEL_SIZE];
bool (*flash_model_keep)(uint32_t address, uint32_t n);
void (*flash_model_glance)(uint32_t address, uint8_t *data, uint32_t n);
bool flash_model_supply_low;
bool flash_model_brown_out_off;

void flash_model_erase_all(void)
{
    memset(flash_model, 0xFF, sizeof flash_model);
}

static bool inside(uint32_t address, uint32_t n)
{
    return address <= FLASH_MODEL_SIZE && n <= FLASH_MODEL_SIZE - address;
}

static bool kept(uint32_t address, uint32_t n)
{
    return !flash_model_keep || flash_model_keep(address, n);
}

void hal_nvm_get_geometry(struct hal_nvm_geometry *geometry)
{
    *geometry = (struct hal_nvm_geometry){.sectors = FLASH_MODEL_SECTORS,
                                          .sector_size = FLASH_MODEL_SECTOR_SIZE,
                                          .program_size = FLASH_MODEL_PROGRAM_SIZE,
                                          .erased = 0xFF};
}

enum err hal_nvm_read(uint32_t address, void *data, uint32_t n)
{
    if (!inside(address, n))
        return ERR_RANGE;
    memcpy(data, flash_model + address, n);
    if (flash_model_glance)
        flash_model_glance(address, data, n);
    return ERR_OK;
}

/* May these bytes be programmed there? The chips' ports refuse as well, though one of them could clear more bits. */
static bool may_program(uint32_t address, const uint8_t *data, uint32_t n)
{
    uint8_t there[FLASH_MODEL_PROGRAM_SIZE];
    for (uint32_t i = 0; i < n; i += sizeof there) {
        bool erased = true, zero = true;
        if (hal_nvm_read(address + i, there, sizeof there) != ERR_OK)
            return false;
        for (uint32_t k = 0; k < sizeof there; k++) {
            erased = erased && there[k] == 0xFF;
            zero = zero && data[i + k] == 0;
        }
        if (!erased && !zero)
            return false;
    }
    return true;
}

enum err hal_nvm_program(uint32_t address, const void *data, uint32_t n)
{
    if (!inside(address, n) || address % FLASH_MODEL_PROGRAM_SIZE != 0 ||
        n % FLASH_MODEL_PROGRAM_SIZE != 0)
        return ERR_RANGE;
    if (!may_program(address, data, n))
        return ERR_IO;
    if (flash_model_supply_low)
        return ERR_STATE;
    memcpy(flash_model + address, data, n);
    return kept(address, n) ? ERR_OK : ERR_IO;
}

enum err hal_nvm_erase(uint32_t sector)
{
    if (sector >= FLASH_MODEL_SECTORS)
        return ERR_RANGE;
    if (flash_model_supply_low)
        return ERR_STATE;
    memset(flash_model + (size_t)sector * FLASH_MODEL_SECTOR_SIZE, 0xFF, FLASH_MODEL_SECTOR_SIZE);
    return kept(sector * FLASH_MODEL_SECTOR_SIZE, FLASH_MODEL_SECTOR_SIZE) ? ERR_OK : ERR_IO;
}

bool hal_brown_out_off(void)
{
    return flash_model_brown_out_off;
}
