/* info_volume.c: prints a volume's size, place and values; of a label map each structure.
 * SPDX-License-Identifier: MIT */
#include "commands/info_volume.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "files/file_names.h"
#include "labels/label_map.h"
#include "model/input_check.h"
#include "volumes/volume_image.h"

#define ALIKE_LEAST 0.75 /* of neighbours along the first axis that are not both 0: one label goes on */

/* The smallest and the largest value; NaN is left out. */
static void find_range(const smr_volume *volume, double *low, double *high)
{
    const size_t n = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    size_t i = 0;
    *low = (double)INFINITY;
    *high = -(double)INFINITY;
    for (i = 0; i < n; i++) {
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
    host_box box;
    size_t i = 0;
    memset(&box, 0, sizeof box);
    host_box_add_volume(&box, volume);
    (void)printf("spacing %g %g %g mm  first voxel at %g %g %g mm, LPS\n", (double)volume->spacing[0],
                 (double)volume->spacing[1], (double)volume->spacing[2], (double)volume->origin[0],
                 (double)volume->origin[1], (double)volume->origin[2]);
    for (i = 0; i < 3; i++)
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
    uint32_t i = 0;
    for (i = 0; i < map->n_labels; i++) {
        const host_label *const label = &map->label[i];
        (void)printf("label %5u  ", label->value);
        if (map->n_layers > 1u)
            (void)printf("layer %u  ", label->layer);
        (void)printf("%-32s voxels %9" PRIu64 "  %12.3f ml\n", label->name, label->voxels, (double)label->voxels * ml);
    }
}

static void print_map(const char *path, const host_label_map *map)
{
    smr_volume view;
    memset(&view, 0, sizeof view);
    memcpy(view.size, map->grid.size, sizeof view.size);
    memcpy(view.origin, map->grid.origin, sizeof view.origin);
    memcpy(view.spacing, map->grid.spacing, sizeof view.spacing);
    memcpy(view.direction, map->grid.direction, sizeof view.direction);
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
    size_t i = 0, pairs = 0, alike = 0;
    for (i = 0; i < n; i++) {
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

int host_info_volume(const char *path, const char *names, host_error *error)
{
    const int segments = names != NULL || host_has_extension(path, ".seg.nrrd");
    host_error ignored = {0};
    host_label_map map;
    host_image image;
    int like = 0;
    if (segments && host_label_map_read(path, names, &map, error) == 0) {
        print_map(path, &map);
        host_label_map_free(&map);
        return 0;
    }
    if ((segments && !is_empty(path)) || host_image_read(path, HOST_MIRROR_NONE, &image, error) != 0)
        return -1;
    print_image(path, &image.view);
    like = looks_like_labels(&image.view);
    host_image_free(&image);
    if (like && host_label_map_read(path, NULL, &map, &ignored) == 0) {
        print_labels(&map);
        host_label_map_free(&map);
    }
    return 0;
}
