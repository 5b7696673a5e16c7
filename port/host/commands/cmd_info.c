/* cmd_info.c: smr info: prints the structures, radii and sizes of a model, and landmarks.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/threads.h"
#include "commands/commands.h"
#include "commands/info_volume.h"
#include "files/file_kind.h"
#include "landmarks/landmarks.h"
#include "model/model_from_files.h"
#include "volumes/voxel_volume.h"

static void print_info(const host_model *model, int prepared_here)
{
    const smr_model_info *const info = &model->info;
    uint32_t i = 0;
    (void)printf("vertices %u  triangles %u  structures %u  mean edge %.2f mm  bytes %zu  checksum %08x\n",
                 info->n_vertices, info->n_triangles, info->n_structures, (double)info->edge_mm, info->bytes,
                 info->checksum);
    for (i = 0; i < model->n_parts; i++)
        (void)printf("structure %-32s vertices %6u  triangles %6u\n", model->part[i].name,
                     model->part[i].mesh.n_vertices, model->part[i].mesh.n_triangles);
    (void)printf("order %s\n", info->order == SMR_ORDER_FOREST ? "forest" : "breadth-first");
    for (i = 0; i < info->n_radii; i++)
        (void)printf("radius %8.3f mm  indexes per cluster %8.2f  direct %8.2f  largest %5u  smallest %4u  "
                     "blocks %4u  %s  needs %u active\n",
                     (double)info->radius_mm[i], (double)info->indexes_per_cluster[i],
                     (double)info->direct_per_cluster[i], info->largest_cluster[i], info->smallest_cluster[i],
                     info->n_blocks[i], info->separate[i] ? "separate" : "shared", info->active_min[i]);
    (void)printf("priority levels %u, vertices up to each:", info->n_levels);
    for (i = 0; i < info->n_levels; i++)
        (void)printf(" %u", info->level_end[i]);
    (void)printf("\n");
    if (info->profile_samples > 0)
        (void)printf("intensity profiles of %u samples every %.2f mm\n", info->profile_samples,
                     (double)info->profile_step_mm);
    if (prepared_here)
        (void)printf("prepared in %.3f s\n", model->prepare_s);
}

static int describe_landmarks(const char *path, host_error *error)
{
    host_landmarks *const set = calloc(1, sizeof *set);
    uint32_t i = 0;
    int result = 0;
    error->file = path;
    if (set == NULL)
        return host_fail(error, "start", "free memory");
    result = host_landmarks_read(path, set, error);
    if (result == 0)
        (void)printf("landmarks %s  %u, mm, LPS\n", path, set->n);
    for (i = 0; i < set->n; i++)
        (void)printf("landmark %-32s %10.3f %10.3f %10.3f\n", set->label[i], (double)set->xyz[i][0],
                     (double)set->xyz[i][1], (double)set->xyz[i][2]);
    free(set);
    return result;
}

/* Describes volumes and landmarks at once; the files that are left are those of a model. */
static int describe_others(const host_files *files, const char *names, host_files *left, host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < files->n; i++) {
        const int kind = host_file_kind(files->path[i]);
        int result = 0;
        if (kind == HOST_KIND_VOLUME || host_is_volume_path(files->path[i]))
            result = host_info_volume(files->path[i], names, error);
        else if (kind == HOST_KIND_LANDMARKS)
            result = describe_landmarks(files->path[i], error);
        else
            left->path[left->n++] = files->path[i];
        if (result != 0)
            return -1;
    }
    return 0;
}

static int describe_model(const host_files *files, const host_options *options, host_error *error)
{
    host_port port;
    host_model model;
    int result = -1;
    const int ready = host_model_is_prepared(files->path[0]);
    memset(&port, 0, sizeof port);
    memset(&model, 0, sizeof model);
    error->file = options->prepare_option;
    if (ready && options->prepare_option != NULL)
        return host_fail(error, "option", "a model of surfaces: a .smr is prepared already");
    if (host_port_open(&port, 0, error) == 0 && host_model_load(files, options, &port.port, &model, error) == 0) {
        print_info(&model, !ready);
        result = 0;
    }
    host_model_free(&model);
    host_port_close(&port);
    return result;
}

int host_info(const host_options *options, host_error *error)
{
    host_files left = {NULL, 0};
    int result = -1;
    error->file = "info";
    left.path = calloc(options->operands.n, sizeof *left.path);
    if (left.path == NULL)
        (void)host_fail(error, "start", "free memory");
    else
        result = describe_others(&options->operands, options->names, &left, error);
    if (result == 0 && left.n > 0)
        result = describe_model(&left, options, error);
    free(left.path);
    return result == 0 ? HOST_DONE : HOST_REFUSED;
}
