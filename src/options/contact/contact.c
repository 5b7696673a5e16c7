/* contact.c: finds the contacts of vertices and the displacements that end penetration, and projects positions out of
 * contacts. A contact is a plane near a vertex, within SMR_CONTACT_BAND of another structure, with the exit direction
 * as its normal. Displaced by forces and momentum, and the other surface by its own, the vertex may not lie behind the
 * plane: both sides share the missing displacement by mass, along the normal only, so sliding is free (non-penetration
 * constraints of Mueller et al., "Position based dynamics", 2006). Inside, the exit leads through triangles that face
 * the vertex' own normal, so that a thin structure is not passed through; from fixed surfaces it is the shortest.
 * Weights fade with distance. A lower bound on the distance to all bodies, less the displacements since, spares most
 * searches.
 * Projection: clusters average the displacements of single vertices, and a vertex inside a triangle does not push the
 * triangle's corners. At the last radius, before the search for folds, vertex and corners share the missing
 * displacement by mass and barycentric weights, which keeps linear and angular momentum.
 * Bounds: two searches of config.forces.node_budget nodes for a vertex and near body; SMR_PROJECT_PASSES passes.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

#define SMR_CONTACT_DEEP 10.0f  /* mm: depth beyond which a vertex, at its first search, is not pushed out */
#define SMR_CONTACT_BAND 0.5f   /* width of the band beyond gap_mm in which weights of contacts rise from 0, mm */
#define SMR_REACH_NEAR 1.25f    /* search radius / (gap_mm + SMR_CONTACT_BAND) of vertices that were near a surface */
#define SMR_REACH_FAR 4.0f      /* search radius / (gap_mm + SMR_CONTACT_BAND) of all other vertices */
#define SMR_FACING_NONE (-0.5f) /* cosine of exit direction and inward normal at or below which contacts weigh 0 */
#define SMR_FACING_FULL (-0.3f) /* cosine of exit direction and inward normal at or above which contacts weigh 1 */
#define SMR_PASSED 4.0f         /* exit depth / depth of the nearest triangle above which a contact loses weight */
#define SMR_TRIANGLES_LAST 2u   /* number of last iterations that test triangles' centres; with more, vertices drift */
#define SMR_TRIANGLE_REACH 3.0f /* search radius of triangles' centres - gap_mm, mm */
#define SMR_REACH_UNKNOWN (-SMR_CONTACT_DEEP)
#define SMR_WORK_PROBE 4000u  /* instructions at most to begin the test of a point of the surface, ... */
#define SMR_WORK_BODY 40u     /* ... to test the box of a body, ... */
#define SMR_WORK_NEAR 800u    /* ... for a triangle nearly as close as the closest one */
#define SMR_PROJECT_CHUNK 64u /* number of vertices or triangles in a task of the projection */
#define SMR_PROJECT_PASSES 3u /* number of passes of the projection over all contacts */

static uint32_t n_bodies(const smr_shared *c) { return c->n_structures + c->config.contact.n_fixed; }

void smr_contact_layout(smr_arena *a, smr_contact *c, const smr_shared *shared)
{
    const size_t n = shared->n;
    if (shared->config.contact.n_fixed > 0u) /* not saved: the caller sets fixed surfaces again after a restore */
        c->fixed = smr_slot_scratch(a, c->fixed, shared->config.contact.n_fixed, sizeof *c->fixed);
    if (!(shared->config.contact.share > 0.0f))
        return;
    c->box = smr_slot_scratch(a, c->box, n_bodies(shared), sizeof *c->box);
    c->closed = smr_slot_scratch(a, c->closed, shared->n_structures, 1);
    c->touch = smr_slot_scratch(a, c->touch, n, SMR_TOUCHES * sizeof *c->touch);
    c->triangle_touch = smr_slot_scratch(a, c->triangle_touch, shared->n_triangles, sizeof *c->triangle_touch);
    c->push = smr_slot_scratch(a, c->push, n, 3u * sizeof(float));
    c->reach = smr_slot_floats(a, c->reach, n, SMR_KEPT_MM);
    c->reach_next = smr_slot_scratch(a, c->reach_next, n, sizeof(float));
}

void smr_contact_model(smr_contact *c, uint32_t structure, const smr_bulk *rest)
{
    if (c->closed != NULL)
        c->closed[structure] = (uint8_t)(rest->closed && rest->mm3 > 0.0f);
}

