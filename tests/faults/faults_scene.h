/* faults_scene.h: small registrations for a campaign of bit flips.
 * SPDX-License-Identifier: MIT */
#ifndef FAULTS_SCENE_H
#define FAULTS_SCENE_H

#include <smr.h>

#include "faults_memory.h"

enum { FAULTS_SCENES = 5, FAULTS_TICKS = 16, FAULTS_BLOCKS = 5, FAULTS_KINDS = 5, FAULTS_HEAD = 12288 };
enum { FAULTS_MODEL = 0, FAULTS_ARENA, FAULTS_FIRST_INPUT }; /* numbers of blocks; inputs follow */
extern const char *const faults_kind_name[FAULTS_KINDS];

/* The state after a tick: the arena's bytes and the positions. */
typedef struct faults_tick {
    unsigned char *arena;
    float *xyz;
} faults_tick;

typedef struct faults_scene {
    const char *name;
    smr *s;
    uint32_t n_structures, n_vertices, n_ticks, n_blocks, seal;
    uint32_t size[2];             /* vertices of each structure */
    uint32_t kind[FAULTS_BLOCKS]; /* of each block, an index of faults_kind_name */
    faults_block block[FAULTS_BLOCKS];
    unsigned char *clean[FAULTS_BLOCKS]; /* the bytes of each block without a fault */
    faults_tick tick[FAULTS_TICKS + 1];  /* tick[0]: before the first; tick[n_ticks]: the result without a fault */
    float *found;                        /* [n_vertices][3] positions after a flip */
    volatile uint32_t at;                /* the tick under way: the number of complete ones */
} faults_scene;

/* Registers all scenes without a fault. Returns 0 where one did not end with a good verdict. */
int faults_scenes(faults_scene scene[FAULTS_SCENES], int seal);

/* Undoes what a process that ended within a flip left in the blocks. */
void faults_clean(faults_scene scene[FAULTS_SCENES]);

/* Ticks on from the copy `from` to the end, and judges. Returns the status of the first call that failed, or SMR_OK. */
int faults_finish(faults_scene *s, uint32_t from, smr_verdict *verdict);

/* Copies all positions to xyz. Returns 0 where a call failed. */
int faults_positions(const faults_scene *s, float *xyz);

#endif
