/* target_rig.c: text output, the board's clock, and which step the clock is read in.
 * SPDX-License-Identifier: MIT */
#include "registration/schedule_radius.h"
#include "target_rig.h"

const target_case target_cases[TARGET_BUDGETED] = {
    {"surface rigid", 0, SMR_METHOD_RIGID, 0, 0, 0}, {"surface polar", 0, SMR_METHOD_POLAR, 0, 0, 0},
    {"image rigid", 1, SMR_METHOD_RIGID, 0, 0, 0},   {"image polar", 1, SMR_METHOD_POLAR, 0, 0, 0},
    {"part rigid", 0, SMR_METHOD_RIGID, 1, 0, 0},    {"surface, more", 0, SMR_METHOD_RIGID, 0, 1, 0},
    {"image, more", 1, SMR_METHOD_RIGID, 0, 1, 0},   {"dynamics, rigid", 0, SMR_METHOD_RIGID, 0, 0, 1},
    {"part polar", 0, SMR_METHOD_POLAR, 1, 0, 0},    {"dynamics, polar", 0, SMR_METHOD_POLAR, 0, 0, 1},
};

void target_text(const char *text) { smr_semihost_write(text); }

void target_number(uint64_t value)
{
    char text[24];
    uint32_t at = sizeof text - 1u;
    text[at] = '\0';
    do {
        text[--at] = (char)('0' + (char)(value % 10u));
        value /= 10u;
    } while (value != 0u);
    smr_semihost_write(text + at);
}

void target_line(const char *name, uint64_t value)
{
    target_text(name);
    target_number(value);
    target_text("\n");
}

int target_ok(const char *what, int good)
{
    if (!good) {
        target_text("failed: ");
        target_text(what);
        target_text("\n");
    }
    return good;
}

uint32_t target_word(uint32_t otherwise)
{
    char text[64] = {0};
    const uintptr_t block[2] = {(uintptr_t)text, sizeof text};
    uint32_t value = 0, i = 0;
    if (smr_semihost_call(0x15u, block) != 0u) /* SYS_GET_CMDLINE */
        return otherwise;
    while (text[i] != '\0' && text[i] != ' ')
        i++; /* the program's name */
    while (text[i] == ' ')
        i++;
    for (; text[i] >= '0' && text[i] <= '9'; i++)
        value = 10u * value + (uint32_t)(text[i] - '0');
    return value > 0u ? value : otherwise;
}

uint64_t target_now(void *ctx)
{
    target_clock *clock = ctx;
    const uint64_t time = clock->port.now_ns(clock->port.ctx);
    if (clock->running) {
        const uint64_t stretch = time - clock->last;
        uint64_t *in_step = &clock->in_step[clock->watched == NULL ? 0u : clock->watched->step];
        clock->longest = stretch > clock->longest ? stretch : clock->longest;
        *in_step = stretch > *in_step ? stretch : *in_step;
    }
    clock->last = time;
    return time;
}

void target_forget(target_clock *clock)
{
    clock->longest = 0;
    memset(clock->in_step, 0, sizeof clock->in_step);
}

uint64_t target_tick(smr *s, target_clock *clock, uint64_t budget_ns, smr_tick_report *report, smr_status *status)
{
    const uint64_t begin = target_now(clock);
    clock->watched = s;
    clock->running = 1;
    *status = smr_tick(s, budget_ns, report);
    clock->running = 0;
    return target_now(clock) - begin;
}

