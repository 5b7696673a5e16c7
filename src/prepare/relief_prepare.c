/* relief_prepare.c: the relief of each structure, as a target surface of the structure would have it.
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/surface.h"
#include "prepare/prepare_plan.h"

static int16_t stored(float relief)
{
    const float units = smr_clamp(SMR_RELIEF_ONE * relief, -SMR_RELIEF_ONE, SMR_RELIEF_ONE);
    return (int16_t)(int)(units + (units < 0.0f ? -0.5f : 0.5f));
}

void smr_plan_relief(smr_plan *p, void *scratch, size_t bytes)
{
    int16_t *to = p->relief;
    for (uint32_t i = 0; i < p->n_structures; i++) {
        const smr_mesh *const mesh = &p->structures[i].mesh;
        smr_surface *s = NULL;
        const float *relief = smr_surface_build(mesh, scratch, bytes, &s) == SMR_OK ? s->relief : NULL;
        for (uint32_t v = 0; v < mesh->n_vertices; v++)
            *to++ = relief == NULL ? SMR_RELIEF_NONE : stored(relief[v]);
    }
}

void smr_write_relief(const smr_plan *p, smr_writer *w, uint32_t entry[4])
{
    const size_t at = smr_put_section(w, sizeof(int16_t) * (size_t)p->n);
    for (size_t v = 0; v < p->n; v++)
        smr_put16(w, at + 2u * v, (uint16_t)p->relief[p->original[p->along[v]]]);
    entry[0] = SMR_SECTION_RELIEF;
    entry[1] = 0;
    entry[2] = (uint32_t)at;
    entry[3] = 2u * p->n;
}
