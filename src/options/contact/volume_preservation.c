/* volume_preservation.c: corrects each closed structure's volume in each iteration: all its vertices move equally far
 * along their normals. This is the projection of position based dynamics (Mueller et al. 2007) with vertices weighted
 * by area: the smallest displacement that gives the volume. It follows forces and clusters, so a target with another
 * volume keeps the surface at equal distance everywhere. At radii larger than a structure's thickness the clusters
 * restore parts that would become thin. A new ratio is reached in steps, so that coarse clusters can spread the change.
 * Bounds: one pass over triangles and vertices.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

#define SMR_VOLUME_STEP 0.04f      /* largest change of a structure's ratio `now` in an iteration / ratio */
#define SMR_DISPLACEMENT_MOST 0.5f /* largest displacement in an iteration / half the mean thickness */
#define SMR_NOW_MOST 100.0f        /* largest absolute value of a structure's ratio `now` */

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared)
{
    if (!(shared->config.contact.volume > 0.0f))
        return;
    v->kept = smr_slot_scratch(a, v->kept, shared->n_structures, sizeof *v->kept);
    for (uint32_t i = 0; smr_keeps(a) && i < shared->n_structures; i++) {
        smr_kept_volume none = {0}, *one = v->kept != NULL ? &v->kept[i] : &none;
        smr_keep_floats(a, &one->ratio, 1, SMR_VOLUME_RATIO_LEAST, SMR_VOLUME_RATIO_MOST);
        smr_keep_floats(a, &one->now, 1, -SMR_NOW_MOST, SMR_NOW_MOST);
    }
}

void smr_volumes_model(smr_volumes *v, uint32_t structure, const smr_bulk *rest)
{
    if (v->kept == NULL)
        return;
    smr_kept_volume *one = &v->kept[structure];
    one->ratio = one->ratio_at_begin = one->now = 1.0f;
    one->closed = rest->closed;
    one->model_mm3 = rest->mm3;
    one->model_thick_mm = rest->thick_mm;
}

void smr_volumes_scale(smr_volumes *v, float scale, float side)
{
    for (uint32_t i = 0; v->kept != NULL && i < v->shared->n_structures; i++) {
        v->kept[i].rest_mm3 = side * v->kept[i].model_mm3 * scale * scale * scale;
        v->kept[i].thick_mm = v->kept[i].model_thick_mm * scale;
    }
}

int smr_volume_asked(const smr_volumes *v, uint32_t structure)
{
    return v->kept[structure].closed && v->kept[structure].thick_mm > 0.0f;
}

void smr_volumes_start(smr_volumes *v, uint32_t structure, float mm3)
{
    v->kept[structure].now = smr_clamp(mm3 / v->kept[structure].rest_mm3, -SMR_NOW_MOST, SMR_NOW_MOST);
}

void smr_volumes_begin(smr_volumes *v)
{
    for (uint32_t i = 0; i < v->shared->n_structures; i++)
        v->kept[i].ratio_at_begin = v->kept[i].ratio;
}

int smr_volumes_pending(const smr_volumes *v)
{
    int pending = 0;
    for (uint32_t i = 0; i < v->shared->n_structures; i++)
        pending |= v->kept[i].closed && v->kept[i].now != v->kept[i].ratio_at_begin;
    return pending;
}

void smr_volumes_commit(smr_volumes *v)
{
    for (uint32_t i = 0; i < v->shared->n_structures; i++) {
        smr_kept_volume *one = &v->kept[i];
        const float step = SMR_VOLUME_STEP * smr_max(smr_abs(one->now), SMR_VOLUME_RATIO_LEAST);
        one->now += smr_clamp(one->ratio_at_begin - one->now, -step, step);
    }
}

uint32_t smr_volume_tasks(const void *arg)
{
    const smr_volumes *v = arg;
    return v->kept != NULL && v->schedule->repairing == 0u ? smr_triangle_tasks(v->shared) + v->shared->n_tasks : 0u;
}

/* Returns the sum over cones from `apex` whose bases are the triangles from .. to - 1 at the next positions. */
static smr_enclosed piece_of(const smr_volumes *v, uint32_t from, uint32_t to, smr_vec apex)
{
    smr_enclosed sum = {{0, 0, 0, 0}};
    for (uint32_t k = from; k < to; k++) {
        const uint32_t *t = smr_model_triangle(v->shared, k);
        smr_vec at[3], normal[3];
        for (uint32_t c = 0; c < 3u; c++) {
            at[c] = smr_sub(smr_get3(v->shape->x_next, t[c]), apex);
            normal[c] = smr_next_normal(v->sum, t[c]);
        }
        sum = smr_enclosed_add(sum, smr_cone(at, normal));
    }
    return sum;
}

/* Adds the cones on triangles from .. to - 1, which may belong to several structures, to each structure's `sum`, and
 * computes displacement_mm of each structure whose sum is complete. */
static void sum_piece(smr_volumes *v, uint32_t from, uint32_t to)
{
    while (from < to) {
        const uint32_t i = smr_model_owner(v->shared->model, smr_model_triangle(v->shared, from)[0]);
        const smr_shape_structure *one = &v->shape->structure[i];
        const uint32_t end = one->first_triangle + one->tree.n_triangles, last = end > from ? smr_min_u32(to, end) : to;
        smr_kept_volume *kept = &v->kept[i];
        if (from == one->first_triangle) {
            memset(&kept->sum, 0, sizeof kept->sum);
            kept->apex = smr_cone_apex(v->shape, i, v->shape->x_next);
        }
        if (kept->closed)
            kept->sum = smr_enclosed_add(kept->sum, piece_of(v, from, last, kept->apex));
        if (kept->closed && last == one->first_triangle + one->tree.n_triangles)
            kept->displacement_mm =
                v->shared->config.contact.volume * smr_enclosed_displacement(&kept->sum, kept->now * kept->rest_mm3,
                                                                             SMR_DISPLACEMENT_MOST * kept->thick_mm);
        from = last;
    }
}

void smr_volume_correct(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_volumes *v = arg;
    const uint32_t n = smr_triangle_tasks(v->shared), first = task * SMR_TRIANGLE_CHUNK;
    if (task < n)
        sum_piece(v, first, smr_min_u32(first + SMR_TRIANGLE_CHUNK, v->shared->n_triangles));
    for (uint32_t i = (task - n) * SMR_CHUNK; task >= n && i < smr_chunk_end(v->shared, task - n); i++) {
        const float displacement = v->kept[smr_model_owner(v->shared->model, i)].displacement_mm;
        smr_add3(v->shape->x_next, i, smr_scale(smr_next_normal(v->sum, i), displacement));
    }
}
