/* A difference model of a plant from the record of an experiment, output by output and in pieces: orders on the first two thirds
 * (identify/arx_select.h), the best of them and the whole grid fitted there by the method, and of these the one with the least criterion on
 * the last third, which none has seen; it is then fitted on all of the record. tools/identify does the same on the host.
 *
 * Whether it may be relied on is judged by what the last third says, by what it must have in common with the experiment, and
 * by what both parts of the record say alike; docs/methods/experiment.md has the thresholds. */
#ifndef REFLUX_EXPERIMENT_PLANT_MODEL_H
#define REFLUX_EXPERIMENT_PLANT_MODEL_H

#include "identify/arx_fit.h"
#include "identify/arx_select.h"

/* The verdict of an output; that of the model is the worst of them. In the order of how much is known. */
enum plant_verdict {
    PLANT_UNJUDGED,
    PLANT_USABLE,
    PLANT_UNSURE, /* its gains at rest are not those of the record, or not those of its first two thirds */
    PLANT_SLOW,     /* it does not settle within the memory of the sequence, or integrates */
    PLANT_POOR,     /* on its own it does not follow the last third */
    PLANT_UNSTABLE, /* the method finds no stable model of any orders */
    PLANT_UNTOLD    /* the record does not tell parameters apart */
};

struct plant_wanted {
    uint8_t method, criterion; /* enum arx_method, enum arx_criterion */
    uint8_t na, nb;            /* highest orders */
    real_t fit;                /* least of the simulated outputs, part of 1 */
    uint32_t memory;           /* samples that the plant has to settle in */
};

struct plant_output {
    uint8_t verdict; /* enum plant_verdict */
    uint8_t na, nb;
    bool settled;         /* the method has */
    real_t one_step, fit; /* on the last third: 1 - rms of errors/rms about the mean */
    real_t a[DIFFERENCE_A_MOST];
    real_t b[DIFFERENCE_MOST][DIFFERENCE_B_MOST];
    real_t gain[DIFFERENCE_MOST]; /* at rest; 0 where it integrates */
    /* Distance of these gains from those of two thirds of the record, or from what the record leaves of them, whichever is more: times
     * what that input did, as a part of the largest effect of an input. */
    real_t apart;
};

struct plant_finding {
    struct plant_wanted wanted;
    struct arx_data data;
    struct arx_search search;
    struct arx_searching searching;
    struct arx_fitting fitting;
    struct arx_judging judging;
    struct plant_leftover {
        struct triangle triangle; /* columns: slow inputs, 1, what is left */
        real_t cells[(DIFFERENCE_MOST + 2) * (DIFFERENCE_MOST + 3) / 2];
        struct arx_history history; /* of the model alone */
        real_t slow[DIFFERENCE_MOST], pole;
        uint32_t k;
    } left;
    struct arx_fit fit, best; /* on the first two thirds; fit is that of all in the end */
    real_t best_criterion;
    struct arx_judgement best_judged;
    real_t moved[DIFFERENCE_MOST]; /* rms of the inputs */
    uint32_t border;
    uint16_t trial; /* that is fitted */
    uint8_t output, phase;
    bool any; /* best is one */
    struct plant_output found[DIFFERENCE_MOST];
};

/* data is one that arx_check accepts, and lives on. wanted: orders as arx_select takes them. */
void plant_finding_begin(struct plant_finding *f, const struct arx_data *data,
                         const struct plant_wanted *wanted);
/* Up to `most` samples, or one of the steps between them, some n^3 operations for n parameters. True while there is more. */
bool plant_finding_piece(struct plant_finding *f, uint32_t most);

/* Outputs that are done, and the i-th of them. */
unsigned plant_finding_done(const struct plant_finding *f);
const struct plant_output *plant_finding_output(const struct plant_finding *f, unsigned i);

/* Returns true when all roots of z^n + a[0] z^(n-1) + ... are within the circle of that radius, above 0. n to DIFFERENCE_A_MOST. */
bool plant_roots_within(const real_t *a, size_t n, real_t radius);

#endif
