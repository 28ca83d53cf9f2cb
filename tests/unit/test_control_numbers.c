/* Numbers of the blocks of control, compensate and feedforward under random inputs: settings of all sorts, setpoints and measurements on
 * a coarse grid, outputs that are taken, cut, held, forced, followed and shifted, settings that change. Every 16th state of
 * each is kept, and a checksum of all before it; what is right about the numbers say the other tests.
 *
 * Kept in reference/control_numbers.txt, as the float build has it; how it is made anew: support/kept_transcript.h. */
#include <string.h>

#include "base/crc32.h"
#include "block/feedforward.h"
#include "kept_transcript.h"
#include "kinds/decoupler/decoupler.h"
#include "kinds/pid/pid.h"
#include "kinds/two_position/two_position.h"
#include "random_source.h"
#include "unity.h"

#define STEPS 96

static struct random_source source;
static uint32_t sum;

void setUp(void) {}
void tearDown(void) {}

static bool once_in(uint32_t n)
{
    return random_below(&source, n) == 0;
}

static float one_of(const float *values, size_t n)
{
    return values[random_below(&source, (uint32_t)n)];
}

#define ONE_OF(...)                                                                                \
    one_of((const float[]){__VA_ARGS__}, sizeof((const float[]){__VA_ARGS__}) / sizeof(float))

static float grid(int lo, int hi) /* sixteenths */
{
    return (float)(lo + (int)random_below(&source, (uint32_t)(hi - lo + 1))) / 16.0f;
}

