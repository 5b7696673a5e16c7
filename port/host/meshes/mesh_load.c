/* mesh_load.c: reads many mesh files in parallel.
 * SPDX-License-Identifier: MIT */
#include "meshes/mesh_load.h"

#include "base/threads.h"

static void load_one(void *arg, uint32_t task, uint32_t worker)
{
    host_load *const load = (host_load *)arg + task;
    (void)worker;
    load->failed = host_mesh_read(load->path, load->need, load->mirror, &load->mesh, &load->error);
}

int host_load_all(const smr_port *port, host_load *loads, uint32_t n, host_error *error)
{
    uint32_t i = 0, k = 0;
    host_parallel(port, load_one, loads, n);
    for (i = 0; i < n && !loads[i].failed; i++)
        continue;
    if (i == n)
        return 0;
    *error = loads[i].error;
    for (k = 0; k < n; k++)
        host_mesh_free(&loads[k].mesh);
    return -1;
}
