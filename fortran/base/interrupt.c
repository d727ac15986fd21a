/* The wish of a user or a batch system that a run ends: SIGINT, SIGTERM.
 *
 * The first signal is only noted, so that the increment in hand can end and the checkpoint be
 * written; the second one ends the process at once, as it would without us. */
#include <signal.h>

static volatile sig_atomic_t asked = 0;

static void note(int number)
{
    asked = number;
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
}

/* From now on the first signal is only noted. A signal that is ignored (nohup) stays ignored. */
void lopin_catch_interrupts(void)
{
    asked = 0;
    if (signal(SIGINT, note) == SIG_IGN) signal(SIGINT, SIG_IGN);
    if (signal(SIGTERM, note) == SIG_IGN) signal(SIGTERM, SIG_IGN);
}

/* Number of the signal that came; 0: none. */
int lopin_signal_noted(void)
{
    return (int)asked;
}
