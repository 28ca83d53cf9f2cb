/* The line editor alone, on a terminal that knows what the screen shows: one row, a cursor, and the few controls the
 * editor uses. */
#include <stdio.h>
#include <string.h>

#include "console/line_editor.h"
#include "random_source.h"
#include "unity.h"

#define UP    "\033[A"
#define DOWN  "\033[B"
#define RIGHT "\033[C"
#define LEFT  "\033[D"
#define HOME  "\033[H"
#define END   "\033[F"
#define DEL   "\033[3~"

static struct line_editor editor;
static char row[1000]; /* what the screen shows of the line under way */
static unsigned at, widest;
static char above[2000]; /* rows that were finished by the editor itself */
static char finished[LINE_EDITOR_MAX + 1];
static unsigned n_finished;

static void show(char x)
{
    if (x == '\b') {
        TEST_ASSERT_TRUE_MESSAGE(at > 0, "the cursor left the line to the left");
        at--;
    } else if (x == '\n') {
        strcat(above, row);
        strcat(above, "\n");
        memset(row, 0, sizeof row);
        at = widest = 0;
    } else if (x == '\r') {
        at = 0;
    } else {
        TEST_ASSERT_TRUE(at < sizeof row - 1);
        row[at++] = x;
        widest = at > widest ? at : widest;
    }
}

static void screen(void *context, const char *text, size_t n)
{
    (void)context;
    for (size_t i = 0; i < n; i++) {
        if (n - i >= 7 && strncmp(text + i, "\033[H\033[2J", 7) == 0) { /* top left, and wipe all */
            memset(row, 0, sizeof row);
            memset(above, 0, sizeof above);
            at = widest = 0;
            i += 6;
        } else if (text[i] == '\033') { /* ESC [ K: wipe from the cursor on */
            TEST_ASSERT_EQUAL_STRING_LEN("\033[K", text + i, 3);
            memset(row + at, 0, sizeof row - at);
            i += 2;
        } else {
            show(text[i]);
        }
    }
}

/* Commands, and after `mode` loops and a mode; the last choice is a half. */
static bool choices(void *context, const char *line, unsigned n, struct text *word)
{
    static const char *const commands[] = {"mode", "", "help", "reboot", "monitor"};
    static const char *const loops[] = {"top", "bottom", "bottom_2", "loop1."};
    (void)context;
    if (strchr(line, ' ')) {
        if (n < 4)
            text_str(word, loops[n]);
        return n < 4;
    }
    if (n < 5)
        text_str(word, commands[n]);
    return n < 5;
}

static void prompt(void *context)
{
    screen(context, "> ", 2);
}

void setUp(void)
{
    static const struct line_editor_port port = {screen, choices, prompt};
    line_editor_init(&editor, &port, NULL);
    memset(row, 0, sizeof row);
    memset(above, 0, sizeof above);
    at = widest = 0;
    finished[0] = '\0';
    n_finished = 0;
}
void tearDown(void) {}

static void feed(const char *keys, size_t n, bool people)
{
    for (size_t i = 0; i < n; i++) {
        if (!line_editor_take(&editor, keys[i], people))
            continue;
        strcpy(finished, editor.line);
        n_finished++;
        line_editor_remember(&editor, editor.line);
        line_editor_next(&editor);
        memset(row, 0, sizeof row);
        at = widest = 0;
    }
}

static void type(const char *keys)
{
    feed(keys, strlen(keys), true);
}

static void type_as_script(const char *keys)
{
    feed(keys, strlen(keys), false);
}

/* The screen and the editor agree on line and cursor; blanks at the end are wiped places. */
static void shows(const char *line)
{
    char seen[sizeof row];
    TEST_ASSERT_EQUAL_STRING(line, editor.line);
    strcpy(seen, row);
    size_t n = strlen(seen);
    while (n && seen[n - 1] == ' ')
        seen[--n] = '\0';
    char want[sizeof row];
    strcpy(want, line);
    n = strlen(want);
    while (n && want[n - 1] == ' ')
        want[--n] = '\0';
    TEST_ASSERT_EQUAL_STRING(want, seen);
    TEST_ASSERT_EQUAL(editor.cursor, at);
}

/* ---- editing ---- */

static void what_is_typed_is_echoed_and_finished_by_any_end_of_line(void)
{
    type("sp top 80");
    shows("sp top 80");
    type("\r\n");
    TEST_ASSERT_EQUAL(1, n_finished);
    TEST_ASSERT_EQUAL_STRING("sp top 80", finished);
    type("a\nb\r");
    TEST_ASSERT_EQUAL(3, n_finished);
}

