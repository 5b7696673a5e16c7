/* log_format.h: the log of a registration: the bytes of records, and functions that write them.
 * SPDX-License-Identifier: MIT */
#ifndef SMR_LOG_FORMAT_H
#define SMR_LOG_FORMAT_H

#include "base/settings.h"
#include "geometry/surface/surface.h"
#include "registration/shape/schedule_state.h"

#define SMR_LOG_MAGIC 0x4c524d53u /* first word of a log: the letters "SMRL" */
#define SMR_LOG_VERSION 3u        /* version of the logs that this library writes */
#define SMR_LOG_FIXED 28u         /* bytes of a log's header before the configuration */
#define SMR_LOG_FRAME 8u          /* bytes of a record besides its content: head and checksum, a word each */
#define SMR_LOG_WORDS 12u         /* 32-bit words of the largest content of a record */

/* Words of the configuration: for each setting a head and its value. budget_exact, reference_prior and strain_most are
 * written only where they differ from the default: other logs and saves are as they were before these settings. */
enum {
    SMR_LOG_PRIOR = 54,  /* number of the setting reference_prior in logs */
    SMR_LOG_EXACT = 77,  /* number of the setting budget_exact in logs */
    SMR_LOG_SETTLE = 68, /* number of the setting settle_share in logs */
    SMR_LOG_STRAIN = 78, /* number of the setting strain_most in logs */
    SMR_LOG_LATE_WORDS = 2,
    SMR_LOG_CONFIG_WORDS = -3 * SMR_LOG_LATE_WORDS
#define SMR_GROUP(title)
#define SMR_SETTING(kind, number, path, ...) +((number) > 0 ? 1 + (int)(sizeof(((smr_config *)NULL)->path) / 4u) : 0)
#include "base/settings_config.def"
};

#define SMR_LOG_HEADER (SMR_LOG_FIXED + 4u * SMR_LOG_CONFIG_WORDS + 4u) /* bytes of a header with defaults */
#define SMR_LOG_FULL_BYTES (SMR_LOG_FRAME + 4u)                         /* bytes that stay free until recording ends */

static inline int smr_log_has_prior(const smr_config *c) { return c->references.prior != SMR_PRIOR; }
static inline int smr_log_has_strain(const smr_config *c) { return c->motion.strain_most != SMR_STRAIN; }

/* Returns the number of 32-bit words that this configuration takes in a log or a save. */
static inline uint32_t smr_log_config_words(const smr_config *config)
{
    const uint32_t n_late =
        (config->basic.budget_exact != 0u) + (uint32_t)smr_log_has_prior(config) + (uint32_t)smr_log_has_strain(config);
    return (uint32_t)SMR_LOG_CONFIG_WORDS + n_late * (uint32_t)SMR_LOG_LATE_WORDS;
}

uint32_t smr_log_words(uint32_t kind); /* returns the number of words of a record's content; 0: unknown kind */

static inline void smr_log_put32(unsigned char *to, uint32_t v)
{
    v = smr_le32(v);
    memcpy(to, &v, sizeof v);
}

static inline uint32_t smr_log_get32(const unsigned char *from)
{
    return (uint32_t)from[0] | (uint32_t)from[1] << 8 | (uint32_t)from[2] << 16 | (uint32_t)from[3] << 24;
}

typedef struct smr_log smr_log;

/* Type of smr_log_write(), which records a succeeded call; a program that sets no log does not link that function. */
typedef void smr_log_writer(smr_log *log, uint32_t kind, uint32_t number, const void *what, uint32_t n);

/* State of a registration's recording into a log. */
struct smr_log {
    unsigned char *memory; /* [bytes] the caller's memory; NULL: no recording */
    smr_log_writer *write; /* the function smr_log_write; NULL: no recording */
    size_t bytes, used;    /* size of the memory; bytes written so far */
    uint32_t crc, n_ticks; /* CRC-32 of the log up to its last record; number of ticks recorded */
    uint32_t full;         /* 1: a record did not fit, and nothing more is recorded */
    uint32_t fresh;        /* 1: the registration has not changed since smr_init() */
    uint32_t changes;      /* number of ticks, and of calls that changed an input */
};

