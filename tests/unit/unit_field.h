/* unit_field.h: what tests of the field of unseen vertices share: as much of a registration as it looks at, where it
 * carries vertices, and displacements to find.
 * SPDX-License-Identifier: MIT */
#ifndef UNIT_FIELD_H
#define UNIT_FIELD_H

#include <math.h>
#include <string.h>

#include "oracle.h"
#include "registration/goals/external_forces.h"

enum { N = 5000 }; /* so that controls are chosen in several tasks */

/* A registration of N vertices as far as the field looks at it. Lengths in mm. */
typedef struct world {
    smr_shared shared;
    smr_schedule schedule;
    smr_shape shape;
    smr_surface_goals goals;
    smr_target target;
    smr_overlay overlay;
    smr_landmark_goals landmarks;
    smr_occluded_field field;
    uint32_t memory[(9u + SMR_FIELD_MOTIONS) * SMR_FIELD_ROWS + SMR_FACTOR_WORDS(SMR_FIELD_ROWS)];
    float start[3 * N], x[3 * N], normal[3 * N];
    uint8_t seen[N];
    struct {
        smr_model head;
        uint16_t owner[N];
    } model; /* of which only the structure of each vertex is asked for */
} world;

static world w; /* each test fills it */

/* Random places in a box of 100 x 60 x 400 mm, at rest; all seen. */
static inline void begin(float radius)
{
    oracle_random r = oracle_seed(7);
    memset(&w, 0, sizeof w);
    w.shared.n = N;
    w.shared.n_structures = 1;
    w.model.head.at_owner =
        smr_le32((uint32_t)((const unsigned char *)w.model.owner - (const unsigned char *)&w.model));
    w.shared.model = &w.model.head;
    w.target.partial = 1;
    w.schedule.lists.radius = radius;
    w.shape.start = w.start;
    w.shape.x = w.x;
    w.shape.normal = w.normal;
    w.shape.start_box = (smr_box){{0, 0, 0}, {100, 60, 400}};
    w.goals.shared = &w.shared;
    w.goals.target = &w.target;
    w.goals.visibility = w.goals.visibility_next = w.seen;
    w.goals.partial = 1;
    w.overlay.sum = w.memory;
    for (uint32_t i = 0; i < N; i++) {
        const float at[3] = {oracle_uniformf(&r, 0, 100), oracle_uniformf(&r, 0, 60), oracle_uniformf(&r, 0, 400)};
        memcpy(w.start + 3u * i, at, sizeof at);
        memcpy(w.x + 3u * i, at, sizeof at);
        w.normal[3u * i] = 1.0f;
        w.seen[i] = SMR_VISIBLE_ONE;
    }
    smr_occluded_field_wire(&w.field, &w.shared, &w.schedule, &w.shape, &w.goals, &w.landmarks, &w.overlay);
}

static inline void solve(void)
{
    w.target.n_visible = 0;
    for (uint32_t i = 0; i < N; i++)
        w.target.n_visible += w.seen[i] > SMR_VISIBLE_ONE / 2u;
    for (uint32_t task = 0; task < smr_occluded_field_tasks(&w.field); task++)
        smr_occluded_field_solve(&w.field, task, 0);
}

/* Where the field carries a vertex. */
static inline smr_vec carried(uint32_t v)
{
    smr_vec way = smr_v(0, 0, 0);
    const uint8_t seen = w.seen[v];
    w.seen[v] = 0;
    smr_occluded_field_blend(&w.field, v, 1, &way);
    w.seen[v] = seen;
    way = smr_scale(way, w.field.by_normals ? 1.0f / smr_field_normals_step(&w.field) : 1.0f);
    return smr_add(way, smr_load(w.x + 3u * v));
}

static inline float off(uint32_t v, smr_vec from) { return smr_length(smr_sub(carried(v), from)); }

static inline smr_vec similar(const float start[3])
{
    float m[9];
    const smr_vec p = smr_load(start);
    static const float axis[3] = {0.6f, 0.0f, 0.8f};
    const float c = cosf(0.7f), s = sinf(0.7f);
    for (uint32_t i = 0; i < 3u; i++)
        for (uint32_t k = 0; k < 3u; k++)
            m[3u * i + k] = (1.0f - c) * axis[i] * axis[k] + (i == k ? c : 0.0f);
    m[1] -= s * axis[2], m[2] += s * axis[1], m[3] += s * axis[2], m[5] -= s * axis[0], m[6] -= s * axis[1],
        m[7] += s * axis[0];
    return smr_v(1.2f * (m[0] * p.x + m[1] * p.y + m[2] * p.z) + 30.0f,
                 1.2f * (m[3] * p.x + m[4] * p.y + m[5] * p.z) - 12.0f,
                 1.2f * (m[6] * p.x + m[7] * p.y + m[8] * p.z) + 5.0f);
}

static inline smr_vec bent(const float p[3])
{
    return smr_v(p[0] + 6.0f * sinf(0.012f * p[2]), p[1] + 4.0f * cosf(0.01f * p[2] + 0.02f * p[0]), p[2]);
}

static inline float mean_off(void)
{
    float sum = 0.0f;
    uint32_t n = 0;
    for (uint32_t i = 0; i < N; i++)
        if (w.seen[i] == 0u) {
            sum += off(i, bent(w.start + 3u * i));
            n++;
        }
    return sum / (float)n;
}

#endif