static void the_line_is_edited_in_its_middle(void)
{
    type("sp tp 80" LEFT LEFT LEFT LEFT "o");
    shows("sp top 80");
    type(HOME "x" END "1");
    shows("xsp top 801");
    type(HOME DEL);
    shows("sp top 801");
    type(END "\b");
    shows("sp top 80");
    type(LEFT LEFT "\b\b\b\b");
    shows("sp 80");
}

static void keys_of_other_terminals_do_the_same(void)
{
    type("abc\033OD\033OD\033[1~x\033[4~y\033[7~\033[3~\033[8~z");
    shows("abcyz");
    type("\x01v\x05w"); /* ^A, ^E */
    shows("vabcyzw");
}

static void the_cursor_stays_within_the_line(void)
{
    type(LEFT RIGHT "\b" DEL "ab" RIGHT RIGHT "c" HOME LEFT "\b");
    shows("abc");
}

static void control_u_and_control_c_start_again_from_anywhere(void)
{
    type("set loop1.gain 2" LEFT LEFT "\x15");
    shows("");
    type("out top 2\x03");
    shows("");
}

static void keys_that_mean_nothing_are_swallowed_whole(void)
{
    type("a\033[5~b\033[15;2~c\033xd\033[Ze");
    shows("abcde");
    TEST_ASSERT_FALSE(editor.garbled);
}

static void an_end_of_line_ends_a_sequence_cut_off(void)
{
    type("get x\033[\r");
    TEST_ASSERT_EQUAL_STRING("get x", finished);
}

static void a_line_is_full_at_its_limit_and_marked_beyond(void)
{
    for (unsigned i = 0; i < LINE_EDITOR_MAX; i++)
        type("x");
    TEST_ASSERT_FALSE(editor.overlong);
    type(HOME "y");
    TEST_ASSERT_TRUE(editor.overlong);
    TEST_ASSERT_EQUAL(LINE_EDITOR_MAX, strlen(editor.line));
    type("\x15");
    TEST_ASSERT_FALSE(editor.overlong);
}

static void the_line_can_be_shown_again_with_the_cursor_in_its_place(void)
{
    type("sp top 80" LEFT LEFT);
    memset(row, 0, sizeof row);
    at = 0;
    line_editor_show(&editor);
    shows("sp top 80");
}

/* ---- scripts ---- */

static void a_script_sees_no_echo_and_its_tabs_are_blanks(void)
{
    type_as_script("mode\ttop");
    TEST_ASSERT_EQUAL_STRING("mode top", editor.line);
    TEST_ASSERT_EQUAL_STRING("", row);
    type_as_script("\bo\n");
    TEST_ASSERT_EQUAL_STRING("mode too", finished);
}

static void escape_and_foreign_characters_mark_a_scripts_line(void)
{
    type_as_script("\033[A");
    TEST_ASSERT_TRUE(editor.garbled);
    type_as_script("\x15");
    type_as_script("\xC3\xA4");
    TEST_ASSERT_TRUE(editor.garbled);
    type_as_script("\n");
    type_as_script("ok");
    TEST_ASSERT_FALSE(editor.garbled);
}

/* ---- history ---- */

static void up_and_down_go_through_past_lines(void)
{
    type("one\rtwo\rthree\r" UP);
    shows("three");
    type(UP UP);
    shows("one");
    type(UP);
    shows("one");
    type(DOWN);
    shows("two");
    type(DOWN DOWN);
    shows("");
    type(DOWN);
    shows("");
}

static void a_past_line_can_be_changed_and_run_again(void)
{
    type("sp top 80\r" UP "\b5\r");
    TEST_ASSERT_EQUAL_STRING("sp top 85", finished);
    type(UP UP);
    shows("sp top 80");
}

static void the_same_line_twice_and_empty_lines_are_kept_once_and_not_at_all(void)
{
    type("one\rtwo\rtwo\r\r\r" UP UP);
    shows("one");
}

static void the_oldest_lines_make_room(void)
{
    char line[40];
    unsigned kept = 0;
    for (unsigned i = 0; i < 100; i++) {
        snprintf(line, sizeof line, "set loop1.gain %u.25\r", i);
        type(line);
    }
    for (unsigned i = 99; i < 100; i--) {
        char before[LINE_EDITOR_MAX + 1];
        strcpy(before, editor.line);
        type(UP);
        if (strcmp(before, editor.line) == 0)
            break;
        snprintf(line, sizeof line, "set loop1.gain %u.25", i);
        shows(line);
        kept++;
    }
    TEST_ASSERT_EQUAL(LINE_EDITOR_HISTORY / 21, kept);
}

/* ---- completion ---- */

static void a_tab_completes_what_only_one_word_can_be(void)
{
    type("he\t");
    shows("help ");
    type("\x15mod\tt\t");
    shows("mode top ");
}

