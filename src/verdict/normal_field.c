/* normal_field.c: how far vertices may be off. A surface says where it is along its normals only: along itself a vertex
 * may have slid, and what is unseen may be anywhere that is smooth. Both follow from one regression by a kernel
 * (Gaussian process; Rasmussen and Williams 2006, chapter 2): the displacement from the start is a random field with
 * covariance k(d) = size2 / (1 + d^2 / l^2) for each axis and the motions of a similarity; n . displacement is known
 * at seen vertices. What is left of the variance at a vertex says how far it may be off: far from what was seen, which
 * hardly holds a turn or the size, that is much. The field's size follows from what was seen of it.
 * How far off the start was nobody knows beforehand. Of a part, the registration (forces/field_normals.c) stays near
 * it in what normals hardly tell. Where it moved far in what they tell, the rest may lack as much of the same motion.
 * So the motion from the start is one more of the motions, with a variance of its own; and how far that would carry a
 * vertex beyond what it does without counts as doubt, too.
 * Bounds: SMR_TELLERS^2 / 2 multiplications for each vertex and axis; SMR_TELLERS^3 / 6 twice.
 * SPDX-License-Identifier: MIT */
#include "verdict/normal_field.h"

#include "geometry/gaussian_process/gaussian_process.h"
#include "verdict/evidence.h"

#define SMR_NORMAL_LENGTH 0.5f  /* kernel length over the diagonal of the structure's box */
#define SMR_NORMAL_LOOSE 0.01f  /* of the variance: what a vertex may be off along its normal */
#define SMR_NORMAL_MOTIONS 8.0f /* of the variance: of motions, at a kernel length for turns and scale */
#define SMR_NORMAL_MORE 0.5f    /* times its square: the variance of the motion from the start */
#define SMR_NORMAL_MOST 4.0e3f  /* of the variance: that motion's, at most; beyond it rounding nears what is loose */
#define SMR_NORMAL_TURN 0.1f    /* of 4: what Cayley's parameter divides by, near half a turn */
#define SMR_TELLERS_LEAST 6u    /* with fewer nothing is known: a rigid pose alone has six */

/* A place for each array: as many tellers as the memory holds. */
static uint32_t place(smr_normal_field *f, const smr *s)
{
    const uint32_t words = smr_min_u32(s->shared.n, 4u * SMR_TELLERS) * SMR_WORDS;
    uint32_t most = SMR_TELLERS;
    while (most > 0u && most * (most + 1u) / 2u + 8u * most > words)
        most--;
    f->at = (float *)s->overlay.sum;
    f->normal = f->at + 3u * (size_t)most;
    f->moved = f->normal + 3u * (size_t)most;
    f->open = f->moved + most;
    f->lower = f->open + most;
    return most;
}

static int tells(const smr *s, uint32_t v)
{
    const smr_vec n = smr_load(smr_at3(s->shape.normal, v));
    return smr_vertex_seen(s, v) && smr_dot(n, n) > 0.5f;
}

/* Every so many of the seen vertices in stored order, which winds through the structure; and the pose of all seen. */
static void choose(smr_normal_field *f, uint32_t structure, uint32_t most, smr_fit *fit)
{
    const smr *s = f->s;
    const smr_shape_structure *one = &s->shape.structure[structure];
    uint32_t total = 0, met = 0;
    smr_box box = {{SMR_FAR, SMR_FAR, SMR_FAR}, {-SMR_FAR, -SMR_FAR, -SMR_FAR}};
    for (uint32_t i = 0; i < one->n_vertices; i++)
        total += (uint32_t)tells(s, smr_model_position(s->shared.model, one->first_vertex + i));
    const uint32_t wanted = smr_min_u32(total, most);
    for (uint32_t v = 0; v < s->shared.n; v++) {
        if (smr_model_owner(s->shared.model, v) != structure)
            continue;
        const smr_vec p = smr_load(smr_at3(s->shape.start, v));
        box.lo = smr_v(smr_min(box.lo.x, p.x), smr_min(box.lo.y, p.y), smr_min(box.lo.z, p.z));
        box.hi = smr_v(smr_max(box.hi.x, p.x), smr_max(box.hi.y, p.y), smr_max(box.hi.z, p.z));
        if (!tells(s, v))
            continue;
        if (met == 0u)
            smr_fit_start(fit, p, smr_load(smr_at3(s->shape.x, v)));
        smr_fit_add(fit, p, smr_load(smr_at3(s->shape.x, v)), 1.0f);
        if (f->n < wanted && (uint64_t)met * wanted >= (uint64_t)f->n * total) {
            smr_store(smr_at3(f->at, f->n), p);
            smr_store(smr_at3(f->normal, f->n), smr_load(smr_at3(s->shape.normal, v)));
            smr_store(smr_at3(f->lower, f->n), smr_load(smr_at3(s->shape.x, v))); /* until the factor needs it */
            f->n++;
        }
        met++;
    }
    const float length = smr_max(SMR_NORMAL_LENGTH * smr_length(smr_sub(box.hi, box.lo)), 1.0e-6f);
    f->per_length2 = 1.0f / (length * length);
    f->middle = smr_scale(smr_add(box.lo, box.hi), 0.5f);
}

