/* options_table.c: the table of options.
 * SPDX-License-Identifier: MIT */
#include "options/options_table.h"

#include <string.h>

#define FIELD(name) offsetof(host_options, name)
#define PREPARING (HOST_REGISTER | HOST_BUILD | HOST_INFO)
#define COORD ((double)SMR_COORD_MAX)

const host_option host_option_table[] = {
    {"--model", HOST_REGISTER | HOST_BUILD | HOST_BENCH, HOST_KIND_FILES, FIELD(model), 0, 0, 0, 0, NULL, 0},
    {"--target", HOST_REGISTER | HOST_BENCH, HOST_KIND_FILES, FIELD(target), 0, 0, 0, 0, NULL, 0},
    {"-o", HOST_REGISTER | HOST_BUILD | HOST_PHANTOM | HOST_BENCH, HOST_KIND_TEXT, FIELD(out), 0, 0, 0, 0, NULL, 0},
    {"--reference", HOST_REGISTER | HOST_BUILD | HOST_BENCH, HOST_KIND_TEXT, FIELD(reference), 0, 0, 0, 1, NULL,
     HOST_FOR_IMAGES},
    {"--landmarks", HOST_REGISTER | HOST_BENCH, HOST_KIND_FILES, FIELD(landmarks), 0, 0, 0, 0, NULL, 0},
    {"--log", HOST_REGISTER, HOST_KIND_TEXT, FIELD(log), 0, 0, 0, 0, NULL, 0},
    {"--truth", HOST_REGISTER | HOST_BENCH, HOST_KIND_TEXT, FIELD(truth), 0, 0, 0, 0, NULL, HOST_FOR_IMAGES},
    {"--c-array", HOST_BUILD, HOST_KIND_TEXT, FIELD(c_array), 0, 0, 0, 0, NULL, 0},
    {"--source", HOST_MEASURE, HOST_KIND_TEXT, FIELD(source), 0, 0, 0, 0, NULL, 0},
    {"--mirror-model", PREPARING | HOST_BENCH, HOST_KIND_WORD, FIELD(mirror_model), 0, 0, 0, 1, "x|y|z", 0},
    {"--mirror-target", HOST_REGISTER | HOST_BENCH, HOST_KIND_WORD, FIELD(mirror_target), 0, 0, 0, 0, "x|y|z", 0},
    {"--threads", HOST_REGISTER | HOST_MEASURE | HOST_PHANTOM | HOST_BENCH | HOST_REPLAY, HOST_KIND_COUNT,
     FIELD(threads), 1, SMR_WORKERS_MAX, 0, 0, NULL, 0},
    {"--ticks", HOST_REGISTER, HOST_KIND_COUNT, FIELD(ticks), 1, 1e9, 0, 0, NULL, 0},
    {"--budget-ms", HOST_REGISTER, HOST_KIND_DOUBLE, FIELD(budget_ms), 0, 1e6, 0, 0, NULL, 0},
    {"--align", HOST_REGISTER, HOST_KIND_WORD, FIELD(align), 0, 0, 0, 0, "none|rigid|similarity", 0},
    {"--smoothing", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(smoothing), 0, 1e9, 0, 0, NULL, 0},
    {"--quiet", HOST_REGISTER | HOST_BUILD | HOST_PHANTOM | HOST_BENCH, HOST_KIND_FLAG, FIELD(quiet), 0, 0, 0, 0, NULL,
     0},
    {"--radius", PREPARING, HOST_KIND_RADII, FIELD(prepare), 0, COORD, 1, 1, NULL, 0},
    {"--clusters", PREPARING, HOST_KIND_WORD, FIELD(clusters), 0, 0, 0, 1, "auto|shared|separate", 0},
    {"--distance", PREPARING, HOST_KIND_WORD, FIELD(prepare.distance), 0, 0, 0, 1, "euclidean|geodesic", 0},
    {"--mass", PREPARING, HOST_KIND_WORD, FIELD(prepare.mass), 0, 0, 0, 1, "unit|area", 0},
    {"--order", PREPARING, HOST_KIND_WORD, FIELD(prepare.order), 0, 0, 0, 1, "forest|breadth-first", 0},
    {"--block", PREPARING, HOST_KIND_COUNT, FIELD(prepare.block_vertices), 16, 65536, 0, 1, NULL, 0},
    {"--profile-samples", HOST_REGISTER | HOST_BUILD, HOST_KIND_COUNT, FIELD(prepare.profile_samples), 3, 64, 0, 1,
     NULL, HOST_FOR_IMAGES},
    {"--profile-step", HOST_REGISTER | HOST_BUILD, HOST_KIND_FLOAT, FIELD(prepare.profile_step_mm), 0, 100, 1, 1, NULL,
     HOST_FOR_IMAGES},
    {"--profile-inward", HOST_REGISTER | HOST_BUILD, HOST_KIND_FLOAT, FIELD(prepare.profile_inward), 0, 1, 0, 1, NULL,
     HOST_FOR_IMAGES},
    {"--method", HOST_REGISTER, HOST_KIND_WORD, FIELD(config.method), 0, 0, 0, 0, "rigid|polar", 0},
    {"--normals", HOST_REGISTER, HOST_KIND_WORD, FIELD(config.normals), 0, 0, 0, 0, "carried|exact", 0},
    {"--search", HOST_REGISTER, HOST_KIND_SPAN, FIELD(search), 0, COORD, 0, 0, NULL, 0},
    {"--gradient", HOST_REGISTER, HOST_KIND_SPAN, FIELD(gradient), 0, HOST_IMAGE_SEARCH_MAX, 0, 0, NULL,
     HOST_FOR_IMAGES},
    {"--similarity", HOST_REGISTER, HOST_KIND_WORD, FIELD(config.similarity), 0, 0, 0, 0, "ncc|ssd|concordance",
     HOST_FOR_IMAGES},
    {"--sideways", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.sideways), 0, 1, 0, 0, NULL, HOST_FOR_IMAGES},
    {"--confidence", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.confidence), 0, 1, 0, 0, NULL, HOST_FOR_IMAGES},
    {"--normal-angle", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.normal_deg), 0, 180, 1, 0, NULL, HOST_FOR_SURFACES},
    {"--stiffness", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.stiffness), 0, 1, 1, 0, NULL, 0},
    {"--attraction", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.attraction), 0, 1, 0, 0, NULL, HOST_FOR_SURFACES},
    {"--slide", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.slide), 0, 1, 0, 0, NULL, HOST_FOR_SURFACES},
    {"--even", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.even), 0, 1, 0, 0, NULL, HOST_FOR_SURFACES},
    {"--relaxation", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.relaxation), 0, 1, 1, 0, NULL, 0},
    {"--reject-deviations", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.reject_deviations), 0, 1000, 0, 0, NULL,
     HOST_FOR_SURFACES},
    {"--reject-border", HOST_REGISTER, HOST_KIND_FLAG, FIELD(config.reject_border), 0, 0, 0, 0, NULL,
     HOST_FOR_SURFACES},
    {"--node-budget", HOST_REGISTER, HOST_KIND_COUNT, FIELD(config.node_budget), 8, 1000000, 0, 0, NULL,
     HOST_FOR_SURFACES},
    {"--plastic-um", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.plastic_um), 0, 1e6, 0, 0, NULL, 0},
    {"--plastic-every", HOST_REGISTER, HOST_KIND_COUNT, FIELD(config.plastic_every), 0, 1000, 0, 0, NULL, 0},
    {"--seed", HOST_PHANTOM | HOST_BENCH, HOST_KIND_COUNT, FIELD(seed), 1, 1e9, 0, 0, NULL, 0},
    {"--small", HOST_PHANTOM | HOST_BENCH, HOST_KIND_FLAG, FIELD(small), 0, 0, 0, 0, NULL, 0},
    {"--figure2", HOST_BENCH, HOST_KIND_FLAG, FIELD(figure2), 0, 0, 0, 0, NULL, 0},
    {"--soak", HOST_BENCH, HOST_KIND_FLAG, FIELD(soak), 0, 0, 0, 0, NULL, 0},
    {"--repeats", HOST_BENCH, HOST_KIND_COUNT, FIELD(repeats), 1, 1000, 0, 0, NULL, 0},
    {"--step", HOST_BENCH, HOST_KIND_COUNT, FIELD(step), 5, 50, 0, 0, NULL, 0},
    {"--seconds", HOST_BENCH, HOST_KIND_DOUBLE, FIELD(seconds), 0, 1e5, 1, 0, NULL, 0},
    {"--iterations", HOST_REGISTER, HOST_KIND_COUNT, FIELD(config.iterations), 1, 100000, 0, 0, NULL, 0},
    {"--iterations-last", HOST_REGISTER, HOST_KIND_COUNT, FIELD(config.iterations_last), 1, 100000, 0, 0, NULL, 0},
    {"--active", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.active_share), 0, 1, 0, 0, NULL, 0},
    {"--active-first", HOST_REGISTER, HOST_KIND_FLOAT, FIELD(config.active_first), 0, 1, 0, 0, NULL, 0},
    {"--active-enough", HOST_REGISTER, HOST_KIND_COUNT, FIELD(config.active_enough), 0, 1000000, 0, 0, NULL,
     HOST_FOR_IMAGES},
};

_Static_assert(sizeof host_option_table / sizeof host_option_table[0] <= 64, "one bit for each option");

const size_t host_option_count = sizeof host_option_table / sizeof host_option_table[0];

const host_option *host_option_find(const char *name, int command)
{
    size_t i = 0;
    for (i = 0; i < host_option_count; i++)
        if ((host_option_table[i].commands & command) != 0 && strcmp(host_option_table[i].name, name) == 0)
            return &host_option_table[i];
    return NULL;
}

int host_option_given(const host_options *options, const char *name)
{
    const host_option *const o = host_option_find(name, options->command);
    return o != NULL && (options->given >> (size_t)(o - host_option_table) & 1u) != 0;
}
