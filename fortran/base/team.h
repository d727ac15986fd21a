/* Threads that share work out among themselves: they start with it and end with it. */
#ifndef LOPIN_TEAM_H
#define LOPIN_TEAM_H

typedef struct team team_type;

/* Threads that the run in progress computes on; 1 where none is. */
int lopin_threads_of_run(void);
void lopin_set_threads_of_run(int threads);

/* Run job(team, rank, argument) on `threads` threads, or on as many as start. */
void lopin_run_team(int threads, void (*job)(team_type *, int, void *), void *argument);
int lopin_team_size(const team_type *team);
/* The next number from 0 that no thread has taken since all have met. */
int lopin_take_next(team_type *team);
/* All threads meet. */
void lopin_meet(team_type *team);
#endif
