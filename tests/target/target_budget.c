/*
 * target_budget: on the emulated Cortex-M7, ticks keep to their time, cutting the work changes no bit, and what a budget left
 * out can be left out again without a clock.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's timer, so the times are the
 * same in every run. A chunk is the longest stretch between two readings of the clock. Prints what it finds; ends with 0 when all holds.
 *
 * SPDX-License-Identifier: MIT
 */
#include <smr.h>

#include "fixture_bone.h"
#include "smr_baremetal.h"
#include "smr_semihost.h"

#define TARGET_MEMORY static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
#define TARGET_ITERATIONS 20u
#define TARGET_BUDGET_NS 200000u
#define TARGET_TICKS_MAX 100000u
#define TARGET_ENDLESS (UINT64_MAX / 4u) /* a budget that never ends, but the clock is read */
#ifndef TARGET_RANDOM_TICKS
#define TARGET_RANDOM_TICKS 1000u
#endif
#define TARGET_READING_NS 2000u /* what the readings before and after a tick may take */

TARGET_MEMORY unsigned char target_arena[2][SMR_ARENA_BYTES(1024, 2048, 1, 1, 1024)];
TARGET_MEMORY unsigned char target_scratch[6u << 20];
TARGET_MEMORY unsigned char target_image[2u << 20];
TARGET_MEMORY unsigned char target_surface[1u << 20];
TARGET_MEMORY float target_words[16384];
TARGET_MEMORY float target_xyz[2][3 * 1024];
TARGET_MEMORY uint32_t target_triangles[2][3 * 2048];

static void target_number(const char *name, uint64_t value)
{
    char text[24];
    uint32_t at = sizeof text - 1u;
    text[at] = '\0';
    text[--at] = '\n';
    do {
        text[--at] = (char)('0' + (char)(value % 10u));
        value /= 10u;
    } while (value != 0u);
    smr_semihost_write(name);
    smr_semihost_write(text + at);
}

static int target_ok(const char *what, int good)
{
    if (!good) {
        smr_semihost_write("failed: ");
        smr_semihost_write(what);
        smr_semihost_write("\n");
    }
    return good;
}

static int target_meshes(smr_mesh *mesh)
{
    for (int i = 0; i < 2; ++i) {
        fixture_grid grid = i == 0 ? fixture_grid_source(FIXTURE_CELL_SMALL) : fixture_grid_target(FIXTURE_CELL_SMALL);
        fixture_mesh m = {target_xyz[i], target_triangles[i], 1024, 2048, 0, 0};
        const size_t words = sizeof target_words / sizeof target_words[0];
        if (!(i == 0 ? fixture_bone_source(&grid, &m, target_words, words)
                     : fixture_bone_target(&grid, 1.0f, &m, target_words, words))) {
            return 0;
        }
        mesh[i].xyz = m.xyz;
        mesh[i].triangles = m.triangles;
        mesh[i].n_vertices = m.n_vertices;
        mesh[i].n_triangles = m.n_triangles;
    }
    return 1;
}

static int target_model(const smr_model **model, smr_surface **surface)
{
    smr_mesh mesh[2];
    smr_structure structure = {"bone", {NULL, NULL, 0, 0}};
    smr_prepare_config config = smr_prepare_config_default();
    size_t bytes = 0;
    if (!target_meshes(mesh)) {
        return 0;
    }
    structure.mesh = mesh[0];
    config.n_radii = 2;
    config.radius_mm[0] = 90.0f;
    config.radius_mm[1] = 45.0f;
    return smr_prepare(&structure, 1, &config, target_scratch, sizeof target_scratch, target_image,
                       sizeof target_image, &bytes) == SMR_OK &&
           smr_model_open(target_image, bytes, model) == SMR_OK &&
           smr_surface_build(target_surface, sizeof target_surface, &mesh[1], surface) == SMR_OK;
}

/* The board's clock, and the longest stretch between two readings. */
typedef struct target_clock {
    smr_port port;
    uint64_t last, longest;
    uint32_t running;
} target_clock;

static uint64_t target_now(void *ctx)
{
    target_clock *clock = (target_clock *)ctx;
    const uint64_t time = clock->port.now_ns(clock->port.ctx);
    if (clock->running && time - clock->last > clock->longest) {
        clock->longest = time - clock->last;
    }
    clock->last = time;
    return time;
}

static uint64_t target_tick(smr *s, target_clock *clock, uint64_t budget_ns, smr_tick_report *report, smr_status *status)
{
    const uint64_t begin = target_now(clock);
    clock->running = 1;
    *status = smr_tick(s, budget_ns, report);
    clock->running = 0;
    return target_now(clock) - begin;
}

static smr *target_start(const smr_model *model, const smr_surface *surface, const smr_port *port, uint32_t arena)
{
    smr_config config = smr_config_default();
    smr *s = NULL;
    config.n_target_vertices = 1024;
    config.iterations = 30;
    if (smr_init(&s, model, &config, port, target_arena[arena], sizeof target_arena[arena]) != SMR_OK ||
        smr_set_surface(s, SMR_ALL, surface) != SMR_OK) {
        return NULL;
    }
    return s;
}

