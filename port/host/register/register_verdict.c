/* register_verdict.c: the verdict: what the inputs, the start and the result itself say against a registration.
 * SPDX-License-Identifier: MIT */

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "register/register_job.h"

#define SCALE_MOST 2.0     /* people's bones differ less in size, either way */
#define RATIO_MOST 9.0     /* a part of a body and the whole of it: below; centimetres and inches: above */
#define MIRRORED_MOST 0.7  /* of the start's distance: the other side's bone starts at half of it */
#define COVERED_LEAST 0.98 /* of the model's vertices: the rest may end in air */
#define DOUBTFUL 0.3       /* factor of a reason to look on the probability */
#define LOST 0.01          /* largest probability of a failure */
#define MOVED_MOST_MM 40.0 /* from a start by landmarks: clicks are nearer */
#define FOLDS_MOST 1.0e-3  /* folds over triangles, if they are shallow */
#define FOLDS_DEEP_MM 2.0  /* deeper ones are seen: each counts */

const char *host_verdict_name(int level)
{
    static const char *const names[] = {"good", "look", "failed"};
    return names[level];
}

void host_verdict_add(host_verdict *verdict, int level, const char *reason, ...)
{
    va_list list;
    verdict->level = level > verdict->level ? level : verdict->level;
    if (level == HOST_VERDICT_LOOK)
        verdict->probability *= DOUBTFUL;
    else if (level == HOST_VERDICT_FAILED)
        verdict->probability = fmin(verdict->probability, LOST);
    if (verdict->n_reasons == HOST_REASONS_MAX)
        return;
    va_start(list, reason);
    (void)vsnprintf(verdict->reason[verdict->n_reasons++], HOST_REASON_BYTES, reason, list);
    va_end(list);
}

static int beyond(double ratio, double most) { return ratio > 0.0 && (ratio > most || ratio * most < 1.0); }

/* What was seen of the target, and by how many iterations. */
static void judge_run(const host_job *job, host_verdict *verdict)
{
    const int with_reference = job->options->image_target && job->options->reference != NULL;
    if (!job->target_seen && with_reference && !(job->covered > 0.0))
        host_verdict_add(verdict, HOST_VERDICT_FAILED,
                         "nothing of the target was seen: none of the model's vertices lies in the reference image %s",
                         job->options->reference);
    else if (!job->target_seen)
        host_verdict_add(
            verdict, HOST_VERDICT_FAILED,
            "nothing of the target was seen: no vertex had a goal in any iteration; look at the start and at --search");
    if (with_reference && job->covered > 0.0 && job->covered < COVERED_LEAST)
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "%.1f %% of the model's vertices lie in the reference image: look at the ends of the others, "
                         "which have no profiles",
                         100.0 * job->covered);
    if (job->last.done == 0)
        host_verdict_add(verdict, HOST_VERDICT_LOOK, "--ticks ended first, after %.0f %% of the schedule",
                         100.0 * (double)job->last.progress);
}

/* What the alignment says against its pose. Where the given pose was kept, files say which of several it is. */
static void judge_align(const smr_align_report *said, host_verdict *verdict)
{
    if (said->n_alike > 1 && said->given == 0)
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "%" PRIu32 " clearly different start poses explain the surfaces alike: look which way round "
                         "the result lies, or give landmarks",
                         said->n_alike);
    if (said->n_alike > 0 && (double)said->mirrored_rms_mm < MIRRORED_MOST * (double)said->rms_mm)
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "the model's mirror image starts nearer, %.1f instead of %.1f mm: look whether the target is "
                         "of the other side of the body",
                         (double)said->mirrored_rms_mm, (double)said->rms_mm);
}

/* How far the result lies from where the landmarks put the model, mean over vertices. */
static double moved_mm(const host_job *job)
{
    double sum = 0.0, n = 0.0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        sum += (double)job->result[i].report.moved_mean_mm * (double)job->result[i].mesh.n_vertices;
        n += (double)job->result[i].mesh.n_vertices;
    }
    return n > 0.0 ? sum / n : 0.0;
}

static void judge_start(const host_job *job, host_verdict *verdict)
{
    if (job->n_landmarks > 0 && moved_mm(job) > MOVED_MOST_MM)
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "the result lies %.0f mm from where the landmarks put the model: look at their places",
                         moved_mm(job));
    judge_align(&job->align_report, verdict);
    if (job->start_xyz != NULL && job->part == NULL && job->n_landmarks == 0)
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "parts of the model have turned about joints: look at each, and at those the target lacks");
    for (uint32_t i = 0; i < job->model.n_parts && job->part != NULL; i++)
        if (job->result[i].target != HOST_NO_TARGET && job->part[i].order > 0 && job->part[i].report.n_alike == 0)
            host_verdict_add(verdict, HOST_VERDICT_LOOK,
                             "no start pose of its own was found for %s, it starts with its neighbour",
                             job->model.part[i].name);
    if (job->landmark_doubt[0] != '\0')
        host_verdict_add(verdict, HOST_VERDICT_LOOK, "%s", job->landmark_doubt);
    if (beyond(job->start_scale, SCALE_MOST))
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "the start makes the model %.3g times as large: look at the units of model and target",
                         job->start_scale);
    if (beyond(job->size_ratio, RATIO_MOST))
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "the target is %.3g times as large as the model: look at the units of both", job->size_ratio);
}

