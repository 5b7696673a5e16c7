/* case_table.c: the lines with known deformations: one side, patches, an end, outliers; and what calls all tables.
 * SPDX-License-Identifier: MIT */
#include "case_points.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What was asked for. */
typedef struct wanted {
    char lines[256], bones[256]; /* separated by commas */
    uint32_t first, last;        /* seeds */
} wanted;

/* The largest errors of a line, mm. */
typedef struct tally {
    double worst_vertex, extra;
} tally;

/* Bounds of a line, mm: surface, vertices beyond the whole target's run, vertices for femurs and for hip bones. */
typedef struct bounds {
    const char *line;
    double surface, beyond, femur, hip, worse;
    const char *against; /* the line that outliers may make worse by `worse` */
} bounds;

static const bounds limits[] = {
    {"whole", HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, ""},
    {"side", 0.6, 0.4, HUGE_VAL, HUGE_VAL, HUGE_VAL, ""},
    {"patches", 0.8, 0.8, HUGE_VAL, HUGE_VAL, HUGE_VAL, ""},
    {"end", HUGE_VAL, HUGE_VAL, 6.0, 3.0, HUGE_VAL, ""},
    {"whole+5", HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, 1.1, "whole"},
    {"whole+20", HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, 4.0 / 3.0, "whole"},
    {"side+5", HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, 1.1, "side"},
    {"side+20", HUGE_VAL, HUGE_VAL, HUGE_VAL, HUGE_VAL, 4.0 / 3.0, "side"},
};
enum { LINES = sizeof limits / sizeof limits[0] };
_Static_assert(sizeof limits / sizeof limits[0] == CASE_LINES, "a score for each line");

static int judge(const bounds *b, const case_row *row, const case_bone *bone, const case_row *whole,
                 const case_row *against, char said[160])
{
    const double vertex = row->result.vertex, surface = row->result.surface;
    const int near = surface <= b->surface && vertex <= whole->result.vertex + b->beyond &&
                     vertex <= (bone->femur ? b->femur : b->hip);
    const double worse =
        against != NULL ? fmax(surface / against->result.surface, vertex / against->result.vertex) : 0.0;
    const int wrong = vertex > 3.0 && strcmp(row->verdict, "good") == 0;
    const int good = row->status >= 0 && near && worse <= b->worse && !wrong;
    said[0] = '\0';
    if (against != NULL)
        (void)snprintf(said, 160, "x %.2f of %s ", worse, b->against);
    if (row->status < 0)
        (void)strcat(said, "NOT DONE");
    else
        (void)strcat(said, wrong ? "MISS called good" : good ? "ok" : "MISS");
    return good;
}

static void add_to(tally *t, case_score *s, const case_row *row, const case_row *whole, int good)
{
    s->rows++;
    s->held += good != 0;
    s->good_far += row->result.vertex > 3.0 && strcmp(row->verdict, "good") == 0;
    s->mean += (row->result.surface - s->mean) / s->rows;
    s->vertex += (row->result.vertex - s->vertex) / s->rows;
    s->worst = fmax(s->worst, row->result.surface);
    t->extra = fmax(t->extra, row->result.vertex - whole->result.vertex);
    t->worst_vertex = fmax(t->worst_vertex, row->result.vertex);
}

/* 1 when a line is to be run, for itself or for one that is compared with it. */
static int is_needed(const wanted *w, const bounds *b)
{
    const int outliers = strchr(b->line, '+') != NULL;
    if (strcmp(b->line, "whole") == 0)
        return 1;
    if (outliers)
        return case_named(w->lines, "outliers") || strstr(w->lines, b->line) != NULL;
    return case_named(w->lines, b->line) || case_named(w->lines, "outliers");
}

static void run_bone(const wanted *w, const case_bone *bone, uint32_t seed, tally *sums, case_score *score)
{
    case_row row[LINES];
    int i = 0, k = 0;
    for (i = 0; i < LINES; i++) {
        const case_options o = case_line(limits[i].line, seed);
        const case_row *against = NULL;
        char said[160];
        int good = 0;
        if (!is_needed(w, &limits[i]))
            continue;
        row[i] = case_run_row(limits[i].line, bone, &o);
        for (k = 0; k < i; k++)
            if (strcmp(limits[i].against, limits[k].line) == 0)
                against = &row[k];
        good = judge(&limits[i], &row[i], bone, &row[0], against, said);
        case_print_row(&row[i], row[0].result.vertex, said);
        add_to(&sums[i], &score[i], &row[i], &row[0], good);
    }
}

