/* force.c: external forces of surface targets, f^e = stiffness (goal - x) (paper 2.1, and 3, geometric registration). The
 * goal is the target's closest point with an agreeing normal, blended with the target's own pull (pull.c).
 * Bounds: config.node_budget tree nodes a vertex.
 * SPDX-License-Identifier: MIT */
#include "base/fixed.h"
#include "runtime/pull.h"

static int outside_box(const smr_config *c, smr_vec p)
{
    return c->use_box && (p.x < c->box_min[0] || p.y < c->box_min[1] || p.z < c->box_min[2] || p.x > c->box_max[0] ||
                          p.y > c->box_max[1] || p.z > c->box_max[2]);
}

/* The way from vertex v to its goal on the target. Returns 0 when no point is acceptable. */
static int project(smr *s, uint32_t v, const smr_surface *target, smr_vec *way)
{
    /* relative to the target's origin */
    const smr_vec p = smr_add(smr_load(smr_at3(s->x, v)), smr_sub(s->origin, target->origin));
    if (outside_box(&s->config, smr_add(p, target->origin)))
        return 0;
    smr_query q = {p, smr_load(smr_at3(s->normal, v)), s->min_cos, s->config.node_budget, s->warm[v]};
    if (smr_dot(q.normal, q.normal) < 0.5f)
        q.min_cos = -2.0f; /* no triangles around this vertex: any normal will do */
    smr_hit hit = {s->search * s->search, SMR_ALL, {0, 0, 0}};
    smr_tree_closest(&target->facets, &q, &hit);
    if (hit.triangle == SMR_ALL)
        return 0;
    s->warm[v] = hit.triangle;
    if (s->config.reject_border && smr_surface_on_border(target, hit.triangle, hit.weight))
        return 0;
    if (s->force_limit > 0.0f && hit.d2 > s->force_limit * s->force_limit)
        return 0;
    *way = smr_sub(smr_facet_point(&target->facets, hit.triangle, hit.weight), p);
    return !outside_box(&s->config, smr_add(smr_add(p, *way), target->origin));
}

/* Notes how large the quantities that sums.c will round are at this vertex. */
static void measure(const smr *s, uint32_t v, smr_vec force, smr_tally *tally)
{
    const smr_vec ref = smr_load(smr_at3(s->x_ref, v));
    const smr_vec u = smr_scale(smr_sub(smr_add(smr_load(smr_at3(s->x, v)), force), ref), smr_mass_of(s, v));
    const float largest = smr_max(smr_abs(u.x), smr_max(smr_abs(u.y), smr_abs(u.z)));
    const float arm = smr_max(smr_abs(ref.x), smr_max(smr_abs(ref.y), smr_abs(ref.z)));
    tally->largest[0] = smr_max(tally->largest[0], largest);
    tally->largest[1] = smr_max(tally->largest[1], (s->config.method == SMR_METHOD_RIGID ? 2.0f : 1.0f) * arm * largest);
}

void smr_force_search(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    smr_tally *tally = &s->tally[task];
    const int pulled = smr_pull_on(s);
    const float share = s->config.attraction;
    memset(tally, 0, sizeof *tally);
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        const smr_surface *target = s->part[smr_model_owner(s->model, v)].target;
        smr_vec goal = smr_v(0, 0, 0), pull = goal;
        if (target != NULL) {
            const int has_goal = project(s, v, target, &goal);
            const float weight = pulled ? smr_pull_take(s, v, &pull) : 0.0f;
            if (has_goal)
                goal = smr_add(smr_scale(goal, 1.0f - share * weight), smr_scale(pull, share * weight));
            else
                goal = smr_scale(pull, weight);
            if (s->radius == smr_last_radius(s)) {
                const smr_vec nn = smr_load(smr_at3(s->normal, v));
                const smr_vec along = smr_scale(nn, smr_dot(nn, goal));
                goal = smr_add(along, smr_scale(smr_sub(goal, along), s->config.slide));
            }
            tally->n_active++;
            if (has_goal || weight > 0.0f) {
                const float d2 = smr_dot(goal, goal), d = SMR_SQRT(d2);
                tally->n_forces++;
                tally->sum += d;
                tally->sum2 += d2;
                tally->max = smr_max(tally->max, d);
            } else {
                tally->n_rejected++;
            }
        }
        smr_vec force = smr_scale(goal, s->repairing > 0u ? 0.0f : s->config.stiffness);
        if (s->config.momentum > 0.0f && s->repairing == 0u)
            force = smr_add(force, smr_scale(smr_sub(smr_load(smr_at3(s->x, v)), smr_load(smr_at3(s->x_next, v))),
                                             s->config.momentum));
        smr_store(smr_at3(s->force, v), force);
        measure(s, v, force, tally);
    }
}

void smr_force_end(smr *s)
{
    smr_tally all;
    memset(&all, 0, sizeof all);
    for (uint32_t t = 0; t < s->n_tasks; t++) {
        const smr_tally *one = &s->tally[t];
        all.sum += one->sum;
        all.sum2 += one->sum2;
        all.max = smr_max(all.max, one->max);
        all.n_forces += one->n_forces;
        all.n_rejected += one->n_rejected;
        all.n_active += one->n_active;
        all.largest[0] = smr_max(all.largest[0], one->largest[0]);
        all.largest[1] = smr_max(all.largest[1], one->largest[1]);
    }
    const float n = all.n_forces > 0u ? (float)all.n_forces : 1.0f;
    const float mean = all.sum / n, square = all.sum2 / n;
    s->report.n_active = all.n_active;
    s->report.n_forces = all.n_forces;
    s->report.n_rejected = all.n_rejected;
    s->report.residual_mean_mm = mean;
    s->report.residual_rms_mm = SMR_SQRT(square);
    s->report.residual_max_mm = all.max;
    const float deviation = SMR_SQRT(smr_max(square - mean * mean, 0.0f));
    const float k = s->config.reject_deviations;
    s->force_limit = k > 0.0f && all.n_forces > 0u ? smr_max(mean + k * deviation, 1.0e-3f) : 0.0f;
    s->scale[0] = smr_fixed_scale((float)s->lists.largest * all.largest[0]);
    s->scale[1] = smr_fixed_scale((float)s->lists.largest * all.largest[1]);
    s->sum_words = s->config.method == SMR_METHOD_RIGID ? 6u : 12u;
}
