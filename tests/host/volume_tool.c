/* volume_tool.c: prints what the host's readers make of a volume or landmark file, makes parts of sample files, or
 * feeds damaged files to the readers.
 * Usage: volume_tool info FILE [AXIS] | voxel FILE X Y Z | where FILE X Y Z | name PATH | voxels TYPE ORDER OUT |
 *     nifti FORM TYPE ORDER OUT | patch FILE OFFSET HEX OUT | zlib RAW GZIP OUT | landmarks FILE |
 *     pair MODEL TARGET | fuzz FILE N SEED | fuzz-landmarks FILE N SEED
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "landmarks/landmarks.h"
#include "volumes/volume_reader.h"

enum { SIZE_X = 5, SIZE_Y = 4, SIZE_Z = 3, VOXELS = SIZE_X * SIZE_Y * SIZE_Z };

static const struct {
    const char *name;
    host_type type;
    int code; /* NIfTI's */
} types[] = {{"int8", HOST_TYPE_I8, 256},    {"uint8", HOST_TYPE_U8, 2},      {"int16", HOST_TYPE_I16, 4},
             {"uint16", HOST_TYPE_U16, 512}, {"int32", HOST_TYPE_I32, 8},     {"uint32", HOST_TYPE_U32, 768},
             {"int64", HOST_TYPE_I64, 1024}, {"uint64", HOST_TYPE_I64, 1280}, {"float", HOST_TYPE_F32, 16},
             {"double", HOST_TYPE_F64, 64}};

static size_t type_index(const char *name)
{
    size_t i = 0;
    while (i + 1u < sizeof types / sizeof types[0] && strcmp(types[i].name, name) != 0)
        i++;
    return i;
}

static int read_volume(const char *path, host_volume *volume)
{
    host_error error = {0};
    if (host_volume_read(path, volume, &error) == 0)
        return 0;
    host_error_print(&error);
    return 2;
}

static void print_row(const char *name, const float *values, int n)
{
    printf(" %s", name);
    for (int i = 0; i < n; i++) /* adding 0 makes -0 of rounding print as 0 */
        printf(" %.3f", round((double)values[i] * 1e3) / 1e3 + 0.0);
}

static int info(const char *path, int axis)
{
    static const char *const names[] = {"uint8", "int8", "uint16", "int16", "float"};
    host_volume volume;
    double low = HUGE_VAL, high = -HUGE_VAL, sum = 0.0;
    size_t i = 0, n = 0, nan = 0;
    if (read_volume(path, &volume) != 0)
        return 2;
    if (axis >= 0)
        host_volume_mirror(&volume, axis);
    n = (size_t)volume.size[0] * volume.size[1] * volume.size[2];
    for (i = 0; i < n; i++) {
        const double v = host_voxel(volume.voxels, volume.type, i);
        nan += isnan(v) ? 1u : 0u;
        if (!isnan(v))
            sum += v * (double)(i % 251u + 1u);
        low = v < low ? v : low;
        high = v > high ? v : high;
    }
    printf("%s %u %u %u", names[volume.type], volume.size[0], volume.size[1], volume.size[2]);
    print_row("o", volume.origin, 3);
    print_row("s", volume.spacing, 3);
    print_row("d", volume.direction, 9);
    printf(" v %g %g %.1f %zu\n", low, high, sum, nan);
    host_volume_free(&volume);
    return 0;
}

static int print_voxel(const char *path, char **index)
{
    host_volume volume;
    size_t x = 0, y = 0, z = 0;
    if (read_volume(path, &volume) != 0)
        return 2;
    x = (size_t)atoi(index[0]);
    y = (size_t)atoi(index[1]);
    z = (size_t)atoi(index[2]);
    printf("%.9g\n", host_voxel(volume.voxels, volume.type, (z * volume.size[1] + y) * volume.size[0] + x));
    host_volume_free(&volume);
    return 0;
}

