/* local_volume.c: the change of volume around each vertex since the rest shape, on demand: the volume between the
 * surface of a cluster and its centre, now / at rest. Volumes are measured, not derived from transforms, so they
 * include folds and forces; a linear map would count bending as shrinking. Each vertex gets a third of its triangles'
 * normals (of twice the area), volumes and moments. Their cluster sums are exact, in the memory of records and sums.
 * A job (base/job.h). Bounds: passes over vertices and triangles in short pieces, one over a radius' lists.
 * SPDX-License-Identifier: MIT */
#include "base/fixed_point.h"
#include "geometry/box_tree/triangle.h"
#include "registration/schedule_radius.h"
#include "registration/measure_job.h"

#define SMR_LOCAL_EDGES 8.0f     /* default radius in mean edge lengths */
#define SMR_LOCAL_MOST 1.0e6f    /* largest ratio of volumes that is returned */
#define SMR_LOCAL_LEAST 1.0e-18f /* smallest area, mm^2, or volume, mm^3, that is divided by */
#define SMR_SKIN 0.001f /* thickness of the layer added even to a closed surface / root of the surface's area */

/* Words of the record of a vertex or a cluster: of the present shape, then as many of the rest shape. */
enum { SMR_SIX_VOLUMES, SMR_NORMALS, SMR_MOMENTS = 4, SMR_TWO_AREAS = 7, SMR_LOCAL_WORDS };

#define SMR_LOCAL_PIECE 192u /* vertices or triangles in a task */

typedef struct local {
    smr_measuring job;
    uint32_t first, n; /* vertices asked for, in the caller's order */
    float *ratio;      /* [n] the caller's */
    const smr_shared *shared;
    smr_schedule schedule; /* a copy with the lists of the requested radius */
    smr_shape shape;       /* a copy with the pose from the rest shape to the present one */
    smr_sums sums;
    uint32_t block;     /* block of the order L whose lists are summed */
    uint32_t rest;      /* 1: the rest shape is recorded; 0: the present one */
    float area, volume; /* largest values of vertices so far, mm^2 and mm^3 */
    float *part;        /* [n][SMR_LOCAL_WORDS] floating-point values of each vertex, of one shape */
    float scale[2][2];  /* [present, rest][areas, volumes] stored = value * scale */
} local;

_Static_assert(sizeof(local) <= SMR_JOB_BYTES, "local volumes in progress lie in the caller's job");

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

/* ---- records of the present shape, then of the rest shape ---- */

static uint32_t pose_tasks(const void *job) { return smr_rest_pose_tasks(&((const local *)job)->shape); }
static void add_pose(void *job, uint32_t task, uint32_t worker)
{
    smr_rest_pose_sum(&((local *)job)->shape, task, worker);
}

static uint32_t vertex_tasks(const void *job) { return smr_ceil_div(((const local *)job)->shared->n, SMR_LOCAL_PIECE); }
static uint32_t triangle_tasks(const void *job)
{
    return smr_ceil_div(((const local *)job)->shared->n_triangles, SMR_LOCAL_PIECE);
}

static void clear(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const local *l = job;
    const smr_piece p = smr_piece_of(task, SMR_LOCAL_PIECE, l->shared->n);
    memset(l->part + SMR_LOCAL_WORDS * (size_t)p.first, 0, SMR_LOCAL_WORDS * sizeof(float) * (p.last - p.first));
}

static void add_triangles(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    local *l = job;
    const smr_piece piece = smr_piece_of(task, SMR_LOCAL_PIECE, l->shared->n_triangles);
    if (task == 0u && !l->rest)
        smr_rest_pose_end(&l->shape);
    l->area = l->volume = 0.0f;
    for (uint32_t k = piece.first; k < piece.last; k++) {
        const uint32_t *t = smr_model_triangle(l->shared, k);
        smr_vec p[3];
        for (uint32_t c = 0; c < 3u; c++)
            p[c] = l->rest ? smr_rest_posed(&l->shape, t[c]) : smr_get3(l->shape.x, t[c]);
        add_triangle(l, t, p);
    }
}

/* Finds the largest values; the last task sets the scales of fixed-point values. */
static void find_largest(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    local *l = job;
    const smr_piece p = smr_piece_of(task, SMR_LOCAL_PIECE, l->shared->n);
    for (uint32_t v = p.first; v < p.last; v++) {
        const float *part = l->part + SMR_LOCAL_WORDS * (size_t)v;
        l->area = smr_max(l->area, part[SMR_TWO_AREAS]);
        for (uint32_t i = 0; i < SMR_TWO_AREAS; i++)
            if (i < SMR_NORMALS || i >= SMR_MOMENTS)
                l->volume = smr_max(l->volume, smr_abs(part[i]));
    }
    if (p.last < l->shared->n)
        return;
    smr_sums_expect(&l->sums, SMR_WORDS, l->area, l->volume);
    memcpy(l->scale[l->rest], l->sums.scale, sizeof l->sums.scale);
}

