/* state.h: a registration in progress. Arrays are grouped by the stage that writes them; all lie in the caller's arena.
 * Vertices are in the model's stored order; positions are relative to `origin`.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_STATE_H
#define SMR_STATE_H

#include "base/arena.h"
#include "base/parallel.h"
#include "geometry/hilbert_curve.h"
#include "geometry/transform_fit.h"
#include "geometry/surface.h"
#include "image/volume.h"
#include "model/model.h"

#define SMR_WORDS 16u  /* 32-bit words of a record that is summed: one cache line */
#define SMR_CHUNK 128u /* vertices of a task */
#define SMR_MATCH_CHUNK                                                                                                \
    32u                    /* of one that does much for each: transforms, moments, centres and spreads, a fitted pose */
#define SMR_FORCE_CHUNK 4u /* of one that looks for goals on a surface, or for the model from a target */
#define SMR_IMAGE_CHUNK                                                                                                \
    1u /* of one that looks for goals where there is an image: a vertex costs as much as forty elsewhere */
#define SMR_TRIANGLE_CHUNK 256u /* triangles of a task that sums over vertices' neighbours */
#define SMR_ENTRY_CHUNK 32u     /* entries of a piece of a block, half as many of the reference shape's long records */
#define SMR_STEPS_MAX 32u       /* of an iteration */
#define SMR_CONTRAST_ONE 64u    /* of smr.contrast: the image has the profile's */
#define SMR_LIGHTER_NONE 128    /* of smr.lighter: as light as the profile */
#define SMR_HINGE_CHUNK 1024u   /* hinges of a task */
#define SMR_HELD 255.0f         /* held back altogether */
#define SMR_MEND_RUNS 2048u     /* runs of triangles that are looked at or left out as one */
#define SMR_STATE_MAGIC 0x736d7254u

/* One structure's triangles and target. */
typedef struct smr_part {
    uint32_t first_vertex, n_vertices; /* caller's numbering */
    uint32_t first_triangle;
    uint32_t first_leaf;       /* of its tree, counted over all structures */
    smr_facets facets;         /* of the deforming model */
    const smr_surface *target; /* NULL: carried along */
    uint32_t folding;          /* 1: the fold guard is at work here */
    uint32_t drawn;            /* 1: had a target when the iteration under way began */
    uint32_t seen, looked; /* vertices that had a goal in the last iteration, and those of which the image can tell */
    smr_box box;           /* of its vertices */
    float wide_mm;         /* profiles of a structure that is hardly seen are sought so far, if that is farther */
    float noise;           /* intensity: contrast below it counts as none in its profiles */
    float gain, gain_sum, gain_weight; /* the image's contrast against the profiles', in the mean over its goals */
    float lighter, lighter_sum;        /* intensity: the image than the profiles there, likewise */
} smr_part;

/* A distinct target surface and the structures that share it. */
typedef struct smr_goal {
    const smr_surface *surface;
    uint32_t first_task; /* of the target-to-model search */
    uint32_t n_vertices; /* when it was set: a surface rebuilt since must be set again */
    uint32_t first_warm; /* its vertices' slots in target_warm */
} smr_goal;

/* What a task of vertices leaves for the step's end; reduced in task order. */
typedef struct smr_tally {
    float sum, sum2, max; /* of residuals or displacements, mm */
    float largest[2];     /* of the two kinds of summed quantities */
    uint32_t n_forces, n_rejected, n_active;
    uint64_t hash;
} smr_tally;

/* Where the mending of folds stands (fold_repair.c). */
typedef struct smr_mend {
    uint32_t stage, at; /* the pass under way, and how far it is; stage 0: none */
    uint32_t part, ring, sweep;
    uint32_t n_folds;
    uint32_t moved;                        /* 1: x_next has changed, the facets must follow */
    uint32_t run_bits;                     /* 2^run_bits triangles are a run */
    uint64_t touched[SMR_MEND_RUNS / 64u]; /* a bit each run: a corner in it is marked */
} smr_mend;

