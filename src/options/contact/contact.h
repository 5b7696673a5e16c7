/* contact.h: capability: structures that keep apart, keep their volumes, and stay smooth. In: positions, the ways to
 * goals, the moving triangles. Out: for each vertex what it touches and what is added to its force so that it does not
 * go in; positions under way that keep each closed structure's volume; a pull to the height over mesh neighbours that
 * the rest shape has.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CONTACT_H
#define SMR_CONTACT_H

#include "geometry/surface/surface.h"
#include "registration/shape/enclosed_volume.h"
#include "registration/shape/overlaid_memory.h"

#ifdef SMR_WITHOUT_CONTACT
#define SMR_HAS_CONTACT 0
#else
#define SMR_HAS_CONTACT 1
#endif

/* ---- contact ---- */

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

/* 1: structures are kept apart in some iterations. */
static inline int smr_contact_used(const smr_contact *c) { return SMR_HAS_CONTACT && c->touch != NULL; }

/* 1 where structures are kept apart in this iteration. Where clusters hold several structures the pushes of both sides
 * cancel in them. */
static inline int smr_contact_on(const smr_contact *c)
{
    return smr_contact_used(c) && c->pace->repairing == 0u &&
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

/* contact_settle.c: positions under way, kept out of what they touch, at the last radius. The stage is smr_contact. */
uint32_t smr_contact_settle_tasks(const void *contact);
void smr_contact_settle(void *contact, uint32_t task, uint32_t worker); /* serial */

/* ---- volumes ---- */

#define SMR_ASKED_LEAST 0.1f
#define SMR_ASKED_MOST 10.0f

/* One structure. Ratios are volume over rest_mm3. */
typedef struct smr_held_volume {
    uint32_t closed; /* 1: it encloses a volume, and this is led. Otherwise the rest is not looked at */
    float model_mm3; /* of the rest shape */
    float rest_mm3;  /* of the rest shape in the scale of the start; negative where triangles look inwards */
    float model_thick_mm, thick_mm; /* half its thickness, in the mean: volume over area; and in that scale */
    float ratio;                    /* the caller's. Written by setup/volume_ratio.c */
    float begun;                    /* the same, when the iteration under way began */
    float now;        /* asked in the iteration under way: goes from the start's to the caller's by steps */
    float way_mm;     /* each vertex goes so far along its normal */
    smr_vec amid;     /* its cones start there */
    smr_enclosed sum; /* so far */
} smr_held_volume;

typedef struct smr_volumes {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape; /* x_next is changed */
    const uint32_t *sum;    /* [n][SMR_WORDS]: the next normals lie there */
    smr_held_volume *held;  /* [n_structures]; NULL: config.contact.volume is 0 */
} smr_volumes;

/* 1: volumes are led. */
static inline int smr_volumes_used(const smr_volumes *v) { return SMR_HAS_CONTACT && v->held != NULL; }

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared);
void smr_volumes_wire(smr_volumes *v, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                      const smr_overlay *overlay);
void smr_volumes_model(smr_volumes *v); /* what follows from the model alone; ratios are 1 */
void smr_volumes_scale(smr_volumes *v); /* and from the start positions, which are new or were restored */
void smr_volumes_start(smr_volumes *v); /* the same, and the present volumes are where the way to the ratios begins */
void smr_volumes_begin(smr_volumes *v); /* an iteration begins */
int smr_volumes_under_way(const smr_volumes *v); /* 1: some volume has not come to what is asked for */
void smr_volumes_stand(smr_volumes *v);          /* it stands: a step towards what was asked when it began */

/* Step: sums over triangles, then positions. Serial. */
uint32_t smr_volume_tasks(const void *volumes);
void smr_volume_lead(void *volumes, uint32_t task, uint32_t worker);

/* ---- smoothing on the surface, an internal force (paper 2.3, other forces) ---- */

typedef struct smr_smooth {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    smr_rings rings; /* sums over the mesh neighbours' positions */
    float side;      /* of the heights in the start: -1 where it is mirrored */
    float *height; /* [n] mm at rest: of the middle of its mesh neighbours over a vertex, along its normal; NULL: off */
} smr_smooth;

/* 1: the surface is smoothed. */
static inline int smr_smooth_used(const smr_smooth *s) { return SMR_HAS_CONTACT && s->height != NULL; }

void smr_smooth_layout(smr_arena *a, smr_smooth *s, const smr_shared *shared);
void smr_smooth_wire(smr_smooth *s, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                     const smr_rings *rings);
void smr_smooth_rest(smr_smooth *s); /* notes the heights; the shape is the rest shape */

void smr_smooth_start(smr_smooth *s); /* positions start anew, or were restored */

/* Step: sums over mesh neighbours. Serial. */
uint32_t smr_smooth_tasks(const void *smooth);
void smr_smooth_sum(void *smooth, uint32_t task, uint32_t worker);

/* Blends a way to a goal with what smoothing asks for, where the step has tasks. */
smr_vec smr_smooth_blend(const smr_smooth *s, uint32_t v, smr_vec way);

#endif
