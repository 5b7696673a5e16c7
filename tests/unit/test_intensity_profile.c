/* test_intensity_profile.c: packing of profiles; profile match and gradient search find goals at planted places.
 * SPDX-License-Identifier: MIT */
#include "suite.h"
#include <math.h>
#include <string.h>
#include "image/intensity_profile.h"

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

TEST(test_pack)
{
    uint32_t seed = 3;
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

TEST(test_flat)
{
    static const float level[] = {0.0f, 7.0f, -1.0e6f, 1.0e29f};
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

TEST(test_shifts)
{
    static const float gains[] = {1.0f, 0.2f, 8.0f}, adds[] = {0.0f, -40.0f, 300.0f};
    uint32_t seed = 5;
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
TEST(test_ssd_sees_level)
{
    const packed_profile p = reference(2);
    float line[M];
    unsigned char inside[M];
    line_of(2, 20, 1.0f, 30.0f, line, inside);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[0]).confidence > 0.1f);
    assert_true(smr_profile_match(VIEW(p), line, inside, M, &similarity[1]).confidence == 0.0f);
}

/* Concordance compares contrast, too: of two places of the same form the one of like contrast wins, and a difference
 * below the noise is no difference. Correlation accepts either. */
TEST(test_concordance_sees_contrast)
{
    const packed_profile p = reference(0);
    const smr_similarity noisy = {SMR_SIMILARITY_CONCORDANCE, 4.0f, 0.0f, 0};
    float line[2u * M];
    unsigned char inside[2u * M];
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

/* A window that is not all inside cannot win, however well it fits. */
TEST(test_outside_windows)
{
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

TEST(test_edge_place)
{
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

/* Whatever the line: confidence within 0..1, places finite and on the line. */
TEST(test_ranges)
{
    uint32_t seed = 8;
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
