/* Real serial ports, through libserialport. */
#include "bench/transport.h"

#include <stdlib.h>
#include <string.h>

#include "bench/text.h"

#define BAUD_DEFAULT 115200

#if REFLUX_HAVE_LIBSERIALPORT
#include <libserialport.h>

static long serial_read(struct transport *t, void *buffer, size_t size)
{
    struct sp_port *port = t->context;
    int n = (int)sp_nonblocking_read(port, buffer, size);
    if (n > 0) {
        return n;
    }
    /* After a hang-up a read looks like silence; only this question tells. */
    if (n < 0 || sp_input_waiting(port) < 0) {
        return transport_lost(t, "the serial port is gone (unplugged?)");
    }
    return 0;
}

static long serial_write(struct transport *t, const void *data, size_t n)
{
    struct sp_port *port = t->context;
    int taken = (int)sp_nonblocking_write(port, data, n);
    return taken < 0 ? transport_lost(t, "the serial port is gone (unplugged?)") : taken;
}

static void serial_close(struct transport *t)
{
    struct sp_port *port = t->context;
    (void)sp_close(port);
    sp_free_port(port);
}

static const struct transport_ops serial_ops = {
    .read = serial_read, .write = serial_write, .close = serial_close};

static bool configure(struct sp_port *port, int baud)
{
    return sp_set_baudrate(port, baud) == SP_OK && sp_set_bits(port, 8) == SP_OK &&
           sp_set_parity(port, SP_PARITY_NONE) == SP_OK && sp_set_stopbits(port, 1) == SP_OK &&
           sp_set_flowcontrol(port, SP_FLOWCONTROL_NONE) == SP_OK &&
           sp_flush(port, SP_BUF_BOTH) == SP_OK;
}

static bool open_port(struct transport *t, const char *path, int baud, char *err, size_t err_size)
{
    struct sp_port *port = NULL;
    if (sp_get_port_by_name(path, &port) != SP_OK) {
        return sim_fail(err, err_size, "serial:%s: no such serial port", path);
    }
    if (sp_open(port, SP_MODE_READ_WRITE) != SP_OK) {
        char *reason = sp_last_error_message();
        (void)sim_fail(err, err_size, "serial:%s: cannot be opened: %s", path, reason);
        sp_free_error_message(reason);
        sp_free_port(port);
        return false;
    }
    int fd = -1;
    if (!configure(port, baud) || sp_get_port_handle(port, &fd) != SP_OK) {
        (void)sp_close(port);
        sp_free_port(port);
        return sim_fail(err, err_size, "serial:%s: does not take %d baud 8N1", path, baud);
    }
    t->context = port;
    t->fd = fd;
    t->ops = &serial_ops;
    return true;
}
#else
static bool open_port(struct transport *t, const char *path, int baud, char *err, size_t err_size)
{
    (void)t;
    (void)baud;
    return sim_fail(err, err_size, "serial:%s: this program was built without libserialport", path);
}
#endif

bool transport_open_serial(struct transport *t, const char *rest, char *err, size_t err_size)
{
    char path[128];
    uint64_t baud = BAUD_DEFAULT;
    const char *at = strrchr(rest, '@');
    size_t n = at != NULL ? (size_t)(at - rest) : strlen(rest);
    if (n == 0 || n >= sizeof(path)) {
        return sim_fail(err, err_size,
                        "serial:%s: expected serial:/dev/ttyX or serial:/dev/ttyX@BAUD", rest);
    }
    (void)memcpy(path, rest, n);
    path[n] = '\0';
    if (at != NULL && (!sim_parse_unsigned(at + 1, &baud) || baud < 1200 || baud > 4000000)) {
        return sim_fail(err, err_size, "serial:%s: the baud rate must be 1200 to 4000000", rest);
    }
    return open_port(t, path, (int)baud, err, err_size);
}
