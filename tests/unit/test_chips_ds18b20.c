/* The model of a DS18B20 against its data sheet: table 1, the commands, the CRC, and several on one wire. */
#include <stdlib.h>

#include "chip_bench.h"

#define SENSORS_MAX 12u
#define SLOT_US     70.0

static struct chip *sensors[SENSORS_MAX];
static size_t n_sensors;

void setUp(void)
{
    bench_make("ds18b20", "rom=28-000005e2fdc3", BENCH_SEED);
    n_sensors = 0;
}

void tearDown(void)
{
    for (size_t i = 0; i < n_sensors; i++) {
        chip_free(sensors[i]);
    }
    bench_free();
}

static bool slot(bool out)
{
    bench_ns += (uint64_t)(SLOT_US * 1e3);
    return chips_slot(bench_bus, bench_ns, out);
}

static enum chips_answer reset(void)
{
    bench_ns += 960000;
    return chips_reset(bench_bus, bench_ns);
}

static void put(uint8_t byte)
{
    for (unsigned i = 0; i < 8; i++) {
        (void)slot(((unsigned)byte >> i) & 1u);
    }
}

static void get(uint8_t *bytes, size_t n)
{
    memset(bytes, 0, n);
    for (size_t i = 0; i < 8 * n; i++) {
        bytes[i / 8] |= (uint8_t)(slot(true) << (i % 8));
    }
}

/* CRC of the data sheet, bit by bit through its shift register; 0 over bytes and their CRC. */
static uint8_t crc(const uint8_t *bytes, size_t n)
{
    unsigned shift = 0;
    for (size_t i = 0; i < 8 * n; i++) {
        unsigned feedback = (shift & 1u) ^ (((unsigned)bytes[i / 8] >> (i % 8)) & 1u);
        shift >>= 1;
        shift ^= feedback ? 0x8Cu : 0u;
    }
    return (uint8_t)shift;
}

static void read_pad(uint8_t pad[9])
{
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, reset());
    put(0xCC);
    put(0xBE);
    get(pad, 9);
}

static void convert(double wait_ms)
{
    TEST_ASSERT_EQUAL_INT(CHIPS_ANSWER, reset());
    put(0xCC);
    put(0x44);
    bench_wait_ms(wait_ms);
}

static unsigned code_of(const uint8_t pad[9])
{
    return (unsigned)(pad[1] << 8 | pad[0]);
}

static void power_on_reads_85_degrees_and_says_so_in_byte_6(void)
{
    static const uint8_t first[8] = {0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10};
    uint8_t pad[9];
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(first, pad, 8);
    TEST_ASSERT_EQUAL_HEX8(0x1C, pad[8]); /* as many a log of such sensors has it */
    TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
    bench_expect_right();
}

static void temperatures_are_those_of_table_1(void)
{
    static const struct {
        double degc;
        uint16_t code;
    } rows[] = {{125, 0x07D0},      {85, 0x0550},  {25.0625, 0x0191}, {10.125, 0x00A2},
                {0.5, 0x0008},      {0, 0x0000},   {-0.5, 0xFFF8},    {-10.125, 0xFF5E},
                {-25.0625, 0xFE6F}, {-55, 0xFC90}, {200, 0x07D0},     {-100, 0xFC90}};
    uint8_t pad[9];
    for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
        bench_set("temperature", rows[i].degc);
        convert(750);
        read_pad(pad);
        TEST_ASSERT_EQUAL_HEX16(rows[i].code, code_of(pad));
        TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
    }
    bench_expect_right();
}

static void measured_85_degrees_differ_from_those_of_power_on(void)
{
    uint8_t pad[9];
    bench_set("temperature", 85);
    convert(750);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX16(0x0550, code_of(pad));
    TEST_ASSERT_NOT_EQUAL(0x0C, pad[6]);
}

