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

#define SMR_IMAGE_CHUNK 1u    /* vertices of a task that searches the image; each takes as long as forty on a surface */
#define SMR_NOISE_MUCH 2.0f   /* noise of the image / mean noise level of structures above which more are active */
#define SMR_NOISE_MORE 4.0f   /* largest number of active vertices / number without noise */
#define SMR_CONTRAST_ONE 64u  /* stored contrast number for equal contrast of image and profile */
#define SMR_BRIGHTER_NONE 128 /* stored brightness number for equal brightness of image and profile */
#define SMR_BRIGHTER_HIDDEN 0 /* stored brightness number of a vertex that the image does not show */

/* Results of one structure's search in the image in the last iteration, and settings of its next search. */
typedef struct smr_image_structure {
    uint32_t n_goals;            /* number of vertices with a goal */
    uint32_t n_decided;          /* number of vertices whose search decided whether they have a goal */
    smr_box box;                 /* box around the present positions of the structure, mm */
    float wide_mm;               /* search distance of profiles, mm, used if larger than schedule.profile_mm */
    float noise;                 /* noise level of the image, intensity */
    float gain;                  /* contrast of the image divided by the profiles' contrast, mean of all goals */
    float gain_sum, gain_weight; /* weighted sum of contrast ratios at goals; sum of their weights */
    float brighter;              /* brightness of the image minus the profiles', intensity, mean of all goals */
    float brighter_sum;          /* weighted sum of brightness differences at goals, intensity */
    uint32_t idle;               /* 1: the last complete forces did not search the image for the structure */
    float matched;               /* share of vertices with a goal in the last search, while idle; -1: no search */
} smr_image_structure;

struct smr_image_goals;

/* Functions of an iteration with an image. Programs without smr_set_volume(), which names them, link none. */
typedef struct smr_image_calls {
    /* Searches vertex v's goal in the image. Returns SMR_GOAL, and the displacement to it, mm; SMR_NO_GOAL: no goal
     * above the confidence threshold; SMR_UNDECIDED: the search leaves the image or meets one value only, or the search
     * distance is below a sample; SMR_INVISIBLE: no goal, and the image does not show the vertex. Stores contrast and
     * brightness at the goal. */
    int (*goal)(struct smr_image_goals *g, uint32_t v, smr_vec *displacement);
    int (*rests)(const struct smr_image_goals *g, uint32_t v);    /* 1: v keeps its last goal instead of searching */
    void (*ahead)(const struct smr_image_goals *g, uint32_t v);   /* prefetches voxels that v's search reads */
    smr_run_task *fill_sum;                                       /* runs a task of smr_fill_sum() */
    smr_vec (*fill)(const struct smr_image_goals *g, uint32_t v); /* returns smoothing of a goalless vertex, mm */
} smr_image_calls;

typedef struct smr_image_goals {
    const smr_image_calls *calls; /* functions of an iteration with an image; NULL: no image was set */
    const smr_shared *shared;
    const smr_schedule *schedule;
    const smr_shape *shape;
    const uint8_t *found;           /* [n] SMR_FOUND_...: what each vertex' search found in the last complete forces */
    smr_rings rings;                /* sums of the positions of each vertex' mesh neighbours */
    uint32_t has_image;             /* 1: structures without a target surface follow the image */
    uint32_t n_invisible;           /* number of vertices that the image does not show */
    smr_grid grid;                  /* target image */
    float noise;                    /* standard deviation of the target image's noise, intensity */
    float noise_level;              /* mean noise level of structures with profiles, intensity */
    smr_image_structure *structure; /* [n_structures] results and settings of each structure's search in the image */
    uint8_t *contrast;              /* [n] image's contrast / profile's * SMR_CONTRAST_ONE, at each goal; 0: unknown */
    uint8_t *contrast_next;         /* [n] contrast numbers, as in `contrast`, of the current forces */
    uint8_t *brighter;              /* [n] (image minus profile brightness at each goal) / noise + SMR_BRIGHTER_NONE */
    uint8_t *brighter_next;         /* [n] brightness numbers, as in `brighter`, of the current forces */
    uint8_t *searched;              /* [n] iteration, modulo 256, in which the search last found each vertex' goal */
    float *last;                    /* [n][2][3] each vertex' position and displacement in that search, mm */
} smr_image_goals;

