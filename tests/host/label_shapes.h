/* label_shapes.h: for tests of label maps: shapes as functions, grids, maps of them, and measures of their surfaces.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_SHAPES_H
#define LABEL_SHAPES_H

#include "base/system.h"
#include "labels/label_map.h"
#include "meshes/triangle_mesh.h"
#include "volumes/voxel_volume.h"

/* Of one thread, between open_port() and close_port(), which CMocka calls around a group. */
extern host_port label_port;
int open_port(void **state);
int close_port(void **state);

/* Negative inside; mm. */
typedef double (*shape_function)(const double p[3]);

enum { SHAPES = 5, SHAPE_BALL = 0, SHAPE_PLATE = 4 };

/* Bodies around the origin that a grid of make_grid() holds; the plate has 3 mm. */
extern const struct shape {
    const char *name;
    shape_function f;
} shapes[SHAPES];

/* A grid of about 56 mm around the origin, turned about two axes. spacing: mm. handed -1: left-handed. */
host_volume make_grid(double sx, double sy, double sz, double turn, double tilt, int handed);

/* Where the centre of a voxel lies, mm. */
void place(const host_volume *g, size_t voxel, double at[3]);

/* A map of n labels without voxels, label_1 ...; the caller frees it. */
host_label_map make_map(const host_volume *grid, uint32_t n);
void set_voxel(host_label_map *map, size_t voxel, uint16_t label);

/* A map of one label: the voxels with their centre in the shape. */
host_label_map draw(const host_volume *grid, shape_function f);

/* 1 when each edge has exactly two triangles, which run along it in opposite directions. */
int is_closed(const host_mesh *mesh);

/* The mean angle between the triangles' normals and the shape's, over the area, degrees. */
double normal_error(const host_mesh *mesh, shape_function f);

/* mm^3; of a closed surface whose normals point outwards it is positive. */
double mesh_volume(const host_mesh *mesh);

/* Dice's coefficient of the voxels in a surface and those that `index` calls 1; NULL: those in the shape. */
double dice_of(const host_mesh *mesh, const host_volume *grid, const uint16_t *index, shape_function f);

#endif
