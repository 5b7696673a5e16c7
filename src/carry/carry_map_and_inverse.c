/* carry_map_and_inverse.c: the map and its inverse at points that are not bound. The map solves the equations for the
 * vertices' residuals, which also gives the gradient. The inverse takes damped Newton steps from near vertices.
 * Bounds: SMR_CARRY_STARTS starts of SMR_CARRY_ROUNDS steps, each of SMR_CARRY_HALVINGS + 1 searches and factors.
 * SPDX-License-Identifier: MIT */
#include "carry/carry.h"
#include "geometry/linear_solve/eigen_jacobi.h"

#define SMR_CARRY_STARTS 4u    /* number of vertices from which the search for the inverse starts */
#define SMR_CARRY_ROUNDS 30u   /* largest number of Newton steps from each start */
#define SMR_CARRY_HALVINGS 6u  /* largest number of times that a Newton step is halved */
#define SMR_CARRY_MET 2.0e-4f  /* mm: |F(p) - q| at which p counts as the inverse of q; near coordinates' rounding */
#define SMR_CARRY_FLAT 1.0e-3f /* determinant of a matrix at or below which undo() does not invert the matrix */

/* The map F and its derivative at a point p. */
typedef struct value {
    smr_vec at;        /* mapped position F(p), mm */
    float gradient[9]; /* derivative dF/dp, row-major */
} value;

/* Returns the residual of a vertex, mm: the present position minus the rest position mapped by T. */
static smr_vec residual(const smr_carry_call *j, uint32_t id)
{
    return smr_sub(smr_get3(j->now, smr_carry_item(j->c, id)), smr_pose_apply(&j->trend, smr_get3(j->c->rest, id)));
}

/* Sets s->weight, the equations' solution for the vertices' residuals. Returns the nearest vertex' residual, mm. */
static smr_vec weigh(const smr_carry_call *j, smr_carry_site *s)
{
    const smr_vec first = residual(j, s->id[0]);
    for (uint32_t i = 1; i < s->n; i++) {
        const smr_vec w = smr_sub(residual(j, s->id[i]), smr_scale(first, s->part[i]));
        s->weight[0][i] = w.x;
        s->weight[1][i] = w.y;
        s->weight[2][i] = w.z;
    }
    for (uint32_t axis = 0; axis < 3u; axis++)
        smr_carry_solve(s, s->weight[axis]);
    return first;
}

/* Returns the gradient of g(|p - r|) with respect to p, 1 / mm; r: rest position of the site's vertex i. */
static smr_vec slope(const smr_carry *c, const smr_carry_site *s, smr_vec p, uint32_t i)
{
    const smr_vec d = smr_sub(p, smr_carry_place(s, i));
    const float r = smr_length(d);
    const float smooth = smr_positive(1.0f - r * c->per_smooth), rough = smr_positive(1.0f - r * c->per_rough);
    return smr_scale(d, 20.0f * (c->per_smooth * c->per_smooth * (smooth * smooth * smooth) +
                                 SMR_CARRY_ROUGH * c->per_rough * c->per_rough * (rough * rough * rough)));
}

/* Returns F(p) and its derivative at p. The derivative takes noise variances as constant, though they change with p. */
static value evaluate(const smr_carry_call *j, smr_carry_site *s, smr_vec p)
{
    const smr_carry *c = j->c;
    value v;
    smr_carry_gather(c, p, s);
    smr_carry_fill(c, s);
    smr_carry_factor(s, 0, SMR_CARRY_NEAR);
    const smr_vec first = weigh(j, s);
    const float share = smr_carry_side(c, p, s) / (1.0f + SMR_CARRY_ROUGH);
    const smr_vec near = slope(c, s, p, 0);
    smr_vec moved = smr_sub(first, smr_scale(first, share));
    for (uint32_t i = 0; i < 9u; i++)
        v.gradient[i] = j->trend.m[i / 3u][i % 3u];
    smr_add_product(v.gradient, first, smr_scale(near, -1.0f / (1.0f + SMR_CARRY_ROUGH)));
    for (uint32_t i = 1; i < s->n; i++) {
        const smr_vec w = smr_v(s->weight[0][i], s->weight[1][i], s->weight[2][i]);
        moved = smr_add(moved, smr_scale(w, s->side[i]));
        smr_add_product(v.gradient, w, smr_sub(smr_scale(near, s->part[i]), slope(c, s, p, i)));
    }
    /* F(p) is computed relative to the nearest vertex, which maps exactly to its present position */
    const smr_vec rest = smr_sub(p, smr_carry_place(s, 0));
    v.at = smr_add(smr_get3(j->now, smr_carry_item(c, s->id[0])),
                   smr_add(smr_pose_turn(&j->trend, rest), smr_sub(moved, first)));
    return v;
}

static float determinant(const float m[9]) { return smr_dot(smr_load(m), smr_cross(smr_load(m + 3), smr_load(m + 6))); }

