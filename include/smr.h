/* smr.h: shape-matching registration of a prepared anatomical model onto a patient's data, in the caller's memory.
 *
 * Method: "Fast Musculoskeletal Registration Based on Shape Matching", "the paper" below.
 * A first program needs sections 1 to 6, and 10 for start poses. Each later section is one capability.
 * Lengths are in millimetres and times in nanoseconds where no other unit is given. Axes are the caller's.
 * The library allocates nothing, prints nothing and has no globals. The library never frees a pointer of the caller's.
 * Memory handed over must not overlap another argument or memory still in use; the library does not check overlaps.
 * A call that needs memory takes its inputs, the memory, the memory's bytes, then its results. The function
 * NAME_bytes() returns the required bytes. An error leaves a call's results untouched unless the call's comment says
 * otherwise. smr_set_...() may be called between any two ticks.
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
#define SMR_VERSION_MAJOR 1 /* functions, layouts of structs and values stay within it, see docs/safety/LIFECYCLE.md */
#define SMR_VERSION_MINOR 0
#define SMR_VERSION_PATCH 0

typedef enum smr_status {
    SMR_OK = 0,
    SMR_PARTIAL = 1,     /* the budget ended within an iteration; the next tick resumes the iteration */
    SMR_E_NULL = -1,     /* a required pointer is NULL */
    SMR_E_CONFIG = -2,   /* wrong cookie, a field outside its stated range, or fields that exclude each other */
    SMR_E_ARENA = -3,    /* the memory handed over is too small */
    SMR_E_ALIGN = -4,    /* the memory handed over is not aligned to SMR_ALIGN */
    SMR_E_MODEL = -5,    /* the bytes are not a model, are of another version, damaged or inconsistent */
    SMR_E_INPUT = -6,    /* a count, index or coordinate in the data is out of range */
    SMR_E_STATE = -7,    /* the object's state does not allow the call, or the object is not of the expected type */
    SMR_E_ABORTED = -8,  /* the progress callback asked to stop */
    SMR_E_LOG = -9,      /* the bytes are not a log, are of another version, damaged, or end within a record */
    SMR_E_SAVE = -10,    /* the bytes are not a save, are of another version, damaged or inconsistent */
    SMR_E_WITHOUT = -11, /* a log or a save needs a capability that this build leaves out */
    SMR_E_DAMAGED = -12  /* memory has changed that only the library may change */
} smr_status;

/* Returns the status' name, for example "SMR_E_ARENA", never NULL. */
const char *smr_status_name(smr_status status);

/* Returns the capabilities that this build leaves out (docs/LINKING.md): "", or words of "image partial track contact
 * dynamics references". Calls and settings of a left-out capability get E_CONFIG. */
const char *smr_built_without(void);

#define SMR_ALIGN 64u             /* bytes: alignment of all memory handed over */
#define SMR_COORD_MAX 1.0e5f      /* mm: largest absolute coordinate accepted */
#define SMR_VERTICES_MAX 4000000u /* most vertices of a model, a target surface or a cloud */
#define SMR_TRIANGLES_MAX 8000000u
#define SMR_STRUCTURES_MAX 1024u
#define SMR_NAME_BYTES 64u /* bytes of a structure's name, with the closing NUL */
#define SMR_RADII_MAX 16u
#define SMR_LEVELS_MAX 24u /* priority levels of a model */
#define SMR_LANDMARKS_MAX 64u
#define SMR_REFERENCES_MAX 16u /* shapes of a model, its own included */
#define SMR_FIXED_MAX 64u      /* fixed surfaces of a registration */
#define SMR_WORKERS_MAX 64u
#define SMR_ALL 0xffffffffu    /* as a structure: every structure */
#define SMR_NONE 0xffffffffu   /* as an index: no triangle, or no vertex */
#define SMR_FINEST 0xffffffffu /* as a radius index: the last radius of the model */

typedef struct smr_port smr_port;     /* the platform's threads and clock: section 7 */
typedef struct smr_volume smr_volume; /* an image of voxels: section 11 */

/* ------------------------------------------------------------------ 2. meshes and target surfaces */
/* A triangle mesh in the caller's memory. Isolated or duplicate vertices, zero-area triangles, non-manifold edges and
 * several components are legal. Neighbours carry vertices without triangles (nodes inside a volume mesh, landmarks),
 * even as a structure of their own. A target's vertices without triangles do not attract. */
typedef struct smr_mesh {
    const float *xyz;          /* [n_vertices][3] mm. Vertex positions, finite, within +-SMR_COORD_MAX */
    const uint32_t *triangles; /* [n_triangles][3] vertex indexes, each < n_vertices; NULL if n_triangles is 0 */
    uint32_t n_vertices;       /* number of vertices, 1..SMR_VERTICES_MAX */
    uint32_t n_triangles;      /* number of triangles, 0..SMR_TRIANGLES_MAX */
} smr_mesh;

/* A target surface made ready for closest-point search, in the caller's memory. */
typedef struct smr_surface smr_surface;

/* Copies the mesh into `memory` (SMR_ALIGN-aligned, smr_surface_bytes()) and builds its search tree there. The mesh
 * needs at least one triangle and may be freed afterwards. `memory` must stay as long as the surface is used.
 * Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT. */
smr_status smr_surface_bytes(uint32_t n_vertices, uint32_t n_triangles, size_t *bytes);
smr_status smr_surface_build(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface);

/* ------------------------------------------------------------------ 3. prepare: surfaces -> model */
typedef struct smr_structure {
    const char *name; /* name, cut to SMR_NAME_BYTES - 1 bytes; "" or NULL: no name */
    smr_mesh mesh;
} smr_structure;

/* The settings of smr_prepare(): section 8. Most models set n_radii and radius_mm only. */
typedef struct smr_prepare_config smr_prepare_config;
smr_prepare_config smr_prepare_config_default(void);

/* Writes the model. scratch and model are SMR_ALIGN-aligned; scratch may be freed afterwards. smr_prepare_bytes()
 * returns the bytes of scratch for these structures and reads only their counts. *model_bytes returns the model's size.
 * With model NULL smr_prepare() only computes *model_bytes. Where model_capacity is too small, smr_prepare() returns
 * E_ARENA and *model_bytes holds the needed size. No macro bounds scratch or model for static storage: run
 * smr_prepare_bytes() and smr_prepare() with model NULL once for the structures, and use the returned sizes.
 * Errors: E_NULL, E_CONFIG, E_ALIGN, E_ARENA, E_INPUT, E_ABORTED, E_STATE (the port, as in smr_tick()). */
smr_status smr_prepare_bytes(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                             size_t *scratch_bytes);
smr_status smr_prepare(const smr_structure *structures, uint32_t n_structures, const smr_prepare_config *config,
                       void *scratch, size_t scratch_bytes, void *model, size_t model_capacity, size_t *model_bytes);

/* A prepared model, used where it lies: position-independent bytes, little-endian on every host, with a checksum. */
typedef struct smr_model smr_model;

/* Checks every byte that the runtime trusts, and returns the memory itself as a model. memory (SMR_ALIGN-aligned, may
 * lie in flash) must stay unchanged while the model is used. Errors: E_NULL, E_ALIGN, E_MODEL. */
smr_status smr_model_open(const void *memory, size_t bytes, const smr_model **model);

/* ------------------------------------------------------------------ 4. set up a registration */
enum { SMR_METHOD_RIGID = 0, SMR_METHOD_POLAR = 1 };

/* config.basic: the settings that most programs change. The comment of each setting starts with unit, range and
 * default. A second default is that of smr_config_default_image(). */
typedef struct smr_basic_config {
    uint32_t n_workers; /* threads, [1, 64], default 1. Threads with memory in the arena, at least smr_port.n_workers */
    /* vertices, [0, 4000000], default 0. Capacity for target points: the vertices of all target surfaces set at one
     * time, plus the capacities of all clouds. 0: surfaces of any size are accepted and do not attract. */
    uint32_t n_target_vertices;
    /* 0 or 1, default 1. 1: target vertices attract the model if n_target_vertices is not 0. 0: target vertices do not
     * attract; surfaces of any size are accepted, clouds are refused, and the arena has no memory for attraction. */
    uint32_t attract;
    uint32_t method; /* SMR_METHOD_..., default rigid. How a cluster's rotation is computed */
    /* iterations, [1, 100000], default 60, 20. Most iterations at each radius except the last, not counting iterations
     * that only repair folds. With an image the first of several radii has twice this number. */
    uint32_t iterations;
    uint32_t iterations_last; /* iterations, [1, 100000], default 30, 40. Most iterations at the last radius */
    /* share, [0, 1], default 1. Share of the vertices that take part, the most important first (paper 2.2, complexity
     * tuning). Ignored vertices get no force, belong to no cluster, and move with the nearby active vertices. At least
     * smr_model_info.active_min vertices take part. */
    float active_share;
    uint32_t budget_exact; /* 0 or 1, default 0. 1: a budget leaves out no vertex and changes no bit of the result */
    float search_mm; /* mm, (0, 100000], default 60. Largest distance from a vertex to a closest point that is a goal */
    float attraction; /* share, [0, 1], default 0.5. Weight of target vertices' pulls in a goal; 0: only clouds pull */
    /* share, [0, 1], default 0. Share of the displacement to the goal along the model's surface that counts. At 0 the
     * result does not depend on the inputs' pose. At 1 the distances between the surfaces become smallest. */
    float slide;
    /* share, [0, 1], default 0.5. Share of a vertex' motion along the surface, relative to its neighbours' motion, that
     * is undone at the last radius with a target; it falls to 0 at the end. Above 0, noise is smoothed, too. */
    float even;
} smr_basic_config;

/* All settings (section 17): basic, image, partial, track, contact, dynamics, references, caller, forces, motion,
 * schedule. */
typedef struct smr_config smr_config;
smr_config smr_config_default(void);

/* A registration in progress, inside the caller's arena. */
typedef struct smr smr;

/* Sets up a registration at the model's rest shape in arena (SMR_ALIGN-aligned, smr_arena_bytes() or more). smr_init()
 * copies config and port. port NULL means one worker and no clock. model and arena must keep their addresses: calls
 * with a copy return E_STATE. Errors: E_NULL, E_CONFIG, E_ALIGN, E_ARENA, E_INPUT (the size exceeds size_t), E_MODEL
 * (at least 64 readable bytes that are no model; smr_model_open() finds all other damage). */
smr_status smr_arena_bytes(const smr_model *model, const smr_config *config, size_t *bytes);
smr_status smr_init(const smr_model *model, const smr_config *config, const smr_port *port, void *arena, size_t bytes,
                    smr **s);

/* A similarity: x'[r] = m[r][0..2] . x + m[r][3]; columns 0 to 2 are rotation times scale, column 3 is in mm. */
typedef struct smr_pose {
    float m[3][4];
} smr_pose;

/* Moves the whole model's rest shape by a pose, makes the moved shape the start, and restarts the schedule.
 * Errors: E_NULL, E_STATE, E_INPUT (an entry or a moved vertex beyond SMR_COORD_MAX; a singular or mirroring pose: the
 * determinant of columns 0 to 2 is outside [1e-9, 1e9]). */
smr_status smr_set_pose(smr *s, const smr_pose *pose);

/* Sets the positions of a structure, or of SMR_ALL, all in a row: [n_vertices][3] mm in the caller's vertex order.
 * The present positions of all structures become the reference shape x^r, and the schedule restarts.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
smr_status smr_set_positions(smr *s, uint32_t structure, const float *xyz);

/* Sets the target surface of a structure, or of SMR_ALL, borrowed until another target replaces the surface. NULL
 * removes the target: neighbours then carry the structure along. An iteration under way without all of its forces
 * computes its forces again; an iteration with all of its forces ends with the goals on the old target. Once the call
 * has returned and no other structure has the old target, the library no longer reads the old target's memory. A
 * finished schedule stays finished until smr_set_pose() or smr_set_positions(). With config.track.mode the model
 * follows the new target; after a refit, set the refitted surface again by this call.
 * Errors: E_NULL, E_STATE (not a registration, or not a surface), E_INPUT (no such structure), E_ARENA (more vertices
 * than config.basic.n_target_vertices, where that number is not 0 and config.basic.attract is 1). */
smr_status smr_set_surface(smr *s, uint32_t structure, const smr_surface *surface);

