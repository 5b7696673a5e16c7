/* register_truth_map.c: a label map as the truth: its surfaces to measure distances to, its voxels to measure overlap.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/file_read.h"
#include "labels/label_names.h"
#include "labels/label_surfaces.h"
#include "labels/surface_fill.h"
#include "register/register_job.h"

/* Names the structures that nothing is measured of, in one line. */
static void tell_missing(const host_job *job)
{
    uint32_t i = 0, n = 0;
    for (i = 0; i < job->model.n_parts; i++)
        if (job->result[i].target == HOST_NO_TARGET && job->model.part[i].mesh.n_triangles > 0)
            (void)fprintf(stderr, "%s%s", n++ == 0 ? "smr: --truth: no label is named like " : ", ",
                          job->model.part[i].name);
    if (n > 0)
        (void)fprintf(stderr, "\n");
}

/* The surfaces become the targets of the structures with their names, each of one. */
static int take_surfaces(host_job *job, host_label_surface *surface, host_error *error)
{
    uint32_t i = 0;
    job->target = calloc(job->model.n_parts, sizeof *job->target);
    if (job->target == NULL)
        return host_fail(error, "start", "free memory");
    for (i = 0; i < job->model.n_parts; i++) {
        const host_label *const label = host_label_find_like(job->truth_map, job->model.part[i].name);
        host_target *const target = &job->target[job->n_targets];
        if (label == NULL || job->model.part[i].mesh.n_triangles == 0 ||
            surface[label - job->truth_map->label].mesh.n_triangles == 0)
            continue;
        target->path = job->options->truth;
        target->mesh = surface[label - job->truth_map->label].mesh;
        memset(&surface[label - job->truth_map->label].mesh, 0, sizeof target->mesh);
        memcpy(target->name, label->name, sizeof target->name);
        target->users = 1;
        target->user = i;
        job->result[i].target = job->n_targets++;
    }
    if (job->n_targets == 0)
        return host_fail(error, "names", "a label with the name of one of the model's structures");
    tell_missing(job);
    return 0;
}

int host_job_load_truth_map(host_job *job, host_error *error)
{
    host_label_surface *surface = NULL;
    uint32_t n = 0;
    int result = -1;
    error->file = job->options->truth;
    job->truth_map = calloc(1, sizeof *job->truth_map);
    if (job->truth_map == NULL)
        return host_fail(error, "start", "free memory");
    job->truth_first = host_file_count();
    if (host_label_map_read(job->options->truth, NULL, job->truth_map, error) == 0) {
        if (job->options->mirror_target != HOST_MIRROR_NONE)
            host_volume_mirror(&job->truth_map->grid, job->options->mirror_target);
        n = job->truth_map->n_labels;
        surface = calloc(n, sizeof *surface);
        if (surface == NULL)
            (void)host_fail(error, "start", "free memory");
        else if (host_label_surfaces_make(&job->port.port, job->truth_map, HOST_SMOOTHING_PASSES, 0, surface, error) ==
                 0)
            result = take_surfaces(job, surface, error);
    }
    job->truth_end = host_file_count();
    host_label_surfaces_free(surface, n);
    return result;
}

/* Voxels of a box that have a label. */
static uint64_t count_both(const host_label_map *map, uint32_t label, const host_filled *filled)
{
    const uint16_t *const index = map->index + map->label[label].layer * host_label_voxels(map);
    const size_t n = (size_t)filled->size[0] * filled->size[1] * filled->size[2];
    uint64_t both = 0;
    size_t i = 0;
    for (i = 0; i < n; i++) {
        const size_t x = i % filled->size[0] + filled->low[0],
                     y = i / filled->size[0] % filled->size[1] + filled->low[1],
                     z = i / filled->size[0] / filled->size[1] + filled->low[2];
        both += filled->inside[i] && index[x + map->grid.size[0] * (y + map->grid.size[1] * z)] == label + 1u;
    }
    return both;
}

/* Tasks of one parallel loop: the overlap of a structure. An open surface has none. */
static void measure_overlap(void *arg, uint32_t task, uint32_t worker)
{
    host_job *const job = arg;
    const host_label_map *const map = job->truth_map;
    const double mm3 = fabs(host_label_mm3(&map->grid));
    const host_label *const label = host_label_find_like(map, job->model.part[task].name);
    host_result *const result = &job->result[task];
    host_filled filled;
    host_error error;
    (void)worker;
    memset(&filled, 0, sizeof filled);
    memset(&error, 0, sizeof error);
    result->dice = -1.0;
    if (result->target == HOST_NO_TARGET || host_open_edges(&result->mesh) != 0)
        return;
    if (host_surface_fill(&result->mesh, &map->grid, &filled, &error) == 0) {
        const uint64_t both = count_both(map, (uint32_t)(label - map->label), &filled);
        result->dice = 2.0 * (double)both / (double)(filled.voxels + label->voxels);
        result->label_mm3[0] = (double)filled.voxels * mm3;
        result->label_mm3[1] = (double)label->voxels * mm3;
    }
    host_filled_free(&filled);
}

void host_job_measure_labels(host_job *job)
{
    if (job->truth_map != NULL)
        host_parallel(&job->port.port, measure_overlap, job, job->model.n_parts);
}
