/* ply_header.h: the header of a PLY file: its elements and their properties.
 * SPDX-License-Identifier: MIT */
#ifndef PLY_HEADER_H
#define PLY_HEADER_H

#include "base/number_types.h"
#include "meshes/mesh_reader.h"

#define HOST_PLY_ELEMENTS_MAX 16u
#define HOST_PLY_PROPERTIES_MAX 64u

enum { HOST_PLY_OTHER = 0, HOST_PLY_VERTEX, HOST_PLY_FACE };
enum { HOST_PLY_ASCII = 0, HOST_PLY_LITTLE, HOST_PLY_BIG };

typedef struct host_ply_property {
    host_type type;
    host_type count_type; /* of a list's length; HOST_TYPE_NONE: a single value */
    int role; /* vertex: 0, 1, 2 for x, y, z, 3, 4, 5 for nx, ny, nz; face: 0 for the index list; -1: ignored */
} host_ply_property;

typedef struct host_ply_element {
    int kind; /* HOST_PLY_... */
    uint64_t count;
    uint32_t line; /* line of the header */
    uint32_t n_properties;
    uint32_t has_list;
    size_t row_bytes; /* binary: bytes of one row, with empty lists */
    host_ply_property property[HOST_PLY_PROPERTIES_MAX];
} host_ply_element;

typedef struct host_ply_header {
    int format; /* HOST_PLY_ASCII, ... */
    uint32_t n_elements;
    uint32_t lines;      /* lines of the header, end_header included */
    uint64_t n_vertices; /* count of the vertex element */
    const unsigned char *body;
    host_ply_element element[HOST_PLY_ELEMENTS_MAX];
} host_ply_header;

/* Reads the header and checks that the rest of the file can hold its counts. 0, or -1 with the error filled. */
int host_ply_read_header(host_mesh_reader *reader, const unsigned char *data, size_t n, host_ply_header *header);

#endif
