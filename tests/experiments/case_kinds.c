/* case_kinds.c: the table of kinds with surfaces as targets, and which kind a seed gives.
 * SPDX-License-Identifier: MIT */
#include "case_kinds.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SEEN(low, high) .part = CASE_PATCHES, .patches = 1, .share = {low, high}

const case_kind case_surface_kinds[] = {
    {.name = "whole", .weight = 6, .fair = 1},
    {.name = "whole near", .weight = 2, .fair = 1, .shift = 3.0, .turn = 3.0},
    {.name = "whole exact", .weight = 1, .fair = 1, .noise = -1.0},
    {.name = "whole noise 1", .weight = 2, .fair = 1, .noise = 1.0},
    {.name = "whole noise 2", .weight = 1, .fair = 1, .noise = 2.0},
    {.name = "whole bend 10", .weight = 2, .fair = 1, .deform = 10.0, .sigma = 100.0},
    {.name = "whole bend small", .weight = 1, .fair = 1, .deform = 3.0, .sigma = 40.0},
    {.name = "whole outliers 5", .weight = 2, .fair = 1, .outliers = 0.05},
    {.name = "whole outliers 20", .weight = 1, .fair = 1, .outliers = 0.2},
    {.name = "side", .weight = 6, .fair = 1, .part = CASE_SIDE},
    {.name = "side outliers 5", .weight = 2, .fair = 1, .part = CASE_SIDE, .outliers = 0.05},
    {.name = "patches", .weight = 6, .fair = 1, .part = CASE_PATCHES, .patches = 3, .share = {0.2, 0.4}},
    {.name = "end", .weight = 4, .fair = 1, .part = CASE_END, .share = {0.38, 0.38}},
    {.name = "view", .weight = 8, .fair = 1, SEEN(0.15, 0.9)},
    {.name = "view far", .weight = 4, .fair = 1, SEEN(0.15, 0.9), .shift = 15.0, .turn = 10.0},
    {.name = "person", .weight = 2, .fair = 1, .change = case_change_person, .words = "--align rigid"},
    {.name = "person scaled", .weight = 2, .fair = 1, .change = case_change_person, .words = "--align similarity"},
    {.name = "person top", .weight = 2, .fair = 1, .change = case_change_person_top, .words = "--align rigid"},
    {.name = "person low", .weight = 1, .fair = 1, .change = case_change_person_low, .words = "--align rigid"},
    {.name = "aligned", .weight = 2, .fair = 1, .shift = 40.0, .turn = 30.0, .words = "--align rigid"},
    {.name = "aligned side",
     .weight = 1,
     .fair = 1,
     .part = CASE_SIDE,
     .shift = 20.0,
     .turn = 15.0,
     .words = "--align rigid"},
    {.name = "marks", .weight = 1, .fair = 1, .shift = 60.0, .turn = 60.0, .change = case_change_marks},
    {.name = "metres", .weight = 1, .change = case_change_metres},
    {.name = "metres scaled", .weight = 1, .change = case_change_metres, .words = "--align similarity"},
    {.name = "inside out", .weight = 1, .change = case_change_inside_out},
    {.name = "tibia", .weight = 1, .change = case_change_tibia, .words = "--align similarity"},
    {.name = "other bone", .weight = 1, .change = case_change_other_bone, .words = "--align similarity"},
    {.name = "other bone rigid", .weight = 1, .change = case_change_other_bone, .words = "--align rigid"},
    {.name = "other bone there", .weight = 1, .change = case_change_other_bone},
    {.name = "wrong side", .weight = 1, .change = case_change_wrong_side},
    {.name = "wrong side rigid", .weight = 1, .change = case_change_wrong_side, .words = "--align rigid"},
    {.name = "upside down", .weight = 1, .change = case_change_upside_down},
    {.name = "twisted", .weight = 1, .change = case_change_twisted},
    {.name = "scaled", .weight = 1, .change = case_change_scaled},
    {.name = "stretched", .weight = 1, .change = case_change_stretched},
    {.name = "half replaced", .weight = 1, .change = case_change_half},
    {.name = "twin", .weight = 1, .change = case_change_twin},
    {.name = "middle", .weight = 1, .change = case_change_middle},
    {.name = "sphere", .weight = 1, .change = case_change_sphere, .words = "--align similarity"},
    {.name = "flat", .weight = 1, .change = case_change_flat},
    {.name = "soup", .weight = 1, .change = case_change_soup},
    {.name = "noise 5", .weight = 1, .noise = 5.0},
    {.name = "outliers 50", .weight = 1, .outliers = 0.5},
    {.name = "far 60", .weight = 1, .shift = 60.0, .turn = 20.0},
    {.name = "far 60 side", .weight = 1, .part = CASE_SIDE, .shift = 60.0, .turn = 20.0},
    {.name = "turned 60", .weight = 1, .turn = 60.0},
    {.name = "tiny", .weight = 1, SEEN(0.02, 0.05)},
    {.name = "wild bend", .weight = 1, .deform = 20.0, .sigma = 30.0},
    {.name = "marks swapped", .weight = 1, .change = case_change_marks_swapped},
    {.name = "marks off", .weight = 1, .change = case_change_marks_off},
    {.name = NULL},
};

