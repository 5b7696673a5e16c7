/* test_fixture_thigh.c: the computed thigh: closed surfaces without folds that touch each other, a deformation with
 * its inverse, landmarks on their structures, an image of the same anatomy, and the same bits every time.
 * SPDX-License-Identifier: MIT */
#include "../suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "fixture_thigh.h"

#define TEST_SEEDS 8u
#define TEST_EDGES (3u * FIXTURE_THIGH_TRIANGLES)
/* Of one slice of the patient with seed 1; the same with every compiler and processor. */
#define TEST_SLICE_HASH 0x2e128bd0u
#define TEST_MESH_HASH 0x37a89519u

static fixture_thigh thigh;
static fixture_mesh mesh[FIXTURE_THIGH_PARTS];
static float scratch[FIXTURE_THIGH_SCRATCH];

static int set_up(void **state)
{
    (void)state;
    fixture_thigh_init(&thigh);
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
        mesh[i].max_vertices = FIXTURE_THIGH_VERTICES;
        mesh[i].max_triangles = FIXTURE_THIGH_TRIANGLES;
        mesh[i].xyz = malloc(3u * FIXTURE_THIGH_VERTICES * sizeof(float));
        mesh[i].triangles = malloc(3u * FIXTURE_THIGH_TRIANGLES * sizeof(uint32_t));
        if (mesh[i].xyz == NULL || mesh[i].triangles == NULL || !fixture_thigh_mesh(&thigh, i, 1.0f, &mesh[i], scratch))
            return -1;
    }
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
        free(mesh[i].xyz);
        free(mesh[i].triangles);
    }
    return 0;
}

typedef struct edge {
    uint64_t ends; /* from << 32 | to */
    uint32_t triangle;
} edge;

static int compare_edges(const void *a, const void *b)
{
    const uint64_t x = ((const edge *)a)->ends, y = ((const edge *)b)->ends;
    return x < y ? -1 : x > y;
}

static void normal_of(const float *xyz, const uint32_t *t, double *n)
{
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = (double)xyz[3u * t[1] + (uint32_t)k] - (double)xyz[3u * t[0] + (uint32_t)k];
        v[k] = (double)xyz[3u * t[2] + (uint32_t)k] - (double)xyz[3u * t[0] + (uint32_t)k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
}

/* Every directed edge once and its opposite once; returns the number of edges whose faces turn back. */
static uint32_t check_edges(const fixture_mesh *m, const float *xyz)
{
    static edge edges[TEST_EDGES];
    const uint32_t n = 3u * m->n_triangles;
    uint32_t folds = 0;
    for (uint32_t i = 0; i < n; i++) {
        edges[i].ends = (uint64_t)m->triangles[i] << 32 | m->triangles[i % 3u == 2u ? i - 2u : i + 1u];
        edges[i].triangle = i / 3u;
    }
    qsort(edges, n, sizeof edges[0], compare_edges);
    for (uint32_t i = 0; i < n; i++) {
        edge opposite = {edges[i].ends << 32 | edges[i].ends >> 32, 0};
        const edge *found = bsearch(&opposite, edges, n, sizeof edges[0], compare_edges);
        double u[3], v[3];
        assert_true(i == 0u || edges[i].ends != edges[i - 1u].ends);
        assert_non_null(found);
        normal_of(xyz, m->triangles + 3u * edges[i].triangle, u);
        normal_of(xyz, m->triangles + 3u * found->triangle, v);
        folds += u[0] * v[0] + u[1] * v[1] + u[2] * v[2] <= 0.0;
    }
    return folds / 2u;
}

/* Vertices reached from the first one along edges. */
static uint32_t connected(const fixture_mesh *m)
{
    static uint32_t label[FIXTURE_THIGH_VERTICES];
    uint32_t n = 0;
    memset(label, 0, sizeof label);
    label[m->triangles[0]] = 1;
    for (int changed = 1; changed;) {
        changed = 0;
        for (uint32_t i = 0; i < m->n_triangles; i++) {
            const uint32_t *t = m->triangles + 3u * i;
            uint32_t some = label[t[0]] | label[t[1]] | label[t[2]];
            changed |= some != (label[t[0]] & label[t[1]] & label[t[2]]);
            label[t[0]] = label[t[1]] = label[t[2]] = some;
        }
    }
    for (uint32_t i = 0; i < m->n_vertices; i++)
        n += label[i];
    return n;
}

static double volume_of(const fixture_mesh *m, const float *xyz)
{
    double volume = 0.0;
    for (uint32_t i = 0; i < m->n_triangles; i++) {
        const float *a = xyz + 3u * m->triangles[3u * i];
        double n[3];
        normal_of(xyz, m->triangles + 3u * i, n);
        volume += (double)a[0] * n[0] + (double)a[1] * n[1] + (double)a[2] * n[2];
    }
    return volume / 6.0;
}

TEST(test_surfaces)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
        const fixture_mesh *m = &mesh[i];
        n += m->n_vertices;
        assert_int_equal(2u * m->n_vertices - 4u, m->n_triangles); /* one sphere */
        assert_int_equal(m->n_vertices, connected(m));
        assert_int_equal(0, check_edges(m, m->xyz));
        assert_true(volume_of(m, m->xyz) > 3000.0); /* mm3, outward */
    }
    assert_in_range(n, 21000, 26000);
    assert_in_range(thigh.n_segments, 1, FIXTURE_THIGH_SEGMENTS);
}

