/* points_file.h: sets of any number of points: landmark files as landmarks.h reads them, and the vertices of a surface
 * file; written in the format of the output's extension.
 * SPDX-License-Identifier: MIT */
#ifndef POINTS_FILE_H
#define POINTS_FILE_H

#include "base/byte_buffer.h"
#include "landmarks/landmarks.h"
#include "meshes/triangle_mesh.h"

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

/* Writes a point's label and the tail as a field of a CSV table, in quotes where it needs them; without a label the
 * point's number, from 1. */
void host_points_put_name(const host_points *points, uint32_t i, const char *tail, host_buffer *out);

void host_points_free(host_points *points);

#endif
