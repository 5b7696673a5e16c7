/* volume_metaimage.c: reads MetaImage (.mha, .mhd with a data file): "key = value" lines, then the voxels.
 *
 * TransformMatrix lists the direction of the first axis first. Offset is the centre of the first voxel. Both are LPS.
 * AnatomicalOrientation is ignored. ElementSize is the spacing where there is no ElementSpacing, as in ITK and VTK.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "volumes/volume_reader.h"

typedef struct meta_header {
    int64_t size[3];
    int has_size, binary, packed, big_endian;
    int last; /* ElementDataFile was read, which ends the header */
    int64_t packed_bytes, header_bytes;
    double spacing[3], extent[3], matrix[9], offset[3]; /* extent: of a voxel (ElementSize), mm; 0: not said */
    host_word file;
} meta_header;

typedef int (*key_function)(host_volume_reader *reader, meta_header *header, host_text *words);

/* Reads exactly n numbers up to the end of the line. */
static int numbers(host_text *words, int n, double *values)
{
    host_word word;
    for (int i = 0; i < n; i++)
        if (!host_text_word_in_line(words, &word) || !host_word_double(word, &values[i]))
            return 0;
    return !host_text_word_in_line(words, &word);
}

static int one_word(host_text *words, host_word *word)
{
    host_word more;
    return host_text_word_in_line(words, word) && !host_text_word_in_line(words, &more);
}

/* Reads True (1) or False (0); -1 for others. */
static int truth(host_volume_reader *reader, host_text *words, const char *key, int *value)
{
    host_word word;
    const int one = one_word(words, &word);
    *value = one && (host_word_is_nocase(word, "true") || host_word_is(word, "1"));
    if (*value || (one && (host_word_is_nocase(word, "false") || host_word_is(word, "0"))))
        return 0;
    return host_volume_fail(reader, "%s = True or False", key);
}

static int whole(host_volume_reader *reader, host_text *words, const char *key, int64_t low, int64_t *value)
{
    host_word word;
    if (!one_word(words, &word) || !host_word_int(word, value) || *value < low)
        return host_volume_fail(reader, "%s = a whole number", key);
    return 0;
}

static int key_object(host_volume_reader *reader, meta_header *header, host_text *words)
{
    host_word word;
    (void)header;
    if (!one_word(words, &word) || !host_word_is_nocase(word, "image"))
        return host_volume_fail(reader, "ObjectType = Image");
    return 0;
}

static int key_dimensions(host_volume_reader *reader, meta_header *header, host_text *words)
{
    int64_t n = 0;
    (void)header;
    if (whole(reader, words, "NDims", 1, &n) != 0)
        return -1;
    return n == 3 ? 0 : host_volume_fail(reader, "NDims = 3 (other images are not read)");
}

static int key_channels(host_volume_reader *reader, meta_header *header, host_text *words)
{
    int64_t n = 0;
    (void)header;
    if (whole(reader, words, "ElementNumberOfChannels", 1, &n) != 0)
        return -1;
    return n == 1 ? 0 : host_volume_fail(reader, "ElementNumberOfChannels = 1 (colour and vectors are not read)");
}

static int key_size(host_volume_reader *reader, meta_header *header, host_text *words)
{
    host_word word;
    for (int i = 0; i < 3; i++)
        if (!host_text_word_in_line(words, &word) || !host_word_int(word, &header->size[i]))
            return host_volume_fail(reader, "DimSize = three counts");
    if (host_text_word_in_line(words, &word))
        return host_volume_fail(reader, "DimSize = three counts, found more");
    header->has_size = 1;
    return host_volume_set_size(reader, "DimSize", header->size);
}

static int lengths(host_volume_reader *reader, host_text *words, const char *key, double mm[3])
{
    if (!numbers(words, 3, mm))
        return host_volume_fail(reader, "%s = three numbers", key);
    for (int i = 0; i < 3; i++)
        if (!(mm[i] > 0.0 && mm[i] <= (double)SMR_COORD_MAX)) /* written so that NaN fails */
            return host_volume_fail(reader, "%s = three positive numbers, found %g", key, mm[i]);
    return 0;
}

/* Positions are millimetres: no unit is converted. "?" is MetaImage's "unknown". */
static int key_units(host_volume_reader *reader, meta_header *header, host_text *words)
{
    host_word word = {"", 0};
    (void)header;
    if (one_word(words, &word) && (host_word_is_nocase(word, "mm") || host_word_is(word, "?")))
        return 0;
    return host_volume_fail(reader, "DistanceUnits = mm, found '%.*s'", (int)(word.n < 40u ? word.n : 40u), word.start);
}

