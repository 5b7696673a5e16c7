/* register_summary.c: the result of a registration in a few lines for people.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>

#include "report/register_report.h"

#define SHOWN 0.995 /* of the model's area: less is said */

/* The verdict in words, and what it is made of. */
static void print_verdict(const host_verdict *verdict)
{
    uint32_t i = 0;
    (void)printf("verdict: %s",
                 verdict->level == HOST_VERDICT_LOOK ? "look at the result" : host_verdict_name(verdict->level));
    for (i = 0; i < verdict->n_reasons; i++)
        (void)printf("%s%s", i == 0 ? ": " : "; ", verdict->reason[i]);
    if (verdict->expected_error_mm >= 0.0 && verdict->level != HOST_VERDICT_FAILED)
        (void)printf(" (expected error %.2f mm)", verdict->expected_error_mm);
    (void)putchar('\n');
}

void host_job_summary(const host_job *job)
{
    const host_stats *const a = &job->area.to_target, *const b = &job->area.to_result;
    const char *const name = job->options->image_target ? "truth" : "target";
    smr_log_state log;
    uint32_t i = 0, carried = 0;
    (void)printf("%s after %u iterations, %.3f s (load %.3f, prepare %.3f, start %.3f, register %.3f), %u threads\n",
                 host_job_converged(job) ? "converged" : "not converged", job->last.iteration,
                 host_seconds() - job->begin_s, job->load_s, job->model_is_prepared ? 0.0 : job->model.prepare_s,
                 job->start_s, job->register_s, job->port.port.n_workers);
    if (job->n_landmarks > 0 && job->warp_kind != SMR_WARP_SPLINE && job->options->align == HOST_ALIGN_NONE)
        (void)printf("start: %u landmarks as they lie carry no spline, a %s fit instead\n", job->n_landmarks,
                     host_warp_name(job->warp_kind));
    if (a->n > 0)
        (void)printf("model to %s: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", name, a->mean, a->rms, a->p95,
                     a->max);
    if (job->overlap.n > 0 && job->overlap.weight < SHOWN * a->weight)
        (void)printf("the %.0f %% of the model that the target shows: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n",
                     100.0 * job->overlap.weight / a->weight, job->overlap.mean, job->overlap.rms, job->overlap.p95,
                     job->overlap.max);
    if (job->n_targets > 0)
        (void)printf("%s to model: mean %.3f  rms %.3f  p95 %.3f  max %.3f mm\n", name, b->mean, b->rms, b->p95,
                     b->max);
    if (job->by_vertex.n > 0)
        (void)printf("vertex to vertex: mean %.3f  max %.3f mm\n", job->by_vertex.mean, job->by_vertex.max);
    if (job->goals != NULL)
        (void)printf("landmarks to their places: mean %.3f  max %.3f mm\n", job->goals->mean, job->goals->max);
    if (job->options->image_target)
        (void)printf("vertices with a goal in the image: %.1f %%\n",
                     job->last.details.matched_share > 0.0f ? 100.0 * (double)job->last.details.matched_share : 0.0);
    (void)printf("folds: %" PRIu64 "  state hash: %016" PRIx64 "\n", job->folds, smr_state_hash(job->state));
    for (i = 0; i < job->model.n_parts; i++)
        if (host_job_carries(job, i))
            (void)printf("%s%s", carried++ == 0 ? "carried along without a target: " : ", ", job->model.part[i].name);
    if (carried > 0)
        (void)putchar('\n');
    for (i = 0; i < job->n_targets; i++)
        if (job->target[i].users == 0)
            (void)printf("not used, no structure has its name: %s\n", job->target[i].path);
    if (job->options->log != NULL && smr_get_log(job->state, &log) == SMR_OK)
        (void)printf("log: %s, %u ticks%s\n", job->options->log, log.n_ticks, log.full ? ", then it was full" : "");
    (void)printf("results: %s\n", job->options->out);
    if (job->options->slicer != NULL)
        (void)printf("scene for 3D Slicer: %s\n", job->options->slicer);
    if (job->options->html)
        (void)printf("to look at: %s/report.html\n", job->options->out);
    print_verdict(&job->verdict);
}
