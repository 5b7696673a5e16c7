/* track_verdict.c: how good a frame is: of surfaces the verdict on the whole; in images each structure counts, for one
 * of little contrast may go astray and be too small for the whole to show it.
 * SPDX-License-Identifier: MIT */
#include "track/track_verdict.h"

#include <stdio.h>

static void lower(smr_verdict *verdict)
{
    if (verdict->level == SMR_VERDICT_GOOD)
        verdict->level = SMR_VERDICT_LOOK;
}

/* Those without triangles are carried. */
static smr_status judge_structures(smr *s, const host_model *model, smr_verdict *verdict, host_track_doubts *doubts)
{
    smr_status status = SMR_OK;
    uint32_t i = 0;
    for (i = 0; status == SMR_OK && i < model->n_parts; i++) {
        smr_verdict one;
        if (model->part[i].mesh.n_triangles == 0)
            continue;
        status = smr_get_verdict(s, i, &one);
        if (status != SMR_OK || one.level == SMR_VERDICT_GOOD)
            continue;
        lower(verdict);
        verdict->reasons |= one.reasons;
        doubts->frames[i]++;
    }
    return status;
}

smr_status host_track_judge(smr *s, const host_model *images, int settled, smr_verdict *verdict,
                            host_track_doubts *doubts)
{
    const smr_status status = smr_get_verdict(s, SMR_ALL, verdict);
    if (status != SMR_OK || images == NULL)
        return status;
    if (!settled)
        lower(verdict);
    return judge_structures(s, images, verdict, doubts);
}

void host_track_print_doubts(const host_track_doubts *doubts, const host_model *model)
{
    const char *before = "not good in themselves, and in how many frames: ";
    uint32_t i = 0;
    for (i = 0; i < model->n_parts; i++)
        if (doubts->frames[i] > 0) {
            (void)printf("%s%s %u", before, model->part[i].name, doubts->frames[i]);
            before = ", ";
        }
    if (before[0] == ',')
        (void)printf("\n");
}