/* By what they run, and where that is not enough by their phase: steps may come and go. */
static const struct {
    smr_task run;
    uint32_t phase, unit;
    const char *name;
} target_steps[] = {
    {smr_occluded_field_solve, SMR_PHASE_FORCES, TARGET_VERTICES, "unseen field"},
    {smr_attract_search, SMR_PHASE_FORCES, TARGET_GOALS, "target pulls"},
    {smr_outlier_sum, SMR_PHASE_FORCES, TARGET_GOALS, "outliers"},
    {smr_point_spread_run, SMR_PHASE_FORCES, TARGET_VERTICES, "point spread"},
    {smr_fill_sum, SMR_PHASE_FORCES, TARGET_TRIANGLES, "fill, sums"},
    {smr_forces_search, SMR_PHASE_FORCES, TARGET_VERTICES, "goals"},
    {smr_visibility_count, SMR_PHASE_FORCES, TARGET_VERTICES, "visible vertices"},
    {smr_forces_take, SMR_PHASE_FORCES, TARGET_VERTICES, "forces"},
    {smr_plastic_follow, SMR_PHASE_FORCES, TARGET_VERTICES, "new reference shape"},
    {smr_sources_keep, SMR_PHASE_SUMS, TARGET_VERTICES, "forces' results"},
    {smr_rest_pose_sum, SMR_PHASE_SUMS, TARGET_VERTICES, "the last radius' pose"},
    {smr_reference_reach, SMR_PHASE_SUMS, TARGET_VERTICES, "reach"},
    {smr_reference_record, SMR_PHASE_SUMS, TARGET_VERTICES, "reference records"},
    {smr_reference_cluster, SMR_PHASE_SUMS, TARGET_VERTICES, "cluster centres"},
    {smr_sums_record, SMR_PHASE_SUMS, TARGET_VERTICES, "displacement records"},
    {smr_sums_forest, SMR_PHASE_SUMS, TARGET_INDEXES, "forest, sums"},
    {smr_boundary_reference, SMR_PHASE_SUMS, TARGET_VERTICES, "boundary, reference"},
    {smr_boundary_sums, SMR_PHASE_SUMS, TARGET_VERTICES, "boundary, displacements"},
    {smr_boundary_sums, SMR_PHASE_AVERAGE, TARGET_VERTICES, "boundary, average"},
    {smr_match_clusters, SMR_PHASE_MATCH, TARGET_VERTICES, "match"},
    {smr_average_record, SMR_PHASE_AVERAGE, TARGET_VERTICES, "transform records"},
    {smr_sums_forest, SMR_PHASE_AVERAGE, TARGET_INDEXES, "forest, average"},
    {smr_tangent_clear, SMR_PHASE_EVOLVE, TARGET_VERTICES, "evening out, clear"},
    {smr_tangent_sum, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "evening out, sums"},
    {smr_evolve_step, SMR_PHASE_EVOLVE, TARGET_VERTICES, "positions"},
    {smr_triangles_refit, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "facets and boxes"},
    {smr_refit_again, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "facets and boxes"},
    {smr_uppers_refit, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "upper boxes"},
    {smr_strain_limit, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "bound of strain"},
    {smr_smooth_sum, SMR_PHASE_FORCES, TARGET_TRIANGLES, "smoothing"},
    {smr_contact_search, SMR_PHASE_FORCES, TARGET_VERTICES, "contacts"},
    {smr_volume_correct, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "volumes"},
    {smr_contact_project, SMR_PHASE_EVOLVE, TARGET_VERTICES, "out of contact"},
    {smr_fold_find, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "search for folds"},
    {smr_fold_repair_pass, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "repair of folds"},
    {smr_fold_limit_pass, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "limiting of folds"},
    {smr_fold_open_pass, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "opening of folds"},
    {smr_track_rest_sum, SMR_PHASE_EVOLVE, TARGET_VERTICES, "poses of what is tracked"},
    {smr_evolve_measure, SMR_PHASE_EVOLVE, TARGET_VERTICES, "displacements, hash"},
    {smr_exact_normals_clear, SMR_PHASE_EVOLVE, TARGET_VERTICES, "normals, clear"},
    {smr_exact_normals_sum, SMR_PHASE_EVOLVE, TARGET_TRIANGLES, "normals, sums"},
    {smr_exact_normals_unit, SMR_PHASE_EVOLVE, TARGET_VERTICES, "normals, length"},
    {smr_commit, SMR_PHASE_EVOLVE, TARGET_VERTICES, "becoming current"},
};

const char *target_step_name(uint32_t number, uint32_t *unit)
{
    for (uint32_t i = 0; i < sizeof target_steps / sizeof target_steps[0]; i++) {
        if (target_steps[i].run == smr_steps[number].run && target_steps[i].phase == smr_steps[number].phase) {
            *unit = target_steps[i].unit;
            return target_steps[i].name;
        }
    }
    *unit = TARGET_VERTICES;
    return "another step";
}
