/* closest_point_goals.h: goals on target surfaces (paper 2.1; 3, geometric registration): the closest point of the
 * target, averaged with the target's pulls. In: positions, normals, surfaces. Out: displacements of vertices to goals.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_CLOSEST_POINT_GOALS_H
#define SMR_CLOSEST_POINT_GOALS_H

#include "geometry/surface/surface.h"
#include "registration/shape/deformed_shape.h"

#define SMR_FORCE_CHUNK 4u   /* number of vertices, or target vertices, in a task that searches a surface */
#define SMR_LEARN_GOAL 0.05f /* largest displacement, in mean edges, after which a vertex learns what else is near */
#define SMR_LEARN_PULL 0.04f /* largest displacement, in mean edges, after which target vertices learn it */
#define SMR_VISIBLE_ONE 255u /* visibility of a fully visible vertex */
#define SMR_PULL_SCALE 1048576.0f /* 2^20: pulls are summed in units of 2^-20 mm times weight */
#define SMR_PULL_FULL 0.25f       /* pulling area, in mean areas of a target vertex, from which on pulls count fully */

#define SMR_SUM_TINY 1.0e-20f /* least divisor: compilers divide before they test divisors for 0 */

/* Noise of a target along its normals, in mean edges of the model; both 0 without a target. */
typedef struct smr_target_noise {
    float mesh, cloud;
} smr_target_noise;

typedef struct smr_target {
    const smr_surface *surface;       /* target surface or cloud of a structure; NULL: none */
    uint32_t partial;                 /* 1: goals are weighted by visibility; 0: all goals have full weight */
    uint32_t n_visible, n_judged;     /* number of visible and of judged vertices at the last judgement of visibility */
    uint32_t visible_now, judged_now; /* the same numbers of the current forces */
    uint32_t had_target;              /* 1: the structure had a target when the current iteration began */
    uint32_t measured;                /* 1: forces were completed since the target was set or removed */
    uint32_t n_vertices, changes; /* number of vertices, and change counter, of the surface when the target was set */
    uint32_t guard, body;         /* checksums of the surface's header; of its memory, where the scrub is on */
    float spread;                 /* cloud: mean weight of the vertices that points pull */
    float share;                  /* cloud: 0..1, share of displacements to goals that the model follows */
    float scale;                  /* mm: scale of the residuals of the target's vertices; 0: unknown */
    float area_share;             /* largest share of the target's area that the model can cover; 0: unknown */
    uint32_t others;              /* 1: the target holds bodies on which no goal may lie (outlier_weights.c) */
    float path;  /* mm: sum of each iteration's largest displacement of the structure since smr_certainties_clear() */
    float moved; /* mm: largest displacement of the structure in the last iteration */
    smr_vec facing; /* cloud: sum of the normals of the visible vertices of the current forces */
    smr_vec view;   /* cloud: mean normal of the model's visible vertices; 0: unknown */
    /* cloud: sums over the points at this structure, by weight: of the weights; of pulls along the normal, mm, times
     * what the other points predict; of squares of the former and of the latter; of points' shares in smoothed pulls */
    float compared, product, pulled, square, own;
    smr_target_noise noise; /* of the target that the last complete forces followed */
} smr_target;

/* Returns the share of the squared pulls of points, 0..1, that other points confirm: the rest is noise. 1: unknown. */
static inline float smr_points_agree(const smr_target *target)
{
    return target->pulled > 0.0f ? smr_clamp(target->product / smr_max(target->pulled, SMR_SUM_TINY), 0.0f, 1.0f)
                                 : 1.0f;
}

/* Returns the mean number of points that a goal averages; 0: unknown. */
static inline float smr_points_in_reach(const smr_target *target)
{
    return target->compared / smr_max(target->own, SMR_SUM_TINY);
}

/* Returns the noise of the target: a mesh is measured when it is built; a cloud has what no other points confirm. */
static inline smr_target_noise smr_noise_of(const smr_target *target, float edge_mm)
{
    const float noise2 = target->pulled * (1.0f - smr_points_agree(target)) / smr_max(target->compared, SMR_SUM_TINY);
    const float per_edge = 1.0f / smr_max(edge_mm, 1.0e-6f);
    if (target->surface == NULL)
        return (smr_target_noise){0.0f, 0.0f};
    if (!smr_is_cloud(target->surface))
        return (smr_target_noise){target->surface->noise_mm * per_edge, 0.0f};
    return (smr_target_noise){0.0f, target->compared > 0.0f ? SMR_SQRT(smr_positive(noise2)) * per_edge : 0.0f};
}

