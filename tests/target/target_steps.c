/* target_steps.c: cost of an iteration on an emulated board, in instructions: by phase and by step for fixed work,
 * the longest pieces that a budget cannot cut and their bounds, and single searches and decompositions; for surfaces
 * and an image, rigid and polar. Prints the table of tests/timing/results. The command line says how many nanoseconds
 * an instruction takes.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"
#include "geometry/linear_solve/eigen_jacobi.h"
#include "geometry/rotation/rotation.h"
#include "geometry/box_tree/triangle.h"

#define TARGET_ENDLESS (UINT64_MAX / 4u) /* a budget that never ends, but the clock is read */
#define TARGET_FIXED_ITERATIONS 24u
#define TARGET_RADIUS 1u /* where fixed work is measured */
#define TARGET_SAMPLES 2000u
#define TARGET_SWEEPS 4u /* of smr_polar() */
#define TARGET_NODES 64u
#define TARGET_BLIND_NODES 256u /* nodes that a blind search may open: more than one stretch */

/* ns that a statement takes, and the reading. */
#define TARGET_COST(clock, statement, ns)                                                                              \
    do {                                                                                                               \
        const uint64_t begin = target_now(clock);                                                                      \
        statement;                                                                                                     \
        (ns) = target_now(clock) - begin;                                                                              \
    } while (0)

static uint64_t target_ns_per_instruction;

/* The emulator's time is whole instructions; the board's clock shows it in steps of its own, so rounded. */
static uint64_t target_instructions(uint64_t ns)
{
    return (ns + target_ns_per_instruction / 2u) / target_ns_per_instruction;
}

static void target_row(const char *kind, const char *what, const char *name, uint64_t first, uint64_t second)
{
    target_text(kind);
    target_text("; ");
    target_text(what);
    target_text("; ");
    target_text(name);
    target_text("; ");
    target_number(first);
    target_text("; ");
    target_number(second);
    target_text("\n");
}

/* The step's number stands in the second column, two names are used twice. */
static void target_step_row(const char *kind, const char *what, uint32_t step, const uint64_t *units, uint64_t ns)
{
    uint32_t unit;
    const char *name = target_step_name(step, &unit);
    char text[64];
    size_t n = strlen(what);
    if (ns == 0u || n > sizeof text - 16u)
        return;
    memcpy(text, what, n);
    memcpy(text + n, ", step 00", 10u);
    text[n + 7u] = (char)('0' + (char)(step / 10u));
    text[n + 8u] = (char)('0' + (char)(step % 10u));
    target_row(kind, text, name, units == NULL ? 0u : units[unit], target_instructions(ns));
}

/* How many of each unit the scene has, at TARGET_RADIUS. */
static int target_units(const target_scene *scene, uint64_t units[TARGET_UNITS])
{
    smr_model_info info;
    if (smr_model_get_info(scene->model, &info) != SMR_OK)
        return 0;
    units[TARGET_VERTICES] = info.n_vertices;
    units[TARGET_TRIANGLES] = info.n_triangles;
    units[TARGET_INDEXES] =
        info.n_vertices + (uint64_t)(info.indexes_per_cluster[TARGET_RADIUS] * (float)info.n_vertices + 0.5f);
    units[TARGET_GOALS] = scene->surface == NULL ? 0u : scene->surface->n_vertices;
    target_row("model", scene->what->name, "vertices, triangles", info.n_vertices, info.n_triangles);
    target_row("model", scene->what->name, "vertices and indexes, target vertices", units[TARGET_INDEXES],
               units[TARGET_GOALS]);
    return 1;
}

static smr_config target_stay(const target_scene *scene, int stiff)
{
    smr_config config = target_config(scene);
    config.schedule.radius_first = config.schedule.radius_last = TARGET_RADIUS;
    config.basic.iterations_last = TARGET_FIXED_ITERATIONS + 2u;
    config.motion.settle_um = 0.0f;
    config.motion.plastic_um = 0.0f;
    config.motion.plastic_every = stiff ? 0u : 1u;
    return config;
}

