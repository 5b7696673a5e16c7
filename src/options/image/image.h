/* image.h: capability: images. Goals in the target image (paper 2.1) and what fills in where the image shows none. In: positions,
 * normals, the image, the model's intensity profiles. Out: the way to each vertex' goal.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_IMAGE_H
#define SMR_IMAGE_H

#include "geometry/box_tree/hilbert_curve.h"
#include "image/volume.h"
#include "registration/shape/overlaid_memory.h"
#include "registration/shape/shape.h"

#ifdef SMR_WITHOUT_IMAGE
#define SMR_HAS_IMAGE 0
#else
#define SMR_HAS_IMAGE 1
#endif

#define SMR_IMAGE_CHUNK 1u   /* vertices of a task that seeks goals in an image: one costs as much as forty elsewhere */
#define SMR_CONTRAST_ONE 64u /* stored contrast of an image that has the profile's own */
#define SMR_BRIGHTER_NONE 128 /* stored brightness of an image that is as bright as the profile */

/* How one structure was seen in the image in the last iteration, and how its next goals are sought. Written by
 * fill_unseen.c; noise by image_goal.c, when an image comes. */
typedef struct smr_image_structure {
    uint32_t n_goals;   /* vertices that had a goal */
    uint32_t n_decided; /* vertices for which the image could say whether there is one */
    smr_box box;        /* of its vertices, mm */
    float wide_mm;      /* profiles are sought so far, where that is farther than pace.profile_mm */
    float noise;        /* brightness: contrast below it counts as none in its profiles */
    float gain;         /* contrast of the image over the profiles', in the mean over its goals */
    float gain_sum, gain_weight;
    float brighter; /* image minus profile brightness, likewise */
    float brighter_sum;
    uint32_t idle; /* 1: its last complete forces sought nothing. Written by forces.c, as is: */
    float matched; /* while idle: share of its vertices with a goal when it was last sought; -1: never */
} smr_image_structure;

typedef struct smr_image_goals {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape;
    const uint8_t *found;           /* [n] forces.found_last: what the last complete forces found */
    smr_rings rings;                /* written by fill_unseen.c: sums of the mesh neighbours' positions */
    uint32_t has_image;             /* 1: structures without a surface follow the image. Written by setup/targets.c */
    smr_grid grid;                  /* the image */
    smr_image_structure *structure; /* [n_structures] */
    uint32_t ring_pieces;           /* pieces of a structure in the step under way; 0 and 1: whole */
    /* how the image compares with the profile at the goal: of the last complete forces, and of those under way */
    uint8_t *contrast, *contrast_next; /* [n] in units of 1 / SMR_CONTRAST_ONE; 0: not known */
    uint8_t *brighter, *brighter_next; /* [n] image minus profile, in noise units above SMR_BRIGHTER_NONE */
} smr_image_goals;

/* 1: structures without a surface follow an image. */
static inline int smr_image_on(const smr_image_goals *g) { return SMR_HAS_IMAGE && g->has_image; }

void smr_image_goals_layout(smr_arena *a, smr_image_goals *g, const smr_shared *shared);
void smr_image_goals_wire(smr_image_goals *g, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                          const uint8_t *found, const smr_rings *rings);
void smr_image_goals_reset(smr_image_goals *g);                       /* nothing of the forces so far is left */
void smr_image_goals_open(smr_image_goals *g, const smr_grid *image); /* NULL: none from here on */
void smr_image_goals_noise(smr_image_goals *g);                       /* noise of each structure, from the model */
void smr_image_goals_stand(smr_image_goals *g);                       /* the forces under way are complete */

/* The way from vertex v to its goal in the image, along its normal and a little along the surface: SMR_GOAL, and *way
 * is set. SMR_NO_GOAL: no goal above the confidence threshold. SMR_UNDECIDED: the image cannot tell, for the vertex has
 * no profile, the search leaves the image or meets nothing but one value, or search distances are below a sample.
 * Notes how the image compares with the profile there. */
int smr_image_goal(smr_image_goals *g, uint32_t v, smr_vec *way);

/* 1 when goals of this structure are sought in the image in the forces under way: no search distance reaches a sample
 * where they end at 0. */
int smr_image_seeks(const smr_image_goals *g, uint32_t structure);

/* There is no goal in the image for v in the forces under way. */
void smr_image_forget(smr_image_goals *g, uint32_t v);

/* What the last forces found of v in the image stays. */
void smr_image_keep(smr_image_goals *g, uint32_t v);

/* Asks the processor for the voxels that the goal of v will need. */
void smr_image_ahead(const smr_image_goals *g, uint32_t v);

/* image_likeness.c: whether profiles fit where the model is, or as well beside: what chance gives in this image. */

/* Compares the profile of v in its place with the same profile in places beside it. wins: comparisons won less those
 * lost, of n. Returns the score in its place, -1..1; n is 0 where there is no profile or it is not all inside. */
float smr_image_compare(const smr_image_goals *g, uint32_t v, int32_t *wins, uint32_t *n);

/* fill_unseen.c: sums over mesh neighbours, then the way of a vertex without a goal. */
uint32_t smr_fill_tasks(const void *goals);
uint32_t smr_fill_abreast(const void *goals);
void smr_fill_pieces(void *goals, int cut);
void smr_fill_sum(void *goals, uint32_t task, uint32_t worker);
smr_vec smr_fill_way(const smr_image_goals *g, uint32_t v);

#endif
