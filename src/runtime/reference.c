/* reference.c: what matching needs of the reference shape x^r, whenever it is new: each cluster's centre c^r, mass M and
 * covariance C^r or inverse inertia tensor (paper 2.3). x^r is rounded to a power of two of a millimetre, the quantum,
 * and the moments are summed as whole numbers with wrap-around; taken relative to the cluster's own vertex the final
 * values fit and are exact, however far the cluster lies from the origin. The quantum is about a thousandth of the
 * cluster's reach; it only enters lever arms, never positions.
 * SPDX-License-Identifier: MIT */
#include "base/fixed.h"
#include "geometry/jacobi.h"
#include "runtime/state.h"

#define SMR_INERTIA_FLOOR 1.0e-4f /* a cluster thinner than this share of its length is a line: no torque about it */

uint32_t smr_reference_tasks(smr *s) { return s->reference_stale ? s->n_tasks : 0u; }
uint32_t smr_reference_blocks(smr *s) { return s->reference_stale ? s->lists.n_blocks : 0u; }

/* How far a member of a cluster can be from its own vertex in x^r: the rest distance, scaled as the start pose did, and
 * both ends' deviations from that pose. */
static float reach_bound(const smr *s)
{
    const uint32_t *rest = smr_at(s->model, s->model->at_rest);
    const smr_pose *p = &s->fitted;
    float off2 = 0.0f;
    for (uint32_t v = 0; v < s->n; v++) {
        const uint32_t *r = rest + 3u * (size_t)v;
        const smr_vec at = smr_pose_apply(p, smr_v(smr_le_float(r[0]), smr_le_float(r[1]), smr_le_float(r[2])));
        const smr_vec d = smr_sub(at, smr_load(smr_at3(s->x_ref, v)));
        off2 = smr_max(off2, smr_dot(d, d));
    }
    const smr_vec column = smr_v(p->m[0][0], p->m[1][0], p->m[2][0]);
    return 1.01f * (s->lists.reach * smr_length(column) + 2.0f * SMR_SQRT(off2)) + 1.0e-3f;
}

void smr_reference_begin(smr *s)
{
    const float reach = reach_bound(s);
    const float mass = (float)s->lists.largest * s->mass_max * s->mass_unit;
    float k = 1.0f;
    for (int i = 0; i < 40 && mass * (reach / k) * (reach / k) > 1073741824.0f; i++)
        k *= 2.0f;
    for (int i = 0; i < 20 && mass * (reach / k) * (reach / k) < 268435456.0f; i++)
        k *= 0.5f;
    s->quantum = smr_max(k, 1.0f / 4096.0f);
    s->sum_words = 10;
}

void smr_reference_record(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const float inverse_k = 1.0f / s->quantum;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        uint32_t *r = s->record + SMR_WORDS * (size_t)v;
        const float *p = smr_at3(s->x_ref, v);
        const uint32_t m = (uint32_t)(smr_mass_of(s, v) * s->mass_unit);
        const uint32_t q[3] = {smr_fixed(p[0] * inverse_k), smr_fixed(p[1] * inverse_k), smr_fixed(p[2] * inverse_k)};
        r[0] = m;
        for (uint32_t a = 0, i = 4; a < 3u; a++) {
            r[1u + a] = m * q[a];
            for (uint32_t b = a; b < 3u; b++, i++)
                r[i] = m * q[a] * q[b];
        }
    }
}

/* Covariance -> inverse inertia tensor, with a defined answer for lines and points. */
static void invert_inertia(const float c[6], float out[6])
{
    const float trace = c[SMR_XX] + c[SMR_YY] + c[SMR_ZZ];
    const float inertia[6] = {trace - c[SMR_XX], -c[SMR_XY], -c[SMR_XZ], trace - c[SMR_YY], -c[SMR_YZ], trace - c[SMR_ZZ]};
    smr_pseudo_inverse(inertia, SMR_INERTIA_FLOOR, out);
}

void smr_reference_cluster(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const float k = s->quantum, inverse_k = 1.0f / k, unit = 1.0f / s->mass_unit;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        const uint32_t *w = s->sum + SMR_WORDS * (size_t)v;
        const float *p = smr_at3(s->x_ref, v);
        const uint32_t q[3] = {smr_fixed(p[0] * inverse_k), smr_fixed(p[1] * inverse_k), smr_fixed(p[2] * inverse_k)};
        /* moments about the cluster's own vertex */
        const float mass = smr_max(smr_unfix(w[0], unit), unit);
        float d[3], c[6];
        for (uint32_t a = 0; a < 3u; a++)
            d[a] = smr_unfix(w[1u + a] - w[0] * q[a], k * unit) / mass;
        for (uint32_t a = 0, i = 0; a < 3u; a++)
            for (uint32_t b = a; b < 3u; b++, i++)
                c[i] = smr_unfix(w[4u + i] - q[a] * w[1u + b] - q[b] * w[1u + a] + w[0] * q[a] * q[b], k * k * unit) -
                       mass * d[a] * d[b];
        for (uint32_t a = 0; a < 3u; a++)
            smr_at3(s->centre, v)[a] = smr_unfix(q[a], k) + d[a];
        s->cluster_mass[v] = mass;
        float *spread = s->spread + 6u * (size_t)v;
        if (s->config.method == SMR_METHOD_RIGID)
            invert_inertia(c, spread);
        else
            memcpy(spread, c, sizeof c);
    }
}

void smr_reference_end(smr *s) { s->reference_stale = 0; }
