/* smr.h: shape-matching registration. Deforms a prepared anatomical model onto a patient's data, one iteration per
 * smr_tick(), in memory that the caller hands over.
 *
 * Method: "Fast Musculoskeletal Registration Based on Shape Matching" ("the paper" below).
 * A first program needs sections 1 to 6 alone. Each later section is one capability with its settings.
 * Units: millimetres and nanoseconds where not said otherwise. Axes are the caller's (LPS in the command line).
 * Nothing here allocates, prints, or keeps globals. Every pointer stays the caller's.
 * Memory handed over must not overlap another argument or memory still in use. Nobody checks that.
 * Calls that need memory take inputs, memory, its bytes, then results; NAME_bytes() says how many bytes.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SMR_H
#define SMR_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------ 1. version, status, limits */
#define SMR_VERSION_MAJOR 0
#define SMR_VERSION_MINOR 2
#define SMR_VERSION_PATCH 0

typedef enum smr_status {
    SMR_OK = 0,
    SMR_PARTIAL = 1,    /* the budget ended within an iteration; the next tick resumes it */
    SMR_E_NULL = -1,    /* a required pointer is NULL */
    SMR_E_CONFIG = -2,  /* wrong cookie, a field outside its stated range, or fields that exclude each other */
    SMR_E_ARENA = -3,   /* the memory handed over is too small */
    SMR_E_ALIGN = -4,   /* the memory handed over is not aligned to SMR_ALIGN */
    SMR_E_MODEL = -5,   /* not a model, other version, damaged, or inconsistent */
    SMR_E_INPUT = -6,   /* a count, index or coordinate in the data is out of range */
    SMR_E_STATE = -7,   /* the call is not possible in this state */
    SMR_E_ABORTED = -8, /* the progress callback asked to stop */
    SMR_E_LOG = -9,     /* not a log, other version, damaged, or cut off within a record */
    SMR_E_SAVE = -10,   /* not a saved registration, other version, damaged, or inconsistent */
    SMR_E_WITHOUT = -11 /* a log or a save needs a capability that this build leaves out */
} smr_status;

/* The status' name, for example "SMR_E_ARENA". Never NULL. */
const char *smr_status_name(smr_status status);

/* The capabilities that this build of the library leaves out (docs/LINKING.md): "", or words of "image partial track
 * contact dynamics". What one of them needs is refused with E_CONFIG, a setting that is not at its default, too. */
const char *smr_built_without(void);

#define SMR_ALIGN 64u        /* bytes: every memory handed over starts on such an address */
#define SMR_COORD_MAX 1.0e5f /* mm: largest absolute coordinate accepted */
#define SMR_VERTICES_MAX 4000000u
#define SMR_TRIANGLES_MAX 8000000u
#define SMR_STRUCTURES_MAX 1024u
#define SMR_NAME_BYTES 64u /* structure names, with the closing NUL */
#define SMR_RADII_MAX 16u
#define SMR_LEVELS_MAX 24u /* of priority, in a model */
#define SMR_LANDMARKS_MAX 64u
#define SMR_FIXED_MAX 64u /* fixed surfaces */
#define SMR_WORKERS_MAX 64u
#define SMR_ALL 0xffffffffu    /* every structure */
#define SMR_NONE 0xffffffffu   /* no triangle */
#define SMR_FINEST 0xffffffffu /* the last radius of the model */

typedef struct smr_port smr_port;     /* threads and a clock: section 7 */
typedef struct smr_volume smr_volume; /* an image: section 11 */

/* ------------------------------------------------------------------ 2. meshes and target surfaces */
/* A triangle mesh in the caller's memory. Isolated or duplicate vertices, zero-area triangles, non-manifold edges and
 * several components are legal. Vertices without triangles (nodes inside a volume mesh, landmarks) are carried by those
 * around them, also as a structure of their own; in a target they attract nothing. */
typedef struct smr_mesh {
    const float *xyz;          /* [n_vertices][3], mm, finite, within +-SMR_COORD_MAX */
    const uint32_t *triangles; /* [n_triangles][3], each < n_vertices; NULL when n_triangles is 0 */
    uint32_t n_vertices;       /* 1..SMR_VERTICES_MAX */
    uint32_t n_triangles;      /* 0..SMR_TRIANGLES_MAX */
} smr_mesh;

/* A target surface made ready for closest-point search, in the caller's memory. */
typedef struct smr_surface smr_surface;

/* Copies the mesh into `memory` (SMR_ALIGN-aligned, smr_surface_bytes()) and builds its search tree there. Needs at
 * least one triangle. The mesh may go afterwards. `memory` must stay as long as the surface is used.
 * Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT; *surface untouched then. */
smr_status smr_surface_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t *bytes);
smr_status smr_surface_build(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface);

/* ------------------------------------------------------------------ 3. prepare: surfaces -> model */
typedef struct smr_structure {
    const char *name; /* "" or NULL for none; cut to SMR_NAME_BYTES - 1 */
    smr_mesh mesh;
} smr_structure;

/* How surfaces become a model: section 8. What most models set is n_radii and radius_mm. */
typedef struct smr_prepare_config smr_prepare_config;
smr_prepare_config smr_prepare_config_default(void);

/* Writes the model. scratch and model are SMR_ALIGN-aligned; scratch may go afterwards. smr_prepare_bytes(): bytes of
 * scratch for these structures, of which it reads counts only. *model_bytes: what the model takes. model NULL: only
 * that is found out, SMR_OK. Too small: E_ARENA, nothing useful is written, and *model_bytes says what is needed. No
 * constant bounds scratch or model for static storage: run smr_prepare_bytes(), then smr_prepare() with model NULL,
 * once for the structures, and write down what they say.
 * Errors: E_NULL, E_CONFIG, E_ALIGN, E_ARENA, E_INPUT, E_ABORTED. */
smr_status smr_prepare_bytes(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                             size_t *scratch_bytes);
smr_status smr_prepare(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                       void *scratch, size_t scratch_bytes, void *model, size_t model_capacity, size_t *model_bytes);

/* A model in place: position-independent, little-endian on every host, checksummed. */
typedef struct smr_model smr_model;

/* Checks every byte that the runtime will trust, and returns the memory itself as a model. memory (SMR_ALIGN-aligned,
 * may lie in flash) must stay as it is while the model is used.
 * Errors: E_NULL, E_ALIGN, E_MODEL; *model untouched then. */
smr_status smr_model_open(const void *memory, size_t bytes, const smr_model **model);

/* ------------------------------------------------------------------ 4. set up a registration */
enum { SMR_METHOD_RIGID = 0, SMR_METHOD_POLAR = 1 };

/* config.basic: what most registrations set. Each comment of a setting starts with unit, range and default. Where two
 * defaults stand, the second is that of smr_config_default_image(). build/SETTINGS.md has all settings as a page. */
typedef struct smr_basic_config {
    uint32_t n_workers; /* threads, [1, 64], default 1. Memory is laid out for so many; the port has at most so many */
    /* vertices, [0, 4000000], default 0. Room for the vertices of all target surfaces set at one time, together, and
     * the capacities of clouds. 0: room for none, so surfaces of any size are taken and none attracts. */
    uint32_t n_target_vertices;
    /* 0 or 1, default 1. Target vertices attract the model, as far as n_target_vertices has room for them. 0: none
     * attracts, surfaces of any size are taken, clouds are not, and the room takes no memory. */
    uint32_t attract;
    uint32_t method; /* SMR_METHOD_..., default rigid. How a cluster's rotation is found */
    /* iterations, [1, 100000], default 9, 20. At most, at each radius but the last. Those that only repair folds do not
     * count. With an image the first of several radii has twice as many. */
    uint32_t iterations;
    uint32_t iterations_last; /* iterations, [1, 100000], default 60, 40. At most, at the last radius */
    /* share, [0, 1], default 1. Vertices that take part, the most important first (paper 2.2, complexity tuning). The
     * others get no force, are in no cluster, and are carried along. At least smr_model_info.active_min are in. */
    float active_share;
    float search_mm; /* mm, (0, 100000], default 60. No closest point beyond this distance is a goal */
    /* share, [0, 1], default 0.5. Of the target-to-model pull in the goal. smr_tick_details.attraction_used says what
     * was used. */
    float attraction;
    /* share, [0, 1], default 0. Share of the displacement to the goal along the model's surface that counts. 0: the
     * result does not depend on the inputs' pose. 1: the surfaces come closest. */
    float slide;
    /* share, [0, 1], default 0.5. Of a vertex' motion along the surface that differs from its neighbours', taken back.
     * Only at the last radius, and only where there is a target surface. The share falls to 0 in the last iteration. */
    float even;
} smr_basic_config;

/* All settings, in groups: basic, image, partial, track, contact, dynamics, caller, forces, motion, schedule. The
 * struct is complete in section 17, after its groups. */
typedef struct smr_config smr_config;
smr_config smr_config_default(void);

/* A registration in progress, inside the caller's arena. */
typedef struct smr smr;

/* Sets up a registration at the model's rest shape in arena (SMR_ALIGN-aligned, smr_arena_bytes() or more). config and
 * port are copied. port may be NULL: one worker, no clock. model and arena must stay where they are: a copy of the
 * arena is not a registration, and calls with it return E_STATE.
 * Errors: E_NULL, E_CONFIG, E_ALIGN, E_ARENA, E_INPUT (the size is more than size_t holds); *s untouched then. */
smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes);
smr_status smr_init(const smr_model *model, const smr_config *config, const smr_port *port, void *arena, size_t bytes,
                    smr **s);

/* x' = m[r][0..2] . x + m[r][3]: rotation times scale, and translation. */
typedef struct smr_pose {
    float m[3][4];
} smr_pose;

/* Applies a pose to the whole model's rest shape and starts from there; the schedule starts over.
 * Errors: E_NULL, E_INPUT (an entry or a moved vertex beyond SMR_COORD_MAX), E_STATE. */
smr_status smr_set_pose(smr *s, const smr_pose *pose);

/* Puts a structure at these positions, [n_vertices][3] mm in the caller's vertex order. The present positions of all
 * structures become the reference shape x^r, and the schedule starts over.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
smr_status smr_set_positions(smr *s, uint32_t structure, const float *xyz);

/* Gives a structure, or SMR_ALL, its target surface, borrowed until replaced. NULL takes it away: the structure is then
 * carried along by its neighbours. Target vertices attract the model if config.basic.n_target_vertices has room.
 * Allowed between any two ticks. An iteration under way that has not all its forces yet starts them again; one that has
 * them ends with what it found of the old target. The old target's memory is the caller's again as soon as this call
 * returns and no other structure has the same target: no iteration looks at it any more. A schedule that is done stays
 * done until smr_set_pose() or smr_set_positions(); with config.track.mode a new target is followed, and this call is
 * how a tick learns of it, also when it is the same surface refitted.
 * Errors: E_NULL, E_STATE (not a registration, or not a surface), E_INPUT (no such structure), E_ARENA (more vertices
 * than config.basic.n_target_vertices, where that is not 0 and config.basic.attract is 1). */
