#include "hold.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static void name_process(pid_t pid, char *who, size_t size)
{
    char path[40], name[20] = "";
    (void)snprintf(path, sizeof path, "/proc/%ld/comm", (long)pid);
    FILE *file = fopen(path, "re");
    if (file) {
        if (!fgets(name, sizeof name, file))
            name[0] = '\0';
        (void)fclose(file);
    }
    name[strcspn(name, "\n")] = '\0';
    if (pid <= 0) /* of another container: it has no number here */
        (void)snprintf(who, size, "another process");
    else
        (void)snprintf(who, size, name[0] ? "process %ld (%s)" : "process %ld", (long)pid, name);
}

bool hold_is_taken(int fd, char *who, size_t size)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    if (fcntl(fd, F_GETLK, &lock) != 0 || lock.l_type == F_UNLCK)
        return false;
    name_process(lock.l_pid, who, size);
    return true;
}

bool hold_take(int fd, char *who, size_t size)
{
    struct flock lock = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    (void)snprintf(who, size,
                   "another process"); /* one that has ended by the time it is looked up */
    if (fcntl(fd, F_SETLK, &lock) == 0)
        return true;
    int reason = errno == EAGAIN ? EACCES : errno;
    (void)hold_is_taken(fd, who, size);
    errno = reason;
    return false;
}