/* Returns 1 when structures without a target surface follow an image. */
static inline int smr_image_on(const smr_image_goals *g) { return SMR_HAS_IMAGE && g->has_image; }

/* Returns the noise of the image / the mean noise level of structures; 0 as in the paper, which ignores noise. */
static inline float smr_image_noise(const smr_image_goals *g)
{
    const int ignored = g->shared->config.image.blend == SMR_BLEND_PLAIN || !(g->noise_level > 0.0f);
    return ignored ? 0.0f : g->noise / g->noise_level;
}

/* Returns how many times as many active vertices suffice as without noise: so many that their mean has as much noise,
 * but not at the last radius, nor in tracking, where budgets may take fewer after the search. The first 1 / that share
 * of the active vertices is sought by means over many lines and decides whether the image can be trusted: on few lines
 * mere noise has goals, too. */
static inline float smr_image_more(const smr_image_goals *g)
{
    const float noise = SMR_HAS_IMAGE && g->has_image ? smr_image_noise(g) * (1.0f / SMR_NOISE_MUCH) : 0.0f;
    const int all = smr_at_last_radius(g->shared, g->schedule) || g->schedule->tracking != 0u;
    return all ? 1.0f : smr_clamp(noise * noise, 1.0f, SMR_NOISE_MORE);
}

void smr_image_goals_layout(smr_arena *a, smr_image_goals *g, const smr_shared *shared);
/* discards contrast and brightness of a part of the vertices, and `idle` */
void smr_image_goals_reset(smr_image_goals *g, uint32_t part, uint32_t parts);
void smr_image_goals_open(smr_image_goals *g, const smr_grid *image); /* sets the target image; NULL: none */
void smr_image_goals_see(smr_image_goals *g, const smr_grid *image);  /* stores the target image and its noise */
/* Sums in the making over the profiles of structure k, of which `at` vertices are done, and over the structures. */
typedef struct smr_image_summing {
    uint32_t k, at;
    float sum, count;   /* sum of the ranges of profiles, and number of ranges above 0 */
    float noise, noisy; /* sum of the structures' noise, and number of structures with noise */
} smr_image_summing;
int smr_image_goals_sum(smr_image_goals *g,
                        smr_image_summing *j); /* sets noise and n_invisible; returns 1 at the end */
/* when forces are complete: keeps contrast and brightness of some vertices; pieces come in order */
void smr_image_keep_found(smr_image_goals *g, smr_piece p);

/* Returns 1 when the profile of v is complete and the image contains the whole line of the profile at v. */
int smr_image_shows(const smr_image_goals *g, uint32_t v);

/* Returns 1 when the current forces search the image for a structure: a search distance is at least half a sample. */
int smr_image_seeks(const smr_image_goals *g, uint32_t structure);
void smr_image_forget(smr_image_goals *g, uint32_t v); /* stores that v has no contrast and brightness */
void smr_image_keep(smr_image_goals *g, uint32_t v);   /* takes v's contrast and brightness from the last forces */

/* Compares how well the profile of v matches the image at v and at places beside v. *wins: comparisons won by v minus
 * those lost by v, out of *n. *n is 0 when v has no profile or a sample at v lies outside the image. */
void smr_image_compare(const smr_image_goals *g, uint32_t v, int32_t *wins, uint32_t *n);

/* Step: sums positions of mesh neighbours, by which vertices without a goal are smoothed. */
smr_count_tasks smr_fill_tasks;
smr_run_task smr_fill_sum, smr_fill_structure;
smr_vec smr_fill_displacement(const smr_image_goals *g, uint32_t v);

#endif
