/* Frames: published checksum vectors, round trips, and every kind of damage a line can do. */
#include <stdio.h>
#include <string.h>

#include "base/crc32.h"
#include "link/frame.h"
#include "random_source.h"
#include "unity.h"

#define SEED 20240611u

void setUp(void) {}

void tearDown(void) {}

static struct frame frame_of(uint8_t type, uint16_t sequence, size_t n)
{
    struct frame f = {.type = type, .sequence = sequence, .n = (uint8_t)n};
    struct random_source r = {SEED + type};
    for (size_t i = 0; i < n; i++) {
        /* Half of the bytes are zeros: stuffing has work to do. */
        uint64_t x = random_next(&r);
        f.payload[i] = (x & 1u) != 0 ? 0 : (uint8_t)(x >> 8);
    }
    return f;
}

static void assert_same(const struct frame *a, const struct frame *b)
{
    TEST_ASSERT_EQUAL_UINT8(a->type, b->type);
    TEST_ASSERT_EQUAL_UINT16(a->sequence, b->sequence);
    TEST_ASSERT_EQUAL_UINT8(a->n, b->n);
    if (a->n > 0) {
        TEST_ASSERT_EQUAL_UINT8_ARRAY(a->payload, b->payload, a->n);
    }
}

/* Feeds all bytes; returns how many frames came out, the last one in *f. */
static unsigned feed(struct frame_decoder *d, const uint8_t *bytes, size_t n, struct frame *f)
{
    unsigned frames = 0;
    for (size_t i = 0; i < n; i++) {
        frames += frame_decode(d, bytes[i], f) ? 1u : 0u;
    }
    return frames;
}

static void crc32_gives_the_published_check_values(void)
{
    TEST_ASSERT_EQUAL_HEX32(0xCBF43926u, crc32_update(0, "123456789", 9));
    TEST_ASSERT_EQUAL_HEX32(0x00000000u, crc32_update(0, "", 0));
    TEST_ASSERT_EQUAL_HEX32(0xE8B7BE43u, crc32_update(0, "a", 1));
    TEST_ASSERT_EQUAL_HEX32(0x352441C2u, crc32_update(0, "abc", 3));
    TEST_ASSERT_EQUAL_HEX32(0x414FA339u,
                            crc32_update(0, "The quick brown fox jumps over the lazy dog", 43));
    /* Ethernet / RFC 3720 style patterns: 32 bytes of 0x00 and of 0xFF. */
    uint8_t block[32];
    memset(block, 0x00, sizeof(block));
    TEST_ASSERT_EQUAL_HEX32(0x190A55ADu, crc32_update(0, block, sizeof(block)));
    memset(block, 0xFF, sizeof(block));
    TEST_ASSERT_EQUAL_HEX32(0xFF6CAB0Bu, crc32_update(0, block, sizeof(block)));
}

static void crc32_can_be_continued_over_parts(void)
{
    const char *text = "123456789";
    for (size_t cut = 0; cut <= 9; cut++) {
        uint32_t crc = crc32_update(crc32_update(0, text, cut), text + cut, 9 - cut);
        TEST_ASSERT_EQUAL_HEX32(0xCBF43926u, crc);
    }
}

static void every_payload_length_makes_the_round_trip(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    uint8_t wire[FRAME_WIRE_MAX];
    for (unsigned n = 0; n <= FRAME_PAYLOAD_MAX; n++) {
        struct frame sent = frame_of((uint8_t)n, (uint16_t)(n * 257u), n);
        size_t size = frame_encode(&sent, wire);
        TEST_ASSERT_EQUAL_size_t(n + 9u, size); /* 3 header, 4 checksum, 1 overhead, 1 delimiter */
        struct frame got = {0};
        TEST_ASSERT_EQUAL_UINT(1, feed(&d, wire, size, &got));
        assert_same(&sent, &got);
    }
    TEST_ASSERT_EQUAL_UINT32(FRAME_PAYLOAD_MAX + 1u, d.count.good);
    TEST_ASSERT_EQUAL_UINT32(0, d.count.bad_crc + d.count.malformed + d.count.overlong);
}

static void payloads_without_zeros_and_of_zeros_only_make_the_round_trip(void)
{
    for (unsigned fill = 0; fill < 256; fill += 255) {
        struct frame sent = {.type = 0xFF, .sequence = 0xFFFF, .n = FRAME_PAYLOAD_MAX};
        memset(sent.payload, (int)fill, sizeof(sent.payload));
        uint8_t wire[FRAME_WIRE_MAX];
        size_t size = frame_encode(&sent, wire);
        TEST_ASSERT_EQUAL_size_t(FRAME_WIRE_MAX, size);
        struct frame_decoder d;
        frame_decoder_reset(&d);
        struct frame got;
        TEST_ASSERT_EQUAL_UINT(1, feed(&d, wire, size, &got));
        assert_same(&sent, &got);
    }
}