/* Prints the position of a voxel's centre, mm. */
static int print_where(const char *path, char **index)
{
    host_volume volume;
    if (read_volume(path, &volume) != 0)
        return 2;
    for (int i = 0; i < 3; i++) {
        double at = (double)volume.origin[i];
        for (int j = 0; j < 3; j++)
            at += (double)volume.direction[3 * i + j] * (double)volume.spacing[j] * atof(index[j]);
        printf("%.6f%c", at, i < 2 ? ' ' : '\n');
    }
    host_volume_free(&volume);
    return 0;
}

static int write_file(const char *path, const unsigned char *data, size_t n)
{
    FILE *const file = fopen(path, "wb");
    int good = file != NULL && fwrite(data, 1, n, file) == n;
    if (file != NULL && fclose(file) != 0)
        good = 0;
    return good ? 0 : 2;
}

static void put_bits(unsigned char *to, uint64_t bits, size_t n, int big)
{
    for (size_t i = 0; i < n; i++)
        to[i] = (unsigned char)(bits >> 8 * (big ? n - 1u - i : i));
}

static void put_float(unsigned char *to, float value, int big)
{
    uint32_t bits = 0;
    memcpy(&bits, &value, 4);
    put_bits(to, bits, 4, big);
}

/* The sample: voxel (i, j, k) is i + 7 j + 31 k, less 40 for signed types. */
static size_t sample(size_t type, int big, unsigned char *to)
{
    const size_t bytes = host_type_bytes(types[type].type);
    for (int i = 0; i < VOXELS; i++) {
        const int less = types[type].name[0] == 'u' ? 0 : 40;
        const int v = i % SIZE_X + 7 * (i / SIZE_X % SIZE_Y) + 31 * (i / SIZE_X / SIZE_Y) - less;
        const double d = v;
        uint64_t bits = (uint64_t)(int64_t)v;
        if (types[type].type == HOST_TYPE_F32) {
            put_float(to + (size_t)i * bytes, (float)v, big);
            continue;
        }
        if (types[type].type == HOST_TYPE_F64)
            memcpy(&bits, &d, 8);
        put_bits(to + (size_t)i * bytes, bits, bytes, big);
    }
    return bytes * VOXELS;
}

/* The sample as NIfTI: LPS origin 10 -20 30, spacing 1.5 2 4, turned by 30 degrees about z. form: s, q or none. */
static int make_nifti(const char *form, const char *type_name, int big, const char *out)
{
    static const double spacing[3] = {1.5, 2.0, 4.0};
    const size_t type = type_index(type_name);
    const double c = sqrt(0.75), turn[3][3] = {{-c, 0.5, 0.0}, {-0.5, -c, 0.0}, {0.0, 0.0, 1.0}};
    const double origin[3] = {-10.0, 20.0, 30.0};
    unsigned char data[352 + 8 * VOXELS] = {0};
    put_bits(data, 348, 4, big);
    for (size_t i = 0; i < 8; i++)
        put_bits(data + 40 + 2 * i, i == 0 ? 3 : i == 1 ? SIZE_X : i == 2 ? SIZE_Y : i == 3 ? SIZE_Z : 1, 2, big);
    put_bits(data + 70, (uint64_t)types[type].code, 2, big);
    put_bits(data + 72, 8u * host_type_bytes(types[type].type), 2, big);
    put_float(data + 76, 1.0f, big);
    put_float(data + 108, 352.0f, big);
    data[123] = 2;
    put_bits(data + 252, form[0] == 'q', 2, big);
    put_bits(data + 254, form[0] == 's', 2, big);
    put_float(data + 264, -0.96592583f, big);
    for (size_t i = 0; i < 3; i++) {
        put_float(data + 80 + 4 * i, (float)spacing[i], big);
        put_float(data + 268 + 4 * i, (float)origin[i], big);
        for (size_t j = 0; j < 3; j++)
            put_float(data + 280 + 16 * i + 4 * j, (float)(turn[i][j] * spacing[j]), big);
        put_float(data + 292 + 16 * i, (float)origin[i], big);
    }
    memcpy(data + 344, "n+1", 4);
    return write_file(out, data, 352u + sample(type, big, data + 352));
}

