/* landmarks_file.c: reads a landmark file of any format, and pairs two sets by label.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "files/file_names.h"
#include "files/file_read.h"
#include "landmarks/landmarks_reader.h"

#define FILE_BYTES_MAX ((size_t)4u << 20) /* 64 landmarks take a few kilobytes */

/* Refuses files that are too large or binary before they are read whole. */
static int accept_small(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    (void)path;
    if (total > FILE_BYTES_MAX || memchr(head, '\0', n) != NULL)
        return host_fail(error, "content", "a small text file: Slicer .mrk.json or .fcsv, or CSV label,x,y,z");
    return 0;
}

int host_landmarks_read(const char *path, host_landmarks *landmarks, host_error *error)
{
    host_bytes bytes;
    host_text text;
    host_word word;
    const char *data = NULL;
    size_t n = 0;
    int result = 0;
    memset(landmarks, 0, sizeof *landmarks);
    if (host_file_read(path, accept_small, &bytes, error) != 0)
        return -1;
    data = (const char *)bytes.data;
    n = bytes.size;
    if (n >= 3u && memcmp(data, "\xef\xbb\xbf", 3) == 0) { /* the UTF-8 byte order mark */
        data += 3;
        n -= 3u;
    }
    text = host_text_over(data, n);
    if (host_text_word(&text, &word) && word.start[0] == '{')
        result = host_read_markups(landmarks, data, n, error);
    else
        result = host_read_landmark_table(landmarks, data, n, host_has_extension(path, ".fcsv"), error);
    if (result == 0 && landmarks->n == 0)
        result = host_fail(error, "landmarks", "at least one landmark (Slicer .mrk.json or .fcsv, or CSV label,x,y,z)");
    host_file_free(&bytes);
    if (result != 0)
        memset(landmarks, 0, sizeof *landmarks);
    return result;
}

/* Index of a label, n when it is missing. */
static uint32_t find(const host_landmarks *landmarks, const char *label)
{
    uint32_t i = 0;
    while (i < landmarks->n && strcmp(landmarks->label[i], label) != 0)
        i++;
    return i;
}

/* Checks that b has every label of a. */
static int all_in(const host_landmarks *a, const host_landmarks *b, const char *a_path, const char *b_path,
                  host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < a->n; i++)
        if (find(b, a->label[i]) == b->n) {
            error->file = b_path;
            return host_fail(error, "landmarks", "one labelled \"%s\" as in %s", a->label[i], a_path);
        }
    return 0;
}

int host_landmarks_pair(const host_landmarks *model, const host_landmarks *target, const char *model_path,
                        const char *target_path, float from[HOST_LANDMARKS_MAX][3], float to[HOST_LANDMARKS_MAX][3],
                        uint32_t *n, host_error *error)
{
    uint32_t i = 0;
    *n = 0;
    if (all_in(model, target, model_path, target_path, error) != 0 ||
        all_in(target, model, target_path, model_path, error) != 0)
        return -1;
    for (i = 0; i < model->n; i++) {
        memcpy(from[i], model->xyz[i], sizeof from[i]);
        memcpy(to[i], target->xyz[find(target, model->label[i])], sizeof to[i]);
    }
    *n = model->n;
    return 0;
}
