/* answers.h: what the lines of answers share: memory, checksums, targets, and what a registration answers.
 * SPDX-License-Identifier: MIT */
#ifndef ANSWERS_H
#define ANSWERS_H

#include <smr.h>

/* Memory up to the end of the present line, all 0; what was taken before answers_keep() stays for all lines. */
void *answers_room(size_t bytes);
void answers_keep(void);

/* Ends the program with one line unless it holds. */
void answers_need(int holds, const char *what);

/* Adds to the checksum, whatever the byte order: words of four bytes; bytes; a status, returning whether it is OK. */
void answers_put(const void *words, size_t bytes);
void answers_put_bytes(const void *bytes, size_t n);
int answers_put_status(smr_status status);

/* A line: its name, then words with the checksum of what was put since the last word. */
void answers_begin(const char *name);
void answers_say(const char *what);
void answers_end(void);

/* Meshes in the line's memory. cut: triangles whose first corner lies beyond `least` on the axis. moved: turned about z
 * by the tangent of half the angle, scaled, shifted along x; mirrored where the scale is negative. */
smr_mesh answers_copy(const smr_mesh *mesh);
smr_mesh answers_cut(const smr_mesh *mesh, uint32_t axis, float least);
smr_mesh answers_noisy(const smr_mesh *mesh, float mm);
smr_mesh answers_moved(const smr_mesh *mesh, float t, float scale, float shift);
smr_mesh answers_joined(const smr_mesh *a, const smr_mesh *b);
smr_surface *answers_surface(const smr_mesh *mesh);

/* A point for every other triangle, and strays beside. */
smr_points *answers_points(const smr_mesh *mesh, int normals, uint32_t strays);

/* Prepares a model and adds its bytes to the checksum. */
const smr_model *answers_model(const smr_structure *parts, uint32_t n, const smr_prepare_config *config);
smr *answers_init(const smr_model *model, const smr_config *config);

/* Adds everything that a registration answers to the line. */
void answers_of(smr *s, const smr_model *model, const smr_tick_report *report);

/* Lines of calls beside registrations, of a bone and a deformed one (answers_calls.c); not all: the quick ones. */
void answers_calls(const smr_mesh bone[2], int all);

#endif
