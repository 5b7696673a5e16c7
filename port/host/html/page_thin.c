/* page_thin.c: thins surfaces, and cuts out and averages an image, for a page of bounded size.
 * SPDX-License-Identifier: MIT */
#include "html/page_data.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define BINS 4096
#define CUT 0.001

/* One axis of what is cut out: voxels first to end - 1 of the image become n, each of `step` voxels. */
typedef struct axis {
    uint32_t first, end, n;
    double step;
} axis;

/* The voxels that the box spans, and margin_mm more. 0 when there are none. */
static int span(const host_volume *v, const host_box *box, float margin_mm, axis a[3])
{
    double inverse[9], low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    host_volume_to_index(v, inverse);
    for (int corner = 0; corner < 8; corner++)
        for (int j = 0; j < 3; j++) {
            double at = 0.0;
            for (int c = 0; c < 3; c++) {
                const float p = (corner >> c & 1) != 0 ? box->high[c] + margin_mm : box->low[c] - margin_mm;
                at += inverse[3 * j + c] * ((double)p - (double)v->origin[c]);
            }
            low[j] = at < low[j] ? at : low[j];
            high[j] = at > high[j] ? at : high[j];
        }
    for (int j = 0; j < 3; j++) {
        const double from = floor(low[j]), to = ceil(high[j]) + 1.0, n = v->size[j];
        if (!(to > 0.0 && from < n))
            return 0;
        a[j].first = from > 0.0 ? (uint32_t)from : 0u;
        a[j].end = to < n ? (uint32_t)to : v->size[j];
    }
    return 1;
}

/* The finest spacing, mm, with which there are at most so many voxels. */
static void choose_step(const host_volume *v, size_t most, axis a[3])
{
    double spacing = (double)fminf(v->spacing[0], fminf(v->spacing[1], v->spacing[2]));
    double total = 0.0;
    do {
        total = 1.0;
        for (int j = 0; j < 3; j++) {
            const double own = (double)v->spacing[j], count = (double)(a[j].end - a[j].first);
            a[j].step = spacing > own ? spacing / own : 1.0;
            a[j].n = (uint32_t)fmax(1.0, floor(count / a[j].step));
            total *= a[j].n;
        }
        spacing *= 1.02;
    } while (total > (double)most);
}

/* Voxels of the image that voxel i of the axis covers: first to end - 1; the share of each. */
static double share(const axis *a, uint32_t i, uint32_t at)
{
    const double from = (double)i * a->step, to = from + a->step, k = (double)(at - a->first);
    return fmin(to, k + 1.0) - fmax(from, k);
}

static uint32_t first_of(const axis *a, uint32_t i) { return a->first + (uint32_t)((double)i * a->step); }

static uint32_t end_of(const axis *a, uint32_t i)
{
    const double end = ceil((double)(i + 1u) * a->step - 1e-9) + (double)a->first;
    return end < (double)a->end ? (uint32_t)end : a->end;
}

/* The mean of what a voxel covers; NaN where nothing is finite. */
static float mean_of(const host_volume *v, const axis a[3], const uint32_t at[3])
{
    double sum = 0.0, weight = 0.0;
    for (uint32_t k = first_of(&a[2], at[2]); k < end_of(&a[2], at[2]); k++)
        for (uint32_t j = first_of(&a[1], at[1]); j < end_of(&a[1], at[1]); j++) {
            const double row = share(&a[2], at[2], k) * share(&a[1], at[1], j);
            for (uint32_t i = first_of(&a[0], at[0]); i < end_of(&a[0], at[0]); i++) {
                const size_t at_ijk = ((size_t)k * v->size[1] + j) * v->size[0] + i;
                const double value = host_voxel(v->voxels, v->type, at_ijk), w = row * share(&a[0], at[0], i);
                if (!isfinite(value))
                    continue;
                sum += w * value;
                weight += w;
            }
        }
    return weight > 0.0 ? (float)(sum / weight) : NAN;
}

static void fill(const host_volume *v, const axis a[3], float *out)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < a[2].n; at[2]++)
        for (at[1] = 0; at[1] < a[1].n; at[1]++)
            for (at[0] = 0; at[0] < a[0].n; at[0]++)
                *out++ = mean_of(v, a, at);
}

