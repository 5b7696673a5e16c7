/* mesh_obj.c: reads Wavefront OBJ: v and f lines (v, v/vt, v//vn, v/vt/vn, negative indexes); skips all others.
 *
 * A backslash at a line's end continues the line, as white space would. Comments are not continued.
 * SPDX-License-Identifier: MIT */
#include <string.h>

#include "base/text_scan.h"
#include "meshes/mesh_reader.h"

/* The largest vertex index in a face: checked at the end, since the vertex may follow the face. */
typedef struct pending {
    int64_t index;
    uint32_t line;
} pending;

/* Reads a line with all lines that continue it; the word holds their line breaks. */
static int read_line(host_text *text, host_word *line)
{
    host_word more;
    if (!host_text_line(text, line))
        return 0;
    more = *line;
    while (more.n > 0 && more.start[more.n - 1u] == '\\' && memchr(more.start, '#', more.n) == NULL &&
           host_text_line(text, &more))
        line->n = (size_t)(more.start + more.n - line->start);
    return 1;
}

/* Reads the next word of a line from read_line, without the backslash that continues the line. */
static int next_word(host_text *line, host_word *word)
{
    while (host_text_word(line, word)) {
        const int at_break = line->at == line->end || *line->at == '\n' || *line->at == '\r';
        if (at_break && word->start[word->n - 1u] == '\\')
            word->n--;
        if (word->n > 0)
            return 1;
    }
    return 0;
}

/* v and vn. */
static int read_three(host_mesh_reader *reader, host_text *text, int is_normal)
{
    double xyz[3];
    int i = 0;
    for (i = 0; i < 3; i++) {
        host_word word;
        if (!next_word(text, &word) || !host_word_double(word, &xyz[i]))
            return host_fail_at(reader->error, "line", reader->number, "three numbers after %s",
                                is_normal ? "vn" : "v");
    }
    return is_normal ? host_reader_normal(reader, xyz) : host_reader_vertex(reader, xyz);
}

/* Reads "7/1/3" as vertex index 6. Negative numbers count back from the last vertex read. */
static int read_index(const host_mesh_reader *reader, host_word word, pending *last, uint32_t *index)
{
    const char *const slash = memchr(word.start, '/', word.n);
    const int64_t known = reader->mesh->n_vertices;
    int64_t value = 0;
    if (slash != NULL)
        word.n = (size_t)(slash - word.start);
    if (!host_word_int(word, &value) || value == 0)
        return host_fail_at(reader->error, "line", reader->number, "vertex indexes from 1, found '%.*s'",
                            (int)(word.n < 40 ? word.n : 40), word.start);
    value = value < 0 ? known + value : value - 1;
    if (value < 0 || value >= (int64_t)SMR_VERTICES_MAX)
        return host_fail_at(reader->error, "line", reader->number, "the index of one of the %lld vertices so far",
                            (long long)known);
    if (value > last->index) {
        last->index = value;
        last->line = (uint32_t)reader->number;
    }
    *index = (uint32_t)value;
    return 0;
}

static int read_face(host_mesh_reader *reader, host_text *text, pending *last)
{
    uint32_t fan[3] = {0, 0, 0};
    host_word word;
    while (next_word(text, &word)) {
        uint32_t index = 0;
        if (word.start[0] == '#')
            break;
        if (read_index(reader, word, last, &index) != 0 || host_reader_fan(reader, fan, index) != 0)
            return -1;
    }
    if (fan[0] < 3)
        return host_fail_at(reader->error, "line", reader->number, "at least 3 vertices in a face");
    return 0;
}

int host_read_obj(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_text text = host_text_over(data, n);
    host_word whole;
    pending last = {-1, 0};
    uint32_t line = 1;
    reader->unit = "line";
    for (line = 1; read_line(&text, &whole); line = text.line) {
        host_text words = host_text_over(whole.start, whole.n);
        host_word word;
        int result = 0;
        reader->number = line;
        if (!next_word(&words, &word))
            continue;
        if (word.start[0] == '#')
            reader->ras |= host_word_has(whole, "SPACE=RAS");
        else if (host_word_is(word, "v"))
            result = read_three(reader, &words, 0);
        else if (reader->cloud && host_word_is(word, "vn"))
            result = read_three(reader, &words, 1);
        else if (host_word_is(word, "f"))
            result = read_face(reader, &words, &last);
        else if (memchr(whole.start, '\0', whole.n) != NULL)
            result = host_fail_at(reader->error, "line", reader->number, "text");
        if (result != 0)
            return -1;
    }
    if (last.index >= (int64_t)reader->mesh->n_vertices)
        return host_fail_at(reader->error, "line", last.line, "vertex indexes from 1 to %u, found %lld",
                            reader->mesh->n_vertices, (long long)last.index + 1);
    return 0;
}