/* ------------------------------------------------------------------ 5. iterate */
enum { SMR_PHASE_FORCES = 0, SMR_PHASE_SUMS, SMR_PHASE_MATCH, SMR_PHASE_AVERAGE, SMR_PHASE_EVOLVE, SMR_PHASES };

/* Details of a tick's report. */
typedef struct smr_tick_details {
    uint32_t phase;            /* SMR_PHASE_... in which the next tick resumes; 0 after a complete iteration */
    uint32_t radius;           /* index of this tick's radius; of the next iteration's radius if the tick had no work */
    uint32_t radius_iteration; /* complete iterations at `radius`, not counting iterations that only repair folds */
    /* Number of vertices that take part: the first n_taken in the order of priority. The iteration ignores all others.
     * After a partial tick that has not computed all forces: an upper bound. */
    uint32_t n_taken;
    uint32_t n_wanted;   /* number of vertices that would take part without a budget */
    uint32_t n_active;   /* number of the n_taken vertices with a target */
    uint32_t n_rejected; /* number of the n_active vertices without an acceptable goal */
    uint32_t n_guarded;  /* number of vertices that config.motion.fold_guard held back, unfolded or repaired */
    /* share, 0..1. Share of the vertices that searched for a goal and have one, in the last iteration in which a vertex
     * searched (in noisy images: of the most important ones). -1: no search since an input was set. */
    float matched_share;
    float attraction_used;                  /* config.basic.attraction if target vertices attracted the model, else 0 */
    float residual_rms_mm, residual_max_mm; /* mm. Root mean square and largest residual; -1: not measured */
    uint64_t phase_ns[SMR_PHASES];          /* ns; time of this tick in each phase; 0 without a clock */
    uint32_t plastic_updates;               /* number of times since the start that the reference shape x^r became x */
    uint32_t tracking;   /* 1: the schedule has ended and the model follows targets (config.track); done stays 0 */
    uint32_t settled;    /* 1: the tracked model has settled; ticks change nothing until a target is set */
    uint32_t jumped;     /* 1: the first goals of the present targets were beyond config.track.jump_mm, or missing */
    uint32_t recovering; /* 1: the coarser radii run again after a jump; the positions are not good yet */
    /* Number of successful smr_set_surface(), _points(), _volume(), _landmarks() and _goals() calls up to the targets
     * that the positions follow. The number rises with the first complete iteration on new targets; 0: at the start. */
    uint32_t target_serial;
} smr_tick_details;

typedef struct smr_tick_report {
    uint32_t iteration; /* number of complete iterations since the start */
    uint32_t done;      /* 1: the schedule has ended; further ticks change nothing */
    /* 1: done is 1, the last iteration moved every vertex by less than plastic_um, and matched_share is above 0. A
     * target that is set after the end resets converged to 0. */
    uint32_t converged;
    float progress;    /* completed share of the schedule's iterations, 0..1 */
    uint32_t n_forces; /* number of vertices with an external force */
    /* mm. Mean distance of visible vertices to their target surface; to their goals on a cloud, in an image and at
     * landmarks. -1: not measured in the last complete forces, or since a target, the image or positions were set;
     * n_active, n_forces and n_rejected are then 0. */
    float residual_mean_mm;
    float displacement_max_mm; /* mm. Largest displacement of a vertex in the last complete iteration */
    uint64_t state_hash;       /* smr_state_hash(): equal bits have an equal hash on every processor */
    smr_tick_details details;
} smr_tick_report;

/* Runs one registration iteration (paper 2.3, the closing list): external forces, shape matching, averaging, evolution.
 * With budget_ns 0, or a port without a clock, it is one whole iteration. With a budget a tick evaluates forces by
 * priority until the rest of the iteration needs the remaining time; other vertices are ignored, none where even the
 * fewest exceed the budget, nor into an image without tracking. If the budget ends within the iteration, the tick stops
 * between two chunks of work and returns SMR_PARTIAL. The last complete positions then stay valid, and the next tick
 * resumes the iteration. Every tick does at least one chunk of work. Once the schedule has ended, a tick changes
 * nothing. report may be NULL. Errors: E_NULL, E_STATE (not a registration; a target has changed, or is being refitted;
 * inputs are missing after smr_restore(); called from within a tick; the caller's force broke its contract; the port
 * left out a task or used an illegal worker number; then the last complete positions stay, and ticks return E_STATE
 * until smr_set_pose() or smr_set_positions()). */
smr_status smr_tick(smr *s, uint64_t budget_ns, smr_tick_report *report);

/* Copies a structure's positions to xyz[n_vertices][3], mm, in the caller's order. Errors: E_NULL, E_INPUT, E_STATE. */
smr_status smr_get_positions(const smr *s, uint32_t structure, float *xyz);

/* ------------------------------------------------------------------ 6. verdict */
/* Levels of a verdict by its probability. FAILED: very likely wrong, though what is visible may be right. */
enum { SMR_VERDICT_GOOD = 0, SMR_VERDICT_LOOK = 1, SMR_VERDICT_FAILED = 2 };
#define SMR_PROBABILITY_GOOD 0.8f    /* a verdict with a higher probability is good */
#define SMR_PROBABILITY_FAILED 0.05f /* a verdict with a lower probability is failed */

/* Measures of a structure, or of the whole model. -1: not measured. */
typedef struct smr_verdict {
    uint32_t level;          /* SMR_VERDICT_... */
    uint32_t reasons;        /* sum of SMR_REASON_... (section 7); 0 if the level is good */
    float probability;       /* 0..1. Probability that errors are below 1 mm (surface) and 3 mm (vertices) */
    float expected_error_mm; /* mm, or -1. Mean smr_get_expected_error() of all vertices in structures visible enough */
    /* mm, or -1. Mean expected errors: across the surface, along the surface, and at visible vertices */
    float expected_across_mm, expected_along_mm, expected_visible_mm;
    float visible_share; /* 0..1, or -1. Visible share of the model's area; in an image, share of vertices with goals */
    /* 0..1, or -1. Share of the target's area that the model covers: the model is no farther away than a mean edge or
     * twice the residual. Measured only where target vertices attract (config.basic.attract, n_target_vertices). */
    float target_covered;
    float other_share;   /* 0..1, or -1. Target's area in bodies that the model does not reach; a cloud's outliers */
    float residual_mm;   /* mm, or -1. Mean distance of visible vertices to the target, or to goals in an image */
    float normals_agree; /* 0..1, or -1. Share of the model's area on the target with normals within 90 degrees */
    /* -1..1, or -1. Intensity profiles in place are compared with places 12 to 36 mm away along the normal: share of
     * comparisons won less share lost. Chance gives about 0. */
    float image_similarity;
    float goals_share;  /* 0..1, or -1. Share of the vertices searched for in the image that have a goal */
    float strain;       /* share. Root mean square change of edge lengths from rest, without the model's scale */
    float stretch;      /* share. Root mean square change of parts' sizes from rest, without the model's scale */
    float volume_ratio; /* volume divided by the volume at rest, without the model's scale; 1 for open surfaces */
    float rotation_deg; /* degrees, 0..180. Largest rotation of a part from rest, relative to the whole model */
    float turned_deg; /* degrees, 0..180. Rotation of the model from the start; above 40 rigid kinematics is inexact */
    float bend_mm;    /* mm along an axis. Smooth displacement from the start that no rigid motion explains */
    float scale, scale_rest; /* present size divided by the size at the start, and by the size at rest */
    /* ratio. Distance from the convex blends of the model's subjects / distance between subjects; -1: one subject. */
    float subjects_ratio;
    float moved_last_mm; /* mm. Largest displacement of a vertex of the whole model in the last iteration */
} smr_verdict;

/* Measures and judges one structure, or SMR_ALL, without a change of the result, on the port's threads. The cost is a
 * closest point for each vertex and target triangle, and about 9,000 multiplications for each vertex. In pieces:
 * smr_verdict_begin(). Errors: E_NULL, E_INPUT, E_STATE (no registration; within a tick; a changed target; an iteration
 * under way: tick until SMR_OK). */
smr_status smr_get_verdict(smr *s, uint32_t structure, smr_verdict *verdict);

/* Returns one sentence for one bit of smr_verdict.reasons: measure and advice. Any other argument gives "". */
const char *smr_reason_text(uint32_t bit);

/* ------------------------------------------------------------------ 7. threads, clock, further reports */
/* Runs one task of a parallel loop. worker is in 0..n_workers-1, and only one thread uses a worker number at a time. A
 * task with another number is not run. Where a task has not run, the call that needs it returns SMR_E_STATE. */
typedef void (*smr_task)(void *arg, uint32_t task, uint32_t worker);

/* Threads and clock that the platform provides; see docs/PORTING.md. */
struct smr_port {
    void *ctx;
    uint32_t n_workers; /* number of workers of `parallel`, 1..SMR_WORKERS_MAX */
    /* Calls run(arg, t, w) once for each t < n_tasks, in any order, on any workers w. Returns when all tasks are done
     * and their writes are visible. NULL: the caller's thread loops. In a task setters and smr_tick() get E_STATE. */
    void (*parallel)(void *ctx, smr_task run, void *arg, uint32_t n_tasks);
    uint64_t (*now_ns)(void *ctx); /* returns monotonic nanoseconds; NULL: no clock, and budgets and times are 0 */
};

/* A call in pieces, for little time at once. smr_NAME_begin() checks and borrows the call's arguments; the state lies
 * in the caller's job, which may be left at any time. smr_job_step() does the work. */
#define SMR_JOB_BYTES 2048u
typedef struct smr_job {
    uint64_t state[SMR_JOB_BYTES / 8u];
} smr_job;

/* Continues a job for `units` pieces of about 100,000 instructions of a Cortex-M7 (0: no limit), or until budget_ns
 * have passed by the port's clock (0, or no clock: no limit), to the end of a piece on each worker. port NULL: the
 * call's own port, or none. Limits and threads change no bit. SMR_OK: the results are written. SMR_PARTIAL: work is
 * left. Errors: E_NULL, E_CONFIG (n_workers), E_STATE (no job; a registration that has since got a tick, a setter or
 * another measure; the port, as in smr_tick()), those of the call NAME. */
smr_status smr_job_step(smr_job *job, uint32_t units, const smr_port *port, uint64_t budget_ns);

/* Begin smr_model_open(), smr_init(), smr_set_pose() and smr_set_positions() in pieces. Memory that arguments name
 * stays borrowed; config, port and pose are copied. Until SMR_OK arena holds no registration. While positions are
 * being written, other calls with s return E_STATE; after a job that was left smr_set_pose() starts anew. */
smr_status smr_model_open_begin(const void *memory, size_t bytes, const smr_model **model, smr_job *job);
smr_status smr_init_begin(const smr_model *model, const smr_config *config, const smr_port *port, void *arena,
                          size_t bytes, smr **s, smr_job *job);
smr_status smr_set_pose_begin(smr *s, const smr_pose *pose, smr_job *job);
smr_status smr_set_positions_begin(smr *s, uint32_t structure, const float *xyz, smr_job *job);

/* Tests whether compiler and processor compute float arithmetic as the library needs. Returns 0, or a sum of
 * SMR_FLOAT_...; any flag means that results have other bits than elsewhere. The test needs no memory and some hundred
 * instructions. Each thread has its own floating-point mode: call the test at power-on in the context of smr_tick(). */
uint32_t smr_self_test(void);
#define SMR_FLOAT_FUSED 1u    /* products and sums are fused: -ffp-contract=off is missing */
#define SMR_FLOAT_FLUSHED 2u  /* denormals become 0: FTZ or DAZ on x86, FPSCR.FZ on Arm, a vector unit */
#define SMR_FLOAT_EXCESS 4u   /* results have more bits than a float (x87), or sums are reordered (-ffast-math) */
#define SMR_FLOAT_ROUNDING 8u /* rounding is not to nearest even, or quotients and square roots are estimates */

