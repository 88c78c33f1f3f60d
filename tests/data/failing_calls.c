/* Calls on files below a folder that fail as those of a full or broken disk, preloaded before the C library.
 *
 * FAILING_BELOW   the folder, as the system names it
 * FAILING_FIRST   the number, from 1, of the first call that fails
 * FAILING_LAST    that of the last one
 * FAILING_WAITS   or: fsync waits for as long as this file exists
 * FAILING_SIGNAL  or: the process sends itself this signal after call FAILING_FIRST, or, where some fail, after the one
 *                 that follows FAILING_LAST
 * FAILING_CALL    counted are calls of this name alone
 * FAILING_NAME    and on files whose path has this in it
 * FAILING_LOG     gets a line for every call that failed or waits, and with FAILING_LISTS for every call that is counted:
 *                 its name, and the file
 *
 * Counted are opening for writing, write, writev, pwrite, fsync, fdatasync, ftruncate, rename and unlink. Where several
 * fail, unlink works: it needs no room.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long calls;
static _Thread_local int signal_is_due;

static long number(const char *name) {
    const char *text = getenv(name);
    return text ? atol(text) : 0;
}

static int is_below(const char *path) {
    const char *folder = getenv("FAILING_BELOW");
    size_t length = folder ? strlen(folder) : 0;
    return length && !strncmp(path, folder, length) && (path[length] == '/' || !path[length]);
}

/* Straight from the kernel: the log is no file that is watched. */
static void note(const char *call, const char *path) {
    const char *log = getenv("FAILING_LOG");
    char line[PATH_MAX + 32];
    int length = snprintf(line, sizeof line, "%s %s\n", call, path);
    long file = log ? syscall(SYS_openat, AT_FDCWD, log, O_WRONLY | O_CREAT | O_APPEND, 0600) : -1;
    if (file >= 0) {
        syscall(SYS_write, file, line, (size_t)length);
        syscall(SYS_close, file);
    }
}

static int fails_at(const char *call, const char *path) {
    long first = number("FAILING_FIRST"), last = number("FAILING_LAST");
    const char *name = getenv("FAILING_CALL"), *part = getenv("FAILING_NAME");
    int removes = !strcmp(call, "unlink");
    if (!is_below(path) || getenv("FAILING_WAITS")) return 0;
    if ((name && strcmp(call, name)) || (part && !strstr(path, part))) return 0;
    long call_number = 1 + atomic_fetch_add(&calls, 1);
    if (getenv("FAILING_SIGNAL") && call_number == (last < first ? first : last + 1)) signal_is_due = 1;
    if (getenv("FAILING_LISTS")) note(call, path);
    if (call_number < first || call_number > last || (removes && last > first)) return 0;
    note(call, path);
    errno = ENOSPC;
    return 1;
}

/* What a call returned, after the signal that is due. */
static long after(long returned) {
    int saved = errno;
    if (signal_is_due) {
        signal_is_due = 0;
        kill(getpid(), (int)number("FAILING_SIGNAL"));
    }
    errno = saved;
    return returned;
}

static void waits(int file) {
    const char *flag = getenv("FAILING_WAITS");
    char link[64], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = flag ? readlink(link, path, sizeof path - 1) : -1;
    if (length < 0) return;
    path[length] = 0;
    if (!is_below(path)) return;
    note("fsync", path);
    while (!syscall(SYS_faccessat, AT_FDCWD, flag, F_OK)) usleep(1000);
}

static int fails(const char *call, const char *path) {
    char whole[PATH_MAX];
    int saved = errno;
    if (path[0] != '/') {
        char folder[PATH_MAX];
        if (!getcwd(folder, sizeof folder)) return 0;
        if (snprintf(whole, sizeof whole, "%s/%s", folder, path) >= (int)sizeof whole) return 0;
        path = whole;
    }
    int failed = fails_at(call, path);
    if (!failed) errno = saved;
    return failed;
}

static int fails_on(const char *call, int file) {
    char link[64], path[PATH_MAX];
    int saved = errno;
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = file > 2 ? readlink(link, path, sizeof path - 1) : -1;
    errno = saved;
    if (length < 0) return 0;
    path[length] = 0;
    return fails_at(call, path);
}

#define NEXT(type, name, ...) \
    static type (*next)(__VA_ARGS__); \
    if (!next) next = (type (*)(__VA_ARGS__))dlsym(RTLD_NEXT, name)

#define OPEN(name) \
    int name(const char *path, int flags, ...) { \
        NEXT(int, #name, const char *, int, ...); \
        va_list more; \
        va_start(more, flags); \
        mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0; \
        va_end(more); \
        return (flags & O_ACCMODE) != O_RDONLY && fails("open", path) ? -1 : after(next(path, flags, mode)); \
    }

OPEN(open)
OPEN(open64)

ssize_t write(int file, const void *bytes, size_t count) {
    NEXT(ssize_t, "write", int, const void *, size_t);
    return fails_on("write", file) ? -1 : after(next(file, bytes, count));
}

ssize_t writev(int file, const struct iovec *parts, int count) {
    NEXT(ssize_t, "writev", int, const struct iovec *, int);
    return fails_on("writev", file) ? -1 : after(next(file, parts, count));
}

ssize_t pwrite64(int file, const void *bytes, size_t count, off64_t at) {
    NEXT(ssize_t, "pwrite64", int, const void *, size_t, off64_t);
    return fails_on("pwrite", file) ? -1 : after(next(file, bytes, count, at));
}

/* Flushing goes no further: what a process has written stays when it ends, however it ends, and disks are slow. */
int fsync(int file) {
    waits(file);
    return fails_on("fsync", file) ? -1 : (int)after(0);
}

int fdatasync(int file) {
    return fails_on("fdatasync", file) ? -1 : (int)after(0);
}

int ftruncate64(int file, off64_t length) {
    NEXT(int, "ftruncate64", int, off64_t);
    return fails_on("ftruncate", file) ? -1 : after(next(file, length));
}

int rename(const char *from, const char *to) {
    NEXT(int, "rename", const char *, const char *);
    return fails("rename", to) ? -1 : after(next(from, to));
}

int unlink(const char *path) {
    NEXT(int, "unlink", const char *);
    return fails("unlink", path) ? -1 : after(next(path));
}
