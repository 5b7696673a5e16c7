/* cmocka_first.h: CMocka with the headers that it needs before it.
 * SPDX-License-Identifier: MIT */
#ifndef CMOCKA_FIRST_H
#define CMOCKA_FIRST_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#endif
