/* surface_net.c: builds the surface net of a label. A cell that the surface passes several times has as many vertices,
 * so each edge has exactly two quadrangles.
 * Source: S. F. F. Gibson, "Constrained elastic surface nets", 1998; for several vertices in a cell, see cell_loops.c.
 * SPDX-License-Identifier: MIT */
#include "labels/surface_net.h"
#include <stdlib.h>
#include <string.h>
#include "smr.h"

void host_cell_edge(unsigned edge, unsigned corner[2])
{
    const unsigned a = edge / 4u;
    corner[0] = (edge & 1u) << (a + 1u) % 3u | (edge >> 1 & 1u) << (a + 2u) % 3u;
    corner[1] = corner[0] | 1u << a;
}

/* The face's corners in a circle; edge k runs from corner k to corner k + 1. */
static void face_circle(unsigned face, unsigned corner[4], unsigned edge[4])
{
    const unsigned a = face / 2u, s = face % 2u, b = (a + 1u) % 3u, c = (a + 2u) % 3u;
    corner[0] = s << a;
    corner[1] = corner[0] | 1u << b;
    corner[2] = corner[1] | 1u << c;
    corner[3] = corner[0] | 1u << c;
    edge[0] = 4u * b + 2u * s;
    edge[1] = 4u * c + s + 2u;
    edge[2] = 4u * b + 2u * s + 1u;
    edge[3] = 4u * c + s;
}

static void unite(unsigned char set[HOST_CELL_EDGES], unsigned a, unsigned b)
{
    const unsigned char from = set[a] > set[b] ? set[a] : set[b], to = set[a] > set[b] ? set[b] : set[a];
    for (unsigned e = 0; e < HOST_CELL_EDGES; e++)
        if (set[e] == from)
            set[e] = to;
}

/* Joins the edges that belong together on a face. Returns 1 when its four edges are crossed. */
static int join_on_face(unsigned mask, unsigned face, int joined, unsigned char group[HOST_CELL_EDGES])
{
    unsigned corner[4], edge[4], k = 0, n = 0, crossed[4] = {0};
    face_circle(face, corner, edge);
    for (k = 0; k < 4u; k++)
        if ((mask >> corner[k] & 1u) != (mask >> corner[(k + 1u) % 4u] & 1u))
            crossed[n++] = edge[k];
    if (n == 2u)
        unite(group, crossed[0], crossed[1]);
    for (k = 0; n == 4u && k < 4u; k++)
        if ((mask >> corner[k] & 1u) != (unsigned)joined) /* this corner is cut off */
            unite(group, edge[(k + 3u) % 4u], edge[k]);
    return n == 4u;
}

host_loops host_cell_loops(unsigned mask, unsigned joined)
{
    unsigned char group[HOST_CELL_EDGES], name[HOST_CELL_EDGES];
    unsigned corner[4], edge[4], e = 0, f = 0, four = 0;
    host_loops loops = {0};
    memset(name, HOST_NO_LOOP, sizeof name);
    for (e = 0; e < HOST_CELL_EDGES; e++)
        group[e] = (unsigned char)e;
    for (f = 0; f < HOST_CELL_FACES; f++)
        four |= (unsigned)join_on_face(mask, f, (int)(joined >> f & 1u), group) << f;
    for (e = 0; e < HOST_CELL_EDGES; e++) {
        host_cell_edge(e, corner);
        loops.of[e] = HOST_NO_LOOP;
        if ((mask >> corner[0] & 1u) == (mask >> corner[1] & 1u))
            continue;
        if (name[group[e]] == HOST_NO_LOOP)
            name[group[e]] = loops.n++;
        loops.of[e] = name[group[e]];
    }
    for (f = 0; f < HOST_CELL_FACES; f++) {
        face_circle(f, corner, edge);
        if ((four >> f & 1u) != 0 && loops.of[edge[0]] == loops.of[edge[1]] && loops.of[edge[1]] == loops.of[edge[2]])
            loops.twice |= (unsigned char)(1u << f);
    }
    return loops;
}

#define MARGIN 0.02f /* voxels: between a vertex and the walls of its cell */

typedef struct builder {
    const uint32_t *cell;
    const unsigned char *mask;
    size_t n;
    const uint32_t *size;
    const float *spacing;
    uint32_t stride[3];     /* from a cell's number to the next one's along each axis */
    host_loops table[256];  /* by mask */
    unsigned char *joined;  /* [n] for host_cell_loops; owned */
    uint32_t *first_vertex; /* [n] of each cell; owned */
    host_net *net;
} builder;

