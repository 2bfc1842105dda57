/* Registers of a program are used again; in the text each value has a number of its own, so a reader needs no rule for
 * the lives of registers. It builds the graph anew: equal nodes are one, and the results of a program do not depend on
 * the order of its instructions. Values of the body of a loop are forgotten behind its `next`, since a symbol of the
 * graph has a meaning only within its loop. */
#include "expr/expr_text.h"

#include "base/json_write.h"
#include "base/mem.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const type_names[] = {
    [EXPR_TYPE_F] = "float", [EXPR_TYPE_I] = "integer", [EXPR_TYPE_B] = "truth", [EXPR_TYPE_N] = ""};

/* --- writing --- */

/* A constant if the number is EXPR_NONE. */
struct operand {
    uint32_t number;
    enum expr_type type;
    union expr_value constant;
};

struct text {
    struct document *out;
    struct expr_images *images;
    uint32_t count; /* numbers in use */
};

static void put_float(struct text *t, double x) {
    char words[JSON_NUMBER];
    json_number(words, x);
    document_add(t->out, " %s", words);
}

static void put_operand(struct text *t, const struct operand *operand) {
    if (operand->number != EXPR_NONE)
        document_add(t->out, " v%u", (unsigned)operand->number);
    else if (operand->type == EXPR_TYPE_F)
        put_float(t, operand->constant.f);
    else if (operand->type == EXPR_TYPE_B)
        document_add(t->out, operand->constant.i ? " true" : " false");
    else
        document_add(t->out, " %lld", (long long)operand->constant.i);
}

/* map: of the registers. */
static struct operand operand_of(const struct expr_program *program, const struct operand *map, uint16_t value,
                                 enum expr_type type) {
    if (value < program->constant_count)
        return (struct operand){EXPR_NONE, type, program->constants[value]};
    return map[value - program->constant_count];
}

static bool put_image(struct text *t, int64_t operand, struct error *error) {
    const struct image_function *function = expr_texel_function(operand);
    int at = 0;
    while (at < t->images->count && t->images->items[at] != function)
        at++;
    if (at == EXPR_IMAGES)
        return error_set(error, ERROR_SCENE, "a function reads more than %d pictures", EXPR_IMAGES);
    t->images->items[at] = function;
    t->images->count += at == t->images->count;
    document_add(t->out, " image%d.%d", at + 1, (int)(operand & 3));
    return true;
}

static bool put_code(struct text *t, const struct expr_program *program, struct operand *map, struct error *error);

/* outside: by the slots of the loop, what was put there; its states are replaced by those after the loop. */
static bool put_loop(struct text *t, const struct expr_loop *loop, struct operand *outside, struct error *error) {
    const struct expr_program *body = &loop->body;
    struct operand *map = mem_alloc_zero((size_t)body->register_count + 1, sizeof *map);
    if (!map)
        return error_no_memory(error, "a function");
    uint32_t step = t->count;
    document_add(t->out, "loop v%u %u %u %s", (unsigned)step, loop->first, loop->last, loop->ends ? "while" : "all");
    for (uint32_t k = 0; k < loop->state_count; k++) {
        outside[k].type = loop->type[k];
        document_add(t->out, " %s", type_names[loop->type[k]]);
        put_operand(t, &outside[k]);
    }
    document_add(t->out, "; ");
    map[loop->argument_count] = (struct operand){step, EXPR_TYPE_I, {.i = 0}};
    for (uint32_t k = 0; k < loop->argument_count; k++)
        map[k] = k < loop->state_count ? (struct operand){step + 1 + k, loop->type[k], {.i = 0}} : outside[k];
    t->count += 1 + loop->state_count;
    bool ok = put_code(t, body, map, error);
    document_add(t->out, "next v%u", (unsigned)t->count);
    for (uint32_t k = 0; ok && k < loop->state_count; k++) {
        struct operand next = operand_of(body, map, loop->next[k], loop->type[k]);
        put_operand(t, &next);
        outside[k] = (struct operand){t->count + k, loop->type[k], {.i = 0}};
    }
    t->count += loop->state_count;
    document_add(t->out, "; ");
    mem_free(map);
    return ok;
}

