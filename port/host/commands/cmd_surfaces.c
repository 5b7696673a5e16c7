/* cmd_surfaces.c: smr surfaces: a label map's structures as smooth closed surfaces, and a table of their names.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include <dirent.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/threads.h"
#include "commands/commands.h"
#include "files/output_files.h"
#include "labels/label_names.h"
#include "labels/label_surfaces.h"

#define TABLE "labels.ctbl"

/* A colour of 0 to 1 as bytes; a label without one gets the next shade. */
static void colour_of(const host_label *label, uint32_t i, unsigned char colour[3])
{
    float shade[3];
    uint32_t k = 0;
    memcpy(shade, label->colour, sizeof shade);
    if (!label->coloured)
        host_label_colour(i, shade);
    for (k = 0; k < 3u; k++)
        colour[k] = (unsigned char)(255.0f * shade[k] + 0.5f);
}

/* 1 when a file's name is that of a surface which the map does not give. */
static int is_stranger(const host_label_map *map, const char *file)
{
    char name[SMR_NAME_BYTES + 8u];
    uint32_t i = 0;
    if (file[0] == '.' || host_format_of(file) < 0)
        return 0;
    for (i = 0; i < map->n_labels; i++) {
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
    char found[256] = ""; /* the first one by name */
    if (directory == NULL)
        return 0; /* it is still to be made */
    while ((entry = readdir(directory)) != NULL)
        if (is_stranger(map, entry->d_name) && (found[0] == '\0' || strcmp(entry->d_name, found) < 0))
            (void)snprintf(found, sizeof found, "%.255s", entry->d_name);
    (void)closedir(directory);
    error->file = path;
    return found[0] == '\0' ? 0
                            : host_fail(error, "surfaces", "a directory without other surfaces, found %.180s", found);
}

/* Values that differ: those of layers need not. */
static void put_table(const host_label_map *map, host_buffer *out)
{
    uint32_t i = 0;
    host_buffer_print(out, "# Color table file: value, name, red, green, blue, opacity\n");
    for (i = 0; i < map->n_labels; i++) {
        unsigned char colour[3];
        colour_of(&map->label[i], i, colour);
        host_buffer_print(out, "%u %s %u %u %u 255\n", map->n_layers > 1u ? i + 1u : map->label[i].value,
                          map->label[i].name, colour[0], colour[1], colour[2]);
    }
}

static int write_surfaces(const host_label_map *map, const host_label_surface *surface, host_output *output,
                          host_error *error)
{
    host_buffer buffer;
    char name[SMR_NAME_BYTES + 8u];
    unsigned char colour[3];
    uint32_t i = 0;
    int result = 0;
    memset(&buffer, 0, sizeof buffer);
    for (i = 0; result == 0 && i < map->n_labels; i++) {
        (void)snprintf(name, sizeof name, "%s.ply", map->label[i].name);
        buffer.size = 0;
        colour_of(&map->label[i], i, colour);
        if (map->label[i].coloured)
            host_mesh_write_coloured(&surface[i].mesh, colour, &buffer);
        else
            host_mesh_write(&surface[i].mesh, HOST_FORMAT_PLY, &buffer);
        result = host_output_add(output, name, &buffer, error);
    }
    if (result == 0) {
        buffer.size = 0;
        put_table(map, &buffer);
        result = host_output_add(output, TABLE, &buffer, error);
    }
    host_buffer_free(&buffer);
    return result;
}

static int write_all(const host_label_map *map, const host_label_surface *surface, const char *directory,
                     host_error *error)
{
    host_output *const output = host_output_begin(directory);
    if (output == NULL)
        return host_fail(error, "output", "free memory");
    if (write_surfaces(map, surface, output, error) == 0)
        return host_output_commit(output, error);
    host_output_abandon(output);
    return -1;
}

static void tell(const host_options *options, const host_label_map *map, const host_label_surface *surface)
{
    uint32_t i = 0;
    for (i = 0; i < map->n_labels; i++) {
        const host_label *const label = &map->label[i];
        const host_label_surface *const s = &surface[i];
        (void)printf("label %5u  %-32s voxels %9" PRIu64 "  %12.1f mm3  surface %12.1f mm3  triangles %7u  folds %u\n",
                     label->value, label->name, label->voxels, s->voxel_volume, s->volume, s->mesh.n_triangles,
                     s->folds);
    }
    (void)printf("%s: %u surfaces\n", options->out, map->n_labels);
}

int host_surfaces(const host_options *options, host_error *error)
{
    const char *const path = options->operands.path[0];
    host_label_map map;
    host_label_surface *surface = NULL;
    host_port port;
    int result = HOST_REFUSED;
    memset(&map, 0, sizeof map);
    memset(&port, 0, sizeof port);
    if (host_output_check(options->out, error) == 0 && host_port_open(&port, options->threads, error) == 0 &&
        host_label_map_read(path, options->names, &map, error) == 0 &&
        check_directory(&map, options->out, error) == 0) {
        error->file = path;
        surface = calloc(map.n_labels, sizeof *surface);
        if (surface == NULL)
            (void)host_fail(error, "labels", "free memory");
        else if (host_label_surfaces_make(&port.port, &map, options->passes, options->triangles, surface, error) == 0 &&
                 write_all(&map, surface, options->out, error) == 0)
            result = HOST_DONE;
    }
    if (result == HOST_DONE && !options->quiet)
        tell(options, &map, surface);
    host_label_surfaces_free(surface, map.n_labels);
    host_label_map_free(&map);
    host_port_close(&port);
    return result;
}