smr_status smr_set_surface(smr *s, uint32_t structure, const smr_surface *surface);

/* ------------------------------------------------------------------ 5. iterate */
enum { SMR_PHASE_FORCES = 0, SMR_PHASE_SUMS, SMR_PHASE_MATCH, SMR_PHASE_AVERAGE, SMR_PHASE_EVOLVE, SMR_PHASES };

/* What a tick did, for those who look closer. */
typedef struct smr_tick_details {
    uint32_t phase;            /* SMR_PHASE_... that the next tick resumes; 0 after a whole iteration */
    uint32_t radius;           /* index; of this tick's iteration, or of the next where there was nothing to do */
    uint32_t radius_iteration; /* complete iterations at that radius; those that only repair folds do not count */
    /* Vertices that take part: the first so many in the order of priority; the others are ignored in this iteration.
     * After a partial tick that has not all its forces yet: the most that will. */
    uint32_t n_taken;
    uint32_t n_wanted;   /* vertices that would take part without a budget */
    uint32_t n_active;   /* vertices of n_taken with a target */
    uint32_t n_rejected; /* vertices of n_active without an acceptable goal */
    uint32_t n_guarded;  /* vertices that the fold guard moved: held back, unfolded or repaired */
    /* share, 0..1. Vertices with a goal, of those that looked for one in the last iteration in which any did: search
     * distances in images may end at 0. -1: none has since a target, the image or positions were set. */
    float matched_share;
    float attraction_used; /* config.basic.attraction where target vertices attracted the model, else 0 */
    float residual_rms_mm, residual_max_mm; /* as residual_mean_mm of the report */
    uint64_t phase_ns[SMR_PHASES];          /* ns; time of this tick by phase; 0 without a clock */
    uint32_t plastic_updates;               /* x^r = x happened so many times since the start */
    uint32_t tracking; /* 1: the schedule is done and targets are followed (config.track); done stays 0 */
    uint32_t settled;  /* 1: tracking, and ticks change and cost nothing until a target is set */
    uint32_t jumped;   /* 1: tracking, and the targets set last lay beyond reach when first looked at; until the next */
} smr_tick_details;

typedef struct smr_tick_report {
    uint32_t iteration; /* complete ones since the start */
    uint32_t done;      /* 1: the schedule is done; further ticks change nothing */
    /* 1: done, the last iteration moved every vertex by less than plastic_um, and matched_share is above 0. Back to 0
     * when a target is set after the end, for no iteration has looked at it. */
    uint32_t converged;
    float progress;    /* share of the schedule's iterations done, 0..1 */
    uint32_t n_forces; /* vertices with an external force, of those with a target */
    /* mm. |goal - x| over the n_forces vertices, of the last complete forces. -1: not measured, for no vertex had a
     * goal then, or a target, the image or positions were set since (n_active, n_forces and n_rejected are 0 then). */
    float residual_mean_mm;
    float displacement_max_mm; /* largest of the last complete iteration */
    uint64_t state_hash;       /* smr_state_hash(): the same bits and hash on every processor */
    smr_tick_details details;
} smr_tick_report;

/* One registration iteration (paper 2.3, the closing list): external forces, shape matching, averaging, evolution.
 * budget_ns 0, or a port without a clock: one whole iteration, however long it takes. Otherwise forces are evaluated in
 * the order of priority until the rest of the iteration needs the time that is left; vertices not reached are ignored
 * in this iteration. If the time still ends within the iteration, the tick stops between two chunks of work and returns
 * SMR_PARTIAL. The last complete positions stay valid, and the next tick goes on. Every tick does some work, however
 * short its budget. Once the schedule is done a tick changes nothing. report may be NULL.
 * Errors: E_NULL, E_STATE (not a registration; a target has changed, or is being refitted; inputs are awaited after
 * smr_restore(); called from within a tick; the caller's force broke its contract; the port used a worker number that
 * it has not). After the last the positions are those of the last complete iteration, and further ticks are refused
 * until smr_set_pose() or smr_set_positions(). */
smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report);

/* Copies a structure's current positions: [n_vertices][3] mm, in the caller's vertex order.
 * Errors: E_NULL, E_INPUT, E_STATE. */
smr_status smr_get_positions(const smr *s, uint32_t structure, float *xyz);

/* ------------------------------------------------------------------ 6. verdict */
/* Whether a result can be relied on. GOOD: nothing measured speaks against it. LOOK: something does. FAILED: the result
 * says nothing about the target. */
enum { SMR_VERDICT_GOOD = 0, SMR_VERDICT_LOOK = 1, SMR_VERDICT_FAILED = 2 };

/* What was measured of a structure, or of all. -1: nothing of the kind was measured. */
typedef struct smr_verdict {
    uint32_t level;          /* SMR_VERDICT_...: the worst of its reasons */
    uint32_t reasons;        /* sum of SMR_REASON_... (section 7); 0 when good */
    float expected_error_mm; /* or -1. Mean of smr_get_expected_error() over structures that are visible enough */
    float visible_share; /* 0..1, or -1. Of the model's area that the target shows; in an image: vertices with goals */
    /* 0..1, or -1. Of the target's area that the model lies on: no farther off than a mean edge or twice the residual.
     * Measured where target vertices attract (config.basic.attract, n_target_vertices). */
    float target_covered;
    float residual_mm;   /* or -1. Mean distance of visible vertices to the target; into an image: to their goals */
    float normals_agree; /* 0..1, or -1. Of the model's area on the target: normals less than 90 degrees apart */
    /* -1..1, or -1. Comparisons of an intensity profile in its place with the same profile 12 to 36 mm beside it on the
     * normal: share won less share lost. About 0 is what chance gives. */
    float image_similarity;
    float goals_share;  /* 0..1, or -1. Of vertices that looked for a goal in the image: those that found one */
    float strain;       /* share. Root mean square change of edge lengths from rest, without the whole's scale */
    float stretch;      /* share. Root mean square change of the size of parts from rest, likewise */
    float volume_ratio; /* volume over that at rest, without the whole's scale; 1 for open surfaces */
    float rotation_deg; /* 0..180. Largest rotation from rest of a part against the whole */
    float turned_deg; /* 0..180. Rotation of the whole from the start. Beyond 40 rigid kinematics is far from linear */
    float bend_mm;    /* smooth displacement from the start that no rigid motion explains, along an axis */
    float scale, scale_rest; /* size now over that at the start, and over that at rest */
    float moved_last_mm;     /* largest displacement of a vertex in the last iteration, of the whole model */
} smr_verdict;

/* Measures and judges one structure, or SMR_ALL: a closest-point search for each vertex and each triangle of its
 * target, and about 9,000 multiplications for each vertex. Changes no result. Serial.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration; called from within a tick; a target surface has changed; an
 * iteration is under way, whose memory this needs: tick until SMR_OK). */
smr_status smr_get_verdict(smr *s, uint32_t structure, smr_verdict *verdict);

/* One sentence for one bit of smr_verdict.reasons: what was measured and where to look. "" for anything else. Never
 * NULL; constant data. */
const char *smr_reason_text(uint32_t bit);

/* ------------------------------------------------------------------ 7. threads, clock, further reports */
/* One task of a parallel loop. worker is in 0..n_workers-1 and used by one thread at a time. With another number the
 * task is not run, and smr_tick() returns SMR_E_STATE. */
typedef void (*smr_task)(void *arg, uint32_t task, uint32_t worker);

/* What the platform lends to the library; see docs/PORTING.md. */
struct smr_port {
    void *ctx;
    uint32_t n_workers; /* 1..SMR_WORKERS_MAX */
    /* Calls run(arg, t, w) once for each t < n_tasks, in any order, on any workers w. Returns when all are done and
     * their writes are visible. NULL: a plain loop. Calls of smr_set_...() and smr_tick() for the same registration
     * from within get SMR_E_STATE. */
    void (*parallel)(void *ctx, smr_task run, void *arg, uint32_t n_tasks);
    uint64_t (*now_ns)(void *ctx); /* monotonic nanoseconds; NULL: no clock, budgets and times are then 0 */
};

/* Whether compiler and processor do float arithmetic as the library needs it: 0, or a sum of SMR_FLOAT_... Anything but
 * 0 means that results have other bits than elsewhere. Needs no memory and some hundred instructions: call it at
 * power-on and in the context that will call smr_tick(), for each thread has a floating-point mode of its own. */
uint32_t smr_self_test(void);
#define SMR_FLOAT_FUSED 1u    /* products and sums are fused: -ffp-contract=off was forgotten */
#define SMR_FLOAT_FLUSHED 2u  /* denormals become 0: FTZ or DAZ on x86, FPSCR.FZ on Arm, a vector unit */
#define SMR_FLOAT_EXCESS 4u   /* more bits than a float has (x87), or reordered sums (-ffast-math) */
#define SMR_FLOAT_ROUNDING 8u /* not to nearest even, or quotients and square roots are estimates */

/* What a verdict other than good rests on. */
#define SMR_REASON_NOTHING_VISIBLE 1u /* no vertex had a goal in the last complete forces, or there were none */
#define SMR_REASON_LITTLE_VISIBLE 2u  /* visible_share low; or expected_error_mm high, beside bend_mm or for a part */
#define SMR_REASON_EXPECTED 4u        /* expected_error_mm is high */
#define SMR_REASON_UNCOVERED 8u       /* target_covered is low */
#define SMR_REASON_NORMALS 16u        /* normals_agree is low */
#define SMR_REASON_RESIDUAL 32u       /* residual_mm is high for the model's edges */
#define SMR_REASON_SCALE 64u          /* scale is far from 1 */
#define SMR_REASON_STRAIN 128u        /* strain or stretch is high */
#define SMR_REASON_VOLUME 256u        /* volume_ratio is far from 1 */
#define SMR_REASON_ROTATION 512u      /* rotation_deg is high */
#define SMR_REASON_BEND 1024u         /* bend_mm is high */
#define SMR_REASON_SIMILARITY 2048u   /* image_similarity is low */
#define SMR_REASON_GOALS 4096u        /* goals_share is low */
#define SMR_REASON_STRUCTURES 8192u   /* of the whole: structures that are not good make up much of it */

