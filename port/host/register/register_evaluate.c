/* register_evaluate.c: measures the result of a registration: distances in both directions, folds, volumes.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "register/register_job.h"

/* A target, and the surface of all structures that are registered to it. */
typedef struct pair {
    const host_target *target;
    smr_surface *result;
    void *memory;   /* memory of `result`; owned; NULL for that of one structure */
    uint32_t index; /* index of the target */
    const host_job *job;
} pair;

/* Statistics to be made of some queries: a task of a parallel loop. */
typedef struct summary {
    const host_query *query;
    uint32_t n_queries;
    const unsigned char *const *seen; /* [n_queries] flags of vertices; NULL: all count */
    host_stats *area, *vertices;      /* vertices may be NULL */
    int failed;
} summary;

/* Room for what measuring takes. */
typedef struct room {
    pair *pairs;
    host_query *query;
    summary *list;
    unsigned char *flags;       /* of all vertices: 1 where the target shows them */
    const unsigned char **seen; /* [queries] into flags */
} room;

smr_surface *host_result_surface(host_result *result)
{
    const smr_mesh view = host_mesh_view(&result->mesh);
    if (result->surface == NULL)
        result->surface = host_surface_make(&view, &result->memory);
    return result->surface;
}

void host_result_moves(host_result *result)
{
    free(result->memory);
    result->memory = NULL;
    result->surface = NULL;
}

static void build_result(void *arg, uint32_t task, uint32_t worker)
{
    pair *const p = (pair *)arg + task;
    host_mesh whole = {0};
    int result = 0;
    (void)worker;
    if (p->target->users == 1) {
        p->result = host_result_surface(&p->job->result[p->target->user]);
        return;
    }
    for (uint32_t i = 0; result == 0 && i < p->job->model.n_parts; i++)
        if (p->job->result[i].target == p->index)
            result = host_mesh_append(&whole, &p->job->result[i].mesh);
    if (result == 0) {
        const smr_mesh view = host_mesh_view(&whole);
        p->result = host_surface_make(&view, &p->memory);
    }
    host_mesh_free(&whole);
}

static void make_summary(void *arg, uint32_t task, uint32_t worker)
{
    summary *const s = (summary *)arg + task;
    (void)worker;
    s->failed = host_area_stats(s->query, s->n_queries, s->seen, s->area) != 0 ||
                (s->vertices != NULL && host_vertex_stats(s->query, s->n_queries, s->seen, s->vertices) != 0);
}

/* 1 when a structure's surface is compared with another one. */
static int is_compared(const host_job *job, uint32_t i)
{
    return job->result[i].target != HOST_NO_TARGET && job->model.part[i].mesh.n_triangles > 0;
}

/* Queries for all structures with a target, then for all targets in use. Returns how many of the former there are. */
static uint32_t make_queries(const host_job *job, const pair *pairs, uint32_t n_pairs, host_query *query)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_result *const result = &job->result[i];
        if (!is_compared(job, i) || job->target[result->target].surface == NULL)
            continue;
        query[n].surface = job->target[result->target].surface;
        query[n++].mesh = host_mesh_view(&result->mesh);
    }
    for (uint32_t i = 0; i < n_pairs; i++) {
        query[n + i].surface = pairs[i].result;
        query[n + i].mesh = host_mesh_view(&pairs[i].target->mesh);
    }
    return n;
}

/* Flags the vertices that the targets show. 0 where the library says nothing of them. */
static int find_seen(const host_job *job, room *r)
{
    unsigned char *at = r->flags;
    uint32_t q = 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        if (!is_compared(job, i))
            continue;
        if (smr_get_visible(job->state, i, at) != SMR_OK)
            return 0;
        r->seen[q++] = at;
        at += job->result[i].mesh.n_vertices;
    }
    return 1;
}

/* What is to be made of the queries, in their order. Returns how many summaries there are. */
static uint32_t list_summaries(host_job *job, const room *r, uint32_t n_queries, uint32_t n_pairs)
{
    const int overlaps = !job->options->image_target;
    const host_query *const query = r->query;
    summary *const list = r->list;
    uint32_t q = 0, n = 3;
    for (uint32_t i = 0; n_queries > 1u && i < job->model.n_parts; i++)
        if (is_compared(job, i) && job->target[job->result[i].target].surface != NULL) {
            host_result *const of = &job->result[i];
            list[n++] = (summary){&query[q], 1, NULL, &of->area.to_target, &of->vertices.to_target, 0};
            if (overlaps)
                list[n++] = (summary){&query[q], 1, &r->seen[q], &of->overlap, &of->overlap_vertices, 0};
            q++;
        }
    q = n_queries;
    /* all structures and all targets: the longest tasks first */
    list[0] = (summary){query, q, NULL, &job->area.to_target, &job->vertices.to_target, 0};
    list[1] = (summary){query + q, n_pairs, NULL, &job->area.to_result, &job->vertices.to_result, 0};
    list[2] = (summary){query, overlaps ? q : 0, r->seen, &job->overlap, &job->overlap_vertices, 0};
    for (uint32_t i = 0; n_pairs > 1u && i < n_pairs; i++) {
        host_result *const of = &job->result[r->pairs[i].target->user];
        if (r->pairs[i].target->users == 1)
            list[n++] = (summary){&query[q + i], 1, NULL, &of->area.to_result, &of->vertices.to_result, 0};
    }
    return n;
}

