/* test_intensity_profile.c: packing of profiles; profile match and gradient search find goals at planted places.
 * SPDX-License-Identifier: MIT */
#include "cmocka_first.h"

#include <math.h>
#include <string.h>

#include "image/intensity_profile.h"
#include "property/rig.h"

#define N 30u
#define M 70u

static const smr_similarity similarity[] = {{SMR_SIMILARITY_NCC, 0.0f, 0.0f, 0},
                                            {SMR_SIMILARITY_SSD, 0.0f, 0.0f, 0},
                                            {SMR_SIMILARITY_CONCORDANCE, 0.0f, 0.0f, 0}};

static float value_of(uint32_t kind, float t)
{
    const double x = (double)t;
    switch (kind) {
    case 0: /* a soft step */ return (float)tanh((x - 14.0) / 2.0);
    case 1: /* a ramp between two plateaus */ return t < 8.0f ? 0.0f : t > 20.0f ? 12.0f : t - 8.0f;
    default: /* smooth noise */
        return (float)(sin(0.61 * x + 1.0) + 0.8 * sin(0.37 * x * (1.0 + 0.01 * x) + 0.2) + 0.6 * sin(0.23 * x + 2.1));
    }
}

typedef struct packed_profile {
    uint8_t byte[N];
    float low, range;
} packed_profile;

#define VIEW(p) (&(const smr_profile){(p).byte, (p).low, (p).range, N})

static packed_profile pack(const float *value)
{
    packed_profile p;
    unsigned char inside[N];
    memset(inside, 1, sizeof inside);
    smr_profile_pack(value, inside, N, p.byte, &p.low, &p.range);
    return p;
}

static packed_profile reference(uint32_t kind)
{
    float value[N];
    for (uint32_t k = 0; k < N; k++)
        value[k] = value_of(kind, (float)k);
    return pack(value);
}

/* The profile shifted by `shift` samples in another light, all of it inside. */
static void line_of(uint32_t kind, float shift, float gain, float add, float *line, unsigned char *inside)
{
    for (uint32_t k = 0; k < M; k++) {
        line[k] = add + gain * value_of(kind, (float)k - shift);
        inside[k] = 1;
    }
}

static void test_pack(void **state)
{
    uint32_t seed = 3;
    (void)state;
    for (uint32_t round = 0; round < 200u; round++) {
        const uint32_t n = 3u + rig_random(&seed, SMR_PROFILE_MAX - 2u);
        const float scale = powf(10.0f, rig_between(&seed, -3, 6)), add = rig_between(&seed, -3, 3) * scale;
        float value[SMR_PROFILE_MAX], low, range, least = 1.0e30f, most = -1.0e30f;
        unsigned char inside[SMR_PROFILE_MAX];
        uint8_t byte[SMR_PROFILE_MAX];
        for (uint32_t k = 0; k < n; k++) {
            value[k] = add + scale * rig_between(&seed, -1, 1);
            inside[k] = 1;
            least = fminf(least, value[k]);
            most = fmaxf(most, value[k]);
        }
        smr_profile_pack(value, inside, n, byte, &low, &range);
        assert_true(low == least && fabsf(low + range - most) <= 1.0e-6f * (fabsf(low) + fabsf(most)));
        for (uint32_t k = 0; k < n; k++) {
            const float back = low + (float)byte[k] * range / 255.0f;
            assert_true(fabsf(back - value[k]) <= 0.51f * range / 255.0f + 1.0e-6f * fabsf(value[k]));
        }
        inside[rig_random(&seed, n)] = 0;
        smr_profile_pack(value, inside, n, byte, &low, &range);
        assert_true(range == 0.0f && isfinite(low));
    }
}

static void test_flat(void **state)
{
    static const float level[] = {0.0f, 7.0f, -1.0e6f, 1.0e29f};
    (void)state;
    for (uint32_t k = 0; k < 4u; k++) {
        float value[N], line[M];
        unsigned char inside[M];
        for (uint32_t i = 0; i < N; i++)
            value[i] = level[k];
        const packed_profile p = pack(value);
        assert_true(p.range == 0.0f);
        line_of(0, 20, 1, 0, line, inside);
        for (int ssd = 0; ssd < 2; ssd++)
            assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[ssd]).confidence == 0.0f);
        assert_true(smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 10).confidence == 0.0f);
    }
    for (float scale = 1.0e-30f; scale > 0.0f; scale *= 0.1f) { /* as good as flat: 255 / range would be infinite */
        float value[N];
        for (uint32_t i = 0; i < N; i++)
            value[i] = i < 15u ? 0.0f : scale;
        const packed_profile p = pack(value);
        assert_true(p.range == 0.0f && p.byte[0] == 0u && p.byte[N - 1u] == 0u);
    }
    for (uint32_t k = 0; k < 4u; k++) { /* a flat line has nothing either, whatever the reference */
        const packed_profile p = reference(k % 3u);
        float line[M];
        unsigned char inside[M];
        for (uint32_t i = 0; i < M; i++) {
            line[i] = level[k];
            inside[i] = 1;
        }
        assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[0]).confidence == 0.0f);
        assert_true(smr_profile_edge(VIEW(p), 14, line, inside, M, 35, 10).confidence == 0.0f);
    }
}

