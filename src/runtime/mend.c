/* mend.c: deals with hinges that fold, at the finest radii. Before the last two radii
 * - iterations without forces repair what folds by then: in a patch around it, that grows while this does not suffice,
 *   the displacement from the rest shape is made as smooth as the patch's surroundings.
 * From then on, where an iteration would turn triangles back on each other,
 * - the steps x_next - x of their corners become the mean of their neighbours' steps, again in a growing patch: a patch
 *   that moves as a whole does not fold;
 * - what would fold even so has its steps halved, and at last stays where it was, which did not fold.
 * How many passes that takes is seen on the way, and each depends on the one before. So it is one task after the other, each a
 * piece of a pass over hinges, triangles or vertices; `s->mend` says which comes next.
 * Bounds: SMR_ROUNDS passes over the hinges and SMR_SMOOTHINGS times 3 + 2 SMR_SWEEPS over the structures that fold; a repair
 * one, and 3 + 2 SMR_REPAIR_SWEEPS for each ring of its patch.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/guard.h"

#define SMR_SMOOTHINGS 5u /* rounds that smooth steps */
#define SMR_HALVINGS 3u   /* rounds that halve them; later ones take them back */
#define SMR_ROUNDS 40u
#define SMR_SWEEPS 3u
#define SMR_EDGE_FLOOR 1.0e-3f /* mm, added to edge lengths before they divide */
#define SMR_REPAIR_SWEEPS 10u
#define SMR_REPAIR_WIDEN 3u /* iterations until the patch grows by a ring */

/* Passes. */
enum { SMR_MEND_IDLE = 0, SMR_MEND_MARK, SMR_MEND_WIDEN, SMR_MEND_SPREAD, SMR_MEND_CLEAR, SMR_MEND_SUM, SMR_MEND_MOVE };

static smr_vec normal_at(const smr *s, float *x, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return smr_unit(smr_triangle_cross(smr_load(smr_at3(x, t[0])), smr_load(smr_at3(x, t[1])), smr_load(smr_at3(x, t[2]))));
}

static int folds_between(smr_vec first, smr_vec second, const smr_image_hinge *h)
{
    return smr_dot(first, second) < smr_hinge_limit(smr_le32(h->bend));
}

static int any_marked(const smr *s, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]];
}

/* At x_next: as the facets have it, unless a corner may have moved since. */
static smr_vec next_normal(const smr *s, uint32_t triangle, int marked)
{
    return marked ? normal_at(s, s->x_next, triangle) : smr_load(s->facet_normal + 3u * (size_t)triangle);
}

/* Runs of triangles in which something is marked: the others are passed over without a look at their corners. */
static void touch(smr *s, uint32_t triangle)
{
    const uint32_t run = triangle >> s->mend.run_bits;
    s->mend.touched[run / 64u] |= (uint64_t)1 << (run % 64u);
}

static int touched(const smr *s, uint32_t triangle)
{
    const uint32_t run = triangle >> s->mend.run_bits;
    return (int)(s->mend.touched[run / 64u] >> (run % 64u) & 1u);
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

/* Marks the corners of hinges that fold at x_next: all of them in a repair, otherwise those that did not at x. The first
 * round looks where the search counted some, the others where marks are: nothing else has moved since. Runs do not know of
 * what a pass holds back itself. */
static void mark_folds(smr *s, uint32_t from, uint32_t to)
{
    const int repairs = s->repairing > 0u;
    const uint32_t round = s->mend.round;
    for (uint32_t i = from; i < to; i++) {
        const smr_image_hinge *h = smr_hinge_at(s, i);
        const uint32_t first = smr_le32(h->first), second = smr_hinge_second(h);
        if (round == 0u ? s->tally[i / SMR_HINGE_CHUNK].n_rejected == 0u
                        : round < SMR_SMOOTHINGS && !touched(s, first) && !touched(s, second))
            continue;
        const int first_marked = any_marked(s, first), second_marked = any_marked(s, second);
        if (round > 0u && !first_marked && !second_marked)
            continue;
        if (!folds_between(next_normal(s, first, first_marked), next_normal(s, second, second_marked), h) ||
            (!repairs && folds_between(normal_at(s, s->x, first), normal_at(s, s->x, second), h)))
            continue;
        mark(s, first);
        mark(s, second);
        if (round >= SMR_SMOOTHINGS) {
            const float keep = round < SMR_SMOOTHINGS + SMR_HALVINGS ? 0.5f : 0.0f;
            hold(s, first, keep);
            hold(s, second, keep);
        }
        s->mend.n_folds++;
    }
}

/* Marks the neighbours of marked vertices, */
static void widen(smr *s, const uint32_t *t, const uint32_t *end)
{
    for (; t < end; t += 3)
        if ((s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]]) & 1u)
            for (uint32_t c = 0; c < 3u; c++)
                s->guard[t[c]] |= 2u;
}

