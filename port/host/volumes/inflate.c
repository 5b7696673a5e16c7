/* inflate.c: unpacks zlib and gzip streams inside volume files (MetaImage, NRRD). The gzip program unpacks whole files
 * only, and not zlib, whose checksum differs.
 *
 * Formats: RFC 1950 (zlib), RFC 1951 (deflate), RFC 1952 (gzip, one member).
 * SPDX-License-Identifier: MIT */
#include <stdlib.h>
#include <string.h>
#include "volumes/volume_reader.h"

#define CODE_BITS 15 /* bits of the longest Huffman code */

/* The codes of an alphabet: entry[next 15 bits] = symbol * 16 + length; length 0: no code. */
typedef struct code_table {
    uint16_t entry[1u << CODE_BITS];
} code_table;

typedef struct stream {
    const unsigned char *in;
    size_t n, at;
    uint64_t hold; /* bits read from `in` but not used yet; the lowest is the next */
    unsigned held;
    unsigned char *out;
    size_t out_n, done;
    code_table literal, distance;
} stream;

static void fill(stream *s)
{
    while (s->held <= 48u && s->at < s->n) {
        s->hold |= (uint64_t)s->in[s->at++] << s->held;
        s->held += 8u;
    }
}

/* Reads the next n bits, at most 16, as a number; -1 at the end of the data. */
static int take(stream *s, unsigned bits)
{
    fill(s);
    if (s->held < bits)
        return -1;
    int value = (int)(s->hold & ((1u << bits) - 1u));
    s->hold >>= bits;
    s->held -= bits;
    return value;
}

static int decode(stream *s, const code_table *table)
{
    fill(s);
    unsigned entry = table->entry[s->hold & ((1u << CODE_BITS) - 1u)];
    unsigned length = entry & 15u;
    if (length == 0 || length > s->held)
        return -1;
    s->hold >>= length;
    s->held -= length;
    return (int)(entry >> 4);
}

static unsigned reversed(unsigned code, unsigned bits)
{
    unsigned turned = 0;
    for (; bits > 0; bits--, code >>= 1)
        turned = (turned << 1) | (code & 1u);
    return turned;
}

/* Makes the canonical codes from their lengths; -1 when there are more codes than bit patterns. */
static int build(code_table *table, const unsigned char *lengths, unsigned n)
{
    unsigned count[CODE_BITS + 1] = {0}, next[CODE_BITS + 1] = {0};
    unsigned code = 0;
    memset(table, 0, sizeof *table);
    for (unsigned i = 0; i < n; i++)
        count[lengths[i]]++;
    count[0] = 0;
    for (unsigned bits = 1; bits <= CODE_BITS; bits++) {
        code = (code + count[bits - 1u]) << 1;
        next[bits] = code;
        if (code + count[bits] > 1u << bits)
            return -1;
    }
    for (unsigned i = 0; i < n; i++) {
        const unsigned length = lengths[i];
        if (length == 0)
            continue;
        for (unsigned at = reversed(next[length]++, length); at < 1u << CODE_BITS; at += 1u << length)
            table->entry[at] = (uint16_t)(i * 16u + length);
    }
    return 0;
}

static int read_stored(stream *s)
{
    (void)take(s, s->held & 7u); /* to the next whole byte: `hold` has the rest of a byte and whole bytes */
    int size = take(s, 16);
    int inverse = take(s, 16);
    if (size < 0 || inverse < 0 || (size ^ inverse) != 0xffff || (size_t)size > s->out_n - s->done)
        return -1;
    for (; size > 0; size--) {
        const int byte = take(s, 8);
        if (byte < 0)
            return -1;
        s->out[s->done++] = (unsigned char)byte;
    }
    return 0;
}

static int fixed_codes(stream *s)
{
    unsigned char lengths[288];
    memset(lengths, 8, 144);
    memset(lengths + 144, 9, 112);
    memset(lengths + 256, 7, 24);
    memset(lengths + 280, 8, 8);
    if (build(&s->literal, lengths, 288) != 0)
        return -1;
    memset(lengths, 5, 30);
    return build(&s->distance, lengths, 30);
}

/* Reads the code lengths of a dynamic block, which are coded with runs. */
static int read_lengths(stream *s, unsigned char *lengths, unsigned n)
{
    unsigned i = 0;
    while (i < n) {
        const int symbol = decode(s, &s->literal);
        int run = 1, value = symbol;
        if (symbol < 0 || (symbol == 16 && i == 0))
            return -1;
        if (symbol >= 16) {
            value = symbol == 16 ? lengths[i - 1u] : 0;
            run = take(s, symbol == 16 ? 2u : symbol == 17 ? 3u : 7u);
            if (run < 0)
                return -1;
            run += symbol == 18 ? 11 : 3;
        }
        if ((unsigned)run > n - i)
            return -1;
        memset(lengths + i, value, (size_t)run);
        i += (unsigned)run;
    }
    return 0;
}

static int dynamic_codes(stream *s)
{
    static const unsigned char order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    unsigned char lengths[320] = {0};
    const int literals = take(s, 5), distances = take(s, 5), codes = take(s, 4);
    if (literals < 0 || distances < 0 || codes < 0 || literals > 29 || distances > 29)
        return -1;
    for (int i = 0; i < codes + 4; i++) {
        const int length = take(s, 3);
        if (length < 0)
            return -1;
        lengths[order[i]] = (unsigned char)length;
    }
    if (build(&s->literal, lengths, 19) != 0)
        return -1;
    memset(lengths, 0, sizeof lengths);
    if (read_lengths(s, lengths, (unsigned)(literals + distances) + 258u) != 0)
        return -1;
    if (build(&s->literal, lengths, (unsigned)literals + 257u) != 0)
        return -1;
    return build(&s->distance, lengths + literals + 257, (unsigned)distances + 1u);
}

