/* label_surfaces.h: the surfaces of all structures of a label map.
 * SPDX-License-Identifier: MIT */
#ifndef LABEL_SURFACES_H
#define LABEL_SURFACES_H

#include "labels/label_map.h"
#include "meshes/triangle_mesh.h"

/* Collapses edges until at most so many triangles are left. The surface stays closed, no edge gets folded, the volume
 * stays but for rounding. The result does not depend on the machine. More triangles are left where no edge can collapse
 * any more: four are the least of a closed surface. 0, or -1 when out of memory; the mesh is as before then. */
int host_surface_thin(host_mesh *mesh, uint32_t most);

typedef struct host_label_surface {
    host_mesh mesh;      /* mm, LPS; owned */
    double volume, area; /* inside, mm^3; mm^2 */
    double voxel_volume; /* of the voxels, mm^3 */
    uint32_t folds;      /* edges turned back by more than a right angle */
    const char *failed;  /* what was expected; NULL: made */
} host_label_surface;

/* Makes the surface of each label, surface[map->n_labels], with all threads. passes: of smoothing. most: triangles of
 * each, 4 or more; 0: all; refuses where one cannot have so few. 0, or -1 with the
 * error filled; host_label_surfaces_free in either case. */
int host_label_surfaces_make(const smr_port *port, const host_label_map *map, uint32_t passes, uint32_t most,
                             host_label_surface *surface, host_error *error);
/* Frees the array, too; it may be NULL. */
void host_label_surfaces_free(host_label_surface *surface, uint32_t n);

enum { HOST_SMOOTHING_PASSES = 80 };

#endif
