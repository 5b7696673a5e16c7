/* info_volume.h: what a volume is: an image, or a label map with its structures.
 * SPDX-License-Identifier: MIT */
#ifndef INFO_VOLUME_H
#define INFO_VOLUME_H

#include "base/error_line.h"

/* Prints it. A .seg.nrrd is a label map, as is every volume with a file of names (NULL: none) and what looks like one:
 * whole numbers from 0 on, mostly next to their like. 0, or -1 with the error filled. */
int host_info_volume(const char *path, const char *names, host_error *error);

#endif
