/* test_page_bytes.c: what the page of a report is made of: base64, ASCII JSON, 16-bit numbers, thinned surfaces, the
 * cut of an image.
 * SPDX-License-Identifier: MIT */
#include "unit/cmocka_first.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "html/page_bytes.h"
#include "html/page_image.h"
#include "html/page_thin.h"

static void is_text(const host_buffer *buffer, const char *text)
{
    assert_int_equal(buffer->failed, 0);
    assert_int_equal(buffer->size, strlen(text));
    if (text[0] != '\0')
        assert_memory_equal(buffer->data, text, strlen(text));
}

static void base64_is_the_standard_one(void **state)
{
    static const char *const pairs[][2] = {{"", ""},        {"f", "Zg=="},          {"fo", "Zm8="},
                                           {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}, {"\xff\xfe\xfd", "//79"}};
    unsigned char many[200];
    host_buffer out;
    size_t i = 0;
    (void)state;
    memset(&out, 0, sizeof out);
    for (i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        out.size = 0;
        host_page_base64(&out, (const unsigned char *)pairs[i][0], strlen(pairs[i][0]));
        is_text(&out, pairs[i][1]);
    }
    memset(many, 0, sizeof many);
    out.size = 0;
    host_page_base64(&out, many, sizeof many);
    assert_int_equal(out.size, 268 + 2); /* two ends of lines */
    assert_int_equal(out.data[128], '\n');
    host_buffer_free(&out);
}

static void json_becomes_ascii(void **state)
{
    static const char *const pairs[][2] = {
        {"{\n  \"a b\": [1,\n  2]\n}\n", "{\"a b\":[1,2]}"},
        {"\"</script><!-- & -->\"", "\"\\u003c/script\\u003e\\u003c!-- \\u0026 --\\u003e\""},
        {"\"\\\" x\\\\\" : 1", "\"\\\" x\\\\\":1"},
        {"\"\xc3\xa9\xe2\x80\xa8\xf0\x9f\x98\x80\"", "\"\\u00e9\\u2028\\ud83d\\ude00\""},
        {"\"\xc0\xbc\xe0\x80\xbc\xed\xa0\x80\xff\xe2\x80\"", "\"????"
                                                             "???????\""},
        {"\"\x7f\"", "\"\\u007f\""}};
    host_buffer out;
    size_t i = 0;
    (void)state;
    memset(&out, 0, sizeof out);
    for (i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        out.size = 0;
        host_page_json(&out, (const unsigned char *)pairs[i][0], strlen(pairs[i][0]));
        is_text(&out, pairs[i][1]);
    }
    host_buffer_free(&out);
}

static uint32_t word(const host_buffer *buffer, size_t i)
{
    return (uint32_t)buffer->data[2u * i] | (uint32_t)buffer->data[2u * i + 1u] << 8;
}

static void values_keep_what_they_are(void **state)
{
    const float value[] = {0.0f, 3.0f, 12.5f, NAN, -1.0f, INFINITY, 0.001f};
    const float none[] = {NAN, -1.0f}, zero[] = {0.0f, 0.0f};
    host_buffer out;
    double unit = 0.0;
    (void)state;
    memset(&out, 0, sizeof out);
    unit = host_page_values(&out, value, 7);
    assert_int_equal(out.size, 14);
    assert_int_equal(word(&out, 0), 0);
    assert_true(fabs(unit * word(&out, 1) - 3.0) <= unit);
    assert_true(fabs(unit * word(&out, 2) - 12.5) <= unit);
    assert_int_equal(word(&out, 2), 65534);
    assert_int_equal(word(&out, 3), 65535);
    assert_int_equal(word(&out, 4), 65535);
    assert_int_equal(word(&out, 5), 65535);
    assert_true(fabs(unit * word(&out, 6) - 0.001) <= unit);
    out.size = 0;
    assert_true(host_page_values(&out, none, 2) > 0.0);
    assert_int_equal(word(&out, 1), 65535);
    out.size = 0;
    assert_true(host_page_values(&out, zero, 2) > 0.0);
    assert_int_equal(word(&out, 1), 0);
    host_buffer_free(&out);
}

