/* test_label_surfaces.c: surfaces of known shapes in straight, oblique and uneven volumes: each edge has two
 * triangles, no folds, the volume within 1 %, normals at most 12 degrees off in the mean, and every voxel comes
 * back. Any voxels at all give closed surfaces. Rays through edges and corners are counted once.
 * Damaged maps are refused, or legal; axes that floats cannot count are refused.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* mkstemp */

#include "unit/cmocka_first.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/threads.h"
#include "labels/cell_loops.h"
#include "labels/label_surfaces.h"
#include "labels/surface_fill.h"
#include "measure/half_edges.h"
#include "measure/surface_distances.h"
#include "volumes/volume_write.h"

#define PI 3.14159265358979

static host_port port;

/* Negative inside; mm. */
typedef double (*shape_function)(const double p[3]);

static double ball(const double p[3]) { return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 15.0; }

static double ellipsoid(const double p[3])
{
    return 10.0 * (sqrt(p[0] * p[0] / 400.0 + p[1] * p[1] / 100.0 + p[2] * p[2] / 144.0) - 1.0);
}

static double capsule(const double p[3])
{
    const double t = p[0] < -12.0 ? -12.0 : (p[0] > 12.0 ? 12.0 : p[0]);
    return sqrt((p[0] - t) * (p[0] - t) + p[1] * p[1] + p[2] * p[2]) - 7.0;
}

static double torus(const double p[3])
{
    const double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 14.0;
    return sqrt(ring * ring + p[2] * p[2]) - 5.0;
}

/* A plate of 3 mm with a round border. */
static double plate(const double p[3])
{
    const double out = sqrt(p[0] * p[0] + p[1] * p[1]) - 18.0, side = out > 0.0 ? out : 0.0;
    return sqrt(side * side + p[2] * p[2]) - 1.5;
}

static const struct {
    const char *name;
    shape_function f;
} shapes[] = {{"ball", ball}, {"ellipsoid", ellipsoid}, {"capsule", capsule}, {"torus", torus}, {"plate", plate}};

enum { SHAPES = 5 };

/* A grid of about 56 mm around the origin, turned about two axes. handed -1: left-handed. */
static host_volume make_grid(double sx, double sy, double sz, double turn, double tilt, int handed)
{
    host_volume g;
    const double c = cos(turn), s = sin(turn), d = cos(tilt), t = sin(tilt), spacing[3] = {sx, sy, sz};
    const double rows[9] = {c, -s * d, s * t, s, c * d, -c * t, 0.0, t, d};
    double half[3], at[3];
    unsigned k = 0;
    memset(&g, 0, sizeof g);
    for (k = 0; k < 9; k++)
        g.direction[k] = (float)(k % 3u == 2u && handed < 0 ? -rows[k] : rows[k]);
    for (k = 0; k < 3; k++) {
        g.spacing[k] = (float)spacing[k];
        g.size[k] = (uint32_t)(56.0 / spacing[k]);
        half[k] = 0.5 * (double)(g.size[k] - 1u) + 0.23;
    }
    host_volume_place(&g, half, at);
    for (k = 0; k < 3; k++)
        g.origin[k] = (float)-at[k];
    return g;
}

static void place(const host_volume *g, size_t voxel, double at[3])
{
    const double index[3] = {(double)(voxel % g->size[0]), (double)(voxel / g->size[0] % g->size[1]),
                             (double)(voxel / g->size[0] / g->size[1])};
    host_volume_place(g, index, at);
}

/* A map of n labels without voxels. */
static host_label_map make_map(const host_volume *grid, uint32_t n)
{
    host_label_map map;
    uint32_t i = 0;
    memset(&map, 0, sizeof map);
    map.grid = *grid;
    map.n_layers = 1;
    map.n_labels = n;
    map.index = calloc(host_label_voxels(&map), sizeof *map.index);
    map.label = calloc(n, sizeof *map.label);
    assert_non_null(map.index);
    assert_non_null(map.label);
    for (i = 0; i < n; i++)
        (void)snprintf(map.label[i].name, SMR_NAME_BYTES, "label_%u", i + 1u);
    return map;
}

static void set_voxel(host_label_map *map, size_t voxel, uint16_t label)
{
    map->index[voxel] = label;
    map->label[label - 1u].voxels++;
}

