/* align_landmarks.c: the start pose from corresponding landmarks, by least squares (similarity_fit.c). Collinear
 * landmarks, or two, get one of the best-fitting rotations; a single landmark, or coincident ones, get the identity.
 * Bounds: two passes over at most SMR_LANDMARKS_MAX pairs.
 * SPDX-License-Identifier: MIT */
#include "geometry/rotation/similarity_fit.h"

smr_status smr_align_landmarks(const float *from, const float *to, uint32_t n, uint32_t scaled, smr_pose *pose,
                               float *rms_mm)
{
    smr_fit fit;
    float sum = 0.0f;
    if (from == NULL || to == NULL || pose == NULL)
        return SMR_E_NULL;
    if (n == 0u || n > SMR_LANDMARKS_MAX || scaled > 1u || !smr_all_within(from, 3u * (size_t)n, SMR_COORD_MAX) ||
        !smr_all_within(to, 3u * (size_t)n, SMR_COORD_MAX))
        return SMR_E_INPUT;
    smr_fit_start(&fit, smr_load(from), smr_load(to));
    for (size_t i = 0; i < n; i++)
        smr_fit_add(&fit, smr_load(from + 3u * i), smr_load(to + 3u * i), 1.0f);
    const smr_pose found = smr_fit_solve(&fit, scaled != 0u);
    for (size_t i = 0; i < n; i++) {
        const smr_vec error = smr_sub(smr_pose_apply(&found, smr_load(from + 3u * i)), smr_load(to + 3u * i));
        sum += smr_dot(error, error);
    }
    *pose = found;
    if (rms_mm != NULL)
        *rms_mm = SMR_SQRT(sum / (float)n);
    return SMR_OK;
}
