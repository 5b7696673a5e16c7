/* landmarks.h: landmarks and points: reads them from files, pairs two sets by label, writes points in the format of the
 * output's extension.
 * SPDX-License-Identifier: MIT */
#ifndef LANDMARKS_H
#define LANDMARKS_H

#include "files/file_read.h"
#include "meshes/triangle_mesh.h"

#define HOST_LANDMARKS_MAX 64u
#define HOST_LABEL_BYTES 64u /* including the NUL */

typedef struct host_landmarks {
    uint32_t n;
    char label[HOST_LANDMARKS_MAX][HOST_LABEL_BYTES]; /* UTF-8, not empty, unique */
    float xyz[HOST_LANDMARKS_MAX][3];                 /* mm, LPS, finite */
    struct host_points *points;                       /* not NULL: points go there, in any number */
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
int host_landmarks_add(host_landmarks *set, host_error *error, uint32_t line, host_word label, const double xyz[3]);

/* Turns the landmarks from `first` on from the named coordinate system into LPS. -1 for an unknown system. */
int host_landmarks_to_lps(host_landmarks *set, host_error *error, uint32_t line, host_word system, uint32_t first);

/* Reads the bytes of a file in any format. */
int host_landmarks_scan(host_landmarks *landmarks, const char *path, const host_bytes *bytes, host_error *error);

int host_read_markups(host_landmarks *landmarks, const char *data, size_t n, host_error *error);
/* slicer 1: the file is .fcsv, which must name its coordinate system. */
int host_read_landmark_table(host_landmarks *landmarks, const char *data, size_t n, int slicer, host_error *error);

typedef struct host_points {
    uint32_t n, capacity;
    float (*xyz)[3];                 /* [n] mm, LPS; owned */
    char (*label)[HOST_LABEL_BYTES]; /* [n]; NULL: from a surface file, which has none; owned */
    float (*orientation)[9]; /* [n] rows of matrices whose columns are axes, LPS; NULL: no point has one; owned */
    host_mesh mesh;          /* that file's triangles; its vertices are moved to xyz; owned */
} host_points;

/* Reads .mrk.json, .fcsv or CSV, told apart by content, or a surface file. Labels may be empty and occur more than
 * once. 0, or -1 with the error filled and the set empty. */
int host_points_read(const char *path, host_points *points, host_error *error);

/* Appends a point. 0, or -1 when out of memory or beyond the library's limits. */
int host_points_add(host_points *points, const char *label, size_t label_bytes, const float xyz[3]);

/* Gives the last point an orientation; those that have none get the coordinates' axes. 0, or -1 when out of memory. */
int host_points_orient(host_points *points, const float orientation[9]);

/* Takes all orientations away: of points that are carried without them. */
void host_points_unorient(host_points *points);

/* Checks that the extension is .json, .fcsv, .csv, .ply, .stl, .vtk or .obj. 0, or -1 with the error filled. */
int host_points_can_write(const char *path, host_error *error);

/* Checks that such a file can hold these points. 0, or -1 with the error filled. */
int host_points_fit(const host_points *points, const char *path, host_error *error);

/* Writes the points in the path's format into the buffer, which stores failure. */
void host_points_write(const host_points *points, const char *path, host_buffer *out);

/* Writes a point's label, or its number from 1, and the tail as a field of a CSV table, quoted where it needs it. */
void host_points_put_name(const host_points *points, uint32_t i, const char *tail, host_buffer *out);

void host_points_free(host_points *points);

#endif
