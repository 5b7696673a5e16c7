/* cmd_labels.c: smr surfaces and smr labels: a label map's structures as surfaces, and surfaces as a label map.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "commands/commands.h"
#include "labels/label_surfaces.h"
#include "labels/surface_set.h"

#define TABLE "labels.ctbl"

/* A colour of 0 to 1 as bytes; a label without one gets the next shade. */
static void colour_of(const host_label *label, uint32_t i, unsigned char colour[3])
{
    float shade[3];
    memcpy(shade, label->colour, sizeof shade);
    if (!label->coloured)
        host_label_colour(i, shade);
    for (uint32_t k = 0; k < 3u; k++)
        colour[k] = (unsigned char)(255.0f * shade[k] + 0.5f);
}

/* 1 when a file's name is that of a surface which the map does not give. */
static int is_stranger(const host_label_map *map, const char *file)
{
    char name[SMR_NAME_BYTES + 8u];
    if (file[0] == '.' || host_format_of(file) < 0)
        return 0;
    for (uint32_t i = 0; i < map->n_labels; i++) {
        (void)snprintf(name, sizeof name, "%s.ply", map->label[i].name);
        if (strcmp(name, file) == 0)
            return 0;
    }
    return 1;
}

/* smr labels takes all surfaces of a directory: none of another map may lie there. */
static int check_directory(const host_label_map *map, const char *path, host_error *error)
{
    DIR *const directory = opendir(path);
    const struct dirent *entry = NULL;
    char name[256] = ""; /* the first one by name */
    if (directory == NULL)
        return 0; /* it is still to be made */
    while ((entry = readdir(directory)) != NULL)
        if (is_stranger(map, entry->d_name) && (name[0] == '\0' || strcmp(entry->d_name, name) < 0))
            (void)snprintf(name, sizeof name, "%.255s", entry->d_name);
    (void)closedir(directory);
    error->file = path;
    return name[0] == '\0' ? 0 : host_fail(error, "surfaces", "a directory without other surfaces, found %.180s", name);
}

/* Values that differ: those of layers need not. */
static void put_table(const host_label_map *map, host_buffer *out)
{
    host_buffer_print(out, "# Color table file: value, name, red, green, blue, opacity\n");
    for (uint32_t i = 0; i < map->n_labels; i++) {
        unsigned char colour[3];
        colour_of(&map->label[i], i, colour);
        host_buffer_print(out, "%u %s %u %u %u 255\n", map->n_layers > 1u ? i + 1u : map->label[i].value,
                          map->label[i].name, colour[0], colour[1], colour[2]);
    }
}

static int write_surfaces(const host_label_map *map, const host_label_surface *of, const char *dir, host_error *error)
{
    host_output *const output = host_output_begin(dir);
    host_buffer buffer = {0};
    char name[SMR_NAME_BYTES + 8u];
    unsigned char colour[3];
    int result = 0;
    for (uint32_t i = 0; result == 0 && i < map->n_labels; i++) {
        (void)snprintf(name, sizeof name, "%s.ply", map->label[i].name);
        colour_of(&map->label[i], i, colour);
        if (map->label[i].coloured)
            host_mesh_write_coloured(&of[i].mesh, colour, &buffer);
        else
            host_mesh_write(&of[i].mesh, HOST_FORMAT_PLY, &buffer);
        result = host_output_take(output, name, &buffer, 0, error);
    }
    put_table(map, &buffer);
    result = host_output_take(output, TABLE, &buffer, result, error);
    return host_output_end(output, result, error);
}

static void tell(const host_options *options, const host_label_map *map, const host_label_surface *surface)
{
    for (uint32_t i = 0; i < map->n_labels; i++) {
        const host_label *const of = &map->label[i];
        const host_label_surface *const s = &surface[i];
        (void)printf("label %5u  %-32s voxels %9" PRIu64 "  %12.1f mm3  surface %12.1f mm3  triangles %7u  folds %u\n",
                     of->value, of->name, of->voxels, s->voxel_volume, s->volume, s->mesh.n_triangles, s->folds);
    }
    (void)printf("%s: %u surfaces\n", options->out, map->n_labels);
}

