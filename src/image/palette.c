/* Median cut (Heckbert, Color Image Quantization for Frame Buffer Display, 1982) over cells of 4 levels in each
 * channel: the box with the largest sum of squared distances along an axis is cut at the median of that axis, until
 * there are 256. Only whole numbers: the same palette everywhere.
 * Dithering is ordered (Bayer, An Optimum Method for Two-Level Rendition of Continuous-Tone Pictures, 1973). */
#include "image/palette_internal.h"

#include "base/mem.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELL_BITS = 6, CELLS = 1 << (3 * CELL_BITS), CELL_SHIFT = 8 - CELL_BITS, NOT_FOUND = UINT16_MAX };

struct cell {
    uint64_t count, sum[3];
};

struct palette_count {
    struct cell cells[CELLS];
};

struct palette_count *palette_count_create(void) {
    return mem_alloc_zero(1, sizeof(struct palette_count));
}

void palette_count_destroy(struct palette_count *count) {
    mem_free(count);
}

void palette_count_clear(struct palette_count *count) {
    memset(count, 0, sizeof *count);
}

static uint32_t cell_of(const uint8_t rgb[3]) {
    return (uint32_t)(rgb[0] >> CELL_SHIFT) << (2 * CELL_BITS) | (uint32_t)(rgb[1] >> CELL_SHIFT) << CELL_BITS |
           (uint32_t)(rgb[2] >> CELL_SHIFT);
}

void palette_count_add(struct palette_count *count, const uint8_t *rgb, size_t pixels) {
    for (size_t i = 0; i < pixels; i++, rgb += 3) {
        struct cell *cell = &count->cells[cell_of(rgb)];
        cell->count++;
        for (int c = 0; c < 3; c++)
            cell->sum[c] += rgb[c];
    }
}

/* A cell that occurs. */
struct counted_colour {
    uint64_t count;
    uint32_t cell;
    uint8_t mean[3];
};

/* Colours from first to before last. */
struct cut_box {
    size_t first, last;
    int axis;
    double spread; /* sum of squared distances from the mean along the axis */
};

static int by_channel(const void *left, const void *right, int channel) {
    const struct counted_colour *a = left, *b = right;
    if (a->mean[channel] != b->mean[channel])
        return a->mean[channel] < b->mean[channel] ? -1 : 1;
    return a->cell < b->cell ? -1 : a->cell > b->cell;
}

static int by_red(const void *a, const void *b) {
    return by_channel(a, b, 0);
}

static int by_green(const void *a, const void *b) {
    return by_channel(a, b, 1);
}

static int by_blue(const void *a, const void *b) {
    return by_channel(a, b, 2);
}

/* Sums are whole numbers below 2^53 for pictures with up to 10^11 pixels, and so exact. */
static void measure(const struct counted_colour *colours, struct cut_box *box) {
    box->spread = -1;
    for (int channel = 0; channel < 3; channel++) {
        double count = 0, sum = 0, squares = 0;
        for (size_t i = box->first; i < box->last; i++) {
            double value = colours[i].mean[channel], weight = (double)colours[i].count;
            count += weight;
            sum += weight * value;
            squares += weight * value * value;
        }
        double spread = squares - sum * sum / count;
        if (spread > box->spread) {
            box->spread = spread;
            box->axis = channel;
        }
    }
    if (box->last - box->first < 2)
        box->spread = -1;
}

/* Cuts the box at the median of its axis; the second half is the result. */
static struct cut_box cut(struct counted_colour *colours, struct cut_box *box) {
    static int (*const order[3])(const void *, const void *) = {by_red, by_green, by_blue};
    uint64_t all = 0, below = 0;
    qsort(colours + box->first, box->last - box->first, sizeof *colours, order[box->axis]);
    for (size_t i = box->first; i < box->last; i++)
        all += colours[i].count;
    size_t middle = box->first;
    do
        below += colours[middle++].count;
    while (middle + 1 < box->last && 2 * below < all);
    struct cut_box rest = {.first = middle, .last = box->last};
    box->last = middle;
    measure(colours, box);
    measure(colours, &rest);
    return rest;
}

static int squared_distance(const uint8_t a[3], const uint8_t b[3]) {
    int sum = 0;
    for (int c = 0; c < 3; c++)
        sum += (a[c] - b[c]) * (a[c] - b[c]);
    return sum;
}

/* The mean distance between a colour and the nearest other one, for one channel. */
static int spread_of(const struct palette *palette) {
    enum { SPREAD_MAX = 48 };
    double sum = 0;
    for (int i = 0; i < palette->count; i++) {
        int nearest = INT32_MAX;
        for (int k = 0; k < palette->count; k++) {
            int distance = squared_distance(palette->colours[i], palette->colours[k]);
            nearest = k != i && distance < nearest ? distance : nearest;
        }
        sum += sqrt((double)nearest / 3);
    }
    int mean = palette->count > 1 ? (int)(sum / palette->count + 0.5) : 0;
    return mean > SPREAD_MAX ? SPREAD_MAX : mean;
}

