/* image.h: capability: images. Goals in the target image (paper 2.1), and smoothing where the image shows none. In:
 * positions, normals, the image, the model's intensity profiles. Out: the displacement of each vertex to its goal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_IMAGE_H
#define SMR_IMAGE_H

#include "geometry/box_tree/hilbert_curve.h"
#include "image/volume.h"
#include "registration/shape/overlaid_memory.h"
#include "registration/shape/deformed_shape.h"

#ifdef SMR_WITHOUT_IMAGE
#define SMR_HAS_IMAGE 0
#else
#define SMR_HAS_IMAGE 1
#endif

#define SMR_IMAGE_CHUNK 1u    /* vertices of a task that searches the image: one takes the time of forty on a surface */
#define SMR_CONTRAST_ONE 64u  /* stored number for equal contrast of image and profile */
#define SMR_BRIGHTER_NONE 128 /* stored number for equal brightness of image and profile */
#define SMR_BRIGHTER_HIDDEN 0 /* stored number for a vertex that the image does not show */

/* Results of one structure's search in the image in the last iteration, and settings of its next search. */
typedef struct smr_image_structure {
    uint32_t n_goals;            /* vertices with a goal */
    uint32_t n_decided;          /* vertices for which the image decides whether there is a goal */
    smr_box box;                 /* box around the structure's vertices, mm */
    float wide_mm;               /* search distance of profiles, mm, where it exceeds schedule.profile_mm */
    float noise;                 /* noise level, intensity: lower contrast counts as none */
    float gain;                  /* contrast of the image divided by that of the profiles, mean of the goals */
    float gain_sum, gain_weight; /* weighted sum of contrasts at goals; sum of weights */
    float brighter;              /* brightness of the image minus that of the profiles, intensity, mean of the goals */
    float brighter_sum;          /* weighted sum of brightness at goals */
    uint32_t idle;               /* 1: the last complete forces did not search the image for this structure */
    float matched;               /* while idle: share of vertices with a goal in the last search; -1: never searched */
} smr_image_structure;

typedef struct smr_image_goals {
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const uint8_t *found;           /* [n] SMR_FOUND_... of the last complete forces */
    smr_rings rings;                /* sums of the mesh neighbours' positions, for the smoothing force */
    uint32_t has_image;             /* 1: structures without a target surface follow the image */
    uint32_t n_invisible;           /* number of SMR_BRIGHTER_HIDDEN in `brighter` */
    smr_grid grid;                  /* the target image */
    smr_image_structure *structure; /* [n_structures] each structure's search in the image */
    uint32_t ring_pieces;           /* pieces of a structure in the current step; 0 and 1: the structure is one task */
    uint8_t *contrast;              /* [n] at the goal: image's contrast / profile's * SMR_CONTRAST_ONE; 0: unknown */
    uint8_t *contrast_next;         /* [n] `contrast` of the current forces */
    uint8_t *brighter;      /* [n] brightness at the goal, image minus profile, in noise units + SMR_BRIGHTER_NONE */
    uint8_t *brighter_next; /* [n] `brighter` of the current forces */
} smr_image_goals;

/* Returns 1 when structures without a surface follow an image. */
static inline int smr_image_on(const smr_image_goals *g) { return SMR_HAS_IMAGE && g->has_image; }

void smr_image_goals_layout(smr_arena *a, smr_image_goals *g, const smr_shared *shared);
void smr_image_goals_reset(smr_image_goals *g);                       /* discards all results of the current forces */
void smr_image_goals_open(smr_image_goals *g, const smr_grid *image); /* sets the target image; NULL: none */
void smr_image_goals_derive(smr_image_goals *g);                      /* computes noise levels and n_invisible */
void smr_image_goals_commit(smr_image_goals *g); /* called when the current forces are complete: keeps their results */

/* The displacement of vertex v to its goal in the image: SMR_GOAL, and *displacement is set. SMR_NO_GOAL: no goal
 * above the confidence threshold. SMR_UNDECIDED: the search leaves the image or meets one value only, or the search
 * distance is below a sample. SMR_INVISIBLE: no goal, and the image does not show the vertex. Stores contrast and
 * brightness at the goal. */
int smr_image_goal(smr_image_goals *g, uint32_t v, smr_vec *displacement);

/* Returns 1 when the reference image shows all of the profile of v, and the image all of the same line at v. */
int smr_image_shows(const smr_image_goals *g, uint32_t v);

/* Returns 1 when the current forces search the image for this structure: some search distance reaches a sample. */
int smr_image_seeks(const smr_image_goals *g, uint32_t structure);
void smr_image_forget(smr_image_goals *g, uint32_t v);      /* marks v as having no goal in the current forces */
void smr_image_keep(smr_image_goals *g, uint32_t v);        /* keeps the last contrast and brightness of v */
void smr_image_ahead(const smr_image_goals *g, uint32_t v); /* prefetches the voxels for the search of v */

/* Compares how well the profile of v matches the image at v and at places beside v. *wins: comparisons that v won minus
 * those that it lost, of *n. *n is 0 when v has no profile or a sample lies outside the image. */
void smr_image_compare(const smr_image_goals *g, uint32_t v, int32_t *wins, uint32_t *n);

/* Step: sums over mesh neighbours, all structures side by side. Then the displacement of a vertex without goal, mm. */
uint32_t smr_fill_tasks(const void *goals);
uint32_t smr_fill_abreast(const void *goals);
void smr_fill_pieces(void *goals, int cut);
void smr_fill_sum(void *goals, uint32_t task, uint32_t worker);
smr_vec smr_fill_displacement(const smr_image_goals *g, uint32_t v);

#endif
