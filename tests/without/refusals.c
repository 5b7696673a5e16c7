/* refusals.c: what a library refuses that was built without capabilities: settings, setters, saves and logs.
 * usage: refusals write FILE        with the whole library: saves and logs of runs that need one capability each
 *        refusals check FILE WORD...  with a library without the capabilities WORD...
 * Prints "not ok" for what is not as it should be; status 1 then. Public header only.
 * SPDX-License-Identifier: MIT */
#include <smr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { IMAGE, PARTIAL, TRACK, CONTACT, DYNAMICS, REFERENCES, NOTHING, CASES };
static const char *const words[] = {"image", "partial", "track", "contact", "dynamics", "references"};

#define SIDE 6u /* points along an edge of a cube */
#define NV (SIDE * SIDE * SIDE)
#define BYTES (1u << 20)

static _Alignas(SMR_ALIGN) unsigned char scratch[4 * BYTES], prepared[BYTES], closed_memory[BYTES], open_memory[BYTES],
    cloud_memory[BYTES], arena[BYTES];
static unsigned char saved[BYTES], logged[BYTES];
static float xyz[NV][3];
static uint32_t triangles[12 * (SIDE - 1u) * (SIDE - 1u)][3], n_triangles;
static signed char voxels[8 * 8 * 8];
static const smr_model *model;
static smr_surface *closed_surface, *open_surface;
static int out[NOTHING], failures;

static void expect(const char *what, int detail, smr_status got, int refused, smr_status refusal)
{
    if ((got == refusal) == (refused != 0) && (refused || got == SMR_OK))
        return;
    printf("not ok %s %d: %s\n", what, detail, smr_status_name(got));
    failures++;
}

static uint32_t node(uint32_t axis, uint32_t side, uint32_t i, uint32_t k)
{
    uint32_t at[3];
    at[axis] = side * (SIDE - 1u);
    at[(axis + 1u) % 3u] = i;
    at[(axis + 2u) % 3u] = k;
    return (at[2] * SIDE + at[1]) * SIDE + at[0];
}

/* A cube of 30 mm: the surface of a grid, whose inner points are carried along. */
static void make_cube(void)
{
    for (uint32_t v = 0; v < NV; v++) {
        xyz[v][0] = 6.0f * (float)(v % SIDE);
        xyz[v][1] = 6.0f * (float)(v / SIDE % SIDE);
        xyz[v][2] = 6.0f * (float)(v / SIDE / SIDE);
    }
    for (uint32_t f = 0; f < 6u; f++)
        for (uint32_t c = 0; c < (SIDE - 1u) * (SIDE - 1u); c++) {
            const uint32_t i = c % (SIDE - 1u), k = c / (SIDE - 1u), axis = f / 2u, side = f % 2u;
            const uint32_t q[4] = {node(axis, side, i, k), node(axis, side, i + 1u, k),
                                   node(axis, side, i + 1u, k + 1u), node(axis, side, i, k + 1u)};
            for (uint32_t t = 0; t < 2u; t++, n_triangles++) {
                triangles[n_triangles][0] = q[0];
                triangles[n_triangles][1] = q[side ? t + 1u : t + 2u];
                triangles[n_triangles][2] = q[side ? t + 2u : t + 1u];
            }
        }
}

