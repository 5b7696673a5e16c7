/* case_marks.c: landmarks and points of single experiments: landmarks that are off or spread over surfaces; a surface
 * that is displaced from its image; points under surfaces.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include "fixture_thigh.h"
#include "volumes/voxel_volume.h"

void case_write_marks(const host_landmarks *marks, const char *path)
{
    FILE *const file = fopen(path, "w");
    for (uint32_t i = 0; file != NULL && i < marks->n; i++)
        (void)fprintf(file, "\"%s\",%.9g,%.9g,%.9g\n", marks->label[i], (double)marks->xyz[i][0],
                      (double)marks->xyz[i][1], (double)marks->xyz[i][2]);
    if (file == NULL || fclose(file) != 0)
        case_fail(path);
}

void case_read_marks(const char *path, host_landmarks *marks)
{
    host_error error = {0};
    if (host_landmarks_read(path, marks, &error) != 0)
        case_fail(path);
}

/* FILE MM SEED OUT.csv: each landmark moved by up to MM along each axis; seed 0: as they are. */
void case_click(char **word)
{
    host_landmarks *const set = case_alloc(1, sizeof *set);
    const double mm = atof(word[1]);
    oracle_random r = oracle_seed(1000u + (uint32_t)atoi(word[2]));
    case_read_marks(word[0], set);
    for (uint32_t i = 0; atoi(word[2]) > 0 && i < 3u * set->n; i++)
        set->xyz[i / 3u][i % 3u] += (float)oracle_uniform(&r, -mm, mm);
    case_write_marks(set, word[3]);
}

/* Middles of triangles, spread over the true surfaces: each is the one farthest from those before. Writes where they
 * are in the model, and where they belong, with noise. hidden: only triangles that the target does not show. */
static void spread(const case_data *data, uint32_t n, double noise_mm, oracle_random *r, int hidden, char *const *path)
{
    host_landmarks *const set = case_alloc(2, sizeof *set);
    double last[3] = {0.0, 0.0, 0.0}, p[3];
    double *least[CASE_BODIES];
    for (uint32_t b = 0; b < data->n; b++)
        least[b] = case_alloc(data->body[b].truth.n_triangles, sizeof **least);
    for (uint32_t k = 0; k <= n; k++) { /* the first one only begins */
        uint32_t body = 0, triangle = 0;
        double best = -1.0;
        for (uint32_t b = 0; b < data->n; b++)
            for (uint32_t t = 0; t < data->body[b].truth.n_triangles; t++) {
                const uint32_t *const v = data->body[b].truth.triangles + 3u * (size_t)t;
                const unsigned char *const seen = data->body[b].seen;
                if (hidden && (seen[v[0]] || seen[v[1]] || seen[v[2]]))
                    continue;
                case_centre(&data->body[b].truth, t, p);
                least[b][t] = k == 0 ? 1e9 : fmin(least[b][t], case_apart(p, last));
                if (least[b][t] > best) {
                    best = least[b][t];
                    body = b;
                    triangle = t;
                }
            }
        case_centre(&data->body[body].truth, triangle, last);
        case_centre(&data->body[body].model, triangle, p);
        for (uint32_t s = 0; k > 0 && s < 2u; s++) {
            for (int c = 0; c < 3; c++)
                set[s].xyz[k - 1u][c] = (float)(s == 0 ? p[c] : last[c] + noise_mm * case_random_normal(r));
            (void)snprintf(set[s].label[k - 1u], sizeof set[s].label[0], "s%u", k);
            set[s].n = k;
        }
        if (k == 0)
            for (uint32_t b = 0; b < data->n; b++)
                for (uint32_t t = 0; t < data->body[b].truth.n_triangles; t++)
                    least[b][t] = 1e9;
    }
    case_write_marks(&set[0], path[0]);
    case_write_marks(&set[1], path[1]);
}

/* DIR N NOISE SEED HIDDEN FROM.csv TO.csv: landmarks of a case. */
void case_spread(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    oracle_random r = oracle_seed(100u + (uint32_t)atoi(word[3]));
    case_read(data, word[0]);
    spread(data, (uint32_t)atoi(word[1]), atof(word[2]), &r, atoi(word[4]), word + 5);
}

/* FILE IMAGE SEED DIR: a case whose model is the surface 15 mm, 8 degrees and a deformation of at most 5 mm off; seen
 * is what lies in the image. The 64 landmarks DIR/from.csv and to.csv put the surface there. */
void case_displaced(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_options o = case_defaults();
    host_volume image;
    host_error error = {0};
    if (host_volume_read(word[1], &image, &error) != 0)
        case_fail(word[1]);
    case_body *const body = case_add(data, word[0], HOST_MIRROR_NONE);
    body->truth = case_copy(&body->model);
    body->whole = case_copy(&body->model);
    body->seen = case_alloc(body->model.n_vertices, 1);
    for (uint32_t i = 0; i < body->model.n_vertices; i++) {
        body->seen[i] = 1;
        for (uint32_t c = 0; c < 3u; c++) { /* the box of voxel centres; the image's axes are the patient's */
            const float at = (body->truth.xyz[3u * (size_t)i + c] - image.origin[c]) / image.spacing[c];
            body->seen[i] = (unsigned char)(body->seen[i] && at >= 0.0f && at <= (float)(image.size[c] - 1u));
        }
    }
    o.seed = (uint32_t)atoi(word[2]);
    o.shift_mm = 15.0;
    o.sigma_mm = 60.0;
    case_displace(data, &o);
    case_write(data, word[3]);
    char *const path[2] = {case_text("%s/to.csv", word[3]), case_text("%s/from.csv", word[3])};
    oracle_random r = oracle_seed(1);
    spread(data, 64, 0.0, &r, 0, path);
}

/* DEPTH OUT TRUTH FILE...: points DEPTH mm under every fifth vertex of the computed thigh's surfaces, and where the
 * patient of seed 1 has them. */
void case_depths(char **word)
{
    host_mesh points = {0};
    fixture_pose pose;
    for (int i = 3; word[i] != NULL; i++) {
        host_mesh mesh = case_load(word[i], HOST_MIRROR_NONE);
        double *const normal = case_vertex_normals(&mesh), p[3];
        uint32_t k = 0;
        for (uint32_t v = 0; v < mesh.n_vertices; v += 5u, k++) {
            case_get(&mesh, v, p);
            for (int c = 0; c < 3; c++)
                p[c] -= atof(word[0]) * normal[3u * (size_t)v + (uint32_t)c];
            case_put(&mesh, k, p);
        }
        mesh.n_vertices = k;
        mesh.n_triangles = 0;
        if (host_mesh_append(&points, &mesh) != 0)
            case_fail("out of memory");
        host_mesh_free(&mesh);
        free(normal);
    }
    case_save(&points, word[1]);
    fixture_thigh_pose(1, &pose);
    fixture_thigh_truth(&pose, points.xyz, points.n_vertices, points.xyz);
    case_save(&points, word[2]);
}
