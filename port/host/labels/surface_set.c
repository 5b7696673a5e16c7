/* surface_set.c: a directory of surfaces; paints surfaces as a label map. A voxel inside several surfaces belongs to
 * the one in which it lies deepest: whose surface is farthest away. Of two as deep, the first one has it.
 * SPDX-License-Identifier: MIT */
#include "labels/surface_set.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "files/file_names.h"
#include "measure/surface_distances.h"

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
    fill_task *const t = (fill_task *)arg + number;
    (void)worker;
    t->open = host_open_edges(&t->load->mesh);
    t->failed = t->open != 0 || host_surface_fill(&t->load->mesh, t->grid, &t->filled, &t->error) != 0;
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
    const size_t n = (size_t)filled->size[0] * filled->size[1] * filled->size[2];
    p->painted->inside[surface] = filled->voxels;
    for (size_t i = 0; i < n; i++) {
        const size_t voxel = host_filled_voxel(filled, i, p->grid);
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
    int result = 0;
    memset(task, 0, sizeof task);
    for (uint32_t i = 0; i < n; i++) {
        task[i].load = &p->loads[first + i];
        task[i].grid = p->grid;
    }
    host_parallel(p->port, run_fill, task, n);
    for (uint32_t i = 0; i < n; i++) {
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
    (void)worker;
    for (size_t i = first; i < end; i++) {
        claim *const c = &p->claims[i];
        const double index[3] = {(double)(c->voxel % grid->size[0]), (double)(c->voxel / grid->size[0] % grid->size[1]),
                                 (double)(c->voxel / grid->size[0] / grid->size[1])};
        double at[3];
        float point[3];
        smr_closest hit = {0};
        host_volume_place(grid, index, at);
        for (size_t k = 0; k < 3u; k++)
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
    if (p->n_claims == 0)
        return 0;
    for (size_t i = 0; i < p->n_claims; i++) {
        const uint32_t s = p->claims[i].surface;
        const smr_mesh view = host_mesh_view(&p->loads[s].mesh);
        if (p->surface[s] == NULL)
            p->surface[s] = host_surface_make(&view, &p->memory[s]);
        if (p->surface[s] == NULL)
            return host_fail(error, "overlap", "free memory");
    }
    host_parallel(p->port, run_depths, p, (uint32_t)((p->n_claims + CHUNK - 1u) / CHUNK));
    qsort(p->claims, p->n_claims, sizeof *p->claims, by_voxel);
    for (size_t i = 0; i < p->n_claims; i++) {
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
    p->painted->index = host_alloc(n * sizeof *p->painted->index);
    p->painted->inside = calloc(p->n, sizeof *p->painted->inside);
    p->painted->voxels = calloc(p->n, sizeof *p->painted->voxels);
    p->surface = calloc(p->n, sizeof(smr_surface *));
    p->memory = calloc(p->n, sizeof(void *));
    if (p->painted->index == NULL || p->painted->inside == NULL || p->painted->voxels == NULL || p->surface == NULL ||
        p->memory == NULL)
        return host_fail(error, "labels", "free memory");
    memset(p->painted->index, 0, n * sizeof *p->painted->index);
    for (uint32_t k = 0; k < p->n; k += BATCH)
        if (paint_batch(p, k, error) != 0)
            return -1;
    if (settle_claims(p, error) != 0)
        return -1;
    for (size_t i = 0; i < n; i++)
        if (p->painted->index[i] > 0)
            p->painted->voxels[p->painted->index[i] - 1u]++;
    return 0;
}

int host_paint(const smr_port *port, const host_load *loads, uint32_t n, const host_volume *grid, host_painted *painted,
               host_error *error)
{
    painter p = {.port = port, .loads = loads, .n = n, .grid = grid, .painted = painted};
    memset(painted, 0, sizeof *painted);
    int result = paint_all(&p, error);
    for (uint32_t i = 0; p.memory != NULL && i < n; i++)
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

/* The names that are given to values; none when there is no file of them. */
static int read_names(const char *directory, const char *path, host_names *names, host_error *error)
{
    struct stat st;
    int result = 0;
    if (path != NULL)
        return host_names_read(path, names, error);
    char *const table = host_path_in(directory, "labels.ctbl");
    if (table == NULL)
        return host_fail(error, "names", "free memory");
    if (stat(table, &st) == 0) {
        result = host_names_read(table, names, error);
        error->file = directory;
    }
    free(table);
    return result;
}

/* Turns an error of one file into one of the directory, for the file's name is freed with the set. Returns -1. */
static int blame(const host_surface_set *set, host_error *error)
{
    const char *const slash = error->file != NULL ? strrchr(error->file, '/') : NULL;
    char place[sizeof error->place];
    for (uint32_t i = 0; set->files.n > 0 && i < set->files.frame[0].files.n; i++)
        if (set->files.frame[0].files.path[i] == error->file) {
            (void)snprintf(place, sizeof place, "%.50s: %.40s", slash != NULL ? slash + 1 : error->file, error->place);
            memcpy(error->place, place, sizeof place);
            error->file = set->directory;
            return -1;
        }
    return -1;
}

static int name_surface(const host_surface_set *set, uint32_t i, host_error *error)
{
    char name[SMR_NAME_BYTES];
    error->file = set->load[i].path;
    if (host_base_name(set->load[i].path, name, sizeof name) >= sizeof name ||
        host_label_name(name, strlen(name), set->label[i].name) != 0)
        return host_fail(error, "name", "a name of 1 to %u bytes", SMR_NAME_BYTES - 1u);
    for (uint32_t k = 0; k < i; k++)
        if (strcmp(set->label[k].name, set->label[i].name) == 0)
            return host_fail(error, "name", "surfaces with names that differ, '%s' is there twice", set->label[i].name);
    return 0;
}

/* The value that the file of names gives; what it leaves out comes behind the largest one. */
static int give_value(const host_surface_set *set, uint32_t i, const host_names *all, uint32_t *most, host_error *error)
{
    host_label *const label = &set->label[i];
    for (uint32_t k = 0; k < all->n; k++)
        if (strcmp(all->item[k].name, label->name) == 0) {
            label->value = all->item[k].value;
            label->coloured = all->item[k].coloured;
            memcpy(label->colour, all->item[k].colour, sizeof label->colour);
        }
    if (label->value == 0)
        label->value = ++*most;
    if (!label->coloured)
        host_label_colour(i, label->colour);
    for (uint32_t k = 0; k < i; k++)
        if (set->label[k].value == label->value)
            return host_fail_of(error, set->load[i].path, "names", "a label of its own, %u is also that of '%s'",
                                label->value, set->label[k].name);
    return 0;
}

static int label_surfaces(const host_surface_set *set, const host_names *names, host_error *error)
{
    uint32_t most = 0;
    for (uint32_t i = 0; i < names->n; i++)
        most = names->item[i].value > most ? names->item[i].value : most;
    for (uint32_t i = 0; i < set->n; i++)
        if (name_surface(set, i, error) != 0)
            return -1;
    for (uint32_t i = 0; i < set->n; i++)
        if (give_value(set, i, names, &most, error) != 0)
            return -1;
    return 0;
}

/* Tables of points may lie beside the surfaces: they come last. Returns how many files come before. */
static uint32_t surfaces_first(const host_frame *frame)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < frame->files.n; i++) {
        const char *const path = frame->files.path[i];
        if (host_has_extension(path, ".csv"))
            continue;
        for (uint32_t k = i; k > n; k--)
            frame->files.path[k] = frame->files.path[k - 1u];
        frame->files.path[n++] = path;
    }
    return n;
}

static int load_surfaces(host_surface_set *set, const smr_port *port, host_error *error)
{
    host_frame frame = set->files.frame[0];
    frame.files.n = surfaces_first(&frame);
    if (frame.files.n == 0)
        return host_fail(error, "files", "a surface or more");
    if (host_frame_load(&frame, port, HOST_MIRROR_NONE, &set->load, error) != 0)
        return -1;
    set->n = frame.files.n;
    for (uint32_t i = 0; i < set->n; i++)
        if (set->load[i].mesh.n_triangles == 0)
            return host_fail_of(error, set->load[i].path, "faces", "at least one triangle");
    return 0;
}

int host_surface_set_read(const char *directory, const char *names_path, const smr_port *port, host_surface_set *set,
                          host_error *error)
{
    host_files paths = {&directory, 1};
    host_names names = {NULL, 0};
    int result = -1;
    memset(set, 0, sizeof *set);
    set->directory = error->file = directory;
    if (read_names(directory, names_path, &names, error) == 0 && host_frames_list(&paths, &set->files, error) == 0 &&
        load_surfaces(set, port, error) == 0) {
        set->label = calloc(set->n, sizeof *set->label);
        result = set->label != NULL ? label_surfaces(set, &names, error) : host_fail(error, "names", "free memory");
    }
    host_names_free(&names);
    return result == 0 ? 0 : blame(set, error);
}

void host_surface_set_free(host_surface_set *set)
{
    for (uint32_t i = 0; i < set->n; i++)
        host_mesh_free(&set->load[i].mesh);
    free(set->load);
    host_frames_free(&set->files);
    free(set->label);
    memset(set, 0, sizeof *set);
}

int host_surface_set_paint(const host_surface_set *set, const smr_port *port, const host_volume *grid,
                           host_label_map *map, uint64_t *shared, host_error *error)
{
    host_painted painted;
    error->file = set->directory;
    int result = host_paint(port, set->load, set->n, grid, &painted, error);
    memset(map, 0, sizeof *map);
    map->label = calloc(set->n, sizeof *map->label);
    if (result == 0 && map->label == NULL)
        result = host_fail(error, "labels", "free memory");
    if (result == 0) {
        map->grid = *grid;
        map->grid.voxels = NULL;
        map->n_layers = 1;
        map->n_labels = set->n;
        map->index = painted.index;
        painted.index = NULL;
        memcpy(map->label, set->label, set->n * sizeof *map->label);
        for (uint32_t i = 0; i < set->n; i++)
            map->label[i].voxels = painted.voxels[i];
        if (shared != NULL)
            *shared = painted.shared;
    } else {
        host_label_map_free(map);
    }
    host_painted_free(&painted);
    return result == 0 ? 0 : blame(set, error);
}