static int key_type(host_volume_reader *reader, meta_header *header, host_text *words)
{
    static const struct {
        const char *name;
        host_type type;
        int unsigned64;
    } types[] = {{"MET_CHAR", HOST_TYPE_I8, 0},       {"MET_UCHAR", HOST_TYPE_U8, 0},
                 {"MET_SHORT", HOST_TYPE_I16, 0},     {"MET_USHORT", HOST_TYPE_U16, 0},
                 {"MET_INT", HOST_TYPE_I32, 0},       {"MET_UINT", HOST_TYPE_U32, 0},
                 {"MET_LONG", HOST_TYPE_I32, 0},      {"MET_ULONG", HOST_TYPE_U32, 0}, /* 4 bytes by definition */
                 {"MET_LONG_LONG", HOST_TYPE_I64, 0}, {"MET_ULONG_LONG", HOST_TYPE_I64, 1},
                 {"MET_FLOAT", HOST_TYPE_F32, 0},     {"MET_DOUBLE", HOST_TYPE_F64, 0}};
    host_word word;
    (void)header;
    for (size_t i = 0; one_word(words, &word) && i < sizeof types / sizeof types[0]; words->at = word.start, i++)
        if (host_word_is_nocase(word, types[i].name)) {
            reader->type = types[i].type;
            reader->unsigned64 = types[i].unsigned64;
            return 0;
        }
    return host_volume_fail(reader, "ElementType = MET_UCHAR, MET_SHORT, MET_FLOAT or another single number");
}

static int key_file(host_volume_reader *reader, meta_header *header, host_text *words)
{
    header->last = 1;
    if (!host_text_word_in_line(words, &header->file))
        return host_volume_fail(reader, "ElementDataFile = LOCAL or a file's name");
    /* a file name may contain spaces: all of the line without the spaces at its end */
    header->file.n = (size_t)(words->end - header->file.start);
    while (header->file.start[header->file.n - 1u] == ' ' || header->file.start[header->file.n - 1u] == '\t')
        header->file.n--;
    if (host_word_is(header->file, "LIST") || memchr(header->file.start, '%', header->file.n) != NULL)
        return host_volume_fail(reader, "ElementDataFile = LOCAL or one file (lists of files are not read)");
    return 0;
}

enum { TRUTH = 0, WHOLE, LENGTHS, NUMBERS };

/* Keys whose values are kept as they are. */
static const struct plain {
    const char *name, *said; /* said: in errors */
    int kind;
    int least; /* of a whole number; of numbers, how many */
    size_t offset;
} plain_keys[] = {{"ElementSpacing", "ElementSpacing", LENGTHS, 3, offsetof(meta_header, spacing)},
                  {"ElementSize", "ElementSize", LENGTHS, 3, offsetof(meta_header, extent)},
                  {"TransformMatrix", "TransformMatrix = nine numbers", NUMBERS, 9, offsetof(meta_header, matrix)},
                  {"Rotation", "TransformMatrix = nine numbers", NUMBERS, 9, offsetof(meta_header, matrix)},
                  {"Orientation", "TransformMatrix = nine numbers", NUMBERS, 9, offsetof(meta_header, matrix)},
                  {"Offset", "Offset = three numbers", NUMBERS, 3, offsetof(meta_header, offset)},
                  {"Position", "Offset = three numbers", NUMBERS, 3, offsetof(meta_header, offset)},
                  {"Origin", "Offset = three numbers", NUMBERS, 3, offsetof(meta_header, offset)},
                  {"BinaryData", "BinaryData", TRUTH, 0, offsetof(meta_header, binary)},
                  {"BinaryDataByteOrderMSB", "BinaryDataByteOrderMSB", TRUTH, 0, offsetof(meta_header, big_endian)},
                  {"ElementByteOrderMSB", "BinaryDataByteOrderMSB", TRUTH, 0, offsetof(meta_header, big_endian)},
                  {"CompressedData", "CompressedData", TRUTH, 0, offsetof(meta_header, packed)},
                  {"CompressedDataSize", "CompressedDataSize", WHOLE, 0, offsetof(meta_header, packed_bytes)},
                  {"HeaderSize", "HeaderSize", WHOLE, -1, offsetof(meta_header, header_bytes)}};