static void write_settings(uint8_t high, uint8_t low, uint8_t config)
{
    (void)reset();
    put(0xCC);
    put(0x4E);
    put(high);
    put(low);
    put(config);
}

static void resolution_sets_time_and_bits(void)
{
    static const double ms[4] = {93.75, 187.5, 375, 750};
    static const uint16_t code[4] = {0x0198, 0x019C, 0x019E, 0x019F};
    bench_set("temperature", 25.9375); /* 019Fh */
    for (unsigned r = 0; r < 4; r++) {
        uint8_t pad[9];
        write_settings(75, 70, (uint8_t)(r << 5 | 0x1F));
        convert(0);
        uint64_t start_ns = bench_ns;
        while (!slot(true)) {
        }
        double taken = (double)(bench_ns - start_ns) * 1e-6;
        TEST_ASSERT_TRUE(taken <= ms[r] && taken > 0.65 * ms[r]);
        bench_wait_ms(ms[r] - taken);
        read_pad(pad);
        TEST_ASSERT_EQUAL_HEX16(code[r], code_of(pad));
    }
    bench_expect_right();
}

static void a_scratchpad_read_too_early_is_noticed_and_old(void)
{
    uint8_t pad[9];
    convert(400);
    read_pad(pad);
    bench_expect_wrong("after Convert T, which takes up to 750 ms");
    TEST_ASSERT_EQUAL_HEX16(0x0550, code_of(pad));
}

static void settings_come_back_from_the_store_after_a_loss_of_power(void)
{
    uint8_t pad[9];
    write_settings(30, 10, 0x3F);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(30, pad[2]);
    TEST_ASSERT_EQUAL_HEX8(0x3F, pad[4]);
    bench_set("power_loss", 1);
    bench_wait_ms(1);
    bench_set("power_loss", 0);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(75, pad[2]);
    TEST_ASSERT_EQUAL_HEX8(0x7F, pad[4]);
    write_settings(30, 10, 0x3F);
    (void)reset();
    put(0xCC);
    put(0x48); /* copy */
    TEST_ASSERT_FALSE(slot(true));
    bench_wait_ms(10);
    TEST_ASSERT_TRUE(slot(true));
    write_settings(1, 2, 0x1F);
    (void)reset();
    put(0xCC);
    put(0xB8); /* recall */
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(30, pad[2]);
    TEST_ASSERT_EQUAL_HEX8(10, pad[3]);
    TEST_ASSERT_EQUAL_HEX8(0x3F, pad[4]);
    bench_expect_right();
}

static void only_the_resolution_of_the_configuration_can_be_written(void)
{
    uint8_t pad[9];
    write_settings(1, 2, 0x80);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(0x1F, pad[4]);
}

static void a_loss_of_power_in_each_conversion_reads_as_power_on(void)
{
    uint8_t pad[9];
    bench_set("temperature", 60);
    bench_set("power_loss", 1);
    for (unsigned i = 0; i < 3; i++) {
        convert(750);
        read_pad(pad);
        TEST_ASSERT_EQUAL_HEX16(0x0550, code_of(pad));
        TEST_ASSERT_EQUAL_HEX8(0x0C, pad[6]);
        TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
    }
    bench_set("power_loss", 0);
    convert(750);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX16(60 * 16, code_of(pad));
    bench_expect_right();
}

static void a_turned_bit_spoils_the_crc_each_time(void)
{
    uint8_t pad[9];
    bench_set("crc", 1);
    for (unsigned i = 0; i < 100; i++) {
        read_pad(pad);
        TEST_ASSERT_NOT_EQUAL(0, crc(pad, 9));
    }
    bench_set("crc", 0);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
}

static void a_shorted_line_is_held_low_and_comes_back(void)
{
    uint8_t pad[9];
    bench_set("short", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_HELD_LOW, reset());
    get(pad, 9);
    TEST_ASSERT_EQUAL_HEX8(0, pad[0]);
    TEST_ASSERT_EQUAL_HEX8(0, pad[8]);
    bench_set("short", 0);
    read_pad(pad);
    TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
    bench_expect_right();
}

