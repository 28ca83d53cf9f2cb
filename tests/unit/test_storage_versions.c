/* Guards a promise to owners of stored sets: later firmware reads sets of earlier firmware, and leaves sets of newer firmware alone. The
 * images in tests/reference/storage are such sets, written from storage-format.md by storage_images.py. */
#include "storage_images.h"

/* Meaning of "renamed" in tests/reference/storage_images.py; the firmware's own table is not linked. */
const struct storage_rename storage_renames[] = {
    {15u << 12 | 60u << 6, 4u << 12 | 4u << 6},
    {(uint16_t)(15u << 12 | 61u << 6), 4u << 12 | 6u << 6},
    {0, 0},
};

static unsigned operations;

static bool keep(uint32_t address, uint32_t n)
{
    (void)address;
    (void)n;
    operations++;
    return true;
}

void setUp(void)
{
    flash_model_keep = keep;
    operations = 0;
    memory_port_erase_all();
}

void tearDown(void) {}

/* ---- older ones ---- */

/* ---- newer ones ---- */

static void expect_blocked(const char *name, float gain, float format)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    load_image(name);
    memcpy(image, flash_model, sizeof image);
    for (unsigned i = 0; i < 2; i++) {
        bench_boot();
        TEST_ASSERT_EQUAL_FLOAT(gain, bench_get("loop1.gain"));
        TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_NEWER]);
        TEST_ASSERT_EQUAL_FLOAT(format, last_value[EVENT_STORAGE_NEWER]);
        TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_DAMAGED]);
        TEST_ASSERT_EQUAL_STRING("blocked", storage_word(&fw.storage));
        TEST_ASSERT_EQUAL(ERR_VERSION, bench_save());
        TEST_ASSERT_NOT_NULL(strstr(save_why, "`save replace`"));
    }
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(image, flash_model, sizeof image, name);
    TEST_ASSERT_EQUAL(0, operations);
}

static enum err save_replacing(void)
{
    enum err err = storage_save(&fw.storage, true, &save_why);
    bench_work();
    return err ? err : storage_result(&fw.storage, &save_why);
}

static void test_settings_of_newer_firmware_are_kept_until_somebody_gives_them_up(void)
{
    static const char *const names[] = {"newer_slot", "newer_set", "newer_both"};
    static const float gains[] = {4.0f, 4.0f, 1.0f}, formats[] = {2.0f, 2.0f, 3.0f};
    for (unsigned i = 0; i < 3; i++) {
        struct config c;
        operations = 0;
        expect_blocked(names[i], gains[i], formats[i]);
        bench_small(&c, "6.5");
        bench_put(&c);
        fw.supervisor.loop[0].mode = LOOP_AUTO;
        TEST_ASSERT_EQUAL(ERR_STATE, save_replacing());
        TEST_ASSERT_EQUAL(0, operations);
        fw.supervisor.loop[0].mode = LOOP_MANUAL;
        TEST_ASSERT_EQUAL(ERR_OK, save_replacing());
        TEST_ASSERT_EQUAL_STRING("ok", storage_word(&fw.storage));
        bench_boot();
        TEST_ASSERT_TRUE(bench_is(&c));
        TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_NEWER]);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    }
}

static void test_nothing_of_ours_is_repaired_beside_newer_firmware(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    load_image("newer_slot");
    bench_boot();
    memset(flash_model + fw.storage.newest.tail + STORAGE_GRAIN, 0, 4); /* its confirmation */
    memcpy(image, flash_model, sizeof image);
    bench_boot();
    TEST_ASSERT_EQUAL(ERR_VERSION, bench_save());
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
}

static void test_only_newer_settings_are_no_damage_and_load_says_so(void)
{
    struct config c;
    const char *reason;
    load_image("newer_both");
    bench_boot();
    TEST_ASSERT_EQUAL(ERR_VERSION, storage_load(&fw.storage, &c, &reason));
    TEST_ASSERT_NOT_NULL(strstr(reason, "newer firmware"));
}

static unsigned times_in_flash(const void *bytes, size_t n)
{
    unsigned times = 0;
    for (size_t i = 0; i + n <= sizeof flash_model; i++)
        times += memcmp(flash_model + i, bytes, n) == 0;
    return times;
}

static void test_unknown_ids_are_carried_over_by_every_save(void)
{
    uint8_t unknown[204] = {0x82, 0xFF, 9, 200};
    static const uint8_t empty[4] = {0xC0, 0xFF, 77, 0};
    static const uint8_t beyond[8] = {0x3B, 0x41, STORAGE_FLOAT, 4, 0, 0, 0xE0, 0x40};
    for (unsigned i = 0; i < 200; i++)
        unknown[4 + i] = (uint8_t)i;
    struct config expected;
    plant_of_images(&expected);
    load_image("unknown");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
    for (unsigned n = 2; n < 6; n++) {
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        TEST_ASSERT_EQUAL(n, times_in_flash(unknown, sizeof unknown));
        TEST_ASSERT_EQUAL(n, times_in_flash(empty, sizeof empty));
        TEST_ASSERT_EQUAL(n, times_in_flash(beyond, sizeof beyond));
        bench_boot();
        TEST_ASSERT_TRUE(bench_is(&expected));
    }
    /* Also when everything else changes. */
    parameters_defaults(&expected);
    bench_put(&expected);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_EQUAL(6, times_in_flash(unknown, sizeof unknown));
}

