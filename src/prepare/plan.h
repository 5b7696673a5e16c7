/* plan.h: what the steps of prepare share: the model in curve order, and scratch. All arrays lie in the caller's
 * scratch memory. Vertices are numbered along a space-filling curve: neighbours in space are neighbours in memory, and a
 * ball of vertices is a few runs of consecutive numbers. The stored order (priority_levels.c) is only put on by what writes the
 * model.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PLAN_H
#define SMR_PLAN_H

#include "base/arena.h"
#include "base/parallel.h"
#include "geometry/box_tree.h"
#include "model/model.h"

#define SMR_NEAREST 12u        /* spatial neighbours tried as parents in the forest */
#define SMR_RING_TRIED 16u     /* mesh neighbours tried as parents */
#define SMR_REMAINS UINT32_MAX /* no place in the priority list: never left out */

typedef struct smr_plan {
    const smr_structure *structures;
    const smr_prepare_config *config;
    uint32_t n_structures;
    uint32_t n;     /* vertices of all structures */
    uint32_t nt;    /* triangles of all structures */
    uint32_t block; /* most vertices in a block */
    uint32_t words; /* 64-bit words of a row of n bits */
    uint32_t n_rows;
    uint32_t separate; /* of the radius in work */
    smr_port port;     /* for loops over a block; none for geodesic clusters, which share scratch */
    float centre[3];   /* mm */
    float edge_mm;     /* mean edge */
    float edge_max;    /* longest edge */

    /* written by order: the model along the curve */
    float *xyz;           /* [n][3] relative to centre */
    float *mass;          /* [n] */
    uint16_t *owner;      /* [n] */
    uint32_t *position;   /* [n] caller's vertex -> along the curve */
    uint32_t *original;   /* [n] along the curve -> caller's */
    uint32_t *triangle;   /* [nt][3] vertices, structures in a row, each in tree order */
    uint32_t *facet;      /* [nt] the caller's index within the structure */
    uint32_t *ring_start; /* [n + 1] */
    uint32_t *ring;       /* [6 nt] mesh neighbours of each vertex, each once */
    uint32_t n_hinges;
    smr_stored_hinge *hinge; /* [3 nt / 2] edges between two triangles, see model.h */
    uint8_t *profile;        /* [n][profile_samples], NULL without a reference */
    float *range;            /* [n][2] */
    float *normal;           /* [n][3] */
    smr_facets points;       /* box tree whose leaves are single vertices */

    /* written by priority */
    uint32_t n_listed;
    uint32_t *list;                     /* [n_listed] the priority list S, the least significant first */
    uint32_t *place;                    /* [n] in that list, or SMR_REMAINS */
    uint32_t active_min[SMR_RADII_MAX]; /* vertices that keep clusters large enough at this radius */
    uint32_t *witness;                  /* [n] scratch: see priority_list.c */
    uint32_t *next;                     /* [n] scratch */
    uint32_t *bucket;                   /* [n + 1] scratch */
    uint32_t n_scanned;                 /* clusters found since the start */
    uint32_t progress_total;            /* what progress counts to */
    /* written by levels: the stored order */
    uint32_t n_levels;
    uint32_t level_end[SMR_LEVELS_MAX]; /* stored vertices of a level and all before it */
    uint32_t *stored;                   /* [n] along the curve -> stored */
    uint32_t *along;                    /* [n] stored -> along the curve */
    uint32_t *level; /* [n] of each vertex along the curve; the priority list is done with its scratch */

    /* written per radius */
    uint64_t *row;    /* [n_rows][words + 1] clusters as bit rows, see smr_plan_row() */
    uint32_t *count;  /* [n] |zeta| */
    uint32_t *rank;   /* [n] entry number of a vertex */
    uint32_t *member; /* [n] of a list; the same scratch */

    /* scratch */
    float *middle;          /* [nt][3] centres of triangles */
    uint32_t *key;          /* [max(n, nt, pairs)] */
    uint32_t *item;         /* [max(n, nt, pairs)] */
    uint32_t *tmp;          /* [2 max(n, nt, pairs)] */
    uint32_t near_kind;     /* what near holds: 1 + separate; 0 nothing yet */
    uint32_t *near;         /* [n][SMR_NEAREST] the nearest vertices within a vertex' block, SMR_NONE behind the last */
    uint32_t *edge_a;       /* [pairs] candidate edges of a block's forest */
    uint32_t *edge_b;       /* [pairs] */
    uint32_t *set;          /* [block + 1] union-find */
    uint32_t *link_start;   /* [block + 2] tree edges of a block */
    uint32_t *link;         /* [2 (block + 1)] */
    uint32_t *queue;        /* [n + 1] */
    uint32_t *geo_distance; /* [n] micrometres, geodesic only */
    uint32_t *geo_heap;     /* [2 (6 nt + 1)], geodesic only */
} smr_plan;

/* Counts and pointers only; reads no mesh. Errors: E_NULL, E_INPUT, E_CONFIG. */
smr_status smr_plan_start(smr_plan *p, const smr_structure *structures, uint32_t n, const smr_prepare_config *config);

/* Cuts the scratch (or measures it). counts are in the plan already. */
void smr_plan_layout(smr_arena *a, smr_plan *p);

/* Order along the curve, ring neighbours, masses, centre. */
void smr_plan_order(smr_plan *p);
void smr_plan_mass(smr_plan *p);