/* for good. */
static void spread(smr *s, const uint32_t *t, const uint32_t *end)
{
    for (; t < end; t++)
        s->guard[*t] = s->guard[*t] != 0u;
}

/* Where a vertex' displacement is counted from: base, or the rest shape in its fitted pose when base is NULL. */
static smr_vec base_at(const smr *s, float *base, uint32_t v)
{
    if (base != NULL)
        return smr_load(smr_at3(base, v));
    const uint32_t *r = (const uint32_t *)smr_at(s->model, s->model->at_rest) + 3u * (size_t)v;
    return smr_pose_apply(&s->fitted, smr_v(smr_le_float(r[0]), smr_le_float(r[1]), smr_le_float(r[2])));
}

static void clear_rings(smr *s, uint32_t triangle, uint32_t last)
{
    for (; triangle < last; triangle++) {
        const uint32_t *t = s->triangle + 3u * (size_t)triangle;
        if (!any_marked(s, triangle))
            continue;
        touch(s, triangle);
        for (uint32_t c = 0; c < 3u; c++) {
            smr_store(smr_at3(s->ring_sum, t[c]), smr_v(0, 0, 0));
            s->ring_weight[t[c]] = 0.0f;
        }
    }
}

/* Weighted sums of the displacements x_next - base of marked vertices' mesh neighbours. Near neighbours weigh more, so
 * that the corners of a sliver, which the smallest difference turns over, move alike. */
static void sum_rings(smr *s, uint32_t triangle, uint32_t last, float *base)
{
    for (; triangle < last; triangle++) {
        const uint32_t *t = s->triangle + 3u * (size_t)triangle;
        smr_vec at[3], moved[3];
        if (!touched(s, triangle)) {
            triangle |= ((uint32_t)1 << s->mend.run_bits) - 1u; /* to the end of the run */
            continue;
        }
        if (!any_marked(s, triangle))
            continue;
        for (uint32_t c = 0; c < 3u; c++) {
            at[c] = base_at(s, base, t[c]);
            moved[c] = smr_sub(smr_load(smr_at3(s->x_next, t[c])), at[c]);
        }
        for (uint32_t a = 0; a < 3u; a++) { /* the edge from corner a to the next, both ways */
            const uint32_t b = (a + 1u) % 3u;
            const float w = 1.0f / (smr_length(smr_sub(at[a], at[b])) + SMR_EDGE_FLOOR);
            float *sum_a = smr_at3(s->ring_sum, t[a]), *sum_b = smr_at3(s->ring_sum, t[b]);
            smr_store(sum_a, smr_add(smr_load(sum_a), smr_scale(moved[b], w)));
            smr_store(sum_b, smr_add(smr_load(sum_b), smr_scale(moved[a], w)));
            s->ring_weight[t[a]] += w;
            s->ring_weight[t[b]] += w;
        }
    }
}

/* Displacements x_next - base of marked vertices become the mean of their mesh neighbours' displacements, over and over:
 * a few sweeps towards the smoothest displacement that joins the patch's surroundings. */
static void move(smr *s, uint32_t from, uint32_t to, float *base)
{
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(s->model, i);
        if (!s->guard[v])
            continue;
        const smr_vec mean = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
        smr_store(smr_at3(s->x_next, v), smr_add(base_at(s, base, v), mean));
        smr_store(smr_at3(s->ring_sum, v), smr_v(0, 0, 0)); /* for the next sweep */
        s->ring_weight[v] = 0.0f;
    }
}

static uint32_t rings_of(const smr *s)
{
    return s->repairing > 0u ? 1u + s->repairing / SMR_REPAIR_WIDEN : (s->mend.round > 0u ? 1u : 0u);
}

static uint32_t sweeps_of(const smr *s) { return s->repairing > 0u ? SMR_REPAIR_SWEEPS * rings_of(s) : SMR_SWEEPS; }

