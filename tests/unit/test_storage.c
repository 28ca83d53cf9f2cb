/* Stored settings: the format on old images, what is stored, wear, refusals. */
#include "storage_images.h"

static unsigned erases, programs;
static unsigned refusals; /* of the next writes */
static bool take_no_write, worn_tail;

static bool keep(uint32_t address, uint32_t n)
{
    if (n == FLASH_MODEL_SECTOR_SIZE)
        erases++;
    else
        programs++;
    if (worn_tail && memcmp(flash_model + address, "RXST", 4) == 0)
        flash_model[address + 8] = 0; /* after it was read back */
    if (refusals) {
        refusals--;
        return false;
    }
    return !take_no_write;
}

void setUp(void)
{
    flash_model_keep = keep;
    take_no_write = worn_tail = false;
    erases = programs = refusals = 0;
    memory_port_erase_all();
}

void tearDown(void) {}

/* ---- format ---- */

static void test_image_of_another_writer_is_read(void)
{
    struct config expected;
    plant_of_images(&expected);
    load_image("plain");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&expected));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_LOADED]);
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_CLIPPED] + seen[EVENT_STORAGE_OLDER]);
    TEST_ASSERT_EQUAL(1, fw.storage.newest.sequence);
}

static void test_newest_of_several_counts_in_either_slot(void)
{
    load_image("three");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(3.0f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(9, fw.storage.newest.sequence);
    load_image("second");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(5.0f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL_FLOAT(41.0f, last_value[EVENT_STORAGE_LOADED]);
}

static void test_torn_set_leaves_the_one_before(void)
{
    load_image("torn");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(2.5f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_OLDER]);
    /* The next save goes behind what is torn, under a number of its own. */
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_EQUAL(
        3, fw.storage.newest.sequence); /* 2 was used, and is what the start settled under */
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(2.5f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
}

/* Each stands behind the checksum of the set, which is right here: a writer's mistake, not the flash's. */
static void test_set_counts_only_if_head_and_tail_are_right_too(void)
{
    static const char *const images[] = {"head", "tail_length", "tail_sequence"};
    for (unsigned i = 0; i < sizeof images / sizeof images[0]; i++) {
        load_image(images[i]);
        bench_boot();
        TEST_ASSERT_EQUAL_FLOAT_MESSAGE(2.5f, bench_get("loop1.gain"), images[i]);
        TEST_ASSERT_EQUAL_MESSAGE(1, seen[EVENT_STORAGE_OLDER], images[i]);
        TEST_ASSERT_EQUAL_FLOAT(1.0f, last_value[EVENT_STORAGE_OLDER]);
        /* The next save goes behind it, and counts. */
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        bench_boot();
        TEST_ASSERT_EQUAL_MESSAGE(0, seen[EVENT_STORAGE_OLDER], images[i]);
        TEST_ASSERT_TRUE(fw.storage.newest.sequence > 1);
    }
}

static void test_nothing_is_appended_to_a_slot_whose_mark_is_not_right(void)
{
    load_image("mark");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(2.5f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(1, erases); /* of the other one */
    TEST_ASSERT_EQUAL(0, fw.storage.erases[0]);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_TRUE(fw.storage.newest.address >= fw.storage.slot_size);
}

static void test_broken_first_set_of_a_new_slot_is_told(void)
{
    load_image("second");
    flash_model[FLASH_MODEL_SIZE / 2 + STORAGE_GRAIN] ^= 1u; /* of its head */
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(4.0f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_OLDER]);
}

static void test_nothing_whole_means_defaults_and_an_alarm(void)
{
    struct config defaults;
    parameters_defaults(&defaults);
    load_image("ruined");
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&defaults));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_DAMAGED]);
    TEST_ASSERT_EQUAL(EVENT_ALARM, event_level(EVENT_STORAGE_DAMAGED));
    const char *reason;
    struct config c = defaults;
    TEST_ASSERT_EQUAL(ERR_CRC, storage_load(&fw.storage, &c, &reason));
}

