/* A disk that fails when it is told to, for tests: loaded before the program (LD_PRELOAD).
 *
 * FAULT_ROOM=n: files may grow by n bytes in all, then there is no space left. FAULT_KILL=n: the process
 * is killed in the middle of the write with which they would have grown by more. FAULT_SYNC=n,
 * FAULT_CLOSE=n: the n-th sync, or close of a file that was written to, fails. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

static long long grown;
static int syncs, closes;
static char written[1024];

static long long said(const char *name)
{
    const char *text = getenv(name);
    return text ? atoll(text) : -1;
}

/* How many of n bytes at `at` may be written; -1: none. */
static long long granted(int file, long long at, long long n)
{
    long long room = said("FAULT_ROOM"), deadly = said("FAULT_KILL"), more;
    struct stat is;
    if (fstat(file, &is) || !S_ISREG(is.st_mode)) return n;
    if (file < 1024) written[file] = 1;
    if (at < 0) at = lseek(file, 0, SEEK_CUR);
    more = at + n - is.st_size;
    if (more <= 0) return n;
    if (deadly >= 0 && grown + more > deadly) return deadly - grown < n ? -2 - (deadly - grown) : n;
    if (room >= 0 && grown + more > room) {
        n -= grown + more - room;
        if (n <= 0) return -1;
        more = at + n - is.st_size;
    }
    if (more > 0) grown += more;
    return n;
}

ssize_t pwrite64(int file, const void *bytes, size_t n, off_t at)
{
    static ssize_t (*real)(int, const void *, size_t, off_t);
    long long may = granted(file, at, (long long)n);
    if (!real) real = (ssize_t(*)(int, const void *, size_t, off_t))dlsym(RTLD_NEXT, "pwrite64");
    if (may <= -2) {
        if (real(file, bytes, (size_t)(-2 - may), at) >= 0) kill(getpid(), SIGKILL);
    }
    if (may < 0) {
        errno = ENOSPC;
        return -1;
    }
    return real(file, bytes, (size_t)may, at);
}

ssize_t pwrite(int file, const void *bytes, size_t n, off_t at)
{
    return pwrite64(file, bytes, n, at);
}

ssize_t write(int file, const void *bytes, size_t n)
{
    static ssize_t (*real)(int, const void *, size_t);
    long long may = granted(file, -1, (long long)n);
    if (!real) real = (ssize_t(*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
    if (may <= -2) kill(getpid(), SIGKILL);
    if (may < 0) {
        errno = ENOSPC;
        return -1;
    }
    return real(file, bytes, (size_t)may);
}

static int failed_sync(void)
{
    if (++syncs != said("FAULT_SYNC")) return 0;
    errno = EIO;
    return -1;
}

int fsync(int file)
{
    static int (*real)(int);
    if (!real) real = (int (*)(int))dlsym(RTLD_NEXT, "fsync");
    return failed_sync() ? -1 : real(file);
}

int syncfs(int file)
{
    static int (*real)(int);
    if (!real) real = (int (*)(int))dlsym(RTLD_NEXT, "syncfs");
    return failed_sync() ? -1 : real(file);
}

int close(int file)
{
    static int (*real)(int);
    int ours = file >= 0 && file < 1024 && written[file];
    if (!real) real = (int (*)(int))dlsym(RTLD_NEXT, "close");
    if (!ours) return real(file);
    written[file] = 0;
    real(file);
    if (++closes != said("FAULT_CLOSE")) return 0;
    errno = EIO;
    return -1;
}
