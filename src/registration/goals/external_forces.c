/* external_forces.c: external forces f^e = stiffness (goal - x) (paper 2.1), and the displacements of contact.
 * Bounds: one pass over the vertices; those of the sources, and of contact.c for vertices and triangles.
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "registration/goals/external_forces.h"

/* Instructions at most of a vertex' goal but its search on a surface, and of its force; for each control of the field
 * of occluded vertices, for each landmark, and by an image with the default distances. */
#define SMR_WORK_GOAL 2700u
#define SMR_WORK_FORCE 450u
#define SMR_WORK_CONTROL 300u
#define SMR_WORK_LANDMARK 100u
#define SMR_WORK_IMAGE 45000u

void smr_forces_layout(smr_arena *a, smr_forces *f, const smr_shared *shared)
{
    const size_t n = shared->n;
    f->force = smr_slot_scratch(a, f->force, n, 3u * sizeof(float));
    f->residual = smr_slot_floats(a, f->residual, n, 2.0f * SMR_KEPT_MM);
    f->found = smr_slot_scratch(a, f->found, n, 1);
    f->found_last = smr_slot_bytes(a, f->found_last, n, SMR_FOUND_UNDECIDED);
    f->n_kept = shared->n;
    smr_keep_floats(a, &f->matched, 1, -1.0f, 1.0f);
    smr_keep_words(a, &f->unmeasured, 1, 1);
    smr_sources_layout(a, f, shared);
}

void smr_forces_reset(smr_forces *f, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(f->shared->n, part, parts);
    memset(f->residual + p.first, 0, (p.last - p.first) * sizeof *f->residual);
    memset(f->found + p.first, SMR_FOUND_NO_TARGET, p.last - p.first);
    memset(f->found_last + p.first, SMR_FOUND_NO_TARGET, p.last - p.first);
    f->n_kept = f->shared->n;
    f->unmeasured = 1;
    f->matched = -1.0f;
    smr_sources_reset(f, part, parts);
}

void smr_forces_unmeasured(smr_forces *f)
{
    smr_certainties_clear(&f->surface);
    f->unmeasured = 1;
    f->matched = -1.0f;
}

/* Raises tally->forces.largest to v's terms of cluster sums: mass times displacement u; that times position x^r. */
static void measure(const smr_forces *f, uint32_t v, smr_tally *tally)
{
    const smr_vec r = smr_get3(f->shape->x_ref, v), u = smr_scale(smr_match_displacement(f, v), smr_mass(f->shared, v));
    const float largest = smr_max(smr_abs(u.x), smr_max(smr_abs(u.y), smr_abs(u.z)));
    const float arm = smr_max(smr_abs(r.x), smr_max(smr_abs(r.y), smr_abs(r.z)));
    const float terms = f->shared->config.basic.method == SMR_METHOD_RIGID ? 2.0f : 1.0f;
    tally->forces.largest[0] = smr_max(tally->forces.largest[0], largest);
    tally->forces.largest[1] = smr_max(tally->forces.largest[1], terms * arm * largest);
}

float smr_forces_ease(const smr_forces *f, uint32_t v)
{
    if (!(f->schedule->fade < 1.0f) || f->surface.target[smr_model_owner(f->shared->model, v)].surface != NULL)
        return 1.0f;
    const float prevails = smr_landmarks_on(&f->landmarks) ? smr_occluded_field_hard_weight(&f->occluded, v) : 0.0f;
    return smr_max(f->schedule->fade, prevails);
}

uint32_t smr_force_chunk(const smr_forces *f) { return smr_image_on(&f->image) ? SMR_IMAGE_CHUNK : SMR_FORCE_CHUNK; }

uint32_t smr_forces_tasks(const void *arg)
{
    const smr_forces *f = arg;
    return smr_ceil_div(f->schedule->n_active, smr_force_chunk(f));
}

