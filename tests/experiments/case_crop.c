/* case_crop.c: images that show the upper part of a structure: the slices of an image above a height; noise.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "volumes/voxel_volume.h"

/* Writes an image with other voxels, and frees its own. */
static void write_volume(host_volume *image, const unsigned char *voxels, const char *out)
{
    host_buffer bytes = {0};
    host_volume_write_header(image, image->type, 1, "", out, &bytes);
    host_volume_write_values(voxels, image->type, (size_t)image->size[0] * image->size[1] * image->size[2], &bytes);
    FILE *const file = fopen(out, "wb");
    if (file == NULL || bytes.failed || fwrite(bytes.data, 1, bytes.size, file) != bytes.size || fclose(file) != 0)
        case_fail(out);
    host_buffer_free(&bytes);
    host_volume_free(image);
}

/* Writes the slices of an image from z mm on. The axes are the patient's. */
static void crop(const char *path, double z, const char *out)
{
    host_volume image;
    host_error error = {0};
    if (host_volume_read(path, &image, &error) != 0)
        case_fail(path);
    const double first = ceil((z - (double)image.origin[2]) / (double)image.spacing[2]);
    const uint32_t from = first > 0.0 ? (uint32_t)first : 0u, slice = image.size[0] * image.size[1];
    if (first >= (double)image.size[2])
        case_fail("no slice is left");
    image.size[2] -= from;
    image.origin[2] += (float)from * image.spacing[2];
    write_volume(&image, (unsigned char *)image.voxels + host_volume_voxel_bytes(image.type) * slice * from, out);
}

/* FILE OUT SHARE SEED: the image with Rician noise: the length of the intensity plus noise, and of noise, both of a
 * deviation of SHARE times the 99.5 percentile; rounded, and at most 255. */
void case_rician(char **word)
{
    host_volume image;
    host_error error = {0};
    oracle_random r = oracle_seed((uint32_t)atoi(word[3]));
    size_t n_of[256] = {0}, n = 0, below = 0;
    int top = 0;
    if (host_volume_read(word[0], &image, &error) != 0 || image.type != SMR_VOXEL_UINT8)
        case_fail(word[0]);
    unsigned char *const voxel = image.voxels;
    n = (size_t)image.size[0] * image.size[1] * image.size[2];
    for (size_t i = 0; i < n; i++)
        n_of[voxel[i]]++;
    while (top < 255 && (double)(below + n_of[top]) < 0.995 * (double)n)
        below += n_of[top++];
    for (size_t i = 0; i < n; i++) {
        const double along = voxel[i] + atof(word[2]) * top * case_random_normal(&r);
        const double across = atof(word[2]) * top * case_random_normal(&r);
        voxel[i] = (unsigned char)fmin(sqrt(along * along + across * across) + 0.5, 255.0);
    }
    write_volume(&image, voxel, word[1]);
}

/* Writes the landmarks of a file that lie above z mm in `there`. */
static void crop_marks(const char *path, const host_landmarks *there, double z, const char *out)
{
    host_landmarks *const marks = case_alloc(1, sizeof *marks), *const kept = case_alloc(1, sizeof *kept);
    case_read_marks(path, marks);
    for (uint32_t i = 0; i < marks->n; i++)
        for (uint32_t k = 0; k < there->n; k++)
            if (strcmp(marks->label[i], there->label[k]) == 0 && (double)there->xyz[k][2] > z) {
                memcpy(kept->xyz[kept->n], marks->xyz[i], sizeof marks->xyz[0]);
                memcpy(kept->label[kept->n++], marks->label[i], sizeof marks->label[0]);
            }
    case_write_marks(kept, out);
    free(marks);
    free(kept);
}

static host_mesh load(const char *word)
{
    const int mirrored = strncmp(word, "x:", 2) == 0;
    return case_load(word + (mirrored ? 2 : 0), mirrored ? HOST_MIRROR_X : HOST_MIRROR_NONE);
}

/* SHARE IMAGE PLACED MODEL TRUTH WHOLE DIR [FROM TO]: a case that an image shows in part: DIR/image.mha has the slices
 * that show the upper share of PLACED's height; DIR/from.csv and to.csv the landmarks that TO has there. PLACED: the
 * model where the image has it; TRUTH: where its vertices belong; WHOLE: the true surface. x: mirrored. */
void case_crop(char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    const host_mesh placed = load(word[2]);
    double low = 0.0;
    const double height = case_height(&placed, &low), z = low + (1.0 - atof(word[0])) * height;
    case_body *const body = case_add(data, word[3] + (strncmp(word[3], "x:", 2) == 0 ? 2 : 0), HOST_MIRROR_NONE);
    body->model = load(word[3]);
    body->truth = load(word[4]);
    body->whole = load(word[5]);
    body->seen = case_alloc(body->model.n_vertices, 1);
    for (uint32_t i = 0; i < body->model.n_vertices; i++)
        body->seen[i] = (double)placed.xyz[3u * (size_t)i + 2u] > z;
    case_write(data, word[6]);
    crop(word[1], z, case_text("%s/image.mha", word[6]));
    if (word[7] != NULL) {
        host_landmarks *const there = case_alloc(1, sizeof *there);
        case_read_marks(word[8], there);
        crop_marks(word[7], there, z, case_text("%s/from.csv", word[6]));
        crop_marks(word[8], there, z, case_text("%s/to.csv", word[6]));
    }
}
