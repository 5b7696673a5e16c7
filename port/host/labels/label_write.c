/* label_write.c: writes label maps. Segments: the keys that 3D Slicer needs; their Extent is the box of the voxels, for
 * Slicer cuts off what lies outside.
 * SPDX-License-Identifier: MIT */
#include "labels/label_write.h"

#include <stdlib.h>
#include <string.h>

#include "files/file_names.h"
#include "files/gzip_write.h"
#include "volumes/volume_write.h"

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
    uint32_t i = 0, n = 0;
    if (box == NULL)
        return -1;
    find_boxes(map, box);
    for (i = 0; i < map->n_labels; i++) {
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
    size_t i = 0;
    if (host_buffer_reserve(out, n * bytes) != 0)
        return -1;
    for (i = 0; i < n; i++) {
        const uint32_t value = map->index[i] > 0 ? map->label[map->index[i] - 1u].value : 0;
        out->data[out->size++] = (unsigned char)value;
        if (bytes > 1u)
            out->data[out->size++] = (unsigned char)(value >> 8);
    }
    return 0;
}

static int write_nifti(const host_label_map *map, uint32_t type, const char *path, host_buffer *out, host_error *error)
{
    host_buffer plain;
    int result = 0;
    memset(&plain, 0, sizeof plain);
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
    host_buffer keys;
    uint32_t i = 0, most = 0, type = HOST_UINT8;
    int result = 0;
    memset(&keys, 0, sizeof keys);
    for (i = 0; i < map->n_labels; i++)
        most = map->label[i].value > most ? map->label[i].value : most;
    if (most > VALUE_MAX)
        return host_fail(error, "labels", "labels of at most %u, found %u", VALUE_MAX, most);
    type = most > 255u ? HOST_UINT16 : HOST_UINT8;
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
