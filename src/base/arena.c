/* arena.c: divides the caller's memory into slots aligned to SMR_ALIGN; red zones follow under the address sanitiser.
 * SPDX-License-Identifier: MIT */
#include "base/arena.h"

#if defined(__SANITIZE_ADDRESS__)
#define SMR_ASAN 1 /* the address sanitiser watches this build */
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SMR_ASAN 1 /* the address sanitiser watches this build */
#endif
#endif

#ifdef SMR_ASAN
void __asan_poison_memory_region(void const volatile *addr, size_t size);
void __asan_unpoison_memory_region(void const volatile *addr, size_t size);
#define SMR_POISON(p, n) __asan_poison_memory_region((p), (n))
#define SMR_UNPOISON(p, n) __asan_unpoison_memory_region((p), (n))
#define SMR_RED_ZONE ((size_t)8) /* least bytes of poisoned memory behind each slot */
#else
#define SMR_POISON(p, n) ((void)(p), (void)(n))
#define SMR_UNPOISON(p, n) ((void)(p), (void)(n))
#define SMR_RED_ZONE ((size_t)0) /* least bytes of poisoned memory behind each slot: none */
#endif

smr_status smr_arena_start(smr_arena *a, void *base, size_t capacity)
{
    if (base == NULL)
        return SMR_E_NULL;
    if ((uintptr_t)base % SMR_ALIGN != 0u)
        return SMR_E_ALIGN;
    *a = (smr_arena){base, capacity, 0, NULL};
    return SMR_OK;
}

void *smr_arena_take(smr_arena *a, size_t count, size_t size)
{
    const size_t start = a->used, bytes = count * size;
    if (start > SIZE_MAX - 4u * SMR_ALIGN || (size != 0u && count > (SIZE_MAX - start - 4u * SMR_ALIGN) / size)) {
        a->used = SIZE_MAX;
        return NULL;
    }
    a->used = start + (bytes + SMR_RED_ZONE + SMR_ALIGN - 1u) / SMR_ALIGN * SMR_ALIGN;
    if (a->base == NULL || a->used > a->capacity)
        return NULL;
    SMR_UNPOISON(a->base + start, bytes);
    SMR_POISON(a->base + start + bytes, a->used - start - bytes);
    return a->base + start;
}

void smr_arena_release(void *base, size_t capacity) { SMR_UNPOISON(base, capacity); }
