/* Bounds by trying everything: the frame decoder from every state it can be in, on short inputs of the bytes that
 * matter and on every shape of group; rings and queues of small sizes from every position, across the wrap of
 * their counts at 2^32. What is proved instead, and how, stands in docs/inside/proofs.md.
 */
#include <stdlib.h>
#include <string.h>

#include "base/spsc.h"
#include "hal/ring.h"
#include "link/frame.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

#define GUARD 16

/* A decoder and a frame with bytes around them that nobody may touch. */
static struct {
    uint8_t before[GUARD];
    struct frame_decoder decoder;
    uint8_t between[GUARD];
    struct frame frame;
    uint8_t behind[GUARD];
} box;

static void close_box(void)
{
    memset(&box, 0x5A, sizeof box);
    frame_decoder_reset(&box.decoder);
}

static bool box_is_closed(void)
{
    for (unsigned i = 0; i < GUARD; i++)
        if (box.before[i] != 0x5A || box.between[i] != 0x5A || box.behind[i] != 0x5A)
            return false;
    return box.decoder.n < FRAME_WIRE_MAX;
}

/* With the induction hypothesis n < FRAME_WIRE_MAX, one more byte keeps it: every n, both flags, every byte. */
static void every_state_of_the_decoder_keeps_its_bounds_on_every_byte(void)
{
    for (unsigned n = 0; n < FRAME_WIRE_MAX; n++)
        for (unsigned overlong = 0; overlong < 2; overlong++)
            for (unsigned byte = 0; byte < 256; byte++)
                for (unsigned content = 1; content < 256; content += byte ? 127 : 1) {
                    close_box();
                    memset(box.decoder.buffer, (int)content, sizeof box.decoder.buffer);
                    box.decoder.n = (uint16_t)n;
                    box.decoder.overlong = overlong;
                    bool taken = frame_decode(&box.decoder, (uint8_t)byte, &box.frame);
                    TEST_ASSERT_TRUE(box_is_closed());
                    TEST_ASSERT_FALSE(taken && (byte != 0 || overlong));
                    TEST_ASSERT_TRUE(byte == 0 ? box.decoder.n == 0
                                               : box.decoder.n == n + (n < FRAME_WIRE_MAX - 1));
                }
}

/* Several bytes at once: up to the end of the buffer, around it and past it, with and without a delimiter behind. */
static void every_state_of_the_decoder_keeps_its_bounds_on_runs_around_its_end(void)
{
    static const int around[] = {-2, -1, 0, 1, 2, 40};
    static uint8_t run[FRAME_WIRE_MAX + 42];
    for (unsigned n = 0; n < FRAME_WIRE_MAX; n++)
        for (unsigned k = 0; k < 4 * sizeof around / sizeof around[0]; k++) {
            int length = (int)(FRAME_WIRE_MAX - 1 - n) + around[k / 4];
            bool delimited = k & 1u, overlong = k & 2u, delivered;
            if (length < 0)
                continue;
            memset(run, 1, sizeof run);
            run[length] = delimited ? 0 : 1;
            close_box();
            memset(box.decoder.buffer, 1, sizeof box.decoder.buffer);
            box.decoder.n = (uint16_t)n;
            box.decoder.overlong = overlong;
            size_t taken =
                frame_decode_bytes(&box.decoder, run, (size_t)length + 1, &box.frame, &delivered);
            TEST_ASSERT_TRUE(box_is_closed());
            TEST_ASSERT_FALSE(delivered);
            TEST_ASSERT_EQUAL((size_t)length + 1, taken);
            unsigned held = n + (unsigned)length + 1;
            if (held > FRAME_WIRE_MAX - 1)
                held = FRAME_WIRE_MAX - 1;
            TEST_ASSERT_EQUAL_UINT(delimited ? 0 : held, box.decoder.n);
            TEST_ASSERT_EQUAL(!delimited && (overlong || n + (unsigned)length + 1 > held),
                              box.decoder.overlong);
        }
}

