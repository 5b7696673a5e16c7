/* restore.c: restores a registration from saved bytes, all of which are checked before anything is written.
 * Bounds: two passes over the bytes; the bounds of smr_init().
 * SPDX-License-Identifier: MIT */
#include "registration/tick/iteration_steps.h"
#include "options/references/references.h"
#include "registration/api/start.h"
#include "registration/config/config.h"

#define SMR_RESTORE_PIECE 4096u /* bytes in a task that compares sums */

static uint32_t word_of(const unsigned char *saved, uint32_t word) { return smr_log_get32(saved + 4u * word); }

/* Returns the number of bytes of a save with its checksum; 0 when lengths disagree. */
static size_t length_of(const unsigned char *saved, size_t bytes)
{
    if (bytes < SMR_SAVED_FIXED + 4u || word_of(saved, SMR_SAVED_AT_MAGIC) != SMR_SAVED_MAGIC ||
        word_of(saved, SMR_SAVED_AT_VERSION) != SMR_SAVED_VERSION)
        return 0;
    const size_t all = word_of(saved, SMR_SAVED_AT_BYTES), n_config = word_of(saved, SMR_SAVED_AT_CONFIG_WORDS);
    const int fits = all <= bytes && all >= SMR_SAVED_FIXED + 4u && n_config <= (all - SMR_SAVED_FIXED - 4u) / 4u;
    return fits ? all : 0u;
}

/* Returns the number of bytes before the saved values of a save that length_of() accepts. */
static size_t values_at(const unsigned char *saved)
{
    return SMR_SAVED_FIXED + 4u * (size_t)word_of(saved, SMR_SAVED_AT_CONFIG_WORDS);
}

/* Reads the facts of a save whose bytes are not damaged. Errors: E_SAVE. */
static smr_status read_info(const unsigned char *from, smr_saved_info *info)
{
    smr_config config;
    if (smr_log_get_config(from + SMR_SAVED_FIXED, word_of(from, SMR_SAVED_AT_CONFIG_WORDS), SMR_LOG_VERSION,
                           &config) != SMR_OK)
        return SMR_E_SAVE;
    info->bytes = word_of(from, SMR_SAVED_AT_BYTES);
    info->library = word_of(from, SMR_SAVED_AT_LIBRARY);
    info->model_checksum = word_of(from, SMR_SAVED_AT_MODEL);
    info->n_vertices = word_of(from, SMR_SAVED_AT_VERTICES);
    info->config = config;
    return SMR_OK;
}

smr_status smr_save_info(const void *saved, size_t saved_bytes, smr_saved_info *info)
{
    if (saved == NULL || info == NULL)
        return SMR_E_NULL;
    const size_t all = length_of(saved, saved_bytes);
    const unsigned char *from = saved;
    if (all == 0u || smr_log_get32(from + all - 4u) != smr_crc32(0, from, all - 4u))
        return SMR_E_SAVE;
    return read_info(from, info);
}

typedef struct restoring {
    smr_initing init;
    const unsigned char *from;
    size_t bytes, at;       /* bytes of the save without its checksum; bytes done in the present stage */
    uint32_t crc, whole;    /* CRC-32 of the bytes done; 1: all values at once */
    const smr_model *model; /* arguments of the call */
    uint32_t has_config, has_port;
    smr_config config;
    smr_port port;
    void *arena;
    size_t arena_bytes;
    smr **out;
    smr_image_summing image;
} restoring;

_Static_assert(sizeof(restoring) <= SMR_JOB_BYTES, "a restore in progress lies in the caller's job");

/* Checks or restores the fields of structs and a piece of the slots. Sets *over to 1 when no piece is left. Returns 1
 * when all values are in range and no byte is left over. */
static int go_over(restoring *j, smr *s, uint32_t mode, int *over)
{
    const size_t all = j->bytes, last = smr_keep_end(j->at, all, j->whole);
    smr_keeper k = {
        .mode = mode, .from = j->from, .at = values_at(j->from), .bytes = all, .first = j->at, .last = last};
    smr_go_over(s, &k);
    const int planned = j->at > 0u || k.plan == word_of(j->from, SMR_SAVED_AT_PLAN);
    j->at = last;
    *over = last == all;
    return !k.wrong && k.at == k.bytes && planned;
}

/* Checks the model, and that the configuration differs in n_workers at most. */
static smr_status check(const smr_model *model, const smr_config *config, const smr_saved_info *info)
{
    size_t bytes;
    if (info->model_checksum != smr_le32(model->checksum) || info->n_vertices != smr_le32(model->n_vertices))
        return SMR_E_MODEL;
    smr_config as_saved = info->config, asked = *config;
    smr_config_settle(&asked);
    as_saved.basic.n_workers = config->basic.n_workers;
    if (smr_config_left_out(&as_saved) || (!SMR_HAS_REFERENCES && smr_model_references(model) != NULL))
        return SMR_E_WITHOUT;
    if (memcmp(&as_saved, &asked, sizeof as_saved) != 0)
        return SMR_E_CONFIG;
    return smr_arena_bytes(model, config, &bytes);
}

static smr *made(const void *job) { return ((const smr_starting *)job)->job.s; }

static void end_with(void *job, smr_status status) { ((smr_job_head *)job)->status = status; }

