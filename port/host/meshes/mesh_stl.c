/* mesh_stl.c: reads STL, ASCII and binary. The format repeats the vertices of every triangle; equal positions are
 * merged into one vertex, numbered by first appearance.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include "meshes/mesh_reader.h"

#define HEADER_BYTES 84u
#define FACET_BYTES 50u
#define EMPTY 0xffffffffu

/* A hash table of vertex indexes by the coordinates' bits: open addressing, at most half full. */
typedef struct weld {
    uint32_t *slot;
    uint32_t mask;
} weld;

static uint32_t hash_of(const float *xyz)
{
    uint32_t bits[3];
    uint64_t h = 0x9e3779b97f4a7c15ull;
    memcpy(bits, xyz, sizeof bits);
    for (int i = 0; i < 3; i++) {
        h = (h ^ bits[i]) * 0xff51afd7ed558ccdull;
        h ^= h >> 32;
    }
    return (uint32_t)h;
}

static void place(const weld *table, const float *xyz, uint32_t index)
{
    uint32_t at = hash_of(xyz) & table->mask;
    while (table->slot[at] != EMPTY)
        at = (at + 1u) & table->mask;
    table->slot[at] = index;
}

/* Makes a table of `size` slots (a power of two) that holds the mesh's vertices. */
static int resize(weld *table, const host_mesh *mesh, uint32_t size)
{
    free(table->slot);
    table->slot = malloc(sizeof *table->slot * size);
    if (table->slot == NULL)
        return -1;
    table->mask = size - 1u;
    memset(table->slot, 0xff, sizeof *table->slot * size);
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        place(table, mesh->xyz + 3u * (size_t)i, i);
    return 0;
}

static int weld_vertex(host_mesh_reader *reader, weld *table, const double *xyz, uint32_t *index)
{
    host_mesh *const mesh = reader->mesh;
    float point[3];
    uint32_t at = 0;
    if (host_reader_vertex(reader, xyz) != 0)
        return -1;
    for (int i = 0; i < 3; i++) /* adding zero turns -0 into 0 */
        point[i] = mesh->xyz[3u * (size_t)(mesh->n_vertices - 1u) + (size_t)i] + 0.0f;
    mesh->n_vertices--;
    for (at = hash_of(point) & table->mask; table->slot[at] != EMPTY; at = (at + 1u) & table->mask)
        if (memcmp(mesh->xyz + 3u * (size_t)table->slot[at], point, sizeof point) == 0) {
            *index = table->slot[at];
            return 0;
        }
    memcpy(mesh->xyz + 3u * (size_t)mesh->n_vertices, point, sizeof point);
    *index = mesh->n_vertices++;
    table->slot[at] = *index;
    if (mesh->n_vertices > table->mask / 2u && resize(table, mesh, 2u * (table->mask + 1u)) != 0)
        return host_reader_fail(reader, "more free memory");
    return 0;
}

static uint64_t facets_claimed(const unsigned char *data)
{
    return (uint64_t)data[80] | (uint64_t)data[81] << 8 | (uint64_t)data[82] << 16 | (uint64_t)data[83] << 24;
}

int host_is_binary_stl(const unsigned char *head, size_t n, size_t total)
{
    return n >= HEADER_BYTES && total == HEADER_BYTES + FACET_BYTES * (size_t)facets_claimed(head);
}

int host_is_ascii_stl(const unsigned char *head, size_t n)
{
    host_text text = host_text_over(head, n < 5u ? n : 5u);
    host_word word;
    return n > 5u && (head[5] == ' ' || head[5] == '\t' || head[5] == '\r' || head[5] == '\n') &&
           host_text_word_in_line(&text, &word) && host_word_is_nocase(word, "solid");
}