static void record(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const local *l = job;
    const smr_piece p = smr_piece_of(task, SMR_LOCAL_PIECE, l->shared->n);
    for (uint32_t i = SMR_LOCAL_WORDS * p.first; i < SMR_LOCAL_WORDS * p.last; i++) {
        const uint32_t v = i / SMR_LOCAL_WORDS, k = i % SMR_LOCAL_WORDS;
        const int is_volume = k < SMR_NORMALS || (k >= SMR_MOMENTS && k < SMR_TWO_AREAS);
        l->sums.record[SMR_WORDS * (size_t)v + (l->rest ? SMR_LOCAL_WORDS : 0u) + k] =
            smr_fixed(l->part[i] * l->scale[l->rest][is_volume]);
    }
}

/* Goes back to record the rest shape; then prepares the sums. */
static void end_records(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    local *l = job;
    if (l->rest == 0u)
        l->job.head.next_stage = l->job.head.stage - 4u;
    l->rest = 1;
    l->block = 0;
    smr_worker_start(&l->shared->worker[0]);
}

/* Sums a part of the lists of the current block, and comes back until no block is left. */
static void sum_lists(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    local *l = job;
    if (smr_sums_some(&l->sums, &l->block))
        smr_job_again(&l->job.head);
}

static uint32_t boundary_tasks(const void *job) { return smr_boundary_tasks(&((const local *)job)->sums); }
static void sum_boundary(void *job, uint32_t task, uint32_t worker)
{
    smr_boundary_sums(&((local *)job)->sums, task, worker);
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

static uint32_t ratio_tasks(const void *job) { return smr_ceil_div(((const local *)job)->n, SMR_LOCAL_PIECE); }

static void find_ratios(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const local *l = job;
    const smr_piece p = smr_piece_of(task, SMR_LOCAL_PIECE, l->n);
    for (uint32_t k = p.first; k < p.last; k++)
        l->ratio[k] = ratio_at(l, smr_model_position(l->shared->model, l->first + k));
}

static const smr_stage stages[] = {
    {pose_tasks, add_pose, smr_in_order, NULL},
    {vertex_tasks, clear, NULL, NULL},
    {triangle_tasks, add_triangles, smr_in_order, NULL},
    {vertex_tasks, find_largest, smr_in_order, NULL},
    {vertex_tasks, record, NULL, NULL},
    {NULL, end_records, NULL, NULL}, /* back to `clear` */
    {NULL, sum_lists, NULL, NULL},
    {boundary_tasks, sum_boundary, smr_in_order, NULL},
    {ratio_tasks, find_ratios, NULL, NULL},
};

static int is_unchanged(void *job, int enter)
{
    local *l = job;
    l->sums.schedule = &l->schedule;
    if (!smr_measure_guard(&l->job, enter))
        return 0;
    if (!enter)
        smr_guard_close(l->job.s); /* the sums of lists move a worker, which the guard covers */
    return 1;
}

smr_status smr_local_volume_begin(smr *s, uint32_t structure, float radius_mm, float *ratio, smr_job *job)
{
    local *const l = (local *)(void *)job;
    SMR_TRY(ratio == NULL || job == NULL ? SMR_E_NULL : smr_sound(s));
    if (!smr_measurable(s))
        return SMR_E_STATE;
    if ((structure != SMR_ALL && structure >= s->shared.n_structures) || !(radius_mm >= 0.0f) ||
        radius_mm > SMR_COORD_MAX)
        return SMR_E_INPUT;
    const smr_model *m = s->shared.model;
    const float wanted = radius_mm > 0.0f ? radius_mm : SMR_LOCAL_EDGES * smr_le_float(m->edge_mm);
    memset(l, 0, sizeof *l);
    l->job = smr_measure_begin(s, stages, sizeof stages / sizeof stages[0]);
    l->job.head.guard = is_unchanged;
    l->first = structure == SMR_ALL ? 0u : s->shape.structure[structure].first_vertex;
    l->n = structure == SMR_ALL ? s->shared.n : s->shape.structure[structure].n_vertices;
    l->ratio = ratio;
    l->shared = &s->shared;
    l->schedule = s->schedule;
    l->schedule.lists = smr_model_lists(m, smr_radius_near(m, 0, smr_le32(m->n_radii) - 1u, wanted));
    l->schedule.n_active = s->shared.n;
    l->shape = s->shape;
    l->shape.rest_pose_due = 1;
    l->sums = s->sums;
    l->part = (float *)s->sums.sum;
    return SMR_OK;
}

smr_status smr_get_local_volume(smr *s, uint32_t structure, float radius_mm, float *ratio)
{
    smr_job job;
    return smr_job_whole(smr_local_volume_begin(s, structure, radius_mm, ratio, &job), &job, NULL);
}