/* Write the configuration, smr_log_config_words() words, and read n_words words of a log of this version. Errors: E_LOG
 * (other version, unknown or repeated setting, wrong length). Values are not checked. */
void smr_log_put_config(unsigned char *to, const smr_config *config);
smr_status smr_log_get_config(const unsigned char *from, uint32_t n_words, uint32_t version, smr_config *config);
/* Return checksums of the numbers of an input, not of their bytes in memory: equal on all processors, and never 0. */
uint64_t smr_points_checksum(const float *xyz, uint32_t n);
uint64_t smr_goals_checksum(const smr_goals *goals, uint32_t n);
uint64_t smr_motion_checksum(const smr_motion *motion, uint32_t n);
uint64_t smr_target_checksum(
    const smr_surface *surface); /* returns the checksum of a mesh, or of a cloud's points and capacity */
uint64_t smr_volume_checksum(const smr_volume *volume);
static inline uint64_t smr_surface_checksum(const smr_surface *surface) { return smr_target_checksum(surface); }
/* A checksum in the making, for inputs that are summed in pieces. */
typedef struct smr_input_part {
    uint32_t kind;  /* what an item is */
    const void *at; /* the items */
    uint64_t n;     /* number of items */
} smr_input_part;
typedef struct smr_input_sum {
    uint64_t sum, at;          /* checksum of the items so far; number of items of the current part that it contains */
    uint32_t at_part, n_parts; /* current part; number of parts */
    smr_input_part part[8];
} smr_input_sum;
smr_input_sum smr_sum_of_target(const smr_surface *surface);
smr_input_sum smr_sum_of_goals(const smr_goals *goals, uint32_t n);
smr_input_sum smr_sum_of_volume(const smr_volume *volume);
/* Adds at most `most` items, four times as many voxels, or all (UINT32_MAX), of one part. Returns 1 at the end. */
int smr_sum_add(smr_input_sum *s, uint32_t most);

/* Returns the checksum of the input `what` of this kind, both as in smr_log_note(); 0 when the input is taken away. */
uint64_t smr_log_checksum(uint32_t kind, const void *what, uint32_t n);

void smr_log_write(smr_log *log, uint32_t kind, uint32_t number, const void *what, uint32_t n);
void smr_log_start(smr_log *log, const smr_shared *shared, void *memory, size_t bytes);
void smr_log_end(smr_log *log);

typedef struct smr_log_of_tick {
    const smr_tick_report *report;
    uint32_t complete;    /* 1: the tick completed an iteration, or the schedule was done already */
    uint32_t n_evaluated; /* vertices with computed forces in the iteration that the tick has completed or stopped in */
} smr_log_of_tick;

/* Records a call that has succeeded: kind is SMR_LOG_...
 *   SURFACE, POINTS, FIXED_SURFACE  number: structure or index   what: the surface or cloud, NULL
 *   POSITIONS, GOALS, MOTION        number: structure            what: xyz, smr_goals, smr_motion   n: vertices
 *   LANDMARKS                       what: [n] landmarks
 *   VOLUME, POSE                    what: the volume, NULL; the pose
 *   FORCE                           number: 0 taken away, 1 set, 2 called   what: checksum of its result (uint64_t)
 *   VOLUME_RATIO                    number: structure            what: the ratio (float)
 *   ACTIVE                          number: vertices
 *   TICK                            what: smr_log_of_tick */
static inline void smr_log_note(smr_log *log, uint32_t kind, uint32_t number, const void *what, uint32_t n)
{
    log->fresh = 0;
    log->changes++;
    if (log->write != NULL)
        log->write(log, kind, number, what, n);
}

#endif
