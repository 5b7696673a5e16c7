/* volume_nrrd.c: reads NRRD, attached (.nrrd) or detached (.nhdr): "field: value" lines; an empty line ends the header.
 * SPDX-License-Identifier: MIT */
#include <string.h>
#include "volumes/volume_reader.h"

enum { SPACE_NONE = 0, SPACE_LPS, SPACE_RAS, SPACE_LAS };

typedef struct nrrd_header {
    int has_size, has_encoding, has_order, has_steps, has_spacing, has_layers, space, other_space;
    int n; /* axes: 3, or 4 when the first one is of layers */
    double steps[3][3], spacing[3], origin[3];
    host_word file; /* n 0: the voxels follow the header */
} nrrd_header;

typedef int (*field_function)(host_volume_reader *reader, nrrd_header *header, host_word value);

static int is_one_of(host_word value, const char *const *names)
{
    for (; *names != NULL; names++)
        if (host_word_is_nocase(value, *names))
            return 1;
    return 0;
}

static int field_dimension(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    int64_t n = 0;
    if (host_word_int(value, &n) && (n == 3 || (n == 4 && reader->keys != NULL))) {
        header->n = (int)n;
        return 0;
    }
    return host_volume_fail(reader, reader->keys != NULL ? "dimension: 3, or 4 with layers"
                                                         : "dimension: 3 (colour, vectors and series are not read)");
}

/* The first count of a map with layers. */
static int read_layers(host_volume_reader *reader, host_text *words)
{
    host_word word;
    int64_t n = 0;
    if (!host_text_word_in_line(words, &word) || !host_word_int(word, &n) || n < 1 || n > HOST_LAYERS_MAX)
        return host_volume_fail(reader, "sizes: 1 to %d layers, then three counts", HOST_LAYERS_MAX);
    reader->layers = (uint32_t)n;
    return 0;
}

static int field_sizes(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    host_text words = host_text_over(value.start, value.n);
    host_word word;
    int64_t size[3];
    if (header->n == 4 && read_layers(reader, &words) != 0)
        return -1;
    for (int i = 0; i < 3; i++)
        if (!host_text_word_in_line(&words, &word) || !host_word_int(word, &size[i]))
            return host_volume_fail(reader, "sizes: three counts");
    if (host_text_word_in_line(&words, &word))
        return host_volume_fail(reader, "sizes: three counts, found more");
    header->has_size = 1;
    if (host_volume_set_size(reader, "sizes", size) != 0)
        return -1;
    if (reader->layers > HOST_FILE_MAX / ((uint64_t)size[0] * (uint64_t)size[1] * (uint64_t)size[2]))
        return host_volume_fail(reader, "sizes: at most %zu million values", HOST_FILE_MAX / 1000000u);
    return 0;
}

