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

void host_track_note(host_track_verdict *verdict, const host_frame_report *report)
{
    verdict->last = *report;
    if (verdict->worst.name == NULL || report->verdict.level > verdict->worst.verdict.level)
        verdict->worst = *report;
    verdict->n[report->verdict.level]++;
}

/* Reasons go after a colon, then after semicolons. */
static const char *between(uint32_t *n) { return (*n)++ == 0 ? ": " : "; "; }

static void print_reasons(const host_frame_report *frame)
{
    uint32_t bit = 0, n = 0;
    for (bit = 1; bit != 0 && bit <= frame->verdict.reasons; bit <<= 1)
        if ((frame->verdict.reasons & bit) != 0)
            (void)printf("%s%s", between(&n), smr_reason_text(bit));
    if (frame->overlap_mm > 0.0f)
        (void)printf("%s" HOST_OVERLAP_TEXT, between(&n), (double)frame->overlap_mm);
    if (frame->last.details.jumped)
        (void)printf("%sthe target jumped", between(&n));
    if (!frame->last.details.settled)
        (void)printf("%sit did not settle within %u ticks", between(&n), frame->ticks);
}

static void print_frame(const host_frame_report *frame)
{
    static const char *const words[] = {"good", "look at the result", "failed"};
    const uint32_t level = frame->verdict.level;
    (void)printf("%s: %s", frame->name, words[level]);
    if (level != SMR_VERDICT_GOOD)
        print_reasons(frame);
    if (frame->verdict.expected_error_mm >= 0.0f && level != SMR_VERDICT_FAILED)
        (void)printf(" (expected error %.2f mm)", (double)frame->verdict.expected_error_mm);
    (void)putchar('\n');
}

void host_track_print_verdict(const host_track_verdict *verdict)
{
    (void)printf("verdict of the last frame, ");
    print_frame(&verdict->last);
    if (verdict->worst.verdict.level == verdict->last.verdict.level)
        return;
    (void)printf("verdict of the worst frame, ");
    print_frame(&verdict->worst);
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
