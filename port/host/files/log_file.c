/* log_file.c: reads and writes log files. A line of readable text precedes each section; a checksum covers all of them.
 * SPDX-License-Identifier: MIT */
#define _POSIX_C_SOURCE 200809L

#include "files/log_file.h"
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include "files/file_read.h"

#define MAGIC "smr-run 1 "
#define LINE_MAX_BYTES 96u

/* Mixes by the finaliser of splitmix64 (Steele, Lea, Flood 2014). */
uint64_t host_log_checksum(uint64_t sum, const unsigned char *bytes, size_t n)
{
    for (size_t i = 0; i < n; i += 8) {
        uint64_t word = 0;
        for (size_t k = 0; k < 8 && i + k < n; k++)
            word |= (uint64_t)bytes[i + k] << (8u * k);
        sum = sum * UINT64_C(0x9e3779b97f4a7c15) + word + 1u;
        sum = (sum ^ (sum >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
        sum = (sum ^ (sum >> 27)) * UINT64_C(0x94d049bb133111eb);
        sum ^= sum >> 31;
    }
    return sum;
}

#define WANTED "a readable file, as it was when recorded (%s)"

static void measure_block(void *context, const unsigned char *block, size_t n)
{
    host_log_input *const input = context;
    input->checksum = host_log_checksum(input->checksum, block, n);
    input->bytes += n;
}

int host_log_measure(const char *path, host_log_input *input, host_error *error)
{
    const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    struct stat st;
    int result = 0;
    *input = (host_log_input){path, 0, 0};
    if (fd < 0)
        return host_fail_of(error, path, "file", WANTED, strerror(errno));
    error->file = path;
    if (fstat(fd, &st) != 0)
        result = host_fail(error, "file", WANTED, strerror(errno));
    else if (!S_ISREG(st.st_mode))
        result = host_fail(error, "file", "a regular file");
    else
        result = host_file_blocks(fd, measure_block, input, error);
    (void)close(fd);
    return result;
}

static void put_piece(host_buffer *out, const void *bytes, size_t n)
{
    host_buffer_add(out, bytes, n);
    host_buffer_add(out, "\n", 1);
}

void host_log_write(const host_log *log, host_buffer *out)
{
    host_buffer body = {0};
    for (uint32_t i = 0; i < log->n_arguments; i++) {
        host_buffer_print(&body, "argument %zu\n", strlen(log->argument[i]));
        put_piece(&body, log->argument[i], strlen(log->argument[i]));
    }
    for (uint32_t i = 0; i < log->n_inputs; i++) {
        const host_log_input *const in = &log->input[i];
        host_buffer_print(&body, "input %zu %" PRIu64 " %016" PRIx64 "\n", strlen(in->path), in->bytes, in->checksum);
        put_piece(&body, in->path, strlen(in->path));
    }
    host_buffer_print(&body, "log %zu\n", log->log_bytes);
    put_piece(&body, log->log, log->log_bytes);
    host_buffer_print(out, MAGIC "%zu %016" PRIx64 "\n", body.size, host_log_checksum(0, body.data, body.size));
    host_buffer_add(out, body.data, body.size);
    out->failed |= body.failed;
    host_buffer_free(&body);
}

/* The reading position. */
typedef struct reader {
    unsigned char *data;
    size_t at, size;
    host_error *error;
} reader;

static int damaged(reader *r, const char *expected) { return host_fail_at(r->error, "byte", r->at, "%s", expected); }

/* Reads the next line and replaces its end by a NUL; NULL when there is no line end within LINE_MAX_BYTES. */
static const char *next_line(reader *r)
{
    char *const start = (char *)r->data + r->at;
    const size_t left = r->size - r->at;
    char *const end = memchr(start, '\n', left < LINE_MAX_BYTES ? left : LINE_MAX_BYTES);
    if (end == NULL || memchr(start, '\0', (size_t)(end - start)) != NULL)
        return NULL;
    *end = '\0';
    r->at += (size_t)(end - start) + 1u;
    return start;
}

/* Reads a number that `stop` follows. Digits only: strtoull would accept a sign. */
static const char *number(const char *text, int base, char stop, uint64_t *value)
{
    char *end = NULL;
    const char *const digits = base == 16 ? "0123456789abcdef" : "0123456789";
    if (text == NULL || text[0] == '\0' || strspn(text, digits) > 19u || strchr(digits, text[0]) == NULL)
        return NULL;
    *value = strtoull(text, &end, base);
    return *end == stop && end == text + strspn(text, digits) ? end + (stop != '\0') : NULL;
}

/* Reads n bytes and a line end, which becomes a NUL. */
static unsigned char *next_piece(reader *r, uint64_t n)
{
    unsigned char *const piece = r->data + r->at;
    if (n >= r->size - r->at || piece[n] != '\n')
        return NULL;
    piece[n] = '\0';
    r->at += (size_t)n + 1u;
    return piece;
}

static int read_argument(reader *r, const char *line, host_log *log)
{
    uint64_t n = 0;
    char *const text = number(line, 10, '\0', &n) != NULL ? (char *)next_piece(r, n) : NULL;
    if (text == NULL || strlen(text) != n || log->n_arguments == HOST_LOG_ARGUMENTS_MAX)
        return damaged(r, "an argument of the length before it");
    log->argument[log->n_arguments++] = text;
    return 0;
}

static int read_input(reader *r, const char *line, host_log *log)
{
    uint64_t n = 0;
    host_log_input input = {NULL, 0, 0};
    line = number(line, 10, ' ', &n);
    line = number(line, 10, ' ', &input.bytes);
    line = number(line, 16, '\0', &input.checksum);
    input.path = line != NULL ? (const char *)next_piece(r, n) : NULL;
    if (input.path == NULL || strlen(input.path) != n || n == 0 || log->n_inputs == HOST_LOG_INPUTS_MAX)
        return damaged(r, "a file's length of name, size and checksum, and its name");
    log->input[log->n_inputs++] = input;
    return 0;
}

static int read_pieces(reader *r, host_log *log)
{
    while (r->at < r->size) {
        const char *const line = next_line(r);
        uint64_t n = 0;
        int result = 0;
        if (line != NULL && strncmp(line, "argument ", 9) == 0) {
            result = read_argument(r, line + 9, log);
        } else if (line != NULL && strncmp(line, "input ", 6) == 0) {
            result = read_input(r, line + 6, log);
        } else if (line != NULL && strncmp(line, "log ", 4) == 0 && number(line + 4, 10, '\0', &n) != NULL) {
            log->log = next_piece(r, n);
            log->log_bytes = (size_t)n;
            return log->log != NULL && r->at == r->size ? 0 : damaged(r, "the end of the file behind the log");
        } else {
            result = damaged(r, "an argument, an input or the log");
        }
        if (result != 0)
            return -1;
    }
    return damaged(r, "a log");
}

static int read_all(reader *r, host_log *log)
{
    uint64_t size = 0, checksum = 0;
    const char *line = next_line(r);
    line = line != NULL && strncmp(line, MAGIC, strlen(MAGIC)) == 0 ? line + strlen(MAGIC) : NULL;
    line = number(line, 10, ' ', &size);
    if (number(line, 16, '\0', &checksum) == NULL)
        return host_fail(r->error, "line 1", "the log of a registration made by smr register --log");
    if (size != r->size - r->at)
        return damaged(r, "as many bytes as the first line says");
    if (host_log_checksum(0, r->data + r->at, (size_t)size) != checksum)
        return damaged(r, "bytes that give the checksum of the first line");
    log->argument = calloc(HOST_LOG_ARGUMENTS_MAX + 2u, sizeof *log->argument);
    log->input = calloc(HOST_LOG_INPUTS_MAX, sizeof *log->input);
    if (log->argument == NULL || log->input == NULL)
        return host_fail(r->error, "file", "free memory");
    return read_pieces(r, log);
}

static int accept_log(const host_head *head, host_error *error)
{
    if (head->n < strlen(MAGIC) || memcmp(head->data, MAGIC, strlen(MAGIC)) != 0)
        return host_fail(error, "line 1", "the log of a registration made by smr register --log");
    return 0;
}

int host_log_read(const char *path, host_log *log, host_error *error)
{
    host_bytes bytes;
    memset(log, 0, sizeof *log);
    if (host_file_read(path, accept_log, &bytes, error) != 0)
        return -1;
    log->memory = bytes.data;
    reader r = {bytes.data, 0, bytes.size, error};
    if (read_all(&r, log) == 0)
        return 0;
    host_log_free(log);
    return -1;
}

void host_log_free(host_log *log)
{
    free(log->argument);
    free(log->input);
    free(log->memory);
    memset(log, 0, sizeof *log);
}
