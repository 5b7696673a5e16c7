/* case_kinds.c: the kinds of runs that verdicts are judged by, in families; fair, poor and hopeless ones.
 * SPDX-License-Identifier: MIT */
#include "case.h"
#include <stdio.h>
#include <string.h>

#define PART(low, high) .part = CASE_PATCHES, .patches = 1, .share = {low, high}
#define MOVED(least, most, angle) .shift = {least, most}, .turn = {0.0, angle}
#define NEAR .shift = {0.0, 6.0}, .turn = {0.0, 6.0}
#define BEND(least, most) .deform = {least, most}, .sigma = {50.0, 110.0}

static const case_kind kinds[] = {
    {"deformed", "whole", .weight = 2},
    {"deformed", "whole near", .weight = 1, MOVED(0.0, 3.0, 3.0)},
    {"deformed", "whole exact", .weight = 1, .noise = {-1.0, -1.0}},
    {"deformed", "bend 2", .weight = 3, BEND(0.5, 2.0)},
    {"deformed", "bend 6", .weight = 3, BEND(2.0, 6.0)},
    {"deformed", "bend 12", .weight = 3, BEND(6.0, 12.0)},
    {"deformed", "bend 25", .weight = 3, BEND(12.0, 25.0)},
    {"deformed", "bend small", .weight = 1, .deform = {2.0, 4.0}, .sigma = {25.0, 50.0}},
    {"deformed", "wild bend", .weight = 1, .deform = {8.0, 20.0}, .sigma = {25.0, 40.0}},
    {"start", "aligned", .weight = 3, MOVED(20.0, 80.0, 60.0), .words = "--align rigid"},
    {"start", "aligned side", .weight = 1, .part = CASE_SIDE, MOVED(10.0, 30.0, 20.0), .words = "--align rigid"},
    {"start", "moved", .weight = 3, MOVED(5.0, 25.0, 15.0)},
    {"start", "far", .weight = 3, MOVED(25.0, 80.0, 30.0)},
    {"start", "turned", .weight = 2, .turn = {20.0, 90.0}},
    {"start", "upside down", .weight = 2, .change = case_upside_down},
    {"start", "twisted", .weight = 1, .change = case_twisted},
    {"wrong bone", "other bone", .weight = 2, .change = case_other_bone, .words = "--align similarity"},
    {"wrong bone", "other bone rigid", .weight = 2, .change = case_other_bone, .words = "--align rigid"},
    {"wrong bone", "other bone there", .weight = 2, .change = case_other_bone},
    {"wrong bone", "tibia", .weight = 1, .change = case_tibia, .words = "--align similarity", .sorts = "f"},
    {"wrong bone", "sphere", .weight = 1, .change = case_sphere, .words = "--align similarity"},
    {"wrong bone", "flat", .weight = 1, .change = case_flat},
    {"mirrored", "wrong side", .weight = 1, .change = case_wrong_side},
    {"mirrored", "wrong side rigid", .weight = 1, .change = case_wrong_side, .words = "--align rigid"},
    {"mirrored", "wrong side scaled", .weight = 1, .change = case_wrong_side, .words = "--align similarity"},
    {"mirrored", "person mirrored", .weight = 2, .change = case_person_mirrored, .words = "--align rigid",
     .sorts = "fh"},
    {"cut", "patches", .weight = 2, .part = CASE_PATCHES, .patches = 3, .share = {0.2, 0.4}},
    {"cut", "end", .weight = 2, .part = CASE_END, .share = {0.2, 0.6}},
    {"cut", "view", .weight = 3, PART(0.15, 0.9)},
    {"cut", "most", .weight = 3, PART(0.7, 0.97), NEAR, BEND(0.5, 4.0)},
    {"cut", "view far", .weight = 1, PART(0.15, 0.9), MOVED(0.0, 15.0, 10.0)},
    {"cut", "tiny", .weight = 1, PART(0.02, 0.05)},
    {"cut", "middle", .weight = 1, .change = case_middle_part, .sorts = "f"},
    {"one side", "side", .weight = 3, .part = CASE_SIDE},
    {"one side", "side little", .weight = 3, .part = CASE_SIDE, NEAR, BEND(0.5, 3.0)},
    {"one side", "front", .weight = 2, .part = CASE_FRONT, NEAR},
    {"one side", "side strays", .weight = 1, .part = CASE_SIDE, .outliers = {0.05, 0.05}},
    {"one side", "side far", .weight = 1, .part = CASE_SIDE, MOVED(20.0, 60.0, 20.0)},
    {"noise", "noise 1", .weight = 3, .noise = {0.2, 1.0}},
    {"noise", "noise 2", .weight = 2, .noise = {1.0, 2.0}},
    {"noise", "noise 5", .weight = 1, .noise = {2.0, 6.0}},
    {"noise", "soup", .weight = 1, .change = case_soup},
    {"noise", "inside out", .weight = 1, .change = case_inside_out},
    {"strays", "strays 5", .weight = 2, .outliers = {0.01, 0.05}},
    {"strays", "strays 20", .weight = 1, .outliers = {0.05, 0.2}},
    {"strays", "strays 50", .weight = 1, .outliers = {0.2, 0.5}},
    {"strays", "stray points", .weight = 2, NEAR, .change = case_stray_points},
    {"strays", "point blob", .weight = 1, NEAR, .change = case_point_blob},
    {"neighbours", "beside", .weight = 4, NEAR},
    {"neighbours", "beside far", .weight = 1, MOVED(10.0, 30.0, 15.0)},
    {"neighbours", "neighbour", .weight = 3, .change = case_neighbour},
    {"neighbours", "neighbour bend", .weight = 1, BEND(5.0, 15.0), .change = case_neighbour},
    {"neighbours", "half replaced", .weight = 1, .change = case_half_replaced},
    {"neighbours", "twin", .weight = 2, .change = case_twin},
    {"sampling", "same mesh", .weight = 1, .change = case_same_mesh},
    {"sampling", "uneven", .weight = 1, .change = case_uneven},
    {"sampling", "points", .weight = 3, .change = case_points},
    {"sampling", "few points", .weight = 2, .change = case_few_points},
    {"sampling", "points side", .weight = 1, .part = CASE_SIDE, .change = case_points},
    {"scale", "scaled little", .weight = 3, .change = case_scaled_little},
    {"scale", "scaled align", .weight = 3, .change = case_scaled, .words = "--align similarity"},
    {"scale", "scaled", .weight = 2, .change = case_scaled},
    {"scale", "stretched", .weight = 2, .change = case_stretched},
    {"scale", "metres", .weight = 1, .change = case_metres},
    {"scale", "metres scaled", .weight = 1, .change = case_metres, .words = "--align similarity"},
    {"person", "person", .weight = 3, .change = case_person, .words = "--align rigid", .sorts = "fh"},
    {"person", "person scaled", .weight = 3, .change = case_person, .words = "--align similarity", .sorts = "fh"},
    {"person", "person top", .weight = 2, .change = case_person_top, .words = "--align rigid", .sorts = "fh"},
    {"person", "person low", .weight = 1, .change = case_person_low, .words = "--align rigid", .sorts = "f"},
    {"landmarks", "marks", .weight = 3, MOVED(30.0, 90.0, 60.0), .change = case_marks},
    {"landmarks", "marks near", .weight = 2, .change = case_marks},
    {"landmarks", "marks swapped", .weight = 1, .change = case_marks_swapped},
    {"landmarks", "marks off", .weight = 1, .change = case_marks_off},
    {.name = NULL},
};