/* Intensity profiles of the reference image along the normals. Errors: as smr_grid_open. */
smr_status smr_plan_profiles(smr_plan *p);
uint32_t smr_profile_inward(const smr_prepare_config *c); /* samples before the vertex; needs a reference image */

/* Edges with exactly two triangles. */
void smr_plan_hinges(smr_plan *p);

/* The priority list over all radii, and what each radius needs. Errors: E_ABORTED. */
smr_status smr_plan_priority(smr_plan *p, const float *radius, uint32_t n_radii, float separate_below);

/* The stored order that follows from it; or without a list, one level along the curve. */
void smr_plan_levels(smr_plan *p, uint32_t n_radii);
void smr_plan_one_level(smr_plan *p, uint32_t n_radii);

/* A row of n bits; the word behind them names the words first .. last - 1 that may hold any (first | last << 32), so that
 * small clusters cost little in large models. */
static inline uint64_t *smr_plan_row(const smr_plan *p, uint32_t i) { return p->row + (size_t)i * (p->words + 1u); }

static inline uint32_t smr_row_first(const uint64_t *row, uint32_t words) { return (uint32_t)row[words]; }
static inline uint32_t smr_row_last(const uint64_t *row, uint32_t words) { return (uint32_t)(row[words] >> 32); }

/* Widens the range to words first .. last - 1. */
static inline void smr_row_cover(uint64_t *row, uint32_t words, uint32_t first, uint32_t last)
{
    first = smr_min_u32(first, smr_row_first(row, words));
    last = smr_max_u32(last, smr_row_last(row, words));
    row[words] = (uint64_t)last << 32 | first;
}

static inline void smr_row_set(uint64_t *row, uint32_t words, uint32_t bit)
{
    row[bit / 64u] |= (uint64_t)1 << (bit % 64u);
    smr_row_cover(row, words, bit / 64u, bit / 64u + 1u);
}

static inline void smr_row_clear(uint64_t *row, uint32_t words)
{
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++)
        row[w] = 0;
    row[words] = words;
}

/* 1 when clusters of this radius also hold mesh neighbours. */
static inline int smr_uses_ring(const smr_plan *p, float radius) { return p->config->ring && radius >= p->edge_mm; }

/* Fills a row with zeta of vertex v at this radius. */
void smr_cluster_row(smr_plan *p, uint32_t v, float radius, uint64_t *row);

/* The Euclidean ball alone, over all structures. */
void smr_ball_row(const smr_plan *p, uint32_t v, float radius, uint64_t *row);

/* The vertices within `radius` along mesh edges, as bits. */
void smr_geodesic_row(smr_plan *p, uint32_t v, float radius, uint64_t *row);

/* The k <= SMR_NEAREST vertices nearest to v among first..last-1 (same structure only when separate), v itself left
 * out. Returns how many; distance2 may be NULL. */
uint32_t smr_nearest(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t k, uint32_t *found,
                     float *distance2);

/* Bits set in a row. */
uint32_t smr_row_count(const uint64_t *row, uint32_t words);

/* Chooses radii from coarse to fine when the configuration leaves them open. Returns their number. */
uint32_t smr_choose_radii(smr_plan *p, float radius[SMR_RADII_MAX]);

/* The model as it grows: bytes beyond the capacity are counted, not written. */
typedef struct smr_writer {
    unsigned char *model; /* NULL: count only */
    size_t capacity;
    size_t used;
} smr_writer;

void smr_put16(smr_writer *w, size_t at, uint32_t value);
void smr_put32(smr_writer *w, size_t at, uint32_t value);
/* Reserves a section of zero bytes on the next SMR_ALIGN boundary; returns its offset. */
size_t smr_put_section(smr_writer *w, size_t bytes);

/* The whole model but its checksum. Errors: E_ABORTED, E_INPUT (more than 4 GiB). */
smr_status smr_write_model(smr_plan *p, smr_writer *w, const float *radius, uint32_t n_radii, float separate_below);

/* One radius' lists being written. */
typedef struct smr_list_writer {
    smr_writer *w;
    uint32_t index_bytes;
    size_t at_blocks, at_entries, at_count, at_indexes, at_boundary;
    uint32_t n_blocks; /* blocks begun so far */
    uint32_t n_entries;
    uint32_t n_indexes;
    uint64_t n_boundary;
    uint64_t n_members; /* sum of |zeta| */
    uint32_t largest, smallest;
} smr_list_writer;

void smr_list_block(smr_list_writer *l);
/* Appends an entry, in stored numbers. own and parent_row: rows; parent_row NULL for a root. parent: entry number in the block. */
void smr_list_entry(smr_list_writer *l, smr_plan *p, uint32_t vertex, uint32_t parent, const uint64_t *own,
                    const uint64_t *parent_row);

/* The radius' boundary, behind its lists; the largest cluster with it. */
void smr_write_boundary(smr_plan *p, smr_list_writer *l, float radius);

/* Minimum spanning forest of the clusters of the curve's vertices first..last-1, written as one block. */
void smr_forest_block(smr_plan *p, smr_list_writer *l, uint32_t first, uint32_t last, float radius);

/* The paper's breadth-first order over the whole model, as one block. E_ABORTED when progress says so. */
smr_status smr_breadth_first(smr_plan *p, smr_list_writer *l, float radius, uint32_t step, uint32_t steps);

#endif
