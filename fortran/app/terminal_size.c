/* How a terminal is. */
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

/* Columns of the terminal behind a descriptor; 0: lines cannot be rewritten there. */
int lopin_columns(int file)
{
    struct winsize size;
    const char *kind = getenv("TERM");
    if (!isatty(file) || !kind || !strcmp(kind, "dumb")) return 0;
    if (ioctl(file, TIOCGWINSZ, &size) || size.ws_col == 0) return 80;
    return size.ws_col;
}
