/* save_format.h: the bytes of a saved registration. docs/SPEC.md has the table.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SAVE_FORMAT_H
#define SMR_SAVE_FORMAT_H

#include "registration/api/setup.h"

#define SMR_SAVED_MAGIC 0x53524d53u /* "SMRS" */
#define SMR_SAVED_VERSION 1u
#define SMR_SAVED_FIXED 32u /* bytes of a header before the configuration */

/* Words of the header. Then follow the configuration's words, the saved values, and a CRC-32 of everything. */
enum {
    SMR_SAVED_AT_MAGIC = 0,
    SMR_SAVED_AT_VERSION,
    SMR_SAVED_AT_BYTES,
    SMR_SAVED_AT_LIBRARY,
    SMR_SAVED_AT_MODEL,
    SMR_SAVED_AT_VERTICES,
    SMR_SAVED_AT_PLAN, /* checksum of the list of saved values: another list is another version */
    SMR_SAVED_AT_CONFIG_WORDS
};

#endif
