/* Option reading, driven by one table: name, commands, kind, field, range.
 * SPDX-License-Identifier: MIT */
#include "host_options.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "host_text.h"
#include "host_volume.h"

enum kind { KIND_FILES, KIND_TEXT, KIND_FLAG, KIND_COUNT, KIND_FLOAT, KIND_DOUBLE, KIND_WORD, KIND_RADII, KIND_SPAN };

typedef struct option {
    const char *name;
    int commands; /* HOST_REGISTER | ... */
    enum kind kind;
    size_t field;    /* offset in host_options */
    double min, max; /* of numbers */
    int open;        /* 1: above min, not equal */
    int prepares;    /* 1: matters only when a model is prepared */
    const char *words; /* KIND_WORD: "a|b|c", stored as 0, 1, 2 */
    int targets;       /* FOR_SURFACES, FOR_IMAGES, 0 for both */
} option;

enum { FOR_SURFACES = 1, FOR_IMAGES = 2 };

#define FIELD(name) offsetof(host_options, name)
#define PREPARING (HOST_REGISTER | HOST_BUILD | HOST_INFO)
#define IMAGE_SEARCH_MAX 60.0 /* mm: the library's */
#define IMAGE_SMOOTHING 100.0f /* mm: about what clusters of the coarsest radius put right themselves; points clicked in an image are uncertain */
#define COORD ((double)SMR_COORD_MAX)

