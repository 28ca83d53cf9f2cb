/* Options of the host board, and its life from main()'s point of view. */
#ifndef REFLUX_HAL_HOST_PORT_H
#define REFLUX_HAL_HOST_PORT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct host_port_options {
    const char *console, *link; /* as line_open() takes them */
    const char *nvm;            /* file that is the flash; NULL = memory, lost at the end */
    uint32_t boot_id;
    bool watchdog; /* hal_watchdog_start() finds one; else this board has none */
};

bool host_port_open(const struct host_port_options *options, char *err, size_t err_size);
void host_port_run(void);  /* until host_port_stop() */
void host_port_stop(void); /* callable from a signal handler */
void host_port_close(void);

#endif
