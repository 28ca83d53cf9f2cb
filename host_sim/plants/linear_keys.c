/* Keys of a linear plant's file. */
#include <math.h>

#include "plants/file_keys.h"
#include "plants/plant_parts.h"

#define LIST(key, least, most, initial, words)                                                     \
    {                                                                                              \
        .name = (key), .type = "list", .unit = "-", .lo = (least), .hi = (most),                   \
        .otherwise = (initial), .about = (words)                                                   \
    }
#define MATRIX(key, needed, words, of)                                                             \
    {                                                                                              \
        .name = (key), .type = "matrix", .unit = "-", .allowed = "rows of numbers",                \
        .otherwise = (needed), .about = (words), .models = (of)                                    \
    }

const struct file_key linear_keys[] = {
    FILE_HEAD_KEYS,
    {.name = "time_unit",
     .type = "text",
     .unit = "-",
     .allowed = "s|min|h",
     .otherwise = "s",
     .about = "of lags, zeros, dead times, matrices and the period"},
    LIST("inputs", 1, PLANT_CHANNELS_MAX, "required", "manipulated variables, below"),
    LIST("disturbances", 0, PLANT_CHANNELS_MAX, "none", "below"),
    LIST("parameters", 0, PLANT_CHANNELS_MAX, "none", "for elements with cases, below"),
    LIST("outputs", 1, PLANT_CHANNELS_MAX, "required", "measurements, below"),
    {.name = "model",
     .type = "text",
     .unit = "-",
     .allowed = "transfer|state_space|discrete|polynomial",
     .otherwise = "required",
     .about = "how the plant is given"},
    {.name = "elements",
     .type = "list",
     .unit = "-",
     .allowed = "a row for each output, in it an element for each input, then for each disturbance",
     .otherwise = "required",
     .about = "an element is null (no connection), an object as below, or one with cases",
     .models = "transfer"},
    {.name = "period",
     .type = "number",
     .unit = "time_unit",
     .allowed = "0.001 s .. 86400 s, whole milliseconds",
     .otherwise = "required",
     .about = "the plant takes no tick but this one",
     .models = "discrete polynomial"},
    MATRIX("A", "required",
           "of the states, at most 200; polynomial: [A1, A2, ...] of the past outputs, at most 50",
           "state_space discrete polynomial"),
    MATRIX("B", "required",
           "inputs on states; polynomial: [B0, B1, ...], columns are inputs, then disturbances",
           "state_space discrete polynomial"),
    MATRIX("C", "required", "states on outputs", "state_space discrete"),
    MATRIX("D", "0", "inputs on outputs", "state_space discrete"),
    MATRIX("E", "0", "disturbances on states; with disturbances E, F or both",
           "state_space discrete"),
    MATRIX("F", "0", "disturbances on outputs", "state_space discrete"),
    FILE_KEYS_END,
};

const struct file_key linear_input_keys[] = {
    FILE_NAME_KEY, FILE_UNIT_KEY, FILE_LO_KEY,   FILE_HI_KEY,   FILE_NOMINAL_KEY,
    FILE_SAFE_KEY, FILE_SLEW_KEY, FILE_HELP_KEY, FILE_KEYS_END,
};

const struct file_key linear_disturbance_keys[] = {
    FILE_NAME_KEY,    FILE_UNIT_KEY, FILE_LO_KEY,   FILE_HI_KEY,
    FILE_NOMINAL_KEY, FILE_HELP_KEY, FILE_KEYS_END,
};

const struct file_key linear_output_keys[] = {
    FILE_NAME_KEY,    FILE_UNIT_KEY,    FILE_LO_KEY,   FILE_HI_KEY,
    FILE_NOMINAL_KEY, FILE_SENSOR_KEYS, FILE_HELP_KEY, FILE_KEYS_END,
};

const struct file_key linear_parameter_keys[] = {
    FILE_NAME_KEY,
    FILE_NUMBER_KEY("values", "-", 2.0, 100.0, NAN, "how many values it has: 1, 2, ..., whole"),
    {.name = "nominal",
     .type = "number",
     .unit = "-",
     .allowed = "1 .. values, whole",
     .otherwise = "1",
     .about = "the case in which a run begins"},
    FILE_HELP_KEY,
    FILE_KEYS_END,
};

const struct file_key element_keys[] = {
    FILE_NUMBER_KEY("gain", "output unit per input unit; with an integrator per time_unit",
                    -FILE_BIG, FILE_BIG, NAN, "K"),
    FILE_NUMBER_KEY("zero", "time_unit", -1e6, 1e6, 0.0,
                    "z: (z s + 1), of either sign; needs a lag"),
    {.name = "lags",
     .type = "number, or list of two",
     .unit = "time_unit",
     .allowed = "each 1e-09 .. 1e+06",
     .otherwise = "none",
     .about = "T: 1/(T s + 1) each"},
    {.name = "quadratic",
     .type = "list of two",
     .unit = "time_unit^2, time_unit",
     .allowed = "1e-18 .. 1e+12, -1e+06 .. 1e+12",
     .otherwise = "none",
     .about = "[a2, a1] in place of lags: 1/(a2 s² + a1 s + 1)"},
    {.name = "integrator",
     .type = "true or false",
     .unit = "-",
     .allowed = "true|false",
     .otherwise = "false",
     .about = "1/s"},
    {.name = "dead_time",
     .type = "number",
     .unit = "time_unit",
     .allowed = "0 s .. 1e+08 s",
     .otherwise = "0",
     .about = "L: e^(-L s), exact"},
    FILE_KEYS_END,
};

const struct file_key case_keys[] = {
    {.name = "parameter",
     .type = "text",
     .unit = "-",
     .allowed = "name of a parameter",
     .otherwise = "required",
     .about = "`--event T:regime=2` changes it while the plant runs"},
    {.name = "cases",
     .type = "list",
     .unit = "-",
     .allowed = "an element for each value of the parameter",
     .otherwise = "required",
     .about = "all of the same order, because states and past inputs carry over"},
    FILE_KEYS_END,
};

const struct file_object linear_objects[] = {
    {"Linear plant", "The file. A key of another model is refused.", linear_keys},
    {"Input of a linear plant", "An entry of `inputs`: a manipulated variable.", linear_input_keys},
    {"Disturbance of a linear plant", "An entry of `disturbances`.", linear_disturbance_keys},
    {"Parameter of a linear plant",
     "An entry of `parameters`: which of its cases an element has now.", linear_parameter_keys},
    {"Output of a linear plant", "An entry of `outputs`: a measurement.", linear_output_keys},
    {"Element", "An entry of a row of `elements`: a transfer function.", element_keys},
    {"Element with cases", "An element that changes while the plant runs.", case_keys},
    {NULL, NULL, NULL},
};
