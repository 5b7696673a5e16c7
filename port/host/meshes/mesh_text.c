/* mesh_text.c: reads OBJ, and points from CSV.
 * SPDX-License-Identifier: MIT */
#include <string.h>
#include "meshes/mesh_reader.h"

#define COLUMNS 6

static int is_between(char c) { return c == ',' || c == ';' || c == ' ' || c == '\t' || c == '\r'; }

/* The next field of a line. 0 at its end. */
static int next_field(host_word *rest, host_word *field)
{
    while (rest->n > 0 && is_between(*rest->start)) {
        rest->start++;
        rest->n--;
    }
    field->start = rest->start;
    field->n = 0;
    while (rest->n > 0 && !is_between(*rest->start)) {
        rest->start++;
        rest->n--;
        field->n++;
    }
    return field->n > 0;
}

/* The numbers of a line, at most COLUMNS + 1; -1 when a field is no number. */
static int read_numbers(host_word line, double value[COLUMNS])
{
    host_word field;
    double number = 0.0;
    int n = 0;
    for (n = 0; n <= COLUMNS && next_field(&line, &field); n++) {
        if (!host_word_double(field, &number))
            return -1;
        if (n < COLUMNS)
            value[n] = number;
    }
    return n;
}

int host_read_csv(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_text text = host_text_over(data, n);
    host_word line, first;
    int columns = 0;
    reader->unit = "line";
    for (uint32_t number = 1; host_text_line(&text, &line); number++) {
        host_word rest = line;
        double value[COLUMNS];
        reader->number = number;
        if (!next_field(&rest, &first))
            continue;
        if (first.start[0] == '#') {
            reader->ras |= host_word_has(line, "SPACE=RAS");
            continue;
        }
        int found = read_numbers(line, value);
        if (found < 0 && columns == 0) { /* names of columns */
            columns = -1;
            continue;
        }
        if ((found != 3 && found != 6) || (columns > 0 && found != columns))
            return host_fail_at(reader->error, "line", number, "x,y,z or x,y,z,nx,ny,nz, the same in all lines");
        columns = found;
        if (host_reader_vertex(reader, value) != 0 || (found == 6 && host_reader_normal(reader, value + 3) != 0))
            return -1;
    }
    return 0;
}

/* The largest vertex index in a face: checked at the end, since the vertex may follow the face. */
typedef struct pending {
    int64_t index;
    uint32_t line;
} pending;

/* Reads a line with all lines that continue it; the word holds their line breaks. */
static int read_line(host_text *text, host_word *line)
{
    if (!host_text_line(text, line))
        return 0;
    host_word more = *line;
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
    for (int i = 0; i < 3; i++) {
        host_word word;
        if (!next_word(text, &word) || !host_word_double(word, &xyz[i]))
            return host_reader_fail(reader, "three numbers after %s", is_normal ? "vn" : "v");
    }
    return is_normal ? host_reader_normal(reader, xyz) : host_reader_vertex(reader, xyz);
}

/* Reads "7/1/3" as vertex index 6. Negative numbers count back from the last vertex read. */
static int read_index(const host_mesh_reader *reader, host_word w, pending *last, uint32_t *index)
{
    const char *const slash = memchr(w.start, '/', w.n);
    const int64_t known = reader->mesh->n_vertices;
    int64_t value = 0;
    if (slash != NULL)
        w.n = (size_t)(slash - w.start);
    if (!host_word_int(w, &value) || value == 0)
        return host_reader_fail(reader, "vertex indexes from 1, found '%.*s'", (int)(w.n < 40 ? w.n : 40), w.start);
    value = value < 0 ? known + value : value - 1;
    if (value < 0 || value >= (int64_t)SMR_VERTICES_MAX)
        return host_reader_fail(reader, "the index of one of the %lld vertices so far", (long long)known);
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
        return host_reader_fail(reader, "at least 3 vertices in a face");
    return 0;
}

int host_read_obj(host_mesh_reader *reader, const unsigned char *data, size_t n)
{
    host_text text = host_text_over(data, n);
    host_word whole;
    pending last = {-1, 0};
    reader->unit = "line";
    for (uint32_t line = 1; read_line(&text, &whole); line = text.line) {
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
            result = host_reader_fail(reader, "text");
        if (result != 0)
            return -1;
    }
    if (last.index >= (int64_t)reader->mesh->n_vertices)
        return host_fail_at(reader->error, "line", last.line, "vertex indexes from 1 to %u, found %lld",
                            reader->mesh->n_vertices, (long long)last.index + 1);
    return 0;
}
