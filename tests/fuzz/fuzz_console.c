/* Any bytes into the console in machine mode: as many replies as there are lines that are not blank; the board
 * comes to rest; the settings afterwards are sound.
 *
 * Input: a first byte (odd: two loops are configured and a plant is connected), then what is typed.
 */
#include <stdbool.h>
#include <string.h>

#include "console/line_editor.h"
#include "fuzz.h"
#include "fuzz_board.h"

/* The line editor as docs/use/console.md describes it, with the board's length of a line. */
static struct {
    char text[LINE_EDITOR_MAX + 1];
    size_t n;
    bool garbled, overlong, flow; /* flow: an XON, which may count as a character or not */
    char before;
} line;

enum ended { NOT_YET, BLANK, COMMAND, EITHER };

static enum ended typed(char c)
{
    char before = line.before;
    line.before = c;
    if (c == '\n' && before == '\r')
        return NOT_YET;
    if (c == '\r' || c == '\n') {
        line.text[line.n] = '\0';
        bool blank = strspn(line.text, " \t") == line.n && !line.garbled && !line.overlong;
        if (blank && line.flow)
            return EITHER;
        return blank ? BLANK : COMMAND;
    }
    if (c == '\b' || c == 127) {
        if (line.n)
            line.n--;
    } else if (c == 21 || c == 3) {
        line.n = 0;
        line.garbled = line.overlong = line.flow = false;
    } else if (c == '\t' || (c >= ' ' && c < 127)) {
        if (line.n < LINE_EDITOR_MAX)
            line.text[line.n++] = c;
        else
            line.overlong = true;
    } else if (c == 17) {
        line.flow = true;
    } else if (c != 0) {
        line.garbled = true;
    }
    return NOT_YET;
}

static bool first_word_is(const char *word)
{
    const char *at = line.text + strspn(line.text, " \t");
    size_t n = strcspn(at, " \t");
    return n == strlen(word) && strncmp(at, word, n) == 0;
}

/* After these the console is another one. */
static bool leaves_machine_mode(void)
{
    if (line.garbled || line.overlong)
        return false;
    return first_word_is("reboot") || (first_word_is("mode") && strstr(line.text, "human"));
}

static void type_and_count(const uint8_t *text, size_t n, unsigned lowest, unsigned highest)
{
    fuzz_type(text, n);
    unsigned replies = fuzz_replies();
    DEMAND(replies >= lowest && replies <= highest);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    fuzz_start(feed_byte(&f) & 1u);
    (void)fuzz_replies();
    memset(&line, 0, sizeof line);
    line.before = '\n';
    size_t from = 0, start = 0, at = 0; /* of what is not typed yet, of the line under way */
    unsigned expected = 0, either = 0;
    bool counting = true;
    for (; counting && at < f.left && f.data[at] != 19; at++) { /* nothing comes after an XOFF */
        enum ended ended = typed((char)f.data[at]);
        if (ended == NOT_YET)
            continue;
        counting = !leaves_machine_mode();
        if (!counting) {
            /* Replies that stand in the line die with a restart: those before are read first. */
            type_and_count(f.data + from, start - from, expected, expected + either);
            type_and_count(f.data + start, at + 1 - start, 0, 1);
            from = at + 1;
        }
        expected += ended == COMMAND;
        either += ended == EITHER;
        start = at + 1;
        line.n = 0;
        line.garbled = line.overlong = line.flow = false;
    }
    if (counting)
        type_and_count(f.data + from, at - from, expected, expected + either);
    if (at < f.left)
        fuzz_type(f.data + at, f.left - at);
    fuzz_type("\x11", 1);
    if (fuzz_is_chosen(data, size))
        fuzz_settings_are_sound();
    return 0;
}
