/* A byte stream to the firmware, whatever carries it.
 *
 *     socket:PATH              unix stream socket, connected to; retried until somebody listens
 *     pty:PATH                 an existing pseudo-terminal, made raw
 *     newpty[:LINK]            a new pseudo-terminal; its name is printed, and LINK made to point to it
 *     serial:/dev/ttyX[@BAUD]  a real serial port, 8N1, through libserialport; 115200 unless told
 *     board:PATH               a virtual board's control socket, which carries both lines and the time
 *     PATH                     one of the first two or the last, by what the file is
 *     other schemes            added by transport_add_scheme(): the in-process firmware
 *
 * Rules
 *  1. Nobody spins: transport_wait() sleeps until bytes come, the peer goes, or the time is over.
 *  2. A vanished peer is noticed at the next read, write or wait: `gone` is set, with the reason.
 *  3. read() costs no system call when the last wait() saw nothing.
 */
#ifndef REFLUX_HOST_SIM_TRANSPORT_H
#define REFLUX_HOST_SIM_TRANSPORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct transport;

struct transport_ops {
    /* Bytes moved now, 0 = none now, negative = gone (reason written). */
    long (*read)(struct transport *t, void *buffer, size_t size);
    long (*write)(struct transport *t, const void *data, size_t n);
    /* Instead of a descriptor to wait on: lets the other side run until it has something to say, for so long at most or for a moment. */
    void (*turn)(struct transport *t, uint64_t timeout_ms);
    /* Milliseconds; NULL = this machine's monotonic clock. */
    uint64_t (*now_ms)(struct transport *t);
    void (*close)(struct transport *t);
    /* A fault of the hardware (virtual_board/fault_table.h); NULL: that hardware is real, or there is none. */
    bool (*fault)(struct transport *t, const char *name, double value);
    /* Of a board with wired pins (chips/wired.h): connects them (NULL: they are), gives a sensor its quantity, reads its loads. NULL: none. */
    bool (*wire)(struct transport *t, const char *wiring, uint64_t seed, char *err,
                 size_t err_size);
    void (*measure)(struct transport *t, const char *sensor, double value);
    /* A fault of what is wired, "T1.open" (chips/wiring.h). False: it cannot have it. */
    bool (*pins_fault)(struct transport *t, const char *name, double value);
    bool (*loads)(struct transport *t, double *ns, size_t n);
    /* The board's time, ns, and where in it the firmware's clock was 0. */
    void (*clock)(struct transport *t, uint64_t *now_ns, uint64_t *began_ns);
    /* Time does not go beyond this; 0: it may. NULL: it goes in whole milliseconds. */
    void (*limit)(struct transport *t, uint64_t ns);
};

struct transport {
    const struct transport_ops *ops;
    void *context;
    int fd;       /* what poll() waits on; -1 = none, then ops->turn is there */
    int spare_fd; /* newpty: our own hold on the far end until the peer has come; -1 = none */
    bool ready;   /* the last wait saw something to read */
    bool gone;    /* the peer has vanished */
    bool waiting; /* that it is not there yet has been said */
    uint64_t patience_ms;
    char reason[128];
    char where[160]; /* as opened, for messages */
    char link[160];  /* newpty: the symbolic link to remove at the end */
    uint64_t bytes_read, bytes_written;
};

typedef bool (*transport_opener)(struct transport *t, const char *rest, char *err, size_t err_size);

/* Makes "SCHEME" and "SCHEME:rest" known to transport_open(). One extra scheme at a time. */
void transport_add_scheme(const char *scheme, transport_opener open);

/* Opens; a path or listener that is not there yet is waited for up to patience_ms, and stderr says so. */
bool transport_open(struct transport *t, const char *where, uint64_t patience_ms, char *err,
                    size_t err_size);
void transport_close(struct transport *t);

/* Takes what has arrived, up to size bytes; 0 when there is nothing or the peer is gone (see gone). */
size_t transport_read(struct transport *t, void *buffer, size_t size);

/* Writes everything, waiting for room if need be; false when the peer is gone or takes nothing for 2 s. */
bool transport_write(struct transport *t, const void *data, size_t n);

/* Waits until one of the n transports has something to read or is gone, at most timeout_ms. */
void transport_wait(struct transport *const *list, size_t n, uint64_t timeout_ms);

uint64_t transport_now_ms(struct transport *t);

/* Returns whether the other end keeps the time, as a virtual board does. */
bool transport_keeps_time(const struct transport *t);

/* Has what is at the other end have that fault; false: it cannot. */
bool transport_fault(struct transport *t, const char *name, double value);

/* Likewise a fault of what is wired to its pins, "T1.open". */
bool transport_pins_fault(struct transport *t, const char *name, double value);

/* For the implementations: marks the peer as gone and returns -1. */
long transport_lost(struct transport *t, const char *reason);

/* transport_serial.c */
bool transport_open_serial(struct transport *t, const char *rest, char *err, size_t err_size);

#endif