static host_label_map draw(const host_volume *grid, shape_function f)
{
    host_label_map map = make_map(grid, 1);
    size_t i = 0;
    for (i = 0; i < host_label_voxels(&map); i++) {
        double at[3];
        place(grid, i, at);
        if (f(at) < 0.0)
            set_voxel(&map, i, 1);
    }
    return map;
}

static host_label_surface *surfaces_of(const host_label_map *map)
{
    host_label_surface *const s = calloc(map->n_labels, sizeof *s);
    host_error error = {0};
    assert_non_null(s);
    if (host_label_surfaces_make(&port.port, map, HOST_SMOOTHING_PASSES, s, &error) != 0) {
        host_error_print(&error);
        fail();
    }
    return s;
}

/* Each edge has exactly two triangles, which run along it in opposite directions. */
static int is_closed(const host_mesh *mesh)
{
    const smr_mesh view = host_mesh_view(mesh);
    host_half_edges edges;
    size_t v = 0, i = 0, end = 0;
    int good = mesh->n_triangles > 0;
    assert_int_equal(host_half_edges_make(&view, &edges), 0);
    assert_int_equal(edges.first[mesh->n_vertices], 3u * (size_t)mesh->n_triangles);
    for (v = 0; v < mesh->n_vertices; v++)
        for (i = edges.first[v]; i < edges.first[v + 1u]; i = end) {
            end = host_half_edges_end(&edges, v, i);
            good = good && end - i == 2u &&
                   (mesh->triangles[edges.edge[i].side] == v) != (mesh->triangles[edges.edge[i + 1u].side] == v);
        }
    host_half_edges_free(&edges);
    return good;
}

static void corner(const host_mesh *mesh, size_t t, unsigned c, double p[3])
{
    const float *const x = mesh->xyz + 3u * (size_t)mesh->triangles[3u * t + c];
    p[0] = (double)x[0];
    p[1] = (double)x[1];
    p[2] = (double)x[2];
}

/* The mean angle between the triangles' normals and the shape's, over the area, degrees. */
static double normal_error(const host_mesh *mesh, shape_function f)
{
    double sum = 0.0, all = 0.0;
    size_t t = 0;
    unsigned k = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double p[3][3], n[3], g[3], area = 0.0, length = 0.0, dot = 0.0;
        for (k = 0; k < 3; k++)
            corner(mesh, t, k, p[k]);
        for (k = 0; k < 3; k++) {
            const unsigned i = (k + 1u) % 3u, j = (k + 2u) % 3u;
            double at[3], up = 0.0;
            n[k] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
            for (unsigned c = 0; c < 3; c++)
                at[c] = (p[0][c] + p[1][c] + p[2][c]) / 3.0;
            at[k] += 0.01;
            up = f(at);
            at[k] -= 0.02;
            g[k] = up - f(at);
        }
        for (k = 0; k < 3; k++) {
            area += n[k] * n[k];
            length += g[k] * g[k];
            dot += n[k] * g[k];
        }
        area = sqrt(area);
        dot /= area * sqrt(length) + 1e-30;
        sum += area * acos(dot > 1.0 ? 1.0 : (dot < -1.0 ? -1.0 : dot));
        all += area;
    }
    return sum / all * 180.0 / PI;
}

