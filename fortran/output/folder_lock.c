/* One run at a time writes the files of a job: a lock that ends with the process that holds it.
 *
 * The system drops the lock of a process that dies, however it dies, so that a file which is left
 * behind locks nobody out. The number of the process and the name of its machine are in the file only
 * to name them. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static void read_holder(int file, long long *process, char *machine, int n)
{
    char text[300] = "", name[256] = "";
    ssize_t got = pread(file, text, sizeof text - 1, 0);
    *process = 0;
    memset(machine, ' ', (size_t)n);
    if (got <= 0 || sscanf(text, "%lld %255s", process, name) < 1) return;
    memcpy(machine, name, strlen(name) < (size_t)n ? strlen(name) : (size_t)n);
}

/* Where a file system knows no locks, the process that the file names must have ended. */
static int seems_alive(int file)
{
    char machine[256], here[256] = "";
    long long process;
    read_holder(file, &process, machine, (int)sizeof machine);
    if (process <= 0) return 0;
    gethostname(here, sizeof here - 1);
    if (strncmp(machine, here, strlen(here)) || machine[strlen(here)] != ' ') return 1;
    return process != (long long)getpid() && (kill((pid_t)process, 0) == 0 || errno == EPERM);
}

/* The lock of a path: 0 and an open file; -1 if another run holds it, and which; else an errno.
 * `old`: the file was there before, left behind by a run that was killed. */
int lopin_lock_take(const char *path, int *file, int *old, long long *process, char *machine, int n)
{
    for (;;) {
        struct stat here, there;
        int taken;
        *process = 0;
        *old = 1;
        *file = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
        if (*file < 0 && errno == ENOENT) {
            *old = 0;
            *file = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
            if (*file < 0 && errno == EEXIST) continue;
        }
        if (*file < 0) return errno;
        taken = flock(*file, LOCK_EX | LOCK_NB);
        if (taken && (errno == EWOULDBLOCK || (errno != EINTR && seems_alive(*file)))) {
            read_holder(*file, process, machine, n);
            close(*file);
            return -1;
        }
        /* Whoever held it may have removed the file between open and lock. */
        if (fstat(*file, &here) == 0 && stat(path, &there) == 0 && here.st_ino == there.st_ino
            && here.st_dev == there.st_dev) return 0;
        close(*file);
    }
}

/* Who holds it: a help for people, so that a full disk is no failure here. */
void lopin_lock_sign(int file)
{
    char text[300], here[256] = "";
    int n;
    gethostname(here, sizeof here - 1);
    n = snprintf(text, sizeof text, "%lld %s\n", (long long)getpid(), here);
    if (pwrite(file, text, (size_t)n, 0) != n || ftruncate(file, n)) return;
}

/* Give the lock back; with a path, its file goes too. */
void lopin_lock_give(const char *path, int file)
{
    if (path[0]) unlink(path);
    close(file);
}

/* The path of a file from the root, links followed, with its length; 0 where there is no such file
 * or no room. */
int lopin_full_path(const char *path, char *full, int n)
{
    char *found = realpath(path, NULL);
    size_t length = found ? strlen(found) : 0;
    if (length > (size_t)n) length = 0;
    if (length) memcpy(full, found, length);
    free(found);
    return (int)length;
}
