/* rig_cloud.h: two balls beside each other and clouds of points near them.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_CLOUD_H
#define RIG_CLOUD_H

#include "property/rig.h"

#define RIG_PAIR 2u
#define RIG_CLOUD_ROOM 80u /* points of a cloud that grows */

typedef struct rig_pair {
    smr_mesh part[RIG_PAIR];
    const smr_model *model;
} rig_pair;

rig_pair rig_pair_make(void);

/* A point: position, normal (none: 0), weight. */
typedef struct rig_point {
    float xyz[3], normal[3], weight;
} rig_point;

/* An empty cloud; NULL where the library refuses it, or needs more than SMR_POINTS_BYTES() says. */
smr_points *rig_cloud(uint32_t capacity);
smr_status rig_cloud_add(smr_points *cloud, const rig_point *p);

/* A point near ball `which`, with some noise; of every third the normal is not known. */
rig_point rig_cloud_point(uint32_t *seed, uint32_t which, float radius, float noise);

/* Settings that matter to points. */
smr_config rig_cloud_config(uint32_t *seed);

#endif
