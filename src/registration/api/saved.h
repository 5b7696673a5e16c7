/* saved.h: how a saved registration lies in bytes. docs/SPEC.md has the table.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SAVED_H
#define SMR_SAVED_H

#include "registration/api/setup.h"

#define SMR_SAVED_MAGIC 0x53524d53u /* "SMRS" */
#define SMR_SAVED_VERSION 1u
#define SMR_SAVED_FIXED 32u /* bytes of a header before the configuration */

/* Words of the header. The configuration's words follow, what is kept, and a CRC-32 of all that. */
enum {
    SMR_SAVED_AT_MAGIC = 0,
    SMR_SAVED_AT_VERSION,
    SMR_SAVED_AT_BYTES,
    SMR_SAVED_AT_LIBRARY,
    SMR_SAVED_AT_MODEL,
    SMR_SAVED_AT_VERTICES,
    SMR_SAVED_AT_PLAN, /* checksum of which values are kept: another list is another version */
    SMR_SAVED_AT_CONFIG_WORDS
};

#endif
