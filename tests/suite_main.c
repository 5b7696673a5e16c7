/* suite_main.c: main() of test programs that have none of their own; the linker takes it from the library.
 * SPDX-License-Identifier: MIT */
int suite_run(int (*set_up)(void **), int (*tear_down)(void **)); /* that of the program: suite.h */

int main(void) { return suite_run(0, 0); }
