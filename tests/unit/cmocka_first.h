/* cmocka_first.h: CMocka and the headers that must precede it.
 * SPDX-License-Identifier: MIT */
#ifndef CMOCKA_FIRST_H
#define CMOCKA_FIRST_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#endif