static void points_keep_their_places(void **state)
{
    const float xyz[] = {-10, 5, 0, 90, 5, 0, 40, 5, 1000};
    const uint32_t keep[] = {2};
    host_page_box box = host_page_box_empty();
    host_buffer out;
    (void)state;
    memset(&out, 0, sizeof out);
    assert_true(host_page_box_side(&box) <= 0.0f);
    host_page_box_add(&box, xyz, 3);
    assert_true(fabsf(host_page_box_side(&box) - 1000.0f) < 1e-3f);
    host_page_points(&out, &box, xyz, NULL, 3);
    assert_int_equal(out.size, 18);
    assert_int_equal(word(&out, 0), 0);
    assert_int_equal(word(&out, 3), 65535);
    assert_true(fabs(word(&out, 6) / 65535.0 * 100.0 - 50.0) < 0.01);
    assert_int_equal(word(&out, 1), 0); /* a flat side */
    out.size = 0;
    host_page_points(&out, &box, xyz, keep, 1);
    assert_int_equal(word(&out, 2), 65535);
    host_buffer_free(&out);
}

enum { SIDE = 20 };

/* A flat square of SIDE x SIDE cells of 1 mm. */
static host_mesh make_sheet(void)
{
    host_mesh mesh;
    uint32_t i = 0, k = 0;
    memset(&mesh, 0, sizeof mesh);
    mesh.n_vertices = (SIDE + 1) * (SIDE + 1);
    mesh.xyz = calloc(3u * mesh.n_vertices, sizeof *mesh.xyz);
    mesh.triangles = calloc(6u * SIDE * SIDE, sizeof *mesh.triangles);
    assert_non_null(mesh.xyz);
    assert_non_null(mesh.triangles);
    for (i = 0; i < mesh.n_vertices; i++) {
        mesh.xyz[3u * i] = (float)(i % (SIDE + 1)) - 7.0f;
        mesh.xyz[3u * i + 1u] = (float)(i / (SIDE + 1));
    }
    for (i = 0; i < SIDE * SIDE; i++) {
        const uint32_t a = i / SIDE * (SIDE + 1) + i % SIDE,
                       cell[6] = {a, a + 1, a + SIDE + 1, a + SIDE + 2, a + SIDE + 1, a + 1};
        for (k = 0; k < 6; k++)
            mesh.triangles[6u * i + k] = cell[k];
    }
    mesh.n_triangles = 2 * SIDE * SIDE;
    return mesh;
}

static void thinning_leaves_a_surface(void **state)
{
    host_mesh mesh = make_sheet();
    host_page_mesh thin;
    uint32_t i = 0;
    (void)state;
    assert_int_equal(host_page_thin(&mesh, 0.0f, &thin), 0);
    assert_int_equal(thin.n_vertices, mesh.n_vertices);
    assert_int_equal(thin.n_triangles, mesh.n_triangles);
    assert_memory_equal(thin.triangles, mesh.triangles, 12u * mesh.n_triangles);
    host_page_mesh_free(&thin);
    assert_int_equal(host_page_thin(&mesh, 4.0f, &thin), 0);
    assert_true(thin.n_vertices >= 25 && thin.n_vertices <= 42); /* cubes of 4 mm over 20 mm */
    assert_true(thin.n_triangles >= 30 && thin.n_triangles < 100);
    for (i = 0; i < 3u * thin.n_triangles; i++)
        assert_true(thin.triangles[i] < thin.n_vertices);
    for (i = 0; i < thin.n_triangles; i++)
        assert_true(thin.triangles[3u * i] != thin.triangles[3u * i + 1u] &&
                    thin.triangles[3u * i] != thin.triangles[3u * i + 2u]);
    for (i = 1; i < thin.n_vertices; i++)
        assert_true(thin.keep[i] > thin.keep[i - 1u]);
    assert_true(fabsf(host_page_edge(&mesh) - 1.0f) < 1e-5f);
    assert_int_equal(host_page_mesh_bytes(10, 4, 18), 180 + 24);
    assert_int_equal(host_page_mesh_bytes(65537, 1, 1), 65537 + 12);
    host_page_mesh_free(&thin);
    host_mesh_free(&mesh);
}

enum { NX = 12, NY = 10, NZ = 8 };

