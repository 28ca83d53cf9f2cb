/* The path through libserialport, over a pseudo-terminal. The library refuses pseudo-terminals for two questions
 * they cannot answer: an entry in /sys/class/tty, and the modem lines. This program answers both itself; all the
 * rest is the library's. */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include "bench/text.h"
#include "bench/transport.h"
#include "unity.h"

#define SYS_TTY "/sys/class/tty/"

/* ---- the two questions ---- */

int lstat(const char *restrict path, struct stat *restrict status)
{
    if (strncmp(path, SYS_TTY, strlen(SYS_TTY)) == 0) {
        memset(status, 0, sizeof(*status));
        status->st_mode = S_IFLNK | 0777;
        return 0;
    }
    return fstatat(AT_FDCWD, path, status, AT_SYMLINK_NOFOLLOW);
}

/* The name under which programs built for an older C library ask the same. */
int __lxstat(int version, const char *path, struct stat *status);
int __lxstat(int version, const char *path, struct stat *status)
{
    (void)version;
    return lstat(path, status);
}

ssize_t readlink(const char *restrict path, char *restrict buffer, size_t size)
{
    if (strncmp(path, SYS_TTY, strlen(SYS_TTY)) == 0) {
        return snprintf(buffer, size, "../../devices/platform/tty");
    }
    return readlinkat(AT_FDCWD, path, buffer, size);
}

int ioctl(int fd, unsigned long request, ...)
{
    va_list list;
    va_start(list, request);
    void *argument = va_arg(list, void *);
    va_end(list);
    if (request == TIOCMGET) {
        *(int *)argument = TIOCM_DTR | TIOCM_RTS;
        return 0;
    }
    if (request == TIOCMSET || request == TIOCMBIS || request == TIOCMBIC) {
        return 0;
    }
    int (*real)(int, unsigned long, ...);
    *(void **)&real = dlsym(RTLD_NEXT, "ioctl");
    return real(fd, request, argument);
}

/* ---- the tests ---- */

static struct transport t;
static char err[SIM_ERROR_SIZE];
static int peer;

static bool open_line(const char *baud)
{
    char name[48];
    char where[80];
    peer = posix_openpt(O_RDWR | O_NOCTTY);
    TEST_ASSERT_TRUE(peer >= 0 && grantpt(peer) == 0 && unlockpt(peer) == 0);
    TEST_ASSERT_EQUAL_INT(0, ptsname_r(peer, name, sizeof(name)));
    (void)snprintf(where, sizeof(where), "serial:%s%s", name, baud);
    return transport_open(&t, where, 0, err, sizeof(err));
}

void setUp(void) {}

void tearDown(void)
{
    transport_close(&t);
}

static double processor_s(void)
{
    struct rusage usage;
    (void)getrusage(RUSAGE_SELF, &usage);
    return (double)usage.ru_utime.tv_sec + 1e-6 * (double)usage.ru_utime.tv_usec +
           (double)usage.ru_stime.tv_sec + 1e-6 * (double)usage.ru_stime.tv_usec;
}

static void every_byte_value_passes_both_ways(void)
{
    TEST_ASSERT_TRUE_MESSAGE(open_line(""), err);
    uint8_t sent[256];
    uint8_t got[300];
    for (unsigned i = 0; i < sizeof(sent); i++) {
        sent[i] = (uint8_t)i;
    }
    TEST_ASSERT_TRUE(transport_write(&t, sent, sizeof(sent)));
    for (size_t n = 0; n < sizeof(sent);) {
        ssize_t k = read(peer, got + n, sizeof(got) - n);
        TEST_ASSERT_TRUE(k > 0);
        n += (size_t)k;
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(sent, got, sizeof(sent));
    TEST_ASSERT_EQUAL_INT(256, write(peer, sent, sizeof(sent)));
    struct transport *list[] = {&t};
    for (size_t n = 0; n < sizeof(sent);) {
        transport_wait(list, 1, 1000);
        size_t k = transport_read(&t, got + n, sizeof(got) - n);
        TEST_ASSERT_TRUE(k > 0);
        n += k;
    }
    TEST_ASSERT_EQUAL_HEX8_ARRAY(sent, got, sizeof(sent));
    (void)close(peer);
}

static void the_line_is_set_to_the_baud_rate_asked_for(void)
{
    TEST_ASSERT_TRUE_MESSAGE(open_line("@57600"), err);
    struct termios settings;
    TEST_ASSERT_EQUAL_INT(0, tcgetattr(t.fd, &settings));
    TEST_ASSERT_EQUAL_UINT(B57600, cfgetospeed(&settings));
    TEST_ASSERT_EQUAL_UINT(CS8, settings.c_cflag & CSIZE);
    TEST_ASSERT_EQUAL_UINT(0, settings.c_cflag & (PARENB | CSTOPB | CRTSCTS));
    TEST_ASSERT_EQUAL_UINT(0, settings.c_iflag & (IXON | IXOFF | ICRNL));
    (void)close(peer);
}

static void waiting_costs_no_processor_time_and_a_hang_up_is_noticed_at_once(void)
{
    TEST_ASSERT_TRUE_MESSAGE(open_line(""), err);
    struct transport *list[] = {&t};
    uint8_t byte;
    double wall = sim_clock_s();
    double processor = processor_s();
    transport_wait(list, 1, 200);
    TEST_ASSERT_EQUAL_size_t(0, transport_read(&t, &byte, 1));
    TEST_ASSERT_TRUE(sim_clock_s() - wall > 0.19);
    TEST_ASSERT_TRUE(processor_s() - processor < 0.05);
    TEST_ASSERT_FALSE(t.gone);
    (void)close(peer);
    wall = sim_clock_s();
    transport_wait(list, 1, 60000);
    TEST_ASSERT_EQUAL_size_t(0, transport_read(&t, &byte, 1));
    TEST_ASSERT_TRUE(t.gone);
    TEST_ASSERT_EQUAL_STRING("the serial port is gone (unplugged?)", t.reason);
    TEST_ASSERT_TRUE(sim_clock_s() - wall <
                     50.0); /* it did not wait; how busy the machine is, is its affair */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_byte_value_passes_both_ways);
    RUN_TEST(the_line_is_set_to_the_baud_rate_asked_for);
    RUN_TEST(waiting_costs_no_processor_time_and_a_hang_up_is_noticed_at_once);
    return UNITY_END();
}
