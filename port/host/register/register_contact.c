/* register_contact.c: reads and sets fixed surfaces; measures how result surfaces touch and overlap.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_names.h"
#include "register/register_job.h"

#define MOST_MM 2.0f /* deeper is more than what folds and large triangles keep back */

int host_job_load_fixed(host_job *job, host_error *error)
{
    const host_files *const files = &job->options->contact_with;
    host_contacts *const c = &job->contacts;
    int result = 0;
    error->file = "--contact";
    if (job->options->contact && files->n == 0 && job->model.n_parts == 1)
        return host_fail(error, "option", "a model of several structures, or --contact-with beside it");
    error->file = "--contact-with";
    host_load *load = calloc(files->n + 1u, sizeof *load);
    c->fixed = calloc(files->n + 1u, sizeof *c->fixed);
    if (load == NULL || c->fixed == NULL)
        result = host_fail(error, "start", "free memory");
    for (uint32_t i = 0; result == 0 && i < files->n; i++)
        load[i] = (host_load){.path = files->path[i], .need = HOST_MESH_SURFACE, .mirror = job->options->mirror_target};
    if (result == 0 && files->n > 0)
        result = host_load_all(&job->port.port, load, files->n, error);
    for (uint32_t i = 0; result == 0 && i < files->n; i++) {
        host_target *const fixed = &c->fixed[c->n_fixed++];
        fixed->path = load[i].path;
        fixed->mesh = load[i].mesh;
        (void)host_base_name(fixed->path, fixed->name, sizeof fixed->name);
        if (host_is_inside_out(&fixed->mesh)) {
            error->file = fixed->path;
            result = host_fail(error, "faces", "normals that point outwards, this closed surface is inside out");
        }
        const smr_mesh view = host_mesh_view(&fixed->mesh);
        fixed->surface = host_surface_make(&view, &fixed->memory);
        error->file = fixed->path;
        memset(&load[i].mesh, 0, sizeof load[i].mesh);
        if (fixed->surface == NULL)
            result = host_fail(error, "surface", "a surface within the library's limits and free memory for it");
    }
    for (uint32_t i = 0; load != NULL && i < files->n; i++)
        host_mesh_free(&load[i].mesh);
    free(load);
    return result;
}

smr_status host_job_set_fixed(host_job *job)
{
    smr_status status = SMR_OK;
    for (uint32_t i = 0; status == SMR_OK && i < job->contacts.n_fixed; i++)
        status = smr_set_fixed(job->state, i, job->contacts.fixed[i].surface);
    return status;
}

/* A surface with its box: a structure's result, or a fixed one. */
typedef struct body {
    const host_mesh *mesh;
    const smr_surface *surface; /* NULL: no triangles */
    host_result *result;        /* NULL for a fixed one */
    host_box box;
    int failed;
} body;

/* Tasks of two parallel loops: a surface, a pair. */
typedef struct bodies {
    const host_job *job;
    body *body;
    host_contact_pair *pair;
    uint32_t n_parts; /* bodies that are structures */
} bodies;

static void build_body(void *arg, uint32_t task, uint32_t worker)
{
    body *const b = (body *)arg + task;
    const smr_mesh view = host_mesh_view(b->mesh);
    (void)worker;
    host_box_add(&b->box, view.xyz, view.n_vertices);
    if (b->surface != NULL || view.n_triangles == 0)
        return;
    b->surface = host_result_surface(b->result);
    b->failed = b->surface == NULL;
}

/* A fixed surface that lies so much deeper in a structure than it cuts the structure's own surface is there by design:
 * what both have in common says nothing. */
#define INSIDE_MM 2.0f

/* How far two surfaces cut each other's walls: a tip that went through one lies deep in it, and that counts; what lies
 * wholly in the other does not. */
static float cut(const smr_surface *a, const smr_surface *b)
{
    smr_contact_report ab = {0, 0, 0, 0}, ba = {0, 0, 0, 0};
    (void)smr_surface_contact(a, b, 0.0f, &ab);
    (void)smr_surface_contact(b, a, 0.0f, &ba);
    return fminf(ab.a_in_b_mm, ba.a_in_b_mm);
}

#define NESTED_CUT 0.1f /* of the depth: a wall that is cut by less is not */

/* 1 where one of two structures lies in the other at rest, as marrow in a bone. */
static int is_nested(const host_job *job, const host_contact_pair *p)
{
    void *memory[2] = {NULL, NULL};
    const smr_mesh a = host_mesh_view(&job->model.part[p->a].mesh), b = host_mesh_view(&job->model.part[p->b].mesh);
    const smr_surface *const one = host_surface_make(&a, &memory[0]), *const other = host_surface_make(&b, &memory[1]);
    smr_contact_report r = {0, 0, 0, 0};
    if (one != NULL && other != NULL)
        (void)smr_surface_contact(one, other, 0.0f, &r);
    const int nested = r.deepest_mm > HOST_CONTACT_MM && cut(one, other) < NESTED_CUT * r.deepest_mm;
    free(memory[0]);
    free(memory[1]);
    return nested;
}

/* How deep the surface that a structure is registered to lies in a fixed one; 0 of an open one. */
static float asked(const host_job *job, uint32_t part, const smr_surface *fixed)
{
    const uint32_t target = job->result[part].target;
    smr_contact_report r = {0, 0, 0, 0};
    if (!job->options->image_target && target != HOST_NO_TARGET && job->target[target].surface != NULL)
        (void)smr_surface_contact(job->target[target].surface, fixed, 0.0f, &r);
    return r.a_in_b_mm;
}