static bool put_instruction(struct text *t, const struct expr_program *program, const struct expr_instruction *in,
                            struct operand *map, struct error *error) {
    const enum expr_operation operation = (enum expr_operation)in->operation;
    const uint16_t operands[3] = {in->a, in->b, in->c};
    document_add(t->out, "v%u = %s", (unsigned)t->count, expr_operation_name(operation));
    for (int k = 0; k < expr_operand_count(operation); k++) {
        const enum expr_type type = expr_operand_type(operation, k);
        const struct operand value = operand_of(program, map, operands[k], type);
        if (operation == EXPR_TEXEL && k == 2) {
            if (!put_image(t, value.constant.i, error))
                return false;
        } else {
            put_operand(t, &value);
        }
    }
    document_add(t->out, "; ");
    map[in->out - program->constant_count] = (struct operand){t->count++, expr_result_type(operation), {.i = 0}};
    return true;
}

static bool put_code(struct text *t, const struct expr_program *program, struct operand *map, struct error *error) {
    struct operand **outside = mem_alloc_zero((size_t)program->loop_count + 1, sizeof(struct operand *));
    bool ok = outside != NULL;
    for (uint32_t k = 0; ok && k < program->loop_count; k++) {
        outside[k] = mem_alloc_zero((size_t)program->loops[k].argument_count + 1, sizeof **outside);
        ok = outside[k] != NULL;
    }
    if (!ok)
        (void)error_no_memory(error, "a function");
    for (uint32_t i = 0; ok && i < program->count; i++) {
        const struct expr_instruction *in = &program->code[i];
        if (in->operation <= EXPR_OPERATION_COUNT) {
            ok = put_instruction(t, program, in, map, error);
            continue;
        }
        const struct expr_loop_access at = expr_loop_access(program, in);
        struct operand *slots = outside[at.loop - program->loops];
        if (at.puts)
            slots[at.slot] = operand_of(program, map, in->b, expr_operand_type((enum expr_operation)in->operation, 1));
        else if (in->operation == EXPR_LOOP)
            ok = put_loop(t, at.loop, slots, error);
        else
            map[in->out - program->constant_count] = slots[at.slot];
    }
    for (uint32_t k = 0; outside && k < program->loop_count; k++)
        mem_free(outside[k]);
    mem_free(outside);
    return ok;
}

bool expr_write_text(const struct expr_program *program, struct document *out, struct expr_images *images,
                     struct error *error) {
    struct text t = {.out = out, .images = images};
    struct operand *map = mem_alloc_zero((size_t)program->register_count + 1, sizeof *map);
    if (!map)
        return error_no_memory(error, "a function");
    for (int i = 0; i < program->input_count; i++) {
        document_add(out, "v%u = %s; ", (unsigned)t.count, expr_input_name((enum expr_input)program->inputs[i].input));
        map[program->inputs[i].value - program->constant_count] = (struct operand){t.count++, EXPR_TYPE_F, {.i = 0}};
    }
    bool ok = put_code(&t, program, map, error);
    document_add(out, "result");
    for (int i = 0; ok && i < program->output_count; i++) {
        struct operand value = operand_of(program, map, program->outputs[i], EXPR_TYPE_F);
        put_operand(&t, &value);
    }
    mem_free(map);
    return ok && (!out->failed || error_no_memory(error, "a function"));
}

/* --- reading --- */

/* LOOP_STEPS: as many as a recorded loop has. WORK: instructions of a point. */
enum { WORD = 64, LOOP_STEPS = 10000 };
#define WORK UINT64_C(100000000)

struct open_loop {
    struct expr_graph_loop loop;
    uint32_t step; /* its number */
    uint32_t initial[EXPR_STATES], next[EXPR_STATES];
};

struct reading {
    struct expr_graph graph;
    const struct expr_images *images;
    const char *at;
    char word[WORD]; /* the one that was read last; "" at the end of a statement */
    uint32_t *nodes; /* by number; EXPR_NONE: it is forgotten */
    uint32_t count;
    struct open_loop loops[EXPR_DEPTH];
    uint32_t depth;
    struct error *error;
};

static bool fail(struct reading *r, const char *what) {
    return error_set(r->error, ERROR_SCENE, "code: v%u: %s, at '%.60s'", (unsigned)r->count, what, r->word);
}

/* Reads a word of a statement. False: the statement has ended. */
static bool next_word(struct reading *r) {
    size_t length = 0;
    r->at += strspn(r->at, " \t\r");
    if (*r->at != ';' && *r->at != '\n')
        length = strcspn(r->at, " \t\r\n;");
    (void)snprintf(r->word, sizeof r->word, "%.*s", (int)(length < WORD ? length : WORD - 1), r->at);
    r->at += length;
    return length > 0;
}

