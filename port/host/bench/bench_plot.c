/* bench_plot.c: draws line charts side by side in one SVG.
 * SPDX-License-Identifier: MIT */
#include "bench/bench_plot.h"

#include <math.h>

/* Pixels. The texts of a panel's axes are on its left and below it. */
#define PANEL_WIDTH 480.0
#define HEIGHT 420.0
#define LEFT 62.0
#define RIGHT 14.0
#define TOP 64.0
#define BOTTOM 52.0
#define LINE 17.0
#define HEADROOM 1.45 /* top of the y axis over the largest value: room for the legend */
#define TICKS 6.0

/* A panel's place and scales. */
typedef struct frame {
    double left, top, width, height, x_max, y_max, y_step;
} frame;

static double px(const frame *f, double x) { return f->left + f->width * x / f->x_max; }
static double py(const frame *f, double y) { return f->top + f->height * (1.0 - y / f->y_max); }

/* The distance of axis ticks: 1, 2 or 5 times a power of ten, about TICKS of them in the range. */
static double nice_step(double range)
{
    const double raw = range / TICKS, power = pow(10.0, floor(log10(raw))), digit = raw / power;
    return power * (digit <= 1.0 ? 1.0 : digit <= 2.0 ? 2.0 : digit <= 5.0 ? 5.0 : 10.0);
}

static frame frame_of(const host_plot *plot, uint32_t index)
{
    frame f = {
        PANEL_WIDTH * index + LEFT, TOP, PANEL_WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM, plot->x_max, 0.0, 0.0};
    uint32_t c = 0, i = 0;
    for (c = 0; c < plot->n_curves; c++)
        for (i = 0; i < plot->curve[c].n; i++)
            f.y_max = plot->curve[c].y[i] > f.y_max ? plot->curve[c].y[i] : f.y_max;
    if (!(f.y_max > 0.0))
        f.y_max = 1.0;
    f.y_max *= plot->headroom > 0.0 ? plot->headroom : HEADROOM;
    f.y_step = nice_step(f.y_max);
    f.y_max = f.y_step * ceil(f.y_max / f.y_step);
    return f;
}

static void put_axes(const host_plot *plot, const frame *f, host_buffer *out)
{
    const double x_step = nice_step(f->x_max), bottom = f->top + f->height, right = f->left + f->width;
    const int digits = f->y_step < 0.1 ? 2 : f->y_step < 1.0 ? 1 : 0;
    double v = 0.0;
    for (v = 0.0; v <= f->y_max * 1.0001; v += f->y_step)
        host_buffer_print(out,
                          "<path d=\"M%.1f %.1fH%.1f\" stroke=\"#dddddd\"/>"
                          "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%.*f</text>\n",
                          f->left, py(f, v), right, f->left - 6.0, py(f, v) + 4.0, digits, v);
    for (v = 0.0; v <= f->x_max * 1.0001; v += x_step)
        host_buffer_print(out,
                          "<path d=\"M%.1f %.1fv5\" stroke=\"#333333\"/>"
                          "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%g</text>\n",
                          px(f, v), bottom, px(f, v), bottom + 19.0, v);
    host_buffer_print(out, "<path d=\"M%.1f %.1fV%.1fH%.1f\" stroke=\"#333333\" fill=\"none\"/>\n", f->left, f->top,
                      bottom, right);
    host_buffer_print(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%s</text>\n", f->left + f->width / 2.0,
                      bottom + 40.0, plot->x_label);
    host_buffer_print(out, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\">%s</text>\n",
                      f->left - 44.0, f->top + f->height / 2.0, plot->y_label);
    host_buffer_print(out, "<text x=\"%.1f\" y=\"%.1f\" font-weight=\"bold\">%s</text>\n", f->left, f->top - 12.0,
                      plot->title);
}

static void put_curve(const host_curve *curve, const frame *f, host_buffer *out)
{
    uint32_t i = 0;
    if (curve->n == 0)
        return;
    host_buffer_print(out, "<path d=\"M");
    if (curve->fitted)
        host_buffer_print(out, "%.1f %.1fL%.1f %.1f", px(f, 0.0), py(f, curve->fit[0]), px(f, f->x_max),
                          py(f, curve->fit[0] + curve->fit[1] * f->x_max));
    for (i = 0; !curve->fitted && i < curve->n; i++)
        host_buffer_print(out, "%s%.1f %.1f", i > 0 ? "L" : "", px(f, curve->x[i]), py(f, curve->y[i]));
    host_buffer_print(out, "\" stroke=\"%s\" stroke-width=\"1.6\" stroke-dasharray=\"%s\" fill=\"none\"/>\n",
                      curve->colour, curve->dash);
    for (i = 0; i < curve->n; i++)
        host_buffer_print(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/>", px(f, curve->x[i]),
                          py(f, curve->y[i]), curve->colour);
    host_buffer_print(out, "\n");
}

static void put_legend(const host_plot *plot, const frame *f, host_buffer *out)
{
    const double left = plot->legend_left ? f->left + 12.0 : f->left + f->width - 232.0;
    uint32_t c = 0;
    for (c = 0; c < plot->n_curves; c++) {
        const host_curve *const curve = &plot->curve[c];
        const double y = f->top + 6.0 + LINE * (double)(c + 1u);
        host_buffer_print(
            out,
            "<path d=\"M%.1f %.1fh30\" stroke=\"%s\" stroke-width=\"1.6\" stroke-dasharray=\"%s\"/>"
            "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"3\" fill=\"%s\"/><text x=\"%.1f\" y=\"%.1f\">%s</text>\n",
            left, y - 4.0, curve->colour, curve->dash, left + 15.0, y - 4.0, curve->colour, left + 38.0, y,
            curve->name);
    }
}

void host_plot_write(const host_plot *plots, uint32_t n, const char *title, host_buffer *out)
{
    uint32_t i = 0, c = 0;
    const double width = PANEL_WIDTH * n;
    host_buffer_print(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" viewBox=\"0 0 %.0f %.0f\" "
        "font-family=\"sans-serif\" font-size=\"13\" fill=\"#222222\">\n<title>%s</title>\n"
        "<rect width=\"%.0f\" height=\"%.0f\" fill=\"#ffffff\"/>\n"
        "<text x=\"%.1f\" y=\"24\" font-size=\"15\" text-anchor=\"middle\">%s</text>\n",
        width, HEIGHT, width, HEIGHT, title, width, HEIGHT, width / 2.0, title);
    for (i = 0; i < n; i++) {
        const frame f = frame_of(&plots[i], i);
        put_axes(&plots[i], &f, out);
        for (c = 0; c < plots[i].n_curves; c++)
            put_curve(&plots[i].curve[c], &f, out);
        put_legend(&plots[i], &f, out);
    }
    host_buffer_print(out, "</svg>\n");
}
