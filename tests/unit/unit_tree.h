/* unit_tree.h: box trees of test meshes, questions to them, and a search of all triangles.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_TREE_H
#define UNIT_TREE_H

#include "geometry/box_tree/box_tree.h"
#include "unit_mesh.h"

/* Triangles of m in tree order with boxes and normals; frees nothing of m. */
smr_box_tree unit_plant(const unit_mesh *m, uint32_t **triangles);
void unit_uproot(smr_box_tree *f, uint32_t *triangles);

/* Writes the closest acceptable triangle nearer than *hit; ties go to the smallest index. */
void unit_closest(const smr_box_tree *f, const smr_query *q, smr_hit *hit);

/* A question of a kind: free points or the mesh's own, with and without a warm start or a normal. */
smr_query unit_query(oracle_random *r, const unit_mesh *m, uint32_t kind);

#endif
