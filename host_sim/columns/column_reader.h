/* Declarations that the files that read a column share: column_json.c (its structure), column_parts.c (components and what they are
 * needed for), column_channels.c (inputs, disturbances, constants), column_drives_check.c (what they must be together),
 * column_views.c (outputs and truths), column_steady_json.c (the nominal state). */
#ifndef REFLUX_HOST_SIM_COLUMN_READER_H
#define REFLUX_HOST_SIM_COLUMN_READER_H

#include "columns/column_plant.h"
#include "columns/column_trim.h"
#include "model/activity.h"
#include "plants/json_walk.h"
#include "plants/plant_parts.h"

#define COLUMN_TRUTHS_MAX ((size_t)200)
#define COLUMN_BIG        1e15

/* One column as it is read; lives as long as its class. */
struct column_file {
    struct column_config config;
    struct component component[COLUMN_COMPONENTS_MAX];
    struct activity activity;
    struct column_terms terms;
    struct column_plant plant;
    struct plant_states states;
};

struct column_reader {
    struct json_walk *walk;
    const json_t *root;
    struct column_file *file;
    struct plant_class *class;
    struct plant_channel *channels;
    size_t n_channels;
    struct column_seen *seen; /* [i - n_inputs] of channel i */
    struct column_trim trim[COLUMN_DRIVES_MAX];
    size_t n_trims;
};

/* Kinds of entries in a file, by its `is` or its key in `constants`. */
struct column_quantity {
    const char *name;
    unsigned measures, keys; /* keys: enum view_keys, of what is seen */
    double lo, hi;           /* what the model takes, SI; of what is seen: both 0 */
    const char *about;
    const char *otherwise; /* what holds where nothing gives it, or when it is needed */
};

/* Keys of an entry that is seen, besides its unit. */
enum view_keys {
    KEY_STAGE = 1, /* one stage */
    KEY_STAGES = 2,
    KEY_OF = 4
};

/* The k-th quantity that drives a column, and the k-th that is seen of one; NULL past the end. */
const struct column_quantity *column_drive_row(size_t k);
const struct column_quantity *column_sight_row(size_t k);

/* --- column_parts.c --- */

/* Property data that a component may do without. */
enum column_need {
    NEED_MASS = 1,
    NEED_VOLUME = 2, /* molar mass and density */
    NEED_HEATS = 4,
    NEED_CAPACITY = 8 /* heats and heat capacity */
};
void column_read_components(struct column_reader *r);
void column_read_activity(struct column_reader *r);
/* Fails at the present path unless every component has it. what: "the unit l/h". */
void column_need(struct column_reader *r, unsigned needs, const char *what);
/* Properties that a unit needs. */
void column_need_unit(struct column_reader *r, const struct column_unit *unit);
/* Index of the component whose name is the text at the path. */
size_t column_component(struct column_reader *r, const json_t *name);

/* --- column_channels.c --- */
void column_read_inputs(struct column_reader *r);
/* Name of a driving quantity. */
const char *column_drive_name(enum column_drive is);
/* Unit under the key `unit`, of one of the measures. */
const struct column_unit *column_read_unit(struct column_reader *r, const json_t *object,
                                           unsigned measures, const char *what);
/* lo and hi of a channel; both within what the quantity may be. */
void column_read_span(struct column_reader *r, const json_t *object, struct plant_channel *c);
/* A list of channels under a key, each handed to read: as many as its row in column_keys has. */
void column_read_list(struct column_reader *r, const char *key, enum plant_kind kind,
                      void (*read)(struct column_reader *r, const json_t *object,
                                   enum plant_kind kind));

/* --- column_drives_check.c --- */

/* After all inputs and constants: is everything there that must be, and nothing that excludes it? */
void column_check_driven(struct column_reader *r);

/* --- column_views.c --- */

void column_read_views(struct column_reader *r);

/* --- column_steady_json.c --- */
void column_read_steady_state(struct column_reader *r);

#endif
