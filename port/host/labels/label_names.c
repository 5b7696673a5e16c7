/* label_names.c: names and colours of labels. What a .seg.nrrd's keys mean is in 3D Slicer's documents: segments count
 * from 0 without a gap, Layer is missing where each segment has a layer of its own.
 * SPDX-License-Identifier: MIT */
#include "labels/label_map.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/file_read.h"

#define SNAP_NUMBERS 6u

/* What a .seg.nrrd says of one segment. */
typedef struct segment {
    host_word id, name, colour;
    int64_t value, layer; /* layer -1: not said */
} segment;

int host_label_name(const char *text, size_t n, char name[SMR_NAME_BYTES])
{
    if (n == 0 || n >= SMR_NAME_BYTES)
        return -1;
    for (size_t i = 0; i < n; i++) {
        const unsigned char c = (unsigned char)text[i];
        const int good = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
                         c == '+' || (c == '-' && i > 0) || (c == '.' && i > 0) || c > 127;
        name[i] = good ? text[i] : '_';
    }
    name[n] = '\0';
    return 0;
}

void host_label_colour(uint32_t i, float colour[3])
{
    static const unsigned char shades[12][3] = {{128, 174, 128}, {241, 214, 145}, {177, 122, 101}, {111, 184, 210},
                                                {216, 101, 79},  {221, 130, 101}, {144, 238, 144}, {192, 104, 88},
                                                {220, 245, 20},  {78, 63, 0},     {255, 250, 220}, {230, 220, 70}};
    for (uint32_t k = 0; k < 3u; k++)
        colour[k] = (float)shades[i % 12u][k] / 255.0f;
}

/* Three numbers of 0 to most. */
static int read_colour(host_text words, double most, float colour[3])
{
    host_word one;
    double value = 0.0;
    for (int k = 0; k < 3; k++) {
        if (!host_text_word_in_line(&words, &one) || !host_word_double(one, &value) || !(value >= 0.0 && value <= most))
            return -1;
        colour[k] = (float)(value / most);
    }
    return 0;
}

/* One line "SegmentN_Key:=value"; others are skipped. */
static void read_key(host_word line, segment *segments)
{
    static const char start[] = "Segment";
    const size_t k = sizeof start - 1u;
    const char *const end = line.start + line.n, *at = NULL, *colon = memchr(line.start, ':', line.n);
    uint32_t number = 0;
    host_word key, value;
    if (colon == NULL || line.n <= k || memcmp(line.start, start, k) != 0)
        return;
    for (at = line.start + k; at < colon && *at >= '0' && *at <= '9' && number < SMR_STRUCTURES_MAX; at++)
        number = 10u * number + (uint32_t)(*at - '0');
    if (number >= SMR_STRUCTURES_MAX || at == line.start + k || *at != '_')
        return;
    key.start = at + 1;
    key.n = (size_t)(colon - key.start);
    value = host_word_trimmed(colon + 2 < end ? colon + 2 : end, end);
    if (host_word_is(key, "ID"))
        segments[number].id = value;
    else if (host_word_is(key, "Name"))
        segments[number].name = value;
    else if (host_word_is(key, "Color"))
        segments[number].colour = value;
    else if (host_word_is(key, "LabelValue") && !host_word_int(value, &segments[number].value))
        segments[number].value = -1;
    else if (host_word_is(key, "Layer") && !host_word_int(value, &segments[number].layer))
        segments[number].layer = -2;
}

static host_label *label_at(host_label_map *map, int64_t layer, int64_t value)
{
    for (uint32_t i = 0; i < map->n_labels; i++)
        if ((int64_t)map->label[i].layer == layer && (int64_t)map->label[i].value == value)
            return &map->label[i];
    return NULL;
}