/* From the middle, in kernel lengths. */
static smr_vec arm_of(const smr_normal_field *f, smr_vec at)
{
    return smr_scale(smr_sub(at, f->middle), SMR_SQRT(f->per_length2));
}

/* The motion from the start to the pose, of a place on this arm, mm. */
static smr_vec motion_at(const smr_normal_field *f, smr_vec arm) { return smr_add(f->shift, smr_cross(f->turn, arm)); }

/* The covariance of the displacement at a place with what teller i knows. */
static smr_vec with_teller(const smr_normal_field *f, smr_vec at, uint32_t i)
{
    const smr_vec n = smr_load(smr_at3(f->normal, i)), from = smr_load(smr_at3(f->at, i));
    const smr_vec arm = arm_of(f, at), other = arm_of(f, from), apart = smr_sub(at, from);
    const smr_vec turn = smr_cross(smr_cross(other, n), arm), scale = smr_scale(arm, smr_dot(other, n));
    const smr_vec motions = smr_scale(smr_add(smr_add(n, turn), scale), f->motions);
    const smr_vec more = smr_scale(motion_at(f, arm), f->more * smr_dot(motion_at(f, other), n));
    return smr_add(smr_scale(n, smr_kernel(smr_dot(apart, apart), f->per_length2)), smr_add(motions, more));
}

static void factor(smr_normal_field *f)
{
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec at = smr_load(smr_at3(f->at, i)), normal = smr_load(smr_at3(f->normal, i));
        for (uint32_t j = 0; j <= i; j++) {
            const float both = smr_dot(normal, with_teller(f, at, j)) + (i == j ? SMR_NORMAL_LOOSE : 0.0f);
            smr_factor_set(f->lower, i, j, both, 0.5f * SMR_NORMAL_LOOSE);
        }
    }
}

/* size2 = y K^-1 y / n, the likeliest one. */
static void find_size(smr_normal_field *f)
{
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    f->size2 = 0.0f;
    for (uint32_t i = 0; i < f->n; i++)
        f->size2 += f->open[i] * f->open[i] / (float)f->n;
    memset(f->open, 0, f->n * sizeof *f->open);
}

/* By the inverse of a pose's rotation: to where it lay at the start. */
static smr_vec turned_back(const smr_pose *p, smr_vec v)
{
    return smr_v(p->m[0][0] * v.x + p->m[1][0] * v.y + p->m[2][0] * v.z,
                 p->m[0][1] * v.x + p->m[1][1] * v.y + p->m[2][1] * v.z,
                 p->m[0][2] * v.x + p->m[1][2] * v.y + p->m[2][2] * v.z);
}

static void find_motion(smr_normal_field *f, const smr_pose *p)
{
    const float trace = p->m[0][0] + p->m[1][1] + p->m[2][2];
    const smr_vec axis = smr_v(p->m[2][1] - p->m[1][2], p->m[0][2] - p->m[2][0], p->m[1][0] - p->m[0][1]);
    const float per = 2.0f / (SMR_SQRT(f->per_length2) * smr_max(1.0f + trace, SMR_NORMAL_TURN));
    f->turn = smr_scale(axis, per);
    f->shift = turned_back(p, smr_sub(smr_pose_apply(p, f->middle), f->middle));
}

