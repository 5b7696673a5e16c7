/* case_tool.c: makes cases with a known truth, measures results, and runs the tables of partial targets.
 * SPDX-License-Identifier: MIT */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case.h"
#include "case_run.h"
#include "case_table.h"
#include "case_verdicts.h"

static const char usage[] =
    "case_tool make [OPTIONS] --model FILE... -o DIR    model, target, truth, whole, seen in DIR\n"
    "case_tool measure DIR RESULT                       one line of figures; RESULT is a PLY or a directory of them\n"
    "case_tool run DIR OUT [WORDS...]                   smr register of the case, then the same line\n"
    "case_tool table [LINES...] [--bones NAME...] [--seeds A-B] [--keep DIR]\n"
    "    LINES: side patches end outliers person length thigh points random, or all (the default: all but random);\n"
    "    --bones: beginnings of the names m_right 2008 2007 vhm_left hip_thigh hip_bone hip_right\n"
    "case_tool verdicts FIRST LAST DIR FILE.csv [KIND]  runs of all kinds, good and hopeless, a row each\n"
    "case_tool judge FILE.csv                           how often verdicts were wrong\n"
    "make: --seed N --part whole|side|patches|end|front --share X --patches N --side-deg X --deform MM --sigma MM\n"
    "    --shift MM --turn DEG --noise MM --isotropic --outliers X --outlier-mm MM --spikes --density 0|1|2 --mirror\n"
    "SMR names the program (build/smr), SMR_TEST_DATA the data, CASE_THREADS its threads (1),\n"
    "SMR_EXPERIMENT_OPTIONS more words of every registration.\n";

typedef struct number_option {
    const char *name;
    double *value;
} number_option;

static int read_part(const char *text)
{
    static const char *const names[] = {"whole", "side", "patches", "end", "front"};
    int i = 0;
    for (i = 0; i < 5; i++)
        if (strcmp(text, names[i]) == 0)
            return i;
    (void)fprintf(stderr, "case_tool: no part %s\n", text);
    exit(2);
}

/* 1 when the word was a number's option, with its value behind it. */
static int read_number(const char *word, const char *value, case_options *o, double *seed, double *patches,
                       double *density)
{
    const number_option all[] = {
        {"--share", &o->share},    {"--side-deg", &o->side_deg}, {"--deform", &o->deform_mm},
        {"--sigma", &o->sigma_mm}, {"--shift", &o->shift_mm},    {"--turn", &o->turn_deg},
        {"--noise", &o->noise_mm}, {"--outliers", &o->outliers}, {"--outlier-mm", &o->outlier_mm},
        {"--seed", seed},          {"--patches", patches},       {"--density", density}};
    size_t i = 0;
    for (i = 0; value != NULL && i < sizeof all / sizeof all[0]; i++)
        if (strcmp(word, all[i].name) == 0) {
            *all[i].value = atof(value);
            return 1;
        }
    return 0;
}

static void print_figures(const case_figures *f, const char *name)
{
    (void)printf("%s surface %.3f (to %.3f from %.3f max %.2f worst %.3f) vertex %.3f seen %.3f unseen %.3f "
                 "share_seen %.3f\n",
                 name, f->surface, f->to, f->from, f->farthest, f->worst, f->vertex, f->seen, f->unseen, f->share);
}

static int do_make(int n, char **word)
{
    case_options o = case_defaults();
    case_data *const data = case_alloc(1, sizeof *data);
    double seed = 1, patches = o.patches, density = o.density;
    const char *out = NULL;
    int i = 0, mirror = HOST_MIRROR_NONE, good = 1;
    uint32_t b = 0;
    for (i = 0; i < n; i++) {
        if (strcmp(word[i], "--mirror") == 0)
            mirror = HOST_MIRROR_X;
        else if (strcmp(word[i], "--isotropic") == 0)
            o.noise_isotropic = 1;
        else if (strcmp(word[i], "--spikes") == 0)
            o.spikes = 1;
        else if (strcmp(word[i], "--part") == 0 && i + 1 < n)
            o.part = read_part(word[++i]);
        else if (strcmp(word[i], "-o") == 0 && i + 1 < n)
            out = word[++i];
        else if (strcmp(word[i], "--model") == 0)
            while (good && i + 1 < n && word[i + 1][0] != '-')
                good = case_add(data, word[++i], mirror);
        else if (read_number(word[i], i + 1 < n ? word[i + 1] : NULL, &o, &seed, &patches, &density))
            i++;
        else
            good = 0;
    }
    o.seed = (uint32_t)seed;
    o.patches = (int)patches;
    o.density = (int)density;
    if (!good || out == NULL || data->n == 0) {
        (void)fputs(usage, stderr);
        return 2;
    }
    case_make(data, &o);
    good = case_write(data, out);
    {
        const case_figures start = case_measure_start(data);
        print_figures(&start, "start:");
    }
    (void)printf("visible %.3f of the area", data->overlap);
    for (b = 0; b < data->n; b++)
        (void)printf("%s %s: target %u vertices, resampling %.4f mm", b > 0 ? ";" : ";", data->body[b].name,
                     data->body[b].target.n_vertices, data->body[b].resampling);
    (void)putchar('\n');
    case_free(data);
    free(data);
    return good ? 0 : 1;
}

static int do_measure(const char *directory, const char *result)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_figures f;
    const int good = case_read(data, directory) && case_measure_files(data, result, &f);
    if (good)
        print_figures(&f, "result:");
    case_free(data);
    free(data);
    return good ? 0 : 1;
}

static int do_run(const char *directory, const char *out, int n, char **word)
{
    case_data *const data = case_alloc(1, sizeof *data);
    case_run *const run = case_alloc(1, sizeof *run);
    experiment_command words = {{NULL}, 0};
    case_figures f;
    int i = 0, good = case_read(data, directory);
    case_add_words(data, directory, &words);
    for (i = 0; i < n; i++)
        experiment_add(&words, "%s", word[i]);
    case_register(&words, out, run);
    f = case_measure_start(data);
    print_figures(&f, "start:");
    good = good && case_measure_files(data, out, &f);
    if (good)
        print_figures(&f, "result:");
    (void)printf("status %d verdict %s seconds %.2f\n", run->status, case_text(run, "verdict"), run->seconds);
    case_free(data);
    free(data);
    free(run);
    return good ? 0 : 1;
}

int main(int argc, char **argv)
{
    if (argc > 2 && strcmp(argv[1], "make") == 0)
        return do_make(argc - 2, argv + 2);
    if (argc == 4 && strcmp(argv[1], "measure") == 0)
        return do_measure(argv[2], argv[3]);
    if (argc >= 4 && strcmp(argv[1], "run") == 0)
        return do_run(argv[2], argv[3], argc - 4, argv + 4);
    if (argc >= 2 && strcmp(argv[1], "table") == 0)
        return case_table(argc - 2, argv + 2);
    if ((argc == 6 || argc == 7) && strcmp(argv[1], "verdicts") == 0)
        return case_verdicts((uint32_t)atoi(argv[2]), (uint32_t)atoi(argv[3]), argc == 7 ? argv[6] : NULL, argv[4],
                             argv[5]);
    if (argc == 3 && strcmp(argv[1], "judge") == 0)
        return case_judge(argv[2]);
    (void)fputs(usage, stderr);
    return 2;
}
