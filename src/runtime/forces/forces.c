/* forces.c: external forces of surface targets, f^e = stiffness (goal - x) (paper 2.1, and 3, geometric registration). The
 * goal is the target's closest point with an agreeing normal, blended with the target's own pull (attract.c).
 * Bounds: config.node_budget tree nodes a vertex.
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "runtime/forces/image_goal.h"
#include "runtime/forces/attract.h"

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
    s->warm_next[v] = s->warm[v];
    if (outside_box(&s->config, smr_add(p, target->origin)))
        return 0;
    smr_query q = {p, smr_load(smr_at3(s->normal, v)), s->min_cos, s->config.node_budget, s->warm[v]};
    if (smr_dot(q.normal, q.normal) < 0.5f)
        q.min_cos = -2.0f; /* no triangles around this vertex: any normal will do */
    smr_hit hit = {s->search * s->search, SMR_NONE, {0, 0, 0}};
    smr_tree_closest(&target->facets, &q, &hit);
    if (hit.triangle == SMR_NONE)
        return 0;
    s->warm_next[v] = hit.triangle;
    if (s->config.reject_border && smr_surface_on_border(target, hit.triangle, hit.weight))
        return 0;
    if (s->force_limit > 0.0f && hit.d2 > s->force_limit * s->force_limit)
        return 0;
    *way = smr_sub(smr_facet_point(&target->facets, hit.triangle, hit.weight), p);
    return !outside_box(&s->config, smr_add(smr_add(p, *way), target->origin));
}

/* Notes how large the quantities that sums.c will round are at this vertex. */
static void measure(const smr *s, uint32_t v, smr_tally *tally)
{
    const smr_vec ref = smr_load(smr_at3(s->x_ref, v)), u = smr_scale(smr_drive(s, v), smr_full_mass(s, v));
    const float largest = smr_max(smr_abs(u.x), smr_max(smr_abs(u.y), smr_abs(u.z)));
    const float arm = smr_max(smr_abs(ref.x), smr_max(smr_abs(ref.y), smr_abs(ref.z)));
    tally->largest[0] = smr_max(tally->largest[0], largest);
    tally->largest[1] =
        smr_max(tally->largest[1], (s->config.method == SMR_METHOD_RIGID ? 2.0f : 1.0f) * arm * largest);
}

/* A way without what runs along the model's surface, except the share that may count: where goals jump from one place of the
 * target to another, they jump along the surface. Vertices without triangles have no surface. */
static smr_vec off_surface(const smr *s, uint32_t v, smr_vec way)
{
    const smr_vec n = smr_load(smr_at3(s->normal, v)), along_normal = smr_scale(n, smr_dot(n, way));
    if (smr_dot(n, n) < 0.5f)
        return way;
    return smr_add(along_normal, smr_scale(smr_sub(way, along_normal), s->config.slide));
}

/* The way to the surface target, blended with its pull. Returns 0 for no goal. */
static int surface_goal(smr *s, uint32_t v, const smr_surface *target, smr_vec *way)
{
    smr_vec pull = smr_v(0, 0, 0), goal = pull;
    const int has_goal = project(s, v, target, &goal);
    float weight = smr_pull_on(s) ? smr_pull_take(s, v, &pull) : 0.0f;
    if (!has_goal)
        goal = smr_v(0, 0, 0);
    if (!has_goal && s->config.use_box) /* outside the box nothing pulls either */
        weight = 0.0f;
    const float share = has_goal ? s->config.attraction * weight : weight;
    goal = smr_add(smr_scale(goal, 1.0f - share), smr_scale(pull, share));
    *way = off_surface(s, v, goal);
    return has_goal || weight > 0.0f;
}

/* The way to the vertex' goal, whatever its target is. Returns 0 for none; *drawn says whether there is a target, 2 for an
 * image that cannot tell. */
