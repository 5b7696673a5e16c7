/* settings.h: macros that turn the tables settings_config.def and settings_prepare.def into defaults and checks. A file
 * that uses a table defines SMR_GROUP(title) and SMR_SETTING(...) and includes the table, which undefines both again.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETTINGS_H
#define SMR_SETTINGS_H

#include "base/base.h"

#define SMR_PRIOR 300.0f /* default of the setting references.prior */
#define SMR_STRAIN 1.5f  /* default of the setting motion.strain_most */

enum { SMR_ENDS_CLOSED = 0, SMR_ENDS_OPEN, SMR_ENDS_OR_ZERO };

/* The range of legal values of a setting that is one float or one uint32_t. */
typedef struct smr_range {
    uint16_t offset;         /* offset of the setting in its configuration, bytes */
    uint8_t is_number, ends; /* is_number: 1: the setting is a float, 0: a uint32_t; ends: SMR_ENDS_... */
    float low, high;         /* smallest and largest legal value; exact for counts, which are below 2^24 */
} smr_range;

/* Returns 1 when the n settings that range[n] describes have legal values in the struct at config. */
static inline int smr_ranges_legal(const void *config, const smr_range *range, size_t n)
{
    int legal = 1;
    for (const smr_range *r = range; r < range + n; r++) {
        const unsigned char *const at = (const unsigned char *)config + r->offset;
        uint32_t count;
        float number;
        memcpy(&count, at, sizeof count);
        memcpy(&number, at, sizeof number);
        const float v = r->is_number ? number : (float)count;
        legal &= (v >= r->low && v <= r->high && (r->ends != SMR_ENDS_OPEN || (v > r->low && v >= FLT_MIN))) ||
                 (r->ends == SMR_ENDS_OR_ZERO && count == 0u);
    }
    return legal;
}

/* SMR_RANGE_kind expands to a setting's smr_range, and to nothing for kinds that are checked elsewhere. */
#define SMR_RANGE_COUNT(type, path, low, high, ends) {offsetof(type, path), 0, (ends), (float)(low), (float)(high)},
#define SMR_RANGE_CHOICE(type, path, low, high, ends) SMR_RANGE_COUNT(type, path, low, high, ends)
#define SMR_RANGE_SWITCH(type, path, low, high, ends) SMR_RANGE_COUNT(type, path, low, high, ends)
#define SMR_RANGE_NUMBER(type, path, low, high, ends) {offsetof(type, path), 1, (ends), (float)(low), (float)(high)},
#define SMR_RANGE_INDEX(type, path, low, high, ends)
#define SMR_RANGE_VECTOR(type, path, low, high, ends)
#define SMR_RANGE_POINTER(type, path, low, high, ends)

/* SMR_DEFAULT_kind sets v, a setting of that kind, to `value`; vectors and pointers are left as they are, 0. */
#define SMR_DEFAULT_COUNT(v, value) (v) = (uint32_t)(value);
#define SMR_DEFAULT_CHOICE(v, value) SMR_DEFAULT_COUNT(v, value)
#define SMR_DEFAULT_SWITCH(v, value) SMR_DEFAULT_COUNT(v, value)
#define SMR_DEFAULT_INDEX(v, value) SMR_DEFAULT_COUNT(v, value)
#define SMR_DEFAULT_NUMBER(v, value) (v) = (float)(value);
#define SMR_DEFAULT_VECTOR(v, value)
#define SMR_DEFAULT_POINTER(v, value)

/* A row of a table as code: set the setting in *c to its default or its default for images; RANGE: its smr_range. */
#define SMR_ROW_DEFAULT(kind, number, path, name, unit, low, high, ends, value, in_image, text)                        \
    SMR_DEFAULT_##kind(c->path, value)
#define SMR_ROW_IMAGE(kind, number, path, name, unit, low, high, ends, value, in_image, text)                          \
    SMR_DEFAULT_##kind(c->path, in_image)
#define SMR_ROW_RANGE(type, kind, number, path, name, unit, low, high, ends, value, in_image, text)                    \
    SMR_RANGE_##kind(type, path, low, high, SMR_ENDS_##ends)

#endif
