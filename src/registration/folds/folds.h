/* folds.h: finds and removes folds, triangles that turn over, at the last two radii. In: next positions. Out: next
 * positions with folds repaired, limited or opened. fold_find.c finds folds; fold_repair.c works in one iteration
 * before these radii, fold_limit.c in later ones, fold_open.c on remaining folds at the last radius. A dihedral edge is
 * shared by two triangles; the edge's cosine is that of the angle between their normals.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_FOLDS_H
#define SMR_FOLDS_H

#include "registration/evolve/evolve_positions.h"

#define SMR_DIHEDRAL_CHUNK 1024u /* number of dihedral edges in a task of fold_find.c */
#define SMR_EDGE_PIECE 64u       /* number of dihedral edges that a bit of a tally stands for */
#define SMR_FOLD_COS 0.001f /* cosine below which an edge that is open at rest is folded; above 0 because of rounding */
#define SMR_LIMIT_BELOW 0.31f /* a next cosine above this needs no limit: limiting cosines are 0.02 at most */

/* Progress of a pass over dihedral edges, triangles or vertices. Each task of the step is a piece of a pass. */
typedef struct smr_fold_pass {
    uint32_t stage;     /* kind of the current pass; 0: none */
    uint32_t at;        /* number of completed items of the structure in this pass */
    uint32_t structure; /* index of the structure whose items the pass works on */
    uint32_t n_done;    /* number of completed tasks of the step in this iteration */
} smr_fold_pass;

/* Items of a pass: all dihedral edges, one structure's triangles or vertices, or the vertices with requests. */
enum { SMR_OVER_DIHEDRALS = 0, SMR_OVER_TRIANGLES, SMR_OVER_VERTICES, SMR_OVER_LISTED };

typedef struct smr_fold_repair {
    smr_fold_pass pass;
    uint32_t ring, sweep; /* index of the current ring of the patch around folds; index of the current sweep */
} smr_fold_repair;

typedef struct smr_fold_limit {
    smr_fold_pass pass;
    uint32_t round;    /* number of complete rounds of requests in this iteration */
    uint32_t n_listed; /* number of vertices with requests in this round */
    float most;        /* largest share, 0..1, by which an edge asks to even out its corners' steps in this round */
} smr_fold_limit;

typedef struct smr_fold_open {
    smr_fold_pass pass;
    uint32_t n_passes; /* number of completed passes that opened folds in this iteration */
    uint32_t n_folds;  /* number of folds opened in this pass so far */
} smr_fold_open;

#define SMR_OPENED 64u /* smr_folds.folding: above the rounds of fold_limit.c */

typedef struct smr_folds {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;             /* positions x and x_next; fold steps correct x_next in place */
    smr_tangent_smooth *tangent_smooth; /* smoothing, whose `limited` gets the removed share of each step */
    smr_rings rings;
    smr_tally *tally;
    uint8_t *marked; /* [n] not 0: a fold step changes the vertex' position in this iteration */
    /* [n_structures] 0: nothing moved; repair: 1; else the last round of limit, from 1, or SMR_OPENED + the last pass
     * of open, from 1, that moved a vertex */
    uint32_t *folding;
    uint32_t n_dihedral_tasks; /* number of tasks of fold_find.c */
    uint32_t n_guarded;        /* number of vertices that fold steps changed in this iteration */
    uint32_t moved;            /* 1: x_next has changed and the triangles must be updated */
    smr_fold_repair repair;
    smr_fold_limit limit;
    smr_fold_open open;
    uint64_t *touched; /* [n_triangles / 64] a bit for each triangle; 1: repair or a round of limit marked a corner */
} smr_folds;

void smr_folds_layout(smr_arena *a, smr_folds *f, const smr_shared *shared);
void smr_folds_reset(smr_folds *f); /* clears the passes when an iteration is complete or abandoned */
int smr_folds_guarded(const smr_shared *c, const smr_schedule *p); /* returns 1 where folds are searched for */

smr_count_tasks smr_fold_find_tasks;
smr_run_task smr_fold_find;
void smr_fold_find_end(smr_folds *f); /* starts repair, limit or open where folds were found */

/* Steps; their tasks run one after the other. While work is left, a step has one task more than it has completed. */
smr_count_tasks smr_fold_repair_tasks, smr_fold_limit_tasks, smr_fold_open_tasks;
smr_run_task smr_fold_repair_pass, smr_fold_limit_pass, smr_fold_open_pass;
void smr_folds_moved(smr_folds *f); /* counts the vertices that fold steps changed, in n_guarded */
void smr_fold_repair_start(smr_folds *f);
void smr_fold_limit_start(smr_folds *f);
void smr_fold_open_start(smr_folds *f);