/* A range's value, or the option's own. */
static void choose(const double range[2], double *option, oracle_random *r)
{
    if (range[0] != 0.0 || range[1] != 0.0)
        *option = fmax(0.0, oracle_uniform(r, range[0], range[1]));
}

static case_options options_of(const case_kind *kind, uint32_t seed, oracle_random *r)
{
    case_options o = case_defaults();
    o.seed = seed;
    o.part = kind->part;
    o.patches = kind->patches > 0 ? kind->patches + (kind->patches > 1 ? (int)(seed / 2u % 2u) : 0) : o.patches;
    choose(kind->share, &o.share, r);
    choose(kind->shift, &o.shift_mm, r);
    choose(kind->turn, &o.turn_deg, r);
    choose(kind->noise, &o.noise_mm, r);
    choose(kind->outliers, &o.outliers, r);
    choose(kind->deform, &o.deform_mm, r);
    choose(kind->sigma, &o.sigma_mm, r);
    return o;
}

static int make_surfaces(case_job *job, const case_kind *kind, uint32_t seed, oracle_random *r)
{
    const char *const sorts = kind->sorts != NULL ? kind->sorts : "fhpu";
    job->of = case_choose_bone(job->half, sorts, "", r);
    job->of = job->of->slow ? case_choose_bone(job->half, sorts, "", r) : job->of;
    job->bone = job->of->name;
    const int mirror = job->of->right ? HOST_MIRROR_X : HOST_MIRROR_NONE;
    const case_options o = options_of(kind, seed, r);
    (void)case_add(&job->data, case_text("%s/%s", job->data_path, job->of->path), mirror);
    if (strncmp(kind->name, "beside", 6) == 0 && job->of->beside != NULL)
        case_beside(&job->data, case_text("%s/%s", job->data_path, job->of->beside), mirror);
    case_make(&job->data, &o);
    const int truth = kind->change == NULL || kind->change(job, r);
    const char *const name = job->data.body[0].name, *const place = job->directory;
    job->words = case_text("%s --model %s/model/%s.ply --target %s/target/%s.ply %s", job->words, place, name, place,
                           name, kind->words != NULL ? kind->words : "");
    return truth;
}

