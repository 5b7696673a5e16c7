/* fold_open.c: opens folds that remain at the last radius: dihedral edges whose triangles face away from each other but
 * not in the rest shape. fold_limit.c leaves a margin to edges with right angles at rest, and only keeps old folds from
 * growing. The corners of an edge move the shortest distance to a positive cosine. Edges are opened one after the
 * other, in several passes, since opening an edge may turn its neighbour.
 * Source: projection of a constraint, Mueller et al., "Position based dynamics", 2006.
 * Bounds: SMR_OPEN_PASSES passes over the dihedral edges.
 * SPDX-License-Identifier: MIT */
#include "geometry/box_tree/triangle.h"
#include "registration/folds/folds.h"

#define SMR_OPEN_PASSES 16u       /* largest number of passes over the dihedral edges in an iteration */
#define SMR_OPEN_CHUNK 32u        /* number of dihedral edges in a task */
#define SMR_OPEN_COS 0.01f        /* cosine to which folds are opened */
#define SMR_CORNER_REACH 0.25f    /* largest displacement of a corner in a pass, as a share of the shortest edge */
#define SMR_SQUARE_FLOOR 1.0e-22f /* per mm^2: largest squared gradient of a cosine that counts as none */
#define SMR_AREA_FLOOR 1.0e-6f    /* mm^2: twice the area of the smallest triangle that has a normal */

void smr_fold_open_start(smr_folds *f)
{
    memset(&f->open, 0, sizeof f->open);
    f->open.pass.stage = smr_at_last_radius(f->shared, f->schedule) && f->schedule->repairing == 0u;
}

uint32_t smr_fold_open_tasks(const void *folds) { return smr_fold_tasks(&((const smr_folds *)folds)->open.pass); }

/* One of the two triangles of a dihedral edge, at x_next. */
typedef struct side {
    const uint32_t *corner; /* [3] vertices of the triangle */
    smr_vec edge[3];        /* the edge opposite each corner, mm */
    smr_vec normal;         /* unit normal of the triangle */
    float area2;            /* twice the area of the triangle, mm^2 */
    float shortest2;        /* squared length of the shortest edge, mm^2 */
} side;

static side side_of(const smr_folds *f, uint32_t triangle)
{
    side t;
    t.corner = smr_corners(f, triangle);
    const smr_vec a = smr_get3(f->shape->x_next, t.corner[0]), b = smr_get3(f->shape->x_next, t.corner[1]);
    const smr_vec c = smr_get3(f->shape->x_next, t.corner[2]), cross = smr_triangle_cross(a, b, c);
    t.edge[0] = smr_sub(c, b);
    t.edge[1] = smr_sub(a, c);
    t.edge[2] = smr_sub(b, a);
    t.area2 = smr_length(cross);
    t.normal = smr_unit(cross);
    t.shortest2 =
        smr_min(smr_dot(t.edge[0], t.edge[0]), smr_min(smr_dot(t.edge[1], t.edge[1]), smr_dot(t.edge[2], t.edge[2])));
    return t;
}

/* Adds the gradient of the cosine with respect to one triangle's corners, which is parallel to the triangle's normal.
 * Places 0 to 2 are corners of the first triangle, place 3 is the other corner of the second. */
static void add_gradient(const side *own, const side *other, const uint32_t place[3], smr_vec gradient[4])
{
    for (uint32_t c = 0; c < 3u; c++) {
        const float turn = -smr_dot(other->normal, smr_cross(own->normal, own->edge[c])) / own->area2;
        gradient[place[c]] = smr_add(gradient[place[c]], smr_scale(own->normal, turn));
    }
}

