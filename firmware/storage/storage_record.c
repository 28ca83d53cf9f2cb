#include "storage/storage_record.h"

#include <string.h>

#include "hal/nvm.h"

#define READ_AT_ONCE 16u
#define READ_MOST    8u

enum err storage_read(uint32_t address, void *data, uint32_t n)
{
    uint8_t *to = data, again[READ_AT_ONCE];
    for (uint32_t at = 0; at < n; at += READ_AT_ONCE) {
        uint32_t part = n - at < READ_AT_ONCE ? n - at : READ_AT_ONCE;
        enum err err = hal_nvm_read(address + at, to + at, part);
        for (unsigned i = 0; i < READ_MOST && err == ERR_OK; i++) {
            err = hal_nvm_read(address + at, again, part);
            if (memcmp(to + at, again, part) == 0)
                break;
            memcpy(to + at, again, part);
        }
        if (err)
            return err;
    }
    return ERR_OK;
}

bool record_at(uint32_t address, uint32_t left, struct stored_record *r)
{
    uint8_t head[RECORD_HEAD];
    if (left < RECORD_HEAD || storage_read(address, head, sizeof head) != ERR_OK)
        return false;
    *r = (struct stored_record){
        .address = address, .id = get16(head), .type = head[2], .size = head[3]};
    if (left - RECORD_HEAD < r->size)
        return false;
    uint8_t id[RECORD_WIDE];
    if (RECORDS_ARE_WIDE && r->id == 0 && r->size >= sizeof id) {
        if (storage_read(address + RECORD_HEAD, id, sizeof id) != ERR_OK)
            return false;
        r->id = get32(id) >> 16 ? get32(id) : 0;
        r->wide = sizeof id;
    }
    return true;
}

bool record_parameter(const struct stored_record *r, const struct config *config,
                      struct parameter *p, bool *renamed)
{
    uint32_t id = r->id;
    *renamed = false;
    for (const struct storage_rename *rename = storage_renames; rename->from; rename++) {
        if (rename->from == (id & ~(uint32_t)0x3F)) {
            id = rename->to | (id & 0x3F);
            *renamed = true;
            break;
        }
    }
    return parameter_find_id(config, id, p) == ERR_OK;
}

static bool is_text(const struct parameter *p)
{
    return p->field->type == PARAMETER_NAME || p->field->type == PARAMETER_UNIT ||
           p->field->type == PARAMETER_KIND || p->field->type == PARAMETER_LIST;
}

/* Sets a parameter that is a number to the nearest allowed value. Returns whether that differs from f. */
static bool take_number(const struct parameter *p, struct config *config, float f, uint32_t exact,
                        bool is_whole)
{
    void *at = parameter_place(p, config);
    float lo = parameter_lo(p), hi = parameter_hi(p);
    if (p->field->type == PARAMETER_WORD) {
        lo = 0.0f;
        hi = (float)(parameter_words(p) - 1u);
    }
    bool outside = f < lo || f > hi;
    if (outside) {
        f = f < lo ? lo : hi;
        is_whole = false;
    }
    if (p->field->type == PARAMETER_FLOAT) {
        f = f == 0.0f ? 0.0f : f; /* no negative zero: equal settings have equal bits */
        memcpy(at, &f, sizeof f);
        return outside;
    }
    uint32_t u32 = is_whole ? exact : (uint32_t)f; /* 0 .. 1e6: fits */
    bool rounded = !is_whole && !outside && (float)u32 != f;
    if (p->field->type == PARAMETER_U32) {
        memcpy(at, &u32, sizeof u32);
    } else if (p->field->type == PARAMETER_U16) {
        uint16_t u16 = (uint16_t)u32;
        memcpy(at, &u16, sizeof u16);
    } else {
        *(uint8_t *)at = (uint8_t)u32;
    }
    return outside || rounded;
}

#define TEXT_MAX (CONFIG_BLOCKS ? BLOCK_NAMES_SIZE - 1u : CHANNEL_NAME_SIZE)
static bool take_text(const struct parameter *p, struct config *config, const char *text)
{
    if (parameter_is_of_block(p))
        return parameter_restore(p, config, text);
    return parameter_set(p, config, text) == ERR_OK;
}

