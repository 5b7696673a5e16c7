/* experiment.c: paths, child processes, bounds and small files of the experiments.
 * SPDX-License-Identifier: MIT */
#define _XOPEN_SOURCE 700

#include "experiment.h"

#include <dirent.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "measure/surface_distances.h"

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define INSTRUMENTED 1
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define INSTRUMENTED 1
#endif
#ifndef INSTRUMENTED
#define INSTRUMENTED 0
#endif

enum { PATHS = 16, PATH_BYTES = 1024 };

static char path_text[PATHS][PATH_BYTES];
static unsigned path_next;
static char scratch[PATH_BYTES];
static int misses;

static char *new_path(void) { return path_text[path_next++ % PATHS]; }

int experiment_full(void)
{
    const char *const asked = getenv("SMR_EXPERIMENTS");
    return asked != NULL && (strcmp(asked, "full") == 0 || strcmp(asked, "all") == 0);
}

int experiment_all(void)
{
    const char *const asked = getenv("SMR_EXPERIMENTS");
    return asked != NULL && strcmp(asked, "all") == 0;
}

const char *experiment_data(const char *format, ...)
{
    const char *const data = getenv("SMR_TEST_DATA");
    char *const path = new_path();
    struct stat found;
    va_list list;
    size_t n = 0;
    if (INSTRUMENTED && !experiment_full()) {
        (void)puts("skipped: instrumented code takes too long (SMR_EXPERIMENTS=full runs it)");
        return NULL;
    }
    (void)snprintf(path, PATH_BYTES, "%s/", data != NULL ? data : "../shared/data");
    n = strlen(path);
    va_start(list, format);
    (void)vsnprintf(path + n, PATH_BYTES - n, format, list);
    va_end(list);
    if (stat(path, &found) == 0)
        return path;
    (void)printf("skipped: %s is not there (SMR_TEST_DATA=DIR says where)\n", path);
    return NULL;
}

static int remove_one(const char *path, const struct stat *about, int kind, struct FTW *place)
{
    (void)about;
    (void)kind;
    (void)place;
    (void)remove(path);
    return 0;
}

static void remove_scratch(void) { (void)nftw(scratch, remove_one, 8, FTW_DEPTH | FTW_PHYS); }

const char *experiment_scratch(const char *format, ...)
{
    char *const path = new_path();
    va_list list;
    int n = 0;
    if (scratch[0] == '\0') {
        const char *const tmp = getenv("TMPDIR");
        (void)snprintf(scratch, sizeof scratch, "%s/smr_experiment_XXXXXX", tmp != NULL ? tmp : "/tmp");
        if (mkdtemp(scratch) == NULL) {
            perror(scratch);
            exit(1);
        }
        (void)atexit(remove_scratch);
    }
    n = snprintf(path, PATH_BYTES, "%.500s/", scratch);
    va_start(list, format);
    (void)vsnprintf(path + n, PATH_BYTES - (size_t)n, format, list);
    va_end(list);
    return path;
}

int experiment_directory(const char *path)
{
    struct stat found;
    return mkdir(path, 0700) == 0 || (stat(path, &found) == 0 && S_ISDIR(found.st_mode));
}

void experiment_add(experiment_command *command, const char *format, ...)
{
    const int room = (int)(sizeof command->word / sizeof command->word[0]) - 1;
    char text[PATH_BYTES];
    va_list list;
    va_start(list, format);
    (void)vsnprintf(text, sizeof text, format, list);
    va_end(list);
    command->word[command->n] = command->n < room ? strdup(text) : NULL;
    if (command->word[command->n] == NULL) {
        (void)fputs("experiment: too many words, or no memory\n", stderr);
        exit(1);
    }
    command->word[++command->n] = NULL;
}

static int is_surface(const struct dirent *entry)
{
    const size_t n = strlen(entry->d_name);
    return n > 4u && strcmp(entry->d_name + n - 4u, ".ply") == 0;
}

void experiment_add_surfaces(experiment_command *command, const char *directory)
{
    struct dirent **list = NULL;
    const int n = scandir(directory, &list, is_surface, alphasort);
    int i = 0;
    for (i = 0; i < n; i++) {
        experiment_add(command, "%s/%s", directory, list[i]->d_name);
        free(list[i]);
    }
    free(list);
}

