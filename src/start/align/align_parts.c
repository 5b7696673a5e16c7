/* align_parts.c: poses of structures that turn about joints, after the pose of the whole. The largest structure comes
 * first, from the whole's pose; then always the one that touches placed structures most in the model. It starts with
 * the pose of its neighbour, which it touches most; the joint is where both touch. On a target that structures share,
 * rotations of that pose about the joint are searched, among points in reach that no placed structure explains.
 * Bounds: for each structure a search from each of its vertices in each structure before it; on a shared target also
 * from each sample in each refinement, and 7 from each vertex of the target.
 * SPDX-License-Identifier: MIT */
#include "start/align/align.h"

#define SMR_JOINT_PIECE 16u    /* vertices in a task that finds a joint */
#define SMR_JOINT_BLUR 0.03f   /* distance at which a vertex' weight for the joint is a quarter / size of the part */
#define SMR_JOINT_SLACK 1.1f   /* factor on the reach of a part */
#define SMR_EXPLAIN_SIZE 0.01f /* distance up to which a placed part explains a point / size of the part, plus ... */
#define SMR_EXPLAIN_RMS 3.0f   /* ... the part's rms distance times this, ... */
#define SMR_EXPLAIN_MOST 4.0f  /* ... but at most so often the former */
#define SMR_EXPLAIN_COS 0.3f   /* smallest cosine between the normals of a point and of the part that explains it */
#define SMR_FOUND_SHARE 0.4f   /* smaller share of both surfaces that match: the pose is not taken */

/* Returns the size of a surface, mm: the square root of its area. */
static float size_of(const smr_surface *s) { return SMR_SQRT(s->area_mean * (float)s->n_used); }

/* Returns 1 when a placed part lies at a point of its target, mm from the target's origin, and faces as it does. */
static int explains(const smr_align_part *part, const smr_surface *target, smr_vec p, smr_vec normal)
{
    const smr_pose back = smr_pose_invert(&part->pose);
    const float sign = part->report.model_inside_out != part->report.target_inside_out ? -1.0f : 1.0f;
    const smr_vec facing = smr_scale(smr_pose_turn(&back, normal), sign);
    const float least = SMR_EXPLAIN_SIZE * size_of(part->model);
    const float near =
        least + smr_min(SMR_EXPLAIN_RMS * part->report.rms_mm / smr_pose_scale(&part->pose), SMR_EXPLAIN_MOST * least);
    const int bare = smr_is_cloud(part->model) || !(smr_dot(facing, facing) > 0.0f);
    const smr_query q = {smr_sub(smr_pose_apply(&back, smr_add(p, target->origin)), part->model->origin),
                         smr_unit(facing), bare ? -2.0f : SMR_EXPLAIN_COS, UINT32_MAX, SMR_NONE};
    smr_hit hit = {near * near, SMR_NONE, {0, 0, 0}};
    smr_surface_search(part->model, NULL, &q, &hit);
    return hit.triangle != SMR_NONE;
}

int smr_mask_holds(const smr_align_mask *mask, const smr_surface *target, smr_vec p, smr_vec normal)
{
    const smr_vec d = smr_sub(p, mask->centre);
    int holds = smr_dot(d, d) <= mask->reach2;
    for (uint32_t i = 0; i < mask->n_parts && holds; i++) {
        const smr_align_part *part = &mask->part[i];
        if (part->order > 0u && part->target == target && part->report.model_share > 0.0f)
            holds = !explains(part, target, p, normal);
    }
    return holds;
}

/* ---- joints of all parts with the part placed last: tasks visit the vertices of parts not placed yet ---- */

static uint32_t joint_pieces(const smr_align_work *w, uint32_t i)
{
    return w->part[i].order > 0u ? 0u : smr_ceil_div(w->part[i].model->n_vertices, SMR_JOINT_PIECE);
}

uint32_t smr_joint_tasks(const smr_align_work *w)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < w->n_parts && w->current != NULL; i++)
        n += joint_pieces(w, i);
    return n;
}

