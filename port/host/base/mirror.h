/* mirror.h: the coordinate that mirroring negates.
 * SPDX-License-Identifier: MIT */
#ifndef MIRROR_H
#define MIRROR_H

enum { HOST_MIRROR_NONE = -1, HOST_MIRROR_X = 0, HOST_MIRROR_Y = 1, HOST_MIRROR_Z = 2 };

#endif
