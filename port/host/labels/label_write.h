/* label_write.h: writes label maps: .seg.nrrd with names and colours, .nrrd, .mha, .nii, .nii.gz.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_WRITE_H
#define LABEL_WRITE_H

#include "base/byte_buffer.h"
#include "labels/label_map.h"

/* Checks that the extension is one of those. 0, or -1 with the error filled. */
int host_labels_can_write(const char *path, host_error *error);

/* Writes a map of one layer in the format of the path's extension. Labels of more than 65535 do not fit: -1 with the
 * error filled. */
int host_labels_write(const host_label_map *map, const char *path, host_buffer *out, host_error *error);

#endif