static void test_new_flash_is_prepared_without_an_alarm(void)
{
    const char *reason;
    struct config c;
    bench_boot();
    TEST_ASSERT_EQUAL(1, erases);
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_DAMAGED]);
    TEST_ASSERT_EQUAL(ERR_EMPTY, storage_load(&fw.storage, &c, &reason));
    bench_boot();
    TEST_ASSERT_EQUAL(1, erases); /* once is enough */
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_DAMAGED]);
}

static void test_bytes_in_flash_are_those_of_the_document(void)
{
    static const uint8_t expected[] = {'R',  'X',  'S',  'M',  1, 0, 0, 0, 1, 0, 0, 0,
                                       0x0C, 0xA6, 0xAF, 0x3D, /* mark */
                                       'R',  'X',  'S',  'H',  1, 0, 0, 0, 0, 0, 1, CONFIG_SCHEMA};
    bench_boot();
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    uint8_t there[sizeof expected];
    memcpy(there, flash_model, sizeof there);
    memset(there + 12, 0, 4); /* the checksum: test_image_of_another_writer_is_read */
    there[24] = there[25] = 0;
    uint8_t wanted[sizeof expected];
    memcpy(wanted, expected, sizeof wanted);
    memset(wanted + 12, 0, 4);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(wanted, there, sizeof wanted);
    TEST_ASSERT_EQUAL_HEX8(0x40, flash_model[32]); /* tick.base: id 0x1040 */
    TEST_ASSERT_EQUAL_HEX8(0x10, flash_model[33]);
    TEST_ASSERT_EQUAL(STORAGE_FLOAT, flash_model[34]);
    TEST_ASSERT_EQUAL(4, flash_model[35]);
}

static void test_confirmed_set_is_left_as_it_is(void)
{
    load_image("confirmed");
    bench_boot(); /* which makes the other slot ready, where there is no room for the largest set */
    TEST_ASSERT_EQUAL(1, fw.storage.newest.sequence);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, bench_get("loop1.gain"));
    static uint8_t image[FLASH_MODEL_SIZE];
    memcpy(image, flash_model, sizeof image);
    programs = 0;
    bench_boot();
    TEST_ASSERT_EQUAL(0, programs);
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
}

static void test_set_of_earlier_firmware_is_confirmed_once(void)
{
    load_image("plain");
    bench_boot();
    TEST_ASSERT_EQUAL(CLOSED_CONFIRMED, fw.storage.newest.closed);
    programs = 0;
    bench_boot();
    TEST_ASSERT_EQUAL(0, programs);
    TEST_ASSERT_EQUAL_FLOAT(1.5f, bench_get("loop1.gain"));
}

static void test_renewed_set_counts_before_one_that_was_cut(void)
{
    load_image("renewed");
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(2.5f, bench_get("loop1.gain"));
    TEST_ASSERT_EQUAL(2, fw.storage.newest.sequence);
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
    /* Writer and image agree: without the renewal the same one is written again, for the set that is whole now. */
    uint32_t at = fw.storage.newest.tail;
    uint8_t there[32];
    memcpy(there, flash_model + at, sizeof there);
    memset(flash_model + at, 0xFF, sizeof there);
    flash_model[at - 20] = 0; /* of the tail */
    bench_boot();
    TEST_ASSERT_EQUAL_MEMORY(there, flash_model + at, sizeof there);
}

static void test_sequence_goes_round(void)
{
    load_image("round");
    for (unsigned sequence = 1; sequence < 4; sequence++) {
        bench_boot();
        TEST_ASSERT_EQUAL_FLOAT(3.0f, bench_get("loop1.gain"));
        TEST_ASSERT_EQUAL(sequence, fw.storage.newest.sequence);
        TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_OLDER]);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    }
}

static void test_start_that_finds_nothing_whole_erases_nothing(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    load_image("mark");
    flash_model[100] ^= 1u;
    memcpy(image, flash_model, sizeof image);
    bench_boot();
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_DAMAGED]);
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
    /* It was the weather. */
    flash_model[100] ^= 1u;
    bench_boot();
    TEST_ASSERT_EQUAL_FLOAT(2.5f, bench_get("loop1.gain"));
    /* A user who saves over it wants to. */
    load_image("mark");
    flash_model[100] ^= 1u;
    bench_boot();
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
}

