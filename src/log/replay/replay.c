/* replay.c: repeats a recorded registration from its log and its inputs, to the last bit, on any processor with any
 * number of threads. The log has what a budget decides: the number of active vertices and the iteration that each input
 * affects. Each iteration runs with that number. Inputs come between iterations, before an iteration's first search
 * (recorded while its forces were incomplete), or before its last step (recorded later), which may begin tracking or
 * change the radius by what is known of targets. An input that restarts the schedule abandons the iteration.
 * Bounds: each record is read once; a tick begins at most two iterations.
 * SPDX-License-Identifier: MIT */
#include "registration/config/config.h"
#include "registration/registration.h"
#include "registration/tick/iteration_steps.h"

/* smr_replay.state, by the last record of a tick: it ended an iteration; forces were incomplete, and nothing is
 * computed here yet; forces were complete, and all but the last step is computed. */
enum { SMR_REPLAY_BETWEEN = 0, SMR_REPLAY_BEGUN, SMR_REPLAY_FORCES };

smr_status smr_replay_start(smr *s, const void *log, size_t bytes, smr_log_input input, void *ctx, smr_replay *replay)
{
    smr_log_reader reader;
    smr_log_info info;
    if (replay == NULL || s == NULL || log == NULL)
        return SMR_E_NULL;
    if (!smr_ready(s) || !s->log.fresh)
        return SMR_E_STATE;
    SMR_TRY(smr_log_open(log, bytes, &reader, &info));
    if (info.model_checksum != smr_le32(s->shared.model->checksum) || info.n_vertices != s->shared.n)
        return SMR_E_MODEL;
    info.config.basic.n_workers = s->shared.config.basic.n_workers; /* any number of workers is accepted */
    if (smr_config_left_out(&info.config))
        return SMR_E_WITHOUT;
    if (memcmp(&info.config, &s->shared.config, sizeof info.config) != 0)
        return SMR_E_CONFIG;
    *replay = (smr_replay){.s = s, .reader = reader, .input = input, .ctx = ctx};
    return SMR_OK;
}

/* Collects the landmarks of successive records, and sets them with the last record. */
static smr_status set_landmark(smr_replay *r, const smr_log_record *record)
{
    if (record->index != r->n_landmarks || (record->index > 0u && record->count != r->count))
        return SMR_E_LOG;
    r->count = record->count;
    r->landmark[r->n_landmarks++] = record->landmark;
    if (r->n_landmarks < record->count)
        return SMR_OK;
    r->n_landmarks = 0;
    return smr_set_landmarks(r->s, r->landmark, record->count);
}

/* Returns 1 when an iteration that has its forces goes on after an input of this kind. */
static int of_forces(uint32_t kind)
{
    return kind == SMR_LOG_SURFACE || kind == SMR_LOG_POINTS || kind == SMR_LOG_LANDMARKS || kind == SMR_LOG_GOALS ||
           kind == SMR_LOG_FORCE || kind == SMR_LOG_FIXED_SURFACE || kind == SMR_LOG_VOLUME_RATIO;
}

/* Returns 1 when the checksum of the caller's input is the recorded one; a force only has to be a function. */
static int is_recorded(const smr *s, const smr_log_record *record, const void *given)
{
    const smr_motion *motion = given;
    smr_grid grid;
    int legal = 1;
    switch (record->kind) {
    case SMR_LOG_FORCE: return ((const smr_caller_force *)given)->force != NULL; /* functions have no checksum */
    case SMR_LOG_SURFACE:
    case SMR_LOG_FIXED_SURFACE: legal = smr_surface_valid(given); break;
    case SMR_LOG_POINTS: legal = smr_points_valid(given); break;
    case SMR_LOG_VOLUME: legal = smr_grid_open(given, &grid) == SMR_OK; break;
    case SMR_LOG_MOTION: legal = motion->mass != NULL || motion->velocity != NULL; break;
    default: break;
    }
    const int whole = record->structure >= s->shared.n_structures; /* 1: the input belongs to no single structure */
    const uint32_t n = whole ? s->shared.n : s->shape.structure[record->structure].n_vertices; /* of positions */
    return legal && smr_log_checksum(record->kind, given, n) == record->checksum;
}

