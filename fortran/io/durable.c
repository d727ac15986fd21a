/* What Fortran cannot say of files: be on the disk, be no longer than this. Zero is success. */
#include <fcntl.h>
#include <unistd.h>

/* What was written to a file has reached the disk. */
int lopin_sync_file(const char *path)
{
    int file = open(path, O_RDONLY), status;
    if (file < 0) return 1;
    status = fsync(file);
    return close(file) != 0 || status != 0;
}

/* Cut a file to a length, in bytes. */
int lopin_cut_file(const char *path, long long length)
{
    return truncate(path, (off_t)length) != 0;
}
