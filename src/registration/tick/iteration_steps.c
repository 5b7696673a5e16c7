/* iteration_steps.c: one registration iteration, in the order of the paper's section 2.3. The table lists the steps;
 * the functions above the table pass results of one stage to the next. Only the last step makes new positions current,
 * so readers of positions always see a complete iteration.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"
#include "registration/tick/iteration_steps.h"

/* Restarts momentum where points pull the model back, as accelerated gradients do (O'Donoghue and Candes 2015). Not in
 * tracking, which limits momentum itself, and not beside an image. */
static void cloud_end(smr *s)
{
    if (!smr_tracks(&s->schedule) && !s->forces.image.has_image && s->forces.surface.clouds->swings(&s->forces.points))
        s->schedule.momentum = 0.0f;
}

static void forces_end(smr *s)
{
    const smr_force_totals *t = &s->forces.totals;
    smr_forces_end(&s->forces);
    s->schedule.serial_of_forces = s->schedule.n_set;
    s->schedule.others = 0;
    for (uint32_t i = 0; i < s->shared.n_structures; i++)
        s->schedule.others += s->forces.surface.target[i].others;
    smr_sums_expect(&s->sums, smr_method_words(&s->shared), t->largest[0], t->largest[1]);
    s->report.details.n_taken = s->schedule.n_active;
    s->report.details.n_active = t->n_with_target;
    s->report.n_forces = t->n_forces;
    s->report.details.n_rejected = t->n_rejected;
    const int attracts = smr_attraction_on(&s->forces.surface) && s->schedule.repairing == 0u;
    s->report.details.attraction_used = attracts ? s->shared.config.basic.attraction : 0.0f;
    s->report.details.matched_share = s->forces.matched;
    s->report.residual_mean_mm = t->n_residuals > 0u ? t->mean : -1.0f;
    s->report.details.residual_rms_mm = t->n_residuals > 0u ? t->rms : -1.0f;
    s->report.details.residual_max_mm = t->n_residuals > 0u ? t->max : -1.0f;
    if (smr_tracks(&s->schedule))
        smr_tracking_find_jump(s);
    if (s->forces.surface.clouds != NULL)
        s->forces.surface.clouds->view(&s->forces.surface);
}

static void track_rest_end(smr *s)
{
    if (SMR_HAS_HELD)
        smr_track_rest_sum_end(&s->shape);
}

static void match_end(smr *s)
{
    smr_match_end(&s->match);
    smr_sums_expect(&s->sums, smr_transform_words(&s->shared), s->match.largest[0], s->match.largest[1]);
}

static void measure_end(smr *s)
{
    smr_evolve_measure_end(&s->evolve);
    s->volumes.pending = (uint32_t)(smr_volumes_used(&s->volumes) && smr_volumes_pending(&s->volumes));
    s->evolve.normals_due = s->shared.config.motion.normals == SMR_NORMALS_EXACT || s->schedule.tracking ||
                            smr_moves(s) || smr_plastic_ahead(s);
    s->evolve.ref_next = smr_tracks(&s->schedule)                 ? SMR_REF_POSED
                         : SMR_HAS_TRACK && smr_tracking_ahead(s) ? SMR_REF_STARTS
                                                                  : SMR_REF_STAYS;
    if (s->evolve.ref_next == SMR_REF_STARTS)
        smr_track_rest_clear(&s->shape);
}

static void rest_pose_end(smr *s) { smr_rest_pose_end(&s->shape); }
static void reference_begin(smr *s) { smr_reference_begin(&s->reference); }
static void reference_end(smr *s) { smr_reference_end(&s->reference); }
static void evolve_end(smr *s) { smr_triangles_follow(&s->shape, s->shape.x_next); }
static void strain_end(smr *s) { s->reference.strained = s->reference.many_over; }
static void find_end(smr *s) { smr_fold_find_end(&s->folds); }
static void folds_moved(smr *s) { smr_folds_moved(&s->folds); }

