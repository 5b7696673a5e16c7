/* vec.c: a function of vectors with several callers, of which copies would take room.
 * SPDX-License-Identifier: MIT */
#include "base/vec.h"

SMR_SHARED static float whole(float a) { return smr_whole_number(a); }

smr_vec smr_whole(smr_vec a) { return smr_v(whole(a.x), whole(a.y), whole(a.z)); }
