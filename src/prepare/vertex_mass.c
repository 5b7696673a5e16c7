/* vertex_mass.c: the masses m_i of the particles (paper 2.3): 1 each, or a third of the area of the adjacent
 * triangles, scaled to a mean of 1 and rounded to multiples of 1 / SMR_MASS_UNITS. Vertices without triangles (nodes
 * inside a volume mesh, landmarks) get no forces: they have the least mass, so that they hardly hold back the others.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "prepare/prepare_plan.h"

static void unit_masses(smr_plan *p)
{
    for (uint32_t v = 0; v < p->n; v++)
        p->mass[v] = p->nt == 0u ? 1.0f : 1.0f / SMR_MASS_UNITS;
    for (uint32_t i = 0; i < 3u * p->nt; i++)
        p->mass[p->triangle[i]] = 1.0f;
}

void smr_plan_mass(smr_plan *p)
{
    float total = 0.0f;
    if (p->config->mass != SMR_MASS_AREA || p->nt == 0u) {
        unit_masses(p);
        return;
    }
    for (uint32_t v = 0; v < p->n; v++)
        p->mass[v] = 0.0f;
    for (uint32_t k = 0; k < p->nt; k++) {
        const uint32_t *t = p->triangle + 3u * (size_t)k;
        const float third = smr_length(smr_corners_cross(p->xyz, t)) * (1.0f / 6.0f);
        for (uint32_t c = 0; c < 3u; c++)
            p->mass[t[c]] += third;
        total += 3.0f * third;
    }
    const float unit = total > 0.0f ? SMR_MASS_UNITS * (float)p->n / total : 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        const float units = smr_clamp(p->mass[v] * unit + 0.5f, 1.0f, SMR_MASS_MAX * SMR_MASS_UNITS);
        p->mass[v] = (float)(uint32_t)units / SMR_MASS_UNITS;
    }
}