/* Returns the number of tasks that update the triangles once more; 0: no fold step moved a vertex. */
static uint32_t triangles_again(const void *arg)
{
    const smr *s = arg;
    return s->folds.moved ? smr_triangles_tasks(&s->shape) : 0u;
}

void smr_refit_again(void *s, uint32_t task, uint32_t worker) { smr_triangles_refit(&((smr *)s)->shape, task, worker); }

static uint32_t one_task(const void *stage) { return (void)stage, 1u; }

/* Exchanges normals with the next ones, which lie in the sums, and sets x^r as evolve.ref_next says. A reader that
 * comes before the last step finds the former ones in the sums. */
static void exchange(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr *s = arg;
    const uint32_t ref = SMR_HAS_TRACK ? s->evolve.ref_next : SMR_REF_STAYS;
    for (uint32_t v = task * SMR_CHUNK; v < smr_chunk_end(&s->shared, task); v++) {
        const smr_vec next = smr_next_normal(s->sums.sum, v);
        smr_next_normal_set(s->sums.sum, v, smr_get3(s->shape.normal, v));
        smr_put3(s->shape.normal, v, next);
        if (ref == SMR_REF_STAYS)
            continue;
        smr_sum_vec_set(s->sums.sum, v, SMR_FORMER_REF, smr_get3(s->shape.x_ref, v));
        if (ref == SMR_REF_STARTS)
            smr_track_rest_add(&s->shape, v);
        smr_put3(s->shape.x_ref, v, smr_track_rest_posed(&s->shape, v));
    }
}

static uint32_t vertex_tasks(const void *arg) { return ((const smr *)arg)->shared.n_tasks; }

uint32_t smr_exchanged(const smr *s)
{
    uint32_t step = 0;
    while (smr_steps[step].run != exchange)
        step++;
    return s->step < step ? 0u : s->step > step ? s->shared.n : smr_min_u32(s->next_task * SMR_CHUNK, s->shared.n);
}

/* Exchanges x and x_next, and makes all results of the iteration current. */
void smr_commit(void *arg, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr *s = arg;
    smr_shape *shape = &s->shape;
    float *before = shape->x;
    shape->x = shape->x_next;
    shape->x_next = before;
    smr_certainties_age(&s->forces.surface, s->evolve.most2);
    s->forces.surface.limit = s->forces.surface.limit_next;
    if (smr_tracks(&s->schedule))
        smr_track_rest_commit(shape);
    if (smr_volumes_used(&s->volumes))
        smr_volumes_commit(&s->volumes);
    smr_folds_reset(&s->folds);
    s->report.displacement_max_mm = s->evolve.moved_mm;
    s->report.state_hash = s->evolve.hash;
    s->schedule.serial = s->schedule.serial_of_forces;
    s->schedule.iteration++;
    s->schedule.radius_iteration++;
    s->schedule.since_plastic++;
    s->report.details.radius = s->schedule.radius; /* the next iteration may have another radius */
    s->report.details.radius_iteration = s->schedule.repairing > 0u ? 0u : s->schedule.radius_iteration;
    smr_schedule_next(s);
}

SMR_SELDOM void smr_abandon_iteration(smr *s)
{
    for (uint32_t v = 0; v < smr_exchanged(s); v++) {
        smr_put3(s->shape.normal, v, smr_next_normal(s->sums.sum, v));
        if (SMR_HAS_TRACK && s->evolve.ref_next != SMR_REF_STAYS)
            smr_put3(s->shape.x_ref, v, smr_sum_vec(s->sums.sum, v, SMR_FORMER_REF));
    }
    memcpy(s->shape.x_next, s->shape.x, 3u * (size_t)s->shared.n * sizeof(float));
    if (s->step > 0u) /* the first step does not change it */
        s->shape.rest_pose = s->shape.rest_pose_before;
    if (SMR_HAS_HELD && s->shape.track_pose_last != NULL && s->schedule.tracking) {
        s->shape.track_rest->due = 1; /* the poses may be those of the abandoned iteration: fits them to x again */
        for (uint32_t i = 0; i < smr_track_rest_sum_tasks(&s->shape); i++)
            smr_track_rest_sum(&s->shape, i, 0);
        smr_track_rest_sum_end(&s->shape);
    }
    smr_iteration_reset(s, 0, 1);
    smr_triangles_now(&s->shape);
}

