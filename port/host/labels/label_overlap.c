/* label_overlap.c: Dice's coefficient, volumes and surface distances of the structures of two label maps.
 * SPDX-License-Identifier: MIT */
#include "labels/label_overlap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int host_same_grid(const host_volume *a, const host_volume *b)
{
    uint32_t k = 0, j = 0;
    double off = 0.0;
    for (k = 0; k < 3u; k++) {
        if (a->size[k] != b->size[k])
            return 0;
        off = fmax(off, fabs((double)a->origin[k] - (double)b->origin[k]) / (double)a->spacing[k]);
        for (j = 0; j < 3u; j++) /* over the whole axis, in voxels */
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

/* The label of `map` that is the same structure as a label of `own`; SMR_NONE: none. By value only where no label of
 * `own` has its name. */
static uint32_t same_label(const host_label_map *own, const host_label *label, const host_label_map *map)
{
    const host_label *const named = host_label_find(map, label->name);
    uint32_t i = 0;
    if (named != NULL)
        return (uint32_t)(named - map->label);
    for (i = 0; i < map->n_labels; i++)
        if (map->label[i].value == label->value && is_plain(label) != is_plain(&map->label[i]) &&
            host_label_find(own, map->label[i].name) == NULL)
            return i;
    return SMR_NONE;
}

/* Pairs the labels, each with one at most. Returns how many structures there are. */
static uint32_t pair_labels(const host_label_map *a, const host_label_map *b, host_overlap *overlap)
{
    uint32_t i = 0, k = 0, n = 0;
    for (i = 0; i < a->n_labels; i++, n++) {
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
    for (i = 0; i < b->n_labels; i++) {
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
    uint32_t la = 0, lb = 0;
    size_t i = 0;
    for (la = 0; la < a->n_layers; la++)
        for (lb = 0; lb < b->n_layers; lb++)
            for (i = 0; i < n; i++) {
                const uint32_t in_a = a->index[la * n + i], in_b = b->index[lb * n + i];
                if (in_a > 0 && in_b > 0 && overlap[in_a - 1u].b == in_b - 1u)
                    overlap[in_a - 1u].both++;
            }
}

static void settle_voxels(const host_label_map *a, const host_label_map *b, host_overlap *overlap, uint32_t n)
{
    uint32_t i = 0;
    for (i = 0; i < n; i++) {
        host_overlap *const o = &overlap[i];
        o->voxels_a = o->a != SMR_NONE ? a->label[o->a].voxels : 0;
        o->voxels_b = o->b != SMR_NONE ? b->label[o->b].voxels : 0;
        o->mm3_a = (double)o->voxels_a * fabs(host_label_mm3(&a->grid));
        o->mm3_b = (double)o->voxels_b * fabs(host_label_mm3(&b->grid));
        if (o->voxels_a + o->voxels_b > 0)
            o->dice = 2.0 * (double)o->both / (double)(o->voxels_a + o->voxels_b);
    }
}

static void settle_distances(host_overlap *o)
{
    const double weight = o->to_b.weight + o->to_a.weight;
    o->hausdorff95 = o->to_b.p95 > o->to_a.p95 ? o->to_b.p95 : o->to_a.p95;
    o->mean = weight > 0.0 ? (o->to_b.mean * o->to_b.weight + o->to_a.mean * o->to_a.weight) / weight : 0.0;
}

/* The distances of one structure, both ways. A structure at a time: their surfaces take memory. */
static int measure_one(const smr_port *port, const smr_mesh *a, const smr_mesh *b, host_overlap *o)
{
    host_query query[2];
    void *memory[2] = {NULL, NULL};
    int result = -1;
    memset(query, 0, sizeof query);
    query[0].mesh = *a;
    query[1].mesh = *b;
    query[0].surface = host_surface_make(b, &memory[0]);
    query[1].surface = host_surface_make(a, &memory[1]);
    if (query[0].surface != NULL && query[1].surface != NULL && host_distances(port, query, 2) == 0 &&
        host_area_stats(&query[0], 1, NULL, &o->to_b) == 0 && host_area_stats(&query[1], 1, NULL, &o->to_a) == 0) {
        settle_distances(o);
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
    uint32_t i = 0;
    count_both(a, b, overlap);
    settle_voxels(a, b, overlap, n);
    for (i = 0; i < n; i++) {
        host_overlap *const o = &overlap[i];
        if (o->a == SMR_NONE || o->b == SMR_NONE || mesh_a[o->a].n_triangles == 0 || mesh_b[o->b].n_triangles == 0)
            continue;
        if (measure_one(port, &mesh_a[o->a], &mesh_b[o->b], o) != 0)
            return host_fail(error, o->name, "surfaces that can be measured, and free memory");
    }
    return (int)n;
}
