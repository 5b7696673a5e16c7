/* options_table.c: the table of options.
 * SPDX-License-Identifier: MIT */
#include "options/options_table.h"
#include <string.h>

#define FIELD(name) offsetof(host_options, name)
#define OWN(name) FIELD(name), 0
#define CONFIG(name) FIELD(config.name), FIELD(config.name)
#define PREPARE(name) FIELD(prepare.name), FIELD(prepare.name)
#define LIBRARY 0, 0, 0 /* the range is the setting's */
#define PREPARING (HOST_REGISTER | HOST_BUILD | HOST_INFO | HOST_TRACK)
#define ONTO (HOST_REGISTER | HOST_TRACK)
#define CARRYING (HOST_CARRY | HOST_FIELD | HOST_WARP)
#define COORD ((double)SMR_COORD_MAX)

const host_option host_option_table[] = {
    {"--model", ONTO | HOST_BUILD | HOST_BENCH, HOST_KIND_FILES, OWN(model), 0, 0, 0, 0, NULL, 0},
    {"--also", HOST_BUILD, HOST_KIND_FILES, OWN(also), 0, 0, 0, 1, NULL, 0},
    {"--reference-prior", ONTO, HOST_KIND_FLOAT, CONFIG(references.prior), LIBRARY, 0, NULL, 0},
    {"--target", HOST_REGISTER | HOST_BENCH, HOST_KIND_FILES, OWN(target), 0, 0, 0, 0, NULL, 0},
    {"--frames", HOST_TRACK, HOST_KIND_FILES, OWN(frames), 0, 0, 0, 0, NULL, 0},
    {"--fps", HOST_TRACK, HOST_KIND_DOUBLE, OWN(fps), 0, 1e6, 1, 0, NULL, 0},
    {"--track-radius", HOST_TRACK, HOST_KIND_FLOAT, CONFIG(track.radius_mm), LIBRARY, 0, NULL, 0},
    {"--track-ahead", HOST_TRACK, HOST_KIND_FLOAT, CONFIG(track.ahead), LIBRARY, 0, NULL, 0},
    {"-o", ONTO | HOST_BUILD | HOST_PHANTOM | HOST_BENCH | CARRYING | HOST_SUMMARY | HOST_SURFACES | HOST_LABELS,
     HOST_KIND_TEXT, OWN(out), 0, 0, 0, 0, NULL, 0},
    {"--result", CARRYING, HOST_KIND_TEXT, OWN(result), 0, 0, 0, 0, NULL, 0},
    {"--points", HOST_CARRY | HOST_TRACK, HOST_KIND_TEXT, OWN(points), 0, 0, 0, 0, NULL, 0},
    {"--volume", HOST_WARP, HOST_KIND_TEXT, OWN(volume), 0, 0, 0, 0, NULL, 0},
    {"--like", HOST_FIELD | HOST_WARP | HOST_LABELS, HOST_KIND_TEXT, OWN(like), 0, 0, 0, 0, NULL, 0},
    {"--names", HOST_SURFACES | HOST_LABELS | HOST_MEASURE | HOST_INFO, HOST_KIND_TEXT, OWN(names), 0, 0, 0, 0, NULL,
     0},
    {"--passes", HOST_SURFACES | HOST_MEASURE, HOST_KIND_COUNT, OWN(passes), 0, 1000, 0, 0, NULL, 0},
    {"--triangles", HOST_SURFACES, HOST_KIND_COUNT, OWN(triangles), 4, 1e8, 0, 0, NULL, 0},
    {"--spacing", HOST_FIELD | HOST_WARP, HOST_KIND_FLOAT, OWN(spacing), 0, 1000, 1, 0, NULL, 0},
    {"--inverse", HOST_CARRY | HOST_FIELD, HOST_KIND_FLAG, OWN(inverse), 0, 0, 0, 0, NULL, 0},
    {"--reference", ONTO | HOST_BUILD | HOST_BENCH, HOST_KIND_TEXT, OWN(reference), 0, 0, 0, 1, NULL, HOST_FOR_IMAGES},
    {"--landmarks", ONTO | HOST_BENCH, HOST_KIND_FILES, OWN(landmarks), 0, 0, 0, 0, NULL, 0},
    {"--landmark-goals", HOST_REGISTER, HOST_KIND_FILES, OWN(landmark_goals), 0, 0, 0, 0, NULL, 0},
    {"--landmark-weight", HOST_REGISTER, HOST_KIND_TEXT, OWN(landmark_weight), 0, 0, 0, 0, NULL, 0},
    {"--contact", ONTO, HOST_KIND_FLAG, OWN(contact), 0, 0, 0, 0, NULL, 0},
    {"--contact-with", ONTO, HOST_KIND_FILES, OWN(contact_with), 0, 0, 0, 0, NULL, 0},
    {"--contact-mm", ONTO, HOST_KIND_FLOAT, CONFIG(contact.gap_mm), LIBRARY, 0, NULL, 0},
    {"--log", HOST_REGISTER, HOST_KIND_TEXT, OWN(log), 0, 0, 0, 0, NULL, 0},
    {"--trace", HOST_REGISTER, HOST_KIND_TEXT, OWN(trace), 0, 0, 0, 0, NULL, 0},
    {"--html", ONTO, HOST_KIND_FLAG, OWN(html), 0, 0, 0, 0, NULL, 0},
    {"--save", HOST_REGISTER, HOST_KIND_TEXT, OWN(save), 0, 0, 0, 0, NULL, 0},
    {"--resume", HOST_REGISTER, HOST_KIND_TEXT, OWN(resume), 0, 0, 0, 0, NULL, 0},
    {"--truth", HOST_REGISTER | HOST_BENCH, HOST_KIND_TEXT, OWN(truth), 0, 0, 0, 0, NULL, HOST_FOR_IMAGES},
    {"--c-array", HOST_BUILD, HOST_KIND_TEXT, OWN(c_array), 0, 0, 0, 0, NULL, 0},
    {"--source", HOST_MEASURE, HOST_KIND_TEXT, OWN(source), 0, 0, 0, 0, NULL, 0},
    {"--mirror-model", PREPARING | HOST_BENCH, HOST_KIND_WORD, OWN(mirror_model), 0, 0, 0, 1, "x|y|z", 0},
    {"--mirror-target", ONTO | HOST_BENCH, HOST_KIND_WORD, OWN(mirror_target), 0, 0, 0, 0, "x|y|z", 0},
    {"--threads",
     ONTO | HOST_MEASURE | HOST_PHANTOM | HOST_BENCH | HOST_REPLAY | CARRYING | HOST_SURFACES | HOST_LABELS,
     HOST_KIND_COUNT, OWN(threads), 1, SMR_WORKERS_MAX, 0, 0, NULL, 0},
    {"--ticks", ONTO, HOST_KIND_COUNT, OWN(ticks), 1, 1e9, 0, 0, NULL, 0},
    {"--budget-ms", ONTO, HOST_KIND_DOUBLE, OWN(budget_ms), 0, 1e6, 0, 0, NULL, 0},
    {"--budget-exact", ONTO, HOST_KIND_FLAG, CONFIG(basic.budget_exact), LIBRARY, 0, NULL, 0},
    {"--align", ONTO | HOST_BENCH, HOST_KIND_WORD, OWN(align), 0, 0, 0, 0, "none|rigid|similarity|parts", 0},
    {"--vertex-errors", HOST_REGISTER, HOST_KIND_FLAG, OWN(vertex_errors), 0, 0, 0, 0, NULL, 0},
    {"--format", ONTO, HOST_KIND_WORD, OWN(format), 0, 0, 0, 0, "ply|stl|vtk|obj", 0},
    {"--slicer", HOST_REGISTER, HOST_KIND_TEXT, OWN(slicer), 0, 0, 0, 0, NULL, 0},
    {"--paper", PREPARING, HOST_KIND_FLAG, OWN(paper), 0, 0, 0, 0, NULL, 0},
    {"--accept", ONTO, HOST_KIND_WORD, OWN(accept), 0, 0, 0, 0, "good|look", 0},
    {"--json", HOST_REGISTER, HOST_KIND_FLAG, OWN(json), 0, 0, 0, 0, NULL, 0},
    {"--skip-done", HOST_REGISTER, HOST_KIND_FLAG, OWN(skip_done), 0, 0, 0, 0, NULL, 0},
    {"--html", HOST_SUMMARY, HOST_KIND_TEXT, OWN(overview), 0, 0, 0, 0, NULL, 0},
    {"--times", HOST_SUMMARY, HOST_KIND_FLAG, OWN(times), 0, 0, 0, 0, NULL, 0},
    {"--smoothing", HOST_REGISTER, HOST_KIND_FLOAT, OWN(smoothing), 0, 1e9, 0, 0, NULL, 0},
    {"--quiet", ONTO | HOST_BUILD | HOST_PHANTOM | HOST_BENCH | CARRYING | HOST_SUMMARY | HOST_SURFACES | HOST_LABELS,
     HOST_KIND_FLAG, OWN(quiet), 0, 0, 0, 0, NULL, 0},
    {"--radius", PREPARING, HOST_KIND_RADII, PREPARE(radius_mm), LIBRARY, 1, NULL, 0},
    {"--clusters", PREPARING, HOST_KIND_WORD, OWN(clusters), 0, 0, 0, 1, "auto|shared|separate", 0},
    {"--distance", PREPARING, HOST_KIND_WORD, PREPARE(distance), LIBRARY, 1, NULL, 0},
    {"--mass", PREPARING, HOST_KIND_WORD, PREPARE(mass), LIBRARY, 1, NULL, 0},
    {"--order", PREPARING, HOST_KIND_WORD, PREPARE(order), LIBRARY, 1, NULL, 0},
    {"--block", PREPARING, HOST_KIND_COUNT, PREPARE(block_vertices), LIBRARY, 1, NULL, 0},
    {"--profile-samples", HOST_REGISTER | HOST_BUILD, HOST_KIND_COUNT, PREPARE(profile_samples), LIBRARY, 1, NULL,
     HOST_FOR_IMAGES},
    {"--profile-step", HOST_REGISTER | HOST_BUILD, HOST_KIND_FLOAT, PREPARE(profile_step_mm), LIBRARY, 1, NULL,
     HOST_FOR_IMAGES},
    {"--profile-inward", HOST_REGISTER | HOST_BUILD, HOST_KIND_FLOAT, PREPARE(profile_inward), 0, 1, 0, 1, NULL,
     HOST_FOR_IMAGES},
    {"--method", ONTO, HOST_KIND_WORD, CONFIG(basic.method), LIBRARY, 0, NULL, 0},
    {"--fusing", ONTO, HOST_KIND_WORD, CONFIG(motion.fusing), LIBRARY, 0, NULL, 0},
    {"--normals", HOST_REGISTER, HOST_KIND_WORD, CONFIG(motion.normals), LIBRARY, 0, NULL, 0},
    {"--search", ONTO, HOST_KIND_SPAN, OWN(search), 0, COORD, 0, 0, NULL, 0},
    {"--gradient", HOST_REGISTER, HOST_KIND_SPAN, FIELD(gradient), FIELD(config.image.gradient_mm), LIBRARY, 0, NULL,
     HOST_FOR_IMAGES},
    {"--similarity", HOST_REGISTER, HOST_KIND_WORD, CONFIG(image.similarity), LIBRARY, 0, NULL, HOST_FOR_IMAGES},
    {"--sideways", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(image.sideways), LIBRARY, 0, NULL, HOST_FOR_IMAGES},
    {"--confidence", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(image.confidence), LIBRARY, 0, NULL, HOST_FOR_IMAGES},
    {"--normal-angle", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(forces.normal_deg), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--stiffness", ONTO, HOST_KIND_FLOAT, CONFIG(forces.stiffness), LIBRARY, 0, NULL, 0},
    {"--coverage", ONTO, HOST_KIND_WORD, CONFIG(partial.coverage), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--attraction", ONTO, HOST_KIND_FLOAT, CONFIG(basic.attraction), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--slide", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(basic.slide), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--even", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(basic.even), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--noise-mm", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(partial.noise_mm), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--relaxation", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(motion.relaxation), LIBRARY, 0, NULL, 0},
    {"--reject-deviations", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(forces.reject_deviations), LIBRARY, 0, NULL,
     HOST_FOR_SURFACES},
    {"--reject-border", HOST_REGISTER, HOST_KIND_FLAG, CONFIG(forces.reject_border), LIBRARY, 0, NULL,
     HOST_FOR_SURFACES},
    {"--node-budget", HOST_REGISTER, HOST_KIND_COUNT, CONFIG(forces.node_budget), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--curvature", ONTO, HOST_KIND_FLOAT, CONFIG(forces.curvature), LIBRARY, 0, NULL, HOST_FOR_SURFACES},
    {"--plastic-um", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(motion.plastic_um), LIBRARY, 0, NULL, 0},
    {"--plastic-every", HOST_REGISTER, HOST_KIND_COUNT, CONFIG(motion.plastic_every), LIBRARY, 0, NULL, 0},
    {"--strain-most", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(motion.strain_most), LIBRARY, 0, NULL, 0},
    {"--seed", HOST_PHANTOM | HOST_BENCH, HOST_KIND_COUNT, OWN(seed), 1, 1e9, 0, 0, NULL, 0},
    {"--small", HOST_PHANTOM | HOST_BENCH, HOST_KIND_FLAG, OWN(small), 0, 0, 0, 0, NULL, 0},
    {"--figure1", HOST_BENCH, HOST_KIND_FLAG, OWN(figure1), 0, 0, 0, 0, NULL, 0},
    {"--figure2", HOST_BENCH, HOST_KIND_FLAG, OWN(figure2), 0, 0, 0, 0, NULL, 0},
    {"--soak", HOST_BENCH, HOST_KIND_FLAG, OWN(soak), 0, 0, 0, 0, NULL, 0},
    {"--repeats", HOST_BENCH, HOST_KIND_COUNT, OWN(repeats), 1, 1000, 0, 0, NULL, 0},
    {"--step", HOST_BENCH, HOST_KIND_COUNT, OWN(step), 5, 50, 0, 0, NULL, 0},
    {"--seconds", HOST_BENCH, HOST_KIND_DOUBLE, OWN(seconds), 0, 1e5, 1, 0, NULL, 0},
    {"--volume", ONTO, HOST_KIND_FLAG, OWN(keep_volume), 0, 0, 0, 0, NULL, 0},
    {"--volume-ratio", ONTO, HOST_KIND_FILES, OWN(volume_ratio), 0, 0, 0, 0, NULL, 0},
    {"--smooth", ONTO, HOST_KIND_FLOAT, CONFIG(contact.smooth), LIBRARY, 0, NULL, 0},
    {"--iterations", ONTO, HOST_KIND_COUNT, CONFIG(basic.iterations), LIBRARY, 0, NULL, 0},
    {"--iterations-last", ONTO, HOST_KIND_COUNT, CONFIG(basic.iterations_last), LIBRARY, 0, NULL, 0},
    {"--settle-share", ONTO, HOST_KIND_FLOAT, CONFIG(motion.settle_share), LIBRARY, 0, NULL, 0},
    {"--active", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(basic.active_share), LIBRARY, 0, NULL, 0},
    {"--active-first", HOST_REGISTER, HOST_KIND_FLOAT, CONFIG(schedule.active_first), LIBRARY, 0, NULL, 0},
    {"--active-enough", HOST_REGISTER, HOST_KIND_COUNT, CONFIG(schedule.active_enough), LIBRARY, 0, NULL, 0},
};

_Static_assert(sizeof host_option_table / sizeof host_option_table[0] <= 128, "one bit for each option");

const size_t host_option_count = sizeof host_option_table / sizeof host_option_table[0];

static const smr_setting *at_offset(const smr_setting *s, uint32_t n, size_t offset)
{
    for (uint32_t i = 0; i < n; i++)
        if (s[i].kind != SMR_SETTING_GROUP && s[i].offset == offset)
            return &s[i];
    return NULL;
}

const smr_setting *host_option_setting(const host_option *o)
{
    uint32_t n = 0;
    const smr_setting *s = smr_config_settings(&n);
    if (o->setting >= FIELD(config) && o->setting < FIELD(config) + sizeof(smr_config))
        return at_offset(s, n, o->setting - FIELD(config));
    s = smr_prepare_settings(&n);
    return o->setting >= FIELD(prepare) ? at_offset(s, n, o->setting - FIELD(prepare)) : NULL;
}

host_range host_option_range(const host_option *o)
{
    const smr_setting *const s = host_option_setting(o);
    host_range range = {o->min, o->max, o->open};
    if (s != NULL && !(o->max > o->min)) {
        range.min = s->low;
        range.max = s->high;
        range.open = (int)s->open;
    }
    return range;
}

const char *host_option_words(const host_option *o)
{
    const smr_setting *const s = host_option_setting(o);
    return o->words == NULL && s != NULL ? s->unit : o->words;
}

double host_image_search_max(void)
{
    uint32_t n = 0;
    const smr_setting *const s = smr_config_settings(&n);
    return at_offset(s, n, offsetof(smr_config, image.profile_mm))->high;
}

const host_option *host_option_find(const char *name, int command)
{
    for (size_t i = 0; i < host_option_count; i++)
        if ((host_option_table[i].commands & command) != 0 && strcmp(host_option_table[i].name, name) == 0)
            return &host_option_table[i];
    return NULL;
}

int host_option_was_given(const host_options *from, size_t i) { return (from->given[i / 64u] >> i % 64u & 1u) != 0; }

int host_option_given(const host_options *options, const char *name)
{
    const host_option *const o = host_option_find(name, options->command);
    return o != NULL && host_option_was_given(options, (size_t)(o - host_option_table));
}
