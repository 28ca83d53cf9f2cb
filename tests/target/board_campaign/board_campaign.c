/* board-campaign: the supply of a virtual board that runs the flashed file is cut very often, and its stored set is looked for.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "campaigns.h"

static const char usage[] =
    "usage: board-campaign first|further|instants IMAGE [options]\n"
    "\n"
    "Cuts the supply of a virtual board that runs the flashed file, and looks for the set that it "
    "has stored.\n"
    "Words in capitals in the results are finds; the exit status is 1 if there is one.\n"
    "\n"
    "  first             once in each word of a save, and at 20 points within each erase of a "
    "save\n"
    "  further           in a save, and twice more in the starts and saves that follow\n"
    "  instants          or its reset: at random instants of five states, with the pilot column "
    "at its link\n"
    "\n"
    "  --from N          number of the first run of further or instants (default 0)\n"
    "  --count N         how many of these (default 1000)\n"
    "  --stride N        of first: every N-th place only (default 1)\n"
    "  --whole N         every N-th run reads back all settings, the others those that differ "
    "(default 8)\n"
    "  --append          no saves that erase\n"
    "  --results FILE    keep results there, and leave out runs that it has\n"
    "  --jobs N          runs at a time (default: processors of this machine)\n"
    "  --seed N          (default 1)\n"
    "  --root FOLDER     of the repository, for its settings (default: the present one)\n"
    "  --help\n";

uint64_t campaign_random(const struct campaign *c, unsigned run)
{
    return random_state(random_state(c->seed) + run);
}

uint32_t below(uint64_t *random, uint32_t limit)
{
    return random_word(random) % limit;
}

static bool number(const char *text, unsigned least, unsigned *x)
{
    char *end;
    unsigned long n = strtoul(text, &end, 10);
    *x = (unsigned)n;
    if (end != text && *end == '\0' && n >= least && n <= 1000000000u)
        return true;
    (void)fprintf(stderr, "board-campaign: %s is no whole number from %u on\n", text, least);
    return false;
}

static bool read_image(struct image *image, const char *path)
{
    FILE *f = fopen(path, "rb");
    const char *name = strrchr(path, '/') != NULL ? strrchr(path, '/') : path;
    image->chip = chip_named_in(name);
    image->bytes = f == NULL ? 0 : fread(image->data, 1, sizeof(image->data), f);
    if (f != NULL)
        (void)fclose(f);
    if (image->bytes < 4 || image->chip == NULL) {
        (void)fprintf(stderr, "board-campaign: %s is no image of a known chip\n", path);
        return false;
    }
    (void)memcpy(&image->crc, image->data + image->bytes - 4u, 4);
    return true;
}

int main(int argc, char **argv)
{
    static const struct option known[] = {{"from", 1, NULL, 'f'},
                                          {"count", 1, NULL, 'c'},
                                          {"stride", 1, NULL, 's'},
                                          {"whole", 1, NULL, 'w'},
                                          {"append", 0, NULL, 'a'},
                                          {"results", 1, NULL, 'r'},
                                          {"jobs", 1, NULL, 'j'},
                                          {"seed", 1, NULL, 'e'},
                                          {"root", 1, NULL, 'o'},
                                          {"help", 0, NULL, 'h'},
                                          {0}};
    static const struct {
        const char *name;
        bool (*run)(const struct campaign *c);
    } campaigns[] = {
        {"first", first_cuts}, {"further", further_cuts}, {"instants", random_instants}};
    static struct image image;
    static struct runs runs;
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    unsigned jobs = processors > 0 ? (unsigned)processors : 1u, seed = 1;
    struct campaign c = {
        .image = &image, .root = ".", .runs = &runs, .count = 1000, .stride = 1, .whole = 8};
    const char *results = NULL;
    int option;
    bool ok = true;
    while (ok && (option = getopt_long(argc, argv, "", known, NULL)) != -1) {
        switch (option) {
        case 'f':
            ok = number(optarg, 0, &c.from);
            break;
        case 'c':
            ok = number(optarg, 1, &c.count);
            break;
        case 's':
            ok = number(optarg, 1, &c.stride);
            break;
        case 'w':
            ok = number(optarg, 1, &c.whole);
            break;
        case 'a':
            c.append_only = true;
            break;
        case 'r':
            results = optarg;
            break;
        case 'j':
            ok = number(optarg, 1, &jobs);
            break;
        case 'e':
            ok = number(optarg, 0, &seed);
            break;
        case 'o':
            c.root = optarg;
            break;
        case 'h':
            (void)fputs(usage, stdout);
            return 0;
        default:
            ok = false;
        }
    }
    size_t which = 0, all = sizeof(campaigns) / sizeof(campaigns[0]);
    while (optind < argc && which < all && strcmp(campaigns[which].name, argv[optind]) != 0)
        which++;
    if (!ok || argc - optind != 2 || which == all) {
        (void)fprintf(stderr, "board-campaign: wants first, further or instants, and an image; "
                              "--help lists the options\n");
        return 2;
    }
    if (!read_image(&image, argv[optind + 1]))
        return 2;
    c.seed = seed;
    char about[160];
    (void)snprintf(about, sizeof(about), "%s, %s image with checksum %08x, seed %u%s",
                   campaigns[which].name, image.chip->name, image.crc, seed,
                   c.append_only ? ", append" : "");
    if (!runs_begin(&runs, results, about, jobs))
        return 2;
    bool ran = campaigns[which].run(&c);
    bool good = runs_end(&runs);
    return !ran ? 2 : good ? 0 : 1;
}
