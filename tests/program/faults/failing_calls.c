/* Preloaded into a rank: makes calls of the system fail, as a full disk or a bad sector does.
 *   FAULT_CALL   write or read, in all their forms; sync, cut (ftruncate), rename, or open
 *   FAULT_PATH   only on files whose path contains this text
 *   FAULT_FROM   the first such call that fails, from 1; all after it fail too, or FAULT_COUNT of them
 *   FAULT_ERROR  the number of the error: 28 no space left, 5 input/output error; 0: the process is killed instead
 *   FAULT_RANK   only on this rank, of Open MPI or MPICH
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
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static atomic_long seen;

static long number(const char *name, long otherwise) {
    const char *text = getenv(name);
    return text ? atol(text) : otherwise;
}

static int is_wanted(const char *call) {
    const char *wanted = getenv("FAULT_CALL");
    const char *rank = getenv("OMPI_COMM_WORLD_RANK"), *only = getenv("FAULT_RANK");
    if (!rank) rank = getenv("PMI_RANK");
    return wanted && !strcmp(wanted, call) && (!only || !strcmp(only, rank ? rank : "0"));
}

static int path_must_fail(const char *call, const char *path) {
    const char *part = getenv("FAULT_PATH");
    if (!is_wanted(call) || !part || !path || !strstr(path, part)) return 0;
    long now = atomic_fetch_add(&seen, 1) + 1, first = number("FAULT_FROM", 1);
    if (now < first || now - first >= number("FAULT_COUNT", LONG_MAX)) return 0;
    errno = (int)number("FAULT_ERROR", ENOSPC);
    if (errno == 0) kill(getpid(), SIGKILL);
    return 1;
}

static int must_fail(const char *call, int file) {
    if (!is_wanted(call)) return 0;
    char link[64], path[PATH_MAX];
    snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    ssize_t length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = 0;
    return path_must_fail(call, path);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int file, const void *from, size_t count) {
    return must_fail("write", file) ? -1 : REAL(write)(file, from, count);
}
ssize_t pwrite(int file, const void *from, size_t count, off_t offset) {
    return must_fail("write", file) ? -1 : REAL(pwrite)(file, from, count, offset);
}
ssize_t pwrite64(int file, const void *from, size_t count, off64_t offset) {
    return must_fail("write", file) ? -1 : REAL(pwrite64)(file, from, count, offset);
}
ssize_t writev(int file, const struct iovec *from, int count) {
    return must_fail("write", file) ? -1 : REAL(writev)(file, from, count);
}
ssize_t read(int file, void *to, size_t count) {
    return must_fail("read", file) ? -1 : REAL(read)(file, to, count);
}
ssize_t pread(int file, void *to, size_t count, off_t offset) {
    return must_fail("read", file) ? -1 : REAL(pread)(file, to, count, offset);
}
ssize_t pread64(int file, void *to, size_t count, off64_t offset) {
    return must_fail("read", file) ? -1 : REAL(pread64)(file, to, count, offset);
}
int fsync(int file) { return must_fail("sync", file) ? -1 : REAL(fsync)(file); }
int fdatasync(int file) { return must_fail("sync", file) ? -1 : REAL(fdatasync)(file); }
int ftruncate(int file, off_t length) { return must_fail("cut", file) ? -1 : REAL(ftruncate)(file, length); }
int ftruncate64(int file, off64_t length) { return must_fail("cut", file) ? -1 : REAL(ftruncate64)(file, length); }
int rename(const char *from, const char *to) { return path_must_fail("rename", to) ? -1 : REAL(rename)(from, to); }

static mode_t mode_of(int flags, va_list more) { return flags & (O_CREAT | O_TMPFILE) ? va_arg(more, mode_t) : 0; }

int open(const char *path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    mode_t mode = mode_of(flags, more);
    va_end(more);
    return path_must_fail("open", path) ? -1 : REAL(open)(path, flags, mode);
}
int open64(const char *path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    mode_t mode = mode_of(flags, more);
    va_end(more);
    return path_must_fail("open", path) ? -1 : REAL(open64)(path, flags, mode);
}