/* mm: [n_vertices], caller's order. How far the vertex is expected from its true place, not only from the true surface:
 * error along the surface counts, too. -1 where too little of the structure is visible to say anything.
 * Errors: as smr_get_verdict(). */
smr_status smr_get_expected_error(smr *s, uint32_t structure, float *mm);

/* visible: [n_vertices], caller's order. 1: the target shows the vertex, as last judged; 0: the vertex follows others.
 * xyz: [n_vertices][3], likewise: unit normals, 0 where no triangle has an area.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
smr_status smr_get_visible(const smr *s, uint32_t structure, unsigned char *visible);
smr_status smr_get_normals(const smr *s, uint32_t structure, float *xyz);

typedef struct smr_structure_report {
    uint32_t has_target; /* 1: a surface, an image, a landmark of its own or the caller's goals; 0: carried along */
    uint32_t n_forces;   /* as in smr_tick_report, of the last complete forces */
    uint32_t n_rejected;
    float matched_share;                     /* as in smr_tick_details, of this structure */
    float residual_mean_mm, residual_max_mm; /* -1: not measured, as in smr_tick_report */
    float moved_mean_mm, moved_max_mm;       /* from the start positions */
} smr_structure_report;
smr_status smr_get_structure_report(const smr *s, uint32_t structure, smr_structure_report *report);

/* ratio: [n_vertices], caller's order; for SMR_ALL those of all structures in a row. Volume around each vertex over
 * that at rest, scale and all: between the surface of its cluster and the cluster's middle. Negative: inside out.
 * -1e6..1e6. The less the surface surrounds its cluster, the more this is the change of its area instead; where there
 * is none it is the whole's. radius_mm: of the clusters, the model's nearest to it, 0..SMR_COORD_MAX; 0: eight mean
 * edges. Take one as large as the structure is thick. Takes about as long as an iteration. Changes no result. Serial.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration; called from within a tick; inputs are awaited; an iteration is
 * under way, whose memory this needs). */
smr_status smr_get_local_volume(smr *s, uint32_t structure, float radius_mm, float *ratio);

/* Hash of the complete state: positions, relative to the start's whole millimetres, and reference shape. 0 for NULL. */
uint64_t smr_state_hash(const smr *s);

/* From the next iteration on exactly the first n_active vertices in the order of priority take part, whatever
 * configuration and budget say. At least smr_model_info.active_min of the radius take part, at most all vertices. 0 (as
 * at the start): configuration and budget decide again. Stays over smr_set_pose() and smr_set_positions(). Ticks
 * without a clock, each given the n_taken of a recorded iteration, repeat it to the last bit.
 * Errors: E_NULL, E_STATE. */
smr_status smr_set_active(smr *s, uint32_t n_active);

/* ------------------------------------------------------------------ 8. prepare and models in detail */
enum { SMR_DISTANCE_EUCLIDEAN = 0, SMR_DISTANCE_GEODESIC = 1 };
enum { SMR_MASS_UNIT = 0, SMR_MASS_AREA = 1 };
enum { SMR_ORDER_FOREST = 0, SMR_ORDER_BREADTH_FIRST = 1 };

/* Called between pieces of work: `done` of `total` are done. Return non-zero to stop (SMR_E_ABORTED). */
typedef int (*smr_progress)(void *ctx, uint32_t done, uint32_t total);

/* Each comment starts with unit, range and default; smr_prepare_settings() has the same as data. */
struct smr_prepare_config {
    uint32_t cookie; /* SMR_COOKIE of this struct; smr_prepare_config_default() sets it */
    /* radii, [0, 16], default 0: chosen from the surfaces' size and edge length. With a reference image: 60, 40, 25 and
     * 15 mm; for a structure alone its size and a third of it before them. */
    uint32_t n_radii;
    /* mm, [1e-06, 100000]. Cluster radii s, coarse to fine; the first n_radii count. The last says how soft the model
     * becomes. */
    float radius_mm[SMR_RADII_MAX];
    /* mm, [-100000, 100000], default -1: chosen. At radii below it clusters keep to their own structure. 0: at none.
     * Negative: below a third of the largest radius; with a reference image at the finest radius only. */
    float separate_below_mm;
    uint32_t profile_samples; /* samples, [3, 64], default 20. Of an image profile on a vertex' normal (paper 3: 30) */
    float profile_step_mm;    /* mm, (1e-06, 100], default 0.5. Distance between two samples */
    /* share, [-1, 1], default -1: all samples but 1.6 voxels of the reference. Share of the samples on the inner side.
     * The inside differs less between people than what lies around. Negative: chosen. */
    float profile_inward;
    uint32_t distance; /* SMR_DISTANCE_..., default euclidean (paper 2.2) */
    uint32_t mass;     /* SMR_MASS_..., default unit: 1 for each vertex; 1/16 for one without triangles */
    uint32_t order;    /* SMR_ORDER_..., default forest. The order L of the clusters */
    uint32_t ring;     /* 0 or 1, default 1. A cluster has its vertex' mesh neighbours, at radii from the mean edge */
    /* 0 or 1, default 1. Vertices are stored in the order in which they matter (paper 2.2, complexity tuning). A
     * registration can then leave out the last ones. 0: all vertices always take part. */
    uint32_t priority;
    uint32_t block_vertices; /* vertices, 0 or [16, 65536], default 0: chosen. Of a block of the forest */
    /* What the caller lends while smr_prepare() runs; NULL by default. */
    const smr_volume *reference; /* image that fits the model, for its intensity profiles */
    smr_progress progress;
    void *progress_ctx;
    const smr_port *port; /* threads; NULL: the calling thread alone. The model is the same */
};

/* The model as the paper has it: one radius of 30 mm over all structures, 30 samples of a profile, half inwards. */
smr_prepare_config smr_prepare_config_paper(void);

/* Arrays have one element for each radius, coarse to fine, where not said otherwise. */
typedef struct smr_model_info {
    uint32_t n_vertices, n_triangles, n_structures, n_radii;
    float centre[3]; /* mm. Origin of the model's internal coordinates */
    float edge_mm;   /* mm. Mean triangle edge; 0 without triangles */
    float radius_mm[SMR_RADII_MAX];
    float indexes_per_cluster[SMR_RADII_MAX]; /* mean number of stored indexes: zeta+, zeta- and roots */
    float direct_per_cluster[SMR_RADII_MAX];  /* mean number of vertices, |zeta|: what direct sums would read */
    uint32_t largest_cluster[SMR_RADII_MAX];  /* vertices; those within a micrometre beyond the radius count half */
    uint32_t smallest_cluster[SMR_RADII_MAX];
    uint32_t n_blocks[SMR_RADII_MAX];
    uint32_t separate[SMR_RADII_MAX];   /* 1: clusters keep to their own structure */
    uint32_t active_min[SMR_RADII_MAX]; /* active vertices so that each cluster keeps 3, or all that it has */
    uint32_t n_levels;                  /* of priority, the most important first; 1 without priority */
    uint32_t level_end[SMR_LEVELS_MAX]; /* [n_levels]: vertices in a level and all before it */
    uint32_t order;                     /* SMR_ORDER_... */
    uint32_t profile_samples;           /* 0: no intensity profiles */
    float profile_step_mm;
    uint32_t checksum;
    size_t bytes;
} smr_model_info;
smr_status smr_model_get_info(const smr_model *model, smr_model_info *info);

typedef struct smr_structure_info {
    char name[SMR_NAME_BYTES];
    uint32_t n_vertices, n_triangles;
} smr_structure_info;
smr_status smr_model_structure(const smr_model *model, uint32_t structure, smr_structure_info *info);

/* Copies a structure's rest shape as it was given to smr_prepare(), in the caller's vertex and triangle order. xyz:
 * [n_vertices][3], mm; triangles: [n_triangles][3]; either may be NULL. */
smr_status smr_model_mesh(const smr_model *model, uint32_t structure, float *xyz, uint32_t *triangles);

/* ------------------------------------------------------------------ 9. surfaces: closest points, building in steps */
typedef struct smr_closest {
    float point[3];     /* mm, on the surface */
    float normal[3];    /* unit, of that triangle */
    float distance;     /* mm */
    uint32_t triangle;  /* the caller's triangle index, SMR_NONE when nothing was found */
    float weight[3];    /* barycentric, sums to 1 */
    uint32_t on_border; /* 1 when the point lies on an edge that has one triangle only */
} smr_closest;

/* Exact closest point of the surface to `point` (3 floats), within max_mm (0 or more).
 * normal: 3 floats, unit; only triangles whose normal has at least the cosine min_cos with it count. NULL: all count.
 * Ties go to the smallest triangle index. Nothing found: SMR_OK, and hit->triangle is SMR_NONE.
 * Errors: E_NULL, E_STATE (not a surface), E_INPUT. */
smr_status smr_surface_closest(const smr_surface *surface, const float *point, const float *normal, float min_cos,
                               float max_mm, smr_closest *hit);

/* smr_surface_build() in pieces, for a thread that may not be long: begins, and smr_surface_step() does the work. Until
 * that returns SMR_OK the mesh must stay, and the surface is none: other calls refuse it with E_STATE.
 * Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT (a count); *surface untouched then. */
smr_status smr_surface_begin(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface);

/* New positions of a complete surface's vertices, xyz: [n_vertices][3] mm, in its mesh's order: begins, and
 * smr_surface_step() does the work, several times faster than a build. xyz is borrowed until that returns SMR_OK. Until
 * then no registration may tick that has the surface as a target (E_STATE), nor afterwards, until smr_set_surface()
 * gives it again; a registration that must tick in the meantime has another surface then. The result is a surface like
 * another, with the tree of the first positions: searches are slower where it no longer fits. A log has its checksum,
 * which depends on both; a replay refits the same surfaces again.
 * Errors: E_NULL, E_STATE (not a complete surface). */
smr_status smr_surface_refit(smr_surface *surface, const float *xyz);

/* Goes on with building or refitting: for `units` pieces of work (0: no limit), each of about 256 vertices or
 * triangles, or until budget_ns have passed by the port's clock (0, or no clock: no limit), which is exceeded by one
 * piece at most. Always does one piece. Neither limit changes a bit of the result. SMR_OK: the surface is complete.
 * SMR_PARTIAL: there is more to do. Errors: E_NULL, E_STATE (not a surface), E_INPUT (an index, a coordinate, a changed
 * cloud; what was to be built is none, what was to be refitted is as it was). */
smr_status smr_surface_step(smr_surface *surface, uint32_t units, const smr_port *port, uint64_t budget_ns);