static void the_wire_holds_no_zero_but_the_last_byte(void)
{
    uint8_t wire[FRAME_WIRE_MAX];
    for (unsigned n = 0; n <= FRAME_PAYLOAD_MAX; n += 7) {
        struct frame sent = frame_of(6, 0, n);
        size_t size = frame_encode(&sent, wire);
        TEST_ASSERT_NULL(memchr(wire, 0, size - 1));
        TEST_ASSERT_EQUAL_UINT8(0, wire[size - 1]);
    }
}

static void a_payload_that_is_too_long_is_not_encoded(void)
{
    struct frame f = {.type = 1, .n = FRAME_PAYLOAD_MAX + 1};
    uint8_t wire[FRAME_WIRE_MAX] = {0xAA};
    TEST_ASSERT_EQUAL_size_t(0, frame_encode(&f, wire));
    TEST_ASSERT_EQUAL_UINT8(0xAA, wire[0]);
}

static const size_t damaged_lengths[] = {0, 1, 14, 36, 42};

static void every_single_flipped_bit_is_refused(void)
{
    for (size_t k = 0; k < sizeof(damaged_lengths) / sizeof(damaged_lengths[0]); k++) {
        struct frame sent = frame_of((uint8_t)(k + 1), 300, damaged_lengths[k]);
        uint8_t wire[FRAME_WIRE_MAX];
        size_t size = frame_encode(&sent, wire);
        for (size_t bit = 0; bit < size * 8; bit++) {
            struct frame_decoder d;
            frame_decoder_reset(&d);
            struct frame got = {0};
            wire[bit / 8] ^= (uint8_t)(1u << (bit % 8));
            TEST_ASSERT_EQUAL_UINT_MESSAGE(0, feed(&d, wire, size, &got), "damaged frame taken");
            wire[bit / 8] ^= (uint8_t)(1u << (bit % 8));
        }
    }
}

static void every_pair_of_flipped_bits_is_refused(void)
{
    for (size_t k = 0; k < sizeof(damaged_lengths) / sizeof(damaged_lengths[0]); k++) {
        struct frame sent = frame_of((uint8_t)(k + 1), 300, damaged_lengths[k]);
        uint8_t wire[FRAME_WIRE_MAX];
        size_t size = frame_encode(&sent, wire);
        for (size_t a = 0; a < size * 8; a++) {
            wire[a / 8] ^= (uint8_t)(1u << (a % 8));
            for (size_t b = 0; b < a; b++) {
                struct frame_decoder d;
                frame_decoder_reset(&d);
                struct frame got = {0};
                wire[b / 8] ^= (uint8_t)(1u << (b % 8));
                TEST_ASSERT_EQUAL_UINT_MESSAGE(0, feed(&d, wire, size, &got),
                                               "damaged frame taken");
                wire[b / 8] ^= (uint8_t)(1u << (b % 8));
            }
            wire[a / 8] ^= (uint8_t)(1u << (a % 8));
        }
    }
}

static void every_truncation_is_refused_and_the_next_frame_is_taken(void)
{
    for (size_t k = 0; k < sizeof(damaged_lengths) / sizeof(damaged_lengths[0]); k++) {
        struct frame sent = frame_of((uint8_t)(k + 1), 7, damaged_lengths[k]);
        uint8_t wire[FRAME_WIRE_MAX];
        size_t size = frame_encode(&sent, wire);
        for (size_t cut = 0; cut < size - 1; cut++) {
            struct frame_decoder d;
            frame_decoder_reset(&d);
            struct frame got = {0};
            TEST_ASSERT_EQUAL_UINT(0, feed(&d, wire, cut, &got));
            TEST_ASSERT_FALSE(frame_decode(&d, 0, &got)); /* the delimiter of the short piece */
            TEST_ASSERT_EQUAL_UINT(1, feed(&d, wire, size, &got));
            assert_same(&sent, &got);
        }
        for (size_t cut = 1; cut < size - 1; cut++) { /* the head is missing */
            struct frame_decoder d;
            frame_decoder_reset(&d);
            struct frame got = {0};
            TEST_ASSERT_EQUAL_UINT(0, feed(&d, wire + cut, size - cut, &got));
        }
    }
}

static void a_refused_frame_leaves_the_callers_frame_alone(void)
{
    struct frame sent = frame_of(3, 9, 20);
    uint8_t wire[FRAME_WIRE_MAX];
    size_t size = frame_encode(&sent, wire);
    wire[size / 2] ^= 0x10;
    struct frame got = {.type = 0x77, .sequence = 0x1234, .n = 1, .payload = {0x55}};
    struct frame_decoder d;
    frame_decoder_reset(&d);
    TEST_ASSERT_EQUAL_UINT(0, feed(&d, wire, size, &got));
    TEST_ASSERT_EQUAL_UINT8(0x77, got.type);
    TEST_ASSERT_EQUAL_UINT16(0x1234, got.sequence);
    TEST_ASSERT_EQUAL_UINT8(0x55, got.payload[0]);
}

