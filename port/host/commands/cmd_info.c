/* cmd_info.c: smr info: prints the structures, radii and sizes of a model.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <string.h>

#include "base/threads.h"
#include "commands/commands.h"
#include "model/model_from_files.h"

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

int host_info(const host_options *options, host_error *error)
{
    host_port port;
    host_model model;
    int result = HOST_REFUSED;
    const int ready = host_model_is_prepared(options->operands.path[0]);
    memset(&port, 0, sizeof port);
    memset(&model, 0, sizeof model);
    error->file = options->prepare_option;
    if (ready && options->prepare_option != NULL) {
        (void)host_fail(error, "option", "a model of surfaces: a .smr is prepared already");
        return HOST_REFUSED;
    }
    if (host_port_open(&port, 0, error) == 0 &&
        host_model_load(&options->operands, options, &port.port, &model, error) == 0) {
        print_info(&model, !ready);
        result = HOST_DONE;
    }
    host_model_free(&model);
    host_port_close(&port);
    return result;
}