static bool add_number(struct reading *r, uint32_t node) {
    if (node == EXPR_NONE || r->count == EXPR_NODES)
        return r->graph.out_of_memory ? error_no_memory(r->error, "a function") : fail(r, "the function is too long");
    r->nodes[r->count++] = node;
    return true;
}

/* A value of that type. */
static bool read_operand(struct reading *r, enum expr_type type, uint32_t *node) {
    char *end = r->word;
    (void)next_word(r);
    if (r->word[0] == 'v') {
        unsigned long number = strtoul(r->word + 1, &end, 10);
        if (end == r->word + 1 || *end || number >= r->count || r->nodes[number] == EXPR_NONE)
            return fail(r, "this value is not known here");
        *node = r->nodes[number];
        return r->graph.nodes[*node].type == type || fail(r, "this value has another type");
    }
    bool is_word = strcmp(r->word, "true") == 0 || strcmp(r->word, "false") == 0;
    if (type == EXPR_TYPE_F && r->word[0]) {
        double x = strtod(r->word, &end);
        *node = *end ? EXPR_NONE : expr_float(&r->graph, x);
    } else if (type == EXPR_TYPE_I && r->word[0]) {
        long long x = strtoll(r->word, &end, 10);
        *node = *end ? EXPR_NONE : expr_integer(&r->graph, x);
    } else if (type == EXPR_TYPE_B && is_word) {
        end += strlen(r->word);
        *node = expr_truth(&r->graph, r->word[0] == 't');
    }
    if (end == r->word || *end)
        return fail(r, "a value is missing");
    return *node != EXPR_NONE || add_number(r, *node);
}

static bool read_image(struct reading *r, uint32_t *node) {
    unsigned long image = 0, channel = 4;
    char *end = r->word;
    if (next_word(r) && strncmp(r->word, "image", 5) == 0)
        image = strtoul(r->word + 5, &end, 10);
    if (*end == '.' && end[1])
        channel = strtoul(end + 1, &end, 10);
    if (*end || image < 1 || image > EXPR_IMAGES || channel >= TEXEL_CHANNELS || !r->images->items[image - 1])
        return fail(r, "a picture such as image1.0 is missing");
    *node = expr_integer(&r->graph, expr_texel_operand(r->images->items[image - 1], (int)channel));
    return *node != EXPR_NONE || add_number(r, *node);
}

/* "v7" of the next value. */
static bool read_number(struct reading *r) {
    char wanted[WORD];
    (void)snprintf(wanted, sizeof wanted, "v%u", (unsigned)r->count);
    return strcmp(r->word, wanted) == 0 || fail(r, "the next value has another number");
}

static bool read_value(struct reading *r) {
    uint32_t operands[3] = {EXPR_NONE, EXPR_NONE, EXPR_NONE};
    if (!read_number(r))
        return false;
    if (!next_word(r) || strcmp(r->word, "=") != 0 || !next_word(r))
        return fail(r, "= and an operation are missing");
    for (int i = 0; i < EXPR_INPUT_COUNT; i++)
        if (strcmp(r->word, expr_input_name((enum expr_input)i)) == 0)
            return add_number(r, expr_input(&r->graph, (enum expr_input)i));
    int operation = EXPR_INPUT + 1;
    while (operation < EXPR_OPERATION_COUNT &&
           strcmp(r->word, expr_operation_name((enum expr_operation)operation)) != 0)
        operation++;
    if (operation == EXPR_OPERATION_COUNT)
        return fail(r, "this is no operation");
    for (int k = 0; k < expr_operand_count((enum expr_operation)operation); k++) {
        bool is_image = operation == EXPR_TEXEL && k == 2;
        if (!(is_image ? read_image(r, &operands[k])
                       : read_operand(r, expr_operand_type((enum expr_operation)operation, k), &operands[k])))
            return false;
    }
    return add_number(r,
                      expr_operation(&r->graph, (enum expr_operation)operation, operands[0], operands[1], operands[2]));
}

static bool read_step(struct reading *r, uint32_t *step) {
    char *end = r->word;
    unsigned long x = next_word(r) ? strtoul(r->word, &end, 10) : 0;
    *step = (uint32_t)x;
    return (end != r->word && !*end && x >= 1 && x <= LOOP_STEPS) || fail(r, "a loop has steps from 1 to 10000");
}

