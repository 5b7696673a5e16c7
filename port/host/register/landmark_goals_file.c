/* landmark_goals_file.c: the landmarks of --landmark-goals.
 * SPDX-License-Identifier: MIT */
#include "register/landmark_goals_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int host_landmark_pairs_read(const host_options *options, const host_files *files, host_landmarks *set,
                             float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3], uint32_t *n,
                             host_error *error)
{
    host_landmarks *const both = calloc(2, sizeof *both);
    uint32_t i = 0;
    int result = 0;
    if (both == NULL)
        return host_fail(error, "start", "free memory");
    for (i = 0; result == 0 && i < 2; i++)
        result = host_landmarks_read(files->path[i], &both[i], error);
    if (result == 0)
        result = host_landmarks_pair(&both[0], &both[1], files->path[0], files->path[1], from, to, n, error);
    for (i = 0; result == 0 && i < *n; i++) {
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
    host_landmark_goals *const goals = calloc(1, sizeof *goals);
    uint32_t n = 0;
    error->file = "--landmark-goals";
    if (goals == NULL) {
        (void)host_fail(error, "start", "free memory");
        return NULL;
    }
    if (host_landmark_pairs_read(options, &options->landmark_goals, &goals->set, goals->from, goals->to, &n, error) ==
        0)
        return goals;
    free(goals);
    return NULL;
}

smr_status host_landmark_goals_set(const host_landmark_goals *goals, float weight, smr *s)
{
    smr_landmark landmark[HOST_LANDMARKS_MAX];
    uint32_t i = 0;
    memset(landmark, 0, sizeof landmark);
    for (i = 0; i < goals->set.n; i++) {
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
    uint32_t i = 0;
    goals->mean = goals->max = 0.0;
    for (i = 0; status == SMR_OK && i < goals->set.n; i++) {
        const double x = (double)xyz[i][0] - (double)goals->to[i][0], y = (double)xyz[i][1] - (double)goals->to[i][1],
                     z = (double)xyz[i][2] - (double)goals->to[i][2];
        goals->residual[i] = sqrt(x * x + y * y + z * z);
        goals->mean += goals->residual[i] / goals->set.n;
        goals->max = goals->residual[i] > goals->max ? goals->residual[i] : goals->max;
    }
    return status;
}
