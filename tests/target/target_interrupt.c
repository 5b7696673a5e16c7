/* target_interrupt.c: on an emulated board: a registration ticks in a timer interrupt beside a background loop, as in
 * a device. No period is missed, the background makes progress and reads complete positions, and the run repeats
 * without a clock to the same bits.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's time. Prints what it finds; ends with 0
 * when all holds.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"
#include "smr_clock.h"
#include "smr_systick.h"
#include <stdatomic.h>

#define TARGET_PERIOD_NS 5000000u
#define TARGET_TICK_NS                                                                                                 \
    4000000u /* the budget; a chunk and the interrupt's own work fit into the rest, the background has what is left */
#define TARGET_LOG 256u /* iterations */
#define TARGET_READS 4096u
#define TARGET_POINTS 2048u /* of all structures */
#define TARGET_PARTS 2u

/* Written by the interrupt, read by the background once `stop` is set; `done` and `stop` at any time. */
static struct {
    smr *s;
    atomic_uint done; /* complete iterations: positions are new when it changes */
    atomic_uint stop;
    uint32_t ticks, partial, cut, missed;
    uint32_t taken[TARGET_LOG]; /* n_taken of each iteration */
    smr_status status;
    uint64_t longest; /* ns: a tick */
    target_clock clock;
} target_isr;

/* One period. The positions are this handler's alone while it runs, for the background cannot interrupt it. */
void smr_systick_handler(void)
{
    smr_tick_report report;
    if (atomic_load(&target_isr.stop) != 0u)
        return;
    const uint64_t time = target_tick(target_isr.s, &target_isr.clock, TARGET_TICK_NS, &report, &target_isr.status);
    target_isr.longest = time > target_isr.longest ? time : target_isr.longest;
    target_isr.ticks++;
    if (target_isr.status == SMR_OK) {
        if (report.iteration <= TARGET_LOG)
            target_isr.taken[report.iteration - 1u] = report.details.n_taken;
        target_isr.cut += report.details.n_taken < report.details.n_wanted ? 1u : 0u;
        atomic_store(&target_isr.done, report.iteration);
    }
    target_isr.partial += target_isr.status == SMR_PARTIAL ? 1u : 0u;
    if (smr_systick_pending())
        target_isr.missed++; /* the next period has begun already */
    if (target_isr.status < 0 || report.done)
        atomic_store(&target_isr.stop, 1u);
}

static struct {
    float xyz[3u * TARGET_POINTS];
    uint32_t n, n_parts, part[TARGET_PARTS]; /* points in all, and of each structure */
} target_points;

static int target_count(const smr_model *model)
{
    smr_model_info info;
    if (smr_model_get_info(model, &info) != SMR_OK || info.n_structures > TARGET_PARTS ||
        info.n_vertices > TARGET_POINTS)
        return 0;
    target_points.n = info.n_vertices;
    target_points.n_parts = info.n_structures;
    for (uint32_t i = 0; i < info.n_structures; i++) {
        smr_structure_info part;
        if (smr_model_structure(model, i, &part) != SMR_OK)
            return 0;
        target_points.part[i] = part.n_vertices;
    }
    return 1;
}

/* All structures' positions. */
static void target_copy(const smr *s)
{
    float *xyz = target_points.xyz;
    for (uint32_t i = 0; i < target_points.n_parts; i++) {
        (void)smr_get_positions(s, i, xyz);
        xyz += 3u * target_points.part[i];
    }
}

/* Reads positions from the background, again when an iteration ended meanwhile. Returns the iteration they belong
 * to. */
static uint32_t target_positions(const smr *s, uint32_t *again)
{
    for (;;) {
        const uint32_t before = atomic_load(&target_isr.done);
        target_copy(s);
        if (atomic_load(&target_isr.done) == before)
            return before;
        ++*again;
    }
}