/* Reasons for a verdict other than good, with the measure of smr_verdict. */
#define SMR_REASON_NOTHING_VISIBLE 1u /* no vertex had a goal in the last complete forces */
#define SMR_REASON_LITTLE_VISIBLE 2u  /* visible_share is low, or expected_error_mm is high compared with bend_mm */
#define SMR_REASON_EXPECTED 4u        /* expected_error_mm is high */
#define SMR_REASON_UNCOVERED 8u       /* target_covered is low */
#define SMR_REASON_NORMALS 16u        /* normals_agree is low */
#define SMR_REASON_RESIDUAL 32u       /* residual_mm, beyond a cloud's noise, is high beside the edge lengths */
#define SMR_REASON_SCALE 64u          /* scale is far from 1 */
#define SMR_REASON_STRAIN 128u        /* strain or stretch is high */
#define SMR_REASON_VOLUME 256u        /* volume_ratio is far from 1 */
#define SMR_REASON_ROTATION 512u      /* rotation_deg is high, or structures have turned far apart */
#define SMR_REASON_BEND 1024u         /* bend_mm is high */
#define SMR_REASON_SIMILARITY 2048u   /* image_similarity is low */
#define SMR_REASON_GOALS 4096u        /* goals_share is low */
#define SMR_REASON_STRUCTURES 8192u   /* for SMR_ALL: structures that are not good make up much of the model */
#define SMR_REASON_RECOVERING 16384u  /* recovering is 1, or no iteration on the present targets is complete */
#define SMR_REASON_UNCHECKED 32768u   /* no whole round of smr_set_scrub() since the last iteration */
#define SMR_REASON_BOUND 65536u       /* many edges were stretched beyond config.motion.strain_most */
#define SMR_REASON_SUBJECTS 131072u   /* subjects_ratio is high */

/* Writes each vertex' expected distance from its true place to mm[n_vertices], or the parts across and along the
 * true surface; one part may be NULL. -1: too little is visible for an estimate. Errors: as smr_get_verdict(). */
smr_status smr_get_expected_error(smr *s, uint32_t structure, float *mm);
smr_status smr_get_expected_parts(smr *s, uint32_t structure, float *across_mm, float *along_mm);

/* Begin smr_get_verdict(), smr_get_expected_error() with parts (unwanted: NULL), smr_get_local_volume() in pieces. */
smr_status smr_verdict_begin(smr *s, uint32_t structure, smr_verdict *verdict, smr_job *job);
smr_status smr_expected_begin(smr *s, uint32_t structure, float *mm, float *across_mm, float *along_mm, smr_job *job);
smr_status smr_local_volume_begin(smr *s, uint32_t structure, float radius_mm, float *ratio, smr_job *job);

/* smr_get_visible() writes visible[n_vertices], in the caller's order. 1: the target shows the vertex, by the last
 * complete forces; 0: it follows other vertices. smr_get_normals() writes xyz[n_vertices][3], in the caller's order:
 * unit normals, or 0 where no triangle has an area. Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
smr_status smr_get_visible(const smr *s, uint32_t structure, unsigned char *visible);
smr_status smr_get_normals(const smr *s, uint32_t structure, float *xyz);

typedef struct smr_structure_report {
    uint32_t has_target; /* 1: has a surface, image, own landmark or caller's goals; 0: carried by neighbours */
    uint32_t n_forces;   /* number of the structure's vertices with an external force, in the last complete forces */
    uint32_t n_rejected;
    float matched_share;                     /* share of searched vertices that have a goal; -1: no search */
    float residual_mean_mm, residual_max_mm; /* mm. Mean and largest residual; -1: not measured */
    float moved_mean_mm, moved_max_mm;       /* mm. Mean and largest displacement from the start positions */
} smr_structure_report;
smr_status smr_get_structure_report(const smr *s, uint32_t structure, smr_structure_report *report);

/* Computes the rigid pose that best maps the rest shape of a structure, or of SMR_ALL, onto the visible vertices; onto
 * all if fewer than 3 are visible. *residual_mm: mean distance of visible vertices in that pose to the planes through
 * their last goals; -1: not measured since an input was set or restored, or within an iteration. After the first
 * complete iteration on a target this is a pose for navigation. Errors: E_NULL, E_INPUT, E_STATE. */
smr_status smr_get_pose(const smr *s, uint32_t structure, smr_pose *pose, float *residual_mm);

/* Writes ratio[n_vertices], in the caller's order; for SMR_ALL, of all structures in a row. A ratio is the volume
 * between the surface of the vertex' cluster and the cluster's centre, with the scale, divided by that volume at rest,
 * -1e6..1e6; below 0: inside out. The less the surface surrounds the cluster, the more the ratio is the change of
 * area; without a surface, it is the cube of the model's scale. radius_mm: 0..SMR_COORD_MAX; of the radii at which
 * clusters hold all vertices the nearest is taken; 0: eight mean edges. Choose one as large as the structure is thick.
 * The call takes as long as an iteration. Errors: as smr_get_verdict(), and E_STATE without inputs. */
smr_status smr_get_local_volume(smr *s, uint32_t structure, float radius_mm, float *ratio);

/* Returns a hash of the reference shape, and of the positions relative to the start's whole millimetres; 0 for NULL. */
uint64_t smr_state_hash(const smr *s);

/* Sets the number of active vertices from the next iteration on: the first n_active in the order of priority take part.
 * The number is raised to smr_model_info.active_min of the radius and cut to the vertices that the radius' clusters
 * hold. With 0, the initial value, configuration and budget decide. smr_set_pose() and smr_set_positions() keep the
 * number. Ticks with the n_taken of recorded iterations, without clock, repeat these bits. Errors: E_NULL, E_STATE. */
smr_status smr_set_active(smr *s, uint32_t n_active);

/* ------------------------------------------------------------------ 8. prepare and models in detail */
enum { SMR_DISTANCE_EUCLIDEAN = 0, SMR_DISTANCE_GEODESIC = 1 };
enum { SMR_MASS_UNIT = 0, SMR_MASS_AREA = 1 };
enum { SMR_ORDER_FOREST = 0, SMR_ORDER_BREADTH_FIRST = 1 };

/* Called between pieces of work, `done` of `total` complete. A non-zero result stops the work: SMR_E_ABORTED. */
typedef int (*smr_progress)(void *ctx, uint32_t done, uint32_t total);

/* Shapes of n further subjects, 0..SMR_REFERENCES_MAX - 1, such as results of registering the model onto them. */
typedef struct smr_subjects {
    const float *xyz; /* [n][vertices of all structures in a row][3] mm, within +-SMR_COORD_MAX, in any pose and size */
    uint32_t n;
} smr_subjects;

/* Each setting's comment starts with unit, range and default; smr_prepare_settings() returns the settings as data. */
struct smr_prepare_config {
    uint32_t cookie; /* SMR_COOKIE of this struct; smr_prepare_config_default() sets it */
    /* radii, [0, 16], default 0: chosen from the surfaces' size and edge length. Number of cluster radii. With a
     * reference image 60, 40, 25 and 15 mm are chosen; a single structure also gets its length and a third of that. */
    uint32_t n_radii;
    /* mm, [1e-06, 100000]. Cluster radii s, coarse to fine; elements from n_radii on are ignored. */
    float radius_mm[SMR_RADII_MAX];
    /* mm, [-100000, 100000], default -1: chosen. At radii below this value each cluster contains one structure only. 0:
     * no limit. Negative: a third of the largest radius; with a reference image, the finest radius alone. */
    float separate_below_mm;
    uint32_t profile_samples; /* samples, [3, 64], default 20. Intensity samples on a vertex' normal (paper 3: 30) */
    float profile_step_mm;    /* mm, (1e-06, 100], default 0.5. Distance between two samples */
    /* share, [-1, 1], default -1: all samples but 1.6 voxels of the reference. Share of the samples on the inner side
     * of the surface. The inside differs less between people than the surroundings. Negative: chosen. */
    float profile_inward;
    uint32_t distance; /* SMR_DISTANCE_..., default euclidean (paper 2.2). Distance by which clusters are built */
    uint32_t mass;     /* SMR_MASS_..., default unit: 1 for each vertex, 1/16 for a vertex without triangles */
    uint32_t order;    /* SMR_ORDER_..., default forest. Order L in which sums over clusters are computed (paper 2.2) */
    uint32_t ring;     /* 0 or 1, default 1. 1: clusters include mesh neighbours, at radii from the mean edge up */
    /* 0 or 1, default 1. 1: vertices are stored in the order of importance (paper 2.2, complexity tuning), so a
     * registration can ignore the last vertices. 0: all vertices always take part. */
    uint32_t priority;
    uint32_t block_vertices; /* vertices, 0 or [16, 65536], default 0: by model size. Vertices in a task of sums */
    /* Pointers of the caller that smr_prepare() reads during the call; NULL by default. */
    const smr_volume *reference; /* image that fits the model; the source of intensity profiles */
    const smr_subjects *also;    /* shapes of further subjects: config.references */
    smr_progress progress;
    void *progress_ctx;
    const smr_port *port; /* threads; NULL: the calling thread alone. The model's bytes do not depend on port */
};

/* Returns the paper's settings: one radius of 30 mm for all structures together, 30 samples, half of them inside. */
smr_prepare_config smr_prepare_config_paper(void);

