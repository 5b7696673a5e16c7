/* case_points.h: clouds of points on the visible part of a case's true surface, and registrations onto them.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_POINTS_H
#define CASE_POINTS_H

#include "case_table.h"

typedef struct case_cloud {
    float *xyz, *normal; /* [n][3], mm and unit; owned */
    uint32_t n;
} case_cloud;

/* How a cloud is used. */
typedef struct case_feed {
    uint32_t n;        /* points */
    uint32_t per_tick; /* so many before each tick; 0: all at once */
    int normals;       /* 1: with normals */
    int sweep;         /* 1: in the order of the long axis instead of a random one */
} case_feed;

/* n points evenly over a mesh' area, with isotropic noise; normals of the triangles. */
case_cloud case_sample(const host_mesh *mesh, uint32_t n, double noise_mm, uint32_t seed);
void case_cloud_free(case_cloud *cloud);

/* The library's registration of body 0 with the defaults. 0 when a call failed. */
int case_run_points(const case_data *data, const case_feed *feed, double noise_mm, uint32_t seed, case_row *row);

/* Lines "points 3000", "points 300" and so on over bones and seeds; returns how many bounds were missed. */
int case_table_points(const char *lines, const char *bones, uint32_t first, uint32_t last);

#endif