/* A kind of pass: a task processes at most `chunk` items of the kind `over`, the items from .. to - 1 of the model. */
typedef struct smr_fold_stage {
    uint32_t over, chunk;
    void (*run)(smr_folds *f, uint32_t from, uint32_t to);
} smr_fold_stage;

/* Runs the next task of pass p, of the kind stages[p->stage]. Returns 1 when the pass is complete. */
int smr_fold_run(smr_folds *f, smr_fold_pass *p, const smr_fold_stage *stages);
/* Returns the first structure with folds from `structure` on; n_structures: none. */
uint32_t smr_folding_from(const smr_folds *f, uint32_t structure);

/* Returns the number of tasks of a fold step: the completed ones, and one more while work is left. */
static inline uint32_t smr_fold_tasks(const smr_fold_pass *p) { return p->n_done + (p->stage != 0u); }

static inline const smr_stored_dihedral *smr_edge_at(const smr_folds *f, uint32_t i)
{
    return (const smr_stored_dihedral *)smr_at(f->shared->model, f->shared->model->at_dihedrals) + i;
}

/* smr_edge_first(), smr_edge_second(): an edge's triangles. smr_edge_limit(): cosine below which the edge is folded.
 * smr_edge_open(): 1 when the edge's triangles do not face away from each other in the rest shape. */
static inline uint32_t smr_edge_first(const smr_folds *f, const smr_stored_dihedral *h)
{
    return smr_index(smr_le32(h->first), f->shared->n_triangles);
}
static inline uint32_t smr_edge_second(const smr_folds *f, const smr_stored_dihedral *h)
{
    return smr_index(smr_le32(h->bend) & SMR_DIHEDRAL_MASK, f->shared->n_triangles);
}
static inline float smr_edge_limit(const smr_stored_dihedral *h)
{
    return (float)(smr_le32(h->bend) >> 24) / SMR_DIHEDRAL_UNIT - 1.0f;
}
static inline int smr_edge_open(const smr_stored_dihedral *h) { return smr_edge_limit(h) > SMR_DIHEDRAL_OPEN; }

/* Returns the cosine of the angle between the normals of an edge's triangles, with vertices at x [n][3]. */
float smr_dihedral_cosine(const smr_folds *f, float *x, const smr_stored_dihedral *h);

/* Returns the bit of an edge's piece in the tally of the edge's chunk. */
static inline uint32_t smr_piece_bit(uint32_t edge)
{
    return (uint32_t)1 << (edge % SMR_DIHEDRAL_CHUNK / SMR_EDGE_PIECE);
}

/* Returns the edge's cosine at x_next as the last refit of triangles found it: no corner has moved since. */
static inline float smr_refitted_cosine(const smr_folds *f, const smr_stored_dihedral *h)
{
    const float *const normal = f->shape->triangle_normal;
    return smr_dot(smr_get3(normal, smr_edge_first(f, h)), smr_get3(normal, smr_edge_second(f, h)));
}

/* Returns the first of the edges from .. to - 1 with a touched triangle; to: none. */
uint32_t smr_next_touched(const smr_folds *f, uint32_t from, uint32_t to);
/* Returns 1 when `folding` is above `round` in a structure of a chunk of edges. */
int smr_marked_since(const smr_folds *f, const smr_tally *tally, uint32_t round);

/* Returns the share, 0..1, by which the steps of h's corners must move to their mean if h's next cosine is `next`. */
float smr_fold_limit_share(const smr_folds *f, const smr_stored_dihedral *h, float next);

static inline const uint32_t *smr_corners(const smr_folds *f, uint32_t t) { return smr_model_triangle(f->shared, t); }

/* Returns not 0 when a corner of the triangle is marked. */
static inline int smr_any_marked(const smr_folds *f, uint32_t triangle)
{
    const uint32_t *const t = f->shared->triangle + 3u * (size_t)triangle, n = f->shared->n;
    return f->marked[smr_index(t[0], n)] | f->marked[smr_index(t[1], n)] | f->marked[smr_index(t[2], n)];
}

static inline void smr_triangle_touch(smr_folds *f, uint32_t triangle)
{
    f->touched[triangle / 64u] |= (uint64_t)1 << (triangle % 64u);
}

static inline uint32_t smr_triangle_touched(const smr_folds *f, uint32_t triangle)
{
    return (uint32_t)(f->touched[triangle / 64u] >> (triangle % 64u)) & 1u;
}

#endif