/* All inputs of up to seven bytes of an alphabet that holds every kind of group length for them. */
static void every_short_input_keeps_the_bounds_and_makes_no_frame(void)
{
    static const uint8_t alphabet[] = {0, 1, 2, 3, 4, 7, 8, 255};
    for (unsigned length = 1; length <= 7; length++) {
        unsigned long inputs = 1;
        for (unsigned i = 0; i < length; i++)
            inputs *= sizeof alphabet;
        for (unsigned long k = 0; k < inputs; k++) {
            unsigned long rest = k;
            close_box();
            bool taken = false;
            for (unsigned i = 0; i < length; i++, rest /= sizeof alphabet)
                taken |= frame_decode(&box.decoder, alphabet[rest % sizeof alphabet], &box.frame);
            taken |= frame_decode(&box.decoder, 0, &box.frame);
            TEST_ASSERT_TRUE(box_is_closed());
            TEST_ASSERT_FALSE(taken); /* a frame has nine bytes */
        }
    }
}

/* Every length, every first and second group. */
static void every_pair_of_group_lengths_keeps_the_bounds(void)
{
    for (unsigned n = 1; n < FRAME_WIRE_MAX; n += n < 12 || n > 240 ? 1 : 19)
        for (unsigned first = 1; first < 256; first++)
            for (unsigned second = 1; second < 256; second++) {
                close_box();
                memset(box.decoder.buffer, 1, sizeof box.decoder.buffer);
                box.decoder.buffer[0] = (uint8_t)first;
                if (first < FRAME_WIRE_MAX)
                    box.decoder.buffer[first] = (uint8_t)second;
                box.decoder.n = (uint16_t)n;
                (void)frame_decode(&box.decoder, 0, &box.frame);
                TEST_ASSERT_TRUE(box_is_closed());
                if (first >= FRAME_WIRE_MAX)
                    break;
            }
}

/* Counts that are about to wrap, and others. */
static const uint32_t starts[] = {0, 1, 0x7FFFFFFEu, 0xFFFFFFF0u, 0xFFFFFFFEu, 0xFFFFFFFFu};

#define SIZE_MAX_TRIED 16u

static uint8_t room[GUARD + SIZE_MAX_TRIED + GUARD];

static struct ring ring_at(uint32_t size, uint32_t tail, uint32_t used)
{
    memset(room, 0x5A, sizeof room);
    for (uint32_t i = 0; i < used; i++)
        room[GUARD + ((tail + i) & (size - 1u))] = (uint8_t)(100u + i);
    return (struct ring){.bytes = room + GUARD, .size = size, .head = tail + used, .tail = tail};
}

static void check_ring(const struct ring *r, uint32_t used)
{
    TEST_ASSERT_EQUAL_UINT32(used, ring_used(r));
    TEST_ASSERT_EQUAL_UINT32(r->size - used, ring_room(r));
    for (unsigned i = 0; i < GUARD; i++)
        TEST_ASSERT_TRUE(room[i] == 0x5A && room[GUARD + r->size + i] == 0x5A);
}