void smr_contact_reset(smr_contact *c, uint32_t part, uint32_t parts)
{
    const smr_piece p = smr_part(c->shared->n, part, parts);
    if (c->touch == NULL)
        return;
    for (uint32_t v = p.first; v < p.last; v++) {
        c->touch[SMR_TOUCHES * (size_t)v].body = SMR_NONE;
        smr_put3(c->push, v, smr_v(0, 0, 0));
        c->reach[v] = c->reach_next[v] = SMR_REACH_UNKNOWN;
    }
}

smr_status smr_fixed_valid(const smr_contact *c)
{
    smr_status status = SMR_OK;
    for (uint32_t i = 0; c->fixed != NULL && i < c->shared->config.contact.n_fixed; i++) {
        const smr_fixed_surface *f = &c->fixed[i];
        if (f->surface == NULL)
            continue;
        if (!smr_surface_valid(f->surface) || f->surface->n_vertices != f->n_vertices ||
            f->surface->changes != f->changes)
            return SMR_E_STATE;
        if (smr_surface_guard(f->surface) != f->guard)
            status = SMR_E_DAMAGED;
    }
    return status;
}

/* Returns the tree of a body's triangles; NULL: no contacts. *shift: from the shape's to the body's origin, mm. */
static const smr_box_tree *body_of(const smr_contact *c, uint32_t body, smr_vec *shift)
{
    *shift = smr_v(0, 0, 0);
    if (body < c->shared->n_structures)
        return c->closed[body] ? &c->shape->structure[body].tree : NULL;
    const smr_surface *surface = c->fixed[body - c->shared->n_structures].surface;
    if (surface == NULL)
        return NULL;
    *shift = smr_sub(surface->origin, c->shape->origin);
    return &surface->tree;
}

/* Stores the box of a body; for a body without contacts a box without points. */
static void place_box(smr_contact *c, uint32_t body)
{
    smr_vec shift;
    const smr_box_tree *f = body_of(c, body, &shift);
    const smr_box box = f != NULL && f->n_levels > 0u ? smr_node_box(smr_tree_root(f)) : smr_no_box();
    c->box[body] = (smr_box){smr_add(box.lo, shift), smr_add(box.hi, shift)};
}

int smr_contact_acts(const smr_contact *c)
{
    return c->schedule->repairing == 0u &&
           (c->shared->n_structures == 1u || smr_at_last_radius(c->shared, c->schedule) ||
            smr_model_separate(c->shared->model, c->schedule->radius));
}

void smr_contact_begin(smr_contact *c)
{
    for (uint32_t i = 0; i < n_bodies(c->shared); i++)
        place_box(c, i);
    c->triangles_due = smr_contact_on(c) && smr_at_last_radius(c->shared, c->schedule) && !c->schedule->tracking &&
                       c->schedule->radius_iteration + SMR_TRIANGLES_LAST >= c->shared->config.basic.iterations_last;
}

void smr_contact_fix(smr_contact *c, uint32_t index, const smr_surface *surface)
{
    c->fixed[index] = (smr_fixed_surface){.surface = surface};
    if (surface != NULL)
        c->fixed[index] =
            (smr_fixed_surface){surface, surface->n_vertices, surface->changes, smr_surface_guard(surface), 0};
    for (uint32_t v = 0; v < c->shared->n && c->touch != NULL; v++)
        c->reach[v] = SMR_REACH_UNKNOWN;
}

/* Stores the current forces' distance bounds. Bounds of inactive vertices fall by twice the largest displacement. */
void smr_contact_keep(smr_contact *c, smr_piece p)
{
    const uint32_t n = smr_contact_on(c) ? c->schedule->n_active : 0u;
    for (uint32_t v = p.first; v < p.last; v++)
        if (v < n)
            c->reach[v] = c->reach_next[v];
        else if (c->reach[v] != SMR_REACH_UNKNOWN)
            c->reach[v] = smr_max(c->reach[v] - 2.0f * *c->moved_mm, 2.0f * SMR_REACH_UNKNOWN);
}

/* Returns a weight that changes linearly from 0 at value = `from` to 1 at `to`, constant outside. */
static float ramp(float value, float from, float to) { return smr_clamp((value - from) / (to - from), 0.0f, 1.0f); }

/* Writes the exit from inside a structure, through triangles that face the vertex, to *side. Returns a weight, 0..1. */
static float face_out(const smr_box_tree *f, const float *normal, smr_query q, smr_pause *pause, smr_side *side)
{
    const float nearest = -side->mm;
    q.min_cos = SMR_FACING_NONE;
    if (!smr_signed_distance(f, normal, &q, SMR_CONTACT_DEEP, pause, side) || side->mm > 0.0f)
        return 0.0f;
    return smr_clamp(SMR_PASSED * nearest / smr_max(-side->mm, 1.0e-6f), 0.0f, 1.0f);
}