/* A distinct target surface. Several structures may share one. */
typedef struct smr_goal {
    const smr_surface *surface;
    uint32_t first_task; /* index of this target's first task in the target-to-model search */
    uint32_t n_vertices; /* number of vertices of the surface when the target was set */
    uint32_t first_warm; /* index of the target's first vertex in target_warm and target_residual */
    uint32_t structure;  /* index of the first structure with this target */
    uint32_t first_body; /* index of the target's first component in body_weight and body_sum */
    uint32_t n_bodies;   /* number of the surface's components that have their own weights; 0: no room for weights */
    float scale, area_share; /* scale of residuals, mm; share of the area that the model can cover; current forces */
    float model_area;        /* mm^2: area of the structures with this target, summed so far */
} smr_goal;

/* Sums over the vertices of a component of a target. */
typedef struct smr_body_sum {
    uint64_t area;   /* area of the vertices, in units of 1 / 65536 of the mean area of a target vertex */
    uint64_t inlier; /* sum of area times inlier weight, in the units of `area` */
} smr_body_sum;

#define SMR_RESIDUAL_NONE 65535u /* target_residual of a vertex without a closest point */
#define SMR_RESIDUALS 200u /* bins of the histogram of residuals, an eighth of an octave each; last bin: no residual */
#define SMR_BODY_SLOTS(n_structures) (SMR_BODY_PART + SMR_BODY_FIRST * (n_structures))

/* Checksum and size of a structure's cloud when the cloud was set. */
typedef struct smr_points_then {
    uint64_t sum; /* smr_points_checksum() of the cloud; 0: the target was no cloud */
    uint32_t n;   /* number of points of the cloud */
} smr_points_then;

struct smr_cloud_calls;

typedef struct smr_surface_goals {
    const struct smr_cloud_calls *clouds; /* functions for clouds of points; NULL: no cloud was set */
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    smr_target *target;    /* [n_structures] the target of each structure */
    smr_goal *goal;        /* [n_structures] distinct targets; the first n_goals are in use */
    smr_points_then *then; /* [n_structures] clouds when they were set; NULL: no target attracts */
    uint32_t n_goals;      /* number of distinct targets */
    uint32_t n_clouds;     /* number of distinct targets that are clouds */
    uint32_t n_points;     /* number of points of all clouds */
    uint32_t n_goals_at_begin, n_clouds_at_begin, n_points_at_begin; /* counts when this iteration began */
    uint32_t n_tasks;                                                /* number of tasks of the target-to-model search */
    const float *spread; /* [n][4] structures with a cloud: sum of the points' pulls, mm, and weight */
    /* members that the search for goals writes */
    uint32_t *warm;      /* [n] closest target triangle of each vertex in the last complete forces; SMR_NONE: none */
    uint32_t *warm_next; /* [n] closest target triangle of each vertex in the current forces, which may restart */
    uint16_t *other;     /* [n] smr_other_unit(): least distance of all target triangles but warm_next[v]; 0: unknown */
    /* [n_target_vertices] mm: distance of all but the closest model triangle, plus the structure's `path` then */
    float *target_other;
    uint32_t *target_warm; /* [n_target_vertices] closest model triangle of each target vertex; NULL: no attraction */
    uint16_t *target_residual; /* [n_target_vertices] distance to the model, logarithmic (outlier_weights.c) */
    uint64_t *histogram;       /* [SMR_RESIDUALS] area of the target vertices whose residuals lie in each bin */
    uint8_t *body_weight;      /* [SMR_BODY_SLOTS] 0..255: weight of a component's pulls; 0: another body */
    smr_body_sum *body_sum;    /* [SMR_BODY_SLOTS] area and inliers of each component */
    int64_t *pull; /* [n_workers][n][4] sum of pulls on each vertex, and weight; 0 between iterations; NULL: none */
    uint8_t *visibility;      /* [n] 0 .. SMR_VISIBLE_ONE: visibility at the last judgement; NULL: never judged */
    uint8_t *visibility_next; /* [n] 0 .. SMR_VISIBLE_ONE: visibility of each vertex in the current forces */
    uint32_t partial;         /* 1: some target is partial */
    float limit;              /* mm: longer displacements are rejected as outliers; 0: no limit, as after new inputs */
    float limit_next;         /* mm: limit by the current forces, which counts once the iteration is complete */
} smr_surface_goals;

