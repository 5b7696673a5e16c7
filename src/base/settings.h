/* settings.h: macros that turn the tables settings_config.def and settings_prepare.def into defaults and checks. A user
 * defines SMR_GROUP(title) and SMR_SETTING(...) and includes a table, which undefines both again.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_SETTINGS_H
#define SMR_SETTINGS_H

#include "base/base.h"

enum { SMR_ENDS_CLOSED = 0, SMR_ENDS_OPEN, SMR_ENDS_OR_ZERO };

static inline int smr_legal_count(uint32_t v, uint32_t low, uint32_t high, int ends)
{
    return (v >= low && v <= high) || (ends == SMR_ENDS_OR_ZERO && v == 0u);
}

static inline int smr_legal_number(float v, float low, float high, int ends)
{
    return v >= low && v <= high && (ends != SMR_ENDS_OPEN || (v > low && v >= FLT_MIN));
}

/* SMR_LEGAL_kind is 1 when a value of this kind is legal. Kinds that are checked elsewhere always pass. */
#define SMR_LEGAL_COUNT(v, low, high, ends) smr_legal_count((v), (uint32_t)(low), (uint32_t)(high), (ends))
#define SMR_LEGAL_CHOICE SMR_LEGAL_COUNT
#define SMR_LEGAL_SWITCH SMR_LEGAL_COUNT
#define SMR_LEGAL_NUMBER(v, low, high, ends) smr_legal_number((v), (float)(low), (float)(high), (ends))
#define SMR_LEGAL_INDEX(v, low, high, ends) 1
#define SMR_LEGAL_VECTOR(v, low, high, ends) 1
#define SMR_LEGAL_POINTER(v, low, high, ends) 1

/* SMR_DEFAULT_kind sets a value of this kind to its default. Vectors and pointers stay 0. */
#define SMR_DEFAULT_COUNT(v, value) (v) = (uint32_t)(value);
#define SMR_DEFAULT_CHOICE SMR_DEFAULT_COUNT
#define SMR_DEFAULT_SWITCH SMR_DEFAULT_COUNT
#define SMR_DEFAULT_INDEX SMR_DEFAULT_COUNT
#define SMR_DEFAULT_NUMBER(v, value) (v) = (float)(value);
#define SMR_DEFAULT_VECTOR(v, value)
#define SMR_DEFAULT_POINTER(v, value)

/* SMR_ROW_... expand a row of a table for the configuration *c. */
#define SMR_ROW_DEFAULT(kind, number, path, name, unit, low, high, ends, value, image, text)                           \
    SMR_DEFAULT_##kind(c->path, value)
#define SMR_ROW_IMAGE(kind, number, path, name, unit, low, high, ends, value, image, text)                             \
    SMR_DEFAULT_##kind(c->path, image)
#define SMR_ROW_LEGAL(kind, number, path, name, unit, low, high, ends, value, image, text)                             \
    legal &= SMR_LEGAL_##kind(c->path, low, high, SMR_ENDS_##ends);

#endif
