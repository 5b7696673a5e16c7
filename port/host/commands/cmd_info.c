/* cmd_info.c: smr info: prints the structures, radii and sizes of a model, and landmarks.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include "base/system.h"
#include "commands/commands.h"
#include "files/file_names.h"
#include "labels/label_map.h"
#include "landmarks/landmarks.h"
#include "model/model_from_files.h"

#define ALIKE_LEAST 0.75 /* of neighbours along the first axis that are not both 0: one label goes on */

/* The smallest and the largest value; NaN is left out. */
static void find_range(const smr_volume *volume, double *low, double *high)
{
    const size_t n = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    *low = (double)INFINITY;
    *high = -(double)INFINITY;
    for (size_t i = 0; i < n; i++) {
        const double v = host_voxel(volume->voxels, volume->type, i);
        *low = v < *low ? v : *low;
        *high = v > *high ? v : *high;
    }
    if (*low > *high)
        *low = *high = (double)NAN;
}

static void print_place(const smr_volume *volume)
{
    const float *const d = volume->direction;
    host_box box = {0};
    host_box_add_volume(&box, volume);
    (void)printf("spacing %g %g %g mm  first voxel at %g %g %g mm, LPS\n", (double)volume->spacing[0],
                 (double)volume->spacing[1], (double)volume->spacing[2], (double)volume->origin[0],
                 (double)volume->origin[1], (double)volume->origin[2]);
    for (size_t i = 0; i < 3; i++)
        (void)printf("axis %zu runs along %.4f %.4f %.4f\n", i, (double)d[i], (double)d[3u + i], (double)d[6u + i]);
    (void)printf("centres of voxels from %g %g %g to %g %g %g mm, LPS\n", (double)box.low[0], (double)box.low[1],
                 (double)box.low[2], (double)box.high[0], (double)box.high[1], (double)box.high[2]);
}

static void print_image(const char *path, const smr_volume *volume)
{
    static const char *const types[] = {"uint8", "int8", "uint16", "int16", "float"};
    double low = 0.0, high = 0.0;
    find_range(volume, &low, &high);
    (void)printf("volume %s  voxels %u x %u x %u  %s  values %g to %g\n", path, volume->size[0], volume->size[1],
                 volume->size[2], types[volume->type], low, high);
    print_place(volume);
}

static void print_labels(const host_label_map *map)
{
    const double ml = fabs(host_label_mm3(&map->grid)) / 1000.0;
    for (uint32_t i = 0; i < map->n_labels; i++) {
        const host_label *const label = &map->label[i];
        (void)printf("label %5u  ", label->value);
        if (map->n_layers > 1u)
            (void)printf("layer %u  ", label->layer);
        (void)printf("%-32s voxels %9" PRIu64 "  %12.3f ml\n", label->name, label->voxels, (double)label->voxels * ml);
    }
}

static void print_map(const char *path, const host_label_map *map)
{
    const smr_volume view = host_volume_view(&map->grid);
    (void)printf("label map %s  voxels %u x %u x %u  layers %u  labels %u\n", path, view.size[0], view.size[1],
                 view.size[2], map->n_layers, map->n_labels);
    print_place(&view);
    print_labels(map);
}

/* Whole numbers from 0 on, one above it, which mostly go on from voxel to voxel. */
static int looks_like_labels(const smr_volume *volume)
{
    const size_t n = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    double before = 0.0;
    size_t pairs = 0, alike = 0;
    for (size_t i = 0; i < n; i++) {
        const double v = host_voxel(volume->voxels, volume->type, i);
        if (!(v >= 0.0 && v <= (double)HOST_LABEL_MAX) || floor(v) < v)
            return 0;
        if (i > 0 && (v > 0.0 || before > 0.0)) {
            pairs++;
            alike += !(v > before) && !(v < before);
        }
        before = v;
    }
    return pairs > 0 && (double)alike >= ALIKE_LEAST * (double)pairs;
}