static int read_bytes(const char *path, host_bytes *bytes)
{
    FILE *const file = fopen(path, "rb");
    bytes->data = malloc((size_t)1 << 22);
    if (file == NULL || bytes->data == NULL)
        return 2;
    bytes->size = fread(bytes->data, 1, (size_t)1 << 22, file);
    return fclose(file) == 0 ? 0 : 2;
}

static int patch(const char *in, size_t at, const char *hex, const char *out)
{
    host_bytes bytes;
    int result = read_bytes(in, &bytes);
    for (; result == 0 && hex[0] != '\0' && hex[1] != '\0' && at < bytes.size; hex += 2, at++) {
        const char pair[3] = {hex[0], hex[1], '\0'};
        bytes.data[at] = (unsigned char)strtoul(pair, NULL, 16);
    }
    result = result == 0 ? write_file(out, bytes.data, bytes.size) : result;
    free(bytes.data);
    return result;
}

/* A zlib stream out of gzip's (written with -n): other header, other sum. */
static int make_zlib(const char *raw_path, const char *gzip_path, const char *out)
{
    host_bytes raw, packed;
    uint32_t a = 1, b = 0;
    if (read_bytes(raw_path, &raw) != 0 || read_bytes(gzip_path, &packed) != 0 || packed.size < 18u)
        return 2;
    for (size_t i = 0; i < raw.size; i++) {
        a = (a + raw.data[i]) % 65521u;
        b = (b + a) % 65521u;
    }
    packed.data[8] = 0x78;
    packed.data[9] = 0x9c;
    put_bits(packed.data + packed.size - 8u, (b << 16) | a, 4, 1);
    int result = write_file(out, packed.data + 8, packed.size - 12u);
    free(raw.data);
    free(packed.data);
    return result;
}

static int print_landmarks(const char *path)
{
    host_landmarks set;
    host_error error = {0};
    if (host_landmarks_read(path, &set, &error) != 0) {
        host_error_print(&error);
        return 2;
    }
    for (uint32_t i = 0; i < set.n; i++)
        printf("%s: %.3f %.3f %.3f\n", set.label[i], (double)set.xyz[i][0], (double)set.xyz[i][1],
               (double)set.xyz[i][2]);
    return 0;
}

static int print_pairs(const char *model_path, const char *target_path)
{
    static host_landmarks model, target;
    float from[64][3], to[64][3];
    uint32_t n = 0, i = 0;
    host_error error = {0};
    if (host_landmarks_read(model_path, &model, &error) != 0 ||
        host_landmarks_read(target_path, &target, &error) != 0 ||
        host_landmarks_pair(&model, &target, model_path, target_path, from, to, &n, &error) != 0) {
        host_error_print(&error);
        return 2;
    }
    for (i = 0; i < n; i++)
        printf("%.3f %.3f %.3f -> %.3f %.3f %.3f\n", (double)from[i][0], (double)from[i][1], (double)from[i][2],
               (double)to[i][0], (double)to[i][1], (double)to[i][2]);
    return 0;
}

/* Reads from a copy of exactly n bytes, so that a sanitizer sees every step beyond. 1: read, 0: refused. */
static int try_volume(const unsigned char *data, size_t n, const char *path)
{
    unsigned char *const copy = malloc(n > 0 ? n : 1u);
    host_volume volume;
    host_volume_reader reader;
    host_error error = {0};
    if (copy == NULL)
        abort();
    memcpy(copy, data, n);
    memset(&volume, 0, sizeof volume);
    memset(&reader, 0, sizeof reader);
    reader.volume = &volume;
    reader.error = &error;
    reader.path = path;
    int good = (strstr(path, ".nii") != NULL    ? host_read_nifti(&reader, copy, n)
                : strstr(path, ".nrrd") != NULL ? host_read_nrrd(&reader, copy, n)
                                                : host_read_metaimage(&reader, copy, n)) == 0;
    if (!good && (error.place[0] == '\0' || error.expected[0] == '\0'))
        abort();
    if (good &&
        (volume.voxels == NULL || !(volume.spacing[0] > 0.0f) || volume.size[2] == 0 || volume.type > SMR_VOXEL_FLOAT))
        abort();
    host_volume_free(&volume);
    host_file_free(&reader.detached);
    free(copy);
    return good;
}

