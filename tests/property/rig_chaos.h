/* rig_chaos.h: a port that runs tasks in any order on any worker and now and then breaks its contract, with a clock
 * that stands, jumps and runs backwards.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_CHAOS_H
#define RIG_CHAOS_H

#include "smr.h"

typedef struct rig_chaos {
    uint32_t seed, n_workers;
    uint32_t odds;   /* one loop in so many breaks the contract; 0: none */
    uint32_t broken; /* number of loops that did */
    uint64_t time;
} rig_chaos;

smr_port rig_chaos_port(rig_chaos *chaos, uint32_t seed, uint32_t n_workers, uint32_t odds);

#endif