/* Where holding back stands (fold_limit.c). */
typedef struct smr_brake {
    uint32_t stage, at, round, part;
    float most;                            /* asked for in this round */
    uint32_t run_bits;                     /* 2^run_bits triangles are a run */
    uint64_t touched[SMR_MEND_RUNS / 64u]; /* a bit each run: a corner in it is marked */
} smr_brake;

/* Where unfolding stands (fold_open.c). */
typedef struct smr_unfold {
    uint32_t pass, chunk; /* the chunk of hinges to come; pass 0: none */
    uint32_t n_folds;     /* found in this pass so far */
} smr_unfold;

/* What the controller knows of the time that an iteration takes (time_budget.c). */
typedef struct smr_control {
    float rate[SMR_STEPS_MAX]; /* ns a unit of work, by step; negative: not known yet */
    uint64_t spent;            /* ns, in the step under way */
    float sum, whole;          /* ns, of the iteration under way so far, and of iterations in the mean */
    uint64_t budget;           /* ns, of the tick that began the iteration */
    uint32_t count;            /* active vertices when the sums' rates were learnt */
    uint32_t uncut;            /* 1: the iteration under way takes several ticks, and leaves nothing out */
    uint32_t late;             /* 1: it was meant to end in one tick, and has not */
    uint32_t cut;              /* 1: n_active is less than the configuration asks for, for want of time */
    uint32_t repairing;        /* 1: the last iteration was a repair */
    float margin;              /* times the reserve */
    uint32_t look;             /* forces so far at which it is asked again whether the time is up */
    uint32_t odd;              /* 1: the clock ran backwards in the step under way */
} smr_control;

/* Where recording stands (log.c). */
typedef struct smr_log {
    unsigned char *memory; /* the caller's; NULL: nothing is recorded */
    size_t bytes, used;
    uint32_t crc; /* of the last record */
    uint32_t n_ticks;
    uint32_t full; /* 1: a record did not fit, and none follows */
} smr_log;

struct smr {
    uint32_t magic;
    uint32_t fresh; /* 1: as smr_init left it */
    smr_log log;
    const smr_model *model;
    smr_config config;
    smr_port port;
    uint32_t n, n_triangles, n_parts, n_radii, n_tasks, n_hinges, n_hinge_tasks;
    float mass_max, mass_unit; /* masses are whole multiples of 1 / mass_unit */
    smr_vec origin;            /* mm */
    smr_pose fitted;           /* rest shape -> start positions, as near as a similarity comes */

    /* schedule */
    uint32_t radius, radius_iteration, iteration, since_plastic, plastic_updates;
    uint32_t converged, done, reference_stale;
    uint32_t repairing; /* iterations spent on repairing folds before a radius starts; 0: none */
    uint32_t n_goals, n_target_tasks;
    uint32_t begun_goals;     /* n_goals when the iteration under way began: a later one does not count in it */
    uint32_t step, next_task; /* where the tick stands: step of the iteration, tasks already done */
    smr_lists lists;          /* of the radius in use */
    uint32_t n_active;        /* the first so many vertices take part; the others are carried along */
    uint32_t n_pinned;        /* smr_set_active: the caller's choice; 0 none */
    smr_control control;
    float momentum;                /* at this radius */
    float search;                  /* mm: search distance at this radius */
    uint32_t fit_due;              /* 1: `fitted` is to be made of the present positions */
    smr_fit fit;                   /* its sums so far */
    float even;                    /* in this iteration: of the way to the neighbours' mean (tangent_evening.c) */
    float profile_mm, gradient_mm; /* search distances in the image in this iteration */
    float farthest_mm;             /* of profiles, were it not for the radius */
    float ease;                    /* share of forces and momentum left: falls to 0 where an image registration ends */
    float force_limit;             /* mm: longer forces are dropped; 0 none yet */

