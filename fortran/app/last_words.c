/* An end that no procedure of ours chose is told in our words, by its exit code too.
 *
 * Compiled code and its library end a program where an allocation fails, and a BLAS waits for ever for
 * memory that does not come. The executable asks first: its allocations go through here (--wrap of the
 * linker), libraries that give up are heard when the program exits, and where the address space is
 * limited (ulimit -v) the BLAS begins with one thread. */
#define _GNU_SOURCE
#include <alloca.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

extern void lopin_summary_failed(int code);
void *__real_malloc(size_t n);
void *__real_calloc(size_t count, size_t n);
void *__real_realloc(void *old, size_t n);

static int told = 0, as_json = 0;
enum { resource = 5, internal = 70 };
static const char more_memory[] = "a coarser mesh, a machine with more memory or a higher limit (ulimit "
                                  "-v); files are whole, and a run that had begun goes on by --resume";

static void put(int file, const char *text)
{
    if (write(file, text, strlen(text)) < 0) return;
}

static void say_and_end(int code, const char *id, const char *message, const char *help)
{
    char text[700];
    told = 1;
    if (as_json) {
        snprintf(text, sizeof text,
                 "{\"schema\": \"lopin-1\", \"status\": \"failed\", \"exit_code\": %d,\n"
                 " \"diagnostics\": [\n  {\"severity\": \"error\", \"code\": \"%s\", \"message\": \"%s\", "
                 "\"file\": \"\", \"line\": 0, \"column\": 0, \"end_column\": 0, \"label\": \"\", "
                 "\"note\": \"\", \"help\": \"%s\"}\n ]}\n", code, id, message, help);
        put(1, text);
    } else {
        snprintf(text, sizeof text, "error[%s]: %s\n  = help: %s\n", id, message, help);
        put(2, text);
    }
    lopin_summary_failed(code);
    _exit(code);
}

static void no_memory(size_t n)
{
    char text[160];
    if (n > 0)
        snprintf(text, sizeof text, "not enough memory: the system refuses %.3g MB more",
                 (double)n/1048576.0);
    else
        snprintf(text, sizeof text, "not enough memory");
    say_and_end(resource, "E0702", text, more_memory);
}

void *__wrap_malloc(size_t n)
{
    void *place = __real_malloc(n);
    if (!place && n > 0) no_memory(n);
    return place;
}

void *__wrap_calloc(size_t count, size_t n)
{
    void *place = __real_calloc(count, n);
    if (!place && count > 0 && n > 0) no_memory(count*n);
    return place;
}

void *__wrap_realloc(void *old, size_t n)
{
    void *place = __real_realloc(old, n);
    if (!place && n > 0) no_memory(n);
    return place;
}

/* Compiled code calls this where an array's size overflows or its memory is refused. */
__attribute__((weak)) void _gfortran_os_error_at(const char *where, const char *format, ...)
{
    (void)where;
    (void)format;
    no_memory(0);
    abort();
}

/* The program exits: by `finish` of the terminal, or because a library gave up. */
static void at_exit(void)
{
    int reason = errno;
    if (told) return;
    if (reason == ENOMEM || reason == EAGAIN)
        say_and_end(resource, "E0702", "not enough memory: a library gave up", more_memory);
    say_and_end(internal, "E0900", "a library ended the program; this is a defect of Lopin",
                "report the deck and this message");
}

static uintptr_t base_of_stack;

/* A fault of memory is heard on a stack of its own: the other one may be what is full. */
static void at_fault(int number, siginfo_t *what, void *context)
{
    char text[160];
    struct rlimit limit;
    uintptr_t place = (uintptr_t)what->si_addr, below = base_of_stack - place;
    (void)context;
    if (number == SIGSEGV && place < base_of_stack && !getrlimit(RLIMIT_STACK, &limit)
        && limit.rlim_cur != RLIM_INFINITY && below > limit.rlim_cur / 2
        && below < limit.rlim_cur + ((uintptr_t)1 << 32)) {
        snprintf(text, sizeof text, "the stack of %.3g MB is full; this is a defect of Lopin",
                 (double)limit.rlim_cur / 1048576.0);
        say_and_end(internal, "E0900", text,
                    "ulimit -s unlimited lets the run go on; report the deck and this message");
    }
    snprintf(text, sizeof text, "memory was read or written where there is none (signal %d); this "
             "is a defect of Lopin", number);
    say_and_end(internal, "E0900", text, "report the deck and this message; --resume goes on");
}

static void hear_faults(void)
{
    static char room[65536];
    stack_t other = {.ss_sp = room, .ss_size = sizeof room};
    struct sigaction action;
    base_of_stack = (uintptr_t)__builtin_frame_address(0);
    memset(&action, 0, sizeof action);
    action.sa_sigaction = at_fault;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESETHAND;
    if (sigaltstack(&other, NULL)) return;
    sigaction(SIGSEGV, &action, NULL);
    sigaction(SIGBUS, &action, NULL);
}

void lopin_hear_the_end(void)
{
    atexit(at_exit);
    hear_faults();
}

void lopin_end_as_json(void)
{
    as_json = 1;
}

/* The exit that follows is ours. Threads of the BLAS are not waited for. */
void lopin_end(int code)
{
    told = 1;
    fflush(NULL);
    _exit(code);
}

/* Before the libraries begin: each thread of OpenBLAS takes 128 MB of addresses or waits for ever. */
static void one_blas_thread(int argc, char **argv, char **envp)
{
    static char one[] = "OPENBLAS_NUM_THREADS=1";
    struct rlimit limit;
    char **now;
    int i, n;
    (void)argc;
    if (getrlimit(RLIMIT_AS, &limit) || limit.rlim_cur == RLIM_INFINITY) return;
    if (limit.rlim_cur > (rlim_t)1 << 34) return;
    for (n = 0; envp[n]; ++n)
        if (!strcmp(envp[n], one)) return;
    now = alloca((size_t)(n + 2)*sizeof *now);
    now[0] = one;
    n = 1;
    for (i = 0; envp[i]; ++i)
        if (strncmp(envp[i], one, sizeof one - 2)) now[n++] = envp[i];
    now[n] = NULL;
    execve("/proc/self/exe", argv, now);
}

__attribute__((section(".preinit_array"), used))
static void (*const before_libraries)(int, char **, char **) = one_blas_thread;
