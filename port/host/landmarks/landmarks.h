/* landmarks.h: landmarks: reads them from files and pairs two sets by label.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_H
#define LANDMARKS_H

#include <stdint.h>

#include "base/error_line.h"

#define HOST_LANDMARKS_MAX 64u
#define HOST_LABEL_BYTES 64u /* including the NUL */

typedef struct host_landmarks {
    uint32_t n;
    char label[HOST_LANDMARKS_MAX][HOST_LABEL_BYTES]; /* UTF-8, not empty, unique */
    float xyz[HOST_LANDMARKS_MAX][3];                 /* mm, LPS, finite */
    struct host_points *points;                       /* not NULL: points go there, in any number; see points_file.h */
} host_landmarks;

/* Reads 3D Slicer markups (.mrk.json, .fcsv) or CSV (label,x,y,z in LPS, or as its header line names the columns),
 * told apart by content.
 * Returns 0, or -1 with the error filled and the set empty. */
int host_landmarks_read(const char *path, host_landmarks *landmarks, host_error *error);

/* Pairs landmarks by label: from[i] of the model, to[i] of the target, in the model's order. Both sets must have the
 * same labels. The paths are for the error. Returns 0, or -1 with the error filled. */
int host_landmarks_pair(const host_landmarks *model, const host_landmarks *target, const char *model_path,
                        const char *target_path, float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3],
                        uint32_t *n, host_error *error);

#endif
