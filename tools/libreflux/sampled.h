/* A difference model from the flat arrays of struct reflux_sampled. */
#ifndef REFLUX_LIBREFLUX_SAMPLED_H
#define REFLUX_LIBREFLUX_SAMPLED_H

#include "arrays.h"
#include "lti/difference_model.h"

/* ERR_RANGE: sizes; coefficients are not looked at. */
enum err take_sampled(const struct reflux_sampled *from, struct difference_model *to);

#endif