/* ------------------------------------------------------------------ 10. start poses */
typedef struct smr_align_config {
    uint32_t cookie;
    uint32_t scaled;       /* 0 rigid, 1 rigid with one scale; default 1 */
    uint32_t iterations;   /* 1..1000, default 60: closest-point iterations of the last refinement */
    uint32_t samples;      /* 16..100000, default 600: points taken from each surface */
    const smr_pose *given; /* the pose that the surfaces are given in, tried as well; NULL (default): the identity */
} smr_align_config;
smr_align_config smr_align_config_default(void);

/* What smr_align() found. Distances are those of the parts that both surfaces have, in both directions. */
typedef struct smr_align_report {
    float rms_mm;               /* root mean square distance that is left */
    float model_share;          /* 0..1, of the model's area that the target explains */
    float target_share;         /* 0..1, of the target's area that the model explains */
    float scale;                /* of the pose */
    float second_rms_mm;        /* rms_mm of the best clearly different pose; 0 when none was found */
    float mirrored_rms_mm;      /* rms_mm of the mirrored model; clearly smaller: perhaps the other side's */
    uint32_t n_alike;           /* clearly different poses that fit as well, with the one found; symmetric: above 1 */
    uint32_t given;             /* 1: the pose as given was kept */
    uint32_t model_inside_out;  /* 1: closed, and its triangles look inwards; aligned as if they did not */
    uint32_t target_inside_out; /* likewise */
} smr_align_report;

/* Finds the pose that lays `model` onto `target` without landmarks, wholes or parts of them. The target may be a cloud
 * (smr_points_surface()); where its points have no normals their positions decide alone. A search over rotations and
 * over translations that match centres or ends, refined by closest points in both directions; what the other surface
 * does not have is left out. The pose as given is tried, too. memory: SMR_ALIGN-aligned scratch of smr_align_bytes()
 * (E_NULL, E_CONFIG). report may be NULL.
 * Errors: E_NULL, E_STATE (not a surface), E_CONFIG, E_ALIGN, E_ARENA, E_INPUT (no pose found, or config.given is not a
 * rotation, a scale and a translation); *pose and *report untouched then. */
smr_status smr_align_bytes(const smr_align_config *config, size_t *bytes);
smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config, void *memory,
                     size_t bytes, smr_pose *pose, smr_align_report *report);

/* The pose that lays from[i] onto to[i], both [n][3] mm, by least squares. scaled: 0 rigid; 1 with one scale, the ratio
 * of the spreads. rms_mm (may be NULL): the remaining distance. Where the pairs leave a rotation open (fewer than 3, or
 * all on one line), one of the best poses is returned.
 * Errors: E_NULL, E_INPUT (a count, scaled above 1, non-finite, beyond SMR_COORD_MAX); *pose untouched then. */
smr_status smr_align_landmarks(const float *from, const float *to, uint32_t n, uint32_t scaled, smr_pose *pose,
                               float *rms_mm);

typedef struct smr_warp smr_warp; /* a thin-plate spline in the caller's memory */
/* What a warp is: where landmarks do not determine a spline, the next best that they determine. */
enum { SMR_WARP_SPLINE = 0, SMR_WARP_SCALED = 1, SMR_WARP_RIGID = 2, SMR_WARP_TRANSLATION = 3 };

/* Fits a thin-plate spline (kernel |r| in three dimensions, Bookstein 1989) from from[i] to to[i], both [n][3] mm.
 * smoothing: mm, 0 or more. 0 passes through every landmark; larger values follow the affine part more.
 * kind: SMR_WARP_..., what the landmarks determine. Coplanar sets: rigid with one scale. Collinear ones or fewer than
 * 3: rigid. One place: a translation. Duplicates are averaged. memory (SMR_ALIGN-aligned, smr_warp_bytes()) stays the
 * caller's and holds the warp.
 * Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT (n not in 1..SMR_LANDMARKS_MAX, non-finite, beyond SMR_COORD_MAX, smoothing
 * negative or not finite); *warp untouched then. */
smr_status smr_warp_bytes(uint32_t n, size_t *bytes);
smr_status smr_warp_fit(const float *from, const float *to, uint32_t n, float smoothing, void *memory, size_t bytes,
                        smr_warp **warp, uint32_t *kind);

/* Carries n points xyz [n][3] mm by the warp, in place.
 * Errors: E_NULL, E_STATE (not a warp), E_INPUT (a point not finite or beyond SMR_COORD_MAX); xyz unchanged then. */
smr_status smr_warp_apply(const smr_warp *warp, float *xyz, uint32_t n);

/* ------------------------------------------------------------------ 11. images (paper 2.1) */
enum { SMR_SIMILARITY_NCC = 0, SMR_SIMILARITY_SSD = 1, SMR_SIMILARITY_CONCORDANCE = 2 };
enum { SMR_EDGE_REFERENCE = 0, SMR_EDGE_STEEPEST = 1 };
enum { SMR_BLEND_CONFIDENCE = 0, SMR_BLEND_PLAIN = 1 };
enum { SMR_VOXEL_UINT8 = 0, SMR_VOXEL_INT8, SMR_VOXEL_UINT16, SMR_VOXEL_INT16, SMR_VOXEL_FLOAT };

/* Voxels in the caller's memory: borrowed, never written. */
struct smr_volume {
    const void *voxels;  /* [size[2]][size[1]][size[0]], host byte order, naturally aligned; NaN counts as outside */
    const uint8_t *mask; /* the same shape, 0 counts as outside; NULL: none */
    uint32_t type;       /* SMR_VOXEL_... */
    uint32_t size[3];    /* 1..65536 voxels along each axis */
    float origin[3];     /* mm: centre of the first voxel */
    float spacing[3];    /* mm, > 0 */
    float direction[9];  /* row-major; columns are the axes' unit vectors, without the spacing, not all in one plane */
};

/* config.image. Goals are sought along the normal, both ways. Search distances fall linearly over the schedule. Over
 * the second half of the last radius all forces and the momentum fall to 0. */
typedef struct smr_image_config {
    float profile_mm; /* mm, [0, 60], default 10, 30. Search distance of profile matching, at the schedule's start */
    float profile_end_mm; /* mm, [0, 60], default 0, 2. The same at the end */
    float gradient_mm; /* mm, [0, 60], default 5. Search distance for the edge most like the profile's, at the start */
    float gradient_end_mm; /* mm, [0, 60], default 0, 2. The same at the end */
    /* SMR_SIMILARITY_..., default concordance. Of a profile and the image: normalised cross-correlation, sum of squared
     * differences, or concordance: a correlation that is lower under another contrast or brightness. */
    uint32_t similarity;
    float confidence; /* share, [0, 1], default 0.3. Combined confidence at or below this yields no force */
    /* cluster radii, (0, 1000000], default 0.5. Profiles are not sought beyond this many radii. Farther away lies the
     * far side of a neighbour. Where fewer than 80 % of a structure's vertices had a goal the limit grows, to one
     * radius and half the structure's thickness at most. */
    float profile_radii;
    /* share, [0, 1], default 0.5. Of the displacement along the surface at which the image becomes like the profile. It
     * is added to the goal on the normal. 0: goals lie on the normal, as in the paper. */
    float sideways;
    /* share, [0, 1], default 1. Of the displacement to the middle of the neighbours, for a vertex without a goal in the
     * image. Not where the image is undecided: no profile, a search that leaves the image or meets one value only. Not
     * in a structure of which fewer than half the vertices have a goal. */
    float fill;
    /* share, [0, 1], default 0. Weight of goals in the image beside those on a target surface, which weigh 1. Beside an
     * open surface or a cloud it is 1 in any case, and theirs is the share of the vertex that they show. */
    float beside;
    float nearer;   /* score per mm, [0, 1], default 0.005. Taken off at the ends of a search: the nearer place wins */
    uint32_t edge;  /* SMR_EDGE_..., default reference. Edge sought: most like the reference's, or steepest (paper) */
    uint32_t blend; /* SMR_BLEND_..., default confidence. Weights of profile and edge, or each in full (paper) */
    uint32_t fade;  /* 0 or 1, default 1. Forces and momentum fall to 0 over the last half radius (not in the paper) */
} smr_image_config;

/* Defaults for a registration into an image. Goals there are noisy and far, so the reference shape follows less often,
 * and there are more iterations. */
smr_config smr_config_default_image(void);

/* Gives every structure without a target surface this image, borrowed until replaced. NULL takes it away. The schedule
 * starts over from the present positions. While moving targets are followed (config.track), an image in the place of
 * another is followed, too: profiles are sought as far as at the schedule's start, within half the radius, and the
 * image before is free when the call returns. Along their surfaces, and where they have no goal, structures then go
 * with a smooth field from the schedule's result through everything that has one. Once surfaces, clouds (but for points
 * added) or landmarks are set again and no image is, what was found goes along with them, until the next.
 * Errors: E_NULL (voxels), E_INPUT (the volume's fields), E_STATE (no profiles). */
smr_status smr_set_volume(smr *s, const smr_volume *volume);

/* ------------------------------------------------------------------ 12. partial targets: clouds and landmarks */
enum { SMR_COVERAGE_AUTO = 0, SMR_COVERAGE_WHOLE = 1, SMR_COVERAGE_PARTIAL = 2 };

/* config.partial. */
typedef struct smr_partial_config {
    /* SMR_COVERAGE_..., default auto. Whether target surfaces show all of the model. Where they do not, a vertex counts
     * as far as it is visible: less beyond an open border, where normals disagree, and where the target's closest
     * points lie elsewhere on the model. Occluded vertices follow the image where that shows them, or the visible ones
     * by a smooth field. auto: whole for closed surfaces of which the model covers nine tenths. whole: no memory. */
    uint32_t coverage;
    /* mm, [0, 100], default 0. Noise of target points: a point nearer to the model's surface pulls nothing, a farther
     * one only by what it is farther. 0: noise of many points averages out. */
    float noise_mm;
    uint32_t n_landmarks; /* landmarks, [0, 64], default 0. Most that smr_set_landmarks() takes; 0 takes no memory */
} smr_partial_config;

/* A cloud of points as a target, in the caller's memory: a ring that keeps the newest. It shows the part of the model
 * that it lies on; what is between a few points and beyond them follows (config.partial.coverage). */
typedef struct smr_points smr_points;

/* Makes an empty cloud in `memory` (SMR_ALIGN-aligned, smr_points_bytes()), which must stay as long as the cloud is
 * used. capacity: 1..SMR_VERTICES_MAX points.
 * Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT; *points untouched then. */