/* ---- the kind of a seed: its number chooses the family, then the kind in the family by weight */

static const case_kind *kind_at(uint32_t i)
{
    uint32_t n = 0;
    while (kinds[n].name != NULL)
        n++;
    return i < n ? &kinds[i] : &case_image_kinds[i - n];
}

static int starts_family(uint32_t i)
{
    return i == 0 || (kind_at(i)->name != NULL && strcmp(kind_at(i)->family, kind_at(i - 1u)->family) != 0);
}

static const case_kind *kind_of(uint32_t number)
{
    uint32_t families = 0, first = 0, sum = 0;
    for (uint32_t i = 0; kind_at(i)->name != NULL; i++)
        families += (uint32_t)starts_family(i);
    for (uint32_t left = number % families; !starts_family(first) || left-- > 0;)
        first++;
    for (uint32_t i = first; i == first || (kind_at(i)->name != NULL && !starts_family(i)); i++)
        sum += (uint32_t)kind_at(i)->weight;
    for (uint32_t slot = number / families % sum; slot >= (uint32_t)kind_at(first)->weight; first++)
        slot -= (uint32_t)kind_at(first)->weight;
    return kind_at(first);
}

static const case_kind *kind_named(const char *name)
{
    uint32_t i = 0;
    while (kind_at(i)->name != NULL && strcmp(kind_at(i)->name, name) != 0)
        i++;
    if (kind_at(i)->name == NULL)
        case_fail("no such kind");
    return kind_at(i);
}

void case_job_make(uint32_t seed, const char *name, const char *data, const char *directory)
{
    case_job *const job = case_alloc(1, sizeof *job);
    oracle_random r = oracle_seed(20000u + seed);
    const case_kind *const kind = name != NULL ? kind_named(name) : kind_of(seed / 2u);
    const int image = strncmp(kind->family, "image", 5) == 0;
    job->half = seed % 2u; /* both halves of the seeds have all kinds */
    job->data_path = data;
    job->directory = directory;
    job->words = "";
    case_directory(directory);
    const int truth = image ? case_image_make(job, kind, &r) : make_surfaces(job, kind, seed, &r);
    case_write(&job->data, directory);
    (void)printf("family=%s\nkind=%s\nbone=%s\nhopeless=%d\nimage=%d\noverlap=%.3f\nwords=%s\n", kind->family,
                 kind->name, job->bone, !truth, image, job->data.overlap, job->words);
}