static bool begin_loop(struct reading *r) {
    if (r->depth == EXPR_DEPTH)
        return fail(r, "loops are too deep in each other");
    struct open_loop *open = &r->loops[r->depth];
    struct expr_graph_loop *loop = &open->loop;
    *loop = (struct expr_graph_loop){.depth = r->depth + 1, .initial = open->initial, .next = open->next};
    open->step = r->count;
    (void)next_word(r);
    if (!read_number(r) || !read_step(r, &loop->first) || !read_step(r, &loop->last))
        return false;
    (void)next_word(r);
    loop->ends = strcmp(r->word, "while") == 0;
    if (loop->first > loop->last || (!loop->ends && strcmp(r->word, "all") != 0))
        return fail(r, "a loop has its first step, its last step, and while or all");
    enum expr_type types[EXPR_STATES];
    for (; next_word(r); loop->state_count++) {
        int type = EXPR_TYPE_F;
        while (type < EXPR_TYPE_N && strcmp(r->word, type_names[type]) != 0)
            type++;
        if (type == EXPR_TYPE_N || loop->state_count == EXPR_STATES)
            return fail(r, "a state is float, integer or truth, and its first value");
        types[loop->state_count] = (enum expr_type)type;
        if (!read_operand(r, (enum expr_type)type, &open->initial[loop->state_count]))
            return false;
    }
    if (loop->state_count == 0 || (loop->ends && types[0] == EXPR_TYPE_B))
        return fail(r, "a loop has a state, and one with while begins with a number");
    bool ok = add_number(r, expr_symbol(&r->graph, loop->depth, 0, EXPR_TYPE_I));
    for (uint32_t k = 0; ok && k < loop->state_count; k++)
        ok = add_number(r, expr_symbol(&r->graph, loop->depth, k + 1, types[k]));
    r->depth++;
    return ok;
}

static bool end_loop(struct reading *r) {
    if (r->depth == 0)
        return fail(r, "next without a loop");
    struct open_loop *open = &r->loops[r->depth - 1];
    uint32_t states[EXPR_STATES];
    (void)next_word(r);
    if (!read_number(r))
        return false;
    for (uint32_t k = 0; k < open->loop.state_count; k++)
        if (!read_operand(r, r->graph.nodes[open->initial[k]].type, &open->next[k]))
            return false;
    if (!expr_loop(&r->graph, &open->loop, states))
        return add_number(r, EXPR_NONE);
    for (uint32_t k = open->step; k < r->count; k++)
        r->nodes[k] = EXPR_NONE;
    r->depth--;
    for (uint32_t k = 0; k < open->loop.state_count; k++)
        if (!add_number(r, states[k]))
            return false;
    return true;
}

/* Reads statements up to the result. */
static bool read_code(struct reading *r, uint32_t outputs[EXPR_OUTPUTS], int *output_count) {
    for (;;) {
        r->at += strspn(r->at, " \t\r\n;");
        if (!next_word(r))
            return fail(r, "the result is missing");
        if (strcmp(r->word, "result") == 0)
            break;
        if (!(strcmp(r->word, "loop") == 0   ? begin_loop(r)
              : strcmp(r->word, "next") == 0 ? end_loop(r)
                                             : read_value(r)))
            return false;
        if (r->word[0] && next_word(r))
            return fail(r, "the statement goes on");
    }
    if (r->depth > 0)
        return fail(r, "a loop has no end");
    for (*output_count = 0; r->at += strspn(r->at, " \t\r\n;"), *r->at; ++*output_count)
        if (*output_count == 3 || !read_operand(r, EXPR_TYPE_F, &outputs[*output_count]))
            return *output_count == 3 ? fail(r, "a result is a number or three") : false;
    return *output_count == 1 || *output_count == 3 || fail(r, "a result is a number or three");
}

bool expr_read_text(const char *text, const struct expr_images *images, struct arena *arena,
                    struct expr_program *program, struct error *error) {
    struct reading r = {.images = images, .at = text, .error = error};
    uint32_t outputs[EXPR_OUTPUTS];
    int count = 0;
    r.nodes = mem_alloc_zero(EXPR_NODES, sizeof *r.nodes);
    bool ok = r.nodes ? read_code(&r, outputs, &count) : error_no_memory(error, "a function");
    ok = ok && expr_compile(&r.graph, outputs, count, arena, program, error);
    if (ok && expr_work(program) > WORK)
        ok = error_set(error, ERROR_SCENE, "code: more than %llu operations for a point", (unsigned long long)WORK);
    expr_graph_destroy(&r.graph);
    mem_free(r.nodes);
    return ok;
}
