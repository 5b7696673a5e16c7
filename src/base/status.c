/* status.c: the names of the status codes, for messages.
 * SPDX-License-Identifier: MIT */
#include "base/base.h"

const char *smr_status_name(smr_status status)
{
    switch (status) {
    case SMR_OK: return "SMR_OK";
    case SMR_PARTIAL: return "SMR_PARTIAL";
    case SMR_E_NULL: return "SMR_E_NULL";
    case SMR_E_CONFIG: return "SMR_E_CONFIG";
    case SMR_E_ARENA: return "SMR_E_ARENA";
    case SMR_E_ALIGN: return "SMR_E_ALIGN";
    case SMR_E_MODEL: return "SMR_E_MODEL";
    case SMR_E_INPUT: return "SMR_E_INPUT";
    case SMR_E_STATE: return "SMR_E_STATE";
    case SMR_E_ABORTED: return "SMR_E_ABORTED";
    case SMR_E_LOG: return "SMR_E_LOG";
    case SMR_E_SAVE: return "SMR_E_SAVE";
    case SMR_E_WITHOUT: return "SMR_E_WITHOUT";
    case SMR_E_DAMAGED: return "SMR_E_DAMAGED";
    }
    return "SMR_E_UNKNOWN";
}