/* A point of a structure's surface that is tested for contacts. */
typedef struct probe {
    smr_vec at, inward; /* position, mm; unit vector opposite to the surface's normal */
    uint32_t owner;     /* structure that the point belongs to */
} probe;

/* Writes the signed distance of a point to a body. Returns the contact's weight, 0..1; -1: body beyond `reach`. The
 * result does not count when a search stopped. */
static float side_of(const smr_contact *c, const probe *p, uint32_t body, float reach, smr_worker *w)
{
    smr_side *const side = &w->task.contact.side;
    smr_vec shift;
    const smr_box_tree *f = body_of(c, body, &shift);
    const int moves = body < c->shared->n_structures;
    const smr_surface *fixed = moves ? NULL : c->fixed[body - c->shared->n_structures].surface;
    const float *normal = moves ? c->shape->normal : fixed->normal;
    const smr_query q = {smr_sub(p->at, shift), p->inward, -2.0f, c->shared->config.forces.node_budget, SMR_NONE};
    if (w->task.contact.leaves)
        return face_out(f, normal, q, &w->pause, side);
    if (!smr_signed_distance(f, normal, &q, reach, &w->pause, side))
        return -1.0f;
    if (!moves)
        return fixed->open && smr_surface_on_border(fixed, side->triangle, side->weight) ? 0.0f : 1.0f;
    if (!(side->mm < 0.0f))
        return ramp(smr_dot(p->inward, side->out), SMR_FACING_NONE, SMR_FACING_FULL);
    if (smr_dot(smr_get3(f->normal, side->triangle), q.normal) > 0.0f)
        return 1.0f;
    w->task.contact.leaves = 1; /* inside: the exit leads through triangles that face the vertex */
    return face_out(f, normal, q, &w->pause, side);
}

/* Adds a contact to touch[n], which keeps the n deepest contacts in the order of their bodies. */
static void keep(smr_touch *touch, uint32_t n, const smr_touch *more)
{
    uint32_t shallow = 0, used = 0;
    for (; used < n && touch[used].body != SMR_NONE; used++)
        if (touch[used].mm > touch[shallow].mm)
            shallow = used;
    if (used < n) {
        touch[used] = *more;
        return;
    }
    if (!(more->mm < touch[shallow].mm))
        return;
    for (uint32_t i = shallow; i + 1u < n; i++)
        touch[i] = touch[i + 1u];
    touch[n - 1u] = *more;
}

/* Adds the contact with a body, of weight `counts`, to touch[n]. */
static void note(const smr_contact *c, uint32_t body, float counts, smr_worker *w, smr_touch *touch, uint32_t n)
{
    const smr_side *side = &w->task.contact.side;
    const float zone = c->shared->config.contact.gap_mm + SMR_CONTACT_BAND;
    w->task.contact.inside |= side->mm <= 0.0f;
    w->task.contact.deepest = smr_max(w->task.contact.deepest, -side->mm);
    w->task.contact.nearest = smr_min(w->task.contact.nearest, smr_abs(side->mm));
    const float share = counts * ramp(side->mm, zone, zone - 0.5f * SMR_CONTACT_BAND);
    if (!(share > 0.0f))
        return;
    smr_touch more = {.body = body, .triangle = side->triangle, .mm = side->mm, .share = share};
    memcpy(more.weight, side->weight, sizeof more.weight);
    smr_store(more.out, side->out);
    keep(touch, n, &more);
}

/* Writes the n deepest contacts of a point with bodies within `reach`. Returns a lower bound on their distance, mm. */
static float look(const smr_contact *c, const probe *p, float reach, smr_worker *w, smr_touch *touch, uint32_t n)
{
    if (!w->pause.in_search) {
        smr_work(&w->pause, SMR_WORK_PROBE + SMR_WORK_BODY * n_bodies(c->shared));
        memset(&w->task.contact, 0, sizeof w->task.contact);
        w->task.contact.nearest = reach;
    }
    for (; w->task.contact.body < n_bodies(c->shared); w->task.contact.body++) {
        const uint32_t body = w->task.contact.body;
        if (body == p->owner || !smr_box_reaches(&c->box[body], p->at, reach))
            continue;
        const float counts = side_of(c, p, body, reach, w);
        if (w->pause.kept)
            return 0.0f;
        w->task.contact.leaves = 0;
        if (counts >= 0.0f)
            note(c, body, counts, w, touch, n);
    }
    return w->task.contact.inside ? -w->task.contact.deepest : w->task.contact.nearest;
}

uint32_t smr_contact_work(const smr_contact *c)
{
    return SMR_WORK_PROBE + SMR_WORK_BODY * n_bodies(c->shared) + SMR_NEAR_MOST * SMR_WORK_NEAR;
}

