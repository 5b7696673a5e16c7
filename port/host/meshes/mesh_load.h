/* Many mesh files at once, read by all threads.
 * SPDX-License-Identifier: MIT */
#ifndef MESH_LOAD_H
#define MESH_LOAD_H

#include "meshes/triangle_mesh.h"

/* One file to read, and what became of it. */
typedef struct host_load {
    const char *path;
    int need, mirror; /* as in host_mesh_read */
    host_mesh mesh;   /* owned by whoever takes it */
    host_error error;
    int failed;
} host_load;

/* Reads them all. 0, or -1 with the first failing file's error; the meshes are freed then. */
int host_load_all(const smr_port *port, host_load *loads, uint32_t n, host_error *error);

#endif