/* Gives the label of a segment its name. A segment without voxels is none. */
static int take_segment(host_label_map *map, const segment *s, uint32_t i, host_error *error)
{
    const host_word name = s->name.n > 0 ? s->name : s->id;
    const int64_t layer = s->layer >= 0 ? s->layer : (map->n_layers == 1u ? 0 : (int64_t)i);
    char place[48];
    (void)snprintf(place, sizeof place, "Segment%u", i);
    if (s->layer == -2 || layer >= (int64_t)map->n_layers)
        return host_fail(error, place, "a Layer of 0 to %u", map->n_layers - 1u);
    if (s->value < 0 || s->value > (int64_t)HOST_LABEL_MAX)
        return host_fail(error, place, "a LabelValue of 0 to %u", HOST_LABEL_MAX);
    host_label *of = label_at(map, layer, s->value);
    if (of == NULL)
        return 0;
    if (of->name[0] != '\0')
        return host_fail(error, place, "a label of its own, %u of layer %u is another segment's", of->value, of->layer);
    if (host_label_name(name.start, name.n, of->name) != 0)
        return host_fail(error, place, "a Name of at most %u bytes", SMR_NAME_BYTES - 1u);
    of->coloured = s->colour.n > 0;
    if (of->coloured && read_colour(host_text_over(s->colour.start, s->colour.n), 1.0, of->colour) != 0)
        return host_fail(error, place, "a Color of three numbers from 0 to 1");
    return 0;
}

int host_labels_take_segments(host_label_map *map, const host_buffer *keys, host_error *error)
{
    host_word line;
    int result = 0;
    if (keys->size == 0)
        return 0;
    segment *segments = calloc(SMR_STRUCTURES_MAX, sizeof *segments);
    if (segments == NULL)
        return host_fail(error, "labels", "free memory");
    for (uint32_t i = 0; i < SMR_STRUCTURES_MAX; i++) {
        segments[i].value = 1;
        segments[i].layer = -1;
    }
    host_text text = host_text_over(keys->data, keys->size);
    while (host_text_line(&text, &line))
        read_key(line, segments);
    for (uint32_t i = 0; result == 0 && i < SMR_STRUCTURES_MAX && segments[i].id.n > 0; i++)
        result = take_segment(map, &segments[i], i, error);
    free(segments);
    return result;
}

/* 1 when these words behind a value are those of ITK-SNAP: red, green, blue, opacity, two switches. */
static int is_snap(const host_word *word, size_t n)
{
    double number = 0.0;
    for (size_t i = 0; i < SNAP_NUMBERS && i < n; i++)
        if (!host_word_double(word[i], &number))
            return 0;
    return n >= SNAP_NUMBERS;
}

/* The rest of such a line is the name, in quotes. */
static int read_snap_line(host_word line, const host_word *word, size_t n, host_named *named)
{
    const char *const end = line.start + line.n, *const name = n > SNAP_NUMBERS ? word[SNAP_NUMBERS].start : end;
    if (end - name < 2 || name[0] != '"' || end[-1] != '"' ||
        read_colour(host_text_over(word[0].start, (size_t)(name - word[0].start)), 255.0, named->colour) != 0)
        return -1;
    named->coloured = 1;
    return host_label_name(name + 1, (size_t)(end - name) - 2u, named->name);
}

/* "value name...", perhaps a colour behind, or a line of ITK-SNAP. 0 when that is what the line says. */
static int read_line(host_word line, host_named *named)
{
    host_text words = host_text_over(line.start, line.n), rest;
    host_word word[16], more;
    char name[SMR_NAME_BYTES];
    size_t n = 0, i = 0, at = 0;
    int64_t value = 0;
    double number = 0.0;
    if (!host_text_word_in_line(&words, &word[0]) || !host_word_int(word[0], &value) || value < 0 ||
        value > (int64_t)HOST_LABEL_MAX)
        return -1;
    named->value = (uint32_t)value;
    rest = words;
    while (n < 16u && host_text_word_in_line(&rest, &word[n]))
        n++;
    if (is_snap(word, n))
        return read_snap_line(line, word, n, named);
    if (host_text_word_in_line(&rest, &more))
        return -1;
    for (i = n; i > 1u && host_word_double(word[i - 1u], &number);)
        i--;
    if (n - i == 3u || n - i == 4u) { /* behind the name */
        rest = host_text_over(word[i].start, (size_t)(line.start + line.n - word[i].start));
        if (read_colour(rest, 255.0, named->colour) != 0)
            return -1;
        named->coloured = 1;
        n = i;
    }
    for (i = 0; i < n; i++) {
        if (at + word[i].n + 1u >= sizeof name)
            return -1;
        if (i > 0)
            name[at++] = '_';
        memcpy(name + at, word[i].start, word[i].n);
        at += word[i].n;
    }
    return host_label_name(name, at, named->name);
}