static double mesh_volume(const host_mesh *mesh)
{
    double six = 0.0;
    size_t t = 0;
    for (t = 0; t < mesh->n_triangles; t++) {
        double a[3], b[3], c[3];
        corner(mesh, t, 0, a);
        corner(mesh, t, 1, b);
        corner(mesh, t, 2, c);
        six += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return six / 6.0;
}

/* Voxels of a grid in a surface, and in the shape, and in both: Dice. */
static double dice_of(const host_mesh *mesh, const host_volume *grid, const uint16_t *index, shape_function f)
{
    host_filled filled;
    host_error error = {0};
    uint64_t a = 0, b = 0, both = 0;
    uint32_t x = 0, y = 0, z = 0;
    size_t voxel = 0;
    assert_int_equal(host_surface_fill(mesh, grid, &filled, &error), 0);
    for (z = 0; z < grid->size[2]; z++)
        for (y = 0; y < grid->size[1]; y++)
            for (x = 0; x < grid->size[0]; x++, voxel++) {
                const uint32_t i = x - filled.low[0], j = y - filled.low[1], k = z - filled.low[2];
                const int in = i < filled.size[0] && j < filled.size[1] && k < filled.size[2] &&
                               filled.inside[((size_t)k * filled.size[1] + j) * filled.size[0] + i];
                double at[3];
                int true_in = index != NULL && index[voxel] == 1;
                if (index == NULL) {
                    place(grid, voxel, at);
                    true_in = f(at) < 0.0;
                }
                a += (uint64_t)in;
                b += (uint64_t)true_in;
                both += (uint64_t)(in && true_in);
            }
    assert_int_equal(a, filled.voxels);
    host_filled_free(&filled);
    return 2.0 * (double)both / (double)(a + b);
}

static void check_shape(const host_volume *grid, unsigned s, double least_dice)
{
    const host_volume millimetre = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    host_label_map map = draw(grid, shapes[s].f);
    host_label_surface *const surface = surfaces_of(&map);
    const host_mesh *const mesh = &surface[0].mesh;
    const smr_mesh view = host_mesh_view(mesh);
    const double volume = mesh_volume(mesh), normals = normal_error(mesh, shapes[s].f),
                 same = dice_of(mesh, grid, map.index, NULL), other = dice_of(mesh, &millimetre, NULL, shapes[s].f);
    uint64_t folds = 0, absolute = 0;
    assert_int_equal(host_count_folds(&view, NULL, &folds, &absolute), 0);
    print_message(
        "%-10s %4.2f %4.2f %4.2f mm  volume %+.3f %%  normals %5.2f deg  Dice %.5f, at 1 mm %.5f  folds %u %u\n",
        shapes[s].name, (double)grid->spacing[0], (double)grid->spacing[1], (double)grid->spacing[2],
        100.0 * (volume / surface[0].voxel_volume - 1.0), normals, same, other, (unsigned)absolute,
        (unsigned)surface[0].folds);
    assert_true(is_closed(mesh));
    assert_true(fabs(volume / surface[0].voxel_volume - 1.0) < 0.01);
    assert_true(fabs(volume - surface[0].volume) < 1e-3 * volume);
    assert_true(normals <= 12.0);
    assert_true(same >= 1.0);
    assert_true(other >= least_dice);
    assert_int_equal(absolute, 0);
    host_label_surfaces_free(surface, map.n_labels);
    host_label_map_free(&map);
}

static void keeps_shapes(void **state)
{
    const host_volume straight = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1),
                      oblique = make_grid(1.0, 1.0, 1.0, 0.5, 0.3, -1), uneven = make_grid(0.8, 0.8, 2.0, 0.5, 0.3, 1);
    unsigned s = 0;
    (void)state;
    for (s = 0; s < SHAPES; s++) {
        check_shape(&straight, s, 0.98);
        check_shape(&oblique, s, 0.98);
        check_shape(&uneven, s, s == 4 ? 0.85 : 0.97); /* slices of 2 mm, a plate of 3 */
    }
}

/* Two halves of a ball that touch: each is closed, and no voxel changes its owner. */
static void keeps_touching_structures(void **state)
{
    const host_volume grid = make_grid(1.0, 1.2, 0.9, 0.4, 0.7, 1);
    host_label_map map = make_map(&grid, 2);
    host_label_surface *surface = NULL;
    uint32_t i = 0;
    size_t v = 0;
    (void)state;
    for (v = 0; v < host_label_voxels(&map); v++) {
        double at[3];
        place(&grid, v, at);
        if (ball(at) < 0.0)
            set_voxel(&map, v, at[0] + 0.3 * at[1] < 2.0 ? 1 : 2);
    }
    surface = surfaces_of(&map);
    for (i = 0; i < 2; i++) {
        assert_true(is_closed(&surface[i].mesh));
        assert_int_equal(surface[i].folds, 0);
        assert_true(fabs(surface[i].volume / surface[i].voxel_volume - 1.0) < 0.01);
    }
    assert_true(dice_of(&surface[0].mesh, &grid, map.index, NULL) >= 1.0);
    host_label_surfaces_free(surface, 2);
    host_label_map_free(&map);
}

