/* Keys of a column's file. */
#include <math.h>

#include "columns/column_reader.h"
#include "plants/file_keys.h"

#define LIST(key, least, most, initial, words)                                                     \
    {                                                                                              \
        .name = (key), .type = "list", .unit = "-", .lo = (least), .hi = (most),                   \
        .otherwise = (initial), .about = (words)                                                   \
    }
#define OBJECT(key, initial, words)                                                                \
    {                                                                                              \
        .name = (key), .type = "object", .unit = "-", .allowed = "below", .otherwise = (initial),  \
        .about = (words)                                                                           \
    }
/* A number that may be missing: `initial` says in words what holds then, and the reader takes 0. */
#define PROPERTY(key, of, least, most, words)                                                      \
    {                                                                                              \
        .name = (key), .type = "number", .unit = (of), .lo = (least), .hi = (most),                \
        .fallback = 0.0, .otherwise = "none", .about = (words)                                     \
    }
#define TEXT(key, words_allowed, initial, words)                                                   \
    {                                                                                              \
        .name = (key), .type = "text", .unit = "-", .allowed = (words_allowed),                    \
        .otherwise = (initial), .about = (words)                                                   \
    }
#define VAPOUR_PRESSURE                                                                            \
    "constants A, B, C, D, E, F, G of ln(P/Pa) = A - B/(C + T) + D T + E ln T + F T^G, "           \
    "T in K; what is left out is 0. With C = D = 0 this is DIPPR-101"

const struct file_key column_keys[] = {
    FILE_HEAD_KEYS,
    {.name = "column",
     .type = "number",
     .unit = "-",
     .allowed = "1",
     .otherwise = "required",
     .about = "version of this format; it is what makes the file a column"},
    LIST("components", 2, COLUMN_COMPONENTS_MAX, "required",
         "the last one is not integrated, but closes the sum to 1"),
    {.name = "reference_vapour_pressure",
     .type = "list",
     .unit = "K, Pa",
     .allowed = "3 to 7 numbers",
     .otherwise = "none",
     .about = "constants as of `vapour_pressure`, of a liquid whose relative volatility is 1; with "
              "`relative_volatility`"},
    OBJECT("activity", "an ideal liquid", "activity coefficients"),
    FILE_NUMBER_KEY("stages", "-", 4, COLUMN_STAGES_MAX, NAN,
                    "N, whole: 1 is the reboiler, 2 to N-1 are trays, counted upwards, N is the "
                    "total condenser with its drum"),
    {.name = "feed_stage",
     .type = "number",
     .unit = "-",
     .allowed = "2 .. N-2, whole",
     .otherwise = "required",
     .about = "where the feed enters"},
    FILE_NUMBER_KEY("efficiency", "-", 0.01, 1.0, 1.0, "Murphree efficiency of the trays"),
    FILE_NUMBER_KEY("pressure_drop", "Pa", 0.0, 1e7, 0.0, "reboiler less condenser"),
    {.name = "temperature_range",
     .type = "list of two",
     .unit = "K",
     .allowed = "each 50 .. 1000, at least 1 apart",
     .otherwise = "required",
     .about = "[lowest, highest], where property data are used and bubble points sought. It holds "
              "the boiling points of all components at every pressure that the column may have; "
              "where a mixture boils outside it, an azeotrope, the error names the stage"},
    FILE_NUMBER_KEY("limit_softness", "-", 0.001, 0.5, 0.02,
                    "relative width over which limits on flows set in"),
    OBJECT("holdup", "required", "liquid on the stages"),
    OBJECT("levels", "perfect levels", "drum and reboiler are holdups that rise and fall"),
    OBJECT("constants", "none", "values of driving quantities that are no channels"),
    LIST("inputs", 1, PLANT_CHANNELS_MAX, "required",
         "manipulated variables; with disturbances together at most 32"),
    LIST("disturbances", 0, PLANT_CHANNELS_MAX, "none", "inputs that the board does not set"),
    LIST("outputs", 1, PLANT_CHANNELS_MAX, "required", "measurements"),
    LIST("truths", 0, COLUMN_TRUTHS_MAX, "none", "values that are logged and not measured"),
    {.name = "steady_state",
     .type = "list",
     .unit = "-",
     .allowed = "at most one entry for each driving quantity",
     .otherwise = "none",
     .about = "what the nominal state must meet"},
    FILE_KEYS_END,
};