static void a_tab_goes_as_far_as_all_choices_agree_and_then_shows_them(void)
{
    type("mode b\t");
    shows("mode bottom");
    TEST_ASSERT_EQUAL_STRING("", above);
    type("\t");
    TEST_ASSERT_NOT_NULL(strstr(above, "bottom  bottom_2  \n"));
    TEST_ASSERT_EQUAL_STRING("> mode bottom", row);
    TEST_ASSERT_EQUAL_STRING("mode bottom", editor.line);
}

static void a_tab_on_nothing_shows_all_there_is(void)
{
    type("\t");
    TEST_ASSERT_NOT_NULL(strstr(above, "mode  help  reboot  monitor  "));
}

static void half_a_name_gets_no_blank(void)
{
    type("mode l\t");
    shows("mode loop1.");
}

static void a_tab_where_nothing_fits_changes_nothing(void)
{
    type("xyz\t");
    shows("xyz");
    TEST_ASSERT_EQUAL_STRING("", above);
}

static void a_tab_in_the_middle_completes_the_word_before_the_cursor(void)
{
    type("he x" LEFT LEFT "\t");
    shows("help x");
}

/* ---- anything ---- */

static void any_keys_in_any_order_leave_screen_and_line_in_agreement(void)
{
    static const char *const keys[] = {UP,   DOWN,    LEFT,   RIGHT,  HOME,   END,
                                       DEL,  "\b",    "\x7f", "\x15", "\r",   "a",
                                       "b ", "mode ", "x",    "\x01", "\x05", "\x03"};
    struct random_source source = {.state = 0xED17u};
    for (unsigned n = 0; n < 200000; n++) {
        type(keys[random_below(&source, sizeof keys / sizeof keys[0])]);
        TEST_ASSERT_TRUE(editor.cursor <= editor.n);
        TEST_ASSERT_EQUAL(strlen(editor.line), editor.n);
        if (n % 16 == 0)
            shows(editor.line);
    }
}

static void control_l_leaves_the_line_alone_on_the_screen(void)
{
    strcpy(above, "what stood there\n");
    type("mode top\033[D\033[D\x0c");
    TEST_ASSERT_EQUAL_STRING("", above);
    TEST_ASSERT_EQUAL_STRING("> mode top", row);
    type("\x0cx");
    TEST_ASSERT_EQUAL_STRING("> mode txop", row);
}

static void noise_never_leaves_the_buffers(void)
{
    struct random_source source = {.state = 0xED17u};
    for (unsigned n = 0; n < 300000; n++) {
        char x = (char)random_next(&source);
        if (x == '\t')
            memset(above, 0, sizeof above);
        if (line_editor_take(&editor, x, n % 50000 < 25000)) {
            line_editor_remember(&editor, editor.line);
            line_editor_next(&editor);
            memset(row, 0, sizeof row);
        }
        at = editor.cursor; /* both kinds of session are mixed here: the screen is not followed */
        TEST_ASSERT_EQUAL(strlen(editor.line), editor.n);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_is_typed_is_echoed_and_finished_by_any_end_of_line);
    RUN_TEST(the_line_is_edited_in_its_middle);
    RUN_TEST(keys_of_other_terminals_do_the_same);
    RUN_TEST(the_cursor_stays_within_the_line);
    RUN_TEST(control_u_and_control_c_start_again_from_anywhere);
    RUN_TEST(keys_that_mean_nothing_are_swallowed_whole);
    RUN_TEST(an_end_of_line_ends_a_sequence_cut_off);
    RUN_TEST(a_line_is_full_at_its_limit_and_marked_beyond);
    RUN_TEST(the_line_can_be_shown_again_with_the_cursor_in_its_place);
    RUN_TEST(a_script_sees_no_echo_and_its_tabs_are_blanks);
    RUN_TEST(escape_and_foreign_characters_mark_a_scripts_line);
    RUN_TEST(up_and_down_go_through_past_lines);
    RUN_TEST(a_past_line_can_be_changed_and_run_again);
    RUN_TEST(the_same_line_twice_and_empty_lines_are_kept_once_and_not_at_all);
    RUN_TEST(the_oldest_lines_make_room);
    RUN_TEST(a_tab_completes_what_only_one_word_can_be);
    RUN_TEST(a_tab_goes_as_far_as_all_choices_agree_and_then_shows_them);
    RUN_TEST(a_tab_on_nothing_shows_all_there_is);
    RUN_TEST(half_a_name_gets_no_blank);
    RUN_TEST(a_tab_where_nothing_fits_changes_nothing);
    RUN_TEST(a_tab_in_the_middle_completes_the_word_before_the_cursor);
    RUN_TEST(any_keys_in_any_order_leave_screen_and_line_in_agreement);
    RUN_TEST(control_l_leaves_the_line_alone_on_the_screen);
    RUN_TEST(noise_never_leaves_the_buffers);
    return UNITY_END();
}