void smr_iteration_reset(smr *s, uint32_t part, uint32_t parts)
{
    smr_forces_reset(&s->forces, part, parts);
    smr_match_reset(&s->match, part, parts);
    smr_evolve_reset(&s->evolve, part, parts);
    smr_folds_reset(&s->folds);
    smr_place_reset(s);
}

/* Rows of steps, whose tasks run in any order, or one after the other (SERIAL). cost: thousands of instructions of a
 * task at most on a Cortex-M7; 0: tasks count their work. */
#define SMR_IN(part, function) (SMR_HAS_##part ? (function) : NULL)
#define SMR_ROW(part, phase, work, order, cost, member, n_tasks, run, end)                                             \
    {                                                                                                                  \
        SMR_PART_##part, SMR_PHASE_##phase, SMR_WORK_##work, order, offsetof(smr, member), 1000u * (uint32_t)(cost),   \
            SMR_IN(part, n_tasks), SMR_IN(part, run), end                                                              \
    }
#define SMR_STEP(part, phase, work, cost, member, n_tasks, run, end)                                                   \
    SMR_ROW(part, phase, work, SMR_ANY_ORDER, cost, member, n_tasks, run, end)
#define SMR_SERIAL_STEP(part, phase, work, cost, member, n_tasks, run, end)                                            \
    SMR_ROW(part, phase, work, SMR_SERIAL, cost, member, n_tasks, run, end)

