/* fold_repair.c: repairs what folds before the last two radii, in iterations without forces: in a patch around it, that grows while
 * this does not suffice, the displacement from the rest shape is made as smooth as the patch's surroundings. One task after
 * the other, each a piece of a pass over hinges, triangles or vertices; `s->mend` says which comes next.
 * Bounds: one pass over the hinges, and over the structures that fold 3 + 2 SMR_REPAIR_SWEEPS for each ring of the patch.
 * SPDX-License-Identifier: MIT */
#include "geometry/triangle.h"
#include "runtime/folds/folds.h"

#define SMR_EDGE_FLOOR 1.0e-3f /* mm, added to edge lengths before they divide */
#define SMR_REPAIR_SWEEPS 10u
#define SMR_REPAIR_WIDEN 3u /* iterations until the patch grows by a ring */

/* Passes. */
enum { SMR_MEND_IDLE = 0, SMR_MEND_MARK, SMR_MEND_WIDEN, SMR_MEND_SPREAD, SMR_MEND_CLEAR, SMR_MEND_SUM, SMR_MEND_MOVE };

static int any_marked(const smr *s, uint32_t triangle)
{
    const uint32_t *t = s->triangle + 3u * (size_t)triangle;
    return s->guard[t[0]] | s->guard[t[1]] | s->guard[t[2]];
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

/* Marks the corners of hinges that fold at x_next, where the search counted some. */
static void mark_folds(smr *s, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const smr_stored_hinge *h = smr_hinge_at(s, i);
        if (s->tally[i / SMR_HINGE_CHUNK].n_rejected == 0u ||
            !(smr_hinge_cosine(s, s->x_next, h) < smr_hinge_limit(smr_le32(h->bend))))
            continue;
        mark(s, smr_le32(h->first));
        mark(s, smr_hinge_second(h));
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

/* The rest shape in its fitted pose: displacements are counted from there. */
static smr_vec rest_at(const smr *s, uint32_t v)
{
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

/* Weighted sums of the displacements of marked vertices' mesh neighbours. Near neighbours weigh more, so
 * that the corners of a sliver, which the smallest difference turns over, move alike. */
static void sum_rings(smr *s, uint32_t triangle, uint32_t last)
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
            at[c] = rest_at(s, t[c]);
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

/* Displacements of marked vertices become the mean of their mesh neighbours' displacements, over and over:
 * a few sweeps towards the smoothest displacement that joins the patch's surroundings. */
static void move(smr *s, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        const uint32_t v = smr_model_position(s->model, i);
        if (!s->guard[v])
            continue;
        const smr_vec mean = smr_scale(smr_load(smr_at3(s->ring_sum, v)), 1.0f / s->ring_weight[v]);
        smr_store(smr_at3(s->x_next, v), smr_add(rest_at(s, v), mean));
        smr_store(smr_at3(s->ring_sum, v), smr_v(0, 0, 0)); /* for the next sweep */
        s->ring_weight[v] = 0.0f;
    }
}

static uint32_t rings_of(const smr *s) { return 1u + s->repairing / SMR_REPAIR_WIDEN; }

/* On to the next structure that folds, from m->part on. */
static void next_part(smr *s)
{
    smr_mend *m = &s->mend;
    while (m->part < s->n_parts && !s->part[m->part].folding)
        m->part++;
    m->ring = m->sweep = 0;
    m->stage = m->part < s->n_parts ? SMR_MEND_WIDEN : SMR_MEND_IDLE;
}

/* A pass is complete. */
static void next_pass(smr *s)
{
    smr_mend *m = &s->mend;
    m->at = 0;
    if (m->stage == SMR_MEND_MARK) {
        s->n_folding = m->n_folds;
        next_part(s);
    } else if (m->stage == SMR_MEND_SPREAD) {
        m->stage = ++m->ring < rings_of(s) ? SMR_MEND_WIDEN : SMR_MEND_CLEAR;
    } else if (m->stage != SMR_MEND_MOVE) {
        m->stage++;
    } else if (++m->sweep < SMR_REPAIR_SWEEPS * rings_of(s)) {
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
    const uint32_t length = m->stage == SMR_MEND_MARK   ? s->n_hinges
                            : m->stage == SMR_MEND_MOVE ? part->n_vertices
                                                        : part->facets.n_triangles;
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
        sum_rings(s, part->first_triangle + from, part->first_triangle + to);
    else if (m->stage == SMR_MEND_MOVE)
        move(s, part->first_vertex + from, part->first_vertex + to);
    m->at = to;
    if (to == length)
        next_pass(s);
}

void smr_mend_end(smr *s)
{
    s->n_guarded = 0;
    for (uint32_t v = 0; v < s->n; v++)
        s->n_guarded += s->guard[v];
    s->mend.moved = 1;
}

/* Facets once more, where the above moved anything. */
uint32_t smr_mend_facet_tasks(smr *s) { return s->mend.moved ? smr_facet_tasks(s) : 0u; }

void smr_mend_abandon(smr *s)
{
    memset(&s->mend, 0, sizeof s->mend);
    memset(&s->unfold, 0, sizeof s->unfold);
    memset(&s->brake, 0, sizeof s->brake);
}
