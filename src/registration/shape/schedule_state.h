/* schedule_state.h: constants, model, configuration and schedule, which all stages of a registration read.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SCHEDULE_STATE_H
#define SMR_SCHEDULE_STATE_H

#include "base/save_fields.h"
#include "base/vec.h"
#include "model/model.h"

#define SMR_WORDS 16u           /* number of 32-bit words of a summed record: one cache line */
#define SMR_CHUNK 128u          /* number of vertices in a task */
#define SMR_MATCH_CHUNK 32u     /* number of vertices in a task whose vertices take much time */
#define SMR_TRIANGLE_CHUNK 256u /* number of triangles in a task */

/* Iterations from a repair of folds on until the visibility is judged: by then repaired patches lie on the target. */
#define SMR_REPAIRED 4u

#define SMR_KEPT_MM 2.0e6f   /* largest saved coordinate or distance, mm: above the values of legal inputs */
#define SMR_KEPT_UNIT 1.001f /* largest saved entry of unit vectors and rotations */

/* Result of a vertex' search for a goal: no target, or one that does not show the vertex; a goal; no acceptable goal;
 * the image gives no answer. Second list: result of the search in the image alone. */
enum { SMR_FOUND_NO_TARGET = 0, SMR_FOUND_GOAL = 1, SMR_FOUND_NONE = 2, SMR_FOUND_UNDECIDED = 3 };
enum { SMR_NO_GOAL = 0, SMR_GOAL, SMR_UNDECIDED, SMR_INVISIBLE };

/* Model, configuration and values that follow from both. Constant after the setup. */
typedef struct smr_shared {
    const smr_model *model;
    smr_config config;
    uint32_t parts; /* sum of the SMR_PART_... that model and configuration need */
    uint32_t n;     /* number of vertices */
    uint32_t n_triangles, n_structures, n_radii, n_dihedrals;
    uint32_t n_references;     /* number of subjects' shapes that are blended; 0: the model has its own shape alone */
    uint32_t n_tasks;          /* number of chunks of SMR_CHUNK vertices */
    const uint32_t *triangle;  /* [n_triangles][3] stored vertices; on little-endian hosts in the model itself */
    const uint16_t *relief;    /* [n] the model's relief, as model.h says; NULL: none */
    float mass_max;            /* largest mass of a vertex in the model */
    float mass_unit;           /* masses are whole multiples of 1 / mass_unit */
    float mass_sum;            /* sum of all masses, in dynamics; 0: unknown */
    const float *mass;         /* [n] weights in the clusters' fits, in dynamics; NULL: the model's masses */
    float min_cos;             /* cosine of config.forces.normal_deg */
    struct smr_worker *worker; /* [config.basic.n_workers] where each worker is in the current step */
} smr_shared;

/* Returns the number of target vertices that the arena has memory for; 0: no target attracts. */
static inline uint32_t smr_target_slots(const smr_shared *shared) { return shared->config.basic.n_target_vertices; }

/* Age of the tracked image: not yet used by an iteration; used; outdated, since other targets have changed. */
enum { SMR_IMAGE_NEW = 0, SMR_IMAGE_CURRENT = 1, SMR_IMAGE_PAST = 2 };

