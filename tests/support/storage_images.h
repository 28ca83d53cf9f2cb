/* Flash images as earlier firmware, or newer, left them behind (tests/reference/storage_images.py). */
#ifndef REFLUX_TESTS_STORAGE_IMAGES_H
#define REFLUX_TESTS_STORAGE_IMAGES_H

#include "storage_bench.h"

static inline void load_image(const char *name)
{
    char path[512];
    snprintf(path, sizeof path, STORAGE_IMAGES "/%s.bin", name);
    FILE *file = fopen(path, "rb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    flash_model_erase_all();
    TEST_ASSERT_TRUE(fread(flash_model, 1, sizeof flash_model, file) > 0);
    fclose(file);
}

/* Sets the plant that the images describe. */
static inline void plant_of_images(struct config *c)
{
    bench_small(c, "1.5");
    bench_set(c, "meas1.unit", "degC");
    bench_set(c, "meas1.lo", "60");
    bench_set(c, "meas1.hi", "160");
    bench_set(c, "mv1.unit", "kW");
    bench_set(c, "mv1.hi", "2");
    bench_set(c, "mv1.max", "2");
    bench_set(c, "mv1.safe", "0.5");
    bench_set(c, "loop1.ti", "300");
    bench_set(c, "loop1.divisor", "2");
}

#endif
