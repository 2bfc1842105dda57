/* Where a program is a union at its root, the operands of the union are sorted along an axis; where all that end before
 * a place and all that begin behind it keep a distance, the list is cut, and the pieces are looked at along the other
 * axes. What no axis cuts is one part. The distance is larger than the rounding errors by which csg.c joins
 * crossings, so that nothing on any line can happen at once in two parts.
 *
 * Sorting is by the lower ends as single-precision numbers, rounded down, with the index in the same word. */
#include "csg/csg_split.h"

#include "base/mem.h"
#include "base/sort.h"
#include "math/portable.h"

#include <string.h>

/* Operands keep apart if they are further from each other than this, relative to their coordinates. */
#define APART 0x1p-19
/* Lists are not sorted more often than this, on average: arrangements that are cut one by one stay whole. */
enum { SORTS_PER_OPERAND = 48 };

/* What a token and those before it that belong to it make. */
struct span {
    uint32_t first; /* token */
    struct box box; /* outside of it the truth is `far` */
    bool far;
};

struct splitting {
    const struct csg_leaf *leaves;
    const struct csg_token *program;
    struct span *spans; /* of every token */
    uint32_t *operands; /* of the union at the root: their last tokens, in order */
    uint32_t count;
    uint32_t *part; /* of each operand: the first operand of its part */
    uint64_t *words;
    struct piece {
        uint32_t first, count;
    } * pieces;
    uint32_t *order;
};

static struct box tidy(struct box b) {
    return box_is_empty(&b) ? box_empty() : b;
}

/* a and b under an AND, by the rule of csg_build.c; an OR is the same with true and false exchanged. */
static struct span both(const struct span *a, const struct span *b, bool is_all) {
    bool a_decides = a->far != is_all, b_decides = b->far != is_all;
    struct span out = {.first = a->first, .far = a_decides || b_decides ? !is_all : is_all};
    out.box = a_decides && b_decides ? tidy(box_meet(a->box, b->box))
              : a_decides            ? a->box
              : b_decides            ? b->box
                                     : box_join(a->box, b->box);
    return out;
}

static struct box leaf_box(const struct csg_leaf *leaf) {
    struct box b = box_pad(shape_bounds_under(&leaf->shape, &leaf->csg_from_leaf.forward));
    if (leaf->limit)
        b = box_meet(b, box_pad(*leaf->limit));
    return tidy(b);
}

static void fill_spans(struct splitting *s, uint32_t length) {
    for (uint32_t i = 0; i < length; i++) {
        struct span *out = &s->spans[i], right, left;
        enum csg_operation operation = s->program[i].operation;
        if (operation == CSG_LEAF) {
            *out = (struct span){i, leaf_box(&s->leaves[s->program[i].leaf]), false};
            continue;
        }
        right = s->spans[i - 1];
        if (operation == CSG_INVERSE) {
            *out = (struct span){right.first, right.box, !right.far};
            continue;
        }
        left = s->spans[right.first - 1];
        right.far = right.far != (operation == CSG_DIFFERENCE);
        *out = both(&left, &right, operation != CSG_UNION);
    }
}

/* The operands of the union at the root, those of its operands that are unions in their place. */
static void find_operands(struct splitting *s, uint32_t length) {
    uint32_t depth = 0, *stack = s->part;
    stack[depth++] = length - 1;
    while (depth > 0) {
        uint32_t token = stack[--depth];
        if (s->program[token].operation == CSG_UNION) {
            stack[depth++] = token - 1;
            stack[depth++] = s->spans[token - 1].first - 1;
        } else {
            s->operands[s->count++] = token;
        }
    }
}

static float rounded_down(double x) {
    float f = (float)x;
    return (double)f > x ? math_nextafterf(f, -INFINITY) : f;
}

/* Words that sort as the numbers do. */
static uint64_t word_of(float key, uint32_t index) {
    uint32_t bits;
    memcpy(&bits, &key, sizeof bits);
    bits = bits >> 31 ? ~bits : bits | UINT32_C(1) << 31;
    return (uint64_t)bits << 32 | index;
}

static float key_of(uint64_t word) {
    uint32_t bits = (uint32_t)(word >> 32);
    float key;
    bits = bits >> 31 ? bits & ~(UINT32_C(1) << 31) : ~bits;
    memcpy(&key, &bits, sizeof key);
    return key;
}

/* Sorts a piece along an axis and cuts it at its gaps; the pieces go where `pieces` ends. False: there is none. */
static bool cut(struct splitting *s, struct piece piece, int axis, uint32_t *pieces) {
    for (uint32_t i = 0; i < piece.count; i++) {
        uint32_t operand = s->order[piece.first + i];
        s->words[i] = word_of(rounded_down(vec3_get(s->spans[s->operands[operand]].box.min, axis)), operand);
    }
    sort_words(s->words, piece.count);
    uint32_t before = *pieces, begun = 0;
    double extent = -INFINITY;
    for (uint32_t i = 0; i < piece.count; i++) {
        uint32_t operand = (uint32_t)s->words[i];
        double low = (double)key_of(s->words[i]);
        if (i > begun && low - extent > APART * (fabs(low) + fabs(extent))) {
            s->pieces[(*pieces)++] = (struct piece){piece.first + begun, i - begun};
            begun = i;
        }
        extent = math_max(extent, vec3_get(s->spans[s->operands[operand]].box.max, axis));
        s->order[piece.first + i] = operand;
    }
    if (begun == 0)
        return false;
    s->pieces[(*pieces)++] = (struct piece){piece.first + begun, piece.count - begun};
    return *pieces > before;
}

