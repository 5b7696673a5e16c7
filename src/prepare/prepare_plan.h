/* prepare_plan.h: data that the stages of smr_prepare() share: the model numbered along the curve, priorities, rows of
 * bits, and the model being written. All arrays lie in the caller's scratch memory. Neighbours on the space-filling
 * curve are mostly neighbours in space, so a cluster is a few runs of consecutive numbers. The stored order
 * (priority_list.c) is applied only while the model is written.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_PREPARE_PLAN_H
#define SMR_PREPARE_PLAN_H

#include "base/arena.h"
#include "geometry/box_tree/box_tree.h"
#include "model/model.h"

#define SMR_NEAREST 12u          /* number of nearest vertices tried as parents in the forest */
#define SMR_NEIGHBOURS_TRIED 16u /* largest number of mesh neighbours tried as parents */
#define SMR_REMAINS UINT32_MAX   /* place of a vertex outside the priority list S, which is never ignored */

/* The priority list S of vertices that can be ignored, and scratch for computing S (priority_list.c). */
typedef struct smr_priority {
    uint32_t n_listed;  /* number of vertices in S */
    uint32_t *list;     /* [n_listed] S: vertices, the least significant first */
    uint32_t *place;    /* [n] index of each vertex in S, or SMR_REMAINS */
    uint32_t *witness;  /* [n] scratch: the vertex in whose cluster m_i of each vertex was found */
    uint32_t *next;     /* [n] scratch: next vertex in the same bucket */
    uint32_t *bucket;   /* [n + 1] scratch: first vertex of each bucket of equal m_i */
    uint32_t n_scanned; /* number of clusters computed so far, for the progress callback */
} smr_priority;

/* Scratch of the forest of one block (order_l_forest.c). Numbers count from the block's first vertex. */
typedef struct smr_forest {
    uint32_t nearest_kind; /* clusters for which nearest[] was found: 0 none yet, 1 shared, 2 separate */
    uint32_t *nearest;     /* [n][SMR_NEAREST] nearest vertices within the vertex' block, SMR_NONE behind the last */
    uint32_t *edge_a, *edge_b; /* [pairs] both ends of the candidate edges of the spanning tree */
    uint32_t *parent;          /* [block_size + 1] parent of each vertex in the union-find, then in the tree */
    uint32_t *link_start;      /* [block_size + 2] index in link[] of each vertex' first neighbour */
    uint32_t *link;            /* [2 (block_size + 1)] neighbours of each vertex in the spanning tree */
} smr_forest;

