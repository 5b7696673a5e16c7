/*
 * target_budget: on the emulated Cortex-M7, ticks keep to their time and cutting the work changes no bit.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's timer, so the times are the
 * same in every run. Prints the longest tick beyond the budget; ends with 0 when all holds.
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
#define TARGET_CHUNK_NS 1000000u /* what a tick may take beyond its budget: one chunk, a million instructions */
#define TARGET_TICKS_MAX 100000u

TARGET_MEMORY unsigned char target_arena[SMR_ARENA_BYTES(1024, 2048, 1, 1, 1024)];
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

/* Runs TARGET_ITERATIONS iterations in ticks of this budget; 0: no limit. *hash: the state after them. */
static int target_run(const smr_model *model, const smr_surface *surface, const smr_port *port, uint64_t budget_ns,
                      uint64_t *hash)
{
    smr_config config = smr_config_default();
    smr_tick_report report = {0};
    uint64_t longest = 0;
    uint32_t ticks = 0, partial = 0, phase = 0;
    smr *s = NULL;
    config.n_target_vertices = 1024;
    config.iterations = 10;
    if (smr_init(&s, model, &config, port, target_arena, sizeof target_arena) != SMR_OK ||
        smr_set_surface(s, SMR_ALL, surface) != SMR_OK) {
        return 0;
    }
    while (report.iteration < TARGET_ITERATIONS && ticks < TARGET_TICKS_MAX) {
        uint64_t begin = port->now_ns(port->ctx), time;
        smr_status status = smr_tick(s, budget_ns, &report);
        time = port->now_ns(port->ctx) - begin;
        if (time > longest) {
            longest = time;
            for (uint32_t i = 0; i < SMR_PHASES; ++i) {
                phase = report.phase_ns[i] > report.phase_ns[phase] ? i : phase;
            }
        }
        partial += status == SMR_PARTIAL ? 1u : 0u;
        ++ticks;
        if (status != SMR_OK && status != SMR_PARTIAL) {
            return 0;
        }
    }
    *hash = smr_state_hash(s);
    target_number("budget ns:       ", budget_ns);
    target_number("  ticks:         ", ticks);
    target_number("  partial ticks: ", partial);
    target_number("  longest ns:    ", longest);
    target_number("  in phase:      ", phase);
    return target_ok("iterations", report.iteration == TARGET_ITERATIONS) &&
           target_ok("whole ticks without a budget", budget_ns != 0u || partial == 0u) &&
           target_ok("partial ticks with a budget", budget_ns == 0u || partial > 0u) &&
           target_ok("time", budget_ns == 0u || longest <= budget_ns + TARGET_CHUNK_NS);
}

int main(void);

int main(void)
{
    smr_baremetal clock;
    smr_port port = smr_baremetal_port(&clock);
    const smr_model *model = NULL;
    smr_surface *surface = NULL;
    uint64_t whole = 0, cut = 1;
    return target_ok("model", target_model(&model, &surface)) &&
                   target_ok("run", target_run(model, surface, &port, 0, &whole)) &&
                   target_ok("run with a budget", target_run(model, surface, &port, TARGET_BUDGET_NS, &cut)) &&
                   target_ok("same bits", whole == cut)
               ? 0
               : 1;
}
