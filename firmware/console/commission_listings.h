/* Listings of `commission`: what automatic start-up does and has found. */
#ifndef REFLUX_CONSOLE_COMMISSION_LISTINGS_H
#define REFLUX_CONSOLE_COMMISSION_LISTINGS_H

#include "console/reply.h"

/* `commission relay [LOOP]` */
void commission_relay_command(struct client *c, unsigned n, char **word);
/* `commission watch [HOURS]` */
void commission_watch_command(struct client *c, unsigned n, char **word);
/* The watch under way; nothing while none is. */
void watch_progress_line(struct client *c, struct text *line);
/* `commission watched` */
bool commission_watched_line(struct client *c, unsigned n, struct text *line);
/* The relay test under way; nothing while none is. */
void relay_progress_line(struct client *c, struct text *line);
bool commission_relay_line(struct client *c, unsigned n, struct text *line);

struct advice;
/* Prints a piece of advice: the setting and why. */
void commission_advice_text(const struct config *config, const struct advice *a, struct text *line);
/* `commission plan|plant|structure|trial|model|gains|pairing|proposal|advice` */
bool commission_advice_line(struct client *c, unsigned n, struct text *line);
bool commission_plan_line(struct client *c, unsigned n, struct text *line);
bool commission_plant_line(struct client *c, unsigned n, struct text *line);
bool commission_structure_line(struct client *c, unsigned n, struct text *line);
bool commission_trial_line(struct client *c, unsigned n, struct text *line);
bool commission_model_line(struct client *c, unsigned n, struct text *line);
bool commission_gains_line(struct client *c, unsigned n, struct text *line);
bool commission_pairing_line(struct client *c, unsigned n, struct text *line);
bool commission_proposal_line(struct client *c, unsigned n, struct text *line);

#endif