static void test_shifts(void **state)
{
    static const float gains[] = {1.0f, 0.2f, 8.0f}, adds[] = {0.0f, -40.0f, 300.0f};
    uint32_t seed = 5;
    (void)state;
    for (uint32_t round = 0; round < 600u; round++) {
        const uint32_t kind = round % 3u, light = round / 3u % 4u;
        const packed_profile p = reference(kind);
        const float shift = rig_between(&seed, 1.0f, (float)(M - N) - 1.0f);
        float line[M];
        unsigned char inside[M];
        /* the fourth light is the same as the reference's, by squared differences */
        line_of(kind, shift, light < 3u ? gains[light] : 1.0f, light < 3u ? adds[light] : 0.0f, line, inside);
        const smr_peak peak = smr_profile_match(VIEW(p), line, inside, M, &similarity[light == 3u]);
        assert_true(peak.confidence > 0.1f && peak.confidence <= 1.0f);
        assert_true(fabsf(peak.at - shift) < 0.1f);
    }
}

/* Squared differences tell brightness apart; correlation does not. */
static void test_ssd_sees_level(void **state)
{
    const packed_profile p = reference(2);
    float line[M];
    unsigned char inside[M];
    (void)state;
    line_of(2, 20, 1.0f, 30.0f, line, inside);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[0]).confidence > 0.1f);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[1]).confidence == 0.0f);
}

/* Concordance compares contrast, too: of two places of the same form the one of like contrast wins, and a difference
 * below the noise is no difference. Correlation accepts either. */
static void test_concordance_sees_contrast(void **state)
{
    const packed_profile p = reference(0);
    const smr_similarity noisy = {SMR_SIMILARITY_CONCORDANCE, 4.0f, 0.0f, 0};
    float line[2u * M];
    unsigned char inside[2u * M];
    (void)state;
    for (uint32_t faint = 0; faint < 2u; faint++) {
        line_of(0, 20, faint == 0u ? 0.3f : 1.0f, 0.0f, line, inside);
        line_of(0, 20, faint == 1u ? 0.3f : 1.0f, 0.0f, line + M, inside + M);
        const float wanted = faint == 0u ? 20.0f + (float)M : 20.0f;
        const smr_peak peak = smr_profile_match(VIEW(p), line, inside, 2u * M, &similarity[2]);
        assert_true(fabsf(peak.at - wanted) < 0.1f && peak.confidence > 0.5f);
        const smr_peak none = smr_profile_match(VIEW(p), line, inside, 2u * M, &noisy);
        assert_true(none.confidence < 0.5f * peak.confidence);
    }
}

/* Of two like places the nearer to the line's middle wins, on whichever side it lies. */
static void test_nearer_wins(void **state)
{
    const packed_profile p = reference(2);
    (void)state;
    for (uint32_t kind = 0; kind < 3u; kind++) {
        const smr_similarity how = {kind, 0.0f, 0.2f, 0};
        for (uint32_t side = 0; side < 2u; side++) {
            float line[3u * M];
            unsigned char inside[3u * M];
            for (uint32_t k = 0; k < 3u * M; k++) {
                line[k] = 0.0f;
                inside[k] = 1;
            }
            const uint32_t far_at = side == 0u ? 10u : 3u * M - N - 10u, near_at = side == 0u ? 120u : 60u;
            for (uint32_t k = 0; k < N; k++)
                line[far_at + k] = line[near_at + k] = value_of(2, (float)k);
            const smr_peak peak = smr_profile_match(VIEW(p), line, inside, 3u * M, &how);
            assert_true(fabsf(peak.at - (float)near_at) < 0.6f);
        }
    }
}

