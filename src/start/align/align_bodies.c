/* align_bodies.c: rigid bodies of patches. Patches that follow closest points slide along a surface slowly, each part
 * by itself. Bodies are found one by one: the motion of the patch with which most of the area agrees, and the patches
 * that do. Each body then follows the target as a whole, by distances along the model's normals (Chen and Medioni
 * 1992: the target's), held weakly to its neighbours at seams, where the surface bends and distances do not count.
 * Steps are damped (Levenberg 1944, Marquardt 1963): a round body would else turn about its axis by facets.
 * Bounds: SMR_BENT_BODIES passes over pairs of patches; then a search from each patch in each round.
 * SPDX-License-Identifier: MIT */
#include "geometry/linear_solve/thin_plate_solve.h"
#include "geometry/rotation/rotation.h"
#include "start/align/align_patches.h"

#define SMR_BODY_NEAR 0.2f    /* distance at which a patch agrees with a motion by a half / radius of a cell */
#define SMR_BODY_REACH 2.0f   /* distance up to which a patch joins a body / that distance */
#define SMR_BODY_ALONG 0.3f   /* weight of squared distances along the surface when bodies begin; across it: 1 */
#define SMR_BODY_SLIDE 0.05f  /* the same when a patch goes over to another body */
#define SMR_BODY_LEAST 0.01f  /* smallest share of the area that has a goal, to begin a body */
#define SMR_BODY_FIT 0.2f     /* distance across the surface at which a goal counts a quarter / radius of a cell */
#define SMR_BODY_HOLD 1.0e-4f /* weight of the place that a patch has, relative to its goal's, at first */
#define SMR_BODY_FIRMER 10.0f /* factor on this weight after a move that is taken back */
#define SMR_BODY_LOOSER 0.5f  /* factor on this weight after any other move */
#define SMR_BODY_SEAM 0.01f   /* weight of its place by all bodies around it, times the share that are others */

#define SMR_BODY_PIECE 32u /* patches in a task */

/* Returns the squared distance of a patch, moved by m, from a place, mm^2. along: weight along the surface. */
static float distance2(const smr_patch *p, const smr_pose *m, smr_vec place, float along)
{
    const smr_vec d = smr_sub(smr_pose_apply(m, p->rest), place);
    const float across = smr_dot(d, smr_pose_turn(&p->motion, p->normal));
    return along * smr_dot(d, d) + (1.0f - along) * across * across;
}

static float near2(const smr_bent *w) { return SMR_BODY_NEAR * SMR_BODY_NEAR * w->radius * w->radius; }

/* Returns 1 when a patch has found the target and belongs to no body. */
static int is_free(const smr_patch *p) { return p->found != 0u && p->body == SMR_NONE; }

static smr_bent *work_of(const void *job) { return ((const smr_bent_job *)job)->w; }

uint32_t smr_bodies_count(const void *job) { return work_of(job)->n_bodies; }
uint32_t smr_bodies_halves(const void *job) { return SMR_SIDES * work_of(job)->side[SMR_MODEL].n; }
uint32_t smr_bodies_pieces(const void *job) { return smr_ceil_div(work_of(job)->side[SMR_MODEL].n, SMR_BODY_PIECE); }

/* Sums over half of the patches; the halves lie in d2[]. */
void smr_bodies_gather(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_patch *p = &w->patch[task / SMR_SIDES];
    const float half2 = near2(w);
    float sum = 0.0f;
    for (uint32_t i = task % SMR_SIDES; i < w->side[SMR_MODEL].n && is_free(p); i += SMR_SIDES) {
        const smr_patch *q = &w->patch[i];
        if (is_free(q))
            sum += w->side[SMR_MODEL].cell[i].area * half2 / (half2 + distance2(q, &p->motion, q->at, SMR_BODY_ALONG));
    }
    w->d2[task % SMR_SIDES][task / SMR_SIDES] = sum;
}

