/* track_points.h: points of the model's space that go along with it from frame to frame.
 * SPDX-License-Identifier: MIT */
#ifndef TRACK_POINTS_H
#define TRACK_POINTS_H

#include "files/output_files.h"
#include "landmarks/points_file.h"
#include "model/model_from_files.h"

#define HOST_POINT_COLUMNS 5000u /* most points that the table has: programs for tables end at 16,384 columns */

typedef struct host_track_points {
    host_points points; /* where they are in the frame that was carried last; n 0: there are none */
    const char *path;   /* of the file that was read, for errors; borrowed */
    const char *file;   /* what a frame's directory has them as, by the format that they were read in */
    float *now;         /* [all vertices][3] mm, structures in a row; owned */
    void *memory;       /* of the map; owned */
    smr_carry *carry;   /* lies in memory */
} host_track_points;

/* Reads the file. 0, or -1 with the error filled. Call host_track_points_free() in both cases. */
int host_track_points_read(host_track_points *t, const char *path, host_error *error);

/* Binds the points to the prepared model at rest. mirror: the coordinate that was negated in the model's files; format:
 * of the frames' surfaces, none of which may be called as the points are. The port stays. Without points nothing is
 * done. 0, or -1 with the error filled. */
int host_track_points_bind(host_track_points *t, const host_model *model, int mirror, int format, const smr_port *port,
                           host_error *error);

/* Carries them to where the model of s is. Without points nothing is done. 0, or -1 with the error filled. */
int host_track_points_carry(host_track_points *t, const smr *s, const host_model *model, host_error *error);

/* Appends the table's columns for them, or their places, each with a comma before it. */
void host_track_points_columns(const host_track_points *t, host_buffer *out);
void host_track_points_row(const host_track_points *t, host_buffer *out);

/* Adds the frame's file of points. Without points nothing is done. 0, or -1 with the error filled. */
int host_track_points_add(const host_track_points *t, const char *frame, host_output *output, host_error *error);

void host_track_points_free(host_track_points *t);

#endif