smr_status smr_points_bytes(uint32_t capacity, size_t *bytes);
smr_status smr_points_open(uint32_t capacity, void *memory, size_t bytes, smr_points **points);

/* Copies n points into the cloud, at most its capacity; those beyond take the place of the oldest. n times 50 ns. xyz:
 * [n][3] mm, finite, within +-SMR_COORD_MAX. normals: [n][3], outwards, of any length; 0 0 0: this point has none;
 * NULL: none has. weights: [n], 0..4; NULL: 1 each. A point of weight 0 does nothing. Not while smr_tick() runs. Every
 * smr_set_points() of the cloud must be repeated. Errors: E_NULL, E_STATE (not a cloud), E_INPUT; it is unchanged. */
smr_status smr_points_add(smr_points *points, const float *xyz, const float *normals, const float *weights, uint32_t n);

/* Gives a point of the cloud another weight, 0 for one that was a mistake; otherwise as smr_points_add(). index: in the
 * order of adding, from 0, modulo the capacity. Errors: E_NULL, E_STATE, E_INPUT (no such point, or the weight). */
smr_status smr_points_weigh(smr_points *points, uint32_t index, float weight);

/* Takes all points out of the cloud, otherwise as smr_points_add(); counts its points. Errors: E_NULL, E_STATE. */
smr_status smr_points_clear(smr_points *points);
smr_status smr_points_count(const smr_points *points, uint32_t *n);

/* A copy of the cloud in which smr_surface_closest() finds the nearest point (with the point's index as the triangle),
 * and onto which smr_align() lays a model. Not for smr_set_surface(), and not needed for smr_set_points(). n: points in
 * the cloud, 1 or more. memory (SMR_ALIGN-aligned) stays the caller's and holds the surface. The same in pieces: begin,
 * then smr_surface_step() until it returns SMR_OK; until then the cloud stays as it is.
 * Errors: E_NULL, E_STATE (not a cloud), E_ALIGN, E_ARENA, E_INPUT (no point); *surface untouched then. */
smr_status smr_points_surface_bytes(uint32_t n, size_t *bytes);
smr_status smr_points_surface(const smr_points *points, void *memory, size_t bytes, smr_surface **surface);
smr_status smr_points_surface_begin(const smr_points *points, void *memory, size_t bytes, smr_surface **surface);

/* Gives a structure, or SMR_ALL, a cloud of points as its target, in place of a surface; borrowed until replaced. NULL
 * takes it away. config.basic.n_target_vertices must be at least the capacities of all clouds and the vertices of all
 * surfaces set at one time. An empty cloud shows nothing: the structure is carried along. To be called again whenever
 * points were added, between any two ticks; smr_tick() returns E_STATE until then. What an iteration under way does,
 * and what a schedule that is done, is as with smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration, or not a cloud), E_INPUT (no such structure), E_ARENA. */
smr_status smr_set_points(smr *s, uint32_t structure, const smr_points *points);

/* A point of the model, and where it is now. */
typedef struct smr_landmark {
    uint32_t structure; /* whose point; SMR_ALL (without a vertex): of whichever lies nearest at rest */
    uint32_t vertex; /* in the caller's numbering; SMR_NONE: `rest` says where, and the nearest triangle carries it */
    float rest[3];   /* mm. Position in the model's rest shape, on a surface or off it; ignored when `vertex` is set */
    float place[3];  /* mm, now */
    float weight;    /* [0.001, 1000]: one over the variance of its place; 1 counts like a visible vertex */
    uint32_t hard;   /* 1: the point ends in its place; weight is not looked at */
} smr_landmark;

/* Gives the model n landmarks in place of those before; n 0 takes them away. They are copied. Where no target shows the
 * model, it follows a smooth field through them; where one does, they say what runs along the surface, and a hard one
 * is reached all the same. Allowed between any two ticks, as smr_set_surface(). What is bound stays bound: to call this
 * with new places only costs next to nothing, a point at rest costs a pass over the model's triangles.
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (more than config.partial.n_landmarks), E_INPUT (no such
 * structure or vertex, a structure without vertices, a field outside its range). */
smr_status smr_set_landmarks(smr *s, const smr_landmark *landmarks, uint32_t n);

/* Where the landmarks' points of the model are: [n][3] mm, in the order set. Errors: E_NULL, E_STATE. */
smr_status smr_get_landmarks(const smr *s, float *xyz);

/* ------------------------------------------------------------------ 13. tracking: targets that move */
enum { SMR_TRACK_OFF = 0, SMR_TRACK_REPORT = 1, SMR_TRACK_RECOVER = 2 };

/* config.track. After the coarse-to-fine schedule the model follows targets that are replaced between ticks by
 * smr_set_surface(), smr_set_points(), smr_set_volume() or smr_set_landmarks(). The model is elastic about the
 * schedule's result: x^r is that shape, each structure carried rigidly along, and does not creep. */
typedef struct smr_track_config {
    /* SMR_TRACK_..., default off. report: follows, and says of a target whether it jumped beyond reach. recover: then
     * also goes through the coarser radii again. Not off, the arena has SMR_ARENA_TRACK_BYTES more. */
    uint32_t mode;
    /* mm, [0, 100000], default 0: six mean edges; with several structures at most the largest at which clusters keep to
     * their own structure. Cluster radius while following; the model's nearest. Larger is stiffer and steadier. */
    float radius_mm;
    /* mm, [0, 100000], default 0: a twelfth of the radius. A target has jumped when the mean distance of its goals is
     * larger in the first iteration that looks at it, or when it has none. */
    float jump_mm;
    float settle_um; /* um, [0, 100000000], default 20. Largest displacement at which to wait until a target moves */
    uint32_t iterations; /* iterations, [1, 100000], default 30. At most, for one position of the targets */
    /* share, [0, 1], default 0. When targets are set, each structure first goes on as a rigid body by this share of its
     * displacement since they were set before: for targets that come at even intervals. Not after a jump. The rest of
     * the share is left of the last iteration's momentum. The first tick on new targets does so at once, in one pass
     * over vertices and triangles, whatever its budget, and positions show it even if that tick is partial. Meant for
     * one to three ticks a target, or for targets at which the model settles. */
    float ahead;
} smr_track_config;

/* ------------------------------------------------------------------ 14. contact, volume and smoothness */
/* config.contact. A vertex inside another closed structure, or a fixed surface, goes out the short way, both sides by
 * mass. It slides freely. Structures overlap at rest? They are parted, too. */
typedef struct smr_contact_config {
    /* share, [0, 1], default 0: off. Of the displacement out of the other surface that an iteration makes; 1 is meant.
     * Not with dynamics. Not 0, the arena has SMR_ARENA_CONTACT_BYTES more. */
    float share;
    float gap_mm;     /* mm, [0, 100], default 0. Distance kept between surfaces */
    uint32_t n_fixed; /* surfaces, [0, 64], default 0. Most that smr_set_fixed() takes at one time. 0 takes no memory */
    /* share, [0, 1], default 0: off. Of what is missing from a closed structure's volume that each iteration gives
     * back, everywhere equally far along the normals. 1: it is what is asked after each iteration: the volume of the
     * rest shape in the scale of the start, times smr_set_volume_ratio(). Less: a compromise with the targets'.
     * Structures that are not closed are left alone. Not 0, the arena has SMR_ARENA_VOLUME_BYTES more. */
    float volume;
    /* share, [0, 1], default 0: off. Weight of smoothing on the surface beside goals, which weigh the rest to 1: a
     * vertex is drawn along its normal to where it stands out from its mesh neighbours as much as at rest. Finest radii
     * feel it most: clusters are stiff. Not 0, the arena has SMR_ARENA_SMOOTH_BYTES more. */
    float smooth;
} smr_contact_config;

/* A fixed surface that structures are kept out of, number index, borrowed until replaced; NULL takes it away. One that
 * is closed has an inside, which no vertex may be in: an implant inside a bone keeps the bone's surface off. One that
 * is open has an outside where its normals point to; what lies beyond its border is not held. It acts with
 * config.contact.share only. A refitted one is set again. Allowed between any two ticks, as smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration, not a complete surface, or a cloud), E_ARENA (config.contact.n_fixed is
 * 0), E_INPUT (index is not below config.contact.n_fixed). */
smr_status smr_set_fixed(smr *s, uint32_t index, const smr_surface *surface);

/* How two closed surfaces lie in each other. All are 0 where one of them is open: it has no inside. */
typedef struct smr_contact_report {
    float deepest_mm; /* farthest that a point of one lies inside the other, at vertices and three points a triangle */
    float a_in_b_mm;  /* the same of points of a only: of an implant b inside a bone a what cuts the bone's surface */
    float volume_mm3; /* of what is inside both */
    float area_mm2;   /* of one surface within the distance of the other, or inside; mean of both */
} smr_contact_report;

/* Measures the contact of two surfaces, which must not be clouds. within_mm: 0..100, distance that counts as contact.
 * Takes about as long as the closest points of both surfaces' vertices. For a result: smr_surface_build() of each
 * structure's positions.
 * Errors: E_NULL, E_STATE (not a complete surface with triangles), E_INPUT; *report untouched then. */
smr_status smr_surface_contact(const smr_surface *a, const smr_surface *b, float within_mm, smr_contact_report *report);

/* The volume that a closed structure, or each of them (SMR_ALL), is to have: ratio, 0.1..10, times the rest shape's in
 * the scale of the start, which is that of the similarity that lays the model's rest shape onto the start positions
 * best. 1 until set. Gone to by steps of 4 % an iteration. Allowed between any two ticks, as smr_set_surface(); stays
 * over smr_set_pose() and smr_set_positions().
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.contact.volume is 0), E_INPUT (no such structure, one
 * that encloses no volume, a ratio outside its range). */
smr_status smr_set_volume_ratio(smr *s, uint32_t structure, float ratio);

/* The volume of a structure that encloses one: each edge of its triangles belongs to as many triangles in one sense as
 * in the other. Volumes are positive, also where triangles look inwards at rest; a structure turned inside out since
 * has a negative one. Measured in one pass over the model's vertices and the structure's triangles, whether
 * config.contact.volume is on or off. Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
typedef struct smr_structure_volume {
    uint32_t closed;   /* 0: it encloses none, and all else is 0 */
    float rest_mm3;    /* of the rest shape, in the scale of the start (smr_set_volume_ratio()) */
    float asked_mm3;   /* at the end of the steps there; 0 while config.contact.volume is 0 */
    float present_mm3; /* volume at the positions of the last complete iteration */
    float asked_ratio; /* asked_mm3 over rest_mm3 */
    float ratio;       /* present_mm3 over rest_mm3 */
} smr_structure_volume;
smr_status smr_get_structure_volume(const smr *s, uint32_t structure, smr_structure_volume *volume);

