/* volume_file.c: reads a volume file of any format: finds the format and calls its reader. Mirrors and frees volumes.
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>

#include "files/file_names.h"
#include "volumes/volume_reader.h"

typedef int (*read_function)(host_volume_reader *reader, const unsigned char *data, size_t n);

static int starts_with(const unsigned char *head, size_t n, const char *text)
{
    const size_t k = strlen(text);
    return n >= k && memcmp(head, text, k) == 0;
}

/* A NIfTI file starts with the size of its header: 348, or 540 in version 2. */
static int looks_like_nifti(const unsigned char *head, size_t n)
{
    int order = 0;
    for (order = 0; n >= 348u && order < 2; order++) {
        const double bytes = host_type_read(HOST_TYPE_I32, head, order);
        if (bytes >= 348.0 && bytes <= 348.0 && (head[344] == 'n'))
            return 1;
        if (bytes >= 540.0 && bytes <= 540.0 && head[4] == 'n')
            return 1;
    }
    return 0;
}

static read_function reader_for(const char *path, const unsigned char *head, size_t n)
{
    if (starts_with(head, n, "NRRD0"))
        return host_read_nrrd;
    if (starts_with(head, n, "ObjectType") || starts_with(head, n, "NDims"))
        return host_read_metaimage;
    if (looks_like_nifti(head, n))
        return host_read_nifti;
    if (host_has_extension(path, ".mha") || host_has_extension(path, ".mhd"))
        return host_read_metaimage;
    if (host_has_extension(path, ".nrrd") || host_has_extension(path, ".nhdr"))
        return host_read_nrrd;
    if (host_has_extension(path, ".nii"))
        return host_read_nifti;
    return NULL;
}

static int accept_volume(const char *path, const unsigned char *head, size_t n, size_t total, host_error *error)
{
    (void)total;
    if (reader_for(path, head, n) != NULL)
        return 0;
    if (host_has_extension(path, ".dcm") || (n >= 132u && memcmp(head + 128, "DICM", 4) == 0))
        return host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume; dcm2niix makes one of a DICOM series");
    return host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume");
}

static int read_file(const char *path, host_volume *volume, uint32_t *layers, host_buffer *keys, host_error *error)
{
    host_bytes bytes;
    host_volume_reader reader;
    read_function read = NULL;
    int result = 0;
    memset(volume, 0, sizeof *volume);
    memset(&reader, 0, sizeof reader);
    reader.volume = volume;
    reader.error = error;
    reader.path = path;
    reader.keys = keys;
    if (host_file_read(path, accept_volume, &bytes, error) != 0)
        return -1;
    read = reader_for(path, bytes.data, bytes.size);
    result = read != NULL ? read(&reader, bytes.data, bytes.size)
                          : host_fail(error, "content", "a MetaImage, NIfTI-1 or NRRD volume");
    host_file_free(&bytes);
    host_file_free(&reader.detached);
    if (result != 0)
        host_volume_free(volume);
    *layers = reader.layers > 0u ? reader.layers : 1u;
    return result;
}

int host_volume_read(const char *path, host_volume *volume, host_error *error)
{
    uint32_t layers = 0;
    return read_file(path, volume, &layers, NULL, error);
}

int host_volume_read_layers(const char *path, host_volume *volume, uint32_t *layers, host_buffer *keys,
                            host_error *error)
{
    return read_file(path, volume, layers, keys, error);
}

void host_volume_free(host_volume *volume)
{
    free(volume->voxels);
    memset(volume, 0, sizeof *volume);
}

void host_volume_mirror(host_volume *volume, int axis)
{
    const size_t row = (size_t)axis;
    size_t j = 0;
    /* 0 - x instead of -x: does not turn 0 into -0, which prints differently */
    volume->origin[row] = 0.0f - volume->origin[row];
    for (j = 0; j < 3; j++)
        volume->direction[3u * row + j] = 0.0f - volume->direction[3u * row + j];
}

int host_is_volume_path(const char *path)
{
    static const char *const endings[] = {".mha", ".mhd", ".nii", ".nrrd", ".nhdr", ".dcm"};
    size_t i = 0;
    for (i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (host_has_extension(path, endings[i]))
            return 1;
    return 0;
}
