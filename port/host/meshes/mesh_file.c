/* mesh_file.c: reads a mesh file of any format: finds the format, calls its reader, checks and mirrors the mesh.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "files/file_names.h"
#include "files/file_read.h"
#include "meshes/mesh_reader.h"

/* Grows an array to at least `need` rows of 12 bytes; at least doubles its capacity, up to `limit` rows. */
static int grow(host_mesh_reader *reader, void **array, size_t *capacity, size_t need, size_t limit, const char *what)
{
    size_t next = *capacity * 2u;
    if (need <= *capacity)
        return 0;
    if (need > limit)
        return host_reader_fail(reader, "at most %zu %s", limit, what);
    if (next < need)
        next = need;
    if (next > limit)
        next = limit;
    void *grown = realloc(*array, next * 12u);
    if (grown == NULL)
        return host_reader_fail(reader, "%zu bytes of free memory", next * 12u);
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

int host_reader_vertex(host_mesh_reader *r, const double *xyz)
{
    host_mesh *const mesh = r->mesh;
    const double limit = (double)SMR_COORD_MAX;
    for (int i = 0; i < 3; i++)
        if (!(xyz[i] >= -limit && xyz[i] <= limit)) /* written so that NaN fails */
            return host_reader_fail(r, "finite coordinates within +-%.0f mm, found %g", limit, xyz[i]);
    if (mesh->n_vertices >= r->vertex_capacity && host_reader_reserve(r, (size_t)mesh->n_vertices + 1u, 0) != 0)
        return -1;
    float *to = mesh->xyz + 3u * (size_t)mesh->n_vertices;
    for (int i = 0; i < 3; i++)
        to[i] = (float)xyz[i];
    mesh->n_vertices++;
    return 0;
}

int host_reader_normal(host_mesh_reader *reader, const double *normal)
{
    void *rows = reader->mesh->normals;
    if (!reader->cloud)
        return 0;
    int result = grow(reader, &rows, &reader->normal_capacity, reader->n_normals + 1u, SMR_VERTICES_MAX, "normals");
    reader->mesh->normals = rows;
    if (result != 0)
        return -1;
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int i = 0; i < 3; i++) /* written so that NaN and infinity fail */
        reader->mesh->normals[3u * reader->n_normals + (size_t)i] =
            length > 1e-6 && length < 1e6 ? (float)(normal[i] / length) : 0.0f;
    reader->n_normals++;
    return 0;
}