/* Where a cell is in the list; n when it is not. */
static size_t find_cell(const builder *b, uint32_t cell)
{
    size_t low = 0, high = b->n;
    while (low < high) {
        const size_t middle = low + (high - low) / 2u;
        if (b->cell[middle] < cell)
            low = middle + 1u;
        else
            high = middle;
    }
    return low < b->n && b->cell[low] == cell ? low : b->n;
}

/* Where one loop would cross a face twice in both its cells, the face's inside corners are joined: else an edge of the
 * net would have four quadrangles. */
static void join_faces(builder *b)
{
    for (size_t i = 0; i < b->n; i++) {
        const unsigned twice = b->table[b->mask[i]].twice;
        for (unsigned a = 0; a < 3u; a++) {
            if ((twice >> (2u * a + 1u) & 1u) == 0)
                continue;
            size_t next = find_cell(b, b->cell[i] + b->stride[a]);
            if (next < b->n && ((unsigned)b->table[b->mask[next]].twice >> 2u * a & 1u) != 0) {
                b->joined[i] |= (unsigned char)(1u << (2u * a + 1u));
                b->joined[next] |= (unsigned char)(1u << 2u * a);
            }
        }
    }
}

static host_loops loops_of(const builder *b, size_t i)
{
    return b->joined[i] == 0 ? b->table[b->mask[i]] : host_cell_loops(b->mask[i], b->joined[i]);
}

/* The middle of an edge in its cell, 0 to 1 along each axis. */
static void edge_middle(unsigned edge, float at[3])
{
    unsigned corner[2], k = 0;
    host_cell_edge(edge, corner);
    for (k = 0; k < 3u; k++)
        at[k] = 0.5f * (float)((corner[0] >> k & 1u) + (corner[1] >> k & 1u));
}