const struct file_key component_keys[] = {
    TEXT("name", "up to 15 letters, digits and underscores", "required", "no other has it"),
    {.name = "vapour_pressure",
     .type = "list",
     .unit = "K, Pa",
     .allowed = "3 to 7 numbers",
     .otherwise = "this or relative_volatility",
     .about = VAPOUR_PRESSURE},
    {.name = "relative_volatility",
     .type = "number",
     .unit = "-",
     .lo = 1e-6,
     .hi = 1e6,
     .fallback = NAN,
     .otherwise = "this or vapour_pressure",
     .about = "for all components or none: P is this times the reference vapour pressure. The "
              "vapour is then y_j = a_j x_j / sum a_k x_k whatever the temperature"},
    PROPERTY("molar_mass", "kg/mol", 1e-4, 10.0, "a mass or a volume needs it"),
    {.name = "density",
     .type = "number, or list of two",
     .unit = "kg/m3, kg/(m3 K)",
     .allowed = "1 to 30000 over the whole temperature_range",
     .otherwise = "none",
     .about = "[d0, d1]: d0 + d1 T, or one number; a volume needs it. The liquid's molar volume is "
              "molar_mass / density"},
    PROPERTY("vaporisation_heat", "J/mol", 1.0, 1e6,
             "h at the boiling point, elsewhere by Watson: h ((Tc - T)/(Tc - Tb))^0.38, and 0 from "
             "Tc on; `heat`, `feed_temperature` and a subcooling need it"),
    PROPERTY("boiling_point", "K", 1.0, 2000.0, "Tb; needed with vaporisation_heat"),
    PROPERTY("critical_temperature", "K", 1.0, 1e4,
             "Tc, above the boiling point and the temperature_range; needed with "
             "vaporisation_heat"),
    PROPERTY("heat_capacity", "J/(mol K)", 1.0, 1e5,
             "of the liquid; `feed_temperature` as the state of the feed, and a subcooling that is "
             "not always 0, need it"),
    FILE_KEYS_END,
};

#define ACTIVITY_MATRIX(key, of, initial, words)                                                   \
    {                                                                                              \
        .name = (key), .type = "matrix", .unit = (of),                                             \
        .allowed = "rows and columns in the order of the components", .otherwise = (initial),      \
        .about = (words)                                                                           \
    }
#define ACTIVITY_KEYS                                                                              \
    TEXT("model", "wilson|nrtl", "required", "how the coefficients follow from the matrices"),     \
        ACTIVITY_MATRIX("a", "-", "required", "the diagonal is 0"),                                \
        ACTIVITY_MATRIX("b", "K", "0",                                                             \
                        "the diagonal is 0. Over the whole temperature_range a + b / T must "      \
                        "be -10 to 10 (wilson) or -20 to 20 (nrtl)")

const struct file_key wilson_keys[] = {ACTIVITY_KEYS, FILE_KEYS_END};

const struct file_key nrtl_keys[] = {
    ACTIVITY_KEYS,
    ACTIVITY_MATRIX("alpha", "-", "required with nrtl", "nrtl alone; symmetric, 0 to 1"),
    FILE_KEYS_END,
};

#define HOLDUP_LEAST   1e-9
#define HOLDUP_LARGEST 1e9
const struct file_key holdup_keys[] = {
    TEXT("form", "molar|volumetric|conservative", "required",
         "molar: mol, constant; volumetric: m3, constant, balances close at rest only; "
         "conservative: m3, constant, all balances close"),
    FILE_NUMBER_KEY("reboiler", "mol or m3", HOLDUP_LEAST, HOLDUP_LARGEST, NAN, "in the reboiler"),
    FILE_NUMBER_KEY("tray", "mol or m3", HOLDUP_LEAST, HOLDUP_LARGEST, NAN, "on each tray"),
    FILE_NUMBER_KEY("condenser", "mol or m3", HOLDUP_LEAST, HOLDUP_LARGEST, NAN, "in the drum"),
    {.name = "temperatures",
     .type = "list of two",
     .unit = "K",
     .allowed = "within temperature_range",
     .otherwise = "required unless molar",
     .about = "[reboiler, condenser], linear in between: the temperature at which volumes are "
              "taken. A molar holdup has none"},
    OBJECT("hydraulics", "constant holdups", "the holdups of the trays move; only with molar"),
    FILE_KEYS_END,
};

const struct file_key hydraulics_keys[] = {
    FILE_NUMBER_KEY("time", "s", 0.001, 1e6, NAN, "time constant of a tray"),
    FILE_NUMBER_KEY("vapour", "-", -5.0, 5.0, 0.0, "liquid that a change of the vapour moves"),
    FILE_KEYS_END,
};

const struct file_key levels_keys[] = {
    FILE_NUMBER_KEY("capacity", "-", 1.0, 10.0, 2.0,
                    "how often the nominal holdup a vessel holds, more than 1; above it runs over"),
    OBJECT("condenser", "required", "the drum"),
    OBJECT("reboiler", "required", "the reboiler"),
    FILE_KEYS_END,
};

const struct file_key level_keys[] = {
    TEXT("by", "none|distillate|reflux of the drum, none|bottoms|boilup of the reboiler",
         "required", "the flow that a proportional controller moves; it can be no channel's"),
    FILE_NUMBER_KEY("gain", "1/s", 1e-9, 1000.0, NAN, "of that controller; without `none` only"),
    FILE_KEYS_END,
};

#define DRIVE_IS                                                                                   \
    TEXT("is", "a driving quantity", "required", "what it drives: the table of them is below")