typedef struct smr_plan {
    const smr_structure *structures;
    const smr_prepare_config *config;
    uint32_t n_structures;
    uint32_t n, nt;          /* number of vertices, and of triangles, of all structures */
    uint32_t block_size;     /* largest number of vertices in a block, a part of the order L with its own forest */
    uint32_t words;          /* length of a row of bits, 64-bit words */
    uint32_t n_rows;         /* number of rows of bits in row[] */
    uint32_t separate;       /* 1: each cluster of the current radius contains vertices of one structure only */
    smr_port port;           /* runs loops over a block; empty for geodesic clusters, which share scratch */
    uint32_t failed;         /* 1: the port has not run all tasks of a loop */
    float centre[3];         /* mm, whole numbers: origin of rest positions */
    float edge_mm, edge_max; /* mean and largest length of mesh edges, mm */

    int16_t *relief; /* [n] relief of the caller's vertices, as in the model; written by smr_plan_relief() */

    /* written by smr_plan_order(), smr_plan_neighbours() and smr_plan_mass(): the model along the curve */
    float *xyz;                /* [n][3] rest positions, mm from centre */
    float *mass;               /* [n] masses m_i of the vertices, about 1 on average */
    uint16_t *owner;           /* [n] structure of each vertex */
    uint32_t *position;        /* [n] curve index of each vertex of the caller */
    uint32_t *original;        /* [n] caller's index of each vertex along the curve */
    uint32_t *triangle;        /* [nt][3] vertices along the curve; structures in a row, each in tree order */
    uint32_t *triangle_index;  /* [nt] the caller's index of each triangle within its structure */
    uint32_t *neighbour_start; /* [n + 1] index in neighbour[] of each vertex' first mesh neighbour */
    uint32_t *neighbour;       /* [6 nt] mesh neighbours of each vertex, vertex after vertex, ascending */
    smr_box_tree points;       /* box tree whose leaves are single vertices */

    /* written by smr_plan_dihedrals() and smr_plan_profiles() */
    uint32_t n_dihedrals;
    smr_stored_dihedral *dihedral; /* [3 nt / 2] edges of exactly two triangles, see model.h */
    uint8_t *profile;              /* [n][profile_samples] packed reference profiles; NULL without a reference image */
    float *range;                  /* [n][2] lowest value and range of each profile */
    float *normal;                 /* [n][3] unit vertex normals */

    /* written by smr_plan_priority() */
    smr_priority priority;
    uint32_t active_min[SMR_RADII_MAX]; /* fewest active vertices that keep clusters large enough at each radius */
    uint32_t progress_total;            /* total number of steps that the progress callback is given */

    /* written by smr_plan_levels(): the order in which the model stores its vertices */
    uint32_t n_levels;
    uint32_t level_end[SMR_LEVELS_MAX];     /* number of vertices in each level and all levels before it */
    uint32_t *stored;                       /* [n] stored index of each vertex along the curve */
    uint32_t *along;                        /* [n] curve index of each stored vertex */
    uint32_t coarse_radii, coarse_vertices; /* as in the model: smr_plan_coarse() */
    uint32_t members;                       /* clusters hold only the first `members` stored vertices; 0: all */
    smr_box_tree few; /* box tree over these `members` vertices in the order of the curve, as `points` */
    uint32_t *of_bit; /* [members] vertex of each bit of a row; NULL without a dense structure */
    uint32_t *bit;    /* [n] bit of each of these vertices */
    uint32_t *level;  /* [n] level of each vertex along the curve; the memory of priority.next */

    /* written for each radius */
    uint64_t *row;       /* [n_rows][words + 1] rows of bits: sets of vertices, see smr_plan_row() */
    uint32_t *count;     /* [n] |zeta_i|, the number of vertices in each cluster */
    uint32_t *entry;     /* [n] index, in the vertex' block, of each vertex' entry of L */
    uint32_t *touched;   /* [n] not 0: a vertex may lie in the cluster's boundary; the memory of priority.bucket */
    uint32_t *n_outside; /* [n] number of boundary vertices beyond the radius of each cluster; the memory of entry */

    /* scratch */
    smr_forest forest;
    float *triangle_centre; /* [nt][3] centres of triangles, times 3, mm */
    uint32_t *key;          /* [max(n, 6 nt, pairs)] sort keys */
    uint32_t *item;         /* [max(n, 6 nt, pairs)] numbers that are sorted by key[] */
    uint32_t *tmp;          /* [2 max(n, 6 nt, pairs)] scratch of sorts; kept edges of the spanning tree */
    uint32_t *queue;        /* [n + 1] vertices still to visit, breadth first */
    uint32_t *geo_distance; /* [n] path lengths, micrometres, UINT32_MAX between searches; NULL: Euclidean distances */
    uint64_t *geo_heap;     /* [6 nt + 1] heap of path length (micrometres) and vertex; NULL: Euclidean distances */
} smr_plan;

/* Sets counts and sizes of the plan; reads no vertex or triangle. Errors: E_NULL, E_INPUT, E_CONFIG. */
smr_status smr_plan_start(smr_plan *p, const smr_structure *structures, uint32_t n, const smr_prepare_config *config);
/* Takes all arrays of the plan from the arena, or measures them. smr_plan_start() must have set their sizes. */
void smr_plan_layout(smr_arena *a, smr_plan *p);

/* Measures relief[] in `bytes` of scratch memory, before the layout: relief_prepare.c. */
void smr_plan_relief(smr_plan *p, void *scratch, size_t bytes);

