/* log_tool.c: changes log files of smr register --log and repairs their checksums, so that a replay finds the change
 * itself.
 *
 * log_tool taken IN OUT TICK DELTA   adds DELTA to the number of vertices that tick number TICK took
 * log_tool cut IN OUT TICKS          ends the library's log after this many ticks
 * log_tool seal IN OUT               repairs only the first line's checksum, for a body that was edited
 * SPDX-License-Identifier: MIT */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "files/log_file.h"

static unsigned char file[1u << 24];

static uint32_t get32(const unsigned char *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static void put32(unsigned char *p, uint32_t v)
{
    for (int i = 0; i < 4; i++)
        p[i] = (unsigned char)(v >> (8 * i) & 255u);
}

/* CRC-32 (IEEE 802.3), bit by bit: independent of the library's own. */
static uint32_t crc_of(uint32_t crc, const unsigned char *p, size_t n)
{
    crc = ~crc;
    for (size_t i = 0; i < n; i++) {
        crc ^= p[i];
        for (int bit = 0; bit < 8; bit++)
            crc = (crc >> 1) ^ (0xedb88320u & (0u - (crc & 1u)));
    }
    return ~crc;
}

/* The library's log is the last piece: its bytes end one before the file's end. */
static unsigned char *find_log(size_t size, size_t *bytes)
{
    for (size_t at = size; at > 4u; at--) {
        if (memcmp(file + at - 4u, "log ", 4) == 0 && (at == 4u || file[at - 5u] == '\n')) {
            char *end = NULL;
            *bytes = (size_t)strtoull((const char *)file + at, &end, 10);
            unsigned char *const log = (unsigned char *)end + 1;
            if ((size_t)(log - file) + *bytes + 1u == size)
                return log;
        }
    }
    return NULL;
}

/* Changes one tick or ends the log behind it, and seals the records again. Returns the log's bytes, or 0 when the
 * tick is not found. */
static size_t change(unsigned char *log, size_t bytes, int taken, uint32_t tick, uint32_t delta)
{
    const uint32_t header = get32(log + 8);
    uint32_t crc = get32(log + header - 4u), ticks = 0;
    for (size_t at = header; at + 8u <= bytes;) {
        const uint32_t size = get32(log + at) >> 8;
        ticks += (log[at] == 1u);
        if (taken && log[at] == 1u && ticks == tick)
            put32(log + at + 12u, get32(log + at + 12u) + delta);
        crc = crc_of(crc, log + at, size - 4u);
        put32(log + at + size - 4u, crc);
        at += size;
        if (!taken && ticks == tick)
            return at;
    }
    return ticks >= tick ? bytes : 0u;
}

static int write_sealed(const char *path, const unsigned char *body, size_t size, const unsigned char *log,
                        size_t log_bytes)
{
    static unsigned char out[1u << 24];
    FILE *const to = fopen(path, "wb");
    if (to == NULL)
        return 1;
    memcpy(out, body, size);
    size_t n = size;
    if (log != NULL) {
        n += (size_t)sprintf((char *)out + n, "log %zu\n", log_bytes);
        memcpy(out + n, log, log_bytes);
        n += log_bytes;
        out[n++] = '\n';
    }
    fprintf(to, "smr-run 1 %zu %016" PRIx64 "\n", n, host_log_checksum(0, out, n));
    return fwrite(out, 1, n, to) != n || fclose(to) != 0;
}

int main(int argc, char **argv)
{
    FILE *const from = argc >= 4 ? fopen(argv[2], "rb") : NULL;
    const size_t size = from != NULL ? fread(file, 1, sizeof file - 1u, from) : 0u;
    const unsigned char *const line = memchr(file, '\n', size);
    size_t bytes = 0;
    if (line == NULL || from == NULL || fclose(from) != 0)
        return 2;
    const unsigned char *const body = line + 1;
    if (strcmp(argv[1], "seal") == 0)
        return write_sealed(argv[3], body, size - (size_t)(body - file), NULL, 0);
    unsigned char *const log = find_log(size, &bytes);
    if (log == NULL || argc < 5)
        return 2;
    const int taken = strcmp(argv[1], "taken") == 0;
    const uint32_t delta = argc > 5 ? (uint32_t)strtol(argv[5], NULL, 10) : 0u;
    const size_t changed = change(log, bytes, taken, (uint32_t)strtoul(argv[4], NULL, 10), delta);
    char head[32];
    const size_t head_bytes = (size_t)sprintf(head, "log %zu\n", bytes);
    return changed == 0u ? 2 : write_sealed(argv[3], body, (size_t)(log - body) - head_bytes, log, changed);
}