void smr_surface_goals_layout(smr_arena *a, smr_surface_goals *g, const smr_shared *shared);
/* discards the results of the searches so far, in part k of `parts`; part 0 also what structures have */
void smr_surface_goals_reset(smr_surface_goals *g, uint32_t k, uint32_t parts);
void smr_surface_goals_commit(smr_surface_goals *g); /* stores what complete forces found of each target */
void smr_pulls_clear(smr_surface_goals *g);          /* sets all pulls of target vertices to 0 */
void smr_certainties_clear(smr_surface_goals *g);    /* discards what searches know of other triangles */
/* Adds an iteration's largest displacements to each structure's `path`. most2: [n_workers][n_structures] squares, which
 * are set to 0; NULL: nothing attracts. */
void smr_certainties_age(smr_surface_goals *g, float *most2);
void smr_target_warm_clear(smr_surface_goals *g); /* discards the closest model triangles of target vertices */
/* Checks that no target has changed since it was set. Errors: E_STATE; E_DAMAGED (a fault in a header). */
smr_status smr_targets_valid(const smr_surface_goals *g);

/* Returns the unit of smr_surface_goals.other, mm: 16 mean edges fit. */
static inline float smr_other_unit(const smr_surface_goals *g)
{
    return smr_le_float(g->shared->model->edge_mm) * (1.0f / 4096.0f);
}

/* Returns what a search knows of other triangles, which are at least other_mm away. After a step larger than `learn`
 * mean edges the search learns nothing, since the next one would not be sure. In dynamics nothing is known. */
static inline smr_certainty smr_known(const smr_surface_goals *g, float other_mm, float step_mm, float learn,
                                      smr_pause *pause)
{
    const int learns = g->shape->from == NULL && step_mm < learn * smr_le_float(g->shared->model->edge_mm);
    return (smr_certainty){learns ? step_mm : -1.0f, g->shape->from == NULL ? other_mm : 0.0f, 0, pause};
}

/* Result of a vertex' search on its target. */
typedef struct smr_surface_find {
    smr_hit hit;          /* the closest point with an agreeing normal; triangle SMR_NONE: no acceptable point */
    smr_vec displacement; /* from the vertex to the closest point, mm */
} smr_surface_find;

#define SMR_AHEAD 8u /* number of searches that memory is read ahead */

/* Prefetches what the searches of the vertices behind v read. */
static inline void smr_surface_goal_ahead(const smr_surface_goals *g, uint32_t v)
{
    const uint32_t last = g->schedule->n_active - 1u, far = smr_min_u32(v + SMR_AHEAD, last);
    const uint32_t near = smr_min_u32(v + SMR_AHEAD / 2u, last);
    const smr_surface *surface = g->target[smr_model_owner(g->shared->model, far)].surface;
    if (surface != NULL)
        smr_tree_ahead(&surface->tree, g->warm[far]);
    surface = g->target[smr_model_owner(g->shared->model, near)].surface;
    if (surface != NULL)
        smr_tree_ahead_corners(&surface->tree, g->warm[near]);
}

/* Finds the displacement from vertex v to its goal on the target mesh, mm. Returns 0 without a goal, and when the
 * search stopped: pause->kept. */
int smr_surface_goal(smr_surface_goals *g, uint32_t v, const smr_surface *target, smr_pause *pause,
                     smr_vec *displacement, smr_surface_find *find);

/* Returns the displacement of v to its last closest target triangle, averaged with the pulls on v, mm; or 0. */
smr_vec smr_surface_goal_again(const smr_surface_goals *g, uint32_t v);

/* Returns the displacement, mm, with its part along the model's surface multiplied by config.basic.slide, since goals
 * jump along it. Vertices without triangles have no normal. */
static inline smr_vec smr_off_surface(const smr_surface_goals *g, uint32_t v, smr_vec displacement)
{
    const smr_vec n = smr_get3(g->shape->normal, v), along_normal = smr_scale(n, smr_dot(n, displacement));
    if (smr_dot(n, n) < 0.5f)
        return displacement;
    return smr_add(along_normal, smr_scale(smr_sub(displacement, along_normal), g->shared->config.basic.slide));
}