/* Stages of smr_prepare(), in this order; smr_plan says which fields each one writes. */
void smr_plan_order(smr_plan *p);          /* numbers vertices and triangles: curve_numbering.c */
void smr_plan_neighbours(smr_plan *p);     /* lists mesh neighbours: mesh_measures.c */
void smr_plan_mass(smr_plan *p);           /* computes the vertices' masses: mesh_measures.c */
void smr_plan_dihedrals(smr_plan *p);      /* lists edges of two triangles: fold_dihedrals_prepare.c */
smr_status smr_plan_profiles(smr_plan *p); /* samples intensity profiles; errors of smr_grid_open() */
/* Returns the number of samples of a profile on the inner side of the vertex. Needs a reference image. */
uint32_t smr_profile_inward(const smr_prepare_config *c);
/* Chooses radii, mm, from coarse to fine (cluster_radii.c). Returns their number. */
uint32_t smr_choose_radii(smr_plan *p, float radius[SMR_RADII_MAX]);

/* Returns the number of vertices with dense structures thinned; p->n if options need all vertices in all clusters. */
uint32_t smr_plan_thinned(const smr_plan *p);
/* Chooses coarse_vertices, and coarse_radii among radii chosen by smr_choose_radii(). Needs active_min. */
void smr_plan_coarse(smr_plan *p, const float *radius, uint32_t n_radii);
void smr_plan_members(smr_plan *p, uint32_t radius); /* sets members, few and bits for the radius of this index */
/* Builds a tree over n vertices, vertex[n] or 0 .. n-1. The children of leaf k are vertices 8k .. 8k+7, boxes of size
 * 0. The tree has memory for n vertices. */
void smr_plan_tree(const smr_plan *p, smr_box_tree *tree, uint32_t n, const uint32_t *vertex);
void smr_plan_clear_rows(const smr_plan *p); /* removes all vertices from all rows, whose length may have changed */

/* Computes the priority list S for all radii, and active_min of each radius. separate_below: radius, mm, below which
 * clusters contain vertices of one structure only; empty 1: leaves S empty. Errors: E_ABORTED. */
smr_status smr_plan_priority(smr_plan *p, const float *radius, uint32_t n_radii, float separate_below, int empty);
/* Computes the stored order from S; an empty S gives one level in the order of the curve. */
void smr_plan_levels(smr_plan *p, uint32_t n_radii);

/* A row of bits is a set of vertices, a bit for each curve index, or for each of `members`. Behind its `words` 64-bit
 * words a row has one more: first | last << 32. Only words first .. last-1 may hold bits: small clusters cost little in
 * large models. */
static inline uint32_t smr_row_first(const uint64_t *row, uint32_t words) { return (uint32_t)row[words]; }
static inline uint32_t smr_row_last(const uint64_t *row, uint32_t words) { return (uint32_t)(row[words] >> 32); }

/* Extends the range of words that may hold bits by the words first .. last-1. */
static inline void smr_row_cover(uint64_t *row, uint32_t words, uint32_t first, uint32_t last)
{
    first = smr_min_u32(first, smr_row_first(row, words));
    last = smr_max_u32(last, smr_row_last(row, words));
    row[words] = (uint64_t)last << 32 | first;
}

/* Returns 1 when clusters of the current radius may hold the vertex. */
static inline int smr_is_member(const smr_plan *p, uint32_t v) { return p->members == 0u || p->stored[v] < p->members; }

/* Returns the vertex of a bit. */
static inline uint32_t smr_bit_vertex(const smr_plan *p, uint32_t bit)
{
    return p->members > 0u ? p->of_bit[bit] : bit;
}

/* Adds the vertex of `bit` to the row. */
static inline void smr_row_set(uint64_t *row, uint32_t words, uint32_t bit)
{
    row[bit / 64u] |= (uint64_t)1 << (bit % 64u);
    smr_row_cover(row, words, bit / 64u, bit / 64u + 1u);
}

