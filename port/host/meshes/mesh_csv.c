/* mesh_csv.c: reads points as text: a line each, "x,y,z" or "x,y,z,nx,ny,nz", separated by commas, semicolons, tabs or
 * spaces. The first line may name the columns. Lines that start with # are comments; one may say SPACE=RAS.
 * SPDX-License-Identifier: MIT */
#include "base/text_scan.h"
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
    uint32_t number = 1;
    int columns = 0;
    reader->unit = "line";
    for (number = 1; host_text_line(&text, &line); number++) {
        host_word rest = line;
        double value[COLUMNS];
        int found = 0;
        reader->number = number;
        if (!next_field(&rest, &first))
            continue;
        if (first.start[0] == '#') {
            reader->ras |= host_word_has(line, "SPACE=RAS");
            continue;
        }
        found = read_numbers(line, value);
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
