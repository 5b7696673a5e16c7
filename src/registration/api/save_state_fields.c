/* save_state_fields.c: what a save keeps of a registration beside its slots: where log, schedule and report stand, and
 * which inputs it has. What the clock taught is learnt anew.
 * Bounds: those of restore_awaited_inputs.c.
 * SPDX-License-Identifier: MIT */
#include "registration/api/setup.h"
#include "options/dynamics/dynamics.h"
#include "options/track/track.h"
#include "registration/schedule_radius.h"

/* Saves the state of the recording, without its memory. */
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

/* Saves the schedule. Search distances and shares are chosen anew when an iteration begins. */
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
    smr_keep_words(a, &p->repairing, 1, SMR_REPAIR_MAX);
    smr_keep_words(a, &p->n_active, 1, n);
    smr_keep_words(a, &p->n_active_chosen, 1, n);
    smr_keep_require(a, p->radius >= s->shared.config.schedule.radius_first);
    if (SMR_HAS_TRACK)
        smr_tracking_keep(a, s);
    if (a->keeper->mode == SMR_KEEP_COUNT || a->keeper->wrong)
        return;
    smr_radius_take(s);
    smr_keep_require(a, p->n_active >= smr_min_u32(p->lists.active_min, n));
    if (SMR_HAS_DYNAMICS && s->shared.config.dynamics.mode) {
        smr_keep_require(a, !p->done && !p->repairing && p->radius == smr_radius_after(s));
        return;
    }
    if (smr_tracks(p)) {
        smr_keep_require(a, smr_tracking_legal(s));
        return;
    }
    smr_keep_require(a, p->radius_iteration <= (smr_at_last_radius(&s->shared, p)
                                                    ? s->shared.config.basic.iterations_last
                                                    : SMR_FIRST_CLOUD * s->shared.config.basic.iterations));
}

static void keep_fields(smr_arena *a, smr *s)
{
    keep_log(a, &s->log);
    smr_keep_words(a, &s->budget.cut, 1, 1);
    keep_report(a, &s->report, s->shared.n);
    smr_keep_inputs(a, s);
    keep_schedule(a, s); /* last, since its ranges depend on the others */
}

void smr_go_over(smr *s, smr_keeper *k)
{
    smr_arena a = smr_arena_measure();
    k->calls = &smr_keep_all;
    k->fields = keep_fields;
    a.keeper = k;
    (void)smr_layout(&a, s);
}