static void next_round(smr *s)
{
    smr_mend *m = &s->mend;
    m->n_folds = m->part = 0;
    m->stage = s->repairing == 0u && ++m->round < SMR_ROUNDS ? SMR_MEND_MARK : SMR_MEND_IDLE;
}

/* On to the next structure that folds, from m->part on. */
static void next_part(smr *s)
{
    smr_mend *m = &s->mend;
    while (m->part < s->n_parts && !s->part[m->part].folding)
        m->part++;
    m->ring = m->sweep = 0;
    if (m->part < s->n_parts)
        m->stage = rings_of(s) > 0u ? SMR_MEND_WIDEN : SMR_MEND_CLEAR;
    else
        next_round(s);
}

static void marked(smr *s)
{
    smr_mend *m = &s->mend;
    if (s->repairing > 0u)
        s->n_folding = m->n_folds;
    m->part = 0;
    if (m->n_folds == 0u)
        m->stage = SMR_MEND_IDLE;
    else if (m->round >= SMR_SMOOTHINGS)
        next_round(s);
    else
        next_part(s);
}

/* A pass is complete. */
static void next_pass(smr *s)
{
    smr_mend *m = &s->mend;
    m->at = 0;
    if (m->stage == SMR_MEND_MARK) {
        marked(s);
    } else if (m->stage == SMR_MEND_SPREAD) {
        m->stage = ++m->ring < rings_of(s) ? SMR_MEND_WIDEN : SMR_MEND_CLEAR;
    } else if (m->stage != SMR_MEND_MOVE) {
        m->stage++;
    } else if (++m->sweep < sweeps_of(s)) {
        m->stage = SMR_MEND_SUM;
    } else {
        m->part++;
        next_part(s);
    }
}

void smr_mend_start(smr *s)
{
    memset(&s->mend, 0, sizeof s->mend);
    s->mend.stage = SMR_MEND_MARK;
    while (s->n_triangles >> s->mend.run_bits >= SMR_MEND_RUNS)
        s->mend.run_bits++;
}

uint32_t smr_mend_tasks(smr *s) { return s->mend.stage == SMR_MEND_IDLE ? s->next_task : s->next_task + 1u; }

/* A piece of the pass under way. */
void smr_mend_pass(void *arg, uint32_t task, uint32_t worker)
{
    smr *s = arg;
    smr_mend *m = &s->mend;
    const smr_part *part = &s->part[m->part];
    float *base = s->repairing > 0u ? NULL : s->x;
    const uint32_t length = m->stage == SMR_MEND_MARK ? s->n_hinges
                            : m->stage == SMR_MEND_MOVE ? part->n_vertices : part->facets.n_triangles;
    const uint32_t from = m->at, to = smr_min_u32(from + SMR_TRIANGLE_CHUNK, length);
    const uint32_t *t = part->facets.triangle + 3u * (size_t)from, *end = part->facets.triangle + 3u * (size_t)to;
    (void)task;
    (void)worker;
    if (m->stage == SMR_MEND_MARK)
        mark_folds(s, from, to);
    else if (m->stage == SMR_MEND_WIDEN)
        widen(s, t, end);
    else if (m->stage == SMR_MEND_SPREAD)
        spread(s, t, end);
    else if (m->stage == SMR_MEND_CLEAR)
        clear_rings(s, part->first_triangle + from, part->first_triangle + to);
    else if (m->stage == SMR_MEND_SUM)
        sum_rings(s, part->first_triangle + from, part->first_triangle + to, base);
    else if (m->stage == SMR_MEND_MOVE)
        move(s, part->first_vertex + from, part->first_vertex + to, base);
    m->at = to;
    if (to == length)
        next_pass(s);
}

void smr_mend_end(smr *s)
{
    const int hold = s->radius == smr_last_radius(s) && s->repairing == 0u;
    s->n_guarded = 0;
    for (uint32_t v = 0; v < s->n; v++) {
        s->n_guarded += s->guard[v];
        s->held[v] |= (uint8_t)(hold && s->guard[v]);
    }
    s->mend.moved = 1;
}

/* Facets once more, where the above moved anything. */
uint32_t smr_mend_facet_tasks(smr *s) { return s->mend.moved ? smr_facet_tasks(s) : 0u; }

void smr_mend_abandon(smr *s)
{
    memset(&s->mend, 0, sizeof s->mend);
    memset(&s->unfold, 0, sizeof s->unfold);
}