    /* targets */
    uint32_t has_grid; /* 1: structures without a surface follow the image */
    smr_grid grid;
    smr_part *part;        /* [n_parts] */
    smr_goal *goal;        /* [n_parts] */
    uint32_t *target_warm; /* [n_target_vertices] last closest triangle of the model */

    /* written by evolve */
    float *x;       /* [n][3] last complete positions */
    float *x_next;  /* [n][3] */
    float *normal;  /* [n][3] unit, at x */
    float moved_mm; /* largest displacement and hash of the iteration under way */
    uint64_t hash;
    uint32_t exact; /* 1: it ends with normals of the triangles */
    /* written by reference */
    float *x_ref;        /* [n][3] x^r */
    float *normal_ref;   /* [n][3] */
    float *centre;       /* [n][3] c^r of each cluster */
    float *spread;       /* [n][6] inverse inertia (rigid) or covariance (polar) */
    float *cluster_mass; /* [n] M; this and the two above only of active vertices' clusters */
    float *share;        /* [n] 1 / |zeta|, of active members; 0 for none */
    float coarse, fine;  /* mm: x^r is rounded to these where spreads and centres are summed */
    /* written by forces */
    float *force;        /* [n][3] f^e */
    float *residual;     /* [n] mm to the goal, where there is one; f^e fades where an image registration ends */
    uint32_t *warm;      /* [n] closest triangle of the target, of the last complete forces */
    uint32_t *warm_next; /* [n] the same, of those under way: they may have to start again */
    int64_t *pull;       /* [n_workers][n][4] target-to-model pulls: 3 sums and the weight */
    /* written by guard */
    uint8_t *found; /* [n] 0 no target, 1 a goal, 2 none acceptable, 3 nor can the image tell */
    uint8_t *seen;  /* [n] found, of the last complete forces */
    uint8_t *
        contrast; /* [n] the image's at the goal, SMR_CONTRAST_ONE: the profile's, 0: not known; of the last complete forces */
    uint8_t *contrast_next; /* [n] the same, of those under way */
    uint8_t *
        lighter; /* [n] the image at the goal than the profile, noise's; SMR_LIGHTER_NONE: not at all. Where contrast is known */
    uint8_t *lighter_next; /* [n] the same, of those under way */
    uint8_t *
        guard; /* [n] not 0: its step is held back (fold_limit.c), or it belongs to a repair (fold_repair.c), in this iteration */
    uint8_t *held; /* [n] the most that its step was held back since the last radius began */
    /* written by smooth, even and brake, over record */
    float *ring_sum;    /* [n][3] sum over a vertex' mesh neighbours */
    float *ring_weight; /* [n] of that sum */
    float *
        displaced; /* [n][3] tangent_evening.c: from the rest shape in its pose; fold_limit.c: [0] the most that is asked */
    uint32_t n_folding; /* hinges found folding while repairing */
    uint32_t n_guarded; /* vertices so marked */
    smr_mend mend;
    smr_brake brake;
    smr_unfold unfold;
    /* written by sums and average */
    uint32_t *record;     /* [n][SMR_WORDS] fixed-point quantities of each vertex */
    uint32_t *sum;        /* [n][SMR_WORDS] their sums over each cluster */
    uint32_t pieces;      /* of a block, in the step under way; 0 and 1: whole */
    uint32_t ring_pieces; /* of a structure in fill.c, the same */
    uint32_t sum_words;   /* words in use: 6, 10 or 12 */
    float scale[2];       /* of the two kinds of quantities */
    /* written by match */
    float *transform; /* [n][12] R - I row-major, t */
    float *eigen;     /* [n][9] warm start of the polar method; NULL for rigid */
    /* all stages */
    smr_tally *tally;         /* [max(ceil(n / SMR_MATCH_CHUNK), n_hinge_tasks)] */
    float *start;             /* [n][3] start positions */
    const uint32_t *triangle; /* [n_triangles][3]; in the model image itself on little-endian hosts */
    uint32_t *own_triangle;   /* the same on big-endian hosts */
    float *facet_normal;      /* [n_triangles][3] of the deforming model, for target-to-model search */
    smr_node *node;           /* [n_nodes] its box trees, one structure after the other */
    uint32_t n_nodes;
    float min_cos; /* of config.normal_deg */
    smr_tick_report report;
};

