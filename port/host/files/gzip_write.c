/* gzip_write.c: packs bytes by deflate with its fixed codes: RFC 1951, 1952. Each place is compared with the last one
 * that started with the same four bytes.
 * SPDX-License-Identifier: MIT */
#include "files/gzip_write.h"
#include <stdlib.h>

void host_crc32_start(host_crc32 *crc)
{
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t left = i;
        for (uint32_t k = 0; k < 8; k++)
            left = left >> 1 ^ ((left & 1u) != 0 ? 0xedb88320u : 0u);
        crc->table[0][i] = left;
    }
    for (uint32_t k = 1; k < 8; k++)
        for (uint32_t i = 0; i < 256; i++)
            crc->table[k][i] = crc->table[k - 1u][i] >> 8 ^ crc->table[0][crc->table[k - 1u][i] & 0xffu];
    crc->state = 0xffffffffu;
}

void host_crc32_add(host_crc32 *crc, const void *data, size_t n)
{
    const unsigned char *p = data;
    uint32_t(*const t)[256] = crc->table;
    uint32_t s = crc->state;
    for (; n >= 8u; n -= 8u, p += 8) {
        s ^= (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
        s = t[7][s & 0xffu] ^ t[6][s >> 8 & 0xffu] ^ t[5][s >> 16 & 0xffu] ^ t[4][s >> 24] ^ t[3][p[4]] ^ t[2][p[5]] ^
            t[1][p[6]] ^ t[0][p[7]];
    }
    for (; n > 0u; n--, p++)
        s = s >> 8 ^ t[0][(s ^ *p) & 0xffu];
    crc->state = s;
}

uint32_t host_crc32_end(const host_crc32 *crc) { return ~crc->state; }

#define WINDOW 32768u
#define MATCH_LEAST 4u
#define MATCH_MOST 258u
#define HASH_BITS 15u
#define END_CODE 256u

/* The numbers that a code stands for: base to base + 2^bits - 1. */
typedef struct span {
    uint16_t base;
    uint8_t bits;
} span;

static const span lengths[29] = {{3, 0},   {4, 0},   {5, 0},   {6, 0},   {7, 0},  {8, 0},  {9, 0},  {10, 0},
                                 {11, 1},  {13, 1},  {15, 1},  {17, 1},  {19, 2}, {23, 2}, {27, 2}, {31, 2},
                                 {35, 3},  {43, 3},  {51, 3},  {59, 3},  {67, 4}, {83, 4}, {99, 4}, {115, 4},
                                 {131, 5}, {163, 5}, {195, 5}, {227, 5}, {258, 0}};
static const span distances[30] = {{1, 0},     {2, 0},     {3, 0},     {4, 0},      {5, 1},      {7, 1},
                                   {9, 2},     {13, 2},    {17, 3},    {25, 3},     {33, 4},     {49, 4},
                                   {65, 5},    {97, 5},    {129, 6},   {193, 6},    {257, 7},    {385, 7},
                                   {513, 8},   {769, 8},   {1025, 9},  {1537, 9},   {2049, 10},  {3073, 10},
                                   {4097, 11}, {6145, 11}, {8193, 12}, {12289, 12}, {16385, 13}, {24577, 13}};

typedef struct packer {
    host_buffer *out;
    uint64_t bits; /* that wait, the first one lowest */
    unsigned n;
} packer;

static void put_bits(packer *p, uint32_t value, unsigned n)
{
    p->bits |= (uint64_t)value << p->n;
    for (p->n += n; p->n >= 8u; p->n -= 8u) {
        const unsigned char byte = (unsigned char)p->bits;
        host_buffer_add(p->out, &byte, 1);
        p->bits >>= 8;
    }
}

uint32_t host_crc32_of(const void *data, size_t n)
{
    host_crc32 crc;
    host_crc32_start(&crc);
    host_crc32_add(&crc, data, n);
    return host_crc32_end(&crc);
}

/* A code, whose highest bit comes first. */
static void put_code(packer *p, uint32_t code, unsigned n)
{
    uint32_t turned = 0;
    for (unsigned i = 0; i < n; i++)
        turned |= (code >> i & 1u) << (n - 1u - i);
    put_bits(p, turned, n);
}

/* A byte, the end, or the code of a length. */
static void put_symbol(packer *p, unsigned symbol)
{
    if (symbol < 144u)
        put_code(p, 0x30u + symbol, 8);
    else if (symbol < 256u)
        put_code(p, 0x190u + symbol - 144u, 9);
    else if (symbol < 280u)
        put_code(p, symbol - 256u, 7);
    else
        put_code(p, 0xc0u + symbol - 280u, 8);
}

static unsigned find_span(const span *spans, unsigned n, size_t value)
{
    while (n > 1u && spans[n - 1u].base > value)
        n--;
    return n - 1u;
}

static void put_match(packer *p, size_t length, size_t distance)
{
    const unsigned l = find_span(lengths, 29, length), d = find_span(distances, 30, distance);
    put_symbol(p, 257u + l);
    put_bits(p, (uint32_t)(length - lengths[l].base), lengths[l].bits);
    put_code(p, d, 5);
    put_bits(p, (uint32_t)(distance - distances[d].base), distances[d].bits);
}

static uint32_t hash_of(const unsigned char *at)
{
    const uint32_t value = (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    return value * 2654435761u >> (32u - HASH_BITS);
}

static size_t match_length(const unsigned char *data, size_t n, size_t from, size_t at)
{
    const size_t most = n - at < MATCH_MOST ? n - at : MATCH_MOST;
    size_t k = 0;
    while (k < most && data[from + k] == data[at + k])
        k++;
    return k;
}

/* last: room, [2^HASH_BITS] places plus 1. */
static void put_data(packer *p, const unsigned char *data, size_t n, size_t *last)
{
    size_t i = 0;
    while (i < n && !p->out->failed) {
        size_t length = 0, from = 0;
        if (n - i >= MATCH_LEAST) {
            size_t *const slot = &last[hash_of(data + i)];
            from = *slot;
            *slot = i + 1u;
            if (from > 0 && i - (from - 1u) <= WINDOW)
                length = match_length(data, n, from - 1u, i);
        }
        if (length >= MATCH_LEAST) {
            put_match(p, length, i - (from - 1u));
            i += length;
        } else {
            put_symbol(p, data[i++]);
        }
    }
}

void host_gzip_write(const unsigned char *data, size_t n, host_buffer *out)
{
    static const unsigned char head[10] = {0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 255};
    size_t *const last = calloc((size_t)1 << HASH_BITS, sizeof *last);
    host_crc32 *const crc = malloc(sizeof *crc);
    packer p = {out, 0, 0};
    if (last == NULL || crc == NULL) {
        out->failed = 1;
    } else {
        host_crc32_start(crc);
        host_crc32_add(crc, data, n);
        host_buffer_add(out, head, sizeof head);
        put_bits(&p, 3, 3); /* the last block, of fixed codes */
        put_data(&p, data, n, last);
        put_symbol(&p, END_CODE);
        put_bits(&p, 0, 7); /* to the end of the byte */
        host_buffer_u32(out, host_crc32_end(crc));
        host_buffer_u32(out, (uint32_t)n);
    }
    free(last);
    free(crc);
}
