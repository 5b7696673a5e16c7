/* landmarks_reader.c: adds landmarks to the set being read; checks labels and positions.
 * SPDX-License-Identifier: MIT */
#include "landmarks/landmarks_reader.h"

#include <string.h>

#include "landmarks/points_file.h"
#include "smr.h"

static int same(const char *a, host_word b) { return strlen(a) == b.n && memcmp(a, b.start, b.n) == 0; }

/* A point of a set of any number: the label may be empty or known. */
static int add_point(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label, const double xyz[3])
{
    const double limit = (double)SMR_COORD_MAX;
    float at[3];
    uint32_t i = 0;
    if (label.n >= HOST_LABEL_BYTES || (label.n > 0 && memchr(label.start, '\0', label.n) != NULL))
        return host_fail_at(error, "line", line, "a label of at most %u bytes, without NUL", HOST_LABEL_BYTES - 1u);
    for (i = 0; i < 3; i++) {
        if (!(xyz[i] >= -limit && xyz[i] <= limit)) /* written so that NaN fails */
            return host_fail_at(error, "line", line, "finite coordinates within +-%.0f mm, found %g", limit, xyz[i]);
        at[i] = (float)xyz[i];
    }
    landmarks->n++;
    return host_points_add(landmarks->points, label.start, label.n, at) == 0
               ? 0
               : host_fail_at(error, "line", line, "at most %u points, and free memory", SMR_VERTICES_MAX);
}

int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3])
{
    const double limit = (double)SMR_COORD_MAX;
    uint32_t i = 0;
    if (landmarks->points != NULL)
        return add_point(landmarks, error, line, label, xyz);
    if (landmarks->n == HOST_LANDMARKS_MAX)
        return host_fail_at(error, "line", line, "at most %u landmarks", HOST_LANDMARKS_MAX);
    if (label.n == 0)
        return host_fail_at(error, "line", line, "a landmark with a label");
    if (label.n >= HOST_LABEL_BYTES)
        return host_fail_at(error, "line", line, "a label of at most %u bytes, found %zu", HOST_LABEL_BYTES - 1u,
                            label.n);
    if (memchr(label.start, '\0', label.n) != NULL)
        return host_fail_at(error, "line", line, "a label without NUL");
    for (i = 0; i < landmarks->n; i++)
        if (same(landmarks->label[i], label))
            return host_fail_at(error, "line", line, "each label once, found a second \"%s\"", landmarks->label[i]);
    for (i = 0; i < 3; i++) {
        if (!(xyz[i] >= -limit && xyz[i] <= limit)) /* written so that NaN fails */
            return host_fail_at(error, "line", line, "finite coordinates within +-%.0f mm, found %g", limit, xyz[i]);
        landmarks->xyz[landmarks->n][i] = (float)xyz[i];
    }
    memcpy(landmarks->label[landmarks->n], label.start, label.n);
    landmarks->label[landmarks->n][label.n] = '\0';
    landmarks->n++;
    return 0;
}

int host_landmarks_to_lps(host_landmarks *landmarks, host_error *error, uint32_t line, host_word system, uint32_t first)
{
    float(*const xyz)[3] = landmarks->points != NULL ? landmarks->points->xyz : landmarks->xyz;
    uint32_t i = 0, k = 0;
    if (host_word_is(system, "LPS") || host_word_is(system, "1"))
        return 0;
    if (!host_word_is(system, "RAS") && !host_word_is(system, "0"))
        return host_fail_at(error, "line", line, "coordinate system LPS or RAS, found %.*s",
                            (int)(system.n < 32u ? system.n : 32u), system.start);
    for (i = first; i < landmarks->n; i++) {
        xyz[i][0] = 0.0f - xyz[i][0];
        xyz[i][1] = 0.0f - xyz[i][1];
        for (k = 0; landmarks->points != NULL && landmarks->points->orientation != NULL && k < 6u; k++)
            landmarks->points->orientation[i][k] = 0.0f - landmarks->points->orientation[i][k];
    }
    return 0;
}