void experiment_add_environment(experiment_command *command, const char *name)
{
    const char *at = getenv(name);
    while (at != NULL && *at != '\0') {
        const size_t n = strcspn(at, " ");
        if (n > 0)
            experiment_add(command, "%.*s", (int)n, at);
        at += n + (at[n] == ' ');
    }
}

int experiment_build(const char *surfaces, const char *reference, const char *out)
{
    experiment_command c = {{NULL}, 0};
    struct stat found;
    experiment_add(&c, "build");
    experiment_add(&c, "--model");
    if (stat(surfaces, &found) == 0 && S_ISDIR(found.st_mode))
        experiment_add_surfaces(&c, surfaces);
    else
        experiment_add(&c, "%s", surfaces);
    experiment_add(&c, "--reference");
    experiment_add(&c, "%s", reference);
    experiment_add(&c, "-o");
    experiment_add(&c, "%s", out);
    experiment_add_environment(&c, "SMR_EXPERIMENT_BUILD");
    return experiment_run(&c) == 0;
}

void experiment_free(experiment_command *command)
{
    while (command->n > 0)
        free(command->word[--command->n]);
    memset(command, 0, sizeof *command);
}

static void show_log(const char *log, const experiment_command *command)
{
    FILE *const file = fopen(log, "r");
    int i = 0, c = 0;
    (void)printf("failed: smr");
    for (i = 0; i < command->n; i++)
        (void)printf(" %s", command->word[i]);
    (void)putchar('\n');
    while (file != NULL && (c = fgetc(file)) != EOF)
        (void)putchar(c);
    if (file != NULL)
        (void)fclose(file);
}

int experiment_run(experiment_command *command)
{
    const char *const program = getenv("SMR") != NULL ? getenv("SMR") : "build/smr";
    const char *const log = experiment_scratch("log");
    char *word[100] = {NULL};
    int status = 0, i = 0;
    pid_t child = 0;
    for (i = 0; i < command->n; i++)
        word[i + 1] = command->word[i];
    (void)fflush(NULL);
    child = fork();
    if (child == 0) {
        const int to = open(log, O_WRONLY | O_CREAT | O_TRUNC, 0600);
        if (to >= 0 && dup2(to, 1) >= 0 && dup2(to, 2) >= 0) {
            char name[PATH_BYTES];
            (void)snprintf(name, sizeof name, "%s", program);
            word[0] = name;
            (void)execv(program, word);
        }
        _exit(127);
    }
    if (child < 0 || waitpid(child, &status, 0) != child)
        status = -1;
    status = status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : 128;
    if (!experiment_written(status))
        show_log(log, command);
    experiment_free(command);
    return status;
}

int experiment_written(int status) { return status == 0 || status == 1 || status == 3 || status == 4; }

void experiment_bound(const char *what, double value, double limit)
{
    const int good = value <= limit; /* not so for NaN */
    (void)printf("  %-4s %-60s %8.3f, at most %g\n", good ? "ok" : "MISS", what, value, limit);
    misses += !good;
}

int experiment_misses(void)
{
    const int n = misses;
    misses = 0;
    (void)fflush(stdout);
    return n;
}

int experiment_write_landmarks(const char *path, const host_landmarks *landmarks)
{
    FILE *const file = fopen(path, "w");
    uint32_t i = 0;
    if (file == NULL)
        return 0;
    for (i = 0; i < landmarks->n; i++)
        (void)fprintf(file, "\"%s\",%.9g,%.9g,%.9g\n", landmarks->label[i], (double)landmarks->xyz[i][0],
                      (double)landmarks->xyz[i][1], (double)landmarks->xyz[i][2]);
    return fclose(file) == 0;
}

int experiment_distance(const host_mesh *from, const unsigned char *use, const host_mesh *to, double *mean, double *max)
{
    const smr_mesh view = host_mesh_view(to);
    const smr_port one_thread = {0};
    void *memory = NULL;
    host_query query;
    host_stats stats = {0.0, 0.0, 0.0, 0.0, 0, 0.0};
    int good = 0;
    memset(&query, 0, sizeof query);
    query.surface = host_surface_make(&view, &memory);
    query.mesh = host_mesh_view(from);
    good = query.surface != NULL && host_distances(&one_thread, &query, 1) == 0 &&
           host_area_stats(&query, 1, &use, &stats) == 0 && stats.n > 0;
    host_queries_free(&query, 1);
    free(memory);
    *mean = stats.mean;
    *max = stats.max;
    return good;
}
