/* Hash-consing and constant folding. An identity is applied only if it holds for NaN, infinities and both zeros: x *
 * 1, x / 1, x - 0 and x + -0 become x. x + 0 stays, because -0 + 0 is 0. */
#include "expr/expr_graph.h"

#include "base/mem.h"
#include "base/random.h"

#include <string.h>

struct description {
    const char *name;
    enum expr_type result, operands[3];
};

#define DESCRIPTION(member, name, result, a, b, c, expression)                                                         \
    [member] = {name, EXPR_TYPE_##result, {EXPR_TYPE_##a, EXPR_TYPE_##b, EXPR_TYPE_##c}},
static const struct description descriptions[] = {EXPR_OPERATIONS(DESCRIPTION)};

const char *expr_operation_name(enum expr_operation operation) {
    return descriptions[operation].name;
}

enum expr_type expr_result_type(enum expr_operation operation) {
    return descriptions[operation].result;
}

enum expr_type expr_operand_type(enum expr_operation operation, int operand) {
    return descriptions[operation].operands[operand];
}

int expr_operand_count(enum expr_operation operation) {
    int count = 0;
    if (operation == EXPR_CONSTANT || operation == EXPR_INPUT)
        return 0;
    while (count < 3 && descriptions[operation].operands[count] != EXPR_TYPE_N)
        count++;
    return count;
}

const char *expr_input_name(enum expr_input input) {
#define INPUT_WORD(member, word) [member] = (word),
    static const char *const words[] = {EXPR_INPUTS(INPUT_WORD)};
    return words[input];
}

#define APPLY(member, name, R, A, B, C, expression)                                                                    \
    case member: {                                                                                                     \
        EXPR_C_TYPE_##A a = x.EXPR_MEMBER_##A;                                                                         \
        EXPR_C_TYPE_##B b = y.EXPR_MEMBER_##B;                                                                         \
        EXPR_C_TYPE_##C c = z.EXPR_MEMBER_##C;                                                                         \
        (void)a, (void)b, (void)c;                                                                                     \
        out.EXPR_MEMBER_##R = (expression);                                                                            \
        break;                                                                                                         \
    }

union expr_value expr_apply(enum expr_operation operation, union expr_value x, union expr_value y, union expr_value z) {
    union expr_value out = {.i = 0};
    switch (operation) {
        EXPR_OPERATIONS(APPLY)
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
        break;
    }
    return out;
}

void expr_graph_destroy(struct expr_graph *graph) {
    mem_free(graph->nodes);
    mem_free(graph->slots);
    *graph = (struct expr_graph){.count = 0};
}

static uint64_t hash_of(const struct expr_node *node) {
    uint64_t key = random_combine((uint64_t)node->operation << 8 | (uint64_t)node->type, (uint64_t)node->constant.i);
    key = random_combine(key, (uint64_t)node->operands[0] << 32 | node->operands[1]);
    return random_combine(key, node->operands[2]);
}

static bool same(const struct expr_node *a, const struct expr_node *b) {
    return a->operation == b->operation && a->type == b->type && a->constant.i == b->constant.i &&
           memcmp(a->operands, b->operands, sizeof a->operands) == 0;
}

/* The slot of an equal node, or the free slot where it belongs. */
static uint32_t *find(const struct expr_graph *graph, const struct expr_node *node) {
    for (uint64_t at = hash_of(node);; at++) {
        uint32_t *slot = &graph->slots[at & (graph->slot_count - 1)];
        if (*slot == EXPR_NONE || same(&graph->nodes[*slot], node))
            return slot;
    }
}

static bool grow(struct expr_graph *graph) {
    uint32_t capacity = graph->capacity ? graph->capacity * 2 : 256;
    struct expr_node *nodes = mem_resize_array(graph->nodes, capacity, sizeof *nodes);
    if (!nodes)
        return false;
    graph->nodes = nodes;
    uint32_t *slots = mem_resize_array(graph->slots, (size_t)capacity * 2, sizeof *slots);
    if (!slots)
        return false;
    graph->slots = slots;
    graph->capacity = capacity;
    graph->slot_count = capacity * 2;
    memset(slots, 0xff, (size_t)graph->slot_count * sizeof *slots); /* EXPR_NONE */
    for (uint32_t i = 0; i < graph->count; i++)
        *find(graph, &nodes[i]) = i;
    return true;
}

static uint32_t intern(struct expr_graph *graph, const struct expr_node *node) {
    if (graph->count == graph->capacity && !grow(graph)) {
        graph->out_of_memory = true;
        return EXPR_NONE;
    }
    uint32_t *slot = find(graph, node);
    if (*slot != EXPR_NONE)
        return *slot;
    if (graph->count >= EXPR_NODES) {
        graph->full = true;
        return EXPR_NONE;
    }
    graph->nodes[graph->count] = *node;
    return *slot = graph->count++;
}

static uint32_t constant(struct expr_graph *graph, enum expr_type type, union expr_value value) {
    struct expr_node node = {EXPR_CONSTANT, type, {EXPR_NONE, EXPR_NONE, EXPR_NONE}, value};
    if (type == EXPR_TYPE_F && value.f != value.f)
        node.constant.f = (double)NAN; /* one NaN */
    return intern(graph, &node);
}

uint32_t expr_float(struct expr_graph *graph, double x) {
    return constant(graph, EXPR_TYPE_F, (union expr_value){.f = x});
}

uint32_t expr_integer(struct expr_graph *graph, int64_t x) {
    return constant(graph, EXPR_TYPE_I, (union expr_value){.i = x});
}

uint32_t expr_truth(struct expr_graph *graph, bool x) {
    return constant(graph, EXPR_TYPE_B, (union expr_value){.i = -(int64_t)x});
}

uint32_t expr_input(struct expr_graph *graph, enum expr_input input) {
    return intern(graph,
                  &(struct expr_node){EXPR_INPUT, EXPR_TYPE_F, {(uint32_t)input, EXPR_NONE, EXPR_NONE}, {.i = 0}});
}

const union expr_value *expr_constant(const struct expr_graph *graph, uint32_t node) {
    return node != EXPR_NONE && graph->nodes[node].operation == EXPR_CONSTANT ? &graph->nodes[node].constant : NULL;
}

static bool is_float(const struct expr_graph *graph, uint32_t node, double x) {
    const union expr_value *value = expr_constant(graph, node), wanted = {.f = x};
    return value && value->i == wanted.i;
}

/* The result of the operation if an identity gives it, else EXPR_NONE. */
static uint32_t simpler(const struct expr_graph *graph, enum expr_operation operation, const uint32_t operands[3]) {
    uint32_t a = operands[0], b = operands[1];
    bool is_select = operation == EXPR_SELECT || operation == EXPR_INTEGER_SELECT || operation == EXPR_TRUTH_SELECT;
    const union expr_value *condition = is_select ? expr_constant(graph, a) : NULL;
    if (condition)
        return condition->i ? b : operands[2];
    if (is_select && b == operands[2])
        return b;
    if (operation == EXPR_MULTIPLY && (is_float(graph, a, 1) || is_float(graph, b, 1)))
        return is_float(graph, a, 1) ? b : a;
    if ((operation == EXPR_DIVIDE && is_float(graph, b, 1)) || (operation == EXPR_SUBTRACT && is_float(graph, b, 0)) ||
        (operation == EXPR_ADD && is_float(graph, b, -0.0)))
        return a;
    return EXPR_NONE;
}

uint32_t expr_operation(struct expr_graph *graph, enum expr_operation operation, uint32_t a, uint32_t b, uint32_t c) {
    struct expr_node node = {operation, expr_result_type(operation), {a, b, c}, {.i = 0}};
    union expr_value values[3] = {{.i = 0}, {.i = 0}, {.i = 0}};
    int count = expr_operand_count(operation);
    bool known = true;
    for (int k = 0; k < 3; k++) {
        if (k >= count) {
            node.operands[k] = EXPR_NONE;
            continue;
        }
        if (node.operands[k] == EXPR_NONE)
            return EXPR_NONE;
        const union expr_value *value = expr_constant(graph, node.operands[k]);
        known = known && value;
        if (value)
            values[k] = *value;
    }
    if (known)
        return constant(graph, node.type, expr_apply(operation, values[0], values[1], values[2]));
    uint32_t old = simpler(graph, operation, node.operands);
    return old != EXPR_NONE ? old : intern(graph, &node);
}