static smr_volume volume_of(void)
{
    smr_volume v = {voxels, NULL, SMR_VOXEL_INT8, {8, 8, 8}, {-5, -5, -5}, {6, 6, 6}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (uint32_t i = 0; i < sizeof voxels; i++)
        voxels[i] = (signed char)(i % 8u > 2u && i % 8u < 6u ? 100 : 10);
    return v;
}

static int make_inputs(void)
{
    smr_prepare_config config = smr_prepare_config_default();
    const smr_volume reference = volume_of();
    size_t bytes = 0;
    make_cube();
    const smr_structure cube = {"cube", {xyz[0], triangles[0], NV, n_triangles}};
    smr_mesh half = cube.mesh;
    half.n_triangles /= 2u;
    config.n_radii = 1;
    config.radius_mm[0] = 15.0f;
    config.reference = &reference;
    config.profile_samples = 5;
    return smr_prepare(&cube, 1, &config, scratch, sizeof scratch, prepared, sizeof prepared, &bytes) == SMR_OK &&
           smr_model_open(prepared, bytes, &model) == SMR_OK &&
           smr_surface_build(&cube.mesh, closed_memory, sizeof closed_memory, &closed_surface) == SMR_OK &&
           smr_surface_build(&half, open_memory, sizeof open_memory, &open_surface) == SMR_OK;
}

/* A configuration that needs one capability and nothing of the others. */
static smr_config config_of(int capability)
{
    smr_config c = smr_config_default();
    c.basic.n_target_vertices = 2u * NV;
    c.partial.coverage = SMR_COVERAGE_WHOLE;
    if (capability == IMAGE)
        c.image.sideways = 0.25f;
    if (capability == PARTIAL)
        c.partial.n_landmarks = 2;
    if (capability == TRACK)
        c.track.mode = SMR_TRACK_REPORT;
    if (capability == CONTACT) {
        c.contact.share = c.contact.volume = 1.0f;
        c.contact.n_fixed = 1;
    }
    if (capability == DYNAMICS)
        c.dynamics.mode = SMR_DYNAMICS_ON;
    if (capability == REFERENCES)
        c.references.prior = 5.0f;
    return c;
}

static smr *start(const smr_config *config)
{
    smr *s = NULL;
    return smr_init(model, config, NULL, arena, sizeof arena, &s) == SMR_OK ? s : NULL;
}

/* Saves and logs of all cases, each with its size before it. */
static int write_all(FILE *file)
{
    int good = 1;
    for (int i = 0; i < CASES; i++) {
        const smr_config config = config_of(i);
        size_t bytes = 0;
        smr_log_state log;
        smr *s = start(&config);
        good &= s != NULL && smr_set_log(s, logged, sizeof logged) == SMR_OK &&
                smr_set_surface(s, SMR_ALL, closed_surface) == SMR_OK && smr_tick(s, 0, NULL) == SMR_OK &&
                smr_get_log(s, &log) == SMR_OK && smr_save_bytes(s, &bytes) == SMR_OK &&
                smr_save(s, saved, sizeof saved) == SMR_OK;
        good = good && fwrite(&bytes, sizeof bytes, 1, file) == 1u && fwrite(saved, bytes, 1, file) == 1u &&
               fwrite(&log.bytes, sizeof log.bytes, 1, file) == 1u && fwrite(logged, log.bytes, 1, file) == 1u;
    }
    return good;
}

static int read_part(FILE *file, unsigned char *to, size_t *bytes)
{
    return fread(bytes, sizeof *bytes, 1, file) == 1u && *bytes <= BYTES && fread(to, *bytes, 1, file) == 1u;
}

static void check_saved(FILE *file)
{
    for (int i = 0; i < CASES; i++) {
        const smr_config config = config_of(NOTHING), own = config_of(i);
        const int refused = i < NOTHING && out[i];
        size_t bytes = 0;
        smr *s = NULL;
        smr_replay replay;
        if (!read_part(file, saved, &bytes)) {
            printf("not ok the file of saves ends early\n");
            failures++;
            return;
        }
        /* what a save keeps depends on the build, so that one that needs nothing may be refused, too */
        const smr_status got = smr_restore(model, NULL, NULL, saved, bytes, arena, sizeof arena, &s);
        expect("restore", i, got, refused || (smr_built_without()[0] != '\0' && got != SMR_OK), SMR_E_WITHOUT);
        (void)read_part(file, logged, &bytes);
        s = start(refused ? &config : &own);
        expect("replay", i, s == NULL ? SMR_E_STATE : smr_replay_start(s, logged, bytes, NULL, NULL, &replay), refused,
               SMR_E_WITHOUT);
    }
}

static int group_of(const smr_setting *row)
{
    const size_t begin[] = {offsetof(smr_config, image),         offsetof(smr_config, partial),
                            offsetof(smr_config, track.mode),    offsetof(smr_config, contact.share),
                            offsetof(smr_config, dynamics.mode), offsetof(smr_config, references)};
    const size_t bytes[] = {sizeof(smr_image_config),   sizeof(smr_partial_config),  sizeof(smr_track_config),
                            sizeof(smr_contact_config), sizeof(smr_dynamics_config), sizeof(smr_references_config)};
    int group = NOTHING;
    for (int i = 0; i < NOTHING; i++)
        if (row->offset >= begin[i] && row->offset < begin[i] + bytes[i])
            group = i;
    return group;
}

/* Another legal value than the default. */
static void change(smr_config *config, const smr_setting *row)
{
    void *at = (char *)config + row->offset;
    const float number = (float)(row->high > row->value ? row->high : 0.5 * row->value);
    const uint32_t count = row->value > row->low ? (uint32_t)row->low : (uint32_t)row->high;
    if (row->kind == SMR_SETTING_NUMBER)
        memcpy(at, &number, sizeof number);
    else
        memcpy(at, &count, sizeof count);
}

static void check_settings(void)
{
    uint32_t n = 0;
    const smr_setting *row = smr_config_settings(&n);
    for (uint32_t i = 0; i < n; i++) {
        smr_config config = smr_config_default();
        size_t bytes = 0;
        if (row[i].kind == SMR_SETTING_GROUP || group_of(&row[i]) == NOTHING)
            continue;
        change(&config, &row[i]);
        const int whole = strcmp(row[i].name, "coverage") == 0 && config.partial.coverage == SMR_COVERAGE_WHOLE;
        expect(row[i].name, 0, smr_arena_bytes(model, &config, &bytes), out[group_of(&row[i])] && !whole, SMR_E_CONFIG);
    }
    const smr_config paper = smr_config_paper();
    size_t bytes = 0;
    expect("the paper's configuration", 0, smr_arena_bytes(model, &paper, &bytes), 0, SMR_E_CONFIG);
}

/* A model with the shapes of two subjects. */
static void check_shapes(void)
{
    const smr_config config = config_of(NOTHING);
    const smr_subjects subjects = {xyz[0], 1};
    const smr_structure cube = {"cube", {xyz[0], triangles[0], NV, n_triangles}};
    smr_prepare_config prepare = smr_prepare_config_default();
    const smr_model *shapes = NULL;
    size_t bytes = 0;
    prepare.also = &subjects;
    expect("smr_prepare", 0, smr_prepare(&cube, 1, &prepare, scratch, sizeof scratch, arena, sizeof arena, &bytes), 0,
           SMR_E_CONFIG);
    expect("smr_model_open", 0, smr_model_open(arena, bytes, &shapes), 0, SMR_E_CONFIG);
    expect("a model of shapes", 0, shapes == NULL ? SMR_E_MODEL : smr_arena_bytes(shapes, &config, &bytes),
           out[REFERENCES], SMR_E_CONFIG);
}

static void check_setters(void)
{
    const smr_volume volume = volume_of();
    const smr_landmark landmark = {0, 0, {0, 0, 0}, {1, 1, 1}, 1.0f, 0};
    smr_points *cloud = NULL;
    smr_config config = smr_config_default();
    float mass[NV];
    for (uint32_t v = 0; v < NV; v++)
        mass[v] = 1.0f;
    config.basic.n_target_vertices = 2u * NV;
    config.partial.n_landmarks = out[PARTIAL] ? 0u : 1u;
    config.contact.n_fixed = out[CONTACT] ? 0u : 1u;
    config.contact.volume = out[CONTACT] ? 0.0f : 1.0f;
    smr *s = start(&config);
    if (s == NULL || smr_points_open(NV, cloud_memory, sizeof cloud_memory, &cloud) != SMR_OK ||
        smr_points_add(cloud, xyz[0], NULL, NULL, NV) != SMR_OK) {
        printf("not ok setters: no registration\n");
        failures++;
        return;
    }
    expect("smr_set_surface", 0, smr_set_surface(s, SMR_ALL, closed_surface), 0, SMR_E_CONFIG);
    expect("smr_set_surface, open", 0, smr_set_surface(s, SMR_ALL, open_surface), out[PARTIAL], SMR_E_CONFIG);
    expect("smr_set_points", 0, smr_set_points(s, SMR_ALL, cloud), out[PARTIAL], SMR_E_CONFIG);
    expect("smr_set_landmarks", 0, smr_set_landmarks(s, &landmark, 1), out[PARTIAL], SMR_E_CONFIG);
    expect("smr_set_volume", 0, smr_set_volume(s, &volume), out[IMAGE], SMR_E_CONFIG);
    expect("smr_set_fixed", 0, smr_set_fixed(s, 0, closed_surface), out[CONTACT], SMR_E_CONFIG);
    expect("smr_set_volume_ratio", 0, smr_set_volume_ratio(s, 0, 1.1f), out[CONTACT], SMR_E_CONFIG);
    for (int tick = 0; tick < 5; tick++)
        expect("smr_tick", tick, smr_tick(s, 0, NULL), 0, SMR_E_CONFIG);
    config = config_of(out[DYNAMICS] ? NOTHING : DYNAMICS);
    s = start(&config);
    expect("smr_set_motion", 0, s == NULL ? SMR_E_NULL : smr_set_motion(s, 0, mass, NULL), out[DYNAMICS], SMR_E_CONFIG);
}

int main(int argc, char **argv)
{
    char left_out[64] = "";
    FILE *file = argc > 2 ? fopen(argv[2], strcmp(argv[1], "write") == 0 ? "wb" : "rb") : NULL;
    if (file == NULL || !make_inputs()) {
        printf("not ok no file, or no inputs\n");
        return 1;
    }
    if (strcmp(argv[1], "write") == 0) {
        const int good = write_all(file);
        return fclose(file) == 0 && good ? 0 : 1;
    }
    for (int i = 0; i < NOTHING; i++)
        for (int k = 3; k < argc; k++)
            if (strcmp(words[i], argv[k]) == 0) {
                out[i] = 1;
                (void)strcat(left_out, left_out[0] == '\0' ? "" : " ");
                (void)strcat(left_out, words[i]);
            }
    if (strcmp(left_out, smr_built_without()) != 0) {
        printf("not ok built without \"%s\"\n", smr_built_without());
        failures++;
    }
    check_settings();
    check_setters();
    check_shapes();
    check_saved(file);
    (void)fclose(file);
    return failures > 0;
}
