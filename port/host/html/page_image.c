/* page_image.c: voxels are means over the image's own; 0.1 % of the brightest and of the darkest are cut off.
 * SPDX-License-Identifier: MIT */
#include "html/page_image.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "volumes/voxel_volume.h"

#define BINS 4096
#define CUT 0.001

/* One axis of what is cut out: voxels first to end - 1 of the image become n, each of `step` voxels. */
typedef struct axis {
    uint32_t first, end, n;
    double step;
} axis;

static size_t index_of(const smr_volume *v, size_t i, size_t j, size_t k)
{
    return (k * v->size[1] + j) * v->size[0] + i;
}

/* The inverse of a matrix [9], row-major; 0 when there is none. */
static int invert(const double m[9], double out[9])
{
    double det = 0.0;
    int r = 0, c = 0;
    for (r = 0; r < 3; r++)
        for (c = 0; c < 3; c++) {
            const int r1 = (c + 1) % 3, r2 = (c + 2) % 3, c1 = (r + 1) % 3, c2 = (r + 2) % 3;
            out[3 * r + c] = m[3 * r1 + c1] * m[3 * r2 + c2] - m[3 * r1 + c2] * m[3 * r2 + c1];
        }
    det = m[0] * out[0] + m[1] * out[3] + m[2] * out[6];
    if (!(fabs(det) > 1e-12))
        return 0;
    for (r = 0; r < 9; r++)
        out[r] /= det;
    return 1;
}

/* The voxels that the box spans, and margin_mm more. 0 when there are none. */
static int span(const smr_volume *v, const host_page_box *box, float margin_mm, axis a[3])
{
    double m[9], inverse[9], low[3] = {DBL_MAX, DBL_MAX, DBL_MAX}, high[3] = {-DBL_MAX, -DBL_MAX, -DBL_MAX};
    int corner = 0, j = 0, c = 0;
    for (c = 0; c < 9; c++)
        m[c] = (double)v->direction[c] * (double)v->spacing[c % 3];
    if (!invert(m, inverse))
        return 0;
    for (corner = 0; corner < 8; corner++)
        for (j = 0; j < 3; j++) {
            double at = 0.0;
            for (c = 0; c < 3; c++) {
                const float p = (corner >> c & 1) != 0 ? box->high[c] + margin_mm : box->low[c] - margin_mm;
                at += inverse[3 * j + c] * ((double)p - (double)v->origin[c]);
            }
            low[j] = at < low[j] ? at : low[j];
            high[j] = at > high[j] ? at : high[j];
        }
    for (j = 0; j < 3; j++) {
        const double from = floor(low[j]), to = ceil(high[j]) + 1.0, n = v->size[j];
        if (!(to > 0.0 && from < n))
            return 0;
        a[j].first = from > 0.0 ? (uint32_t)from : 0u;
        a[j].end = to < n ? (uint32_t)to : v->size[j];
    }
    return 1;
}

/* The finest spacing, mm, with which there are at most so many voxels. */
static void choose_step(const smr_volume *v, size_t most, axis a[3])
{
    double spacing = (double)fminf(v->spacing[0], fminf(v->spacing[1], v->spacing[2]));
    double total = 0.0;
    int j = 0;
    do {
        total = 1.0;
        for (j = 0; j < 3; j++) {
            const double own = (double)v->spacing[j], count = (double)(a[j].end - a[j].first);
            a[j].step = spacing > own ? spacing / own : 1.0;
            a[j].n = (uint32_t)fmax(1.0, floor(count / a[j].step));
            total *= a[j].n;
        }
        spacing *= 1.02;
    } while (total > (double)most);
}

/* Voxels of the image that voxel i of the axis covers: first to end - 1; the share of each. */
static double share(const axis *a, uint32_t i, uint32_t at)
{
    const double from = (double)i * a->step, to = from + a->step, k = (double)(at - a->first);
    return fmin(to, k + 1.0) - fmax(from, k);
}

static uint32_t first_of(const axis *a, uint32_t i) { return a->first + (uint32_t)((double)i * a->step); }

static uint32_t end_of(const axis *a, uint32_t i)
{
    const double end = ceil((double)(i + 1u) * a->step - 1e-9) + (double)a->first;
    return end < (double)a->end ? (uint32_t)end : a->end;
}

