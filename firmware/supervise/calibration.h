/* The limits within which a calibrated reading may be true (docs/inside/faults.md). */
#ifndef REFLUX_SUPERVISE_CALIBRATION_H
#define REFLUX_SUPERVISE_CALIBRATION_H

#include "exchange/calibration.h"

/* Returns true if a calibrated reading of measurement i may be true. */
bool calibration_believes(const struct plan *plan, uint8_t i, float value);

#endif