/* The vertex of a loop starts in the middle of the crossed edges. Of several loops each keeps to its part of a cell. */
static void place_vertex(const builder *b, size_t i, const host_loops *loops, unsigned loop)
{
    const uint32_t c = b->cell[i], v = b->first_vertex[i] + loop;
    const uint32_t index[3] = {c % b->stride[1], c / b->stride[1] % (b->size[1] + 1u), c / b->stride[2]};
    float sum[3] = {0}, low[3] = {1, 1, 1}, high[3] = {0}, n = 0.0f;
    for (unsigned e = 0; e < HOST_CELL_EDGES; e++) {
        float at[3];
        if (loops->of[e] != loop)
            continue;
        edge_middle(e, at);
        n += 1.0f;
        for (unsigned k = 0; k < 3u; k++) {
            sum[k] += at[k];
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    for (unsigned k = 0; k < 3u; k++) {
        const float wall = (float)index[k] - 1.0f, mm = b->spacing[k];
        const float from = loops->n > 1u ? low[k] : 0.0f, to = loops->n > 1u ? high[k] : 1.0f;
        b->net->xyz[3u * (size_t)v + k] = (wall + sum[k] / n) * mm;
        b->net->low[3u * (size_t)v + k] = (wall + from + MARGIN) * mm;
        b->net->high[3u * (size_t)v + k] = (wall + to - MARGIN) * mm;
    }
}

static int place_vertices(builder *b)
{
    host_net *const net = b->net;
    size_t n = 0;
    for (size_t i = 0; i < b->n; i++) {
        b->first_vertex[i] = (uint32_t)n;
        n += loops_of(b, i).n;
        if (n > SMR_VERTICES_MAX)
            return -1;
    }
    net->n_vertices = (uint32_t)n;
    net->xyz = malloc((3u * n + 1u) * sizeof *net->xyz);
    net->start = malloc((3u * n + 1u) * sizeof *net->start);
    net->low = malloc((3u * n + 1u) * sizeof *net->low);
    net->high = malloc((3u * n + 1u) * sizeof *net->high);
    if (net->xyz == NULL || net->start == NULL || net->low == NULL || net->high == NULL)
        return -1;
    for (size_t i = 0; i < b->n; i++) {
        const host_loops loops = loops_of(b, i);
        for (unsigned loop = 0; loop < loops.n; loop++)
            place_vertex(b, i, &loops, loop);
    }
    for (size_t i = 0; i < 3u * n; i++) {
        const float x = net->xyz[i], low = net->low[i], high = net->high[i];
        net->xyz[i] = net->start[i] = x < low ? low : (x > high ? high : x);
    }
    return 0;
}

/* The vertex of a cell through whose loop an edge runs. */
static uint32_t vertex_at(const builder *b, size_t i, unsigned e) { return b->first_vertex[i] + loops_of(b, i).of[e]; }

/* The four cells around an edge are those before its cell along the two other axes; at[axis combination] follows them
 * while the cell moves on: the bits of the combination are the axes. */
static void add_quads_of(const builder *b, size_t i, size_t at[8])
{
    host_net *const net = b->net;
    for (unsigned set = 1; set < 7u; set++) {
        const uint32_t back = (set & 1u) * b->stride[0] + (set >> 1 & 1u) * b->stride[1] + (set >> 2) * b->stride[2];
        while (at[set] < b->n && b->cell[at[set]] + back < b->cell[i])
            at[set]++;
    }
    for (unsigned a = 0; a < 3u; a++) {
        const unsigned u = 1u << (a + 1u) % 3u, v = 1u << (a + 2u) % 3u, inside = b->mask[i] & 1u;
        uint32_t *const quad = net->quad + 4u * (size_t)net->n_quads;
        if ((b->mask[i] >> (1u << a) & 1u) == inside)
            continue;
        quad[0] = vertex_at(b, i, 4u * a);
        quad[inside ? 1 : 3] = vertex_at(b, at[u], 4u * a + 1u);
        quad[2] = vertex_at(b, at[u | v], 4u * a + 3u);
        quad[inside ? 3 : 1] = vertex_at(b, at[v], 4u * a + 2u);
        net->n_quads++;
    }
}

static int add_quads(builder *b)
{
    size_t i = 0, n = 0, at[8] = {0};
    for (i = 0; i < b->n; i++)
        for (unsigned a = 0; a < 3u; a++)
            n += ((b->mask[i] >> (1u << a)) & 1u) != (b->mask[i] & 1u);
    if (2u * n > SMR_TRIANGLES_MAX)
        return -1;
    b->net->quad = malloc(4u * n * sizeof *b->net->quad + 1u);
    b->net->split = calloc(n + 1u, 1);
    if (b->net->quad == NULL || b->net->split == NULL)
        return -1;
    for (i = 0; i < b->n; i++)
        add_quads_of(b, i, at);
    return 0;
}

/* Groups the sides by the vertex they start at. */
static int link_sides(host_net *net)
{
    const size_t n = 4u * (size_t)net->n_quads;
    size_t *const first = calloc((size_t)net->n_vertices + 2u, sizeof *first);
    net->side_first = first;
    net->side = malloc(n * sizeof *net->side + 1u);
    if (first == NULL || net->side == NULL)
        return -1;
    for (size_t i = 0; i < n; i++)
        first[net->quad[i] + 2u]++;
    for (size_t i = 2; i < (size_t)net->n_vertices + 2u; i++)
        first[i] += first[i - 1u];
    for (size_t i = 0; i < n; i++) {
        const uint32_t k = (uint32_t)(i % 4u), quad = (uint32_t)(i / 4u);
        net->side[first[net->quad[i] + 1u]++] = (host_net_side){net->quad[4u * (size_t)quad + (k + 1u) % 4u], quad, k};
    }
    return 0;
}

int host_net_make(const uint32_t *cell, const unsigned char *mask, size_t n, const uint32_t size[3],
                  const float spacing[3], host_net *net)
{
    const uint32_t row = size[0] + 1u;
    builder b = {cell, mask, n, size, spacing, {1, row, row * (size[1] + 1u)}, {{0}}, NULL, NULL, net};
    int result = -1;
    memset(net, 0, sizeof *net);
    for (unsigned k = 0; k < 256u; k++)
        b.table[k] = host_cell_loops(k, 0);
    b.joined = calloc(n + 1u, 1);
    b.first_vertex = malloc((n + 1u) * sizeof *b.first_vertex);
    if (b.joined != NULL && b.first_vertex != NULL) {
        join_faces(&b);
        result = place_vertices(&b) != 0 || add_quads(&b) != 0 || link_sides(net) != 0 ? -1 : 0;
    }
    free(b.joined);
    free(b.first_vertex);
    return result;
}

void host_net_free(host_net *net)
{
    free(net->xyz);
    free(net->start);
    free(net->low);
    free(net->high);
    free(net->quad);
    free(net->split);
    free(net->side_first);
    free(net->side);
    memset(net, 0, sizeof *net);
}
