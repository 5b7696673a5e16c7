/* options_read.c: option reading, driven by the table of options_table.c.
 * SPDX-License-Identifier: MIT */

#include <float.h>
#include <stdlib.h>
#include <string.h>
#include "options/options_table.h"

#define OF(field) offsetof(host_options, field)

static host_word word_of(const char *text) { return (host_word){text, strlen(text)}; }

static int refuse_number(const host_option *o, host_word value, host_error *error)
{
    const host_range range = host_option_range(o);
    char place[64];
    const size_t n = value.n < sizeof place - 3u ? value.n : sizeof place - 3u;
    place[0] = '\'';
    memcpy(place + 1, value.start, n);
    place[n + 1u] = '\'';
    place[n + 2u] = '\0';
    return host_fail(error, place, "a %s %s %.10g and at most %.10g",
                     o->kind == HOST_KIND_COUNT ? "whole number" : "number", range.open ? "above" : "of at least",
                     range.min, range.max);
}

static int read_number(const host_option *o, host_word word, double *value, host_error *error)
{
    const host_range range = host_option_range(o);
    int64_t whole = 0;
    int good = o->kind == HOST_KIND_COUNT ? host_word_int(word, &whole) : host_word_double(word, value);
    if (o->kind == HOST_KIND_COUNT)
        *value = (double)whole;
    good = good && *value <= range.max && (range.open ? *value > range.min : *value >= range.min);
    return good ? 0 : refuse_number(o, word, error);
}

/* Reads the number before the next comma; *text: what follows it, NULL at the end. */
static int next_number(const host_option *o, const char **text, host_word *word, double *value, host_error *error)
{
    const char *const comma = strchr(*text, ',');
    *word = word_of(*text);
    if (comma != NULL)
        word->n = (size_t)(comma - *text);
    *text = comma != NULL ? comma + 1 : NULL;
    return read_number(o, *word, value, error);
}

/* "80,30,10": from coarse to fine. */
static int read_radii(const host_option *o, const char *text, smr_prepare_config *prepare, host_error *error)
{
    uint32_t n = 0;
    while (text != NULL) {
        const char *const rest = text;
        host_word word;
        double value = 0.0;
        if (n == SMR_RADII_MAX)
            return host_fail(error, rest, "at most %u radii", SMR_RADII_MAX);
        if (next_number(o, &text, &word, &value, error) != 0)
            return -1;
        if (n > 0 && (float)value >= prepare->radius_mm[n - 1u])
            return host_fail(error, rest, "radii that fall, from coarse to fine");
        if (!((float)value > 0.0f))
            return refuse_number(o, word, error);
        prepare->radius_mm[n++] = (float)value;
    }
    prepare->n_radii = n;
    return 0;
}

/* "5" or "5,0": from the start of the schedule to its end. */
static int read_span(const host_option *o, const char *at, host_span *span, host_error *error)
{
    host_word word;
    double from = 0.0, to = 0.0;
    if (next_number(o, &at, &word, &from, error) != 0 || (at != NULL && read_number(o, word_of(at), &to, error) != 0))
        return -1;
    *span = (host_span){(float)from, (float)to, at != NULL ? 2 : 1};
    return 0;
}

static int read_choice(const host_option *o, const char *text, uint32_t *choice, host_error *error)
{
    const char *word = host_option_words(o);
    uint32_t i = 0;
    while (word != NULL) {
        const char *const bar = strchr(word, '|');
        const size_t n = bar != NULL ? (size_t)(bar - word) : strlen(word);
        if (strlen(text) == n && strncmp(text, word, n) == 0) {
            *choice = i;
            return 0;
        }
        i++;
        word = bar != NULL ? bar + 1 : NULL;
    }
    return host_fail(error, text, "one of %s", host_option_words(o));
}

static int add_file(host_files *files, const char *path, uint32_t most, host_error *error)
{
    if (files->n == most)
        return host_fail(error, path, "at most %u files", most);
    files->path[files->n++] = path;
    return 0;
}

/* Stores one value in the option's field. */
static int store(const host_option *o, const char *text, host_options *options, host_error *error)
{
    void *const field = (unsigned char *)options + o->field;
    double value = 0.0;
    if (o->kind == HOST_KIND_FILES)
        return add_file(field, text, SMR_STRUCTURES_MAX, error);
    if (o->kind == HOST_KIND_RADII)
        return read_radii(o, text, &options->prepare, error);
    if (o->kind == HOST_KIND_WORD)
        return read_choice(o, text, field, error);
    if (o->kind == HOST_KIND_SPAN)
        return read_span(o, text, field, error);
    if (o->kind == HOST_KIND_TEXT) {
        if (text[0] == '\0')
            return host_fail(error, "value", "a text that is not empty");
        *(const char **)field = text;
        return 0;
    }
    if (read_number(o, word_of(text), &value, error) != 0)
        return -1;
    if (o->kind == HOST_KIND_COUNT)
        *(uint32_t *)field = (uint32_t)value;
    else if (o->kind == HOST_KIND_DOUBLE)
        *(double *)field = value;
    else
        *(float *)field = (float)value;
    /* what is denormal counts as 0, as in the library */
    const float least = (float)host_option_range(o).min;
    if (o->kind == HOST_KIND_FLOAT && host_option_range(o).open &&
        !(*(float *)field > least && (least != 0.0f || *(float *)field >= FLT_MIN)))
        return refuse_number(o, word_of(text), error);
    return 0;
}

