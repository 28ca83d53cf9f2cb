/* usage: board-io IMAGE CASE [exact], or IMAGE CAMPAIGN COUNT SEED. Prints what it saw; status 1 with the reason when that is not what it should be.
 *
 * SPDX-License-Identifier: Apache-2.0 OR GPL-2.0-only
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "board_io.h"

static const struct {
    const char *name;
    void (*run)(const char *image);
} cases[] = {{"pins", case_pins},     {"outputs", case_outputs}, {"pwm", case_pwm},
             {"pulses", case_pulses}, {"analog", case_analog},   {"spi", case_spi},
             {"wire", case_wire},     {"i2c", case_i2c},         {"together", case_together}};

static const struct {
    const char *name;
    void (*run)(const char *image, uint32_t count, uint64_t seed);
} campaigns[] = {{"spi-campaign", case_spi_campaign},
                 {"wire-campaign", case_wire_campaign},
                 {"i2c-campaign", case_i2c_campaign}};

int main(int argc, char **argv)
{
    bench_exact = argc == 4 && strcmp(argv[3], "exact") == 0;
    if (argc != 3 && argc != 5 && !bench_exact) {
        (void)fputs("usage: board-io IMAGE CASE [exact], or IMAGE CAMPAIGN COUNT SEED\n", stderr);
        return 2;
    }
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        if (argc < 5 && strcmp(cases[i].name, argv[2]) == 0) {
            cases[i].run(argv[1]);
            return 0;
        }
    }
    for (size_t i = 0; i < sizeof(campaigns) / sizeof(campaigns[0]); i++) {
        if (argc == 5 && strcmp(campaigns[i].name, argv[2]) == 0) {
            campaigns[i].run(argv[1], (uint32_t)strtoul(argv[3], NULL, 10),
                             strtoull(argv[4], NULL, 10));
            return 0;
        }
    }
    (void)fprintf(stderr, "board-io: no case %s\n", argv[2]);
    return 2;
}
