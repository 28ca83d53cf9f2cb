/* Compares the table of commands in docs/use/console.md with console/commands.h: every command has rows there, its rows name every word of
 * its arguments, and no row is of another command. Without a file it prints a row for each command.
 *
 *     command_table                   prints
 *     command_table docs/use/console.md   compares what stands between the two marks
 */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "console/commands.h"

#define BEGIN_MARK "<!-- commands: begin -->\n"
#define END_MARK   "<!-- commands: end -->"

static const struct command {
    const char *name, *arguments, *help;
} commands[] = {
#define ROW(name, arguments, help, words_min, words_max) {#name, arguments, help},
    CONSOLE_COMMANDS(ROW)
#undef ROW
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static char rows[COMMANDS][8000]; /* of each command on the page */

/* A bar would end the cell. */
static void print_cell(const char *text)
{
    for (; *text; text++)
        printf(*text == '|' ? "\\%c" : "%c", *text);
}

static int print(void)
{
    for (unsigned i = 0; i < COMMANDS; i++) {
        printf("| `%s%s", commands[i].name, commands[i].arguments[0] ? " " : "");
        print_cell(commands[i].arguments);
        printf("` | ");
        print_cell(commands[i].help);
        printf(" |\n");
    }
    return 0;
}

/* Letters, digits, _ and - are of a word. */
static size_t word_length(const char *text)
{
    size_t n = 0;
    while (isalnum((unsigned char)text[n]) || text[n] == '_' || text[n] == '-')
        n++;
    return n;
}

static bool has_word(const char *text, const char *word, size_t n)
{
    for (; *text; text++) {
        size_t length = word_length(text);
        if (length == n && strncmp(text, word, n) == 0)
            return true;
        text += length > 0 ? length - 1 : 0;
    }
    return false;
}

/* Puts a row of the page to those of its command. False: there is no such command. */
static bool sort_in(const char *row, size_t n)
{
    const char *name = row + strlen("| `");
    for (unsigned i = 0; i < COMMANDS; i++) {
        if (word_length(name) == strlen(commands[i].name) &&
            strncmp(name, commands[i].name, word_length(name)) == 0) {
            size_t used = strlen(rows[i]);
            if (used + n < sizeof rows[i])
                memcpy(rows[i] + used, row, n);
            return true;
        }
    }
    return false;
}

static int renew(const char *path, const char *what, size_t n, const char *is_wrong)
{
    fprintf(stderr,
            "%s: the table of commands: `%.*s` %s; renew it with\n"
            "    tools/figures/command_table.py\n",
            path, (int)n, what, is_wrong);
    return 1;
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
        fprintf(stderr, "%s: the marks around the table of commands are missing\n", path);
        return 1;
    }
    *end = '\0';
    int wrong = 0;
    for (const char *row = strstr(begin, "\n| `"); row; row = strstr(row + 1, "\n| `")) {
        const char *name = row + strlen("\n| `");
        if (!sort_in(row + 1, strcspn(row + 1, "\n") + 1))
            wrong |= renew(path, name, word_length(name), "is no command");
    }
    for (unsigned i = 0; i < COMMANDS; i++) {
        if (!rows[i][0])
            wrong |= renew(path, commands[i].name, strlen(commands[i].name), "has no row");
        for (const char *a = commands[i].arguments; rows[i][0] && *a;
             a += word_length(a) + (a[word_length(a)] != '\0')) {
            if (word_length(a) == 0 || has_word(rows[i], a, word_length(a)))
                continue;
            fprintf(stderr, "%s: `%s` takes %.*s, which none of its rows names; write it there\n",
                    path, commands[i].name, (int)word_length(a), a);
            wrong = 1;
        }
    }
    return wrong;
}

int main(int argc, char **argv)
{
    return argc == 2 ? compare(argv[1]) : print();
}
