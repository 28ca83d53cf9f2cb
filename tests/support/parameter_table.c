/* Prints the table of parameters in docs/use/console.md from their declaration. With a file as argument: compares
 * instead, and fails where the file's table is another.
 *
 *     parameter_table                   prints
 *     parameter_table docs/use/console.md   compares what stands between the two marks
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "settings/parameters.h"

#define BEGIN_MARK "<!-- parameters: begin -->\n"
#define END_MARK   "<!-- parameters: end -->"
#define RANGE_MAX  1000 /* of blockN.kind: the names of all kinds */

static char table[60000];
static size_t used;

static void add(const char *text)
{
    size_t n = strlen(text);
    if (used + n >= sizeof table)
        exit(2);
    memcpy(table + used, text, n + 1);
    used += n;
}

/* A text that the table would show shortened: its buffer here has to grow. */
static void refuse_cut(const struct parameter *p, const char *what, const struct text *text)
{
    if (!text->cut)
        return;
    fprintf(stderr, "parameter_table: %s of %s%s.%s has more than %u characters\n", what,
            p->group->name, p->group->indexed ? "<i>" : "", p->field->name,
            (unsigned)(text->size - 1));
    exit(2);
}

/* A bar would end the cell. */
static void add_cell(const char *text)
{
    for (; *text; text++) {
        char one[3] = {*text, '\0', '\0'};
        if (*text == '|') {
            one[0] = '\\';
            one[1] = '|';
        }
        add(one);
    }
    add(" | ");
}

static void add_group(const struct parameter_group *group)
{
    static struct config defaults;
    parameters_defaults(&defaults);
    char line[160];
    snprintf(line, sizeof line, "\n**`%s%s`**", group->name, group->indexed ? "<i>" : "");
    add(line);
    if (group->indexed)
        snprintf(line, sizeof line, ", i = 1 to %u", group->count);
    add(group->indexed ? line : "");
    add("\n\n| name | unit | allowed | default | what | id |\n|---|---|---|---|---|---|\n");
    for (unsigned f = 0; f < group->n_fields; f++) {
        struct parameter p = {.group = group, .field = &group->fields[f]};
        char range[RANGE_MAX], initial[60];
        struct text r = text_on(range, sizeof range), d = text_on(initial, sizeof initial);
        parameter_range(&p, &r);
        parameter_default(&p, &defaults, &d);
        refuse_cut(&p, "what is allowed", &r);
        refuse_cut(&p, "the default", &d);
        add("| ");
        add_cell(p.field->name);
        add_cell(parameter_unit(&p));
        add_cell(range);
        bool diagonal = strcmp(group->name, "decouple") == 0;
        add_cell(diagonal ? "1 on the diagonal, else 0" : initial);
        add_cell(p.field->help);
        snprintf(line, sizeof line, "0x%04x |\n", (unsigned)parameter_id(&p));
        add(line);
    }
}

static int compare(const char *path)
{
    static char text[200000];
    FILE *f = fopen(path, "rb");
    if (!f) {
        fprintf(stderr, "%s: cannot be opened\n", path);
        return 1;
    }
    text[fread(text, 1, sizeof text - 1, f)] = '\0';
    fclose(f);
    char *begin = strstr(text, BEGIN_MARK), *end = strstr(text, END_MARK);
    if (!begin || !end || end < begin) {
        fprintf(stderr, "%s: the marks around the table of parameters are missing\n", path);
        return 1;
    }
    begin += strlen(BEGIN_MARK);
    if ((size_t)(end - begin) == used && memcmp(begin, table, used) == 0)
        return 0;
    fprintf(stderr,
            "%s: the table of parameters is not what the firmware declares; renew it with\n"
            "    tools/figures/parameter_table.py\n",
            path);
    return 1;
}

int main(int argc, char **argv)
{
    for (unsigned g = 0; g < parameter_group_count; g++)
        add_group(&parameter_groups[g]);
#if CONFIG_BLOCKS
    add_group(&parameter_blocks);
#endif
    add("\n");
    if (argc == 2)
        return compare(argv[1]);
    return fputs(table, stdout) < 0;
}