void smr_contact_find(smr_contact *c, uint32_t v, smr_worker *w)
{
    /* with unknown bounds, as after an abandoned iteration, moved_mm is not used: a replay does not know moved_mm */
    const float moved = c->reach[v] == SMR_REACH_UNKNOWN ? 0.0f : 2.0f * *c->moved_mm;
    const float zone = c->shared->config.contact.gap_mm + SMR_CONTACT_BAND;
    smr_touch *touch = c->touch + SMR_TOUCHES * (size_t)v;
    const float bound = c->reach[v] - moved;
    for (uint32_t i = 0; !w->pause.in_search && i < SMR_TOUCHES; i++)
        touch[i].body = SMR_NONE;
    c->reach_next[v] = smr_max(bound, 2.0f * SMR_REACH_UNKNOWN);
    if (!c->shape->on_surface[v] || (c->reach[v] > 0.0f && bound > zone))
        return;
    /* search radius, mm; where bound < 0, -bound is the largest depth inside a structure that is possible now */
    const float far = zone * (c->reach[v] > zone ? SMR_REACH_FAR : SMR_REACH_NEAR);
    const probe p = {smr_get3(c->shape->x, v), smr_scale(smr_get3(c->shape->normal, v), -1.0f),
                     smr_model_owner(c->shared->model, v)};
    c->reach_next[v] = look(c, &p, smr_min(smr_max(far, -bound), SMR_CONTACT_DEEP + zone), w, touch, SMR_TOUCHES);
}

/* Returns 1 when the distance bound of a corner of triangle t excludes a contact of the triangle's centre, `middle`. */
static int out_of_reach(const smr_contact *c, const uint32_t *t, smr_vec middle)
{
    const float zone = c->shared->config.contact.gap_mm + SMR_CONTACT_BAND, moved = 2.0f * *c->moved_mm;
    for (uint32_t i = 0; i < 3u; i++)
        if (c->reach[t[i]] - moved > zone + smr_length(smr_sub(smr_get3(c->shape->x, t[i]), middle)))
            return 1;
    return 0;
}

void smr_contact_find_triangle(smr_contact *c, uint32_t k, smr_worker *w)
{
    const uint32_t *t = smr_model_triangle(c->shared, k);
    const float *x = c->shape->x;
    const smr_vec sum = smr_add(smr_get3(x, t[0]), smr_add(smr_get3(x, t[1]), smr_get3(x, t[2])));
    const probe p = {smr_scale(sum, 1.0f / 3.0f), smr_scale(smr_get3(c->shape->triangle_normal, k), -1.0f),
                     smr_model_owner(c->shared->model, t[0])};
    if (!w->pause.in_search)
        c->triangle_touch[k].body = SMR_NONE;
    if (!out_of_reach(c, t, p.at))
        (void)look(c, &p, c->shared->config.contact.gap_mm + SMR_TRIANGLE_REACH, w, &c->triangle_touch[k], 1);
}

/* Returns the three stored vertices of the touched triangle; NULL for a fixed surface, which does not move. */
static const uint32_t *corners_of(const smr_contact *c, const smr_touch *touch)
{
    const smr_shape_structure *one = &c->shape->structure[touch->body];
    if (touch->body >= c->shared->n_structures || touch->triangle >= one->tree.n_triangles)
        return NULL;
    return smr_model_triangle(c->shared, one->first_triangle + touch->triangle);
}

smr_vec smr_contact_displacement(const smr_contact *c, uint32_t v, smr_displacement displaced, const void *ctx)
{
    const smr_touch *touch = c->touch + SMR_TOUCHES * (size_t)v;
    const smr_vec own = displaced(ctx, v);
    const float mass = smr_mass(c->shared, v);
    smr_vec moved = smr_v(0, 0, 0);
    for (uint32_t i = 0; i < SMR_TOUCHES && touch[i].body != SMR_NONE; i++) {
        const uint32_t *t = corners_of(c, &touch[i]);
        smr_vec other = smr_v(0, 0, 0);
        float heavy = 0.0f;
        for (uint32_t k = 0; t != NULL && k < 3u; k++) {
            other = smr_add(other, smr_scale(displaced(ctx, t[k]), touch[i].weight[k]));
            heavy += touch[i].weight[k] * smr_mass(c->shared, t[k]);
        }
        const float share = t == NULL ? 1.0f : heavy / (mass + heavy); /* v's part of the motion, 0..1 */
        const smr_vec out = smr_load(touch[i].out), apart = smr_sub(smr_add(own, moved), other);
        const float missing = smr_positive(c->shared->config.contact.gap_mm - touch[i].mm - smr_dot(out, apart));
        moved = smr_add(moved, smr_scale(out, share * touch[i].share * missing * c->shared->config.contact.share));
    }
    return moved;
}

