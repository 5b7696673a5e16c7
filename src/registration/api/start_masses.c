/* start_masses.c: stages of smr_init() with dynamics: counts the members of clusters, and finds weights of fits.
 * Bounds: for each SMR_WORDS structures a pass over the lists of the radius of time steps, and two over the vertices;
 * two more over the vertices.
 * SPDX-License-Identifier: MIT */
#include "options/dynamics/dynamics.h"
#include "registration/api/start.h"

static smr *of(const void *job) { return ((const smr_starting *)job)->job.s; }
static smr_piece piece_of(const void *job, uint32_t task)
{
    return smr_piece_of(task, SMR_START_PIECE, of(job)->shared.n);
}

static void begin(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    j->k = j->at = 0;
    smr_members_begin(of(job));
}

static void mark(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_members_mark(of(job), ((smr_starting *)job)->k, piece_of(job, task));
}

static void sum_lists(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    if (smr_sums_some(&of(job)->sums, &j->at))
        smr_job_again(&j->job.head);
}

static uint32_t boundary_tasks(const void *job) { return smr_boundary_tasks(&of(job)->sums); }

static void sum_boundary(void *job, uint32_t task, uint32_t worker) { smr_boundary_sums(&of(job)->sums, task, worker); }

/* Takes the sums; goes back to the records of the next structures. */
static void add_members(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_starting *j = job;
    smr_members_add(j->job.s, j->k, piece_of(job, task));
    if (task + 1u < smr_start_vertices(job))
        return;
    j->k += SMR_WORDS;
    j->at = 0;
    if (j->k < j->job.s->shared.n_structures)
        j->job.head.next_stage = j->job.head.stage - 3u;
}

uint32_t smr_start_weights(const void *job) { return smr_moves(of(job)) ? smr_start_vertices(job) : 0u; }

void smr_start_add_weights(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    if (SMR_HAS_DYNAMICS)
        smr_weights_add(of(job), piece_of(job, task));
}

void smr_start_set_weights(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    if (SMR_HAS_DYNAMICS)
        smr_weights_set(of(job), piece_of(job, task));
}

static void end(void *job, uint32_t task, uint32_t worker) { ((smr_starting *)job)->then(job, task, worker); }

static const smr_stage stages[] = {
    {NULL, begin, NULL, NULL},
    {smr_start_vertices, mark, smr_in_order, NULL},
    {NULL, sum_lists, NULL, NULL}, /* comes back for each piece */
    {boundary_tasks, sum_boundary, smr_in_order, NULL},
    {smr_start_vertices, add_members, smr_in_order, NULL},
    {smr_start_weights, smr_start_add_weights, smr_in_order, NULL},
    {smr_start_weights, smr_start_set_weights, smr_in_order, NULL},
    {NULL, end, NULL, NULL},
};

void smr_start_masses_go(smr_starting *j) { smr_job_go(&j->job.head, stages, sizeof stages / sizeof stages[0]); }
