#include "kinds/experiment/experiment_finding.h"

#include "identify/prbs.h"
#include "kinds/experiment/experiment_finding_state.h"

#define ROWS_A_PIECE 8u

void experiment_finding_reset(struct experiment_finding *f)
{
    f->begun = f->over = false;
}

static void begin_finding(struct experiment_finding *f, const struct experiment_context *c,
                          const struct experiment_rows *rows)
{
    const struct arx_data data = experiment_rows_data(rows, c);
    /* The samples that the plant has to settle in. */
    uint32_t memory = prbs_memory(&(struct prbs_settings){.inputs = c->n,
                                                          .bits = (uint8_t)c->s.bits,
                                                          .independence = PRBS_SHIFTS,
                                                          .clock = c->s.clock});
    const struct plant_wanted wanted = {.method = c->s.method,
                                        .criterion = c->s.criterion,
                                        .na = (uint8_t)c->s.na,
                                        .nb = (uint8_t)c->s.nb,
                                        .fit = c->s.fit / 100,
                                        .memory = memory};
    plant_finding_begin(&f->finding, &data, &wanted);
    f->begun = true;
}

bool experiment_finding_piece(struct experiment_finding *f, const struct experiment_context *c,
                              const struct experiment_rows *rows)
{
    if (f->over)
        return false;
    if (!f->begun)
        begin_finding(f, c, rows);
    else
        f->over = !plant_finding_piece(&f->finding, ROWS_A_PIECE);
    return !f->over;
}

bool experiment_finding_is_over(const struct experiment_finding *f)
{
    return f->over;
}

const struct plant_finding *experiment_finding_result(const struct experiment_finding *f)
{
    return &f->finding;
}