/* ------------------------------------------------------------------ 15. dynamics */
enum { SMR_DYNAMICS_OFF = 0, SMR_DYNAMICS_ON = 1 };
#define SMR_SWEEPS 8u          /* iterations of a time step of dynamics */
#define SMR_GRAVITY_MAX 1.0e6f /* mm/s^2 along an axis */

/* config.dynamics. The model has mass and moves in time, by implicit Euler, in place of the schedule: from the start
 * pose, which is its shape at rest, at the cluster radius of config.track.radius_mm. SMR_SWEEPS iterations make a time
 * step; velocities are new when smr_tick_report.iteration is a multiple of it. More of them would let stiffness reach
 * farther. Each structure is elastic about its shape at rest; forces are springs to their goals, `stiffness` as strong
 * as those of shape matching. All vertices take part; folds are not looked at, and done stays 0. Where clusters deform
 * much, as small ones around few pinned vertices do, `method` polar is the right one. */
typedef struct smr_dynamics_config {
    /* SMR_DYNAMICS_..., default off. Not with track, volume, smooth or contact. On, the arena has
     * SMR_ARENA_DYNAMICS_BYTES more. */
    uint32_t mode;
    float step_ms; /* ms, [0.01, 1000], default 10. Length of a time step. Any is stable; long ones take energy out */
    float damping; /* 1/s, [0, 1000000], default 1. Velocities fall to 1 / (1 + step * damping) in each step */
    float gravity[3]; /* mm/s^2, [-1000000, 1000000], default 0. Along the caller's axes; 9810 is that of the Earth */
    /* 1/s^2, [0, 100000000], default 10000. Stiffness of the springs of shape matching, for each unit of mass: a vertex
     * that is off its clusters' mean swings with sqrt(elastic) / 2 pi Hz. */
    float elastic;
} smr_dynamics_config;

/* Masses and velocities of a structure's vertices, in the caller's order; copied. mass: [n_vertices] g, 1e-6 to 1e6, or
 * INFINITY: the vertex is pinned, it keeps its velocity whatever draws it, and clusters turn about it. NULL: they stay;
 * at first each is what smr_prepare_config.mass says. A mass counts as at most 1024 times the mean, with a rounding of
 * 1/32 of the mean; smr_get_energy() says what counts. velocity: [n_vertices][3] mm/s, within +-1e6; NULL: they stay.
 * Between any two ticks: an iteration under way starts again. smr_set_pose(), smr_set_positions() and smr_set_volume()
 * set velocities to 0, masses stay.
 * Errors: E_NULL (both), E_STATE (not a registration, or inputs are awaited), E_ARENA (config.dynamics.mode is off),
 * E_INPUT (no such structure, a value outside its range). */
smr_status smr_set_motion(smr *s, uint32_t structure, const float *mass, const float *velocity);

/* Velocities of a structure's vertices, [n_vertices][3] mm/s in the caller's order: those at the end of the last
 * complete time step, or as set since.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration), E_ARENA (config.dynamics.mode is off). */
smr_status smr_get_velocities(const smr *s, uint32_t structure, float *velocity);

/* Energies of all structures together. 1 uJ is 1000 g mm^2/s^2.
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.dynamics.mode is off). */
typedef struct smr_energy {
    uint32_t steps;    /* complete time steps since the start */
    uint32_t sweeps;   /* iterations of the step under way, 0..SMR_SWEEPS - 1 */
    uint32_t n_pinned; /* vertices */
    float mass_g;      /* of the others, as it counts */
    float centre[3];   /* mm: their centre of mass, now */
    float kinetic_uj;  /* of the velocities that smr_get_velocities() says, without pinned vertices */
    float gravity_uj;  /* potential energy in the gravity, now; 0 at the start positions */
    float elastic_uj;  /* last complete step: half of deviation times force, good while parts turn little against
                          each other; at most what the other energies leave for it */
    float goals_uj;    /* last complete step: of the springs to the goals */
} smr_energy;
smr_status smr_get_energy(const smr *s, smr_energy *energy);

/* ------------------------------------------------------------------ 16. goals and forces of the caller's own */
enum { SMR_CALLER_OFF = 0, SMR_CALLER_ON = 1, SMR_CALLER_CHECKED = 2 };

/* config.caller. */
typedef struct smr_caller_config {
    uint32_t goals; /* 0 or 1, default 0. 1: there is memory for smr_set_goals() */
    /* SMR_CALLER_..., default off. Memory for smr_set_force(). checked: each call is made twice, and a force that gives
     * something else the second time ends in SMR_E_STATE. */
    uint32_t force;
} smr_caller_config;

/* Goals of the caller's own for a structure: xyz, [n_vertices][3] mm, and weights, [n_vertices], 0..1000, 0 for none,
 * in the caller's vertex order. weights NULL: 1 for all. Both are borrowed until replaced, and set again when they
 * change; xyz NULL takes them away. A target's goal weighs 1: displacements to goals are averaged by weight, so the
 * only one counts in full, whatever it weighs. Allowed between any two ticks, as smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.caller.goals is 0), E_INPUT (no such structure, a goal
 * beyond SMR_COORD_MAX or not finite, a weight outside its range). */
smr_status smr_set_goals(smr *s, uint32_t structure, const float *xyz, const float *weights);

/* What a force of the caller's own sees: n vertices, which it may only read, and only until it returns. */
typedef struct smr_force_view {
    uint32_t n;
    uint32_t iteration;        /* complete ones since the start */
    float radius_mm;           /* of the clusters in use */
    const uint32_t *structure; /* [n] */
    const uint32_t *vertex;    /* [n] in the caller's numbering of that structure */
    const float *xyz;          /* [n][3] mm, now */
    const float *normal;       /* [n][3] unit, or 0 */
    const float *rest;         /* [n][3] mm, in the model's rest shape */
} smr_force_view;

/* Adds to displacement[n][3] (mm) how far each vertex is asked to go and to weight[n] how much that counts, 0..1000, as
 * for smr_set_goals(). Both are 0 before the call, and stay so for a vertex that is not drawn. Called from the port's
 * workers, several at a time, each vertex once in an iteration: a pure function of the view and of what ctx holds,
 * which does not change during a tick. Must not call the library with the same registration. */
typedef void (*smr_force)(void *ctx, const smr_force_view *view, float *displacement, float *weight);

/* Sets a force of the caller's own; NULL takes it away. Part of a tick's forces, under the same budget. If it gives
 * what is not finite, beyond SMR_COORD_MAX or a weight outside its range, or breaks its contract (config.caller.force
 * checked), smr_tick() returns E_STATE until it is set again. Allowed between any two ticks, as smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.caller.force is off). */
smr_status smr_set_force(smr *s, smr_force force, void *ctx);

/* ------------------------------------------------------------------ 17. experts' settings, and all settings */
enum { SMR_NORMALS_CARRIED = 0, SMR_NORMALS_EXACT = 1 };
enum { SMR_PLASTIC_LARGEST = 0, SMR_PLASTIC_MEAN = 1 };
enum { SMR_FUSING_LINEAR = 0, SMR_FUSING_LIE = 1 };

/* config.forces. */
typedef struct smr_forces_config {
    /* share, (0, 1], default 0.8. Of the displacement to its goal that a vertex is asked to make: the paper's alpha_e
     * (2.1), force = stiffness * (goal - x). It does not make the model stiffer: cluster radii do. */
    float stiffness;
    /* cluster radii, (0, 1000000], default 1.5. The search for closest points narrows to this many radii. From one
     * radius to the next it narrows by half at most. */
    float search_radii;
    float normal_deg; /* degrees, (0, 180], default 75. Largest angle between normals of vertex and closest point */
    /* standard deviations, [0, 1000000], default 0: off. Forces longer than the mean and this many deviations, both of
     * the last iteration, are dropped. */
    float reject_deviations;
    uint32_t reject_border; /* 0 or 1, default 0. Closest points on the border of an open target are no goals */
    uint32_t node_budget;   /* tree nodes, [8, 1000000], default 512. Most nodes that one closest-point search opens */
    uint32_t use_box;       /* 0 or 1, default 0. 1: no force outside the box */
    float box_min[3]; /* mm, [-100000, 100000], default 0. Lowest corner of the box. Looked at with use_box only */
    float box_max[3]; /* mm, [-100000, 100000], default 0. Highest corner of the box, nowhere below the lowest */
} smr_forces_config;

/* config.motion (paper 2.3). */
typedef struct smr_motion_config {
    float relaxation; /* share, (0, 1], default 1. x += relaxation * (averaged goal - x) */
    float momentum;   /* share, [0, 0.99], default 0.8, 0.7. Of the last displacement, added to the forces */
    /* share, [0, 0.99], default 0, 0.6. The same at the last radius. There momentum would carry vertices along the
     * surface, and rounding with them. */
    float momentum_last;
    float plastic_um; /* um, [0, 100000000], default 50. x^r = x when the largest displacement falls below it */
    /* iterations, [0, 1000], default 1, 5. x^r = x also after this many. 0: x^r follows only at rest (plastic_um) or at
     * the end of a radius, so that the model springs back towards its shape. */
    uint32_t plastic_every;
    uint32_t plastic_by; /* SMR_PLASTIC_..., default largest. Compared with plastic_um: largest, or mean (paper) */
    /* um, [0, 100000000], default 1. A radius is done early when the largest displacement falls below it. Not the last
     * radius while `even` works on a target surface and anything moves. */
    float settle_um;
    /* 0 or 1, default 1. At the last two radii folds are repaired, and steps that would fold triangles are limited. At
     * the last radius edges that are folded all the same are opened. */
    uint32_t fold_guard;
    /* SMR_NORMALS_..., default carried. Normals follow the clusters' rotations, or are computed in each iteration.
     * Carried ones, too, are computed whenever x^r = x. */
    uint32_t normals;
    float turn_deg; /* degrees, [0, 85], default 0: 86. Largest rotation of a cluster by rigid kinematics (paper: 20) */
    /* SMR_FUSING_..., default linear. The mean of the transforms of a vertex' clusters: of their matrices (paper 2.3),
     * which shrinks where these turn differently, or of their logarithms, which is a rigid motion again. Differences
     * show where x^r follows seldom (plastic_every). */
    uint32_t fusing;
} smr_motion_config;