static const option table[] = {
    {"--model", HOST_REGISTER | HOST_BUILD | HOST_BENCH, KIND_FILES, FIELD(model), 0, 0, 0, 0, NULL, 0},
    {"--target", HOST_REGISTER | HOST_BENCH, KIND_FILES, FIELD(target), 0, 0, 0, 0, NULL, 0},
    {"-o", HOST_REGISTER | HOST_BUILD | HOST_PHANTOM | HOST_BENCH, KIND_TEXT, FIELD(out), 0, 0, 0, 0, NULL, 0},
    {"--reference", HOST_REGISTER | HOST_BUILD | HOST_BENCH, KIND_TEXT, FIELD(reference), 0, 0, 0, 1, NULL, FOR_IMAGES},
    {"--landmarks", HOST_REGISTER | HOST_BENCH, KIND_FILES, FIELD(landmarks), 0, 0, 0, 0, NULL, 0},
    {"--truth", HOST_REGISTER | HOST_BENCH, KIND_TEXT, FIELD(truth), 0, 0, 0, 0, NULL, FOR_IMAGES},
    {"--c-array", HOST_BUILD, KIND_TEXT, FIELD(c_array), 0, 0, 0, 0, NULL, 0},
    {"--source", HOST_MEASURE, KIND_TEXT, FIELD(source), 0, 0, 0, 0, NULL, 0},
    {"--mirror-model", PREPARING | HOST_BENCH, KIND_WORD, FIELD(mirror_model), 0, 0, 0, 1, "x|y|z", 0},
    {"--mirror-target", HOST_REGISTER | HOST_BENCH, KIND_WORD, FIELD(mirror_target), 0, 0, 0, 0, "x|y|z", 0},
    {"--threads", HOST_REGISTER | HOST_MEASURE | HOST_PHANTOM | HOST_BENCH, KIND_COUNT, FIELD(threads), 1,
     SMR_WORKERS_MAX, 0, 0, NULL, 0},
    {"--ticks", HOST_REGISTER, KIND_COUNT, FIELD(ticks), 1, 1e9, 0, 0, NULL, 0},
    {"--budget-ms", HOST_REGISTER, KIND_DOUBLE, FIELD(budget_ms), 0, 1e6, 0, 0, NULL, 0},
    {"--align", HOST_REGISTER, KIND_WORD, FIELD(align), 0, 0, 0, 0, "none|rigid|similarity", 0},
    {"--smoothing", HOST_REGISTER, KIND_FLOAT, FIELD(smoothing), 0, 1e9, 0, 0, NULL, 0},
    {"--quiet", HOST_REGISTER | HOST_BUILD | HOST_PHANTOM | HOST_BENCH, KIND_FLAG, FIELD(quiet), 0, 0, 0, 0, NULL, 0},
    {"--radius", PREPARING, KIND_RADII, FIELD(prepare), 0, COORD, 1, 1, NULL, 0},
    {"--clusters", PREPARING, KIND_WORD, FIELD(clusters), 0, 0, 0, 1, "auto|shared|separate", 0},
    {"--distance", PREPARING, KIND_WORD, FIELD(prepare.distance), 0, 0, 0, 1, "euclidean|geodesic", 0},
    {"--mass", PREPARING, KIND_WORD, FIELD(prepare.mass), 0, 0, 0, 1, "unit|area", 0},
    {"--order", PREPARING, KIND_WORD, FIELD(prepare.order), 0, 0, 0, 1, "forest|breadth-first", 0},
    {"--block", PREPARING, KIND_COUNT, FIELD(prepare.block_vertices), 16, 65536, 0, 1, NULL, 0},
    {"--profile-samples", HOST_REGISTER | HOST_BUILD, KIND_COUNT, FIELD(prepare.profile_samples), 3, 64, 0, 1, NULL, FOR_IMAGES},
    {"--profile-step", HOST_REGISTER | HOST_BUILD, KIND_FLOAT, FIELD(prepare.profile_step_mm), 0, 100, 1, 1, NULL, FOR_IMAGES},
    {"--profile-inward", HOST_REGISTER | HOST_BUILD, KIND_FLOAT, FIELD(prepare.profile_inward), 0, 1, 0, 1, NULL, FOR_IMAGES},
    {"--method", HOST_REGISTER, KIND_WORD, FIELD(config.method), 0, 0, 0, 0, "rigid|polar", 0},
    {"--normals", HOST_REGISTER, KIND_WORD, FIELD(config.normals), 0, 0, 0, 0, "carried|exact", 0},
    {"--search", HOST_REGISTER, KIND_SPAN, FIELD(search), 0, COORD, 0, 0, NULL, 0},
    {"--gradient", HOST_REGISTER, KIND_SPAN, FIELD(gradient), 0, IMAGE_SEARCH_MAX, 0, 0, NULL, FOR_IMAGES},
    {"--similarity", HOST_REGISTER, KIND_WORD, FIELD(config.similarity), 0, 0, 0, 0, "ncc|ssd|concordance", FOR_IMAGES},
    {"--confidence", HOST_REGISTER, KIND_FLOAT, FIELD(config.confidence), 0, 1, 0, 0, NULL, FOR_IMAGES},
    {"--normal-angle", HOST_REGISTER, KIND_FLOAT, FIELD(config.normal_deg), 0, 180, 1, 0, NULL, FOR_SURFACES},
    {"--stiffness", HOST_REGISTER, KIND_FLOAT, FIELD(config.stiffness), 0, 1, 1, 0, NULL, 0},
    {"--attraction", HOST_REGISTER, KIND_FLOAT, FIELD(config.attraction), 0, 1, 0, 0, NULL, FOR_SURFACES},
    {"--slide", HOST_REGISTER, KIND_FLOAT, FIELD(config.slide), 0, 1, 0, 0, NULL, FOR_SURFACES},
    {"--even", HOST_REGISTER, KIND_FLOAT, FIELD(config.even), 0, 1, 0, 0, NULL, FOR_SURFACES},
    {"--relaxation", HOST_REGISTER, KIND_FLOAT, FIELD(config.relaxation), 0, 1, 1, 0, NULL, 0},
    {"--reject-deviations", HOST_REGISTER, KIND_FLOAT, FIELD(config.reject_deviations), 0, 1000, 0, 0, NULL,
     FOR_SURFACES},
    {"--reject-border", HOST_REGISTER, KIND_FLAG, FIELD(config.reject_border), 0, 0, 0, 0, NULL, FOR_SURFACES},
    {"--node-budget", HOST_REGISTER, KIND_COUNT, FIELD(config.node_budget), 8, 1000000, 0, 0, NULL, FOR_SURFACES},
    {"--plastic-um", HOST_REGISTER, KIND_FLOAT, FIELD(config.plastic_um), 0, 1e6, 0, 0, NULL, 0},
    {"--plastic-every", HOST_REGISTER, KIND_COUNT, FIELD(config.plastic_every), 0, 1000, 0, 0, NULL, 0},
    {"--seed", HOST_PHANTOM | HOST_BENCH, KIND_COUNT, FIELD(seed), 1, 1e9, 0, 0, NULL, 0},
    {"--small", HOST_PHANTOM | HOST_BENCH, KIND_FLAG, FIELD(small), 0, 0, 0, 0, NULL, 0},
    {"--figure2", HOST_BENCH, KIND_FLAG, FIELD(figure2), 0, 0, 0, 0, NULL, 0},
    {"--soak", HOST_BENCH, KIND_FLAG, FIELD(soak), 0, 0, 0, 0, NULL, 0},
    {"--repeats", HOST_BENCH, KIND_COUNT, FIELD(repeats), 1, 1000, 0, 0, NULL, 0},
    {"--step", HOST_BENCH, KIND_COUNT, FIELD(step), 5, 50, 0, 0, NULL, 0},
    {"--seconds", HOST_BENCH, KIND_DOUBLE, FIELD(seconds), 0, 1e5, 1, 0, NULL, 0},
    {"--iterations", HOST_REGISTER, KIND_COUNT, FIELD(config.iterations), 1, 100000, 0, 0, NULL, 0},
    {"--iterations-last", HOST_REGISTER, KIND_COUNT, FIELD(config.iterations_last), 1, 100000, 0, 0, NULL, 0},
    {"--active", HOST_REGISTER, KIND_FLOAT, FIELD(config.active_share), 0, 1, 0, 0, NULL, 0},
    {"--active-first", HOST_REGISTER, KIND_FLOAT, FIELD(config.active_first), 0, 1, 0, 0, NULL, 0},
    {"--active-enough", HOST_REGISTER, KIND_COUNT, FIELD(config.active_enough), 0, 1000000, 0, 0, NULL, FOR_IMAGES},
};

