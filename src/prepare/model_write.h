/* model_write.h: writes the model's bytes section by section, and the cluster lists of one radius.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MODEL_WRITE_H
#define SMR_MODEL_WRITE_H

#include "prepare/prepare_plan.h"

/* The model being written. Bytes beyond the capacity are counted, not written. */
typedef struct smr_writer {
    unsigned char *model; /* NULL: count only */
    size_t capacity;      /* bytes at model */
    size_t used;          /* bytes so far */
} smr_writer;

/* Writes a little-endian number at offset `at`. */
void smr_put16(smr_writer *w, size_t at, uint32_t value);
void smr_put32(smr_writer *w, size_t at, uint32_t value);

/* Appends a section of `bytes` zeros at the next multiple of SMR_ALIGN. Returns its offset. */
size_t smr_put_section(smr_writer *w, size_t bytes);

/* Writes the whole model but its checksum. Errors: E_ABORTED, E_INPUT (more than 4 GiB). */
smr_status smr_write_model(smr_plan *p, smr_writer *w, const float *radius, uint32_t n_radii, float separate_below);

/* The lists of one radius being written: the order L with parents, zeta+ and zeta-, in stored vertex numbers. */
typedef struct smr_list_writer {
    smr_writer *w;
    uint32_t index_bytes;                                            /* 2 or 4: width of an index */
    size_t at_blocks, at_entries, at_count, at_indexes, at_boundary; /* offsets of the sections */
    uint32_t n_blocks;                                               /* blocks begun so far */
    uint32_t n_entries;                                              /* entries of L so far */
    uint32_t n_indexes;                                              /* indexes in all zeta+ and zeta- so far */
    uint64_t n_boundary;                                             /* boundary pairs so far */
    uint64_t n_members;                                              /* sum of |zeta| so far */
    uint32_t largest, smallest;                                      /* |zeta| of the largest and smallest cluster */
} smr_list_writer;

/* Begins a block: part of the order L whose parents all lie within it. */
void smr_list_block(smr_list_writer *l);

/* Appends an entry of L: the vertex, its parent, zeta+ and zeta-. vertex: number along the curve; parent: entry number
 * within the block; own, parent_row: the two clusters' rows, parent_row NULL for a root. */
void smr_list_entry(smr_list_writer *l, smr_plan *p, uint32_t vertex, uint32_t parent, const uint64_t *own,
                    const uint64_t *parent_row);

/* Writes the boundary pairs of the radius behind its lists, and adds them to the largest cluster's size. */
void smr_write_boundary(smr_plan *p, smr_list_writer *l, float radius);

/* Writes the clusters of the vertices first .. last-1 along the curve as one block: a minimum spanning forest. */
void smr_forest_block(smr_plan *p, smr_list_writer *l, uint32_t first, uint32_t last, float radius);

/* Writes all clusters as one block in the paper's breadth-first order. radius_index, n_radii: for the callback.
 * Errors: E_ABORTED. */
smr_status smr_breadth_first(smr_plan *p, smr_list_writer *l, float radius, uint32_t radius_index, uint32_t n_radii);

#endif