/* ---- projection ---- */

static uint32_t due_tasks(const smr_contact *c)
{
    return c->triangles_due ? smr_ceil_div(c->shared->n_triangles, SMR_PROJECT_CHUNK) : 0u;
}

static uint32_t vertex_tasks(const smr_contact *c) { return smr_ceil_div(c->schedule->n_active, SMR_PROJECT_CHUNK); }

uint32_t smr_contact_project_tasks(const void *arg)
{
    const smr_contact *c = arg;
    if (!smr_contact_on(c) || !smr_at_last_radius(c->shared, c->schedule))
        return 0;
    return SMR_PROJECT_PASSES * (vertex_tasks(c) + due_tasks(c));
}

/* A point of a surface that the projection moves: a vertex, or a point of a triangle. */
typedef struct place {
    uint32_t n, vertex[3]; /* number of vertices, and the vertices; n is 0 for a surface that does not move */
    float weight[3];       /* barycentric weight of each vertex */
} place;

/* Returns how far a point moves along `out` in this iteration, mm. Adds the point's inverse mass, 1 / g, to *sum. */
static float displacement_along(const smr_contact *c, const place *p, smr_vec out, float *sum)
{
    float displacement = 0.0f;
    for (uint32_t k = 0; k < p->n; k++) {
        const uint32_t v = p->vertex[k];
        displacement += p->weight[k] * smr_dot(out, smr_sub(smr_get3(c->shape->x_next, v), smr_get3(c->shape->x, v)));
        *sum += p->weight[k] * p->weight[k] / smr_mass(c->shared, v);
    }
    return displacement;
}

static void move(const smr_contact *c, const place *p, smr_vec out, float mm)
{
    for (uint32_t k = 0; k < p->n; k++) {
        const float share = p->weight[k] / smr_mass(c->shared, p->vertex[k]);
        smr_add3(c->shape->x_next, p->vertex[k], smr_scale(out, mm * share));
    }
}

/* Moves a point and the touched triangle apart along the contact's normal, up to a distance of gap_mm. */
static void separate(const smr_contact *c, const place *p, const smr_touch *touch)
{
    const uint32_t *t = corners_of(c, touch);
    const smr_vec out = smr_load(touch->out);
    place other = {t != NULL ? 3u : 0u, {0, 0, 0}, {touch->weight[0], touch->weight[1], touch->weight[2]}};
    float sum = 0.0f;
    if (t != NULL)
        memcpy(other.vertex, t, sizeof other.vertex);
    const float apart = displacement_along(c, p, out, &sum) - displacement_along(c, &other, out, &sum);
    const float missing = c->shared->config.contact.gap_mm - touch->mm - apart;
    if (!(missing > 0.0f && sum > 0.0f))
        return;
    const float displacement = missing * touch->share * c->shared->config.contact.share / sum;
    move(c, p, out, displacement);
    move(c, &other, out, -displacement);
}

static void separate_vertices(const smr_contact *c, uint32_t chunk)
{
    const uint32_t last = smr_min_u32((chunk + 1u) * SMR_PROJECT_CHUNK, c->schedule->n_active);
    for (uint32_t v = chunk * SMR_PROJECT_CHUNK; v < last; v++) {
        const smr_touch *touch = c->touch + SMR_TOUCHES * (size_t)v;
        const place p = {1, {v, 0, 0}, {1, 0, 0}};
        for (uint32_t i = 0; i < SMR_TOUCHES && touch[i].body != SMR_NONE; i++)
            separate(c, &p, &touch[i]);
    }
}

static void separate_triangles(const smr_contact *c, uint32_t chunk)
{
    const uint32_t last = smr_min_u32((chunk + 1u) * SMR_PROJECT_CHUNK, c->shared->n_triangles);
    for (uint32_t k = chunk * SMR_PROJECT_CHUNK; k < last; k++) {
        const uint32_t *t = smr_model_triangle(c->shared, k);
        const place p = {3, {t[0], t[1], t[2]}, {1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f}};
        if (c->triangle_touch[k].body != SMR_NONE)
            separate(c, &p, &c->triangle_touch[k]);
    }
}

void smr_contact_project(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_contact *c = arg;
    const uint32_t n = due_tasks(c), chunk = task % (n + vertex_tasks(c));
    if (chunk < n)
        separate_triangles(c, chunk);
    else
        separate_vertices(c, chunk - n);
}
