/* The only routines by which results reach the disk.
 *
 * Each answers 0, or the errno of what failed: a write that was short, a length that is not what was
 * written, a sync or a close that reports late what a write had accepted. Nothing takes its name
 * before it is whole, and no symbolic link is followed. */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* All bytes to a descriptor that may be a pipe. */
int lopin_write_all(int file, const char *bytes, long long n)
{
    while (n > 0) {
        ssize_t done = write(file, bytes, (size_t)n);
        if (done < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            struct pollfd room = {file, POLLOUT, 0};
            poll(&room, 1, -1);
        } else if (done < 0 && errno != EINTR) {
            return errno;
        } else if (done == 0) {
            return EIO;
        } else if (done > 0) {
            bytes += done;
            n -= done;
        }
    }
    return 0;
}

static int write_at(int file, long long at, const char *bytes, long long n)
{
    while (n > 0) {
        ssize_t done = pwrite(file, bytes, (size_t)n, (off_t)at);
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) return done < 0 ? errno : EIO;
        bytes += done;
        at += done;
        n -= done;
    }
    return 0;
}

/* Some files (devices, file systems in memory) know no sync; that is no failure. */
static int synced(int file)
{
    if (fsync(file) == 0 || errno == EINVAL || errno == ENOTSUP) return 0;
    return errno;
}

/* A new file beside its place, instead of what an earlier run left there. */
int lopin_file_begin(const char *part, int *file)
{
    unlink(part);
    *file = open(part, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    return *file < 0 ? errno : 0;
}

/* Close a file that must have a length; lasting: it is on the disk afterwards. */
int lopin_file_end(int file, long long length, int lasting)
{
    struct stat is;
    int status = fstat(file, &is) ? errno : 0;
    if (status == 0 && is.st_size != (off_t)length) status = EIO;
    if (status == 0 && lasting) status = synced(file);
    if (close(file) && status == 0) status = errno;
    return status;
}

int lopin_file_rename(const char *part, const char *path)
{
    return rename(part, path) ? errno : 0;
}

/* Lines at the end of a file; all of them or, on a failure, none. */
int lopin_file_append(int file, long long length, const char *bytes, long long n)
{
    int status = write_at(file, length, bytes, n);
    if (status == 0) return 0;
    return ftruncate(file, (off_t)length) ? EIO : status;
}

/* Replace what follows `at` by something longer. The room is taken first, by blanks behind the end,
 * so that a disk that is full leaves the file as it was; the rest needs no room. */
int lopin_file_new_end(int file, long long at, long long length, const char *bytes, long long n)
{
    static const char blanks[64] = "\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n"
                                   "\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n";
    long long end = length;
    int status = 0;
    while (end < at + n && status == 0) {
        long long room = at + n - end < 64 ? at + n - end : 64;
        status = write_at(file, end, blanks, room);
        end += room;
    }
    if (status == 0) return write_at(file, at, bytes, n);
    return ftruncate(file, (off_t)length) ? EIO : status;
}

/* A file of an earlier run, to be gone on with: cut to a length. ENODATA: it has become shorter. */
int lopin_file_go_on(const char *path, long long length, int *file)
{
    struct stat is;
    int status = 0;
    *file = open(path, O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (*file < 0) return errno == ENOENT ? ENODATA : errno;
    if (fstat(*file, &is)) status = errno;
    else if (!S_ISREG(is.st_mode)) status = EINVAL;
    else if (is.st_size < (off_t)length) status = ENODATA;
    else if (ftruncate(*file, (off_t)length)) status = errno;
    if (status) {
        close(*file);
        *file = -1;
    }
    return status;
}

/* All that was written in the file system of an open file is on its disk. */
int lopin_sync_folder(int file)
{
#ifdef __linux__
    return syncfs(file) ? errno : 0;
#else
    return synced(file);
#endif
}

/* What a path is, links followed: 0 a file, 1 nothing, 2 a folder, 3 a pipe, 4 a device or a socket,
 * 5 not to be read; and its length in bytes. */
int lopin_file_kind(const char *path, long long *length)
{
    struct stat is;
    *length = 0;
    if (stat(path, &is)) return errno == ENOENT || errno == ENOTDIR ? 1 : 5;
    *length = (long long)is.st_size;
    if (S_ISDIR(is.st_mode)) return 2;
    if (S_ISFIFO(is.st_mode)) return 3;
    if (!S_ISREG(is.st_mode)) return 4;
    return access(path, R_OK) ? 5 : 0;
}

/* Something has this name, be it a link that leads nowhere. */
int lopin_file_is_there(const char *path)
{
    struct stat is;
    return lstat(path, &is) == 0;
}

/* The first bytes of a file; fewer than asked for is a failure. */
int lopin_file_read(const char *path, char *bytes, long long n)
{
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK), status = 0;
    if (file < 0) return errno;
    while (n > 0 && status == 0) {
        ssize_t done = read(file, bytes, (size_t)n);
        if (done < 0 && errno == EINTR) continue;
        if (done <= 0) status = done < 0 ? errno : ENODATA;
        else {
            bytes += done;
            n -= done;
        }
    }
    close(file);
    return status;
}

/* What an errno means: 1 the disk is full, 2 a limit of file sizes, 3 rights, 4 a link, 5 a reader
 * who left, 6 a file that has become shorter, 7 a stream that is not open, 0 anything else. */
int lopin_reason(int status, char *text, int n)
{
    const char *said = strerror(status);
    int i, length = (int)strlen(said);
    for (i = 0; i < n; ++i) text[i] = i < length ? said[i] : ' ';
    switch (status) {
    case ENOSPC:
    case EDQUOT: return 1;
    case EFBIG: return 2;
    case EACCES:
    case EPERM:
    case EROFS: return 3;
    case ELOOP: return 4;
    case EPIPE: return 5;
    case ENODATA: return 6;
    case EBADF: return 7;
    default: return 0;
    }
}

/* What `job.json` shall say if the process must end at once, kept where that needs no memory. */
static char *summary_path, *summary_text;

void lopin_summary_is(const char *path, const char *text)
{
    free(summary_path);
    free(summary_text);
    summary_path = path[0] ? strdup(path) : NULL;
    summary_text = path[0] ? strdup(text) : NULL;
}

/* Only a file that is there and long enough is changed: in its place, with blanks to its end. The
 * exit code of the text, its only digit after the word, gives way to this one. */
void lopin_summary_failed(int code)
{
    char digits[12];
    int file, fits;
    long long length, n = 0, before, more;
    const char *at;
    if (!summary_path || !summary_text || lopin_file_kind(summary_path, &length)) return;
    at = strstr(summary_text, "exit_code");
    at = at ? strpbrk(at, "0123456789") : NULL;
    before = at ? at - summary_text : (long long)strlen(summary_text);
    more = at ? snprintf(digits, sizeof digits, "%d", code) : 0;
    file = open(summary_path, O_WRONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK);
    if (file < 0) return;
    n = (long long)strlen(summary_text) + more - (at ? 1 : 0);
    fits = n <= length && write_at(file, 0, summary_text, before) == 0;
    if (fits && at)
        fits = write_at(file, before, digits, more) == 0
            && write_at(file, before + more, at + 1, n - before - more) == 0;
    if (fits) while (n < length && write_at(file, n, " ", 1) == 0) ++n;
    close(file);
}
