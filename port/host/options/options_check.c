/* options_check.c: what options need beside them, what they exclude, and what depends on the kind of target: after all
 * are read.
 * SPDX-License-Identifier: MIT */
#include <float.h>
#include <string.h>
#include "files/file_names.h"
#include "meshes/triangle_mesh.h"
#include "options/options_table.h"
#include "volumes/voxel_volume.h"

#define OF(field) offsetof(host_options, field)
#define RATIO_LEAST 0.1 /* as smr_set_volume_ratio() has it */
#define RATIO_MOST 10.0

int host_volume_ratio_split(const char *word, size_t *name, double *to)
{
    const char *const equals = strrchr(word, '=');
    if (equals == NULL || equals == word)
        return 0;
    *name = (size_t)(equals - word);
    return host_word_double((host_word){equals + 1, strlen(equals + 1)}, to) && *to >= RATIO_LEAST && *to <= RATIO_MOST;
}

/* 1 where an earlier word has the same name. */
static int is_again(const host_files *words, uint32_t number)
{
    size_t name = 0, other = 0;
    double ratio = 0.0;
    (void)host_volume_ratio_split(words->path[number], &name, &ratio);
    for (uint32_t i = 0; i < number; i++)
        if (host_volume_ratio_split(words->path[i], &other, &ratio) && other == name &&
            strncmp(words->path[i], words->path[number], name) == 0)
            return 1;
    return 0;
}

static int check_volume_ratios(const host_files *words, host_error *error)
{
    size_t name = 0;
    double ratio = 0.0;
    error->file = "--volume-ratio";
    for (uint32_t i = 0; i < words->n; i++)
        if (!host_volume_ratio_split(words->path[i], &name, &ratio))
            return host_fail(error, words->path[i], "NAME=R, a structure and a ratio of at least %g and at most %g",
                             RATIO_LEAST, RATIO_MOST);
        else if (is_again(words, i))
            return host_fail(error, words->path[i], "one ratio for each structure");
    return 0;
}

/* mm: about what clusters of the coarsest radius put right themselves; points clicked in an image are uncertain */
#define IMAGE_SMOOTHING 100.0f

/* Of files: the model and its targets, for figure 1 surfaces; else also both images and the truth. All or none. */
static int check_bench_files(const host_options *options, host_error *error)
{
    static const char *const needed[] = {"--model", "--target", "--reference", "--truth"};
    const size_t n = options->figure1 ? 2 : sizeof needed / sizeof needed[0];
    for (size_t i = 0; i < sizeof needed / sizeof needed[0]; i++) {
        error->file = needed[i];
        if (i >= n && host_option_given(options, needed[i]))
            return host_fail(error, "option", "--figure2 or --soak beside it");
        if (i < n && (options->model.n > 0) != host_option_given(options, needed[i]))
            return host_fail(error, "option",
                             options->figure1 ? "both --model and --target, or none"
                                              : "all of --model, --target, --reference and --truth, or none");
    }
    return 0;
}

/* An option that is refused unless what it needs is there. */
typedef struct rule {
    const char *option;
    int fits;
    const char *expected;
} rule;

static int check_rules(const host_options *options, const rule *rules, size_t n, host_error *error)
{
    for (size_t i = 0; i < n; i++)
        if (!rules[i].fits && host_option_given(options, rules[i].option))
            return host_fail_of(error, rules[i].option, "option", "%s", rules[i].expected);
    return 0;
}

/* A benchmark of the computed thigh, or of files. */
static int check_bench(const host_options *asked, host_error *error)
{
    const int files = asked->model.n > 0, soak = asked->soak != 0, figure2 = asked->figure2 != 0;
    const rule rules[] = {{"--seconds", soak, "--soak beside it"},
                          {"--repeats", figure2, "--figure2 beside it"},
                          {"--step", figure2, "--figure2 beside it"},
                          {"--seed", !files, "no --model beside it, it is of the computed thigh"},
                          {"--small", !files, "no --model beside it, it is of the computed thigh"},
                          {"--landmarks", files, "--model beside it"},
                          {"--mirror-model", files, "--model beside it"},
                          {"--mirror-target", files, "--model beside it"},
                          {"--align", files, "--model beside it"},
                          {"--align", asked->figure1 != 0, "--figure1 beside it"},
                          {"--align", asked->align != HOST_ALIGN_PARTS, "rigid or similarity"}};
    if (asked->figure1 + asked->figure2 + asked->soak != 1u)
        return host_fail(error, "bench", "one of --figure1, --figure2 and --soak");
    if (asked->out == NULL)
        return host_fail(error, "-o", "the directory for the results");
    return check_rules(asked, rules, sizeof rules / sizeof rules[0], error) != 0 ? -1 : check_bench_files(asked, error);
}

