/* A picture of the sign of a function of x and y between -1 and 1, by tiles: a tile whose sign bounds decide is painted
 * at once, the others are divided and their program is shortened (M. Keeter, "Massively parallel rendering of complex
 * closed-form implicit surfaces", SIGGRAPH 2020). And a reader of the form in which that paper's example is published:
 * one operation a line, "_2a max _4 _7". For bench/expr.c and tests/unit/expr/test_expr_prospero.c. */
#ifndef GRAY_BENCH_PROSPERO_H
#define GRAY_BENCH_PROSPERO_H

#include "expr/expr_shorten.h"

#include "base/mem.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PROSPERO_LINES = 16384, PROSPERO_LEVELS = 3, PROSPERO_CODE = 1 << 16 };

/* The graph of a file and its last line. False: there is no such file, or it cannot be read. */
static bool prospero_read(const char *name, struct expr_graph *graph, uint32_t *root) {
    static const struct {
        const char *name;
        enum expr_operation operation;
    } operations[] = {{"neg", EXPR_NEGATE},   {"square", EXPR_MULTIPLY}, {"sqrt", EXPR_SQRT}, {"add", EXPR_ADD},
                      {"sub", EXPR_SUBTRACT}, {"mul", EXPR_MULTIPLY},    {"min", EXPR_MIN},   {"max", EXPR_MAX}};
    static uint32_t nodes[PROSPERO_LINES];
    char line[256], word[32];
    uint32_t count = 0;
    FILE *file = fopen(name, "r");
    bool fine = file != NULL;
    while (fine && fgets(line, sizeof line, file)) {
        unsigned number, a = 0, b = 0;
        int at = 0;
        if (sscanf(line, "_%x %31s %n", &number, word, &at) != 2)
            continue;
        fine = number == count && count < PROSPERO_LINES;
        if (!fine)
            break;
        uint32_t node = EXPR_NONE;
        int operands = sscanf(line + at, "_%x _%x", &a, &b);
        if (strcmp(word, "const") == 0)
            node = expr_float(graph, strtod(line + at, NULL));
        else if (strcmp(word, "var-x") == 0 || strcmp(word, "var-y") == 0)
            node = expr_input(graph, word[4] == 'x' ? EXPR_POINT_X : EXPR_POINT_Y);
        for (size_t i = 0; i < sizeof operations / sizeof operations[0] && operands > 0 && a < count && b < count; i++)
            if (strcmp(word, operations[i].name) == 0)
                node = expr_operation(graph, operations[i].operation, nodes[a],
                                      strcmp(word, "square") == 0 ? nodes[a] : nodes[b], EXPR_NONE);
        fine = node != EXPR_NONE;
        nodes[count++] = node;
    }
    if (file)
        (void)fclose(file);
    *root = count ? nodes[count - 1] : EXPR_NONE;
    return fine && count > 0;
}

struct prospero {
    int size;       /* a power of two, at least 256 */
    uint8_t *image; /* size * size: 255 where the function is negative */
    double *at;     /* positions of the pixels */
    struct expr_choice *choices[PROSPERO_LEVELS];
    struct expr_stack stack;
    void *rows, *scratch;
};

static bool prospero_init(struct prospero *p, const struct expr_program *program, int size) {
    *p = (struct prospero){.size = size};
    size_t bounds = expr_intervals_size(program), batch = expr_batch_size(program);
    p->image = mem_alloc_zero((size_t)size, (size_t)size);
    p->at = mem_alloc_zero((size_t)size, sizeof *p->at);
    bool fine = p->image && p->at;
    for (int i = 0; i < PROSPERO_LEVELS; i++) {
        p->choices[i] = mem_alloc_zero((size_t)program->count + 1, sizeof *p->choices[i]);
        fine = fine && p->choices[i];
    }
    p->stack.code = mem_alloc_zero(PROSPERO_CODE, sizeof *p->stack.code);
    p->stack.free = PROSPERO_CODE;
    p->rows = mem_alloc_aligned(64, bounds > batch ? bounds : batch);
    p->scratch = mem_alloc_aligned(64, expr_shorten_size(program));
    for (int i = 0; fine && i < size; i++)
        p->at[i] = (2 * i + 1) / (double)size - 1;
    return fine && p->stack.code && p->rows && p->scratch;
}