static void put_colours(const struct palette_count *count, const struct counted_colour *colours,
                        const struct cut_box *boxes, struct palette *out) {
    for (int k = 0; k < out->count; k++) {
        uint64_t all = 0, sum[3] = {0};
        for (size_t i = boxes[k].first; i < boxes[k].last; i++) {
            const struct cell *cell = &count->cells[colours[i].cell];
            all += cell->count;
            for (int c = 0; c < 3; c++)
                sum[c] += cell->sum[c];
        }
        for (int c = 0; c < 3; c++)
            out->colours[k][c] = (uint8_t)((2 * sum[c] + all) / (2 * all));
    }
}

bool palette_make(const struct palette_count *count, struct palette *out) {
    struct cut_box boxes[PALETTE_COLOURS];
    size_t used = 0, all = 0;
    for (uint32_t cell = 0; cell < CELLS; cell++)
        all += count->cells[cell].count > 0;
    *out = (struct palette){0};
    struct counted_colour *colours = mem_alloc_zero(all + 1, sizeof *colours);
    if (!colours)
        return false;
    /* The mean of a cell stands for its colours. */
    for (uint32_t number = 0; number < CELLS; number++) {
        const struct cell *cell = &count->cells[number];
        if (cell->count == 0)
            continue;
        colours[used] = (struct counted_colour){.count = cell->count, .cell = number};
        for (int c = 0; c < 3; c++)
            colours[used].mean[c] = (uint8_t)((2 * cell->sum[c] + cell->count) / (2 * cell->count));
        used++;
    }
    boxes[0] = (struct cut_box){.last = used};
    measure(colours, &boxes[0]);
    int made = used > 0;
    /* Median cut: always the box whose colours differ most. */
    while (made > 0 && made < PALETTE_COLOURS) {
        int widest = 0;
        for (int k = 1; k < made; k++)
            widest = boxes[k].spread > boxes[widest].spread ? k : widest;
        if (boxes[widest].spread < 0)
            break;
        boxes[made] = cut(colours, &boxes[widest]);
        made++;
    }
    out->count = made;
    put_colours(count, colours, boxes, out);
    out->spread = used > PALETTE_COLOURS ? spread_of(out) : 0;
    mem_free(colours);
    return true;
}

struct palette_search {
    struct palette palette;
    uint16_t found[CELLS]; /* by cell: its colour, or NOT_FOUND */
};

struct palette_search *palette_search_create(void) {
    return mem_alloc(sizeof(struct palette_search));
}

void palette_search_destroy(struct palette_search *search) {
    mem_free(search);
}

void palette_search_begin(struct palette_search *search, const struct palette *palette) {
    search->palette = *palette;
    memset(search->found, 0xff, sizeof search->found);
    for (int k = 0; palette->spread == 0 && k < palette->count; k++) /* each of them is the mean of its cell */
        search->found[cell_of(palette->colours[k])] = (uint16_t)k;
}

int palette_threshold(uint32_t x, uint32_t y) {
    int value = 0;
    for (int bit = 0; bit < 3; bit++) { /* the bits of x ^ y and y, from the highest of the value on */
        uint32_t row = y >> bit & 1, column = x >> bit & 1;
        value = value << 2 | (int)((row ^ column) << 1 | row);
    }
    return 4 * value - 126;
}

uint8_t palette_find(struct palette_search *search, const uint8_t rgb[3], uint32_t x, uint32_t y) {
    int shift = search->palette.spread * palette_threshold(x, y) / 256;
    uint8_t wanted[3];
    for (int c = 0; c < 3; c++) {
        int value = rgb[c] + shift;
        wanted[c] = (uint8_t)(value < 0 ? 0 : value > 255 ? 255 : value);
    }
    uint32_t cell = cell_of(wanted);
    if (search->found[cell] != NOT_FOUND)
        return (uint8_t)search->found[cell];
    const uint8_t middle[3] = {(uint8_t)((wanted[0] & ~3) + 2), (uint8_t)((wanted[1] & ~3) + 2),
                               (uint8_t)((wanted[2] & ~3) + 2)};
    int best = 0, best_distance = INT32_MAX;
    for (int k = 0; k < search->palette.count; k++) {
        int distance = squared_distance(search->palette.colours[k], middle);
        if (distance < best_distance) {
            best_distance = distance;
            best = k;
        }
    }
    search->found[cell] = (uint16_t)best;
    return (uint8_t)best;
}