__attribute__((format(printf, 2, 3))) static void says(bool whole, const char *format, ...)
{
    char text[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    sum = crc32_update(sum, text, strlen(text));
    if (whole)
        kept_line("%08x %s", (unsigned)sum, text);
}

/* Everything that the block describes of itself. */
static void describes(const struct block_kind *ops, const void *state, bool whole)
{
    char text[300] = "";
    float value;
    const char *name;
    for (size_t i = 0; (name = ops->describe(state, i, &value)) != NULL; i++)
        snprintf(text + strlen(text), sizeof text - strlen(text), "%s %.9g ", name, (double)value);
    says(whole, "%s", text);
}

static struct pid_config some_settings(void)
{
    struct pid_config c = pid_default_config();
    c.gain = ONE_OF(0.5f, 1.5f, 4.0f, 0.1f);
    c.ti_s = ONE_OF(0.0f, 2.0f, 20.0f, 300.0f);
    c.td_s = ONE_OF(0.0f, 0.0f, 3.0f, 40.0f);
    c.n = ONE_OF(1.0f, 8.0f, 20.0f);
    c.b = ONE_OF(0.0f, 0.3f, 1.0f);
    c.c = ONE_OF(0.0f, 0.7f, 1.0f);
    c.tt_s = ONE_OF(0.0f, 0.0f, 0.75f, 5.0f, 30.0f);
    c.out_lo = ONE_OF(0.0f, -1.0f, 0.25f);
    c.out_hi = ONE_OF(1.0f, 0.75f, 2.0f);
    c.rate_per_s = ONE_OF(0.0f, 0.0f, 0.02f, 0.3f);
    c.inhibit_s = ONE_OF(0.0f, 0.0f, 4.0f, 30.0f);
    c.action = once_in(2) ? PID_DIRECT : PID_REVERSE;
    c.form = once_in(2) ? PID_VELOCITY : PID_POSITIONAL;
    return c;
}

static void controllers_do_as_they_did(void)
{
    for (unsigned number = 0; number < 40; number++) {
        struct pid_config c = some_settings();
        float h_s = ONE_OF(1.0f, 0.1f, 5.0f), r = 0.5f, y = 0.5f, u;
        struct pid pid;
        kept_line("# controller %u", number);
        TEST_ASSERT_EQUAL_INT(ERR_OK, pid_init(&pid, &c, h_s));
        for (unsigned step = 0; step < STEPS; step++) {
            if (once_in(12))
                r = grid(0, 16);
            y += grid(-1, 1) / 2.0f;
            y = y < -0.5f || y > 1.5f ? 0.5f : y;
            u = num_to_float(pid_step(&pid, num_from_float(r), num_from_float(y)));
            if (once_in(4)) /* something else was applied */
                u = once_in(2) ? grid(0, 16) : u / 2.0f;
            uint8_t clamp = (uint8_t)(once_in(5) ? random_below(&source, 4) : 0);
            pid_back_calculate(&pid, num_from_float(u), clamp);
            if (once_in(24))
                pid_follow(&pid, num_from_float(r), num_from_float(y), num_from_float(grid(0, 16)));
            if (once_in(24))
                pid_shift(&pid, num_from_float(grid(-4, 20)));
            if (once_in(16)) {
                c = some_settings();
                TEST_ASSERT_EQUAL_INT(ERR_OK, pid_retune(&pid, &c, h_s));
            }
            describes(&pid_kind, &pid, step % 32 == 31);
        }
    }
}

static void two_positions_do_as_they_did(void)
{
    for (unsigned number = 0; number < 8; number++) {
        struct two_position_config c;
        c.band = grid(1, 4) / 4.0f;
        c.out_lo = grid(-2, 4);
        c.out_hi = grid(5, 20);
        c.direct = once_in(2);
        struct two_position t;
        float r = 0.5f;
        kept_line("# two positions %u", number);
        TEST_ASSERT_EQUAL_INT(ERR_OK, two_position_init(&t, &c));
        for (unsigned step = 0; step < STEPS; step++) {
            if (once_in(12))
                r = grid(4, 12);
            (void)two_position_step(&t, num_from_float(r), num_from_float(grid(0, 64) / 4.0f));
            if (once_in(24))
                two_position_follow(&t, num_from_float(grid(0, 16)));
            if (once_in(12)) {
                c.out_hi = grid(5, 20);
                c.band = grid(1, 4) / 4.0f;
                TEST_ASSERT_EQUAL_INT(ERR_OK, two_position_retune(&t, &c));
            }
            describes(&two_position_kind, &t, step % 48 == 47);
        }
    }
}

static void feedforwards_do_as_they_did(void)
{
    static num_t ring[64];
    for (unsigned number = 0; number < 12; number++) {
        struct element_settings c;
        c.gain = ONE_OF(-2.0f, 0.5f, 3.0f);
        c.lead_s = ONE_OF(0.0f, 4.0f, 30.0f);
        c.lag_s = ONE_OF(0.0f, 2.0f, 25.0f);
        c.dead_time_s = ONE_OF(0.0f, 1.0f, 3.5f, 12.0f);
        c.reference = grid(0, 16);
        c.out_lo = ONE_OF(-1.0f, -0.25f, 0.125f);
        c.out_hi = ONE_OF(1.0f, 0.5f);
        struct feedforward f;
        kept_line("# feedforward %u", number);
        TEST_ASSERT_EQUAL_INT(ERR_OK, feedforward_init(&f, &c, 1.0f, ring, sizeof ring));
        says(true, "%u bytes, %.9g", (unsigned)feedforward_bytes(&c, 1.0f),
             (double)num_to_float(f.output));
        float d = c.reference;
        for (unsigned step = 0; step < STEPS; step++) {
            if (once_in(6))
                d = grid(0, 16);
            if (once_in(40))
                feedforward_reset(&f, num_from_float(d));
            says(step % 48 == 47, "%.9g",
                 (double)num_to_float(feedforward_step(&f, num_from_float(d))));
        }
    }
}

/* Matrices near and far from those without an inverse, and what can still be reached through them. */
static enum err decoupler_checks(const float (*m)[DECOUPLER_MAX], uint8_t mask, const float *reach,
                                 uint8_t *worst)
{
    const struct matrix_settings settings = {m};
    struct block_setup setup = {.settings = &settings, .members = DECOUPLER_MAX, .present = mask};
    for (uint8_t i = 0; i < DECOUPLER_MAX; i++)
        setup.member[i] = (struct block_member){.loop = i, .out_reach = reach ? reach[i] : 1.0f};
    return decoupler_check(&setup, worst);
}

static void decouplers_do_as_they_did(void)
{
    kept_line("# decouplers");
    for (unsigned number = 0; number < 400; number++) {
        float m[DECOUPLER_MAX][DECOUPLER_MAX] = {{0}}, reach[DECOUPLER_MAX];
        num_t x[DECOUPLER_MAX], y[DECOUPLER_MAX] = {num_zero()};
        uint8_t mask = (uint8_t)random_below(&source, 256), worst = 0;
        float away = ONE_OF(0.0f, 0.25f, 1.0f, 1.0f);
        for (unsigned i = 0; i < DECOUPLER_MAX; i++) {
            for (unsigned j = 0; j < DECOUPLER_MAX; j++)
                m[i][j] = i == j
                              ? ONE_OF(1.0f, 1.0f, 1.0f, 0.5f, 2.0f, 0.0078125f)
                              : away * (once_in(3) ? ONE_OF(0.25f, -0.5f, 1.0f, 0.98828125f) : 0);
            reach[i] = ONE_OF(1.0f, 1.25f, 2.0f);
            x[i] = num_from_float(grid(-16, 16));
        }
        struct decoupler d = {.n = 0};
        enum err err = decoupler_select(&d, (const float(*)[DECOUPLER_MAX])m, mask);
        enum err with = decoupler_checks((const float(*)[DECOUPLER_MAX])m, mask, reach, &worst);
        uint8_t worst_with = worst;
        worst = 0;
        enum err without = decoupler_checks((const float(*)[DECOUPLER_MAX])m, mask, NULL, &worst);
        decoupler_forward(&d, x, y);
        decoupler_back(&d, y, x);
        char text[200] = "";
        for (unsigned i = 0; i < DECOUPLER_MAX; i++)
            snprintf(text + strlen(text), sizeof text - strlen(text), " %.5g %.5g",
                     (double)num_to_float(x[i]), (double)num_to_float(y[i]));
        says(number % 16 == 0, "%u %d %u %d %u %d%s", mask, err, worst_with, with, worst, without,
             text);
    }
}

static void all_is_as_it_was_kept(void)
{
    source.state = 20261122u;
    kept_open("reference/control_numbers.txt");
    controllers_do_as_they_did();
    two_positions_do_as_they_did();
    feedforwards_do_as_they_did();
    decouplers_do_as_they_did();
    kept_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(all_is_as_it_was_kept);
    return UNITY_END();
}