/* Removes all vertices from the row. */
static inline void smr_row_clear(uint64_t *row, uint32_t words)
{
    for (uint32_t w = smr_row_first(row, words); w < smr_row_last(row, words); w++)
        row[w] = 0;
    row[words] = words;
}

/* Return the number of vertices in the row (count), or in exactly one of the rows a and b (difference_count). */
uint32_t smr_row_count(const uint64_t *row, uint32_t words);
uint32_t smr_row_difference_count(const uint64_t *a, const uint64_t *b, uint32_t words);

/* Returns row i of the plan's n_rows rows of bits. */
static inline uint64_t *smr_plan_row(const smr_plan *p, uint32_t i) { return p->row + (size_t)i * (p->words + 1u); }

/* Returns 1 when clusters of the radius `mm` also hold the mesh neighbours of their vertex. */
static inline int smr_holds_neighbours(const smr_plan *p, float mm) { return p->config->ring && mm >= p->edge_mm; }

#define SMR_BOUNDARY_MM 7.0e-4f /* mm: largest half width of the boundary, thirty times the rounding of coordinates */
#define SMR_BOUNDARY_SHARE (1.0f / 256.0f) /* largest half width of the boundary / radius */
#define SMR_BOUNDARY_ROUNDING 1.0e-6f      /* largest relative rounding error of squared distances to boxes */

/* Where the boundary of the balls of one radius lies (cluster_boundary_prepare.c). */
typedef struct smr_boundary {
    float half, near2, far2; /* half width of the boundary, mm; squared distances that enclose the boundary, mm^2 */
} smr_boundary;

static inline smr_boundary smr_boundary_at(float radius)
{
    const float half = smr_min(SMR_BOUNDARY_MM, SMR_BOUNDARY_SHARE * radius);
    return (smr_boundary){half, (radius - half) * (radius - half) * (1.0f - SMR_BOUNDARY_ROUNDING),
                          (radius + half) * (radius + half) * (1.0f + SMR_BOUNDARY_ROUNDING)};
}

/* cluster: fills the row with the cluster zeta_v of this radius, mm; ball: with all vertices in the ball around v.
 * Return 0 when no vertex lies in the boundary of the ball around v. */
uint32_t smr_cluster_row(smr_plan *p, uint32_t v, float radius, uint64_t *row);
uint32_t smr_ball_row(const smr_plan *p, uint32_t v, float radius, uint64_t *row);

/* Returns the node's child boxes inside the ball of squared radius inside2, mm^2, around p, a bit each. *reaching: the
 * other boxes that reach into the ball of squared radius outside2. */
uint32_t smr_box_kinds(const smr_node *node, smr_vec p, float inside2, float outside2, uint32_t *reaching);
/* Returns the leaf's vertices in the ball of squared radius near2, mm^2, around p, a bit each; *outer: within far2. */
uint32_t smr_leaf_members(const smr_node *leaf, smr_vec p, float near2, float far2, uint32_t *outer);

/* Returns 1 when clusters of the current radius leave out vertices because of their structure. */
static inline uint32_t smr_keeps_apart(const smr_plan *p) { return p->n_structures > 1u && p->separate; }

/* Returns 1 when two vertices are never in each other's cluster at the present radius: separate clusters do not cross
 * structures, except structures without triangles, which share the clusters around them. */
static inline int smr_kept_apart(const smr_plan *p, uint32_t a, uint32_t b)
{
    const uint32_t i = p->owner[a], k = p->owner[b];
    return smr_keeps_apart(p) && i != k && p->structures[i].mesh.n_triangles > 0u &&
           p->structures[k].mesh.n_triangles > 0u;
}

/* Removes from the row the vertices of structures that are kept apart from v (smr_kept_apart). */
void smr_row_keep_structure(const smr_plan *p, uint32_t v, uint64_t *row);

/* Finds the k <= SMR_NEAREST vertices found[k] nearest to v among first .. last-1, without v and vertices kept apart
 * from v. distance2[k], unless NULL: squared distances, mm^2. Returns the number of vertices found. */