/* Sets a recorded input in the registration, with the caller's data where the record has only a checksum. */
static smr_status set_input(smr_replay *r, const smr_log_record *record)
{
    const void *given = NULL;
    smr *s = r->s;
    const uint32_t kind = record->kind, structure = record->structure;
    const int owned = kind == SMR_LOG_POSITIONS || kind == SMR_LOG_GOALS || kind == SMR_LOG_MOTION;
    if ((owned && structure >= s->shared.n_structures) || (kind == SMR_LOG_ALL_POSITIONS && structure != SMR_ALL))
        return SMR_E_LOG;
    if (record->present) {
        given = r->input == NULL ? NULL : r->input(r->ctx, record);
        if (given == NULL || !is_recorded(s, record, given))
            return SMR_E_INPUT;
    }
    const smr_caller_force *force = given;
    const smr_goals *goals = given;
    const smr_motion *motion = given;
    switch (kind) {
    case SMR_LOG_POSE: return smr_set_pose(s, &record->pose);
    case SMR_LOG_LANDMARKS: return set_landmark(r, record);
    case SMR_LOG_VOLUME_RATIO: return smr_set_volume_ratio(s, structure, record->ratio);
    case SMR_LOG_FORCE: return smr_set_force(s, given != NULL ? force->force : NULL, given != NULL ? force->ctx : NULL);
    case SMR_LOG_GOALS:
        return smr_set_goals(s, structure, given != NULL ? goals->xyz : NULL, given != NULL ? goals->weights : NULL);
    case SMR_LOG_MOTION:
        return motion != NULL ? smr_set_motion(s, structure, motion->mass, motion->velocity) : SMR_E_LOG;
    case SMR_LOG_SURFACE: return smr_set_surface(s, structure, given);
    case SMR_LOG_FIXED_SURFACE: return smr_set_fixed(s, record->index, given);
    case SMR_LOG_POINTS: return smr_set_points(s, structure, given);
    case SMR_LOG_VOLUME: return smr_set_volume(s, given);
    default: return smr_set_positions(s, structure, given);
    }
}

/* Runs the iteration up to the step whose tasks `run` does. */
static smr_status run_until(const smr_replay *r, smr_run_task *run)
{
    const smr_status status = smr_tick_until(r->s, run);
    return status == SMR_PARTIAL ? SMR_OK : status;
}

static smr_status take_input(smr_replay *r, const smr_log_record *record)
{
    if (r->n_landmarks > 0u && record->kind != SMR_LOG_LANDMARKS)
        return SMR_E_LOG; /* announced landmarks are missing */
    SMR_TRY(r->state == SMR_REPLAY_BEGUN ? run_until(r, smr_attract_search) : SMR_OK);
    r->state = of_forces(record->kind) && r->state == SMR_REPLAY_FORCES ? SMR_REPLAY_FORCES : SMR_REPLAY_BETWEEN;
    const smr_status status = set_input(r, record);
    return status == SMR_E_CONFIG ? SMR_E_WITHOUT : status; /* this build leaves out what the input needs */
}

/* Returns this registration's state as a record, for comparison with the recorded tick. */
static smr_log_record found_here(const smr *s, const smr_log_record *recorded)
{
    smr_log_record found = *recorded;
    found.iteration = s->schedule.iteration;
    found.state_hash = s->report.state_hash;
    found.done = s->schedule.done;
    found.plastic_updates = s->schedule.plastic_updates;
    if (recorded->complete) {
        found.n_taken = found.n_evaluated = s->report.details.n_taken;
        found.n_forces = s->report.n_forces;
        found.checksum = s->forces.caller.reported_sum;
    }
    return found;
}

/* Repeats an iteration up to the point that an input after this record may depend on. */
static smr_status take_tick(smr_replay *r, const smr_log_record *record)
{
    const int has_forces = record->complete || record->phase != SMR_PHASE_FORCES;
    if (r->n_landmarks > 0u)
        return SMR_E_LOG;
    if (!has_forces) {
        r->state = SMR_REPLAY_BEGUN;
        return SMR_OK;
    }
    if (r->state != SMR_REPLAY_FORCES) {
        SMR_TRY(smr_set_active(r->s, record->complete ? record->n_taken : record->n_evaluated));
        SMR_TRY(record->complete ? SMR_OK : run_until(r, smr_commit));
    }
    r->state = record->complete ? SMR_REPLAY_BETWEEN : SMR_REPLAY_FORCES;
    return record->complete ? smr_tick(r->s, 0, NULL) : SMR_OK;
}

static smr_status compare_tick(smr_replay *r, smr_replay_report *report)
{
    smr_log_record *const recorded = &report->record;
    recorded->checksum = r->gave;
    r->gave = 0;
    SMR_TRY(take_tick(r, recorded));
    report->found = found_here(r->s, recorded);
    const smr_log_record *const a = recorded, *const b = &report->found;
    report->differs = a->iteration != b->iteration || a->state_hash != b->state_hash || a->done != b->done ||
                      a->plastic_updates != b->plastic_updates || a->n_taken != b->n_taken ||
                      a->n_forces != b->n_forces || a->checksum != b->checksum;
    return SMR_OK;
}

smr_status smr_replay_tick(smr_replay *replay, smr_replay_report *report)
{
    if (replay == NULL || report == NULL)
        return SMR_E_NULL;
    memset(report, 0, sizeof *report);
    report->tick = replay->n_ticks + 1u;
    for (;;) {
        const smr_log_reader before = replay->reader;
        SMR_TRY(smr_log_next(&replay->reader, &report->record));
        const uint32_t kind = report->record.kind;
        if (kind == 0u || kind == SMR_LOG_FULL) {
            report->ended = 1;
            report->tick = replay->n_ticks;
            report->full = kind == SMR_LOG_FULL;
            replay->reader = before; /* goes back, so that the next call finds the log's end again */
            return SMR_OK;
        }
        if (kind == SMR_LOG_TICK) {
            replay->n_ticks++;
            return compare_tick(replay, report);
        }
        if (report->record.gave)
            replay->gave = report->record.checksum;
        else if (kind != SMR_LOG_ACTIVE)
            SMR_TRY(take_input(replay, &report->record));
    }
}