_Static_assert(sizeof table / sizeof table[0] <= 64, "one bit for each option");

static const option *find_option(const char *name, int command)
{
    size_t i = 0;
    for (i = 0; i < sizeof table / sizeof table[0]; i++)
        if ((table[i].commands & command) != 0 && strcmp(table[i].name, name) == 0)
            return &table[i];
    return NULL;
}

static host_word word_of(const char *text)
{
    host_word word;
    word.start = text;
    word.n = strlen(text);
    return word;
}

static int refuse_number(const option *o, host_word value, host_error *error)
{
    char place[64];
    const size_t n = value.n < sizeof place - 3u ? value.n : sizeof place - 3u;
    place[0] = '\'';
    memcpy(place + 1, value.start, n);
    place[n + 1u] = '\'';
    place[n + 2u] = '\0';
    return host_fail(error, place, "a %s %s %.10g and at most %.10g", o->kind == KIND_COUNT ? "whole number" : "number",
                     o->open ? "above" : "of at least", o->min, o->max);
}

static int read_number(const option *o, host_word word, double *value, host_error *error)
{
    int64_t whole = 0;
    int good = o->kind == KIND_COUNT ? host_word_int(word, &whole) : host_word_double(word, value);
    if (o->kind == KIND_COUNT)
        *value = (double)whole;
    good = good && *value <= o->max && (o->open ? *value > o->min : *value >= o->min);
    return good ? 0 : refuse_number(o, word, error);
}

/* "80,30,10": from coarse to fine. */
static int read_radii(const option *o, const char *text, smr_prepare_config *prepare, host_error *error)
{
    uint32_t n = 0;
    while (text != NULL) {
        const char *const comma = strchr(text, ',');
        host_word word = word_of(text);
        double value = 0.0;
        if (comma != NULL)
            word.n = (size_t)(comma - text);
        if (n == SMR_RADII_MAX)
            return host_fail(error, text, "at most %u radii", SMR_RADII_MAX);
        if (read_number(o, word, &value, error) != 0)
            return -1;
        if (n > 0 && (float)value >= prepare->radius_mm[n - 1u])
            return host_fail(error, text, "radii that fall, from coarse to fine");
        if (!((float)value > 0.0f))
            return refuse_number(o, word, error);
        prepare->radius_mm[n++] = (float)value;
        text = comma != NULL ? comma + 1 : NULL;
    }
    prepare->n_radii = n;
    return 0;
}

/* "5" or "5,0": from the start of the schedule to its end. */
static int read_span(const option *o, const char *text, host_span *span, host_error *error)
{
    const char *const comma = strchr(text, ',');
    host_word word = word_of(text);
    double from = 0.0, to = 0.0;
    if (comma != NULL)
        word.n = (size_t)(comma - text);
    if (read_number(o, word, &from, error) != 0 ||
        (comma != NULL && read_number(o, word_of(comma + 1), &to, error) != 0))
        return -1;
    span->from = (float)from;
    span->to = (float)to;
    span->n = comma != NULL ? 2 : 1;
    return 0;
}

