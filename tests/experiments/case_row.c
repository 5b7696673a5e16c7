/* case_row.c: one run of a table: its case, its registration, its row.
 * SPDX-License-Identifier: MIT */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_table.h"

const case_bone case_bones[CASE_BONES] = {
    {"m_right", "femurs/femur_m_right.ply", 1, 1},
    {"2008", "femurs/femur_2008_0019_left_3k.ply", 0, 1},
    {"2007", "femurs/femur_2007_5028_left_3k.ply", 0, 1},
    {"vhm_left", "femurs/femur_vhm_left.ply", 0, 1},
    {"hip_thigh", "hip_thigh_vhm/femur.ply", 1, 1},
    {"hip_bone", "hip_thigh_vhm/hip_bone.ply", 1, 0},
    {"hip_right", "ct_hips_surfaces/hip_bone_right.ply", 1, 0},
};

static const char *kept;

void case_keep(const char *directory) { kept = directory; }

case_options case_line(const char *line, uint32_t seed)
{
    static const double shares[] = {0.2, 0.3, 0.4};
    static const struct {
        const char *name;
        int part;
    } parts[] = {{"whole", CASE_WHOLE},
                 {"side", CASE_SIDE},
                 {"patches", CASE_PATCHES},
                 {"end", CASE_END},
                 {"front", CASE_FRONT}};
    case_options o = case_defaults();
    const char *const plus = strchr(line, '+');
    size_t i = 0;
    o.seed = seed;
    for (i = 0; i < sizeof parts / sizeof parts[0]; i++)
        if (strncmp(line, parts[i].name, strlen(parts[i].name)) == 0)
            o.part = parts[i].part;
    if (o.part == CASE_PATCHES) {
        o.patches = seed % 2u == 1u ? 3 : 4;
        o.share = shares[seed % 3u];
    }
    o.outliers = plus != NULL ? atof(plus + 1) / 100.0 : 0.0;
    return o;
}

int case_named(const char *words, const char *name)
{
    const char *at = words;
    if (*words == '\0')
        return 1;
    for (; *at != '\0'; at += *at == ',') {
        const size_t n = strcspn(at, ",");
        if (n > 0 && strncmp(name, at, n) == 0)
            return 1;
        at += n;
    }
    return 0;
}

/* The words of a text, separated by blanks. */
static void add_words(experiment_command *c, const char *text)
{
    while (*text != '\0') {
        const size_t n = strcspn(text, " ");
        if (n > 0)
            experiment_add(c, "%.*s", (int)n, text);
        text += n + (text[n] == ' ');
    }
}

static void find_directory(const case_row *row, char directory[CASE_TEXT])
{
    if (kept != NULL)
        (void)snprintf(directory, CASE_TEXT, "%.900s/%s_%s_%u", kept, row->line, row->bone, row->seed);
    else
        (void)snprintf(directory, CASE_TEXT, "%.900s", experiment_scratch("case"));
}

const char *case_out(const case_data *data, const case_row *row)
{
    static char path[CASE_TEXT];
    char directory[CASE_TEXT];
    find_directory(row, directory);
    (void)snprintf(path, sizeof path, "%.900s/out/%.64s.ply", directory, data->body[0].name);
    return path;
}

case_row case_run_data(const char *line, const char *name, uint32_t seed, const case_data *data, const char *words,
                       case_run *run)
{
    experiment_command c = {{NULL}, 0};
    case_row row;
    char directory[CASE_TEXT], out[CASE_TEXT];
    memset(&row, 0, sizeof row);
    (void)snprintf(row.line, sizeof row.line, "%s", line);
    (void)snprintf(row.bone, sizeof row.bone, "%s", name);
    row.seed = seed;
    row.overlap = data->overlap;
    find_directory(&row, directory);
    (void)snprintf(out, sizeof out, "%.900s/out", directory);
    row.status = -1;
    if (!case_write(data, directory))
        return row;
    case_add_words(data, directory, &c);
    add_words(&c, words);
    case_register(&c, out, run);
    row.status = run->status;
    row.seconds = run->seconds;
    row.expected = case_number(run, "expected_error_mm");
    (void)snprintf(row.verdict, sizeof row.verdict, "%.15s", case_text(run, "verdict"));
    row.start = case_measure_start(data);
    if (row.status == 2 || row.status > 4 || !case_measure_files(data, out, &row.result))
        row.status = -1;
    return row;
}

case_row case_run_row(const char *line, const case_bone *bone, const case_options *options)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_run *const run = case_alloc(1, sizeof *run);
    const char *const path = experiment_data("%s", bone->path);
    case_row row;
    memset(&row, 0, sizeof row);
    row.status = -1;
    if (path != NULL && case_add(data, path, HOST_MIRROR_NONE)) {
        case_make(data, options);
        row = case_run_data(line, bone->name, options->seed, data, "", run);
    }
    case_free(data);
    free(data);
    free(run);
    return row;
}

void case_print_head(void)
{
    (void)printf("%-12s %-20s %4s %5s  %6s %6s  %7s %7s %7s %7s %7s  %6s %4s %6s %6s  %s\n", "case", "bone", "seed",
                 "seen", "start", "vertex", "surface", "vertex", "seen", "unseen", "whole", "said", "exit", "expect",
                 "time s", "bounds");
}

void case_print_row(const case_row *row, double whole, const char *said)
{
    char other[16] = "-";
    if (whole >= 0.0)
        (void)snprintf(other, sizeof other, "%.3f", whole);
    (void)printf("%-12s %-20s %4u %4.0f%%  %6.2f %6.2f  %7.3f %7.3f %7.3f %7.3f %7s  %6s %4d %6.2f %6.2f  %s\n",
                 row->line, row->bone, row->seed, 100.0 * row->overlap, row->start.surface, row->start.vertex,
                 row->result.surface, row->result.vertex, row->result.seen, row->result.unseen, other,
                 row->verdict[0] != '\0' ? row->verdict : "-", row->status, row->expected, row->seconds, said);
    (void)fflush(stdout);
}