int host_reader_triangle(host_mesh_reader *r, uint32_t a, uint32_t b, uint32_t c)
{
    host_mesh *const mesh = r->mesh;
    if (mesh->n_triangles >= r->triangle_capacity && host_reader_reserve(r, 0, (size_t)mesh->n_triangles + 1u) != 0)
        return -1;
    uint32_t *to = mesh->triangles + 3u * (size_t)mesh->n_triangles;
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

int host_reader_fail(const host_mesh_reader *reader, const char *expected, ...)
{
    va_list list;
    va_start(list, expected);
    (void)vsnprintf(reader->error->expected, sizeof reader->error->expected, expected, list);
    va_end(list);
    (void)snprintf(reader->error->place, sizeof reader->error->place, "%s %" PRIu64, reader->unit, reader->number);
    return -1;
}

int host_numbers_fit(const host_numbers *from, host_type type, uint64_t n)
{
    const size_t left = (size_t)(from->text.end - from->text.at);
    /* text: a digit and a space each, but for the last */
    return from->binary ? n <= left / host_type_bytes(type) : n <= (left + 1u) / 2u;
}

int host_numbers_value(host_numbers *from, host_type type, double *value)
{
    host_word word;
    if (from->binary) {
        if (!host_numbers_fit(from, type, 1))
            return host_reader_truncated(from->reader);
        *value = host_type_read(type, (const unsigned char *)from->text.at, from->big_endian);
        from->text.at += host_type_bytes(type);
        return 0;
    }
    if (!host_text_word(&from->text, &word))
        return host_reader_truncated(from->reader);
    if (!host_word_double(word, value))
        return host_reader_fail(from->reader, "a number, found '%.*s'", (int)(word.n < 40 ? word.n : 40), word.start);
    return 0;
}

int host_numbers_index(host_numbers *from, host_type type, uint64_t n, uint32_t *index)
{
    double value = 0.0;
    if (host_numbers_value(from, type, &value) != 0)
        return -1;
    if (!(value >= 0.0 && value < (double)n) || (double)(uint32_t)value < value)
        return host_reader_fail(from->reader, "vertex indexes from 0 to %lld, found %.10g", (long long)n - 1, value);
    *index = (uint32_t)value;
    return 0;
}

int host_numbers_three(host_numbers *from, host_type type, double value[3])
{
    for (int i = 0; i < 3; i++)
        if (host_numbers_value(from, type, &value[i]) != 0)
            return -1;
    return 0;
}

int host_numbers_skip(host_numbers *from, host_type type, uint64_t n)
{
    double ignored = 0.0;
    if (from->binary) {
        if (!host_numbers_fit(from, type, n))
            return host_reader_truncated(from->reader);
        from->text.at += host_type_bytes(type) * (size_t)n;
        return 0;
    }
    for (; n > 0; n--)
        if (host_numbers_value(from, type, &ignored) != 0)
            return -1;
    return 0;
}

int host_reader_truncated(const host_mesh_reader *reader)
{
    return host_reader_fail(reader, "more data, but the file ends here");
}

static void load_one(void *arg, uint32_t task, uint32_t worker)
{
    host_load *const load = (host_load *)arg + task;
    (void)worker;
    load->failed = host_mesh_read(load->path, load->need, load->mirror, &load->mesh, &load->error);
}

int host_load_all(const smr_port *port, host_load *loads, uint32_t n, host_error *error)
{
    uint32_t i = 0;
    host_parallel(port, load_one, loads, n);
    for (i = 0; i < n && !loads[i].failed; i++)
        continue;
    if (i == n)
        return 0;
    *error = loads[i].error;
    for (uint32_t k = 0; k < n; k++)
        host_mesh_free(&loads[k].mesh);
    return -1;
}

typedef int (*read_function)(host_mesh_reader *reader, const unsigned char *data, size_t n);

/* Length of the UTF-8 byte order mark that the data starts with, 0 without one. */
static size_t mark_bytes(const unsigned char *data, size_t n)
{
    return n >= 3u && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3u : 0u;
}

/* 1 when the first line that is neither empty nor a comment is one of OBJ. */
static int looks_like_obj(const unsigned char *head, size_t n)
{
    host_text text = host_text_over(head, n);
    host_word line, w;
    while (host_text_line(&text, &line)) {
        host_text words = host_text_over(line.start, line.n);
        if (!host_text_word_in_line(&words, &w) || w.start[0] == '#')
            continue;
        return host_word_is(w, "v") || host_word_is(w, "mtllib") || host_word_is(w, "o") || host_word_is(w, "g");
    }
    return 0;
}

/* Finds the reader by the content, or by the extension where the content does not decide. head: without a mark. */
static read_function reader_for(const char *path, const unsigned char *head, size_t n, size_t total)
{
    if (host_starts_with(head, n, "ply\n") || host_starts_with(head, n, "ply\r"))
        return host_read_ply;
    if (host_starts_with(head, n, "# vtk DataFile"))
        return host_read_vtk;
    if (host_is_binary_stl(head, n, total))
        return host_read_stl;
    if (host_has_extension(path, ".ply"))
        return host_read_ply;
    if (host_has_extension(path, ".stl") || host_is_ascii_stl(head, n))
        return host_read_stl;
    if (host_has_extension(path, ".vtk"))
        return host_read_vtk;
    if (host_has_extension(path, ".obj") || looks_like_obj(head, n))
        return host_read_obj;
    return NULL;
}

/* A cloud may be a CSV file, too. */
static read_function cloud_reader(const char *path, const unsigned char *head, size_t n, size_t total)
{
    const read_function found = reader_for(path, head, n, total);
    return found == NULL && host_has_extension(path, ".csv") ? host_read_csv : found;
}

static int accept_mesh(const host_head *head, host_error *error)
{
    const size_t skip = mark_bytes(head->data, head->n);
    if (reader_for(head->path, head->data + skip, head->n - skip, head->total - skip) == NULL)
        return host_fail(error, "content", "a PLY, STL, OBJ or legacy VTK polydata file");
    return 0;
}

static int accept_cloud(const host_head *head, host_error *error)
{
    const size_t skip = mark_bytes(head->data, head->n);
    if (cloud_reader(head->path, head->data + skip, head->n - skip, head->total - skip) == NULL)
        return host_fail(error, "content", "a PLY, STL, OBJ, legacy VTK polydata or CSV file");
    return 0;
}

static int check(const host_mesh *mesh, int need, host_error *error)
{
    if (mesh->n_vertices == 0)
        return host_fail(error, "vertices", "at least one vertex");
    if (need == HOST_MESH_SURFACE && mesh->n_triangles == 0)
        return host_fail(error, "faces", "at least one triangle, for a surface is needed here");
    return 0;
}

/* Normals that are not those of the points. */
static void drop_normals(const host_mesh_reader *reader)
{
    host_mesh *const mesh = reader->mesh;
    if (mesh->n_triangles == 0 && reader->n_normals == mesh->n_vertices)
        return;
    free(mesh->normals);
    mesh->normals = NULL;
}

int host_mesh_read(const char *path, int need, int mirror, host_mesh *mesh, host_error *error)
{
    host_bytes bytes;
    host_mesh_reader reader = {.mesh = mesh, .error = error, .unit = "header line", .cloud = need == HOST_MESH_CLOUD};
    memset(mesh, 0, sizeof *mesh);
    if (host_file_read(path, reader.cloud ? accept_cloud : accept_mesh, &bytes, error) != 0)
        return -1;
    size_t skip = mark_bytes(bytes.data, bytes.size);
    read_function read =
        (reader.cloud ? cloud_reader : reader_for)(path, bytes.data + skip, bytes.size - skip, bytes.size - skip);
    int result = read != NULL ? read(&reader, bytes.data + skip, bytes.size - skip)
                              : host_fail(error, "content", "a PLY, STL, OBJ or legacy VTK polydata file");
    host_file_free(&bytes);
    if (result == 0)
        result = check(mesh, need, error);
    if (result != 0) {
        host_mesh_free(mesh);
        return -1;
    }
    drop_normals(&reader);
    for (int axis = 0; reader.ras && axis < 2; axis++) /* RAS to LPS: a rotation, which keeps the triangles' outside */
        host_mesh_negate(mesh, axis);
    if (mirror != HOST_MIRROR_NONE)
        host_mesh_mirror(mesh, mirror);
    return 0;
}
