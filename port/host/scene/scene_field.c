/* scene_field.c: the displacement field of a scene. The way back takes some 40 us a voxel, so it is sought on a lattice
 * of twice the spacing; what is rough is near the vertices, where the fit puts it in.
 * SPDX-License-Identifier: MIT */
#include "scene/scene_field.h"

#include <stdlib.h>

#include "carry/carry_field.h"
#include "volumes/volume_write.h"

#define MARGIN_MM 20.0f
#define SPACING_MM 4.0f
#define COARSER 1.05f

static size_t voxels(const host_volume *grid) { return (size_t)grid->size[0] * grid->size[1] * grid->size[2]; }

static int choose_grid(const host_carried *c, host_volume *grid, host_error *error)
{
    float low[3] = {0}, high[3] = {0}, s = SPACING_MM;
    int fits = 0;
    host_carried_box(c, 1, low, high);
    for (; !fits && s < SMR_COORD_MAX; s *= COARSER) {
        const float spacing[3] = {s, s, s};
        fits = host_volume_around(low, high, MARGIN_MM, spacing, grid) == 0 && voxels(grid) <= HOST_SCENE_VOXELS;
    }
    return fits ? 0 : host_fail(error, "field", "a result of less than %.0f mm", (double)SMR_COORD_MAX);
}

/* Every second voxel of the grid, and one beyond its end where it has an even number. */
static host_volume lattice_of(const host_volume *grid)
{
    host_volume lattice = *grid;
    uint32_t k = 0;
    for (k = 0; k < 3; k++) {
        lattice.size[k] = grid->size[k] / 2u + 1u;
        lattice.spacing[k] = 2.0f * grid->spacing[k];
    }
    return lattice;
}

/* The value of a voxel: the mean of the points of the lattice that it lies between, 1, 2, 4 or 8. */
static void halve(const host_volume *lattice, const float *from, const uint32_t at[3], float to[3])
{
    uint32_t corner = 0, k = 0;
    for (k = 0; k < 3; k++)
        to[k] = 0.0f;
    for (corner = 0; corner < 8u; corner++) {
        size_t i = 0;
        for (k = 3; k-- > 0u;)
            i = i * lattice->size[k] + at[k] / 2u + ((corner >> k & 1u) & at[k]);
        for (k = 0; k < 3; k++)
            to[k] += from[3u * i + k] / 8.0f;
    }
}

static void fill(const host_volume *lattice, const float *from, const host_volume *grid, float *field)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < grid->size[2]; at[2]++)
        for (at[1] = 0; at[1] < grid->size[1]; at[1]++)
            for (at[0] = 0; at[0] < grid->size[0]; at[0]++, field += 3)
                halve(lattice, from, at, field);
}

int64_t host_scene_field_write(host_carried *c, host_buffer *out, double *share, host_error *error)
{
    host_volume grid, lattice;
    float *from = NULL, *field = NULL;
    int64_t missed = -1;
    if (choose_grid(c, &grid, error) != 0)
        return -1;
    lattice = lattice_of(&grid);
    from = malloc(3u * sizeof *from * voxels(&lattice));
    field = malloc(3u * sizeof *field * voxels(&grid));
    if (from == NULL || field == NULL)
        (void)host_fail(error, "field", "free memory for %zu voxels", voxels(&grid));
    else
        missed = host_carried_field(c, &lattice, 1, from, error);
    if (missed >= 0) {
        fill(&lattice, from, &grid, field);
        host_carried_field_fit(c, &grid, 1, field);
        host_carried_field_file(&grid, 1, field, ".nrrd", out);
        *share = (double)missed / (double)voxels(&lattice);
    }
    free(from);
    free(field);
    return missed;
}
