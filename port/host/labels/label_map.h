/* label_map.h: label maps: volumes whose whole numbers say to which structure a voxel belongs; names and colours of
 * labels, from a .seg.nrrd, from a text file, or made up.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_MAP_H
#define LABEL_MAP_H

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

/* Checks that the extension is one of those. 0, or -1 with the error filled. */
int host_labels_can_write(const char *path, host_error *error);

/* Writes a map of one layer in the format of the path's extension. Labels above 65535: -1 with the error filled. */
int host_labels_write(const host_label_map *map, const char *path, host_buffer *out, host_error *error);

/* A name that is given to a value, in all layers. */
typedef struct host_named {
    uint32_t value;
    char name[SMR_NAME_BYTES];
    float colour[3];
    int coloured;
} host_named;

typedef struct host_names {
    host_named *item; /* owned */
    uint32_t n;
} host_names;

/* Reads lines "value name", perhaps with "red green blue" or "red green blue opacity" of 0 to 255 behind, as in
 * Slicer's colour tables, and ITK-SNAP's: value red green blue opacity visible mesh "name". Empty lines and those that
 * start with '#' are skipped, as is the value 0.
 * 0, or -1 with the error filled; host_names_free in either case. */
int host_names_read(const char *path, host_names *names, host_error *error);
void host_names_free(host_names *names);

/* Gives the map's labels the names and colours of a .seg.nrrd's "key:=value" lines. */
int host_labels_take_segments(host_label_map *map, const host_buffer *keys, host_error *error);

/* Gives the map's labels these names. Those without one become label_VALUE; of several with the same name each gets its
 * value behind it. */
int host_labels_settle_names(host_label_map *map, const host_names *names, host_error *error);

/* Copies a text as a name. What no name may have becomes '_', a first dot too. 0, or -1 when empty or too long. */
int host_label_name(const char *text, size_t n, char name[SMR_NAME_BYTES]);

/* The label that has this name once its characters are those of a name, or NULL. */
const host_label *host_label_find_like(const host_label_map *map, const char *name);

/* A colour for structure i that has none. */
void host_label_colour(uint32_t i, float colour[3]);

#endif
