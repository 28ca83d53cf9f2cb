/* Prints the firmware's own tables for tools/reference: commands, parameters, kinds of blocks with their verbs and events, codes of
 * refusals, and events. A line has fields with tabs between them; the first field says what the line is.
 *
 *     reference_tables                prints the tables
 *     reference_tables sentences      reads lines "CODE subject value detail", and prints each event as the console says it to people
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/error.h"
#include "base/event.h"
#include "block/block.h"
#include "console/commands.h"
#include "console/event_sentence.h"
#include "settings/parameters.h"

#define TEXT_MAX 1000 /* of blockN.kind: the names of all kinds */

static struct config config;

/* A text that would be printed shortened: its buffer here has to grow. */
static void refuse_cut(const struct text *text)
{
    if (!text->cut)
        return;
    fprintf(stderr, "reference_tables: a text has more than %u characters\n",
            (unsigned)(text->size - 1));
    exit(2);
}

/* ---- commands ---- */

static void print_commands(void)
{
#define ROW(name, arguments, help, words_min, words_max)                                           \
    printf("command\t%s\t%s\t%s\n", #name, arguments, help);
    CONSOLE_COMMANDS(ROW)
#undef ROW
}

/* ---- parameters ---- */

static void print_parameter(const char *line, const char *group, const struct parameter *p)
{
    char range[TEXT_MAX], initial[TEXT_MAX];
    struct text r = text_on(range, sizeof range), d = text_on(initial, sizeof initial);
    const struct block_parameter *own = parameter_own(p);
    parameter_range(p, &r);
    parameter_default(p, &config, &d);
    refuse_cut(&r);
    refuse_cut(&d);
    printf("%s\t%s\t%s\t%s\t%s\t%s\t%s\t0x%04x\t%u\t%u\n", line, group,
           own ? own->name : p->field->name, parameter_unit(p), range,
           strcmp(group, "decouple") == 0 ? "1 on the diagonal, else 0" : initial,
           parameter_about(p), (unsigned)parameter_id(p), own ? own->rows : 1u,
           own ? own->cols : 1u);
}

static void print_group(const struct parameter_group *group)
{
    printf("group\t%s\t%u\n", group->name, group->indexed ? group->count : 0u);
    for (unsigned f = 0; f < group->n_fields; f++) {
        struct parameter p = {.group = group, .field = &group->fields[f]};
        print_parameter("parameter", group->name, &p);
    }
}

/* ---- kinds ---- */

static const char *const stages[BLOCK_STAGES] = {
    [STAGE_CONTROL] = "controller",
    [STAGE_ESTIMATE] = "estimator",
    [STAGE_COMPENSATE] = "compensator",
    [STAGE_FEED_FORWARD] = "feedforward element",
};

static void print_kind(const struct block_kind *kind)
{
    struct parameter p;
    parameters_defaults(&config);
    if (parameter_find_in(&config, "block1.kind", &p) != ERR_OK ||
        parameter_set(&p, &config, kind->name) != ERR_OK) {
        fprintf(stderr, "reference_tables: block1.kind %s refused\n", kind->name);
        exit(2);
    }
    printf("kind\t%s\t%s\t%u\t%u\t%u\n", kind->name, stages[kind->stage], kind->members_most,
           kind->inputs_most, kind->points_most);
    for (unsigned n = 0; parameter_of(&config, n, &p); n++)
        if (parameter_own(&p) && p.index == 0 && p.row == 0)
            print_parameter("own", kind->name, &p);
    for (unsigned v = 0; v < kind->verbs; v++) {
        const struct block_verb *verb = &kind->verb[v];
        printf("verb\t%s\t%s\t%s\t%g\t%g\t%s\t%s\t%s\n", kind->name, verb->name,
               verb->number ? verb->number : "", (double)verb->lo, (double)verb->hi,
               verb->may_lack_number ? "optional" : "",
               verb->access == ACCESS_ENGINEER ? "engineer" : "operator", verb->help);
    }
    for (unsigned e = 0; e < kind->events; e++)
        printf("kind_event\t%s\t%s\t%s\t%s\n", kind->name, kind->event[e].code,
               kind->event[e].level == BLOCK_ALARM ? "alarm" : "info", kind->event[e].words);
}

/* ---- events ---- */

static void print_event(const char *boards, const char *name)
{
    for (unsigned code = 0; code < EVENT_COUNT; code++)
        if (strcmp(event_name((uint8_t)code), name) == 0)
            printf("event\t%u\t%s\t%s\t%s\t%s\n", code, name,
                   event_level_name(event_level((uint8_t)code)), event_text((uint8_t)code), boards);
}

static void print_events(void)
{
#define ALWAYS(name, text, level, unit)   print_event("every board", #name);
#define SEQUENCE(name, text, level, unit) print_event("boards with sequences", #name);
#define START_UP(name, text, level, unit) print_event("boards with automatic start-up", #name);
#define GUARD(name, text, level, unit)    print_event("boards with loop guards", #name);
#define JOB(name, text, level, unit)      print_event("boards with jobs", #name);
#define BLOCK(name, text, level, unit)    print_event("boards with blocks", #name);
#define CHECK(name, text, level, unit)    print_event("boards that check their RAM", #name);
#define PINS(name, text, level, unit)     print_event("boards with devices at their pins", #name);
    EVENT_LIST(ALWAYS, SEQUENCE, START_UP, GUARD, JOB, BLOCK, CHECK, PINS)
}

/* The board of the examples: a loop `top` that holds the temperature T1 by the reflux Lr. */
static void configure_example(void)
{
    parameters_defaults(&config);
    strcpy(config.measurement[0].name, "T1");
    strcpy(config.measurement[0].unit, "degC");
    strcpy(config.mv[0].name, "Lr");
    strcpy(config.mv[0].unit, "l/h");
    strcpy(config.loop[0].name, "top");
    strcpy(config.loop[0].pv, "T1");
    strcpy(config.loop[0].out, "Lr");
    strcpy(config.interlock[0].measurement, "T1");
    strcpy(config.interlock[0].mv, "Lr");
}

static unsigned kind_place(const char *name)
{
    unsigned k = 0;
    while (k < block_kind_count && strcmp(block_kinds[k]->name, name) != 0)
        k++;
    return k;
}

/* detail: a number, or the name of a kind, whose place stands for it. */
static int print_sentences(void)
{
    char line[300], code[40], subject[40], detail[40], said[400];
    float value;
    configure_example();
    while (fgets(line, sizeof line, stdin)) {
        if (sscanf(line, "%39s %39s %f %39s", code, subject, &value, detail) != 4)
            return 2;
        struct text t = text_on(said, sizeof said);
        unsigned k = 0;
        while (k < EVENT_COUNT && strcmp(event_name((uint8_t)k), code) != 0)
            k++;
        bool number = strspn(detail, "0123456789") == strlen(detail);
        unsigned d = number ? (unsigned)atoi(detail) : kind_place(detail);
        struct event e = event_make(0, (enum event_code)k, strcmp(subject, "-") != 0 ? subject : "",
                                    value, (uint8_t)d);
        event_sentence(&config, &e, &t);
        refuse_cut(&t);
        printf("%s\t%s\n", code, said);
    }
    return 0;
}

int main(int argc, char **argv)
{
    if (argc == 2 && strcmp(argv[1], "sentences") == 0)
        return print_sentences();
    if (argc != 1) {
        fprintf(stderr, "usage: reference_tables [sentences]\n");
        return 2;
    }
    parameters_defaults(&config);
    print_commands();
    for (unsigned g = 0; g < parameter_group_count; g++)
        print_group(&parameter_groups[g]);
    print_group(&parameter_blocks);
    for (unsigned k = 0; k < block_kind_count; k++)
        if (block_kinds[k]->parameter)
            print_kind(block_kinds[k]);
    for (int code = ERR_OK - 1; code >= ERR_LAST; code--)
        printf("error\t%s\t%s\n", err_name((enum err)code), err_text((enum err)code));
    print_events();
    return 0;
}