/* What a command cannot do without: a text, or files, one at least unless `exactly` says how many. In this order. */
static const struct need {
    int commands;
    size_t offset; /* in host_options, of a host_files or of a text */
    uint32_t files, exactly;
    const char *place, *expected;
} needs[] = {
    {HOST_SURFACES, OF(operands), 1, 1, "surfaces", "one label map: smr surfaces LABELS -o DIR"},
    {HOST_LABELS, OF(operands), 1, 1, "labels", "one directory of surfaces: smr labels DIR --like VOLUME -o FILE"},
    {HOST_LABELS, OF(like), 0, 0, "--like", "a volume whose voxels get the labels"},
    {HOST_SURFACES, OF(out), 0, 0, "-o", "the directory for the surfaces"},
    {HOST_LABELS, OF(out), 0, 0, "-o", "the file for the label map"},
    {HOST_TRACK | HOST_REGISTER | HOST_BUILD, OF(model), 1, 0, "--model", "one file or more"},
    {HOST_TRACK, OF(frames), 1, 0, "--frames", "one file or directory or more, each a frame"},
    {HOST_CARRY | HOST_FIELD | HOST_WARP, OF(result), 0, 0, "--result", "the directory that smr register wrote"},
    {HOST_CARRY, OF(points), 0, 0, "--points", "a file of points"},
    {HOST_WARP, OF(volume), 0, 0, "--volume", "the image that fits the model"},
    {HOST_CARRY | HOST_FIELD | HOST_WARP, OF(out), 0, 0, "-o", "the file for what is carried"},
    {HOST_MEASURE, OF(operands), 1, 2, "measure", "two surfaces: smr measure A B"},
    {HOST_REPLAY, OF(operands), 1, 1, "replay", "one log: smr replay LOG"},
    {HOST_INFO, OF(operands), 1, 0, "info", "a model or surfaces: smr info MODEL.smr"},
    {HOST_SUMMARY, OF(operands), 1, 0, "summary",
     "directories that smr register wrote: smr summary DIR... -o TABLE.csv"},
    {HOST_PHANTOM, OF(out), 0, 0, "-o", "the directory for the phantom"},
};

static int check_needs(host_options *options, host_error *error)
{
    error->file = "usage";
    if (options->command == HOST_BENCH)
        return check_bench(options, error);
    for (const struct need *need = needs; need < needs + sizeof needs / sizeof needs[0]; need++) {
        const void *const at = (const unsigned char *)options + need->offset;
        uint32_t n = 0;
        if ((options->command & need->commands) == 0)
            continue;
        n = need->files ? ((const host_files *)at)->n : *(const char *const *)at != NULL;
        if (n == 0 || (need->exactly > 0 && n != need->exactly))
            return host_fail(error, need->place, "%s", need->expected);
    }
    if (options->command == HOST_SUMMARY && options->out == NULL && options->overview == NULL)
        return host_fail(error, "-o", "the file for the table, or --html the one for the page");
    if (options->command == HOST_REGISTER && options->target.n == 0 && options->landmark_goals.n == 0)
        return host_fail(error, "--target", "one file or more, or --landmark-goals");
    if ((options->command & (HOST_REGISTER | HOST_TRACK | HOST_BUILD)) != 0 && options->out == NULL)
        return host_fail(error, "-o",
                         options->command == HOST_BUILD ? "the file for the model" : "the directory for the results");
    if ((options->command & (HOST_CARRY | HOST_FIELD | HOST_WARP)) != 0 && options->like != NULL &&
        host_option_given(options, "--spacing"))
        return host_fail(error, "--spacing", "no --like beside it, which has its own");
    return 0;
}