/* Brightness rises linearly: what is cut out of it and averaged must as well, to a tenth of a voxel: a voxel counts as
 * far as it is covered. */
static void image_is_cut_and_averaged(void **state)
{
    uint16_t voxel[NX * NY * NZ];
    smr_volume v = {
        voxel, NULL, SMR_VOXEL_UINT16, {NX, NY, NZ}, {100, -50, 30}, {1, 1, 3}, {0, 1, 0, 1, 0, 0, 0, 0, -1}};
    const host_page_box box = {{101, -49, 15}, {106, -44, 20}}, away = {{500, 500, 500}, {510, 510, 510}};
    host_page_image out;
    uint32_t i = 0, at[3];
    (void)state;
    for (i = 0; i < NX * NY * NZ; i++)
        voxel[i] = (uint16_t)(1000 + 10 * (i % NX) + 100 * (i / NX % NY) + 20 * (i / NX / NY));
    assert_int_equal(host_page_image_make(&v, &away, 5, 1000, &out), 0);
    assert_null(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 1000, NX * NY * NZ, &out), 0);
    assert_true(out.size[0] == NX && out.size[1] == NY && out.size[2] == NZ);
    free(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 1, 150, &out), 0);
    assert_true(out.size[0] * out.size[1] * out.size[2] <= 150 && out.size[0] >= 3 && out.size[0] <= 8);
    assert_true(out.spacing[0] > 1.0f && out.spacing[0] < 2.0f && fabsf(out.spacing[2] - 3.0f) < 1e-6f);
    for (at[2] = 0, i = 0; at[2] < out.size[2]; at[2]++)
        for (at[1] = 0; at[1] < out.size[1]; at[1]++)
            for (at[0] = 0; at[0] < out.size[0]; at[0]++, i++) {
                double p[3], want = 1000.0;
                int c = 0;
                for (c = 0; c < 3; c++)
                    p[c] = (double)out.first[c] + (double)(v.direction[3 * c]) * at[0] * (double)out.spacing[0] +
                           (double)(v.direction[3 * c + 1]) * at[1] * (double)out.spacing[1] +
                           (double)(v.direction[3 * c + 2]) * at[2] * (double)out.spacing[2];
                want += 10.0 * (p[1] + 50.0) + 100.0 * (p[0] - 100.0) + 20.0 * (30.0 - p[2]) / 3.0;
                want = fmin(out.high, fmax(out.low, want));
                assert_true(fabs(out.low + out.at[i] / 255.0 * (out.high - out.low) - want) < 12.0);
            }
    assert_true(out.low >= 1000.0 && out.high <= 2200.0 && out.high > out.low + 300.0);
    free(out.at);
}

static void odd_images_are_no_trouble(void **state)
{
    float value[8] = {NAN, INFINITY, -INFINITY, 5, 5, 5, 5, NAN};
    uint8_t one = 7;
    smr_volume v = {value, NULL, SMR_VOXEL_FLOAT, {2, 2, 2}, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    const host_page_box box = {{-1, -1, -1}, {3, 3, 3}};
    host_page_image out;
    (void)state;
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_true(isfinite(out.low) && out.high > out.low);
    free(out.at);
    assert_int_equal(host_page_image_make(&v, &box, 10, 1, &out), 0);
    assert_int_equal(out.size[0] * out.size[1] * out.size[2], 1);
    free(out.at);
    value[3] = -3e38f;
    value[4] = 3e38f;
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_true(isfinite(out.low) && out.high > out.low);
    free(out.at);
    v = (smr_volume){&one, NULL, SMR_VOXEL_UINT8, {1, 1, 1}, {0, 0, 0}, {1, 1, 1}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    assert_int_equal(host_page_image_make(&v, &box, 10, 100, &out), 0);
    assert_int_equal(out.at[0], 7);
    free(out.at);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(base64_is_the_standard_one), cmocka_unit_test(json_becomes_ascii),
        cmocka_unit_test(values_keep_what_they_are),  cmocka_unit_test(points_keep_their_places),
        cmocka_unit_test(thinning_leaves_a_surface),  cmocka_unit_test(image_is_cut_and_averaged),
        cmocka_unit_test(odd_images_are_no_trouble),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