/* Adds the motion that the normals show. */
static void count_from_start(smr_normal_field *f)
{
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec arm = arm_of(f, smr_load(smr_at3(f->at, i)));
        f->moved[i] += smr_dot(motion_at(f, arm), smr_load(smr_at3(f->normal, i)));
    }
}

/* Leaves in `open` by which coefficients the field differs once the motion from the start has a variance. */
static void open_motion(smr_normal_field *f)
{
    const float square = smr_dot(f->shift, f->shift) + smr_dot(f->turn, f->turn);
    const float most = SMR_NORMAL_MOST * f->size2;
    memcpy(f->open, f->moved, f->n * sizeof *f->open);
    smr_solve_forward(f->lower, f->n, f->open);
    smr_solve_back(f->lower, f->n, f->open);
    f->more = SMR_NORMAL_MORE * square < most ? SMR_NORMAL_MORE / f->size2 : SMR_NORMAL_MOST / square;
    factor(f);
    smr_solve_forward(f->lower, f->n, f->moved);
    smr_solve_back(f->lower, f->n, f->moved);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec arm = arm_of(f, smr_load(smr_at3(f->at, i)));
        f->again += f->more * f->open[i] * smr_dot(motion_at(f, arm), smr_load(smr_at3(f->normal, i)));
        f->open[i] = f->moved[i] - f->open[i];
    }
}

/* 1 where what normals hardly tell stays as the start had it. */
static int keeps_to_start(const smr *s, uint32_t structure)
{
    return s->forces.surface.target[structure].surface != NULL && !s->forces.unseen.sheet && !s->pace.tracking &&
           s->shared.config.partial.n_landmarks == 0u && smr_overlap_lasting(&s->forces.surface, structure);
}

void smr_normal_field_solve(smr_normal_field *f, const smr *s, uint32_t structure)
{
    smr_fit fit;
    memset(f, 0, sizeof *f);
    memset(&fit, 0, sizeof fit);
    f->s = s;
    f->motions = s->forces.unseen.sheet ? 0.0f : SMR_NORMAL_MOTIONS; /* borders hold a sheet */
    choose(f, structure, place(f, s), &fit);
    if (f->n < SMR_TELLERS_LEAST) {
        f->n = 0;
        return;
    }
    const smr_pose pose = smr_fit_solve(&fit, 0);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec posed = smr_pose_apply(&pose, smr_load(smr_at3(f->at, i)));
        const smr_vec way = smr_sub(smr_load(smr_at3(f->lower, i)), posed);
        const smr_vec normal = smr_load(smr_at3(f->normal, i));
        f->moved[i] = smr_dot(way, normal);
        smr_store(smr_at3(f->normal, i), turned_back(&pose, normal));
    }
    factor(f);
    find_size(f);
    find_motion(f, &pose);
    count_from_start(f);
    if (keeps_to_start(s, structure) && smr_dot(f->shift, f->shift) + smr_dot(f->turn, f->turn) > 0.0f)
        open_motion(f);
}

float smr_normal_field_doubt(const smr_normal_field *f, uint32_t v)
{
    const smr_vec at = smr_load(smr_at3(f->s->shape.start, v));
    float known[3u * SMR_TELLERS]; /* for each axis: L^-1 of the covariances with the tellers */
    const smr_vec arm = arm_of(f, at), motion = motion_at(f, arm);
    smr_vec way = smr_scale(motion, f->again);
    float left = 3.0f + 3.0f * f->motions * (1.0f + smr_dot(arm, arm)) + f->more * smr_dot(motion, motion);
    for (uint32_t i = 0; i < f->n; i++) {
        const smr_vec with = with_teller(f, at, i);
        const smr_vec one = smr_solve_row3(smr_factor_row(f->lower, i), i, known, with);
        smr_store(smr_at3(known, i), one);
        left -= smr_dot(one, one);
        way = smr_add(way, smr_scale(with, f->open[i]));
    }
    return SMR_SQRT(smr_max(left, 0.0f) * f->size2 + smr_dot(way, way));
}
