/* volume_preservation.h: each closed structure's volume is led to what is asked. In: positions and normals under way.
 * Out: positions under way.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_VOLUME_PRESERVATION_H
#define SMR_VOLUME_PRESERVATION_H

#include "runtime/deformed/enclosed_volume.h"
#include "runtime/match/sums.h"

#define SMR_ASKED_LEAST 0.1f
#define SMR_ASKED_MOST 10.0f

/* One structure. Ratios are volume over rest_mm3. */
typedef struct smr_held_volume {
    uint32_t closed; /* 1: it encloses a volume, and this is led. Otherwise the rest is not looked at */
    float model_mm3; /* of the rest shape */
    float rest_mm3;  /* of the rest shape in the scale of the start; negative where triangles look inwards */
    float model_thick_mm, thick_mm; /* half its thickness, in the mean: volume over area; and in that scale */
    float ratio;                    /* the caller's. Written by setup/volume_ratio.c */
    float begun;                    /* the same, when the iteration under way began */
    float now;        /* asked in the iteration under way: goes from the start's to the caller's by steps */
    float way_mm;     /* each vertex goes so far along its normal */
    smr_vec amid;     /* its cones start there */
    smr_enclosed sum; /* so far */
} smr_held_volume;

typedef struct smr_volumes {
    const smr_shared *shared;
    const smr_pace *pace;
    const smr_shape *shape; /* x_next is changed */
    const smr_sums *sums;   /* the next normals lie there */
    smr_held_volume *held;  /* [n_structures]; NULL: config.contact.volume is 0 */
} smr_volumes;

void smr_volumes_layout(smr_arena *a, smr_volumes *v, const smr_shared *shared);
void smr_volumes_wire(smr_volumes *v, const smr_shared *shared, const smr_pace *pace, const smr_shape *shape,
                      const smr_sums *sums);
void smr_volumes_model(smr_volumes *v); /* what follows from the model alone; ratios are 1 */
void smr_volumes_scale(smr_volumes *v); /* and from the start positions, which are new or were restored */
void smr_volumes_start(smr_volumes *v); /* the same, and the present volumes are where the way to the ratios begins */
void smr_volumes_begin(smr_volumes *v); /* an iteration begins */
int smr_volumes_under_way(const smr_volumes *v); /* 1: some volume has not come to what is asked for */
void smr_volumes_stand(smr_volumes *v);          /* it stands: a step towards what was asked when it began */

/* Step: sums over triangles, then positions. Serial. */
uint32_t smr_volume_tasks(const void *volumes);
void smr_volume_lead(void *volumes, uint32_t task, uint32_t worker);

#endif