/* Compares the CRC-32 of the save, and then reads the configuration. */
static void check_bytes(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    restoring *j = job;
    const size_t left = j->bytes - j->at, n = left < SMR_RESTORE_PIECE ? left : SMR_RESTORE_PIECE;
    smr_saved_info info;
    j->crc = smr_crc32(j->crc, j->from + j->at, n);
    j->at += n;
    if (n < left) {
        smr_job_again(job);
        return;
    }
    smr_status status = smr_log_get32(j->from + j->at) == j->crc ? read_info(j->from, &info) : SMR_E_SAVE;
    if (status == SMR_OK && !j->has_config)
        j->config = info.config;
    if (status == SMR_OK)
        status = check(j->model, &j->config, &info);
    if (status != SMR_OK)
        end_with(j, status);
    j->at = 0;
}

static void restore_values(void *job, uint32_t task, uint32_t worker);

/* Checks the values, on a registration without arrays; then goes on with smr_init(). */
static void check_values(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    restoring *j = job;
    smr s;
    int over;
    smr_count(&s, j->model, &j->config);
    if (!smr_can_wait(&s.shared) || !go_over(j, &s, SMR_KEEP_CHECK, &over)) {
        /* a save of a build with more capabilities holds more values */
        end_with(j, smr_built_without()[0] == 0 ? SMR_E_SAVE : SMR_E_WITHOUT);
        return;
    }
    if (!over) {
        smr_job_again(job);
        return;
    }
    j->at = 0;
    const smr_status status = smr_init_check(&j->init, j->model, &s.shared.config, j->has_port ? &j->port : NULL,
                                             j->arena, j->arena_bytes, j->out);
    j->init.then = restore_values;
    if (status != SMR_OK)
        end_with(j, status);
}

static uint32_t image_tasks(const void *job) { return (uint32_t)smr_image_on(&made(job)->forces.image); }

static void find_noise(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    if (SMR_HAS_IMAGE && !smr_image_goals_sum(&made(job)->forces.image, &((restoring *)job)->image))
        smr_job_again(job);
}

static uint32_t rest_tasks(const void *job)
{
    return SMR_HAS_HELD && made(job)->shape.track_rest != NULL ? smr_start_vertices(job) : 0u;
}

static void find_rest_box(void *job, uint32_t task, SMR_UNUSED uint32_t worker)
{
    smr_start_add_to_box(job, task, made(job)->shape.track_rest_x);
    if (SMR_HAS_HELD)
        made(job)->shape.track_rest->box = ((smr_starting *)job)->box;
}

/* Ends the restore. The next iteration recomputes the reference. */
static void finish_restore(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    const restoring *j = job;
    smr *s = made(job);
    s->reference.missing = 1;
    smr_guard_close(s);
    *j->out = s;
}

/* Stages that compute what follows from the saved values. */
static const smr_stage stages_behind[] = {
    {NULL, restore_values, NULL, NULL}, /* comes back for each piece */
    {smr_start_vertices, smr_start_box, smr_in_order, NULL},
    {image_tasks, find_noise, NULL, NULL}, /* likewise */
    {smr_start_leaves, smr_start_refit_leaves, smr_in_order, NULL},
    {smr_start_uppers, smr_start_refit_uppers, smr_in_order, NULL},
    {smr_start_in_parts, smr_start_find_parts, NULL, NULL}, /* likewise */
    {rest_tasks, find_rest_box, smr_in_order, NULL},
    {smr_start_fits, smr_start_scale_fit, smr_in_order, NULL},
    {smr_start_weights, smr_start_add_weights, smr_in_order, NULL},
    {smr_start_weights, smr_start_set_weights, smr_in_order, NULL},
    {NULL, finish_restore, NULL, NULL},
};

/* Goes on behind smr_init(), with the values of the save. */
static void restore_values(void *job, SMR_UNUSED uint32_t task, SMR_UNUSED uint32_t worker)
{
    restoring *j = job;
    int over;
    if (j->init.then != NULL)
        smr_job_go(job, stages_behind, sizeof stages_behind / sizeof stages_behind[0]);
    else if (go_over(j, made(job), SMR_KEEP_RESTORE, &over), !over)
        smr_job_again(job);
    j->init.then = NULL;
    j->init.start.k = j->init.start.at = 0;
    made(job)->await = smr_await;
}

static const smr_stage stages_before[] = {
    {NULL, check_bytes, NULL, NULL}, /* both come back for each piece */
    {NULL, check_values, NULL, NULL},
};

smr_status smr_restore_begin(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                             size_t saved_bytes, void *arena, size_t bytes, smr **s, smr_job *job)
{
    restoring *const j = (restoring *)(void *)job;
    if (model == NULL || saved == NULL || s == NULL || job == NULL)
        return SMR_E_NULL;
    const size_t all = length_of(saved, saved_bytes);
    if (all == 0u)
        return SMR_E_SAVE;
    memset(j, 0, sizeof *j);
    j->from = saved;
    j->bytes = all - 4u;
    j->model = model;
    j->has_config = config != NULL;
    if (config != NULL)
        j->config = *config;
    j->has_port = port != NULL;
    if (port != NULL)
        j->port = *port;
    j->arena = arena;
    j->arena_bytes = bytes;
    j->out = s;
    j->init.start.job.head = smr_job_begin(stages_before, sizeof stages_before / sizeof stages_before[0], port);
    return SMR_OK;
}

static void restore_whole(smr_job *job) { ((restoring *)(void *)job)->whole = 1; }

smr_status smr_restore(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                       size_t saved_bytes, void *arena, size_t bytes, smr **s)
{
    smr_job job;
    SMR_TRY(smr_restore_begin(model, config, port, saved, saved_bytes, arena, bytes, s, &job));
    restore_whole(&job);
    return smr_job_step(&job, 0, &smr_alone, 0);
}

smr_status smr_get_awaited(const smr *s, uint32_t *n)
{
    SMR_TRY(smr_readable(s, 0, n));
    *n = s->n_awaited;
    return SMR_OK;
}