static int add_line(host_word line, uint32_t number, host_names *names, host_error *error)
{
    host_named named = {0};
    if (read_line(line, &named) != 0)
        return host_fail_at(error, "line", number, "a label and its name, as in: 7 femur");
    if (named.value == 0)
        return 0;
    host_named *grown = realloc(names->item, (names->n + 1u) * sizeof *grown);
    if (grown == NULL)
        return host_fail_at(error, "line", number, "free memory");
    names->item = grown;
    grown[names->n++] = named;
    return 0;
}

int host_names_read(const char *path, host_names *names, host_error *error)
{
    host_bytes bytes;
    host_word line;
    uint32_t number = 1;
    int result = 0;
    error->file = path;
    if (host_file_read(path, NULL, &bytes, error) != 0)
        return -1;
    host_text text = host_text_over(bytes.data, bytes.size);
    for (; result == 0 && host_text_line(&text, &line); number = text.line) {
        line = host_word_trimmed(line.start, line.start + line.n);
        if (line.n == 0 || line.start[0] == '#')
            continue;
        result = names->n < 65536u ? add_line(line, number, names, error)
                                   : host_fail_at(error, "line", number, "at most 65536 names");
    }
    host_file_free(&bytes);
    return result;
}

void host_names_free(host_names *names)
{
    free(names->item);
    memset(names, 0, sizeof *names);
}

static int is_taken(const host_label_map *map, uint32_t i)
{
    for (uint32_t k = 0; k < map->n_labels; k++)
        if (k != i && strcmp(map->label[k].name, map->label[i].name) == 0)
            return 1;
    return 0;
}

int host_labels_settle_names(host_label_map *map, const host_names *names, host_error *error)
{
    unsigned char taken[SMR_STRUCTURES_MAX];
    for (uint32_t i = 0; i < map->n_labels; i++) {
        host_label *const label = &map->label[i];
        for (uint32_t k = 0; k < names->n; k++)
            if (names->item[k].value == label->value) {
                memcpy(label->name, names->item[k].name, sizeof label->name);
                if (names->item[k].coloured)
                    memcpy(label->colour, names->item[k].colour, sizeof label->colour);
                label->coloured |= names->item[k].coloured;
            }
        if (label->name[0] == '\0')
            (void)snprintf(label->name, sizeof label->name, "label_%u", label->value);
    }
    for (uint32_t i = 0; i < map->n_labels; i++)
        taken[i] = (unsigned char)is_taken(map, i);
    for (uint32_t i = 0; i < map->n_labels; i++) {
        host_label *const label = &map->label[i];
        const size_t n = strlen(label->name);
        if (taken[i] && map->n_layers > 1u)
            (void)snprintf(label->name + n, sizeof label->name - n, "_%u_%u", label->layer, label->value);
        else if (taken[i])
            (void)snprintf(label->name + n, sizeof label->name - n, "_%u", label->value);
    }
    for (uint32_t i = 0; i < map->n_labels; i++)
        if (is_taken(map, i))
            return host_fail(error, "names", "labels with names that differ, '%s' is there twice", map->label[i].name);
    return 0;
}

const host_label *host_label_find_like(const host_label_map *map, const char *name)
{
    char label[SMR_NAME_BYTES];
    return host_label_name(name, strlen(name), label) == 0 ? host_label_find(map, label) : NULL;
}
