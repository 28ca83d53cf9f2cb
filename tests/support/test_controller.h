/* A controller for tests of the bench: the controller's side of the plant link and of the console, as far as the
 * bench sees them, with a proportional law behind. Bytes in, bytes out; it never waits. The real firmware is
 * another program; this one exists to be started in a millisecond and to misbehave on request.
 */
#ifndef REFLUX_TESTS_TEST_CONTROLLER_H
#define REFLUX_TESTS_TEST_CONTROLLER_H

#include "link/messages.h"

#define TEST_BUFFER_SIZE 16384

struct test_controller {
    uint32_t session;
    enum { TEST_DOWN, TEST_GREETING, TEST_READY } state;
    uint32_t plant_session;
    uint8_t n_measurements, n_outputs, next_page;
    struct link_page page[2 * LINK_CHANNELS_MAX];
    struct frame_decoder decoder;
    uint16_t sequence;
    uint64_t now_ms, last_sent, last_heard, last_request;
    bool answered;
    struct link_command last;
    uint32_t ticks, duplicates, greetings;

    bool machine; /* console mode */
    bool log;
    char line[256];
    unsigned n_line;
    bool reboot_wanted;

    /* misbehaviour */
    uint32_t drop_command_every; /* each n-th command is not sent the first time; 0 = none */
    uint32_t mute_from_tick;     /* says nothing any more from this tick on; 0 = never */
    bool refuse_version;         /* greets with version 2 */

    uint8_t link_out[TEST_BUFFER_SIZE];
    unsigned n_link_out;
    char console_out[TEST_BUFFER_SIZE];
    unsigned n_console_out;
};

void test_controller_init(struct test_controller *c, uint32_t session, uint64_t now_ms);
void test_controller_link(struct test_controller *c, const uint8_t *bytes, unsigned n);
void test_controller_console(struct test_controller *c, const char *bytes, unsigned n);
/* Does what is due at now_ms: greetings, keep-alive, silence. */
void test_controller_turn(struct test_controller *c, uint64_t now_ms);

#endif
