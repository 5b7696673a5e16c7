/* contact_settle.c: keeps positions under way out of what they touch, at the last radius. Forces pass through clusters,
 * which average what single vertices ask; and a vertex in the middle of a triangle asks nothing of the triangle's
 * corners. Here the vertex and the corners go the way that is still missing, by mass and by the corners' weights, so
 * that together they neither move nor turn. One touch after the other, a few times over, for one may undo another.
 * Folds are watched for afterwards.
 * Source: Mueller et al., "Position based dynamics", 2006. Bounds: SMR_SETTLE_PASSES passes over the vertices.
 * SPDX-License-Identifier: MIT */
#include "options/contact/contact.h"

#define SMR_SETTLE_PASSES 3u

static uint32_t facet_tasks(const smr_contact *c)
{
    return c->facets_due ? smr_ceil_div(c->shared->n_triangles, SMR_TRIANGLE_CHUNK) : 0u;
}

uint32_t smr_contact_settle_tasks(const void *arg)
{
    const smr_contact *c = arg;
    if (!smr_contact_on(c) || !smr_at_last_radius(c->shared, c->pace))
        return 0;
    return SMR_SETTLE_PASSES * (smr_active_tasks(c->pace) + facet_tasks(c));
}

/* A point of a surface: a vertex, or one of a triangle, by weights of vertices. */
typedef struct place {
    uint32_t n, vertex[3];
    float weight[3];
} place;

/* How far a place is displaced so far, along out; adds to sum how easily it moves. */
static float gone(const smr_contact *c, const place *p, smr_vec out, float *sum)
{
    float way = 0.0f;
    for (uint32_t k = 0; k < p->n; k++) {
        const uint32_t v = p->vertex[k];
        const smr_vec step = smr_sub(smr_load(smr_at3(c->shape->x_next, v)), smr_load(smr_at3(c->shape->x, v)));
        way += p->weight[k] * smr_dot(out, step);
        *sum += p->weight[k] * p->weight[k] / smr_mass(c->shared, v);
    }
    return way;
}

static void move(const smr_contact *c, const place *p, smr_vec out, float mm)
{
    for (uint32_t k = 0; k < p->n; k++) {
        float *x = smr_at3(c->shape->x_next, p->vertex[k]);
        const float share = p->weight[k] / smr_mass(c->shared, p->vertex[k]);
        smr_store(x, smr_add(smr_load(x), smr_scale(out, mm * share)));
    }
}

static void part(const smr_contact *c, const place *p, const smr_touch *touch)
{
    const uint32_t *t = smr_touch_corners(c, touch);
    const smr_vec out = smr_load(touch->out);
    place other = {0, {0, 0, 0}, {touch->weight[0], touch->weight[1], touch->weight[2]}};
    float sum = 0.0f;
    if (t != NULL) { /* what is fixed does not move */
        other.n = 3;
        memcpy(other.vertex, t, sizeof other.vertex);
    }
    const float apart = gone(c, p, out, &sum) - gone(c, &other, out, &sum);
    const float missing = c->shared->config.contact.gap_mm - touch->mm - apart;
    if (!(missing > 0.0f && sum > 0.0f))
        return;
    const float way = missing * touch->share * c->shared->config.contact.share / sum;
    move(c, p, out, way);
    move(c, &other, out, -way);
}

static void part_vertices(const smr_contact *c, uint32_t chunk)
{
    for (uint32_t v = chunk * SMR_CHUNK; v < smr_active_end(c->pace, chunk); v++) {
        const smr_touch *touch = c->touch + SMR_TOUCHES * (size_t)v;
        const place p = {1, {v, 0, 0}, {1, 0, 0}};
        for (uint32_t i = 0; i < SMR_TOUCHES && touch[i].body != SMR_NONE; i++)
            part(c, &p, &touch[i]);
    }
}

static void part_facets(const smr_contact *c, uint32_t chunk)
{
    const uint32_t last = smr_min_u32((chunk + 1u) * SMR_TRIANGLE_CHUNK, c->shared->n_triangles);
    for (uint32_t k = chunk * SMR_TRIANGLE_CHUNK; k < last; k++) {
        const uint32_t *t = c->shared->triangle + 3u * (size_t)k;
        const place p = {3, {t[0], t[1], t[2]}, {1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f}};
        if (c->facet[k].body != SMR_NONE)
            part(c, &p, &c->facet[k]);
    }
}

void smr_contact_settle(void *arg, uint32_t task, uint32_t worker)
{
    const smr_contact *c = arg;
    const uint32_t n = facet_tasks(c), chunk = task % (n + smr_active_tasks(c->pace));
    (void)worker;
    if (chunk < n)
        part_facets(c, chunk);
    else
        part_vertices(c, chunk - n);
}