static void measure_pair(void *arg, uint32_t task, uint32_t worker)
{
    const bodies *const all = arg;
    host_contact_pair *const pair = &all->pair[task];
    smr_contact_report *const r = &pair->report;
    (void)worker;
    (void)smr_surface_contact(all->body[pair->a].surface, all->body[pair->b].surface, HOST_CONTACT_MM, r);
    if (pair->b < all->n_parts) {
        const int nested = r->deepest_mm > host_contact_bound(all->job) && is_nested(all->job, pair);
        pair->left_mm = nested ? cut(all->body[pair->a].surface, all->body[pair->b].surface) : r->deepest_mm;
        return;
    }
    if (r->deepest_mm > r->a_in_b_mm + INSIDE_MM)
        r->volume_mm3 = r->area_mm2 = 0.0f;
    pair->left_mm = r->deepest_mm = r->a_in_b_mm; /* how far it cuts the surface */
    pair->asked_mm = asked(all->job, pair->a, all->body[pair->b].surface);
}

static int near(const body *a, const body *b)
{
    int apart = a->surface == NULL || b->surface == NULL;
    for (int c = 0; c < 3; c++)
        apart |= a->box.low[c] > b->box.high[c] + HOST_CONTACT_MM || b->box.low[c] > a->box.high[c] + HOST_CONTACT_MM;
    return !apart;
}

/* Pairs whose boxes meet; two fixed surfaces are none. */
static uint32_t list_pairs(const host_job *job, const body *list, host_contact_pair *pair)
{
    const uint32_t n_parts = job->model.n_parts, n_all = n_parts + job->contacts.n_fixed;
    uint32_t n = 0;
    for (uint32_t a = 0; a < n_parts; a++)
        for (uint32_t b = a + 1u; b < n_all; b++)
            if (near(&list[a], &list[b])) {
                if (pair != NULL)
                    pair[n] = (host_contact_pair){a, b, {0, 0, 0, 0}, 0, 0};
                n++;
            }
    return n;
}

static int measure(host_job *job, body *list)
{
    host_contacts *const c = &job->contacts;
    const uint32_t n_all = job->model.n_parts + c->n_fixed;
    uint32_t n = 0, kept = 0;
    for (uint32_t i = 0; i < n_all; i++) {
        const int moves = i < job->model.n_parts;
        list[i].mesh = moves ? &job->result[i].mesh : &c->fixed[i - job->model.n_parts].mesh;
        list[i].result = moves ? &job->result[i] : NULL;
        list[i].surface = moves ? NULL : c->fixed[i - job->model.n_parts].surface;
    }
    if (n_all > 1u) /* one body touches nothing */
        host_parallel(&job->port.port, build_body, list, n_all);
    for (uint32_t i = 0; i < n_all; i++)
        if (list[i].failed)
            return -1;
    n = list_pairs(job, list, NULL);
    free(c->pair);
    c->pair = calloc(n + 1u, sizeof *c->pair);
    if (c->pair == NULL)
        return -1;
    (void)list_pairs(job, list, c->pair);
    host_parallel(&job->port.port, measure_pair, &(bodies){job, list, c->pair, job->model.n_parts}, n);
    for (uint32_t i = 0; i < n; i++)
        if (c->pair[i].report.area_mm2 > 0.0f || c->pair[i].report.deepest_mm > 0.0f || c->pair[i].asked_mm > 0.0f)
            c->pair[kept++] = c->pair[i];
    c->n_pairs = kept;
    c->measured = 1;
    return 0;
}

int host_job_measure_contact(host_job *job, host_error *error)
{
    const uint32_t n_all = job->model.n_parts + job->contacts.n_fixed;
    body *const list = calloc(n_all + 1u, sizeof *list);
    const int result = list == NULL ? -1 : measure(job, list);
    free(list);
    error->file = "register";
    return result == 0 ? 0 : host_fail(error, "result", "surfaces that can be measured, and free memory for it");
}

int host_job_contact_left(host_job *job, float *left_mm, host_error *error)
{
    *left_mm = 0.0f;
    if (!(job->course.config.contact.share > 0.0f))
        return 0;
    if (host_job_copy_results(job, error) != 0 || host_job_measure_contact(job, error) != 0)
        return -1;
    for (uint32_t i = 0; i < job->contacts.n_pairs; i++)
        if (job->contacts.pair[i].left_mm > host_contact_bound(job))
            *left_mm = fmaxf(*left_mm, job->contacts.pair[i].left_mm);
    return 0;
}

float host_contact_bound(const host_job *job)
{
    if (!(job->course.config.contact.share > 0.0f))
        return INFINITY;
    return fmaxf(MOST_MM - job->options->config.contact.gap_mm, HOST_CONTACT_MM);
}

const char *host_contact_name(const host_job *job, uint32_t i)
{
    return i < job->model.n_parts ? job->model.part[i].name : job->contacts.fixed[i - job->model.n_parts].name;
}

void host_contacts_free(host_contacts *c)
{
    for (uint32_t i = 0; c->fixed != NULL && i < c->n_fixed; i++) {
        host_mesh_free(&c->fixed[i].mesh);
        free(c->fixed[i].memory);
    }
    free(c->fixed);
    free(c->pair);
}