static int read_choice(const option *o, const char *text, uint32_t *choice, host_error *error)
{
    const char *word = o->words;
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
    return host_fail(error, text, "one of %s", o->words);
}

static int add_file(host_files *files, const char *path, host_error *error)
{
    if (files->n == SMR_STRUCTURES_MAX)
        return host_fail(error, path, "at most %u files", SMR_STRUCTURES_MAX);
    files->path[files->n++] = path;
    return 0;
}

/* Stores one value in the option's field. */
static int store(const option *o, const char *text, host_options *options, host_error *error)
{
    void *const field = (unsigned char *)options + o->field;
    double value = 0.0;
    if (o->kind == KIND_FILES)
        return add_file(field, text, error);
    if (o->kind == KIND_RADII)
        return read_radii(o, text, field, error);
    if (o->kind == KIND_WORD)
        return read_choice(o, text, field, error);
    if (o->kind == KIND_SPAN)
        return read_span(o, text, field, error);
    if (o->kind == KIND_TEXT) {
        if (text[0] == '\0')
            return host_fail(error, "value", "a text that is not empty");
        *(const char **)field = text;
        return 0;
    }
    if (read_number(o, word_of(text), &value, error) != 0)
        return -1;
    if (o->kind == KIND_COUNT)
        *(uint32_t *)field = (uint32_t)value;
    else if (o->kind == KIND_DOUBLE)
        *(double *)field = value;
    else
        *(float *)field = (float)value;
    if (o->kind == KIND_FLOAT && o->open && !(*(float *)field > (float)o->min))
        return refuse_number(o, word_of(text), error);
    return 0;
}

static int is_option(const char *text)
{
    return text[0] == '-' && text[1] != '\0';
}

/* One option with its values; *at is left behind them. */
static int read_option(int argc, char **argv, int *at, host_options *options, host_error *error)
{
    const char *const name = argv[*at];
    const option *const o = find_option(name, options->command);
    int n = 0;
    error->file = name;
    if (o == NULL)
        return host_fail(error, "option", "an option of this command (see smr --help)");
    *at += 1;
    options->given |= (uint64_t)1 << (size_t)(o - table);
    if (o->prepares && options->prepare_option == NULL)
        options->prepare_option = o->name;
    if (o->kind == KIND_FLAG) {
        *(uint32_t *)(void *)((unsigned char *)options + o->field) = 1;
        return 0;
    }
    /* A number may start with a minus sign; a file may not (write ./-name). */
    while (*at < argc && ((n == 0 && o->kind != KIND_FILES && o->kind != KIND_TEXT) || !is_option(argv[*at])) &&
           (n == 0 || o->kind == KIND_FILES)) {
        if (store(o, argv[*at], options, error) != 0)
            return -1;
        *at += 1;
        n++;
    }
    if (n == 0)
        return host_fail(error, "value", o->kind == KIND_FILES ? "one file or more" : "a value");
    return 0;
}

static int is_given(const host_options *options, const char *name)
{
    const option *const o = find_option(name, options->command);
    return o != NULL && (options->given >> (size_t)(o - table) & 1u) != 0;
}

/* A benchmark of the computed thigh, or of files: then the model, both images and the truth. */
static int check_bench(const host_options *options, host_error *error)
{
    static const char *const needed[] = {"--model", "--target", "--reference", "--truth"};
    static const char *const optional[] = {"--landmarks", "--mirror-model", "--mirror-target"};
    static const char *const computed[] = {"--seed", "--small"};
    static const char *const figure[] = {"--repeats", "--step"};
    const int files = options->model.n > 0;
    size_t i = 0;
    if (options->figure2 + options->soak != 1u)
        return host_fail(error, "bench", "either --figure2 or --soak");
    if (options->out == NULL)
        return host_fail(error, "-o", "the directory for the results");
    error->file = "--seconds";
    if (is_given(options, error->file) && !options->soak)
        return host_fail(error, "option", "--soak beside it");
    for (i = 0; i < sizeof figure / sizeof figure[0]; i++) {
        error->file = figure[i];
        if (is_given(options, figure[i]) && !options->figure2)
            return host_fail(error, "option", "--figure2 beside it");
    }
    for (i = 0; i < sizeof computed / sizeof computed[0]; i++) {
        error->file = computed[i];
        if (files && is_given(options, computed[i]))
            return host_fail(error, "option", "no --model beside it, it is of the computed thigh");
    }
    for (i = 0; i < sizeof optional / sizeof optional[0]; i++) {
        error->file = optional[i];
        if (!files && is_given(options, optional[i]))
            return host_fail(error, "option", "--model beside it");
    }
    for (i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        error->file = needed[i];
        if (files != is_given(options, needed[i]))
            return host_fail(error, "option", "all of --model, --target, --reference and --truth, or none");
    }
    return 0;
}