smr_vec smr_shortened(smr_vec r, float by); /* returns r shortened by more than 0 mm; 0 where r is no longer */

/* Returns a displacement to the target, mm, shortened by config.partial.noise_mm; 0 within the noise. */
static inline smr_vec smr_beyond_noise(const smr_surface_goals *g, smr_vec r)
{
    const float noise = g->shared->config.partial.noise_mm;
    return noise > 0.0f ? smr_shortened(r, noise) : r;
}

/* correspondence_rejection.c: tests that reject goals. */
int smr_reject_outside(const smr_config *c, smr_vec p); /* 1: p, mm in the caller's coordinates, is outside the box */
int smr_reject_distance(const smr_surface_goals *g,
                        float d2); /* 1: a correspondence of squared length d2, mm^2, is an outlier */
/* 1: the closest point lies on an open border of the target */
int smr_reject_border(const smr_surface_goals *g, const smr_surface *target, const smr_hit *hit);
/* returns the outlier limit of the next iteration, mm: mean plus k standard deviations of the residuals; 0: none */
float smr_reject_limit(const smr_config *c, uint32_t n_forces, float mean, float mean_square);

/* Returns 1 when some target pulls the model. */
static inline int smr_attraction_on(const smr_surface_goals *g)
{
    return (g->shared->config.basic.attraction > 0.0f || g->n_clouds > 0u) && g->n_goals > 0u && g->target_warm != NULL;
}

/* Returns 1 when vertices of this target pull the model; a cloud always pulls. */
static inline int smr_attracts(const smr_surface_goals *g, const smr_surface *target)
{
    return smr_attraction_on(g) && (g->shared->config.basic.attraction > 0.0f || smr_is_cloud(target));
}

/* Step: each target vertex finds the closest point of the model, and pulls the model's vertices there. */
smr_count_tasks smr_attract_tasks;
smr_run_task smr_attract_search;

/* Returns the area of target vertex j divided by the mean area, at most 16; for a cloud, the weight of point j. */
static inline float smr_target_area(const smr_surface *s, uint32_t j)
{
    return s->area_mean > 0.0f ? smr_min(s->area[j] / smr_max(s->area_mean, 1.0e-20f), 16.0f) : 1.0f;
}

/* outlier_weights.c. Returns the weight, 0..1 and at tips up to 81, of the pull of target vertex j with the squared
 * residual r2, mm^2. */
float smr_outlier_weight(const smr_surface_goals *g, const smr_goal *goal, uint32_t j, float r2);
void smr_residual_put(smr_surface_goals *g, uint32_t slot, float mm); /* stores a residual in target_residual[slot] */

/* Returns the entry of g->goal for a structure's target; the structure must have a target. */
static inline const smr_goal *smr_goal_of(const smr_surface_goals *g, uint32_t structure)
{
    const smr_goal *goal = g->goal;
    while (goal->surface != g->target[structure].surface)
        goal++;
    return goal;
}

/* Returns the weights of the components of a structure's target: 0: no goal lies there; NULL: goals lie on all. */
const unsigned char *smr_other_bodies(const smr_surface_goals *g, uint32_t structure);
/* Step: scale and inliers of each target, from the residuals; tasks run one after the other. */
smr_count_tasks smr_outlier_tasks;
smr_run_task smr_outlier_sum;
/* Returns the median residual, mm, of what the model can cover: the mean of all targets that pull; 0: no target. */
float smr_residual_typical(const smr_surface_goals *g);
void smr_outliers_commit(smr_surface_goals *g);                     /* stores scales and weights of complete forces */
void smr_outliers_forget(smr_surface_goals *g, uint32_t structure); /* discards scale and weights of an old target */

/* reads the sum and the weight of the pulls on a vertex, in units of 1 / SMR_PULL_SCALE */
void smr_pull_look(const smr_surface_goals *g, uint32_t v, int64_t sum[4]);
void smr_pull_sum(smr_surface_goals *g, uint32_t v, int64_t sum[4]); /* reads the pulls on v, then sets them to 0 */
float smr_pull_mean(const int64_t sum[4], smr_vec *mean); /* writes the mean pull, mm; returns its weight, 0..1 */

/* Writes the mean pull on v, mm, and clears the pulls. Returns the weight, 0..1, which is small where few target
 * vertices pull, so that a single target vertex makes no difference. */
float smr_pull_take(smr_surface_goals *g, uint32_t v, smr_vec *mean);

#endif
