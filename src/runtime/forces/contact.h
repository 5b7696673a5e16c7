/* contact.h: keeps structures out of each other and out of fixed surfaces. In: positions, the ways to goals, the moving
 * triangles. Out: for each vertex what it touches, and what is added to its force so that it does not go in.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CONTACT_H
#define SMR_CONTACT_H

#include "geometry/surface.h"
#include "runtime/deformed/shape.h"

#define SMR_TOUCHES 2u        /* surfaces that a vertex touches at one time; of more the deepest */
#define SMR_CONTACT_CHUNK 16u /* vertices of a task */

/* A surface near a vertex. */
typedef struct smr_touch {
    uint32_t body;     /* a structure, or the number of structures + a fixed surface; SMR_NONE: nothing is touched */
    uint32_t triangle; /* of it, with the closest point at these weights */
    float weight[3];
    float out[3]; /* unit: the way out */
    float mm;     /* distance, negative inside */
    float share;  /* 0..1: how far the touch counts */
} smr_touch;

/* A surface that does not move. Written by setup/fixed.c. */
typedef struct smr_fixed_surface {
    const smr_surface *surface;   /* NULL: none */
    uint32_t n_vertices, changes; /* when it was set */
} smr_fixed_surface;

typedef struct smr_contact {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    const float *moved_mm;    /* largest displacement of the last iteration */
    smr_fixed_surface *fixed; /* [config.contact.n_fixed] */
    /* NULL: config.contact.share is 0 */
    float *box;          /* [n_bodies][6] lowest and highest corner, mm from the shape's origin; of structures where
                           an iteration begins */
    uint8_t *closed;     /* [n_structures] 1: it has an inside, which its triangles look away from */
    smr_touch *touch;    /* [n][SMR_TOUCHES] of the iteration under way */
    smr_touch *facet;    /* [n_triangles] of their centres, where facets are due */
    uint32_t facets_due; /* 1: in this iteration */
    float *push;         /* [n][3] mm: added to the force */
    float *reach;        /* [n] mm, of the last complete forces. Above 0: no surface is nearer; else how deep inside */
    float *reach_next;   /* [n] the same, of those under way */
} smr_contact;

void smr_contact_layout(smr_arena *a, smr_contact *c, const smr_shared *shared);
void smr_contact_wire(smr_contact *c, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape);
void smr_contact_model(smr_contact *c); /* what follows from the model alone */
void smr_contact_reset(smr_contact *c); /* nothing is known of any distance */
void smr_contact_begin(smr_contact *c); /* an iteration begins */
void smr_contact_stand(smr_contact *c); /* the forces under way are complete */
/* A fixed surface comes, or goes (NULL): nothing is known of any distance. */
void smr_contact_fix(smr_contact *c, uint32_t index, const smr_surface *surface);
int smr_fixed_stand(const smr_contact *c); /* 1: every fixed surface is still the one that was set */

/* 1 where structures are kept apart in this iteration. Where clusters hold several structures the pushes of both sides
 * cancel in them. */
static inline int smr_contact_on(const smr_contact *c)
{
    return c->touch != NULL && c->pace->repairing == 0u &&
           (c->shared->n_structures == 1u || smr_at_last_radius(c->shared, c->pace) ||
            smr_model_separate(c->shared->model, c->pace->radius));
}

/* What a vertex touches at its present place, and the centre of a triangle, in the iterations in which they are due. */
void smr_contact_find(smr_contact *c, uint32_t v);
void smr_contact_find_facet(smr_contact *c, uint32_t triangle);

/* The stored vertices of the triangle that is touched; NULL: it is of a fixed surface. */
const uint32_t *smr_touch_corners(const smr_contact *c, const smr_touch *touch);

/* What is missing of v's own share so that it keeps off what it touches, when all vertices are displaced so. */
typedef smr_vec (*smr_displacement)(const void *ctx, uint32_t v);
smr_vec smr_contact_way(const smr_contact *c, uint32_t v, smr_displacement displaced, const void *ctx);

#endif