/* Fills `part`. Returns how many there are. */
static uint32_t find_parts(struct splitting *s) {
    uint32_t pieces = 0, parts = 0;
    uint64_t budget = (uint64_t)SORTS_PER_OPERAND * s->count;
    for (uint32_t i = 0; i < s->count; i++)
        s->order[i] = i;
    s->pieces[pieces++] = (struct piece){0, s->count};
    while (pieces > 0) {
        struct piece piece = s->pieces[--pieces];
        bool is_cut = false;
        for (int axis = 0; axis < 3 && piece.count > 1 && !is_cut && budget >= piece.count; axis++) {
            budget -= piece.count;
            is_cut = cut(s, piece, axis, &pieces);
        }
        if (is_cut)
            continue;
        uint32_t first = UINT32_MAX;
        for (uint32_t i = 0; i < piece.count; i++)
            first = s->order[piece.first + i] < first ? s->order[piece.first + i] : first;
        for (uint32_t i = 0; i < piece.count; i++)
            s->part[s->order[piece.first + i]] = first;
        parts++;
    }
    return parts;
}

/* One part: its operands' tokens in order, united. */
static const struct csg *build_part(struct splitting *s, struct arena *arena, uint32_t first, struct csg_leaf *leaves,
                                    struct csg_token *program, struct error *error) {
    uint32_t leaf_count = 0, length = 0;
    for (uint32_t i = first; i < s->count; i++) {
        if (s->part[i] != first)
            continue;
        for (uint32_t k = s->spans[s->operands[i]].first; k <= s->operands[i]; k++) {
            struct csg_token token = s->program[k];
            if (token.operation == CSG_LEAF) {
                leaves[leaf_count] = s->leaves[token.leaf];
                token.leaf = (uint16_t)leaf_count++;
            }
            program[length++] = token;
        }
        if (i > first)
            program[length++] = (struct csg_token){.operation = CSG_UNION};
    }
    return csg_build(arena, leaves, leaf_count, program, length, error);
}

/* Divides the operands into parts. The caller frees the contents of s in every case. False: no memory. */
static bool analyse(struct splitting *s, uint32_t length, uint32_t *parts) {
    *s = (struct splitting){.leaves = s->leaves,
                            .program = s->program,
                            .spans = mem_alloc_zero(length, sizeof *s->spans),
                            .operands = mem_alloc_zero(length, sizeof *s->operands),
                            .part = mem_alloc_zero(length, sizeof *s->part),
                            .words = mem_alloc_zero(length, sizeof *s->words),
                            .pieces = mem_alloc_zero(length, sizeof *s->pieces),
                            .order = mem_alloc_zero(length, sizeof *s->order)};
    if (!s->spans || !s->operands || !s->part || !s->words || !s->pieces || !s->order)
        return false;
    fill_spans(s, length);
    *parts = 1;
    if (!s->spans[length - 1].far) { /* in a union that is true far away all operands are connected */
        find_operands(s, length);
        *parts = find_parts(s);
    }
    return true;
}

bool csg_build_parts(struct arena *arena, const struct csg_program *program, const struct csg ***parts, uint32_t *count,
                     struct error *error) {
    struct splitting s = {.leaves = program->leaves, .program = program->tokens};
    struct csg_leaf *some_leaves = mem_alloc_zero(program->leaf_count, sizeof *some_leaves);
    struct csg_token *some_tokens = mem_alloc_zero(program->length, sizeof *some_tokens);
    *count = 0;
    bool ok = analyse(&s, program->length, count) && some_leaves && some_tokens;
    *parts = ok ? arena_alloc_array(arena, *count, sizeof **parts) : NULL;
    if (!*parts)
        ok = error_no_memory(error, "CSG");
    /* Nothing is disjoint: the program as it is. */
    if (ok && *count == 1) {
        (*parts)[0] = csg_build(arena, program->leaves, program->leaf_count, program->tokens, program->length, error);
        ok = (*parts)[0] != NULL;
    }
    /* A part has the number of its first operand. */
    uint32_t made = 0;
    for (uint32_t i = 0; ok && *count > 1 && i < s.count; i++) {
        if (s.part[i] != i)
            continue;
        (*parts)[made] = build_part(&s, arena, i, some_leaves, some_tokens, error);
        ok = (*parts)[made++] != NULL;
    }
    mem_free(some_tokens);
    mem_free(some_leaves);
    mem_free(s.order);
    mem_free(s.pieces);
    mem_free(s.words);
    mem_free(s.part);
    mem_free(s.operands);
    mem_free(s.spans);
    return ok;
}
