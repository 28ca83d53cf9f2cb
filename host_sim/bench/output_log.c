#include "bench/output_log.h"

#include <errno.h>
#include <inttypes.h>
#include <string.h>

#include "bench/text.h"

bool output_log_open(struct output_log *log, const char *path, const struct plant_class *class,
                     char *err, size_t err_size)
{
    log->file = fopen(path, "w");
    if (log->file == NULL) {
        return sim_fail(err, err_size, "--outputs %s: %s", path, strerror(errno));
    }
    (void)fputs("ms,why", log->file);
    for (size_t i = 0; i < class->n_channels; i++) {
        if (class->channels[i].kind == PLANT_MV) {
            (void)fprintf(log->file, ",%s", class->channels[i].name);
        }
    }
    (void)fputc('\n', log->file);
    return true;
}

static void end_row(struct output_log *log)
{
    (void)fputc('\n', log->file);
    (void)fflush(log->file);
}

void output_log_command(struct output_log *log, uint64_t ms, const struct link_command *command)
{
    if (log->file == NULL) {
        return;
    }
    (void)fprintf(log->file, "%" PRIu64 ",command", ms);
    for (size_t i = 0; i < command->n_outputs; i++) {
        (void)fputc(',', log->file);
        if (command->output[i].drive) {
            (void)fprintf(log->file, "%.9g", (double)command->output[i].value);
        }
    }
    end_row(log);
}

void output_log_safe(struct output_log *log, uint64_t ms, const char *why,
                     const struct link_page *safe, size_t n)
{
    if (log->file == NULL) {
        return;
    }
    (void)fprintf(log->file, "%" PRIu64 ",%s", ms, why);
    for (size_t i = 0; i < n; i++) {
        (void)fprintf(log->file, ",%.9g", (double)safe[i].safe);
    }
    end_row(log);
}

bool output_log_close(struct output_log *log)
{
    bool whole = log->file == NULL || fclose(log->file) == 0;
    log->file = NULL;
    return whole;
}
