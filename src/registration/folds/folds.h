/* folds.h: finds and removes folds: triangles that turn over, from the last radius but one on. In: current
 * positions. Out: the same with folds repaired, limited or opened. fold_find counts folds; fold_repair works before
 * a radius starts, fold_limit in its iterations, fold_open on remaining folds at the last radius. A dihedral edge is
 * shared by two triangles; its cosine is that of the angle between their normals.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FOLDS_H
#define SMR_FOLDS_H

#include "registration/evolve/evolve_positions.h"

#define SMR_DIHEDRAL_CHUNK 1024u /* dihedral edges of a task of fold_find.c */
#define SMR_RUNS 2048u           /* most runs of triangles: a run is tested or skipped as a whole */

/* cosine below which an edge that was open at rest is folded; above 0 because of rounding */
#define SMR_FOLD_COS 0.001f

/* largest cosine that is tested: limits are 0.02 at most */
#define SMR_LIMIT_BELOW 0.31f

/* Progress of a pass over dihedral edges, triangles or vertices. Each task of the step is a piece of a pass. */
typedef struct smr_fold_pass {
    uint32_t stage;     /* kind of the current pass; 0: none */
    uint32_t at;        /* items of the structure that are done */
    uint32_t structure; /* current structure */
    uint32_t n_done;    /* tasks of the step that are done in this iteration */
} smr_fold_pass;

/* What a pass runs over: all dihedral edges, or one structure's triangles or vertices. */
enum { SMR_OVER_DIHEDRALS = 0, SMR_OVER_TRIANGLES, SMR_OVER_VERTICES };

/* A piece of a pass: items from .. to - 1, counted over all structures. first: the structure's first item; length:
 * number of its items. */
typedef struct smr_fold_piece {
    uint32_t first, from, to, length;
} smr_fold_piece;

typedef struct smr_fold_repair {
    smr_fold_pass pass;
    uint32_t ring, sweep;
    uint32_t n_folds; /* folds that were marked so far */
} smr_fold_repair;

typedef struct smr_fold_limit {
    smr_fold_pass pass;
    uint32_t round;
    float most; /* largest share that this round requested */
} smr_fold_limit;

typedef struct smr_fold_open {
    uint32_t n_done;  /* tasks of the step that are done in this iteration */
    uint32_t pass;    /* current pass, from 1; 0: none */
    uint32_t chunk;   /* next chunk of dihedral edges */
    uint32_t n_folds; /* folds found in this pass so far */
} smr_fold_open;

typedef struct smr_folds {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;             /* x_next is changed */
    smr_tangent_smooth *tangent_smooth; /* is told which steps were limited */
    smr_rings rings;
    smr_tally *tally;
    uint8_t *marked;   /* [n] not 0: a fold step changes the vertex' position in this iteration */
    uint32_t *folding; /* [n_structures] 1: the structure has folds */
    uint32_t n_dihedral_tasks;
    uint32_t n_folding; /* dihedral edges that folded when the repair began */
    uint32_t n_guarded; /* number of marked vertices */
    uint32_t moved;     /* 1: x_next has changed and the triangles must be updated */
    smr_fold_repair repair;
    smr_fold_limit limit;
    smr_fold_open open;
    uint32_t run_bits;                /* a run is 2^run_bits triangles */
    uint64_t touched[SMR_RUNS / 64u]; /* a bit for each run: one of its corners is marked by repair or limit */
} smr_folds;

void smr_folds_layout(smr_arena *a, smr_folds *f, const smr_shared *shared);
void smr_folds_reset(smr_folds *f); /* called when an iteration is complete or abandoned */
int smr_folds_guarded(const smr_shared *c, const smr_schedule *p); /* 1: folds are searched for at this radius */

uint32_t smr_fold_find_tasks(const void *folds);
void smr_fold_find(void *folds, uint32_t task, uint32_t worker);
void smr_fold_find_end(smr_folds *f); /* starts those of the steps below that are needed */

/* Tasks run one after the other. While work is left, the number of tasks is one more than were done. */
uint32_t smr_fold_repair_tasks(const void *folds);
void smr_fold_repair_pass(void *folds, uint32_t task, uint32_t worker);
uint32_t smr_fold_limit_tasks(const void *folds);
void smr_fold_limit_pass(void *folds, uint32_t task, uint32_t worker);
uint32_t smr_fold_open_tasks(const void *folds);
void smr_fold_open_pass(void *folds, uint32_t task, uint32_t worker);
void smr_folds_moved(smr_folds *f); /* called after each of the three steps: counts marked vertices */

void smr_fold_repair_start(smr_folds *f);
void smr_fold_limit_start(smr_folds *f);
void smr_fold_open_start(smr_folds *f);

/* The next piece of a pass, of at most `chunk` items. */
smr_fold_piece smr_fold_piece_of(const smr_folds *f, const smr_fold_pass *p, uint32_t over, uint32_t chunk);

/* Notes that a piece is done. Returns 1 when the pass is complete. */
static inline int smr_fold_piece_done(smr_fold_pass *p, const smr_fold_piece *piece)
{
    p->at = piece->to - piece->first;
    p->n_done++;
    return p->at == piece->length;
}

static inline const smr_stored_dihedral *smr_dihedral_at(const smr_folds *f, uint32_t i)
{
    return (const smr_stored_dihedral *)smr_at(f->shared->model, f->shared->model->at_dihedrals) + i;
}

static inline uint32_t smr_dihedral_second(const smr_stored_dihedral *h)
{
    return smr_le32(h->bend) & SMR_DIHEDRAL_MASK;
}

/* The cosine below which a dihedral edge counts as folded. */
static inline float smr_dihedral_limit_of(const smr_stored_dihedral *h)
{
    return smr_dihedral_limit(smr_le32(h->bend));
}

/* Returns 1 when the edge's triangles did not face away from each other at rest. */
static inline int smr_dihedral_open(const smr_stored_dihedral *h)
{
    return smr_dihedral_limit_of(h) > SMR_DIHEDRAL_OPEN;
}

/* The cosine of the angle between the normals of an edge's triangles at x [n][3]. */
float smr_dihedral_cosine(const smr_folds *f, float *x, const smr_stored_dihedral *h);

/* The share, 0..1, by which the steps of an edge's corners must move towards their mean when its cosine would become
 * `next`. */
float smr_fold_limit_share(const smr_folds *f, const smr_stored_dihedral *h, float next);

static inline const uint32_t *smr_corners(const smr_folds *f, uint32_t triangle)
{
    return f->shared->triangle + 3u * (size_t)triangle;
}

static inline int smr_any_marked(const smr_folds *f, uint32_t triangle)
{
    const uint32_t *t = smr_corners(f, triangle);
    return f->marked[t[0]] | f->marked[t[1]] | f->marked[t[2]];
}

/* Clears the bits of all runs. A run without marked corners is skipped as a whole. */
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
