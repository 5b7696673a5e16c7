/* case_verdicts.c: runs of all kinds, a row of CSV each.
 * SPDX-License-Identifier: MIT */
#include "case_verdicts.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "case_expected.h"
#include "case_kinds.h"

enum { COLUMNS = 500 };

/* The report's keys, found by the first run of each sort; later ones that are new are left out. */
typedef struct header {
    char key[COLUMNS][96];
    uint32_t n;
} header;

static int is_left_out(const char *key)
{
    static const char *const names[] = {"per_structure", "start_pose", "radii",   "radius_mm",      "state_hash",
                                        "command",       "inputs",     "version", "targets_unused", "memory_bytes"};
    size_t i = 0;
    for (i = 0; i < sizeof names / sizeof names[0]; i++)
        if (strncmp(key, names[i], strlen(names[i])) == 0)
            return 1;
    return 0;
}

static void add_keys(header *h, const case_run *run)
{
    uint32_t i = 0, k = 0;
    for (i = 0; i < run->n; i++) {
        for (k = 0; k < h->n && strcmp(h->key[k], run->value[i].key) != 0; k++)
            ;
        if (k == h->n && k < COLUMNS && !is_left_out(run->value[i].key))
            memcpy(h->key[h->n++], run->value[i].key, sizeof h->key[0]);
    }
}

/* Runs one job; its figures. */
static int run_job(case_job *job, const char *directory, case_run *run, case_figures *f, case_told *told)
{
    char out[CASE_TEXT], path[CASE_TEXT];
    uint32_t i = 0;
    (void)snprintf(out, sizeof out, "%.900s/out", directory);
    for (i = 0; i < job->data.n; i++) {
        (void)snprintf(path, sizeof path, "%.900s/%.64s.ply", out, job->data.body[i].name);
        (void)remove(path);
    }
    experiment_add(&job->words, "--vertex-errors");
    case_register(&job->words, out, run);
    memset(f, 0, sizeof *f);
    f->surface = f->vertex = -1.0;
    *told = case_tell(&job->data, out);
    return run->status != 2 && run->status <= 4 && case_measure_files(&job->data, out, f);
}

static void print_word(FILE *file, const char *text)
{
    (void)fputc(',', file);
    for (; *text != '\0'; text++)
        (void)fputc(*text == ',' ? ';' : *text == '"' || *text == '\n' ? '\'' : *text, file);
}

static void print_header(FILE *file, const header *h)
{
    uint32_t i = 0;
    (void)fprintf(file, "seed,kind,bone,fair,hopeless,image,overlap,start_surface,start_vertex,surface,vertex,seen,"
                        "unseen,farthest,worst,status,seconds,spearman_vertex,spearman_surface,ratio_vertex,"
                        "ratio_surface");
    for (i = 0; i < h->n; i++)
        print_word(file, h->key[i]);
    (void)fputc('\n', file);
}

static void print_row(FILE *file, const header *h, const case_job *job, const case_run *run, const case_figures *f,
                      const case_told *told)
{
    case_figures start;
    uint32_t i = 0;
    memset(&start, 0, sizeof start);
    start.surface = start.vertex = -1.0;
    if (job->picture == NULL)
        start = case_measure_start(&job->data);
    (void)fprintf(file, "%u,%s,%s,%d,%d,%d,%.3f,%.3f,%.3f,%.4f,%.4f,%.4f,%.4f,%.3f,%.3f,%d,%.2f,%.3f,%.3f,%.3f,%.3f",
                  job->seed, job->kind, job->bone, job->fair, job->hopeless, job->picture != NULL, job->data.overlap,
                  start.surface, start.vertex, f->surface, f->vertex, f->seen, f->unseen, f->farthest, f->worst,
                  run->status, run->seconds, told->spearman[0], told->spearman[1], told->ratio[0], told->ratio[1]);
    for (i = 0; i < h->n; i++)
        print_word(file, case_text(run, h->key[i]));
    (void)fputc('\n', file);
    (void)fflush(file);
}

/* Fills the header from a run with a surface and one with an image. */
static int find_columns(const char *directory, case_run *run, header *h)
{
    static const char *const kinds[] = {"whole", "image"};
    case_job *const job = case_alloc(1, sizeof *job);
    case_figures f;
    case_told told;
    int i = 0, good = 1;
    for (i = 0; good && i < 2; i++) {
        good = case_job_make(job, 2, kinds[i], directory) && run_job(job, directory, run, &f, &told);
        add_keys(h, run);
        case_job_free(job);
    }
    free(job);
    return good;
}

int case_verdicts(uint32_t first, uint32_t last, const char *kind, const char *directory, const char *csv)
{
    header *const h = case_alloc(1, sizeof *h);
    case_run *const run = case_alloc(1, sizeof *run);
    case_job *const job = case_alloc(1, sizeof *job);
    FILE *const file = fopen(csv, "w");
    uint32_t seed = 0, not_done = 0;
    int good = file != NULL && experiment_directory(directory) && find_columns(directory, run, h);
    if (good)
        print_header(file, h);
    for (seed = first; good && seed <= last; seed++) {
        case_figures f;
        case_told told;
        if (!case_job_make(job, seed, kind, directory)) {
            not_done++;
        } else {
            not_done += !run_job(job, directory, run, &f, &told);
            print_row(file, h, job, run, &f, &told);
        }
        case_job_free(job);
    }
    (void)printf("%u runs without a result\n", not_done);
    if (file != NULL)
        (void)fclose(file);
    free(h);
    free(run);
    free(job);
    return good ? 0 : 1;
}
