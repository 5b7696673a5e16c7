/* point_targets.h: clouds of points as targets.
 * SPDX-License-Identifier: MIT */
#ifndef POINT_TARGETS_H
#define POINT_TARGETS_H

#include "meshes/triangle_mesh.h"

/* The mesh's vertices as a cloud in *memory; free(*memory) releases it. NULL when memory is short. */
smr_points *host_points_make(const host_mesh *mesh, void **memory);

/* The same as a surface to search in. */
smr_surface *host_points_surface(const host_mesh *mesh, void **memory);

#endif