static inline int smr_valid(const smr *s) { return s != NULL && s->magic == SMR_STATE_MAGIC; }
static inline float *smr_at3(float *array, uint32_t i) { return array + 3u * (size_t)i; }

static inline uint32_t smr_chunk_end(const smr *s, uint32_t task) { return smr_min_u32((task + 1u) * SMR_CHUNK, s->n); }

static inline float smr_full_mass(const smr *s, uint32_t vertex)
{
    return smr_le_float(((const uint32_t *)smr_at(s->model, s->model->at_mass))[vertex]);
}

/* 1 when a vertex takes part: it gets a force and is in its neighbours' clusters (paper 2.2, complexity tuning). The others
 * are still carried by the clusters' transforms. */
static inline int smr_active(const smr *s, uint32_t vertex) { return vertex < s->n_active; }

/* The end of a task's active vertices. */
static inline uint32_t smr_active_end(const smr *s, uint32_t task)
{
    return smr_min_u32((task + 1u) * SMR_CHUNK, s->n_active);
}

/* A vertex' mass in the sums: an ignored one is out of every cluster, but its own cluster still carries it. */
static inline float smr_mass_of(const smr *s, uint32_t vertex)
{
    return smr_active(s, vertex) ? smr_full_mass(s, vertex) : 0.0f;
}