/* A window that is not all inside cannot win, however well it fits. */
static void test_outside_windows(void **state)
{
    (void)state;
    for (uint32_t ssd = 0; ssd < 3u; ssd++) {
        for (uint32_t hole = 0; hole < M; hole++) {
            const packed_profile p = reference(0);
            float line[M];
            unsigned char inside[M];
            line_of(0, 20, 1, 0, line, inside);
            line[hole] = 0.0f;
            inside[hole] = 0;
            const smr_peak peak = smr_profile_match(VIEW(p), line, inside, M, &similarity[ssd]);
            const uint32_t o = (uint32_t)(peak.at + 0.5f);
            if (hole < 19u || hole >= 21u + N)
                assert_true(fabsf(peak.at - 20.0f) < 0.1f && peak.confidence > 0.1f);
            else if (peak.confidence > 0.0f)
                assert_true(hole < o || hole >= o + N);
        }
    }
    const packed_profile p = reference(0);
    float line[M];
    unsigned char inside[M];
    line_of(0, 20, 1, 0, line, inside);
    for (uint32_t k = 0; k < M; k += N) {
        inside[k] = 0; /* one in each window */
        line[k] = 0.0f;
    }
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[0]).confidence == 0.0f);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[1]).confidence == 0.0f);
    memset(inside, 0, sizeof inside);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[0]).confidence == 0.0f);
    assert_true(smr_profile_edge(VIEW(p), 14, line, inside, M, 35, 10).confidence == 0.0f);
}

/* A sharp edge: two samples wide, of the given sign, from level 0. */
static float edge_at(float t, float place) { return fminf(fmaxf(0.5f * (t - place) + 0.5f, 0.0f), 1.0f); }

static packed_profile edge_reference(float place, float sign)
{
    float value[N];
    for (uint32_t k = 0; k < N; k++)
        value[k] = 100.0f + sign * 50.0f * edge_at((float)k, place);
    return pack(value);
}

static void edge_line(const float *place, const float *sign, uint32_t n, float *line, unsigned char *inside)
{
    for (uint32_t k = 0; k < M; k++) {
        line[k] = 100.0f;
        inside[k] = 1;
        for (uint32_t i = 0; i < n; i++)
            line[k] += sign[i] * 50.0f * edge_at((float)k, place[i]);
    }
}

static void test_edge_place(void **state)
{
    (void)state;
    for (int sign = -1; sign <= 1; sign += 2) {
        for (int miss = -2; miss <= 2; miss++) {
            const packed_profile p = edge_reference(15.0f + (float)miss, (float)sign);
            for (int place = 20; place <= 50; place++) {
                const float at = (float)place, way = (float)sign;
                float line[M];
                unsigned char inside[M];
                edge_line(&at, &way, 1, line, inside);
                const smr_peak peak = smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 8);
                if (place >= 35 - 7 && place <= 35 + 7) {
                    assert_true(peak.confidence > 0.0f && peak.confidence <= 1.0f);
                    assert_true(fabsf(peak.at - (at - (float)miss)) < 0.1f);
                } else if (place <= 35 - 10 || place >= 35 + 10) { /* none of it within reach */
                    assert_true(peak.confidence == 0.0f);
                }
                const float wrong = -way;
                edge_line(&at, &wrong, 1, line, inside);
                assert_true(smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 8).confidence == 0.0f);
            }
        }
    }
}

/* A nearer and stronger edge of the other polarity is passed by. */
static void test_edge_polarity(void **state)
{
    static const float place[2] = {36, 40}, up_first[2] = {2, -1}, down_first[2] = {-2, 1};
    (void)state;
    for (uint32_t k = 0; k < 2u; k++) {
        const packed_profile p = edge_reference(15.0f, k == 0u ? -1.0f : 1.0f);
        float line[M];
        unsigned char inside[M];
        edge_line(place, k == 0u ? up_first : down_first, 2, line, inside);
        const smr_peak peak = smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 10);
        assert_true(peak.confidence > 0.0f && fabsf(peak.at - 40.0f) < 0.1f);
    }
    /* an edge of the reference far from its surface says nothing about the surface */
    const packed_profile far = edge_reference(25.0f, 1.0f);
    float line[M];
    unsigned char inside[M];
    edge_line(place, up_first, 1, line, inside);
    assert_true(smr_profile_edge(VIEW(far), 15, line, inside, M, 35, 10).confidence == 0.0f);
}

/* Edges at 30 and 40 of the reference's polarity, `steep` times as high as its own and `lift` of its ranges
 * lighter. */
static void two_edges(const packed_profile *p, float sign, const float *steep, const float *lift, float *line)
{
    static const float place[2] = {30, 40};
    for (uint32_t k = 0; k < M; k++) {
        const uint32_t i = k < 35u ? 0u : 1u;
        line[k] = p->low + p->range * (0.5f + lift[i] + sign * steep[i] * (edge_at((float)k, place[i]) - 0.5f));
    }
}

/* Of two edges the one like the reference's wins: a much steeper one loses, and so does an equal one that is lighter
 * or darker. */