static int run_deformed(const wanted *w, case_score *score)
{
    tally sums[LINES];
    uint32_t seed = 0, missed = 0;
    int b = 0, i = 0;
    memset(sums, 0, sizeof sums);
    memset(score, 0, LINES * sizeof *score);
    case_print_head();
    for (b = 0; b < CASE_BONES; b++)
        for (seed = w->first; case_named(w->bones, case_bones[b].name) && seed <= w->last; seed++)
            run_bone(w, &case_bones[b], seed, sums, score);
    for (i = 0; i < LINES; i++) {
        case_score *const s = &score[i];
        (void)snprintf(s->line, sizeof s->line, "%s", limits[i].line);
        if (s->rows > 0)
            (void)printf("sum %-10s %3u runs, %3u missed: surface mean %.3f worst %.3f, vertex mean %.3f worst %.3f, "
                         "beyond whole at most %.3f\n",
                         s->line, s->rows, s->rows - s->held, s->mean, s->worst, s->vertex, sums[i].worst_vertex,
                         sums[i].extra);
        missed += s->rows - s->held;
    }
    return (int)missed;
}

int case_table_deformed(const char *lines, const char *bones, uint32_t first, uint32_t last, case_score *score)
{
    wanted w;
    memset(&w, 0, sizeof w);
    (void)snprintf(w.lines, sizeof w.lines, "%s", lines);
    (void)snprintf(w.bones, sizeof w.bones, "%s", bones);
    w.first = first;
    w.last = last;
    return run_deformed(&w, score);
}

/* Words behind an option, or before any, as one text with commas. */
static int gather(int n, char **word, int i, char text[256])
{
    size_t at = strlen(text);
    for (; i < n && strncmp(word[i], "--", 2) != 0; i++) {
        (void)snprintf(text + at, 256u - at, "%s%s", at > 0 ? "," : "", word[i]);
        at = strlen(text);
    }
    return i;
}

static int read_wanted(int n, char **word, wanted *w)
{
    int i = 0;
    memset(w, 0, sizeof *w);
    w->first = 1;
    w->last = 3;
    i = gather(n, word, 0, w->lines);
    while (i < n)
        if (strcmp(word[i], "--bones") == 0) {
            i = gather(n, word, i + 1, w->bones);
        } else if (strcmp(word[i], "--seeds") == 0 && i + 1 < n) {
            const char *const to = strchr(word[i + 1], '-');
            w->first = (uint32_t)atoi(word[i + 1]);
            w->last = to != NULL ? (uint32_t)atoi(to + 1) : w->first;
            i += 2;
        } else if (strcmp(word[i], "--keep") == 0 && i + 1 < n && experiment_directory(word[i + 1])) {
            case_keep(word[i + 1]);
            i += 2;
        } else {
            return 0;
        }
    if (strcmp(w->lines, "partial") == 0)
        (void)snprintf(w->lines, sizeof w->lines, "side,patches,end,outliers");
    if (strcmp(w->lines, "all") == 0)
        w->lines[0] = '\0';
    return 1;
}

int case_table(int n, char **word)
{
    wanted w;
    case_score score[LINES];
    case_views views[2];
    int i = 0, missed = 0, deformed = 0;
    if (!read_wanted(n, word, &w)) {
        (void)fputs("case_tool: table: see case_tool --help\n", stderr);
        return 2;
    }
    for (i = 0; i < LINES; i++)
        deformed |= case_named(w.lines, limits[i].line) || case_named(w.lines, "outliers");
    if (deformed)
        missed += run_deformed(&w, score);
    if (case_named(w.lines, "person"))
        missed += case_table_persons("", w.bones, score);
    if (case_named(w.lines, "length"))
        missed += case_table_lengths(w.bones, score);
    if (case_named(w.lines, "thigh"))
        missed += case_table_thigh(w.first, w.last, score);
    if (strstr(w.lines, "points") != NULL || w.lines[0] == '\0')
        missed += case_table_points(w.lines, w.bones, w.first, w.last);
    if (w.lines[0] != '\0' && case_named(w.lines, "random"))
        missed += case_table_random(w.bones, w.first, w.last, views);
    (void)printf("%d bounds missed\n", missed);
    return 0;
}