/* Mean and spread of edge lengths: near-uniform triangles. */
TEST(test_edges_are_even)
{
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
        double sum = 0.0, square = 0.0;
        const uint32_t n = 3u * mesh[i].n_triangles;
        for (uint32_t e = 0; e < n; e++) {
            const float *a = mesh[i].xyz + 3u * mesh[i].triangles[e];
            const float *b = mesh[i].xyz + 3u * mesh[i].triangles[e % 3u == 2u ? e - 2u : e + 1u];
            double x = (double)(a[0] - b[0]), y = (double)(a[1] - b[1]), z = (double)(a[2] - b[2]);
            double length = sqrt(x * x + y * y + z * z);
            sum += length;
            square += length * length;
        }
        sum /= n;
        square = sqrt(square / n - sum * sum);
        assert_true(sum > 5.0 && sum < 8.5);
        assert_true(square < 0.3 * sum);
    }
}

/* The truth is the model under the deformation: the way back leads home; and nothing is folded or turned over. */
TEST(test_truth)
{
    static float truth[3u * FIXTURE_THIGH_VERTICES];
    for (uint32_t seed = 1; seed <= TEST_SEEDS; seed++) {
        fixture_pose pose;
        double moved = 0.0, n = 0.0;
        fixture_thigh_pose(seed, &pose);
        for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
            fixture_thigh_truth(&pose, mesh[i].xyz, mesh[i].n_vertices, truth);
            for (uint32_t v = 0; v < mesh[i].n_vertices; v++) {
                float back[3];
                double d = 0.0;
                fixture_thigh_back(&pose, truth + 3u * v, back);
                for (uint32_t k = 0; k < 3u; k++) {
                    double e = (double)truth[3u * v + k] - (double)mesh[i].xyz[3u * v + k];
                    assert_true(fabsf(back[k] - mesh[i].xyz[3u * v + k]) < 1e-3f);
                    d += e * e;
                }
                moved += sqrt(d);
                n += 1.0;
            }
            assert_int_equal(0, check_edges(&mesh[i], truth));
            assert_true(volume_of(&mesh[i], truth) > 0.7 * volume_of(&mesh[i], mesh[i].xyz));
        }
        moved /= n;
        if (getenv("SMR_TEST_SHOW") != NULL)
            print_message("seed %u: moved by %.1f mm in the mean\n", seed, moved);
        assert_true(moved > 25.0 && moved < 60.0);
    }
}

/* Muscles do not reach into each other by more than the triangles' coarseness, and many vertices touch a
 * neighbour. Bones keep off each other. */
TEST(test_neighbours)
{
    uint32_t touching = 0, n = 0;
    for (uint32_t i = 0; i < FIXTURE_THIGH_PARTS; i++) {
        for (uint32_t v = 0; v < mesh[i].n_vertices; v++) {
            float nearest = 1e6f;
            for (uint32_t j = 0; j < FIXTURE_THIGH_PARTS; j++) {
                fixture_clipped other = {&thigh, j};
                float value = j == i ? nearest : fixture_clipped_value(&other, mesh[i].xyz + 3u * v);
                nearest = value < nearest ? value : nearest;
            }
            assert_true(nearest > -1.0f);
            touching += nearest < 1.5f;
            n++;
        }
    }
    if (getenv("SMR_TEST_SHOW") != NULL)
        print_message("%u of %u vertices within 1.5 mm of another structure\n", touching, n);
    assert_true(touching > n / 5u);
}