static void a_dead_chip_has_no_presence(void)
{
    bench_set("dead", 1);
    TEST_ASSERT_EQUAL_INT(CHIPS_SILENT, reset());
    TEST_ASSERT_TRUE(slot(true));
}

static void the_address_is_family_serial_and_crc(void)
{
    static const uint8_t rom[7] = {0x28, 0xC3, 0xFD, 0xE2, 0x05, 0x00, 0x00};
    uint8_t bytes[8];
    (void)reset();
    put(0x33);
    get(bytes, 8);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(rom, bytes, 7);
    TEST_ASSERT_EQUAL_HEX8(crc(rom, 7), bytes[7]);
    put(0xB4);
    TEST_ASSERT_TRUE(slot(true)); /* supply of its own */
    bench_expect_right();
}

static void a_slot_without_a_reset_is_noticed(void)
{
    (void)slot(false);
    bench_expect_wrong("slot written without a reset");
    write_settings(1, 2, 0x7F);
    bench_expect_right();
    put(0x44);
    bench_expect_wrong("slot written without a reset");
}

static void commands_that_are_none_are_noticed(void)
{
    (void)reset();
    put(0x12);
    bench_expect_wrong("12h is no command for the address");
    (void)reset();
    put(0xCC);
    put(0x13);
    bench_expect_wrong("13h is no command");
    convert(10);
    (void)reset();
    put(0xCC);
    put(0x44);
    bench_expect_wrong("Convert T while it converts");
}

static void add_sensors(size_t n, uint64_t seed)
{
    for (size_t i = 0; i < n; i++) {
        struct chip *c = chip_new("ds18b20", "", seed + i, bench_err, sizeof(bench_err));
        TEST_ASSERT_NOT_NULL(c);
        sensors[n_sensors++] = c;
        TEST_ASSERT_TRUE(chips_add(bench_bus, c, HAL_PIN_NONE, bench_err, sizeof(bench_err)));
        chip_power(c, bench_ns, true);
        TEST_ASSERT_TRUE(
            chip_set(c, "temperature", 30.0 + (double)i, bench_err, sizeof(bench_err)));
    }
}

/* Passes of the search of the data sheet: two bits in and one out, 64 times. The number of addresses; -1: a pass without an answer. */
static int search(uint8_t command, uint8_t found[][8], size_t most)
{
    unsigned branch = 0;
    int n = 0;
    uint8_t rom[8] = {0};
    do {
        unsigned last_zero = 0;
        if (reset() != CHIPS_ANSWER) {
            return -1;
        }
        put(command);
        for (unsigned i = 1; i <= 64; i++) {
            bool bit = slot(true);
            bool complement = slot(true);
            uint8_t mask = (uint8_t)(1u << ((i - 1) % 8));
            if (bit && complement) {
                return -1;
            }
            bool go = bit;
            if (!bit && !complement) {
                go = i < branch ? (rom[(i - 1) / 8] & mask) != 0 : i == branch;
                last_zero = go ? last_zero : i;
            }
            rom[(i - 1) / 8] = (uint8_t)((rom[(i - 1) / 8] & ~mask) | (go ? mask : 0));
            (void)slot(go);
        }
        TEST_ASSERT_TRUE((size_t)n < most);
        memcpy(found[n++], rom, 8);
        branch = last_zero;
    } while (branch != 0);
    return n;
}

static double serial_of(const uint8_t rom[8])
{
    double serial = 0.0;
    for (unsigned i = 6; i >= 1; i--) {
        serial = serial * 256.0 + rom[i];
    }
    return serial;
}

