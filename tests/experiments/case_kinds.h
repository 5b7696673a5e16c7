/* case_kinds.h: the kinds of runs that verdicts are judged by: fair ones, poor ones and hopeless ones.
 * SPDX-License-Identifier: MIT */
#ifndef CASE_KINDS_H
#define CASE_KINDS_H

#include "case_table.h"

/* The image of a run, and the landmarks in it. */
typedef struct case_picture {
    unsigned char *voxels; /* [size[2]][size[1]][size[0]] */
    uint32_t size[3];
    host_landmarks marks;
    uint32_t patient;
    char directory[CASE_TEXT];
} case_picture;

/* A run that is to be made. */
typedef struct case_job {
    char kind[24], bone[24];
    uint32_t seed;
    int fair;                 /* 1: what a user may expect to work */
    int hopeless;             /* 1: no result is right, whatever the distances say */
    case_picture *picture;    /* NULL when the target is a surface; borrowed */
    case_data data;           /* without targets for an image */
    experiment_command words; /* inputs and options */
} case_job;

/* A kind that starts from a known deformation. 0 stands for a field's default, a negative number for 0. */
typedef struct case_kind {
    const char *name;
    int weight; /* how often it comes */
    int fair, part, patches;
    double share[2]; /* between which the visible share lies */
    double shift, turn, noise, outliers, deform, sigma;
    int (*change)(case_job *job, oracle_random *r); /* spoils it further; 1: there still is a truth */
    const char *words;
} case_kind;

/* Makes the run of a seed, with its files below the directory. A kind's name overrides what the seed says; NULL: none.
 * 0 when the data are not there. */
int case_job_make(case_job *job, uint32_t seed, const char *kind, const char *directory);
void case_job_free(case_job *job);

/* The kinds' tables end with a NULL name. */
extern const case_kind case_surface_kinds[];
extern const case_kind case_image_kinds[];

/* Makes an image run: `directory` keeps what several runs need: the prepared model and the patients. */
int case_image_make(case_job *job, const case_kind *kind, oracle_random *r, const char *directory);

/* Changes of surfaces, for the table. */
int case_change_metres(case_job *job, oracle_random *r);
int case_change_inside_out(case_job *job, oracle_random *r);
int case_change_tibia(case_job *job, oracle_random *r);
int case_change_other_bone(case_job *job, oracle_random *r);
int case_change_wrong_side(case_job *job, oracle_random *r);
int case_change_upside_down(case_job *job, oracle_random *r);
int case_change_twisted(case_job *job, oracle_random *r);
int case_change_scaled(case_job *job, oracle_random *r);
int case_change_stretched(case_job *job, oracle_random *r);
int case_change_half(case_job *job, oracle_random *r);
int case_change_twin(case_job *job, oracle_random *r);
int case_change_middle(case_job *job, oracle_random *r);
int case_change_sphere(case_job *job, oracle_random *r);
int case_change_flat(case_job *job, oracle_random *r);
int case_change_soup(case_job *job, oracle_random *r);
int case_change_person(case_job *job, oracle_random *r);
int case_change_person_top(case_job *job, oracle_random *r);
int case_change_person_low(case_job *job, oracle_random *r);
int case_change_marks(case_job *job, oracle_random *r);
int case_change_marks_swapped(case_job *job, oracle_random *r);
int case_change_marks_off(case_job *job, oracle_random *r);

/* Changes of an image's voxels and of the landmarks in it. */
int case_change_bright(case_job *job, oracle_random *r);
int case_change_grain(case_job *job, oracle_random *r);
int case_change_heavy(case_job *job, oracle_random *r);
int case_change_noise_only(case_job *job, oracle_random *r);
int case_change_half_noise(case_job *job, oracle_random *r);
int case_change_inverted(case_job *job, oracle_random *r);
int case_change_blank(case_job *job, oracle_random *r);
int case_change_mirrored(case_job *job, oracle_random *r);
int case_change_head_down(case_job *job, oracle_random *r);
int case_change_cropped(case_job *job, oracle_random *r);
int case_change_shuffled(case_job *job, oracle_random *r);
int case_change_clicks(case_job *job, oracle_random *r);
int case_change_clicks_15(case_job *job, oracle_random *r);
int case_change_image_swapped(case_job *job, oracle_random *r);
int case_change_image_off(case_job *job, oracle_random *r);
int case_change_image_other(case_job *job, oracle_random *r);
int case_change_no_marks(case_job *job, oracle_random *r);

#endif