static void two_million_random_bytes_are_survived_and_give_no_frame(void)
{
    printf("random garbage, seed %u\n", SEED);
    struct random_source r = {SEED};
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    unsigned frames = 0;
    for (unsigned i = 0; i < 2000000u; i++) {
        frames += frame_decode(&d, (uint8_t)random_next(&r), &got) ? 1u : 0u;
    }
    /* About 7800 pieces with a 32-bit checksum: a chance of two in a million for one to pass. */
    TEST_ASSERT_EQUAL_UINT(0, frames);
    TEST_ASSERT_EQUAL_UINT32(0, d.count.good);
    TEST_ASSERT_GREATER_THAN_UINT32(1000, d.count.malformed);
    TEST_ASSERT_GREATER_THAN_UINT32(1000, d.count.overlong);
}

static void after_any_garbage_the_second_good_frame_is_taken_at_the_latest(void)
{
    printf("resynchronisation, seed %u\n", SEED);
    struct random_source r = {SEED};
    struct frame sent = frame_of(5, 1000, 30);
    uint8_t wire[FRAME_WIRE_MAX];
    size_t size = frame_encode(&sent, wire);
    unsigned first = 0;
    for (unsigned round = 0; round < 5000; round++) {
        struct frame_decoder d;
        frame_decoder_reset(&d);
        struct frame got = {0};
        uint32_t garbage = random_below(&r, 600);
        for (uint32_t i = 0; i < garbage; i++) {
            (void)frame_decode(&d, (uint8_t)random_next(&r), &got);
        }
        first += feed(&d, wire, size, &got);
        TEST_ASSERT_EQUAL_UINT(1, feed(&d, wire, size, &got));
        assert_same(&sent, &got);
    }
    printf("the first good frame after garbage was taken in %u of 5000 rounds\n", first);
}

static void an_overlong_run_is_skipped_and_counted_once(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    for (unsigned i = 0; i < 100000; i++) {
        TEST_ASSERT_FALSE(frame_decode(&d, 0x01, &got));
    }
    TEST_ASSERT_FALSE(frame_decode(&d, 0, &got));
    TEST_ASSERT_EQUAL_UINT32(1, d.count.overlong);
    struct frame sent = frame_of(2, 2, 5);
    uint8_t wire[FRAME_WIRE_MAX];
    size_t size = frame_encode(&sent, wire);
    TEST_ASSERT_EQUAL_UINT(1, feed(&d, wire, size, &got));
    assert_same(&sent, &got);
}

static void a_piece_one_byte_longer_than_the_longest_frame_is_overlong(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    for (unsigned i = 0; i < FRAME_WIRE_MAX; i++) {
        (void)frame_decode(&d, 1, &got);
    }
    (void)frame_decode(&d, 0, &got);
    TEST_ASSERT_EQUAL_UINT32(1, d.count.overlong);
    TEST_ASSERT_EQUAL_UINT32(0, d.count.malformed);
}

static void delimiters_in_a_row_are_harmless_and_not_counted(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    for (unsigned i = 0; i < 1000; i++) {
        TEST_ASSERT_FALSE(frame_decode(&d, 0, &got));
    }
    TEST_ASSERT_EQUAL_UINT32(0, d.count.malformed + d.count.overlong + d.count.bad_crc);
}

/* Appends up to `most` bytes of what a line may bring: frames, damaged ones, pieces, delimiters, noise without end. */
static size_t put_anything(uint8_t *line, size_t most, struct random_source *r)
{
    uint8_t wire[FRAME_WIRE_MAX];
    struct frame f = frame_of((uint8_t)random_next(r), (uint16_t)random_next(r),
                              random_below(r, FRAME_PAYLOAD_MAX + 1));
    size_t size = frame_encode(&f, wire);
    switch (random_below(r, 6)) {
    case 0:
        wire[random_below(r, (uint32_t)size)] ^= (uint8_t)(1u << random_below(r, 8));
        break;
    case 1:
        size = random_below(r, (uint32_t)size);
        break;
    case 2:
        memset(wire, 0, size = 3);
        break;
    case 3:
        memset(wire, 0x2A, size = sizeof wire);
        break;
    default:
        break;
    }
    if (size > most) {
        size = most;
    }
    memcpy(line, wire, size);
    return size;
}

