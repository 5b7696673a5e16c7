/* label_map.c: reads label maps: checks each voxel's number and gives its label a number from 1 on.
 * SPDX-License-Identifier: MIT */
#include "labels/label_map.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/memory.h"
#include "labels/label_names.h"

static int refuse_value(const host_volume *v, size_t i, uint32_t layers, host_error *error)
{
    const double value = host_voxel(v->voxels, v->type, i);
    const size_t at = i / layers, x = at % v->size[0], y = at / v->size[0] % v->size[1],
                 z = at / v->size[0] / v->size[1];
    char place[64];
    (void)snprintf(place, sizeof place, "voxel %zu %zu %zu", x, y, z);
    return host_fail(error, place, "a label, a whole number from 0 to %u, found %g: is it an image?", HOST_LABEL_MAX,
                     value);
}

/* Checks all values. *most: the largest. */
static int check_values(const host_volume *v, uint32_t layers, uint32_t *most, host_error *error)
{
    const size_t n = (size_t)v->size[0] * v->size[1] * v->size[2] * layers;
    double high = 0.0;
    size_t i = 0;
    for (i = 0; i < n; i++) {
        const double value = host_voxel(v->voxels, v->type, i);
        if (!(value >= 0.0 && value <= (double)HOST_LABEL_MAX) || floor(value) < value) /* so that NaN fails */
            return refuse_value(v, i, layers, error);
        high = value > high ? value : high;
    }
    *most = (uint32_t)high;
    return 0;
}

static int by_value(const void *a, const void *b)
{
    const uint32_t *const x = a, *const y = b;
    return (*x > *y) - (*x < *y);
}

/* Adds the labels of a layer, in the order of their values. number: of all values there are, 0 before and after. */
static int number_layer(host_label_map *map, const host_volume *v, uint32_t layer, uint16_t *number, host_error *error)
{
    const size_t n = host_label_voxels(map);
    uint32_t met[SMR_STRUCTURES_MAX], n_met = 0, k = 0;
    size_t i = 0;
    for (i = 0; i < n; i++) {
        const uint32_t value = (uint32_t)host_voxel(v->voxels, v->type, i * map->n_layers + layer);
        if (value == 0 || number[value] != 0)
            continue;
        if (map->n_labels + n_met == SMR_STRUCTURES_MAX)
            return host_fail(error, "labels", "at most %u of them, found more: is it an image?", SMR_STRUCTURES_MAX);
        number[value] = 1;
        met[n_met++] = value;
    }
    qsort(met, n_met, sizeof *met, by_value);
    for (k = 0; k < n_met; k++) {
        map->label[map->n_labels].value = met[k];
        map->label[map->n_labels++].layer = layer;
        number[met[k]] = (uint16_t)map->n_labels;
    }
    for (i = 0; i < n; i++) {
        const uint16_t label = number[(uint32_t)host_voxel(v->voxels, v->type, i * map->n_layers + layer)];
        map->index[layer * n + i] = label;
        if (label > 0)
            map->label[label - 1u].voxels++;
    }
    for (k = 0; k < n_met; k++)
        number[met[k]] = 0;
    return 0;
}

static int number_labels(host_label_map *map, const host_volume *v, host_error *error)
{
    uint32_t most = 0, layer = 0;
    uint16_t *number = NULL;
    int result = check_values(v, map->n_layers, &most, error);
    if (result != 0)
        return -1;
    number = calloc((size_t)most + 1u, sizeof *number);
    map->index = host_alloc_scattered(host_label_voxels(map) * map->n_layers * sizeof *map->index);
    map->label = calloc(SMR_STRUCTURES_MAX, sizeof *map->label);
    if (number == NULL || map->index == NULL || map->label == NULL)
        result = host_fail(error, "labels", "free memory");
    for (layer = 0; result == 0 && layer < map->n_layers; layer++)
        result = number_layer(map, v, layer, number, error);
    free(number);
    if (result == 0 && map->n_labels == 0)
        return host_fail(error, "labels", "a voxel that is not 0");
    return result;
}

/* Names the labels by the file of names, by the map's own keys, or by their values. */
static int name_labels(host_label_map *map, const host_buffer *keys, const char *path, host_error *error)
{
    host_names names = {NULL, 0};
    const char *const of_map = error->file;
    int result = host_labels_take_segments(map, keys, error);
    if (result == 0 && path != NULL) {
        result = host_names_read(path, &names, error);
        if (result == 0)
            error->file = of_map;
    }
    if (result == 0)
        result = host_labels_settle_names(map, &names, error);
    host_names_free(&names);
    return result;
}

int host_label_map_read(const char *path, const char *names, host_label_map *map, host_error *error)
{
    host_buffer keys;
    int result = -1;
    memset(map, 0, sizeof *map);
    memset(&keys, 0, sizeof keys);
    error->file = path;
    if (host_volume_read_layers(path, &map->grid, &map->n_layers, &keys, error) == 0) {
        if (keys.failed)
            (void)host_fail(error, "header", "free memory");
        else if (number_labels(map, &map->grid, error) == 0)
            result = name_labels(map, &keys, names, error);
    }
    free(map->grid.voxels);
    map->grid.voxels = NULL;
    host_buffer_free(&keys);
    if (result != 0)
        host_label_map_free(map);
    return result;
}

void host_label_map_free(host_label_map *map)
{
    free(map->index);
    free(map->label);
    memset(map, 0, sizeof *map);
}

const host_label *host_label_find(const host_label_map *map, const char *name)
{
    uint32_t i = 0;
    for (i = 0; i < map->n_labels; i++)
        if (strcmp(map->label[i].name, name) == 0)
            return &map->label[i];
    return NULL;
}

double host_label_mm3(const host_volume *grid)
{
    const float *const d = grid->direction;
    double sum = 0.0;
    unsigned c = 0;
    for (c = 0; c < 3u; c++)
        sum += (double)d[c] * ((double)d[3u + (c + 1u) % 3u] * (double)d[6u + (c + 2u) % 3u] -
                               (double)d[3u + (c + 2u) % 3u] * (double)d[6u + (c + 1u) % 3u]);
    return sum * (double)grid->spacing[0] * (double)grid->spacing[1] * (double)grid->spacing[2];
}