/* 1 when there is nothing but 0, which label maps refuse. */
static int is_empty(const char *path)
{
    host_error ignored = {0};
    host_image image;
    double low = 1.0, high = 1.0;
    if (host_image_read(path, HOST_MIRROR_NONE, &image, &ignored) != 0)
        return 0;
    find_range(&image.view, &low, &high);
    host_image_free(&image);
    return !(low < 0.0) && !(high > 0.0);
}

/* Prints it. A .seg.nrrd is a label map, as is every volume with a file of names (NULL: none) and what looks like one:
 * whole numbers from 0 on, mostly next to their like. 0, or -1 with the error filled. */
static int host_info_volume(const char *path, const char *names, host_error *error)
{
    const int segments = names != NULL || host_has_extension(path, ".seg.nrrd");
    host_error ignored = {0};
    host_label_map map;
    host_image image;
    if (segments && host_label_map_read(path, names, &map, error) == 0) {
        print_map(path, &map);
        host_label_map_free(&map);
        return 0;
    }
    if ((segments && !is_empty(path)) || host_image_read(path, HOST_MIRROR_NONE, &image, error) != 0)
        return -1;
    print_image(path, &image.view);
    int like = looks_like_labels(&image.view);
    host_image_free(&image);
    if (like && host_label_map_read(path, NULL, &map, &ignored) == 0) {
        print_labels(&map);
        host_label_map_free(&map);
    }
    return 0;
}

static void print_info(const host_model *model, int prepared_here)
{
    const smr_model_info *const info = &model->info;
    (void)printf("vertices %u  triangles %u  structures %u  mean edge %.2f mm  bytes %zu  checksum %08x\n",
                 info->n_vertices, info->n_triangles, info->n_structures, (double)info->edge_mm, info->bytes,
                 info->checksum);
    for (uint32_t i = 0; i < model->n_parts; i++)
        (void)printf("structure %-32s vertices %6u  triangles %6u\n", model->part[i].name,
                     model->part[i].mesh.n_vertices, model->part[i].mesh.n_triangles);
    if (info->n_references > 1)
        (void)printf("references %u\n", info->n_references);
    (void)printf("order %s\n", info->order == SMR_ORDER_FOREST ? "forest" : "breadth-first");
    for (uint32_t i = 0; i < info->n_radii; i++)
        (void)printf("radius %8.3f mm  indexes per cluster %8.2f  direct %8.2f  largest %5u  smallest %4u  blocks %4u  "
                     "%s  needs %u active\n",
                     (double)info->radius_mm[i], (double)info->indexes_per_cluster[i],
                     (double)info->direct_per_cluster[i], info->largest_cluster[i], info->smallest_cluster[i],
                     info->n_blocks[i], info->separate[i] ? "separate" : "shared", info->active_min[i]);
    (void)printf("priority levels %u, vertices up to each:", info->n_levels);
    for (uint32_t i = 0; i < info->n_levels; i++)
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
    error->file = path;
    if (set == NULL)
        return host_fail(error, "start", "free memory");
    int result = host_landmarks_read(path, set, error);
    if (result == 0)
        (void)printf("landmarks %s  %u, mm, LPS\n", path, set->n);
    for (uint32_t i = 0; i < set->n; i++)
        (void)printf("landmark %-32s %10.3f %10.3f %10.3f\n", set->label[i], (double)set->xyz[i][0],
                     (double)set->xyz[i][1], (double)set->xyz[i][2]);
    free(set);
    return result;
}

/* Describes volumes and landmarks at once; the files that are left are those of a model. */
static int describe_others(const host_files *files, const char *names, host_files *left, host_error *error)
{
    for (uint32_t i = 0; i < files->n; i++) {
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
    host_port port = {0};
    host_model model = {0};
    int result = -1;
    const int ready = host_model_is_prepared(files->path[0]);
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
