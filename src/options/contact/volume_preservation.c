/* volume_preservation.c: leads each closed structure's volume to what is asked, in each iteration: all its vertices go
 * equally far along their normals, as far as it takes. That is the projection of position based dynamics (Mueller et
 * al. 2007) with vertices weighed by area: of all ways to change a volume by so much it moves the surface least. It
 * comes behind the forces and the clusters, so a target that wants another volume keeps the surface at equal distance
 * all over, and comes to rest there. What forces see next holds it already; nothing is integrated.
 * The clusters carry it on: at radii larger than a structure is thick they give back what parts thinner than the rest
 * would lose, and this asks for the remainder all over.
 * A ratio other than the present one is gone to by steps, so that coarse clusters spread it.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

#define SMR_VOLUME_STEP 0.04f /* of the volume: largest change of what is asked, in an iteration */
#define SMR_WAY_MOST 0.5f     /* of half the thickness: largest way in an iteration */
#define SMR_NOW_MOST 100.0f   /* ratio of the start positions to the rest shape, either way */

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared)
{
    if (!(shared->config.contact.volume > 0.0f))
        return;
    v->held = smr_slot_scratch(a, v->held, shared->n_structures, sizeof *v->held);
    for (uint32_t i = 0; smr_keeps(a) && i < shared->n_structures; i++) {
        smr_held_volume none = {0}, *one = v->held != NULL ? &v->held[i] : &none;
        smr_keep_floats(a, &one->ratio, 1, SMR_ASKED_LEAST, SMR_ASKED_MOST);
        smr_keep_floats(a, &one->now, 1, -SMR_NOW_MOST, SMR_NOW_MOST);
    }
}

void smr_volumes_wire(smr_volumes *v, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                      const smr_overlay *overlay)
{
    v->shared = shared;
    v->pace = pace;
    v->shape = shape;
    v->sum = overlay->sum;
}

void smr_volumes_model(smr_volumes *v)
{
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++) {
        smr_held_volume *one = &v->held[i];
        memset(one, 0, sizeof *one);
        one->ratio = one->begun = one->now = 1.0f;
        one->closed = (uint32_t)smr_rest_volume(v->shape, i, &one->model_mm3, &one->model_thick_mm);
    }
}

void smr_volumes_scale(smr_volumes *v)
{
    const float scale = v->held != NULL ? smr_start_scale(v->shape) : 1.0f;
    const float side = v->held != NULL && smr_start_mirrored(v->shape) ? -1.0f : 1.0f;
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++) {
        v->held[i].rest_mm3 = side * v->held[i].model_mm3 * scale * scale * scale;
        v->held[i].thick_mm = v->held[i].model_thick_mm * scale;
    }
}

void smr_volumes_start(smr_volumes *v)
{
    smr_volumes_scale(v);
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++) {
        smr_held_volume *one = &v->held[i];
        if (!one->closed || !(one->thick_mm > 0.0f))
            continue;
        const float present = smr_enclosed_of(v->shape, i, v->shape->x);
        one->now = smr_clamp(present / one->rest_mm3, -SMR_NOW_MOST, SMR_NOW_MOST);
    }
}

void smr_volumes_begin(smr_volumes *v)
{
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++)
        v->held[i].begun = v->held[i].ratio;
}

int smr_volumes_under_way(const smr_volumes *v)
{
    int under_way = 0;
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++)
        under_way |= v->held[i].closed && v->held[i].now != v->held[i].begun;
    return under_way;
}

void smr_volumes_stand(smr_volumes *v)
{
    for (uint32_t i = 0; v->held != NULL && i < v->shared->n_structures; i++) {
        smr_held_volume *one = &v->held[i];
        const float step = SMR_VOLUME_STEP * smr_max(smr_abs(one->now), SMR_ASKED_LEAST);
        one->now += smr_clamp(one->begun - one->now, -step, step);
    }
}

static uint32_t sum_tasks(const smr_volumes *v) { return smr_ceil_div(v->shared->n_triangles, SMR_TRIANGLE_CHUNK); }

uint32_t smr_volume_tasks(const void *arg)
{
    const smr_volumes *v = arg;
    return v->held != NULL && v->pace->repairing == 0u ? sum_tasks(v) + v->shared->n_tasks : 0u;
}

static smr_enclosed piece_of(const smr_volumes *v, uint32_t from, uint32_t to, smr_vec amid)
{
    smr_enclosed sum = {{0, 0, 0, 0}};
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = v->shared->triangle + 3u * (size_t)k;
        smr_vec at[3], normal[3];
        for (uint32_t c = 0; c < 3u; c++) {
            at[c] = smr_sub(smr_load(smr_at3(v->shape->x_next, t[c])), amid);
            normal[c] = smr_next_normal(v->sum, t[c]);
        }
        sum = smr_enclosed_add(sum, smr_cone(at, normal));
    }
    return sum;
}

/* Sums over triangles from .. to - 1, which may be of several structures, one after the other. */
static void sum_piece(smr_volumes *v, uint32_t from, uint32_t to)
{
    while (from < to) {
        const uint32_t i = smr_model_owner(v->shared->model, v->shared->triangle[3u * (size_t)from]);
        const smr_shape_structure *one = &v->shape->structure[i];
        const uint32_t last = smr_min_u32(to, one->first_triangle + one->facets.n_triangles);
        smr_held_volume *held = &v->held[i];
        if (from == one->first_triangle) {
            memset(&held->sum, 0, sizeof held->sum);
            held->amid = smr_amid(v->shape, i, v->shape->x_next);
        }
        if (held->closed)
            held->sum = smr_enclosed_add(held->sum, piece_of(v, from, last, held->amid));
        from = last;
    }
}

/* All sums are complete. */
static void choose_ways(smr_volumes *v)
{
    for (uint32_t i = 0; i < v->shared->n_structures; i++) {
        smr_held_volume *one = &v->held[i];
        one->way_mm = 0.0f;
        if (one->closed)
            one->way_mm = v->shared->config.contact.volume *
                          smr_enclosed_way(&one->sum, one->now * one->rest_mm3, SMR_WAY_MOST * one->thick_mm);
    }
}

static void go(const smr_volumes *v, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++) {
        float *x = smr_at3(v->shape->x_next, i);
        const float way = v->held[smr_model_owner(v->shared->model, i)].way_mm;
        smr_store(x, smr_add(smr_load(x), smr_scale(smr_next_normal(v->sum, i), way)));
    }
}

void smr_volume_lead(void *arg, uint32_t task, uint32_t worker)
{
    smr_volumes *v = arg;
    const uint32_t n = sum_tasks(v), first = task * SMR_TRIANGLE_CHUNK;
    (void)worker;
    if (task < n)
        sum_piece(v, first, smr_min_u32(first + SMR_TRIANGLE_CHUNK, v->shared->n_triangles));
    if (task == n)
        choose_ways(v);
    if (task >= n)
        go(v, (task - n) * SMR_CHUNK, smr_chunk_end(v->shared, task - n));
}