static int is_option(const char *text) { return text[0] == '-' && text[1] != '\0'; }

/* One option with its values; *at is left behind them. */
static int read_option(int argc, char **argv, int *at, host_options *options, host_error *error)
{
    const char *const name = argv[*at];
    const host_option *const o = host_option_find(name, options->command);
    int n = 0;
    error->file = name;
    if (o == NULL)
        return host_fail(error, "option", "an option of this command (see smr --help)");
    *at += 1;
    options->given[(size_t)(o - host_option_table) / 64u] |= (uint64_t)1 << (size_t)(o - host_option_table) % 64u;
    if (o->prepares && options->prepare_option == NULL)
        options->prepare_option = o->name;
    if (o->kind == HOST_KIND_FLAG) {
        *(uint32_t *)(void *)((unsigned char *)options + o->field) = 1;
        return 0;
    }
    /* A number may start with a minus sign; a file may not (write ./-name). */
    while (*at < argc &&
           ((n == 0 && o->kind != HOST_KIND_FILES && o->kind != HOST_KIND_TEXT) || !is_option(argv[*at])) &&
           (n == 0 || o->kind == HOST_KIND_FILES)) {
        if (store(o, argv[*at], options, error) != 0)
            return -1;
        *at += 1;
        n++;
    }
    if (n == 0)
        return host_fail(error, "value", o->kind == HOST_KIND_FILES ? "one file or more" : "a value");
    return 0;
}

/* Whether --paper is given anywhere: what other options set counts, whichever comes first. */
static int wants_paper(int argc, char **argv)
{
    for (int i = 2; i < argc; i++)
        if (strcmp(argv[i], "--paper") == 0)
            return 1;
    return 0;
}

/* A summary is of as many results as there are; others take as many as a model has structures. */
static uint32_t operands_most(int verb, int argc) { return verb == HOST_SUMMARY ? (uint32_t)argc : SMR_STRUCTURES_MAX; }

static const size_t lists[] = {OF(model),        OF(target),         OF(operands),     OF(landmarks), OF(frames),
                               OF(volume_ratio), OF(landmark_goals), OF(contact_with), OF(also)};

#define N_LISTS (sizeof lists / sizeof lists[0])

static host_files *list_at(host_options *options, size_t i)
{
    return (host_files *)(void *)((unsigned char *)options + lists[i]);
}

static int set_defaults(int command, int argc, int paper, host_options *options)
{
    memset(options, 0, sizeof *options);
    options->command = command;
    options->seed = 1;
    options->repeats = 7;
    options->step = 10;
    options->seconds = 4.0;
    options->fps = 30.0;
    options->passes = 80;
    options->mirror_model = HOST_MIRROR_NONE;
    options->mirror_target = HOST_MIRROR_NONE;
    options->prepare = paper ? smr_prepare_config_paper() : smr_prepare_config_default();
    options->config = paper ? smr_config_paper() : smr_config_default();
    options->goal_weight = 1.0f;
    for (size_t i = 0; i < N_LISTS; i++) {
        host_files *const files = list_at(options, i);
        files->path = calloc(files == &options->operands ? operands_most(command, argc) : SMR_STRUCTURES_MAX,
                             sizeof *files->path);
        if (files->path == NULL)
            return -1;
    }
    return 0;
}

int host_options_read(int command, int argc, char **argv, host_options *options, host_error *error)
{
    int at = 2;
    error->file = "usage";
    if (set_defaults(command, argc, wants_paper(argc, argv), options) != 0)
        return host_fail(error, "start", "free memory");
    options->arguments = argv + at;
    options->n_arguments = argc - at;
    while (at < argc) {
        if (is_option(argv[at])) {
            if (read_option(argc, argv, &at, options, error) != 0)
                return -1;
        } else {
            error->file = argv[at];
            if ((command & (HOST_INFO | HOST_MEASURE | HOST_REPLAY | HOST_SUMMARY | HOST_SURFACES | HOST_LABELS)) == 0)
                return host_fail(error, "argument", "an option before it (see smr --help)");
            if (add_file(&options->operands, argv[at++], operands_most(command, argc), error) != 0)
                return -1;
        }
    }
    if (options->clusters == HOST_CLUSTERS_SHARED)
        options->prepare.separate_below_mm = 0.0f;
    else if (options->clusters == HOST_CLUSTERS_SEPARATE)
        options->prepare.separate_below_mm = SMR_COORD_MAX; /* the most that smr_prepare() takes */
    if (options->keep_volume || options->volume_ratio.n > 0)
        options->config.contact.volume = 1.0f;
    return host_options_check(options, error);
}

void host_options_free(host_options *options)
{
    for (size_t i = 0; i < N_LISTS; i++)
        free(list_at(options, i)->path);
    memset(options, 0, sizeof *options);
}
