/* target_budget.c: on an emulated board: ticks keep to their budget, cutting the work changes no bit, and an iteration
 * shortened by a budget repeats without a clock; for a surface, an image and an open surface, rigid and polar, and with
 * contact, volumes, smoothing and fusing on; and for a bone with mass, drawn to a surface.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's time, so times are the same in every
 * run. A chunk is the longest stretch between two readings of the clock. The command line says how many ticks of
 * random budgets each case runs; below 25 the last two cases are left out. Prints what it finds; ends with 0 when all
 * holds.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"

#define TARGET_BUDGET_NS 200000u
#define TARGET_TICKS_MAX 100000u
#define TARGET_ENDLESS (UINT64_MAX / 4u) /* a budget that never ends, but the clock is read */
#define TARGET_TWIN_TICKS 250u           /* so long a twin without a clock goes along */
#define TARGET_ALL_TICKS 25u /* ticks of a case from which on all cases run, with fewer the first TARGET_FIRST */
#define TARGET_FIRST 8u
#define TARGET_CHUNK_NS 100000u /* no chunk takes more instructions, with the guard before and after a tick */

/* What a run through the schedule showed. */
typedef struct target_times {
    uint64_t hash;
    uint64_t whole;   /* ns: the longest iteration */
    uint64_t fixed;   /* ns: the shortest iteration of all vertices, its forces taken off */
    uint64_t longest; /* tick */
    uint32_t ticks, partial;
} target_times;

/* The schedule, or four time steps, are done. */
static int ends(const target_scene *scene, const smr_tick_report *report)
{
    return report->done == 1u || (scene->what->moves && report->iteration >= 4u * SMR_SWEEPS);
}

/* All vertices through the schedule in ticks of this budget. Random budgets are compared with a run without a clock. */
static int target_run(const target_scene *scene, target_clock *clock, uint64_t budget_ns, target_times *t)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_config(scene);
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0);
    memset(t, 0, sizeof *t);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK)
        return 0;
    while (!ends(scene, &report) && t->ticks < TARGET_TICKS_MAX) {
        smr_status status;
        const uint32_t repairs = s->schedule.repairing;
        const uint64_t time = target_tick(s, clock, budget_ns, &report, &status),
                       fixed = time - report.details.phase_ns[SMR_PHASE_FORCES];
        t->longest = time > t->longest ? time : t->longest;
        t->partial += status == SMR_PARTIAL ? 1u : 0u;
        t->ticks++;
        if (repairs == 0u && (t->fixed == 0u || fixed < t->fixed))
            t->fixed = fixed;
        if (status != SMR_OK && status != SMR_PARTIAL)
            return 0;
    }
    t->whole = t->longest;
    t->hash = smr_state_hash(s);
    return target_ok("the schedule ends", ends(scene, &report));
}

/* What random budgets did. */
typedef struct target_tally {
    uint64_t over; /* ns: the longest time beyond a budget */
    uint32_t late, done, cut, enough, enough_done;
} target_tally;

/* The iteration that s has completed, without a clock. */
static int target_repeat(smr *s, smr *twin, uint32_t n_taken)
{
    return smr_set_active(twin, n_taken) == SMR_OK && smr_tick(twin, 0, NULL) == SMR_OK &&
           smr_state_hash(twin) == smr_state_hash(s);
}

/* Ticks of 5 to 150 % of a whole iteration, with the controller on; for the first ones a twin without a clock repeats
 * each iteration. */