/* Sizes and measures of a model. Arrays without a stated shape have one element for each radius, coarse to fine. */
typedef struct smr_model_info {
    uint32_t n_vertices, n_triangles, n_structures, n_radii;
    float centre[3]; /* mm. Origin of the model's internal coordinates */
    float edge_mm;   /* mm. Mean length of a triangle edge; 0 without triangles */
    float radius_mm[SMR_RADII_MAX];
    float indexes_per_cluster[SMR_RADII_MAX]; /* mean number of stored indexes per cluster: zeta+, zeta- and roots */
    float direct_per_cluster[SMR_RADII_MAX];  /* mean number of vertices per cluster, |zeta|, all read by direct sums */
    uint32_t largest_cluster[SMR_RADII_MAX];  /* vertices of the largest cluster (half up to 1 um beyond the radius) */
    uint32_t smallest_cluster[SMR_RADII_MAX];
    uint32_t n_blocks[SMR_RADII_MAX];
    uint32_t separate[SMR_RADII_MAX];   /* 1: each cluster contains one structure only */
    uint32_t active_min[SMR_RADII_MAX]; /* fewest active vertices with at least 3 (or all) in each cluster */
    uint32_t n_levels;                  /* number of priority levels, the most important first; 1 without priority */
    uint32_t level_end[SMR_LEVELS_MAX]; /* [n_levels]: number of vertices in a level and all levels before it */
    uint32_t order;                     /* SMR_ORDER_... of smr_prepare_config.order */
    uint32_t profile_samples;           /* samples of each intensity profile; 0: no profiles */
    uint32_t n_references;              /* number of shapes, the model's own included */
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

/* Copies a structure's rest shape as given to smr_prepare(), in the caller's vertex and triangle order, to
 * xyz[n_vertices][3] (mm) and triangles[n_triangles][3]. Either pointer may be NULL. */
smr_status smr_model_mesh(const smr_model *model, uint32_t structure, float *xyz, uint32_t *triangles);

/* ------------------------------------------------------------------ 9. surfaces: closest points, building in steps */
typedef struct smr_closest {
    float point[3];     /* mm. Closest point on the surface */
    float normal[3];    /* unit normal of the triangle */
    float distance;     /* mm. Distance from the given point to the closest point */
    uint32_t triangle;  /* the caller's index of the triangle; SMR_NONE: no triangle within max_mm */
    float weight[3];    /* barycentric coordinates of the point in the triangle; the sum is 1 */
    uint32_t on_border; /* 1: the point lies on an edge with one triangle only */
} smr_closest;

/* Finds the exact closest point of the surface to `point` (3 floats, mm), within max_mm (0 or more). normal: NULL, or 3
 * floats, unit: only triangles whose normal has at least the cosine min_cos with `normal` count. Of equally near ones
 * the smallest index wins. hit->triangle SMR_NONE: none is near. Errors: E_NULL, E_STATE (not a surface), E_INPUT. */
smr_status smr_surface_closest(const smr_surface *surface, const float *point, const float *normal, float min_cos,
                               float max_mm, smr_closest *hit);

/* Writes mm[n], the distances of n points xyz[n][3], mm, to the surface; -1: a cloud without points. A list in which
 * neighbours lie near each other takes a part of the time of smr_surface_closest(). Errors: as there. */
smr_status smr_surface_distances(const smr_surface *surface, const float *xyz, uint32_t n, float *mm);

/* Begins smr_surface_build() in pieces, for callers with little time at once; smr_surface_step() does the work. Until
 * then the mesh must stay, and other calls get E_STATE. Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT (a count). */
smr_status smr_surface_begin(const smr_mesh *mesh, void *memory, size_t bytes, smr_surface **surface);

/* Begins to replace the positions of a complete surface's vertices by xyz[n_vertices][3] mm, in the mesh's order,
 * which the library borrows; smr_surface_step() does the work. A registration onto the surface may not tick
 * (E_STATE) until the refit is complete and smr_set_surface() has set it again. A log's checksum of the surface
 * depends on both positions, so a replay refits. Errors: E_NULL, E_STATE (not a complete surface). */
smr_status smr_surface_refit(smr_surface *surface, const float *xyz);

/* Continues a build or a refit for `units` pieces of work of at most 256 vertices or triangles each (0: no limit), or
 * until budget_ns have passed by the port's clock (0, or no clock: no limit), to the end of a piece. Limits change
 * no bit. SMR_OK: the surface is complete. SMR_PARTIAL: work is left. Errors: E_NULL, E_STATE (not a surface),
 * E_INPUT (an index, a coordinate, a changed cloud): a built surface is then no surface, a refitted one as before. */
smr_status smr_surface_step(smr_surface *surface, uint32_t units, const smr_port *port, uint64_t budget_ns);

/* ------------------------------------------------------------------ 10. start poses */
typedef struct smr_align_config {
    uint32_t cookie;       /* SMR_COOKIE of this struct; smr_align_config_default() sets it */
    uint32_t scaled;       /* 0 or 1, default 1. 0: a rigid pose; 1: a rigid pose with one scale */
    uint32_t iterations;   /* 1..1000, default 60. Number of closest-point iterations of the last refinement */
    uint32_t samples;      /* 16..100000, default 600. Number of points taken from each surface */
    const smr_pose *given; /* known pose of the model, tried as well; NULL (default): the identity */
    const smr_port *port;  /* threads that share the work; NULL (default): one */
    uint32_t n_parts;      /* 0..SMR_STRUCTURES_MAX, default 0. Number of structures that get poses of their own */
    struct smr_align_part *part; /* [n_parts] these structures, which joints connect; NULL without */
} smr_align_config;
smr_align_config smr_align_config_default(void);

/* Result of smr_align(). Distances are measured in both directions, between the parts that both surfaces have. */
typedef struct smr_align_report {
    float rms_mm;               /* mm. Root mean square of the remaining distances */
    float model_share;          /* 0..1. Share of the model's area that lies on the target */
    float target_share;         /* 0..1. Share of the target's area that lies on the model */
    float scale;                /* scale factor of the pose */
    float second_rms_mm;        /* mm. rms_mm of the best clearly different pose; 0: no such pose was found */
    float mirrored_rms_mm;      /* mm. rms_mm of the mirrored model; clearly below rms_mm: perhaps the other side */
    uint32_t n_alike;           /* number of clearly different poses that fit equally well; above 1 if symmetric */
    uint32_t given;             /* 1: the result is the known pose, config.given (NULL: the identity) */
    uint32_t model_inside_out;  /* 1: a closed model with triangles facing inwards, which smr_align() reverses */
    uint32_t target_inside_out; /* 1: a closed target with triangles facing inwards, which smr_align() reverses */
    uint32_t n_other;           /* number of clearly different poses that were compared */
    smr_pose other[3];          /* [n_other] those poses, as starts for smr_articulated_begin() */
} smr_align_report;

typedef struct smr_align_part {
    const smr_surface *model, *target; /* its surface, in the model; its target, which several may share */
    smr_pose pose;                     /* result. Target NULL, or no pose found: that of the neighbour */
    smr_align_report report;           /* result; all 0 with the neighbour's pose */
    uint32_t order;                    /* result: 1..n_parts, the order of placement; the largest is first */
} smr_align_part;

/* Finds the pose that lays `model`, or a part, onto `target`, or a part, also a cloud. With config.part each structure
 * then gets its own rigid pose from rest, for smr_set_positions(): joints are where surfaces touch at rest, and *pose
 * is the whole's. memory: SMR_ALIGN-aligned, smr_align_bytes() (E_NULL, E_CONFIG). report may be NULL. Errors: E_NULL,
 * E_STATE (not a surface), E_CONFIG, E_ALIGN, E_ARENA, E_INPUT (no pose, or config.given is no pose). */
smr_status smr_align_bytes(const smr_align_config *config, size_t *bytes);
smr_status smr_align(const smr_surface *model, const smr_surface *target, const smr_align_config *config, void *memory,
                     size_t bytes, smr_pose *pose, smr_align_report *report);
smr_status smr_align_begin(const smr_surface *model, const smr_surface *target, const smr_align_config *config,
                           void *memory, size_t bytes, smr_pose *pose, smr_align_report *report, smr_job *job);

/* Finds start positions xyz[n_vertices][3], mm, of one surface whose parts have turned about joints. The target may
 * show a part. start: one part lies about right in it. *bent 0: it explains both surfaces, or turned parts do not; xyz
 * stays. Else 1 + 1e6 * the share unexplained before rigid parts move, 0..1.5: the least of several is right. memory:
 * SMR_ALIGN-aligned, smr_articulated_bytes(). Errors: E_NULL, E_STATE (no mesh), E_INPUT (start), E_ALIGN, E_ARENA. */
smr_status smr_articulated_bytes(const smr_surface *model, const smr_surface *target, size_t *bytes);
smr_status smr_articulated_begin(const smr_surface *model, const smr_surface *target, const smr_pose *start,
                                 const smr_port *port, void *memory, size_t bytes, float *xyz, uint32_t *bent,
                                 smr_job *job);

/* Computes the least-squares pose that lays from[i] onto to[i], both [n][3] mm, n <= SMR_LANDMARKS_MAX; scaled 1: with
 * the ratio of spreads as scale. *rms_mm (or NULL): rms of the remaining distances. Of several best rotations (fewer
 * than 3 pairs, or all on a line) it is one. Errors: E_NULL, E_INPUT (n, scaled, non-finite, beyond SMR_COORD_MAX). */
smr_status smr_align_landmarks(const float *from, const float *to, uint32_t n, uint32_t scaled, smr_pose *pose,
                               float *rms_mm);

typedef struct smr_warp smr_warp; /* a thin-plate spline in the caller's memory */
/* Kinds of warps. Landmarks that do not determine a spline give the most general kind that these determine. */
enum { SMR_WARP_SPLINE = 0, SMR_WARP_SCALED = 1, SMR_WARP_RIGID = 2, SMR_WARP_TRANSLATION = 3 };

/* Fits a thin-plate spline (kernel |r| in three dimensions, Bookstein 1989) from from[i] to to[i], both [n][3] mm.
 * smoothing: mm, 0 or more. With 0 the spline passes through every landmark; more brings it nearer to its affine
 * part. *kind is SMR_WARP_..., the kind that the landmarks determine: rigid with one scale for coplanar places,
 * rigid for collinear or fewer than 3, a translation for one. Duplicates are averaged. memory (SMR_ALIGN-aligned,
 * smr_warp_bytes()) holds the warp. Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT (n, a coordinate, smoothing). */
smr_status smr_warp_bytes(uint32_t n, size_t *bytes);
smr_status smr_warp_fit(const float *from, const float *to, uint32_t n, float smoothing, void *memory, size_t bytes,
                        smr_warp **warp, uint32_t *kind);

/* Moves n points xyz[n][3] mm by the warp, in place. Errors: E_NULL, E_STATE (not a warp), E_INPUT (a point not
 * finite or beyond SMR_COORD_MAX). */
smr_status smr_warp_apply(const smr_warp *warp, float *xyz, uint32_t n);

/* ------------------------------------------------------------------ 11. images (paper 2.1) */
enum { SMR_SIMILARITY_NCC = 0, SMR_SIMILARITY_SSD = 1, SMR_SIMILARITY_CONCORDANCE = 2 };
enum { SMR_EDGE_REFERENCE = 0, SMR_EDGE_STEEPEST = 1 };
enum { SMR_BLEND_CONFIDENCE = 0, SMR_BLEND_PLAIN = 1 };
enum { SMR_VOXEL_UINT8 = 0, SMR_VOXEL_INT8, SMR_VOXEL_UINT16, SMR_VOXEL_INT16, SMR_VOXEL_FLOAT };

/* An image: voxels in the caller's memory, which the library borrows and only reads. */
struct smr_volume {
    const void *voxels;  /* [size[2]][size[1]][size[0]], host byte order, naturally aligned; NaN: outside the image */
    const uint8_t *mask; /* [size[2]][size[1]][size[0]]; 0 means outside the image; NULL: no mask */
    uint32_t type;       /* SMR_VOXEL_...: type of a voxel */
    uint32_t size[3];    /* voxels along each axis, 1..65536 */
    float origin[3];     /* mm. Centre of the first voxel */
    float spacing[3];    /* mm, > 0. Distance of neighbouring voxels' centres along each axis */
    float direction[9];  /* row-major 3 x 3; columns are the axes' unit vectors and do not lie in one plane */
};

/* config.image. Vertices search along the normal, inwards and outwards. Search distances fall linearly. */
typedef struct smr_image_config {
    float profile_mm;     /* mm, [0, 60], default 10, 30. Search distance of profile matching at the schedule's start */
    float profile_end_mm; /* mm, [0, 60], default 0, 2. Search distance of profile matching at the schedule's end */
    float gradient_mm;    /* mm, [0, 60], default 5. Search distance for an image edge at the schedule's start */
    float gradient_end_mm; /* mm, [0, 60], default 0, 2. Search distance for an image edge at the schedule's end */
    /* SMR_SIMILARITY_..., default concordance. Similarity of a profile and the image: normalised cross-correlation, sum
     * of squared differences, or concordance. Another contrast or brightness lowers concordance. */
    uint32_t similarity;
    float confidence; /* share, [0, 1], default 0.3. A goal with a confidence at or below this yields no force */
    /* cluster radii, (0, 1000000], default 0.5. Upper bound on the profile search distance, because the far side of a
     * neighbour lies farther away. Where fewer than 80 % of a structure's vertices had a goal, the bound grows to at
     * most the smaller of one radius and half the structure's thickness. */
    float profile_radii;
    /* share, [0, 1], default 0.5. Share of the tangential displacement to the place where the image is most like the
     * profile. The goal on the normal is moved by this share. 0: goals lie on the normal, as in the paper. */
    float sideways;
    /* share, [0, 1], default 1. Share of the displacement to the mean of the mesh neighbours, for a vertex without a
     * goal in the image. A vertex is excluded if the image is undecided: no profile, or a search that leaves the image
     * or meets one value only. A structure is excluded if fewer than half of its vertices have a goal. */
    float fill;
    /* share, [0, 1], default 0. Weight of image goals beside a closed target surface, whose goals weigh 1. Beside an
     * open surface or a cloud, image goals weigh 1 and target goals a vertex' visibility. */
    float beside;
    float nearer;   /* score per mm, [0, 1], default 0.005. Score lost per mm from the vertex: nearer places win ties */
    uint32_t edge;  /* SMR_EDGE_..., default reference. Edge goal: the edge most like the reference's, or steepest */
    uint32_t blend; /* SMR_BLEND_..., default confidence. Weights of profile and edge goals: confidence, or 1 (paper) */
    uint32_t fade;  /* 0 or 1, default 1. 1: forces and momentum fall to 0 at the end, and in mere noise */
    uint32_t rest;  /* iterations, [0, 60], default 2. A still vertex keeps its goal so long; 0, or tracking: none */
} smr_image_config;

/* Returns the defaults for images, whose goals are noisy and far: x^r is set to x less often; more iterations. */
smr_config smr_config_default_image(void);

/* Sets the image of every structure without a target surface; the library borrows the image until the next image. NULL
 * removes the image. The schedule restarts from the present positions. While the model follows moving targets
 * (config.track), a new image is followed, too: profiles are searched from 0.3 of the way to profile_end_mm on, within
 * half the radius. The memory of the previous image is free when the call returns. Tangentially, and at vertices
 * without a goal, structures then follow a smooth displacement field from the schedule's result through all vertices
 * with a goal. Once surfaces, clouds (except for added points) or landmarks are set again without a new image, the
 * image goals move along with the other targets until the next image.
 * Errors: E_NULL (voxels), E_INPUT (the volume's fields), E_STATE (no profiles). */
smr_status smr_set_volume(smr *s, const smr_volume *volume);

/* ------------------------------------------------------------------ 12. partial targets: clouds and landmarks */
enum { SMR_COVERAGE_AUTO = 0, SMR_COVERAGE_WHOLE = 1, SMR_COVERAGE_PARTIAL = 2 };

/* config.partial: partial targets, noise and landmarks. */
typedef struct smr_partial_config {
    /* SMR_COVERAGE_..., default auto. Whether target surfaces show the whole model or a part. With a partial target a
     * vertex' weight is its visibility, which falls beyond an open border, where normals disagree, and where the
     * target's closest points lie elsewhere on the model. Occluded vertices follow the image, or a smooth field of
     * visible vertices. auto: whole for closed surfaces of which the model covers nine tenths. whole: no memory. */
    uint32_t coverage;
    /* mm, [0, 100], default 0. Noise of clouds and target surfaces. Points nearer to the model attract
     * nothing; farther points attract by the excess of distance. At 0 the noise of many points averages out. */
    float noise_mm;
    uint32_t n_landmarks; /* landmarks, [0, 64], default 0. Largest number of landmarks; 0 takes no memory */
} smr_partial_config;

/* A cloud of points as a target, in the caller's memory: a ring buffer that keeps the newest points. A cloud shows the
 * part of the model on which its points lie; other vertices follow (config.partial.coverage). */
typedef struct smr_points smr_points;

/* Creates an empty cloud in `memory` (SMR_ALIGN-aligned, smr_points_bytes()), which must stay as long as the cloud is
 * used. capacity: 1..SMR_VERTICES_MAX points. Errors: E_NULL, E_ALIGN, E_ARENA, E_INPUT. */
smr_status smr_points_bytes(uint32_t capacity, size_t *bytes);
smr_status smr_points_open(uint32_t capacity, void *memory, size_t bytes, smr_points **points);

/* Copies n points, at most the capacity, into the cloud; in a full cloud the new points replace the oldest. A point
 * takes about 50 ns. xyz: [n][3] mm, finite, within +-SMR_COORD_MAX. normals: [n][3], outwards, of any length; 0 0 0
 * marks a point without a normal; NULL: no point has a normal. weights: [n], 0..4; a point of weight 0 is ignored;
 * NULL: every weight is 1. The call is not allowed while smr_tick() runs. Repeat every smr_set_points() of the cloud
 * after the call. Errors: E_NULL, E_STATE (not a cloud), E_INPUT. */
smr_status smr_points_add(smr_points *points, const float *xyz, const float *normals, const float *weights, uint32_t n);

/* Sets the weight of one point of the cloud, 0..4. index counts added points from 0, modulo the capacity. Repeat every
 * smr_set_points() of the cloud. Errors: E_NULL, E_STATE, E_INPUT (no such point, or the weight). */
smr_status smr_points_weigh(smr_points *points, uint32_t index, float weight);

/* Removes all points; repeat every smr_set_points() of the cloud. *n: number of points. Errors: E_NULL, E_STATE. */
smr_status smr_points_clear(smr_points *points);
smr_status smr_points_count(const smr_points *points, uint32_t *n);

/* Copies the cloud as a surface for searches: smr_surface_closest() finds the nearest point and returns the point's
 * index as the triangle, and smr_align() lays a model onto the points. smr_set_surface() refuses the copy, and
 * smr_set_points() takes the cloud itself. n: points in the cloud, 1 or more. memory (SMR_ALIGN-aligned) stays the
 * caller's and holds the surface. smr_points_surface_begin() begins the copy in pieces; the cloud must stay unchanged
 * until smr_surface_step() returns SMR_OK.
 * Errors: E_NULL, E_STATE (not a cloud), E_ALIGN, E_ARENA, E_INPUT (no point). */
smr_status smr_points_surface_bytes(uint32_t n, size_t *bytes);
smr_status smr_points_surface(const smr_points *points, void *memory, size_t bytes, smr_surface **surface);
smr_status smr_points_surface_begin(const smr_points *points, void *memory, size_t bytes, smr_surface **surface);

/* Sets a cloud as the target of a structure, or of SMR_ALL, in place of a surface; the library borrows the cloud until
 * another target replaces it. NULL removes the target. config.basic.n_target_vertices must be at least the capacities
 * of all clouds plus the vertices of all surfaces set at one time. An empty cloud shows no vertex: neighbours carry the
 * structure. After points were added, smr_tick() returns E_STATE until this call. All else is as for smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration, or not a cloud), E_INPUT (no such structure), E_ARENA. */
smr_status smr_set_points(smr *s, uint32_t structure, const smr_points *points);

/* A point of the model and its present place. */
typedef struct smr_landmark {
    uint32_t structure; /* structure of the point; SMR_ALL (without a vertex): the structure nearest at rest */
    uint32_t vertex; /* the caller's index of the vertex; SMR_NONE: the triangle nearest to `rest` carries the point */
    float rest[3];   /* mm. The point in the model's rest shape, on a surface or off it; ignored if `vertex` is set */
    float place[3];  /* mm. Present place of the point */
    float weight;    /* [0.001, 1000]. 1 / variance of the place; weight 1 equals that of a visible vertex */
    uint32_t hard;   /* 1: the point ends at `place`, and `weight` is ignored; 0: the weight decides */
} smr_landmark;

/* Replaces all landmarks by copies of n landmarks; n 0 removes all. Where no target shows the model, the model follows
 * a smooth displacement field through the landmarks. Where a target shows the model, landmarks decide along the
 * surface, and a hard landmark is always reached. New places of unchanged points cost next to nothing; a new point at
 * rest costs a pass over all triangles. Forces under way are treated as by smr_set_surface().
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (more than config.partial.n_landmarks), E_INPUT (no such
 * structure or vertex, a structure without vertices, a field outside its range). */
smr_status smr_set_landmarks(smr *s, const smr_landmark *landmarks, uint32_t n);

/* Writes the present places of the landmarks' points to xyz[n][3] mm, in the order set. Errors: E_NULL, E_STATE. */
smr_status smr_get_landmarks(const smr *s, float *xyz);

/* config.references: models with shapes of further subjects (smr_prepare_config.also). After smr_set_pose(), vertices
 * that a target does not show follow a convex blend of all shapes; the visible vertices choose the weights. Start
 * positions in reports, verdicts and energies are then those of the shapes' mean. */
typedef struct smr_references_config {
    /* factor, [0.01, 1000000], default 300. Strength of the prior that all shapes have equal weights */
    float prior;
} smr_references_config;

/* Writes weights[*n <= SMR_REFERENCES_MAX] of the last forces' blend, the own shape first; 1 without further shapes.
 * Errors: E_NULL, E_STATE. */
smr_status smr_get_reference_weights(const smr *s, float *weights, uint32_t *n);

/* ------------------------------------------------------------------ 13. tracking: targets that move */
enum { SMR_TRACK_OFF = 0, SMR_TRACK_REPORT = 1, SMR_TRACK_RECOVER = 2 };

/* config.track. After the coarse-to-fine schedule the model follows targets that smr_set_surface(), smr_set_points(),
 * smr_set_volume() or smr_set_landmarks() replace between ticks. The model is elastic about the schedule's result: x^r
 * is that shape with each structure moved rigidly, and does not creep. */
typedef struct smr_track_config {
    /* SMR_TRACK_..., default off. report: the model follows targets, and smr_tick_details.jumped reports jumps.
     * recover: after a jump the model also runs the coarser radii again. The arena grows by SMR_ARENA_TRACK_BYTES. */
    uint32_t mode;
    /* mm, [0, 100000], default 0: six mean edges; with several structures at most the largest at which clusters keep to
     * their own structure. Cluster radius while following, the model's nearest. Larger radii are stiffer. */
    float radius_mm;
    /* mm, [0, 100000], default 0: a twelfth of the radius. Smallest mean distance to the goals of new targets that
     * counts as a jump. New targets without any goal also count as a jump. */
    float jump_mm;
    float settle_um;     /* um, [0, 100000000], default 20. Displacement below which the model rests, or 1/5 residual */
    uint32_t iterations; /* iterations, [1, 100000], default 30. Most iterations for one position of the targets */
    /* share, [0, 1], default 0. When targets are set, each structure first repeats this share of its rigid displacement
     * between the last two times that targets were set. The prediction suits targets at even intervals. After a jump no
     * prediction is made. Momentum of the last iteration keeps the remaining share. The first tick on new targets
     * applies the prediction at once, in one pass over vertices and triangles, whatever its budget; positions show the
     * prediction even after a partial tick. Use one to three ticks a target. */
    float ahead;
} smr_track_config;

/* ------------------------------------------------------------------ 14. contact, volume and smoothness */
/* config.contact. A vertex inside another closed structure, or a fixed surface, moves out over the shortest distance.
 * Two structures in contact both move, the lighter farther, and slide freely. Overlap at rest is removed, too. */
typedef struct smr_contact_config {
    /* share, [0, 1], default 0: off. Share of the displacement out of the other surface in each iteration; 1 is the
     * usual value. Contact excludes dynamics. Unless 0, the arena has SMR_ARENA_CONTACT_BYTES more. */
    float share;
    float gap_mm;     /* mm, [0, 100], default 0. Distance kept between surfaces */
    uint32_t n_fixed; /* surfaces, [0, 64], default 0. Largest number of fixed surfaces; 0 takes no memory */
    /* share, [0, 1], default 0: off. Share of a closed structure's missing volume that each iteration restores, by
     * equal displacements along the normals. At 1 each iteration meets the asked volume: the rest shape's volume in the
     * scale of the start, times the ratio of smr_set_volume_ratio(). Below 1 the volume is a compromise with the goals.
     * The volume of open structures is not preserved. Unless 0, the arena has SMR_ARENA_VOLUME_BYTES more. */
    float volume;
    /* share, [0, 1], default 0: off. Weight of smoothing on the surface; goals have the remaining weight. Smoothing
     * moves a vertex along its normal until its height above the mean of its mesh neighbours is as at rest. The effect
     * is largest at the finest radii. Unless 0, the arena has SMR_ARENA_SMOOTH_BYTES more. */
    float smooth;
} smr_contact_config;

/* Sets fixed surface number index, out of which structures are kept; the library borrows the surface until the next
 * call, and NULL removes the surface. A closed surface has an inside that no vertex may enter: an implant inside a bone
 * keeps off the bone's surface. An open surface has its outside where its normals point, and does not act beyond its
 * border. Fixed surfaces act only if config.contact.share is above 0. Set a refitted surface again.
 * Errors: E_NULL, E_STATE (not a registration, not a complete surface, or a cloud), E_ARENA (config.contact.n_fixed is
 * 0), E_INPUT (index is not below config.contact.n_fixed). */
smr_status smr_set_fixed(smr *s, uint32_t index, const smr_surface *surface);

/* Overlap of two closed surfaces a and b. All fields are 0 if a surface is open and thus has no inside. */
typedef struct smr_contact_report {
    float deepest_mm; /* mm. Largest depth in the other surface, of vertices and three points a triangle */
    float a_in_b_mm;  /* mm. Largest depth of a's surface in b, such as of a bone a in an implant b */
    float volume_mm3; /* mm^3. Volume inside both surfaces */
    float area_mm2;   /* mm^2. Area of a surface inside the other, or within within_mm of the other; mean of both */
} smr_contact_report;

/* Measure the contact of two surfaces, in pieces and at once; clouds are refused. within_mm: 0..100, the distance that
 * counts as contact. The call takes about as long as the closest points of both surfaces' vertices, and no time for
 * surfaces whose boxes are apart. For a result, pass surfaces built of the structures' positions. Errors: E_NULL,
 * E_STATE (not a complete surface with triangles, or changed since the begin), E_INPUT. */
smr_status smr_surface_contact(const smr_surface *a, const smr_surface *b, float within_mm, smr_contact_report *report);
smr_status smr_surface_contact_begin(const smr_surface *a, const smr_surface *b, float within_mm,
                                     smr_contact_report *report, smr_job *job);

/* Sets the asked volume of a closed structure, or of each closed structure (SMR_ALL): ratio, 0.1..10, times the rest
 * shape's volume in the scale of the start. The scale of the start is that of the similarity that best lays the model's
 * rest shape onto the start positions. Until set, the ratio is 1. The volume approaches the asked one by 4 % an
 * iteration. smr_set_pose() and smr_set_positions() keep the ratio.
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.contact.volume is 0), E_INPUT (no such structure, a
 * structure that encloses no volume, a ratio outside its range). */
smr_status smr_set_volume_ratio(smr *s, uint32_t structure, float ratio);

/* Volumes of a structure. A structure encloses a volume if each edge belongs to as many triangles in one direction as
 * in the other. The rest volume is positive, also where triangles face inwards at rest; a structure turned inside out
 * has a negative present volume. smr_get_structure_volume() takes one pass over the model's vertices and the
 * structure's triangles, config.contact.volume on or off. Errors: E_NULL, E_INPUT, E_STATE (not a registration). */
typedef struct smr_structure_volume {
    uint32_t closed;   /* 1: the structure encloses a volume; 0: all other fields are 0, too */
    float rest_mm3;    /* mm^3. Volume of the rest shape in the scale of the start (smr_set_volume_ratio()) */
    float asked_mm3;   /* mm^3. Asked volume, which the 4 % steps approach; 0 while config.contact.volume is 0 */
    float present_mm3; /* mm^3. Volume at the positions of the last complete iteration */
    float asked_ratio; /* asked_mm3 / rest_mm3 */
    float ratio;       /* present_mm3 / rest_mm3 */
} smr_structure_volume;
smr_status smr_get_structure_volume(const smr *s, uint32_t structure, smr_structure_volume *volume);

/* ------------------------------------------------------------------ 15. dynamics */
enum { SMR_DYNAMICS_OFF = 0, SMR_DYNAMICS_ON = 1 };
#define SMR_SWEEPS 8u          /* iterations in a time step of dynamics */
#define SMR_GRAVITY_MAX 1.0e6f /* mm/s^2: largest gravity along an axis */

/* config.dynamics. In place of the schedule, the model has mass and moves in time by implicit Euler, from the start
 * pose, which is the shape at rest. The cluster radius is config.track.radius_mm. SMR_SWEEPS iterations make a time
 * step, and velocities are new when smr_tick_report.iteration is a multiple of SMR_SWEEPS. More iterations would let
 * stiffness act farther. Each structure is elastic about its shape at rest. Forces are springs to their goals; their
 * strength is `stiffness` times that of shape matching. All vertices take part, folds are not repaired, and done stays
 * 0. Where clusters deform much, as small clusters around few pinned vertices do, set `method` to polar. */
typedef struct smr_dynamics_config {
    /* SMR_DYNAMICS_..., default off. Excludes track, volume, smooth and contact. Memory: SMR_ARENA_DYNAMICS_BYTES. */
    uint32_t mode;
    float step_ms;    /* ms, [0.01, 1000], default 10. Length of a time step. Every length is stable; long steps damp */
    float damping;    /* 1/s, [0, 1000000], default 1. Force against the velocity, for each unit of mass and velocity */
    float gravity[3]; /* mm/s^2, [-1000000, 1000000], default 0. Acceleration along the caller's axes; Earth: 9810 */
    /* 1/s^2, [0, 100000000], default 10000. Stiffness of shape matching for each unit of mass: a vertex away from the
     * mean of its clusters swings with sqrt(elastic) / 2 pi Hz. */
    float elastic;
} smr_dynamics_config;

/* Sets masses and velocities of a structure's vertices, in the caller's order, as copies. mass: [n_vertices] g, 1e-6 to
 * 1e6, or INFINITY. A vertex of mass INFINITY is pinned: forces do not change its velocity, and clusters turn about the
 * vertex. mass NULL keeps the masses; the first masses are those of smr_prepare_config.mass. A mass counts as at most
 * 1024 times the mean mass and is rounded to 1/32 of the mean; smr_get_energy() returns the masses that count.
 * velocity: [n_vertices][3] mm/s, within +-1e6; NULL keeps the velocities. An iteration under way restarts.
 * smr_set_pose(), smr_set_positions() and smr_set_volume() set velocities to 0 and keep masses.
 * Errors: E_NULL (both pointers), E_STATE (not a registration, or inputs are missing), E_ARENA (config.dynamics.mode is
 * off), E_INPUT (no such structure, a value outside its range). */
smr_status smr_set_motion(smr *s, uint32_t structure, const float *mass, const float *velocity);

/* Writes the velocities of a structure's vertices to velocity[n_vertices][3] mm/s, in the caller's order, at the end of
 * the last complete time step or as set since.
 * Errors: E_NULL, E_INPUT, E_STATE (not a registration), E_ARENA (config.dynamics.mode is off). */
smr_status smr_get_velocities(const smr *s, uint32_t structure, float *velocity);

/* Energies of all structures together, in uJ; 1 uJ is 1000 g mm^2/s^2.
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.dynamics.mode is off). */
typedef struct smr_energy {
    uint32_t steps;    /* number of complete time steps since the start */
    uint32_t sweeps;   /* number of complete iterations in the present step, 0..SMR_SWEEPS - 1 */
    uint32_t n_pinned; /* number of pinned vertices */
    float mass_g;      /* g. Mass that counts (smr_set_motion()) of the vertices that are not pinned */
    float centre[3];   /* mm. Present centre of mass of the vertices that are not pinned */
    float kinetic_uj;  /* uJ. Kinetic energy of the velocities of smr_get_velocities(), without pinned vertices */
    float gravity_uj;  /* uJ. Present potential energy in gravity; 0 at the start positions */
    float elastic_uj;  /* uJ. Elastic energy at the last complete step: half of deviation times force, accurate while
                          parts turn little against each other; at most the remainder that the other energies leave */
    float goals_uj;    /* uJ. Energy of the springs to the goals at the last complete step */
} smr_energy;
smr_status smr_get_energy(const smr *s, smr_energy *energy);

/* ------------------------------------------------------------------ 16. goals and forces of the caller's own */
enum { SMR_CALLER_OFF = 0, SMR_CALLER_ON = 1, SMR_CALLER_CHECKED = 2 };

/* config.caller: whether the arena has memory for goals and forces of the caller's own. */
typedef struct smr_caller_config {
    uint32_t goals; /* 0 or 1, default 0. 1: the arena has memory for smr_set_goals() */
    /* SMR_CALLER_..., default off. on: the arena has memory for smr_set_force(). checked: the library also makes each
     * call twice, and smr_tick() returns SMR_E_STATE if the two results differ. */
    uint32_t force;
} smr_caller_config;

/* Sets goals of the caller's own for a structure: xyz[n_vertices][3] mm and weights[n_vertices], 0..1000, in the
 * caller's vertex order. Weight 0 means no goal; weights NULL means weight 1 for all. The library borrows both arrays
 * until the next call; set changed arrays again; xyz NULL removes the goals. A target's goal has weight 1.
 * Displacements to goals are averaged by weight, so a single goal counts in full, whatever its weight.
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.caller.goals is 0), E_INPUT (no such structure, a goal
 * beyond SMR_COORD_MAX or not finite, a weight outside its range). */
smr_status smr_set_goals(smr *s, uint32_t structure, const float *xyz, const float *weights);

/* Input of the caller's force: n vertices. The force may only read the view, and only until the force returns. */
typedef struct smr_force_view {
    uint32_t n;                /* number of vertices in the view */
    uint32_t iteration;        /* number of complete iterations since the start */
    float radius_mm;           /* mm. Present cluster radius */
    const uint32_t *structure; /* [n] structure of each vertex */
    const uint32_t *vertex;    /* [n] index of each vertex in the caller's numbering of its structure */
    const float *xyz;          /* [n][3] mm. Present positions */
    const float *normal;       /* [n][3] present unit normals; 0 where no triangle has an area */
    const float *rest;         /* [n][3] mm. Positions in the model's rest shape */
} smr_force_view;

/* Adds each vertex' wanted displacement to displacement[n][3] (mm) and the weight of that displacement to weight[n],
 * 0..1000, as in smr_set_goals(). Both arrays are 0 before the call; weight 0 means no force. The port's workers call
 * the function, several at a time, once for each vertex in an iteration. The function must depend only on the view and
 * on data behind ctx that do not change during a tick. The function must not call the library with the registration. */
typedef void (*smr_force)(void *ctx, const smr_force_view *view, float *displacement, float *weight);

/* Sets a force of the caller's own; NULL removes the force. The force is part of a tick's forces, under the same
 * budget. smr_tick() returns E_STATE until the force is set again, if a displacement is not finite or beyond
 * SMR_COORD_MAX, if a weight is outside its range, or if the force breaks its contract (config.caller.force checked).
 * Errors: E_NULL, E_STATE (not a registration), E_ARENA (config.caller.force is off). */
smr_status smr_set_force(smr *s, smr_force force, void *ctx);

/* ------------------------------------------------------------------ 17. experts' settings, and all settings */
enum { SMR_NORMALS_CARRIED = 0, SMR_NORMALS_EXACT = 1 };
enum { SMR_PLASTIC_LARGEST = 0, SMR_PLASTIC_MEAN = 1 };
enum { SMR_FUSING_LINEAR = 0, SMR_FUSING_LIE = 1 };

/* config.forces: external forces onto surfaces and into images. */
typedef struct smr_forces_config {
    /* share, (0, 1], default 0.8. force = stiffness * (goal - x): the paper's alpha_e. Stiff or soft: cluster radii. */
    float stiffness;
    float search_radii; /* cluster radii, (0, 1000000], default 1.5. Search distance, at most halved with each radius */
    float normal_deg;   /* degrees, (0, 180], default 75. Largest angle between normals of vertex and closest point */
    /* standard deviations, [0, 1000000], default 0: off. Forces above the last iteration's mean + so many: none. */
    float reject_deviations;
    uint32_t reject_border; /* 0 or 1, default 0. 1: closest points on the border of an open target are not goals */
    uint32_t node_budget;   /* tree nodes, [8, 1000000], default 512. Most nodes that one closest-point search opens */
    /* share, [0, 1], default 0.06. Goals shift to where a mesh bulges as the model does. Acts on one whole body, not
     * noisy, flat, like a ball or refitted, before the last radius; not with contact.share, use_box or noise_mm. */
    float curvature;
    uint32_t use_box; /* 0 or 1, default 0. 1: vertices outside the box get no force */
    float box_min[3]; /* mm, [-100000, 100000], default 0. Lowest corner of the box, used only with use_box */
    float box_max[3]; /* mm, [-100000, 100000], default 0. Highest corner of the box, nowhere below the lowest */
} smr_forces_config;

/* config.motion: how positions and the reference shape follow the forces (paper 2.3). */
typedef struct smr_motion_config {
    float relaxation; /* share, (0, 1], default 1. Step length: x += relaxation * (averaged goal - x) */
    float momentum;   /* share, [0, 0.99], default 0.8, 0.7. Share of the last displacement added to the forces */
    /* share, [0, 0.99], default 0, 0.6. Momentum at the last radius, where momentum moves vertices on the surface. */
    float momentum_last;
    float plastic_um; /* um, [0, 100000000], default 50. Reference shape x^r is set to x below this displacement */
    /* iterations, [0, 1000], default 1, 5. The reference shape x^r is set to the positions x also after this many
     * iterations. 0: only at rest (plastic_um) or at the end of a radius, so the model springs back to its shape. */
    uint32_t plastic_every;
    uint32_t plastic_by; /* SMR_PLASTIC_..., default largest. Displacement that plastic_um bounds: largest, or mean */
    /* share, [0, 1000], default 1.5. Edges stretched against the rest shape by more than this are shortened before x^r
     * follows; a part of the strain beyond remains. Verdicts tell of one in 1,000 (SMR_REASON_BOUND). 0: no bound. */
    float strain_most;
    /* um, [0, 100000000], default 1. A radius ends early when the largest displacement falls below this. The last
     * radius does not end early while `even` acts on a target surface and a vertex moves. 0: none ends early. */
    float settle_um;
    /* share, [0, 1], default 0.1, 0. A radius before the last ends, too, when an iteration's mean displacement falls
     * below settle_share * first radius / radius of the mean distance to goals; half with clouds or other bodies. */
    float settle_share;
    /* 0 or 1, default 1. 1: at the last two radii folds are repaired, and displacements that would fold triangles are
     * limited; at the last radius remaining folded edges are opened. */
    uint32_t fold_guard;
    /* SMR_NORMALS_..., default carried. Vertex normals: carried by the clusters' rotations and recomputed whenever x^r
     * is set to x, or recomputed exactly in each iteration. */
    uint32_t normals;
    float turn_deg; /* degrees, [0, 85], default 0: 86 deg. Largest turn of a cluster by rigid kinematics (paper: 20) */
    /* SMR_FUSING_..., default linear. Mean of the transforms of a vertex' clusters: linear averages their matrices
     * (paper 2.3) and shrinks where the clusters' rotations differ; lie averages their logarithms and gives a rigid
     * motion. The two means differ where x^r is rarely set to x (plastic_every). */
    uint32_t fusing;
} smr_motion_config;

/* config.schedule: radii from coarse to fine, and the number of active vertices. */
typedef struct smr_schedule_config {
    uint32_t radius_first; /* index, default 0. Index of the first radius used */
    uint32_t radius_last;  /* index, default SMR_FINEST. Index of the last radius used, not below radius_first */
    /* share, [0, 1], default 1. Active share at the schedule's start; grows to active_share if below it. */
    float active_first;
    /* vertices, [0, 1000000], default 30. With an image, and at radii before the last if settle_share is not 0, this
     * many active vertices in the smallest cluster suffice, if 1,000 of the whole model are active, too; the iteration
     * ignores all other vertices. The number is rounded to whole priority levels. 0: active_share alone decides. */
    uint32_t active_enough;
} smr_schedule_config;

struct smr_config {
    uint32_t cookie;                  /* SMR_COOKIE of this struct; smr_config_default() sets it */
    smr_basic_config basic;           /* what most programs change: section 4 */
    smr_image_config image;           /* intensity images: section 11 */
    smr_partial_config partial;       /* partial targets, noise, landmarks: section 12 */
    smr_track_config track;           /* moving targets: section 13 */
    smr_contact_config contact;       /* contact, volume and smoothness: section 14 */
    smr_dynamics_config dynamics;     /* mass, velocity and gravity: section 15 */
    smr_references_config references; /* shapes of further subjects: section 12 */
    smr_caller_config caller;         /* the caller's own goals and forces: section 16 */
    smr_forces_config forces;
    smr_motion_config motion;
    smr_schedule_config schedule;
};

/* Returns the paper's settings of a registration, for a model of smr_prepare_config_paper(); docs/GUIDE.md lists the
 * settings. The paper's start is smr_warp_fit() with smoothing 0. */
smr_config smr_config_paper(void);

/* Kinds of settings. GROUP: a heading, with a name only. COUNT: uint32_t. NUMBER: one or more floats, as `bytes` says.
 * CHOICE: uint32_t, index of one of the words in `unit`, such as "rigid|polar". SWITCH: uint32_t, 0 or 1. */
enum { SMR_SETTING_GROUP = 0, SMR_SETTING_COUNT, SMR_SETTING_NUMBER, SMR_SETTING_CHOICE, SMR_SETTING_SWITCH };
enum { SMR_SETTING_POINTER = 5 };

/* One field of a configuration, for command lines and documents. Constant data, linked only where used. */
typedef struct smr_setting {
    const char *name; /* name in logs, reports and options ("track_mm" of config.track.radius_mm), or a heading */
    const char *unit; /* unit, such as "mm", or a choice's words; "" for none */
    const char *text; /* meaning of the field, one sentence */
    uint32_t kind;    /* SMR_SETTING_...: type of the field */
    uint32_t number;  /* number of the field in logs; never changes */
    uint32_t offset;  /* bytes from the start of smr_config or smr_prepare_config to the field */
    uint32_t bytes;   /* bytes of the field; an array has 4 bytes an element */
    uint32_t open;    /* 1: the value `low` is not legal */
    uint32_t or_zero; /* 1: the value 0 is legal outside the range, too */
    /* Range of each element, with `high` included. CHOICE: 0 and the last word's index. POINTER: both 0. Two defaults
     * lie outside their range: SMR_FINEST of radius_last, and 0 of radius_mm beyond n_radii. */
    double low, high;
    double value, image; /* default of each element, and default for images */
} smr_setting;

/* Return the fields of smr_config and smr_prepare_config in order, with headings; *n (n may be NULL) rows. */
const smr_setting *smr_config_settings(uint32_t *n);
const smr_setting *smr_prepare_settings(uint32_t *n);

/* ------------------------------------------------------------------ 18. carried points */
/* A smooth map of space that carries points near the model along. The vertices' rest and present places define the map,
 * which is exact at the vertices and approaches a similarity far from the model. */
typedef struct smr_carry smr_carry;

/* Binds points[n_points][3] mm, given at rest, to the vertices rest[n_vertices][3] mm: all structures in a row, from
 * smr_model_mesh() or the caller's meshes. n_points may be 0. A point takes about 20 us. memory (SMR_ALIGN-aligned,
 * smr_carry_bytes()) holds the map and must keep its address; rest and points may be freed afterwards. The call copies
 * port; later calls also use port's ctx and functions; port NULL means one worker.
 * Errors: E_NULL, E_ALIGN, E_INPUT, E_ARENA, E_STATE (the port, as in smr_tick()). */
smr_status smr_carry_bytes(uint32_t n_vertices, uint32_t n_points, uint32_t n_workers, size_t *bytes);
smr_status smr_carry_fit(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                         const smr_port *port, void *memory, size_t bytes, smr_carry **carry);
smr_status smr_carry_fit_begin(const float *rest, uint32_t n_vertices, const float *points, uint32_t n_points,
                               const smr_port *port, void *memory, size_t bytes, smr_carry **carry, smr_job *job);

/* Writes the bound points' present places to xyz[n_points][3] mm. now[n_vertices][3] mm: the vertices' present places
 * in the order of rest (smr_get_positions() for each structure). Two threads must not use a map at the same time.
 * Errors: E_NULL, E_STATE (not a map, or a copy of its memory; the port, as in smr_tick()), E_INPUT. */
smr_status smr_carry_apply(smr_carry *carry, const float *now, float *xyz);

typedef struct smr_carry_fact {
    float miss_mm; /* mm. inverse 1: error of the inverse at the point; above 0.01 the inverse was not found */
    float volume;  /* determinant of the map's gradient at rest, to about 0.1; at 0 or below the map folds */
} smr_carry_fact;

/* Maps n points xyz[n][3] mm that are not bound, in about 100 times the time of bound points. inverse 0: from rest to
 * the present; 1: from the present to rest. out: [n][3] mm, may be xyz. facts: [n], or NULL. Errors: as above. */
smr_status smr_carry_map(smr_carry *carry, const float *now, uint32_t inverse, const float *xyz, uint32_t n, float *out,
                         smr_carry_fact *facts);

/* Writes the points that represent a frame, a place with three axes, for each of points[n][3] mm at rest, to
 * places[n][SMR_FRAME_PLACES][3] mm. size_mm: extent of the frame, half an implant's or 1. Errors: E_NULL, E_INPUT. */
#define SMR_FRAME_PLACES 5u
smr_status smr_frame_places(const float *points, uint32_t n, float size_mm, float *places);

/* smr_frame_poses() computes poses[n], the rigid part of the local map from rest to the present, and jacobians[n][9],
 * the local maps, row-major, from a frame's places at rest and now; poses or jacobians may be NULL. smr_frame_normals()
 * carries unit normals[n][3], in place, with the planes that the local maps carry. Errors: E_NULL, E_INPUT. */
smr_status smr_frame_poses(const float *rest, const float *now, uint32_t n, smr_pose *poses, float *jacobians);
smr_status smr_frame_normals(const float *jacobians, float *normals, uint32_t n);

/* ------------------------------------------------------------------ 19. save and restore */
/* A save holds a registration as position-independent bytes, little-endian on every host, with a checksum. The
 * registration can continue in another arena, in another program or on another processor. A restored registration has
 * the bits of an uninterrupted registration, with any number of threads; only reported times differ. */

/* Writes s to memory[bytes] (of any alignment). smr_save_bytes() returns the exact size, which model and configuration
 * alone decide. A save holds checksums of model and inputs instead of their contents; the checksums take one pass over
 * each. Save only between complete iterations: after SMR_PARTIAL, tick until SMR_OK.
 * Errors: E_NULL, E_ARENA, E_STATE (not a registration; called from within a tick; an iteration is under way; a target
 * surface has changed; inputs are missing; the port or the caller's force broke its contract; a coordinate is beyond
 * 2e6 mm, and memory is then overwritten). */
smr_status smr_save_bytes(const smr *s, size_t *bytes);
smr_status smr_save(const smr *s, void *memory, size_t bytes);

/* Reads a save's header; smr_arena_bytes() of info->config is smr_restore()'s arena. Errors: E_NULL, E_SAVE. */
typedef struct smr_saved_info {
    size_t bytes;            /* bytes of the save; memory behind the save is ignored */
    uint32_t library;        /* version of the library that wrote the bytes: major << 16 | minor << 8 | patch */
    uint32_t model_checksum; /* smr_model_info.checksum of the model */
    uint32_t n_vertices;     /* number of vertices of the model */
    smr_config config;       /* configuration as given to smr_init(); not validated */
} smr_saved_info;
smr_status smr_save_info(const void *saved, size_t saved_bytes, smr_saved_info *info);

/* Sets up the registration of saved[saved_bytes] (of any alignment, from any source) in arena, as smr_init() does.
 * config is NULL, or the saved configuration with another n_workers. port, model and arena are as for smr_init(); saved
 * may be freed afterwards. smr_get_positions() and smr_get_normals() work at once. Every input that was borrowed at the
 * save must be set once again: by smr_set_surface() or smr_set_points() for a structure or SMR_ALL, smr_set_volume(),
 * smr_set_goals(), smr_set_fixed(), smr_set_force() (not compared), and smr_set_log() with the log (NULL ends
 * recording). While an input is missing, other calls that change or judge the registration return E_STATE. An input
 * with another checksum, or shared by other structures than at the save, gets E_INPUT (a log: E_LOG). Setting inputs
 * again restarts nothing and is not recorded.
 * Errors: those of smr_init(), E_SAVE, E_MODEL (another model), E_WITHOUT. */
smr_status smr_restore(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                       size_t saved_bytes, void *arena, size_t bytes, smr **s);

/* Begin smr_save() and smr_restore() in pieces (section 7). */
smr_status smr_save_begin(smr *s, void *memory, size_t bytes, smr_job *job);
smr_status smr_restore_begin(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                             size_t saved_bytes, void *arena, size_t bytes, smr **s, smr_job *job);

/* Returns in *n how many inputs must still be set before s ticks: structures with a surface or a cloud, the image,
 * caller's goals and force, fixed surfaces, the log. Without smr_restore() *n is 0. Errors: E_NULL, E_STATE. */
smr_status smr_get_awaited(const smr *s, uint32_t *n);

/* ------------------------------------------------------------------ 20. log and replay */
/* Starts recording s in memory[bytes] (of any alignment): the configuration, each input that is set (poses and
 * landmarks in full, other inputs by checksum), and for each tick its progress and the state's hash. The library
 * borrows memory until another log replaces it; NULL ends recording. The call is allowed only right after smr_init(),
 * so that the log is complete. Where a record does not fit, a last record SMR_LOG_FULL follows, recording ends, and the
 * registration continues. A log changes no result. Recording an input costs one pass over the input.
 * Errors: E_NULL, E_STATE (not a registration, or not right after smr_init()), E_ARENA (below SMR_LOG_BYTES(0, 0)). */
smr_status smr_set_log(smr *s, void *memory, size_t bytes);

/* State of the log of s; all fields are 0 without a log. Errors: E_NULL, E_STATE. */
typedef struct smr_log_state {
    size_t bytes;     /* bytes written; the first `bytes` bytes of the memory are a complete log after each call */
    uint32_t n_ticks; /* number of recorded ticks */
    uint32_t full;    /* 1: the memory is full and recording has ended */
} smr_log_state;
smr_status smr_get_log(const smr *s, smr_log_state *state);

typedef struct smr_log_info {
    uint32_t library, model_checksum, n_vertices; /* library's version; model's checksum and number of vertices */
    smr_config config;                            /* recorded configuration */
} smr_log_info;

/* Kinds of records; each is named after its call. LANDMARKS: one record for each landmark. FORCE: smr_set_force(), and
 * before a tick the results of the force. POINTS: smr_set_points(), and each change of the cloud. FIXED_SURFACE:
 * surface number `index`. FULL: the log's memory was full. ALL_POSITIONS: smr_set_positions() of SMR_ALL. */
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
enum { SMR_LOG_MOTION = 14, SMR_LOG_ALL_POSITIONS };

/* One record of a log. Fields that a kind does not use are 0. */
typedef struct smr_log_record {
    uint32_t kind; /* SMR_LOG_...; 0: the log ends here */
    /* Fields of a recorded input. */
    uint32_t structure; /* structure of a surface, points, positions, goals, volume ratio or motion; or SMR_ALL */
    uint32_t present;   /* 1: an input was set; 0: an input was removed (NULL) */
    uint64_t checksum;  /* checksum of a surface, points, volume, positions, goals, motion, or of a force's results */
    smr_pose pose;
    smr_landmark landmark; /* landmark number `index` of `count`; count 0: the landmarks were removed */
    uint32_t index, count;
    float ratio;   /* ratio of smr_set_volume_ratio() */
    uint32_t gave; /* SMR_LOG_FORCE: 1: checksum of what the caller's force returned; 0: the force was set or removed */
    /* Fields of a recorded tick, from the tick's report. */
    uint32_t complete; /* 1: the tick completed an iteration, or the schedule had ended; 0: SMR_PARTIAL */
    uint32_t done, phase, iteration;
    uint32_t n_taken;     /* number of active vertices; SMR_LOG_ACTIVE: the number passed to smr_set_active() */
    uint32_t n_evaluated; /* number of vertices whose forces the iteration has evaluated so far */
    uint32_t n_forces, plastic_updates;
    uint64_t state_hash;
} smr_log_record;

typedef struct smr_log_reader smr_log_reader; /* position of a reader in a log: section 23 */
typedef struct smr_replay smr_replay;         /* state of a replay: section 23 */

/* smr_log_open() opens a log of `bytes` bytes (of any alignment, from any source); info may be NULL. smr_log_next()
 * reads the next record; at the log's end the record has kind 0. Errors: E_NULL, E_LOG; after an error the reader keeps
 * its position, and smr_log_next() returns a record of kind 0. */
smr_status smr_log_open(const void *log, size_t bytes, smr_log_reader *reader, smr_log_info *info);
smr_status smr_log_next(smr_log_reader *reader, smr_log_record *record);

/* Returns the input that a record names: a const smr_surface * (a target or a fixed surface), a const smr_points * with
 * the points of that time, a const smr_volume *, a const float * (positions, [n_vertices][3], mm), or a const smr_goals
 * *, smr_motion * or smr_caller_force * (section 23). NULL means that the input is missing. */
typedef const void *(*smr_log_input)(void *ctx, const smr_log_record *record);

/* Prepares to repeat a log on s, a registration right after smr_init() with the log's model and configuration.
 * n_workers and the port may differ. log and s must stay. input may be NULL if the log has only poses and landmarks.
 * Errors: E_NULL, E_STATE (not a registration, or not right after smr_init()), E_LOG, E_MODEL (another model), E_CONFIG
 * (another configuration), E_WITHOUT. */
smr_status smr_replay_start(smr *s, const void *log, size_t bytes, smr_log_input input, void *ctx, smr_replay *replay);

typedef struct smr_replay_report {
    uint32_t tick;         /* number of the repeated tick in the log, from 1; at the log's end, the number of ticks */
    uint32_t ended;        /* 1: the log has no further tick */
    uint32_t full;         /* 1: the log ends because its memory was full */
    uint32_t differs;      /* 1: the repeated tick differs from the record */
    smr_log_record record; /* record of the tick; after an error, the record that caused the error */
    smr_log_record found;  /* result of the repeated tick, in the form of a record */
} smr_replay_report;

/* Repeats the log's next tick and the inputs set before that tick, without a clock, and compares the result with the
 * record. The first partial tick that has all forces, or else the complete one, takes the iteration's time; between the
 * former and the latter s is within an iteration. After an error or a difference the rest is not meaningful. Errors:
 * E_NULL, E_LOG, E_INPUT (an input missing, another, or refused), E_WITHOUT, those of smr_set_...() and smr_tick(). */
smr_status smr_replay_tick(smr_replay *replay, smr_replay_report *report);

/* ------------------------------------------------------------------ 21. sizes as constants, for static storage */
/* Upper bounds for nv vertices, nt triangles and ns structures. SMR_X_BYTES bounds x alone; SMR_X_Y_BYTES bounds the
 * bytes that setting y adds to x. No other setting changes a size. For example:
 * static _Alignas(SMR_ALIGN) unsigned char arena[SMR_ARENA_BYTES(1000, 2000, 1, 1, 0, SMR_METHOD_RIGID)]; */

/* Bounds of smr_surface_bytes(), 3 % too large at 1,000 triangles, 1 % from 4,000 on, and of smr_points_bytes(). */
#define SMR_SURFACE_BYTES(nv, nt)                                                                                      \
    ((size_t)2048u + (size_t)32u * (nv) + (size_t)65u * (nt) + SMR_TREE_BYTES(nt, 1u) +                                \
     (5u * (nv) > 3u * (nt) ? (size_t)20u * (nv) - (size_t)12u * (nt) : (size_t)0u))
#define SMR_POINTS_BYTES(capacity) ((size_t)1280u + (size_t)28u * (capacity))

/* Bound of smr_arena_bytes(). n_workers, n_target_vertices (0 with attract 0) and method are those of smr_basic_config.
 * Too large by 6 kB, 1.3 kB for each further structure, and 0.4 %: 2 % at 1,000 vertices, below 1 % from 5,000 on. */
#define SMR_ARENA_BYTES(nv, nt, ns, n_workers, n_target_vertices, method)                                              \
    ((size_t)8576u + ((method) == SMR_METHOD_RIGID ? (size_t)278u : (size_t)314u) * (nv) +                             \
     ((nv) < 190u ? (size_t)64u * (190u - (nv)) : (size_t)0u) + (size_t)(12u + SMR_SWAPPED_BYTES) * (nt) +             \
     (size_t)(nt) / 16u * 3u + (size_t)344u * (ns) + (size_t)2192u * (n_workers) +                                     \
     ((n_target_vertices) == 0u ? (size_t)0u                                                                           \
                                : (size_t)6080u + (size_t)40u * (ns) + (size_t)10u * (n_target_vertices) +             \
                                      (size_t)32u * (n_workers) * (nv) + SMR_TREE_BYTES(nt, ns)))
#define SMR_ARENA_LANDMARKS_BYTES(nv, n_landmarks) ((size_t)38000u + (size_t)192u * (n_landmarks) + (nv))
#define SMR_ARENA_IMAGE_BYTES(nv) ((size_t)512u + (size_t)29u * (nv)) /* added by profiles; image.rest 0: 25 nv less */
#define SMR_ARENA_TRACK_BYTES(nv, ns) ((size_t)1024u + (size_t)24u * (nv) + (size_t)96u * (ns))
#define SMR_ARENA_CONTACT_BYTES(nv, nt, ns) /* added by contact.share or contact.n_fixed */                            \
    ((size_t)4096u + (size_t)100u * (nv) + (size_t)40u * (nt) + (size_t)25u * (ns) + SMR_TREE_BYTES(nt, ns))
#define SMR_ARENA_VOLUME_BYTES(ns) ((size_t)64u + (size_t)64u * (ns)) /* added by contact.volume */
#define SMR_ARENA_SMOOTH_BYTES(nv) ((size_t)64u + (size_t)4u * (nv))  /* added by contact.smooth */
#define SMR_ARENA_DYNAMICS_BYTES(nv, ns) ((size_t)2304u + (size_t)48u * (nv) + (size_t)208u * (ns))
#define SMR_ARENA_REFERENCES_BYTES(n) ((size_t)192u + (size_t)768u * (n)) /* by a model of n shapes */
#define SMR_ARENA_CALLER_BYTES(nv, ns)                                    /* added by caller.goals or caller.force */  \
    ((size_t)256u + (size_t)16u * (nv) + (size_t)16u * (ns))

/* Bounds of smr_save_bytes(). */
#define SMR_SAVE_BYTES(nv, ns, n_target_vertices, n_landmarks, method)                                                 \
    ((size_t)1152u + ((method) == SMR_METHOD_RIGID ? (size_t)85u : (size_t)121u) * (nv) + (size_t)56u * (ns) +         \
     ((n_target_vertices) > 0u ? (size_t)252u + (size_t)4u * (n_target_vertices) : (size_t)0u) +                       \
     ((n_landmarks) > 0u ? (size_t)4u + (nv) + (size_t)200u * (n_landmarks) : (size_t)0u))
#define SMR_SAVE_IMAGE_BYTES(nv) ((size_t)25u * (nv)) /* added by profiles, but for image.rest 0 */
#define SMR_SAVE_VOLUME_BYTES(ns) ((size_t)8u * (ns))
#define SMR_SAVE_TRACK_BYTES(nv) ((size_t)128u + (size_t)24u * (nv)) /* 12 nv bytes fewer suffice without profiles */
#define SMR_SAVE_AHEAD_BYTES(ns) ((size_t)4u + (size_t)96u * (ns))   /* added by track.ahead */
#define SMR_SAVE_DYNAMICS_BYTES(nv, ns) ((size_t)128u + (size_t)40u * (nv) + (size_t)8u * (ns))
#define SMR_SAVE_REFERENCES_BYTES(n) ((size_t)56u + (size_t)4u * (n))
#define SMR_SAVE_CONTACT_BYTES(nv, n_fixed) ((size_t)4u * (nv) + (size_t)8u * (n_fixed))

/* Bound of a log of n_ticks ticks, each with the results of a caller's force, and n_sets calls of smr_set_...(), of any
 * alignment. Each landmark that is set counts as one call. */
#define SMR_LOG_BYTES(n_ticks, n_sets) ((size_t)664u + (size_t)60u * (n_ticks) + (size_t)56u * (n_sets))

/* Parts of the bounds: search trees, and the copy of the triangles on big-endian processors. */
#define SMR_TREE_BYTES(nt, ns) ((size_t)192u * ((size_t)(nt) / 7u + (size_t)8u * (ns)))
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define SMR_SWAPPED_BYTES 12u
#else
#define SMR_SWAPPED_BYTES 0u
#endif

/* ------------------------------------------------------------------ 22. faults in memory */
/* Each call checks pointers and counts: of the registration, in the model's tables and in targets' headers. After a
 * change between two calls each call returns E_DAMAGED; only smr_get_positions() and smr_get_normals() still return
 * the last complete ones, unless these may have changed, too. Other faults never lead beyond the memory, but may give
 * wrong results. smr_set_scrub() finds these faults. what: 0 (off), or the sum of
 * - SMR_SCRUB_INPUTS: each tick compares checksums of a slice of model, targets, clouds, image and fixed surfaces, in
 *   at most 1/32 of its budget. A verdict is good only if a whole round has ended since the last iteration (otherwise
 *   SMR_REASON_UNCHECKED): by ticks after the end, or by smr_scrub().
 * - SMR_SCRUB_STATE: each call checks the whole arena, and takes the arena's checksum when it ends.
 * The call takes the checksum of each input, and a setter later that of its input, in one pass. No result changes.
 * Errors: E_NULL, E_STATE (as smr_tick()), E_INPUT (what), E_DAMAGED (the model is not as it was opened, too). */
enum { SMR_SCRUB_INPUTS = 1, SMR_SCRUB_STATE = 2 };
smr_status smr_set_scrub(smr *s, uint32_t what);
smr_status smr_set_scrub_begin(smr *s, uint32_t what, smr_job *job); /* in pieces (section 7); off until the end */

/* Continues the round for budget_ns; 0: runs a whole round. Returns SMR_PARTIAL until the round ends. Errors: E_NULL,
 * E_STATE (as smr_tick(); SMR_SCRUB_INPUTS is off), E_DAMAGED. */
smr_status smr_scrub(smr *s, uint64_t budget_ns);

/* ------------------------------------------------------------------ 23. for replays alone */
/* Arguments of smr_set_goals(), smr_set_motion() and smr_set_force(), for smr_log_input. */
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

/* Only the library reads and writes the fields of smr_log_reader and smr_replay. */
struct smr_log_reader {
    const unsigned char *log; /* the log, borrowed from the caller */
    size_t bytes, at;
    uint32_t checksum;
};
struct smr_replay {
    smr *s;
    smr_log_reader reader, unused; /* unused and unused_word keep the layout */
    smr_log_input input;
    void *ctx;
    uint32_t n_ticks, state, unused_word, n_landmarks, count;
    uint64_t gave;
    smr_landmark landmark[SMR_LANDMARKS_MAX];
};

#ifdef __cplusplus
}
#endif

#endif /* SMR_H */
