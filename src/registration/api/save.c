/* save.c: saves a registration between two iterations into the caller's memory: the slots that smr_layout() lists, log,
 * schedule, report, and checksums of the inputs. Values that follow from the model, the inputs or the next iteration
 * are not saved; the time budget learns the costs of steps again.
 * Bounds: one pass over all slots, and one over each input.
 * SPDX-License-Identifier: MIT */
#include "options/track/track.h"
#include "options/dynamics/dynamics.h"
#include "registration/api/setup.h"
#include "registration/measure_job.h"
#include "registration/schedule_radius.h"

/* Saves the state of the log, without the log's memory. */
static void keep_log(smr_arena *a, smr_log *log)
{
    uint64_t used = log->used;
    smr_keep_long(a, &used);
    smr_keep_require(a, used == 0u || (used >= SMR_LOG_FIXED + 8u && used <= SIZE_MAX));
    log->used = (size_t)used;
    smr_keep_words(a, &log->crc, 1, UINT32_MAX);
    smr_keep_words(a, &log->n_ticks, 1, UINT32_MAX);
    smr_keep_words(a, &log->full, 1, 1);
    smr_keep_words(a, &log->fresh, 1, 1);
}

static void keep_report(smr_arena *a, smr_tick_report *r, uint32_t n)
{
    smr_keep_words(a, &r->details.n_taken, 1, n);
    smr_keep_words(a, &r->details.n_wanted, 1, n);
    smr_keep_words(a, &r->details.n_active, 1, n);
    smr_keep_words(a, &r->n_forces, 1, n);
    smr_keep_words(a, &r->details.n_rejected, 1, n);
    smr_keep_floats(a, &r->details.matched_share, 1, -1.0f, 1.0f);
    smr_keep_floats(a, &r->details.attraction_used, 1, 0.0f, 1.0f);
    smr_keep_floats(a, &r->residual_mean_mm, 1, -1.0f, 2.0f * SMR_KEPT_MM);
    smr_keep_floats(a, &r->details.residual_rms_mm, 1, -1.0f, 2.0f * SMR_KEPT_MM);
    smr_keep_floats(a, &r->details.residual_max_mm, 1, -1.0f, 2.0f * SMR_KEPT_MM);
    smr_keep_floats(a, &r->displacement_max_mm, 1, 0.0f, 2.0f * SMR_KEPT_MM);
    smr_keep_long(a, &r->state_hash);
}

/* Saves the schedule. Search distances, momentum and fade are chosen again when an iteration begins. */
static void keep_schedule(smr_arena *a, smr *s)
{
    smr_schedule *p = &s->schedule;
    const uint32_t n = s->shared.n;
    smr_keep_words(a, &p->radius, 1, smr_last_radius(&s->shared));
    smr_keep_words(a, &p->radius_iteration, 1, UINT32_MAX);
    smr_keep_words(a, &p->iteration, 1, UINT32_MAX);
    smr_keep_words(a, &p->n_points, 1, UINT32_MAX);
    smr_keep_words(a, &p->since_plastic, 1, UINT32_MAX);
    smr_keep_words(a, &p->plastic_updates, 1, UINT32_MAX);
    smr_keep_words(a, &p->converged, 1, 1);
    smr_keep_words(a, &p->done, 1, 1);
    smr_keep_words(a, &p->repairing, 1, 1);
    smr_keep_words(a, &p->repaired, 1, SMR_REPAIRED);
    smr_keep_words(a, &p->n_active, 1, n);
    smr_keep_words(a, &p->n_active_chosen, 1, n);
    smr_keep_words(a, &p->n_set, 1, UINT32_MAX);
    smr_keep_words(a, &p->serial, 1, UINT32_MAX);
    smr_keep_require(a, p->radius >= s->shared.config.schedule.radius_first);
    if (SMR_HAS_TRACK)
        smr_tracking_keep(a, s);
    if (a->keeper->mode == SMR_KEEP_COUNT || a->keeper->wrong)
        return;
    smr_radius_take(s);
    smr_keep_require(a, p->n_active >= smr_min_u32(p->lists.active_min, n) && p->n_active <= p->lists.members);
    const smr_config *c = &s->shared.config;
    const uint32_t most =
        smr_at_last_radius(&s->shared, p) ? c->basic.iterations_last : SMR_FIRST_CLOUD * c->basic.iterations;
    if (SMR_HAS_DYNAMICS && c->dynamics.mode)
        smr_keep_require(a, !p->done && !p->repairing && p->radius == smr_radius_after(s));
    else if (smr_tracks(p))
        smr_keep_require(a, smr_tracking_legal(s));
    else
        smr_keep_require(a, p->radius_iteration <= most);
    smr_keep_require(a, p->repaired == 0u || (!p->repairing && !smr_tracks(p) && !c->dynamics.mode));
}

static void keep_fields(smr_arena *a, smr *s)
{
    keep_log(a, &s->log);
    smr_keep_words(a, &s->budget.cut, 1, 1);
    keep_report(a, &s->report, s->shared.n);
    smr_keep_inputs(a, s);
    keep_schedule(a, s); /* last, since the ranges of the schedule depend on the other fields */
}

void smr_go_over(smr *s, smr_keeper *k)
{
    smr_arena a = smr_arena_measure();
    k->calls = &smr_keep_all;
    k->fields = keep_fields;
    a.keeper = k;
    (void)smr_layout(&a, s);
}

/* ---- smr_save() as a job ---- */

#define SMR_CRC_PIECE 4096u /* bytes in a task that checks sums */

