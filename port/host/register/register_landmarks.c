/* register_landmarks.c: landmarks as goals, and whether landmarks agree with each other.
 * SPDX-License-Identifier: MIT */
#include "register/register_job.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

int host_landmark_pairs_read(const host_options *options, const host_files *files, host_landmarks *set,
                             float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3], uint32_t *n,
                             host_error *error)
{
    host_landmarks *const both = calloc(2, sizeof *both);
    int result = 0;
    if (both == NULL)
        return host_fail(error, "start", "free memory");
    for (uint32_t i = 0; result == 0 && i < 2; i++)
        result = host_landmarks_read(files->path[i], &both[i], error);
    if (result == 0)
        result = host_landmarks_pair(&both[0], &both[1], files->path[0], files->path[1], from, to, n, error);
    for (uint32_t i = 0; result == 0 && i < *n; i++) {
        if (options->mirror_model != HOST_MIRROR_NONE)
            from[i][options->mirror_model] = 0.0f - from[i][options->mirror_model];
        if (options->mirror_target != HOST_MIRROR_NONE)
            to[i][options->mirror_target] = 0.0f - to[i][options->mirror_target];
    }
    if (result == 0 && set != NULL)
        *set = both[0];
    free(both);
    return result;
}

host_landmark_goals *host_landmark_goals_read(const host_options *options, host_error *error)
{
    host_landmark_goals *const made = calloc(1, sizeof *made);
    uint32_t n = 0;
    error->file = "--landmark-goals";
    if (made == NULL) {
        (void)host_fail(error, "start", "free memory");
        return NULL;
    }
    if (host_landmark_pairs_read(options, &options->landmark_goals, &made->set, made->from, made->to, &n, error) == 0)
        return made;
    free(made);
    return NULL;
}

smr_status host_landmark_goals_set(const host_landmark_goals *goals, float weight, smr *s)
{
    smr_landmark landmark[HOST_LANDMARKS_MAX];
    memset(landmark, 0, sizeof landmark);
    for (uint32_t i = 0; i < goals->set.n; i++) {
        landmark[i].structure = SMR_ALL;
        landmark[i].vertex = SMR_NONE;
        memcpy(landmark[i].rest, goals->from[i], sizeof landmark[i].rest);
        memcpy(landmark[i].place, goals->to[i], sizeof landmark[i].place);
        landmark[i].weight = weight;
        landmark[i].hard = !(weight > 0.0f);
    }
    return smr_set_landmarks(s, landmark, goals->set.n);
}

smr_status host_landmark_goals_measure(host_landmark_goals *goals, const smr *s)
{
    float xyz[HOST_LANDMARKS_MAX][3];
    const smr_status status = smr_get_landmarks(s, xyz[0]);
    goals->mean = goals->max = 0.0;
    for (uint32_t i = 0; status == SMR_OK && i < goals->set.n; i++) {
        const double x = (double)xyz[i][0] - (double)goals->to[i][0], y = (double)xyz[i][1] - (double)goals->to[i][1],
                     z = (double)xyz[i][2] - (double)goals->to[i][2];
        goals->residual[i] = sqrt(x * x + y * y + z * z);
        goals->mean += goals->residual[i] / goals->set.n;
        goals->max = goals->residual[i] > goals->max ? goals->residual[i] : goals->max;
    }
    return status;
}

#define FEWEST 5u        /* pairs that can disagree */
#define SWAP_GAIN 0.65   /* an exchange leaves less than this share of what was left */
#define OFF_TIMES 2.5    /* what one pair is off, over what the others leave */
#define OFF_SPREAD 0.2   /* and over the landmarks' spread */
#define APART_SPREAD 0.3 /* what all pairs leave, over their spread */

/* Pairs, as they are fitted. */
typedef struct pairs {
    float from[HOST_LANDMARKS_MAX][3], to[HOST_LANDMARKS_MAX][3];
    uint32_t n;
} pairs;

