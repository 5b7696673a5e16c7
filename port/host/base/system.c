/* system.c: aligned memory, signals that stop the program, threads and the clock.
 * SPDX-License-Identifier: MIT */
#define _DEFAULT_SOURCE /* madvise */
#define _POSIX_C_SOURCE 200809L
#define _GNU_SOURCE /* sched_getaffinity */

#include "base/system.h"
#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

void *host_alloc(size_t bytes)
{
    const size_t slots = bytes / 64u + 1u;
    return bytes > SIZE_MAX - 128u ? NULL : aligned_alloc(64u, slots * 64u);
}

#define HUGE_PAGE ((size_t)2u << 20)

void *host_alloc_scattered(size_t bytes)
{
    if (bytes < HUGE_PAGE || bytes > SIZE_MAX - 2u * HUGE_PAGE)
        return host_alloc(bytes);
    void *data = aligned_alloc(HUGE_PAGE, (bytes / HUGE_PAGE + 1u) * HUGE_PAGE);
#if defined(MADV_HUGEPAGE)
    if (data != NULL) /* only a hint; the last, partly used huge page keeps small pages */
        (void)madvise(data, bytes / HUGE_PAGE * HUGE_PAGE, MADV_HUGEPAGE);
#endif
    return data;
}

static const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
#define N_NUMBERS (sizeof numbers / sizeof numbers[0])

static void fill(sigset_t *set)
{
    (void)sigemptyset(set);
    for (size_t i = 0; i < N_NUMBERS; i++)
        (void)sigaddset(set, numbers[i]);
}

void host_stop_catch(void (*run)(int number))
{
    struct sigaction action = {0}, was;
    action.sa_handler = run;
    action.sa_flags = SA_RESTART;
    fill(&action.sa_mask);
    for (size_t i = 0; i < N_NUMBERS; i++)
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

double host_seconds(void)
{
    struct timespec now;
    (void)clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static uint32_t processors(void)
{
    cpu_set_t allowed;
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    /* a container or taskset may allow fewer processors than are online */
    const long n = sched_getaffinity(0, sizeof allowed, &allowed) == 0 ? CPU_COUNT(&allowed) : online;
    if (n < 1)
        return 1;
    return n > (long)SMR_WORKERS_MAX ? SMR_WORKERS_MAX : (uint32_t)n;
}

int host_port_open(host_port *port, uint32_t threads, host_error *error)
{
    const uint32_t n = threads > 0 ? threads : processors();
    const size_t bytes = smr_pthread_bytes(n);
    host_stop_set before;
    smr_status status = SMR_E_NULL;
    memset(port, 0, sizeof *port);
    error->file = "--threads";
    port->memory = host_alloc(bytes);
    host_stop_block(&before); /* the threads never receive these signals: only the main thread does */
    if (port->memory != NULL)
        status = smr_pthread_create(&port->pool, port->memory, bytes, n);
    host_stop_restore(&before);
    if (status != SMR_OK) {
        if (port->memory == NULL)
            return host_fail_at(error, "threads", n, "free memory");
        free(port->memory);
        memset(port, 0, sizeof *port);
        return host_fail_at(error, "threads", n, "a system that starts them (%s)", smr_status_name(status));
    }
    port->port = smr_pthread_port(port->pool);
    return 0;
}

void host_port_close(host_port *port)
{
    smr_pthread_destroy(port->pool);
    free(port->memory);
    memset(port, 0, sizeof *port);
}

void host_parallel(const smr_port *port, smr_task run, void *arg, uint32_t n_tasks)
{
    if (port->parallel != NULL && n_tasks > 1) {
        port->parallel(port->ctx, run, arg, n_tasks);
        return;
    }
    for (uint32_t t = 0; t < n_tasks; t++)
        run(arg, t, 0);
}
