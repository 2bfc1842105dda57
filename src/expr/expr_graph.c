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
#define LOOP_DESCRIPTION(member, name, result, a, b, c)                                                                \
    [member] = {name, EXPR_TYPE_##result, {EXPR_TYPE_##a, EXPR_TYPE_##b, EXPR_TYPE_##c}},
static const struct description descriptions[] = {EXPR_OPERATIONS(DESCRIPTION) EXPR_LOOP_OPERATIONS(LOOP_DESCRIPTION)};

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
    EXPR_LOOP_CASES:
    case EXPR_ALL_OPERATIONS:
    case EXPR_CONSTANT:
    case EXPR_INPUT:
    case EXPR_OPERATION_COUNT:
        break;
    }
    return out;
}

void expr_graph_destroy(struct expr_graph *graph) {
    for (uint32_t k = 0; k < graph->loop_count; k++)
        mem_free(graph->loops[k].arguments);
    mem_free(graph->loops);
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
    struct expr_node node = {EXPR_CONSTANT, type, {EXPR_NONE, EXPR_NONE, EXPR_NONE}, 0, value};
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
                  &(struct expr_node){EXPR_INPUT, EXPR_TYPE_F, {(uint32_t)input, EXPR_NONE, EXPR_NONE}, 0, {.i = 0}});
}

uint32_t expr_symbol(struct expr_graph *graph, uint32_t depth, uint32_t slot, enum expr_type type) {
    return intern(graph,
                  &(struct expr_node){EXPR_INPUT, type, {EXPR_INPUT_COUNT + slot, depth, EXPR_NONE}, depth, {.i = 0}});
}

bool expr_is_symbol(const struct expr_node *node) {
    return node->operation == EXPR_INPUT && node->operands[0] >= EXPR_INPUT_COUNT;
}

uint32_t expr_symbol_slot(const struct expr_node *node) {
    return node->operands[0] - EXPR_INPUT_COUNT;
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
    struct expr_node node = {operation, expr_result_type(operation), {a, b, c}, 0, {.i = 0}};
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
        uint32_t depth = graph->nodes[node.operands[k]].depth;
        node.depth = depth > node.depth ? depth : node.depth;
        known = known && value;
        if (value)
            values[k] = *value;
    }
    if (known)
        return constant(graph, node.type, expr_apply(operation, values[0], values[1], values[2]));
    uint32_t old = simpler(graph, operation, node.operands);
    return old != EXPR_NONE ? old : intern(graph, &node);
}

/* --- loops --- */

/* Marks the nodes that the body of a loop needs, by their depth: those of its own depth, which it computes, and those
 * from outside that it reads. False: no memory. */
static bool mark_body(const struct expr_graph *graph, const struct expr_graph_loop *loop, bool **needed) {
    *needed = mem_alloc_zero((size_t)graph->count + 1, sizeof **needed);
    if (!*needed)
        return false;
    for (uint32_t k = 0; k < loop->state_count; k++)
        (*needed)[loop->next[k]] = true;
    for (uint32_t n = graph->count; n-- > 0;) {
        const struct expr_node *node = &graph->nodes[n];
        for (int k = 0; (*needed)[n] && node->depth == loop->depth && k < expr_operand_count(node->operation); k++)
            (*needed)[node->operands[k]] = true;
    }
    return true;
}

static bool is_computed(const struct expr_node *node, uint32_t depth) {
    return node->depth == depth && node->operation != EXPR_INPUT;
}

uint32_t expr_body_size(const struct expr_graph *graph, const struct expr_graph_loop *loop) {
    bool *needed;
    uint32_t count = 0;
    if (!mark_body(graph, loop, &needed))
        return 0;
    for (uint32_t n = 0; n < graph->count; n++)
        count += needed[n] && is_computed(&graph->nodes[n], loop->depth);
    mem_free(needed);
    return count;
}

/* The arguments of a loop: the initial states, then what its body reads from outside, but for constants. After them, as
 * many nodes, the results of the body. NULL: no memory. */
static uint32_t *list_arguments(const struct expr_graph *graph, const struct expr_graph_loop *loop, uint32_t *count) {
    bool *needed;
    if (!mark_body(graph, loop, &needed))
        return NULL;
    *count = loop->state_count;
    for (uint32_t n = 0; n < graph->count; n++) {
        needed[n] = needed[n] && graph->nodes[n].depth < loop->depth && graph->nodes[n].operation != EXPR_CONSTANT;
        *count += needed[n];
    }
    uint32_t *out = mem_alloc_zero((size_t)*count + loop->state_count, sizeof *out), at = loop->state_count;
    for (uint32_t n = 0; out && n < graph->count; n++)
        if (needed[n])
            out[at++] = n;
    for (uint32_t k = 0; out && k < loop->state_count; k++) {
        out[k] = loop->initial[k];
        out[*count + k] = loop->next[k];
    }
    mem_free(needed);
    return out;
}