/* Returns the work, in instructions at most, of a vertex' goal but its search on a surface. */
static uint32_t work_of_goal(const smr_forces *f)
{
    const uint32_t fields = SMR_WORK_CONTROL * f->occluded.n + SMR_WORK_LANDMARK * f->landmarks.n;
    return SMR_WORK_GOAL + fields + (smr_image_on(&f->image) ? SMR_WORK_IMAGE : 0u);
}

void smr_forces_search(void *arg, uint32_t task, uint32_t worker)
{
    smr_forces *f = arg;
    const uint32_t n_active = f->schedule->n_active, chunk = smr_force_chunk(f), first = task * chunk;
    const uint32_t last = smr_min_u32(first + chunk, n_active);
    const int looks = smr_image_on(&f->image) && !smr_field_of_past(&f->occluded);
    smr_worker *const w = &f->shared->worker[worker];
    const uint32_t work = work_of_goal(f);
    smr_worker_needs(w, work);
    for (uint32_t v = first + w->at; v < last; v++) {
        smr_vec displacement;
        float residual = SMR_FAR;
        const uint32_t done = looks && f->image.calls->rests(&f->image, v) ? work - SMR_WORK_IMAGE : work;
        if (smr_worker_stops(w, v - first))
            return;
        if (looks && v + 1u < n_active)
            f->image.calls->ahead(&f->image, v + 1u); /* reading voxels takes as long as the work on a vertex */
        if (SMR_PREFETCHES)
            smr_surface_goal_ahead(&f->surface, v);
        f->found[v] = smr_sources_goal(f, v, &w->pause, &displacement, &residual);
        if (smr_worker_kept(w, v - first, done))
            return;
        smr_put3(f->force, v, displacement);
        if (f->found[v] == SMR_FOUND_GOAL) /* distance to the target mesh, or else to the goal */
            f->residual[v] = residual < SMR_FAR ? residual : smr_length(displacement);
    }
}

/* Adds the distance to the goal, the residual and the kind of result to the task's tally. */
static void count(const smr_forces *f, uint32_t v, smr_vec displacement, smr_tally *tally)
{
    tally->forces.n_rejected = (uint8_t)(tally->forces.n_rejected + (f->found[v] >= SMR_FOUND_NONE));
    if (f->found[v] != SMR_FOUND_GOAL)
        return;
    tally->forces.n_forces++;
    const float d2 = smr_dot(displacement, displacement), r = f->residual[v];
    tally->forces.goal_sum += SMR_SQRT(d2);
    tally->forces.goal_sum2 += d2;
    if (r < 0.0f)
        return;
    tally->forces.n_residuals++;
    tally->forces.sum += r;
    tally->forces.sum2 += r * r;
    tally->forces.max = smr_max(tally->forces.max, r);
}

uint32_t smr_forces_take_tasks(const void *arg) { return ((const smr_forces *)arg)->shared->n_tasks; }

/* Turns displacements into forces. The number of active vertices is final from here on. */
void smr_forces_take(void *arg, uint32_t task, uint32_t worker)
{
    smr_forces *f = arg;
    smr_tally *tally = &f->tally[task];
    const float stiffness = f->schedule->repairing > 0u ? 0.0f : f->shared->config.forces.stiffness * f->schedule->gain;
    const int apart = smr_contact_on(&f->contact), smooth = SMR_HAS_CONTACT && smr_smooth_tasks(&f->smooth) > 0u;
    smr_worker *const w = &f->shared->worker[worker];
    const uint32_t first = task * SMR_CHUNK, work = SMR_WORK_FORCE + SMR_WORK_LANDMARK * f->landmarks.n;
    if (w->at == 0u)
        memset(tally, 0, sizeof *tally);
    smr_worker_needs(w, work);
    for (uint32_t v = first + w->at; v < smr_chunk_end(f->shared, task); v++) {
        if (smr_worker_stops(w, v - first))
            return;
        smr_work(&w->pause, work);
        if (!smr_active(f->schedule, v)) {
            smr_sources_drop(f, v);
            f->found[v] = SMR_FOUND_NO_TARGET;
            smr_put3(f->force, v, smr_v(0, 0, 0));
            continue;
        }
        const smr_vec displacement = smr_get3(f->force, v);
        count(f, v, displacement, tally);
        const smr_vec blended = smooth ? smr_smooth_blend(&f->smooth, v, displacement) : displacement;
        smr_put3(f->force, v, smr_scale(blended, stiffness * smr_forces_ease(f, v)));
        if (apart)
            smr_put3(f->force, v, smr_add(smr_get3(f->force, v), smr_get3(f->contact.push, v)));
        measure(f, v, tally);
    }
}

