/* rig_parts.h: three balls in a row, for random registrations of several structures to surfaces and images.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_PARTS_H
#define RIG_PARTS_H

#include "property/rig.h"

#define RIG_PARTS 3u
#define RIG_PART_VERTICES 160u /* of one, at most */

typedef struct rig_parts {
    smr_mesh part[RIG_PARTS];
    uint32_t n_vertices;       /* of all */
    const smr_model *model[2]; /* the second with intensity profiles */
} rig_parts;

/* The balls' image, bright on dark, moved by `shift` mm along the row. */
smr_volume rig_parts_image(float shift);

/* The balls, and models of them; reference: the image that fits them. */
rig_parts rig_parts_make(const smr_volume *reference);

/* A target that lies near ball number which % 3, larger by 2 mm and `which`. */
smr_mesh rig_parts_goal(uint32_t which);

/* A configuration from the seed: short schedules, searches that open few nodes, images that often show nothing. */
smr_config rig_parts_config(uint32_t *seed);

/* In some, where the rest of it allows: dynamics, or contact. */
void rig_parts_forces(smr_config *config, uint32_t seed);

/* Meshes as one. */
smr_mesh rig_joined(const smr_mesh *mesh, uint32_t n);

/* The triangles whose normals lie within 60 degrees of a direction, a unit vector; all vertices. */
smr_mesh rig_seen_from(const smr_mesh *mesh, const float towards[3]);

/* Mean distance between equally numbered points. */
float rig_mean_far(const float *a, const float *b, uint32_t n);

#endif