static int check_needs(host_options *options, host_error *error)
{
    error->file = "usage";
    if (options->command == HOST_BENCH)
        return check_bench(options, error);
    if (options->command == HOST_MEASURE && options->operands.n != 2)
        return host_fail(error, "measure", "two surfaces: smr measure A B");
    if (options->command == HOST_INFO && options->operands.n == 0)
        return host_fail(error, "info", "a model or surfaces: smr info MODEL.smr");
    if (options->command == HOST_PHANTOM && options->out == NULL)
        return host_fail(error, "-o", "the directory for the phantom");
    if ((options->command & (HOST_REGISTER | HOST_BUILD)) != 0) {
        if (options->model.n == 0)
            return host_fail(error, "--model", "one file or more");
        if (options->command == HOST_REGISTER && options->target.n == 0)
            return host_fail(error, "--target", "one file or more");
        if (options->out == NULL)
            return host_fail(error, "-o", options->command == HOST_REGISTER ? "the directory for the results"
                                                                           : "the file for the model");
    }
    return 0;
}

/* The options of the start: landmarks, a pose, both. */
static int check_start(const host_options *options, host_error *error)
{
    const int landmarks = is_given(options, "--landmarks");
    if (options->image_target && options->align != HOST_ALIGN_NONE && !landmarks) {
        error->file = "--align";
        return host_fail(error, "option", "--landmarks beside it or surfaces as the target, it is a volume");
    }
    error->file = "--smoothing";
    if (is_given(options, "--smoothing") && (!landmarks || options->align != HOST_ALIGN_NONE))
        return host_fail(error, "option", "--landmarks and no --align beside it, it smooths their spline");
    return 0;
}

/* The options that do not go with this kind of target, and those that exclude each other. */
static int check_targets(const host_options *options, host_error *error)
{
    const int unfit = options->image_target ? FOR_SURFACES : FOR_IMAGES;
    size_t i = 0;
    for (i = 0; i < sizeof table / sizeof table[0]; i++) {
        error->file = table[i].name;
        if ((options->given >> i & 1u) != 0 && table[i].targets == unfit)
            return host_fail(error, "option", options->image_target ? "surfaces as the target, it is a volume"
                                                                    : "a volume as the target, it is a surface");
    }
    if (options->image_target && options->target.n != 1) {
        error->file = "--target";
        return host_fail(error, "files", "one volume alone, or surfaces");
    }
    error->file = "--landmarks";
    if (is_given(options, "--landmarks") && options->landmarks.n != 2)
        return host_fail(error, "files", "two of them, the model's landmarks and the target's");
    return check_start(options, error);
}

static float low_of(float a, float b) { return a < b ? a : b; }

/* The library's defaults for images, where no option says otherwise. */
static void set_image_config(host_options *options)
{
    const smr_config image = smr_config_default_image();
    smr_config *const config = &options->config;
    config->profile_mm = options->search.n > 0 ? options->search.from : image.profile_mm;
    config->profile_end_mm = options->search.n > 1 ? options->search.to : low_of(image.profile_end_mm, config->profile_mm);
    config->gradient_mm = options->gradient.n > 0 ? options->gradient.from : image.gradient_mm;
    config->gradient_end_mm =
        options->gradient.n > 1 ? options->gradient.to : low_of(image.gradient_end_mm, config->gradient_mm);
    config->momentum = image.momentum;
    config->momentum_last = image.momentum_last;
    config->n_target_vertices = 0;
    if (!is_given(options, "--smoothing"))
        options->smoothing = IMAGE_SMOOTHING;
    if (!is_given(options, "--plastic-every"))
        config->plastic_every = image.plastic_every;
    if (!is_given(options, "--iterations"))
        config->iterations = image.iterations;
    if (!is_given(options, "--iterations-last"))
        config->iterations_last = image.iterations_last;
}

