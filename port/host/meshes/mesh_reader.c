/* mesh_reader.c: adds vertices and triangles to the mesh being read. Memory grows with the data read, not with the
 * file's counts.
 * SPDX-License-Identifier: MIT */
#include "meshes/mesh_reader.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Grows an array to at least `need` rows of 12 bytes; at least doubles its capacity, up to `limit` rows. */
static int grow(host_mesh_reader *reader, void **array, size_t *capacity, size_t need, size_t limit, const char *what)
{
    size_t next = *capacity * 2u;
    void *grown = NULL;
    if (need <= *capacity)
        return 0;
    if (need > limit)
        return host_fail_at(reader->error, reader->unit, reader->number, "at most %zu %s", limit, what);
    if (next < need)
        next = need;
    if (next > limit)
        next = limit;
    grown = realloc(*array, next * 12u);
    if (grown == NULL)
        return host_fail_at(reader->error, reader->unit, reader->number, "%zu bytes of free memory", next * 12u);
    *array = grown;
    *capacity = next;
    return 0;
}

int host_reader_reserve(host_mesh_reader *reader, size_t vertices, size_t triangles)
{
    host_mesh *const mesh = reader->mesh;
    void *xyz = mesh->xyz, *rows = mesh->triangles;
    int result = grow(reader, &xyz, &reader->vertex_capacity, vertices, SMR_VERTICES_MAX, "vertices");
    mesh->xyz = xyz;
    if (result == 0)
        result = grow(reader, &rows, &reader->triangle_capacity, triangles, SMR_TRIANGLES_MAX, "triangles");
    mesh->triangles = rows;
    return result;
}

int host_reader_vertex(host_mesh_reader *reader, const double *xyz)
{
    host_mesh *const mesh = reader->mesh;
    const double limit = (double)SMR_COORD_MAX;
    int i = 0;
    float *to = NULL;
    for (i = 0; i < 3; i++)
        if (!(xyz[i] >= -limit && xyz[i] <= limit)) /* written so that NaN fails */
            return host_fail_at(reader->error, reader->unit, reader->number,
                                "finite coordinates within +-%.0f mm, found %g", limit, xyz[i]);
    if (mesh->n_vertices >= reader->vertex_capacity &&
        host_reader_reserve(reader, (size_t)mesh->n_vertices + 1u, 0) != 0)
        return -1;
    to = mesh->xyz + 3u * (size_t)mesh->n_vertices;
    for (i = 0; i < 3; i++)
        to[i] = (float)xyz[i];
    mesh->n_vertices++;
    return 0;
}

int host_reader_normal(host_mesh_reader *reader, const double *normal)
{
    void *rows = reader->mesh->normals;
    double length = 0.0;
    int i = 0, result = 0;
    if (!reader->cloud)
        return 0;
    result = grow(reader, &rows, &reader->normal_capacity, reader->n_normals + 1u, SMR_VERTICES_MAX, "normals");
    reader->mesh->normals = rows;
    if (result != 0)
        return -1;
    length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (i = 0; i < 3; i++) /* written so that NaN and infinity fail */
        reader->mesh->normals[3u * reader->n_normals + (size_t)i] =
            length > 1e-6 && length < 1e6 ? (float)(normal[i] / length) : 0.0f;
    reader->n_normals++;
    return 0;
}

int host_reader_triangle(host_mesh_reader *reader, uint32_t a, uint32_t b, uint32_t c)
{
    host_mesh *const mesh = reader->mesh;
    uint32_t *to = NULL;
    if (mesh->n_triangles >= reader->triangle_capacity &&
        host_reader_reserve(reader, 0, (size_t)mesh->n_triangles + 1u) != 0)
        return -1;
    to = mesh->triangles + 3u * (size_t)mesh->n_triangles;
    to[0] = a;
    to[1] = b;
    to[2] = c;
    mesh->n_triangles++;
    return 0;
}

int host_reader_fan(host_mesh_reader *reader, uint32_t state[3], uint32_t index)
{
    const uint32_t before = state[2];
    const uint32_t n = state[0]++;
    if (n == 0)
        state[1] = index;
    state[2] = index;
    return n < 2 ? 0 : host_reader_triangle(reader, state[1], before, index);
}

int host_reader_truncated(const host_mesh_reader *reader)
{
    return host_fail_at(reader->error, reader->unit, reader->number, "more data, but the file ends here");
}