/* Fixed work: one radius, the same active vertices. stiff: x^r stays; otherwise it is new in every iteration. */
static int target_phases(const target_scene *scene, target_clock *clock, int stiff, const uint64_t *units)
{
    static const char *const names[SMR_PHASES] = {"forces", "sums", "match", "average", "evolve"};
    const char *what = scene->what->name, *kind = stiff ? "elastic" : "plastic";
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_stay(scene, stiff);
    uint64_t smallest[SMR_PHASES] = {0}, largest[SMR_PHASES] = {0}, steps[SMR_STEPS_MAX] = {0};
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK)
        return 0;
    for (uint32_t i = 0; i < TARGET_FIXED_ITERATIONS; i++) {
        /* the first iteration also fits the last radius' pose, repairs are other work */
        const int other = i == 0u || s->schedule.repairing > 0u || (s->reference.stale != 0u) == stiff;
        smr_status status;
        target_forget(clock);
        (void)target_tick(s, clock, 0, &report, &status); /* the clock is read after each step only */
        for (uint32_t p = 0; p < SMR_PHASES && !other; p++) {
            const uint64_t n = target_instructions(report.details.phase_ns[p]);
            smallest[p] = smallest[p] == 0u || n < smallest[p] ? n : smallest[p];
            largest[p] = n > largest[p] ? n : largest[p];
        }
        for (uint32_t k = 0; k < smr_n_steps; k++) {
            const int counts = !other || smr_steps[k].run == smr_rest_pose_sum;
            steps[k] = counts && clock->in_step[k] > steps[k] ? clock->in_step[k] : steps[k];
        }
        if (status != SMR_OK)
            return 0;
    }
    for (uint32_t p = 0; p < SMR_PHASES; p++)
        target_row(kind, what, names[p], smallest[p], largest[p]);
    for (uint32_t k = 0; k < smr_n_steps && !stiff; k++)
        target_step_row("whole", what, k, units, steps[k]);
    return 1;
}

/* Nothing pulls and nothing moves: what the match takes besides polar decompositions. */
static int target_still(const target_scene *scene, target_clock *clock)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_stay(scene, 1);
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL || (scene->what->image ? smr_set_volume(s, NULL) : smr_set_surface(s, SMR_ALL, NULL)) != SMR_OK ||
        smr_tick(s, 0, &report) != SMR_OK)
        return 0;
    const uint64_t n = target_instructions(report.details.phase_ns[SMR_PHASE_MATCH]);
    target_row("still", scene->what->name, "match", n, n);
    return 1;
}

/* The whole schedule: the longest stretch between two readings, in each step. */
static int target_stretches(const target_scene *scene, target_clock *clock)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_config(scene);
    uint64_t smallest = 0, largest = 0;
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL)
        return 0;
    target_forget(clock);
    while (!report.done) {
        smr_status status;
        const uint32_t repairs = s->schedule.repairing;
        const uint64_t all = target_tick(s, clock, TARGET_ENDLESS, &report, &status),
                       time = all - report.details.phase_ns[SMR_PHASE_FORCES];
        if (status != SMR_OK)
            return 0;
        if (repairs == 0u) { /* with a budget, repairs leave out what they can */
            smallest = smallest == 0u || time < smallest ? time : smallest;
            largest = time > largest ? time : largest;
        }
    }
    target_row("schedule", scene->what->name, "fixed part", target_instructions(smallest),
               target_instructions(largest));
    target_row("schedule", scene->what->name, "longest stretch", 0, target_instructions(clock->longest));
    for (uint32_t i = 0; i < smr_n_steps; i++)
        target_step_row("longest", scene->what->name, i, NULL, clock->in_step[i]);
    return 1;
}

/* Searches that accept next to no triangle open all nodes that they may: the longest stretch of an iteration. */
static int target_blind(const target_scene *scene, target_clock *clock)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_config config = target_stay(scene, 1);
    smr_tick_report report;
    smr_status status;
    config.forces.normal_deg = 1.0f;
    config.forces.node_budget = TARGET_BLIND_NODES;
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK)
        return 0;
    target_forget(clock);
    (void)target_tick(s, clock, TARGET_ENDLESS, &report, &status);
    target_row("blind", scene->what->name, "longest stretch", 0, target_instructions(clock->longest));
    return status == SMR_OK;
}

