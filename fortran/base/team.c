/* Threads that share work out among themselves.
 *
 * Those of OpenMP look for each other for some 15 ms before they sleep, at each loop: where two of
 * them stand on one processor, because another program has the other one or none has moved them
 * yet, a loop of a millisecond takes that long. A thread that waits for the others looks for them
 * a few microseconds and then sleeps, so that it takes no time from what else the machine does.
 * While they run, each calls the BLAS for itself. */
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include "team.h"

enum { LOOKS = 4000 };                        /* of a thread that waits, before it sleeps */

struct team {
    int size;
    atomic_int next, arrived, round;
    pthread_mutex_t lock;
    pthread_cond_t all_here;
    void (*job)(team_type *, int, void *);
    void *argument;
};

typedef struct { team_type *team; int rank; pthread_t thread; } member_type;

extern int lopin_has_room_for_blas(int threads);

extern int openblas_get_parallel(void) __attribute__((weak));
extern void openblas_set_num_threads(int) __attribute__((weak));
extern int openblas_get_num_threads(void) __attribute__((weak));

static int of_run = 1;

int lopin_threads_of_run(void) { return of_run; }
void lopin_set_threads_of_run(int threads) { of_run = threads > 1 ? threads : 1; }

int lopin_team_size(const team_type *team) { return team->size; }

int lopin_take_next(team_type *team)
{
    if (team->size == 1) {
        int now = atomic_load_explicit(&team->next, memory_order_relaxed);
        atomic_store_explicit(&team->next, now + 1, memory_order_relaxed);
        return now;
    }
    return atomic_fetch_add(&team->next, 1);
}

static void rest(void)
{
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
}

void lopin_meet(team_type *team)
{
    int round = atomic_load(&team->round), k;
    if (team->size == 1) { atomic_store(&team->next, 0); return; }
    if (atomic_fetch_add(&team->arrived, 1) == team->size - 1) {
        atomic_store(&team->arrived, 0);
        atomic_store(&team->next, 0);
        pthread_mutex_lock(&team->lock);
        atomic_fetch_add(&team->round, 1);
        pthread_cond_broadcast(&team->all_here);
        pthread_mutex_unlock(&team->lock);
        return;
    }
    for (k = 0; k < LOOKS; k++) {
        if (atomic_load(&team->round) != round) return;
        rest();
    }
    pthread_mutex_lock(&team->lock);
    while (atomic_load(&team->round) == round) pthread_cond_wait(&team->all_here, &team->lock);
    pthread_mutex_unlock(&team->lock);
}

static void *work(void *v)
{
    member_type *m = v;
    /* Members wait here until it is known how many there are. */
    pthread_mutex_lock(&m->team->lock);
    pthread_mutex_unlock(&m->team->lock);
    m->team->job(m->team, m->rank, m->team->argument);
    return NULL;
}

/* Threads of a team: a BLAS that has its own by OpenMP would start some in each. */
static int that_may_start(int threads)
{
    if (openblas_get_parallel && openblas_get_parallel() == 2) return 1;
    while (threads > 1 && !lopin_has_room_for_blas(threads - 1)) threads--;
    return threads;
}

void lopin_run_team(int threads, void (*job)(team_type *, int, void *), void *argument)
{
    team_type team = {.size = 1, .job = job, .argument = argument};
    member_type *member = NULL;
    sigset_t all, before;
    int blas = 1, k;
    threads = that_may_start(threads);
    if (threads > 1) member = calloc((size_t)threads, sizeof *member);
    pthread_mutex_init(&team.lock, NULL);
    pthread_cond_init(&team.all_here, NULL);
    if (openblas_get_num_threads && openblas_set_num_threads) {
        blas = openblas_get_num_threads();
        if (blas != 1) openblas_set_num_threads(1);
    }
    sigfillset(&all);
    /* Signals are answered by the calling thread. */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    pthread_mutex_lock(&team.lock);
    for (k = 1; member && k < threads; k++) {
        member[k].team = &team;
        member[k].rank = k;
        if (pthread_create(&member[k].thread, NULL, work, &member[k])) break;
        team.size = k + 1;
    }
    pthread_mutex_unlock(&team.lock);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    job(&team, 0, argument);
    for (k = 1; k < team.size; k++) pthread_join(member[k].thread, NULL);
    if (blas != 1 && openblas_set_num_threads) openblas_set_num_threads(blas);
    pthread_cond_destroy(&team.all_here);
    pthread_mutex_destroy(&team.lock);
    free(member);
}

/* ---- parts of one loop ---------------------------------------------------------------------- */

typedef struct {
    int stages, last_is_serial;
    const int *begin;
    void (*part)(void *, int);
    void *context;
} loop_type;

static void do_parts(team_type *team, int rank, void *argument)
{
    const loop_type *loop = argument;
    int stage, k, chunk, first;
    for (stage = 0; stage < loop->stages; stage++) {
        int low = loop->begin[stage], n = loop->begin[stage + 1] - low, end;
        if (loop->last_is_serial && stage == loop->stages - 1) {
            for (k = 0; rank == 0 && k < n; k++) loop->part(loop->context, low + k);
            continue;
        }
        chunk = 1 + n / (8 * team->size);
        for (first = chunk * lopin_take_next(team); first < n;
             first = chunk * lopin_take_next(team)) {
            end = first + chunk < n ? first + chunk : n;
            for (k = first; k < end; k++) loop->part(loop->context, low + k);
        }
        if (stage < loop->stages - 1) lopin_meet(team);
    }
}

/* Parts begin[s] to begin[s + 1] - 1 in each of so many stages; all threads meet between two. */
void lopin_team_loop(int threads, int stages, const int *begin, int last_is_serial,
                     void (*part)(void *, int), void *context)
{
    loop_type loop = {stages, last_is_serial, begin, part, context};
    lopin_run_team(threads, do_parts, &loop);
}