static void prospero_destroy(struct prospero *p) {
    mem_free(p->image);
    mem_free(p->at);
    for (int i = 0; i < PROSPERO_LEVELS; i++)
        mem_free(p->choices[i]);
    mem_free(p->stack.code);
    mem_free(p->rows);
    mem_free(p->scratch);
}

/* 8 x 8 pixels; y goes down in the picture. */
static void prospero_leaf(struct prospero *p, const struct expr_program *program, int x0, int y0) {
    double x[EXPR_BATCH], y[EXPR_BATCH], value[EXPR_BATCH];
    const double *in[EXPR_INPUT_COUNT] = {x, y};
    double *out[EXPR_OUTPUTS] = {value};
    for (int i = 0; i < EXPR_BATCH; i++) {
        x[i] = p->at[x0 + i % 8];
        y[i] = -p->at[y0 + i / 8];
    }
    expr_evaluate_batch(program, EXPR_BATCH, in, out, p->rows);
    for (int i = 0; i < EXPR_BATCH; i++)
        p->image[(size_t)(y0 + i / 8) * (size_t)p->size + (size_t)(x0 + i % 8)] = value[i] < 0 ? 255 : 0;
}

static void prospero_tile(struct prospero *p, const struct expr_program *program, int level, int x0, int y0, int size) {
    static const int sizes[PROSPERO_LEVELS] = {256, 64, 8};
    const int child = sizes[level], across = size / child;
    for (int first = 0; first < across * across; first += EXPR_BOXES) {
        int count = across * across - first < EXPR_BOXES ? across * across - first : EXPR_BOXES;
        double ends[4][EXPR_BOXES];
        struct expr_boxes boxes = {(uint32_t)count, {ends[0], ends[2]}, {ends[1], ends[3]}};
        struct expr_bounds bounds[EXPR_OUTPUTS];
        for (int i = 0; i < count; i++) {
            int x = x0 + (first + i) % across * child, y = y0 + (first + i) / across * child;
            ends[0][i] = p->at[x];
            ends[1][i] = p->at[x + child - 1];
            ends[2][i] = -p->at[y + child - 1];
            ends[3][i] = -p->at[y];
        }
        expr_evaluate_intervals(program, &boxes, bounds, p->choices[level], p->rows);
        uint64_t open = 0;
        for (int i = 0; i < count; i++)
            if (bounds->may_be_nan >> i & 1 || !(bounds->high[i] < 0 || bounds->low[i] >= 0))
                open |= (uint64_t)1 << i;
        for (int i = 0; i < count; i++) {
            int x = x0 + (first + i) % across * child, y = y0 + (first + i) / across * child;
            for (int row = 0; row < child && !(open >> i & 1); row++)
                memset(p->image + (size_t)(y + row) * (size_t)p->size + (size_t)x, bounds->high[i] < 0 ? 255 : 0,
                       (size_t)child);
            if (!(open >> i & 1))
                continue;
            size_t used = p->stack.free;
            struct expr_program shorter;
            if (!expr_shorten(program, p->choices[level], (uint32_t)i, &p->stack, p->scratch, &shorter))
                shorter = *program;
            if (level == PROSPERO_LEVELS - 1)
                prospero_leaf(p, &shorter, x, y);
            else
                prospero_tile(p, &shorter, level + 1, x, y, child);
            p->stack.free = used;
        }
    }
}

static void prospero_render(struct prospero *p, const struct expr_program *program) {
    prospero_tile(p, program, 0, 0, 0, p->size);
}

#endif