/* The mean of what a voxel covers; NaN where nothing is finite. */
static float mean_of(const smr_volume *v, const axis a[3], const uint32_t at[3])
{
    double sum = 0.0, weight = 0.0;
    uint32_t i = 0, j = 0, k = 0;
    for (k = first_of(&a[2], at[2]); k < end_of(&a[2], at[2]); k++)
        for (j = first_of(&a[1], at[1]); j < end_of(&a[1], at[1]); j++) {
            const double row = share(&a[2], at[2], k) * share(&a[1], at[1], j);
            for (i = first_of(&a[0], at[0]); i < end_of(&a[0], at[0]); i++) {
                const double value = host_voxel(v->voxels, v->type, index_of(v, i, j, k)),
                             w = row * share(&a[0], at[0], i);
                if (!isfinite(value))
                    continue;
                sum += w * value;
                weight += w;
            }
        }
    return weight > 0.0 ? (float)(sum / weight) : NAN;
}

static void fill(const smr_volume *v, const axis a[3], float *out)
{
    uint32_t at[3];
    for (at[2] = 0; at[2] < a[2].n; at[2]++)
        for (at[1] = 0; at[1] < a[1].n; at[1]++)
            for (at[0] = 0; at[0] < a[0].n; at[0]++)
                *out++ = mean_of(v, a, at);
}

/* The brightness above a share of all voxels, by counting. */
static double quantile(const float *value, size_t n, double low, double high, double part)
{
    size_t count[BINS], i = 0, seen = 0, all = 0;
    int b = 0;
    memset(count, 0, sizeof count);
    for (i = 0; i < n; i++)
        if (isfinite(value[i])) {
            b = (int)(((double)value[i] - low) / (high - low) * BINS);
            count[b < 0 ? 0 : b < BINS ? b : BINS - 1]++;
            all++;
        }
    for (b = 0; b < BINS - 1; b++) {
        seen += count[b];
        if ((double)seen > part * (double)all)
            break;
    }
    return low + (high - low) * (b + (part > 0.5 ? 1 : 0)) / BINS;
}

/* What 0 and 255 stand for. 8 bits stay what they are. */
static void choose_range(const smr_volume *v, const float *value, size_t n, host_page_image *out)
{
    double low = DBL_MAX, high = -DBL_MAX;
    size_t i = 0;
    for (i = 0; i < n; i++)
        if (isfinite(value[i])) {
            low = (double)value[i] < low ? (double)value[i] : low;
            high = (double)value[i] > high ? (double)value[i] : high;
        }
    out->low = v->type == SMR_VOXEL_UINT8 ? 0.0 : low;
    out->high = v->type == SMR_VOXEL_UINT8 ? 255.0 : high;
    if (v->type == SMR_VOXEL_UINT8 || !(high > low)) {
        out->high = out->high > out->low ? out->high : out->low + 1.0;
        return;
    }
    out->low = quantile(value, n, low, high, CUT);
    out->high = quantile(value, n, low, high, 1.0 - CUT);
}

static void quantise(const float *value, size_t n, const host_page_image *out)
{
    const double scale = 255.0 / (out->high - out->low);
    size_t i = 0;
    for (i = 0; i < n; i++) {
        const double v = ((double)value[i] - out->low) * scale + 0.5;
        out->at[i] = (unsigned char)(v > 0.0 ? v < 255.0 ? v : 255.0 : 0.0); /* NaN is 0 */
    }
}

int host_page_image_make(const smr_volume *image, const host_page_box *box, float margin_mm, size_t most,
                         host_page_image *out)
{
    axis a[3];
    size_t n = 1;
    float *value = NULL;
    int j = 0, c = 0;
    memset(out, 0, sizeof *out);
    if (!span(image, box, margin_mm, a))
        return 0;
    choose_step(image, most, a);
    memcpy(out->first, image->origin, sizeof out->first);
    for (j = 0; j < 3; j++) {
        const double at = (double)a[j].first + 0.5 * (a[j].step - 1.0); /* centre of its first voxel, in voxels */
        out->size[j] = a[j].n;
        out->spacing[j] = (float)(a[j].step * (double)image->spacing[j]);
        for (c = 0; c < 3; c++)
            out->first[c] += (float)(at * (double)image->spacing[j] * (double)image->direction[3 * c + j]);
        n *= a[j].n;
    }
    value = malloc(n * sizeof *value);
    out->at = malloc(n);
    if (value != NULL && out->at != NULL) {
        fill(image, a, value);
        choose_range(image, value, n, out);
        quantise(value, n, out);
    }
    j = value != NULL && out->at != NULL ? 0 : -1;
    free(value);
    return j;
}
