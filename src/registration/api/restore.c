/* restore.c: restores a registration from saved bytes, all of which are checked before anything is written.
 * Bounds: two passes over the bytes; the bounds of smr_init().
 * SPDX-License-Identifier: MIT */
#include "options/references/references.h"
#include "registration/api/setup.h"
#include "registration/config/config.h"

static uint32_t word_of(const unsigned char *saved, uint32_t word) { return smr_log_get32(saved + 4u * word); }

/* Returns the number of bytes before the saved values; 0 when lengths disagree or the bytes are damaged. */
static size_t values_at(const unsigned char *saved, size_t bytes)
{
    if (bytes < SMR_SAVED_FIXED + 4u || word_of(saved, SMR_SAVED_AT_MAGIC) != SMR_SAVED_MAGIC ||
        word_of(saved, SMR_SAVED_AT_VERSION) != SMR_SAVED_VERSION)
        return 0;
    const size_t all = word_of(saved, SMR_SAVED_AT_BYTES), n_config = word_of(saved, SMR_SAVED_AT_CONFIG_WORDS);
    if (all > bytes || all < SMR_SAVED_FIXED + 4u || n_config > (all - SMR_SAVED_FIXED - 4u) / 4u ||
        smr_log_get32(saved + all - 4u) != smr_crc32(0, saved, all - 4u))
        return 0;
    return SMR_SAVED_FIXED + 4u * n_config;
}

smr_status smr_save_info(const void *saved, size_t saved_bytes, smr_saved_info *info)
{
    const unsigned char *from = saved;
    smr_config config;
    if (saved == NULL || info == NULL)
        return SMR_E_NULL;
    if (values_at(from, saved_bytes) == 0u ||
        smr_log_get_config(from + SMR_SAVED_FIXED, word_of(from, SMR_SAVED_AT_CONFIG_WORDS), SMR_LOG_VERSION,
                           &config) != SMR_OK)
        return SMR_E_SAVE;
    info->bytes = word_of(from, SMR_SAVED_AT_BYTES);
    info->library = word_of(from, SMR_SAVED_AT_LIBRARY);
    info->model_checksum = word_of(from, SMR_SAVED_AT_MODEL);
    info->n_vertices = word_of(from, SMR_SAVED_AT_VERTICES);
    info->config = config;
    return SMR_OK;
}

/* Checks or restores the saved values. Returns 1 when all values are in range and no byte is left over. */
static int go_over(smr *s, uint32_t mode, const unsigned char *from, size_t bytes)
{
    smr_keeper k = {.mode = mode, .from = from, .at = values_at(from, bytes)};
    k.bytes = word_of(from, SMR_SAVED_AT_BYTES) - 4u;
    smr_go_over(s, &k);
    return !k.wrong && k.at == k.bytes && k.plan == word_of(from, SMR_SAVED_AT_PLAN);
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

/* Computes what follows from the saved values. The next iteration recomputes the reference. */
static void derive(smr *s)
{
    s->shape.start_box = smr_box_of(s->shape.start, s->shared.n);
    if (smr_image_on(&s->forces.image))
        smr_image_goals_derive(&s->forces.image);
    smr_triangles_now(&s->shape);
    (void)smr_shape_find_parts(&s->shape);
    if (SMR_HAS_HELD)
        smr_track_rest_derive(&s->shape);
    if (SMR_HAS_CONTACT) {
        smr_volumes_scale(&s->volumes);
        smr_smooth_start(&s->forces.smooth);
    }
    if (smr_moves(s))
        smr_time_steps_weigh(s);
    s->reference.missing = 1;
}

smr_status smr_restore(const smr_model *model, const smr_config *config, const smr_port *port, const void *saved,
                       size_t saved_bytes, void *arena, size_t bytes, smr **out)
{
    smr_saved_info info;
    smr s, *self;
    if (model == NULL || saved == NULL || out == NULL)
        return SMR_E_NULL;
    SMR_TRY(smr_save_info(saved, saved_bytes, &info));
    if (config == NULL)
        config = &info.config;
    SMR_TRY(check(model, config, &info));
    smr_count(&s, model, config);
    if (!smr_can_wait(&s.shared) ||
        !go_over(&s, SMR_KEEP_CHECK, saved,
                 saved_bytes)) /* a save of a build with more capabilities holds more values */
        return smr_built_without()[0] == 0 ? SMR_E_SAVE : SMR_E_WITHOUT;
    SMR_TRY(smr_init(model, &s.shared.config, port, arena, bytes, &self));
    (void)go_over(self, SMR_KEEP_RESTORE, saved, saved_bytes);
    self->await = smr_await;
    derive(self);
    smr_guard_close(self);
    *out = self;
    return SMR_OK;
}

smr_status smr_get_awaited(const smr *s, uint32_t *n)
{
    SMR_TRY(smr_readable(s, 0, n));
    *n = s->n_awaited;
    return SMR_OK;
}
