/* model_open.h: a model whose checks are under way (base/job.h), and the stages that check the lists of its radii.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_MODEL_OPEN_H
#define SMR_MODEL_OPEN_H

#include "base/job.h"
#include "model/model.h"

#define SMR_WINDOW 4096u     /* vertices checked at a time for having one entry each, a bit each */
#define SMR_OPEN_PIECE 256u  /* vertices, triangles or entries checked in a task */
#define SMR_OPEN_WORDS 2048u /* indexes, counts or floats checked in a task */
#define SMR_OPEN_BYTES 8192u /* bytes in a task that sums them */

/* A model whose checks are under way. */
typedef struct smr_opening {
    smr_job_head head;
    const smr_model *m;
    const smr_model **out;
    uint32_t crc, k;       /* checksum of the bytes so far; radius that is checked now */
    uint32_t block, lo, i; /* block of that radius; first vertex of the window; entry, from the block's first on */
    uint64_t used;         /* number of indexes of the block's entries so far */
    uint32_t next[SMR_LEVELS_MAX];      /* next vertex of each level */
    uint32_t visited[SMR_WINDOW / 32u]; /* a bit for each vertex of the window */
} smr_opening;

_Static_assert(sizeof(smr_opening) <= SMR_JOB_BYTES, "checks in progress lie in the caller's job");

static inline const smr_model *smr_opened(const void *job) { return ((const smr_opening *)job)->m; }
static inline void smr_open_require(void *job, int legal)
{
    if (!legal)
        ((smr_opening *)job)->head.status = SMR_E_MODEL;
}
static inline uint32_t smr_open_pieces(uint32_t n) { return smr_ceil_div(n, SMR_OPEN_PIECE); }

int smr_floats_within(const uint32_t *stored, size_t n, float lo, float hi); /* 1: all n stored floats are lo .. hi */
/* Returns 1 when all n indexes of the list, each `width` bytes wide, are below `limit`. */
int smr_all_below(const void *list, uint32_t width, size_t n, uint32_t limit);

/* model_open_lists.c: stages that check the lists of a radius; smr_open_blocks() comes back for each piece. */
smr_count_tasks smr_open_boundary_tasks, smr_open_index_tasks, smr_open_vertex_tasks;
smr_run_task smr_open_radius, smr_open_boundary, smr_open_indexes, smr_open_counts, smr_open_blocks;

#endif