/* config.schedule, from coarse to fine radius. */
typedef struct smr_schedule_config {
    uint32_t radius_first; /* index, default 0. First radius used */
    uint32_t radius_last;  /* index, default SMR_FINEST. Last radius used, not below radius_first */
    /* share, [0, 1], default 1. active_share at the start of the schedule, where that is lower. From there it grows
     * evenly to active_share at the end. */
    float active_first;
    /* vertices, [0, 1000000], default 30. With an image so many active vertices in the smallest cluster suffice, if
     * 1,000 of the whole model are active, too; the others are left out. Whole levels of priority are taken. 0:
     * active_share alone decides. */
    uint32_t active_enough;
} smr_schedule_config;

struct smr_config {
    uint32_t cookie;              /* SMR_COOKIE of this struct; smr_config_default() sets it */
    smr_basic_config basic;       /* section 4 */
    smr_image_config image;       /* 11 */
    smr_partial_config partial;   /* 12 */
    smr_track_config track;       /* 13 */
    smr_contact_config contact;   /* 14 */
    smr_dynamics_config dynamics; /* 15 */
    smr_caller_config caller;     /* 16 */
    smr_forces_config forces;
    smr_motion_config motion;
    smr_schedule_config schedule;
};

/* A registration as the paper has it, onto surfaces or into an image; docs/GUIDE.md has its settings. For a model of
 * smr_prepare_config_paper(). The start is the caller's: smr_warp_fit() with smoothing 0 is the paper's. */
smr_config smr_config_paper(void);

/* Settings as data, for command lines and documents. GROUP: a heading, name only. COUNT: uint32_t. NUMBER: floats, by
 * bytes. CHOICE: uint32_t, index of one of the words in `unit`: "rigid|polar". SWITCH: uint32_t, 0 or 1. */
enum { SMR_SETTING_GROUP = 0, SMR_SETTING_COUNT, SMR_SETTING_NUMBER, SMR_SETTING_CHOICE, SMR_SETTING_SWITCH };
enum { SMR_SETTING_POINTER = 5 };

/* One field of a configuration. Constant data; nothing of it is linked unless a program asks. */
typedef struct smr_setting {
    const char *name; /* in logs, reports and on command lines ("track_mm" of config.track.radius_mm); or the heading */
    const char *unit; /* "mm"; "" for none */
    const char *text; /* one sentence */
    uint32_t kind;    /* SMR_SETTING_... */
    uint32_t number;  /* of the field in logs; never changes */
    uint32_t offset;  /* bytes from the start of smr_config, or of smr_prepare_config */
    uint32_t bytes;   /* of the field; arrays are of 4 bytes an element */
    uint32_t open;    /* 1: low itself is not legal */
    uint32_t or_zero; /* 1: 0 is legal, too */
    /* Range of each element, high included. CHOICE: 0 and the last word's index. POINTER: both 0. The default may lie
     * outside it: SMR_FINEST in radius_last, and radius_mm beyond n_radii, where it is 0. */
    double low, high;
    double value, image; /* default, and that for images; of each element */
} smr_setting;

/* The fields of smr_config and of smr_prepare_config in the structs' order, with headings. n (may be NULL): rows. */
const smr_setting *smr_config_settings(uint32_t *n);
const smr_setting *smr_prepare_settings(uint32_t *n);

/* ------------------------------------------------------------------ 18. carried points */
/* Carries points of the space around the rest shape to where the model has taken them: a smooth map of space, exact at
 * the vertices, fixed by the vertices' rest and present places. Far from the model it follows a similarity. */
typedef struct smr_carry smr_carry;

/* Binds points [n_points][3] mm, given at rest, to the vertices rest [n_vertices][3] mm: structures in a row, as
 * smr_model_mesh() or the caller's meshes have them. n_points may be 0. Takes about 20 us a point. memory
 * (SMR_ALIGN-aligned, smr_carry_bytes()) holds the map and stays where it is; rest and points may go afterwards. port
 * is copied, what it names is used by later calls, too; NULL: one worker.
 * Errors: E_NULL, E_ALIGN, E_INPUT, E_ARENA, E_STATE (the port's worker number); *carry untouched then. */
smr_status smr_carry_bytes(uint32_t n_vertices, uint32_t n_points, uint32_t n_workers, size_t *bytes);
smr_status smr_carry_fit(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                         const smr_port *port, void *memory, size_t bytes, smr_carry **carry);

/* xyz [n_points][3] mm: where the bound points are while the vertices are at now [n_vertices][3] mm, in the order of
 * rest (smr_get_positions() for each structure). Not for two calls at a time.
 * Errors: E_NULL, E_STATE (not a map, or a copy of its memory; the port's worker number), E_INPUT. */
smr_status smr_carry_apply(smr_carry *carry, const float *now, float *xyz);

typedef struct smr_carry_fact {
    float miss_mm; /* inverse: how far forwards from the place found misses the point; above 0.01 it failed */
    float volume;  /* determinant of the local map from rest, to about 0.1; 0 or less: the map folds there */
} smr_carry_fact;

/* The same map for n points that are not bound, xyz [n][3] mm; about 100 times the time of a bound one. inverse 0: from
 * rest to now. 1: back. out: [n][3] mm, may be xyz; facts: [n], or NULL.
 * Errors: as smr_carry_apply(). */
smr_status smr_carry_map(smr_carry *carry, const float *now, uint32_t inverse, const float *xyz, uint32_t n, float *out,
                         smr_carry_fact *facts);

/* A frame is carried as SMR_FRAME_PLACES points. Their places for points [n][3] mm at rest: [n][SMR_FRAME_PLACES][3].
 * size_mm: distance over which the frame is measured, half an implant's length or 1. Errors: E_NULL, E_INPUT. */
#define SMR_FRAME_PLACES 5u
smr_status smr_frame_places(const float *points, uint32_t n, float size_mm, float *places);

/* From places at rest and carried ones: the rigid part of the local map, from rest to now, and the local maps
 * themselves, row-major [n][9]; one of the two may be NULL. smr_frame_normals(): unit normals [n][3] carried by local
 * maps, in place: perpendicular to what they were perpendicular to. Errors: E_NULL, E_INPUT. */
smr_status smr_frame_poses(const float *rest, const float *now, uint32_t n, smr_pose *poses, float *jacobians);
smr_status smr_frame_normals(const float *jacobians, float *normals, uint32_t n);

/* ------------------------------------------------------------------ 19. save and restore */
/* To go on in another arena, another program or on another processor, a registration is saved as bytes and restored:
 * position-independent, little-endian on every host, checksummed. From there on it has the same bits as without the
 * interruption, with any number of threads. Its reports say the same but for times, which it learns anew. */

/* Writes s to memory[bytes] (of any alignment). smr_save_bytes(): exactly so many, by model and configuration alone.
 * The model and inputs are not in it, but their checksums: one pass over each. Only between complete iterations: after
 * a tick that returned SMR_PARTIAL, tick until SMR_OK.
 * Errors: E_NULL, E_ARENA, E_STATE (not a registration; called from within a tick; an iteration is under way; a target
 * surface has changed; inputs are awaited; the port was refused, or the caller's force; a coordinate is beyond 2e6 mm,
 * and memory is written to then). */
smr_status smr_save_bytes(const smr *s, size_t *bytes);
smr_status smr_save(const smr *s, void *memory, size_t bytes);

/* What saved[saved_bytes] holds: smr_arena_bytes() with info->config says what smr_restore() needs.
 * Errors: E_NULL, E_SAVE; *info untouched then. */
typedef struct smr_saved_info {
    size_t bytes;            /* of the save itself; more may lie behind it */
    uint32_t library;        /* version that wrote it: major << 16 | minor << 8 | patch */
    uint32_t model_checksum; /* smr_model_info.checksum */
    uint32_t n_vertices;     /* of the model */
    smr_config config;       /* as it was given to smr_init; unchecked */
} smr_saved_info;
smr_status smr_save_info(const void *saved, size_t saved_bytes, smr_saved_info *info);

/* Sets up the registration that saved[saved_bytes] (of any alignment, from anywhere) holds, in arena like smr_init().
 * config: NULL, or as it was saved but for n_workers. port, model and arena as for smr_init(); saved may go afterwards.
 * Positions and normals can be read at once. What was borrowed when it was saved must be set again, each input once, by
 * smr_set_surface() or smr_set_points() for a structure or SMR_ALL, smr_set_volume(), smr_set_goals(), smr_set_fixed(),
 * smr_set_force() (which is taken on trust), and smr_set_log() with the log (NULL: recording ends). Until then other
 * calls that change or judge anything return E_STATE. An input that is not the one from before, by its checksum, or is
 * shared by other structures, is refused with E_INPUT (a log: E_LOG). Setting inputs again restarts nothing and is not
 * recorded: the log goes on as if there had been no interruption.
 * Errors: those of smr_init(), E_SAVE, E_MODEL (another model), E_WITHOUT; *s and arena untouched then. */
smr_status smr_restore(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                       size_t saved_bytes, void *arena, size_t bytes, smr **s);

/* Inputs that must still be set again before s goes on: structures with a surface or a cloud, the image, structures
 * with the caller's goals, the caller's force, the log. 0 for one that was not restored. Errors: E_NULL, E_STATE. */
smr_status smr_get_awaited(const smr *s, uint32_t *n);

/* ------------------------------------------------------------------ 20. log and replay */
/* Records in memory[bytes] (of any alignment) what is done to s from here on: the configuration, each input that is set
 * (poses and landmarks themselves, checksums of others), each tick, how far it came, and the state's hash.
 * memory is borrowed until replaced; NULL takes it away. Only right after smr_init(), so that the log says all. If a
 * record does not fit, a last record says so, recording ends, and the registration goes on. Results are the same with
 * and without a log. An input costs one pass over it.
 * Errors: E_NULL, E_STATE (not a registration, or not right after smr_init()), E_ARENA (below SMR_LOG_BYTES(0, 0)). */
smr_status smr_set_log(smr *s, void *memory, size_t bytes);

/* How far the log of s is; all 0 without one. Errors: E_NULL, E_STATE. */
typedef struct smr_log_state {
    size_t bytes;     /* written so far: the log is the first so many; complete after each call */
    uint32_t n_ticks; /* recorded */
    uint32_t full;    /* 1: the memory was too small, recording has ended */
} smr_log_state;
smr_status smr_get_log(const smr *s, smr_log_state *state);

typedef struct smr_log_info {
    uint32_t library, model_checksum, n_vertices; /* as in smr_saved_info */
    smr_config config;
} smr_log_info;