static void a_search_finds_each_of_several_once(void)
{
    for (size_t n = 0; n <= SENSORS_MAX - 1; n += 1) {
        uint8_t found[SENSORS_MAX][8] = {{0}};
        TEST_ASSERT_EQUAL_INT(n + 1, search(0xF0, found, SENSORS_MAX));
        for (size_t k = 0; k < n; k++) {
            unsigned times = 0;
            for (size_t i = 0; i <= n; i++) {
                TEST_ASSERT_EQUAL_HEX8(0, crc(found[i], 8));
                times += serial_of(found[i]) == sensors[k]->property[0];
            }
            TEST_ASSERT_EQUAL_UINT(1, times);
        }
        if (n < SENSORS_MAX - 1) {
            add_sensors(1, 1000 + 17 * n);
        }
    }
    bench_expect_right();
}

static void an_alarm_search_finds_those_beyond_their_limits(void)
{
    uint8_t found[SENSORS_MAX][8] = {{0}};
    add_sensors(3, 5);
    TEST_ASSERT_TRUE(chip_set(sensors[1], "temperature", 80, bench_err, sizeof(bench_err)));
    write_settings(75, 10, 0x7F);
    convert(750);
    TEST_ASSERT_EQUAL_INT(1, search(0xEC, found, SENSORS_MAX));
    TEST_ASSERT_TRUE(serial_of(found[0]) == sensors[1]->property[0]);
}

static void a_matched_chip_answers_alone(void)
{
    uint8_t found[SENSORS_MAX][8] = {{0}};
    add_sensors(5, 77);
    bench_set("temperature", -7);
    convert(750);
    int n = search(0xF0, found, SENSORS_MAX);
    TEST_ASSERT_EQUAL_INT(6, n);
    for (int i = 0; i < n; i++) {
        uint8_t pad[9];
        double expected = -7.0;
        for (size_t k = 0; k < n_sensors; k++) {
            if (serial_of(found[i]) == sensors[k]->property[0]) {
                expected = 30.0 + (double)k;
            }
        }
        (void)reset();
        put(0x55);
        for (unsigned k = 0; k < 8; k++) {
            put(found[i][k]);
        }
        put(0xBE);
        get(pad, 9);
        TEST_ASSERT_EQUAL_HEX8(0, crc(pad, 9));
        TEST_ASSERT_EQUAL_INT(expected * 16.0, (int16_t)code_of(pad));
    }
    (void)reset();
    put(0x55);
    for (unsigned k = 0; k < 8; k++) {
        put(k == 1 ? (uint8_t)(found[0][1] ^ 1u) : found[0][k]);
    }
    put(0xBE);
    TEST_ASSERT_TRUE(slot(true)); /* nobody: the line stays high */
    bench_expect_right();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(power_on_reads_85_degrees_and_says_so_in_byte_6);
    RUN_TEST(temperatures_are_those_of_table_1);
    RUN_TEST(measured_85_degrees_differ_from_those_of_power_on);
    RUN_TEST(resolution_sets_time_and_bits);
    RUN_TEST(a_scratchpad_read_too_early_is_noticed_and_old);
    RUN_TEST(settings_come_back_from_the_store_after_a_loss_of_power);
    RUN_TEST(only_the_resolution_of_the_configuration_can_be_written);
    RUN_TEST(a_loss_of_power_in_each_conversion_reads_as_power_on);
    RUN_TEST(a_turned_bit_spoils_the_crc_each_time);
    RUN_TEST(a_shorted_line_is_held_low_and_comes_back);
    RUN_TEST(a_dead_chip_has_no_presence);
    RUN_TEST(the_address_is_family_serial_and_crc);
    RUN_TEST(a_slot_without_a_reset_is_noticed);
    RUN_TEST(commands_that_are_none_are_noticed);
    RUN_TEST(a_search_finds_each_of_several_once);
    RUN_TEST(an_alarm_search_finds_those_beyond_their_limits);
    RUN_TEST(a_matched_chip_answers_alone);
    return UNITY_END();
}
