/* stop_signals.h: the signals that ask the program to stop: SIGINT, SIGTERM, SIGHUP. Only the main thread receives
 * them.
 * SPDX-License-Identifier: MIT */
#ifndef STOP_SIGNALS_H
#define STOP_SIGNALS_H

#include <signal.h>

typedef sigset_t host_stop_set;

/* Lets run handle these signals, except those that are ignored (nohup). */
void host_stop_catch(void (*run)(int number));

/* Blocks these signals in this thread, and in threads that it starts. before: what was blocked, for restoring. */
void host_stop_block(host_stop_set *before);
void host_stop_restore(const host_stop_set *before);

#endif
