/* bytes.h: little-endian numbers as models and logs store them, bits of floats, hashes and checksums.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_BYTES_H
#define SMR_BYTES_H

#include "base/base.h"

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
#define SMR_BIG_ENDIAN 1 /* the host stores the most significant byte of a number first */
#else
#define SMR_BIG_ENDIAN 0 /* the host stores the least significant byte of a number first */
#endif

/* Convert a host number to little-endian and back: swap the bytes on big-endian hosts, return v unchanged on others. */
static inline uint16_t smr_le16(uint16_t v) { return SMR_BIG_ENDIAN ? (uint16_t)(v << 8 | v >> 8) : v; }

static inline uint32_t smr_le32(uint32_t v)
{
    return SMR_BIG_ENDIAN ? (v << 24 | (v << 8 & 0xff0000u) | (v >> 8 & 0xff00u) | v >> 24) : v;
}

/* Returns the float with these bits, in host byte order. */
static inline float smr_float_of(uint32_t bits)
{
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* Returns the float whose bits are stored little-endian. */
static inline float smr_le_float(uint32_t stored) { return smr_float_of(smr_le32(stored)); }

/* Returns the bits of v, in host byte order. */
static inline uint32_t smr_float_bits(float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

/* Returns the signed number that a wrapped 32-bit word represents. */
static inline int32_t smr_signed(uint32_t word)
{
    int32_t value;
    memcpy(&value, &word, sizeof value);
    return value;
}

/* Returns a 64-bit hash of z: the finaliser of splitmix64 (Steele, Lea, Flood 2014). */
static inline uint64_t smr_mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Returns the CRC-32 (IEEE 802.3, reflected) of the n bytes at data. crc: CRC-32 of the bytes before them, or 0. */
uint32_t smr_crc32(uint32_t crc, const void *data, size_t n);
/* Returns this host's checksum of n bytes behind bytes with the checksum `sum`. A change of a word changes the sum. */
uint32_t smr_byte_sum(uint32_t sum, const void *data, size_t n);

#endif