TEST(test_landmarks)
{
    for (uint32_t i = 0; i < FIXTURE_THIGH_LANDMARKS; i++) {
        const fixture_landmark *mark = fixture_thigh_landmark(i);
        const fixture_mesh *m = &mesh[mark->part];
        const float *d = mark->direction, *p = m->xyz + 3u * fixture_thigh_pick(mark, m);
        assert_true(mark->part < FIXTURE_THIGH_PARTS);
        for (uint32_t v = 0; v < m->n_vertices; v++) {
            const float *q = m->xyz + 3u * v;
            assert_true((q[0] - p[0]) * d[0] + (q[1] - p[1]) * d[1] + (q[2] - p[2]) * d[2] < 1e-3f);
        }
        for (uint32_t j = 0; j < i; j++) {
            const fixture_landmark *other = fixture_thigh_landmark(j);
            assert_string_not_equal(mark->name, other->name);
            assert_true(other->part != mark->part || fixture_thigh_pick(other, m) != fixture_thigh_pick(mark, m));
        }
    }
}

/* The image shows the surfaces: marrow within bones, a dark wall at their boundary, muscle grey within muscles. */
TEST(test_image)
{
    static const float spacing[3] = {1.0f, 1.0f, 3.0f}, low[3] = {-200.0f, -100.0f, -202.0f},
                       high[3] = {0.0f, 125.0f, -202.0f};
    const float middle[3] = {-120.0f, 4.0f, -202.0f}, muscle[3] = {-126.0f, -72.0f, -202.0f};
    fixture_box box;
    fixture_pose pose;
    float *words;
    fixture_thigh_box(low, high, spacing, &box);
    uint8_t *voxels = malloc((size_t)box.n[0] * box.n[1]);
    words = malloc(FIXTURE_IMAGE_SCRATCH(box.n[0], box.n[1]) * sizeof *words);
    assert_non_null(voxels);
    assert_non_null(words);
    fixture_thigh_pose(0, &pose);
    for (uint32_t z = 0; z < box.n[2]; z++) {
        if (fabsf(box.low[2] + 3.0f * (float)z - middle[2]) < 1.5f) {
            uint32_t x = (uint32_t)(middle[0] - box.low[0]), y = (uint32_t)(middle[1] - box.low[1]), dark = 255;
            fixture_thigh_slice(&thigh, &pose, &box, z, voxels, words);
            assert_in_range(voxels[y * box.n[0] + x], 140, 220);
            for (uint32_t k = 0; k < 25u; k++) {
                uint32_t value = voxels[y * box.n[0] + x + k];
                dark = value < dark ? value : dark;
            }
            assert_in_range(dark, 20, 110);
            x = (uint32_t)(muscle[0] - box.low[0]);
            y = (uint32_t)(muscle[1] - box.low[1]);
            assert_in_range(voxels[y * box.n[0] + x], 50, 95);
            assert_in_range(voxels[0], 0, 25);
        }
    }
    free(voxels);
    free(words);
}

static uint32_t add_word(uint32_t hash, uint32_t word) { return fixture_hash(hash ^ word) + 0x9e3779b9u; }

/* The bits: one thick slice through the hips in coarse voxels, and one small structure. */
TEST(test_bits)
{
    enum { NX = 40, NY = 36 };
    static uint8_t voxels[NX * NY];
    static float words[FIXTURE_IMAGE_SCRATCH(NX, NY)];
    const fixture_box box = {{-210.0f, -110.0f, -12.0f}, {6.0f, 6.0f, 3.0f}, {NX, NY, 1}, {NULL, NULL}, {0, 0}};
    fixture_pose pose;
    uint32_t hash = 0, bits;
    fixture_thigh_pose(1, &pose);
    fixture_thigh_slice(&thigh, &pose, &box, 0, voxels, words);
    for (uint32_t i = 0; i < NX * NY; i++)
        hash = add_word(hash, voxels[i]);
    assert_int_equal(hash, TEST_SLICE_HASH);
    hash = 0;
    for (uint32_t i = 0; i < 3u * mesh[13].n_vertices; i++) {
        memcpy(&bits, mesh[13].xyz + i, sizeof bits);
        hash = add_word(hash, bits);
    }
    assert_int_equal(hash, TEST_MESH_HASH);
}

int main(void) { return suite_run(set_up, tear_down); }