typedef struct saving {
    smr_measuring job;
    unsigned char *to;
    size_t needed, at;   /* bytes of the save; bytes done in the present stage */
    uint32_t plan;       /* checksum of the list of values */
    uint32_t crc, whole; /* CRC-32 of the bytes done; 1: all values at once */
    smr_summing inputs;
} saving;

_Static_assert(sizeof(saving) <= SMR_JOB_BYTES, "a save in progress lies in the caller's job");

/* Counts or writes a copy of s that shares the arrays of s; does not change s. Writes bytes first .. last - 1. */
static smr_keeper go_over(const smr *s, uint32_t mode, unsigned char *to, size_t bytes, size_t first, size_t last)
{
    smr copy = *s;
    copy.shape.x_ref = smr_plastic_follows(s) ? s->shape.x : s->shape.x_ref;
    copy.shape.normal_ref = smr_plastic_follows(s) ? s->shape.normal : s->shape.normal_ref;
    const size_t values_at = SMR_SAVED_FIXED + 4u * smr_log_config_words(&s->shared.config);
    smr_keeper k = {.mode = mode, .to = to, .at = values_at, .bytes = bytes, .first = first, .last = last};
    smr_go_over(&copy, &k);
    return k;
}

static void sum_inputs(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    saving *j = job;
    if (!smr_sum_inputs(j->job.s, &j->inputs, SMR_TRIANGLE_CHUNK))
        smr_job_again(&j->job.head);
}

static void write_header(const smr *s, unsigned char *to, uint32_t needed, uint32_t plan)
{
    const uint32_t version = SMR_VERSION_MAJOR << 16 | SMR_VERSION_MINOR << 8 | SMR_VERSION_PATCH;
    const uint32_t header[SMR_SAVED_FIXED / 4u] = {SMR_SAVED_MAGIC,
                                                   SMR_SAVED_VERSION,
                                                   needed,
                                                   version,
                                                   smr_le32(s->shared.model->checksum),
                                                   s->shared.n,
                                                   plan,
                                                   smr_log_config_words(&s->shared.config)};
    for (size_t i = 0; i < SMR_SAVED_FIXED / 4u; i++)
        smr_log_put32(to + 4u * i, header[i]);
    smr_log_put_config(to + SMR_SAVED_FIXED, &s->shared.config);
}

/* Writes the fields of structs and a piece of the slots. */
static void write_values(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    saving *j = job;
    const size_t all = j->needed - 4u, last = smr_keep_end(j->at, all, j->whole);
    const smr_keeper k = go_over(j->job.s, SMR_KEEP_SAVE, j->to, all, j->at, last);
    j->plan = j->at == 0u ? k.plan : j->plan;
    j->at = last;
    if (k.wrong)
        j->job.head.status = SMR_E_STATE;
    if (last < all) {
        smr_job_again(&j->job.head);
        return;
    }
    write_header(j->job.s, j->to, (uint32_t)j->needed, j->plan);
    j->at = 0;
}

static void sum_bytes(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    saving *j = job;
    const size_t left = j->needed - 4u - j->at, n = left < SMR_CRC_PIECE ? left : SMR_CRC_PIECE;
    j->crc = smr_crc32(j->crc, j->to + j->at, n);
    j->at += n;
    if (n < left)
        smr_job_again(&j->job.head);
    else
        smr_log_put32(j->to + j->at, j->crc);
}

static const smr_stage stages[] = {
    /* each comes back for each piece */
    {NULL, sum_inputs, NULL, NULL},
    {NULL, write_values, NULL, NULL},
    {NULL, sum_bytes, NULL, NULL},
};

static int unchanged(void *job, int enter)
{
    saving *j = job;
    const smr_status status = enter ? smr_inputs_valid(&j->job.s->forces) : SMR_OK;
    if (status != SMR_OK)
        j->job.head.status = status;
    return status == SMR_OK && smr_measure_guard(&j->job, enter);
}

smr_status smr_save_bytes(const smr *s, size_t *bytes)
{
    SMR_TRY(smr_readable(s, 0, bytes));
    *bytes = go_over(s, SMR_KEEP_COUNT, NULL, 0, 0, 0).at + 4u;
    return SMR_OK;
}

smr_status smr_save_begin(smr *s, void *memory, size_t bytes, smr_job *job)
{
    saving *const j = (saving *)(void *)job;
    size_t needed = 0;
    if (memory == NULL || job == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_save_bytes(s, &needed));
    SMR_TRY(smr_sound(s));
    if (!smr_measurable(s) || s->refused || s->forces.caller.broken || !smr_can_wait(&s->shared))
        return SMR_E_STATE; /* saves only between iterations, when all inputs can still be read */
    SMR_TRY(smr_inputs_valid(&s->forces));
    if (bytes < needed || needed > UINT32_MAX)
        return SMR_E_ARENA;
    memset(j, 0, sizeof *j);
    j->job = smr_measure_begin(s, stages, sizeof stages / sizeof stages[0]);
    j->job.head.guard = unchanged;
    j->to = memory;
    j->needed = needed;
    return SMR_OK;
}

static void save_whole(smr_job *job) { ((saving *)(void *)job)->whole = 1; }

smr_status smr_save(const smr *s, void *memory, size_t bytes)
{
    smr_job job;
    if (s == NULL || memory == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_valid(s) ? smr_save_begin(s->placed, memory, bytes, &job) : SMR_E_STATE);
    save_whole(&job);
    return smr_job_step(&job, 0, &smr_alone, 0);
}
