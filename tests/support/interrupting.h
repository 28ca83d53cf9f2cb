/* The tick interrupts the main loop anywhere: it runs in the handler of a timer signal that comes a random time after the last one, or
 * after the tick was locked out, and the tick lock blocks that signal. The test defines _GNU_SOURCE and the plant: hello(), page(), next_sample() and look_at(). */
#ifndef REFLUX_TESTS_INTERRUPTING_H
#define REFLUX_TESTS_INTERRUPTING_H

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include "app/app.h"
#include "link/frame.h"
#include "link/messages.h"
#include "memory_port.h"
#include "random_source.h"
#include "unity.h"

#define INTERRUPTING_SEED 0x7E4A1u

static timer_t timer;
static sigset_t the_signal;
static struct random_source source;
static volatile unsigned main_turns;
static bool refusals_expected; /* they are not printed */

/* ---- the plant's end of the link: the tick's alone while the signal can come ---- */

static void hello(void);
static void page(uint8_t index);
static void next_sample(void);
static void look_at(const struct link_command *m);

static struct {
    struct frame_decoder decoder;
    uint16_t sequence;
    uint64_t clock_ms;
    unsigned ticks, commands;
} plant_line; /* all 0 at the beginning */

static void give(struct frame *f)
{
    uint8_t wire[FRAME_WIRE_MAX];
    f->sequence = plant_line.sequence++;
    (void)memory_port_give(HAL_UART_LINK, wire, frame_encode(f, wire));
}

static void answer(const struct frame *f)
{
    struct link_page_request request;
    struct link_command command;
    if (f->type == LINK_HELLO) {
        hello();
    } else if (f->type == LINK_PAGE_REQUEST && unpack_page_request(f, &request) == ERR_OK) {
        page(request.index);
    } else if (f->type == LINK_READY) {
        next_sample();
    } else if (f->type == LINK_COMMAND && unpack_command(f, &command) == ERR_OK) {
        plant_line.commands++;
        look_at(&command);
        next_sample();
    }
}

static void tick(void)
{
    uint8_t byte;
    struct frame f;
    plant_line.ticks++;
    memory_port_set_clock(++plant_line.clock_ms);
    app_tick(app_instance());
    while (memory_port_take(HAL_UART_LINK, &byte, 1))
        if (frame_decode(&plant_line.decoder, byte, &f))
            answer(&f);
}

/* ---- the timer ---- */

static void arm(uint32_t longest_ns)
{
    struct itimerspec soon = {.it_value.tv_nsec = 1 + (long)random_below(&source, longest_ns)};
    (void)timer_settime(timer, 0, &soon, NULL);
}

static void on_timer(int number)
{
    (void)number;
    tick();
    arm(random_below(&source, 8) ? 80000 : 2000); /* what an apply takes, or a few instructions */
}

/* Without the tick lock a request is taken twice, and whoever takes them goes round for hours: five looks, each after
 * 50 ms of processor time, without a turn of the main loop. */
static void on_look(int number)
{
    static const char text[] = "\ninterrupted: the main loop does not go on\n";
    static unsigned turns, looks;
    (void)number;
    looks = turns == main_turns ? looks + 1u : 0;
    turns = main_turns;
    if (looks < 5)
        return;
    (void)!write(STDERR_FILENO, text, sizeof text - 1);
    _exit(2);
}

/* The tick likes to come where it is locked out. */
static void empty_lock(void)
{
    sigset_t before;
    (void)sigprocmask(SIG_BLOCK, &the_signal, &before);
    if (random_below(&source, 2))
        arm(3000);
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
}

static inline void lock(void)
{
    (void)sigprocmask(SIG_BLOCK, &the_signal, NULL);
    empty_lock();
}

static inline void unlock(void)
{
    (void)sigprocmask(SIG_UNBLOCK, &the_signal, NULL);
}

static inline void begin_interrupting(void)
{
    struct sigaction action = {.sa_handler = on_timer, .sa_flags = SA_RESTART};
    struct sigaction look = {.sa_handler = on_look, .sa_flags = SA_RESTART};
    struct sigevent event = {.sigev_notify = SIGEV_SIGNAL, .sigev_signo = SIGALRM};
    struct itimerval every = {.it_value.tv_usec = 50000, .it_interval.tv_usec = 50000};
    (void)sigemptyset(&the_signal);
    (void)sigaddset(&the_signal, SIGALRM);
    source.state = INTERRUPTING_SEED;
    TEST_ASSERT_EQUAL(0, sigaction(SIGALRM, &action, NULL));
    TEST_ASSERT_EQUAL(0, sigaction(SIGVTALRM, &look, NULL));
    TEST_ASSERT_EQUAL(0, setitimer(ITIMER_VIRTUAL, &every, NULL));
    TEST_ASSERT_EQUAL(0, timer_create(CLOCK_MONOTONIC, &event, &timer));
    arm(40000);
}

static inline void end_interrupting(void)
{
    struct itimerval off = {.it_value = {0}};
    (void)timer_delete(timer);
    (void)signal(SIGALRM, SIG_IGN);
    (void)setitimer(ITIMER_VIRTUAL, &off, NULL);
}

/* ---- the main loop ---- */

/* Types a line; whether it was answered with ok. */
static inline bool typed(const char *text)
{
    char said[4096];
    size_t n = 0;
    (void)memory_port_give(HAL_UART_CONSOLE, text, strlen(text));
    (void)memory_port_give(HAL_UART_CONSOLE, "\n", 1);
    for (unsigned turns = 0; turns < 100000; turns++) {
        main_turns = main_turns + 1u;
        app_background(app_instance());
        n += memory_port_take(HAL_UART_CONSOLE, said + n, sizeof said - 1 - n);
        said[n] = '\0';
        if (n >= 3 && strcmp(said + n - 3, "ok\n") == 0 && (n == 3 || said[n - 4] == '\n'))
            return true;
        if (strstr(said, "err "))
            break;
        if (n > sizeof said / 2) /* events */
            n = 0;
    }
    if (!refusals_expected)
        (void)printf("%s -> %s\n", text, said);
    return false;
}

#endif
