/* Keys of the objects in a plant's file, each once: what the reader takes, and what docs/reference/plant-files.md says of it. */
#ifndef REFLUX_HOST_SIM_FILE_KEYS_H
#define REFLUX_HOST_SIM_FILE_KEYS_H

#include <stddef.h>

struct file_key {
    const char *name;
    const char *type;
    const char *unit;
    /* Limits of a number, or of how many elements a list has. With `allowed` the limits depend on other keys, and the reader has them. */
    double lo, hi;
    double fallback;       /* value of a number whose key is missing; NAN: the key is required */
    const char *allowed;   /* what may stand there, in words; NULL: as lo and hi say */
    const char *otherwise; /* the default in words; NULL: as fallback says */
    const char *about;
    const char *
        models; /* models of a linear plant that have the key, with blanks between them; NULL: every model */
};

/* An object and its keys, which end with a row without a name. */
struct file_object {
    const char *title, *about;
    const struct file_key *keys;
};

/* Rows of the head of every plant's file. */
#define FILE_HEAD_KEYS                                                                             \
    {.name = "name",                                                                               \
     .type = "text",                                                                               \
     .unit = "-",                                                                                  \
     .allowed = "up to 40 small letters, digits, - and _",                                         \
     .otherwise = "required",                                                                      \
     .about = "the file's name without .json when it is to be found by name"},                     \
        {.name = "title",                                                                          \
         .type = "text",                                                                           \
         .unit = "-",                                                                              \
         .allowed = "up to 120 characters",                                                        \
         .otherwise = "required",                                                                  \
         .about = "one line for lists and reports"},                                               \
        {.name = "source",                                                                         \
         .type = "text",                                                                           \
         .unit = "-",                                                                              \
         .allowed = "up to 600 characters",                                                        \
         .otherwise = "required",                                                                  \
         .about = "whose numbers they are"},                                                       \
        {.name = "ours",                                                                           \
         .type = "text",                                                                           \
         .unit = "-",                                                                              \
         .allowed = "up to 1200 characters",                                                       \
         .otherwise = "nothing",                                                                   \
         .about = "what the source does not give and you chose"},                                  \
    {                                                                                              \
        .name = "tick_s", .type = "number", .unit = "s", .lo = 0.001, .hi = 86400.0,               \
        .fallback = NAN, .about = "control interval, whole milliseconds"                           \
    }

/* Rows of a channel that several objects have. */
#define FILE_NAME_KEY                                                                              \
    {                                                                                              \
        .name = "name", .type = "text", .unit = "-",                                               \
        .allowed = "up to 15 letters, digits and underscores", .otherwise = "required",            \
        .about = "no other channel has it"                                                         \
    }
#define FILE_HELP_KEY                                                                              \
    {                                                                                              \
        .name = "help", .type = "text", .unit = "-", .allowed = "up to 600 characters",            \
        .otherwise = "none", .about = "what it is, for `reflux-sim --list NAME`"                   \
    }
#define FILE_UNIT_KEY                                                                              \
    {                                                                                              \
        .name = "unit", .type = "text", .unit = "-",                                               \
        .allowed = "up to 11 printable characters without blanks and commas",                      \
        .otherwise = "required",                                                                   \
        .about = "common signs are transliterated: °C and deg C become degC, m³/h becomes m3/h"  \
    }
#define FILE_NUMBER_KEY(key, of, least, most, initial, words)                                      \
    {                                                                                              \
        .name = (key), .type = "number", .unit = (of), .lo = (least), .hi = (most),                \
        .fallback = (initial), .about = (words)                                                    \
    }
#define FILE_BIG 1e15
#define FILE_LO_KEY                                                                                \
    FILE_NUMBER_KEY("lo", "of the channel", -FILE_BIG, FILE_BIG, NAN, "lower end of the span")
#define FILE_HI_KEY                                                                                \
    FILE_NUMBER_KEY("hi", "of the channel", -FILE_BIG, FILE_BIG, NAN, "upper end, above `lo`")
#define FILE_NOMINAL_KEY                                                                           \
    {                                                                                              \
        .name = "nominal", .type = "number", .unit = "of the channel", .allowed = "lo .. hi",      \
        .otherwise = "required", .about = "value at the steady state of the file"                  \
    }
#define FILE_SAFE_KEY                                                                              \
    {                                                                                              \
        .name = "safe", .type = "number", .unit = "of the channel", .allowed = "lo .. hi",         \
        .otherwise = "nominal", .about = "value that the plant announces as safe"                  \
    }
#define FILE_SLEW_KEY                                                                              \
    FILE_NUMBER_KEY("slew", "of the channel per s", 0.0, FILE_BIG, 0.0,                            \
                    "fastest change; 0: no bound")
#define FILE_SENSOR_KEYS                                                                           \
    FILE_NUMBER_KEY("lag_s", "s", 0.0, 86400.0, 0.0, "lag of the sensor"),                         \
        FILE_NUMBER_KEY("noise", "of the channel", 0.0, FILE_BIG, 0.0,                             \
                        "standard deviation of the noise"),                                        \
        FILE_NUMBER_KEY("resolution", "of the channel", 0.0, FILE_BIG, 0.0,                        \
                        "step of the readings; 0: none")
#define FILE_KEYS_END                                                                              \
    {                                                                                              \
        .name = NULL                                                                               \
    }

/* Returns the row of a key; NULL where there is none. */
const struct file_key *file_key_find(const struct file_key *keys, const char *name);

/* --- linear_keys.c --- */

extern const struct file_key linear_keys[], linear_input_keys[], linear_disturbance_keys[],
    linear_parameter_keys[], linear_output_keys[], element_keys[], case_keys[];
extern const struct file_object linear_objects[]; /* ends with an object without a title */

/* --- column_keys.c --- */

extern const struct file_key column_keys[], component_keys[], wilson_keys[], nrtl_keys[],
    holdup_keys[], hydraulics_keys[], level_keys[], levels_keys[], column_input_keys[],
    column_disturbance_keys[], constant_keys[], constant_fraction_keys[], column_output_keys[],
    truth_keys[], trim_keys[];
extern const struct file_object column_objects[];

#endif