/* What --search may be depends on the kind of target. */
static int check_search(const host_options *options, host_error *error)
{
    const host_span *const search = &options->search;
    error->file = "--search";
    if (options->image_target && ((double)search->from > IMAGE_SEARCH_MAX || (double)search->to > IMAGE_SEARCH_MAX))
        return host_fail(error, "value", "at most %g mm along the normal, for the target is a volume",
                         IMAGE_SEARCH_MAX);
    if (search->n > 0 && !options->image_target && !(search->from > 0.0f))
        return host_fail(error, "value", "a number above 0, for the target is a surface");
    if (search->n > 1 && !options->image_target)
        return host_fail(error, "value", "one number, for the target is a surface");
    return 0;
}

/* Profiles come from a reference image. */
static int check_profiles(const host_options *options, host_error *error)
{
    static const char *const names[] = {"--profile-samples", "--profile-step", "--profile-inward"};
    size_t i = 0;
    for (i = 0; i < sizeof names / sizeof names[0]; i++) {
        error->file = names[i];
        if (is_given(options, names[i]) && options->reference == NULL && options->command == HOST_BUILD)
            return host_fail(error, "option", "--reference beside it, the image that profiles are taken from");
    }
    return 0;
}

/* What depends on the kind of target, after all options are read. */
static int settle_targets(host_options *options, host_error *error)
{
    uint32_t i = 0;
    for (i = 0; i < options->target.n; i++)
        options->image_target |= host_is_volume_path(options->target.path[i]);
    if (options->command == HOST_BENCH && options->target.n > 0 && !options->image_target) {
        error->file = "--target";
        return host_fail(error, "files", "one volume");
    }
    options->image_target |= options->command == HOST_BENCH;
    if ((options->command == HOST_REGISTER || options->target.n > 0) && check_targets(options, error) != 0)
        return -1;
    if (check_search(options, error) != 0 || check_profiles(options, error) != 0)
        return -1;
    if (!options->image_target && options->search.n > 0)
        options->config.search_mm = options->search.from;
    if (options->image_target)
        set_image_config(options);
    return 0;
}

static int set_defaults(int command, host_options *options)
{
    memset(options, 0, sizeof *options);
    options->command = command;
    options->seed = 1;
    options->repeats = 7;
    options->step = 10;
    options->seconds = 4.0;
    options->mirror_model = HOST_MIRROR_NONE;
    options->mirror_target = HOST_MIRROR_NONE;
    options->prepare = smr_prepare_config_default();
    options->config = smr_config_default();
    options->model.path = calloc(SMR_STRUCTURES_MAX, sizeof(char *));
    options->target.path = calloc(SMR_STRUCTURES_MAX, sizeof(char *));
    options->operands.path = calloc(SMR_STRUCTURES_MAX, sizeof(char *));
    options->landmarks.path = calloc(SMR_STRUCTURES_MAX, sizeof(char *));
    return options->model.path == NULL || options->target.path == NULL || options->operands.path == NULL ||
                   options->landmarks.path == NULL
               ? -1
               : 0;
}

int host_options_read(int command, int argc, char **argv, host_options *options, host_error *error)
{
    int at = 2;
    error->file = "usage";
    if (set_defaults(command, options) != 0)
        return host_fail(error, "start", "free memory");
    while (at < argc) {
        if (is_option(argv[at])) {
            if (read_option(argc, argv, &at, options, error) != 0)
                return -1;
        } else {
            error->file = argv[at];
            if ((command & (HOST_INFO | HOST_MEASURE)) == 0)
                return host_fail(error, "argument", "an option before it (see smr --help)");
            if (add_file(&options->operands, argv[at++], error) != 0)
                return -1;
        }
    }
    if (options->clusters == HOST_CLUSTERS_SHARED)
        options->prepare.separate_below_mm = 0.0f;
    else if (options->clusters == HOST_CLUSTERS_SEPARATE)
        options->prepare.separate_below_mm = SMR_COORD_MAX; /* the most that smr_prepare() takes */
    return check_needs(options, error) != 0 ? -1 : settle_targets(options, error);
}

void host_options_free(host_options *options)
{
    free(options->model.path);
    free(options->target.path);
    free(options->operands.path);
    free(options->landmarks.path);
    memset(options, 0, sizeof *options);
}
