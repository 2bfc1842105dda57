/* Numbers are compared as the files have them: levels of 255 of PNG and JPEG (also of 16 bits), light of PFM, HDR and
 * EXR. The second picture is the reference.
 *
 * relMSE is the mean of (a - b)^2 / (b^2 + 0.01), of numbers of which 1 is white (F. Rousselle, C. Knaus, M. Zwicker,
 * "Adaptive Sampling and Reconstruction using Greedy Error Minimization", SIGGRAPH Asia 2011). SSIM is that of Z. Wang,
 * A. Bovik, H. Sheikh, E. Simoncelli, "Image Quality Assessment", 2004, of luma: 11 x 11 pixels with a Gaussian of 1.5,
 * cut at the borders. For it, light is limited to 1 and encoded by a power of 1/2.2. */
#include "output/compare.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/image.h"
#include "image/picture_file.h"
#include "math/elementary.h"
#include "output/picture_files.h"
#include "session/text.h"

#include <math.h>
#include <stdio.h>

enum { WINDOW = 5 }; /* of the window of SSIM */

struct comparison {
    const struct image *a, *b;
    uint32_t width, height;
    int channels; /* 4 if some alpha is not 1 */
    double white; /* as it is printed: 255, or 1 of light */
    double threshold, largest, sum, relative, similarity;
    uint64_t beyond; /* pixels */
    uint32_t at[2];  /* of the largest difference */
};

/* Alpha is the fourth component. */
static void pixel(const struct image *image, uint32_t x, uint32_t y, double out[4]) {
    struct rgba texel = image_texel(image, x, y);
    out[0] = texel.r, out[1] = texel.g, out[2] = texel.b, out[3] = texel.a;
}

static void add_pixel(struct comparison *c, uint32_t x, uint32_t y) {
    double a[4], b[4], largest = 0;
    pixel(c->a, x, y, a);
    pixel(c->b, x, y, b);
    for (int k = 0; k < c->channels; k++) {
        double gap = fabs(a[k] - b[k]);
        largest = math_max(largest, gap);
        c->sum += gap;
        c->relative += gap * gap / (b[k] * b[k] + 0.01);
    }
    c->beyond += c->white * largest > c->threshold * (1 + 1e-12);
    if (largest > c->largest) {
        c->largest = largest;
        c->at[0] = x, c->at[1] = y;
    }
}

/* Of all pixels; NULL: no memory. */
static double *make_luma(const struct comparison *c, const struct image *image, struct error *error) {
    size_t count = (size_t)c->width * c->height;
    double *out = mem_alloc_zero(count, sizeof *out);
    if (!out)
        (void)error_no_memory(error, "the comparison");
    for (size_t i = 0; out && i < count; i++) {
        struct rgba t = image_texel(image, (uint32_t)(i % c->width), (uint32_t)(i / c->width));
        double value = 0.2126 * t.r + 0.7152 * t.g + 0.0722 * t.b;
        out[i] = c->white > 1 ? value : el_pow(math_min(value, 1), 1 / 2.2);
    }
    return out;
}

/* At one pixel of two pictures of luma. */
static double similarity_at(const struct comparison *c, const double *const luma[2], const double weights[WINDOW + 1],
                            uint32_t x, uint32_t y) {
    double sum = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
    uint32_t x1 = x + WINDOW < c->width ? x + WINDOW : c->width - 1;
    uint32_t y1 = y + WINDOW < c->height ? y + WINDOW : c->height - 1;
    for (uint32_t v = y > WINDOW ? y - WINDOW : 0; v <= y1; v++) {
        for (uint32_t u = x > WINDOW ? x - WINDOW : 0; u <= x1; u++) {
            double weight = weights[u > x ? u - x : x - u] * weights[v > y ? v - y : y - v];
            double p = luma[0][(size_t)v * c->width + u], q = luma[1][(size_t)v * c->width + u];
            sum += weight;
            a += weight * p, b += weight * q;
            aa += weight * p * p, bb += weight * q * q, ab += weight * p * q;
        }
    }
    a /= sum, b /= sum;
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double variances = aa / sum - a * a + bb / sum - b * b, covariance = ab / sum - a * b;
    return (2 * a * b + c1) * (2 * covariance + c2) / ((a * a + b * b + c1) * (variances + c2));
}