static int read_binary(host_mesh_reader *reader, weld *table, const unsigned char *data, size_t n)
{
    host_word title;
    if (n < HEADER_BYTES)
        return host_fail(reader->error, "header", "84 bytes, but the file ends after %zu", n);
    uint64_t count = facets_claimed(data);
    title.start = (const char *)data;
    title.n = 80;
    reader->ras = host_word_has(title, "SPACE=RAS");
    if (count > (n - HEADER_BYTES) / FACET_BYTES)
        return host_fail(reader->error, "header", "a count the file can hold, found %llu faces in %zu bytes",
                         (unsigned long long)count, n);
    if (host_reader_reserve(reader, 0, (size_t)count) != 0)
        return -1;
    reader->unit = "face";
    for (reader->number = 0; reader->number < count; reader->number++) {
        const unsigned char *const facet = data + HEADER_BYTES + FACET_BYTES * (size_t)reader->number;
        uint32_t corner[3];
        for (uint32_t i = 0; i < 3; i++) {
            double xyz[3];
            for (uint32_t k = 0; k < 3; k++)
                xyz[k] = host_type_read(HOST_TYPE_F32, facet + 12u + 12u * i + 4u * k, 0);
            if (weld_vertex(reader, table, xyz, &corner[i]) != 0)
                return -1;
        }
        if (host_reader_triangle(reader, corner[0], corner[1], corner[2]) != 0)
            return -1;
    }
    return 0;
}

static int expect_word(host_mesh_reader *reader, host_text *text, const char *name)
{
    host_word word;
    const int there = host_text_word(text, &word);
    reader->number = text->line;
    if (!there)
        return host_reader_fail(reader, "'%s', but the file ends here", name);
    if (!host_word_is_nocase(word, name))
        return host_reader_fail(reader, "'%s', found '%.*s'", name, (int)(word.n < 40 ? word.n : 40), word.start);
    return 0;
}

static int read_numbers(host_mesh_reader *reader, host_text *text, double *xyz)
{
    for (int i = 0; i < 3; i++) {
        host_word word;
        const int there = host_text_word(text, &word);
        reader->number = text->line;
        if (!there)
            return host_reader_truncated(reader);
        if (!host_word_double(word, &xyz[i]))
            return host_reader_fail(reader, "a number, found '%.*s'", (int)(word.n < 40 ? word.n : 40), word.start);
    }
    return 0;
}

static int read_facet(host_mesh_reader *reader, weld *table, host_text *text)
{
    uint32_t corner[3] = {0, 0, 0};
    double xyz[3];
    if (expect_word(reader, text, "normal") != 0 || read_numbers(reader, text, xyz) != 0 ||
        expect_word(reader, text, "outer") != 0 || expect_word(reader, text, "loop") != 0)
        return -1;
    for (uint32_t i = 0; i < 3; i++)
        if (expect_word(reader, text, "vertex") != 0 || read_numbers(reader, text, xyz) != 0 ||
            weld_vertex(reader, table, xyz, &corner[i]) != 0)
            return -1;
    if (expect_word(reader, text, "endloop") != 0 || expect_word(reader, text, "endfacet") != 0)
        return -1;
    return host_reader_triangle(reader, corner[0], corner[1], corner[2]);
}

static int read_ascii(host_mesh_reader *reader, weld *table, const unsigned char *data, size_t n)
{
    host_text text = host_text_over(data, n);
    host_word word;
    int inside = 0;
    reader->unit = "line";
    while (host_text_word(&text, &word)) {
        reader->number = text.line;
        if (!inside && host_word_is_nocase(word, "solid")) {
            inside = host_text_line(&text, &word);
            reader->ras |= host_word_has(word, "SPACE=RAS");
        } else if (inside && host_word_is_nocase(word, "facet")) {
            if (read_facet(reader, table, &text) != 0)
                return -1;
        } else if (inside && host_word_is_nocase(word, "endsolid")) {
            (void)host_text_line(&text, &word);
            inside = 0;
        } else {
            return host_reader_fail(reader, "%s, found '%.*s'", inside ? "facet or endsolid" : "solid",
                                    (int)(word.n < 40 ? word.n : 40), word.start);
        }
    }
    reader->number = text.line;
    if (inside)
        return host_reader_fail(reader, "endsolid, but the file ends here");
    return 0;
}

int host_read_stl(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    weld table = {NULL, 0};
    const int ascii = host_is_ascii_stl(data, n) && !host_is_binary_stl(data, n, n) &&
                      memchr(data, '\0', n < HEADER_BYTES ? n : HEADER_BYTES) == NULL;
    if (resize(&table, reader->mesh, 1024u) != 0)
        return host_fail(reader->error, "file", "more free memory");
    int result = ascii ? read_ascii(reader, &table, data, n) : read_binary(reader, &table, data, n);
    free(table.slot);
    return result;
}
