/* contact_projection.c: projects the current positions out of contacts, at the last radius. Forces pass through
 * clusters, which average the displacements of single vertices, and a vertex inside a triangle does not push the
 * triangle's corners. Here the vertex and the corners share the missing displacement by mass and barycentric
 * weights, which keeps linear and angular momentum. Contacts are projected one after the other, several times. Folds
 * are searched for afterwards.
 * Source: Mueller et al., "Position based dynamics", 2006. Bounds: SMR_PROJECT_PASSES passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

#define SMR_PROJECT_PASSES 3u

static uint32_t triangle_tasks(const smr_contact *c)
{
    return c->triangles_due ? smr_ceil_div(c->shared->n_triangles, SMR_TRIANGLE_CHUNK) : 0u;
}

uint32_t smr_contact_project_tasks(const void *arg)
{
    const smr_contact *c = arg;
    if (!smr_contact_on(c) || !smr_at_last_radius(c->shared, c->schedule))
        return 0;
    return SMR_PROJECT_PASSES * (smr_active_tasks(c->schedule) + triangle_tasks(c));
}

/* A point of a surface: a vertex, or a point of a triangle given by weights of its corners. */
typedef struct place {
    uint32_t n, vertex[3];
    float weight[3];
} place;

/* The displacement of a point in this iteration along out, mm. Adds its inverse mass to *sum. */
static float displacement_along(const smr_contact *c, const place *p, smr_vec out, float *sum)
{
    float displacement = 0.0f;
    for (uint32_t k = 0; k < p->n; k++) {
        const uint32_t v = p->vertex[k];
        const smr_vec step = smr_sub(smr_get3(c->shape->x_next, v), smr_get3(c->shape->x, v));
        displacement += p->weight[k] * smr_dot(out, step);
        *sum += p->weight[k] * p->weight[k] / smr_mass(c->shared, v);
    }
    return displacement;
}

static void move(const smr_contact *c, const place *p, smr_vec out, float mm)
{
    for (uint32_t k = 0; k < p->n; k++) {
        float *x = smr_at3(c->shape->x_next, p->vertex[k]);
        const float share = p->weight[k] / smr_mass(c->shared, p->vertex[k]);
        smr_store(x, smr_add(smr_load(x), smr_scale(out, mm * share)));
    }
}

static void separate(const smr_contact *c, const place *p, const smr_touch *touch)
{
    const uint32_t *t = smr_touch_corners(c, touch);
    const smr_vec out = smr_load(touch->out);
    place other = {0, {0, 0, 0}, {touch->weight[0], touch->weight[1], touch->weight[2]}};
    float sum = 0.0f;
    if (t != NULL) { /* a fixed surface does not move */
        other.n = 3;
        memcpy(other.vertex, t, sizeof other.vertex);
    }
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
    for (uint32_t v = chunk * SMR_CHUNK; v < smr_active_end(c->schedule, chunk); v++) {
        const smr_touch *touch = c->touch + SMR_TOUCHES * (size_t)v;
        const place p = {1, {v, 0, 0}, {1, 0, 0}};
        for (uint32_t i = 0; i < SMR_TOUCHES && touch[i].body != SMR_NONE; i++)
            separate(c, &p, &touch[i]);
    }
}

static void separate_triangles(const smr_contact *c, uint32_t chunk)
{
    const uint32_t last = smr_min_u32((chunk + 1u) * SMR_TRIANGLE_CHUNK, c->shared->n_triangles);
    for (uint32_t k = chunk * SMR_TRIANGLE_CHUNK; k < last; k++) {
        const uint32_t *t = c->shared->triangle + 3u * (size_t)k;
        const place p = {3, {t[0], t[1], t[2]}, {1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f}};
        if (c->triangle_touch[k].body != SMR_NONE)
            separate(c, &p, &c->triangle_touch[k]);
    }
}

void smr_contact_project(void *arg, uint32_t task, uint32_t worker)
{
    const smr_contact *c = arg;
    const uint32_t n = triangle_tasks(c), chunk = task % (n + smr_active_tasks(c->schedule));
    (void)worker;
    if (chunk < n)
        separate_triangles(c, chunk);
    else
        separate_vertices(c, chunk - n);
}
