/* strain_bound.c: a bound on what plasticity accumulates (paper 3: "unrealistic deviations can be accumulated"). Edges
 * stretched by more than config.motion.strain_most against the rest shape are shortened, before x^r follows the
 * positions: of a strain s + t beyond the yield s remains s + t / (1 + t / s), below 2 s. An edge shorter than the
 * model's mean edge counts as the mean. Edges may shrink: muscles fold, and fold steps keep triangles open.
 * Method: strain limiting of both ends (Provot 1995), triangle after triangle, in up to SMR_STRAIN_SWEEPS sweeps.
 * Bounds: SMR_STRAIN_SWEEPS passes over the triangles; one where no edge is beyond the yield.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"

#define SMR_STRAIN_SWEEPS 4u     /* most sweeps over the triangles in an iteration */
#define SMR_STRAIN_LEAST 1.0e-6f /* smaller scales and mean edges, mm, count as this: quotients stay finite */
#define SMR_STRAIN_FEW 0.001f    /* share of edges beyond the yield up to which the verdict does not mention them */
#define SMR_STRAIN_EVERY 8u      /* iterations of the last two radii from one check to the next */

/* Returns 1 when this iteration checks edges: the last one that a radius may have, and some of the last two radii. */
static int due(const smr *s)
{
    const uint32_t at = s->schedule.radius_iteration + 1u;
    const int late = at % SMR_STRAIN_EVERY == 0u && s->schedule.radius + 2u > smr_last_radius(&s->shared);
    return s->shared.config.motion.strain_most > 0.0f && (late || at >= smr_radius_iterations(s)) &&
           s->schedule.repairing == 0u && !s->schedule.tracking && s->shape.dynamics == NULL;
}

uint32_t smr_strain_tasks(const void *arg)
{
    const smr *s = arg;
    return due(s) ? smr_triangle_tasks(&s->shared) * s->reference.n_sweeps : 0u;
}

/* Shortens the edge between next positions a and b by a share of its length. */
static void shorten(smr *s, uint32_t a, uint32_t b, smr_vec edge, float share)
{
    const smr_vec half = smr_scale(edge, 0.5f * share);
    smr_put3(s->shape.x_next, a, smr_sub(smr_get3(s->shape.x_next, a), half));
    smr_put3(s->shape.x_next, b, smr_add(smr_get3(s->shape.x_next, b), half));
    s->reference.n_over++;
}

void smr_strain_limit(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr *const s = arg;
    const uint32_t n = smr_triangle_tasks(&s->shared), first = task % n * SMR_TRIANGLE_CHUNK;
    const uint32_t last = smr_min_u32(first + SMR_TRIANGLE_CHUNK, s->shared.n_triangles);
    const float most = s->shared.config.motion.strain_most;
    const float scale = smr_max(smr_length(smr_column(&s->shape.rest_pose, 0)), SMR_STRAIN_LEAST);
    const float mean = smr_max(smr_le_float(s->shared.model->edge_mm), SMR_STRAIN_LEAST);
    const float long2 = scale * scale * (1.0f + most) * (1.0f + most);
    if (first == 0u)
        s->reference.n_over = 0;
    for (uint32_t k = first; k < last; k++)
        for (uint32_t c = 0; c < 3u; c++) {
            const uint32_t *const t = smr_model_triangle(&s->shared, k), a = t[c], b = t[(c + 1u) % 3u];
            const smr_vec now = smr_sub(smr_get3(s->shape.x_next, a), smr_get3(s->shape.x_next, b));
            const smr_vec rest = smr_sub(smr_rest(&s->shared, a), smr_rest(&s->shared, b));
            const float rest2 = smr_max(smr_dot(rest, rest), mean * mean), now2 = smr_dot(now, now);
            if (!(now2 > long2 * rest2))
                continue;
            const float ratio = SMR_SQRT(now2 / rest2) / scale, beyond = ratio - 1.0f - most;
            shorten(s, a, b, now, (beyond - beyond / (1.0f + beyond / most)) / ratio);
        }
    if (last < s->shared.n_triangles)
        return;
    if (s->reference.n_sweeps == 1u)
        s->reference.many_over = (float)s->reference.n_over > SMR_STRAIN_FEW * 3.0f * (float)s->shared.n_triangles;
    if (s->reference.n_over > 0u && s->reference.n_sweeps < SMR_STRAIN_SWEEPS)
        s->reference.n_sweeps++;
}