/* A whole number that wrapped, as it was meant. */
static inline int32_t smr_signed(uint32_t word)
{
    int32_t value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* value / SMR_BOUNDARY_UNITS, to the nearest, for values within +-2^61. Takes as long whatever its sign. */
static inline uint32_t smr_boundary_part(int64_t value)
{
    const uint64_t up = (uint64_t)1 << 62;
    return (uint32_t)(((uint64_t)value + up + SMR_BOUNDARY_UNITS / 2) / SMR_BOUNDARY_UNITS) -
           (uint32_t)(up / SMR_BOUNDARY_UNITS);
}

#define SMR_SPARE 12u /* first word of a sum that averaging does not use */

/* A vertex' next normal, until the iteration stands. */
static inline smr_vec smr_spare(const smr *s, uint32_t v)
{
    smr_vec normal;
    memcpy(&normal, s->sum + SMR_WORDS * (size_t)v + SMR_SPARE, sizeof normal);
    return normal;
}

static inline void smr_spare_set(smr *s, uint32_t v, smr_vec normal)
{
    memcpy(s->sum + SMR_WORDS * (size_t)v + SMR_SPARE, &normal, sizeof normal);
}

/* The displacement that matching sees: x + f^e - x^r, and a share of the last iteration's step (momentum; Polyak 1964).
 * Until evolve writes it, x_next holds the positions before x. */
static inline smr_vec smr_drive(const smr *s, uint32_t v)
{
    const smr_vec x = smr_load(smr_at3(s->x, v));
    const smr_vec step = smr_sub(x, smr_load(smr_at3(s->x_next, v)));
    const float share = s->repairing > 0u ? 0.0f : s->momentum * s->ease;
    const smr_vec u = smr_sub(smr_add(x, smr_load(smr_at3(s->force, v))), smr_load(smr_at3(s->x_ref, v)));
    return smr_add(u, smr_scale(step, share));
}

smr_status smr_config_check(const smr_config *c, const smr_model *m);

/* What a step's time is in proportion to: active vertices, what the forest reads, its number of tasks, or nothing that is
 * known beforehand. */
enum { SMR_WORK_TASKS = 0, SMR_WORK_ACTIVE, SMR_WORK_LISTS, SMR_WORK_FOLDS };

static inline uint32_t smr_method_words(const smr *s) { return s->config.method == SMR_METHOD_RIGID ? 6u : 12u; }

/* A step of the iteration: n_tasks(s) independent tasks (0: the step is skipped), then one serial end. Where tasks are pieces of
 * something that is one task without a budget, `abreast` pieces are independent and the next so many need them. */
typedef struct smr_step {
    uint32_t phase; /* SMR_PHASE_... */
    uint32_t work;  /* SMR_WORK_... */
    uint32_t (*n_tasks)(smr *s);
    smr_task run;
    void (*end)(smr *s);
    uint32_t serial;                 /* 1: its tasks run one after the other, in their order */
    void (*pieces)(smr *s, int cut); /* before the first task: whether to cut. NULL: its tasks are what they are */
    uint32_t (*abreast)(const smr *s);
} smr_step;

extern const smr_step smr_steps[]; /* tick.c: in the order in which they are done */
extern const uint32_t smr_n_steps;
int smr_forces_pending(const smr *s); /* 1 until an iteration has its forces */

void smr_control_start(smr *s);                                       /* time_budget.c: nothing is known */
void smr_control_plan(smr *s, uint64_t budget_ns);                    /* before an iteration */
void smr_control_resume(smr *s);                                      /* a tick goes on with an iteration */
void smr_control_done(smr *s);                                        /* an iteration is complete */
int smr_control_reached(smr *s, uint64_t left_ns, uint32_t group);    /* 1: the time is for the rest of the iteration */
uint32_t smr_control_group(smr *s, uint32_t n_tasks);                 /* tasks between two readings of the clock */
uint64_t smr_control_ahead(smr *s, uint32_t n_tasks, uint32_t group); /* ns that so many will take; 0 not known */
void smr_control_spend(smr *s, uint64_t ns, uint64_t budget_ns);      /* between two readings */
void smr_control_learn(smr *s, uint32_t n_tasks);                     /* the step under way is complete */

/* The steps, by the file they live in. */
uint32_t smr_reference_records(smr *s); /* reference.c: x^r's cluster centres and spreads, when x^r is new */
uint32_t smr_reference_tasks(smr *s);
uint32_t smr_reference_clusters(smr *s);
uint32_t smr_reference_blocks(smr *s);
void smr_reference_reach(void *arg, uint32_t task, uint32_t worker);
void smr_reference_record(void *arg, uint32_t task, uint32_t worker);
void smr_reference_cluster(void *arg, uint32_t task, uint32_t worker);
void smr_reference_add(smr *s, uint32_t to, uint32_t from, int32_t share);
void smr_reference_begin(smr *s); /* chooses the quantum */
void smr_reference_end(smr *s);

uint32_t smr_pull_tasks(smr *s); /* attract.c: target-to-model attraction */
void smr_pull_search(void *arg, uint32_t task, uint32_t worker);

uint32_t smr_facet_tasks(smr *s); /* facets.c: triangles' normals and box trees at x_next */
void smr_facet_refit(void *arg, uint32_t task, uint32_t worker);
void smr_facets_end(smr *s);
void smr_facets_now(smr *s); /* all of them, at x */

uint32_t smr_guard_tasks(smr *s); /* fold_find.c: folds */
void smr_guard_search(void *arg, uint32_t task, uint32_t worker);
void smr_guard_end(smr *s);
void smr_mend_start(smr *s);     /* fold_repair.c: repairs what folds */
uint32_t smr_mend_tasks(smr *s); /* one more, as long as there is work */
void smr_mend_pass(void *arg, uint32_t task, uint32_t worker);
void smr_mend_end(smr *s);
uint32_t smr_mend_facet_tasks(smr *s);
void smr_mend_abandon(smr *s);

void smr_brake_start(smr *s);     /* fold_limit.c: what would fold */
uint32_t smr_brake_tasks(smr *s); /* one more, as long as there is work */
void smr_brake_pass(void *arg, uint32_t task, uint32_t worker);

void smr_unfold_start(smr *s);     /* fold_open.c: what is folded all the same */
uint32_t smr_unfold_tasks(smr *s); /* one more, as long as there is work */
void smr_unfold_pass(void *arg, uint32_t task, uint32_t worker);

uint32_t smr_smooth_tasks(smr *s); /* fill.c: mesh neighbours' sums, for vertices without a goal */
void smr_smooth_pieces(smr *s, int cut);
uint32_t smr_smooth_abreast(const smr *s);
void smr_smooth_sum(void *arg, uint32_t task, uint32_t worker);
smr_vec smr_smooth_way(const smr *s, uint32_t v);

uint32_t smr_vertex_tasks(smr *s);
uint32_t smr_active_tasks(smr *s);      /* those that have active vertices */
uint32_t smr_force_chunk(const smr *s); /* forces.c: f^e; vertices of a task */
uint32_t smr_force_tasks(smr *s);
void smr_force_search(void *arg, uint32_t task, uint32_t worker);
void smr_force_take(void *arg, uint32_t task, uint32_t worker);
void smr_force_end(smr *s);

uint32_t smr_block_tasks(smr *s);       /* sums.c */
void smr_block_pieces(smr *s, int cut); /* before the first task of a forest */
uint32_t smr_block_abreast(const smr *s);
void smr_sums_record(void *arg, uint32_t task, uint32_t worker);
void smr_sums_forest(void *arg, uint32_t task, uint32_t worker);
void smr_average_record(void *arg, uint32_t task, uint32_t worker);

uint32_t smr_boundary_tasks(smr *s); /* boundary.c: members about a radius away, after each forest */
uint32_t smr_boundary_reference_tasks(smr *s);
void smr_boundary_reference(void *arg, uint32_t task, uint32_t worker);
void smr_boundary_sums(void *arg, uint32_t task, uint32_t worker);

uint32_t smr_match_tasks(smr *s);
void smr_match(void *arg, uint32_t task, uint32_t worker); /* match.c: T_i */
void smr_match_end(smr *s);

void smr_evolve(void *arg, uint32_t task, uint32_t worker); /* evolve.c: x */
void smr_evolve_end(smr *s);                                /* facets follow x_next from here on */
void smr_settle(void *arg, uint32_t task, uint32_t worker);
void smr_settle_end(smr *s);
uint32_t smr_stand_tasks(smr *s);
void smr_stand(void *arg, uint32_t task, uint32_t worker); /* everything becomes current at once */

uint32_t smr_exact_tasks(smr *s); /* exact_normals.c: normals of the triangles */
uint32_t smr_exact_facet_tasks(smr *s);
void smr_exact_clear(void *arg, uint32_t task, uint32_t worker);
void smr_exact_facets(void *arg, uint32_t task, uint32_t worker);
void smr_exact_unit(void *arg, uint32_t task, uint32_t worker);

uint32_t smr_even_fit_tasks(smr *s); /* tangent_evening.c: the last radius' pose */
void smr_even_fit(void *arg, uint32_t task, uint32_t worker);
void smr_even_fit_end(smr *s); /* neighbours' displacements, at the last radius */
void smr_even_share(smr *s);
uint32_t smr_even_tasks(smr *s);
uint32_t smr_even_facet_tasks(smr *s);
void smr_even_clear(void *arg, uint32_t task, uint32_t worker);
void smr_even_rings(void *arg, uint32_t task, uint32_t worker);
smr_vec smr_even_step(smr *s, uint32_t v); /* valid after smr_even_rings, until the guard */

void smr_abandon_iteration(smr *s);
void smr_schedule_start(smr *s); /* schedule.c */
void smr_schedule_next(smr *s);
int smr_schedule_plastic(const smr *s); /* 1: the iteration about to stand ends with x^r = x */
uint32_t smr_last_radius(const smr *s);
int smr_guarded(const smr *s); /* 1: at this radius folds are guarded against */
float smr_schedule_progress(const smr *s);
void smr_schedule_distances(smr *s);
void smr_schedule_active(smr *s); /* chooses n_active, before an iteration */

#endif
