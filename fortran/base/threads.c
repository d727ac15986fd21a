/* Threads: how many can be started, and how many processors other processes leave. */
#include <limits.h>
#include <pthread.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { most = 1024 };
static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static void *wait_at_gate(void *unused)
{
    pthread_mutex_lock(&gate);
    pthread_mutex_unlock(&gate);
    return unused;
}

/* How many of n threads, the calling one included, the system lets live at once. */
int lopin_threads_that_start(int n)
{
    pthread_t thread[most];
    int i, started = 0;
    if (n > most) n = most;
    pthread_mutex_lock(&gate);
    while (started < n - 1 && pthread_create(&thread[started], NULL, wait_at_gate, NULL) == 0)
        ++started;
    pthread_mutex_unlock(&gate);
    for (i = 0; i < started; ++i) pthread_join(thread[i], NULL);
    return started + 1;
}

/* Has a BLAS its room already? Asked once it has; it keeps what it took. */
int lopin_blas_took_room(int now)
{
    static volatile int took = 0;
    if (now) took = 1;
    return took;
}

/* Are addresses left for so many threads of a BLAS? One that finds none waits for ever. */
int lopin_has_room_for_blas(int threads)
{
    const size_t each = 140000000;            /* what OpenBLAS takes, and a little more */
    void *place = mmap(NULL, (size_t)threads * each, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED) return 0;
    munmap(place, (size_t)threads * each);
    return 1;
}

/* ---- what other processes leave ----------------------------------------------------------- */

/* Seconds that all processors have computed since the machine started, as Linux says, and this
 * process; 0: not known. */
static int seconds_of_work(double *all, double *own)
{
    unsigned long long user, nice, system, irq, soft;
    struct rusage use;
    FILE *file = fopen("/proc/stat", "r");
    int found = 0;
    if (file) {
        found = fscanf(file, "cpu %llu %llu %llu %*u %*u %llu %llu", &user, &nice, &system, &irq,
                       &soft);
        fclose(file);
    }
    if (found != 5 || getrusage(RUSAGE_SELF, &use)) return 0;
    *all = (double)(user + nice + system + irq + soft)/(double)sysconf(_SC_CLK_TCK);
    *own = (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec)
        + 1e-6*(double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
    return 1;
}

static struct { int known; double all, own, at; } begun;

static double seconds_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

/* From here on it is counted what others compute. */
void lopin_watch_processors(void)
{
    begun.known = seconds_of_work(&begun.all, &begun.own);
    begun.at = seconds_now();
}

/* Processors that others have left idle since then, at least a twentieth of a second; many where the
 * system does not say. */
int lopin_idle_processors(void)
{
    const double least = 0.05;
    double all, own, waited = seconds_now() - begun.at, others;
    long online = sysconf(_SC_NPROCESSORS_ONLN);
    if (!begun.known || online < 1) return INT_MAX;
    if (waited < least) {
        const struct timespec rest = {0, (long)(1e9*(least - waited))};
        nanosleep(&rest, NULL);
        waited = seconds_now() - begun.at;
    }
    if (!seconds_of_work(&all, &own)) return INT_MAX;
    others = ((all - begun.all) - (own - begun.own))/waited;
    return (int)((double)online - others + 0.4);
}
