/* Console and plant link at once, in any order: no command but in answer to a sample that stood on the line, what
 * the firmware says is whole, and the settings afterwards are sound.
 *
 * Input: steps, each a byte that says what, and what it needs.
 */
#include <string.h>

#include "fuzz.h"
#include "fuzz_board.h"

static const char *const commands[] = {
    "mode bottom auto",
    "mode top auto",
    "sp bottom 120",
    "sp top 80",
    "out top 4",
    "mode top manual",
    "log on 1",
    "log off",
    "begin",
    "apply",
    "abandon",
    "status",
    "set loop1.gain 3",
    "events",
    "stats",
    "set meas1.name abc",
    "set tick.base 2",
    "set mv2.name -",
    "alarm",
    "loop top",
    "set loop2.out top",
    "mode top cascade",
    "set loop1.name l1",
    "diff defaults",
};

/* Automatic start-up, which needs a plant that answers: stretches of samples, too. */
static const char *const start_up[] = {
    "commission begin",
    "commission accept",
    "commission",
    "commission model",
    "commission gains",
    "commission pairing",
    "commission structure",
    "commission proposal",
    "commission trial",
    "commission plant",
    "commission pause",
    "commission resume",
    "commission skip",
    "commission repeat",
    "commission abort",
    "commission edit",
    "commission reject",
    "out bottom 1",
    "mode bottom manual",
    "set test.rounds 1",
    "set mv1.test off",
    "set mv2.test_step 0.4",
    "set meas2.test_limit 8",
    "set loop2.gain 100",
    "reboot",
    "commission relay top",
    "commission relay bottom",
    "commission relay",
    "defaults",
    "load",
    "save",
    "set ff1.from heat",
    "set ff1.to reflux",
    "set ff1.dead 100",
};
#define START_UP (sizeof start_up / sizeof start_up[0])
#define STRETCH  (START_UP + 7u) /* a few more chances than one */

static void start_up_step(struct feed *f)
{
    unsigned k = feed_byte(f) % STRETCH;
    if (k < START_UP) {
        fuzz_type(start_up[k], strlen(start_up[k]));
        fuzz_type("\n", 1);
        return;
    }
    fuzz_stretch(feed_byte(f));
}

static void step(struct feed *f)
{
    uint8_t what = feed_byte(f);
    size_t n;
    struct frame frame = {0};
    switch (what & 7u) {
    case 0:
        n = feed_byte(f) & 63u;
        const uint8_t *text = feed_bytes(f, &n);
        fuzz_type(text, n);
        break;
    case 1: {
        if (what >> 3 >= sizeof commands / sizeof commands[0]) {
            start_up_step(f);
            break;
        }
        const char *command = commands[what >> 3];
        fuzz_type(command, strlen(command));
        fuzz_type("\n", 1);
        break;
    }
    case 2:
        n = feed_byte(f) & 63u;
        const uint8_t *bytes = feed_bytes(f, &n);
        fuzz_link(bytes, n);
        break;
    case 3: /* any payload in a whole frame */
        frame.type = feed_byte(f);
        n = feed_byte(f) % (FRAME_PAYLOAD_MAX + 1u);
        const uint8_t *payload = feed_bytes(f, &n);
        if (n)
            memcpy(frame.payload, payload, n);
        frame.n = (uint8_t)n;
        fuzz_frame(&frame);
        fuzz_link("", 0);
        break;
    case 4:
        fuzz_pass(feed_byte(f) * 10u);
        break;
    case 5:
    case 6:
        fuzz_sample(f, false);
        break;
    default:
        fuzz_sample(f, true);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct feed f = {data, size};
    fuzz_start(feed_byte(&f) & 1u);
    while (f.left)
        step(&f);
    fuzz_type("\x11", 1);
    if (fuzz_is_chosen(data, size))
        fuzz_settings_are_sound();
    return 0;
}