/* The brightness above a share of all voxels, by counting. */
static double quantile(const float *value, size_t n, double low, double high, double part)
{
    size_t count[BINS], i = 0, seen = 0, all = 0;
    int b = 0;
    memset(count, 0, sizeof count);
    for (i = 0; i < n; i++)
        if (isfinite(value[i])) {
            b = (int)(((double)value[i] - low) / (high - low) * BINS);
            count[b < 0 ? 0 : b < BINS ? b : BINS - 1]++;
            all++;
        }
    for (b = 0; b < BINS - 1; b++) {
        seen += count[b];
        if ((double)seen > part * (double)all)
            break;
    }
    return low + (high - low) * (b + (part > 0.5 ? 1 : 0)) / BINS;
}

/* What 0 and 255 stand for. 8 bits stay what they are. */
static void choose_range(const host_volume *v, const float *value, size_t n, host_page_image *out)
{
    double low = DBL_MAX, high = -DBL_MAX;
    for (size_t i = 0; i < n; i++)
        if (isfinite(value[i])) {
            low = (double)value[i] < low ? (double)value[i] : low;
            high = (double)value[i] > high ? (double)value[i] : high;
        }
    out->low = v->type == SMR_VOXEL_UINT8 ? 0.0 : low;
    out->high = v->type == SMR_VOXEL_UINT8 ? 255.0 : high;
    if (v->type == SMR_VOXEL_UINT8 || !(high > low)) {
        out->high = out->high > out->low ? out->high : out->low + 1.0;
        return;
    }
    out->low = quantile(value, n, low, high, CUT);
    out->high = quantile(value, n, low, high, 1.0 - CUT);
}

static void quantise(const float *value, size_t n, const host_page_image *out)
{
    const double scale = 255.0 / (out->high - out->low);
    for (size_t i = 0; i < n; i++) {
        const double v = ((double)value[i] - out->low) * scale + 0.5;
        out->at[i] = (unsigned char)(v > 0.0 ? v < 255.0 ? v : 255.0 : 0.0); /* NaN is 0 */
    }
}

int host_page_image_make(const host_volume *v, const host_box *box, float margin_mm, size_t most, host_page_image *out)
{
    axis a[3];
    size_t n = 1;
    int j = 0;
    memset(out, 0, sizeof *out);
    if (!span(v, box, margin_mm, a))
        return 0;
    choose_step(v, most, a);
    memcpy(out->first, v->origin, sizeof out->first);
    for (j = 0; j < 3; j++) {
        const double at = (double)a[j].first + 0.5 * (a[j].step - 1.0); /* centre of its first voxel, in voxels */
        out->size[j] = a[j].n;
        out->spacing[j] = (float)(a[j].step * (double)v->spacing[j]);
        for (int c = 0; c < 3; c++)
            out->first[c] += (float)(at * (double)v->spacing[j] * (double)v->direction[3 * c + j]);
        n *= a[j].n;
    }
    float *value = malloc(n * sizeof *value);
    out->at = malloc(n);
    if (value != NULL && out->at != NULL) {
        fill(v, a, value);
        choose_range(v, value, n, out);
        quantise(value, n, out);
    }
    j = value != NULL && out->at != NULL ? 0 : -1;
    free(value);
    return j;
}

#define TRIES 200

typedef struct place {
    uint64_t cube;
    uint32_t vertex;
} place;

