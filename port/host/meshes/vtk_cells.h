/* vtk_cells.h: polygons and triangle strips of legacy VTK polydata.
 * SPDX-License-Identifier: MIT */
#ifndef VTK_CELLS_H
#define VTK_CELLS_H

#include "meshes/vtk_values.h"

/* How to read the cells of a section. */
enum { HOST_VTK_SKIP = 0, HOST_VTK_POLYGONS, HOST_VTK_STRIPS };

/* Reads a section whose keyword has just been read: counts, then "n i j k ..." rows or, since version 5.1,
 * the arrays OFFSETS and CONNECTIVITY. */
int host_vtk_cells(host_vtk *vtk, int use);

#endif