static void test_edge_alike(void **state)
{
    static const float place[2] = {30, 40}, level[2] = {0, 0}, equal[2] = {1, 1};
    unsigned char inside[M];
    float line[M];
    (void)state;
    memset(inside, 1, sizeof inside);
    for (uint32_t like = 0; like < 2u; like++) {
        for (int way = -1; way <= 1; way += 2) {
            const float sign = (float)way,
                        off = like == 0u ? -3.0f * sign : 3.0f * sign; /* no third edge between them */
            const packed_profile p = edge_reference(15.0f, sign);
            const float steep[2] = {like == 0u ? 1.0f : 20.0f, like == 0u ? 20.0f : 1.0f};
            const float lift[2] = {like == 0u ? 0.0f : off, like == 0u ? off : 0.0f};
            two_edges(&p, sign, steep, level, line);
            smr_peak peak = smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 10);
            assert_true(peak.confidence > 0.5f && fabsf(peak.at - place[like]) < 0.2f);
            two_edges(&p, sign, equal, lift, line);
            peak = smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 10);
            assert_true(peak.confidence > 0.5f && fabsf(peak.at - place[like]) < 0.2f);
        }
    }
}

/* A sample outside near the edge: a goal is right or not given. Its value is 0, as smr_grid_line() leaves it. */
static void test_edge_holes(void **state)
{
    const packed_profile p = edge_reference(15.0f, 1.0f);
    const float at = 38.0f, way = 1.0f;
    (void)state;
    for (uint32_t hole = 25; hole <= 50u; hole++) {
        float line[M];
        unsigned char inside[M];
        edge_line(&at, &way, 1, line, inside);
        line[hole] = 0.0f;
        inside[hole] = 0;
        const smr_peak peak = smr_profile_edge(VIEW(p), 15, line, inside, M, 35, 8);
        if (hole < 34u || hole > 42u)
            assert_true(peak.confidence > 0.0f);
        /* neighbours that lack a sample may show half of the edge only, but never pull it to their hole */
        assert_true(peak.confidence == 0.0f || fabsf(peak.at - at) < 1.01f);
        assert_true(hole != 38u || peak.confidence == 0.0f || fabsf(peak.at - at) < 0.1f);
    }
}

/* Whatever the line: confidence within 0..1, places finite and on the line. */
static void test_ranges(void **state)
{
    uint32_t seed = 8;
    (void)state;
    for (uint32_t round = 0; round < 3000u; round++) {
        const uint32_t n = 3u + rig_random(&seed, SMR_PROFILE_MAX - 2u);
        const uint32_t m = n + rig_random(&seed, SMR_LINE_MAX - n + 1u);
        const float scale = powf(10.0f, rig_between(&seed, -6, 28));
        uint8_t byte[SMR_PROFILE_MAX];
        float line[SMR_LINE_MAX];
        unsigned char inside[SMR_LINE_MAX];
        for (uint32_t k = 0; k < n; k++)
            byte[k] = (uint8_t)rig_random(&seed, 256);
        byte[0] = 0;
        byte[n - 1u] = 255;
        for (uint32_t k = 0; k < m; k++) {
            inside[k] = rig_random(&seed, 100) > round % 5u;
            line[k] = inside[k] ? rig_between(&seed, -1, 1) * scale : 0.0f;
        }
        const float low = rig_between(&seed, -1, 1) * scale,
                    range = rig_between(&seed, 0.01f, 10.0f) * (round % 7u ? scale : 1.0f);
        const smr_profile packed = {byte, low, range, n};
        const smr_peak match = smr_profile_match(&packed, line, inside, m, &similarity[round % 3u]);
        assert_true(match.confidence >= 0.0f && match.confidence <= 1.0f);
        assert_true(match.at >= 0.0f && match.at <= (float)(m - n));
        if (m >= 8u) {
            const uint32_t centre = 3u + rig_random(&seed, m - 6u), reach = rig_random(&seed, 140);
            const smr_peak edge = smr_profile_edge(&packed, n / 2u, line, inside, m, centre, reach);
            assert_true(edge.confidence >= 0.0f && edge.confidence <= 1.0f);
            assert_true(edge.confidence == 0.0f || fabsf(edge.at - (float)centre) <= (float)reach + 3.51f);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pack),
        cmocka_unit_test(test_flat),
        cmocka_unit_test(test_shifts),
        cmocka_unit_test(test_ssd_sees_level),
        cmocka_unit_test(test_outside_windows),
        cmocka_unit_test(test_concordance_sees_contrast),
        cmocka_unit_test(test_nearer_wins),
        cmocka_unit_test(test_edge_place),
        cmocka_unit_test(test_edge_alike),
        cmocka_unit_test(test_edge_polarity),
        cmocka_unit_test(test_edge_holes),
        cmocka_unit_test(test_ranges),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
