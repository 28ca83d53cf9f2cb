/* Runs a fuzz target without a fuzzer: every file of a corpus, then inputs made from them by chance.
 *
 *     replay_NAME [--runs N] [--seed S] [--only K] FOLDER|FILE...
 *
 * Same seed, same inputs on every machine; the number of an input that failed goes with --only.
 */
#include <dirent.h>
#include <string.h>
#include <sys/stat.h>

#include "fuzz.h"
#include "random_source.h"

#define INPUT_MAX 4096
#define FILES_MAX 2000

struct input {
    uint8_t *bytes;
    size_t n;
};

static struct input corpus[FILES_MAX];
static unsigned n_corpus;
static unsigned long seed = 1, runs, under_way;
static const char *what = "";

void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

static void last_words(void)
{
    (void)fprintf(stderr, "replay: it was %s %lu (seed %lu)\n", what, under_way, seed);
}

static int by_name(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

static void read_file(const char *path)
{
    FILE *in = fopen(path, "rb");
    if (in == NULL || n_corpus == FILES_MAX) {
        (void)fprintf(stderr, "replay: %s cannot be read, or is one file too many\n", path);
        exit(2);
    }
    struct input *i = &corpus[n_corpus++];
    i->bytes = malloc(INPUT_MAX);
    DEMAND(i->bytes != NULL);
    i->n = fread(i->bytes, 1, INPUT_MAX, in);
    (void)fclose(in);
}

static void read_folder(const char *path)
{
    static char *names[FILES_MAX];
    unsigned n = 0;
    DIR *folder = opendir(path);
    if (folder == NULL) {
        (void)fprintf(stderr, "replay: there is no folder %s\n", path);
        exit(2);
    }
    for (struct dirent *e; (e = readdir(folder)) != NULL && n < FILES_MAX;)
        if (e->d_name[0] != '.')
            names[n++] = strdup(e->d_name);
    (void)closedir(folder);
    qsort(names, n, sizeof names[0], by_name);
    for (unsigned i = 0; i < n; i++) {
        char file[1024];
        (void)snprintf(file, sizeof file, "%s/%s", path, names[i]);
        read_file(file);
        free(names[i]);
    }
}

/* One change; the result has at most INPUT_MAX bytes. */
static size_t change(struct random_source *r, uint8_t *bytes, size_t n)
{
    size_t at = n ? random_below(r, (uint32_t)n) : 0;
    const struct input *other = n_corpus ? &corpus[random_below(r, n_corpus)] : NULL;
    size_t length = 1 + random_below(r, 16);
    switch (random_below(r, 6)) {
    case 0:
        if (n)
            bytes[at] ^= (uint8_t)(1u << random_below(r, 8));
        return n;
    case 1:
        if (n)
            bytes[at] = (uint8_t)random_next(r);
        return n;
    case 2: /* put in */
        if (n + length > INPUT_MAX)
            return n;
        memmove(bytes + at + length, bytes + at, n - at);
        for (size_t i = 0; i < length; i++)
            bytes[at + i] = (uint8_t)random_next(r);
        return n + length;
    case 3: /* left out */
        length = length < n - at ? length : n - at;
        memmove(bytes + at, bytes + at + length, n - at - length);
        return n - length;
    case 4: /* the end of another */
        if (other == NULL || other->n == 0)
            return n;
        length = random_below(r, (uint32_t)other->n);
        length = length < INPUT_MAX - at ? length : INPUT_MAX - at;
        memcpy(bytes + at, other->bytes + (other->n - length), length);
        return at + length;
    default: /* a piece of another put in */
        if (other == NULL || other->n == 0)
            return n;
        size_t from = random_below(r, (uint32_t)other->n);
        length = other->n - from < 64 ? other->n - from : 64;
        if (n + length > INPUT_MAX)
            return n;
        memmove(bytes + at + length, bytes + at, n - at);
        memcpy(bytes + at, other->bytes + from, length);
        return n + length;
    }
}

static void try_one(const uint8_t *bytes, size_t n)
{
    /* A block of its very size: the sanitizer sees a byte read past the end. */
    uint8_t *copy = malloc(n ? n : 1);
    DEMAND(copy != NULL);
    if (n)
        memcpy(copy, bytes, n);
    (void)LLVMFuzzerTestOneInput(copy, n);
    free(copy);
}

int main(int argc, char **argv)
{
    static uint8_t bytes[INPUT_MAX];
    unsigned long only = 0;
    for (int i = 1; i < argc; i++) {
        struct stat info;
        unsigned long *number = strcmp(argv[i], "--runs") == 0   ? &runs
                                : strcmp(argv[i], "--seed") == 0 ? &seed
                                : strcmp(argv[i], "--only") == 0 ? &only
                                                                 : NULL;
        if (number != NULL && i + 1 < argc)
            *number = strtoul(argv[++i], NULL, 10);
        else if (stat(argv[i], &info) == 0 && S_ISDIR(info.st_mode))
            read_folder(argv[i]);
        else
            read_file(argv[i]);
    }
    if (__sanitizer_set_death_callback)
        __sanitizer_set_death_callback(last_words);
    what = "file";
    for (under_way = 1; !only && under_way <= n_corpus; under_way++)
        try_one(corpus[under_way - 1].bytes, corpus[under_way - 1].n);
    what = "input";
    for (under_way = only ? only : 1; under_way <= (only ? only : runs); under_way++) {
        struct random_source r = {seed * 0x10001u + under_way};
        size_t n = 0;
        if (n_corpus) {
            const struct input *from = &corpus[random_below(&r, n_corpus)];
            n = from->n;
            memcpy(bytes, from->bytes, n);
        }
        for (unsigned changes = 1 + random_below(&r, 6); changes; changes--)
            n = change(&r, bytes, n);
        try_one(bytes, n);
    }
    printf("replay: files %u, inputs %lu, seed %lu, failures 0\n", n_corpus, only ? 1 : runs, seed);
    for (unsigned i = 0; i < n_corpus; i++)
        free(corpus[i].bytes);
    return 0;
}
