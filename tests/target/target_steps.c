/*
 * target_steps: what each phase of an iteration costs on an emulated board, in instructions, and the longest piece of work that
 * a budget cannot cut, for surfaces and an image, rigid and polar. For tests/timing; the command line says how many nanoseconds
 * an instruction takes.
 *
 * SPDX-License-Identifier: MIT
 */
#include "target_rig.h"

#define TARGET_ENDLESS (UINT64_MAX / 4u) /* a budget that never ends, but the clock is read */
#define TARGET_FIXED_ITERATIONS 60u

static uint64_t target_ns_per_instruction;

/* The emulator's time is whole instructions; the board's clock shows it in steps of its own, so rounded. */
static uint64_t target_instructions(uint64_t ns)
{
    return (ns + target_ns_per_instruction / 2u) / target_ns_per_instruction;
}

static void target_row(const char *kind, const target_case *what, const char *name, uint64_t smallest, uint64_t largest)
{
    target_text(kind);
    target_text("; ");
    target_text(what->name);
    target_text("; ");
    target_text(name);
    target_text("; ");
    target_number(smallest);
    target_text("; ");
    target_number(largest);
    target_text("\n");
}

/* Fixed work: one radius, the same active vertices. stiff: x^r stays; otherwise it is new in every iteration. */
static int target_phases(const target_scene *scene, target_clock *clock, int stiff)
{
    static const char *const names[SMR_PHASES] = {"forces", "sums", "match", "average", "evolve"};
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_config config = target_config(scene);
    uint64_t smallest[SMR_PHASES], largest[SMR_PHASES] = {0};
    smr_tick_report report = {0};
    config.radius_first = config.radius_last = 1;
    config.iterations_last = TARGET_FIXED_ITERATIONS + 2u;
    config.settle_um = 0.0f;
    config.plastic_um = 0.0f;
    config.plastic_every = stiff ? 0u : 1u;
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK) {
        return 0;
    }
    for (uint32_t i = 0; i < TARGET_FIXED_ITERATIONS; ++i) {
        const int other = s->repairing > 0u || (s->reference_stale != 0u) == stiff; /* repairs are other work */
        if (smr_tick(s, 0, &report) != SMR_OK) {
            return 0;
        }
        if (other) {
            continue;
        }
        for (uint32_t p = 0; p < SMR_PHASES; ++p) {
            const uint64_t n = target_instructions(report.phase_ns[p]);
            smallest[p] = largest[p] == 0u || n < smallest[p] ? n : smallest[p];
            largest[p] = n > largest[p] ? n : largest[p];
        }
    }
    for (uint32_t p = 0; p < SMR_PHASES; ++p) {
        target_row(stiff ? "elastic" : "plastic", scene->what, names[p], smallest[p], largest[p]);
    }
    return 1;
}

/* The whole schedule of the defaults: the longest stretch between two readings, in each step. */
static int target_stretches(const target_scene *scene, target_clock *clock)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_config(scene);
    uint64_t smallest = 0, largest = 0;
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL) {
        return 0;
    }
    target_forget(clock);
    while (!report.done) {
        smr_status status;
        const uint64_t time = target_tick(s, clock, TARGET_ENDLESS, &report, &status) - report.phase_ns[SMR_PHASE_FORCES];
        if (status != SMR_OK) {
            return 0;
        }
        smallest = smallest == 0u || time < smallest ? time : smallest;
        largest = time > largest ? time : largest;
    }
    target_row("iteration", scene->what, "fixed part", target_instructions(smallest), target_instructions(largest));
    for (uint32_t i = 0; i < smr_n_steps; ++i) {
        if (clock->in_step[i] > 0u) {
            target_row("longest stretch", scene->what, target_step_name(i), 0, target_instructions(clock->in_step[i]));
        }
    }
    return 1;
}

int main(void);

int main(void)
{
    static target_scene scene;
    static target_clock clock;
    smr_baremetal board;
    clock.port = smr_baremetal_port(&board);
    target_ns_per_instruction = target_word(1024u);
    for (uint32_t i = 0; i < TARGET_CASES; ++i) {
        if (!target_ok("scene", target_set_up(&target_cases[i], &scene)) ||
            !target_ok("elastic", target_phases(&scene, &clock, 1)) ||
            !target_ok("plastic", target_phases(&scene, &clock, 0)) ||
            !target_ok("stretches", target_stretches(&scene, &clock))) {
            return 1;
        }
    }
    return 0;
}
