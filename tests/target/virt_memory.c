/* virt_memory.c: the functions that the core and the golden run need of a C library, for a board without one.
 * SPDX-License-Identifier: MIT */
#include <stddef.h>
#include <stdint.h>

/* The loops must not become calls of themselves. */
#pragma GCC optimize("no-tree-loop-distribute-patterns")

typedef uint64_t __attribute__((may_alias)) virt_word;

void *memcpy(void *restrict to, const void *restrict from, size_t n)
{
    const size_t words = (((uintptr_t)to | (uintptr_t)from) % 8u == 0u) ? n / 8u : 0u;
    for (size_t i = 0; i < words; i++)
        ((virt_word *)to)[i] = ((const virt_word *)from)[i];
    for (size_t i = 8u * words; i < n; i++)
        ((unsigned char *)to)[i] = ((const unsigned char *)from)[i];
    return to;
}

void *memmove(void *to, const void *from, size_t n)
{
    unsigned char *const t = to;
    const unsigned char *const f = from;
    for (size_t i = 0; t < f && i < n; i++)
        t[i] = f[i];
    for (size_t i = n; t > f && i > 0; i--)
        t[i - 1] = f[i - 1];
    return to;
}

void *memset(void *to, int value, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ((unsigned char *)to)[i] = (unsigned char)value;
    return to;
}

int memcmp(const void *a, const void *b, size_t n)
{
    const unsigned char *const p = a, *const q = b;
    for (size_t i = 0; i < n; i++)
        if (p[i] != q[i])
            return p[i] < q[i] ? -1 : 1;
    return 0;
}

/* The rest is for the tests, not for the core. */
size_t strlen(const char *text)
{
    size_t n = 0;
    while (text[n] != '\0')
        n++;
    return n;
}

char *strstr(const char *text, const char *words)
{
    const size_t n = strlen(words);
    for (; *text != '\0' && memcmp(text, words, n < strlen(text) ? n : strlen(text) + 1u) != 0; text++) {
    }
    return *text != '\0' || n == 0u ? (char *)(size_t)text : NULL;
}
