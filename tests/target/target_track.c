/* target_track.c: on an emulated board: a target that moves is followed within a budget: no tick, no slice of building
 * a surface or of refitting it ends later than its budget and a chunk, and cutting the work changes no bit.
 *
 * Under `-icount shift=0` one instruction takes one nanosecond of the board's time. Prints what it finds; ends with 0
 * when all holds.
 * SPDX-License-Identifier: MIT */
#include "target_rig.h"

#define TARGET_BUDGET_NS 200000u /* of a tick */
#define TARGET_SLICE_NS 50000u   /* of building and refitting */
#define TARGET_READING_NS 2000u  /* what the readings before and after may take */
#define TARGET_CHUNK_NS 100000u  /* no chunk takes more instructions, with the guard before and after a tick */
#define TARGET_FRAMES 3u
#define TARGET_TICKS_MAX 20000u
#define TARGET_SLICES_LEAST 10u /* of a surface of this size */

#define TARGET_TRACK_MEMORY static __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
TARGET_TRACK_MEMORY unsigned char target_moving[1u << 20];
TARGET_TRACK_MEMORY float target_moved[3 * 1024];

/* What a run showed. */
typedef struct target_found {
    uint64_t hash;
    uint64_t tick_over, slice_over; /* ns beyond the budget, at most */
    uint32_t ticks, slices;
    uint64_t chunk; /* ns: the longest stretch between two readings while a surface was built or refitted */
} target_found;

/* Slices until the surface is complete; budget 0: in one. */
static int target_finish(smr_surface *surface, target_clock *clock, uint64_t budget, target_found *found)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_status status = SMR_PARTIAL;
    const uint64_t longest = clock->longest;
    clock->longest = 0;
    clock->watched = NULL;
    while (status == SMR_PARTIAL) {
        const uint64_t begin = target_now(clock);
        clock->running = 1;
        status = smr_surface_step(surface, 0, &port, budget);
        const uint64_t time = target_now(clock) - begin; /* the last piece counts, too */
        clock->running = 0;
        found->slices++;
        if (budget > 0u && time > budget && time - budget > found->slice_over)
            found->slice_over = time - budget;
    }
    found->chunk = clock->longest > found->chunk ? clock->longest : found->chunk;
    clock->longest = longest;
    return status == SMR_OK;
}

/* Turned by the tangent of half the angle, and shifted. */
static void target_move(const smr_mesh *mesh, float t, float shift)
{
    const float c = (1.0f - t * t) / (1.0f + t * t), s = 2.0f * t / (1.0f + t * t);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        const float *const p = mesh->xyz + 3u * i;
        target_moved[3u * i] = c * p[0] - s * p[1] + shift;
        target_moved[3u * i + 1u] = s * p[0] + c * p[1];
        target_moved[3u * i + 2u] = p[2];
    }
}

/* Ticks until there is nothing to do. */
static int target_settle(smr *s, target_clock *clock, uint64_t budget, target_found *found)
{
    smr_tick_report report = {0};
    for (uint32_t n = 0; !report.details.settled; n++) {
        smr_status status;
        const uint64_t time = target_tick(s, clock, budget, &report, &status);
        if (status < 0 || n > TARGET_TICKS_MAX)
            return 0;
        found->ticks++;
        if (budget > 0u && time > budget && time - budget > found->tick_over)
            found->tick_over = time - budget;
    }
    return 1;
}

/* The whole sequence; budgets 0: none. All vertices take part. */
static int target_run(const target_scene *scene, target_clock *clock, uint64_t tick_ns, uint64_t slice_ns,
                      target_found *found)
{
    const smr_port port = {clock, 1u, NULL, target_now};
    smr_config config = target_config(scene);
    smr_surface *surface = NULL;
    memset(found, 0, sizeof *found);
    config.track.mode = SMR_TRACK_RECOVER;
    config.basic.iterations = 2;
    config.basic.iterations_last = 4;
    config.track.iterations = 6;
    if (smr_surface_begin(&scene->goal, target_moving, sizeof target_moving, &surface) != SMR_OK ||
        !target_finish(surface, clock, slice_ns, found))
        return 0;
    smr *s = target_start(scene, &config, &port, 0);
    if (s == NULL || smr_set_active(s, SMR_ALL) != SMR_OK)
        return 0;
    for (uint32_t i = 0; i < TARGET_FRAMES; i++) {
        const int jumps = i + 1u == TARGET_FRAMES;
        target_move(&scene->goal, jumps ? 0.15f : 0.01f * (float)i, jumps ? 25.0f : (float)i);
        if (smr_surface_refit(surface, target_moved) != SMR_OK || !target_finish(surface, clock, slice_ns, found) ||
            smr_set_surface(s, SMR_ALL, surface) != SMR_OK || !target_settle(s, clock, tick_ns, found))
            return 0;
    }
    found->hash = smr_state_hash(s);
    return 1;
}

static int target_judge(const target_scene *scene, target_clock *clock)
{
    target_found whole, cut;
    if (!target_ok("run", target_run(scene, clock, 0, 0, &whole)))
        return 0;
    target_forget(clock);
    if (!target_ok("run with budgets", target_run(scene, clock, TARGET_BUDGET_NS, TARGET_SLICE_NS, &cut)))
        return 0;
    target_line("  iterations:                 ", whole.ticks);
    target_line("    into ticks:               ", cut.ticks);
    target_line("    a chunk, ns:              ", clock->longest);
    target_line("    longest beyond, ns:       ", cut.tick_over);
    target_line("  surfaces built and refitted: ", whole.slices);
    target_line("    into slices:              ", cut.slices);
    target_line("    a chunk, ns:              ", cut.chunk);
    target_line("    longest beyond, ns:       ", cut.slice_over);
    return target_ok("the same bits", whole.hash == cut.hash) &&
           target_ok("many slices", cut.slices >= TARGET_SLICES_LEAST * whole.slices) &&
           target_ok("at most a chunk beyond a tick's budget", cut.tick_over <= TARGET_CHUNK_NS) &&
           target_ok("at most a chunk beyond a slice's budget", cut.slice_over <= cut.chunk + TARGET_READING_NS) &&
           target_ok("a chunk of a surface is a small one", cut.chunk <= TARGET_SLICE_NS);
}

int main(void);

int main(void)
{
    static target_scene scene;
    static target_clock clock;
    smr_baremetal board;
    clock.port = smr_baremetal_port(&board);
    int good = target_ok("scene", target_set_up(&target_cases[0], &scene)) && target_judge(&scene, &clock);
    return good ? 0 : 1;
}