/* Runs TARGET_ITERATIONS iterations of all vertices in ticks of this budget; 0: no limit. *hash: the state after them. */
static int target_run(const smr_model *model, const smr_surface *surface, target_clock *clock, uint64_t budget_ns,
                      uint64_t *hash, uint64_t *whole, uint64_t *fixed)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_tick_report report = {0};
    uint64_t longest = 0;
    uint32_t ticks = 0, partial = 0;
    smr *s = target_start(model, surface, &port, 0);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK) {
        return 0;
    }
    clock->longest = 0;
    while (report.iteration < TARGET_ITERATIONS && ticks < TARGET_TICKS_MAX) {
        smr_status status;
        const uint64_t time = target_tick(s, clock, budget_ns, &report, &status);
        if (time > longest) {
            longest = time;
            *fixed = time - report.phase_ns[SMR_PHASE_FORCES];
        }
        partial += status == SMR_PARTIAL ? 1u : 0u;
        ++ticks;
        if (status != SMR_OK && status != SMR_PARTIAL) {
            return 0;
        }
    }
    *hash = smr_state_hash(s);
    *whole = longest;
    target_number("budget ns:        ", budget_ns);
    target_number("  ticks:          ", ticks);
    target_number("  partial ticks:  ", partial);
    target_number("  longest tick:   ", longest);
    target_number("  longest chunk:  ", clock->longest);
    return target_ok("iterations", report.iteration == TARGET_ITERATIONS) &&
           target_ok("whole ticks without a budget", budget_ns == TARGET_BUDGET_NS || partial == 0u) &&
           target_ok("partial ticks with a budget", budget_ns != TARGET_BUDGET_NS || partial > 0u) &&
           target_ok("time", budget_ns != TARGET_BUDGET_NS || longest <= budget_ns + clock->longest + TARGET_READING_NS);
}

/* Thousands of ticks of 5 to 150 % of a whole iteration, at the controller's choice; a twin without a clock repeats each
 * iteration. */
static int target_random(const smr_model *model, const smr_surface *surface, target_clock *clock, uint64_t whole)
{
    static const smr_pose same = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_tick_report report = {0}, again = {0};
    smr *s = target_start(model, surface, &port, 0), *twin = target_start(model, surface, NULL, 1);
    uint64_t over = 0;
    uint32_t seed = 1, late = 0, done = 0, cut = 0, enough = 0, enough_done = 0, known = 0;
    smr_status status = SMR_OK;
    if (s == NULL || twin == NULL) {
        return 0;
    }
    clock->longest = 0;
    for (uint32_t i = 0; i < TARGET_RANDOM_TICKS; ++i) {
        const int fresh = status == SMR_OK;
        seed = seed * 1664525u + 1013904223u;
        const uint64_t budget = whole / 100u * (5u + (seed >> 8) % 146u);
        const uint64_t time = target_tick(s, clock, budget, &report, &status);
        if (status < 0) {
            return 0;
        }
        late += time > budget ? 1u : 0u;
        over = time > budget && time - budget > over ? time - budget : over;
        if (fresh && known && budget >= whole) {
            ++enough;
            enough_done += status == SMR_OK ? 1u : 0u;
        }
        if (status != SMR_OK) {
            continue;
        }
        known = 1;
        ++done;
        cut += report.n_taken < report.n_wanted ? 1u : 0u;
        if (smr_set_active(twin, report.n_taken) != SMR_OK || smr_tick(twin, 0, &again) != SMR_OK ||
            !target_ok("the same again", smr_state_hash(twin) == smr_state_hash(s))) {
            return 0;
        }
        if (report.done && (smr_set_pose(s, &same) != SMR_OK || smr_set_pose(twin, &same) != SMR_OK)) {
            return 0;
        }
    }
    target_number("random budgets:   ", TARGET_RANDOM_TICKS);
    target_number("  iterations:     ", done);
    target_number("  of them cut:    ", cut);
    target_number("  late ticks:     ", late);
    target_number("  longest overrun:", over);
    target_number("  longest chunk:  ", clock->longest);
    target_number("  with enough:    ", enough);
    target_number("  then complete:  ", enough_done);
    return target_ok("overrun of at most a chunk", over <= clock->longest + TARGET_READING_NS) &&
           target_ok("cut iterations", cut > done / 10u) && target_ok("whole iterations", cut < done) &&
           target_ok("enough is enough", enough > 0u && enough_done == enough);
}

int main(void);

int main(void)
{
    smr_baremetal board;
    target_clock clock = {smr_baremetal_port(&board), 0, 0, 0};
    const smr_model *model = NULL;
    smr_surface *surface = NULL;
    uint64_t plain = 0, whole = 1, cut = 2, time = 0, fixed = 0, chunk, other;
    if (!target_ok("model", target_model(&model, &surface)) ||
        !target_ok("run", target_run(model, surface, &clock, 0, &plain, &time, &fixed)) ||
        !target_ok("run with a long budget", target_run(model, surface, &clock, TARGET_ENDLESS, &whole, &time, &fixed))) {
        return 1;
    }
    chunk = clock.longest;
    target_number("fixed part ns:    ", fixed);
    return target_ok("chunk of at most 5 % of the fixed part", 20u * chunk <= fixed) &&
                   target_ok("run with a budget", target_run(model, surface, &clock, TARGET_BUDGET_NS, &cut, &other, &other)) &&
                   target_ok("same bits", plain == cut && plain == whole) &&
                   target_ok("random budgets", target_random(model, surface, &clock, time))
               ? 0
               : 1;
}
