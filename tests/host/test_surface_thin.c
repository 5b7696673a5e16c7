/* test_surface_thin.c: known shapes with fewer triangles: the budget is kept, each edge has two triangles, no folds,
 * the same volume, and both surfaces are near each other, the nearer the more triangles there are. What cannot get
 * thinner stays closed. Noise of any kind stays closed.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include "host/label_shapes.h"
#include "labels/label_surfaces.h"
#include "meshes/triangle_mesh.h"
#include "measure/surface_distances.h"

#define SIDE 48u

static int ball(const double p[3]) { return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 225.0; }

static int torus(const double p[3])
{
    const double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 14.0;
    return ring * ring + p[2] * p[2] < 25.0;
}

/* A round plate of 3 mm. */
static int plate(const double p[3]) { return p[0] * p[0] + p[1] * p[1] < 361.0 && p[2] * p[2] < 2.25; }

/* Two balls that a thin bar holds together. */
static int dumbbell(const double p[3])
{
    const double x = fabs(p[0]) - 12.0;
    return x * x + p[1] * p[1] + p[2] * p[2] < 49.0 || (x < 0.0 && p[1] * p[1] + p[2] * p[2] < 3.0);
}

static const struct {
    const char *name;
    int (*inside)(const double p[3]);
    double farthest; /* mm, of 800 triangles */
} thinned[] = {{"ball", ball, 0.35}, {"torus", torus, 0.45}, {"plate", plate, 0.5}, {"dumbbell", dumbbell, 0.4}};

/* The surface of a shape in voxels of 1 mm. */
static host_label_surface *surface_of(int (*inside)(const double p[3]), uint32_t most)
{
    host_label_surface *const surface = calloc(1, sizeof *surface);
    host_label_map map;
    host_error error = {0};
    host_label label;
    memset(&map, 0, sizeof map);
    memset(&label, 0, sizeof label);
    for (uint32_t k = 0; k < 3u; k++) {
        map.grid.size[k] = SIDE;
        map.grid.spacing[k] = 1.0f;
        map.grid.direction[4u * k] = 1.0f;
    }
    map.n_layers = map.n_labels = 1;
    map.label = &label;
    map.index = calloc(host_label_voxels(&map), sizeof *map.index);
    assert_non_null(surface);
    assert_non_null(map.index);
    for (size_t v = 0; v < host_label_voxels(&map); v++) {
        const double p[3] = {(double)(v % SIDE) - 23.3, (double)(v / SIDE % SIDE) - 23.7,
                             (double)(v / SIDE / SIDE) - 23.5};
        map.index[v] = (uint16_t)inside(p);
        label.voxels += map.index[v];
    }
    assert_int_equal(host_label_surfaces_make(&label_port.port, &map, HOST_SMOOTHING_PASSES, most, surface, &error), 0);
    free(map.index);
    return surface;
}

/* mm: the largest distance from the vertices of a to b. */
static double farthest(const host_mesh *a, const host_mesh *b)
{
    const smr_mesh view = host_mesh_view(b);
    void *memory = NULL;
    const smr_surface *const surface = host_surface_make(&view, &memory);
    double most = 0.0;
    assert_non_null(surface);
    for (uint32_t i = 0; i < a->n_vertices; i++) {
        smr_closest hit;
        memset(&hit, 0, sizeof hit);
        assert_int_equal(smr_surface_closest(surface, a->xyz + 3u * (size_t)i, NULL, -1.0f, 100.0f, &hit), SMR_OK);
        most = fmax(most, (double)hit.distance);
    }
    free(memory);
    return most;
}

static double check_thin(unsigned s, const host_label_surface *whole, uint32_t most)
{
    host_label_surface *const thin = surface_of(thinned[s].inside, most);
    const double there = farthest(&thin->mesh, &whole->mesh), back = farthest(&whole->mesh, &thin->mesh);
    const smr_mesh view = host_mesh_view(&thin->mesh);
    host_folds folds;
    assert_int_equal(host_count_folds(&view, NULL, &folds), 0);
    print_message("%-9s %5u -> %4u triangles  volume %+.5f %%  area %+.2f %%  farthest %.3f, back %.3f mm  folds %u\n",
                  thinned[s].name, whole->mesh.n_triangles, thin->mesh.n_triangles,
                  100.0 * (thin->volume / whole->volume - 1.0), 100.0 * (thin->area / whole->area - 1.0), there, back,
                  (unsigned)folds.all);
    assert_true(thin->mesh.n_triangles <= most && thin->mesh.n_triangles + 2u >= most);
    assert_true(is_closed(&thin->mesh));
    assert_true(fabs(thin->volume / whole->volume - 1.0) < 1e-4);
    assert_int_equal(folds.all, 0);
    assert_int_equal(thin->folds, 0);
    host_label_surfaces_free(thin, 1);
    return fmax(there, back);
}

TEST(keeps_shapes)
{
    for (unsigned s = 0; s < sizeof thinned / sizeof thinned[0]; s++) {
        host_label_surface *const whole = surface_of(thinned[s].inside, 0);
        const double fine = check_thin(s, whole, 2500), middle = check_thin(s, whole, 800),
                     coarse = check_thin(s, whole, 200);
        assert_true(fine <= middle && middle <= coarse);
        assert_true(middle < thinned[s].farthest);
        host_label_surfaces_free(whole, 1);
    }
}

/* As far down as it goes: a closed surface of four triangles or more, a torus of more. */
TEST(ends_closed)
{
    for (unsigned s = 0; s < sizeof thinned / sizeof thinned[0]; s++) {
        host_label_surface *const whole = surface_of(thinned[s].inside, 0);
        host_mesh *const mesh = &whole->mesh;
        const uint32_t n = mesh->n_triangles, v = mesh->n_vertices;
        assert_int_equal(host_surface_thin(mesh, n), 0);
        assert_int_equal(mesh->n_triangles, n);
        assert_int_equal(host_surface_thin(mesh, 4), 0);
        print_message("%-9s at least %u triangles\n", thinned[s].name, mesh->n_triangles);
        assert_true(is_closed(mesh));
        assert_true(mesh->n_triangles >= 4 && mesh->n_triangles < 120);
        /* V - E + F, by which a torus stays one */
        assert_int_equal(2 * (int)mesh->n_vertices - (int)mesh->n_triangles, 2 * (int)v - (int)n);
        host_label_surfaces_free(whole, 1);
    }
}

static int noise(const double p[3])
{
    static uint32_t seed = 1;
    seed = seed * 1664525u + 1013904223u;
    return ball(p) && (seed >> 28) < 7u;
}

TEST(keeps_noise_closed)
{
    host_label_surface *const whole = surface_of(noise, 0);
    assert_true(is_closed(&whole->mesh));
    assert_int_equal(host_surface_thin(&whole->mesh, whole->mesh.n_triangles / 3u), 0);
    assert_true(is_closed(&whole->mesh));
    host_label_surfaces_free(whole, 1);
}

int main(void) { return suite_run(open_port, close_port); }
