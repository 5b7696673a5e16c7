/* case_expected.c: reads expected errors from a result's PLY and compares them with the true ones.
 * SPDX-License-Identifier: MIT */
#include "case_expected.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "files/file_read.h"
#include "measure/surface_distances.h"

typedef struct ranked {
    double value;
    size_t at;
} ranked;

static int by_value(const void *a, const void *b)
{
    const ranked *const x = a, *const y = b;
    if (x->value != y->value)
        return x->value < y->value ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

static double *ranks_of(const double *value, size_t n)
{
    ranked *const list = case_alloc(n, sizeof *list);
    double *const rank = case_alloc(n, sizeof *rank);
    size_t i = 0, k = 0;
    for (i = 0; i < n; i++) {
        list[i].value = value[i];
        list[i].at = i;
    }
    qsort(list, n, sizeof *list, by_value);
    for (i = 0; i < n; i = k) {
        for (k = i; k < n && list[k].value <= list[i].value; k++)
            ;
        for (size_t j = i; j < k; j++)
            rank[list[j].at] = 0.5 * (double)(i + k - 1u);
    }
    free(list);
    return rank;
}

double case_spearman(const double *a, const double *b, size_t n)
{
    double *const x = ranks_of(a, n), *const y = ranks_of(b, n);
    const double mean = 0.5 * ((double)n - 1.0);
    double xy = 0.0, xx = 0.0, yy = 0.0;
    size_t i = 0;
    for (i = 0; i < n; i++) {
        xy += (x[i] - mean) * (y[i] - mean);
        xx += (x[i] - mean) * (x[i] - mean);
        yy += (y[i] - mean) * (y[i] - mean);
    }
    free(x);
    free(y);
    return xx > 0.0 && yy > 0.0 ? xy / sqrt(xx * yy) : (double)NAN;
}

/* Bytes of a PLY type. */
static size_t bytes_of(const char *type)
{
    if (strstr(type, "64") != NULL || strcmp(type, "double") == 0)
        return 8;
    if (strstr(type, "int8") != NULL || strstr(type, "char") != NULL)
        return 1;
    return strstr(type, "16") != NULL || strstr(type, "short") != NULL ? 2u : 4u;
}

/* Offsets in a vertex of a binary PLY of floats. 0 when the property is not there. */
static int find_property(const char *head, const char *name, size_t *at, size_t *stride)
{
    const char *line = strstr(head, "element vertex");
    int found = 0;
    *stride = 0;
    while (line != NULL && (line = strchr(line, '\n')) != NULL) {
        char type[32], of[64];
        line++;
        if (sscanf(line, "property %31s %63s", type, of) != 2)
            return found;
        if (strcmp(of, name) == 0) {
            *at = *stride;
            found = bytes_of(type) == 4u;
        }
        *stride += bytes_of(type);
    }
    return 0;
}

/* The property of the first n vertices. */
static int read_property(const char *path, const char *name, uint32_t n, double *value)
{
    static const char end[] = "end_header\n";
    char head[4096];
    const char *behind = NULL;
    host_bytes bytes;
    host_error error;
    size_t at = 0, stride = 0, size = 0, from = 0;
    uint32_t i = 0;
    memset(&error, 0, sizeof error);
    if (host_file_read(path, NULL, &bytes, &error) != 0)
        return 0;
    size = bytes.size < sizeof head - 1u ? bytes.size : sizeof head - 1u;
    memcpy(head, bytes.data, size);
    head[size] = '\0';
    for (behind = head; behind < head + size && strncmp(behind, end, strlen(end)) != 0; behind++)
        ;
    from = (size_t)(behind - head) + strlen(end);
    if (!find_property(head, name, &at, &stride) || from + n * stride > bytes.size)
        n = 0;
    for (i = 0; i < n; i++) {
        float one = 0.0f;
        memcpy(&one, bytes.data + from + i * stride + at, sizeof one);
        value[i] = (double)one;
    }
    host_file_free(&bytes);
    return n > 0;
}

/* Distances of a result's vertices: to their true places, and to the true surface. */
static void true_errors(const case_body *body, const host_mesh *result, double *place, double *surface)
{
    const smr_mesh view = host_mesh_view(&body->whole);
    void *memory = NULL;
    const smr_surface *const whole = host_surface_make(&view, &memory);
    uint32_t i = 0;
    int c = 0;
    for (i = 0; i < result->n_vertices; i++) {
        smr_closest hit;
        double d = 0.0;
        for (c = 0; body->truth.n_vertices > 0 && c < 3; c++) {
            const double x =
                (double)result->xyz[3u * (size_t)i + (size_t)c] - (double)body->truth.xyz[3u * (size_t)i + (size_t)c];
            d += x * x;
        }
        place[i] = sqrt(d);
        surface[i] = whole != NULL && smr_surface_closest(whole, result->xyz + 3u * (size_t)i, NULL, -2.0f,
                                                          4.0f * SMR_COORD_MAX, &hit) == SMR_OK
                         ? (double)hit.distance
                         : 0.0;
    }
    free(memory);
}

/* 1 when all bodies' expected errors could be read; arrays for all vertices. */
static int gather(const case_data *data, const char *directory, double *told, double *place, double *surface)
{
    uint32_t i = 0;
    size_t n = 0;
    int good = 1;
    for (i = 0; good && i < data->n; i++) {
        host_mesh result;
        host_error error;
        char path[CASE_TEXT];
        memset(&error, 0, sizeof error);
        (void)snprintf(path, sizeof path, "%.900s/%.64s.ply", directory, data->body[i].name);
        good = read_property(path, "expected_error", data->body[i].model.n_vertices, told + n) &&
               host_mesh_read(path, HOST_MESH_POINTS_TOO, HOST_MIRROR_NONE, &result, &error) == 0;
        if (!good)
            break;
        true_errors(&data->body[i], &result, place + n, surface + n);
        n += result.n_vertices;
        host_mesh_free(&result);
    }
    return good;
}

static double ratio(const double *a, const double *b, size_t n)
{
    double x = 0.0, y = 0.0;
    size_t i = 0;
    for (i = 0; i < n; i++) {
        x += a[i];
        y += b[i];
    }
    return y > 0.0 ? x / y : (double)NAN;
}

case_told case_tell(const case_data *data, const char *directory)
{
    case_told told = {{(double)NAN, (double)NAN}, {(double)NAN, (double)NAN}};
    double *list[3];
    size_t n = 0;
    uint32_t i = 0;
    int k = 0;
    for (i = 0; i < data->n; i++)
        n += data->body[i].model.n_vertices;
    for (k = 0; k < 3; k++)
        list[k] = case_alloc(n, sizeof *list[k]);
    if (gather(data, directory, list[0], list[1], list[2]))
        for (k = data->body[0].truth.n_vertices > 0 ? 0 : 1; k < 2; k++) {
            told.spearman[k] = case_spearman(list[0], list[k + 1], n);
            told.ratio[k] = ratio(list[0], list[k + 1], n);
        }
    for (k = 0; k < 3; k++)
        free(list[k]);
    return told;
}