/* Copies the statistics of all structures, or of all targets, to a structure where there is only one. */
static void copy_single(host_job *job, const room *r, uint32_t n_queries, uint32_t n_pairs)
{
    for (uint32_t i = 0; n_queries == 1u && i < job->model.n_parts; i++)
        if (is_compared(job, i) && job->target[job->result[i].target].surface != NULL) {
            host_result *const of = &job->result[i];
            of->area.to_target = job->area.to_target;
            of->vertices.to_target = job->vertices.to_target;
            of->overlap = job->overlap;
            of->overlap_vertices = job->overlap_vertices;
        }
    if (n_pairs == 1u && r->pairs[0].target->users == 1) {
        host_result *const of = &job->result[r->pairs[0].target->user];
        of->area.to_result = job->area.to_result;
        of->vertices.to_result = job->vertices.to_result;
    }
}

static int measure_distances(host_job *job, room *r)
{
    pair *const pairs = r->pairs;
    host_query *const query = r->query;
    summary *const list = r->list;
    uint32_t n_pairs = 0, n_queries = 0, n = 0;
    int bad = 0;
    for (uint32_t i = 0; i < job->n_targets; i++)
        if (job->target[i].users > 0)
            pairs[n_pairs++] = (pair){&job->target[i], NULL, NULL, i, job};
    host_parallel(&job->port.port, build_result, pairs, n_pairs);
    for (uint32_t i = 0; i < n_pairs; i++)
        bad |= pairs[i].result == NULL;
    if (!bad)
        n_queries = make_queries(job, pairs, n_pairs, query);
    bad = bad || host_distances(&job->port.port, query, n_queries + n_pairs) != 0 ||
          (!job->options->image_target && !find_seen(job, r));
    if (!bad) {
        n = list_summaries(job, r, n_queries, n_pairs);
        host_parallel(&job->port.port, make_summary, list, n);
        for (uint32_t i = 0; i < n; i++)
            bad |= list[i].failed;
        copy_single(job, r, n_queries, n_pairs);
    }
    for (uint32_t i = 0; i < n_pairs; i++)
        free(pairs[i].memory);
    return bad ? -1 : 0;
}

static int find_distances(host_job *job)
{
    const size_t most = (size_t)job->n_targets + job->model.n_parts;
    room r;
    int result = -1;
    r.pairs = calloc(job->n_targets, sizeof *r.pairs);
    r.query = calloc(most, sizeof *r.query);
    r.list = calloc(most + job->model.n_parts + 3u, sizeof *r.list);
    r.flags = calloc((size_t)job->model.info.n_vertices + 1u, 1);
    r.seen = calloc(most, sizeof *r.seen);
    if (r.pairs != NULL && r.query != NULL && r.list != NULL && r.flags != NULL && r.seen != NULL)
        result = measure_distances(job, &r);
    host_queries_free(r.query, (uint32_t)most);
    free(r.pairs);
    free(r.query);
    free(r.list);
    free(r.flags);
    free((void *)r.seen);
    return result;
}

#define LIKENESS_LEAST 0.5f /* below, the library's verdict on an image is failed */

static int copy_result(host_job *job, uint32_t i, host_error *error)
{
    const host_mesh *const rest = &job->model.part[i].mesh;
    host_result *const result = &job->result[i];
    error->file = "register";
    host_result_moves(result);
    if (result->mesh.xyz == NULL && host_mesh_append(&result->mesh, rest) != 0)
        return host_fail_at(error, "structure", i, "free memory");
    if (smr_get_positions(job->state, i, result->mesh.xyz) != SMR_OK ||
        smr_get_structure_report(job->state, i, &result->report) != SMR_OK)
        return host_fail_at(error, "structure", i, "positions from the library");
    return 0;
}

/* Tasks of one parallel loop: the folds of a structure. */
static void count_folds(void *arg, uint32_t task, uint32_t worker)
{
    host_job *const job = arg;
    host_result *const result = &job->result[task];
    const smr_mesh view = host_mesh_view(&result->mesh);
    (void)worker;
    if (host_count_folds(&view, job->model.part[task].mesh.xyz, &result->folds) != 0)
        result->folds.all = UINT64_MAX;
}