#define DRIVE_OF    TEXT("of", "name of a component", "required of a feed_fraction", "whose fraction")
#define COLUMN_UNIT TEXT("unit", "a unit of the quantity", "required", "the table is below")
#define COLUMN_NOMINAL                                                                             \
    {                                                                                              \
        .name = "nominal", .type = "number", .unit = "of the channel", .allowed = "lo .. hi",      \
        .otherwise = "required",                                                                   \
        .about = "value at the nominal state, or where the search for it starts; distillate and "  \
                 "bottoms have none, because theirs follows"                                       \
    }

const struct file_key column_input_keys[] = {
    FILE_NAME_KEY,  DRIVE_IS,      DRIVE_OF,      COLUMN_UNIT,   FILE_LO_KEY,   FILE_HI_KEY,
    COLUMN_NOMINAL, FILE_SAFE_KEY, FILE_SLEW_KEY, FILE_HELP_KEY, FILE_KEYS_END,
};

const struct file_key column_disturbance_keys[] = {
    FILE_NAME_KEY, DRIVE_IS,       DRIVE_OF,      COLUMN_UNIT,   FILE_LO_KEY,
    FILE_HI_KEY,   COLUMN_NOMINAL, FILE_HELP_KEY, FILE_KEYS_END,
};

#define CONSTANT_VALUE                                                                             \
    {                                                                                              \
        .name = "value", .type = "number", .unit = "of the constant",                              \
        .allowed = "as the quantity has it", .otherwise = "required",                              \
        .about = "stays so for the whole run"                                                      \
    }
const struct file_key constant_keys[] = {CONSTANT_VALUE, COLUMN_UNIT, FILE_KEYS_END};
const struct file_key constant_fraction_keys[] = {DRIVE_OF, CONSTANT_VALUE, COLUMN_UNIT,
                                                  FILE_KEYS_END};

#define VIEW_KEYS                                                                                  \
    FILE_NAME_KEY,                                                                                 \
        TEXT("is", "a quantity that can be seen", "required", "the table of them is below"),       \
        {.name = "of",                                                                             \
         .type = "text, or list",                                                                  \
         .unit = "-",                                                                              \
         .allowed = "names of components",                                                         \
         .otherwise = "required where the quantity has it",                                        \
         .about = "a list: the sum of their fractions"},                                           \
        {.name = "stage",                                                                          \
         .type = "number",                                                                         \
         .unit = "-",                                                                              \
         .allowed = "1 .. N, whole",                                                               \
         .otherwise = "required where the quantity has it",                                        \
         .about = "where it is seen"},                                                             \
        {.name = "stages",                                                                         \
         .type = "list",                                                                           \
         .unit = "-",                                                                              \
         .allowed = "each 1 .. N, whole",                                                          \
         .otherwise = "in place of stage",                                                         \
         .about = "the mean of these; of a difference two, the first less the second"},            \
        COLUMN_UNIT, FILE_LO_KEY, FILE_HI_KEY, FILE_HELP_KEY

const struct file_key column_output_keys[] = {
    VIEW_KEYS,
    FILE_SENSOR_KEYS,
    PROPERTY("every_s", "s", 0.001, 86400.0,
             "an analyser: time between new values, whole ticks, at most 10000 of them"),
    FILE_NUMBER_KEY("delay_s", "s", 0.0, 86400.0, 0.0,
                    "an analyser: so long before a value is shown it was sampled, whole ticks, at "
                    "most 100 of them"),
    FILE_KEYS_END,
};

const struct file_key truth_keys[] = {VIEW_KEYS, FILE_KEYS_END};

const struct file_key trim_keys[] = {
    TEXT("channel", "an output or truth that is not logarithmic", "required", "what must be met"),
    {.name = "value",
     .type = "number",
     .unit = "of the channel",
     .allowed = "lo .. hi of the channel",
     .otherwise = "required",
     .about = "what it must be"},
    TEXT("trim", "an input, or reflux, heat or boilup as a constant", "required",
         "what is sought for it: its nominal value, rounded to seven significant digits"),
    FILE_KEYS_END,
};

const struct file_object column_objects[] = {
    {"Column", "The file. All quantities outside the channels are in SI units.", column_keys},
    {"Component", "An entry of `components`.", component_keys},
    {"Activity", "The object `activity`.", nrtl_keys},
    {"Holdup", "The object `holdup`.", holdup_keys},
    {"Hydraulics", "The object `hydraulics` of the holdup.", hydraulics_keys},
    {"Levels", "The object `levels`.", levels_keys},
    {"Level", "`condenser` and `reboiler` of the levels.", level_keys},
    {"Input of a column", "An entry of `inputs`: a manipulated variable.", column_input_keys},
    {"Disturbance of a column", "An entry of `disturbances`.", column_disturbance_keys},
    {"Constant",
     "A value under the name of its quantity in `constants`; `feed_fraction` is a list of them.",
     constant_fraction_keys},
    {"Output of a column", "An entry of `outputs`: a measurement. It has no `nominal`.",
     column_output_keys},
    {"Truth of a column", "An entry of `truths`.", truth_keys},
    {"Nominal state", "An entry of `steady_state`.", trim_keys},
    {NULL, NULL, NULL},
};
