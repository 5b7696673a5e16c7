/* stop_signals.c: catches and blocks the signals that ask the program to stop.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "base/stop_signals.h"

#include <string.h>

static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
#define N_NUMBERS (sizeof numbers / sizeof numbers[0])

static void fill(sigset_t *set)
{
    size_t i = 0;
    (void)sigemptyset(set);
    for (i = 0; i < N_NUMBERS; i++)
        (void)sigaddset(set, numbers[i]);
}

void host_stop_catch(void (*run)(int number))
{
    struct sigaction action, was;
    size_t i = 0;
    memset(&action, 0, sizeof action);
    action.sa_handler = run;
    action.sa_flags = SA_RESTART;
    fill(&action.sa_mask);
    for (i = 0; i < N_NUMBERS; i++)
        if (sigaction(numbers[i], NULL, &was) == 0 && was.sa_handler != SIG_IGN)
            (void)sigaction(numbers[i], &action, NULL);
}

void host_stop_block(host_stop_set *before)
{
    sigset_t set;
    fill(&set);
    (void)pthread_sigmask(SIG_BLOCK, &set, before);
}

void host_stop_restore(const host_stop_set *before) { (void)pthread_sigmask(SIG_SETMASK, before, NULL); }