/* Root mean square distance of points to their centroid. */
static double spread_of(const float (*xyz)[3], uint32_t n)
{
    double sum = 0.0;
    for (int c = 0; c < 3; c++) {
        double mean = 0.0;
        for (uint32_t i = 0; i < n; i++)
            mean += (double)xyz[i][c] / n;
        for (uint32_t i = 0; i < n; i++)
            sum += ((double)xyz[i][c] - mean) * ((double)xyz[i][c] - mean);
    }
    return sqrt(sum / n);
}

/* What the best fit leaves, mm. */
static double left_by(const pairs *p, smr_pose *pose)
{
    float rms = 0.0f;
    return smr_align_landmarks(p->from[0], p->to[0], p->n, 1, pose, &rms) == SMR_OK ? (double)rms : 0.0;
}

static void swap(pairs *p, uint32_t i, uint32_t k)
{
    float keep[3];
    memcpy(keep, p->to[i], sizeof keep);
    memcpy(p->to[i], p->to[k], sizeof keep);
    memcpy(p->to[k], keep, sizeof keep);
}

/* The exchange that helps most. Returns what is left then. */
static double best_swap(pairs *p, host_landmark_doubt *doubt)
{
    double best = HUGE_VAL;
    smr_pose pose;
    for (uint32_t i = 0; i < p->n; i++)
        for (uint32_t k = i + 1u; k < p->n; k++) {
            swap(p, i, k);
            const double left = left_by(p, &pose);
            swap(p, i, k);
            if (left < best) {
                best = left;
                doubt->first = i;
                doubt->second = k;
            }
        }
    return best;
}

/* How far pair i lies from where the fit of the others puts it; *left: what that fit leaves. */
static double off_by(const pairs *p, uint32_t i, double *left)
{
    pairs others = *p;
    smr_pose pose = {0};
    double sum = 0.0;
    others.n = p->n - 1u;
    memcpy(others.from[i], p->from[others.n], sizeof others.from[i]);
    memcpy(others.to[i], p->to[others.n], sizeof others.to[i]);
    *left = left_by(&others, &pose);
    for (int r = 0; r < 3; r++) {
        const double at = (double)pose.m[r][0] * (double)p->from[i][0] + (double)pose.m[r][1] * (double)p->from[i][1] +
                          (double)pose.m[r][2] * (double)p->from[i][2] + (double)pose.m[r][3] - (double)p->to[i][r];
        sum += at * at;
    }
    return sqrt(sum);
}

static void find_outlier(const pairs *p, double spread, host_landmark_doubt *doubt)
{
    double worst = 1.0;
    for (uint32_t i = 0; i < p->n; i++) {
        double left = 0.0;
        const double off = off_by(p, i, &left), over = off / (OFF_TIMES * left + OFF_SPREAD * spread);
        if (over > worst) {
            worst = over;
            doubt->kind = HOST_LANDMARK_OFF;
            doubt->first = i;
            doubt->off_mm = off;
        }
    }
}

host_landmark_doubt host_landmarks_agree(const float *from, const float *to, uint32_t n)
{
    host_landmark_doubt doubt = {HOST_LANDMARKS_AGREE, 0, 0, 0.0, 0.0};
    smr_pose pose;
    pairs p = {0};
    p.n = n < HOST_LANDMARKS_MAX ? n : HOST_LANDMARKS_MAX;
    memcpy(p.from, from, 12u * (size_t)p.n);
    memcpy(p.to, to, 12u * (size_t)p.n);
    const double spread = spread_of(p.to, p.n), before = spread_of(p.from, p.n), left = left_by(&p, &pose);
    doubt.scale = before > 0.0 ? spread / before : 0.0;
    if (p.n < FEWEST || !(left > 0.0))
        return doubt;
    if (left > 0.02 * spread && best_swap(&p, &doubt) < SWAP_GAIN * left) {
        doubt.kind = HOST_LANDMARKS_SWAPPED;
        return doubt;
    }
    find_outlier(&p, spread, &doubt);
    if (doubt.kind == HOST_LANDMARKS_AGREE && left > APART_SPREAD * spread) {
        doubt.kind = HOST_LANDMARKS_APART;
        doubt.off_mm = left;
    }
    return doubt;
}