/* Surfaces that are inside out have normals that no other surface agrees with. */
static void judge_orientation(host_job *job, host_verdict *verdict)
{
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        if (host_is_inside_out(&job->model.part[i].mesh)) {
            host_verdict_add(&job->result[i].verdict, HOST_VERDICT_LOOK, "the model's surface is inside out");
            host_verdict_add(verdict, HOST_VERDICT_LOOK, "the model's %s is a closed surface that is inside out",
                             job->model.part[i].name);
        }
    for (uint32_t i = 0; !job->options->image_target && i < job->n_targets; i++)
        if (job->target[i].users > 0 && host_is_inside_out(&job->target[i].mesh)) {
            host_verdict_add(&job->result[job->target[i].user].verdict, HOST_VERDICT_LOOK,
                             "the target's surface is inside out");
            host_verdict_add(verdict, HOST_VERDICT_LOOK, "the target %s is a closed surface that is inside out",
                             job->target[i].path);
        }
}

/* Structures of which nothing was found at the end. */
static void judge_lost(host_job *job, host_verdict *verdict)
{
    uint32_t n = 0, first = 0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_result *const r = &job->result[i];
        if (r->report.has_target == 0 || job->model.part[i].mesh.n_triangles == 0 || r->report.matched_share > 0.0f)
            continue;
        host_verdict_add(&job->result[i].verdict, HOST_VERDICT_FAILED, "no vertex had a goal at the end");
        first = n++ == 0 ? i : first;
    }
    if (n > 0 && job->target_seen)
        host_verdict_add(verdict, HOST_VERDICT_LOOK, "no vertex of %s had a goal at the end%s",
                         job->model.part[first].name, n > 1 ? ", nor of others" : "");
}

/* Folds count by their share of the triangles and by their depth. */
static int many_folds(const host_folds *folds, double triangles)
{
    return folds->deepest_mm > FOLDS_DEEP_MM || (double)folds->n > FOLDS_MOST * triangles;
}

static void judge_folds(host_job *job, host_verdict *verdict)
{
    uint32_t most = 0;
    double triangles = 0.0;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        const host_folds *const folds = &job->result[i].folds;
        most = folds->n > job->result[most].folds.n ? i : most;
        triangles += (double)job->result[i].mesh.n_triangles;
        if (many_folds(folds, (double)job->result[i].mesh.n_triangles))
            host_verdict_add(&job->result[i].verdict, HOST_VERDICT_LOOK, "%" PRIu64 " folds are left", folds->n);
    }
    if (many_folds(&job->folds, triangles))
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "%" PRIu64 " folds are left, up to %.1f mm deep: look at the surface of %s first",
                         job->folds.n, job->folds.deepest_mm, job->model.part[most].name);
}

/* Pairs that contact should have parted. */
static void judge_contact(host_job *job, host_verdict *verdict)
{
    const host_contacts *const c = &job->contacts;
    uint32_t n = 0, most = 0;
    for (uint32_t i = 0; i < c->n_pairs; i++) {
        const host_contact_pair *const pair = &c->pair[i];
        if (pair->left_mm <= host_contact_bound(job))
            continue;
        most = n++ == 0 || pair->left_mm > c->pair[most].left_mm ? i : most;
        host_verdict_add(&job->result[pair->a].verdict, HOST_VERDICT_LOOK, "still %.1f mm deep in contact with %s",
                         (double)pair->left_mm, host_contact_name(job, pair->b));
        if (pair->b < job->model.n_parts)
            host_verdict_add(&job->result[pair->b].verdict, HOST_VERDICT_LOOK, "still %.1f mm deep in contact with %s",
                             (double)pair->left_mm, host_contact_name(job, pair->a));
    }
    if (n > 0)
        host_verdict_add(verdict, HOST_VERDICT_LOOK, "%s and %s, which contact should part, overlap by %.1f mm%s",
                         host_contact_name(job, c->pair[most].a), host_contact_name(job, c->pair[most].b),
                         (double)c->pair[most].left_mm, n > 1 ? ", and so do others" : "");
}

/* Where a target lies in what is to be kept out of, contact draws the structure off what is seen of it. */
static void judge_contradiction(host_job *job, host_verdict *verdict)
{
    const host_contacts *const c = &job->contacts;
    uint32_t most = 0;
    for (uint32_t i = 0; i < c->n_pairs; i++) {
        const host_contact_pair *const pair = &c->pair[i];
        most = pair->asked_mm > c->pair[most].asked_mm ? i : most;
        if (pair->asked_mm > host_contact_bound(job))
            host_verdict_add(&job->result[pair->a].verdict, HOST_VERDICT_LOOK,
                             "its target lies %.1f mm deep in %s, which contact keeps it out of",
                             (double)pair->asked_mm, host_contact_name(job, pair->b));
    }
    if (c->n_pairs > 0 && c->pair[most].asked_mm > host_contact_bound(job))
        host_verdict_add(verdict, HOST_VERDICT_LOOK,
                         "the target of %s lies %.1f mm deep in %s: contact keeps the result off its target there",
                         host_contact_name(job, c->pair[most].a), (double)c->pair[most].asked_mm,
                         host_contact_name(job, c->pair[most].b));
}

