/* Triangle meshes of the host program: reading from and writing to files.
 *
 * Inside, coordinates are LPS millimetres. A file that says SPACE=RAS is turned on reading.
 * Vertices and triangles keep the file's order; polygons become fans, in order.
 * SPDX-License-Identifier: MIT */
#ifndef TRIANGLE_MESH_H
#define TRIANGLE_MESH_H

#include <stddef.h>
#include <stdint.h>

#include "base/byte_buffer.h"
#include "base/mirror.h"
#include "smr.h"

typedef struct host_mesh {
    float *xyz;          /* [n_vertices][3], mm; owned */
    uint32_t *triangles; /* [n_triangles][3]; owned; NULL when there are none */
    uint32_t n_vertices, n_triangles;
} host_mesh;

enum { HOST_MESH_POINTS_TOO = 0, HOST_MESH_SURFACE = 1 };

/* Reads PLY, STL, OBJ or legacy VTK polydata, told apart by content, then by extension; packed ones too.
 * need: HOST_MESH_SURFACE refuses a file without triangles. mirror: HOST_MIRROR_..., applied after
 * reading. Returns 0, or -1 with the error filled and the mesh empty. */
int host_mesh_read(const char *path, int need, int mirror, host_mesh *mesh, host_error *error);

/* Negates one coordinate and turns every triangle, so that the surface keeps its outside. */
void host_mesh_mirror(host_mesh *mesh, int axis);

void host_mesh_free(host_mesh *mesh);

/* The same mesh as the library sees it; borrowed. */
smr_mesh host_mesh_view(const host_mesh *mesh);

/* Appends `part` to `whole`; 0, or -1 when memory or the library's limits end. */
int host_mesh_append(host_mesh *whole, const host_mesh *part);

enum { HOST_FORMAT_PLY = 0, HOST_FORMAT_PLY_ASCII, HOST_FORMAT_STL, HOST_FORMAT_OBJ, HOST_FORMAT_VTK };

/* Writes the mesh in a format; binary little-endian PLY is the program's own. The buffer remembers failure. */
void host_mesh_write(const host_mesh *mesh, int format, host_buffer *buffer);

#endif
