#include "plants/plant_library.h"

#include <dirent.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench/text.h"
#include "columns/column_plant.h"
#include "linear/linear_plant.h"
#include "plants/plant_json.h"

#define FOLDER_VARIABLE "REFLUX_PLANTS"
#define FILE_MAX        1000000
#define PATH_LENGTH     4096

/* Classes read from files, in order of reading. */
struct opened {
    struct plant_class *class;
    struct opened *next;
};
static struct opened *opened;

static const struct plant_class *keep(struct plant_class *class, char *err, size_t err_size)
{
    struct opened *entry = class != NULL ? malloc(sizeof(*entry)) : NULL;
    if (entry == NULL) {
        if (class != NULL) {
            (void)sim_fail(err, err_size, "out of memory");
        }
        plant_json_free(class);
        return NULL;
    }
    *entry = (struct opened){class, opened};
    opened = entry;
    return class;
}

void plant_library_free(void)
{
    while (opened != NULL) {
        struct opened *next = opened->next;
        plant_json_free(opened->class);
        free(opened);
        opened = next;
    }
}

static char *read_file(const char *path, size_t *length, char *err, size_t err_size)
{
    FILE *file = sim_open_text(path, err, err_size);
    if (file == NULL) {
        return NULL;
    }
    char *text = malloc(FILE_MAX + 1);
    *length = text != NULL ? fread(text, 1, FILE_MAX + 1, file) : 0;
    bool whole = text != NULL && ferror(file) == 0 && *length <= FILE_MAX;
    if (text == NULL || ferror(file) != 0) {
        (void)sim_fail(err, err_size, "%s: %s", path, strerror(errno));
    } else if (!whole) {
        (void)sim_fail(err, err_size, "%s: a plant file may have %d bytes at most", path, FILE_MAX);
    }
    (void)fclose(file);
    if (!whole) {
        free(text);
        text = NULL;
    }
    return text;
}

static const struct plant_class *open_path(const char *path, char *err, size_t err_size)
{
    size_t length;
    char *text = read_file(path, &length, err, err_size);
    if (text == NULL) {
        return NULL;
    }
    struct plant_class *class = plant_json_read(path, text, length, err, err_size);
    free(text);
    return keep(class, err, err_size);
}

static const struct plant_class *open_text(const struct plant_text *t, char *err, size_t err_size)
{
    char file[64];
    (void)snprintf(file, sizeof(file), "%s.json", t->name);
    return keep(plant_json_read(file, (const char *)t->text, t->length, err, err_size), err,
                err_size);
}

static bool is_plant_file(const struct dirent *entry)
{
    size_t n = strlen(entry->d_name);
    return n > 5 && entry->d_name[0] != '.' && strcmp(entry->d_name + n - 5, ".json") == 0;
}

static int plant_file_filter(const struct dirent *entry)
{
    return is_plant_file(entry) ? 1 : 0;
}

/* By bytes, whatever the language of the user. */
static int by_name(const struct dirent **a, const struct dirent **b)
{
    return strcmp((*a)->d_name, (*b)->d_name);
}

/* Files of the user's folder, sorted; returns how many. */
static int user_files(struct dirent ***list)
{
    const char *folder = getenv(FOLDER_VARIABLE);
    *list = NULL;
    return folder != NULL ? scandir(folder, list, plant_file_filter, by_name) : 0;
}

static void user_path(char *path, const char *file_name)
{
    (void)snprintf(path, PATH_LENGTH, "%s/%s", getenv(FOLDER_VARIABLE), file_name);
}

static void list_names(char *err, size_t err_size)
{
    const char *between = "";
    for (size_t k = 0; plant_classes[k] != NULL; k++) {
        sim_append(err, err_size, "%s%s", between, plant_classes[k]->name);
        between = ", ";
    }
    for (const struct plant_text *t = plant_texts; t->name != NULL; t++) {
        sim_append(err, err_size, "%s%s", between, t->name);
        between = ", ";
    }
    struct dirent **list;
    int n = user_files(&list);
    for (int i = 0; i < n; i++) {
        sim_append(err, err_size, "%s%.*s", between, (int)strlen(list[i]->d_name) - 5,
                   list[i]->d_name);
        between = ", ";
        free(list[i]);
    }
    free(list);
}

const struct plant_class *plant_open(const char *name, char *err, size_t err_size)
{
    size_t n = strlen(name);
    if (strchr(name, '/') != NULL || (n > 5 && strcmp(name + n - 5, ".json") == 0)) {
        return open_path(name, err, err_size);
    }
    for (size_t k = 0; plant_classes[k] != NULL; k++) {
        if (strcmp(plant_classes[k]->name, name) == 0) {
            return plant_classes[k];
        }
    }
    for (const struct plant_text *t = plant_texts; t->name != NULL; t++) {
        if (strcmp(t->name, name) == 0) {
            return open_text(t, err, err_size);
        }
    }
    struct dirent **list;
    int files = user_files(&list);
    char path[PATH_LENGTH] = "";
    for (int i = 0; i < files; i++) {
        if (strlen(list[i]->d_name) == n + 5 && strncmp(list[i]->d_name, name, n) == 0) {
            user_path(path, list[i]->d_name);
        }
        free(list[i]);
    }
    free(list);
    if (path[0] != '\0') {
        return open_path(path, err, err_size);
    }
    (void)sim_fail(err, err_size, "%s: no such plant, and no path of a .json file; there is ",
                   name);
    list_names(err, err_size);
    return NULL;
}

void plant_library_each(void (*visit)(const struct plant_class *class, const char *error))
{
    char err[SIM_ERROR_SIZE] = "";
    for (size_t k = 0; plant_classes[k] != NULL; k++) {
        visit(plant_classes[k], err);
    }
    for (const struct plant_text *t = plant_texts; t->name != NULL; t++) {
        visit(open_text(t, err, sizeof(err)), err);
    }
    struct dirent **list;
    int n = user_files(&list);
    for (int i = 0; i < n; i++) {
        char path[PATH_LENGTH];
        user_path(path, list[i]->d_name);
        visit(open_path(path, err, sizeof(err)), err);
        free(list[i]);
    }
    free(list);
}

struct plant *plant_create(const struct plant_class *class, char *err, size_t err_size)
{
    return class->model != NULL    ? linear_create(class->model, err, err_size)
           : class->column != NULL ? column_plant_create(class->column, err, err_size)
                                   : class->create(err, err_size);
}
