/* threads.c: threads and the clock for the command line.
 * SPDX-License-Identifier: MIT */
#define _GNU_SOURCE /* sched_getaffinity */

#include "base/threads.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "base/stop_signals.h"

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
    uint32_t t = 0;
    if (port->parallel != NULL && n_tasks > 1) {
        port->parallel(port->ctx, run, arg, n_tasks);
        return;
    }
    for (t = 0; t < n_tasks; t++)
        run(arg, t, 0);
}