void smr_bodies_begin(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_bent *w = work_of(job);
    uint32_t best = 0;
    float most = 0.0f, all = 0.0f;
    for (uint32_t i = 0; i < w->side[SMR_MODEL].n; i++) {
        all += w->patch[i].found != 0u ? w->side[SMR_MODEL].cell[i].area : 0.0f;
        const float support = w->d2[SMR_MODEL][i] + w->d2[SMR_TARGET][i];
        best = support > most ? i : best;
        most = smr_max(most, support);
    }
    if (!(most > SMR_BODY_LEAST * all)) {
        ((smr_bent_job *)job)->head.next_stage = w->n_bodies > 0u ? SMR_BENT_SHARE : SMR_BENT_MOVE;
        return;
    }
    smr_body *const b = &w->body[w->n_bodies++];
    memset(b, 0, sizeof *b);
    b->motion = w->patch[best].motion;
    b->centre = w->patch[best].at;
    b->hold = SMR_BODY_HOLD;
    b->least = FLT_MAX;
}

static smr_piece piece_of(const smr_bent *w, uint32_t task)
{
    return smr_piece_of(task, SMR_BODY_PIECE, w->side[SMR_MODEL].n);
}

void smr_bodies_take(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece piece = piece_of(w, task);
    const uint32_t newest = w->n_bodies - 1u;
    for (uint32_t i = piece.first; i < piece.last; i++) {
        smr_patch *const p = &w->patch[i];
        if (is_free(p) &&
            distance2(p, &w->body[newest].motion, p->at, SMR_BODY_ALONG) < SMR_BODY_REACH * SMR_BODY_REACH * near2(w))
            p->body = newest;
    }
    ((smr_bent_job *)job)->head.next_stage = w->n_bodies < SMR_BENT_BODIES ? SMR_BENT_GATHER : SMR_BENT_SHARE;
}

void smr_bodies_share(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece piece = piece_of(w, task);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        smr_patch *const p = &w->patch[i];
        float least = FLT_MAX;
        for (uint32_t k = 0; k < w->n_bodies && (p->body == SMR_NONE || least < FLT_MAX); k++) {
            const float d2 = distance2(p, &w->body[k].motion, p->at, SMR_BODY_ALONG);
            if (d2 < least) {
                least = d2;
                p->body = k;
            }
        }
        p->motion = w->body[p->body].motion;
    }
    ((smr_bent_job *)job)->head.next_stage = SMR_BENT_FIND;
}

/* Adds the equation that a place moves by `off` along n, with weight w; x: the place relative to the centre. */
static void add_equation(smr_body *b, smr_vec x, smr_vec n, float off, float w)
{
    const smr_vec turn = smr_cross(x, n);
    const float row[SMR_BODY_UNKNOWNS] = {turn.x, turn.y, turn.z, n.x, n.y, n.z};
    for (uint32_t i = 0; i < SMR_BODY_UNKNOWNS; i++) {
        for (uint32_t j = 0; j < SMR_BODY_UNKNOWNS; j++)
            b->matrix[i][j] += w * row[i] * row[j];
        b->right[i][0] += w * row[i] * off;
    }
}

void smr_bodies_sum(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece piece = piece_of(w, task);
    static const smr_vec axis[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const float fit2 = SMR_BODY_FIT * SMR_BODY_FIT * w->radius * w->radius;
    const float per_cell = 1.0f / (w->side[SMR_MODEL].radius * w->side[SMR_MODEL].radius);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        const smr_patch *p = &w->patch[i];
        smr_body *const b = &w->body[p->body];
        if (p->joined == 0u)
            continue;
        const float area = w->side[SMR_MODEL].cell[i].area * per_cell;
        const smr_vec at = smr_pose_apply(&p->motion, p->rest), off = smr_sub(p->at, at);
        const smr_vec x = smr_scale(smr_sub(at, b->centre), 1.0f / w->radius);
        float same = 0.0f;
        for (uint32_t k = 0; k < p->n_near; k++)
            same += w->patch[p->member[k]].body == p->body ? 1.0f / (float)p->n_near : 0.0f;
        const float hold = area * (b->hold + SMR_BODY_SEAM * (1.0f - same));
        for (uint32_t k = 0; k < 3u; k++) {
            add_equation(b, x, axis[k], smr_dot(off, axis[k]), hold);
            b->matrix[k][k] += hold; /* few patches would leave a turn open */
        }
        if (!(p->weight > 0.0f))
            continue;
        const smr_vec normal = smr_pose_turn(&p->motion, p->normal);
        const float across = smr_dot(normal, smr_sub(p->goal, at)), fits = fit2 / (fit2 + across * across);
        const float inside = same * same * same * same, weight = area * inside * inside;
        add_equation(b, x, normal, across, weight * fits * fits);
        b->cost += weight * fits * across * across;
        b->all += weight;
    }
}