static bool is_same_loop(const struct expr_kept_loop *kept, const struct expr_graph_loop *loop,
                         const uint32_t *arguments, uint32_t count) {
    const struct expr_graph_loop *other = &kept->loop;
    return kept->argument_count == count && other->first == loop->first && other->last == loop->last &&
           other->depth == loop->depth && other->ends == loop->ends && other->state_count == loop->state_count &&
           memcmp(kept->arguments, arguments, ((size_t)count + loop->state_count) * sizeof *arguments) == 0;
}

static uint32_t loop_operation(struct expr_graph *graph, enum expr_operation operation, const uint32_t operands[3],
                               uint32_t depth) {
    struct expr_node node = {
        operation, expr_result_type(operation), {operands[0], operands[1], operands[2]}, depth, {.i = 0}};
    for (int k = 0; k < expr_operand_count(operation); k++)
        if (operands[k] == EXPR_NONE)
            return EXPR_NONE;
    return intern(graph, &node);
}

/* Of each type. */
static const enum expr_operation puts_of[] = {EXPR_PUT_FLOAT, EXPR_PUT_INTEGER, EXPR_PUT_TRUTH};
static const enum expr_operation takes_of[] = {EXPR_TAKE_FLOAT, EXPR_TAKE_INTEGER, EXPR_TAKE_TRUTH};

static uint32_t loop_depth(const struct expr_graph *graph, const struct expr_kept_loop *kept) {
    uint32_t depth = 0;
    for (uint32_t k = 0; k < kept->argument_count; k++) {
        uint32_t of_argument = graph->nodes[kept->arguments[k]].depth;
        depth = of_argument > depth ? of_argument : depth;
    }
    return depth;
}

/* The instructions that fill and run a loop. Their depth is that of the deepest argument. */
static uint32_t run_node(struct expr_graph *graph, const struct expr_kept_loop *kept, uint32_t number) {
    uint32_t depth = loop_depth(graph, kept), last = expr_integer(graph, 0);
    for (uint32_t k = 0; k < kept->argument_count; k++) {
        enum expr_type type = graph->nodes[kept->arguments[k]].type;
        const uint32_t operands[3] = {last, kept->arguments[k], expr_integer(graph, expr_loop_operand(number, k))};
        last = loop_operation(graph, puts_of[type], operands, depth);
    }
    const uint32_t operands[3] = {last, expr_integer(graph, expr_loop_operand(number, 0)), EXPR_NONE};
    return loop_operation(graph, EXPR_LOOP, operands, depth);
}

/* Appends a loop; owns the arguments. */
static bool keep_loop(struct expr_graph *graph, const struct expr_kept_loop *loop) {
    if (graph->loop_count == graph->loop_capacity) {
        uint32_t capacity = graph->loop_capacity ? 2 * graph->loop_capacity : 16;
        struct expr_kept_loop *loops = mem_resize_array(graph->loops, capacity, sizeof *loops);
        if (!loops)
            return false;
        graph->loops = loops;
        graph->loop_capacity = capacity;
    }
    graph->loops[graph->loop_count++] = *loop;
    return true;
}

bool expr_loop(struct expr_graph *graph, const struct expr_graph_loop *loop, uint32_t *states) {
    struct expr_kept_loop kept = {.loop = *loop, .node = EXPR_NONE};
    uint32_t number = 0;
    kept.arguments = list_arguments(graph, loop, &kept.argument_count);
    graph->out_of_memory = graph->out_of_memory || !kept.arguments;
    if (!kept.arguments)
        return false;
    kept.loop.initial = kept.arguments;
    kept.loop.next = kept.arguments + kept.argument_count;
    /* A loop that is there already is not kept again. */
    while (number < graph->loop_count &&
           !is_same_loop(&graph->loops[number], loop, kept.arguments, kept.argument_count))
        number++;
    bool is_new = number == graph->loop_count;
    bool fits = kept.argument_count <= UINT16_MAX && loop->state_count <= EXPR_STATES;
    graph->full = graph->full || !fits;
    if (!is_new || !fits || !keep_loop(graph, &kept)) {
        mem_free(kept.arguments);
        graph->out_of_memory = graph->out_of_memory || (is_new && fits);
        if (is_new)
            return false;
    }
    uint32_t node = graph->loops[number].node = run_node(graph, &graph->loops[number], number);
    /* One operation takes each state out of it. */
    for (uint32_t k = 0; k < loop->state_count; k++) {
        enum expr_type type = graph->nodes[loop->next[k]].type;
        const uint32_t operands[3] = {node, expr_integer(graph, expr_loop_operand(number, k)), EXPR_NONE};
        uint32_t depth = node != EXPR_NONE ? graph->nodes[node].depth : 0;
        states[k] = loop_operation(graph, takes_of[type], operands, depth);
        if (states[k] == EXPR_NONE)
            return false;
    }
    return true;
}