uint32_t smr_nearest(const smr_plan *p, uint32_t v, uint32_t first, uint32_t last, uint32_t k, uint32_t *found,
                     float *distance2);

/* The model being written. Bytes beyond the capacity are counted, not written. */
typedef struct smr_writer {
    unsigned char *model;  /* [capacity] the caller's memory; NULL: bytes are counted only */
    size_t capacity, used; /* size of the memory at model, bytes; bytes written or counted so far */
} smr_writer;

/* Write a little-endian number of 2 or 4 bytes at offset `at` of the model. */
void smr_put16(smr_writer *w, size_t at, uint32_t value);
void smr_put32(smr_writer *w, size_t at, uint32_t value);
void smr_put_words(smr_writer *w, size_t at, const uint32_t *word, size_t n); /* writes n numbers of 4 bytes */
/* Appends a section of `bytes` zeros at the next multiple of SMR_ALIGN. Returns the section's offset. */
size_t smr_put_section(smr_writer *w, size_t bytes);
/* Append an additional section of the model, and write its entry: shapes of further subjects; relief[]. */
void smr_write_references(const smr_plan *p, smr_writer *w, uint32_t entry[4]);
void smr_write_relief(const smr_plan *p, smr_writer *w, uint32_t entry[4]);
/* Writes the whole model except the checksum. Errors: E_ABORTED, E_INPUT (more than 4 GiB). */
smr_status smr_write_model(smr_plan *p, smr_writer *w, const float *radius, uint32_t n_radii, float separate_below);

/* The lists of one radius being written: the order L with parents, zeta+ and zeta-, in stored vertex numbers. */
typedef struct smr_list_writer {
    smr_writer *w;
    uint32_t index_bytes;                                            /* 2 or 4: width of an index */
    size_t at_blocks, at_entries, at_count, at_indexes, at_boundary; /* offsets of the sections in the model, bytes */
    uint32_t n_blocks;                                               /* number of blocks begun so far */
    uint32_t n_entries;                                              /* number of entries of L so far */
    uint32_t n_indexes;                                              /* indexes in all zeta+ and zeta- so far */
    uint64_t n_boundary;                                             /* number of boundary pairs so far */
    uint64_t n_members;                                              /* sum of |zeta| so far */
    uint32_t largest, smallest;                                      /* |zeta| of the largest and smallest cluster */
} smr_list_writer;

void smr_list_block(smr_list_writer *l); /* begins a block: part of the order L whose parents all lie within it */

/* An entry of L. */
typedef struct smr_list_entry {
    uint32_t vertex;                  /* curve index of the entry's vertex */
    uint32_t parent;                  /* index of the parent's entry in the block; for a root of its own entry */
    const uint64_t *own, *parent_row; /* the rows of the two clusters; parent_row NULL for a root */
} smr_list_entry;

/* Returns the number of indexes in zeta+ and zeta- of the entry. */
uint32_t smr_entry_indexes(const smr_plan *p, const smr_list_entry *e);
/* Counts an entry at the list's end. count: |zeta| of its vertex. */
void smr_list_append(smr_list_writer *l, uint32_t count, uint32_t n_indexes);
/* Writes the entry with this number, its zeta+ and zeta- from this index of the list on, and |zeta|. Entries can be
 * written in any order, by several threads. */
void smr_entry_write(const smr_list_writer *l, const smr_plan *p, const smr_list_entry *e, uint32_t entry,
                     size_t index);
/* Writes the boundary pairs of a radius behind its lists, and adds boundary vertices to the largest cluster's size. */
void smr_write_boundary(smr_plan *p, smr_list_writer *l, float radius);
/* Writes the clusters of the vertices first .. last-1 along the curve as one block: a minimum spanning forest. */
void smr_forest_block(smr_plan *p, smr_list_writer *l, uint32_t first, uint32_t last, float radius);
/* Writes all clusters as one block in the paper's breadth-first order. Errors: E_ABORTED (progress callback). */
smr_status smr_breadth_first(smr_plan *p, smr_list_writer *l, float radius, uint32_t radius_index, uint32_t n_radii);

#endif
