/* label_names.h: the names and colours of labels: from a .seg.nrrd, from a text file, or made up.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_NAMES_H
#define LABEL_NAMES_H

#include "base/byte_buffer.h"
#include "labels/label_map.h"

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

/* Gives the map's labels these names. Labels without a name then become label_VALUE; of several with the same name each
 * gets its value behind it. */
int host_labels_settle_names(host_label_map *map, const host_names *names, host_error *error);

/* Copies a text as a name. Other characters than a name may have become '_', also a dot at the start. 0, or -1 when
 * it is empty or too long. */
int host_label_name(const char *text, size_t n, char name[SMR_NAME_BYTES]);

/* The label that has this name once its characters are those of a name, or NULL. */
const host_label *host_label_find_like(const host_label_map *map, const char *name);

/* A colour for structure i that has none. */
void host_label_colour(uint32_t i, float colour[3]);

#endif
