/* triangle_mesh.h: triangle meshes: in memory, from files and to files.
 *
 * In memory, coordinates are millimetres in LPS. Files marked SPACE=RAS are converted when read.
 * Vertices and triangles keep the file's order; polygons become fans of triangles, in order.
 * SPDX-License-Identifier: MIT */
#ifndef TRIANGLE_MESH_H
#define TRIANGLE_MESH_H

#include "base/byte_buffer.h"
#include "base/text_scan.h"
#include "smr.h"

typedef struct host_mesh {
    float *xyz;          /* [n_vertices][3], mm; owned */
    uint32_t *triangles; /* [n_triangles][3]; owned; NULL without triangles */
    float *normals;      /* [n_vertices][3] of a cloud of points whose file has them; owned; NULL without */
    uint32_t n_vertices, n_triangles;
} host_mesh;

enum { HOST_MESH_POINTS_TOO = 0, HOST_MESH_SURFACE = 1, HOST_MESH_CLOUD = 2 };

/* Reads PLY, STL, OBJ or legacy VTK polydata, also gzipped; the content decides the format, then the extension.
 * need: HOST_MESH_SURFACE refuses a file without triangles; HOST_MESH_CLOUD reads points with their normals, from CSV,
 * too. mirror: HOST_MIRROR_..., applied after
 * reading. Returns 0, or -1 with the error filled and the mesh empty. */
int host_mesh_read(const char *path, int need, int mirror, host_mesh *mesh, host_error *error);

/* Negates one coordinate of vertices and normals. */
void host_mesh_negate(host_mesh *mesh, int axis);

/* The same, and reverses every triangle, so that the surface keeps its outside. */
void host_mesh_mirror(host_mesh *mesh, int axis);

void host_mesh_free(host_mesh *mesh);

/* The mesh as the library's type; borrows the arrays. */
smr_mesh host_mesh_view(const host_mesh *mesh);

/* Appends `part` to `whole`. 0, or -1 when out of memory or beyond the library's limits. */
int host_mesh_append(host_mesh *whole, const host_mesh *part);

/* The first four are what results are written in, in the order of the words of --format: binary but for OBJ. */
enum {
    HOST_FORMAT_PLY = 0, /* little-endian */
    HOST_FORMAT_STL,     /* triangles only: vertices lose their order */
    HOST_FORMAT_VTK,     /* legacy polydata 4.2, big-endian */
    HOST_FORMAT_OBJ,
    HOST_FORMAT_PLY_ASCII,
    HOST_FORMAT_VTK_ASCII
};

/* What a format's files end in, with the dot: four characters. */
const char *host_format_extension(int format);

/* The format of a path's extension, one of the first four, or -1. */
int host_format_of(const char *path);

/* Writes the mesh in a format into the buffer, which stores failure. */
void host_mesh_write(const host_mesh *mesh, int format, host_buffer *buffer);

/* Writes a binary PLY whose vertices have a colour, red, green, blue. */
void host_mesh_write_coloured(const host_mesh *mesh, const unsigned char colour[3], host_buffer *buffer);

/* What is known of each vertex. */
typedef struct host_vertex_values {
    const unsigned char *seen;   /* [n_vertices] 0 or 1 */
    const float *expected_error; /* [n_vertices] mm; -1: unknown */
    const float *across, *along; /* [n_vertices] parts of expected_error across the surface and along it, mm */
    const float *displacement;   /* [n_vertices][3] mm, from where the vertex was in the model */
    const float *local_volume;   /* [n_vertices] around the vertex, over that in the model */
} host_vertex_values;

/* Writes PLY, whose vertices have the properties seen, expected_error, local_volume and the parts of the error then, or
 * VTK with all as arrays of point data. Other formats hold none of them. */
void host_mesh_write_judged(const host_mesh *mesh, int format, const host_vertex_values *values, host_buffer *buffer);

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

/* A side of a triangle whose ends differ. */
typedef struct host_half_edge {
    uint32_t other; /* the larger vertex */
    uint32_t side;  /* 3 times the triangle, plus which of its corners the side starts at */
} host_half_edge;

/* Half-edges grouped by their smaller vertex v: edge[first[v]] to edge[first[v + 1] - 1], sorted by `other`, then by
 * `side`. Half-edges of one edge are therefore neighbours. */
typedef struct host_half_edges {
    size_t *first;        /* [n_vertices + 2]; owned */
    host_half_edge *edge; /* owned */
} host_half_edges;

/* 0, or -1 when out of memory. */
int host_half_edges_make(const smr_mesh *mesh, host_half_edges *edges);

void host_half_edges_free(host_half_edges *edges);

/* The end of the run of half-edges that belong to the same edge as number i of vertex v. */
static inline size_t host_half_edges_end(const host_half_edges *edges, size_t v, size_t i)
{
    size_t end = i + 1u;
    while (end < edges->first[v + 1u] && edges->edge[end].other == edges->edge[i].other)
        end++;
    return end;
}

#endif
