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

#define SMR_TOUCHES 2u        /* largest number of contacts of a vertex; the deepest are kept */
#define SMR_CONTACT_CHUNK 16u /* number of vertices whose contacts one task finds */

/* A contact of a vertex with a surface near it. */
typedef struct smr_touch {
    uint32_t body;     /* touched structure, or n_structures + number of a fixed surface; SMR_NONE: no contact */
    uint32_t triangle; /* touched triangle of the body */
    float weight[3];   /* barycentric weights of the point of the triangle that is closest to the vertex */
    float out[3];      /* unit vector that points out of the body */
    float mm;          /* distance from the vertex to the body, mm; negative inside */
    float share;       /* weight of the contact, 0..1 */
} smr_touch;

/* A surface that keeps its place, as the caller set it. */
typedef struct smr_fixed_surface {
    const smr_surface *surface;   /* the caller's surface; NULL: no surface is set */
    uint32_t n_vertices, changes; /* number of vertices and change counter of the surface when it was set */
    uint32_t guard, body;         /* checksums of the surface's header; of its memory, where the scrub is on */
} smr_fixed_surface;

typedef struct smr_contact {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const float *moved_mm;     /* largest displacement of the last iteration, mm */
    smr_fixed_surface *fixed;  /* [config.contact.n_fixed] surfaces that keep their places */
    smr_box *box;              /* [n_bodies] box of each structure and fixed surface when the iteration began, mm */
    uint8_t *closed;           /* [n_structures] 1: the structure is closed with triangles that face outwards */
    smr_touch *touch;          /* [n][SMR_TOUCHES] contacts of each vertex in the current iteration */
    smr_touch *triangle_touch; /* [n_triangles] contact of each triangle's centre, where triangles_due is 1 */
    uint32_t triangles_due;    /* 1: this iteration also tests triangles' centres */
    float *push;               /* [n][3] displacement that ends penetration, added to each vertex' force, mm */
    float *reach;              /* [n] lower bound on the distance to bodies, mm, by the last forces; < 0: inside */
    float *reach_next;         /* [n] lower bound on the distance to bodies, mm, by the forces under way */
} smr_contact;

void smr_contact_layout(smr_arena *a, smr_contact *c, const smr_shared *shared);
/* stores whether a structure encloses a volume at rest */
void smr_contact_model(smr_contact *c, uint32_t structure, const smr_bulk *rest);
/* discards contacts, pushes and distance bounds of a part of the vertices */
void smr_contact_reset(smr_contact *c, uint32_t part, uint32_t parts);
void smr_contact_begin(smr_contact *c);             /* when an iteration begins: computes boxes and triangles_due */
void smr_contact_keep(smr_contact *c, smr_piece p); /* when forces are complete: stores reach_next in reach */
void smr_contact_fix(smr_contact *c, uint32_t index, const smr_surface *surface); /* sets a fixed surface; NULL: none */
/* Checks that no fixed surface has changed since it was set. Errors: E_STATE; E_DAMAGED (a fault in a header). */
smr_status smr_fixed_valid(const smr_contact *c);

static inline int smr_contact_used(const smr_contact *c) { return SMR_HAS_CONTACT && c->touch != NULL; }

/* Return 1 when contacts act in this iteration: not while clusters span structures, which would cancel contacts. */
int smr_contact_acts(const smr_contact *c);
static inline int smr_contact_on(const smr_contact *c) { return smr_contact_used(c) && smr_contact_acts(c); }

/* Write the contacts of vertex v to `touch`; triangle_touch[triangle]. w->pause.kept: the same call continues. */
void smr_contact_find(smr_contact *c, uint32_t v, smr_worker *w);
void smr_contact_find_triangle(smr_contact *c, uint32_t triangle, smr_worker *w);
uint32_t smr_contact_work(const smr_contact *c); /* returns instructions at most of a point's contacts, but searches */

/* Returns v's share, mm, of the displacement that ends penetration after each vertex w moves by displaced(ctx, w). */
typedef smr_vec (*smr_displacement)(const void *ctx, uint32_t v);
smr_vec smr_contact_displacement(const smr_contact *c, uint32_t v, smr_displacement displaced, const void *ctx);