/* ---- what is stored ---- */

static void test_every_parameter_comes_back(void)
{
    struct config c, there;
    struct parameter p;
    const char *reason;
    char value[32];
    bench_boot();
    parameters_defaults(&c);
    for (unsigned n = 0; parameter_at(n, &p); n++) {
        float lo = field_lo(p.field), hi = field_hi(p.field),
              f = lo + (hi - lo) * (float)(1 + n % 97) / 99.0f;
        switch (p.field->type) {
        case PARAMETER_FIXED:
            continue;
        case PARAMETER_FLOAT:
            snprintf(value, sizeof value, "%.9g", (double)f);
            break;
        case PARAMETER_U32:
        case PARAMETER_U16:
            snprintf(value, sizeof value, "%u", (unsigned)f);
            break;
        case PARAMETER_WORD: {
            struct text t = text_on(value, sizeof value);
            uint8_t *at = parameter_place(&p, &c);
            *at = (uint8_t)(n % parameter_words(&p));
            parameter_value(&p, &c, &t);
            break;
        }
        default:
            snprintf(value, sizeof value, "x%u", n);
            break;
        }
        TEST_ASSERT_EQUAL(ERR_OK, parameter_set(&p, &c, value));
    }
    /* No plan could be made of it, and none is needed. */
    *service_stage(&fw.service) = c;
    fw.service.plan[fw.service.in_force].config = c;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_EQUAL(ERR_OK, storage_load(&fw.storage, &there, &reason));
    TEST_ASSERT_EQUAL_MEMORY(&c, &there, sizeof c);
    printf("bytes of the largest set: %u\n",
           (unsigned)(16u + (fw.storage.newest.length + 15u) / 16u * 16u + 16u));
}

static void test_save_takes_the_pending_plan(void)
{
    struct config c;
    struct config_fault fault;
    bench_boot();
    bench_small(&c, "4.5");
    TEST_ASSERT_EQUAL(ERR_OK, service_apply(&fw.service, &c, &fault)); /* no tick yet */
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_boot();
    TEST_ASSERT_TRUE(bench_is(&c));
}

/* ---- wear, erasing, refusing ---- */

static void test_saves_append_until_the_slot_is_full_and_then_change_it(void)
{
    struct config a, b;
    bench_boot();
    bench_small(&a, "1.5");
    bench_small(&b, "2.5");
    unsigned saves = 0, turned = 0, bytes = 1;
    unsigned before = erases;
    for (; erases < before + 4; saves++) {
        unsigned were = erases;
        bench_put(saves % 2 ? &a : &b);
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        bytes = 48u + (fw.storage.newest.length + 15u) / 16u * 16u;
        turned += erases != were;
    }
    TEST_ASSERT_EQUAL(4, turned);
    /* The slots take turns, and each is filled to the last set that fits. */
    unsigned a_slot = (FLASH_MODEL_SECTOR_SIZE - STORAGE_GRAIN - 128u) / bytes;
    TEST_ASSERT_EQUAL(4 * a_slot + 1, saves);
    TEST_ASSERT_EQUAL(1 + 2, fw.storage.erases[0]);
    TEST_ASSERT_EQUAL(2, fw.storage.erases[1]);
    printf("saves of %u bytes for each erase of a slot of %u: %u\n", bytes, FLASH_MODEL_SECTOR_SIZE,
           a_slot);
    bench_boot();
    TEST_ASSERT_TRUE(bench_is((saves - 1) % 2 ? &a : &b));
}

/* Fills the slot in use so that the next save needs an erase. */
static void fill(void)
{
    struct config c;
    bench_small(&c, "1.5");
    bench_put(&c);
    for (;;) {
        uint8_t slot = fw.storage.newest.address >= fw.storage.slot_size;
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        uint32_t whole_grains = (fw.storage.newest.length + 15u) & ~15u;
        if (fw.storage.slot_size - fw.storage.used[slot] < 32u + whole_grains + 16u + 128u)
            return;
    }
}