/* Places of landmarks, alone or beside a target. Where nothing else says how to start, the pose is fitted to them. */
static int check_landmark_goals(host_options *options, host_error *error)
{
    const char *const text = options->landmark_weight;
    double w = 1.0;
    if (options->landmark_goals.n != 0 && options->landmark_goals.n != 2)
        return host_fail_of(error, "--landmark-goals", "files",
                            "two of them, the model's landmarks and where they are now");
    error->file = "--landmark-weight";
    if (text != NULL && options->landmark_goals.n == 0)
        return host_fail(error, "option", "--landmark-goals beside it");
    if (text != NULL && strcmp(text, "hard") == 0)
        w = 0.0;
    else if (text != NULL && (!host_word_double((host_word){text, strlen(text)}, &w) || w < 0.001 || w > 1000.0))
        return host_fail(error, text, "a number of at least 0.001 and at most 1000, or hard");
    options->goal_weight = (float)w;
    if (options->landmark_goals.n == 0 || options->landmarks.n != 0)
        return 0;
    if (!host_option_given(options, "--align"))
        options->align = HOST_ALIGN_RIGID;
    else if (!options->image_target && options->target.n > 0)
        return 0;
    options->start_by_goals = options->align != HOST_ALIGN_NONE;
    return 0;
}

/* Nothing is packed but label maps, and a plain file with a packed one's name cannot be read back. Points, fields,
 * volumes, label maps and scenes go by their extensions, which are checked where they are written. */
static int check_packed(const host_options *asked, host_error *error)
{
    const int is_file = (asked->command & (HOST_BUILD | HOST_SUMMARY)) != 0;
    const char *const path[] = {is_file ? asked->out : NULL, asked->overview, asked->log, asked->trace, asked->save};
    for (size_t i = 0; i < sizeof path / sizeof path[0]; i++)
        if (path[i] != NULL && host_is_packed_name(path[i]))
            return host_fail_of(error, path[i], "name", "one without .gz, for what is written there is not packed");
    return 0;
}

/* What the results are written as, a log of one run from its start, a distance where something is kept apart. */
static int check_outputs(const host_options *asked, host_error *error)
{
    const rule rules[] = {
        {"--log", asked->save == NULL && asked->resume == NULL,
         "neither --save nor --resume beside it, a log is of a whole run"},
        {"--vertex-errors", asked->format == HOST_FORMAT_PLY || asked->format == HOST_FORMAT_VTK,
         "--format ply or vtk, which have room for them"},
        {"--contact-mm", asked->contact || asked->contact_with.n > 0, "--contact or --contact-with beside it"}};
    if (asked->slicer != NULL && (!host_has_extension(asked->slicer, ".mrml") || host_is_packed_name(asked->slicer)))
        return host_fail_of(error, asked->slicer, "name", "a scene that ends in .mrml");
    return check_rules(asked, rules, sizeof rules / sizeof rules[0], error);
}

/* The options of the start: landmarks, a pose, both. */
static int check_start(const host_options *asked, host_error *error)
{
    const int landmarks = host_option_given(asked, "--landmarks");
    const rule rules[] = {
        {"--align", !asked->image_target || asked->align == HOST_ALIGN_NONE || landmarks || asked->landmark_goals.n > 0,
         "--landmarks beside it or surfaces as the target, it is a volume"},
        {"--align",
         asked->align != HOST_ALIGN_PARTS ||
             (asked->command == HOST_REGISTER && !asked->image_target && !landmarks && asked->landmark_goals.n == 0),
         "surfaces alone as the target for parts"},
        {"--smoothing", landmarks && asked->align == HOST_ALIGN_NONE,
         "--landmarks and no --align beside it, it smooths their spline"}};
    return check_rules(asked, rules, sizeof rules / sizeof rules[0], error);
}

/* The options that do not go with this kind of target, and those that exclude each other. */
static int check_targets(host_options *options, host_error *error)
{
    const int unfit = options->image_target ? HOST_FOR_SURFACES : HOST_FOR_IMAGES;
    for (size_t i = 0; i < host_option_count; i++)
        if (host_option_was_given(options, i) && host_option_table[i].targets == unfit)
            return host_fail_of(error, host_option_table[i].name, "option",
                                options->image_target ? "surfaces as the target, it is a volume"
                                                      : "a volume as the target, it is a surface");
    if (options->image_target && options->command != HOST_TRACK && options->target.n != 1)
        return host_fail_of(error, "--target", "files", "one volume alone, or surfaces");
    if (host_option_given(options, "--landmarks") && options->landmarks.n != 2)
        return host_fail_of(error, "--landmarks", "files", "two of them, the model's landmarks and the target's");
    return check_start(options, error) != 0 ? -1 : check_landmark_goals(options, error);
}