/* Solves the equations, and turns and moves the body. */
static void move_body(smr_body *b, float radius)
{
    float x[SMR_BODY_UNKNOWNS][SMR_SOLVE_SIDES], lu[SMR_BODY_UNKNOWNS * SMR_BODY_UNKNOWNS], r[9];
    float residual[SMR_BODY_UNKNOWNS * SMR_SOLVE_SIDES];
    uint32_t pivot[SMR_BODY_UNKNOWNS];
    const smr_system s = {SMR_BODY_UNKNOWNS, &b->matrix[0][0], &b->right[0][0], &x[0][0], lu, residual, pivot};
    if (!smr_system_solve(&s))
        return;
    const smr_vec turn = smr_scale(smr_v(x[0][0], x[1][0], x[2][0]), 1.0f / radius);
    const smr_vec rest = smr_pose_turn_back(&b->motion, smr_sub(b->centre, smr_column(&b->motion, 3)));
    b->centre = smr_add(b->centre, smr_v(x[3][0], x[4][0], x[5][0]));
    smr_rodrigues(smr_turn_within(turn, SMR_ANGLE_MAX), r);
    for (uint32_t c = 0; c < 3u; c++) {
        const smr_vec column = smr_column(&b->motion, c), more = smr_mul(r, column);
        b->motion.m[0][c] = column.x + more.x;
        b->motion.m[1][c] = column.y + more.y;
        b->motion.m[2][c] = column.z + more.z;
    }
    b->motion.m[0][3] = b->motion.m[1][3] = b->motion.m[2][3] = 0.0f;
    smr_pose_onto(&b->motion, rest, b->centre);
}

/* A body whose cost has risen goes back, and is held more firmly. */
void smr_bodies_move(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    smr_body *const b = &w->body[task];
    const float cost = b->all > 0.0f ? b->cost / b->all : FLT_MAX;
    if (cost > b->least) {
        b->motion = b->kept_motion;
        b->centre = b->kept_centre;
        b->hold *= SMR_BODY_FIRMER;
    } else {
        b->least = cost;
        b->kept_motion = b->motion;
        b->kept_centre = b->centre;
        if (w->body_round + 1u < SMR_BENT_TOGETHER)
            move_body(b, w->radius);
        b->hold = smr_max(SMR_BODY_LOOSER * b->hold, SMR_BODY_HOLD);
    }
    b->cost = b->all = 0.0f;
    memset(b->matrix, 0, sizeof b->matrix);
    memset(b->right, 0, sizeof b->right);
}

void smr_bodies_follow(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_bent *w = work_of(job);
    const smr_piece piece = piece_of(w, task);
    for (uint32_t i = piece.first; i < piece.last; i++) {
        smr_patch *const p = &w->patch[i];
        p->found = p->weight > 0.0f;
        float least = distance2(p, &w->body[p->body].motion, p->goal, SMR_BODY_SLIDE);
        for (uint32_t k = 0; k < p->n_links && p->found != 0u; k++) {
            const uint32_t other = w->patch[p->link[k]].body;
            const float d2 = distance2(p, &w->body[other].motion, p->goal, SMR_BODY_SLIDE);
            if (d2 < least) {
                least = d2;
                p->body = other;
            }
        }
        p->motion = w->body[p->body].motion;
    }
}

void smr_bodies_end_round(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    work_of(job)->body_round++;
    ((smr_bent_job *)job)->head.next_stage = SMR_BENT_FIND;
}
