/* register_distances.c: measures the distances between results and targets in both directions, for each structure and
 * for all.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "register/register_job.h"

/* A target, and the surface of all structures that are registered to it. */
typedef struct pair {
    const host_target *target;
    smr_surface *result;
    void *memory;   /* memory of `result`; owned */
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

static void build_result(void *arg, uint32_t task, uint32_t worker)
{
    pair *const p = (pair *)arg + task;
    host_mesh whole;
    uint32_t i = 0;
    int result = 0;
    (void)worker;
    memset(&whole, 0, sizeof whole);
    for (i = 0; result == 0 && i < p->job->model.n_parts; i++)
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
    uint32_t i = 0, n = 0;
    for (i = 0; i < job->model.n_parts; i++) {
        const host_result *const result = &job->result[i];
        if (!is_compared(job, i) || job->target[result->target].surface == NULL)
            continue;
        query[n].surface = job->target[result->target].surface;
        query[n++].mesh = host_mesh_view(&result->mesh);
    }
    for (i = 0; i < n_pairs; i++) {
        query[n + i].surface = pairs[i].result;
        query[n + i].mesh = host_mesh_view(&pairs[i].target->mesh);
    }
    return n;
}

/* Flags the vertices that the targets show. 0 where the library says nothing of them. */
static int find_seen(const host_job *job, room *r)
{
    unsigned char *at = r->flags;
    uint32_t i = 0, q = 0;
    for (i = 0; i < job->model.n_parts; i++) {
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
static uint32_t list_summaries(host_job *job, const room *r, uint32_t n_pairs)
{
    const int overlaps = !job->options->image_target;
    const host_query *const query = r->query;
    summary *const list = r->list;
    uint32_t i = 0, q = 0, n = 3;
    for (i = 0; i < job->model.n_parts; i++)
        if (is_compared(job, i) && job->target[job->result[i].target].surface != NULL) {
            host_result *const of = &job->result[i];
            list[n++] = (summary){&query[q], 1, NULL, &of->area.to_target, &of->vertices.to_target, 0};
            if (overlaps)
                list[n++] = (summary){&query[q], 1, &r->seen[q], &of->overlap, NULL, 0};
            q++;
        }
    /* all structures and all targets: the longest tasks first */
    list[0] = (summary){query, q, NULL, &job->area.to_target, &job->vertices.to_target, 0};
    list[1] = (summary){query + q, n_pairs, NULL, &job->area.to_result, &job->vertices.to_result, 0};
    list[2] = (summary){query, overlaps ? q : 0, r->seen, &job->overlap, NULL, 0};
    for (i = 0; i < n_pairs; i++) {
        host_result *const of = &job->result[r->pairs[i].target->user];
        if (r->pairs[i].target->users == 1)
            list[n++] = (summary){&query[q + i], 1, NULL, &of->area.to_result, &of->vertices.to_result, 0};
    }
    return n;
}

static int measure(host_job *job, room *r)
{
    pair *const pairs = r->pairs;
    host_query *const query = r->query;
    summary *const list = r->list;
    uint32_t i = 0, n_pairs = 0, n = 0;
    int failed = 0;
    for (i = 0; i < job->n_targets; i++)
        if (job->target[i].users > 0)
            pairs[n_pairs++] = (pair){&job->target[i], NULL, NULL, i, job};
    host_parallel(&job->port.port, build_result, pairs, n_pairs);
    for (i = 0; i < n_pairs; i++)
        failed |= pairs[i].result == NULL;
    if (!failed)
        n = make_queries(job, pairs, n_pairs, query) + n_pairs;
    failed =
        failed || host_distances(&job->port.port, query, n) != 0 || (!job->options->image_target && !find_seen(job, r));
    if (!failed) {
        n = list_summaries(job, r, n_pairs);
        host_parallel(&job->port.port, make_summary, list, n);
        for (i = 0; i < n; i++)
            failed |= list[i].failed;
    }
    for (i = 0; i < n_pairs; i++)
        free(pairs[i].memory);
    return failed ? -1 : 0;
}

int host_job_distances(host_job *job)
{
    const size_t most = (size_t)job->n_targets + job->model.n_parts;
    size_t n = 1;
    uint32_t i = 0;
    room r;
    int result = -1;
    for (i = 0; i < job->model.n_parts; i++)
        n += job->result[i].mesh.n_vertices;
    r.pairs = calloc(job->n_targets, sizeof *r.pairs);
    r.query = calloc(most, sizeof *r.query);
    r.list = calloc(most + job->model.n_parts + 3u, sizeof *r.list);
    r.flags = calloc(n, 1);
    r.seen = calloc(most, sizeof *r.seen);
    if (r.pairs != NULL && r.query != NULL && r.list != NULL && r.flags != NULL && r.seen != NULL)
        result = measure(job, &r);
    host_queries_free(r.query, (uint32_t)most);
    free(r.pairs);
    free(r.query);
    free(r.list);
    free(r.flags);
    free((void *)r.seen);
    return result;
}