/* Distances between vertices with the same index, for structures whose truth has as many vertices. */
static int measure_vertices(host_job *job)
{
    size_t n = 0, all = 0, k = 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        n += job->result[i].mesh.n_vertices;
    host_weighted *value = malloc((n + 1u) * sizeof *value);
    if (value == NULL)
        return -1;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        host_result *const result = &job->result[i];
        const host_mesh *const truth = result->target != HOST_NO_TARGET ? &job->target[result->target].mesh : NULL;
        if (truth == NULL || job->truth_map != NULL || truth->n_vertices != result->mesh.n_vertices)
            continue;
        for (k = 0; k < truth->n_vertices; k++) {
            const float *const a = truth->xyz + 3u * k, *const b = result->mesh.xyz + 3u * k;
            const double x = (double)a[0] - (double)b[0], y = (double)a[1] - (double)b[1];
            const double z = (double)a[2] - (double)b[2];
            value[all + k] = (host_weighted){(float)sqrt(x * x + y * y + z * z), 1.0f};
        }
        result->by_vertex = host_stats_of(value + all, k);
        all += k;
    }
    job->by_vertex = host_stats_of(value, all);
    free(value);
    return 0;
}

/* Distances to all targets, or to the truth when the target is an image. */
static int measure_all(host_job *job, host_error *error)
{
    if (job->n_targets == 0)
        return 0;
    if (job->options->image_target && host_job_make_surfaces(job, error) != 0) {
        error->file = job->options->truth; /* the target's own path is freed with the job */
        return -1;
    }
    int result = find_distances(job);
    if (result == 0 && job->options->image_target)
        result = measure_vertices(job);
    error->file = "register";
    return result == 0 ? 0 : host_fail(error, "result", "surfaces that can be measured, and free memory for it");
}

/* What the meshes of the results say, wherever they come from. */
static int measure(host_job *job, host_error *error)
{
    const double start = host_seconds();
    if (job->goals != NULL && host_landmark_goals_measure(job->goals, job->state) != SMR_OK)
        return host_fail(error, "result", "landmarks from the library");
    if (measure_all(job, error) != 0)
        return -1;
    error->file = "register";
    job->folds = (host_folds){0, 0, 0.0};
    host_parallel(&job->port.port, count_folds, job, job->model.n_parts);
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_folds *const one = &job->result[i].folds;
        if (one->all == UINT64_MAX)
            return host_fail(error, "result", "free memory");
        job->folds.n += one->n;
        job->folds.all += one->all;
        job->folds.deepest_mm = fmax(job->folds.deepest_mm, one->deepest_mm);
    }
    host_job_measure_labels(job);
    job->measure_s += host_seconds() - start;
    return 0;
}

int host_job_copy_results(host_job *job, host_error *error)
{
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        if (copy_result(job, i, error) != 0)
            return -1;
    return 0;
}

int host_job_evaluate(host_job *job, host_error *error)
{
    return host_job_copy_results(job, error) != 0 ? -1 : measure(job, error);
}

int host_job_positions(const host_job *job, float **xyz, host_error *error)
{
    size_t at = 0;
    error->file = "register";
    free(*xyz);
    *xyz = malloc((3u * (size_t)job->model.info.n_vertices + 1u) * sizeof **xyz);
    if (*xyz == NULL)
        return host_fail(error, "memory", "room for the start positions");
    for (uint32_t i = 0; i < job->model.n_parts; at += 3u * (size_t)job->model.part[i].mesh.n_vertices, i++)
        if (smr_get_positions(job->state, i, *xyz + at) != SMR_OK)
            return host_fail_at(error, "structure", i, "positions from the library");
    return 0;
}

int host_job_keep_start(host_job *job, host_error *error)
{
    const float *xyz = job->begun_xyz;
    if (xyz == NULL || (job->measures.reasons & SMR_REASON_SIMILARITY) == 0 ||
        !(job->measures.image_similarity < LIKENESS_LEAST))
        return 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const size_t n = 3u * (size_t)job->result[i].mesh.n_vertices;
        memcpy(job->result[i].mesh.xyz, xyz, n * sizeof *xyz);
        host_result_moves(&job->result[i]);
        job->result[i].report.moved_mean_mm = job->result[i].report.moved_max_mm = 0.0f;
        job->result[i].verdict.expected_error_mm = (double)NAN;
        xyz += n;
    }
    job->kept_start = 1;
    job->verdict.expected_error_mm = (double)NAN; /* it was of what is not written */
    host_verdict_add(&job->verdict, HOST_VERDICT_FAILED, "the start is written instead of what was found");
    return measure(job, error) != 0 ? -1 : host_job_measure_contact(job, error);
}
