/* label_paint.c: paints surfaces as a label map, then gives voxels inside several surfaces to that in which they lie
 * deepest: whose surface is farthest away. Of two as deep, the first one has it.
 * SPDX-License-Identifier: MIT */
#include "labels/label_paint.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "base/threads.h"
#include "labels/surface_fill.h"
#include "measure/surface_distances.h"
#include "volumes/volume_write.h"

#define BATCH 8u    /* surfaces that are filled at a time */
#define CHUNK 1024u /* claims per task */
#define CLAIMS_MAX ((size_t)40u * 1000u * 1000u)
#define FAR_MM (4.0f * SMR_COORD_MAX)

/* A voxel inside a surface, when it is inside another one, too. */
typedef struct claim {
    size_t voxel;
    uint32_t surface;
    float depth; /* mm */
} claim;

typedef struct fill_task {
    const host_load *load;
    const host_volume *grid;
    host_filled filled;
    host_error error;
    int64_t open;
    int failed;
} fill_task;

typedef struct painter {
    const smr_port *port;
    const host_load *loads;
    uint32_t n;
    const host_volume *grid;
    host_painted *painted;
    claim *claims; /* owned */
    size_t n_claims, capacity;
    smr_surface **surface; /* [n]; NULL where none is needed */
    void **memory;         /* [n] theirs; owned */
} painter;

static void run_fill(void *arg, uint32_t number, uint32_t worker)
{
    fill_task *const task = (fill_task *)arg + number;
    (void)worker;
    task->open = host_open_edges(&task->load->mesh);
    task->failed =
        task->open != 0 || host_surface_fill(&task->load->mesh, task->grid, &task->filled, &task->error) != 0;
}

static int add_claim(painter *p, size_t voxel, uint32_t surface)
{
    if (p->n_claims == p->capacity) {
        const size_t capacity = p->capacity == 0 ? 4096u : 2u * p->capacity;
        claim *const grown = p->n_claims < CLAIMS_MAX ? realloc(p->claims, capacity * sizeof *grown) : NULL;
        if (grown == NULL)
            return -1;
        p->claims = grown;
        p->capacity = capacity;
    }
    p->claims[p->n_claims++] = (claim){voxel, surface, 0.0f};
    return 0;
}

/* Gives a surface its voxels; where another one is, both claim it. */
static int paint_one(painter *p, const host_filled *filled, uint32_t surface)
{
    const size_t row = p->grid->size[0], slice = row * p->grid->size[1];
    size_t i = 0;
    const size_t n = (size_t)filled->size[0] * filled->size[1] * filled->size[2];
    p->painted->inside[surface] = filled->voxels;
    for (i = 0; i < n; i++) {
        const size_t x = i % filled->size[0] + filled->low[0],
                     y = i / filled->size[0] % filled->size[1] + filled->low[1],
                     z = i / filled->size[0] / filled->size[1] + filled->low[2];
        const size_t voxel = x + row * y + slice * z;
        uint16_t *const owner = &p->painted->index[voxel];
        if (!filled->inside[i])
            continue;
        if (*owner == 0)
            *owner = (uint16_t)(surface + 1u);
        else if (add_claim(p, voxel, *owner - 1u) != 0 || add_claim(p, voxel, surface) != 0)
            return -1;
    }
    return 0;
}

static int refuse_surface(const fill_task *task, host_error *error)
{
    error->file = task->load->path;
    if (task->open > 0)
        return host_fail(error, "surface", "a closed one, but %lld edges have an odd number of triangles",
                         (long long)task->open);
    return task->open < 0 ? host_fail(error, "surface", "free memory")
                          : host_fail(error, task->error.place, "%s", task->error.expected);
}

static int paint_batch(painter *p, uint32_t first, host_error *error)
{
    fill_task task[BATCH];
    const uint32_t n = p->n - first < BATCH ? p->n - first : BATCH;
    uint32_t i = 0;
    int result = 0;
    memset(task, 0, sizeof task);
    for (i = 0; i < n; i++) {
        task[i].load = &p->loads[first + i];
        task[i].grid = p->grid;
    }
    host_parallel(p->port, run_fill, task, n);
    for (i = 0; i < n; i++) {
        if (result == 0 && task[i].failed)
            result = refuse_surface(&task[i], error);
        else if (result == 0 && paint_one(p, &task[i].filled, first + i) != 0)
            result = host_fail(error, "overlap", "free memory, and at most %zu million voxels in several surfaces",
                               CLAIMS_MAX / 1000000u);
        host_filled_free(&task[i].filled);
    }
    return result;
}

