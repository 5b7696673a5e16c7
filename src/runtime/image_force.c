/* image_force.c: goals in the target image (paper 2.1): the intensity profile of the reference is sought along the normal
 * within one distance, the strongest edge of the reference's polarity within another; both goals are averaged by their
 * confidence. Search distances fall linearly with the schedule.
 * Bounds: SMR_LINE_MAX samples a vertex, and as many offsets of SMR_PROFILE_MAX multiply-adds.
 * SPDX-License-Identifier: MIT */
#include "runtime/image_force.h"

#include "geometry/profile.h"

#define SMR_LONG 16.0f   /* samples: beyond such a search distance every SMR_HOP-th sample tells as much */
#define SMR_HOP 2u
#define SMR_NEARER 0.005f /* score lost per mm of search distance at its ends */
#define SMR_NOISE 0.1f   /* of the model's mean profile range: contrast below is none */

/* What contrast counts as none: a share of what profiles of the model have in the mean. */
static float noise_of(const smr_model *m)
{
    const uint32_t *ranges = smr_at(m, m->at_ranges), n = smr_le32(m->n_vertices);
    float sum = 0.0f, count = 0.0f;
    for (uint32_t v = 0; v < n; v++) {
        const float range = smr_le_float(ranges[2u * (size_t)v + 1u]);
        sum += range;
        count += range > 0.0f ? 1.0f : 0.0f;
    }
    return count > 0.0f ? SMR_NOISE * (sum / count) : 0.0f;
}

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
        s->noise = noise_of(s->model);
    }
    if (volume == NULL && !s->has_grid)
        return SMR_OK;
    s->has_grid = volume != NULL;
    smr_abandon_iteration(s);
    smr_schedule_start(s);
    return SMR_OK;
}

/* A vertex' reference profile as it is compared: every sample, or every second one where the search is long. */
typedef struct reference_profile {
    uint8_t value[SMR_PROFILE_MAX];
    float low, range, step_mm;
    uint32_t n, inward; /* samples, and those before the vertex */
} reference_profile;

static reference_profile reference_of(const smr *s, uint32_t v, float profile_mm)
{
    const smr_model *m = s->model;
    const uint32_t n = smr_le32(m->profile_samples), inward = smr_le32(m->profile_inward);
    const float step = smr_le_float(m->profile_step);
    const uint8_t *stored = (const uint8_t *)smr_at(m, m->at_profiles) + (size_t)v * n;
    const uint32_t *ranges = (const uint32_t *)smr_at(m, m->at_ranges) + 2u * (size_t)v;
    const uint32_t hop = profile_mm > SMR_LONG * step && n >= 4u * SMR_HOP ? SMR_HOP : 1u;
    const uint32_t first = inward % hop;
    reference_profile r;
    r.n = smr_ceil_div(n - first, hop);
    r.inward = inward / hop;
    r.step_mm = step * (float)hop;
    r.low = smr_le_float(ranges[0]);
    r.range = smr_le_float(ranges[1]);
    for (uint32_t k = 0; k < r.n; k++)
        r.value[k] = stored[first + k * hop];
    return r;
}

static int varies(const float *line, uint32_t n)
{
    uint32_t k = 1;
    while (k < n && !(line[k] < line[0]) && !(line[k] > line[0]))
        k++;
    return k < n;
}

int smr_image_goal(const smr *s, uint32_t v, smr_vec *way)
{
    const float profile_mm = smr_max(s->profile_mm, s->part[smr_model_owner(s->model, v)].wide_mm);
    const reference_profile r = reference_of(s, v, profile_mm);
    const smr_vec normal = smr_load(smr_at3(s->normal, v));
    const uint32_t room = (SMR_LINE_MAX - SMR_PROFILE_MAX) / 2u;
    const uint32_t reach = smr_min_u32((uint32_t)(profile_mm / r.step_mm + 0.5f), room);
    const uint32_t edge_reach = smr_min_u32((uint32_t)(s->gradient_mm / r.step_mm + 0.5f), room);
    const uint32_t before = smr_max_u32(reach + r.inward, edge_reach + 2u);
    const uint32_t after = smr_max_u32(reach + r.n - r.inward, edge_reach + 3u);
    float line[SMR_LINE_MAX];
    unsigned char inside[SMR_LINE_MAX];
    if (!(r.range > 0.0f) || smr_dot(normal, normal) < 0.5f || before + after > SMR_LINE_MAX || reach + edge_reach == 0u)
        return SMR_UNSEEN;
    const smr_vec step = smr_scale(normal, r.step_mm);
    const smr_vec at = smr_add(smr_load(smr_at3(s->x, v)), s->origin);
    const smr_vec start = smr_sub(at, smr_scale(step, (float)before));
    const int whole = smr_grid_line(&s->grid, start, step, before + after, line, inside) == before + after;
    smr_peak match = {0, 0}, edge = {0, 0};
    const uint32_t first = before - reach - r.inward;
    const smr_likeness how = {s->config.similarity, s->noise, SMR_NEARER * profile_mm};
    if (reach > 0u)
        match = smr_profile_match(r.value, r.low, r.range, r.n, line + first, inside + first, r.n + 2u * reach, &how);
    if (edge_reach > 0u)
        edge = smr_profile_edge(r.value, r.range, r.n, r.inward, line, inside, before + after, before, edge_reach);
    const float total = match.confidence + edge.confidence;
    if (!(smr_min(total, 1.0f) > s->config.confidence))
        return whole && varies(line, before + after) ? SMR_NO_GOAL : SMR_UNSEEN;
    const float offset = (match.confidence * (match.at - (float)reach) + edge.confidence * (edge.at - (float)before)) / total;
    *way = smr_scale(step, offset);
    return SMR_GOAL;
}
