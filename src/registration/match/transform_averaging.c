/* transform_averaging.c: the clusters' transforms T_i = [R_i - I, t_i] as records, for x~_i = Sum_i(T) x^r_i / |zeta_i|
 * (paper 2.3, evolution). cluster_sums.c sums the records; evolve_positions.c applies the mean to x^r. With
 * smr_config.motion.fusing `lie` records are of log T_i, and x~_i = exp(Sum_i(log T) / |zeta_i|) x^r_i.
 * Bounds: one pass over the active vertices.
 * SPDX-License-Identifier: MIT */
#include "registration/match/cluster_match.h"

uint32_t smr_average_tasks(const void *arg) { return smr_active_tasks(((const smr_match *)arg)->schedule); }

void smr_average_record(void *arg, uint32_t task, SMR_UNUSED uint32_t worker)
{
    const smr_match *m = arg;
    const uint32_t words = smr_transform_words(m->shared), first = words - 3u;
    for (uint32_t v = task * SMR_CHUNK; v < smr_active_end(m->schedule, task); v++) {
        uint32_t *r = m->sums->record + SMR_WORDS * (size_t)v;
        float t[12];
        memcpy(t, m->sums->sum + SMR_WORDS * (size_t)v, words * sizeof *t);
        for (uint32_t i = 0; i < first; i++)
            r[i] = smr_fixed(t[i] * m->sums->scale[0]);
        for (uint32_t i = first; i < words; i++)
            r[i] = smr_fixed(t[i] * m->sums->scale[1]);
    }
}
