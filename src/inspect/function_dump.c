/* The Lua functions of a picture that were recorded: the operations of each, once, in the order of textures, solids,
 * lights, the sky and the fog. */
#include "inspect/inspect.h"

#include "base/mem.h"
#include "material/fog_field.h"
#include "shape/implicit.h"

static void dump_value(struct text_writer *writer, const struct expr_program *program, uint16_t value,
                       enum expr_type type) {
    if (value >= program->constant_count)
        text_writer_print(writer, " r%u", (unsigned)(value - program->constant_count));
    else if (type == EXPR_TYPE_F)
        text_writer_print(writer, " %.17g", program->constants[value].f);
    else
        text_writer_print(writer, " %lld", (long long)program->constants[value].i);
}

/* Prints the instructions, one per line. After a loop follow the instructions of its body, which has separate
 * registers, and the values that become its states, r0, r1, ... */
static void dump_instructions(struct text_writer *writer, const struct expr_program *program, const char *before,
                              const char *after, int indent) {
    char line[256];
    for (uint32_t i = 0; i < program->count; i++) {
        const struct expr_loop *loop = expr_repeated(program, i);
        expr_describe(program, i, line, sizeof line);
        text_writer_print(writer, "%s%*s%s%s", before, indent, "", line, after);
        if (!loop)
            continue;
        dump_instructions(writer, &loop->body, before, after, indent + 4);
        text_writer_print(writer, "%s%*sr0 ... =", before, indent + 4, "");
        for (uint32_t k = 0; k < loop->state_count; k++)
            dump_value(writer, &loop->body, loop->next[k], loop->type[k]);
        text_writer_print(writer, "%s", after);
    }
}

/* Prints the registers of the inputs, the instructions, and the registers of the results. */
static void dump_program(struct text_writer *writer, const struct expr_program *program, bool json) {
    const char *before = json ? "\"" : "    ", *after = json ? "\"," : "\n";
    for (int i = 0; i < program->input_count; i++)
        text_writer_print(writer, "%sr%u = %s%s", before,
                          (unsigned)(program->inputs[i].value - program->constant_count),
                          expr_input_name((enum expr_input)program->inputs[i].input), after);
    dump_instructions(writer, program, before, after, 0);
    text_writer_print(writer, "%sresult", before);
    for (int i = 0; i < program->output_count; i++)
        dump_value(writer, program, program->outputs[i], EXPR_TYPE_F);
    text_writer_print(writer, json ? "\"" : "\n");
}

/* The functions that were printed. */
struct functions {
    struct text_writer *writer;
    bool json, has_one;
    const struct expr_program **printed;
    uint32_t count, capacity;
};

static bool is_new(struct functions *functions, const struct expr_program *program) {
    for (uint32_t i = functions->count; i > 0; i--)
        if (functions->printed[i - 1] == program)
            return false;
    if (functions->count == functions->capacity) {
        uint32_t larger = 2 * functions->capacity + 16;
        void *moved = mem_resize_array(functions->printed, larger, sizeof *functions->printed);
        if (!moved)
            return true;
        functions->printed = moved;
        functions->capacity = larger;
    }
    functions->printed[functions->count++] = program;
    return true;
}

/* Prints a function, unless it is NULL or was printed before. */
static void dump_function(struct functions *functions, const struct expr_program *program) {
    struct text_writer *writer = functions->writer;
    const bool json = functions->json;
    if (!program || !is_new(functions, program))
        return;
    const char *source = program->source ? program->source : "";
    text_writer_print(writer, json && functions->has_one ? "," : "");
    text_writer_put(writer,
                    json ? "{\"source\":%q,\"operations\":%u,\"constants\":%u,\"registers\":%u,\"code\":["
                         : "  %n: %u operations, %u constants, %u registers\n",
                    source, program->count, program->constant_count, program->register_count);
    dump_program(writer, program, json);
    text_writer_print(writer, json ? "]}" : "");
    functions->has_one = true;
}

static void dump_shape(struct functions *functions, const struct shape *shape) {
    if (shape->kind == SHAPE_IMPLICIT)
        dump_function(functions, implicit_program(shape->implicit));
}

static void dump_geometry(struct functions *functions, const struct geometry *geometry) {
    if (!geometry->csg)
        dump_shape(functions, &geometry->shape);
    for (uint32_t i = 0; geometry->csg && i < geometry->csg->leaf_count; i++)
        dump_shape(functions, &geometry->csg->leaves[i].shape);
}

void inspect_functions(const struct inspected *picture, struct text_writer *writer) {
    const struct world *world = picture->job->world;
    const struct fog *fog = world_outside(world)->fog;
    struct functions functions = {.writer = writer, .json = picture->json};
    text_writer_put(writer, picture->json ? "{\"picture\":%q,\"functions\":[" : "%n: functions\n", picture->file);
    for (uint32_t i = 0; i < world->surfaces.textures.count; i++)
        if (world->surfaces.textures.operations[i].kind == TEXTURE_FUNCTION)
            dump_function(&functions, world->surfaces.textures.operations[i].recorded.program);
    for (uint32_t i = 0; i < world->prototype_count; i++)
        dump_geometry(&functions, &world->prototypes[i].geometry);
    for (uint32_t i = 0; i < world->light_count; i++)
        dump_function(&functions, world->lights[i].profile);
    dump_function(&functions, world->sky.kind == SKY_FUNCTION ? world->sky.program : NULL);
    if (fog && fog->kind == FOG_FIELD) {
        dump_function(&functions, fog_field_density(fog->field));
        dump_function(&functions, fog_field_colour(fog->field));
    }
    text_writer_print(writer, picture->json ? "]}\n" : functions.has_one ? "" : "  none\n");
    text_writer_flush(writer);
    mem_free(functions.printed);
}
