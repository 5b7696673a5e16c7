/* rig_parts.c: three balls in a row, for random registrations of several structures to surfaces and images.
 * SPDX-License-Identifier: MIT */
#include "property/rig_parts.h"
#include <math.h>
#include <string.h>

#define SIDE 36u /* voxels of an image */

smr_volume rig_parts_image(float shift)
{
    uint8_t *voxels = rig_alloc(SIDE * SIDE * SIDE);
    for (uint32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const float p[3] = {4.0f * (float)(i % SIDE) - 60.0f - shift, 4.0f * (float)(i / SIDE % SIDE) - 70.0f,
                            4.0f * (float)(i / SIDE / SIDE) - 70.0f};
        float inside = 0.0f;
        for (uint32_t k = 0; k < RIG_PARTS; k++) {
            const float x = p[0] - 32.0f * (float)k, d2 = x * x + p[1] * p[1] + p[2] * p[2];
            inside = d2 < 400.0f ? 1.0f : (d2 < 625.0f && inside < 0.5f ? 0.4f : inside);
        }
        voxels[i] = (uint8_t)(20.0f + 200.0f * inside);
    }
    return (smr_volume){
        voxels, NULL, SMR_VOXEL_UINT8, {SIDE, SIDE, SIDE}, {-60, -70, -70}, {4, 4, 4}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
}

rig_parts rig_parts_make(const smr_volume *reference)
{
    smr_prepare_config c = rig_radii(3, 60.0f, 40.0f, 18.0f);
    rig_parts w = {.n_vertices = 0};
    for (uint32_t i = 0; i < RIG_PARTS; i++) {
        const float centre[3] = {32.0f * (float)i, 0, 0};
        w.part[i] = rig_ball(22.0f, 6, 10u + 2u * i, centre);
        w.n_vertices += w.part[i].n_vertices;
    }
    c.block_vertices = 64;
    w.model[0] = rig_model(w.part, RIG_PARTS, &c);
    c.reference = reference;
    w.model[1] = rig_model(w.part, RIG_PARTS, &c);
    return w;
}

smr_mesh rig_parts_goal(uint32_t which)
{
    const float centre[3] = {32.0f * (float)(which % RIG_PARTS) + 3.0f, 2, -3};
    return rig_ball(24.0f + (float)which, 7, 11, centre);
}

smr_config rig_parts_config(uint32_t *seed)
{
    smr_config c = rig_random(seed, 2) ? smr_config_default() : smr_config_default_image();
    c.basic.method = rig_random(seed, 2);
    c.motion.plastic_every = rig_random(seed, 4);
    c.motion.normals = rig_random(seed, 2);
    c.basic.iterations = 1u + rig_random(seed, 5);
    c.basic.iterations_last = 4u + rig_random(seed, 12);
    c.forces.reject_deviations = rig_random(seed, 3) ? 0.0f : 2.0f;
    c.forces.node_budget = rig_random(seed, 2) ? 8u : 512u;
    c.motion.settle_um = 0.0f;
    c.motion.fold_guard = rig_random(seed, 2);
    c.schedule.active_enough = rig_random(seed, 30);
    c.image.confidence = rig_random(seed, 2) ? 0.4f : rig_between(seed, 0.75f, 0.98f); /* so that many find no goal */
    c.basic.n_workers = 4;
    return c;
}

void rig_parts_forces(smr_config *config, uint32_t seed)
{
    const int alone =
        config->track.mode == SMR_TRACK_OFF && config->contact.volume == 0.0f && config->contact.smooth == 0.0f;
    config->motion.fusing = seed >> 10 & 1u;
    config->dynamics.mode = alone && (seed >> 12 & 3u) == 0u;
    config->dynamics.gravity[1] = -9810.0f;
    config->dynamics.step_ms = (float)(1u + (seed >> 14 & 63u));
    config->contact.share = config->dynamics.mode ? 0.0f : (float)(seed >> 13 & 1u);
}

smr_mesh rig_joined(const smr_mesh *mesh, uint32_t n)
{
    smr_mesh all = {NULL, NULL, 0, 0};
    for (uint32_t i = 0; i < n; i++) {
        all.n_vertices += mesh[i].n_vertices;
        all.n_triangles += mesh[i].n_triangles;
    }
    float *xyz = rig_alloc(12u * (size_t)all.n_vertices);
    uint32_t *t = rig_alloc(12u * (size_t)all.n_triangles), vertex = 0, at = 0;
    for (uint32_t i = 0; i < n; i++) {
        memcpy(xyz + 3u * (size_t)vertex, mesh[i].xyz, 12u * (size_t)mesh[i].n_vertices);
        for (uint32_t k = 0; k < 3u * mesh[i].n_triangles; k++)
            t[at++] = mesh[i].triangles[k] + vertex;
        vertex += mesh[i].n_vertices;
    }
    all.xyz = xyz;
    all.triangles = t;
    return all;
}

smr_mesh rig_seen_from(const smr_mesh *m, const float towards[3])
{
    uint32_t *t = rig_alloc(12u * (size_t)m->n_triangles);
    smr_mesh part = {m->xyz, t, m->n_vertices, 0};
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const uint32_t *from = m->triangles + 3u * (size_t)i;
        const float *a = m->xyz + 3u * from[0], *b = m->xyz + 3u * from[1], *c = m->xyz + 3u * from[2];
        const float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        const float n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        const float dot = n[0] * towards[0] + n[1] * towards[1] + n[2] * towards[2];
        if (dot > 0.5f * sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]))
            memcpy(t + 3u * (size_t)part.n_triangles++, from, 12u);
    }
    return part;
}

float rig_mean_far(const float *a, const float *b, uint32_t n)
{
    float sum = 0.0f;
    for (uint32_t v = 0; v < n; v++)
        sum += rig_far(a + 3u * (size_t)v, b + 3u * (size_t)v, 1);
    return sum / (float)n;
}
