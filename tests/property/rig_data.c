/* rig_data.c: reads a folder of PLY files in the one layout that the test data has.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L
#include "property/rig_data.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "property/rig.h"

static int read_ply(const char *path, smr_mesh *mesh)
{
    char line[256];
    unsigned long nv = 0, nt = 0;
    int binary = 0, ended = 0;
    FILE *f = fopen(path, "rb");
    while (f != NULL && !ended && fgets(line, sizeof line, f) != NULL) {
        binary |= strncmp(line, "format binary_little_endian", 27) == 0;
        nv = strncmp(line, "element vertex ", 15) == 0 ? strtoul(line + 15, NULL, 10) : nv;
        nt = strncmp(line, "element face ", 13) == 0 ? strtoul(line + 13, NULL, 10) : nt;
        ended = strncmp(line, "end_header", 10) == 0;
    }
    int ok = ended && binary && nv > 0u && nv < 1000000u && nt < 1000000u;
    float *xyz = rig_alloc(ok ? nv * 3u * sizeof *xyz : 1u);
    uint32_t *triangle = rig_alloc(ok ? nt * 3u * sizeof *triangle : 1u);
    ok = ok && fread(xyz, 3u * sizeof *xyz, nv, f) == nv;
    for (unsigned long i = 0; ok && i < nt; i++) {
        unsigned char count = 0;
        ok = fread(&count, 1, 1, f) == 1u && count == 3u && fread(triangle + 3u * i, sizeof *triangle, 3, f) == 3u;
    }
    if (f != NULL)
        (void)fclose(f);
    *mesh = (smr_mesh){xyz, triangle, (uint32_t)nv, (uint32_t)nt};
    return ok;
}

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

uint32_t rig_folder(const char *folder, smr_mesh mesh[RIG_STRUCTURES_MAX], char name[][SMR_NAME_BYTES])
{
    const char *root = getenv("SMR_TEST_DATA");
    char path[1024], *file[RIG_STRUCTURES_MAX];
    uint32_t n = 0, read = 0;
    (void)snprintf(path, sizeof path, "%s/%s", root == NULL ? "../shared/data" : root, folder);
    DIR *dir = opendir(path);
    for (struct dirent *d; dir != NULL && n < RIG_STRUCTURES_MAX && (d = readdir(dir)) != NULL;) {
        const size_t length = strlen(d->d_name);
        if (length > 4u && strcmp(d->d_name + length - 4u, ".ply") == 0) {
            file[n] = rig_alloc(length + 1u);
            memcpy(file[n++], d->d_name, length + 1u);
        }
    }
    if (dir != NULL)
        (void)closedir(dir);
    qsort(file, n, sizeof file[0], by_name);
    for (uint32_t i = 0; i < n; i++) {
        (void)snprintf(path, sizeof path, "%s/%s/%s", root == NULL ? "../shared/data" : root, folder, file[i]);
        if (!read_ply(path, &mesh[read]))
            continue;
        for (uint32_t k = 0; name != NULL && k < SMR_NAME_BYTES; k++)
            name[read][k] = '\0';
        for (size_t k = 0; name != NULL && k + 4u < strlen(file[i]) && k + 1u < SMR_NAME_BYTES; k++)
            name[read][k] = file[i][k];
        read++;
    }
    return read;
}
