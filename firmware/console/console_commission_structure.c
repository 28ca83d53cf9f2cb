/* `commission structure`: parts, blocks and cascades of the plant. A proposal gets its inner loops and feedforwards from them. The
 * listings are like those of console_commission_model.c; gains are in spans. */
#include "commission/analysis_structure.h"
#include "commission/commission.h"
#include "commission/words.h"
#include "console/commission_listings.h"
#include "console/commission_structural.h"
#include "console/commission_words.h"
#include "console/phrases.h"

static const struct analysis *analysis(const struct client *c)
{
    return &c->service->commission->work->analysis;
}

static const char *input(const struct client *c, uint8_t k)
{
    const struct commission *m = c->service->commission;
    uint8_t i = analysis_job_input(&m->analysis_job, analysis(c)->pairs.input[k]);
    return commission_output(c, i)->name;
}

/* Names of pair k. */
static void pair(const struct client *c, uint8_t k, struct text *line)
{
    put_word(line, commission_measurement(c, analysis(c)->pairs.output[k])->name);
    put_word(line, input(c, k));
}

static void block_line(const struct analysis *a, unsigned b, struct text *line)
{
    const struct structure *s = layout_structure(&a->layout);
    text_str(line, "block");
    text_named_u32(line, "number", b + 1u);
    text_named_u32(line, "part", s->block[b].part + 1u);
    text_named_u32(line, "pairs", s->block[b].size);
    text_named_float(line, "worst_lambda", s->block[b].worst_lambda);
    text_str(line, " driven_by");
    if (!s->block[b].driven_by)
        text_str(line, " -");
    for (unsigned i = 0; i < s->blocks; i++) {
        if (!(s->block[b].driven_by >> i & 1u))
            continue;
        text_char(line, ' ');
        text_u32(line, i + 1u);
    }
}

/* A block that single loops will not serve well, and what stands in for the controller it wants. */
static void multivariable_line(const struct analysis *a, unsigned b, struct text *line)
{
    if (!layout_structure(&a->layout)->block[b].mimo)
        return;
    text_str(line, "multivariable");
    text_named_u32(line, "block", b + 1u);
    text_named_str(line, "wants", "a multivariable controller");
    text_named_str(line, "gets",
                   a->decoupler == DECOUPLER_USED ? "single loops behind a static decoupler"
                   : a->designed                  ? "single loops, slowed"
                                                  : "nothing");
}

static void member_line(const struct client *c, uint8_t k, struct text *line)
{
    const struct structure *s = layout_structure(&analysis(c)->layout);
    unsigned b = s->pair_block[k];
    text_str(line, "member");
    pair(c, k, line);
    text_named_u32(line, "block", b + 1u);
    text_named_str(line, "single_loop", s->block[b].mimo >> k & 1u ? "no" : "yes");
}

static void put_way(const struct client *c, const struct cross_way *way, struct text *line)
{
    text_str(line, " from");
    pair(c, way->from, line);
    text_str(line, " to");
    pair(c, way->to, line);
    text_named_float(line, "gain", way->gain);
    text_named_float(line, "lead", way->lead_s);
    text_named_float(line, "lag", way->lag_s);
    text_named_float(line, "dead", way->dead_s);
    text_named_float(line, "late", way->late_s);
}

static void way_line(const struct client *c, uint8_t from, uint8_t to, struct text *line)
{
    const struct analysis *a = analysis(c);
    struct cross_way way;
    if (from == to || structure_cross_way(&a->plant, &a->pairs, layout_structure(&a->layout), from,
                                          to, &way) != ERR_OK)
        return;
    text_str(line, "way");
    put_way(c, &way, line);
}

static void cascade_line(const struct client *c, const struct cascade *found, struct text *line)
{
    bool used = (layout_inner_outputs(&analysis(c)->layout) & (1u << found->inner)) != 0u;
    text_str(line, "cascade");
    text_named_str(line, "inner", commission_measurement(c, found->inner)->name);
    text_named_str(line, "outer", commission_measurement(c, found->outer)->name);
    text_named_float(line, "gain", found->between.gain);
    text_named_float(line, "lag", found->between.time_constant_s);
    text_named_float(line, "dead", found->between.dead_time_s);
    text_named_float(line, "misfit", found->misfit_sd);
    text_named_str(line, "used",
                   used ? "yes" : "no: no input of their own, or no settings for the inner loop");
}

static bool structure_lines(const struct client *c, unsigned n, struct text *line)
{
    const struct analysis *a = analysis(c);
    const struct structure *s = layout_structure(&a->layout);
    if (n == 0) {
        text_str(line, "structure");
        text_named_u32(line, "parts", s->parts);
        text_named_u32(line, "blocks", s->blocks);
        return true;
    }
    n--;
    if (n < s->blocks) {
        block_line(a, n, line);
        return true;
    }
    n -= s->blocks;
    if (n < a->pairs.n) {
        member_line(c, (uint8_t)n, line);
        return true;
    }
    n -= a->pairs.n;
    if (n < s->blocks) {
        multivariable_line(a, n, line);
        return true;
    }
    n -= s->blocks;
    if (n >= (unsigned)a->pairs.n * a->pairs.n)
        return false;
    way_line(c, (uint8_t)(n / a->pairs.n), (uint8_t)(n % a->pairs.n), line);
    return true;
}

bool commission_structure_line(struct client *c, unsigned n, struct text *line)
{
    const struct analysis *a = analysis(c);
    bool has = commission_has_results(c->service->commission);
    if (n == 0 && has)
        operate_startup_shown(&c->session);
    if (has && n < layout_cascades(&a->layout)) {
        cascade_line(c, layout_cascade(&a->layout, n), line);
        return true;
    }
    n -= has ? layout_cascades(&a->layout) : 0u;
    if (has && layout_structure(&a->layout))
        return structure_lines(c, n, line);
    if (n == 0)
        text_str(line, has || !commission_had_results(c->service->commission)
                           ? "structure none: the pairing must be determined first"
                           : RESULTS_DISCARDED);
    return n == 0;
}

static void inner_line(const struct client *c, uint8_t k, struct text *line)
{
    const struct analysis *a = analysis(c);
    const struct tuning *t = layout_inner_tuning(&a->layout, k);
    uint8_t inner = analysis_inner_of(a, k);
    if (inner == INTERACT_NONE)
        return;
    text_str(line, "inner");
    put_word(line, commission_measurement(c, inner)->name);
    put_word(line, input(c, k));
    text_named_float(line, "gain", t->gain);
    text_named_float(line, "ti", t->ti_s);
    text_named_float(line, "td", t->td_s);
    text_str(line, t->action == TUNING_DIRECT ? " direct" : " reverse");
    text_named_str(line, "below", commission_measurement(c, a->pairs.output[k])->name);
}

static void feed_line(const struct client *c, uint8_t from, uint8_t to, struct text *line)
{
    struct feed f = analysis_feed(analysis(c), from, to);
    if (f.verdict == FEED_NONE)
        return;
    text_str(line, "feedforward");
    put_way(c, &f.way, line);
    text_named_float(line, "left", f.left);
    text_named_str(line, "used", words_of_feed(f.verdict));
}

bool commission_structural_line(struct client *c, unsigned n, struct text *line)
{
    const struct analysis *a = analysis(c);
    if (n < a->pairs.n) {
        inner_line(c, (uint8_t)n, line);
        return true;
    }
    n -= a->pairs.n;
    if (n >= (unsigned)a->pairs.n * a->pairs.n)
        return false;
    feed_line(c, (uint8_t)(n / a->pairs.n), (uint8_t)(n % a->pairs.n), line);
    return true;
}