/* Joins the probability by measures with what the reasons so far leave. Those to look do not fail a result. */
static double join(const smr_verdict *measures, const host_verdict *verdict)
{
    const double both = (double)measures->probability * verdict->probability;
    return measures->level == SMR_VERDICT_FAILED || verdict->level == HOST_VERDICT_FAILED
               ? both
               : fmax(both, (double)SMR_PROBABILITY_FAILED);
}

/* What the library measured: its level and a sentence for each reason, but for that nothing was seen: judge_run and
 * judge_lost say more of that. */
static void judge_measures(smr_status status, const smr_verdict *measures, host_verdict *verdict)
{
    verdict->expected_error_mm = (double)NAN;
    if (status != SMR_OK) /* --ticks ended within an iteration */
        return;
    if (measures->expected_error_mm >= 0.0f)
        verdict->expected_error_mm = (double)measures->expected_error_mm;
    const double probability = join(measures, verdict);
    for (uint32_t bit = SMR_REASON_NOTHING_VISIBLE << 1; bit <= measures->reasons; bit <<= 1)
        if ((measures->reasons & bit) != 0)
            host_verdict_add(verdict, (int)measures->level, "%s", smr_reason_text(bit));
    verdict->probability = probability;
    if (probability < (double)SMR_PROBABILITY_FAILED)
        verdict->level = HOST_VERDICT_FAILED;
}

/* Least and most of each structure. Where the start was kept they are of what was rejected: not known. */
static void find_local_volumes(host_job *job)
{
    float *const all = malloc(((size_t)job->model.info.n_vertices + 1u) * sizeof *all);
    const float *ratio = all;
    const int known = !job->kept_start && all != NULL && smr_get_local_volume(job->state, SMR_ALL, 0, all) == SMR_OK;
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        host_result *const r = &job->result[i];
        r->local_volume[0] = r->local_volume[1] = known && r->mesh.n_vertices > 0 ? ratio[0] : (float)NAN;
        for (uint32_t k = 0; known && k < r->mesh.n_vertices; k++) {
            r->local_volume[0] = fminf(r->local_volume[0], ratio[k]);
            r->local_volume[1] = fmaxf(r->local_volume[1], ratio[k]);
        }
        if (known)
            ratio += r->mesh.n_vertices;
    }
    free(all);
}

/* Two independent tasks: contact of the results, and what the registration itself measures. */
typedef struct both {
    host_job *job;
    host_error *error;
    int failed;        /* contact */
    smr_status status; /* of the library's verdict */
} both;

static void measure_half(void *arg, uint32_t task, uint32_t worker)
{
    both *const b = arg;
    (void)worker;
    if (task == 0) {
        b->failed = host_job_measure_contact(b->job, b->error);
        return;
    }
    find_local_volumes(b->job);
    b->status = smr_get_verdict(b->job->state, SMR_ALL, &b->job->measures);
}

static void find_volume(void *arg, uint32_t task, uint32_t worker)
{
    const host_job *const job = arg;
    (void)worker;
    (void)smr_get_structure_volume(job->state, task, &job->result[task].volume);
}

int host_job_verdict(host_job *job, host_error *error)
{
    both b = {job, error, 0, SMR_OK};
    const double start = host_seconds();
    host_parallel(&job->port.port, measure_half, &b, 2);
    host_parallel(&job->port.port, find_volume, job, job->model.n_parts);
    job->measure_s += host_seconds() - start;
    if (b.failed)
        return -1;
    job->verdict.probability = 1.0;
    for (uint32_t i = 0; i < job->model.n_parts; i++)
        job->result[i].verdict.probability = 1.0;
    judge_run(job, &job->verdict);
    judge_start(job, &job->verdict);
    judge_orientation(job, &job->verdict);
    judge_lost(job, &job->verdict);
    judge_folds(job, &job->verdict);
    judge_contact(job, &job->verdict);
    judge_contradiction(job, &job->verdict);
    smr_verdict measures = job->measures; /* also those of a structure alone */
    judge_measures(b.status, &job->measures, &job->verdict);
    if (job->target_seen && (job->measures.reasons & SMR_REASON_NOTHING_VISIBLE) != 0)
        host_verdict_add(&job->verdict, HOST_VERDICT_FAILED, "%s", smr_reason_text(SMR_REASON_NOTHING_VISIBLE));
    for (uint32_t i = 0; i < job->model.n_parts; i++) {
        job->result[i].verdict.expected_error_mm = (double)NAN;
        if (job->result[i].report.has_target == 0)
            continue;
        if (job->model.n_parts > 1)
            b.status = smr_get_verdict(job->state, i, &measures);
        judge_measures(b.status, &measures, &job->result[i].verdict);
    }
    return 0;
}
