/* guard.c: keeps the surface from folding over itself at the finest radii. Shape matching makes folds rare; forces that
 * cross can still turn a triangle over, and a plastic reference would then keep it so. Coarse radii move the model almost
 * rigidly, and most of what bends there straightens again. Before the last two radii
 * - iterations without forces repair what folds by then: in a patch around it, that grows while this does not suffice,
 *   the displacement from the rest shape is made as smooth as the patch's surroundings.
 * From then on, where an iteration would turn triangles back on each other,
 * - the steps x_next - x of their corners become the mean of their neighbours' steps, again in a growing patch: a patch
 *   that moves as a whole does not fold;
 * - what would fold even so has its steps halved, and at last stays where it was, which did not fold.
 * Bounds: one pass over the hinges; where any folds, SMR_ROUNDS passes over them and over its structure's triangles.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/state.h"

#define SMR_SMOOTHINGS 5u /* rounds that smooth steps */
#define SMR_HALVINGS 3u   /* rounds that halve them; later ones take them back */
#define SMR_ROUNDS 40u
#define SMR_SWEEPS 3u
#define SMR_EDGE_FLOOR 1.0e-3f /* mm, added to edge lengths before they divide */
#define SMR_REPAIR_SWEEPS 10u
#define SMR_REPAIR_WIDEN 3u /* iterations until the patch grows by a ring */

uint32_t smr_guard_tasks(smr *s) { return smr_guarded(s) ? s->n_hinge_tasks : 0u; }

static const smr_image_hinge *hinge_at(const smr *s, uint32_t i)
{
    return (const smr_image_hinge *)smr_at(s->model, s->model->at_hinges) + i;
}

static uint32_t second_of(const smr_image_hinge *h) { return smr_le32(h->bend) & SMR_HINGE_MASK; }

/* Counts a chunk's folding hinges by the facets' normals at x_next. */
void smr_guard_search(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    (void)worker;
    const uint32_t last = smr_min_u32((task + 1u) * SMR_HINGE_CHUNK, s->n_hinges);
    uint32_t n = 0;
    for (uint32_t i = task * SMR_HINGE_CHUNK; i < last; i++) {
        const smr_image_hinge *h = hinge_at(s, i);
        const smr_vec a = smr_load(s->facet_normal + 3u * (size_t)smr_le32(h->first));
        const smr_vec b = smr_load(s->facet_normal + 3u * (size_t)second_of(h));
        n += smr_dot(a, b) < smr_hinge_limit(smr_le32(h->bend));
    }
    s->tally[task].n_rejected = n;
}

static smr_vec normal_at(const smr *s, float *x, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return smr_unit(smr_triangle_cross(smr_load(smr_at3(x, t[0])), smr_load(smr_at3(x, t[1])), smr_load(smr_at3(x, t[2]))));
}

static int folds_at(const smr *s, float *x, const smr_image_hinge *h)
{
    return smr_dot(normal_at(s, x, smr_le32(h->first)), normal_at(s, x, second_of(h))) < smr_hinge_limit(smr_le32(h->bend));
}

static int any_marked(const smr *s, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]];
}

static void mark(smr *s, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    for (uint32_t c = 0; c < 3u; c++)
        s->guard[t[c]] = 1;
    s->part[smr_model_owner(s->model, t[0])].folding = 1;
}

/* Shortens the steps of a triangle's corners. */
static void hold(smr *s, uint32_t triangle, float keep)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    for (uint32_t c = 0; c < 3u; c++) {
        const smr_vec old = smr_load(smr_at3(s->x, t[c]));
        const smr_vec step = smr_sub(smr_load(smr_at3(s->x_next, t[c])), old);
        smr_store(smr_at3(s->x_next, t[c]), smr_add(old, smr_scale(step, keep)));
    }
}

/* Marks the corners of hinges that fold at x_next: all of them (old 1), or those that did not at x (old 0).
 * Returns how many. The first round looks where the search counted some, the others where something changed since. */
static uint32_t mark_folds(smr *s, int old, uint32_t round)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < s->n_hinges; i++) {
        const smr_image_hinge *h = hinge_at(s, i);
        const uint32_t first = smr_le32(h->first), second = second_of(h);
        const int look = s->tally[i / SMR_HINGE_CHUNK].n_rejected > 0u ||
                         (round > 0u && (any_marked(s, first) || any_marked(s, second)));
        if (!look || !folds_at(s, s->x_next, h) || (!old && folds_at(s, s->x, h)))
            continue;
        mark(s, first);
        mark(s, second);
        if (round >= SMR_SMOOTHINGS) {
            const float keep = round < SMR_SMOOTHINGS + SMR_HALVINGS ? 0.5f : 0.0f;
            hold(s, first, keep);
            hold(s, second, keep);
        }
        n++;
    }
    return n;
}

/* Marks the neighbours of marked vertices of one structure. */
static void widen(smr *s, const smr_part *part)
{
    const uint32_t *t = part->facets.triangle;
    for (uint32_t k = 0; k < part->facets.n_triangles; k++, t += 3)
        if ((s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]]) & 1u)
            for (uint32_t c = 0; c < 3u; c++)
                s->guard[t[c]] |= 2u;
    t = part->facets.triangle;
    for (uint32_t k = 0; k < 3u * part->facets.n_triangles; k++)
        s->guard[t[k]] = s->guard[t[k]] != 0u;
}