static bool measure_similarity(struct comparison *c, struct error *error) {
    double weights[WINDOW + 1], sum = 0, *luma[2] = {make_luma(c, c->a, error), NULL};
    luma[1] = luma[0] ? make_luma(c, c->b, error) : NULL;
    for (int i = 0; i <= WINDOW; i++)
        weights[i] = el_exp(-i * i / (2 * 1.5 * 1.5));
    for (uint32_t y = 0; luma[1] && y < c->height; y++)
        for (uint32_t x = 0; x < c->width; x++)
            sum += similarity_at(c, (const double *const *)luma, weights, x, y);
    bool ok = luma[1] != NULL;
    c->similarity = sum / ((double)c->width * c->height);
    mem_free(luma[0]);
    mem_free(luma[1]);
    return ok;
}

/* The picture of the difference. In PNG files the largest one is white. */

/* Number i of a row: red, green and blue of each pixel. */
static double difference_at(const struct comparison *c, uint32_t i, uint32_t y) {
    double a[4], b[4];
    pixel(c->a, i / 3, y, a);
    pixel(c->b, i / 3, y, b);
    return fabs(a[i % 3] - b[i % 3]);
}

static void row_light(void *context, uint32_t y, float *line) {
    const struct comparison *c = context;
    for (uint32_t i = 0; i < 3 * c->width; i++)
        line[i] = (float)difference_at(c, i, y);
}

static void row_bytes(void *context, uint32_t y, uint8_t *line) {
    const struct comparison *c = context;
    for (uint32_t i = 0; i < 3 * c->width; i++)
        line[i] = (uint8_t)(c->largest > 0 ? 255 * math_min(difference_at(c, i, y) / c->largest, 1) + 0.5 : 0);
}

static bool write_difference(const struct options *options, struct comparison *c, struct error *error) {
    struct picture_files files;
    const struct picture_source source = {
        .width = c->width, .height = c->height, .bytes = row_bytes, .light = row_light, .context = c};
    if (options->animation != ANIMATION_NONE || options_output_is_stream(options))
        return error_set(error, ERROR_USAGE, "-o %.600s: the difference is a picture", options->output);
    picture_files_init(&files, options);
    bool ok = picture_file_write(&(struct file_target){.path = options->output, .rules = &files.picture}, &source, NULL,
                                 error);
    picture_files_destroy(&files);
    return ok;
}

static bool measure(struct comparison *c, const char *const *names, struct error *error) {
    c->width = image_width(c->a);
    c->height = image_height(c->a);
    bool light = image_bits(c->a) == 32;
    if (c->width != image_width(c->b) || c->height != image_height(c->b))
        return error_set(error, ERROR_USAGE, "%.400s has %u x %u pixels, and %.400s %u x %u", names[0], c->width,
                         c->height, names[1], image_width(c->b), image_height(c->b));
    if (light != (image_bits(c->b) == 32))
        return error_set(error, ERROR_USAGE, "%.400s has light, and %.400s numbers for a display", names[!light],
                         names[light]);
    c->white = light ? 1 : 255;
    c->channels = image_largest(c->a).a < 1 || image_largest(c->b).a < 1 ? 4 : 3;
    for (uint32_t y = 0; y < c->height; y++)
        for (uint32_t x = 0; x < c->width; x++)
            add_pixel(c, x, y);
    return measure_similarity(c, error);
}

static void print(const struct comparison *c, const char *const *names) {
    struct digest digests[2];
    double pixels = (double)c->width * c->height, numbers = pixels * c->channels;
    bool same = file_digest(names[0], &digests[0]) && file_digest(names[1], &digests[1]) &&
                digest_equal(digests[0], digests[1]);
    (void)printf("bytes                %s\n", same ? "equal" : "different");
    (void)printf("largest difference   %.6g%s", c->white * c->largest, c->white > 1 ? " of 255" : "");
    if (c->largest > 0)
        (void)printf(" at %u,%u", c->at[0], c->at[1]);
    (void)printf("\nmean difference      %.6g\n", c->white * c->sum / numbers);
    (void)printf("pixels beyond %-6.4g %.6g %%\n", c->threshold, 100 * (double)c->beyond / pixels);
    (void)printf("relMSE               %.6g\nSSIM                 %.6f\n", c->relative / numbers, c->similarity);
}

int compare_run(const struct options *options) {
    struct error error;
    struct image *a = image_read(options->scripts[0], &error), *b = a ? image_read(options->scripts[1], &error) : NULL;
    struct comparison c = {.a = a, .b = b, .threshold = options->threshold};
    bool ok = b && measure(&c, options->scripts, &error);
    if (ok && !options->quiet)
        print(&c, options->scripts);
    ok = ok && (!options->output || write_difference(options, &c, &error));
    if (!ok)
        text_print_line(stderr, error.text);
    if (a)
        image_release(a);
    if (b)
        image_release(b);
    if (!ok)
        return error.kind == ERROR_SCENE ? ERROR_USAGE : (int)error.kind;
    return c.beyond > 0;
}
