/* tangent_evening.c: evens out, along the surface, how neighbours have moved, at the last radius. Nothing else there decides where on
 * the surface a vertex comes to lie: vertices are single, forces are normal to the target. So every choice that a last bit
 * decided on the way (which triangle is nearer, who is just within a cluster) would stay in the result, and grow.
 * Evened is the displacement from the rest shape in its pose of that moment: x moves towards the place where its
 * displacement is the mean of its mesh neighbours', tangentially only. Towards the end this fades. Where the fold guard had to
 * act it ends: it would push against the guard again and again, and how far that gives way is a matter of last bits.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "runtime/state.h"

static smr_vec rest_of(const smr *s, uint32_t v)
{
    const uint32_t *r = (const uint32_t *)smr_at(s->model, s->model->at_rest) + 3u * (size_t)v;
    return smr_v(smr_le_float(r[0]), smr_le_float(r[1]), smr_le_float(r[2]));
}

/* The last radius starts: the pose from which displacements are counted, and in which the clusters' reach is bounded. Nobody
 * asks for it before the sums. One task after the other. */
uint32_t smr_even_fit_tasks(smr *s) { return s->fit_due ? smr_ceil_div(s->n, SMR_MATCH_CHUNK) : 0u; }

void smr_even_fit(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    if (task == 0u)
        smr_fit_start(&s->fit, smr_v(0, 0, 0), smr_v(0, 0, 0));
    const uint32_t last = smr_min_u32((task + 1u) * SMR_MATCH_CHUNK, s->n);
    for (uint32_t v = task * SMR_MATCH_CHUNK; v < last; v++)
        smr_fit_add(&s->fit, rest_of(s, v), smr_load(smr_at3(s->x, v)), 1.0f);
}

void smr_even_fit_end(smr *s)
{
    s->fitted = smr_fit_solve(&s->fit, 1);
    s->fit_due = 0;
}

/* The share of the way to the neighbours' mean, in the coming iteration. */
void smr_even_share(smr *s)
{
    s->even = 0.0f;
    s->begun_goals = s->n_goals;
    for (uint32_t i = 0; i < s->n_parts; i++) /* a new target counts from the next iteration on */
        s->part[i].drawn = s->part[i].target != NULL;
    if (s->radius != smr_last_radius(s) || s->repairing > 0u || s->n_goals == 0u)
        return;
    const float left = 1.0f - (float)s->radius_iteration / (float)s->config.iterations_last;
    s->even = s->config.even * left * left;
}

static void add(smr *s, uint32_t v, smr_vec a, smr_vec b)
{
    float *sum = smr_at3(s->ring_sum, v);
    smr_store(sum, smr_add(smr_load(sum), smr_add(a, b)));
    s->ring_weight[v] += 2.0f;
}

uint32_t smr_even_tasks(smr *s) { return s->even > 0.0f ? s->n_tasks : 0u; }
uint32_t smr_even_facet_tasks(smr *s) { return s->even > 0.0f ? smr_ceil_div(s->n_triangles, SMR_TRIANGLE_CHUNK) : 0u; }

void smr_even_clear(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        if (s->radius_iteration == 0u)
            s->held[v] = 0;
        smr_store(smr_at3(s->ring_sum, v), smr_v(0, 0, 0));
        s->ring_weight[v] = 0.0f;
        smr_store(smr_at3(s->displaced, v),
                  smr_sub(smr_load(smr_at3(s->x, v)), smr_pose_apply(&s->fitted, rest_of(s, v))));
    }
}

/* Sums of the mesh neighbours' displacements. Triangles share vertices: one task after the other. */
void smr_even_rings(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_TRIANGLE_CHUNK, s->n_triangles);
    for (uint32_t k = task * SMR_TRIANGLE_CHUNK; k < last; k++) {
        const uint32_t *t = s->triangle + 3u * (size_t)k;
        const smr_vec a = smr_load(smr_at3(s->displaced, t[0])), b = smr_load(smr_at3(s->displaced, t[1]));
        const smr_vec c = smr_load(smr_at3(s->displaced, t[2]));
        add(s, t[0], b, c);
        add(s, t[1], c, a);
        add(s, t[2], a, b);
    }
}

smr_vec smr_even_step(smr *s, uint32_t v)
{
    if (!(s->even > 0.0f) || !s->part[smr_model_owner(s->model, v)].drawn || !(s->ring_weight[v] > 0.0f))
        return smr_v(0, 0, 0);
    const smr_vec mean = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
    const smr_vec way = smr_sub(mean, smr_load(smr_at3(s->displaced, v))), n = smr_load(smr_at3(s->normal, v));
    return smr_scale(smr_sub(way, smr_scale(n, smr_dot(n, way))), s->even * (1.0f - (float)s->held[v] / SMR_HELD));
}