static int try_landmarks(const unsigned char *data, size_t n, const char *path)
{
    char *const copy = malloc(n > 0 ? n : 1u);
    static host_landmarks set;
    host_error error = {0};
    if (copy == NULL)
        abort();
    memcpy(copy, data, n);
    memset(&set, 0, sizeof set);
    int good = (strstr(path, ".json") != NULL
                    ? host_read_markups(&set, copy, n, &error)
                    : host_read_landmark_table(&set, copy, n, strstr(path, ".fcsv") != NULL, &error)) == 0;
    if ((!good && error.place[0] == '\0') || set.n > HOST_LANDMARKS_MAX)
        abort();
    free(copy);
    return good;
}

static uint32_t next_random(uint32_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* Damages 1 to 4 bytes, cuts every fourth file. Bytes near the start, where headers are, are hit more often. */
static int fuzz(const char *path, int n, uint32_t seed, int (*try_one)(const unsigned char *, size_t, const char *))
{
    host_bytes whole;
    int i = 0, k = 0, good = 0;
    if (read_bytes(path, &whole) != 0 || whole.size == 0)
        return 2;
    unsigned char *damaged = malloc(whole.size);
    if (damaged == NULL)
        return 2;
    seed = seed * 2654435761u + 1u;
    for (i = 0; i < n; i++) {
        static const char marks[] = "0-9.,:=({[\"\\\n e";
        size_t size = whole.size;
        memcpy(damaged, whole.data, whole.size);
        for (k = (int)(next_random(&seed) % 4u); k >= 0; k--) {
            const size_t near = size < 600u || next_random(&seed) % 3u == 0 ? size : 600u;
            const uint32_t r = next_random(&seed);
            const char mark = marks[(r >> 8) % (sizeof marks - 1u)];
            damaged[next_random(&seed) % near] = (unsigned char)(r % 2u == 0 ? r >> 8 : (unsigned char)mark);
        }
        if (next_random(&seed) % 4u == 0)
            size = next_random(&seed) % size;
        good += try_one(damaged, size, path);
    }
    printf("%d read, %d refused\n", good, n - good);
    free(whole.data);
    free(damaged);
    return 0;
}

int main(int argc, char **argv)
{
    const char *const command = argc >= 3 ? argv[1] : "";
    unsigned char data[8 * VOXELS];
    if (strcmp(command, "info") == 0)
        return info(argv[2], argc > 3 ? atoi(argv[3]) : -1);
    if (strcmp(command, "voxel") == 0 && argc == 6)
        return print_voxel(argv[2], argv + 3);
    if (strcmp(command, "where") == 0 && argc == 6)
        return print_where(argv[2], argv + 3);
    if (strcmp(command, "name") == 0)
        return host_is_volume_path(argv[2]) ? 0 : 1;
    if (strcmp(command, "voxels") == 0 && argc == 5)
        return write_file(argv[4], data, sample(type_index(argv[2]), argv[3][0] == 'b', data));
    if (strcmp(command, "nifti") == 0 && argc == 6)
        return make_nifti(argv[2], argv[3], argv[4][0] == 'b', argv[5]);
    if (strcmp(command, "patch") == 0 && argc == 6)
        return patch(argv[2], (size_t)atol(argv[3]), argv[4], argv[5]);
    if (strcmp(command, "zlib") == 0 && argc == 5)
        return make_zlib(argv[2], argv[3], argv[4]);
    if (strcmp(command, "landmarks") == 0)
        return print_landmarks(argv[2]);
    if (strcmp(command, "pair") == 0 && argc == 4)
        return print_pairs(argv[2], argv[3]);
    if (strcmp(command, "fuzz") == 0 && argc == 5)
        return fuzz(argv[2], atoi(argv[3]), (uint32_t)atoi(argv[4]), try_volume);
    if (strcmp(command, "fuzz-landmarks") == 0 && argc == 5)
        return fuzz(argv[2], atoi(argv[3]), (uint32_t)atoi(argv[4]), try_landmarks);
    (void)fputs("usage: see the first lines of volume_tool.c\n", stderr);
    return 2;
}