static void try_ring(uint32_t size, uint32_t tail, uint32_t used)
{
    uint8_t out[SIZE_MAX_TRIED + 2], byte = 0;
    struct ring r = ring_at(size, tail, used);
    TEST_ASSERT_EQUAL(used < size, ring_put(&r, 77));
    check_ring(&r, used < size ? used + 1 : used);

    r = ring_at(size, tail, used);
    TEST_ASSERT_EQUAL(used > 0, ring_get(&r, &byte));
    TEST_ASSERT_TRUE(used == 0 || byte == 100);
    check_ring(&r, used ? used - 1 : 0);

    const uint8_t *run;
    r = ring_at(size, tail, used);
    size_t one_piece = ring_peek(&r, &run);
    TEST_ASSERT_TRUE(one_piece <= used && (one_piece > 0 || used == 0));
    TEST_ASSERT_TRUE(run >= r.bytes && run + one_piece <= r.bytes + size);
    for (size_t i = 0; i < one_piece; i++)
        TEST_ASSERT_EQUAL_UINT(100u + i, run[i]);
    ring_skip(&r, one_piece);
    check_ring(&r, used - (uint32_t)one_piece);

    for (uint32_t n = 0; n <= size + 1; n++) {
        static const uint8_t data[SIZE_MAX_TRIED + 2] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
        r = ring_at(size, tail, used);
        TEST_ASSERT_EQUAL(n <= size - used, ring_write(&r, data, n));
        check_ring(&r, n <= size - used ? used + n : used);
        for (uint32_t i = 0; i < used + n && n <= size - used; i++) {
            TEST_ASSERT_TRUE(ring_get(&r, &byte));
            TEST_ASSERT_EQUAL_UINT(i < used ? 100u + i : data[i - used], byte);
        }

        r = ring_at(size, tail, used);
        memset(out, 0, sizeof out);
        uint32_t got = (uint32_t)ring_read(&r, out, n);
        TEST_ASSERT_EQUAL_UINT32(n < used ? n : used, got);
        check_ring(&r, used - got);
        for (uint32_t i = 0; i < sizeof out; i++)
            TEST_ASSERT_EQUAL_UINT(i < got ? 100u + i : 0, out[i]);
    }
}

static void rings_keep_order_and_bounds_from_every_position_across_the_wrap(void)
{
    for (uint32_t size = 1; size <= SIZE_MAX_TRIED; size *= 2)
        for (unsigned k = 0; k < sizeof starts / sizeof starts[0]; k++)
            for (uint32_t offset = 0; offset < 2 * size; offset++)
                for (uint32_t used = 0; used <= size; used++)
                    try_ring(size, starts[k] + offset, used);
}

static void queues_keep_order_and_bounds_from_every_position_across_the_wrap(void)
{
    for (uint32_t size = 1; size <= SIZE_MAX_TRIED; size *= 2)
        for (unsigned k = 0; k < sizeof starts / sizeof starts[0]; k++)
            for (uint32_t offset = 0; offset < 2 * size; offset++) {
                struct spsc q;
                spsc_init(&q, size);
                uint32_t at = starts[k] + offset;
                atomic_store(&q.written, at);
                atomic_store(&q.read, at);
                for (uint32_t used = 0; used < size; used++) {
                    TEST_ASSERT_EQUAL(used > 0, spsc_can_read(&q));
                    TEST_ASSERT_TRUE(spsc_can_write(&q));
                    TEST_ASSERT_EQUAL_UINT32((at + used) % size, spsc_write_index(&q));
                    spsc_write_done(&q);
                    TEST_ASSERT_EQUAL_UINT32(used + 1, spsc_count(&q));
                }
                TEST_ASSERT_FALSE(spsc_can_write(&q));
                for (uint32_t taken = 0; taken < size; taken++) {
                    TEST_ASSERT_TRUE(spsc_can_read(&q));
                    TEST_ASSERT_EQUAL_UINT32((at + taken) % size, spsc_read_index(&q));
                    spsc_read_done(&q);
                }
                TEST_ASSERT_FALSE(spsc_can_read(&q));
            }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_state_of_the_decoder_keeps_its_bounds_on_every_byte);
    RUN_TEST(every_state_of_the_decoder_keeps_its_bounds_on_runs_around_its_end);
    RUN_TEST(every_short_input_keeps_the_bounds_and_makes_no_frame);
    RUN_TEST(every_pair_of_group_lengths_keeps_the_bounds);
    RUN_TEST(rings_keep_order_and_bounds_from_every_position_across_the_wrap);
    RUN_TEST(queues_keep_order_and_bounds_from_every_position_across_the_wrap);
    return UNITY_END();
}
