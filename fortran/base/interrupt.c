/* How a process of ours meets the world: signals, standard streams that are closed.
 *
 * The wish of a user or a batch system that a run ends (SIGINT, SIGTERM, SIGHUP, SIGXCPU): the first is
 * only noted, so that the increment in hand can end and the checkpoint be written; the second one ends
 * the process at once, as it would without us. */
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

static volatile sig_atomic_t asked = 0;
static const int wishes[] = {SIGINT, SIGTERM, SIGHUP, SIGXCPU};
enum { nwish = sizeof wishes / sizeof wishes[0] };

static void note(int number)
{
    int i;
    asked = number;
    for (i = 0; i < nwish; ++i) signal(wishes[i], SIG_DFL);
    /* Comes once a second from the limit of processor time on; a second limit ends the process. */
    if (number == SIGXCPU) signal(SIGXCPU, SIG_IGN);
}

/* From now on the first signal is only noted. A signal that is ignored (nohup) stays ignored. */
void lopin_catch_interrupts(void)
{
    int i;
    asked = 0;
    for (i = 0; i < nwish; ++i)
        if (signal(wishes[i], note) == SIG_IGN) signal(wishes[i], SIG_IGN);
}

/* Number of the signal that came; 0: none. */
int lopin_signal_noted(void)
{
    return (int)asked;
}

/* The same for a run within a process of somebody else (Python): Ctrl-C only, and the second one is
 * theirs again. */
static struct sigaction theirs;

static void note_once(int number)
{
    asked = number;
    sigaction(SIGINT, &theirs, NULL);
}

void lopin_borrow_interrupt(void)
{
    struct sigaction ours;
    asked = 0;
    ours.sa_handler = note_once;
    ours.sa_flags = SA_RESTART;
    sigemptyset(&ours.sa_mask);
    sigaction(SIGINT, &ours, &theirs);
}

/* A signal that ended no run is handed on. */
void lopin_return_interrupt(int answered)
{
    int came = asked != 0;
    asked = 0;
    sigaction(SIGINT, &theirs, NULL);
    if (came && !answered) raise(SIGINT);
}

/* A program of ours begins: what cannot be written is told by the write, not by a signal; a signal that
 * ends us prints nothing; no result file takes the number of a standard stream that is closed. */
void lopin_guard_process(void)
{
    int file;
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    signal(SIGQUIT, SIG_DFL);
    signal(SIGXCPU, SIG_DFL);
    for (file = 0; file <= 2; ++file)
        if (fcntl(file, F_GETFD) < 0) {
            /* Opened the wrong way round: reading or writing goes on to fail. */
            int opened = open("/dev/null", file == 0 ? O_WRONLY : O_RDONLY);
            if (opened >= 0 && opened != file) close(opened);
        }
}
