/* Parts that plant files of every kind have in common: their head, and the names of channels. */
#ifndef REFLUX_HOST_SIM_PLANT_PARTS_H
#define REFLUX_HOST_SIM_PLANT_PARTS_H

#include "plants/json_walk.h"
#include "plants/plant.h"

#define PLANT_CHANNELS_MAX ((size_t)16) /* of each kind: what the plant link carries */
#define PLANT_TEXT_MAX     ((size_t)600)

/* Letters, digits and underscores only. */
bool plant_name_allowed(const char *name);

/* keys: those of the file, which begin with FILE_HEAD_KEYS. */
void plant_read_head(struct json_walk *w, const json_t *root, const struct file_key *keys,
                     struct plant_class *c);

/* Name and help of channel n; the name is that of no channel before it. */
void plant_read_name(struct json_walk *w, const json_t *object, struct plant_channel *channels,
                     size_t n);

#endif
