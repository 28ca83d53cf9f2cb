/* Tables of columns for tests: made from the simulated plants as reflux-sim makes them, pasted into a board in memory over its
 * console. */
#ifndef REFLUX_TESTS_PASTED_TABLE_H
#define REFLUX_TESTS_PASTED_TABLE_H

#include <stdlib.h>

#include "board_bench.h"
#include "columns/table_task.h"
#include "plants/plant_library.h"

static inline void make_table(struct table_lines *lines, const char *of, const char *components,
                              const char *truncated)
{
    char err[1024] = "";
    struct table_says says;
    struct table_task task = {.components = components, .truncated = truncated, .block = 1};
    const struct plant_class *class = plant_open(of, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(class, err);
    struct plant *p = plant_create(class, err, sizeof err);
    TEST_ASSERT_NOT_NULL_MESSAGE(p, err);
    TEST_ASSERT_TRUE_MESSAGE(table_task_make(class, p, &task, lines, &says, err, sizeof err), err);
    class->destroy(p);
}

#define SPLITTER_SUBSET "C3,iC4,nC4"

/* The column of the splitter with the components of the thesis' estimators, and the pilot column. */
static inline void splitter_table(struct table_lines *lines)
{
    make_table(lines, "splitter", SPLITTER_SUBSET, "2-15,20-22");
}

static inline void pilot_table(struct table_lines *lines)
{
    make_table(lines, "pilot", NULL, NULL);
}

/* The lines, one behind the other; free() them. */
static inline char *text_of(const struct table_lines *lines, unsigned block)
{
    char *text;
    size_t size;
    FILE *to = open_memstream(&text, &size);
    TEST_ASSERT_NOT_NULL(to);
    table_lines_print(to, block, lines);
    fclose(to);
    return text;
}

/* All of it but `apply`, in a transaction that stays open; of the lines behind `begin` no more than so many. */
static inline void paste_lines(const struct table_lines *lines, unsigned block, unsigned most)
{
    char *text = text_of(lines, block), *save = NULL;
    for (char *line = strtok_r(text, "\n", &save); line && strcmp(line, "apply") != 0 && most;
         line = strtok_r(NULL, "\n", &save), most--)
        ask_ok(line);
    free(text);
}

static inline void paste(const struct table_lines *lines, unsigned block)
{
    paste_lines(lines, block, UINT32_MAX);
    ask_ok("apply");
}

/* Everything that would restore the settings, as `dump` prints it; free() it. */
static inline char *dumped(void)
{
    ask_ok("dump");
    return strdup(board.said);
}

#endif
