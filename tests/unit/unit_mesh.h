/* unit_mesh.h: meshes and models for tests, in memory of the rig.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_MESH_H
#define UNIT_MESH_H

#include "oracle.h"
#include "property/rig.h"

typedef struct unit_mesh {
    float *xyz;          /* [nv][3], owned */
    uint32_t *triangles; /* [nt][3], owned; NULL when nt is 0 */
    uint32_t nv, nt;
} unit_mesh;

unit_mesh unit_mesh_new(uint32_t nv, uint32_t nt);
void unit_mesh_free(unit_mesh *m);
smr_mesh unit_view(const unit_mesh *m);

/* n random points in a box of side `size` around `at`, no triangles; every seventh is a copy of an earlier one. */
unit_mesh unit_points(oracle_random *r, uint32_t n, float at, float size);
/* Random triangles: every 5th has zero area, every 7th repeats an earlier one. They share corners when `shared`. */
unit_mesh unit_soup(oracle_random *r, uint32_t nt, float size, int shared);
/* nx by ny quads of side `step` in the xy plane, waved in z: an open surface with a border. */
unit_mesh unit_grid(uint32_t nx, uint32_t ny, float step);
/* An octahedron split `levels` times onto a sphere around `centre`: 8 * 4^levels triangles, closed. */
unit_mesh unit_sphere(uint32_t levels, float radius, float centre);
/* The fixture's bone at FIXTURE_CELL_SMALL; target != 0: the other mesh of it, not deformed. */
unit_mesh unit_bone(int target);

smr_surface *unit_surface(const unit_mesh *m);

/* smr_align() with memory of exactly the size it asks for. */
smr_status unit_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config,
                      smr_pose *pose, smr_align_report *report);

typedef struct unit_image {
    void *bytes; /* owned */
    size_t size;
    const smr_model *model;
} unit_image;

/* Prepares and opens; the image's memory is exactly as long as the image. */
unit_image unit_prepare(const smr_structure *structures, uint32_t n, const smr_prepare_config *config);
unit_image unit_prepare_mesh(const unit_mesh *m, const smr_prepare_config *config);
void unit_image_free(unit_image *image);

/* Every kind of position a run can have is finite and within `limit`. */
int unit_finite(const float *v, size_t n, float limit);

#endif
