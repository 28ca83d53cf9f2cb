/* A general distillation column: N stages, C components; dynamics of composition, and of holdups where they are said to move.
 *
 * Stages are numbered upwards as in Frau: 1 is the partial reboiler, 2 .. N-1 are trays, N is the total
 * condenser with its drum. The code counts from 0, so stage s is index s - 1. The states are the mole
 * fractions of the first C - 1 components on every stage, from the reboiler up: x[(s - 1)(C - 1) + j]; behind them
 * the holdups that move, each over its nominal one, from the reboiler up.
 * SI units throughout: mol, s, K, Pa, W, m3, kg.
 *
 * Assumptions (Frau 2.1): no energy balance on trays, molar flows change only at the feed and at the
 * top (subcooling); liquid holdup constant on every stage, levels held perfectly by the product flows,
 * unless the config says otherwise; pressure falls linearly; Murphree efficiency on trays, ideal reboiler.
 *
 * What is ours: the conservative form (see enum column_holdup), the limits on the flows (struct column_flows),
 * levels and hydraulics (docs/use/columns.md). Equations are those of A. Frau, thesis, Cagliari (XXIII cycle), chapter 3, with
 * the signs of (3.2a), (3.2e) and (3.2f) repaired so that they add up to zero; see docs/methods/column-model.md.
 *
 * Use: column_init, where holdups move column_take_reference, then column_set_inputs whenever inputs change, then
 * column_rates for dx/dt (an integrator) or column_evaluate for the algebraic outputs alone; both leave the outputs in the
 * struct. */
#ifndef REFLUX_MODEL_COLUMN_H
#define REFLUX_MODEL_COLUMN_H

#include "base/error.h"
#include "model/column_sizes.h"
#include "model/properties.h"
#include "model/vle.h"

/* Liquid holdup of a stage. */
enum column_holdup {
    /* Molar holdup given and constant (mol). All balances close. */
    COLUMN_HOLDUP_MOLAR,
    /* Volumetric holdup given and constant (m3), molar holdup follows the composition; internal flows stay
     * constant per section, so that the total component balance closes only at steady state. Frau 2.1. */
    COLUMN_HOLDUP_VOLUMETRIC,
    /* As VOLUMETRIC, but the liquid leaving a stage carries what its molar holdup gives up, so that
     * d(H c)/dt balances and the total closes at every moment. Ours. A tray that needs more liquid than
     * reaches it draws it from the tray below: its liquid[] is negative then, and so may the product flows
     * be for a moment where the nominal flow is almost nothing. */
    COLUMN_HOLDUP_CONSERVATIVE
};

/* Unit of a stream's flow. */
enum column_basis {
    COLUMN_FLOW_MOLAR, /* mol/s */
    COLUMN_FLOW_MASS,  /* kg/s */
    COLUMN_FLOW_VOLUME /* m3/s of liquid at the stream's own composition and temperature */
};

/* Drum and reboiler. */
enum column_levels {
    COLUMN_LEVELS_PERFECT, /* constant holdup; distillate and bottoms are what is left over */
    COLUMN_LEVELS_HOLDUPS  /* they rise and fall with the four flows */
};

#define COLUMN_OVERFLOW_RATE                                                                       \
    REAL_C(0.1) /* 1/s: mol/s that run over for each mol above the capacity */

/* The flow that a proportional controller moves to hold a level. */
enum column_level_by {
    COLUMN_LEVEL_FREE,       /* none: both flows of the vessel are inputs */
    COLUMN_LEVEL_BY_PRODUCT, /* distillate, bottoms */
    COLUMN_LEVEL_BY_INTERNAL /* reflux, boil-up */
};

struct column_level {
    enum column_level_by by;
    real_t gain; /* 1/s: mol/s per mol of holdup, above 0 unless free */
};

/* Everything about a column that does not change while it runs. The struct and the components must
 * outlive the column. column_validate() says what is wrong with one. */
struct column_config {
    size_t stages;                     /* N, 4 to COLUMN_STAGES_MAX */
    size_t components;                 /* C, 2 to COLUMN_COMPONENTS_MAX */
    size_t feed_stage;                 /* 2 to N-2, counted from the reboiler = 1 */
    const struct component *component; /* [C], any order; the last one is not integrated */
    real_t efficiency;                 /* Murphree efficiency of the trays, above 0, at most 1 */
    real_t pressure_drop;              /* Pa, reboiler minus condenser, 0 or more */
    enum column_holdup holdup; /* which of the forms above; it sets the unit of the next three */
    real_t holdup_reboiler;    /* mol or m3, above 0 */
    real_t holdup_tray;        /* each tray; mol or m3, above 0 */
    real_t holdup_condenser;   /* with the reflux drum; mol or m3, above 0 */
    real_t holdup_temperature_bottom; /* K; liquid volume of holdups is taken at a temperature */
    real_t holdup_temperature_top; /* K; linear in the stage number. Not used by the molar form */
    real_t temperature_min;        /* K; bubble points are sought between these, 50 to 1000 K */
    real_t temperature_max;
    real_t limit_softness;  /* 0.001 to 0.5: relative width over which flow limits set in */
    activity_fn *activity;  /* activity coefficients, NULL for an ideal liquid */
    void *activity_context; /* handed to activity */
    /* Holdups that move, molar form only; all 0: none does. Each is a further state, its holdup over the nominal one
     * (those above), from the reboiler up behind the mole fractions. tests/reference/column-equations.md has the equations. */
    /* s, of the trays' liquid; 0: their holdup is constant, above 0 otherwise */
    real_t hydraulic_time;
    real_t hydraulic_vapour; /* liquid driven off a tray by more vapour, mol per mol, -5 to 5 */
    enum column_levels levels;
    struct column_level condenser_level, reboiler_level; /* of COLUMN_LEVELS_HOLDUPS */
    real_t level_capacity; /* of both vessels, over the nominal holdup, above 1, at most 10 */
};