/* Noise has every cell there is; voxels at the border are closed by what lies beyond. */
static void closes_noise(void **state)
{
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    uint32_t round = 0, seed = 1;
    (void)state;
    grid.size[0] = 17;
    grid.size[1] = 14;
    grid.size[2] = 11;
    for (round = 1; round < 8; round++) {
        host_label_map map = make_map(&grid, 1);
        host_label_surface *surface = NULL;
        size_t v = 0;
        for (v = 0; v < host_label_voxels(&map); v++) {
            seed = seed * 1664525u + 1013904223u;
            if ((seed >> 24) < 32u * round)
                set_voxel(&map, v, 1);
        }
        surface = surfaces_of(&map);
        assert_true(is_closed(&surface[0].mesh));
        assert_true(dice_of(&surface[0].mesh, &grid, map.index, NULL) >= 1.0);
        host_label_surfaces_free(surface, 1);
        host_label_map_free(&map);
    }
}

/* What a cell's loops must be: each crossed edge in one, and faces crossed twice only where the notes say so. */
static void groups_all_cells(void **state)
{
    unsigned mask = 0, e = 0, twice = 0;
    (void)state;
    for (mask = 0; mask < 256u; mask++) {
        const host_loops loops = host_cell_loops(mask, 0);
        unsigned crossed = 0;
        for (e = 0; e < HOST_CELL_EDGES; e++) {
            unsigned at[2];
            host_cell_edge(e, at);
            crossed += (mask >> at[0] & 1u) != (mask >> at[1] & 1u);
            assert_int_equal((mask >> at[0] & 1u) != (mask >> at[1] & 1u), loops.of[e] != HOST_NO_LOOP);
        }
        assert_true(loops.n <= 4u && (loops.n > 0) == (crossed > 0));
        assert_true((loops.twice & (loops.twice - 1)) == 0); /* one face at most: joining it leads to no other */
        if (loops.twice != 0) {
            twice++;
            assert_int_equal(host_cell_loops(mask, loops.twice).twice, 0);
        }
    }
    assert_int_equal(twice, 36);
    assert_int_equal(host_cell_loops(9, 0).n, 2); /* inside corners across a face are apart, unless they are joined */
    assert_int_equal(host_cell_loops(9, 1u << 4).n, 1);
}