static int target_random(const target_scene *scene, target_clock *clock, uint64_t whole, uint32_t ticks,
                         target_tally *t)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    const smr_config config = target_config(scene);
    smr_tick_report report = {0};
    smr *s = target_start(scene, &config, &port, 0), *twin = target_start(scene, &config, NULL, 1);
    uint32_t seed = 1, known = 0;
    smr_status status = SMR_OK;
    memset(t, 0, sizeof *t);
    if (s == NULL || twin == NULL)
        return 0;
    for (uint32_t i = 0; i < ticks; i++) {
        const int fresh = status == SMR_OK;
        seed = seed * 1664525u + 1013904223u;
        const uint64_t budget = whole / 100u * (5u + (seed >> 8) % 146u);
        const uint64_t time = target_tick(s, clock, budget, &report, &status);
        if (status < 0)
            return 0;
        t->late += time > budget ? 1u : 0u;
        t->over = time > budget && time - budget > t->over ? time - budget : t->over;
        if (fresh && known && budget >= whole) {
            t->enough++;
            t->enough_done += status == SMR_OK ? 1u : 0u;
        }
        if (status != SMR_OK)
            continue;
        known = 1;
        t->done++;
        t->cut += report.details.n_taken < report.details.n_wanted ? 1u : 0u;
        if (i < TARGET_TWIN_TICKS && !target_ok("the same again", target_repeat(s, twin, report.details.n_taken)))
            return 0;
        if (ends(scene, &report) && (!target_again(scene, s) || !target_again(scene, twin)))
            return 0;
    }
    return 1;
}

/* In hundredths. */
static void target_chunks(uint64_t ns, uint64_t chunk)
{
    const uint64_t hundredths = chunk == 0u ? 0u : (100u * ns + chunk - 1u) / chunk;
    target_number(hundredths / 100u);
    target_text(hundredths % 100u < 10u ? ".0" : ".");
    target_number(hundredths % 100u);
    target_text(" chunks\n");
}

static int target_judge(const target_scene *scene, target_clock *clock, uint32_t ticks)
{
    target_times whole, cut;
    target_tally random;
    target_forget(clock);
    if (!target_ok("run with a long budget", target_run(scene, clock, TARGET_ENDLESS, &whole)) ||
        !target_ok("run with a short budget", target_run(scene, clock, TARGET_BUDGET_NS, &cut)) ||
        !target_ok("random budgets", target_random(scene, clock, whole.whole, ticks, &random)))
        return 0;
    target_line("  iteration, ns:            ", whole.whole);
    target_line("  its fixed part, ns:       ", whole.fixed);
    target_line("  a chunk, ns:              ", clock->longest);
    target_line("  iterations cut to pieces: ", whole.ticks);
    target_line("    into ticks:             ", cut.ticks);
    target_line("    longest beyond, ns:     ", cut.longest - TARGET_BUDGET_NS);
    target_line("  random budgets:           ", ticks);
    target_line("    iterations:             ", random.done);
    target_line("    of them not all took part: ", random.cut);
    target_line("    late ticks:             ", random.late);
    target_line("    longest beyond, ns:     ", random.over);
    target_text("                            ");
    target_chunks(random.over, clock->longest);
    target_line("    with enough time:       ", random.enough);
    target_line("    of them complete:       ", random.enough_done);
    return target_ok("the same bits", cut.hash == whole.hash) &&
           target_ok("whole ticks with a long budget, partial ones with a short one",
                     whole.partial == 0u && cut.partial > 0u) &&
           target_ok("the longest chunk", clock->longest <= TARGET_CHUNK_NS) &&
           target_ok("at most a chunk beyond the short budget", cut.longest <= TARGET_BUDGET_NS + TARGET_CHUNK_NS) &&
           target_ok("at most a chunk beyond random budgets", random.over <= TARGET_CHUNK_NS) &&
           target_ok("some iterations are cut, others not",
                     scene->what->moves || scene->what->image
                         ? random.cut == 0u
                         : random.cut > random.done / 20u && random.cut < random.done) &&
           target_ok("enough is enough", random.enough > 0u && random.enough == random.enough_done);
}

int main(void);

int main(void)
{
    static target_scene scene;
    static target_clock clock;
    smr_baremetal board;
    int good = 1;
    clock.port = smr_baremetal_port(&board);
    const uint32_t ticks = target_word(125u);
    const uint32_t n = ticks < TARGET_ALL_TICKS ? TARGET_FIRST : TARGET_BUDGETED;
    for (uint32_t i = 0; i < n; i++) {
        target_text(target_cases[i].name);
        target_text("\n");
        good =
            target_ok("scene", target_set_up(&target_cases[i], &scene)) && target_judge(&scene, &clock, ticks) && good;
    }
    return good ? 0 : 1;
}
