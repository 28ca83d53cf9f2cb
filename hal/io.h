/* The plant as the firmware sees it: a named set of measurements and manipulated variables, complete
 * samples with plant time, and commands. The plant link is the first implementation (io/plant_link.h);
 * a board's own analogue, pulse, digital and time-proportioned inputs and outputs are another.
 *
 * Rules
 *  1. Values here are engineering units; the channel map in supervise turns them into fractions of span.
 *  2. A sample is complete or absent: never half of one.
 *  3. Plant time is 64-bit milliseconds and comes with the sample. With real inputs the port stamps samples
 *     from the board's timer.
 *  4. All functions are called from the tick context and do not wait.
 *     The caller may have to let a sample wait for work that is due (base/job.h). It goes on calling poll(), so that the
 *     other side is not taken for silent: a plant that waits for its command sends nothing new, or the same number again.
 *     Another number shows that this plant does not wait, and then neither does the sample.
 *  5. A reading that does not come is asked for again by the port itself, from poll() to poll(), until it has come
 *     or IO_READ_TIMEOUT_MS of the board's clock (or half a tick, if that is shorter) have passed since the sample
 *     was due. Then the sample is complete without it: QUALITY_MISSING, and supervise falls back as declared. On
 *     the plant link the plant does that on its side: there is no message to ask for a sample again, an unanswered
 *     one is repeated by the plant, and tick.timeout watches for samples that do not come at all.
 */
#ifndef REFLUX_HAL_IO_H
#define REFLUX_HAL_IO_H

#include <stdbool.h>
#include <stdint.h>

#include "base/channel.h"
#include "base/error.h"

typedef uint64_t plant_time_ms;

#define IO_READ_TIMEOUT_MS 1500 /* rule 5 */

#ifndef IO_CHANNELS_MAX
#define IO_CHANNELS_MAX                                                                            \
    16 /* of each kind a plant may have; the configuration names at most CHANNEL_MAX of them */
#endif

struct io_channel {
    const char *name, *unit; /* the implementation's; good until the table changes */
    float safe;              /* manipulated variables: value on silence */
    float lo, hi;            /* span; both 0 where the board does not keep it */
};

struct io_reading {
    float value;
    enum quality quality;
};

struct io_sample {
    uint32_t number;    /* counts samples; a gap is a lost sample */
    plant_time_ms time; /* plant time of the sample */
    uint32_t reception; /* counts of hal_cycles() that taking it from the line cost */
    uint8_t n_measurements, n_readback; /* n_readback: 0 or the number of manipulated variables */
    struct io_reading measurement[IO_CHANNELS_MAX];
    /* applied value of the interval before this sample */
    struct io_reading readback[IO_CHANNELS_MAX];
};

struct io_command {
    uint32_t number; /* the sample it answers */
    plant_time_ms time;
    bool safe; /* the firmware is in its safe state */
    uint8_t n_outputs;
    struct {
        float value;
        bool drive; /* false: nobody commands this one, the plant keeps its own value */
    } output[IO_CHANNELS_MAX];
};

enum io_state {
    IO_DOWN,     /* nobody there */
    IO_GREETING, /* exchanging capabilities */
    IO_READY     /* channel table complete, samples flow */
};

/* An implementation fills in this table; context is its own. */
struct io_port {
    void *context;
    /* Looks for input. Fills *sample and returns true when a complete one is there; call until false. */
    bool (*poll)(void *context, uint64_t now_ms, struct io_sample *sample);
    enum io_state (*state)(const void *context);
    /* Rises by one whenever the channel table may have changed (new plant, restarted plant). */
    uint32_t (*generation)(const void *context);
    uint8_t (*count)(const void *context, bool manipulated);
    /* index < count. */
    struct io_channel (*channel)(const void *context, bool manipulated, uint8_t index);
    /* Interval of the samples in plant time, ms, as the plant announces it. */
    uint32_t (*tick_ms)(const void *context);
    /* Sends a command. ERR_STATE when nobody is there, ERR_FULL when the line is congested. */
    enum err (*command)(void *context, const struct io_command *command, uint64_t now_ms);
};

#endif
