/* cmd_labels.c: smr labels: closed surfaces as a label map on a volume's grid.
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/threads.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "labels/label_write.h"
#include "labels/surface_set.h"

/* Only the volume's grid is of use. */
static int read_grid(const char *path, host_volume *grid, host_error *error)
{
    host_buffer keys;
    uint32_t layers = 0;
    int result = 0;
    memset(&keys, 0, sizeof keys);
    error->file = path;
    result = host_volume_read_layers(path, grid, &layers, &keys, error);
    host_buffer_free(&keys);
    free(grid->voxels);
    grid->voxels = NULL;
    return result;
}

static int write_map(const host_label_map *map, const char *path, host_error *error)
{
    host_output *output = NULL;
    host_buffer buffer;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    error->file = path;
    result = host_labels_write(map, path, &buffer, error);
    if (result == 0) {
        output = host_output_begin(NULL);
        result =
            output != NULL ? host_output_add(output, path, &buffer, error) : host_fail(error, "output", "free memory");
    }
    host_buffer_free(&buffer);
    if (result == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

/* A volume somewhere else would get a map of nothing. */
static int check_met(const host_label_map *map, const char *like, host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < map->n_labels; i++)
        if (map->label[i].voxels > 0)
            return 0;
    error->file = like;
    return host_fail(error, "voxels", "at least one voxel's centre inside the surfaces: is it another frame or unit?");
}

/* Names the structures that are not in the map, in one line. */
static void tell_missing(const host_label_map *map)
{
    uint32_t i = 0, n = 0;
    for (i = 0; i < map->n_labels; i++)
        if (map->label[i].voxels == 0)
            (void)fprintf(stderr, "%s%s", n++ == 0 ? "smr: structures without a voxel: " : ", ", map->label[i].name);
    if (n > 0)
        (void)fprintf(stderr, "\n");
}

static void tell(const host_options *options, const host_label_map *map, uint64_t shared)
{
    const double mm3 = fabs(host_label_mm3(&map->grid));
    uint32_t i = 0;
    for (i = 0; i < map->n_labels; i++)
        (void)printf("label %5u  %-32s voxels %9" PRIu64 "  %12.1f mm3\n", map->label[i].value, map->label[i].name,
                     map->label[i].voxels, (double)map->label[i].voxels * mm3);
    (void)printf("%s: %u x %u x %u voxels, %u labels; %" PRIu64 " voxels in several surfaces, now in the deepest\n",
                 options->out, map->grid.size[0], map->grid.size[1], map->grid.size[2], map->n_labels, shared);
}

int host_labels(const host_options *options, host_error *error)
{
    host_surface_set set;
    host_label_map map;
    host_volume grid;
    host_port port;
    uint64_t shared = 0;
    int result = HOST_REFUSED;
    memset(&set, 0, sizeof set);
    memset(&map, 0, sizeof map);
    memset(&grid, 0, sizeof grid);
    memset(&port, 0, sizeof port);
    if (host_labels_can_write(options->out, error) == 0 && host_port_open(&port, options->threads, error) == 0 &&
        read_grid(options->like, &grid, error) == 0 &&
        host_surface_set_read(options->operands.path[0], options->names, &port.port, &set, error) == 0 &&
        host_surface_set_paint(&set, &port.port, &grid, &map, &shared, error) == 0 &&
        check_met(&map, options->like, error) == 0 && write_map(&map, options->out, error) == 0)
        result = HOST_DONE;
    if (result == HOST_DONE)
        tell_missing(&map);
    if (result == HOST_DONE && !options->quiet)
        tell(options, &map, shared);
    host_surface_set_free(&set);
    host_label_map_free(&map);
    host_port_close(&port);
    return result;
}
