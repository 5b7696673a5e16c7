/* golden.h: what the golden runs share: memory, how a step is said to have failed, and the runs beside those onto one
 * target.
 * SPDX-License-Identifier: MIT */
#ifndef GOLDEN_H
#define GOLDEN_H

#include <smr.h>

#ifdef SMR_BAREMETAL
#define GOLDEN_MEMORY __attribute__((section(".arena"))) _Alignas(SMR_ALIGN)
#else
#define GOLDEN_MEMORY _Alignas(SMR_ALIGN)
#endif

#define GOLDEN_WORKERS 8u
#define GOLDEN_TICKS 40u
#define GOLDEN_ARENA_BYTES                                                                                             \
    (SMR_ARENA_BYTES(1024, 2048, 1, GOLDEN_WORKERS, 1024, SMR_METHOD_POLAR) + SMR_ARENA_DYNAMICS_BYTES(1024, 1) +      \
     SMR_ARENA_CALLER_BYTES(1024, 1) + SMR_ARENA_IMAGE_BYTES(1024) + SMR_ARENA_TRACK_BYTES(1024, 1) +                  \
     SMR_ARENA_CONTACT_BYTES(1024, 2048, 1))
#define GOLDEN_SCRATCH_BYTES (6u << 20)
#define GOLDEN_SURFACE_BYTES (1u << 20)
#define GOLDEN_IMAGE_BYTES (2u << 20)
#define GOLDEN_WORDS 16384u

extern unsigned char golden_arena[GOLDEN_ARENA_BYTES];
extern unsigned char golden_scratch[GOLDEN_SCRATCH_BYTES];
extern unsigned char golden_target[GOLDEN_SURFACE_BYTES];
extern unsigned char golden_image[GOLDEN_IMAGE_BYTES]; /* of a model */
extern float golden_xyz[2][3 * 1024];                  /* of meshes */
extern uint32_t golden_triangles[2][3 * 2048];
extern float golden_words[GOLDEN_WORDS];

/* CRC-32 of bytes, and of n words of four bytes as if they were little-endian. */
uint32_t golden_crc(const unsigned char *bytes, size_t n);
uint32_t golden_crc_words(const void *words, size_t n);

/* 1 when status is SMR_OK; else it and the step are printed. */
int golden_ok(const char *step, int status);

/* The ticks of a run, with a save and a restore in the middle when golden.c asks for them. */
int golden_ticks(smr **s, const smr_model *model, const smr_surface *target, const smr_volume *volume,
                 smr_tick_report *report);

/* By the defaults (hash[0]), and as the paper has it (hash[1]). Uses the meshes' memory, golden_image, golden_scratch
 * and golden_arena. crc: of the model with profiles. */
int golden_images(const smr_port *port, uint64_t hash[2], uint32_t *crc);

/* Each uses golden_arena, and golden_target where it has a target of its own. hash: the state at the end. */
int golden_track(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_points(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_drawn(const smr_model *model, const smr_mesh *mesh, const smr_surface *target, const smr_port *port,
                 uint64_t *hash);
int golden_fused(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_kept(const smr_model *model, const smr_surface *target, const smr_port *port, uint64_t *hash);
int golden_dynamics(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_contact(const smr_model *model, const smr_surface *target, const smr_surface *fixed, const smr_port *port,
                   uint64_t *hash);
int golden_carry(const smr *s, const smr_mesh *rest, const smr_port *port, uint32_t *crc);

#endif
