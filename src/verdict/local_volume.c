/* local_volume.c: the change of volume around each vertex since the rest shape, on demand: the volume between the
 * surface of a cluster and its centre, now / at rest. Volumes are measured, not derived from transforms, so they
 * include folds and forces; a linear map would count bending as shrinking. Each vertex gets a third of its triangles'
 * normals (of twice the area), volumes and moments. Their cluster sums are exact, in the memory of records and sums.
 * Bounds: four passes over the vertices, two over the triangles, one over a radius' lists.
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "geometry/box_tree/triangle.h"
#include "registration/schedule_radius.h"

#define SMR_LOCAL_EDGES 8.0f     /* default radius in mean edge lengths */
#define SMR_LOCAL_MOST 1.0e6f    /* largest ratio of volumes that is returned */
#define SMR_LOCAL_LEAST 1.0e-18f /* smallest area, mm^2, or volume, mm^3, that is divided by */
#define SMR_SKIN 0.001f /* thickness of the layer added even to a closed surface / root of the surface's area */

/* Words of the record of a vertex or a cluster: of the present shape, then as many of the rest shape. */
enum { SMR_SIX_VOLUMES, SMR_NORMALS, SMR_MOMENTS = 4, SMR_TWO_AREAS = 7, SMR_LOCAL_WORDS };

typedef struct local {
    const smr_shared *shared;
    smr_schedule schedule; /* a copy with the lists of the requested radius */
    smr_shape shape;       /* a copy with the pose from the rest shape to the present one */
    smr_sums sums;
    float *part;       /* [n][SMR_LOCAL_WORDS] floating-point values of each vertex, of one shape */
    float scale[2][2]; /* [present, rest][areas, volumes] stored = value * scale */
} local;

static void begin(local *l, const smr *s, float radius_mm)
{
    const smr_model *m = s->shared.model;
    const float wanted = radius_mm > 0.0f ? radius_mm : SMR_LOCAL_EDGES * smr_le_float(m->edge_mm);
    l->shared = &s->shared;
    l->schedule = s->schedule;
    l->schedule.lists = smr_model_lists(m, smr_radius_near(m, 0, smr_le32(m->n_radii) - 1u, wanted));
    l->schedule.n_active = s->shared.n;
    l->shape = s->shape;
    smr_rest_pose_now(&l->shape);
    l->sums = s->sums;
    l->sums.schedule = &l->schedule;
    l->part = (float *)s->sums.sum;
}

static void add_triangle(local *l, const uint32_t t[3], const smr_vec p[3])
{
    const float third = 1.0f / 3.0f;
    const smr_vec n = smr_scale(smr_triangle_cross(p[0], p[1], p[2]), third);
    const float area = smr_length(n), volume = smr_dot(p[0], n);
    const smr_vec moment = smr_scale(smr_add(p[0], smr_add(p[1], p[2])), third * area);
    const float words[SMR_LOCAL_WORDS] = {volume, n.x, n.y, n.z, moment.x, moment.y, moment.z, area};
    for (uint32_t c = 0; c < 3u; c++)
        for (uint32_t i = 0; i < SMR_LOCAL_WORDS; i++)
            l->part[SMR_LOCAL_WORDS * (size_t)t[c] + i] += words[i];
}

/* Writes the records of the present shape (rest 0) or of the rest shape (rest 1). */
static void record(local *l, int rest)
{
    const uint32_t n = l->shared->n;
    float area = 0.0f, volume = 0.0f;
    memset(l->part, 0, SMR_LOCAL_WORDS * sizeof(float) * (size_t)n);
    for (uint32_t k = 0; k < l->shared->n_triangles; k++) {
        const uint32_t *t = smr_model_triangle(l->shared, k);
        smr_vec p[3];
        for (uint32_t c = 0; c < 3u; c++)
            p[c] = rest ? smr_rest_posed(&l->shape, t[c]) : smr_get3(l->shape.x, t[c]);
        add_triangle(l, t, p);
    }
    for (uint32_t v = 0; v < n; v++) {
        const float *part = l->part + SMR_LOCAL_WORDS * (size_t)v;
        area = smr_max(area, part[SMR_TWO_AREAS]);
        for (uint32_t i = 0; i < SMR_TWO_AREAS; i++)
            if (i < SMR_NORMALS || i >= SMR_MOMENTS)
                volume = smr_max(volume, smr_abs(part[i]));
    }
    smr_sums_expect(&l->sums, SMR_WORDS, area, volume);
    memcpy(l->scale[rest], l->sums.scale, sizeof l->sums.scale);
    for (uint32_t i = 0; i < SMR_LOCAL_WORDS * n; i++) {
        const uint32_t v = i / SMR_LOCAL_WORDS, k = i % SMR_LOCAL_WORDS;
        const int is_volume = k < SMR_NORMALS || (k >= SMR_MOMENTS && k < SMR_TWO_AREAS);
        l->sums.record[SMR_WORDS * (size_t)v + (rest ? SMR_LOCAL_WORDS : 0u) + k] =
            smr_fixed(l->part[i] * l->sums.scale[is_volume]);
    }
}

