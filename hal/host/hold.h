/* Locks on what only one process may use: a flash file, a pseudo-terminal. The kernel drops them with the process,
 * however it ends. They do not disturb flock(), which terminal programs use. */
#ifndef REFLUX_HAL_HOST_HOLD_H
#define REFLUX_HAL_HOST_HOLD_H

#include <stdbool.h>
#include <stddef.h>

/* Locks the file for this process until it closes any descriptor of that file. False with errno: EACCES where another
 * process has it, whose number and name are then in who. */
bool hold_take(int fd, char *who, size_t size);
/* Returns whether another process has the lock, with its number and name in who. */
bool hold_is_taken(int fd, char *who, size_t size);

#endif