static int goal_of(smr *s, uint32_t v, smr_vec *way, int *drawn)
{
    const smr_surface *target = s->part[smr_model_owner(s->model, v)].target;
    *way = smr_v(0, 0, 0);
    s->contrast_next[v] =
        0; /* nothing may stay from forces that started again, before a surface took the image's place */
    s->lighter_next[v] = SMR_LIGHTER_NONE;
    *drawn = target != NULL || s->has_grid;
    if (!*drawn) {
        if (smr_pull_on(s))
            (void)smr_pull_take(s, v, way); /* what pulls it must not wait for the next iteration */
        *way = smr_v(0, 0, 0);
        return 0;
    }
    if (target != NULL)
        return surface_goal(s, v, target, way);
    const int seen = smr_image_goal(s, v, way, &s->contrast_next[v], &s->lighter_next[v]);
    if (seen == SMR_NO_GOAL)
        *way = smr_smooth_way(s, v);
    if (seen == SMR_UNSEEN)
        *drawn = 2;
    return seen == SMR_GOAL;
}

/* Only what follows the image is eased. */
static float ease_at(const smr *s, uint32_t v)
{
    return s->part[smr_model_owner(s->model, v)].target == NULL ? s->ease : 1.0f;
}

uint32_t smr_force_chunk(const smr *s) { return s->has_grid ? SMR_IMAGE_CHUNK : SMR_FORCE_CHUNK; }
uint32_t smr_force_tasks(smr *s) { return smr_ceil_div(s->n_active, smr_force_chunk(s)); }

/* The ways of a few active vertices, into `force`: the dearest part of an iteration, so the tasks are small. */
void smr_force_search(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t chunk = smr_force_chunk(s), last = smr_min_u32((task + 1u) * chunk, s->n_active);
    for (uint32_t v = task * chunk; v < last; v++) {
        smr_vec way;
        int drawn;
        if (s->has_grid &&
            v + 1u < s->n_active) /* voxels lie far apart: their way takes as long as the work on a vertex */
            smr_image_ahead(s, v + 1u);
        const int found = goal_of(s, v, &way, &drawn);
        s->found[v] = (uint8_t)(found ? 1 : (drawn > 0 ? drawn + 1 : 0));
        smr_store(smr_at3(s->force, v), way);
    }
}

/* Ignored vertices: no force, and what pulls them must not wait for the next iteration. */
static void ignore(smr *s, uint32_t v)
{
    smr_vec way;
    if (smr_pull_on(s))
        (void)smr_pull_take(s, v, &way);
    s->found[v] = 0;
    smr_store(smr_at3(s->force, v), smr_v(0, 0, 0));
}

/* From ways to forces, when it is known how many vertices take part. */
void smr_force_take(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    smr_tally *tally = &s->tally[task];
    const float stiffness = s->repairing > 0u ? 0.0f : s->config.stiffness;
    memset(tally, 0, sizeof *tally);
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(s, task); v++) {
        if (!smr_active(s, v)) {
            ignore(s, v);
            continue;
        }
        const smr_vec way = smr_load(smr_at3(s->force, v));
        tally->n_active += s->found[v] != 0u;
        tally->n_forces += s->found[v] == 1u;
        tally->n_rejected += s->found[v] >= 2u;
        if (s->found[v] == 1u) {
            const float d2 = smr_dot(way, way), d = SMR_SQRT(d2);
            tally->sum += d;
            tally->sum2 += d2;
            tally->max = smr_max(tally->max, d);
            s->residual[v] = d;
        }
        smr_store(smr_at3(s->force, v), smr_scale(way, stiffness * ease_at(s, v)));
        measure(s, v, tally);
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
    s->report.n_taken = s->n_active;
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
    s->sum_words = smr_method_words(s);
    /* what the next forces start from: until here they could have been asked to start again */
    memcpy(s->seen, s->found, s->n);
    memcpy(s->contrast, s->contrast_next, s->n_active);
    memcpy(s->lighter, s->lighter_next, s->n_active);
    memcpy(s->warm, s->warm_next, s->n_active * sizeof *s->warm);
}
