/* target_ticks.c: on an emulated board: very many ticks of a bone of 3,600 vertices with budgets of 0.05 to 2 ms: no
 * tick is later than its budget and a chunk. Rigid and polar, adaptive and with exact budgets; each registration starts
 * elsewhere.
 *
 * Under `-icount shift=3` an instruction takes TARGET_NS ns of the board's time, as on a core of 125 million a second.
 * Reads source.smr and target.smr from the emulator's folder. The command line says how many ticks. Prints what it
 * finds; ends with 0 when all holds.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"
#include "smr_semihost.h"

#define TARGET_NS 8u
#define TARGET_CHUNK_NS (100000u * TARGET_NS)
#define TARGET_LEAST_NS 50000u
#define TARGET_MOST_NS 2000000u
#define TARGET_OCTAVES 6u /* number of octaves from the least budget to beyond the largest */
#define TARGET_MANY 4096u /* vertices */

#define TARGET_INPUT static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
TARGET_INPUT unsigned char target_file[2][3u << 20];
TARGET_INPUT unsigned char
    target_arena[SMR_ARENA_BYTES(TARGET_MANY, 2u * TARGET_MANY, 1, 1, TARGET_MANY, SMR_METHOD_POLAR)];
TARGET_INPUT unsigned char target_surface[SMR_SURFACE_BYTES(TARGET_MANY, 2u * TARGET_MANY)];
TARGET_INPUT float target_xyz[3u * TARGET_MANY];
TARGET_INPUT uint32_t target_triangles[6u * TARGET_MANY];

/* What the ticks showed. */
typedef struct target_tally {
    uint64_t beyond; /* ns: the longest time beyond a budget */
    uint32_t ticks, late, over, iterations, cut, runs, seed;
} target_tally;

static uint32_t target_random(target_tally *t)
{
    t->seed = t->seed * 1664525u + 1013904223u;
    return t->seed >> 8;
}

/* As many budgets in each octave. */
static uint64_t target_budget(target_tally *t)
{
    const uint64_t octave = (uint64_t)TARGET_LEAST_NS << target_random(t) % TARGET_OCTAVES;
    const uint64_t budget = octave + octave * (target_random(t) % 256u) / 256u;
    return budget < TARGET_MOST_NS ? budget : TARGET_MOST_NS;
}

/* Turned about z by at most 0.1 rad, and shifted by at most 12 mm. */
static smr_pose target_start_pose(target_tally *t)
{
    const float h = (float)(target_random(t) % 101u) * 1.0e-3f - 0.05f, w = 1.0f / (1.0f + h * h);
    const float c = (1.0f - h * h) * w, s = 2.0f * h * w, shift = (float)(target_random(t) % 25u) - 12.0f;
    return (smr_pose){{{c, -s, 0, shift}, {s, c, 0, -shift}, {0, 0, 1, 0.5f * shift}}};
}

static int target_load(const char *name, unsigned char *memory, const smr_model **model)
{
    const size_t bytes = smr_semihost_read_file(name, memory, sizeof target_file[0]);
    return target_ok(name, bytes > 0u && smr_model_open(memory, bytes, model) == SMR_OK);
}

static int target_make_surface(const smr_model *of, smr_surface **surface)
{
    smr_model_info info;
    const int fits = smr_model_get_info(of, &info) == SMR_OK && info.n_vertices <= TARGET_MANY &&
                     smr_model_mesh(of, 0, target_xyz, target_triangles) == SMR_OK;
    const smr_mesh mesh = {target_xyz, target_triangles, info.n_vertices, info.n_triangles};
    return target_ok("surface",
                     fits && smr_surface_build(&mesh, target_surface, sizeof target_surface, surface) == SMR_OK);
}

static smr *target_registration(const smr_model *model, const smr_surface *surface, const smr_port *port,
                                target_tally *t)
{
    smr_config config = smr_config_default();
    const smr_pose pose = target_start_pose(t);
    smr *s = NULL;
    config.basic.method = t->runs % 2u == 0u ? SMR_METHOD_RIGID : SMR_METHOD_POLAR;
    config.basic.budget_exact = t->runs / 2u % 2u;
    config.basic.n_target_vertices = TARGET_MANY;
    t->runs++;
    return smr_init(model, &config, port, target_arena, sizeof target_arena, &s) == SMR_OK &&
                   smr_set_surface(s, SMR_ALL, surface) == SMR_OK && smr_set_pose(s, &pose) == SMR_OK
               ? s
               : NULL;
}

/* Ticks of one registration, to its end. */
static int target_run(smr *s, target_clock *clock, uint32_t ticks, target_tally *t)
{
    smr_tick_report report = {0};
    while (t->ticks < ticks && !report.done) {
        const uint64_t budget = target_budget(t);
        smr_status status;
        const uint64_t time = target_tick(s, clock, budget, &report, &status);
        if (status < 0)
            return target_ok("a tick", 0);
        t->ticks++;
        t->late += time > budget + TARGET_CHUNK_NS ? 1u : 0u;
        t->over += time > budget ? 1u : 0u;
        t->beyond = time > budget + t->beyond ? time - budget : t->beyond;
        t->iterations += status == SMR_OK ? 1u : 0u;
        t->cut += status == SMR_OK && report.details.n_taken < report.details.n_wanted ? 1u : 0u;
    }
    return 1;
}

int main(void);

int main(void)
{
    static target_clock clock;
    const smr_port port = {&clock, 1u, NULL, target_now};
    const smr_model *model = NULL, *of = NULL;
    smr_surface *surface = NULL;
    smr_baremetal board;
    target_tally t = {.seed = 1};
    clock.port = smr_baremetal_port(&board);
    const uint32_t ticks = target_word(1000u);
    int good = target_load("source.smr", target_file[0], &model) && target_load("target.smr", target_file[1], &of) &&
               target_make_surface(of, &surface);
    while (good && t.ticks < ticks) {
        smr *s = target_registration(model, surface, &port, &t);
        good = target_ok("start", s != NULL) && target_run(s, &clock, ticks, &t);
    }
    target_line("ticks                      ", t.ticks);
    target_line("  registrations:           ", t.runs);
    target_line("  iterations:              ", t.iterations);
    target_line("    of them not all took part: ", t.cut);
    target_line("  beyond the budget:       ", t.over);
    target_line("    by instructions, most: ", t.beyond / TARGET_NS);
    target_line("  longest chunk:           ", clock.longest / TARGET_NS);
    target_line("  late by more than a chunk: ", t.late);
    for (uint32_t i = 0; i < smr_n_steps; i++) {
        uint32_t unit;
        if (clock.in_step[i] > TARGET_CHUNK_NS / 2u) {
            target_text("    ");
            target_text(target_step_name(i, &unit));
            target_line(": ", clock.in_step[i] / TARGET_NS);
        }
    }
    return good && target_ok("no tick is late", t.late == 0u) ? 0 : 1;
}
