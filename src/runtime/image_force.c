/* image_force.c: goals in the target image (paper 2.1): the intensity profile of the reference is sought along the normal
 * within one distance, the strongest edge of the reference's polarity within another; both goals are averaged by their
 * confidence. Search distances fall linearly with the schedule.
 * Bounds: SMR_LINE_MAX samples a vertex, and as many offsets of SMR_PROFILE_MAX multiply-adds.
 * SPDX-License-Identifier: MIT */
#include "runtime/image_force.h"

#include "geometry/profile.h"

smr_status smr_set_volume(smr *s, const smr_volume *volume)
{
    smr_grid grid;
    if (s == NULL)
        return SMR_E_NULL;
    if (!smr_valid(s) || (volume != NULL && smr_le32(s->model->profile_samples) == 0u))
        return SMR_E_STATE;
    if (volume != NULL) {
        smr_status status = smr_grid_open(volume, &grid);
        if (status != SMR_OK)
            return status;
        s->grid = grid;
    }
    if (volume == NULL && !s->has_grid)
        return SMR_OK;
    s->has_grid = volume != NULL;
    smr_abandon_iteration(s);
    smr_schedule_start(s);
    return SMR_OK;
}

float smr_image_goal(const smr *s, uint32_t v, smr_vec *way)
{
    const smr_model *m = s->model;
    const uint32_t n = smr_le32(m->profile_samples), inward = smr_le32(m->profile_inward);
    const float step_mm = smr_le_float(m->profile_step);
    const uint8_t *profile = (const uint8_t *)smr_at(m, m->at_profiles) + (size_t)v * n;
    const uint32_t *ranges = (const uint32_t *)smr_at(m, m->at_ranges) + 2u * (size_t)v;
    const float low = smr_le_float(ranges[0]), range = smr_le_float(ranges[1]);
    const smr_vec normal = smr_load(smr_at3(s->normal, v));
    const uint32_t room = (SMR_LINE_MAX - SMR_PROFILE_MAX) / 2u;
    const uint32_t reach = smr_min_u32((uint32_t)(s->profile_mm / step_mm + 0.5f), room);
    const uint32_t edge_reach = smr_min_u32((uint32_t)(s->gradient_mm / step_mm + 0.5f), room);
    const uint32_t before = smr_max_u32(reach + inward, edge_reach + 2u);
    const uint32_t after = smr_max_u32(reach + n - inward, edge_reach + 3u);
    float line[SMR_LINE_MAX];
    unsigned char inside[SMR_LINE_MAX];
    if (!(range > 0.0f) || smr_dot(normal, normal) < 0.5f || before + after > SMR_LINE_MAX)
        return 0.0f;
    const smr_vec step = smr_scale(normal, step_mm);
    const smr_vec at = smr_add(smr_load(smr_at3(s->x, v)), s->origin);
    if (smr_grid_line(&s->grid, smr_sub(at, smr_scale(step, (float)before)), step, before + after, line, inside) == 0u)
        return 0.0f;
    smr_peak match = {0, 0}, edge = {0, 0};
    const uint32_t first = before - reach - inward;
    if (reach > 0u)
        match = smr_profile_match(profile, low, range, n, line + first, inside + first, n + 2u * reach,
                                  s->config.similarity == SMR_SIMILARITY_SSD);
    if (edge_reach > 0u)
        edge = smr_profile_edge(profile, range, n, inward, line, inside, before + after, before, edge_reach);
    const float total = match.confidence + edge.confidence;
    if (!(total > 0.0f))
        return 0.0f;
    const float offset = (match.confidence * (match.at - (float)reach) + edge.confidence * (edge.at - (float)before)) / total;
    *way = smr_scale(step, offset);
    return smr_min(total, 1.0f);
}