static void test_save_that_needs_an_erase_is_refused_while_a_loop_acts(void)
{
    static uint8_t image[FLASH_MODEL_SIZE];
    bench_boot();
    fill();
    memcpy(image, flash_model, sizeof image);
    unsigned were = erases;
    fw.supervisor.loop[0].mode = LOOP_AUTO;
    TEST_ASSERT_EQUAL(ERR_STATE, bench_save());
    TEST_ASSERT_NOT_NULL(strstr(save_why, "manual"));
    TEST_ASSERT_EQUAL_MEMORY(image, flash_model, sizeof image);
    TEST_ASSERT_EQUAL(were, erases);
    fw.supervisor.loop[0].mode = LOOP_MANUAL;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    TEST_ASSERT_EQUAL(were + 1, erases);
    /* With room again, a loop may act. */
    fw.supervisor.loop[0].mode = LOOP_AUTO;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
}

static void test_loop_that_begins_to_act_stops_the_erase(void)
{
    bench_boot();
    fill();
    unsigned were = erases;
    TEST_ASSERT_EQUAL(ERR_OK, storage_save(&fw.storage, false, &save_why));
    fw.supervisor.loop[0].mode = LOOP_AUTO; /* between the promise and the deed */
    bench_work();
    TEST_ASSERT_EQUAL(ERR_STATE, storage_result(&fw.storage, &save_why));
    TEST_ASSERT_EQUAL(were, erases);
}

static void test_start_makes_room_before_the_settings_are_in_force(void)
{
    struct config c;
    bench_boot();
    bench_small(&c, "1.5");
    bench_put(&c);
    for (unsigned n = 0; n < 40; n++) {
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        bench_boot();
        /* From here on every loop may act: the next save needs no erase. */
        TEST_ASSERT_TRUE(bench_is(&c));
        fw.supervisor.loop[0].mode = LOOP_AUTO;
        TEST_ASSERT_EQUAL(ERR_OK, bench_save());
        fw.supervisor.loop[0].mode = LOOP_MANUAL;
    }
}

static void test_at_most_one_flash_operation_a_turn(void)
{
    bench_boot();
    fill();
    TEST_ASSERT_EQUAL(ERR_OK, storage_save(&fw.storage, false, &save_why));
    bool more = true;
    while (more) {
        unsigned before = erases + programs;
        more = storage_poll(&fw.storage);
        TEST_ASSERT_TRUE(erases + programs - before <= 1);
    }
    TEST_ASSERT_EQUAL(ERR_OK, storage_result(&fw.storage, &save_why));
}

static void test_flash_that_takes_no_write_is_told(void)
{
    char text[120];
    struct text t = text_on(text, sizeof text);
    take_no_write = true;
    bench_boot();
    TEST_ASSERT_EQUAL_STRING("failed", storage_word(&fw.storage));
    TEST_ASSERT_EQUAL(ERR_IO, bench_save());
    TEST_ASSERT_NOT_NULL(strstr(save_why, "does not take the write"));
    storage_text(&fw.storage, &t);
    TEST_ASSERT_EQUAL_STRING_LEN("failed", text, 6);
    fw.supervisor.loop[0].mode = LOOP_AUTO; /* manual would not help */
    TEST_ASSERT_EQUAL(ERR_IO, bench_save());
    fw.supervisor.loop[0].mode = LOOP_MANUAL;
    take_no_write = false;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save()); /* it was the weather */
    TEST_ASSERT_EQUAL_STRING("ok", storage_word(&fw.storage));
}

/* A set that one place does not take may be taken by the next, four times at most. */
static void test_set_begins_behind_what_is_not_taken(void)
{
    for (unsigned n = 1; n <= 4; n++) {
        setUp();
        bench_boot();
        refusals = n;
        TEST_ASSERT_EQUAL(n < 4 ? ERR_OK : ERR_IO, bench_save());
        TEST_ASSERT_EQUAL(0, refusals);
        TEST_ASSERT_EQUAL(n < 4 ? STORAGE_GRAIN * (1 + n) : 0, fw.storage.newest.address);
    }
}

