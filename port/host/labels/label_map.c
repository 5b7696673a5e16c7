/* label_map.c: reads and writes label maps.
 * SPDX-License-Identifier: MIT */
#include "labels/label_map.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/system.h"
#include "files/file_names.h"
#include "files/gzip_write.h"

static int refuse_value(const host_volume *v, size_t i, uint32_t n, host_error *error)
{
    const double value = host_voxel(v->voxels, v->type, i);
    const size_t at = i / n, x = at % v->size[0], y = at / v->size[0] % v->size[1], z = at / v->size[0] / v->size[1];
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
    for (size_t i = 0; i < n; i++) {
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
    for (size_t i = 0; i < n; i++) {
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
    for (size_t i = 0; i < n; i++) {
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
    uint32_t most = 0;
    int result = check_values(v, map->n_layers, &most, error);
    if (result != 0)
        return -1;
    uint16_t *number = calloc((size_t)most + 1u, sizeof *number);
    map->index = host_alloc_scattered(host_label_voxels(map) * map->n_layers * sizeof *map->index);
    map->label = calloc(SMR_STRUCTURES_MAX, sizeof *map->label);
    if (number == NULL || map->index == NULL || map->label == NULL)
        result = host_fail(error, "labels", "free memory");
    for (uint32_t layer = 0; result == 0 && layer < map->n_layers; layer++)
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
    host_buffer keys = {0};
    int result = -1;
    memset(map, 0, sizeof *map);
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
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (strcmp(map->label[i].name, name) == 0)
            return &map->label[i];
    return NULL;
}

double host_label_mm3(const host_volume *grid)
{
    const float *const d = grid->direction;
    double sum = 0.0;
    for (unsigned c = 0; c < 3u; c++)
        sum += (double)d[c] * ((double)d[3u + (c + 1u) % 3u] * (double)d[6u + (c + 2u) % 3u] -
                               (double)d[3u + (c + 2u) % 3u] * (double)d[6u + (c + 1u) % 3u]);
    return sum * (double)grid->spacing[0] * (double)grid->spacing[1] * (double)grid->spacing[2];
}

#define VALUE_MAX 65535u

int host_labels_can_write(const char *path, host_error *error)
{
    const int packed = host_is_packed_name(path);
    error->file = path;
    if (host_has_extension(path, ".nii") ||
        (!packed && (host_has_extension(path, ".nrrd") || host_has_extension(path, ".mha"))))
        return 0;
    return host_fail(error, "name", "an output that ends in .seg.nrrd, .nrrd, .mha, .nii or .nii.gz");
}

/* The boxes of the labels' voxels: box[label][axis][0 low, 1 high]. */
static void find_boxes(const host_label_map *map, uint32_t (*box)[3][2])
{
    const uint32_t *const size = map->grid.size;
    uint32_t at[3], i = 0, k = 0;
    size_t voxel = 0;
    for (i = 0; i < map->n_labels; i++)
        for (k = 0; k < 3u; k++) {
            box[i][k][0] = UINT32_MAX;
            box[i][k][1] = 0;
        }
    for (at[2] = 0; at[2] < size[2]; at[2]++)
        for (at[1] = 0; at[1] < size[1]; at[1]++)
            for (at[0] = 0; at[0] < size[0]; at[0]++, voxel++)
                for (k = 0; map->index[voxel] > 0 && k < 3u; k++) {
                    uint32_t *const of = box[map->index[voxel] - 1u][k];
                    of[0] = at[k] < of[0] ? at[k] : of[0];
                    of[1] = at[k] > of[1] ? at[k] : of[1];
                }
}

/* The keys of a .seg.nrrd; a label without voxels is no segment. */
static int put_segments(const host_label_map *map, host_buffer *keys)
{
    uint32_t(*const box)[3][2] = malloc((map->n_labels + 1u) * sizeof *box);
    uint32_t n = 0;
    if (box == NULL)
        return -1;
    find_boxes(map, box);
    for (uint32_t i = 0; i < map->n_labels; i++) {
        const host_label *const label = &map->label[i];
        if (box[i][0][0] > box[i][0][1])
            continue;
        host_buffer_print(keys,
                          "Segment%u_ID:=%s\nSegment%u_Name:=%s\nSegment%u_Color:=%.6g %.6g %.6g\n"
                          "Segment%u_LabelValue:=%u\nSegment%u_Layer:=0\nSegment%u_Extent:=%u %u %u %u %u %u\n",
                          n, label->name, n, label->name, n, (double)label->colour[0], (double)label->colour[1],
                          (double)label->colour[2], n, label->value, n, n, box[i][0][0], box[i][0][1], box[i][1][0],
                          box[i][1][1], box[i][2][0], box[i][2][1]);
        n++;
    }
    host_buffer_print(keys, "Segmentation_ContainedRepresentationNames:=Binary labelmap|Closed surface|\n");
    free(box);
    return keys->failed ? -1 : 0;
}

/* The voxels' labels as bytes, or two each. */
static int put_values(const host_label_map *map, uint32_t type, host_buffer *out)
{
    const size_t n = host_label_voxels(map);
    const uint32_t bytes = host_volume_voxel_bytes(type);
    if (host_buffer_reserve(out, n * bytes) != 0)
        return -1;
    for (size_t i = 0; i < n; i++) {
        const uint32_t value = map->index[i] > 0 ? map->label[map->index[i] - 1u].value : 0;
        out->data[out->size++] = (unsigned char)value;
        if (bytes > 1u)
            out->data[out->size++] = (unsigned char)(value >> 8);
    }
    return 0;
}

static int write_nifti(const host_label_map *map, uint32_t type, const char *path, host_buffer *out, host_error *error)
{
    host_buffer plain = {0};
    int result = 0;
    if (host_volume_write_nifti(&map->grid, type, &plain) != 0)
        result = host_fail(error, "size", "at most 32767 voxels along an axis, for NIfTI");
    else if (put_values(map, type, &plain) != 0)
        result = host_fail(error, "output", "free memory");
    if (result == 0 && host_is_packed_name(path)) {
        host_gzip_write(plain.data, plain.size, out);
    } else if (result == 0) {
        *out = plain;
        return 0;
    }
    host_buffer_free(&plain);
    return result;
}

int host_labels_write(const host_label_map *map, const char *path, host_buffer *out, host_error *error)
{
    host_buffer keys = {0};
    uint32_t most = 0, type = SMR_VOXEL_UINT8;
    int result = 0;
    for (uint32_t i = 0; i < map->n_labels; i++)
        most = map->label[i].value > most ? map->label[i].value : most;
    if (most > VALUE_MAX)
        return host_fail(error, "labels", "labels of at most %u, found %u", VALUE_MAX, most);
    type = most > 255u ? SMR_VOXEL_UINT16 : SMR_VOXEL_UINT8;
    if (host_has_extension(path, ".nii"))
        return write_nifti(map, type, path, out, error);
    if (host_has_extension(path, ".seg.nrrd"))
        result = put_segments(map, &keys);
    host_buffer_add(&keys, "", 1);
    if (result == 0 && !keys.failed) {
        host_volume_write_header(&map->grid, type, 1, (const char *)keys.data, path, out);
        result = put_values(map, type, out);
    }
    result = result != 0 || keys.failed || out->failed ? host_fail(error, "output", "free memory") : 0;
    host_buffer_free(&keys);
    return result;
}