/* Step of an iteration: moves next positions out of contacts, at the last radius. Tasks run one after the other. */
smr_count_tasks smr_contact_project_tasks;
smr_run_task smr_contact_project;

/* ---- volumes ---- */

#define SMR_VOLUME_RATIO_LEAST 0.1f /* smallest ratio of volumes that the caller may set */
#define SMR_VOLUME_RATIO_MOST 10.0f /* largest ratio of volumes that the caller may set */

/* The volume that one structure keeps. A ratio is a volume divided by rest_mm3. */
typedef struct smr_kept_volume {
    uint32_t closed; /* 1: the structure is closed and its volume is corrected; 0: the other fields are not used */
    float model_mm3; /* volume of the structure in the rest shape, mm^3 */
    float rest_mm3;  /* volume of the rest shape in the scale of the start, mm^3; negative: triangles face inwards */
    float model_thick_mm;  /* volume / area of the rest shape, mm: half the mean thickness */
    float thick_mm;        /* model_thick_mm in the scale of the start, mm */
    float ratio;           /* ratio that the caller wants (smr_set_volume_ratio) */
    float ratio_at_begin;  /* ratio that the caller wanted when the current iteration began */
    float now;             /* ratio of the current iteration: goes in steps from the start's to the caller's */
    float displacement_mm; /* displacement of the structure's vertices along their normals, mm */
    smr_vec apex;          /* common apex of the cones on all triangles, whose volumes are summed, mm */
    smr_enclosed sum;      /* sum over the cones of the triangles so far */
} smr_kept_volume;

typedef struct smr_volumes {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape; /* shape whose x_next volume corrections change */
    const uint32_t *sum;    /* [n][SMR_WORDS] memory of the sums, in which the next normals lie */
    smr_kept_volume *kept;  /* [n_structures] volume of each structure; NULL: config.contact.volume is 0 */
    uint32_t pending;       /* 1: the last iteration corrected a volume to a step before the one asked for */
} smr_volumes;

static inline int smr_volumes_used(const smr_volumes *v) { return SMR_HAS_CONTACT && v->kept != NULL; }

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared);
/* Store a structure's volume at rest, with ratio 1; set rest_mm3 and thick_mm from scale and side (1, or -1: mirrored)
 * of the start; set `now` of a structure of smr_volume_asked() from its present volume. */
void smr_volumes_model(smr_volumes *v, uint32_t structure, const smr_bulk *rest);
void smr_volumes_scale(smr_volumes *v, float scale, float side);
int smr_volume_asked(const smr_volumes *v, uint32_t structure);
void smr_volumes_start(smr_volumes *v, uint32_t structure, float mm3);
void smr_volumes_begin(smr_volumes *v);        /* when an iteration begins: sets ratio_at_begin to ratio */
int smr_volumes_pending(const smr_volumes *v); /* returns 1 when a volume has not reached its ratio */
void smr_volumes_commit(smr_volumes *v);       /* after an iteration: moves `now` a step towards the caller's ratios */

/* Step: sums each structure's volume, then moves vertices to correct it. Tasks run one after the other. */
smr_count_tasks smr_volume_tasks;
smr_run_task smr_volume_correct;

/* ---- smoothing on the surface, an internal force (paper 2.3, other forces) ---- */

typedef struct smr_smooth {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_rings rings; /* sums of the positions of each vertex' mesh neighbours */
    float side;      /* factor on heights at rest: 1; -1: the start pose mirrors */
    float *height;   /* [n] height of the neighbours' mean above each vertex at rest, mm; NULL: no smoothing */
} smr_smooth;

void smr_smooth_layout(smr_arena *a, smr_smooth *s, const smr_shared *shared);
/* sets a chunk of `height` while the positions are those at rest, after all tasks of smr_smooth_sum */
void smr_smooth_rest(smr_smooth *s, uint32_t task);

/* Step: sums the positions of each vertex' mesh neighbours. Tasks run one after the other. */
smr_count_tasks smr_smooth_tasks;
smr_run_task smr_smooth_sum;

/* Returns the weighted mean, mm, of `displacement` and of the displacement that smooths v; the step must have run. */
smr_vec smr_smooth_blend(const smr_smooth *s, uint32_t v, smr_vec displacement);

#endif
