/* surface_set.c: reads a directory of surfaces and gives each one a label.
 * SPDX-License-Identifier: MIT */
#include "labels/surface_set.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "files/file_names.h"
#include "labels/label_names.h"

/* The names that are given to values; none when there is no file of them. */
static int read_names(const char *directory, const char *path, host_names *names, host_error *error)
{
    struct stat st;
    char *table = NULL;
    size_t n = 0;
    int result = 0;
    if (path != NULL)
        return host_names_read(path, names, error);
    n = strlen(directory) + 16u;
    table = malloc(n);
    if (table == NULL)
        return host_fail(error, "names", "free memory");
    (void)snprintf(table, n, "%s/labels.ctbl", directory);
    if (stat(table, &st) == 0) {
        result = host_names_read(table, names, error);
        error->file = directory;
    }
    free(table);
    return result;
}

/* Turns an error of one file into one of the directory, for the file's name is freed with the set. Returns -1. */
static int blame(const host_surface_set *set, host_error *error)
{
    const char *const slash = error->file != NULL ? strrchr(error->file, '/') : NULL;
    char place[sizeof error->place];
    uint32_t i = 0;
    for (i = 0; set->files.n > 0 && i < set->files.frame[0].files.n; i++)
        if (slash != NULL && set->files.frame[0].files.path[i] == error->file) {
            (void)snprintf(place, sizeof place, "%.50s: %.40s", slash + 1, error->place);
            memcpy(error->place, place, sizeof place);
            error->file = set->directory;
            return -1;
        }
    return -1;
}

static int name_surface(const host_surface_set *set, uint32_t i, host_error *error)
{
    char name[SMR_NAME_BYTES];
    uint32_t k = 0;
    error->file = set->load[i].path;
    if (host_base_name(set->load[i].path, name, sizeof name) >= sizeof name ||
        host_label_name(name, strlen(name), set->label[i].name) != 0)
        return host_fail(error, "name", "a name of 1 to %u bytes", SMR_NAME_BYTES - 1u);
    for (k = 0; k < i; k++)
        if (strcmp(set->label[k].name, set->label[i].name) == 0)
            return host_fail(error, "name", "surfaces with names that differ, '%s' is there twice", set->label[i].name);
    return 0;
}

/* The value that the file of names gives; what it leaves out comes behind the largest one. */
static int give_value(const host_surface_set *set, uint32_t i, const host_names *names, uint32_t *most,
                      host_error *error)
{
    host_label *const label = &set->label[i];
    uint32_t k = 0;
    for (k = 0; k < names->n; k++)
        if (strcmp(names->item[k].name, label->name) == 0) {
            label->value = names->item[k].value;
            label->coloured = names->item[k].coloured;
            memcpy(label->colour, names->item[k].colour, sizeof label->colour);
        }
    if (label->value == 0)
        label->value = ++*most;
    if (!label->coloured)
        host_label_colour(i, label->colour);
    for (k = 0; k < i; k++)
        if (set->label[k].value == label->value) {
            error->file = set->load[i].path;
            return host_fail(error, "names", "a label of its own, %u is also that of '%s'", label->value,
                             set->label[k].name);
        }
    return 0;
}

static int label_surfaces(const host_surface_set *set, const host_names *names, host_error *error)
{
    uint32_t i = 0, most = 0;
    for (i = 0; i < names->n; i++)
        most = names->item[i].value > most ? names->item[i].value : most;
    for (i = 0; i < set->n; i++)
        if (name_surface(set, i, error) != 0)
            return -1;
    for (i = 0; i < set->n; i++)
        if (give_value(set, i, names, &most, error) != 0)
            return -1;
    return 0;
}

/* Tables of points may lie beside the surfaces: they come last. Returns how many files come before. */
static uint32_t surfaces_first(const host_frame *frame)
{
    uint32_t i = 0, k = 0, n = 0;
    for (i = 0; i < frame->files.n; i++) {
        const char *const path = frame->files.path[i];
        if (host_has_extension(path, ".csv"))
            continue;
        for (k = i; k > n; k--)
            frame->files.path[k] = frame->files.path[k - 1u];
        frame->files.path[n++] = path;
    }
    return n;
}

static int load_surfaces(host_surface_set *set, const smr_port *port, host_error *error)
{
    host_frame frame = set->files.frame[0];
    uint32_t i = 0;
    frame.files.n = surfaces_first(&frame);
    if (frame.files.n == 0)
        return host_fail(error, "files", "a surface or more");
    if (host_frame_load(&frame, port, HOST_MIRROR_NONE, &set->load, error) != 0)
        return -1;
    set->n = frame.files.n;
    for (i = 0; i < set->n; i++)
        if (set->load[i].mesh.n_triangles == 0) {
            error->file = set->load[i].path;
            return host_fail(error, "faces", "at least one triangle");
        }
    return 0;
}

int host_surface_set_read(const char *directory, const char *names_path, const smr_port *port, host_surface_set *set,
                          host_error *error)
{
    host_files paths = {&directory, 1};
    host_names names = {NULL, 0};
    int result = -1;
    memset(set, 0, sizeof *set);
    set->directory = error->file = directory;
    if (read_names(directory, names_path, &names, error) == 0 && host_frames_list(&paths, &set->files, error) == 0 &&
        load_surfaces(set, port, error) == 0) {
        set->label = calloc(set->n, sizeof *set->label);
        result = set->label != NULL ? label_surfaces(set, &names, error) : host_fail(error, "names", "free memory");
    }
    host_names_free(&names);
    return result == 0 ? 0 : blame(set, error);
}

void host_surface_set_free(host_surface_set *set)
{
    uint32_t i = 0;
    for (i = 0; i < set->n; i++)
        host_mesh_free(&set->load[i].mesh);
    free(set->load);
    host_frames_free(&set->files);
    free(set->label);
    memset(set, 0, sizeof *set);
}

int host_surface_set_paint(const host_surface_set *set, const smr_port *port, const host_volume *grid,
                           host_label_map *map, uint64_t *shared, host_error *error)
{
    host_painted painted;
    uint32_t i = 0;
    int result = 0;
    error->file = set->directory;
    result = host_paint(port, set->load, set->n, grid, &painted, error);
    memset(map, 0, sizeof *map);
    map->label = calloc(set->n, sizeof *map->label);
    if (result == 0 && map->label == NULL)
        result = host_fail(error, "labels", "free memory");
    if (result == 0) {
        map->grid = *grid;
        map->grid.voxels = NULL;
        map->n_layers = 1;
        map->n_labels = set->n;
        map->index = painted.index;
        painted.index = NULL;
        memcpy(map->label, set->label, set->n * sizeof *map->label);
        for (i = 0; i < set->n; i++)
            map->label[i].voxels = painted.voxels[i];
        if (shared != NULL)
            *shared = painted.shared;
    } else {
        host_label_map_free(map);
    }
    host_painted_free(&painted);
    return result == 0 ? 0 : blame(set, error);
}
