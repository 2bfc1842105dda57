/* Anti-aliasing of a finished picture: T. Lottes, "FXAA", NVIDIA white paper, 2009. A pixel whose luma differs from its
 * four neighbours is on a horizontal or vertical edge. The edge is followed in both directions until the luma changes.
 * The pixel is moved across the edge by the fraction that the line between the two ends covers. A pixel that differs
 * from all neighbours is mixed with their mean. Uniform areas, and edges along an axis, which have no ends, do not
 * change. */
#include "image/fxaa_internal.h"

#include <math.h>
#include <stddef.h>

/* From the white paper: the minimum visible contrast; the contrast relative to the brightest neighbour; the fraction of
 * the contrast that ends an edge; the mixing of single pixels. */
static const double edge_min = 1.0 / 32, edge_share = 1.0 / 8, search_share = 1.0 / 4, mix_trim = 1.0 / 4,
                    mix_max = 3.0 / 4;
enum { SEARCH_STEPS = 16 };
_Static_assert((int)SEARCH_STEPS + 2 <= (int)FXAA_RIM, "a pixel depends on the pixels of its search and those beside");

struct source {
    const struct finish_area *area;
    const float (*rgb)[3];
};

/* Pixels beyond the border have the values of the border. */
static const float *pixel_at(const struct source *source, int64_t x, int64_t y) {
    int64_t w = source->area->width, h = source->area->height;
    x = x < 0 ? 0 : x < w ? x : w - 1;
    y = y < 0 ? 0 : y < h ? y : h - 1;
    return source->rgb[y * w + x];
}

static double luma_at(const struct source *source, int64_t x, int64_t y) {
    const float *rgb = pixel_at(source, x, y);
    return 0.299 * (double)rgb[0] + 0.587 * (double)rgb[1] + 0.114 * (double)rgb[2];
}

static double max_of(double a, double b) {
    return a > b ? a : b;
}

static double min_of(double a, double b) {
    return a < b ? a : b;
}

/* A pixel with its four neighbours. */
struct cross {
    double m, n, s, w, e;
};

/* The edge between a pixel and one of its neighbours. */
struct edge {
    int ax, ay;      /* a step across it, to that neighbour */
    double luma;     /* its mean */
    double gradient; /* the fraction of the mean that ends it */
};

static struct edge edge_of(const struct source *source, int64_t x, int64_t y, const struct cross *c) {
    double nw = luma_at(source, x - 1, y - 1), ne = luma_at(source, x + 1, y - 1), sw = luma_at(source, x - 1, y + 1),
           se = luma_at(source, x + 1, y + 1);
    double vertical =
        fabs(nw / 4 - c->n / 2 + ne / 4) + fabs(c->w / 2 - c->m + c->e / 2) + fabs(sw / 4 - c->s / 2 + se / 4);
    double horizontal =
        fabs(nw / 4 - c->w / 2 + sw / 4) + fabs(c->n / 2 - c->m + c->s / 2) + fabs(ne / 4 - c->e / 2 + se / 4);
    bool is_horizontal = horizontal >= vertical;
    double before = is_horizontal ? c->n : c->w, after = is_horizontal ? c->s : c->e;
    double gradient_before = fabs(before - c->m), gradient_after = fabs(after - c->m);
    int step = gradient_before >= gradient_after ? -1 : 1;
    return (struct edge){.ax = is_horizontal ? 0 : step,
                         .ay = is_horizontal ? step : 0,
                         .luma = ((step < 0 ? before : after) + c->m) / 2,
                         .gradient = max_of(gradient_before, gradient_after) * search_share};
}

/* The number of steps to the end of the edge in one direction, at most SEARCH_STEPS, and the difference of the luma
 * there. */
static int search(const struct source *source, int64_t x, int64_t y, const struct edge *edge, int direction,
                  double *difference) {
    int dx = edge->ay != 0 ? direction : 0, dy = edge->ax != 0 ? direction : 0;
    int step = 0;
    do {
        step++;
        int64_t px = x + step * dx, py = y + step * dy;
        double luma = (luma_at(source, px, py) + luma_at(source, px + edge->ax, py + edge->ay)) / 2;
        *difference = luma - edge->luma;
    } while (step < SEARCH_STEPS && fabs(*difference) < edge->gradient);
    return step;
}

/* How far the pixel is moved across the edge, 0..1/2. */
static double shift_of(const struct source *source, int64_t x, int64_t y, const struct edge *edge, double m) {
    double differences[2];
    int before = search(source, x, y, edge, -1, &differences[0]),
        after = search(source, x, y, edge, 1, &differences[1]);
    int nearer = before < after ? before : after;
    double end = differences[before < after ? 0 : 1];
    if ((m - edge->luma < 0) == (end < 0))
        return 0; /* the pixel on the other side of the edge is moved there */
    return 0.5 - (double)nearer / (before + after);
}

/* The weight of the mean of 3 x 3 pixels in an isolated pixel. */
static double mix_of(const struct cross *c, double range) {
    double mean = (c->n + c->s + c->w + c->e) / 4;
    double mix = max_of(0, fabs(mean - c->m) / range - mix_trim) / (1 - mix_trim);
    return min_of(mix, mix_max);
}

static void finish_pixel(const struct source *source, int64_t x, int64_t y, float out[3]) {
    struct cross c = {luma_at(source, x, y), luma_at(source, x, y - 1), luma_at(source, x, y + 1),
                      luma_at(source, x - 1, y), luma_at(source, x + 1, y)};
    double low = min_of(c.m, min_of(min_of(c.n, c.s), min_of(c.w, c.e)));
    double high = max_of(c.m, max_of(max_of(c.n, c.s), max_of(c.w, c.e))), range = high - low;
    const float *own = pixel_at(source, x, y);
    for (int i = 0; i < 3; i++)
        out[i] = own[i];
    if (range < max_of(edge_min, high * edge_share))
        return;
    struct edge edge = edge_of(source, x, y, &c);
    double shift = shift_of(source, x, y, &edge, c.m), mix = mix_of(&c, range);
    const float *other = pixel_at(source, x + edge.ax, y + edge.ay);
    for (int i = 0; i < 3; i++) {
        double moved = (double)own[i] + shift * ((double)other[i] - (double)own[i]), sum = 0;
        if (mix > 0) {
            for (int k = 0; k < 9; k++)
                sum += (double)pixel_at(source, x + k % 3 - 1, y + k / 3 - 1)[i];
            moved += mix * (sum / 9 - moved);
        }
        out[i] = (float)moved;
    }
}

void fxaa_apply(const struct finish_area *area, const float (*in)[3], float (*out)[3]) {
    const struct source source = {area, in};
    for (uint32_t y = 0; y < area->height; y++)
        for (uint32_t x = 0; x < area->width; x++)
            finish_pixel(&source, x, y, out[(size_t)y * area->width + x]);
}