static void run_depths(void *arg, uint32_t number, uint32_t worker)
{
    const painter *const p = arg;
    const size_t first = (size_t)number * CHUNK, end = first + CHUNK < p->n_claims ? first + CHUNK : p->n_claims;
    const host_volume *const grid = p->grid;
    size_t i = 0, k = 0;
    (void)worker;
    for (i = first; i < end; i++) {
        claim *const c = &p->claims[i];
        const double index[3] = {(double)(c->voxel % grid->size[0]), (double)(c->voxel / grid->size[0] % grid->size[1]),
                                 (double)(c->voxel / grid->size[0] / grid->size[1])};
        double at[3];
        float point[3];
        smr_closest hit;
        memset(&hit, 0, sizeof hit);
        host_volume_place(grid, index, at);
        for (k = 0; k < 3u; k++)
            point[k] = (float)at[k];
        if (smr_surface_closest(p->surface[c->surface], point, NULL, -1.0f, FAR_MM, &hit) == SMR_OK)
            c->depth = hit.distance;
    }
}

static int by_voxel(const void *a, const void *b)
{
    const claim *const x = a, *const y = b;
    const int voxel = (x->voxel > y->voxel) - (x->voxel < y->voxel);
    if (voxel != 0)
        return voxel;
    if (x->depth < y->depth || x->depth > y->depth)
        return x->depth > y->depth ? -1 : 1;
    return (x->surface > y->surface) - (x->surface < y->surface);
}

/* Settles voxels that several surfaces claim. */
static int settle_claims(painter *p, host_error *error)
{
    size_t i = 0;
    if (p->n_claims == 0)
        return 0;
    for (i = 0; i < p->n_claims; i++) {
        const uint32_t s = p->claims[i].surface;
        const smr_mesh view = host_mesh_view(&p->loads[s].mesh);
        if (p->surface[s] == NULL)
            p->surface[s] = host_surface_make(&view, &p->memory[s]);
        if (p->surface[s] == NULL)
            return host_fail(error, "overlap", "free memory");
    }
    host_parallel(p->port, run_depths, p, (uint32_t)((p->n_claims + CHUNK - 1u) / CHUNK));
    qsort(p->claims, p->n_claims, sizeof *p->claims, by_voxel);
    for (i = 0; i < p->n_claims; i++) {
        if (i > 0 && p->claims[i].voxel == p->claims[i - 1u].voxel)
            continue;
        p->painted->index[p->claims[i].voxel] = (uint16_t)(p->claims[i].surface + 1u);
        p->painted->shared++;
    }
    return 0;
}

static int paint_all(painter *p, host_error *error)
{
    const size_t n = (size_t)p->grid->size[0] * p->grid->size[1] * p->grid->size[2];
    size_t i = 0;
    uint32_t k = 0;
    p->painted->index = host_alloc(n * sizeof *p->painted->index);
    p->painted->inside = calloc(p->n, sizeof *p->painted->inside);
    p->painted->voxels = calloc(p->n, sizeof *p->painted->voxels);
    p->surface = calloc(p->n, sizeof(smr_surface *));
    p->memory = calloc(p->n, sizeof(void *));
    if (p->painted->index == NULL || p->painted->inside == NULL || p->painted->voxels == NULL || p->surface == NULL ||
        p->memory == NULL)
        return host_fail(error, "labels", "free memory");
    memset(p->painted->index, 0, n * sizeof *p->painted->index);
    for (k = 0; k < p->n; k += BATCH)
        if (paint_batch(p, k, error) != 0)
            return -1;
    if (settle_claims(p, error) != 0)
        return -1;
    for (i = 0; i < n; i++)
        if (p->painted->index[i] > 0)
            p->painted->voxels[p->painted->index[i] - 1u]++;
    return 0;
}

int host_paint(const smr_port *port, const host_load *loads, uint32_t n, const host_volume *grid, host_painted *painted,
               host_error *error)
{
    painter p;
    uint32_t i = 0;
    int result = 0;
    memset(painted, 0, sizeof *painted);
    memset(&p, 0, sizeof p);
    p.port = port;
    p.loads = loads;
    p.n = n;
    p.grid = grid;
    p.painted = painted;
    result = paint_all(&p, error);
    for (i = 0; p.memory != NULL && i < n; i++)
        free(p.memory[i]);
    free(p.memory);
    free((void *)p.surface);
    free(p.claims);
    return result;
}

void host_painted_free(host_painted *painted)
{
    free(painted->index);
    free(painted->inside);
    free(painted->voxels);
    memset(painted, 0, sizeof *painted);
}