static int by_cube(const void *a, const void *b)
{
    const place *const x = a, *const y = b;
    if (x->cube != y->cube)
        return x->cube < y->cube ? -1 : 1;
    return (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

/* The number of a cube, 21 bits an axis. cell_mm 0: each vertex has its own. */
static uint64_t cube_of(const float *xyz, uint32_t vertex, float cell_mm)
{
    uint64_t cube = 0;
    if (!(cell_mm > 0.0f))
        return vertex;
    for (int c = 0; c < 3; c++) {
        const double at = floor((double)xyz[3u * (size_t)vertex + (size_t)c] / (double)cell_mm) + 1048576.0;
        cube = cube << 21 | (at > 0.0 ? at < 2097151.0 ? (uint64_t)at : 2097151u : 0u);
    }
    return cube;
}

/* to[i]: the first vertex in the cube of vertex i. */
static int find_first(const host_mesh *mesh, float cell_mm, uint32_t *to)
{
    place *const list = malloc(((size_t)mesh->n_vertices + 1u) * sizeof *list);
    uint32_t first = 0;
    if (list == NULL)
        return -1;
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        list[i] = (place){cube_of(mesh->xyz, i, cell_mm), i};
    if (cell_mm > 0.0f)
        qsort(list, mesh->n_vertices, sizeof *list, by_cube);
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        if (i == 0 || list[i].cube != list[i - 1u].cube)
            first = list[i].vertex;
        to[list[i].vertex] = first;
    }
    free(list);
    return 0;
}

/* Numbers the kept vertices: number[i] of those that are their cube's first. */
static void keep_first(const host_mesh *mesh, const uint32_t *to, uint32_t *number, host_page_mesh *out)
{
    for (uint32_t i = 0; i < mesh->n_vertices; i++)
        if (to[i] == i) {
            number[i] = out->n_vertices;
            out->keep[out->n_vertices++] = i;
        }
    for (uint32_t i = 0; i < mesh->n_triangles; i++) {
        const uint32_t *const t = mesh->triangles + 3u * (size_t)i;
        const uint32_t a = to[t[0]], b = to[t[1]], c = to[t[2]];
        uint32_t *const put = out->triangles + 3u * (size_t)out->n_triangles;
        if (a == b || b == c || c == a)
            continue;
        put[0] = number[a];
        put[1] = number[b];
        put[2] = number[c];
        out->n_triangles++;
    }
}

int host_page_thin(const host_mesh *mesh, float cell_mm, host_page_mesh *out)
{
    const size_t n = (size_t)mesh->n_vertices + 1u;
    uint32_t *const to = malloc(n * sizeof *to), *const at = malloc(n * sizeof *at);
    int result = -1;
    memset(out, 0, sizeof *out);
    out->keep = malloc(n * sizeof *out->keep);
    out->triangles = malloc((3u * (size_t)mesh->n_triangles + 1u) * sizeof *out->triangles);
    if (to != NULL && at != NULL && out->keep != NULL && out->triangles != NULL && find_first(mesh, cell_mm, to) == 0) {
        keep_first(mesh, to, at, out);
        result = 0;
    }
    free(to);
    free(at);
    return result;
}

void host_page_mesh_free(host_page_mesh *mesh)
{
    free(mesh->keep);
    free(mesh->triangles);
    memset(mesh, 0, sizeof *mesh);
}

/* A side of the smallest cube that is tried, mm: half of a triangle's mean side, or a little of the mesh's extent. */
static float first_cell(const host_mesh *mesh)
{
    host_box box = {0};
    double sum = 0.0;
    host_box_add(&box, mesh->xyz, mesh->n_vertices);
    for (size_t i = 0; i < mesh->n_triangles; i++) {
        const float *const a = mesh->xyz + 3u * (size_t)mesh->triangles[3u * i];
        const float *const b = mesh->xyz + 3u * (size_t)mesh->triangles[3u * i + 1u];
        sum += (double)hypotf(hypotf(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
    }
    float side = 0.0f;
    for (int c = 0; c < 3; c++)
        side = fmaxf(side, box.high[c] - box.low[c]);
    return fmaxf(side / 2000.0f, mesh->n_triangles > 0 ? (float)(0.5 * sum / mesh->n_triangles) : 0.0f);
}

int host_page_thin_all(host_page_part *part, uint32_t n, size_t vertices_most, size_t bytes_most, float *cell_mm)
{
    float first = 1e-3f;
    for (uint32_t i = 0; i < n; i++)
        first = fmaxf(first, first_cell(part[i].mesh));
    *cell_mm = 0.0f;
    for (int attempt = 0; attempt < TRIES; attempt++) {
        size_t vertices = 0, bytes = 0;
        for (uint32_t i = 0; i < n; i++) {
            host_page_mesh *const thin = &part[i].thin;
            host_page_mesh_free(thin);
            if (host_page_thin(part[i].mesh, *cell_mm, thin) != 0)
                return -1;
            vertices += thin->n_vertices;
            bytes += thin->n_vertices * part[i].vertex_bytes;
            bytes += (size_t)thin->n_triangles * (thin->n_vertices > 65536u ? 12u : 6u);
        }
        if (vertices <= vertices_most && bytes <= bytes_most)
            return 0;
        *cell_mm = *cell_mm > 0.0f ? 1.2f * *cell_mm : first;
    }
    return -1;
}

void host_page_parts_free(host_page_part *part, uint32_t n)
{
    for (uint32_t i = 0; part != NULL && i < n; i++)
        host_page_mesh_free(&part[i].thin);
    free(part);
}
