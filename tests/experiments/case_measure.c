/* case_measure.c: a case as a directory of files; how far a result is from its truth, and what it said of that.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_read.h"
#include "measure/surface_distances.h"

static const char *const folders[] = {"model", "truth", "whole", "target"};

static host_mesh *mesh_of(case_body *body, int folder)
{
    host_mesh *const all[] = {&body->model, &body->truth, &body->whole, &body->target};
    return all[folder];
}

void case_write(const case_data *data, const char *directory)
{
    case_directory(directory);
    FILE *const names = fopen(case_text("%s/names.txt", directory), "w");
    for (uint32_t i = 0; names != NULL && i < data->n; i++) {
        case_body body = data->body[i];
        for (int k = 0; k < 4; k++) {
            case_directory(case_text("%s/%s", directory, folders[k]));
            if (mesh_of(&body, k)->n_vertices > 0)
                case_save(mesh_of(&body, k), case_text("%s/%s/%s.ply", directory, folders[k], body.name));
        }
        (void)fprintf(names, "%s ", body.name);
        for (uint32_t v = 0; v < body.model.n_vertices; v++)
            (void)fputc(body.seen != NULL && !body.seen[v] ? '0' : '1', names);
        (void)fputc('\n', names);
    }
    if (names == NULL || fclose(names) != 0)
        case_fail(directory);
}

void case_read(case_data *data, const char *directory)
{
    char name[64];
    FILE *const names = fopen(case_text("%s/names.txt", directory), "r");
    while (names != NULL && fscanf(names, "%63s ", name) == 1) {
        case_body *const body = case_add(data, case_text("%s/model/%s.ply", directory, name), HOST_MIRROR_NONE);
        for (int k = 1; k < 4; k++) {
            const char *const path = case_text("%s/%s/%s.ply", directory, folders[k], name);
            FILE *const there = fopen(path, "rb");
            if (there != NULL && fclose(there) == 0)
                *mesh_of(body, k) = case_load(path, HOST_MIRROR_NONE);
        }
        body->seen = case_alloc(body->model.n_vertices, 1);
        for (uint32_t v = 0; v < body->model.n_vertices; v++)
            body->seen[v] = fgetc(names) != '0';
    }
    if (names == NULL || fclose(names) != 0 || data->n == 0)
        case_fail(directory);
}

/* ---- distances */

double case_surface_mean(const host_mesh *from, const host_mesh *to, const unsigned char *use, double *area)
{
    const smr_mesh view = host_mesh_view(to);
    const smr_port one_thread = {0};
    void *memory = NULL;
    host_query query = {.surface = host_surface_make(&view, &memory), .mesh = host_mesh_view(from)};
    host_stats stats;
    if (query.surface == NULL || host_distances(&one_thread, &query, 1) != 0 ||
        host_area_stats(&query, 1, &use, &stats) != 0)
        case_fail("out of memory");
    host_queries_free(&query, 1);
    free(memory);
    if (area != NULL)
        *area = stats.weight;
    return stats.n > 0 ? stats.mean : HUGE_VAL;
}

/* Sums and counts of distances to the true places: of all vertices, and of those that are not seen. */
static void add_vertices(const case_body *body, const host_mesh *result, double sum[2], double count[2], double *worst)
{
    for (uint32_t i = 0; i < body->truth.n_vertices; i++) {
        double p[3], q[3];
        case_get(result, i, p);
        case_get(&body->truth, i, q);
        *worst = fmax(*worst, case_apart(p, q));
        for (int k = 0; k < (body->seen != NULL && !body->seen[i] ? 2 : 1); k++) {
            sum[k] += case_apart(p, q);
            count[k] += 1.0;
        }
    }
}

case_figures case_measure(const case_data *data, const float *const *xyz)
{
    case_figures f = {0};
    double sum[2] = {0.0, 0.0}, count[2] = {0.0, 0.0}, area[2] = {0.0, 0.0};
    for (uint32_t i = 0; i < data->n; i++) {
        const case_body *const body = &data->body[i];
        double a = 0.0;
        host_mesh result = case_copy(&body->model);
        if (xyz != NULL)
            memcpy(result.xyz, xyz[i], 3u * (size_t)result.n_vertices * sizeof *result.xyz);
        const double to = case_surface_mean(&result, &body->whole, NULL, &a);
        f.to += a * to;
        area[0] += a;
        const double from = case_surface_mean(&body->whole, &result, NULL, &a);
        f.from += a * from;
        area[1] += a;
        add_vertices(body, &result, sum, count, &f.worst);
        host_mesh_free(&result);
    }
    f.to /= area[0];
    f.from /= area[1];
    f.surface = fmax(f.to, f.from);
    f.vertex = count[0] > 0.0 ? sum[0] / count[0] : -1.0;
    f.unseen = count[1] > 0.0 ? sum[1] / count[1] : -1.0;
    f.shown = count[0] > count[1] ? (sum[0] - sum[1]) / (count[0] - count[1]) : -1.0;
    return f;
}

/* ---- expected errors */

int case_by_value(const void *a, const void *b)
{
    const case_ranked *const x = a, *const y = b;
    if (x->value != y->value)
        return x->value < y->value ? -1 : 1;
    return (x->at > y->at) - (x->at < y->at);
}