static float low_of(float a, float b) { return a < b ? a : b; }

/* The library's defaults for images, or the paper's, where no option says otherwise. */
static void set_image_config(host_options *options)
{
    const smr_config image = options->paper ? smr_config_paper() : smr_config_default_image();
    smr_config *const config = &options->config;
    config->image.profile_mm = options->search.n > 0 ? options->search.from : image.image.profile_mm;
    config->image.profile_end_mm =
        options->search.n > 1 ? options->search.to : low_of(image.image.profile_end_mm, config->image.profile_mm);
    config->image.gradient_mm = options->gradient.n > 0 ? options->gradient.from : image.image.gradient_mm;
    config->image.gradient_end_mm =
        options->gradient.n > 1 ? options->gradient.to : low_of(image.image.gradient_end_mm, config->image.gradient_mm);
    config->motion.momentum = image.motion.momentum;
    config->motion.momentum_last = image.motion.momentum_last;
    if (!host_option_given(options, "--settle-share"))
        config->motion.settle_share = image.motion.settle_share;
    config->basic.n_target_vertices = 0;
    if (!host_option_given(options, "--smoothing"))
        options->smoothing = options->paper ? 0.0f : IMAGE_SMOOTHING;
    if (!host_option_given(options, "--plastic-every"))
        config->motion.plastic_every = image.motion.plastic_every;
    if (!host_option_given(options, "--iterations"))
        config->basic.iterations = image.basic.iterations;
    if (!host_option_given(options, "--iterations-last"))
        config->basic.iterations_last = image.basic.iterations_last;
}

/* What --search may be depends on the kind of target. */
static int check_search(const host_options *options, host_error *error)
{
    const host_span *const search = &options->search;
    error->file = "--search";
    if (options->image_target &&
        ((double)search->from > host_image_search_max() || (double)search->to > host_image_search_max()))
        return host_fail(error, "value", "at most %g mm along the normal, for the target is a volume",
                         host_image_search_max());
    if (search->n > 0 && !options->image_target && !(search->from >= FLT_MIN))
        return host_fail(error, "value", "a number above 0, for the target is a surface");
    if (search->n > 1 && !options->image_target)
        return host_fail(error, "value", "one number, for the target is a surface");
    return 0;
}

/* Profiles come from a reference image. */
static int check_profiles(const host_options *options, host_error *error)
{
    static const char expected[] = "--reference beside it, the image that profiles are taken from";
    const int fit = options->reference != NULL || options->command != HOST_BUILD;
    const rule rules[] = {
        {"--profile-samples", fit, expected}, {"--profile-step", fit, expected}, {"--profile-inward", fit, expected}};
    return check_rules(options, rules, sizeof rules / sizeof rules[0], error);
}

/* What depends on the kind of target, after all options are read. */
static int settle_targets(host_options *options, host_error *error)
{
    for (uint32_t i = 0; i < options->target.n; i++)
        options->image_target |= host_is_volume_path(options->target.path[i]);
    if (options->command == HOST_TRACK) /* all frames are of the first one's kind */
        options->image_target |= host_is_volume_path(options->frames.path[0]);
    if (options->command == HOST_BENCH && options->target.n > 0 && options->image_target == (int)options->figure1)
        return host_fail_of(error, "--target", "files", options->figure1 ? "surfaces" : "one volume");
    options->image_target |= options->command == HOST_BENCH && !options->figure1;
    if (((options->command & (HOST_REGISTER | HOST_TRACK)) != 0 || options->target.n > 0) &&
        check_targets(options, error) != 0)
        return -1;
    if (check_search(options, error) != 0 || check_profiles(options, error) != 0)
        return -1;
    if (!options->image_target && options->search.n > 0)
        options->config.basic.search_mm = options->search.from;
    if (options->image_target)
        set_image_config(options);
    options->spline_if_better = !options->paper && !host_option_given(options, "--smoothing");
    return 0;
}

int host_options_check(host_options *options, host_error *error)
{
    if (check_volume_ratios(&options->volume_ratio, error) != 0)
        return -1;
    if (check_needs(options, error) != 0 || check_packed(options, error) != 0 || check_outputs(options, error) != 0)
        return -1;
    return settle_targets(options, error);
}