void smr_joint_find(smr_align_work *w, uint32_t task)
{
    uint32_t i = 0;
    for (; task >= joint_pieces(w, i); i++)
        task -= joint_pieces(w, i);
    const smr_surface *s = w->part[i].model, *other = w->current->model;
    const smr_piece piece = smr_piece_of(task, SMR_JOINT_PIECE, s->n_vertices);
    const float blur = SMR_JOINT_BLUR * size_of(s) + 1.0e-6f;
    const smr_vec shift = smr_sub(s->origin, other->origin);
    smr_joint *const j = &w->joint[i];
    if (piece.first == 0u) {
        j->sum = smr_v(0, 0, 0);
        j->weight = 0.0f;
        j->box = (smr_box){smr_get3(s->xyz, 0), smr_get3(s->xyz, 0)};
    }
    for (uint32_t v = piece.first; v < piece.last; v++) {
        const smr_vec at = smr_get3(s->xyz, v);
        const smr_query q = {smr_add(at, shift), smr_v(0, 0, 0), -2.0f, UINT32_MAX, SMR_NONE};
        smr_hit hit = {FLT_MAX, SMR_NONE, {0, 0, 0}};
        smr_surface_search(other, NULL, &q, &hit);
        const float near = 1.0f / (1.0f + hit.d2 / (blur * blur)), weight = s->area[v] * near * near;
        j->sum = smr_add(j->sum, smr_scale(at, weight));
        j->weight += weight;
        smr_box_grow(&j->box, at);
    }
    if (piece.last < s->n_vertices || (j->neighbour != NULL && j->weight <= j->touch))
        return;
    j->neighbour = w->current;
    j->touch = j->weight;
    j->at = smr_scale(j->sum, 1.0f / smr_max(j->weight, FLT_MIN));
}

/* Returns the part that touches placed ones with the largest share of its area, at first the largest; NULL: none. */
static smr_align_part *next_part(const smr_align_work *w)
{
    smr_align_part *next = NULL;
    float most = -1.0f;
    for (uint32_t i = 0; i < w->n_parts; i++) {
        smr_align_part *const part = &w->part[i];
        const float size = size_of(part->model);
        const float touch = w->joint[i].touch / (size * size + 1.0e-6f), first = part->target != NULL ? size : 0.0f;
        const float rank = w->n_placed > 0u ? touch : first;
        if (part->order == 0u && rank > most) {
            most = rank;
            next = part;
        }
    }
    return next;
}

/* Returns the squared distance from the joint to the farthest corner of the part's box, mm^2. */
static float reach_of(const smr_joint *j)
{
    const smr_vec a = smr_sub(j->at, j->box.lo), b = smr_sub(j->box.hi, j->at);
    const smr_vec far = smr_v(smr_max(a.x, b.x), smr_max(a.y, b.y), smr_max(a.z, b.z));
    return smr_dot(far, far);
}

static int is_shared(const smr_align_work *w)
{
    uint32_t users = 0;
    for (uint32_t i = 0; i < w->n_parts; i++)
        users += w->part[i].target == w->current->target;
    return users > 1u;
}

/* Sets the surfaces of the part in work, and the region of a target that it shares. */
static void set_sides(smr_align_work *w, const smr_joint *j)
{
    const smr_align_part *part = w->current;
    smr_align_side *target = &w->aligner.side[SMR_TARGET];
    w->aligner.side[SMR_MODEL].surface = part->model;
    target->surface = part->target;
    smr_pose_through(&w->given, smr_v(0, 0, 0),
                     smr_sub(smr_pose_apply(&w->given, part->model->origin), part->target->origin));
    target->mask = NULL;
    if (j->neighbour == NULL || !is_shared(w))
        return;
    const float scale = SMR_JOINT_SLACK * smr_pose_scale(&w->given);
    w->mask = (smr_align_mask){w->part, w->n_parts, smr_pose_apply(&w->given, j->at), scale * scale * reach_of(j)};
    target->mask = &w->mask;
}

int smr_align_begin_part(smr_align_work *w)
{
    if (w->current == NULL)
        w->start = *w->pose;
    w->current = next_part(w);
    if (w->current == NULL)
        return -1;
    const smr_joint *j = w->jointed = &w->joint[w->current - w->part];
    w->as_given = w->given = j->neighbour != NULL ? j->neighbour->pose : w->start;
    w->pose = &w->current->pose;
    w->report = &w->current->report;
    if (w->current->target == NULL) {
        smr_align_end_part(w, 0);
        return 0;
    }
    set_sides(w, j);
    memset(&w->said, 0, sizeof w->said);
    w->at = w->other = 0;
    w->parts = NULL;
    return 1;
}

void smr_align_end_part(smr_align_work *w, int found)
{
    smr_align_part *const part = w->current;
    if (part == NULL)
        return;
    if (!found || smr_max(part->report.model_share, part->report.target_share) < SMR_FOUND_SHARE) {
        memset(&part->report, 0, sizeof part->report);
        part->pose = w->as_given;
    }
    part->order = ++w->n_placed;
}

/* Adds a surface's changes to *changes. Returns 0 when it is no surface. */
static int add_changes(const smr_surface *s, uint32_t *changes)
{
    if (!smr_surface_valid(s))
        return 0;
    *changes += s->changes;
    return 1;
}

int smr_align_changes(const smr_align_work *w, uint32_t *changes)
{
    int valid = add_changes(w->whole_of[SMR_MODEL], changes) && add_changes(w->whole_of[SMR_TARGET], changes);
    for (uint32_t i = 0; i < w->n_parts && valid; i++) {
        const smr_align_part *part = &w->part[i];
        valid = add_changes(part->model, changes) && (part->target == NULL || add_changes(part->target, changes));
    }
    return valid;
}
