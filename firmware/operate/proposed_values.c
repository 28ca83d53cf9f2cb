/* Proposals of blocks, as ids and values, written into settings. */
#include "base/assertion.h"
#include "base/crc32.h"
#include "operate/operate_internal.h"

/* Groups of parameters (parameter_table.c) that are settings of blocks: loop, decouple, ff, block. */
#define IS_OF_BLOCKS(group) ((group) == 4 || (group) == 5 || (group) == 6 || (group) == 16)

uint32_t proposed_shape(const struct config *c)
{
    uint32_t crc = 0;
    for (unsigned i = 0; i < CHANNEL_MAX; i++) {
        crc = crc32_update(crc, c->measurement[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, &c->measurement[i].lo, 2 * sizeof(float));
        crc = crc32_update(crc, c->mv[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, &c->mv[i].lo, 2 * sizeof(float));
    }
    for (unsigned i = 0; i < CONFIG_LOOPS; i++) {
        crc = crc32_update(crc, c->loop[i].name, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->loop[i].pv, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->loop[i].out, CHANNEL_NAME_SIZE);
    }
    for (unsigned i = 0; i < CONFIG_FEEDFORWARDS; i++) {
        crc = crc32_update(crc, c->feedforward[i].from, CHANNEL_NAME_SIZE);
        crc = crc32_update(crc, c->feedforward[i].to, CHANNEL_NAME_SIZE);
    }
    for (unsigned i = 0; i < CONFIG_BLOCKS; i++) {
        const struct block_config *b = &c->block[i];
        crc = crc32_update(crc, b->kind, sizeof b->kind);
        crc = crc32_update(crc, b->loops, sizeof b->loops);
        crc = crc32_update(crc, b->inputs, sizeof b->inputs);
        crc = crc32_update(crc, b->points, sizeof b->points);
    }
    return crc;
}
_Static_assert(offsetof(struct measurement_config, hi) ==
                       offsetof(struct measurement_config, lo) + sizeof(float) &&
                   offsetof(struct mv_config, hi) == offsetof(struct mv_config, lo) + sizeof(float),
               "both ends of a span are looked at together");

enum err operate_find_proposed(const struct config *config, uint32_t id, struct parameter *p)
{
    bool of_block = id >> 16;
    uint8_t col = of_block ? (uint8_t)((id & PROPOSED_COLUMN) >> 24) : 0;
    enum err err = parameter_find_id(config, of_block ? id & ~PROPOSED_COLUMN : id, p);
    if (!err && col >= (p->field->type == PARAMETER_ROW ? p->own->cols : 1u))
        err = ERR_UNKNOWN;
    p->col = col;
    return err;
}
_Static_assert(BLOCK_COLS_MAX <= (PROPOSED_COLUMN >> 24) + 1, "every value of a row has an id");

static enum err refuse_proposed(struct config_fault *fault, enum err code,
                                const struct parameter *p, const char *wanted)
{
    *fault = (struct config_fault){.code = code,
                                   .group = p->group->name,
                                   .index = p->group->indexed ? (uint8_t)(p->index + 1u) : 0,
                                   .field = p->own ? p->own->name : p->field->name,
                                   .wanted = wanted};
    return code;
}

enum err proposed_refuse_whole(struct config_fault *fault, enum err code, uint8_t block,
                               const char *wanted)
{
    *fault = (struct config_fault){.code = code,
                                   .group = "block",
                                   .index = (uint8_t)(block + 1u),
                                   .field = "proposal",
                                   .wanted = wanted};
    return code;
}

enum err proposed_write(struct config *config, uint8_t block, const struct proposed_value *v,
                        float *old, struct config_fault *fault)
{
    struct parameter p;
    if (operate_find_proposed(config, v->id, &p) != ERR_OK)
        return proposed_refuse_whole(fault, ERR_UNKNOWN, block, "names an unknown parameter");
    if (!IS_OF_BLOCKS(p.group->id))
        return refuse_proposed(fault, ERR_UNSUPPORTED, &p, "is not a setting of a block");
    if (parameter_get_number(&p, config, old) != ERR_OK)
        return refuse_proposed(fault, ERR_PARSE, &p, "is not a number: it cannot be proposed");
    enum err err = parameter_set_number(&p, config, v->value);
    return err ? refuse_proposed(fault, err, &p, "is proposed with a value that is not allowed")
               : ERR_OK;
}

enum err proposed_write_all(struct config *config, uint8_t block, const struct proposed_value *v,
                            uint8_t n, struct way_back *back, uint8_t *at,
                            struct config_fault *fault)
{
    REFLUX_ASSERT(n <= PROPOSAL_MAX);
    if (back)
        *back = (struct way_back){.n = n, .block = block, .shape = proposed_shape(config)};
    for (*at = 0; *at < n; (*at)++) {
        float old;
        enum err err = proposed_write(config, block, &v[*at], &old, fault);
        if (err)
            return err;
        if (back)
            back->value[*at] = (struct proposed_value){v[*at].id, old};
    }
    return ERR_OK;
}

/* Is any of the values another than the one there was? */
static bool changes_something(const struct proposed_value *v, const struct way_back *back)
{
    REFLUX_ASSERT(back->n <= PROPOSAL_MAX);
    for (uint8_t k = 0; k < back->n; k++)
        if (v[k].value != back->value[k].value)
            return true;
    return false;
}

enum err proposed_adopt(struct operate *door, const struct proposed_value *v,
                        const struct way_back *back, struct config_fault *fault)
{
    struct service *s = door->service;
    if (!changes_something(v, back))
        return ERR_OK;
    enum err err = service_apply(s, service_staged(s), fault);
    if (err)
        return err;
    door->proposals.back = *back;
    door->proposals.refused.known = false;
    service_record(s, EVENT_BLOCK_ADOPTED, service_plan(s)->config.block[back->block].kind,
                   (float)(back->block + 1u), 0);
    return ERR_OK;
}

void operate_keep_refusal(struct operate *door, uint8_t block, float value,
                          const struct config_fault *fault)
{
    char name[CHANNEL_NAME_SIZE];
    struct text t = text_on(name, sizeof name);
    door->proposals.refused =
        (struct refused_proposal){.fault = *fault, .block = block, .value = value, .known = true};
    service_fault_name(fault, &t);
    service_record(door->service, EVENT_PROPOSAL_REFUSED, name, value, (uint8_t)-fault->code);
}