static bool take_row(const struct stored_record *r, const struct parameter *p,
                     struct config *config)
{
    uint8_t row[BLOCK_COLS_MAX * sizeof(float)];
    size_t size = parameter_size(p);
    bool taken;
    return parameter_own(p) && p->field->type == PARAMETER_ROW &&
           (size_t)(r->size - r->wide) == size &&
           storage_read(r->address + RECORD_HEAD + r->wide, row, (uint32_t)size) == ERR_OK &&
           block_row_decode(p->own, parameter_place(p, config), row, &taken);
}

bool record_take(const struct stored_record *r, const struct parameter *p, struct config *config)
{
    char text[TEXT_MAX + 1u] = {0};
    uint8_t data[4] = {0}, size = (uint8_t)(r->size - r->wide);
    uint32_t address = r->address + RECORD_HEAD + r->wide;
    static const uint8_t sizes[] = {0, 4, 4, 2, 1};
    if (parameter_to_write(p, config) != ERR_OK)
        return false;
    if (r->type == STORAGE_TEXT) {
        if (size >= sizeof text || storage_read(address, text, size))
            return false;
        if (parameter_is_secret(p) && strcmp(text, PARAMETER_SECRET) == 0)
            return false;
        float f;
        if (!is_text(p) && p->field->type != PARAMETER_WORD && p->field->type != PARAMETER_ROW &&
            text_parse_float(text, &f) == ERR_OK)
            return !take_number(p, config, f, 0, false);
        return take_text(p, config, text[0] ? text : "-");
    }
    if (r->type == STORAGE_ROW)
        return take_row(r, p, config);
    if (r->type == 0 || r->type > STORAGE_WORD || size != sizes[r->type] || is_text(p) ||
        p->field->type == PARAMETER_ROW || storage_read(address, data, size) != ERR_OK)
        return false;
    uint32_t u32 = get32(data);
    float f = (float)u32;
    if (r->type == STORAGE_FLOAT) {
        memcpy(&f, &u32, sizeof f);
        if (!float_is_finite(f))
            return false;
    }
    return !take_number(p, config, f, u32, r->type != STORAGE_FLOAT);
}

bool record_wanted(const struct parameter *p, const struct config *config)
{
    struct parameter first = *p;
    first.field = &p->group->fields[0];
    if (parameter_is_of_block(p))
        return config->block[p->index].kind[0] != '\0';
    if (p->field->type == PARAMETER_FIXED)
        return false;
    if ((CONFIG_ANALYSERS || CONFIG_CALIBRATION) && p->field->if_set)
        return !parameter_is_default(p, config);
    const float *source = parameter_follows(p, config);
    bool moved = source && *source != field_initial(p->field);
    return moved || !p->group->indexed ||
           (is_text(&first) && !parameter_is_default(&first, config)) ||
           !parameter_is_default(p, config);
}

uint8_t record_encode(const struct parameter *p, struct config *config, uint8_t *record)
{
    static const uint8_t types[] = {STORAGE_FLOAT, STORAGE_U32,  STORAGE_U16,  STORAGE_U32,
                                    STORAGE_WORD,  STORAGE_TEXT, STORAGE_TEXT, STORAGE_TEXT,
                                    STORAGE_TEXT,  STORAGE_ROW};
    const void *at = parameter_place(p, config);
    size_t size = parameter_size(p);
    uint32_t id = parameter_id(p);
    uint8_t *data = record + RECORD_HEAD;
    uint32_t u32;
    uint16_t u16;
    put16(record, id >> 16 ? 0 : (uint16_t)id);
    if (RECORDS_ARE_WIDE && id >> 16) {
        put32(data, id);
        data += RECORD_WIDE;
    }
    if (is_text(p)) {
        size = strlen(at);
        memcpy(data, at, size);
    } else if (parameter_own(p) && p->field->type == PARAMETER_ROW) {
        size = block_row_encode(p->own, at, data);
    } else if (size == 4) {
        memcpy(&u32, at, sizeof u32);
        put32(data, u32);
    } else if (size == 2) {
        memcpy(&u16, at, sizeof u16);
        put16(data, u16);
    } else {
        data[0] = *(const uint8_t *)at;
    }
    record[2] = types[p->field->type];
    record[3] = (uint8_t)((size_t)(data - record) - RECORD_HEAD + size);
    return (uint8_t)(RECORD_HEAD + record[3]);
}
