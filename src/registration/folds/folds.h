/* folds.h: watches for triangles that turn over, from the last radius but one on. In: positions under way. Out: the
 * same with what folds repaired, limited or opened. Four steps: fold_find counts; fold_repair works before a radius
 * starts, fold_limit in its iterations, and fold_open, at the last radius, on what is folded all the same. A hinge is
 * an edge that two triangles share; its cosine is that between their normals.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FOLDS_H
#define SMR_FOLDS_H

#include "registration/evolve/evolve.h"

#define SMR_HINGE_CHUNK 1024u /* hinges of a task of fold_find.c */
#define SMR_RUNS 2048u        /* runs of triangles that are looked at or passed over as one */

/* A hinge that is open at rest is a fold as soon as its triangles look away from each other; a little earlier, for
 * rounding. */
#define SMR_FOLD_COS 0.001f

/* No hinge with a larger cosine folds or is held back: limits are 0.02 at most (prepare/fold_hinges.c). */
#define SMR_LIMIT_BELOW 0.31f

/* Where a pass over hinges, triangles or vertices stands. Each task of such a step is a piece of a pass. */
typedef struct smr_fold_pass {
    uint32_t stage;     /* which pass is under way; 0: none */
    uint32_t at;        /* how far it is */
    uint32_t structure; /* where it is */
    uint32_t n_done;    /* tasks of the step done in this iteration */
} smr_fold_pass;

/* What a pass goes over: all hinges, or one structure's triangles or vertices. */
enum { SMR_OVER_HINGES = 0, SMR_OVER_TRIANGLES, SMR_OVER_VERTICES };

/* A piece of a pass: items from .. to - 1 of length, counted over all structures, so `first` is the structure's own
 * first one. */
typedef struct smr_fold_piece {
    uint32_t first, from, to, length;
} smr_fold_piece;

/* Where repairing stands. */
typedef struct smr_fold_repair {
    smr_fold_pass pass;
    uint32_t ring, sweep;
    uint32_t n_folds; /* marked so far */
} smr_fold_repair;

/* Where limiting stands. */
typedef struct smr_fold_limit {
    smr_fold_pass pass;
    uint32_t round;
    float most; /* asked for in this round */
} smr_fold_limit;

/* Where opening stands. */
typedef struct smr_fold_open {
    uint32_t n_done;  /* tasks of the step done in this iteration */
    uint32_t pass;    /* from 1; 0: none */
    uint32_t chunk;   /* the chunk of hinges to come */
    uint32_t n_folds; /* found in this pass so far */
} smr_fold_open;

typedef struct smr_folds {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape; /* x_next is changed */
    smr_evening *evening;   /* told what is held back */
    smr_rings rings;
    smr_tally *tally;
    uint8_t *marked;   /* [n] not 0: the vertex' step is changed here in this iteration */
    uint32_t *folding; /* [n_structures] 1: something folds there */
    uint32_t n_hinge_tasks;
    uint32_t n_folding; /* hinges found folding while repairing */
    uint32_t n_guarded; /* vertices marked */
    uint32_t moved;     /* 1: x_next has changed, the facets must follow */
    smr_fold_repair repair;
    smr_fold_limit limit;
    smr_fold_open open;
    uint32_t run_bits;                /* 2^run_bits triangles are a run */
    uint64_t touched[SMR_RUNS / 64u]; /* a bit for each run: a corner in it is marked; of repair or limit */
} smr_folds;

void smr_folds_layout(smr_arena *a, smr_folds *f, const smr_shared *shared);
void smr_folds_wire(smr_folds *f, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                    smr_evening *evening, const smr_overlay *overlay);
void smr_folds_reset(smr_folds *f);                            /* an iteration is complete or given up */
int smr_folds_guarded(const smr_shared *c, const smr_pace *p); /* 1: at this radius folds are watched for */

uint32_t smr_fold_find_tasks(const void *folds);
void smr_fold_find(void *folds, uint32_t task, uint32_t worker);
void smr_fold_find_end(smr_folds *f); /* starts what is needed of the steps below */

/* Serial. There is one task more than were done as long as there is work. */
uint32_t smr_fold_repair_tasks(const void *folds);
void smr_fold_repair_pass(void *folds, uint32_t task, uint32_t worker);
uint32_t smr_fold_limit_tasks(const void *folds);
void smr_fold_limit_pass(void *folds, uint32_t task, uint32_t worker);
uint32_t smr_fold_open_tasks(const void *folds);
void smr_fold_open_pass(void *folds, uint32_t task, uint32_t worker);
void smr_folds_moved(smr_folds *f); /* after each of the three: counts who was marked */

void smr_fold_repair_start(smr_folds *f);
void smr_fold_limit_start(smr_folds *f);
void smr_fold_open_start(smr_folds *f);

/* hinges.c: the piece of at most `chunk` items that comes next in a pass. */
smr_fold_piece smr_fold_piece_of(const smr_folds *f, const smr_fold_pass *p, uint32_t over, uint32_t chunk);

/* A task has done a piece. Returns 1 when the pass is through and the next one is to be chosen. */
static inline int smr_fold_piece_done(smr_fold_pass *p, const smr_fold_piece *piece)
{
    p->at = piece->to - piece->first;
    p->n_done++;
    return p->at == piece->length;
}

static inline const smr_stored_hinge *smr_hinge_at(const smr_folds *f, uint32_t i)
{
    return (const smr_stored_hinge *)smr_at(f->shared->model, f->shared->model->at_hinges) + i;
}

static inline uint32_t smr_hinge_second(const smr_stored_hinge *h) { return smr_le32(h->bend) & SMR_HINGE_MASK; }

/* The cosine below which it folds. */
static inline float smr_hinge_limit_of(const smr_stored_hinge *h) { return smr_hinge_limit(smr_le32(h->bend)); }

/* 1: its triangles did not look away from each other at rest. */
static inline int smr_hinge_open(const smr_stored_hinge *h) { return smr_hinge_limit_of(h) > SMR_HINGE_OPEN; }

/* The cosine between a hinge's normals at x [n][3]. */
float smr_hinge_cosine(const smr_folds *f, float *x, const smr_stored_hinge *h);

/* The share, 0..1, by which the steps of a hinge's corners must become alike when its cosine would be `next`. */
float smr_fold_limit_share(const smr_folds *f, const smr_stored_hinge *h, float next);

static inline const uint32_t *smr_corners(const smr_folds *f, uint32_t triangle)
{
    return f->shared->triangle + 3u * (size_t)triangle;
}

/* Not 0: a corner of the triangle is marked. */
static inline int smr_any_marked(const smr_folds *f, uint32_t triangle)
{
    const uint32_t *t = smr_corners(f, triangle);
    return f->marked[t[0]] | f->marked[t[1]] | f->marked[t[2]];
}

/* Runs of triangles in which something is marked: the others are passed over without a look at their corners. */
void smr_runs_clear(smr_folds *f);

static inline void smr_run_touch(smr_folds *f, uint32_t triangle)
{
    const uint32_t run = triangle >> f->run_bits;
    f->touched[run / 64u] |= (uint64_t)1 << (run % 64u);
}

static inline int smr_run_touched(const smr_folds *f, uint32_t triangle)
{
    const uint32_t run = triangle >> f->run_bits;
    return (int)(f->touched[run / 64u] >> (run % 64u) & 1u);
}

#endif