int host_surfaces(const host_options *options, host_error *error)
{
    const char *const in = options->operands.path[0];
    host_label_map map = {0};
    host_label_surface *surface = NULL;
    host_port port = {0};
    int result = HOST_REFUSED;
    if (host_output_check(options->out, error) == 0 && host_port_open(&port, options->threads, error) == 0 &&
        host_label_map_read(in, options->names, &map, error) == 0 && check_directory(&map, options->out, error) == 0) {
        error->file = in;
        surface = calloc(map.n_labels, sizeof *surface);
        if (surface == NULL)
            (void)host_fail(error, "labels", "free memory");
        else if (host_label_surfaces_make(&port.port, &map, options->passes, options->triangles, surface, error) == 0 &&
                 write_surfaces(&map, surface, options->out, error) == 0)
            result = HOST_DONE;
    }
    if (result == HOST_DONE && !options->quiet)
        tell(options, &map, surface);
    host_label_surfaces_free(surface, map.n_labels);
    host_label_map_free(&map);
    host_port_close(&port);
    return result;
}

/* Only the volume's grid is of use. */
static int read_grid(const char *path, host_volume *grid, host_error *error)
{
    host_buffer keys = {0};
    uint32_t layers = 0;
    error->file = path;
    int result = host_volume_read_layers(path, grid, &layers, &keys, error);
    host_buffer_free(&keys);
    free(grid->voxels);
    grid->voxels = NULL;
    return result;
}

static int write_map(const host_label_map *map, const char *path, host_error *error)
{
    host_buffer buffer = {0};
    error->file = path;
    return host_output_file(NULL, path, &buffer, host_labels_write(map, path, &buffer, error), error);
}

/* A volume somewhere else would get a map of nothing. */
static int check_met(const host_label_map *map, const char *like, host_error *error)
{
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (map->label[i].voxels > 0)
            return 0;
    error->file = like;
    return host_fail(error, "voxels", "at least one voxel's centre inside the surfaces: is it another frame or unit?");
}

/* Names the structures that are not in the map, in one line. */
static void tell_missing(const host_label_map *map)
{
    uint32_t n = 0;
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (map->label[i].voxels == 0)
            (void)fprintf(stderr, "%s%s", n++ == 0 ? "smr: structures without a voxel: " : ", ", map->label[i].name);
    if (n > 0)
        (void)fprintf(stderr, "\n");
}

static void tell_map(const host_options *options, const host_label_map *map, uint64_t shared)
{
    const double mm3 = fabs(host_label_mm3(&map->grid));
    for (uint32_t i = 0; i < map->n_labels; i++)
        (void)printf("label %5u  %-32s voxels %9" PRIu64 "  %12.1f mm3\n", map->label[i].value, map->label[i].name,
                     map->label[i].voxels, (double)map->label[i].voxels * mm3);
    (void)printf("%s: %u x %u x %u voxels, %u labels; %" PRIu64 " voxels in several surfaces, now in the deepest\n",
                 options->out, map->grid.size[0], map->grid.size[1], map->grid.size[2], map->n_labels, shared);
}

int host_labels(const host_options *options, host_error *error)
{
    host_surface_set set = {0};
    host_label_map map = {0};
    host_volume grid = {0};
    host_port port = {0};
    uint64_t shared = 0;
    int result = HOST_REFUSED;
    if (host_labels_can_write(options->out, error) == 0 && host_port_open(&port, options->threads, error) == 0 &&
        read_grid(options->like, &grid, error) == 0 &&
        host_surface_set_read(options->operands.path[0], options->names, &port.port, &set, error) == 0 &&
        host_surface_set_paint(&set, &port.port, &grid, &map, &shared, error) == 0 &&
        check_met(&map, options->like, error) == 0 && write_map(&map, options->out, error) == 0)
        result = HOST_DONE;
    if (result == HOST_DONE)
        tell_missing(&map);
    if (result == HOST_DONE && !options->quiet)
        tell_map(options, &map, shared);
    host_surface_set_free(&set);
    host_label_map_free(&map);
    host_port_close(&port);
    return result;
}