/* A fault of a config or of inputs. */
struct column_fault {
    const char *field;  /* name of the field, "" when nothing is wrong */
    const char *wanted; /* the range it must be in */
};

/* Measure of the feed's heat. */
enum column_feed_state {
    COLUMN_FEED_TEMPERATURE, /* its temperature, by heat capacity and heat of vaporisation */
    COLUMN_FEED_QUALITY      /* its quality: constant molar overflow at the feed */
};

/* Inputs of the column. */
struct column_inputs {
    enum column_basis feed_basis;
    real_t feed_flow; /* 0 or more, unit as feed_basis says */
    /* mole fractions, each 0 to 1, sum 1 within 1e-3 */
    real_t feed_fraction[COLUMN_COMPONENTS_MAX];
    real_t feed_temperature; /* K, within the config's temperature range */
    enum column_basis reflux_basis;
    real_t reflux_flow;       /* wanted flow, 0 or more */
    real_t reflux_subcooling; /* K below the drum's bubble point, 0 to 100 */
    real_t heat;              /* W going into boiling, 0 or more */
    real_t pressure_top;      /* Pa in the condenser, 100 to 1e7 */
    enum column_feed_state feed_state;
    /* 0 (vapour at its dew point) over 1 (boiling liquid) to 2; not used with a temperature */
    real_t feed_quality;
    bool boilup_given; /* boilup counts, heat does not */
    real_t boilup;     /* mol/s of vapour leaving the reboiler, 0 or more */
    /* With COLUMN_LEVELS_HOLDUPS, where no level moves them: wanted flows, 0 or more. */
    enum column_basis distillate_basis, bottoms_basis;
    real_t distillate_flow, bottoms_flow;
};

/* Internal flows, mol/s, none of them negative except as said at the conservative form, and the bottoms of a column
 * with hydraulics and perfect levels, which are what its lowest tray gives less the boil-up. Frau 2.4.
 *
 * With perfect levels: where wanted reflux and heat cannot both be had, the levels win, which a real column's level loops and
 * low-level trips would see to: reflux is cut to what the condenser makes (distillate stays 0 or more) and
 * boil-up is cut when the liquid coming down cannot feed it (bottoms stay 0 or more). Likewise a cold feed
 * condenses no more vapour than there is, and a hot one flashes no more than there is of it. The cuts set
 * in smoothly over the relative width limit_softness and are exactly absent outside it. */
struct column_flows {
    real_t feed;                              /* F */
    real_t reflux;                            /* L_T */
    real_t liquid_enriching;                  /* L_E */
    real_t liquid_stripping;                  /* L_S */
    real_t vapour_stripping;                  /* V_S, boil-up */
    real_t vapour_enriching;                  /* V_E */
    real_t vapour_top;                        /* V_T */
    real_t distillate;                        /* D */
    real_t bottoms;                           /* B */
    real_t reflux_wanted;                     /* as asked for, before the limits */
    real_t boilup_wanted;                     /* heat / heat of vaporisation, before the limits */
    real_t condensed_by_feed;                 /* dV_F, negative when the feed flashes */
    real_t condensed_wanted;                  /* dV_F before the limits */
    real_t reflux_gain;                       /* internal reflux for each mole of reflux */
    real_t condensed_by_reflux;               /* dV_R */
    real_t distillate_wanted, bottoms_wanted; /* with COLUMN_LEVELS_HOLDUPS, before the limits */
};

/* One column. Config and inputs are in front; what column_evaluate leaves is for reading. About
 * 4 N C numbers; contents are the module's own unless named as outputs. */
struct column {
    const struct column_config *config;
    struct column_inputs inputs;
    struct vle vle;
    size_t n_fractions;            /* N (C - 1): mole fractions, the first states */
    size_t n_states;               /* with the holdups that move */
    struct column_flows reference; /* column_take_reference */

