/* intensity_profiles_prepare.c: samples the reference image along the normal of each vertex: the profiles (paper 2.1).
 * SPDX-License-Identifier: MIT */
#include "geometry/surface/mesh.h"
#include "image/intensity_profile.h"
#include "image/volume.h"
#include "prepare/prepare_plan.h"

#define SMR_OUTWARD 1.6f /* default length of a profile outside the surface, in mean voxel sizes */

uint32_t smr_profile_inward(const smr_prepare_config *c)
{
    const float n = (float)c->profile_samples, *spacing = c->reference->spacing;
    float share = c->profile_inward;
    if (share < 0.0f) {
        const float outward = SMR_OUTWARD * (spacing[0] + spacing[1] + spacing[2]) * (1.0f / 3.0f);
        share = smr_clamp(1.0f - outward / (n * c->profile_step_mm), 0.0f, 1.0f);
    }
    return smr_min_u32((uint32_t)(share * n), c->profile_samples - 1u);
}

smr_status smr_plan_profiles(smr_plan *p)
{
    const smr_prepare_config *c = p->config;
    smr_grid grid;
    const smr_status status = p->profile == NULL ? SMR_OK : smr_grid_open(c->reference, &grid);
    if (p->profile == NULL || status != SMR_OK)
        return status;
    const uint32_t n = c->profile_samples, inward = smr_profile_inward(c);
    const smr_mesh mesh = {p->xyz, p->triangle, p->n, p->nt};
    smr_mesh_normals(&mesh, p->normal, NULL);
    for (uint32_t v = 0; v < p->n; v++) {
        float value[SMR_PROFILE_MAX];
        unsigned char inside[SMR_PROFILE_MAX];
        const smr_vec step = smr_scale(smr_get3(p->normal, v), c->profile_step_mm);
        const smr_vec at = smr_add(smr_get3(p->xyz, v), smr_load(p->centre));
        (void)smr_grid_line(&grid, smr_sub(at, smr_scale(step, (float)inward)), step, n, value, inside);
        smr_profile_pack(value, inside, n, p->profile + (size_t)v * n, &p->range[2u * (size_t)v],
                         &p->range[2u * (size_t)v + 1u]);
    }
    return SMR_OK;
}