static int read_plain(host_volume_reader *reader, const struct plain *key, void *at, host_text *words)
{
    switch (key->kind) {
    case TRUTH: return truth(reader, words, key->said, at);
    case WHOLE: return whole(reader, words, key->said, key->least, at);
    case LENGTHS: return lengths(reader, words, key->said, at);
    default: return numbers(words, key->least, at) ? 0 : host_volume_fail(reader, "%s", key->said);
    }
}

static int read_key(host_volume_reader *reader, meta_header *header, host_word key, host_text *words)
{
    static const struct {
        const char *name;
        key_function read;
    } keys[] = {{"ObjectType", key_object},
                {"NDims", key_dimensions},
                {"DimSize", key_size},
                {"DistanceUnits", key_units},
                {"ElementNumberOfChannels", key_channels},
                {"ElementType", key_type},
                {"ElementDataFile", key_file}};
    for (size_t i = 0; i < sizeof plain_keys / sizeof plain_keys[0]; i++)
        if (host_word_is(key, plain_keys[i].name))
            return read_plain(reader, &plain_keys[i], (unsigned char *)header + plain_keys[i].offset, words);
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
        if (host_word_is(key, keys[i].name))
            return keys[i].read(reader, header, words);
    return 0; /* ignored: comments, modality, the centre of rotation */
}

static int read_header(host_volume_reader *reader, meta_header *header, host_text *text)
{
    host_word line, key, sign;
    while (!header->last) {
        reader->line = text->line;
        if (!host_text_line(text, &line))
            return host_volume_fail(reader, "ElementDataFile, but the file ends here");
        host_text words = host_text_over(line.start, line.n);
        if (!host_text_word_in_line(&words, &key))
            continue;
        sign.start = memchr(line.start, '=', line.n);
        if (sign.start == NULL)
            return host_volume_fail(reader, "a line like NDims = 3");
        if (key.start + key.n > sign.start) /* no space before the sign */
            key.n = (size_t)(sign.start - key.start);
        words.at = sign.start + 1;
        if (read_key(reader, header, key, &words) != 0)
            return -1;
    }
    return 0;
}

static int locate(host_volume_reader *reader, const meta_header *h, const host_text *text)
{
    reader->data = (const unsigned char *)text->at;
    reader->n = (size_t)(text->end - text->at);
    reader->byte_skip = h->header_bytes;
    reader->big_endian = h->big_endian;
    if (!h->binary)
        reader->encoding = HOST_ENCODING_TEXT;
    else if (h->packed)
        reader->encoding = HOST_ENCODING_DEFLATE;
    if (!host_word_is_nocase(h->file, "LOCAL") && host_volume_read_detached(reader, "ElementDataFile", h->file) != 0)
        return -1;
    if (h->packed && (uint64_t)h->packed_bytes > reader->n)
        return host_fail(reader->error, "CompressedDataSize", "at most the file's %zu bytes, found %lld", reader->n,
                         (long long)h->packed_bytes);
    if (h->packed && h->header_bytes > 0) { /* the skipped bytes are not part of the stream */
        const size_t skip = (uint64_t)h->header_bytes < reader->n ? (size_t)h->header_bytes : reader->n;
        reader->data += skip;
        reader->n -= skip;
        reader->byte_skip = 0;
    }
    return 0;
}

int host_read_metaimage(host_volume_reader *reader, const unsigned char *data, size_t n)
{
    meta_header header = {0};
    double steps[3][3];
    host_text text = host_text_over(data, n);
    header.binary = 1;
    header.matrix[0] = header.matrix[4] = header.matrix[8] = 1.0;
    if (read_header(reader, &header, &text) != 0)
        return -1;
    if (!header.has_size)
        return host_fail(reader->error, "header", "a line DimSize");
    if (reader->type == HOST_TYPE_NONE)
        return host_fail(reader->error, "header", "a line ElementType");
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++)
            steps[j][i] = header.matrix[3 * j + i] * (header.spacing[j] > 0.0  ? header.spacing[j]
                                                      : header.extent[j] > 0.0 ? header.extent[j]
                                                                               : 1.0);
    if (host_volume_set_geometry(reader, "TransformMatrix, ElementSpacing, Offset", (const double(*)[3])steps,
                                 header.offset) != 0)
        return -1;
    if (locate(reader, &header, &text) != 0)
        return -1;
    return host_volume_convert(reader);
}
