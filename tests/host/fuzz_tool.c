/* fuzz_tool.c: feeds damaged meshes to the readers. Each must be refused with a place and an expectation, or give a
 * mesh whose every index and coordinate is legal. Usage: fuzz_tool FILE N SEED. With HOST_LIBFUZZER defined it is a
 * libFuzzer target instead; the first byte of its input chooses the reader.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_read.h"
#include "meshes/mesh_reader.h"

typedef int (*fuzz_reader)(host_mesh_reader *reader, const unsigned char *data, size_t n);

enum { READERS = 5 };
static const fuzz_reader readers[READERS] = {host_read_ply, host_read_stl, host_read_obj, host_read_vtk, host_read_csv};

/* Reads from a copy of exactly n bytes, so that a sanitizer sees every step beyond. 1: read, 0: refused. */
static int try_one(fuzz_reader read, const unsigned char *data, size_t n)
{
    unsigned char *const copy = malloc(n > 0 ? n : 1u);
    host_mesh mesh;
    host_error error;
    host_mesh_reader reader;
    memset(&mesh, 0, sizeof mesh);
    memset(&error, 0, sizeof error);
    memset(&reader, 0, sizeof reader);
    reader.mesh = &mesh;
    reader.error = &error;
    reader.unit = "header line";
    reader.cloud = 1; /* normals are read, too */
    if (copy == NULL)
        abort();
    if (n > 0)
        memcpy(copy, data, n);
    int good = read(&reader, copy, n) == 0;
    if (!good && (error.place[0] == '\0' || error.expected[0] == '\0'))
        abort();
    for (size_t i = 0; good && i < 3u * (size_t)mesh.n_triangles; i++)
        if (mesh.triangles[i] >= mesh.n_vertices)
            abort();
    for (size_t i = 0; good && i < 3u * (size_t)mesh.n_vertices; i++)
        if (!(mesh.xyz[i] >= -SMR_COORD_MAX && mesh.xyz[i] <= SMR_COORD_MAX))
            abort();
    for (size_t i = 0; good && i < 3u * reader.n_normals; i++)
        if (!(mesh.normals[i] >= -1.001f && mesh.normals[i] <= 1.001f))
            abort();
    host_mesh_free(&mesh);
    free(copy);
    return good;
}

#ifdef HOST_LIBFUZZER

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t n);

int LLVMFuzzerTestOneInput(const unsigned char *data, size_t n)
{
    if (n > 0)
        (void)try_one(readers[data[0] % READERS], data + 1, n - 1u);
    return 0;
}

#else

static uint32_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)(*state >> 33);
}

/* A few bytes changed, a piece cut out or doubled, or the end cut off. */
static size_t damage(unsigned char *data, size_t n, uint64_t *state)
{
    static const char digits[] = "0123456789-.e \n";
    const size_t at = next_random(state) % n;
    size_t i = next_random(state) % 4u + 1u, piece = next_random(state) % 40u;
    switch (next_random(state) % 5u) {
    case 0: return at;
    case 1:
        piece = piece < n - at ? piece : n - at;
        memmove(data + at, data + at + piece, n - at - piece);
        return n - piece;
    case 2:
        piece = piece < n - at ? piece : n - at;
        memmove(data + at + piece, data + at, n - at); /* there is room for it */
        return n + piece;
    case 3:
        for (; i > 0; i--)
            data[next_random(state) % n] = (unsigned char)digits[next_random(state) % (sizeof digits - 1u)];
        return n;
    default:
        for (; i > 0; i--)
            data[next_random(state) % n] = (unsigned char)(next_random(state) & 255u);
        return n;
    }
}

int main(int argc, char **argv)
{
    host_bytes bytes;
    host_error error;
    long i = 0, n = 0, good = 0;
    memset(&error, 0, sizeof error);
    if (argc != 4 || (n = atol(argv[2])) < 1) {
        (void)fputs("usage: fuzz_tool FILE N SEED\n", stderr);
        return 2;
    }
    uint64_t state = (uint64_t)atol(argv[3]);
    if (host_file_read(argv[1], NULL, &bytes, &error) != 0) {
        host_error_print(&error);
        return 2;
    }
    unsigned char *work = malloc(bytes.size + 64u);
    for (i = 0; work != NULL && i < n; i++) {
        size_t size = 0;
        uint32_t r = 0;
        memcpy(work, bytes.data, bytes.size);
        size = damage(work, bytes.size, &state);
        for (r = 0; r < READERS; r++)
            good += try_one(readers[r], work, size);
    }
    printf("%ld of %ld read, the others refused\n", good, READERS * n);
    free(work);
    host_file_free(&bytes);
    return i == n ? 0 : 1;
}

#endif