    /* outputs of column_evaluate and column_rates, stage by stage from the reboiler */
    real_t temperature[COLUMN_STAGES_MAX]; /* K, bubble points; also where the next search starts */
    real_t liquid[COLUMN_STAGES_MAX];      /* mol/s leaving the stage; [0] bottoms, [N-1] reflux */
    real_t vapour_flow[COLUMN_STAGES_MAX]; /* mol/s leaving the stage upwards; [N-1] is 0 */
    real_t holdup[COLUMN_STAGES_MAX]; /* mol; where it moves, at least 1e-4 of the nominal one */
    /* mole fractions leaving, [s C + j]; condenser: none, the drum's bubble */
    real_t vapour[COLUMN_STAGES_MAX * COLUMN_COMPONENTS_MAX];
    struct column_flows flows;
    /* of the feed tray: that of all trays, or more where a flash leaves no other choice */
    real_t feed_efficiency;

    /* inside */
    real_t k[COLUMN_STAGES_MAX * COLUMN_COMPONENTS_MAX];
    real_t dk[COLUMN_STAGES_MAX * COLUMN_COMPONENTS_MAX];
    real_t molar_volume[COLUMN_STAGES_MAX * COLUMN_COMPONENTS_MAX];
    real_t pressure[COLUMN_STAGES_MAX];
    real_t feed_molar;
    bool warm; /* k and dk belong to temperature[] at the present pressure */
};

/* Checks a config. ERR_OK, or ERR_RANGE / ERR_NOT_FINITE with fault (never NULL) saying which field. */
MUST_CHECK enum err column_validate(const struct column_config *config, struct column_fault *fault);

/* Checks inputs against a valid config, likewise. */
MUST_CHECK enum err column_validate_inputs(const struct column_config *config,
                                           const struct column_inputs *inputs,
                                           struct column_fault *fault);

/* Makes a column from a config. Fails as column_validate does and then leaves the column unchanged.
 * column_set_inputs must follow. */
MUST_CHECK enum err column_init(struct column *column, const struct column_config *config,
                                struct column_fault *fault);

/* Takes new inputs (copied). Fails as column_validate_inputs does and then keeps the old ones. */
MUST_CHECK enum err column_set_inputs(struct column *column, const struct column_inputs *inputs,
                                      struct column_fault *fault);

/* Flows of the column at its nominal inputs with perfect levels and nominal holdups, settled (column->flows of such a
 * column): what the level controllers and the hydraulics of trays count from. Needed where holdups move, once, after
 * column_init; all of them are 0 before. Copied. */
void column_take_reference(struct column *column, const struct column_flows *nominal);

/* Index among the states of the holdup of stage index s (0 = reboiler); n_states where it is constant. */
size_t column_holdup_state(const struct column *column, size_t s);

/* Holdup of stage index s over its nominal one; 1 where it is constant. */
real_t column_relative_holdup(const struct column *column, const real_t *x, size_t s);

/* Algebraic outputs at the states x[n_states]: temperatures (3.2g), vapour compositions with Murphree
 * efficiency (digest 2.5), holdups, internal flows (2.4). liquid[] is that of constant flows per section.
 * ERR_NOT_FINITE for a state that is no number, ERR_RANGE when a stage has no bubble point. */
MUST_CHECK enum err column_evaluate(struct column *column, const real_t *x);

/* As column_evaluate, near the states of the last column_rates or column_evaluate, for derivatives: vle_bubble_point_near where that will
 * do. Errors likewise. */
MUST_CHECK enum err column_evaluate_near(struct column *column, const real_t *x);

/* dx/dt (1/s) at the states x, and all outputs. Component balances (3.2a)-(3.2f), repaired.
 * rates[n_states]. Errors as column_evaluate. */
MUST_CHECK enum err column_rates(struct column *column, const real_t *x, real_t *rates);

/* As column_rates, for the very x of the last column_rates or column_evaluate, when nothing but inputs has
 * changed since: bubble points are not sought again unless the pressure changed. */
MUST_CHECK enum err column_rates_again(struct column *column, const real_t *x, real_t *rates);

/* Mole fraction of component j (0 .. C-1) on stage index s (0 = reboiler), the last one by closure. */
real_t column_fraction(const struct column *column, const real_t *x, size_t s, size_t j);

/* Half bandwidths of the Jacobian: entries (row, col) with row - col <= lower and col - row <= upper. */
void column_jacobian_shape(const struct column_config *config, size_t *lower, size_t *upper);

/* Analytic Jacobian d(rates)/dx for Newton matrices, of the mole fractions alone (n_fractions rows and columns), at the
 * point of the last column_rates or column_evaluate with the same x, in LAPACK band storage: entry (row, col) goes to
 * band[col * stride + diagonal + row - col]. Every entry of the band is written.
 *
 * Exact for internal flows, holdups and activity coefficients held at their present values, with one
 * truncation: with efficiency E below 1 the vapour leaving a stage remembers every stage below it with
 * weight E (1-E)^k, and the band reaches COLUMN_JACOBIAN_MEMORY stages down. With E = 1 nothing is lost.
 * Good for Newton iterations, which need a near Jacobian only; not for gains. */
#define COLUMN_JACOBIAN_MEMORY 3
void column_jacobian(const struct column *column, const real_t *x, real_t *band, size_t stride,
                     size_t diagonal);

#endif
