/* landmarks_reader.c: adds landmarks to the set being read; checks labels and positions.
 * SPDX-License-Identifier: MIT */
#include "landmarks/landmarks_reader.h"

#include <string.h>

#include "smr.h"

static int same(const char *a, host_word b) { return strlen(a) == b.n && memcmp(a, b.start, b.n) == 0; }

int host_landmarks_add(host_landmarks *landmarks, host_error *error, uint32_t line, host_word label,
                       const double xyz[3])
{
    const double limit = (double)SMR_COORD_MAX;
    uint32_t i = 0;
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
    uint32_t i = 0;
    if (host_word_is(system, "LPS") || host_word_is(system, "1"))
        return 0;
    if (!host_word_is(system, "RAS") && !host_word_is(system, "0"))
        return host_fail_at(error, "line", line, "coordinate system LPS or RAS, found %.*s",
                            (int)(system.n < 32u ? system.n : 32u), system.start);
    for (i = first; i < landmarks->n; i++) {
        landmarks->xyz[i][0] = 0.0f - landmarks->xyz[i][0];
        landmarks->xyz[i][1] = 0.0f - landmarks->xyz[i][1];
    }
    return 0;
}
