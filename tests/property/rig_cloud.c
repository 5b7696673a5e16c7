/* rig_cloud.c: two balls beside each other and clouds of points near them.
 * SPDX-License-Identifier: MIT */
#include "property/rig_cloud.h"
#include <math.h>
#include <string.h>

static const float centre[RIG_PAIR][3] = {{0, 0, 0}, {40, 0, 0}};

rig_pair rig_pair_make(void)
{
    const smr_prepare_config radii = rig_radii(3, 60, 30, 12);
    rig_pair pair;
    for (uint32_t i = 0; i < RIG_PAIR; i++)
        pair.part[i] = rig_ball(22.0f, 8, 12u + 2u * i, centre[i]);
    pair.model = rig_model(pair.part, RIG_PAIR, &radii);
    return pair;
}

smr_points *rig_cloud(uint32_t capacity)
{
    smr_points *cloud = NULL;
    size_t bytes = 0;
    if (smr_points_bytes(capacity, &bytes) != SMR_OK || bytes > SMR_POINTS_BYTES(capacity) ||
        smr_points_open(capacity, rig_alloc(bytes), bytes, &cloud) != SMR_OK)
        return NULL;
    return cloud;
}

smr_status rig_cloud_add(smr_points *cloud, const rig_point *p)
{
    return smr_points_add(cloud, p->xyz, p->normal, &p->weight, 1);
}

rig_point rig_cloud_point(uint32_t *seed, uint32_t which, float radius, float noise)
{
    rig_point p;
    float length = 0.0f;
    while (!(length > 0.2f && length < 1.0f)) {
        for (uint32_t c = 0; c < 3u; c++)
            p.normal[c] = rig_between(seed, -1, 1);
        length = sqrtf(p.normal[0] * p.normal[0] + p.normal[1] * p.normal[1] + p.normal[2] * p.normal[2]);
    }
    for (uint32_t c = 0; c < 3u; c++)
        p.xyz[c] = centre[which][c] + (radius + noise * rig_between(seed, -1, 1)) * p.normal[c] / length;
    if (rig_random(seed, 3) == 0u)
        memset(p.normal, 0, sizeof p.normal);
    p.weight = rig_random(seed, 6) == 0u ? 0.0f : rig_between(seed, 0.5f, 2.0f);
    return p;
}

smr_config rig_cloud_config(uint32_t *seed)
{
    smr_config c = smr_config_default();
    c.basic.n_workers = 4;
    c.basic.n_target_vertices = 3 * RIG_CLOUD_ROOM;
    c.basic.iterations = 1u + rig_random(seed, 3);
    c.basic.iterations_last = 4u + rig_random(seed, 8);
    c.forces.node_budget = rig_random(seed, 2) ? 8u : 512u;
    c.partial.noise_mm = rig_random(seed, 2) ? 0.5f : 0.0f;
    c.basic.attraction = rig_random(seed, 3) ? 0.5f : 0.0f;
    c.partial.coverage = rig_random(seed, 4) ? SMR_COVERAGE_AUTO : SMR_COVERAGE_WHOLE;
    return c;
}
