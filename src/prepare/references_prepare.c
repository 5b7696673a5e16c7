/* references_prepare.c: shapes of further subjects with the model's vertices. Each is mapped by a similarity onto the
 * model's own shape, and stored as the difference that is left.
 * Bounds: three passes over the vertices for each shape.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/similarity_fit.h"
#include "prepare/prepare_plan.h"

/* Returns the position of a caller's vertex in further shape i, mm from the model's centre. */
static smr_vec position(const smr_plan *p, uint32_t i, uint32_t v)
{
    const float *const xyz = p->config->also->xyz + 3u * ((size_t)i * p->n + v);
    return smr_sub(smr_load(xyz), smr_load(p->centre));
}

/* Returns the similarity that maps further shape i onto the model's own shape. */
static smr_pose onto_own(const smr_plan *p, uint32_t i)
{
    smr_fit fit;
    smr_fit_start(&fit, position(p, i, 0), smr_get3(p->xyz, p->position[0]));
    for (uint32_t v = 0; v < p->n; v++)
        smr_fit_add(&fit, position(p, i, v), smr_get3(p->xyz, p->position[v]), 1.0f);
    return smr_fit_solve(&fit, 1);
}

/* Returns the position of shape i, 0: the model's own, mapped by pose[i - 1], at a vertex along the curve, mm. */
static smr_vec mapped(const smr_plan *p, uint32_t i, const smr_pose *pose, uint32_t along)
{
    return i == 0u ? smr_get3(p->xyz, along) : smr_pose_apply(&pose[i - 1u], position(p, i - 1u, p->original[along]));
}

void smr_write_references(const smr_plan *p, smr_writer *w, uint32_t entry[4])
{
    smr_pose pose[SMR_REFERENCES_MAX];
    const uint32_t n = p->config->also->n + 1u;
    for (uint32_t i = 1; i < n; i++)
        pose[i - 1u] = onto_own(p, i - 1u);
    const size_t bytes = 3u * sizeof(float) * n * p->n, at = smr_put_section(w, bytes);
    entry[0] = SMR_SECTION_REFERENCES;
    entry[1] = 0;
    entry[2] = (uint32_t)at;
    entry[3] = (uint32_t)bytes;
    for (uint32_t v = 0; v < p->n; v++) {
        smr_vec mean = smr_v(0, 0, 0);
        for (uint32_t i = 0; i < n; i++)
            mean = smr_add(mean, smr_scale(mapped(p, i, pose, p->along[v]), 1.0f / (float)n));
        for (uint32_t i = 0; i < n; i++) {
            const smr_vec d = smr_sub(mapped(p, i, pose, p->along[v]), mean);
            const uint32_t bits[3] = {smr_float_bits(d.x), smr_float_bits(d.y), smr_float_bits(d.z)};
            smr_put_words(w, at + 3u * sizeof(float) * ((size_t)i * p->n + v), bits, 3);
        }
    }
}
