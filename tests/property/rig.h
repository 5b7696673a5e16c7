/* rig.h: set-up that unit tests, property tests and benchmarks share: bone meshes, models, targets, registrations,
 * hostile schedulers and clocks. Nothing here is asserted: when set-up fails, the program ends.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_H
#define RIG_H

#include "smr.h"

/* Memory on an SMR_ALIGN address, of exactly the size asked for: zeros, or a pattern on which nobody may rely.
 * rig_free() gives a block back, rig_free_all() all of them. */
void *rig_alloc(size_t bytes);
void *rig_rough(size_t bytes);
void rig_free(void *memory); /* NULL: nothing */
void rig_free_all(void);

/* A pair of bones: the source, and the target made from another grid and deformed. */
void rig_bone(uint32_t cell_um, float strength, smr_mesh *source, smr_mesh *target);

/* A closed ball of 2 + 6 * (rings - 1) .. vertices: rings circles of `around` vertices between two poles. */
smr_mesh rig_ball(float radius, uint32_t rings, uint32_t around, const float centre[3]);

/* A copy under x' = m x + t (m row-major). A mirroring m turns the triangles over. */
smr_mesh rig_moved(const smr_mesh *mesh, const float m[9], const float t[3]);

/* A reading model of one mesh or several. radius NULL: default radii. */
const smr_model *rig_model(const smr_mesh *mesh, uint32_t n_structures, const smr_prepare_config *config);
smr_prepare_config rig_radii(uint32_t n, float r0, float r1, float r2);

/* An image of side^3 float voxels around the origin, axes along x, y, z; *voxels is its memory, not written yet. */
smr_volume rig_cube(uint32_t side, float spacing, float **voxels);

smr_surface *rig_surface(const smr_mesh *mesh);

/* A registration in memory of exactly the size that it needs. port may be NULL. */
smr *rig_init(const smr_model *model, const smr_config *config, const smr_port *port);

/* A copy by way of a save, in memory that was used before. Its inputs are to be set again. NULL where a call failed. */
smr *rig_restored(const smr *s, const smr_model *model, const smr_config *config);

/* Ticks without a clock until done or n ticks; returns the last report. */
smr_tick_report rig_run(smr *s, uint32_t n);

/* Replays in twin the log that s wrote. Returns its ticks; 0 where it was full or anything came out otherwise.
 * *partial, unless NULL: ticks that did not complete an iteration. */
uint32_t rig_replays(const smr *s, const void *log, smr_log_input input, void *ctx, smr *twin, uint32_t *partial);

/* Positions of all structures in the caller's order, one after the other: [n][3] in rig memory. */
float *rig_positions(const smr *s, const smr_model *model);

/* Largest distance between equally numbered points, and whether all are finite. */
float rig_far(const float *a, const float *b, uint32_t n);
int rig_finite(const float *xyz, uint32_t n);

/* Schedulers that a correct library cannot notice. They run on one thread but use n_workers numbers. */
enum { RIG_PLAIN, RIG_REVERSE, RIG_SHUFFLE, RIG_INTERLEAVE, RIG_SCHEDULERS };
smr_port rig_port(uint32_t scheduler, uint32_t n_workers);

/* Clocks. step_ns is added at each reading; the kind says how. */
enum { RIG_CLOCK_CONSTANT, RIG_CLOCK_STEADY, RIG_CLOCK_JUMPING, RIG_CLOCK_BACKWARDS, RIG_CLOCK_COARSE, RIG_CLOCKS };
typedef struct rig_clock {
    uint32_t kind;
    uint64_t time, step_ns, readings;
} rig_clock;
smr_port rig_clock_port(rig_clock *clock, uint32_t kind, uint64_t step_ns);

/* A clock that runs forward, now and then by a lot: smr_port.ctx and now_ns. */
typedef struct rig_jitter {
    uint32_t seed;
    uint64_t time;
} rig_jitter;
uint64_t rig_jitter_read(void *jitter);

/* Numbers that look random and are the same everywhere: 0..n-1, and lo..hi. */
uint32_t rig_random(uint32_t *seed, uint32_t n);
float rig_between(uint32_t *seed, float lo, float hi);

/* Three of them, drawn one after the other: compilers evaluate arguments in an order of their own. */
void rig_within(uint32_t *seed, float lo, float hi, float p[3]);

/* How often a test repeats what takes long: n times, a tenth of it (at least once) in an instrumented build, and with
 * SMR_AGAIN=1. */
uint32_t rig_times(uint32_t n);

/* A proper rotation matrix, row-major, of `degrees` about an axis. */
void rig_rotation(float x, float y, float z, float degrees, float m[9]);

#endif