/* The bound of each step's tasks, or of a stretch of tasks that count their work. */
static void target_bounds(const target_scene *scene)
{
    for (uint32_t i = 0; i < smr_n_steps; i++) {
        const uint64_t cost = smr_steps[i].cost > 0u ? smr_steps[i].cost : SMR_WORK_MOST;
        target_step_row("bound", scene->what->name, i, NULL, cost * target_ns_per_instruction);
    }
}

/* One polar decomposition: its cost depends on how many of its rotations have nothing left to do. Measured without
 * any, for the most expensive of many, and with all of them. Then a closest-point search that finds nothing, per node
 * that it may open and per triangle. */
static void target_singles(const target_scene *scene, target_clock *clock)
{
    static const float unit[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, even[9] = {3, 0, 0, 0, 2, 0, 0, 0, 1};
    float v[9], m[9], a[9], nothing[6] = {3, 0, 0, 2, 0, 1}, full[6] = {3, 0.5f, 0.4f, 2, 0.3f, 1};
    uint64_t cost[4], largest = 0, dearest = 0;
    uint32_t seed = 1;
    memcpy(v, unit, sizeof v);
    TARGET_COST(clock, smr_jacobi(nothing, v, 1), cost[0]);
    TARGET_COST(clock, smr_jacobi(full, v, 1), cost[1]);
    memcpy(v, unit, sizeof v);
    TARGET_COST(clock, smr_polar(even, v, m), cost[2]);
    for (uint32_t i = 0; i < TARGET_SAMPLES; i++) {
        uint64_t time;
        for (uint32_t k = 0; k < 9u; k++) {
            seed = seed * 1664525u + 1013904223u;
            a[k] = (float)(seed >> 16) * (1.0f / 32768.0f) - 1.0f;
        }
        memcpy(v, unit, sizeof v); /* cold: more rotations than from the last iteration's */
        TARGET_COST(clock, smr_polar(a, v, m), time);
        largest = time > largest ? time : largest;
        TARGET_COST(clock, (void)smr_triangle_closest(smr_v(0, 0, 0), smr_load(a), smr_load(a + 3), smr_load(a + 6), m),
                    time);
        dearest = time > dearest ? time : dearest;
    }
    target_row("single", "polar decomposition", "no rotation, dearest of many", target_instructions(cost[2]),
               target_instructions(largest));
    target_row("single", "polar decomposition", "all rotations", 0,
               target_instructions(cost[2] + TARGET_SWEEPS * (cost[1] - cost[0])));
    const smr_query blind = {smr_v(0, 0, 0), smr_v(0, 0, 1), 2.0f, TARGET_NODES, SMR_NONE};
    smr_hit hit = {SMR_FAR, SMR_NONE, {0, 0, 0}};
    TARGET_COST(clock, smr_tree_closest(&scene->surface->tree, &blind, &hit), cost[3]);
    target_row("single", "closest point", "a node without its triangles, a triangle",
               target_instructions(cost[3] / TARGET_NODES), target_instructions(dearest));
}

int main(void);

int main(void)
{
    static target_scene scene;
    static target_clock clock;
    smr_baremetal board;
    uint64_t units[TARGET_UNITS];
    clock.port = smr_baremetal_port(&board);
    target_ns_per_instruction = target_word(1024u);
    for (uint32_t i = 0; i < TARGET_CASES; i++) {
        if (!target_ok("scene", target_set_up(&target_cases[i], &scene)) ||
            !target_ok("units", target_units(&scene, units)) ||
            !target_ok("elastic", target_phases(&scene, &clock, 1, units)) ||
            !target_ok("plastic", target_phases(&scene, &clock, 0, units)) ||
            !target_ok("still", target_still(&scene, &clock)) ||
            !target_ok("stretches", target_stretches(&scene, &clock)))
            return 1;
        if (i == 0u) {
            if (!target_ok("blind", target_blind(&scene, &clock)))
                return 1;
            target_singles(&scene, &clock);
            target_bounds(&scene);
        }
    }
    return 0;
}
