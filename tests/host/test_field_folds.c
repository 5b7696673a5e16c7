/* test_field_folds.c: the cells of a grid in which a displacement field folds.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <string.h>
#include "carry/carry_volume.h"

enum { SIDE = 6, VOXELS = SIDE * SIDE * SIDE, MIDDLE = 2 + SIDE * (2 + SIDE * 2) };

/* A grid of cells of 2 x 3 x 4 mm; mirrored: along x. */
static host_volume grid_of(int mirrored)
{
    const float spacing[3] = {2, 3, 4}, direction[9] = {mirrored ? -1.0f : 1.0f, 0, 0, 0, 1, 0, 0, 0, 1};
    host_volume grid;
    memset(&grid, 0, sizeof grid);
    for (int k = 0; k < 3; k++) {
        grid.size[k] = SIDE;
        grid.spacing[k] = spacing[k];
    }
    memcpy(grid.direction, direction, sizeof direction);
    return grid;
}

TEST(counts_cells)
{
    static float field[3 * VOXELS];
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        const host_volume grid = grid_of(mirrored);
        const float along = mirrored ? -1.0f : 1.0f;
        memset(field, 0, sizeof field);
        assert_int_equal(host_field_folds(&grid, field, 0), 0);
        field[3 * MIDDLE] = 1.9f * along; /* nearly onto the next voxel */
        assert_int_equal(host_field_folds(&grid, field, 0), 0);
        field[3 * MIDDLE] = 2.0f * along; /* onto it: the four cells on that side are flat at a corner */
        assert_int_equal(host_field_folds(&grid, field, 0), 4);
        field[3 * MIDDLE + 1] = -3.1f; /* and past another one */
        assert_int_equal(host_field_folds(&grid, field, 0), 6);
        for (int i = 0; i < VOXELS; i++) /* everything turned over along z */
            field[3 * i + 2] = -8.0f * (float)(i / (SIDE * SIDE));
        assert_true(host_field_folds(&grid, field, 0) >= 119 && host_field_folds(&grid, field, 1) <= 8);
    }
}