/* clang-format off */
const smr_step smr_steps[] = { /* a step with the member `magic`, which is the first, gets the whole registration */
    /* dynamics: start positions of the sweep */
    SMR_STEP(DYNAMICS, FORCES, TASKS, 30, magic, smr_sweep_tasks, smr_sweep_begin, NULL),
    /* x^r = x where the iteration before ended with plasticity */
    SMR_SERIAL_STEP(PLAIN, FORCES, TASKS, 5, magic, smr_plastic_tasks, smr_plastic_follow, NULL),
    /* compute external forces f^e: steps of the sources of goals, then the search for the goals of vertices */
    SMR_STEP(CALLER, FORCES, TASKS, 30, forces.caller, smr_caller_tasks, smr_caller_step, NULL),
    SMR_STEP(PLAIN, FORCES, TASKS, 0, forces.surface, smr_attract_tasks, smr_attract_search, NULL),
    SMR_SERIAL_STEP(PLAIN, FORCES, TASKS, 90, forces.surface, smr_outlier_tasks, smr_outlier_sum, NULL),
    SMR_SERIAL_STEP(PARTIAL, FORCES, TASKS, 50, forces.points, smr_point_spread_tasks, smr_point_spread_run, cloud_end),
    SMR_SERIAL_STEP(PARTIAL, FORCES, TASKS, 50, forces.points, smr_point_share_tasks, smr_point_share_run, NULL),
    SMR_SERIAL_STEP(PARTIAL, FORCES, TASKS, 90, forces.occluded, smr_occluded_field_tasks, smr_occluded_field_solve,
                    NULL),
    SMR_STEP(IMAGE, FORCES, TASKS, 0, forces.image, smr_fill_tasks, smr_fill_sum, NULL),
    SMR_STEP(PLAIN, FORCES, ACTIVE, 0, forces, smr_forces_tasks, smr_forces_search, NULL),
    /* smooths and searches for contact of the active vertices, whose number is now final; then computes forces */
    SMR_SERIAL_STEP(CONTACT, FORCES, TASKS, 30, forces.smooth, smr_smooth_tasks, smr_smooth_sum, NULL),
    SMR_STEP(CONTACT, FORCES, ACTIVE, 0, forces, smr_contact_tasks, smr_contact_search, NULL),
    SMR_SERIAL_STEP(PARTIAL, FORCES, TASKS, 40, forces.surface, smr_visibility_tasks, smr_visibility_count, NULL),
    SMR_STEP(PLAIN, FORCES, TASKS, 0, forces, smr_forces_take_tasks, smr_forces_take, forces_end),
    /* results of the forces, from which the next ones start */
    SMR_SERIAL_STEP(PLAIN, SUMS, TASKS, 15, forces, smr_sources_keep_tasks, smr_sources_keep, NULL),
    /* rest pose; where x^r or the active vertices are new: centres, masses and spreads of the clusters */
    SMR_SERIAL_STEP(PLAIN, SUMS, TASKS, 15, shape, smr_rest_pose_tasks, smr_rest_pose_sum, rest_pose_end),
    SMR_STEP(REFERENCE, SUMS, TASKS, 8, reference, smr_reference_tasks, smr_reference_reach, reference_begin),
    SMR_STEP(REFERENCE, SUMS, ACTIVE, 40, reference, smr_reference_record_tasks, smr_reference_record, NULL),
    SMR_STEP(REFERENCE, SUMS, LISTS, 0, sums, smr_block_tasks, smr_sums_forest, NULL),
    SMR_SERIAL_STEP(REFERENCE, SUMS, TASKS, 60, reference, smr_reference_boundary_tasks, smr_boundary_reference, NULL),
    SMR_STEP(REFERENCE, SUMS, TASKS, 45, reference, smr_reference_cluster_tasks, smr_reference_cluster, reference_end),
    /* compute shape matching forces: for each cluster, T_i = argmin Sum m |T x^r - x - f^e|^2 */
    SMR_STEP(PLAIN, SUMS, ACTIVE, 60, sums, smr_sums_record_tasks, smr_sums_record, NULL),
    SMR_STEP(PLAIN, SUMS, LISTS, 0, sums, smr_block_tasks, smr_sums_forest, NULL),
    SMR_SERIAL_STEP(PLAIN, SUMS, TASKS, 20, sums, smr_boundary_tasks, smr_boundary_sums, NULL),
    SMR_STEP(PLAIN, MATCH, ACTIVE, 97, match, smr_match_cluster_tasks, smr_match_clusters, match_end),
    /* average goal positions x~_i = Sum_i(T) x^r_i / |zeta_i| */
    SMR_STEP(PLAIN, AVERAGE, ACTIVE, 50, match, smr_average_tasks, smr_average_record, NULL),
    SMR_STEP(PLAIN, AVERAGE, LISTS, 0, sums, smr_block_tasks, smr_sums_forest, NULL),
    SMR_SERIAL_STEP(PLAIN, AVERAGE, TASKS, 20, sums, smr_boundary_tasks, smr_boundary_sums, NULL),
    /* evolve positions, x = x~, smoothed along the surface; dynamics: end positions of the sweep */
    SMR_STEP(PLAIN, EVOLVE, TASKS, 8, evolve.tangent_smooth, smr_tangent_tasks, smr_tangent_clear, NULL),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 25, evolve.tangent_smooth, smr_tangent_sum_tasks, smr_tangent_sum, NULL),
    SMR_STEP(PLAIN, EVOLVE, TASKS, 70, evolve, smr_evolve_tasks, smr_evolve_step, evolve_end),
    SMR_STEP(DYNAMICS, EVOLVE, TASKS, 45, magic, smr_sweep_tasks, smr_sweep_end, NULL),
    /* bound of strain; volume preservation; positions out of contact; triangles */
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 60, magic, smr_strain_tasks, smr_strain_limit, strain_end),
    SMR_SERIAL_STEP(CONTACT, EVOLVE, TASKS, 60, volumes, smr_volume_tasks, smr_volume_correct, NULL),
    SMR_SERIAL_STEP(CONTACT, EVOLVE, TASKS, 90, forces.contact, smr_contact_project_tasks, smr_contact_project, NULL),
    SMR_STEP(PLAIN, EVOLVE, TASKS, 90, shape, smr_triangles_tasks, smr_triangles_refit, NULL),
    /* search for folds; then repair, limit or open folds */
    SMR_STEP(PLAIN, EVOLVE, TASKS, 0, folds, smr_fold_find_tasks, smr_fold_find, find_end),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, FOLDS, 90, folds, smr_fold_repair_tasks, smr_fold_repair_pass, folds_moved),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, FOLDS, 90, folds, smr_fold_limit_tasks, smr_fold_limit_pass, folds_moved),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, FOLDS, 90, folds, smr_fold_open_tasks, smr_fold_open_pass, folds_moved),
    SMR_STEP(PLAIN, EVOLVE, FOLDS, 90, magic, triangles_again, smr_refit_again, NULL),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 70, shape, smr_uppers_tasks, smr_uppers_refit, NULL),
    /* tracking and dynamics: poses of structures, which x^r follows */
    SMR_SERIAL_STEP(HELD, EVOLVE, TASKS, 40, shape, smr_track_rest_sum_tasks, smr_track_rest_sum, track_rest_end),
    /* displacements; normals, for tracking x^r; then all results become current at once */
    SMR_STEP(PLAIN, EVOLVE, TASKS, 20, evolve, smr_evolve_tasks, smr_evolve_measure, measure_end),
    SMR_STEP(PLAIN, EVOLVE, TASKS, 4, evolve, smr_exact_normals_tasks, smr_exact_normals_clear, NULL),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 40, evolve, smr_exact_normals_sum_tasks, smr_exact_normals_sum, NULL),
    SMR_STEP(PLAIN, EVOLVE, TASKS, 10, evolve, smr_exact_normals_tasks, smr_exact_normals_unit, NULL),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 20, magic, vertex_tasks, exchange, NULL),
    SMR_SERIAL_STEP(DYNAMICS, EVOLVE, TASKS, 40, magic, smr_step_energy_tasks, smr_step_energy, NULL),
    SMR_SERIAL_STEP(PLAIN, EVOLVE, TASKS, 90, magic, one_task, smr_commit, NULL),
};
/* clang-format on */

