/* Byte streams: what goes in comes out, and a vanished peer is noticed at once and without spinning. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <termios.h>
#include <unistd.h>

#include "bench/text.h"
#include "bench/transport.h"
#include "unity.h"

static char folder[] = "/tmp/reflux-transport-XXXXXX";
static char path[64];
static struct transport t;
static char err[SIM_ERROR_SIZE];

void setUp(void)
{
    (void)snprintf(path, sizeof(path), "%s/x", folder);
    (void)unlink(path);
}

void tearDown(void)
{
    (void)unlink(path);
}

static int listen_here(void)
{
    struct sockaddr_un address = {.sun_family = AF_UNIX};
    (void)snprintf(address.sun_path, sizeof(address.sun_path), "%s", path);
    int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    TEST_ASSERT_EQUAL_INT(0, bind(fd, (struct sockaddr *)&address, sizeof(address)));
    TEST_ASSERT_EQUAL_INT(0, listen(fd, 1));
    return fd;
}

static double processor_s(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec +
           (double)usage.ru_stime.tv_sec + 1e-6 * (double)usage.ru_stime.tv_usec;
}

/* All 256 byte values, both ways. */
static void assert_clean(int peer)
{
    uint8_t sent[256];
    uint8_t got[300]; /* roomier than needed: a full buffer would mean "ask again" */
    for (unsigned i = 0; i < 256; i++) {
        sent[i] = (uint8_t)i;
    }
    TEST_ASSERT_TRUE(transport_write(&t, sent, sizeof(sent)));
    size_t n = 0;
    while (n < sizeof(sent)) {
        ssize_t k = read(peer, got + n, sizeof(got) - n);
        TEST_ASSERT_TRUE(k > 0);
        n += (size_t)k;
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(sent, got, sizeof(sent));
    memset(got, 0, sizeof(got));
    TEST_ASSERT_EQUAL_INT(256, write(peer, sent, sizeof(sent)));
    struct transport *list[] = {&t};
    for (n = 0; n < sizeof(sent);) {
        transport_wait(list, 1, 1000);
        size_t k = transport_read(&t, got + n, sizeof(got) - n);
        TEST_ASSERT_TRUE(k > 0);
        n += k;
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(sent, got, sizeof(sent));
}

static void assert_waits_asleep(void)
{
    struct transport *list[] = {&t};
    double wall = sim_clock_s();
    double processor = processor_s();
    transport_wait(list, 1, 200);
    TEST_ASSERT_TRUE(sim_clock_s() - wall > 0.19);
    TEST_ASSERT_TRUE(processor_s() - processor < 0.05);
    TEST_ASSERT_FALSE(t.gone);
}

static void assert_noticed_at_once(void)
{
    struct transport *list[] = {&t};
    uint8_t byte;
    double wall = sim_clock_s();
    transport_wait(list, 1, 60000);
    TEST_ASSERT_EQUAL_size_t(0, transport_read(&t, &byte, 1));
    TEST_ASSERT_TRUE(t.gone);
    TEST_ASSERT_EQUAL_STRING("the other side closed the line", t.reason);
    transport_wait(list, 1, 60000); /* nothing to wait for any more */
    TEST_ASSERT_TRUE(sim_clock_s() - wall <
                     50.0); /* not one of them waited; how busy the machine is, is its affair */
    TEST_ASSERT_FALSE(transport_write(&t, "x", 1));
}

static void socket_round(const char *where)
{
    int listener = listen_here();
    TEST_ASSERT_TRUE_MESSAGE(transport_open(&t, where, 1000, err, sizeof(err)), err);
    int peer = accept(listener, NULL, NULL);
    assert_clean(peer);
    assert_waits_asleep();
    (void)close(peer);
    assert_noticed_at_once();
    transport_close(&t);
    (void)close(listener);
}

static void a_socket_carries_every_byte_and_its_end_is_noticed(void)
{
    char where[80];
    (void)snprintf(where, sizeof(where), "socket:%s", path);
    socket_round(where);
}

static void a_bare_path_of_a_socket_is_a_socket(void)
{
    socket_round(path);
}

static int new_terminal(char *name, size_t size)
{
    int peer = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(peer >= 0 && grantpt(peer) == 0 && unlockpt(peer) == 0);
    TEST_ASSERT_EQUAL_INT(0, ptsname_r(peer, name, size));
    return peer;
}

static void a_pseudo_terminal_carries_every_byte_and_its_end_is_noticed(void)
{
    for (unsigned bare = 0; bare < 2; bare++) {
        char name[48];
        char where[64];
        int peer = new_terminal(name, sizeof(name));
        (void)snprintf(where, sizeof(where), "%s%s", bare ? "" : "pty:", name);
        TEST_ASSERT_TRUE_MESSAGE(transport_open(&t, where, 0, err, sizeof(err)), err);
        assert_clean(peer);
        assert_waits_asleep();
        (void)close(peer);
        assert_noticed_at_once();
        transport_close(&t);
    }
}

static void a_new_pseudo_terminal_waits_for_its_peer_and_notices_its_end(void)
{
    char where[80];
    (void)snprintf(where, sizeof(where), "newpty:%s", path);
    TEST_ASSERT_TRUE_MESSAGE(transport_open(&t, where, 0, err, sizeof(err)), err);
    assert_waits_asleep(); /* nobody has opened it yet: that is no hang-up */
    int peer = open(path, O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(peer >= 0);
    assert_clean(peer);
    (void)close(peer);
    assert_noticed_at_once();
    transport_close(&t);
    TEST_ASSERT_EQUAL_INT(-1, access(path, F_OK)); /* the link is gone too */
}

static void what_cannot_be_opened_is_refused_with_a_reason(void)
{
    const char *wrong[][2] = {{"socket:", "path must have"},
                              {"socket:/no/such/socket", "No such file or directory"},
                              {"pty:/no/such/terminal", "No such file or directory"},
                              {"pty:/dev/null", "is not a terminal"},
                              {"/etc/passwd", "neither a socket nor a terminal"},
                              {"nonsense", "expected socket:PATH"},
                              {"serial:", "expected serial:/dev/ttyX"},
                              {"serial:/dev/ttyX@fast", "baud rate must be"},
                              {"serial:/dev/ttyX@12", "baud rate must be"},
                              {"serial:/dev/no_such_port", "serial:/dev/no_such_port"}};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        TEST_ASSERT_FALSE_MESSAGE(transport_open(&t, wrong[i][0], 30, err, sizeof(err)),
                                  wrong[i][0]);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(err, wrong[i][1]), err);
    }
}

static void a_peer_that_takes_nothing_is_given_up_after_two_seconds(void)
{
    char where[80];
    (void)snprintf(where, sizeof(where), "socket:%s", path);
    int listener = listen_here();
    TEST_ASSERT_TRUE_MESSAGE(transport_open(&t, where, 1000, err, sizeof(err)), err);
    char block[65536];
    memset(block, 'x', sizeof(block));
    while (transport_write(&t, block, sizeof(block))) { /* gives up, or is stopped as hanging */
    }
    TEST_ASSERT_EQUAL_STRING("the other side takes no more bytes", t.reason);
    transport_close(&t);
    (void)close(listener);
}

int main(void)
{
    if (mkdtemp(folder) == NULL) {
        return 1;
    }
    UNITY_BEGIN();
    RUN_TEST(a_socket_carries_every_byte_and_its_end_is_noticed);
    RUN_TEST(a_bare_path_of_a_socket_is_a_socket);
    RUN_TEST(a_pseudo_terminal_carries_every_byte_and_its_end_is_noticed);
    RUN_TEST(a_new_pseudo_terminal_waits_for_its_peer_and_notices_its_end);
    RUN_TEST(what_cannot_be_opened_is_refused_with_a_reason);
    RUN_TEST(a_peer_that_takes_nothing_is_given_up_after_two_seconds);
    (void)rmdir(folder);
    return UNITY_END();
}