/* Copies bytes that were written before; source and destination may overlap. */
static int copy(stream *s, int symbol)
{
    static const uint16_t length_base[29] = {3,  4,  5,  6,  7,  8,  9,  10, 11,  13,  15,  17,  19,  23, 27,
                                             31, 35, 43, 51, 59, 67, 83, 99, 115, 131, 163, 195, 227, 258};
    static const uint16_t distance_base[30] = {1,    2,    3,    4,    5,    7,    9,    13,    17,    25,
                                               33,   49,   65,   97,   129,  193,  257,  385,   513,   769,
                                               1025, 1537, 2049, 3073, 4097, 6145, 8193, 12289, 16385, 24577};
    const int k = symbol - 257;
    if (k > 28)
        return -1;
    int extra = take(s, k < 8 || k == 28 ? 0u : (unsigned)(k - 4) / 4u);
    int far = decode(s, &s->distance);
    if (extra < 0 || far < 0 || far > 29)
        return -1;
    size_t length = length_base[k] + (size_t)extra;
    extra = take(s, far < 4 ? 0u : (unsigned)(far - 2) / 2u);
    if (extra < 0)
        return -1;
    size_t distance = distance_base[far] + (size_t)extra;
    if (distance > s->done || length > s->out_n - s->done)
        return -1;
    for (; length > 0; length--, s->done++)
        s->out[s->done] = s->out[s->done - distance];
    return 0;
}

static int read_coded(stream *s)
{
    for (;;) {
        const int symbol = decode(s, &s->literal);
        if (symbol < 0)
            return -1;
        if (symbol == 256)
            return 0;
        if (symbol > 256) {
            if (copy(s, symbol) != 0)
                return -1;
        } else {
            if (s->done == s->out_n)
                return -1;
            s->out[s->done++] = (unsigned char)symbol;
        }
    }
}

static int read_blocks(stream *s)
{
    int last = 0;
    while (last == 0) {
        int kind = 0, result = -1;
        last = take(s, 1);
        kind = take(s, 2);
        if (last < 0 || kind < 0 || kind > 2)
            return -1;
        if (kind == 0)
            result = read_stored(s);
        else if ((kind == 1 ? fixed_codes(s) : dynamic_codes(s)) == 0)
            result = read_coded(s);
        if (result != 0)
            return -1;
    }
    (void)take(s, s->held & 7u);
    return 0;
}

static uint32_t adler32(const unsigned char *data, size_t n)
{
    uint32_t a = 1, b = 0;
    for (size_t i = 0; i < n; i++) {
        a += data[i];
        b += a;
        if (i % 4096u == 4095u || i + 1u == n) { /* the sums of 4096 bytes fit 32 bits */
            a %= 65521u;
            b %= 65521u;
        }
    }
    return (b << 16) | a;
}

static uint32_t crc32(const unsigned char *data, size_t n)
{
    uint32_t table[256], crc = 0xffffffffu;
    for (size_t i = 0; i < 256; i++) {
        uint32_t c = (uint32_t)i;
        for (int bit = 0; bit < 8; bit++)
            c = (c >> 1) ^ ((c & 1u) != 0 ? 0xedb88320u : 0u);
        table[i] = c;
    }
    for (size_t i = 0; i < n; i++)
        crc = (crc >> 8) ^ table[(crc ^ data[i]) & 255u];
    return ~crc;
}

/* Bytes of the gzip header; 0 when it is invalid. */
static size_t header_bytes(const unsigned char *d, size_t n, int *gzip)
{
    size_t at = 10;
    *gzip = n >= 10u && d[0] == 0x1f && d[1] == 0x8b;
    if (!*gzip)
        return n >= 2u && (d[0] & 15u) == 8u && (d[0] * 256u + d[1]) % 31u == 0 && (d[1] & 32u) == 0 ? 2u : 0u;
    if (d[2] != 8u || (d[3] & 0xe0u) != 0)
        return 0;
    if ((d[3] & 4u) != 0) { /* an extra field, after its size */
        if (n < 12u)
            return 0;
        at += 2u + d[10] + 256u * (size_t)d[11];
    }
    for (int field = 8; field <= 16; field *= 2) /* a name and a comment, each up to a NUL */
        if ((d[3] & field) != 0) {
            while (at < n && d[at] != 0)
                at++;
            at++;
        }
    at += (d[3] & 2u) != 0 ? 2u : 0u; /* a checksum of the header */
    return at < n ? at : 0u;
}

static uint32_t take32(stream *s, int big_endian)
{
    uint32_t v = 0;
    for (int i = 0; i < 4; i++) {
        const int byte = take(s, 8);
        v |= (uint32_t)(byte < 0 ? 0 : byte) << (8 * (big_endian ? 3 - i : i));
    }
    return v;
}

const char *host_inflate(const unsigned char *data, size_t n, unsigned char *out, size_t out_n)
{
    int gzip = 0;
    const size_t head = header_bytes(data, n, &gzip);
    const char *expected = NULL;
    if (head == 0)
        return "a zlib or gzip stream";
    stream *s = calloc(1, sizeof *s);
    if (s == NULL)
        return "free memory for unpacking";
    s->in = data + head;
    s->n = n - head;
    s->out = out;
    s->out_n = out_n;
    if (read_blocks(s) != 0)
        expected = s->done == out_n ? "packed data of the header's size, found more or damaged data"
                                    : "a whole packed stream, found it damaged or cut off";
    else if (s->done != out_n)
        expected = "packed data of the header's size, found less";
    else if (gzip ? take32(s, 0) != crc32(out, out_n) : take32(s, 1) != adler32(out, out_n))
        expected = "packed data that agrees with its checksum";
    free(s);
    return expected;
}
