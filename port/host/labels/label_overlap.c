/* label_overlap.c: how label maps, or a label map and surfaces, overlap.
 * SPDX-License-Identifier: MIT */
#include "labels/label_overlap.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "files/file_names.h"

static int same_grid(const host_volume *a, const host_volume *b)
{
    double off = 0.0;
    for (uint32_t k = 0; k < 3u; k++) {
        if (a->size[k] != b->size[k])
            return 0;
        off = fmax(off, fabs((double)a->origin[k] - (double)b->origin[k]) / (double)a->spacing[k]);
        for (uint32_t j = 0; j < 3u; j++) /* over the whole axis, in voxels */
            off = fmax(off, fabs((double)a->direction[3u * j + k] * (double)a->spacing[k] -
                                 (double)b->direction[3u * j + k] * (double)b->spacing[k]) *
                                (double)a->size[k] / (double)a->spacing[j]);
    }
    return off < 0.01;
}

/* 1 when the name only says the value. */
static int is_plain(const host_label *label)
{
    char name[SMR_NAME_BYTES];
    (void)snprintf(name, sizeof name, "label_%u", label->value);
    return strcmp(name, label->name) == 0;
}

/* The label of `map` for a label of `own`; SMR_NONE: none. By value only where no label of `own` has its name. */
static uint32_t same_label(const host_label_map *own, const host_label *label, const host_label_map *map)
{
    const host_label *const named = host_label_find(map, label->name);
    if (named != NULL)
        return (uint32_t)(named - map->label);
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (map->label[i].value == label->value && is_plain(label) != is_plain(&map->label[i]) &&
            host_label_find(own, map->label[i].name) == NULL)
            return i;
    return SMR_NONE;
}

/* Pairs the labels, each with one at most. Returns how many structures there are. */
static uint32_t pair_labels(const host_label_map *a, const host_label_map *b, host_overlap *overlap)
{
    uint32_t k = 0, n = 0;
    for (uint32_t i = 0; i < a->n_labels; i++, n++) {
        memset(&overlap[n], 0, sizeof *overlap);
        overlap[n].a = i;
        overlap[n].b = same_label(a, &a->label[i], b);
        for (k = 0; k < n; k++) /* values of layers need not differ */
            if (overlap[k].b == overlap[n].b)
                overlap[n].b = SMR_NONE;
        memcpy(overlap[n].name, a->label[i].name, SMR_NAME_BYTES);
        if (overlap[n].b != SMR_NONE && is_plain(&a->label[i]))
            memcpy(overlap[n].name, b->label[overlap[n].b].name, SMR_NAME_BYTES);
    }
    for (uint32_t i = 0; i < b->n_labels; i++) {
        for (k = 0; k < a->n_labels && overlap[k].b != i; k++)
            continue;
        if (k < a->n_labels)
            continue;
        memset(&overlap[n], 0, sizeof *overlap);
        overlap[n].a = SMR_NONE;
        overlap[n].b = i;
        memcpy(overlap[n++].name, b->label[i].name, SMR_NAME_BYTES);
    }
    return n;
}

/* Counts the voxels that structures have in both maps. */
static void count_both(const host_label_map *a, const host_label_map *b, host_overlap *overlap)
{
    const size_t n = host_label_voxels(a);
    for (uint32_t la = 0; la < a->n_layers; la++)
        for (uint32_t lb = 0; lb < b->n_layers; lb++)
            for (size_t i = 0; i < n; i++) {
                const uint32_t in_a = a->index[la * n + i], in_b = b->index[lb * n + i];
                if (in_a > 0 && in_b > 0 && overlap[in_a - 1u].b == in_b - 1u)
                    overlap[in_a - 1u].both++;
            }
}

static void settle_voxels(const host_label_map *a, const host_label_map *b, host_overlap *overlap, uint32_t n)
{
    for (uint32_t i = 0; i < n; i++) {
        host_overlap *const o = &overlap[i];
        o->voxels_a = o->a != SMR_NONE ? a->label[o->a].voxels : 0;
        o->voxels_b = o->b != SMR_NONE ? b->label[o->b].voxels : 0;
        o->mm3_a = (double)o->voxels_a * fabs(host_label_mm3(&a->grid));
        o->mm3_b = (double)o->voxels_b * fabs(host_label_mm3(&b->grid));
        if (o->voxels_a + o->voxels_b > 0)
            o->dice = 2.0 * (double)o->both / (double)(o->voxels_a + o->voxels_b);
    }
}

