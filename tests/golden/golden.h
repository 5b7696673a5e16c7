/* golden.h: what the golden runs share: memory, how a step is said to have failed, and the runs beside those onto one
 * target and into one image.
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
    (SMR_ARENA_BYTES(1024, 2048, 1, GOLDEN_WORKERS, 1024, SMR_METHOD_POLAR) + SMR_TRACK_BYTES(1024, 1))
#define GOLDEN_SCRATCH_BYTES (6u << 20)
#define GOLDEN_SURFACE_BYTES (1u << 20)
#define GOLDEN_WORDS 16384u

extern unsigned char golden_arena[GOLDEN_ARENA_BYTES];
extern unsigned char golden_scratch[GOLDEN_SCRATCH_BYTES];
extern unsigned char golden_target[GOLDEN_SURFACE_BYTES];
extern unsigned char golden_source[GOLDEN_SURFACE_BYTES];
extern float golden_words[GOLDEN_WORDS];

/* CRC-32 (IEEE 802.3), bit by bit: independent of the library's own. */
uint32_t golden_crc(const unsigned char *bytes, size_t n);

/* 1 when status is SMR_OK; else it and the step are printed. */
int golden_ok(const char *step, int status);

/* Each uses golden_arena, and golden_target where it has a target of its own. hash: the state at the end. */
int golden_track(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_points(const smr_model *model, const smr_mesh *mesh, const smr_port *port, uint64_t *hash);
int golden_drawn(const smr_model *model, const smr_mesh *mesh, const smr_surface *target, const smr_port *port,
                 uint64_t *hash);
int golden_carry(const smr *s, const smr_mesh *rest, const smr_port *port, uint32_t *crc);

#endif