/* Returns the displacement of v by the goal's force and momentum, without contact, mm. */
static smr_vec requested_displacement(const void *arg, uint32_t v)
{
    const smr_forces *f = arg;
    if (!smr_active(f->schedule, v))
        return smr_v(0, 0, 0);
    const float share = f->shared->config.forces.stiffness * f->schedule->gain * smr_forces_ease(f, v);
    return smr_add(smr_scale(smr_get3(f->force, v), share), smr_momentum(f, v));
}

uint32_t smr_contact_tasks(const void *arg)
{
    const smr_forces *f = arg;
    if (!smr_contact_on(&f->contact))
        return 0;
    return smr_ceil_div(f->schedule->n_active, SMR_CONTACT_CHUNK) +
           (f->contact.triangles_due ? smr_ceil_div(f->shared->n_triangles, SMR_CONTACT_CHUNK) : 0u);
}

/* Finds the contacts of vertex or, of_triangle 1, triangle i, and the displacement that ends a vertex' penetration. */
static void find_contacts(smr_forces *f, int of_triangle, uint32_t i, smr_worker *w)
{
    if (of_triangle) {
        smr_contact_find_triangle(&f->contact, i, w);
        return;
    }
    smr_contact_find(&f->contact, i, w);
    if (!w->pause.kept)
        smr_put3(f->contact.push, i, smr_contact_displacement(&f->contact, i, requested_displacement, f));
}

void smr_contact_search(void *arg, uint32_t task, uint32_t worker)
{
    smr_forces *f = arg;
    smr_worker *w = &f->shared->worker[worker];
    const uint32_t n_tasks = smr_ceil_div(f->schedule->n_active, SMR_CONTACT_CHUNK);
    const int of_triangle = task >= n_tasks;
    const uint32_t first = (of_triangle ? task - n_tasks : task) * SMR_CONTACT_CHUNK;
    const uint32_t n = of_triangle ? f->shared->n_triangles : f->schedule->n_active;
    smr_worker_needs(w, smr_contact_work(&f->contact) + 8u * SMR_WORK_LANDMARK * f->landmarks.n);
    for (uint32_t i = first + w->at; i < smr_min_u32(first + SMR_CONTACT_CHUNK, n); i++) {
        if (smr_worker_stops(w, i - first))
            return;
        find_contacts(f, of_triangle, i, w);
        if (smr_worker_kept(w, i - first, SMR_WORK_FORCE / 2u)) /* searches count the rest */
            return;
    }
}

/* Returns the share of the searched vertices that have a goal; -1: no vertex was searched. */
static float share_of(uint32_t n_forces, uint32_t n_rejected)
{
    const uint32_t all = n_forces + n_rejected;
    return all > 0u ? (float)n_forces / (float)all : -1.0f;
}

/* Returns the share of a structure's searched vertices with a goal in the last complete forces; -1: none searched. */
static float share_in_last(const smr_forces *f, uint32_t structure)
{
    const smr_shape_structure *one = &f->shape->structure[structure];
    uint32_t n_forces = 0, n_rejected = 0;
    for (uint32_t i = 0; i < one->n_vertices; i++) {
        const uint8_t found = smr_found(f, smr_model_position(f->shared->model, one->first_vertex + i));
        n_forces += found == SMR_FOUND_GOAL;
        n_rejected += found >= SMR_FOUND_NONE;
    }
    return share_of(n_forces, n_rejected);
}

