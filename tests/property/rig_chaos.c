/* rig_chaos.c: a port that breaks its contract now and then, on one thread.
 * SPDX-License-Identifier: MIT */
#include "property/rig_chaos.h"

#include "property/rig.h"

enum { SOUND, LEFT_OUT, TWICE, SWAPPED, NO_WORKER, NO_TASK, ALL_TWICE, KINDS };

static void loop(void *ctx, smr_task run, void *arg, uint32_t n_tasks)
{
    rig_chaos *c = ctx;
    const uint32_t kind =
        c->odds > 0u && rig_random(&c->seed, c->odds) == 0u ? 1u + rig_random(&c->seed, KINDS - 1u) : SOUND;
    const uint32_t first = rig_random(&c->seed, n_tasks), backwards = rig_random(&c->seed, 2);
    const uint32_t victim = rig_random(&c->seed, n_tasks),
                   other = (victim + 1u + rig_random(&c->seed, n_tasks - 1u)) % n_tasks;
    for (uint32_t k = 0; k < n_tasks; k++) {
        const uint32_t t = (first + (backwards ? n_tasks - 1u - k : k)) % n_tasks;
        const uint32_t worker = rig_random(&c->seed, c->n_workers), wrong = c->n_workers + rig_random(&c->seed, 3);
        if (t == victim && (kind == LEFT_OUT || kind == SWAPPED))
            continue;
        run(arg, t, t == victim && kind == NO_WORKER ? wrong : worker);
        if (kind == ALL_TWICE || (t == victim && kind == TWICE) || (t == other && kind == SWAPPED))
            run(arg, t, worker);
    }
    if (kind == NO_TASK)
        run(arg, n_tasks + rig_random(&c->seed, 9) * rig_random(&c->seed, 1u << 20), 0);
    c->broken += kind != SOUND;
}

static uint64_t read_clock(void *ctx)
{
    rig_chaos *c = ctx;
    const uint32_t dice = rig_random(&c->seed, 100), far = rig_random(&c->seed, 63);
    if (dice < 60u)
        c->time += rig_random(&c->seed, 5000);
    else if (dice < 64u)
        c->time += (uint64_t)1 << far;
    else if (dice < 68u)
        c->time -= (uint64_t)1 << far;
    return c->time;
}

smr_port rig_chaos_port(rig_chaos *c, uint32_t seed, uint32_t n_workers, uint32_t odds)
{
    *c = (rig_chaos){.seed = seed, .n_workers = n_workers, .odds = odds, .time = seed};
    return (smr_port){c, n_workers, loop, read_clock};
}
