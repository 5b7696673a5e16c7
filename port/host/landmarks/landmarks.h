/* landmarks.h: landmarks: reads them from files and pairs two sets by label.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_H
#define LANDMARKS_H

#include <stddef.h>
#include <stdint.h>

#include "base/error_line.h"
#include "base/text_scan.h"
#include "files/file_read.h"

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

/* Adds the landmark of a line. Refuses labels and coordinates that host_landmarks does not allow. */
int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3]);

/* Turns the landmarks from `first` on from the named coordinate system into LPS. -1 for an unknown system. */
int host_landmarks_to_lps(host_landmarks *landmarks, host_error *error, uint32_t line, host_word system,
                          uint32_t first);

/* Reads the bytes of a file in any format. */
int host_landmarks_scan(host_landmarks *landmarks, const char *path, const host_bytes *bytes, host_error *error);

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error);
/* slicer 1: the file is .fcsv, which must name its coordinate system. */
int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error);

#endif