/* What a record is of: the call of that name. LANDMARKS: a record for each. FORCE: also, before a tick, what the force
 * gave in it. POINTS: also each change of its points. FIXED_SURFACE: number `index`. FULL: the memory ended here. */
enum {
    SMR_LOG_TICK = 1,
    SMR_LOG_SURFACE,
    SMR_LOG_VOLUME,
    SMR_LOG_POSE,
    SMR_LOG_POSITIONS,
    SMR_LOG_ACTIVE,
    SMR_LOG_FULL
};
enum {
    SMR_LOG_LANDMARKS = 8,
    SMR_LOG_GOALS,
    SMR_LOG_FORCE,
    SMR_LOG_POINTS,
    SMR_LOG_FIXED_SURFACE,
    SMR_LOG_VOLUME_RATIO
};
enum { SMR_LOG_MOTION = 14 };

/* One record. Fields that its kind does not have are 0. */
typedef struct smr_log_record {
    uint32_t kind; /* SMR_LOG_...; 0: the log ends here */
    /* Inputs. */
    uint32_t structure; /* surface, points, positions, goals, volume ratio, motion: whose; SMR_ALL */
    uint32_t present;   /* 0: it was taken away (NULL) */
    uint64_t checksum;  /* surface, points, volume, positions, goals, motion, what a force gave (also in a tick) */
    smr_pose pose;
    smr_landmark landmark; /* number `index` of `count`; none when count is 0: they were taken away */
    uint32_t index, count;
    float ratio;   /* of a volume */
    uint32_t gave; /* 1, of SMR_LOG_FORCE: the checksum is of what the force gave in the coming tick's iteration */
    /* Ticks: what the tick's report said. */
    uint32_t complete; /* 1: an iteration was completed, or the schedule was done already; 0: SMR_PARTIAL */
    uint32_t done, phase, iteration;
    uint32_t n_taken;     /* also of SMR_LOG_ACTIVE: what was asked for */
    uint32_t n_evaluated; /* vertices whose forces were looked for, so far in the iteration */
    uint32_t n_forces, plastic_updates;
    uint64_t state_hash;
} smr_log_record;

typedef struct smr_log_reader smr_log_reader; /* where reading stands: section 22 */
typedef struct smr_replay smr_replay;         /* a replay under way: section 22 */

/* Opens a log of `bytes` bytes (of any alignment), from anywhere. info may be NULL. smr_log_next(): the next record; of
 * kind 0 at the end. Errors: E_NULL, E_LOG; nothing is written then, but a record of kind 0; the reader stays. */
smr_status smr_log_open(const void *log, size_t bytes, smr_log_reader *reader, smr_log_info *info);
smr_status smr_log_next(smr_log_reader *reader, smr_log_record *record);

/* Gives a replay the input that a record names: a const smr_surface * (a target's, or a fixed one), a const smr_points
 * * with the points that it had then, a const smr_volume *, a const float * (positions, [n_vertices][3], mm), or a
 * const smr_goals *, smr_motion * or smr_caller_force * (section 22). NULL: not there. Borrowed as in smr_set_...(). */
typedef const void *(*smr_log_input)(void *ctx, const smr_log_record *record);

/* Prepares to repeat a log on s, which is as smr_init() left it, with the log's model and configuration. n_workers and
 * the port may differ. log and s must stay. input may be NULL when there are only poses and landmarks.
 * Errors: E_NULL, E_STATE (not a registration, or not right after smr_init()), E_LOG, E_MODEL (another model), E_CONFIG
 * (another configuration), E_WITHOUT. */
smr_status smr_replay_start(smr *s, const void *log, size_t bytes, smr_log_input input, void *ctx, smr_replay *replay);

typedef struct smr_replay_report {
    uint32_t tick;         /* the log's, from 1; at its end: how many there were */
    uint32_t ended;        /* 1: the log has no further tick */
    uint32_t full;         /* 1: and it ended because its memory did */
    uint32_t differs;      /* 1: the repeated tick came to something else */
    smr_log_record record; /* the tick; with an error: the record it is about */
    smr_log_record found;  /* what the repeated tick came to */
} smr_replay_report;

/* Repeats the log's next tick and the inputs set before it, without a clock, and compares what came of it. A complete
 * iteration is computed in one piece. A partial tick changes nothing yet, so its time falls on the tick that completes
 * the iteration. After an error or a difference the rest of the replay means little.
 * Errors: E_NULL, E_LOG, E_INPUT (an input is missing, has another checksum, or was refused), E_WITHOUT, and
 * those of smr_set_...() and smr_tick(). */
smr_status smr_replay_tick(smr_replay *replay, smr_replay_report *report);

/* ------------------------------------------------------------------ 21. sizes as constants, for static storage */
/* Upper bounds for nv vertices, nt triangles, ns structures. SMR_X_BYTES is that of x alone, SMR_X_Y_BYTES what y
 * of the configuration adds. No other setting changes a size. For example:
 * static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(1000, 2000, 1, 1, 0, SMR_METHOD_RIGID)]; */

/* smr_surface_bytes(): about 3 % above it at 1,000 triangles, less than 1 % from 4,000 on. */
#define SMR_SURFACE_BYTES(nv, nt) ((size_t)2048u + (size_t)32u * (nv) + (size_t)65u * (nt) + SMR_TREE_BYTES(nt, 1u))
#define SMR_POINTS_BYTES(capacity) ((size_t)1280u + (size_t)28u * (capacity))

/* smr_arena_bytes(). n_workers, n_target_vertices (0 with attract 0) and method as in smr_basic_config. Above the exact
 * size by about 6 kB, 1.3 kB for each further structure, and 0.4 %: with one structure a quarter at 50 vertices, 2 % at
 * 1,000, and less than 1 % from 5,000 on. */
#define SMR_ARENA_BYTES(nv, nt, ns, n_workers, n_target_vertices, method)                                              \
    ((size_t)8192u + ((method) == SMR_METHOD_RIGID ? (size_t)328u : (size_t)364u) * (nv) +                             \
     ((nv) < 190u ? (size_t)64u * (190u - (nv)) : (size_t)0u) + (size_t)(12u + SMR_SWAPPED_BYTES) * (nt) +             \
     (size_t)(nt) / 16u + (size_t)256u * (ns) +                                                                        \
     ((n_target_vertices) == 0u                                                                                        \
          ? (size_t)0u                                                                                                 \
          : (size_t)4u * (n_target_vertices) + (size_t)32u * (n_workers) * (nv) + SMR_TREE_BYTES(nt, ns)))
#define SMR_ARENA_LANDMARKS_BYTES(nv, n_landmarks) ((size_t)38000u + (size_t)192u * (n_landmarks) + (nv))
#define SMR_ARENA_TRACK_BYTES(nv, ns) /* without intensity profiles 12 nv less */                                      \
    ((size_t)1024u + (size_t)24u * (nv) + (size_t)96u * (ns))
#define SMR_ARENA_CONTACT_BYTES(nv, nt, ns) /* contact.share or contact.n_fixed */                                     \
    ((size_t)4096u + (size_t)100u * (nv) + (size_t)40u * (nt) + (size_t)25u * (ns) + SMR_TREE_BYTES(nt, ns))
#define SMR_ARENA_VOLUME_BYTES(ns) ((size_t)64u + (size_t)64u * (ns)) /* contact.volume */
#define SMR_ARENA_SMOOTH_BYTES(nv) ((size_t)64u + (size_t)4u * (nv))  /* contact.smooth */
#define SMR_ARENA_DYNAMICS_BYTES(nv, ns) ((size_t)2304u + (size_t)48u * (nv) + (size_t)208u * (ns))
#define SMR_ARENA_CALLER_BYTES(nv, ns) /* caller.goals or caller.force */                                              \
    ((size_t)256u + (size_t)16u * (nv) + (size_t)16u * (ns))

/* smr_save_bytes(). */
#define SMR_SAVE_BYTES(nv, ns, n_target_vertices, n_landmarks, method)                                                 \
    ((size_t)1152u + ((method) == SMR_METHOD_RIGID ? (size_t)85u : (size_t)121u) * (nv) + (size_t)56u * (ns) +         \
     (size_t)4u * (n_target_vertices) +                                                                                \
     ((n_landmarks) > 0u ? (size_t)4u + (nv) + (size_t)200u * (n_landmarks) : (size_t)0u))
#define SMR_SAVE_VOLUME_BYTES(ns) ((size_t)8u * (ns))
#define SMR_SAVE_TRACK_BYTES(nv) ((size_t)128u + (size_t)24u * (nv)) /* 12 nv less, likewise */
#define SMR_SAVE_AHEAD_BYTES(ns) ((size_t)4u + (size_t)96u * (ns))   /* track.ahead */
#define SMR_SAVE_DYNAMICS_BYTES(nv, ns) ((size_t)128u + (size_t)40u * (nv) + (size_t)8u * (ns))
#define SMR_SAVE_CONTACT_BYTES(nv, n_fixed) ((size_t)4u * (nv) + (size_t)8u * (n_fixed))

/* A log of n_ticks ticks, each with what a force of the caller's gave in it, and n_sets calls of smr_set_...(), of any
 * alignment. Each landmark that is set counts as a call. */
#define SMR_LOG_BYTES(n_ticks, n_sets) ((size_t)640u + (size_t)60u * (n_ticks) + (size_t)56u * (n_sets))

/* Parts of the bounds: search trees, and the triangles' copy where a model's byte order is not the processor's. */
#define SMR_TREE_BYTES(nt, ns) ((size_t)192u * ((size_t)(nt) / 7u + (size_t)8u * (ns)))
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define SMR_SWAPPED_BYTES 12u
#else
#define SMR_SWAPPED_BYTES 0u
#endif

/* ------------------------------------------------------------------ 22. for replays alone */
/* What smr_set_goals(), smr_set_motion() and smr_set_force() were given. */
typedef struct smr_goals {
    const float *xyz, *weights;
} smr_goals;
typedef struct smr_motion {
    const float *mass, *velocity;
} smr_motion;
typedef struct smr_caller_force {
    smr_force force;
    void *ctx;
} smr_caller_force;

/* The fields of these two are the library's. */
struct smr_log_reader {
    const unsigned char *log; /* borrowed */
    size_t bytes, at;
    uint32_t checksum;
};
struct smr_replay {
    smr *s;
    smr_log_reader reader, later;
    smr_log_input input;
    void *ctx;
    uint32_t n_ticks, has_forces, has_later, n_landmarks, count;
    uint64_t gave;
    smr_landmark landmark[SMR_LANDMARKS_MAX];
};

#ifdef __cplusplus
}
#endif

#endif /* SMR_H */
