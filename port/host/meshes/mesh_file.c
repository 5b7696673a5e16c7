/* mesh_file.c: reads a mesh file of any format: finds the format, calls its reader, checks and mirrors the mesh.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "base/text_scan.h"
#include "files/file_names.h"
#include "files/file_read.h"
#include "meshes/mesh_reader.h"

typedef int (*read_function)(host_mesh_reader *reader, const unsigned char *data, size_t n);

/* Length of the UTF-8 byte order mark that the data starts with, 0 without one. */
static size_t mark_bytes(const unsigned char *data, size_t n)
{
    return n >= 3u && memcmp(data, "\xef\xbb\xbf", 3) == 0 ? 3u : 0u;
}

static int starts_with(const unsigned char *head, size_t n, const char *text)
{
    const size_t k = strlen(text);
    return n >= k && memcmp(head, text, k) == 0;
}

/* 1 when the first line that is neither empty nor a comment is one of OBJ. */
static int looks_like_obj(const unsigned char *head, size_t n)
{
    host_text text = host_text_over(head, n);
    host_word line, word;
    while (host_text_line(&text, &line)) {
        host_text words = host_text_over(line.start, line.n);
        if (!host_text_word_in_line(&words, &word) || word.start[0] == '#')
            continue;
        return host_word_is(word, "v") || host_word_is(word, "mtllib") || host_word_is(word, "o") ||
               host_word_is(word, "g");
    }
    return 0;
}

/* Finds the reader by the content, or by the extension where the content does not decide. head: without a mark. */
static read_function reader_for(const char *path, const unsigned char *head, size_t n, size_t total)
{
    if (starts_with(head, n, "ply\n") || starts_with(head, n, "ply\r"))
        return host_read_ply;
    if (starts_with(head, n, "# vtk DataFile"))
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

static int accept_mesh(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    const size_t skip = mark_bytes(head, n);
    if (reader_for(path, head + skip, n - skip, total - skip) == NULL)
        return host_fail(error, "content", "a PLY, STL, OBJ or legacy VTK polydata file");
    return 0;
}

/* A cloud may be a CSV file, too. */
static read_function cloud_reader(const char *path, const unsigned char *head, size_t n, size_t total)
{
    const read_function found = reader_for(path, head, n, total);
    return found == NULL && host_has_extension(path, ".csv") ? host_read_csv : found;
}

static int accept_cloud(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    const size_t skip = mark_bytes(head, n);
    if (cloud_reader(path, head + skip, n - skip, total - skip) == NULL)
        return host_fail(error, "content", "a PLY, STL, OBJ, legacy VTK polydata or CSV file");
    return 0;
}

/* Turns RAS into LPS: a rotation by 180 degrees about the third axis, which keeps the triangles' outside. */
static void turn_ras(host_mesh *mesh)
{
    size_t i = 0;
    for (i = 0; i < mesh->n_vertices; i++) {
        mesh->xyz[3u * i] = -mesh->xyz[3u * i];
        mesh->xyz[3u * i + 1u] = -mesh->xyz[3u * i + 1u];
    }
    for (i = 0; mesh->normals != NULL && i < mesh->n_vertices; i++) {
        mesh->normals[3u * i] = -mesh->normals[3u * i];
        mesh->normals[3u * i + 1u] = -mesh->normals[3u * i + 1u];
    }
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
    host_mesh_reader reader;
    read_function read = NULL;
    size_t skip = 0;
    int result = 0;
    memset(mesh, 0, sizeof *mesh);
    memset(&reader, 0, sizeof reader);
    reader.mesh = mesh;
    reader.error = error;
    reader.unit = "header line";
    reader.cloud = need == HOST_MESH_CLOUD;
    if (host_file_read(path, reader.cloud ? accept_cloud : accept_mesh, &bytes, error) != 0)
        return -1;
    skip = mark_bytes(bytes.data, bytes.size);
    read = (reader.cloud ? cloud_reader : reader_for)(path, bytes.data + skip, bytes.size - skip, bytes.size - skip);
    result = read != NULL ? read(&reader, bytes.data + skip, bytes.size - skip)
                          : host_fail(error, "content", "a PLY, STL, OBJ or legacy VTK polydata file");
    host_file_free(&bytes);
    if (result == 0)
        result = check(mesh, need, error);
    if (result != 0) {
        host_mesh_free(mesh);
        return -1;
    }
    drop_normals(&reader);
    if (reader.ras)
        turn_ras(mesh);
    if (mirror != HOST_MIRROR_NONE)
        host_mesh_mirror(mesh, mirror);
    return 0;
}
