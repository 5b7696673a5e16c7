/* smallest.c: the smallest useful program: opens a model in flash, builds a target surface, registers, reads positions.
 *
 * `make size` links it for a Cortex-M7 and counts its bytes. It is not run there, so the model may be empty. Compiled
 * with SMALLEST_RAM, for the host, it prepares a model, prints the arena's bytes of some configurations, and runs.
 * SPDX-License-Identifier: MIT */
#include <smr.h>

enum { ALONG = 70, AROUND = 50, NV = ALONG * AROUND, NT = 2 * NV }; /* a closed ring of 3,500 vertices */
static float xyz[NV][3];
static uint32_t triangles[NT][3];
static _Alignas(SMR_ALIGN) unsigned char surface_memory[1 << 20], arena[1 << 22];
#ifdef SMALLEST_RAM
static _Alignas(SMR_ALIGN) unsigned char flash[1 << 22];
#else
static _Alignas(SMR_ALIGN) const unsigned char flash[64] = {0};
#endif

static smr_status smallest(void)
{
    const smr_mesh mesh = {&xyz[0][0], &triangles[0][0], NV, NT};
    const smr_config config = smr_config_default();
    const smr_model *model;
    smr_surface *target;
    smr *s;
    smr_tick_report report = {0};
    smr_status status = smr_model_open(flash, sizeof flash, &model);
    if (status == SMR_OK)
        status = smr_surface_build(&mesh, surface_memory, sizeof surface_memory, &target);
    if (status == SMR_OK)
        status = smr_init(model, &config, 0, arena, sizeof arena, &s);
    if (status == SMR_OK)
        status = smr_set_surface(s, SMR_ALL, target);
    while (status == SMR_OK && !report.done)
        status = smr_tick(s, 0, &report);
    return status == SMR_OK ? smr_get_positions(s, 0, &xyz[0][0]) : status;
}

#ifndef SMALLEST_RAM
int main(void) { return smallest() != SMR_OK; }
#else
#include <math.h>
#include <stdio.h>
#include <string.h>

static _Alignas(SMR_ALIGN) unsigned char scratch[1 << 24], with_profiles[1 << 22];
static unsigned char voxels[16 * 16 * 16];

static void make_ring(void)
{
    for (uint32_t v = 0; v < NV; v++) {
        const uint32_t i = v / AROUND, j = v % AROUND, right = (i + 1) % ALONG * AROUND, up = (j + 1) % AROUND;
        const double a = 6.283185307 * i / ALONG, b = 6.283185307 * j / AROUND;
        const uint32_t two[2][3] = {{v, right + j, right + up}, {v, right + up, i * AROUND + up}};
        xyz[v][0] = (float)((60 + 30 * cos(b)) * cos(a));
        xyz[v][1] = (float)((60 + 30 * cos(b)) * sin(a));
        xyz[v][2] = (float)(30 * sin(b));
        memcpy(triangles[2u * v], two, sizeof two);
    }
}

static const smr_model *prepare(const smr_volume *reference, unsigned char *image)
{
    const smr_structure ring = {"ring", {&xyz[0][0], &triangles[0][0], NV, NT}};
    smr_prepare_config config = smr_prepare_config_default();
    const smr_model *model = NULL;
    size_t bytes;
    config.reference = reference;
    if (smr_prepare(&ring, 1, &config, scratch, sizeof scratch, image, 1 << 22, &bytes) != SMR_OK)
        return NULL;
    return smr_model_open(image, bytes, &model) == SMR_OK ? model : NULL;
}

/* Sets a field by its name in the table of settings, and says whether it is there. */
static int set(smr_config *config, const char *name, float value)
{
    uint32_t n;
    const smr_setting *table = smr_config_settings(&n);
    for (uint32_t i = 0; i < n; i++)
        if (table[i].kind != SMR_SETTING_GROUP && strcmp(table[i].name, name) == 0) {
            const uint32_t count = (uint32_t)value;
            const void *from = table[i].kind == SMR_SETTING_NUMBER ? (const void *)&value : &count;
            memcpy((char *)config + table[i].offset, from, 4);
            return 1;
        }
    return 0;
}

/* Bytes of arena of a model with a setting changed; 0 where this library has it left out. */
static size_t arena_bytes(const smr_model *model, const char *name, float value)
{
    smr_config config = smr_config_default();
    size_t bytes = 0;
    if (model == NULL || !set(&config, "coverage", SMR_COVERAGE_WHOLE) ||
        (name != NULL && !set(&config, name, value)) || smr_arena_bytes(model, &config, &bytes) != SMR_OK)
        return 0;
    return bytes;
}

static void print_more(const char *text, size_t least, size_t bytes)
{
    if (bytes == 0)
        printf("  %-24s  left out\n", text);
    else
        printf("  %-24s %+9ld\n", text, (long)bytes - (long)least);
}

int main(void)
{
    static const struct {
        const char *text, *name;
        float value;
    } on[] = {{"partial: coverage auto", "coverage", SMR_COVERAGE_AUTO},
              {"partial: 16 landmarks", "n_landmarks", 16},
              {"track", "track", SMR_TRACK_REPORT},
              {"contact", "contact", 1},
              {"contact: volume", "volume", 1},
              {"contact: smooth", "smooth", 0.5f},
              {"dynamics", "dynamics", SMR_DYNAMICS_ON},
              {"n_target_vertices", "n_target_vertices", NV}};
    const smr_volume volume = {.voxels = voxels,
                               .size = {16, 16, 16},
                               .origin = {-96, -96, -96},
                               .spacing = {12, 12, 12},
                               .direction = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    make_ring();
    for (uint32_t i = 0; i < sizeof voxels; i++)
        voxels[i] = (unsigned char)(i * 7u);
    const smr_model *model = prepare(NULL, flash), *image = prepare(&volume, with_profiles);
    const size_t least = arena_bytes(model, NULL, 0);
    printf("  %-24s %9zu\n", "the smallest", least);
    print_more("image", least, arena_bytes(image, NULL, 0));
    for (uint32_t i = 0; i < sizeof on / sizeof on[0]; i++)
        print_more(on[i].text, least, arena_bytes(model, on[i].name, on[i].value));
    return smallest() != SMR_OK;
}
#endif
