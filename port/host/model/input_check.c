/* input_check.c: looks at the orientation, size and place of inputs.
 * SPDX-License-Identifier: MIT */
#include "model/model_from_files.h"
#include <math.h>
#include <stdlib.h>

#define TARGET_RATIO_MAX 100.0
#define MODEL_LEAST 5.0       /* mm: a smaller model is likely to be in metres or centimetres */
#define IMAGE_RATIO_MAX 500.0 /* a small bone in an image of the whole head: above 100 */

/* Six times the volume below the triangle, seen from the origin o, mm^3. */
static double six_volumes(const host_mesh *mesh, const uint32_t *corner, const float *o)
{
    double v[3][3];
    for (size_t i = 0; i < 3; i++)
        for (size_t k = 0; k < 3; k++)
            v[i][k] = (double)mesh->xyz[3u * corner[i] + k] - (double)o[k];
    return v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) + v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
           v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
}

double host_enclosed_volume(const host_mesh *mesh)
{
    double sum = 0.0;
    for (size_t i = 0; i < mesh->n_triangles; i++)
        sum += six_volumes(mesh, mesh->triangles + 3u * i, mesh->xyz);
    return sum / 6.0;
}

static int by_value(const void *a, const void *b)
{
    const uint64_t *const x = a, *const y = b;
    return (*x > *y) - (*x < *y);
}

/* 1 when every edge is passed as often in one direction as in the other. */
static int is_closed(const host_mesh *mesh)
{
    const size_t n = 3u * (size_t)mesh->n_triangles;
    uint64_t *const edge = malloc((n + 1u) * sizeof *edge); /* lower vertex, higher vertex, direction */
    long balance = 0;
    size_t i = 0;
    if (edge == NULL)
        return 0;
    for (i = 0; i < n; i++) {
        const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        edge[i] = a < b ? (uint64_t)a << 33 | (uint64_t)b << 1 : (uint64_t)b << 33 | (uint64_t)a << 1 | 1u;
    }
    qsort(edge, n, sizeof *edge, by_value);
    for (i = 0; i < n; i++) {
        if (i > 0 && edge[i] >> 1 != edge[i - 1u] >> 1 && balance != 0)
            break;
        balance += (edge[i] & 1u) != 0 ? 1 : -1;
    }
    free(edge);
    return i == n && balance == 0;
}

void host_box_add(host_box *box, const float *xyz, size_t n)
{
    for (size_t i = 0; i < n; i++, box->count++)
        for (size_t k = 0; k < 3; k++) {
            const float x = xyz[3u * i + k];
            box->low[k] = box->count == 0 || x < box->low[k] ? x : box->low[k];
            box->high[k] = box->count == 0 || x > box->high[k] ? x : box->high[k];
        }
}

void host_box_add_volume(host_box *box, const smr_volume *volume)
{
    for (uint32_t corner = 0; corner < 8u; corner++) {
        float at[3];
        for (uint32_t k = 0; k < 3; k++) {
            at[k] = volume->origin[k];
            for (uint32_t i = 0; i < 3; i++)
                if ((corner >> i & 1u) != 0)
                    at[k] += volume->direction[3u * k + i] * volume->spacing[i] * (float)(volume->size[i] - 1u);
        }
        host_box_add(box, at, 1);
    }
}

static double diagonal(const host_box *box)
{
    double sum = 0.0;
    for (size_t k = 0; k < 3; k++)
        sum += ((double)box->high[k] - (double)box->low[k]) * ((double)box->high[k] - (double)box->low[k]);
    return sqrt(sum);
}

int host_is_inside_out(const host_mesh *mesh)
{
    const double volume = mesh->n_triangles > 0 ? host_enclosed_volume(mesh) : 0.0;
    host_box box = {0};
    host_box_add(&box, mesh->xyz, mesh->n_vertices);
    double size = diagonal(&box);
    /* below that, a flat surface's rounding */
    return volume < -1e-6 * size * size * size && is_closed(mesh);
}

void host_warn_inside_out(const char *path, const host_mesh *mesh)
{
    host_error error = {0};
    if (!host_is_inside_out(mesh))
        return;
    error.file = path;
    (void)host_fail(&error, "faces",
                    "normals that point outwards, but this closed surface is inside out (volume %.4g mm^3): reverse "
                    "the order of each face's vertices",
                    host_enclosed_volume(mesh));
    host_error_print(&error);
}

static double model_diagonal(const host_model *model)
{
    host_box box = {0};
    for (uint32_t i = 0; i < model->n_parts; i++)
        host_box_add(&box, model->part[i].mesh.xyz, model->part[i].mesh.n_vertices);
    return diagonal(&box);
}

void host_warn_small(const char *path, const host_model *model)
{
    const double a = model_diagonal(model);
    host_error error = {0};
    if (!(a > 0.0 && a < MODEL_LEAST))
        return;
    error.file = path;
    (void)host_fail(&error, "size", "millimetres, but the model's diagonal is only %.3g mm: is it in metres?", a);
    host_error_print(&error);
}

double host_size_ratio(const host_model *model, const host_box *target)
{
    const double a = model_diagonal(model);
    return a > 0.0 ? diagonal(target) / a : 0.0;
}

static int check_sizes(const host_model *model, const host_box *other, double limit, host_error *error)
{
    const double a = model_diagonal(model), b = diagonal(other);
    if (!(a > 0.0 && b > 0.0) || (a <= limit * b && b <= limit * a))
        return 0;
    return host_fail(
        error, "size",
        "about the model's size of %.4g mm, found %.4g mm, a ratio of %.4g: is one of them in metres or micrometres?",
        a, b, b / a);
}

int host_check_target_size(const host_model *model, const host_box *target, host_error *error)
{
    return check_sizes(model, target, TARGET_RATIO_MAX, error);
}

int host_check_image_size(const host_model *model, const smr_volume *image, host_error *error)
{
    host_box box = {0};
    host_box_add_volume(&box, image);
    return check_sizes(model, &box, IMAGE_RATIO_MAX, error);
}

static int lies_in(const smr_volume *volume, const float *xyz)
{
    for (size_t i = 0; i < 3; i++) {
        double at = 0.0;
        for (size_t k = 0; k < 3; k++)
            at += (double)volume->direction[3u * k + i] * ((double)xyz[k] - (double)volume->origin[k]);
        at /= (double)volume->spacing[i];
        if (!(at >= -0.5 && at <= (double)volume->size[i] - 0.5))
            return 0;
    }
    return 1;
}

double host_share_covered(const host_model *model, const smr_volume *image)
{
    size_t n = 0, covered = 0;
    for (uint32_t i = 0; i < model->n_parts; i++) {
        const host_mesh *const mesh = &model->part[i].mesh;
        for (uint32_t k = 0; k < mesh->n_vertices; k++, n++)
            covered += (size_t)lies_in(image, mesh->xyz + 3u * (size_t)k);
    }
    return n > 0 ? (double)covered / (double)n : 0.0;
}