static int field_type(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    static const struct {
        host_type type;
        int unsigned64;
        const char *names[8];
    } types[] = {
        {HOST_TYPE_I8, 0, {"signed char", "int8", "int8_t"}},
        {HOST_TYPE_U8, 0, {"uchar", "unsigned char", "uint8", "uint8_t"}},
        {HOST_TYPE_I16, 0, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
        {HOST_TYPE_U16, 0, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
        {HOST_TYPE_I32, 0, {"int", "signed int", "int32", "int32_t"}},
        {HOST_TYPE_U32, 0, {"uint", "unsigned int", "uint32", "uint32_t"}},
        {HOST_TYPE_I64,
         0,
         {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"}},
        {HOST_TYPE_I64, 1, {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
        {HOST_TYPE_F32, 0, {"float"}},
        {HOST_TYPE_F64, 0, {"double"}},
    };
    (void)header;
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        if (is_one_of(value, types[i].names)) {
            reader->type = types[i].type;
            reader->unsigned64 = types[i].unsigned64;
            return 0;
        }
    return host_volume_fail(reader, "type: uchar, short, float or another number type");
}

static int field_encoding(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    static const char *const text[] = {"ascii", "text", "txt", NULL}, *const packed[] = {"gzip", "gz", NULL};
    header->has_encoding = 1;
    if (is_one_of(value, text))
        reader->encoding = HOST_ENCODING_TEXT;
    else if (is_one_of(value, packed))
        reader->encoding = HOST_ENCODING_DEFLATE;
    else if (!host_word_is_nocase(value, "raw"))
        return host_volume_fail(reader, "encoding: raw, ascii or gzip");
    return 0;
}

static int field_endian(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    header->has_order = 1;
    reader->big_endian = host_word_is_nocase(value, "big");
    if (reader->big_endian || host_word_is_nocase(value, "little"))
        return 0;
    return host_volume_fail(reader, "endian: little or big");
}

static int field_space(host_volume_reader *from, nrrd_header *header, host_word value)
{
    static const char *const lps[] = {"left-posterior-superior", "LPS", NULL},
                             *const ras[] = {"right-anterior-superior", "RAS", NULL},
                             *const las[] = {"left-anterior-superior", "LAS", NULL};
    header->space = is_one_of(value, lps)   ? SPACE_LPS
                    : is_one_of(value, ras) ? SPACE_RAS
                    : is_one_of(value, las) ? SPACE_LAS
                                            : SPACE_NONE;
    if (header->space != SPACE_NONE)
        return 0;
    return host_volume_fail(from, "space: left-posterior-superior, right-anterior-superior or left-anterior-superior");
}

static int field_space_dimension(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    (void)reader;
    (void)value;
    header->other_space = 1;
    return 0;
}

/* Reads "(x,y,z)", with spaces anywhere. 1 on success. */
static int read_vector(host_text *text, double xyz[3])
{
    static const char marks[4] = {'(', ',', ',', ')'};
    for (int i = 0; i < 4; i++) {
        host_word word;
        while (text->at < text->end && (*text->at == ' ' || *text->at == '\t'))
            text->at++;
        if (text->at >= text->end || *text->at != marks[i])
            return 0;
        text->at++;
        if (i == 3)
            return 1;
        while (text->at < text->end && (*text->at == ' ' || *text->at == '\t'))
            text->at++;
        word.start = text->at;
        while (text->at < text->end && strchr(" \t,()", *text->at) == NULL)
            text->at++;
        word.n = (size_t)(text->at - word.start);
        if (word.n == 0 || !host_word_double(word, &xyz[i]))
            return 0;
    }
    return 0;
}

static int field_directions(host_volume_reader *to, nrrd_header *header, host_word value)
{
    host_text text = host_text_over(value.start, value.n);
    host_word rest;
    if (header->n == 4 && (!host_text_word_in_line(&text, &rest) || !host_word_is_nocase(rest, "none")))
        return host_volume_fail(to, "space directions: none (x,y,z) (x,y,z) (x,y,z), for the first axis is of layers");
    for (int j = 0; j < 3; j++)
        if (!read_vector(&text, header->steps[j]))
            return host_volume_fail(to, "space directions: (x,y,z) (x,y,z) (x,y,z)");
    if (host_text_word_in_line(&text, &rest))
        return host_volume_fail(to, "space directions: three vectors, found more");
    header->has_steps = 1;
    return 0;
}

static int field_origin(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    host_text text = host_text_over(value.start, value.n);
    host_word rest;
    if (!read_vector(&text, header->origin) || host_text_word_in_line(&text, &rest))
        return host_volume_fail(reader, "space origin: (x,y,z)");
    return 0;
}

static int field_spacings(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    host_text words = host_text_over(value.start, value.n);
    host_word word;
    for (int i = 0; i < 3; i++)
        if (!host_text_word_in_line(&words, &word) || !host_word_double(word, &header->spacing[i]) ||
            !(header->spacing[i] > 0.0 && header->spacing[i] <= (double)SMR_COORD_MAX))
            return host_volume_fail(reader, "spacings: three positive numbers");
    header->has_spacing = 1;
    return 0;
}

/* Checks that each axis is one of space, not of colour, vectors or time. */
static int field_kinds(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    static const char *const kinds[] = {"domain", "space", "none", "???", NULL};
    host_text words = host_text_over(value.start, value.n);
    host_word word;
    if (header->n == 4) {
        if (!host_text_word_in_line(&words, &word) || !host_word_is_nocase(word, "list"))
            return host_volume_fail(reader, "kinds: list domain domain domain (vectors and series are not read)");
        header->has_layers = 1;
    }
    while (host_text_word_in_line(&words, &word))
        if (!is_one_of(word, kinds))
            return host_volume_fail(reader, "kinds: domain domain domain (colour, vectors and series are not read)");
    return 0;
}

static int field_units(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    static const char *const names[] = {"\"mm\"", "\"\"", "\"???\"", "mm", "\"millimeter\"", NULL};
    host_text words = host_text_over(value.start, value.n);
    host_word word;
    (void)header;
    while (host_text_word_in_line(&words, &word))
        if (!is_one_of(word, names))
            return host_volume_fail(reader, "units \"mm\" \"mm\" \"mm\"");
    return 0;
}

static int field_file(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    header->file = value;
    if (value.n == 0 || memchr(value.start, '%', value.n) != NULL ||
        (value.n >= 4u && memcmp(value.start, "LIST", 4) == 0 && (value.n == 4u || value.start[4] == ' ')))
        return host_volume_fail(reader, "data file: one file's name (lists of files are not read)");
    return 0;
}

static int field_line_skip(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    (void)header;
    if (!host_word_int(value, &reader->line_skip) || reader->line_skip < 0)
        return host_volume_fail(reader, "line skip: a count");
    return 0;
}

static int field_byte_skip(host_volume_reader *reader, nrrd_header *header, host_word value)
{
    (void)header;
    if (!host_word_int(value, &reader->byte_skip) || reader->byte_skip < -1)
        return host_volume_fail(reader, "byte skip: a count or -1");
    return 0;
}

static int read_field(host_volume_reader *reader, nrrd_header *header, host_word name, host_word value)
{
    static const struct {
        const char *name;
        field_function read;
    } fields[] = {{"dimension", field_dimension},
                  {"sizes", field_sizes},
                  {"type", field_type},
                  {"encoding", field_encoding},
                  {"endian", field_endian},
                  {"space", field_space},
                  {"space dimension", field_space_dimension},
                  {"space directions", field_directions},
                  {"space origin", field_origin},
                  {"spacings", field_spacings},
                  {"kinds", field_kinds},
                  {"space units", field_units},
                  {"units", field_units},
                  {"data file", field_file},
                  {"datafile", field_file},
                  {"line skip", field_line_skip},
                  {"lineskip", field_line_skip},
                  {"byte skip", field_byte_skip},
                  {"byteskip", field_byte_skip}};
    for (size_t i = 0; i < sizeof fields / sizeof fields[0]; i++)
        if (host_word_is_nocase(name, fields[i].name))
            return fields[i].read(reader, header, value);
    return 0; /* ignored: content, thicknesses, the measurement frame and others */
}

static int read_header(host_volume_reader *reader, nrrd_header *header, host_text *text)
{
    host_word line;
    reader->line = 1;
    if (!host_text_line(text, &line) || line.n != 8u || memcmp(line.start, "NRRD000", 7) != 0 || line.start[7] < '1' ||
        line.start[7] > '5')
        return host_volume_fail(reader, "NRRD0001 to NRRD0005");
    for (;;) {
        reader->line = text->line;
        if (!host_text_line(text, &line)) { /* a detached header may end with its file */
            if (header->file.n > 0)
                return 0;
            return host_volume_fail(reader, "an empty line and the voxels, but the file ends here");
        }
        if (line.n == 0)
            return 0;
        if (line.start[0] == '#')
            continue;
        const char *colon = memchr(line.start, ':', line.n);
        if (colon == NULL)
            return host_volume_fail(reader, "a line like dimension: 3");
        if (colon + 1 < line.start + line.n && colon[1] == '=') { /* user-defined "key:=value" */
            if (reader->keys != NULL)
                host_buffer_print(reader->keys, "%.*s\n", (int)line.n, line.start);
            continue;
        }
        if (read_field(reader, header, host_word_trimmed(line.start, colon),
                       host_word_trimmed(colon + 1, line.start + line.n)) != 0)
            return -1;
    }
}

/* Checks that all required fields were read. */
static int check_header(const host_volume_reader *reader, const nrrd_header *header)
{
    const char *missing = NULL;
    if (!header->has_size)
        missing = "sizes";
    else if (reader->type == HOST_TYPE_NONE)
        missing = "type";
    else if (!header->has_encoding)
        missing = "encoding";
    else if (!header->has_order && host_type_bytes(reader->type) > 1u && reader->encoding != HOST_ENCODING_TEXT)
        missing = "endian";
    else if (!header->has_steps && !header->has_spacing)
        missing = "space directions";
    else if (header->space == SPACE_NONE && (header->has_steps || header->other_space))
        missing = "space";
    else if ((header->n == 4) != (reader->layers > 0u))
        missing = "dimension before the line sizes";
    else if (header->n == 4 && (!header->has_layers || !header->has_steps))
        missing = "kinds: list domain domain domain and one of space directions";
    if (missing != NULL)
        return host_fail(reader->error, "header", "a line %s", missing);
    if (reader->byte_skip < 0 && reader->encoding != HOST_ENCODING_RAW)
        return host_fail(reader->error, "header", "byte skip: -1 with encoding: raw only");
    return 0;
}

static int place(host_volume_reader *reader, nrrd_header *header)
{
    for (int j = 0; !header->has_steps && j < 3; j++)
        header->steps[j][j] = header->spacing[j];
    if (header->space == SPACE_RAS)
        host_volume_turn_ras(header->steps, header->origin);
    if (header->space == SPACE_LAS) {
        header->origin[1] = 0.0 - header->origin[1];
        for (int j = 0; j < 3; j++)
            header->steps[j][1] = 0.0 - header->steps[j][1];
    }
    return host_volume_set_geometry(reader, header->has_steps ? "space directions, space origin" : "spacings",
                                    (const double(*)[3])header->steps, header->origin);
}

int host_read_nrrd(host_volume_reader *reader, const unsigned char *data, size_t n)
{
    nrrd_header header = {0};
    host_text text = host_text_over(data, n);
    header.n = 3;
    if (read_header(reader, &header, &text) != 0 || check_header(reader, &header) != 0 || place(reader, &header) != 0)
        return -1;
    reader->data = (const unsigned char *)text.at;
    reader->n = (size_t)(text.end - text.at);
    if (header.file.n > 0) {
        if (host_volume_read_detached(reader, "data file", header.file) != 0)
            return -1;
        /* a data file that is one gzip stream has been unpacked when read */
        if (reader->encoding == HOST_ENCODING_DEFLATE && reader->line_skip == 0)
            reader->encoding = HOST_ENCODING_RAW;
    }
    return host_volume_convert(reader);
}
