/* contact.h: capability: structures that keep apart, keep their volumes, and stay smooth. In: positions, displacements
 * to goals, moving triangles. Out: each vertex' contacts, and the displacement that its force needs to end penetration;
 * next positions that keep each closed structure's volume; displacements towards the rest shape's curvature.
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

#define SMR_TOUCHES 2u        /* most surfaces that a vertex can touch at one time; the deepest are kept */
#define SMR_CONTACT_CHUNK 16u /* vertices of a task */

/* A contact: a surface near a vertex. */
typedef struct smr_touch {
    uint32_t body;     /* a structure, or number of structures + number of a fixed surface; SMR_NONE: no contact */
    uint32_t triangle; /* touched triangle of the body */
    float weight[3];   /* barycentric weights of the triangle's closest point */
    float out[3];      /* unit vector that points out of the body */
    float mm;          /* distance to the body, mm; negative inside */
    float share;       /* 0..1: weight of the contact */
} smr_touch;

/* A fixed surface, as it was set. */
typedef struct smr_fixed_surface {
    const smr_surface *surface;   /* NULL: no surface is set */
    uint32_t n_vertices, changes; /* vertices and change counter of the surface when it was set */
} smr_fixed_surface;

typedef struct smr_contact {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const float *moved_mm;     /* largest displacement of the last iteration, mm */
    smr_fixed_surface *fixed;  /* [config.contact.n_fixed]; the arrays below are NULL when config.contact.share is 0 */
    smr_box *box;              /* [n_bodies] box of each body when the iteration began, mm */
    uint8_t *closed;           /* [n_structures] 1: the structure is closed and its triangles face outwards */
    smr_touch *touch;          /* [n][SMR_TOUCHES] contacts of each vertex in the current iteration */
    smr_touch *triangle_touch; /* [n_triangles] contacts of triangles' centres, in iterations with triangles_due 1 */
    uint32_t triangles_due;    /* 1: this iteration also tests triangles' centres */
    float *push;               /* [n][3] displacement that is added to the force, mm */
    float *reach;      /* [n] lower bound on the distance to bodies, mm, of the last complete forces; < 0: inside */
    float *reach_next; /* [n] lower bound on the distance to bodies, mm, of the current forces */
} smr_contact;

void smr_contact_layout(smr_arena *a, smr_contact *c, const smr_shared *shared);
void smr_contact_model(smr_contact *c);  /* finds which structures are closed */
void smr_contact_reset(smr_contact *c);  /* sets all distance bounds to unknown */
void smr_contact_begin(smr_contact *c);  /* called when an iteration begins: computes the boxes of the bodies */
void smr_contact_commit(smr_contact *c); /* called when the current forces are complete: keeps the distance bounds */
void smr_contact_fix(smr_contact *c, uint32_t index, const smr_surface *surface); /* sets or removes (NULL) a surface */
int smr_fixed_valid(const smr_contact *c); /* 1: no fixed surface has changed since it was set */

static inline int smr_contact_used(const smr_contact *c) { return SMR_HAS_CONTACT && c->touch != NULL; }

/* Returns 1 when contacts act in this iteration: not with clusters of several structures, which would cancel them. */
static inline int smr_contact_on(const smr_contact *c)
{
    return smr_contact_used(c) && c->schedule->repairing == 0u &&
           (c->shared->n_structures == 1u || smr_at_last_radius(c->shared, c->schedule) ||
            smr_model_separate(c->shared->model, c->schedule->radius));
}

void smr_contact_find(smr_contact *c, uint32_t v);                 /* finds the contacts of a vertex */
void smr_contact_find_triangle(smr_contact *c, uint32_t triangle); /* finds the contact of a triangle's centre */

/* Returns v's share, mm, of the displacement that ends penetration when all vertices have moved by `displaced`. */
typedef smr_vec (*smr_displacement)(const void *ctx, uint32_t v);
smr_vec smr_contact_displacement(const smr_contact *c, uint32_t v, smr_displacement displaced, const void *ctx);

