/* Tables of columns as reflux-sim prints them (docs/methods/column-table.md). */
#ifndef REFLUX_TESTS_COMPOSITION_TABLES_H
#define REFLUX_TESTS_COMPOSITION_TABLES_H

#include <string.h>

#include "kinds/column/column.h"

/* --plant pilot: 12 stages, feed on 5, TCE and PCE. */
static const float pilot_values[] = {
    13835189.0f, 57.0f,       0.0f,        0.0f,        12.0f,       2.0f,        5.0f,
    0.9f,        1000.0f,     0.0f,        13.65f,      0.2425f,     1.545f,      0.0f,
    0.0f,        280.0f,      430.0f,      0.02f,       0.0f,        2.0f,        1.3888889e-06f,
    0.0f,        333.15f,     2.0f,        1.25e-06f,   5.0f,        0.0f,        650.0f,
    150.0f,      101324.72f,  0.0f,        0.0f,        62302.0f,    0.0f,        0.0f,
    0.0f,        21.354958f,  3177.8667f,  -36.672f,    0.0f,        0.0f,        0.0f,
    0.0f,        0.13138834f, 1991.141f,   -1.789634f,  31400.0f,    360.36f,     571.05f,
    124.4f,      0.41519314f, 62298.0f,    0.0f,        0.0f,        0.0f,        20.989145f,
    3211.7424f,  -54.787f,    0.0f,        0.0f,        0.0f,        0.0f,        0.1658334f,
    2111.059f,   -1.66525f,   34680.0f,    394.45f,     620.05f,     143.4f,      0.58480686f,
    0.19804388f, 0.32687888f, 0.42813966f, 0.5000884f,  0.54406744f, 0.69679284f, 0.81565446f,
    0.89754623f, 0.946639f,   0.9736688f,  0.98786104f, 0.9951276f};

/* --plant splitter --components C3,iC4,nC4 --truncated 2-15,20-22: 37 stages, feed on 19. */
static const float splitter_values[] = {
    12262776.0f,  14593657.0f,    0.0f,         0.0f,          37.0f,       3.0f,
    19.0f,        0.8f,           25200.0f,     2.0f,          4.0f,        0.2f,
    4.0f,         375.0f,         322.0f,       220.0f,        440.0f,      0.02f,
    0.0f,         2.0f,           0.0245f,      0.0f,          320.0f,      2.0f,
    0.017116666f, 5.0f,           0.0f,         4.81514e+06f,  0.0f,        1.7e+06f,
    3702782.0f,   0.0f,           269.0f,       0.0f,          0.0f,        0.0f,
    59.078f,      3492.6f,        0.0f,         0.0f,          -6.0669f,    1.0919e-05f,
    2.0f,         0.04409562f,    1115.724f,    -2.077646f,    13392.3f,    315.0f,
    441.0f,       133.1f,         0.281f,       21358.0f,      0.0f,        0.0f,
    0.0f,         108.43f,        5039.9f,      0.0f,          0.0f,        -15.012f,
    0.022725f,    1.0f,           0.0581222f,   1009.547f,     -1.523077f,  12475.6f,
    371.0f,       441.0f,         151.7f,       0.236f,        21363.0f,    0.0f,
    0.0f,         0.0f,           66.343f,      4363.2f,       0.0f,        0.0f,
    -7.046f,      9.4509e-06f,    2.0f,         0.0581222f,    991.197f,    -1.392965f,
    15329.8f,     371.0f,         441.0f,       149.2f,        0.483f,      6.1507344e-05f,
    0.32445896f,  0.00013015128f, 0.36552674f,  0.0002263608f, 0.38895816f, 0.0003799029f,
    0.40683672f,  0.0006242603f,  0.4203504f,   0.001012326f,  0.430452f,   0.0016274683f,
    0.43787754f,  0.0026006484f,  0.44316673f,  0.00413652f,   0.44667912f, 0.0065522734f,
    0.4486f,      0.010333127f,   0.4489334f,   0.016205983f,  0.4474805f,  0.0252237f,
    0.4438079f,   0.03882937f,    0.43722364f,  0.058824647f,  0.42680392f, 0.08710524f,
    0.41154635f,  0.12501146f,    0.39073414f,  0.17231423f,   0.3644877f,  0.22628665f,
    0.3342092f,   0.21891516f,    0.39022455f,  0.22495744f,   0.42782506f, 0.23207705f,
    0.46335587f,  0.24104726f,    0.4953612f,   0.2531556f,    0.5220397f,  0.27042836f,
    0.5410508f,   0.29581937f,    0.549301f,    0.3331496f,    0.54291326f, 0.38638526f,
    0.5177986f,   0.45782214f,    0.47131705f,  0.5454914f,    0.40484685f, 0.6417251f,
    0.32546183f,  0.7352629f,     0.24424173f,  0.8161696f,    0.17157297f, 0.87948585f,
    0.11328207f,  0.9251026f,     0.070221424f, 0.9548349f,    0.04019329f, 0.967f,
    0.019999538f};

/* A record of these values, with the checksum that belongs to it. */
static inline void put_record(struct column_record *record, const float *values, size_t size)
{
    memset(record, 0, sizeof *record);
    record->version = COLUMN_TABLE_VERSION;
    record->size = (uint16_t)size;
    memcpy(record->value, values, size * sizeof *values);
    uint32_t sum = column_table_checksum(record->version, record->size, record->value);
    record->checksum[0] = (uint16_t)(sum >> 16);
    record->checksum[1] = (uint16_t)sum;
}

#define PUT_RECORD(record, values) put_record(record, values, sizeof(values) / sizeof(values)[0])

/* The record of the pilot column with each component twice, under two names. */
static inline void put_components_twice(struct column_record *record)
{
    enum { BEHIND = COLUMN_TABLE_FIXED + 4 * COLUMN_TABLE_C_VALUES };
    float v[COLUMN_TABLE_VALUES(12, 4, 0)];
    const float *one = pilot_values + COLUMN_TABLE_FIXED, *x = one + 2 * COLUMN_TABLE_C_VALUES;
    memcpy(v, pilot_values, COLUMN_TABLE_FIXED * sizeof *v);
    v[COLUMN_TABLE_N_COMPONENTS] = 4;
    for (unsigned j = 0; j < 4; j++) {
        float *to = v + COLUMN_TABLE_FIXED + j * COLUMN_TABLE_C_VALUES;
        memcpy(to, one + j / 2 * COLUMN_TABLE_C_VALUES, COLUMN_TABLE_C_VALUES * sizeof *v);
        to[COLUMN_TABLE_C_NAME] += (float)(j % 2);
        to[COLUMN_TABLE_C_FEED] /= 2;
    }
    for (unsigned k = 0; k < 36; k++)
        v[BEHIND + k] = (k % 3 < 2 ? x[k / 3] : 1 - x[k / 3]) / 2;
    PUT_RECORD(record, v);
}

/* The record with one of its values changed, and in order again. */
static inline void change_record(struct column_record *record, unsigned place, float value)
{
    float values[COLUMN_TABLE_MOST];
    memcpy(values, record->value, sizeof values);
    values[place] = value;
    put_record(record, values, record->size);
}

#endif
