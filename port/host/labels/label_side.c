/* label_side.c: reads label maps and directories of surfaces for a comparison.
 * SPDX-License-Identifier: MIT */
#include "labels/label_side.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "files/file_kind.h"
#include "labels/label_overlap.h"

static int is_directory(const char *path)
{
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

int host_is_label_side(const char *path)
{
    return is_directory(path) || host_file_kind(path) == HOST_KIND_VOLUME || host_is_volume_path(path);
}

static int read_map(host_label_side *side, const char *names, uint32_t passes, const smr_port *port, host_error *error)
{
    if (host_label_map_read(side->path, names, &side->map, error) != 0)
        return -1;
    error->file = side->path;
    side->surface = calloc(side->map.n_labels, sizeof *side->surface);
    if (side->surface == NULL)
        return host_fail(error, "labels", "free memory");
    return host_label_surfaces_make(port, &side->map, passes, 0, side->surface, error);
}

/* The surfaces of a map on another grid, in place of its own voxels. */
static int repaint(host_label_side *side, const smr_port *port, const host_volume *grid, host_error *error)
{
    const uint32_t n = side->map.n_labels;
    host_load *const load = calloc(n, sizeof *load);
    host_painted painted;
    uint32_t i = 0;
    int result = -1;
    memset(&painted, 0, sizeof painted);
    error->file = side->path;
    for (i = 0; load != NULL && i < n; i++) {
        load[i].path = side->path;
        load[i].mesh = side->surface[i].mesh;
    }
    if (load == NULL)
        (void)host_fail(error, "labels", "free memory");
    else
        result = host_paint(port, load, n, grid, &painted, error);
    if (result == 0) {
        free(side->map.index);
        side->map.index = painted.index;
        painted.index = NULL;
        side->map.grid = *grid;
        side->map.n_layers = 1;
        for (i = 0; i < n; i++)
            side->map.label[i].voxels = painted.voxels[i];
    }
    host_painted_free(&painted);
    free(load);
    return result;
}

static int list_meshes(host_label_side *side, host_error *error)
{
    uint32_t i = 0;
    side->mesh = calloc(side->map.n_labels, sizeof *side->mesh);
    if (side->mesh == NULL)
        return host_fail(error, "labels", "free memory");
    for (i = 0; i < side->map.n_labels; i++)
        side->mesh[i] = host_mesh_view(side->is_set ? &side->set.load[i].mesh : &side->surface[i].mesh);
    return 0;
}

int host_label_sides_read(host_label_side side[2], const char *names, uint32_t passes, const smr_port *port,
                          host_error *error)
{
    const host_volume *grid = NULL;
    uint32_t i = 0;
    for (i = 0; i < 2u; i++) {
        side[i].is_set = is_directory(side[i].path);
        if ((side[i].is_set ? host_surface_set_read(side[i].path, names, port, &side[i].set, error)
                            : read_map(&side[i], names, passes, port, error)) != 0)
            return -1;
        if (grid == NULL && !side[i].is_set)
            grid = &side[i].map.grid;
    }
    error->file = side[1].path;
    if (grid == NULL)
        return host_fail(error, "surfaces", "a label map, for one of the two must be one");
    for (i = 0; i < 2u; i++) {
        if (side[i].is_set && host_surface_set_paint(&side[i].set, port, grid, &side[i].map, NULL, error) != 0)
            return -1;
        if (!side[i].is_set && !host_same_grid(&side[i].map.grid, grid) && repaint(&side[i], port, grid, error) != 0)
            return -1;
        if (list_meshes(&side[i], error) != 0)
            return -1;
    }
    return 0;
}

void host_label_side_free(host_label_side *side)
{
    host_label_surfaces_free(side->surface, side->map.n_labels);
    host_label_map_free(&side->map);
    host_surface_set_free(&side->set);
    free(side->mesh);
    memset(side, 0, sizeof *side);
}
