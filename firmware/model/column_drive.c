#include "model/column_drive.h"

#define ZERO REAL_C(0.0)
#define TWO  REAL_C(2.0)

static real_t at_least_zero(real_t x)
{
    return x > ZERO ? x : ZERO;
}

void column_drive_take(const struct column_table *table, struct column_inputs *inputs,
                       enum column_drive drive, real_t value)
{
    const struct column_config *config = &table->config;
    real_t pressure = table->nominal.pressure_top;
    switch (drive) {
    case DRIVE_FEED:
        inputs->feed_flow = at_least_zero(value);
        break;
    case DRIVE_FEED_TEMPERATURE:
        inputs->feed_temperature =
            real_clamp(value, config->temperature_min, config->temperature_max);
        break;
    case DRIVE_FEED_QUALITY:
        inputs->feed_quality = real_clamp(value, ZERO, TWO);
        break;
    case DRIVE_REFLUX:
        inputs->reflux_flow = at_least_zero(value);
        break;
    case DRIVE_HEAT:
        inputs->heat = at_least_zero(value - table->heat_loss);
        break;
    case DRIVE_BOILUP:
        inputs->boilup = at_least_zero(value);
        break;
    default:
        inputs->pressure_top = real_clamp(value, pressure / TWO, pressure * TWO);
        break;
    }
}

const char *column_drive_refused(const struct column_table *table, enum column_drive drive)
{
    const struct column_inputs *in = &table->nominal;
    if ((drive == DRIVE_HEAT && in->boilup_given) || (drive == DRIVE_BOILUP && !in->boilup_given))
        return "must have heat or boilup, whichever the table has";
    if ((drive == DRIVE_FEED_TEMPERATURE && in->feed_state != COLUMN_FEED_TEMPERATURE) ||
        (drive == DRIVE_FEED_QUALITY && in->feed_state != COLUMN_FEED_QUALITY))
        return "must have the feed's temperature or quality, whichever the table has";
    return NULL;
}
