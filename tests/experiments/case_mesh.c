/* case_mesh.c: memory and files; areas, normals, cuts and subdivision of triangle meshes.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include "meshes/triangle_mesh.h"

void case_fail(const char *what)
{
    (void)fprintf(stderr, "case_tool: %s\n", what);
    exit(2);
}

void *case_alloc(size_t n, size_t size)
{
    void *const memory = calloc(n > 0 ? n : 1u, size);
    if (memory == NULL)
        case_fail("out of memory");
    return memory;
}

char *case_text(const char *format, ...)
{
    char *const text = case_alloc(4 * CASE_TEXT, 1);
    va_list list;
    va_start(list, format);
    (void)vsnprintf(text, 4 * CASE_TEXT, format, list);
    va_end(list);
    return text;
}

void case_directory(const char *path)
{
    struct stat found;
    if (mkdir(path, 0700) != 0 && (stat(path, &found) != 0 || !S_ISDIR(found.st_mode)))
        case_fail(path);
}

host_mesh case_load(const char *path, int mirror)
{
    host_mesh mesh;
    host_error error = {0};
    if (host_mesh_read(path, HOST_MESH_POINTS_TOO, mirror, &mesh, &error) != 0) {
        host_error_print(&error);
        exit(2);
    }
    return mesh;
}

void case_save(const host_mesh *mesh, const char *path)
{
    host_buffer buffer = {0};
    FILE *const file = fopen(path, "wb");
    host_mesh_write(mesh, HOST_FORMAT_PLY, &buffer);
    if (file == NULL || buffer.failed || fwrite(buffer.data, 1, buffer.size, file) != buffer.size || fclose(file) != 0)
        case_fail(path);
    host_buffer_free(&buffer);
}

case_body *case_add(case_data *data, const char *path, int mirror)
{
    case_body *const body = &data->body[data->n];
    const char *const slash = strrchr(path, '/'), *const base = slash != NULL ? slash + 1 : path;
    const char *const dot = strrchr(base, '.');
    if (data->n++ >= CASE_BODIES)
        case_fail("too many structures");
    body->model = case_load(path, mirror);
    (void)snprintf(body->name, sizeof body->name, "%.*s", (int)(dot != NULL ? dot - base : 60), base);
    return body;
}

void case_beside(case_data *data, const char *path, int mirror)
{
    host_mesh one = case_load(path, mirror);
    if (host_mesh_append(&data->beside, &one) != 0)
        case_fail("out of memory");
    host_mesh_free(&one);
}

static const float *corner(const host_mesh *mesh, uint32_t triangle, uint32_t k)
{
    return mesh->xyz + 3u * (size_t)mesh->triangles[3u * (size_t)triangle + k];
}

void case_normal(const host_mesh *mesh, uint32_t triangle, double out[3])
{
    const float *const a = corner(mesh, triangle, 0), *const b = corner(mesh, triangle, 1),
                       *const c = corner(mesh, triangle, 2);
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (double)b[i] - (double)a[i];
        v[i] = (double)c[i] - (double)a[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
}

void case_centre(const host_mesh *mesh, uint32_t triangle, double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = ((double)corner(mesh, triangle, 0)[i] + (double)corner(mesh, triangle, 1)[i] +
                  (double)corner(mesh, triangle, 2)[i]) /
                 3.0;
}

double case_area(const host_mesh *mesh)
{
    double sum = 0.0, n[3];
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        case_normal(mesh, t, n);
        sum += 0.5 * case_length(n);
    }
    return sum;
}

double *case_vertex_normals(const host_mesh *mesh)
{
    double *const normal = case_alloc(3u * (size_t)mesh->n_vertices, sizeof *normal);
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double n[3];
        case_normal(mesh, t, n);
        for (uint32_t k = 0; k < 9u; k++)
            normal[3u * (size_t)mesh->triangles[3u * (size_t)t + k / 3u] + k % 3u] += n[k % 3u];
    }
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        double *const n = normal + 3u * (size_t)i, length = case_length(n);
        for (int c = 0; c < 3; c++)
            n[c] = length > 0.0 ? n[c] / length : 0.0;
    }
    return normal;
}

host_mesh case_new_mesh(uint32_t n_vertices, uint32_t n_triangles)
{
    host_mesh mesh = {0};
    mesh.xyz = case_alloc(3u * (size_t)n_vertices, sizeof *mesh.xyz);
    mesh.triangles = case_alloc(3u * (size_t)n_triangles, sizeof *mesh.triangles);
    mesh.n_vertices = n_vertices;
    mesh.n_triangles = n_triangles;
    return mesh;
}

host_mesh case_copy(const host_mesh *mesh)
{
    host_mesh copy = case_new_mesh(mesh->n_vertices, mesh->n_triangles);
    memcpy(copy.xyz, mesh->xyz, 3u * (size_t)mesh->n_vertices * sizeof *copy.xyz);
    memcpy(copy.triangles, mesh->triangles, 3u * (size_t)mesh->n_triangles * sizeof *copy.triangles);
    return copy;
}

void case_cut(host_mesh *mesh, unsigned char *keep)
{
    host_mesh cut = case_new_mesh(mesh->n_vertices, mesh->n_triangles);
    uint32_t *const number = case_alloc(mesh->n_vertices, sizeof *number);
    cut.n_vertices = cut.n_triangles = 0;
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        for (uint32_t k = 0; keep[t] && k < 3u; k++) {
            const uint32_t v = mesh->triangles[3u * (size_t)t + k];
            if (number[v] == 0) {
                memcpy(cut.xyz + 3u * (size_t)cut.n_vertices, mesh->xyz + 3u * (size_t)v, 3u * sizeof *cut.xyz);
                number[v] = ++cut.n_vertices;
            }
            cut.triangles[3u * (size_t)cut.n_triangles + k] = number[v] - 1u;
        }
        cut.n_triangles += keep[t] != 0;
    }
    free(number);
    free(keep);
    host_mesh_free(mesh);
    *mesh = cut;
}

void case_keep_height(host_mesh *mesh, double low, double high)
{
    unsigned char *const keep = case_alloc(mesh->n_triangles, 1);
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        double p[3];
        case_centre(mesh, t, p);
        keep[t] = p[2] >= low && p[2] <= high;
    }
    case_cut(mesh, keep);
}

double case_height(const host_mesh *mesh, double *low)
{
    double high = -HUGE_VAL, p[3];
    *low = HUGE_VAL;
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        case_get(mesh, i, p);
        *low = fmin(*low, p[2]);
        high = fmax(high, p[2]);
    }
    return high - *low;
}

void case_keep_shares(host_mesh *mesh, double from, double to)
{
    double low = 0.0;
    const double height = case_height(mesh, &low);
    case_keep_height(mesh, low + from * height, low + to * height);
}

void case_middle(const host_mesh *mesh, double out[3])
{
    out[0] = out[1] = out[2] = 0.0;
    for (uint32_t i = 0; i < 3u * mesh->n_vertices; i++)
        out[i % 3u] += (double)mesh->xyz[i] / mesh->n_vertices;
}

void case_box(const host_mesh *mesh, double middle[3], double half[3])
{
    for (uint32_t c = 0; c < 3u; c++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (uint32_t i = 0; i < mesh->n_vertices; i++) {
            low = fmin(low, (double)mesh->xyz[3u * (size_t)i + c]);
            high = fmax(high, (double)mesh->xyz[3u * (size_t)i + c]);
        }
        middle[c] = 0.5 * (low + high);
        half[c] = 0.5 * (high - low);
    }
}

void case_apply(host_mesh *mesh, const double m[9], const double about[3], const double to[3])
{
    for (uint32_t i = 0; i < mesh->n_vertices; i++) {
        double d[3], p[3];
        case_get(mesh, i, d);
        for (int c = 0; c < 3; c++)
            d[c] -= about[c];
        for (int c = 0; c < 3; c++)
            p[c] = m[3 * c] * d[0] + m[3 * c + 1] * d[1] + m[3 * c + 2] * d[2] + to[c];
        case_put(mesh, i, p);
    }
}

uint32_t case_number_edges(const host_mesh *mesh, uint32_t *edge)
{
    const smr_mesh view = host_mesh_view(mesh);
    host_half_edges half;
    uint32_t count = 0;
    if (host_half_edges_make(&view, &half) != 0)
        case_fail("out of memory");
    for (size_t v = 0; v < mesh->n_vertices; v++)
        for (size_t i = half.first[v]; i < half.first[v + 1u]; count++)
            for (const size_t end = host_half_edges_end(&half, v, i); i < end; i++)
                edge[half.edge[i].side] = count;
    host_half_edges_free(&half);
    return count;
}

host_mesh case_subdivide(const host_mesh *mesh, oracle_random *r)
{
    uint32_t *const edge = case_alloc(3u * (size_t)mesh->n_triangles, sizeof *edge);
    const uint32_t n = mesh->n_vertices, n_edges = case_number_edges(mesh, edge);
    host_mesh fine = case_new_mesh(n + n_edges, 4u * mesh->n_triangles);
    double p[3], q[3], x[3];
    memcpy(fine.xyz, mesh->xyz, 3u * (size_t)n * sizeof *fine.xyz);
    for (uint32_t i = 0; i < 3u * mesh->n_triangles; i++) {
        const uint32_t a = mesh->triangles[i], b = mesh->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        const double at = r != NULL && a < b ? oracle_uniform(r, 0.25, 0.75) : 0.5;
        case_get(mesh, a, p);
        case_get(mesh, b, q);
        for (int c = 0; c < 3; c++)
            x[c] = (1.0 - at) * p[c] + at * q[c];
        if (a < b || fine.xyz[3u * (size_t)(n + edge[i])] == 0.0f) /* a border has one side */
            case_put(&fine, n + edge[i], x);
    }
    for (uint32_t t = 0; t < mesh->n_triangles; t++) {
        const uint32_t *const v = mesh->triangles + 3u * (size_t)t, *const e = edge + 3u * (size_t)t;
        const uint32_t four[12] = {v[0], n + e[0], n + e[2], v[1],     n + e[1], n + e[0],
                                   v[2], n + e[2], n + e[1], n + e[0], n + e[1], n + e[2]};
        memcpy(fine.triangles + 12u * (size_t)t, four, sizeof four);
        for (uint32_t k = 0; r != NULL && k < 3u; k++) { /* the last triangle of a vertex says where that goes */
            const double one = oracle_uniform(r, 0.05, 0.2), other = oracle_uniform(r, 0.05, 0.2);
            case_get(mesh, v[k], x);
            case_get(&fine, four[3u * k + 1u], p);
            case_get(&fine, four[3u * k + 2u], q);
            for (int c = 0; c < 3; c++)
                x[c] = (1.0 - one - other) * x[c] + one * p[c] + other * q[c];
            case_put(&fine, v[k], x);
        }
    }
    free(edge);
    return fine;
}

void case_axes(const case_data *data, double axes[9])
{
    double mean[3] = {0.0, 0.0, 0.0}, spread[9] = {0.0}, value[3], v[9], p[3], count = 0.0;
    for (uint32_t m = 0; m < data->n; m++)
        for (uint32_t i = 0; i < data->body[m].truth.n_vertices; i++, count += 1.0) {
            case_get(&data->body[m].truth, i, p);
            for (int c = 0; c < 3; c++)
                mean[c] += p[c];
        }
    for (uint32_t m = 0; m < data->n; m++)
        for (uint32_t i = 0; i < data->body[m].truth.n_vertices; i++) {
            case_get(&data->body[m].truth, i, p);
            for (int r = 0; r < 9; r++)
                spread[r] += (p[r / 3] - mean[r / 3] / count) * (p[r % 3] - mean[r % 3] / count);
        }
    oracle_eigen(spread, value, v);
    for (int r = 0; r < 9; r++)
        axes[r] = v[3 * (r % 3) + r / 3];
    for (int c = 0; axes[2] < 0.0 && c < 3; c++) /* the long axis points up */
        axes[c] = -axes[c];
}