static uint32_t target_sum(void)
{
    uint32_t sum = 2166136261u; /* FNV-1a, by words */
    for (uint32_t i = 0; i < 3u * target_points.n; i++) {
        uint32_t bits;
        memcpy(&bits, &target_points.xyz[i], sizeof bits);
        sum = (sum ^ bits) * 16777619u;
    }
    return sum;
}

/* What the background read, to be compared with the replay. */
static struct {
    uint32_t n, again;
    uint64_t loops;
    struct {
        uint32_t iteration, sum;
    } seen[TARGET_READS];
} target_background;

static void target_loop(const smr *s)
{
    memset(&target_background, 0, sizeof target_background);
    while (atomic_load(&target_isr.stop) == 0u) {
        target_background.loops++;
        const uint32_t iteration = target_positions(s, &target_background.again);
        if (target_background.n < TARGET_READS) {
            target_background.seen[target_background.n].iteration = iteration;
            target_background.seen[target_background.n++].sum = target_sum();
        }
    }
}

/* The same without a clock. Every read must be of whole positions. */
static int target_replay(const target_scene *scene, const smr_config *config, uint32_t *torn)
{
    smr *s = target_start(scene, config, NULL, 1);
    uint32_t at = 0;
    *torn = 0;
    if (s == NULL)
        return 0;
    for (uint32_t i = 0; i <= atomic_load(&target_isr.done); i++) {
        if (i > 0u && (smr_set_active(s, target_isr.taken[i - 1u]) != SMR_OK || smr_tick(s, 0, NULL) != SMR_OK))
            return 0;
        target_copy(s);
        const uint32_t sum = target_sum();
        for (; at < target_background.n && target_background.seen[at].iteration == i; at++)
            *torn += target_background.seen[at].sum != sum ? 1u : 0u;
    }
    return target_ok("reads in order", at == target_background.n) &&
           target_ok("the replay's bits", smr_state_hash(s) == smr_state_hash(target_isr.s));
}

/* One registration of the scene from interrupts. */
static int target_run(const target_scene *scene)
{
    const smr_port port = {&target_isr.clock, 1u, NULL, target_now};
    const smr_config config = target_config(scene);
    uint32_t torn;
    target_isr.s = target_start(scene, &config, &port, 0);
    if (target_isr.s == NULL || !target_count(scene->model))
        return 0;
    atomic_store(&target_isr.done, 0u);
    atomic_store(&target_isr.stop, 0u);
    target_isr.ticks = target_isr.partial = target_isr.cut = target_isr.missed = 0;
    target_isr.longest = 0;
    target_forget(&target_isr.clock);
    smr_systick_start(smr_clock_core_hz() / 1000u * (TARGET_PERIOD_NS / 1000000u));
    target_loop(target_isr.s);
    smr_systick_stop();
    target_line("  periods:          ", target_isr.ticks);
    target_line("    missed:         ", target_isr.missed);
    target_line("    partial ticks:  ", target_isr.partial);
    target_line("    longest, ns:    ", target_isr.longest);
    target_line("  iterations:       ", atomic_load(&target_isr.done));
    target_line("    not all took part: ", target_isr.cut);
    target_line("  background loops: ", target_background.loops);
    target_line("    reads again:    ", target_background.again);
    return target_ok("status", target_isr.status >= 0) &&
           target_ok("the log is long enough", atomic_load(&target_isr.done) <= TARGET_LOG) &&
           target_ok("no period is missed", target_isr.missed == 0u) &&
           target_ok("the background goes on", target_background.loops > target_isr.ticks / 2u) &&
           target_ok("the replay", target_replay(scene, &config, &torn)) && target_ok("reads are whole", torn == 0u);
}

int main(void);

int main(void)
{
    static target_scene scene;
    smr_baremetal board;
    int good = 1;
    target_isr.clock.port = smr_baremetal_port(&board);
    for (uint32_t i = 0; i < TARGET_CASES; i++) {
        target_text(target_cases[i].name);
        target_text("\n");
        good =
            target_ok("scene", target_set_up(&target_cases[i], &scene)) && target_ok("run", target_run(&scene)) && good;
    }
    return good ? 0 : 1;
}
