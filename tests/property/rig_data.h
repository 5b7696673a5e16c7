/* rig_data.h: real surfaces that may lie beside the repository.
 * SPDX-License-Identifier: MIT */
#ifndef RIG_DATA_H
#define RIG_DATA_H

#include "smr.h"

#define RIG_STRUCTURES_MAX 64u

/* Reads every .ply of ../shared/data/FOLDER (SMR_TEST_DATA: instead of ../shared/data), sorted by name: binary
 * little-endian, three floats a vertex, triangles with a one-byte count. name: where the names go, or NULL.
 * Returns how many; 0 when there is no such folder. Memory: rig_alloc. */
uint32_t rig_folder(const char *folder, smr_mesh mesh[RIG_STRUCTURES_MAX], char name[][SMR_NAME_BYTES]);

#endif