/* Small bones come more often, since a run of them takes less time. */
static const case_bone *pick_bone(oracle_random *r)
{
    static const unsigned char list[] = {4, 4, 4, 5, 5, 5, 1, 1, 2, 2, 0, 0, 3, 6};
    return &case_bones[list[oracle_below(r, sizeof list)]];
}

static double chosen(double value, double otherwise) { return value < 0.0 ? 0.0 : value > 0.0 ? value : otherwise; }

static case_options options_of(const case_kind *kind, uint32_t seed, oracle_random *r)
{
    case_options o = case_defaults();
    o.seed = seed;
    o.part = kind->part;
    o.patches = kind->patches > 0 ? kind->patches + (kind->patches > 1 ? (int)(seed / 2u % 2u) : 0) : o.patches;
    if (kind->share[1] > 0.0)
        o.share = oracle_uniform(r, kind->share[0], kind->share[1]);
    o.shift_mm = chosen(kind->shift, o.shift_mm);
    o.turn_deg = chosen(kind->turn, o.turn_deg);
    o.noise_mm = chosen(kind->noise, o.noise_mm);
    o.outliers = chosen(kind->outliers, o.outliers);
    o.deform_mm = chosen(kind->deform, o.deform_mm);
    o.sigma_mm = chosen(kind->sigma, o.sigma_mm);
    if (strcmp(kind->name, "view far") == 0) {
        o.shift_mm = oracle_uniform(r, 0.0, 15.0);
        o.turn_deg = oracle_uniform(r, 0.0, 10.0);
    }
    o.density = 1; /* a registration's time counts here, not hundredths of a millimetre */
    return o;
}

/* Each word of the text. */
static void add_words(experiment_command *c, const char *text)
{
    while (text != NULL && *text != '\0') {
        const size_t n = strcspn(text, " ");
        if (n > 0)
            experiment_add(c, "%.*s", (int)n, text);
        text += n + (text[n] == ' ');
    }
}

static int make_surfaces(case_job *job, const case_kind *kind, oracle_random *r, const char *directory)
{
    const case_bone *bone = pick_bone(r);
    const char *path = NULL;
    const case_options o = options_of(kind, job->seed, r);
    char place[CASE_TEXT];
    if (!bone->femur && (strncmp(kind->name, "person", 6) == 0 || strcmp(kind->name, "middle") == 0))
        bone = &case_bones[job->seed / 2u % CASE_FEMURS];
    path = experiment_data("%s", bone->path);
    (void)snprintf(job->bone, sizeof job->bone, "%s", bone->name);
    if (path == NULL || !case_add(&job->data, path, bone->right ? HOST_MIRROR_X : HOST_MIRROR_NONE))
        return 0;
    case_make(&job->data, &o);
    if (kind->change != NULL)
        job->hopeless = !kind->change(job, r);
    (void)snprintf(place, sizeof place, "%.900s/case", directory);
    if (!case_write(&job->data, place))
        return 0;
    case_add_words(&job->data, place, &job->words);
    add_words(&job->words, kind->words);
    return 1;
}

static uint32_t weight_of(const case_kind *kinds)
{
    uint32_t n = 0;
    for (; kinds->name != NULL; kinds++)
        n += (uint32_t)kinds->weight;
    return n;
}

/* The kind of a slot, which counts weights through one table after the other. */
static const case_kind *at_slot(const case_kind *kinds, uint32_t slot)
{
    for (; kinds->name != NULL; kinds++) {
        if (slot < (uint32_t)kinds->weight)
            return kinds;
        slot -= (uint32_t)kinds->weight;
    }
    return NULL;
}

static const case_kind *named(const case_kind *kinds, const char *name)
{
    for (; kinds->name != NULL; kinds++)
        if (strcmp(kinds->name, name) == 0)
            return kinds;
    return NULL;
}

int case_job_make(case_job *job, uint32_t seed, const char *kind, const char *directory)
{
    const uint32_t surfaces = weight_of(case_surface_kinds), all = surfaces + weight_of(case_image_kinds);
    const uint32_t slot =
        (uint32_t)(((uint64_t)(seed / 2u) * 1009u) % all); /* both halves of the seeds have all kinds */
    const case_kind *k =
        slot < surfaces ? at_slot(case_surface_kinds, slot) : at_slot(case_image_kinds, slot - surfaces);
    oracle_random r = oracle_seed(20000u + seed);
    memset(job, 0, sizeof *job);
    if (kind != NULL) {
        k = named(case_surface_kinds, kind);
        k = k != NULL ? k : named(case_image_kinds, kind);
    }
    if (k == NULL)
        return 0;
    job->seed = seed;
    job->fair = k->fair;
    (void)snprintf(job->kind, sizeof job->kind, "%s", k->name);
    if (named(case_image_kinds, k->name) != NULL)
        return case_image_make(job, k, &r, directory);
    return make_surfaces(job, k, &r, directory);
}

void case_job_free(case_job *job)
{
    case_free(&job->data);
    experiment_free(&job->words);
}