#define SMR_STEPS ((uint32_t)(sizeof smr_steps / sizeof smr_steps[0]))
_Static_assert(SMR_STEPS <= SMR_STEPS_MAX, "the time budget's table is too short");
const uint32_t smr_n_steps = SMR_STEPS;

/* Returns 1 while the current iteration still reads targets: later steps use copies. */
int smr_forces_pending(const smr *s)
{
    for (uint32_t i = s->step; i < SMR_STEPS; i++)
        if (smr_steps[i].run == smr_forces_take)
            return 1;
    return 0;
}

void smr_forces_settle(smr *s)
{
    if (smr_steps[s->step].run != smr_sources_keep)
        return;
    while (s->next_task < smr_sources_keep_tasks(&s->forces))
        smr_sources_keep(&s->forces, s->next_task++, 0);
    s->step++;
    s->next_task = s->n_shares = s->n_dealt = 0;
    smr_guard_close(s);
}

int smr_seeks_forces(const smr_step *step) { return step->run == smr_forces_search; }

uint32_t smr_forces_evaluated(const smr *s)
{
    if (smr_seeks_forces(&smr_steps[s->step]))
        return smr_min_u32(s->next_task * smr_force_chunk(&s->forces), s->schedule.n_active);
    const smr_task run = smr_steps[s->step].run;
    const int found = !smr_forces_pending(s) || run == smr_forces_take ||
                      (SMR_HAS_CONTACT && run == smr_contact_search) ||
                      (SMR_HAS_PARTIAL && run == smr_visibility_count);
    return found ? s->schedule.n_active : 0u;
}
