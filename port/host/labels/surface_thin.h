/* surface_thin.h: fewer triangles of a closed surface, by collapsing its edges in the order of their costs.
 * SPDX-License-Identifier: MIT */
#ifndef SURFACE_THIN_H
#define SURFACE_THIN_H

#include "meshes/triangle_mesh.h"

/* Collapses edges until at most so many triangles are left. The surface stays closed, no edge gets folded, the volume
 * stays but for rounding. The result does not depend on the machine. More triangles are left where no edge can collapse
 * any more: four are the least of a closed surface. 0, or -1 when out of memory; the mesh is as before then. */
int host_surface_thin(host_mesh *mesh, uint32_t most);

#endif