/* Calibration and limits of belief: what an earlier set lacks is as if it were not there, and is not stored. */
static void test_a_measurement_of_an_earlier_set_is_calibrated_by_nothing(void)
{
    static const char *const names[] = {"meas1.gain", "meas1.zero", "meas1.valid_lo",
                                        "meas1.valid_hi"};
    load_image("plain");
    bench_boot();
    for (uint8_t k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_FLOAT(k == 0 ? 1.0f : 0.0f, bench_get(names[k]));
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        struct parameter p;
        TEST_ASSERT_EQUAL(ERR_OK, parameter_find(names[k], &p));
        uint32_t id = parameter_id(&p);
        const uint8_t head[4] = {(uint8_t)id, (uint8_t)(id >> 8), STORAGE_FLOAT, 4};
        TEST_ASSERT_EQUAL(0, times_in_flash(head, sizeof head));
    }
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_CLIPPED]);
}

static void test_an_earlier_set_probes_the_margin_of_loops_on_trial(void)
{
    load_image("plain");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(1.5f, bench_get("test.probe"));
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_CLIPPED]);
}

static void test_values_out_of_range_are_clipped_one_by_one(void)
{
    struct config expected;
    plant_of_images(&expected);
    bench_set(&expected, "loop1.gain", "100");
    bench_set(&expected, "loop1.b", "0");
    bench_set(&expected, "loop1.n", "8");
    bench_set(&expected, "loop1.divisor", "10000");
    bench_set(&expected, "loop1.action", "direct");
    bench_set(&expected, "tick.miss_limit", "1000000");
    load_image("ranges");
    bench_boot();
    TEST_ASSERT_EQUAL(8, seen[EVENT_STORAGE_CLIPPED]);
    TEST_ASSERT_TRUE(bench_is(&expected));
}

static void test_clipping_names_parameter_and_value(void)
{
    load_image("ranges");
    bench_boot();
    TEST_ASSERT_EQUAL_STRING("meas2.unit", last_subject[EVENT_STORAGE_CLIPPED]);
    struct event e;
    bool found = false;
    for (uint32_t i = 0; i < fw.service.history.count; i++) {
        if (!event_log_get(&fw.service.history, i, &e) || e.code != EVENT_STORAGE_CLIPPED)
            continue;
        if (strcmp(e.subject, "loop1.gain") == 0) {
            found = true;
            TEST_ASSERT_EQUAL_FLOAT(100.0f, e.value);
        }
    }
    TEST_ASSERT_TRUE(found);
}

static void test_types_that_have_changed_are_converted(void)
{
    struct config expected;
    plant_of_images(&expected);
    bench_set(&expected, "loop1.gain", "1.25");
    bench_set(&expected, "loop1.ti", "450");
    bench_set(&expected, "loop1.divisor", "3");
    bench_set(&expected, "loop1.action", "direct");
    bench_set(&expected, "loop1.sp_track", "off");
    bench_set(&expected, "tick.miss_limit", "12");
    load_image("types");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
    TEST_ASSERT_EQUAL(2, seen[EVENT_STORAGE_CLIPPED]); /* what cannot be converted: the default */
}

static void test_renamed_fields_are_found_and_the_new_name_wins(void)
{
    struct config expected;
    plant_of_images(&expected);
    bench_set(&expected, "loop1.td", "25");
    load_image("renamed");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
    /* The next save knows the new names only. */
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    static const uint8_t head[4] = {0x00, 0xFF, STORAGE_FLOAT, 4};
    TEST_ASSERT_EQUAL(1, times_in_flash(head, sizeof head));
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
}

static void test_records_that_end_in_nothing_end_the_reading(void)
{
    struct config expected;
    plant_of_images(&expected);
    load_image("overrun");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
}

static void test_inconsistent_set_stays_stored_and_defaults_run(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    struct config defaults, c;
    struct config_fault fault;
    const char *reason;
    parameters_defaults(&defaults);
    load_image("inconsistent");
    memcpy(image, flash_model, sizeof image);
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&defaults));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_REFUSED]);
    TEST_ASSERT_EQUAL_STRING("loop1.pv", last_subject[EVENT_STORAGE_REFUSED]);
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, 192); /* the set; what was erased may not be */
    /* Asking again gives the reason again. */
    TEST_ASSERT_EQUAL(ERR_OK, storage_load(&fw.storage, &c, &reason));
    TEST_ASSERT_EQUAL(ERR_UNKNOWN, service_apply(&fw.service, &c, &fault));
    TEST_ASSERT_EQUAL_STRING("T1", fault.subject);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_settings_of_newer_firmware_are_kept_until_somebody_gives_them_up);
    RUN_TEST(test_nothing_of_ours_is_repaired_beside_newer_firmware);
    RUN_TEST(test_only_newer_settings_are_no_damage_and_load_says_so);
    RUN_TEST(test_unknown_ids_are_carried_over_by_every_save);
    RUN_TEST(test_a_measurement_of_an_earlier_set_is_calibrated_by_nothing);
    RUN_TEST(test_an_earlier_set_probes_the_margin_of_loops_on_trial);
    RUN_TEST(test_values_out_of_range_are_clipped_one_by_one);
    RUN_TEST(test_clipping_names_parameter_and_value);
    RUN_TEST(test_types_that_have_changed_are_converted);
    RUN_TEST(test_renamed_fields_are_found_and_the_new_name_wins);
    RUN_TEST(test_records_that_end_in_nothing_end_the_reading);
    RUN_TEST(test_inconsistent_set_stays_stored_and_defaults_run);
    return UNITY_END();
}