/* State of the schedule. The tick lowers n_active where a budget ends; the caller sets n_active_chosen. */
typedef struct smr_schedule {
    uint32_t radius;           /* index of the current radius */
    uint32_t radius_iteration; /* number of complete iterations at the current radius */
    uint32_t iteration;        /* number of complete iterations since the start */
    uint32_t n_points;         /* number of points of all clouds when the current radius began */
    uint32_t since_plastic;    /* number of complete iterations since x^r last changed */
    uint32_t plastic_updates;  /* number of times since the start that x^r was set to x */
    uint32_t converged, done;  /* 1: the schedule has ended at rest; 1: the schedule has ended */
    uint32_t repairing;        /* 1: the current iteration repairs folds, before a radius */
    uint32_t repaired;         /* SMR_REPAIRED after a repair that moved vertices, one less in each iteration, to 0 */
    uint32_t n_set;            /* number of times that targets were set */
    uint32_t serial_of_forces; /* n_set when the last forces were complete */
    uint32_t others;           /* number of structures whose targets held other bodies in the last complete forces */
    uint32_t part_at_begin;    /* 1: a target showed a part of the model when the last iteration began */
    uint32_t serial;           /* n_set of the targets that x follows; 0: x is the start */
    uint32_t n_active;         /* the first n_active stored vertices are active; clusters move the others */
    uint32_t n_active_chosen;  /* the caller's choice of n_active (smr_set_active); 0: none */
    smr_lists lists;           /* clusters of the current radius */
    float search_mm;           /* search distance of closest points at the current radius, mm */
    float momentum;            /* share of the last displacement that is added to the forces at the current radius */
    float fade;        /* 0..1: share of image forces and momentum; falls at the end of a registration to an image */
    float profile_mm;  /* search distance of intensity profiles in this iteration, mm */
    float farthest_mm; /* search distance of intensity profiles without the limit by the cluster radius, mm */
    float gradient_mm; /* search distance of edges in this iteration, mm */
    /* members that tracking and new inputs set */
    uint32_t tracking;        /* 1: the schedule is done, and targets are tracked */
    uint32_t recovering;      /* 1: at a coarser radius after a jump of targets; 2: back at the radius of tracking */
    uint32_t changed;         /* SMR_CHANGED..: an input was set since the last iteration began; 0: none */
    uint32_t settled, jumped; /* 1: the tracked model is at rest; 1: the present targets have jumped */
    uint32_t image_age;       /* age of the tracked image, SMR_IMAGE_.. */
    float gain;               /* factor on forces while targets are tracked; 1 except at coarser radii after a jump */
    float noise_mm;           /* typical residual of the previous targets in their last iteration, mm */
    float found;              /* share of vertices that had goals on the last targets, 0..1 */
} smr_schedule;

/* Returns 1 when images can be tracked. */
static inline int smr_follows_images(const smr_shared *c)
{
    return c->config.track.mode != SMR_TRACK_OFF && smr_le32(c->model->profile_samples) > 0u;
}

/* Returns 1 when a tick changes nothing. */
static inline int smr_idle(const smr_schedule *p) { return p->done || (p->settled && !p->changed); }

static inline float *smr_at3(float *array, uint32_t i) { return array + 3u * (size_t)i; }

static inline uint32_t smr_chunk_end(const smr_shared *c, uint32_t task)
{
    return smr_min_u32((task + 1u) * SMR_CHUNK, c->n);
}

static inline uint32_t smr_active_end(const smr_schedule *p, uint32_t task)
{
    return smr_min_u32((task + 1u) * SMR_CHUNK, p->n_active);
}

/* Return the number of tasks for all active vertices, SMR_CHUNK or SMR_MATCH_CHUNK vertices a task. */
static inline uint32_t smr_active_tasks(const smr_schedule *p) { return smr_ceil_div(p->n_active, SMR_CHUNK); }
static inline uint32_t smr_match_tasks(const smr_schedule *p) { return smr_ceil_div(p->n_active, SMR_MATCH_CHUNK); }

/* Returns the number of tasks for all triangles, SMR_TRIANGLE_CHUNK triangles a task. */
static inline uint32_t smr_triangle_tasks(const smr_shared *c)
{
    return smr_ceil_div(c->n_triangles, SMR_TRIANGLE_CHUNK);
}

/* Returns 1 for an active vertex, which gets a force and is a member of clusters (paper 2.2, complexity tuning). */
static inline int smr_active(const smr_schedule *p, uint32_t vertex) { return vertex < p->n_active; }

static inline float smr_mass(const smr_shared *c, uint32_t vertex)
{
    if (c->mass != NULL)
        return c->mass[vertex];
    return smr_le_float(((const uint32_t *)smr_at(c->model, c->model->at_mass))[vertex]);
}

/* Returns the position of a stored vertex in the model's rest shape, mm from the model's centre. */
static inline smr_vec smr_rest(const smr_shared *c, uint32_t vertex)
{
    const uint32_t *rest = (const uint32_t *)smr_at(c->model, c->model->at_rest) + 3u * (size_t)vertex;
    return smr_v(smr_le_float(rest[0]), smr_le_float(rest[1]), smr_le_float(rest[2]));
}

/* Returns the index of the last radius of the schedule. */
static inline uint32_t smr_last_radius(const smr_shared *c)
{
    return smr_min_u32(c->config.schedule.radius_last, c->n_radii - 1u);
}

static inline int smr_at_last_radius(const smr_shared *c, const smr_schedule *p)
{
    return p->radius == smr_last_radius(c);
}

#endif