static void the_line_in_pieces_of_any_size_gives_the_frames_of_single_bytes(void)
{
    static uint8_t line[20000];
    size_t n = 0;
    struct random_source r = {SEED + 1};
    printf("line in pieces, seed %u\n", SEED + 1);
    while (n < sizeof line) {
        n += put_anything(line + n, sizeof line - n, &r);
    }
    for (size_t most = 1; most <= FRAME_WIRE_MAX + 3; most = most < 12 ? most + 1 : most + 17) {
        struct frame_decoder whole, pieces;
        frame_decoder_reset(&whole);
        frame_decoder_reset(&pieces);
        for (size_t from = 0; from < n;) {
            struct frame one = {0}, other = {0};
            bool delivered;
            size_t size = n - from < most ? n - from : most;
            size_t taken = frame_decode_bytes(&pieces, line + from, size, &other, &delivered);
            TEST_ASSERT_TRUE(taken > 0 && taken <= size);
            TEST_ASSERT_TRUE(taken == size || line[from + taken - 1] == 0);
            TEST_ASSERT_EQUAL(delivered ? 1 : 0, feed(&whole, line + from, taken, &one));
            assert_same(&one, &other);
            TEST_ASSERT_EQUAL_UINT16(whole.n, pieces.n);
            TEST_ASSERT_EQUAL(whole.overlong, pieces.overlong);
            TEST_ASSERT_EQUAL_MEMORY(&whole.count, &pieces.count, sizeof whole.count);
            from += taken;
        }
        TEST_ASSERT_GREATER_THAN_UINT32(20, pieces.count.good);
        TEST_ASSERT_GREATER_THAN_UINT32(5, pieces.count.bad_crc);
        TEST_ASSERT_GREATER_THAN_UINT32(5, pieces.count.malformed);
        TEST_ASSERT_GREATER_THAN_UINT32(5, pieces.count.overlong);
    }
}

static void no_bytes_are_no_frame_and_change_nothing(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    uint8_t byte = 0;
    bool delivered = true;
    TEST_ASSERT_EQUAL_UINT(0, feed(&d, (const uint8_t *)"abc", 3, &got));
    TEST_ASSERT_EQUAL_size_t(0, frame_decode_bytes(&d, &byte, 0, &got, &delivered));
    TEST_ASSERT_FALSE(delivered);
    TEST_ASSERT_EQUAL_UINT16(3, d.n);
}

static void damage_is_counted_by_kind(void)
{
    struct frame_decoder d;
    frame_decoder_reset(&d);
    struct frame got = {0};
    const uint8_t impossible[] = {0x09, 0x01, 0x00};            /* group longer than the piece */
    const uint8_t too_short[] = {0x04, 0x01, 0x01, 0x01, 0x00}; /* three bytes of body */
    TEST_ASSERT_EQUAL_UINT(0, feed(&d, impossible, sizeof(impossible), &got));
    TEST_ASSERT_EQUAL_UINT(0, feed(&d, too_short, sizeof(too_short), &got));
    TEST_ASSERT_EQUAL_UINT32(2, d.count.malformed);
    uint8_t wire[FRAME_WIRE_MAX];
    struct frame sent = {.type = 7, .sequence = 0x0101, .n = 0};
    size_t size = frame_encode(&sent, wire);
    wire[1] ^= 0x40;
    TEST_ASSERT_EQUAL_UINT(0, feed(&d, wire, size, &got));
    TEST_ASSERT_EQUAL_UINT32(1, d.count.bad_crc);
    frame_decoder_reset(&d);
    TEST_ASSERT_EQUAL_UINT32(0, d.count.malformed + d.count.bad_crc);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(crc32_gives_the_published_check_values);
    RUN_TEST(crc32_can_be_continued_over_parts);
    RUN_TEST(every_payload_length_makes_the_round_trip);
    RUN_TEST(payloads_without_zeros_and_of_zeros_only_make_the_round_trip);
    RUN_TEST(the_wire_holds_no_zero_but_the_last_byte);
    RUN_TEST(a_payload_that_is_too_long_is_not_encoded);
    RUN_TEST(every_single_flipped_bit_is_refused);
    RUN_TEST(every_pair_of_flipped_bits_is_refused);
    RUN_TEST(every_truncation_is_refused_and_the_next_frame_is_taken);
    RUN_TEST(a_refused_frame_leaves_the_callers_frame_alone);
    RUN_TEST(two_million_random_bytes_are_survived_and_give_no_frame);
    RUN_TEST(after_any_garbage_the_second_good_frame_is_taken_at_the_latest);
    RUN_TEST(an_overlong_run_is_skipped_and_counted_once);
    RUN_TEST(a_piece_one_byte_longer_than_the_longest_frame_is_overlong);
    RUN_TEST(delimiters_in_a_row_are_harmless_and_not_counted);
    RUN_TEST(the_line_in_pieces_of_any_size_gives_the_frames_of_single_bytes);
    RUN_TEST(no_bytes_are_no_frame_and_change_nothing);
    RUN_TEST(damage_is_counted_by_kind);
    return UNITY_END();
}