/* A cube whose corners, edges and faces lie on rays and voxels: half open along each axis, so cubes tile. */
static void fills_once_on_rays(void **state)
{
    static const uint32_t sides[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    unsigned char count[9 * 9 * 9] = {0};
    uint32_t n = 0, i = 0;
    (void)state;
    memset(grid.origin, 0, sizeof grid.origin);
    grid.size[0] = grid.size[1] = grid.size[2] = 9;
    for (n = 0; n < 8u; n++) {
        float xyz[24];
        uint32_t triangles[36];
        host_mesh mesh = {xyz, triangles, NULL, 8, 12};
        host_filled filled;
        host_error error = {0};
        memcpy(triangles, sides, sizeof sides);
        for (i = 0; i < 24u; i++)
            xyz[i] = (float)((i / 3u >> i % 3u & 1u) * 4u + (n >> i % 3u & 1u) * 4u);
        assert_int_equal(host_open_edges(&mesh), 0);
        assert_int_equal(host_surface_fill(&mesh, &grid, &filled, &error), 0);
        assert_int_equal(filled.voxels, 64);
        for (i = 0; i < filled.size[0] * filled.size[1] * filled.size[2]; i++)
            count[i % filled.size[0] + filled.low[0] + 9u * (i / filled.size[0] % filled.size[1] + filled.low[1]) +
                  81u * (i / filled.size[0] / filled.size[1] + filled.low[2])] += filled.inside[i];
        host_filled_free(&filled);
        mesh.n_triangles = 11;
        assert_int_equal(host_open_edges(&mesh), 3);
    }
    for (i = 0, n = 0; i < 9u * 9u * 9u; i++) {
        assert_true(count[i] <= 1);
        n += count[i];
    }
    assert_int_equal(n, 512);
}

static const char layered[] =
    "NRRD0005\ntype: uchar\ndimension: 4\nspace: LPS\nsizes: 2 4 3 2\nspace directions: none (1,0,0) (0,1,0) (0,0,2)\n"
    "kinds: list domain domain domain\nencoding: ascii\nspace origin: (0,0,0)\n"
    "Segment0_ID:=a\nSegment0_Name:=ball\nSegment0_LabelValue:=1\nSegment0_Layer:=0\nSegment0_Color:=1 0 0.5\n"
    "Segment1_ID:=b\nSegment1_Name:=inner\nSegment1_LabelValue:=7\nSegment1_Layer:=1\n\n"
    "0 0 1 0 1 0 0 0 0 7 1 7 1 7 0 0 0 0 1 0 1 0 0 0 0 0 1 0 1 0 0 0 0 0 1 0 1 0 0 0 0 0 1 0 1 0 0 0\n";

/* A damaged map is refused with a place and an expectation, or it is one whose surfaces can be made. */
static int try_map(const char *path)
{
    host_label_map map;
    host_error error = {0};
    uint32_t i = 0;
    if (host_label_map_read(path, NULL, &map, &error) != 0) {
        assert_true(error.place[0] != '\0' && error.expected[0] != '\0' && map.n_labels == 0);
        return 0;
    }
    assert_true(map.n_labels >= 1 && map.n_labels <= SMR_STRUCTURES_MAX);
    for (i = 0; i < map.n_labels; i++)
        assert_true(map.label[i].name[0] != '\0' && strchr(map.label[i].name, '/') == NULL &&
                    map.label[i].name[0] != '.' && map.label[i].layer < map.n_layers);
    if (map.grid.spacing[0] < 1e3f && map.grid.spacing[1] < 1e3f && map.grid.spacing[2] < 1e3f) {
        host_label_surface *const s = surfaces_of(&map);
        assert_true(is_closed(&s[0].mesh));
        host_label_surfaces_free(s, map.n_labels);
    }
    host_label_map_free(&map);
    return 1;
}

static void survives_damage(void **state)
{
    static const char marks[] = "0-9.,:=({[/\\\n eS";
    char path[] = "/tmp/smr_labels_XXXXXX", damaged[sizeof layered];
    const size_t all = sizeof layered - 1u;
    const int fd = mkstemp(path);
    uint32_t seed = 3, round = 0, k = 0, good = 0;
    (void)state;
    assert_true(fd >= 0);
    for (round = 0; round < 1500u; round++) {
        memcpy(damaged, layered, sizeof layered);
        for (k = 0; round > 0 && k <= round % 3u; k++) {
            seed = seed * 1664525u + 1013904223u;
            damaged[(seed >> 8) % all] = marks[(seed >> 3) % (sizeof marks - 1u)];
        }
        assert_int_equal(ftruncate(fd, 0), 0);
        assert_int_equal(pwrite(fd, damaged, all, 0), all);
        good += (uint32_t)try_map(path);
        assert_true(round > 0 || good == 1u);
    }
    (void)close(fd);
    (void)unlink(path);
    assert_true(good > 100u && good < 1400u);
}

/* Places along an axis are floats. */
static void refuses_long_axes(void **state)
{
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    host_label_surface surface[1];
    host_error error = {0};
    host_label_map map;
    (void)state;
    grid.size[0] = 16777217;
    grid.size[1] = grid.size[2] = 1;
    map = make_map(&grid, 1);
    set_voxel(&map, 5, 1);
    assert_int_equal(host_label_surfaces_make(&port.port, &map, 0, surface, &error), -1);
    assert_string_equal(error.place, "size");
    host_label_map_free(&map);
}

static int open_port(void **state)
{
    host_error error = {0};
    (void)state;
    return host_port_open(&port, 1, &error);
}

static int close_port(void **state)
{
    (void)state;
    host_port_close(&port);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(groups_all_cells),          cmocka_unit_test(keeps_shapes),
        cmocka_unit_test(keeps_touching_structures), cmocka_unit_test(closes_noise),
        cmocka_unit_test(fills_once_on_rays),        cmocka_unit_test(survives_damage),
        cmocka_unit_test(refuses_long_axes),
    };
    return cmocka_run_group_tests(tests, open_port, close_port);
}