/* The distances of one structure, both ways. A structure at a time: their surfaces take memory. */
static int measure_one(const smr_port *port, const smr_mesh *a, const smr_mesh *b, host_overlap *o)
{
    void *memory[2] = {NULL, NULL};
    host_query query[2] = {{.mesh = *a, .surface = host_surface_make(b, &memory[0])},
                           {.mesh = *b, .surface = host_surface_make(a, &memory[1])}};
    int result = -1;
    if (query[0].surface != NULL && query[1].surface != NULL && host_distances(port, query, 2) == 0 &&
        host_area_stats(&query[0], 1, NULL, &o->to_b) == 0 && host_area_stats(&query[1], 1, NULL, &o->to_a) == 0) {
        const double weight = o->to_b.weight + o->to_a.weight;
        o->hausdorff95 = o->to_b.p95 > o->to_a.p95 ? o->to_b.p95 : o->to_a.p95;
        o->mean = weight > 0.0 ? (o->to_b.mean * o->to_b.weight + o->to_a.mean * o->to_a.weight) / weight : 0.0;
        result = 0;
    }
    host_queries_free(query, 2);
    free(memory[0]);
    free(memory[1]);
    return result;
}

int host_overlaps_measure(const smr_port *port, const host_label_map *a, const smr_mesh *mesh_a,
                          const host_label_map *b, const smr_mesh *mesh_b, host_overlap *overlap, host_error *error)
{
    const uint32_t n = pair_labels(a, b, overlap);
    count_both(a, b, overlap);
    settle_voxels(a, b, overlap, n);
    for (uint32_t i = 0; i < n; i++) {
        host_overlap *const o = &overlap[i];
        if (o->a == SMR_NONE || o->b == SMR_NONE || mesh_a[o->a].n_triangles == 0 || mesh_b[o->b].n_triangles == 0)
            continue;
        if (measure_one(port, &mesh_a[o->a], &mesh_b[o->b], o) != 0)
            return host_fail(error, o->name, "surfaces that can be measured, and free memory");
    }
    return (int)n;
}

static int is_directory(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

int host_is_label_side(const char *path)
{
    return is_directory(path) || host_file_kind(path) == HOST_KIND_VOLUME || host_is_volume_path(path);
}

static int read_map(host_label_side *side, const char *names, uint32_t passes, const smr_port *port, host_error *error)
{
    if (host_label_map_read(side->path, names, &side->map, error) != 0)
        return -1;
    error->file = side->path;
    side->surface = calloc(side->map.n_labels, sizeof *side->surface);
    if (side->surface == NULL)
        return host_fail(error, "labels", "free memory");
    return host_label_surfaces_make(port, &side->map, passes, 0, side->surface, error);
}

/* The surfaces of a map on another grid, in place of its own voxels. */
static int repaint(host_label_side *side, const smr_port *port, const host_volume *grid, host_error *error)
{
    const uint32_t n = side->map.n_labels;
    host_load *const load = calloc(n, sizeof *load);
    host_painted painted = {0};
    int result = -1;
    error->file = side->path;
    for (uint32_t i = 0; load != NULL && i < n; i++) {
        load[i].path = side->path;
        load[i].mesh = side->surface[i].mesh;
    }
    if (load == NULL)
        (void)host_fail(error, "labels", "free memory");
    else
        result = host_paint(port, load, n, grid, &painted, error);
    if (result == 0) {
        free(side->map.index);
        side->map.index = painted.index;
        painted.index = NULL;
        side->map.grid = *grid;
        side->map.n_layers = 1;
        for (uint32_t i = 0; i < n; i++)
            side->map.label[i].voxels = painted.voxels[i];
    }
    host_painted_free(&painted);
    free(load);
    return result;
}

static int list_meshes(host_label_side *side, host_error *error)
{
    side->mesh = calloc(side->map.n_labels, sizeof *side->mesh);
    if (side->mesh == NULL)
        return host_fail(error, "labels", "free memory");
    for (uint32_t i = 0; i < side->map.n_labels; i++)
        side->mesh[i] = host_mesh_view(side->is_set ? &side->set.load[i].mesh : &side->surface[i].mesh);
    return 0;
}

int host_label_sides_read(host_label_side side[2], const char *names, uint32_t passes, const smr_port *port,
                          host_error *error)
{
    const host_volume *grid = NULL;
    for (uint32_t i = 0; i < 2u; i++) {
        side[i].is_set = is_directory(side[i].path);
        if ((side[i].is_set ? host_surface_set_read(side[i].path, names, port, &side[i].set, error)
                            : read_map(&side[i], names, passes, port, error)) != 0)
            return -1;
        if (grid == NULL && !side[i].is_set)
            grid = &side[i].map.grid;
    }
    error->file = side[1].path;
    if (grid == NULL)
        return host_fail(error, "surfaces", "a label map, for one of the two must be one");
    for (uint32_t i = 0; i < 2u; i++) {
        if (side[i].is_set && host_surface_set_paint(&side[i].set, port, grid, &side[i].map, NULL, error) != 0)
            return -1;
        if (!side[i].is_set && !same_grid(&side[i].map.grid, grid) && repaint(&side[i], port, grid, error) != 0)
            return -1;
        if (list_meshes(&side[i], error) != 0)
            return -1;
    }
    return 0;
}

void host_label_side_free(host_label_side *side)
{
    host_label_surfaces_free(side->surface, side->map.n_labels);
    host_label_map_free(&side->map);
    host_surface_set_free(&side->set);
    free(side->mesh);
    memset(side, 0, sizeof *side);
}