/* Replaces values by their ranks less the mean rank; equal values share theirs. */
static void rank(double *value, size_t n)
{
    case_ranked *const list = case_alloc(n, sizeof *list);
    for (size_t i = 0; i < n; i++)
        list[i] = (case_ranked){value[i], i};
    qsort(list, n, sizeof *list, case_by_value);
    for (size_t i = 0, k = 0; i < n; i = k) {
        while (k < n && list[k].value <= list[i].value)
            k++;
        for (size_t j = i; j < k; j++)
            value[list[j].at] = 0.5 * (double)(i + k - 1u) - 0.5 * ((double)n - 1.0);
    }
    free(list);
}

/* The properties expected_error and expected_across of a result with --vertex-errors, the latter as a sum; 0: there are
 * none. */
static int read_expected(const char *path, uint32_t n, double *value, double *across)
{
    static const char head[] = "property float z\nproperty uchar seen\nproperty float expected_error\n"
                               "property float local_volume\nproperty float expected_across\n"
                               "property float expected_along\n",
                      end[] = "end_header\n";
    host_bytes bytes;
    host_error error = {0};
    char text[512] = "";
    if (host_file_read(path, NULL, &bytes, &error) != 0)
        case_fail(path);
    memcpy(text, bytes.data, bytes.size < sizeof text ? bytes.size : sizeof text - 1u);
    const char *const from = strstr(text, head) != NULL ? strstr(text, end) : NULL;
    for (uint32_t i = 0; from != NULL && i < n; i++) {
        float one[3] = {0.0f};
        memcpy(one, bytes.data + (from - text) + sizeof end - 1u + 29u * (size_t)i + 13u, sizeof one);
        value[i] = (double)one[0];
        *across += (double)one[2];
    }
    host_file_free(&bytes);
    return from != NULL;
}

/* Expected errors against the distances to the true places: rank correlation, mean over mean; and the mean distance to
 * the true surface over its expected value. */
static void tell_expected(const case_data *data, const host_mesh *result, const char *directory, double to_surface)
{
    size_t n = 0;
    double mean[2] = {0.0, 0.0}, across = 0.0, xy = 0.0, xx = 0.0, yy = 0.0;
    for (uint32_t i = 0; i < data->n; i++)
        n += data->body[i].truth.n_vertices;
    double *const expected = case_alloc(n, sizeof *expected), *const error = case_alloc(n, sizeof *error);
    n = 0;
    for (uint32_t i = 0; i < data->n; n += data->body[i++].truth.n_vertices) {
        const char *path = case_text("%s/%s.ply", directory, data->body[i].name);
        if (data->body[i].truth.n_vertices == 0 || !read_expected(path, result[i].n_vertices, expected + n, &across))
            break;
        for (uint32_t v = 0; v < result[i].n_vertices; v++) {
            double p[3], q[3];
            case_get(&result[i], v, p);
            case_get(&data->body[i].truth, v, q);
            error[n + v] = case_apart(p, q);
            mean[0] += expected[n + v];
            mean[1] += error[n + v];
        }
    }
    rank(expected, n);
    rank(error, n);
    for (size_t i = 0; i < n; i++) {
        xy += expected[i] * error[i];
        xx += expected[i] * expected[i];
        yy += error[i] * error[i];
    }
    free(expected);
    free(error);
    if (mean[1] > 0.0 && xx > 0.0 && yy > 0.0)
        (void)printf("spearman %.3f\nratio %.3f\n", xy / sqrt(xx * yy), mean[0] / mean[1]);
    if (across > 0.0)
        (void)printf("across %.3f\n", to_surface * (double)n / across);
}

/* The angle between the first model and its result, degrees. */
static double turned(const host_mesh *model, const host_mesh *result)
{
    double a[9] = {0.0}, rotation[9], singular[3], from[3], to[3], p[3], q[3];
    case_middle(model, from);
    case_middle(result, to);
    for (uint32_t i = 0; i < model->n_vertices; i++) {
        case_get(model, i, p);
        case_get(result, i, q);
        for (int k = 0; k < 9; k++)
            a[k] += (q[k / 3] - to[k / 3]) * (p[k % 3] - from[k % 3]);
    }
    oracle_polar(a, rotation, singular);
    return acos(fmax(-1.0, fmin(1.0, 0.5 * (rotation[0] + rotation[4] + rotation[8] - 1.0)))) * 180.0 / acos(-1.0);
}

void case_tell(const case_data *data, const char *directory)
{
    host_mesh result[CASE_BODIES];
    const float *xyz[CASE_BODIES];
    for (uint32_t i = 0; i < data->n; i++) {
        const char *path = case_text("%s/%s.ply", directory, data->body[i].name);
        result[i] = case_load(path, HOST_MIRROR_NONE);
        xyz[i] = result[i].xyz;
        if (result[i].n_vertices != data->body[i].model.n_vertices)
            case_fail(path);
    }
    const case_figures f = case_measure(data, xyz);
    (void)printf("surface %.4f\nvertex %.4f\nworst %.4f\nunseen %.4f\nshown %.4f\nturned %.1f\n", f.surface, f.vertex,
                 f.worst, f.unseen, f.shown, turned(&data->body[0].model, &result[0]));
    const case_body *const first = &data->body[0];
    if (f.unseen >= 0.0) /* where it is shown */
        (void)printf("to_seen %.4f\n", case_surface_mean(&result[0], &first->whole, first->seen, NULL));
    if (f.unseen >= 0.0 && first->whole.n_vertices == first->truth.n_vertices)
        (void)printf("from_seen %.4f\n", case_surface_mean(&first->whole, &result[0], first->seen, NULL));
    tell_expected(data, result, directory, f.to);
    for (uint32_t i = 0; i < data->n; i++)
        host_mesh_free(&result[i]);
}