/* Volume, area and openness of a cluster in one shape. */
typedef struct bulk {
    float volume, area; /* six times the volume about the centre, mm^3; twice the area, mm^2 */
    float open;         /* 0..1: 0 for a surface all around the cluster, 1 for a flat one */
} bulk;

static bulk bulk_of(const local *l, uint32_t v, int rest)
{
    const uint32_t *w = l->sums.sum + SMR_WORDS * (size_t)v + (rest ? SMR_LOCAL_WORDS : 0u);
    const float areas = 1.0f / l->scale[rest][0], volumes = 1.0f / l->scale[rest][1];
    bulk b = {0.0f, smr_max(smr_unfix(w[SMR_TWO_AREAS], areas), 0.0f), 1.0f};
    if (!(b.area > SMR_LOCAL_LEAST))
        return b;
    const smr_vec normal = smr_unfix3(w + SMR_NORMALS, areas), middle = smr_unfix3(w + SMR_MOMENTS, volumes);
    b.volume = smr_unfix(w[SMR_SIX_VOLUMES], volumes) - smr_dot(middle, normal) / b.area;
    b.open = smr_min(smr_length(normal) / b.area, 1.0f);
    return b;
}

/* Returns the ratio of a cluster's volume to its volume at rest. An open surface has a small volume that changes with
 * bending: a layer is added to the surface, so that the ratio is that of the areas. */
static float ratio_at(const local *l, uint32_t v)
{
    const bulk now = bulk_of(l, v, 0), rest = bulk_of(l, v, 1);
    const smr_pose *p = &l->shape.rest_pose;
    const smr_vec x = smr_column(p, 0), y = smr_column(p, 1);
    const float posed = smr_dot(smr_column(p, 2), smr_cross(x, y));
    const float layer = SMR_SQRT(rest.area) * (SMR_SKIN + rest.open * rest.open);
    const float from = smr_abs(rest.volume) + layer * rest.area;
    const float to = (rest.volume < 0.0f ? -now.volume : now.volume) + layer * now.area;
    if (!(from > SMR_LOCAL_LEAST))
        return smr_min(posed, SMR_LOCAL_MOST);
    return smr_abs(to) < SMR_LOCAL_MOST * from ? smr_clamp(posed * (to / from), -SMR_LOCAL_MOST, SMR_LOCAL_MOST)
                                               : (to < 0.0f ? -SMR_LOCAL_MOST : SMR_LOCAL_MOST);
}

smr_status smr_get_local_volume(smr *s, uint32_t structure, float radius_mm, float *ratio)
{
    local l;
    SMR_TRY(ratio == NULL ? SMR_E_NULL : smr_sound(s));
    if (!smr_ready(s) || s->step != 0u || s->next_task != 0u)
        return SMR_E_STATE;
    if ((structure != SMR_ALL && structure >= s->shared.n_structures) || !(radius_mm >= 0.0f) ||
        radius_mm > SMR_COORD_MAX)
        return SMR_E_INPUT;
    begin(&l, s, radius_mm);
    record(&l, 0);
    record(&l, 1);
    smr_sums_at_once(&l.sums);
    const uint32_t first = structure == SMR_ALL ? 0u : s->shape.structure[structure].first_vertex;
    const uint32_t n = structure == SMR_ALL ? s->shared.n : s->shape.structure[structure].n_vertices;
    for (uint32_t k = 0; k < n; k++)
        ratio[k] = ratio_at(&l, smr_model_position(s->shared.model, first + k));
    return SMR_OK;
}
