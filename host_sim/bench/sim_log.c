#include "bench/sim_log.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "bench/text.h"

#define FLUSH_ROWS 64

static void header(struct sim_log *log, const struct instruments *in)
{
    const struct plant_channel *channels = in->class->channels;
    (void)fputs("number,time[s],safe", log->file);
    for (size_t i = 0; i < in->n_sensors; i++) {
        const struct plant_channel *c = &channels[in->sensor[i].channel];
        (void)fprintf(log->file, ",%s.true[%s],%s.meas[%s],%s.quality", c->name, c->unit, c->name,
                      c->unit, c->name);
    }
    for (size_t i = 0; i < in->n_actuators; i++) {
        const struct plant_channel *c = &channels[in->actuator[i].channel];
        (void)fprintf(log->file, ",%s.cmd[%s],%s.drive,%s.applied[%s]", c->name, c->unit, c->name,
                      c->name, c->unit);
    }
    for (size_t i = 0; i < in->class->n_channels; i++) {
        const struct plant_channel *c = &channels[i];
        if (c->kind == PLANT_DISTURBANCE || c->kind == PLANT_INTERNAL) {
            (void)fprintf(log->file, ",%s[%s]", c->name, c->unit);
        }
    }
    (void)fputc('\n', log->file);
}

void sim_log_begin(struct sim_log *log, FILE *file, const struct instruments *in,
                   const char *comment)
{
    *log = (struct sim_log){.file = file};
    (void)fprintf(log->file, "# reflux-sim log, format %d; plant %s; %s\n", SIM_LOG_FORMAT,
                  in->class->name, comment);
    (void)fputs(
        "# true: the plant; meas: as sent; cmd: the answer to this sample, holds from its time "
        "on; applied: mean over the interval before it\n",
        log->file);
    header(log, in);
}

bool sim_log_open(struct sim_log *log, const char *path, const struct instruments *in,
                  const char *comment, char *err, size_t err_size)
{
    FILE *file = fopen(path, "w");
    if (file == NULL) {
        return sim_fail(err, err_size, "--log %s: %s", path, strerror(errno));
    }
    sim_log_begin(log, file, in, comment);
    return true;
}

void sim_log_row(struct sim_log *log, const struct instruments *in, const struct plant *plant,
                 const struct link_sample *sample, const struct link_command *command)
{
    if (log->file == NULL) {
        return;
    }
    (void)fprintf(log->file, "%" PRIu32 ",%.17g,%d", sample->number,
                  (double)sample->time_ms / 1000.0, command->safe ? 1 : 0);
    for (size_t i = 0; i < in->n_sensors; i++) {
        (void)fprintf(log->file, ",%.17g,%.9g,%u", in->sensor[i].truth,
                      (double)sample->measurement[i].value,
                      (unsigned)sample->measurement[i].quality);
    }
    for (size_t i = 0; i < in->n_actuators; i++) {
        (void)fprintf(log->file, ",%.9g,%d,%.9g", (double)command->output[i].value,
                      command->output[i].drive ? 1 : 0, (double)sample->readback[i].value);
    }
    for (size_t i = 0; i < in->class->n_channels; i++) {
        enum plant_kind kind = in->class->channels[i].kind;
        if (kind == PLANT_DISTURBANCE || kind == PLANT_INTERNAL) {
            (void)fprintf(log->file, ",%.17g", in->class->value(plant, i));
        }
    }
    (void)fputc('\n', log->file);
    log->rows++;
    if (log->rows % FLUSH_ROWS == 0) {
        (void)fflush(log->file);
    }
}

bool sim_log_close(struct sim_log *log)
{
    if (log->file == NULL) {
        return true;
    }
    bool good = ferror(log->file) == 0;
    good = fclose(log->file) == 0 && good;
    log->file = NULL;
    return good;
}