SMR_SELDOM static int open_dihedral(smr_folds *f, const side *a, const side *b, float cosine)
{
    static const uint32_t own[3] = {0, 1, 2};
    uint32_t place[3] = {3, 3, 3}, corner[4] = {a->corner[0], a->corner[1], a->corner[2], a->corner[0]};
    smr_vec gradient[4] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    for (uint32_t c = 0; c < 3u; c++) {
        for (uint32_t k = 0; k < 3u; k++)
            if (b->corner[c] == a->corner[k])
                place[c] = k;
        if (place[c] == 3u)
            corner[3] = b->corner[c];
    }
    add_gradient(a, b, own, gradient);
    add_gradient(b, a, place, gradient);
    float square = 0.0f, largest2 = 0.0f;
    for (uint32_t c = 0; c < 4u; c++) {
        square += smr_dot(gradient[c], gradient[c]);
        largest2 = smr_max(largest2, smr_dot(gradient[c], gradient[c]));
    }
    if (!(square > SMR_SQUARE_FLOOR))
        return 0; /* the edge is fully folded: no direction opens it sooner than another */
    const float most = SMR_CORNER_REACH * SMR_SQRT(smr_min(a->shortest2, b->shortest2) / largest2);
    const float share = smr_min((SMR_OPEN_COS - cosine) / square, most);
    for (uint32_t c = 0; c < 4u; c++) {
        smr_add3(f->shape->x_next, corner[c], smr_scale(gradient[c], share));
        f->marked[corner[c]] = 1;
        smr_tangent_limit(f->tangent_smooth, corner[c], 1.0f);
    }
    return 1;
}

/* Returns the first of the edges from .. to - 1 that may be folded; to: none. Where folds were found, any may, and once
 * a fold was opened: that moves corners of triangles which are not touched. */
static uint32_t next(const smr_folds *f, int found, uint32_t from, uint32_t to)
{
    return found || f->open.n_passes + f->open.n_folds > 0u ? from : smr_next_touched(f, from, to);
}

/* Opens folds among edges from .. to - 1: found by fold_find.c, or with a corner that a fold step has moved. */
static void open_folds(smr_folds *f, uint32_t from, uint32_t to)
{
    const smr_tally *tally = &f->tally[from / SMR_DIHEDRAL_CHUNK];
    const int found = (tally->folds.open & smr_piece_bit(from)) != 0u;
    const uint32_t pass = f->open.n_passes, before = pass > 0u ? SMR_OPENED + pass - 1u : 0u;
    if (!(found && pass == 0u) && !smr_marked_since(f, tally, before))
        return; /* nothing has moved in these structures: in limit, or since the pass before began */
    for (uint32_t i = next(f, found, from, to); i < to; i = next(f, found, i + 1u, to)) {
        const smr_stored_dihedral *h = smr_edge_at(f, i);
        const uint32_t first = smr_edge_first(f, h), second = smr_edge_second(f, h);
        if (!smr_edge_open(h) || (!smr_any_marked(f, first) && !smr_any_marked(f, second) &&
                                  !(found && smr_refitted_cosine(f, h) < SMR_FOLD_COS)))
            continue;
        const side a = side_of(f, first), b = side_of(f, second);
        const float cosine = smr_dot(a.normal, b.normal);
        if (!(cosine < SMR_FOLD_COS) || !(smr_min(a.area2, b.area2) > SMR_AREA_FLOOR))
            continue;
        if (!open_dihedral(f, &a, &b, cosine))
            continue;
        f->folding[smr_model_owner(f->shared->model, a.corner[0])] = SMR_OPENED + pass + 1u;
        f->open.n_folds++;
    }
}

static const smr_fold_stage stages[] = {[1] = {SMR_OVER_DIHEDRALS, SMR_OPEN_CHUNK, open_folds}};

/* Step: opens the folds of one chunk. The next pass needs the positions of this pass. */
void smr_fold_open_pass(void *arg, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_folds *f = arg;
    smr_fold_open *o = &f->open;
    if (!smr_fold_run(f, &o->pass, stages))
        return;
    o->pass.at = 0;
    o->pass.stage = o->n_folds > 0u && ++o->n_passes < SMR_OPEN_PASSES;
    o->n_folds = 0;
}