/* Where a vertex' displacement is counted from: base, or the rest shape in its fitted pose when base is NULL. */
static smr_vec base_at(const smr *s, float *base, uint32_t v)
{
    if (base != NULL)
        return smr_load(smr_at3(base, v));
    const uint32_t *r = (const uint32_t *)smr_at(s->model, s->model->at_rest) + 3u * (size_t)v;
    return smr_pose_apply(&s->fitted, smr_v(smr_le_float(r[0]), smr_le_float(r[1]), smr_le_float(r[2])));
}

/* Weighted sums of the displacements x_next - base of marked vertices' mesh neighbours. Near neighbours weigh more, so
 * that the corners of a sliver, which the smallest difference turns over, move alike. */
static void sum_rings(smr *s, const smr_part *part, float *base)
{
    const uint32_t *t = part->facets.triangle;
    const uint32_t n = part->facets.n_triangles;
    for (uint32_t k = 0; k < 3u * n; k++) {
        if (!s->guard[t[k]])
            continue;
        smr_store(smr_at3(s->ring_sum, t[k]), smr_v(0, 0, 0));
        s->ring_weight[t[k]] = 0.0f;
    }
    for (uint32_t k = 0; k < n; k++, t += 3) {
        if (!(s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]]))
            continue;
        for (uint32_t c = 0; c < 3u; c++) { /* the edge from corner c to the next, both ways */
            const uint32_t a = t[c], b = t[(c + 1u) % 3u];
            const smr_vec at_a = base_at(s, base, a), at_b = base_at(s, base, b);
            const float w = 1.0f / (smr_length(smr_sub(at_a, at_b)) + SMR_EDGE_FLOOR);
            const smr_vec d_a = smr_sub(smr_load(smr_at3(s->x_next, a)), at_a);
            const smr_vec d_b = smr_sub(smr_load(smr_at3(s->x_next, b)), at_b);
            smr_store(smr_at3(s->ring_sum, a), smr_add(smr_load(smr_at3(s->ring_sum, a)), smr_scale(d_b, w)));
            smr_store(smr_at3(s->ring_sum, b), smr_add(smr_load(smr_at3(s->ring_sum, b)), smr_scale(d_a, w)));
            s->ring_weight[a] += w;
            s->ring_weight[b] += w;
        }
    }
}

/* Displacements x_next - base of marked vertices become the mean of their mesh neighbours' displacements, over and over:
 * a few sweeps towards the smoothest displacement that joins the patch's surroundings. */
static void smooth(smr *s, const smr_part *part, float *base, uint32_t sweeps)
{
    for (uint32_t sweep = 0; sweep < sweeps; sweep++) {
        sum_rings(s, part, base);
        for (uint32_t i = 0; i < part->n_vertices; i++) {
            const uint32_t v = smr_model_position(s->model, part->first_vertex + i);
            if (!s->guard[v])
                continue;
            const smr_vec mean = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
            smr_store(smr_at3(s->x_next, v), smr_add(base_at(s, base, v), mean));
        }
    }
}

/* Gives their rest shape back to patches around folds. */
static void repair(smr *s)
{
    s->n_folding = mark_folds(s, 1, 0);
    const uint32_t rings = 1u + s->repairing / SMR_REPAIR_WIDEN;
    for (uint32_t i = 0; i < s->n_parts && s->n_folding > 0u; i++) {
        if (!s->part[i].folding)
            continue;
        for (uint32_t ring = 0; ring < rings; ring++)
            widen(s, &s->part[i]);
        smooth(s, &s->part[i], NULL, SMR_REPAIR_SWEEPS * rings);
    }
}

/* Keeps what does not fold from folding. */
static void prevent(smr *s)
{
    for (uint32_t round = 0; round < SMR_ROUNDS && mark_folds(s, 0, round) > 0u; round++) {
        for (uint32_t i = 0; i < s->n_parts && round < SMR_SMOOTHINGS; i++) {
            if (!s->part[i].folding)
                continue;
            if (round > 0u)
                widen(s, &s->part[i]);
            smooth(s, &s->part[i], s->x, SMR_SWEEPS);
        }
    }
}

void smr_guard_end(smr *s)
{
    uint32_t n_bent = 0;
    s->n_guarded = 0;
    s->n_folding = 0;
    for (uint32_t task = 0; task < s->n_hinge_tasks; task++)
        n_bent += s->tally[task].n_rejected;
    if (n_bent == 0u)
        return;
    for (uint32_t i = 0; i < s->n_parts; i++)
        s->part[i].folding = 0;
    memset(s->guard, 0, s->n);
    if (s->repairing > 0u)
        repair(s);
    else
        prevent(s);
    for (uint32_t v = 0; v < s->n; v++)
        s->n_guarded += s->guard[v];
    for (uint32_t task = 0; task < smr_facet_tasks(s); task++)
        smr_facet_refit(s, task, 0);
    smr_facets_end(s);
}
