/* Threads: how many can be started, and forks of a process that has some. */
#include <pthread.h>
#include <stddef.h>
#include <sys/mman.h>

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

/* Since OpenMP 5.0. Without it a child that computes on threads waits for those of its parent. */
extern int omp_pause_resource_all(int kind) __attribute__((weak));

static void send_threads_home(void)
{
    if (omp_pause_resource_all) omp_pause_resource_all(2);
}

/* From now on a fork begins without the threads of OpenMP that wait for work: both sides start new
 * ones when they need them. */
void lopin_survive_forks(void)
{
    static int ready = 0;
    pthread_mutex_lock(&gate);
    if (!ready) pthread_atfork(send_threads_home, NULL, NULL);
    ready = 1;
    pthread_mutex_unlock(&gate);
}

/* Has a BLAS its room already? Asked once it has; it keeps what it took. */
int lopin_blas_took_room(int now)
{
    static volatile int took = 0;
    if (now) took = 1;
    return took;
}

/* Are n bytes of addresses left? A BLAS that finds none waits for ever. */
int lopin_has_room(long long n)
{
    void *place = mmap(NULL, (size_t)n, PROT_READ | PROT_WRITE,
                       MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (place == MAP_FAILED) return 0;
    munmap(place, (size_t)n);
    return 1;
}
