/* reflux-board: a board that runs the flashed file.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "chips/wired.h"
#include "control.h"
#include "models/models.h"
#include "replay.h"

static const char usage[] =
    "usage: reflux-board [options] --image FILE (--control PATH | --console PATH --link PATH)\n"
    "\n"
    "Runs the file that is flashed to a board, with its chip at register level. What a chip would "
    "not take ends it\n"
    "with the reason, the address and the program counter, and with status 3.\n"
    "\n"
    "  --image FILE      build/stm32f405/reflux-stm32f405.bin, say\n"
    "  --chip NAME       stm32f405 or stm32f100 (default: from the name of the image)\n"
    "  --control PATH    unix socket over which reflux-sim drives it (--port board:PATH); time "
    "goes on as it says\n"
    "  --console PATH    unix socket of USART1, in step with the clock on the wall\n"
    "  --link PATH       unix socket of USART2, likewise\n"
    "  --nvm FILE        keep the flash for settings in FILE (default: it is erased at the start)\n"
    "  --wiring FILE     chips and loads at the pins, as this file says; with --control\n"
    "  --crystal HZ      crystal of the board, Hz; 0: none (default 8000000)\n"
    "  --slow-clock HZ   clock of the watchdog, Hz (default: the chip's nominal one)\n"
    "  --oscillator PPM  error of the internal oscillator, millionths (default 0)\n"
    "  --supply MV       supply, mV (default 3300)\n"
    "  --brown-out MV    level of the brown-out reset, mV; 0: off (default 2830)\n"
    "  --hardware-watchdog  option byte: the watchdog runs from a reset on\n"
    "  --write-protect BITS option bytes: sectors of the flash, a sum of 1 << sector (default 0)\n"
    "  --seed N          of what memory holds at power-on (default 1)\n"
    "  --cut-word N      the supply goes within the N-th word written to the flash, and comes "
    "back\n"
    "  --exact           instruction by instruction: faults and verdicts are the same, and come "
    "sooner\n"
    "  --statistics      at the end: time, instructions, resets and flash words, to stderr\n"
    "  --diary FILE      faults and resets as they come, with the board's time\n"
    "  --memory FILE     at the end: what all RAM and then the flash for settings hold\n"
    "  --help\n";

static volatile int stop;

static void on_signal(int number)
{
    (void)number;
    stop = 1;
}

static int refuse(const char *what, const char *value)
{
    (void)fprintf(stderr, "reflux-board: %s %s; --help lists the options\n", what, value);
    return 2;
}

static bool whole_number(const char *text, long long least, long long most, long long *x)
{
    char *end;
    errno = 0;
    *x = strtoll(text, &end, 10);
    return end != text && *end == '\0' && errno == 0 && *x >= least && *x <= most;
}

static size_t read_file(const char *path, uint8_t *bytes, size_t size)
{
    FILE *f = fopen(path, "rb");
    size_t n = f == NULL ? 0 : fread(bytes, 1, size, f);
    if (f != NULL)
        (void)fclose(f);
    return n;
}

static bool write_file(const char *path, const uint8_t *bytes, size_t size)
{
    FILE *f = fopen(path, "wb");
    return f != NULL && fwrite(bytes, 1, size, f) == size && fclose(f) == 0;
}

static bool write_memory(const char *path, struct board *b)
{
    FILE *f = fopen(path, "wb");
    bool whole = f != NULL;
    for (size_t i = 0; whole && i < b->chip->n_memory; i++) {
        const struct chip_memory *m = &b->chip->memory[i];
        if (m->kind != MEMORY_FLASH)
            whole = fwrite(processor_memory(b, m->base, m->size), 1, m->size, f) == m->size;
    }
    uint32_t stored = b->chip->stored_size;
    whole = whole && fwrite(stored_flash(b)->bytes, 1, stored, f) == stored;
    return f != NULL && fclose(f) == 0 && whole;
}

static void print_statistics(struct board *b)
{
    struct timespec used;
    (void)clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    double seconds = (double)used.tv_sec + 1e-9 * (double)used.tv_nsec;
    (void)fprintf(stderr,
                  "reflux-board: %.3f s of the board, %llu instructions, %.2f s of processor time "
                  "(%.1f M/s); resets:",
                  (double)board_ns(b) / 1e9, (unsigned long long)b->instructions, seconds,
                  (double)b->instructions / seconds / 1e6);
    for (unsigned i = 0; i <= RESET_WATCHDOG; i++)
        (void)fprintf(stderr, " %s %u", board_reset_name((enum board_reset)i), b->resets[i]);
    (void)fprintf(stderr, "; flash words %llu, erases %llu\n",
                  (unsigned long long)stored_flash(b)->words,
                  (unsigned long long)stored_flash(b)->erase_count);
}

int main(int argc, char **argv)
{
    static const struct option known[] = {
        {"image", 1, NULL, 'i'},         {"chip", 1, NULL, 'c'},
        {"control", 1, NULL, 'C'},       {"console", 1, NULL, 'o'},
        {"link", 1, NULL, 'l'},          {"nvm", 1, NULL, 'n'},
        {"crystal", 1, NULL, 'x'},       {"slow-clock", 1, NULL, 's'},
        {"oscillator", 1, NULL, 'p'},    {"supply", 1, NULL, 'v'},
        {"brown-out", 1, NULL, 'b'},     {"seed", 1, NULL, 'r'},
        {"cut-word", 1, NULL, 'w'},      {"hardware-watchdog", 0, NULL, 'd'},
        {"write-protect", 1, NULL, 'q'}, {"exact", 0, NULL, 'e'},
        {"statistics", 0, NULL, 't'},    {"diary", 1, NULL, 'y'},
        {"memory", 1, NULL, 'm'},        {"wiring", 1, NULL, 'g'},
        {"help", 0, NULL, 'h'},          {0}};
    static uint8_t image[1u << 20];
    struct surroundings around = {
        .crystal_hz = 8000000, .supply_mv = 3300, .brown_out_mv = 2830, .baud = 115200, .seed = 1};
    const char *file = NULL, *name = NULL, *control = NULL, *console = NULL, *link = NULL,
               *nvm = NULL, *diary = NULL, *memory = NULL, *wiring = NULL;
    bool exact = false, statistics = false;
    long long n = 0;
    uint64_t cut_word = 0;
    int option;
    while ((option = getopt_long(argc, argv, "", known, NULL)) != -1) {
        bool ok = true;
        switch (option) {
        case 'i':
            file = optarg;
            break;
        case 'c':
            name = optarg;
            break;
        case 'C':
            control = optarg;
            break;
        case 'o':
            console = optarg;
            break;
        case 'l':
            link = optarg;
            break;
        case 'n':
            nvm = optarg;
            break;
        case 'x':
            ok = whole_number(optarg, 0, 50000000, &n);
            around.crystal_hz = (uint32_t)n;
            break;
        case 's':
            ok = whole_number(optarg, 1, 1000000, &n);
            around.slow_clock_hz = (uint32_t)n;
            break;
        case 'p':
            ok = whole_number(optarg, -100000, 100000, &n);
            around.oscillator_ppm = (int32_t)n;
            break;
        case 'v':
            ok = whole_number(optarg, 0, 5000, &n);
            around.supply_mv = (uint32_t)n;
            break;
        case 'b':
            ok = whole_number(optarg, 0, 3300, &n);
            around.brown_out_mv = (uint32_t)n;
            break;
        case 'r':
            ok = whole_number(optarg, 0, INT64_MAX, &n);
            around.seed = (uint64_t)n;
            break;
        case 'w':
            ok = whole_number(optarg, 1, INT64_MAX, &n);
            cut_word = (uint64_t)n;
            break;
        case 'd':
            around.hardware_watchdog = true;
            break;
        case 'q':
            ok = whole_number(optarg, 0, 0xFFF, &n);
            around.write_protect = (uint16_t)n;
            break;
        case 'e':
            exact = true;
            break;
        case 't':
            statistics = true;
            break;
        case 'y':
            diary = optarg;
            break;
        case 'm':
            memory = optarg;
            break;
        case 'g':
            wiring = optarg;
            break;
        case 'h':
            (void)fputs(usage, stdout);
            return 0;
        default:
            return 2;
        }
        if (!ok)
            return refuse("a number that is not allowed there:", optarg);
    }
    if (file == NULL || (control == NULL) == (console == NULL) ||
        (console == NULL) != (link == NULL) || optind < argc)
        return refuse("wants --image and --control, or --image, --console and --link",
                      optind < argc ? argv[optind] : "");
    const char *from = name != NULL ? name : strrchr(file, '/') != NULL ? strrchr(file, '/') : file;
    const struct chip *chip = chip_named_in(from);
    if (chip == NULL)
        return refuse("no chip of that name:", from);
    if (around.slow_clock_hz == 0)
        around.slow_clock_hz = chip->slow_clock_hz;
    if (around.slow_clock_hz < chip->slow_clock_least ||
        around.slow_clock_hz > chip->slow_clock_most) {
        (void)fprintf(stderr, "reflux-board: --slow-clock %u; from %u to %u Hz on the %s\n",
                      around.slow_clock_hz, chip->slow_clock_least, chip->slow_clock_most,
                      chip->name);
        return 2;
    }
    size_t size = read_file(file, image, sizeof(image));
    if (size == 0)
        return refuse("cannot read the image", file);

    char err[512] = "";
    if (console != NULL) { /* by control it ends with the socket, or at once */
        (void)signal(SIGTERM, on_signal);
        (void)signal(SIGINT, on_signal);
    }
    struct board *b = board_new(chip, &around, image, size, exact, err, sizeof(err));
    int status = 1;
    if (b != NULL) {
        if (nvm != NULL)
            (void)read_file(nvm, stored_flash(b)->bytes, chip->stored_size);
        stored_flash(b)->cut_word = cut_word;
        if (diary != NULL && (b->diary = fopen(diary, "w")) == NULL) {
            board_free(b);
            return refuse("cannot write", diary);
        }
        struct wired *wired = NULL;
        if (wiring != NULL) {
            wired = wired_open(wiring, around.seed, err, sizeof(err));
            if (wired == NULL) {
                (void)fprintf(stderr, "reflux-board: %s\n", err);
                board_free(b);
                return 2;
            }
            board_set_world(b, wired_world(wired));
        }
        replay_begin(b);
        board_power_on(b);
        status = control != NULL ? control_serve(b, wired, control, err, sizeof(err))
                                 : lines_serve(b, console, link, &stop, err, sizeof(err));
        if (nvm != NULL && !write_file(nvm, stored_flash(b)->bytes, chip->stored_size))
            status = refuse("cannot write", nvm);
        if (memory != NULL && !write_memory(memory, b))
            status = refuse("cannot write", memory);
        if (statistics)
            print_statistics(b);
        if (b->diary != NULL && fclose(b->diary) != 0)
            status = refuse("cannot write", diary);
        board_free(b);
        wired_close(wired);
    }
    if (err[0] != '\0')
        (void)fprintf(stderr, "reflux-board: %s\n", err);
    return status;
}
