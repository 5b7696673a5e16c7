/* mesh_load.h: reads many mesh files in parallel.
 * SPDX-License-Identifier: MIT */
#ifndef MESH_LOAD_H
#define MESH_LOAD_H

#include "meshes/triangle_mesh.h"

/* One file to read, and its mesh or its error. */
typedef struct host_load {
    const char *path;
    int need, mirror; /* as in host_mesh_read */
    host_mesh mesh;   /* owned by the caller once read */
    host_error error;
    int failed;
} host_load;

/* Reads all files. 0, or -1 with the error of the first file that failed and all meshes freed. */
int host_load_all(const smr_port *port, host_load *loads, uint32_t n, host_error *error);

#endif
