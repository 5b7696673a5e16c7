/* label_map.h: label maps: volumes whose whole numbers say to which structure a voxel belongs.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_MAP_H
#define LABEL_MAP_H

#include <stddef.h>
#include <stdint.h>

#include "smr.h"
#include "volumes/voxel_volume.h"

#define HOST_LABEL_MAX 16777215u /* the largest label read: floats hold larger numbers with gaps */

typedef struct host_label {
    char name[SMR_NAME_BYTES]; /* also of its file: letters, digits, '.', '_', '-', '+' and bytes above 127 */
    uint32_t value, layer;     /* in the file */
    float colour[3];           /* red, green, blue, 0 to 1 */
    int coloured;              /* 0: the file says no colour */
    uint64_t voxels;
} host_label;

typedef struct host_label_map {
    host_volume grid;  /* without voxels */
    uint16_t *index;   /* [n_layers][size[2]][size[1]][size[0]]: 0 background, else 1 + the label's number; owned */
    host_label *label; /* [n_labels], by layer, then by value; owned */
    uint32_t n_layers, n_labels;
} host_label_map;

/* Reads a label map from MetaImage, NIfTI-1 or NRRD, with the names and colours of a .seg.nrrd. names: a file with
 * lines "label name", which come before the map's own; NULL: none. Refuses labels that are negative, no whole
 * numbers or above HOST_LABEL_MAX, more than SMR_STRUCTURES_MAX of them, and a map without any. 0, or -1 with the
 * error filled and the map empty. */
int host_label_map_read(const char *path, const char *names, host_label_map *map, host_error *error);
void host_label_map_free(host_label_map *map);

/* The label of this name, or NULL. */
const host_label *host_label_find(const host_label_map *map, const char *name);

/* The volume that the axes of a voxel span, mm^3: negative when they are left-handed. */
double host_label_mm3(const host_volume *grid);

/* Voxels of a map. */
static inline size_t host_label_voxels(const host_label_map *map)
{
    return (size_t)map->grid.size[0] * map->grid.size[1] * map->grid.size[2];
}

#endif