float smr_forces_matched(const smr_forces *f, uint32_t structure)
{
    const smr_target *target = &f->surface.target[structure];
    if (!target->measured)
        return -1.0f;
    if (SMR_HAS_IMAGE && target->surface == NULL && f->image.structure[structure].idle)
        return f->image.structure[structure].matched;
    return share_in_last(f, structure);
}

/* Returns 1 when a structure is no longer searched for in the image. Stores the matched share of its last search, from
 * found_last, which still holds the results of the forces before. */
static int note_idle(smr_forces *f, uint32_t structure)
{
    smr_image_structure *view = &f->image.structure[structure];
    const uint32_t idle = smr_image_on(&f->image) && !smr_image_seeks(&f->image, structure);
    if (idle && !view->idle)
        view->matched = f->surface.target[structure].measured ? share_in_last(f, structure) : -1.0f;
    view->idle = idle;
    return idle != 0u;
}

/* Stores the share of the searched vertices with a goal: in an image, of those that are sought on many lines. */
static void note_matched(smr_forces *f)
{
    const float more = smr_image_more(&f->image), n = (float)f->schedule->n_active;
    uint32_t n_forces = 0, n_rejected = 0;
    int sought = 0;
    for (uint32_t k = 0; k < f->shared->n_structures; k++) {
        smr_target *target = &f->surface.target[k];
        const int idle = SMR_HAS_IMAGE && note_idle(f, k);
        sought |= target->surface != NULL || !idle;
        target->measured = 1;
    }
    for (uint32_t t = 0; t < f->shared->n_tasks && (float)(t * SMR_CHUNK) * more < n; t++) {
        n_forces += f->tally[t].forces.n_forces;
        n_rejected += f->tally[t].forces.n_rejected;
    }
    if (sought)
        f->matched = share_of(n_forces, n_rejected);
    f->unmeasured = 0;
}

/* Dynamics: a closer bound on cluster sums. A pinned vertex weighs more than all other vertices together, so the sum of
 * the chunks' largest values may be smaller than the largest value times the cluster size. */
static void bound_closely(const smr_forces *f, float largest[2])
{
    for (uint32_t kind = 0; kind < 2u; kind++) {
        float sum = 0.0f;
        for (uint32_t t = 0; t < f->shared->n_tasks; t++)
            sum += (float)SMR_CHUNK * f->tally[t].forces.largest[kind];
        largest[kind] = smr_min(largest[kind], sum / (float)smr_max_u32(f->schedule->lists.largest, 1u));
    }
}

SMR_SELDOM void smr_forces_end(smr_forces *f)
{
    smr_force_totals all = {0};
    float sum = 0.0f, sum2 = 0.0f, goal_sum = 0.0f, goal_sum2 = 0.0f;
    for (uint32_t t = 0; t < f->shared->n_tasks; t++) {
        const smr_tally *one = &f->tally[t];
        goal_sum += one->forces.goal_sum;
        goal_sum2 += one->forces.goal_sum2;
        sum += one->forces.sum;
        sum2 += one->forces.sum2;
        all.max = smr_max(all.max, one->forces.max);
        all.n_forces += one->forces.n_forces;
        all.n_residuals += one->forces.n_residuals;
        all.n_rejected += one->forces.n_rejected;
        all.largest[0] = smr_max(all.largest[0], one->forces.largest[0]);
        all.largest[1] = smr_max(all.largest[1], one->forces.largest[1]);
    }
    if (f->shared->mass != NULL)
        bound_closely(f, all.largest);
    const float n = (float)smr_max_u32(all.n_forces, 1u), measured = (float)smr_max_u32(all.n_residuals, 1u);
    all.n_with_target = all.n_forces + all.n_rejected;
    all.goal_mean = goal_sum / n;
    all.mean = sum / measured;
    all.rms = SMR_SQRT(sum2 / measured);
    f->totals = all;
    f->surface.limit_next = smr_reject_limit(&f->shared->config, all.n_forces, all.goal_mean, goal_sum2 / n);
    note_matched(f);
    smr_sources_commit(f);
    f->n_kept = 0;
}