/* Step: projects the next positions out of contacts, at the last radius. Tasks run one after the other. */
smr_count_tasks smr_contact_project_tasks;
smr_run_task smr_contact_project;

/* ---- volumes ---- */

#define SMR_VOLUME_RATIO_LEAST 0.1f /* smallest ratio that the caller may set */
#define SMR_VOLUME_RATIO_MOST 10.0f /* largest ratio that the caller may set */

/* The volume of one structure. A ratio is a volume divided by rest_mm3. */
typedef struct smr_kept_volume {
    uint32_t closed; /* 1: the structure is closed and its volume is corrected; 0: the other fields are not used */
    float model_mm3; /* volume of the rest shape, mm^3 */
    float rest_mm3;  /* volume of the rest shape in the scale of the start, mm^3; negative: triangles face inwards */
    float model_thick_mm;  /* volume divided by area (half the mean thickness) of the rest shape, mm */
    float thick_mm;        /* model_thick_mm in the scale of the start, mm */
    float ratio;           /* the ratio that the caller wants (smr_set_volume_ratio) */
    float ratio_at_begin;  /* the caller's ratio when the current iteration began */
    float now;             /* ratio of the current iteration: goes in steps from that of the start to the caller's */
    float displacement_mm; /* displacement of each vertex along its normal, mm */
    smr_vec apex;          /* common apex of the cones over the triangles, whose volumes are summed, mm */
    smr_enclosed sum;      /* sum of the cones so far */
} smr_kept_volume;

typedef struct smr_volumes {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape; /* steps change x_next of the shape */
    const uint32_t *sum;    /* [n][SMR_WORDS] sums, which hold the next normals */
    smr_kept_volume *kept;  /* [n_structures]; NULL: config.contact.volume is 0 */
} smr_volumes;

static inline int smr_volumes_used(const smr_volumes *v) { return SMR_HAS_CONTACT && v->kept != NULL; }

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared);
void smr_volumes_model(smr_volumes *v);        /* computes volumes at rest; sets ratios to 1 */
void smr_volumes_scale(smr_volumes *v);        /* scales volumes at rest to the start positions */
void smr_volumes_start(smr_volumes *v);        /* scales, and starts steps to the ratios at the present volumes */
void smr_volumes_begin(smr_volumes *v);        /* when an iteration begins: takes the caller's ratios */
int smr_volumes_pending(const smr_volumes *v); /* 1: some volume has not reached its ratio */
void smr_volumes_commit(smr_volumes *v);       /* called when an iteration is complete: steps towards the ratios */

/* Step: sums over triangles, then positions. Tasks run one after the other. */
smr_count_tasks smr_volume_tasks;
smr_run_task smr_volume_correct;

/* ---- smoothing on the surface, an internal force (paper 2.3, other forces) ---- */

typedef struct smr_smooth {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_rings rings; /* sums of the mesh neighbours' positions */
    float side;      /* sign of the heights in the start pose: -1 when it is mirrored */
    float *height;   /* [n] height of the mesh neighbours' mean above each vertex at rest, mm; NULL: smoothing is off */
} smr_smooth;

void smr_smooth_layout(smr_arena *a, smr_smooth *s, const smr_shared *shared);
void smr_smooth_rest(smr_smooth *s);  /* computes the heights; positions are those of the rest shape */
void smr_smooth_start(smr_smooth *s); /* for a new start or restored positions: sets `side` */

/* Step: sums over mesh neighbours. Tasks run one after the other. */
smr_count_tasks smr_smooth_tasks;
smr_run_task smr_smooth_sum;

/* Returns the mean of the displacement of v to its goal and its smoothing displacement, mm, when the step has run. */
smr_vec smr_smooth_blend(const smr_smooth *s, uint32_t v, smr_vec displacement);

#endif
