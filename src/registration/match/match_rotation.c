/* match_rotation.c: each cluster's least-squares rigid transform T_i = [R_i, t_i] from x^r to x + f^e (paper 2.3), from
 * the cluster's sums. Rigid-body kinematics: omega = I^r^-1 L, R by Rodrigues' formula. Polar decomposition:
 * A = C^r + Sum(m u (x^r - c^r)^T), R by geometry/rotation/rotation_polar_decomposition.c. In both t = c - R c^r. R - I
 * is stored, not R: R - I is small and exactly 0 without a rotation.
 * Bounds: one pass over the active vertices.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"
#include "registration/match/cluster_match.h"

#define SMR_RADIANS 0.017453293f /* radians in a degree */

void smr_match_layout(smr_arena *a, smr_match *m, const smr_shared *shared)
{
    if (shared->config.basic.method == SMR_METHOD_POLAR)
        m->eigen = smr_slot_floats(a, m->eigen, 9u * (size_t)shared->n, SMR_KEPT_UNIT);
}

void smr_match_reset(smr_match *m, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(m->shared->n, part, parts);
    for (size_t v = p.first; m->eigen != NULL && v < p.last; v++)
        for (size_t i = 0; i < 9u; i++)
            m->eigen[9u * v + i] = i % 4u == 0u ? 1.0f : 0.0f;
}

/* Returns a cluster's rotation vector by rigid-body kinematics, rad. mu: sum of m u; w: words of Sum m x^r x u. */
static smr_vec rigid_turn(const smr_match *m, uint32_t v, smr_vec mu, const uint32_t *w, float inverse)
{
    const smr_reference *const r = m->reference;
    const float turn_deg = m->shared->config.motion.turn_deg;
    const smr_vec l = smr_sub(smr_unfix3(w, inverse), smr_cross(smr_get3(r->centre, v), mu));
    const smr_vec turn = smr_mul_symmetric(r->spread + 6u * (size_t)v, l);
    return turn_deg > 0.0f ? smr_turn_within(turn, turn_deg * SMR_RADIANS) : turn;
}

/* Writes R - I of a cluster by polar decomposition to r_minus_i. w: the words of the sum of m u x^r^T. */
static void polar(const smr_match *m, uint32_t v, smr_vec mu, const uint32_t *w, float inverse, float r_minus_i[9])
{
    const float *c = smr_at3(m->reference->centre, v), *i = m->reference->spread + 6u * (size_t)v;
    const float u[3] = {mu.x, mu.y, mu.z};
    float a[9] = {i[0], i[1], i[2], i[1], i[3], i[4], i[2], i[4], i[5]};
    float change = 0.0f;
    for (uint32_t k = 0; k < 9u; k++) {
        const float d = smr_unfix(w[k], inverse) - u[k / 3u] * c[k % 3u];
        a[k] += d;
        change = smr_max(change, smr_abs(d));
    }
    memset(r_minus_i, 0, 9u * sizeof *r_minus_i);
    if (!(change > 0.0f))
        return; /* R - I stays exactly 0: rounding would accumulate over plastic updates */
    smr_polar(a, m->eigen + 9u * (size_t)v, r_minus_i);
}

/* Writes R - I (9 entries) and t, mm, (3) of a cluster to t[12]. mu: sum of m u; w: words of the sum of moments. */
static void matrix_of(const smr_match *m, uint32_t v, smr_vec mu, const uint32_t *w, float inverse, float t[12])
{
    if (m->shared->config.basic.method == SMR_METHOD_RIGID)
        smr_rodrigues(rigid_turn(m, v, mu, w, inverse), t);
    else
        polar(m, v, mu, w, inverse, t);
    const smr_vec mean = smr_scale(mu, 1.0f / m->reference->cluster_mass[v]);
    smr_store(t + 9, smr_sub(mean, smr_mul(t, smr_get3(m->reference->centre, v))));
}

/* Writes the logarithm of a cluster's transform to t[0..5]: rotation vector, rad, and rate, mm. */
static void log_of(const smr_match *m, uint32_t v, smr_vec mu, const uint32_t *w, float inverse, float t[12])
{
    smr_vec turn;
    if (m->shared->config.basic.method == SMR_METHOD_RIGID) {
        turn = smr_turn_within(rigid_turn(m, v, mu, w, inverse), SMR_ANGLE_MAX);
    } else {
        polar(m, v, mu, w, inverse, t);
        turn = smr_rotation_log(t);
    }
    const smr_vec mean = smr_scale(mu, 1.0f / m->reference->cluster_mass[v]);
    const smr_twist twist = smr_twist_about(turn, smr_get3(m->reference->centre, v), mean);
    smr_store(t, twist.turn);
    smr_store(t + 3, twist.rate);
}

uint32_t smr_match_cluster_tasks(const void *arg) { return smr_match_tasks(((const smr_match *)arg)->schedule); }

void smr_match_clusters(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_match *m = arg;
    const uint32_t words = smr_transform_words(m->shared), first = words - 3u;
    const int logs = smr_blends_logs(m->shared);
    const float inverse0 = 1.0f / m->sums->scale[0], inverse1 = 1.0f / m->sums->scale[1];
    float largest_r = 0.0f, largest_t = 0.0f;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, m->schedule->n_active);
    for (uint32_t v = task * SMR_MATCH_CHUNK; v < last; v++) {
        uint32_t *const w = m->sums->sum + SMR_WORDS * (size_t)v;
        float t[12];
        const smr_vec mu = smr_unfix3(w, inverse0);
        if (logs)
            log_of(m, v, mu, w + 3, inverse1, t);
        else
            matrix_of(m, v, mu, w + 3, inverse1, t);
        for (uint32_t i = 0; i < first; i++)
            largest_r = smr_max(largest_r, smr_abs(t[i]));
        for (uint32_t i = first; i < words; i++)
            largest_t = smr_max(largest_t, smr_abs(t[i]));
        memcpy(w, t, words * sizeof *t); /* the transform takes the place of the cluster's sum */
    }
    m->tally[task].match.largest[0] = largest_r;
    m->tally[task].match.largest[1] = largest_t;
}

void smr_match_end(smr_match *m)
{
    m->largest[0] = m->largest[1] = 0.0f;
    for (uint32_t t = 0; t < smr_match_tasks(m->schedule); t++) {
        m->largest[0] = smr_max(m->largest[0], m->tally[t].match.largest[0]);
        m->largest[1] = smr_max(m->largest[1], m->tally[t].match.largest[1]);
    }
}