/* Returns m^-1 v, or v when m has a determinant <= SMR_CARRY_FLAT: nearly singular or mirrored. */
static smr_vec undo(const float m[9], smr_vec v)
{
    const smr_vec a = smr_axis(m, 0), b = smr_axis(m, 1), c = smr_axis(m, 2);
    const float d = determinant(m);
    if (!(d > SMR_CARRY_FLAT))
        return v;
    return smr_scale(smr_v(smr_dot(v, smr_cross(b, c)), smr_dot(v, smr_cross(c, a)), smr_dot(v, smr_cross(a, b))),
                     1.0f / d);
}

/* Returns the SMR_CARRY_STARTS vertices of the thinnest selection whose present positions are nearest to q, mm. */
static smr_carry_nearest starts(const smr_carry_call *j, smr_vec q)
{
    const smr_carry_thin *t = &j->c->thin[j->c->n_densities - 1u];
    smr_carry_nearest f = {.p = q, .most = SMR_CARRY_STARTS};
    for (uint32_t i = 0; i < t->n; i++) {
        const uint32_t v = t->first + i * t->stride;
        const float d2 = smr_distance2(smr_get3(j->now, smr_carry_item(j->c, v)), q);
        if (f.n < f.most || d2 < f.d2[f.n - 1u])
            smr_carry_insert(&f, v, d2);
    }
    return f;
}

/* A candidate for the inverse of the map at a wanted point. */
typedef struct found {
    smr_vec p;  /* position, mm from smr_carry.centre */
    value v;    /* F(p) and the derivative at p */
    float miss; /* distance from F(p) to the wanted point, mm */
} found;

/* Returns p, limited to legal coordinates, as a candidate with F(p), dF/dp and the distance from F(p) to q, mm. */
static found look(const smr_carry_call *j, smr_carry_site *s, smr_vec p, smr_vec q)
{
    const float most = 4.0f * SMR_COORD_MAX;
    found f;
    f.p = smr_v(smr_clamp(p.x, -most, most), smr_clamp(p.y, -most, most), smr_clamp(p.z, -most, most));
    f.v = evaluate(j, s, f.p);
    f.miss = smr_length(smr_sub(f.v.at, q));
    return f;
}

/* Moves the candidate *best by damped Newton steps until F(best->p) is near q or no step comes nearer. */
static void descend(const smr_carry_call *j, smr_carry_site *s, smr_vec q, found *best)
{
    for (uint32_t round = 0; round < SMR_CARRY_ROUNDS && best->miss > SMR_CARRY_MET; round++) {
        smr_vec step = undo(best->v.gradient, smr_sub(q, best->v.at));
        found next = look(j, s, smr_add(best->p, step), q);
        for (uint32_t k = 0; k < SMR_CARRY_HALVINGS && !(next.miss < best->miss); k++) {
            step = smr_scale(step, 0.5f);
            next = look(j, s, smr_add(best->p, step), q);
        }
        if (!(next.miss < best->miss))
            return;
        *best = next;
    }
}

static found invert(const smr_carry_call *j, smr_carry_site *s, smr_vec q)
{
    const smr_carry_nearest start = starts(j, q);
    found best = {smr_v(0, 0, 0), {smr_v(0, 0, 0), {0}}, SMR_FAR};
    for (uint32_t i = 0; i < start.n && best.miss > SMR_CARRY_MET; i++) {
        const smr_vec off = smr_sub(q, smr_get3(j->now, smr_carry_item(j->c, start.id[i])));
        float linear[9];
        for (uint32_t k = 0; k < 9u; k++)
            linear[k] = j->trend.m[k / 3u][k % 3u];
        found f = look(j, s, smr_add(smr_get3(j->c->rest, start.id[i]), undo(linear, off)), q);
        descend(j, s, q, &f);
        if (f.miss < best.miss)
            best = f;
    }
    return best;
}

/* Writes the image of point i under the map, or under the inverse, and the facts on the point. */
static void map(const smr_carry_call *j, smr_carry_site *s, uint32_t i)
{
    const smr_vec p = smr_get3(j->xyz, i);
    const found f = j->inverse ? invert(j, s, p) : look(j, s, smr_sub(p, j->c->centre), smr_v(0, 0, 0));
    smr_put3(j->out, i, j->inverse ? smr_add(f.p, j->c->centre) : f.v.at);
    if (j->facts == NULL)
        return;
    j->facts[i].miss_mm = j->inverse ? f.miss : 0.0f;
    j->facts[i].volume = determinant(f.v.gradient);
}

smr_status smr_carry_map(smr_carry *carry, const float *now, uint32_t inverse, const float *xyz, uint32_t n, float *out,
                         smr_carry_fact *facts)
{
    SMR_TRY((xyz == NULL || out == NULL) && n > 0u ? SMR_E_NULL : smr_carry_check(carry, now));
    if (inverse > 1u || n > SMR_VERTICES_MAX || !smr_all_within(xyz, 3u * (size_t)n, SMR_COORD_MAX))
        return SMR_E_INPUT;
    smr_carry_call call = {.c = carry, .now = now, .out = out, .n = n, .xyz = xyz, .inverse = inverse, .facts = facts};
    return smr_carry_run(&call, map);
}
