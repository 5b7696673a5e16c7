/* test_label_surfaces.c: surfaces of known shapes in straight, oblique and uneven volumes: each edge has two
 * triangles, no folds, the volume within 1 %, normals at most 12 degrees off in the mean, and every voxel comes
 * back. Any voxels at all give closed surfaces. Rays through edges and corners are counted once.
 * Damaged maps are refused, or legal; axes that floats cannot count are refused.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L /* mkstemp */

#include "suite.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "host/label_shapes.h"
#include "labels/surface_net.h"
#include "labels/label_surfaces.h"
#include "labels/surface_set.h"
#include "measure/surface_distances.h"
#include "volumes/voxel_volume.h"

static host_label_surface *surfaces_of(const host_label_map *map)
{
    host_label_surface *const s = calloc(map->n_labels, sizeof *s);
    host_error error = {0};
    assert_non_null(s);
    if (host_label_surfaces_make(&label_port.port, map, HOST_SMOOTHING_PASSES, 0, s, &error) != 0) {
        host_error_print(&error);
        fail();
    }
    return s;
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
    host_folds folds;
    assert_int_equal(host_count_folds(&view, NULL, &folds), 0);
    print_message(
        "%-10s %4.2f %4.2f %4.2f mm  volume %+.3f %%  normals %5.2f deg  Dice %.5f, at 1 mm %.5f  folds %u %u\n",
        shapes[s].name, (double)grid->spacing[0], (double)grid->spacing[1], (double)grid->spacing[2],
        100.0 * (volume / surface[0].voxel_volume - 1.0), normals, same, other, (unsigned)folds.all,
        (unsigned)surface[0].folds);
    assert_true(is_closed(mesh));
    assert_true(fabs(volume / surface[0].voxel_volume - 1.0) < 0.01);
    assert_true(fabs(volume - surface[0].volume) < 1e-3 * volume);
    assert_true(normals <= 12.0);
    assert_true(same >= 1.0);
    assert_true(other >= least_dice);
    assert_int_equal(folds.all, 0);
    host_label_surfaces_free(surface, map.n_labels);
    host_label_map_free(&map);
}

TEST(keeps_shapes)
{
    const host_volume straight = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1),
                      oblique = make_grid(1.0, 1.0, 1.0, 0.5, 0.3, -1), uneven = make_grid(0.8, 0.8, 2.0, 0.5, 0.3, 1);
    for (unsigned s = 0; s < SHAPES; s++) {
        check_shape(&straight, s, 0.98);
        check_shape(&oblique, s, 0.98);
        check_shape(&uneven, s, s == SHAPE_PLATE ? 0.85 : 0.97); /* slices of 2 mm, a plate of 3 */
    }
}

/* Two halves of a ball that touch: each is closed, and no voxel changes its owner. */
TEST(keeps_touching_structures)
{
    const host_volume grid = make_grid(1.0, 1.2, 0.9, 0.4, 0.7, 1);
    host_label_map map = make_map(&grid, 2);
    for (size_t v = 0; v < host_label_voxels(&map); v++) {
        double at[3];
        place(&grid, v, at);
        if (shapes[SHAPE_BALL].f(at) < 0.0)
            set_voxel(&map, v, at[0] + 0.3 * at[1] < 2.0 ? 1 : 2);
    }
    host_label_surface *surface = surfaces_of(&map);
    for (uint32_t i = 0; i < 2; i++) {
        assert_true(is_closed(&surface[i].mesh));
        assert_int_equal(surface[i].folds, 0);
        assert_true(fabs(surface[i].volume / surface[i].voxel_volume - 1.0) < 0.01);
    }
    assert_true(dice_of(&surface[0].mesh, &grid, map.index, NULL) >= 1.0);
    host_label_surfaces_free(surface, 2);
    host_label_map_free(&map);
}

/* Noise has every cell there is; voxels at the border are closed by what lies beyond. */
TEST(closes_noise)
{
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    uint32_t round = 0, seed = 1;
    grid.size[0] = 17;
    grid.size[1] = 14;
    grid.size[2] = 11;
    for (round = 1; round < 8; round++) {
        host_label_map map = make_map(&grid, 1);
        size_t v = 0;
        for (v = 0; v < host_label_voxels(&map); v++) {
            seed = seed * 1664525u + 1013904223u;
            if ((seed >> 24) < 32u * round)
                set_voxel(&map, v, 1);
        }
        host_label_surface *surface = surfaces_of(&map);
        assert_true(is_closed(&surface[0].mesh));
        assert_true(dice_of(&surface[0].mesh, &grid, map.index, NULL) >= 1.0);
        host_label_surfaces_free(surface, 1);
        host_label_map_free(&map);
    }
}

/* What a cell's loops must be: each crossed edge in one, and faces crossed twice only where the notes say so. */
TEST(groups_all_cells)
{
    unsigned mask = 0, e = 0, twice = 0;
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
TEST(fills_once_on_rays)
{
    static const uint32_t sides[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                       2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    unsigned char count[9 * 9 * 9] = {0};
    uint32_t n = 0, i = 0;
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
    if (host_label_map_read(path, NULL, &map, &error) != 0) {
        assert_true(error.place[0] != '\0' && error.expected[0] != '\0' && map.n_labels == 0);
        return 0;
    }
    assert_true(map.n_labels >= 1 && map.n_labels <= SMR_STRUCTURES_MAX);
    for (uint32_t i = 0; i < map.n_labels; i++)
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

TEST(survives_damage)
{
    static const char marks[] = "0-9.,:=({[/\\\n eS";
    char path[] = "/tmp/smr_labels_XXXXXX", damaged[sizeof layered];
    const size_t all = sizeof layered - 1u;
    const int fd = mkstemp(path);
    uint32_t seed = 3, round = 0, k = 0, good = 0;
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
TEST(refuses_long_axes)
{
    host_volume grid = make_grid(1.0, 1.0, 1.0, 0.0, 0.0, 1);
    host_label_surface surface[1];
    host_error error = {0};
    grid.size[0] = 16777217;
    grid.size[1] = grid.size[2] = 1;
    host_label_map map = make_map(&grid, 1);
    set_voxel(&map, 5, 1);
    assert_int_equal(host_label_surfaces_make(&label_port.port, &map, 0, 0, surface, &error), -1);
    assert_string_equal(error.place, "size");
    host_label_map_free(&map);
}

int main(void) { return suite_run(open_port, close_port); }
