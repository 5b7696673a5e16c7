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

/* Returns the difference of further shape i, mapped by `pose`, from the model's own at a vertex along the curve, mm. */
static smr_vec difference(const smr_plan *p, uint32_t i, const smr_pose *pose, uint32_t along)
{
    return smr_sub(smr_pose_apply(pose, position(p, i, p->original[along])), smr_get3(p->xyz, along));
}

/* Returns the mean variance of a coordinate over all shapes, the model's own included, mm^2. */
static float variance(const smr_plan *p, const smr_pose *pose)
{
    const float n = (float)p->config->also->n + 1.0f;
    float sum = 0.0f, lost = 0.0f;
    for (uint32_t v = 0; v < p->n; v++) {
        smr_vec all = smr_v(0, 0, 0);
        float square = 0.0f;
        for (uint32_t i = 0; i < p->config->also->n; i++) {
            const smr_vec d = difference(p, i, &pose[i], v);
            all = smr_add(all, d);
            square += smr_dot(d, d);
        }
        const float term = (square - smr_dot(all, all) / n) / (3.0f * n) - lost, next = sum + term;
        lost = (next - sum) - term;
        sum = next;
    }
    return smr_max(sum / (float)p->n, 0.0f);
}

void smr_write_references(const smr_plan *p, smr_writer *w, struct smr_model *head)
{
    smr_pose pose[SMR_REFERENCES_MAX];
    const uint32_t n = p->config->also == NULL ? 0u : p->config->also->n;
    if (n == 0u)
        return;
    for (uint32_t i = 0; i < n; i++)
        pose[i] = onto_own(p, i);
    const size_t table = smr_put_section(w, sizeof(smr_stored_section));
    const uint32_t bytes = (uint32_t)(sizeof(smr_stored_references) + 12u * (size_t)n * p->n);
    const size_t at = smr_put_section(w, bytes);
    const uint32_t record[4] = {SMR_SECTION_REFERENCES, 0, (uint32_t)at, bytes};
    const uint32_t first[4] = {n, p->n, smr_float_bits(variance(p, pose)), 0};
    for (uint32_t i = 0; i < 4u; i++) {
        smr_put32(w, table + 4u * i, record[i]);
        smr_put32(w, at + 4u * i, first[i]);
    }
    size_t to = at + sizeof(smr_stored_references);
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t v = 0; v < p->n; v++, to += 12u) {
            const smr_vec d = difference(p, i, &pose[i], p->along[v]);
            smr_put32(w, to, smr_float_bits(d.x));
            smr_put32(w, to + 4u, smr_float_bits(d.y));
            smr_put32(w, to + 8u, smr_float_bits(d.z));
        }
    head->n_sections = 1;
    head->at_sections = (uint32_t)table;
}