static void test_what_is_shown_instead_of_a_secret_is_none(void)
{
    struct config c;
    bench_boot();
    bench_small(&c, "1.5");
    strcpy(c.console_key, "***");
    bench_put(&c);
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
    bench_boot();
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_CLIPPED]);
    TEST_ASSERT_EQUAL_STRING("console.key", last_subject[EVENT_STORAGE_CLIPPED]);
    TEST_ASSERT_EQUAL_STRING("", in_force()->console_key);
}

static void test_set_is_read_back_as_a_whole(void)
{
    bench_boot();
    worn_tail = true;
    TEST_ASSERT_EQUAL(ERR_IO, bench_save());
    worn_tail = false;
    TEST_ASSERT_EQUAL(ERR_OK, bench_save());
}

/* Emulated flash reads zeros, or erased, and stays so: that is no damage. */
static void test_memory_of_zeros_is_no_damage(void)
{
    memset(flash_model, 0, sizeof flash_model);
    take_no_write = true;
    bench_boot();
    TEST_ASSERT_EQUAL(0, seen[EVENT_STORAGE_DAMAGED]);
}

static void test_save_and_load_wait_for_the_transaction(void)
{
    bench_boot();
    TEST_ASSERT_NOT_NULL(service_stage(&fw.service));
    fw.service.staging = true;
    TEST_ASSERT_EQUAL(ERR_STATE, bench_save());
}

static void test_whoever_configures_before_storage_is_read_is_not_overruled(void)
{
    struct config c;
    struct config_fault fault;
    load_image("plain");
    bench_boot();
    /* The same start again, with an `apply` before the first turn of storage. */
    memset(seen, 0, sizeof seen);
    bench_small(&c, "8.5");
    storage_init(&fw.storage, &fw.service);
    TEST_ASSERT_EQUAL(ERR_OK, service_apply(&fw.service, &c, &fault));
    (void)storage_ready(&fw.storage);
    bench_work();
    bench_tick();
    bench_events();
    TEST_ASSERT_TRUE(bench_is(&c));
    TEST_ASSERT_EQUAL(1, seen[EVENT_STORAGE_REFUSED]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_image_of_another_writer_is_read);
    RUN_TEST(test_newest_of_several_counts_in_either_slot);
    RUN_TEST(test_torn_set_leaves_the_one_before);
    RUN_TEST(test_set_counts_only_if_head_and_tail_are_right_too);
    RUN_TEST(test_nothing_is_appended_to_a_slot_whose_mark_is_not_right);
    RUN_TEST(test_broken_first_set_of_a_new_slot_is_told);
    RUN_TEST(test_nothing_whole_means_defaults_and_an_alarm);
    RUN_TEST(test_new_flash_is_prepared_without_an_alarm);
    RUN_TEST(test_bytes_in_flash_are_those_of_the_document);
    RUN_TEST(test_confirmed_set_is_left_as_it_is);
    RUN_TEST(test_set_of_earlier_firmware_is_confirmed_once);
    RUN_TEST(test_renewed_set_counts_before_one_that_was_cut);
    RUN_TEST(test_sequence_goes_round);
    RUN_TEST(test_start_that_finds_nothing_whole_erases_nothing);
    RUN_TEST(test_every_parameter_comes_back);
    RUN_TEST(test_save_takes_the_pending_plan);
    RUN_TEST(test_saves_append_until_the_slot_is_full_and_then_change_it);
    RUN_TEST(test_save_that_needs_an_erase_is_refused_while_a_loop_acts);
    RUN_TEST(test_loop_that_begins_to_act_stops_the_erase);
    RUN_TEST(test_start_makes_room_before_the_settings_are_in_force);
    RUN_TEST(test_at_most_one_flash_operation_a_turn);
    RUN_TEST(test_flash_that_takes_no_write_is_told);
    RUN_TEST(test_set_begins_behind_what_is_not_taken);
    RUN_TEST(test_what_is_shown_instead_of_a_secret_is_none);
    RUN_TEST(test_set_is_read_back_as_a_whole);
    RUN_TEST(test_memory_of_zeros_is_no_damage);
    RUN_TEST(test_save_and_load_wait_for_the_transaction);
    RUN_TEST(test_whoever_configures_before_storage_is_read_is_not_overruled);
    return UNITY_END();
}
