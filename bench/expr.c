/* Expressions: time of an operation, at one point and in batches, and against Lua. Each program is made at random from
 * a class of operations, as a graph and as the text of a Lua function at once; both are called at the same points, and
 * their results are compared. One thread; the median of seven runs. */
#include "bench/prospero.h"

#include "base/isa.h"
#include "base/mem.h"
#include "base/random.h"
#include "expr/expr_program.h"

#include <lauxlib.h>
#include <lualib.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { RUNS = 7, POINTS = 4096, LUA_POINTS = 512, TEXT = 1 << 16, VALUES = 32, FUNCTIONS = 5 };

enum class { ARITHMETIC, TRIGONOMETRY, NOISE, BRANCHES, CLASSES };
static const char *const class_names[] = {"arithmetic", "trigonometry and exponentials", "noise", "branches"};

/* A program in both forms. The last VALUES values may be operands; Lua has a local variable for each of them. */
struct sample {
    struct expr_graph graph;
    struct arena arena;
    struct expr_program program;
    char text[TEXT];
    size_t used;
};

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

__attribute__((format(printf, 2, 3))) static void say(struct sample *s, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    s->used += (size_t)vsnprintf(s->text + s->used, TEXT - s->used, format, arguments);
    va_end(arguments);
}

/* Values stay of moderate size: sums are halved, products and quotients are of values that are. */
static uint32_t add_operation(struct sample *s, enum class class, uint64_t bits, uint32_t a, uint32_t b, int va, int vb,
                              int out) {
    struct expr_graph *g = &s->graph;
    uint32_t half = expr_float(g, 0.5);
    unsigned kind = (unsigned)(bits >> 40) % 4;
    if (class == TRIGONOMETRY && kind < 3) {
        static const enum expr_operation operations[] = {EXPR_SIN, EXPR_COS, EXPR_EXP};
        static const char *const words[] = {"sin", "cos", "exp"};
        say(s, "v%d = math.%s(v%d)\n", out, words[kind], va);
        uint32_t x = expr_operation(g, operations[kind], a, EXPR_NONE, EXPR_NONE);
        if (kind < 2)
            return x;
        say(s, "v%d = math.sin(v%d)\n", out, out);
        return expr_operation(g, EXPR_SIN, x, EXPR_NONE, EXPR_NONE);
    }
    if (class == NOISE && kind < 2) {
        say(s, "v%d = noise(v%d, v%d, 0.5)\n", out, va, vb);
        return expr_operation(g, EXPR_NOISE, a, b, half);
    }
    if (class == BRANCHES && kind == 0) {
        say(s, "if v%d < v%d then v%d = v%d * 0.5 else v%d = v%d - 0.5 end\n", va, vb, out, va, out, vb);
        return expr_operation(g, EXPR_SELECT, expr_operation(g, EXPR_LESS, a, b, EXPR_NONE),
                              expr_operation(g, EXPR_MULTIPLY, a, half, EXPR_NONE),
                              expr_operation(g, EXPR_SUBTRACT, b, half, EXPR_NONE));
    }
    switch (kind) {
    case 0:
        say(s, "v%d = v%d + v%d\n", out, va, vb);
        return expr_operation(g, EXPR_ADD, a, b, EXPR_NONE);
    case 1:
        say(s, "v%d = v%d - v%d\n", out, va, vb);
        return expr_operation(g, EXPR_SUBTRACT, a, b, EXPR_NONE);
    case 2:
        say(s, "v%d = v%d * v%d\n", out, va, vb);
        return expr_operation(g, EXPR_MULTIPLY, a, b, EXPR_NONE);
    default:
        say(s, "v%d = v%d * 0.5\n", out, va);
        return expr_operation(g, EXPR_MULTIPLY, a, half, EXPR_NONE);
    }
}

/* Every value is read, so that nothing of it is left out: each operation takes the one before. */
static void sample_make(struct sample *s, enum class class, uint32_t operations, uint64_t seed) {
    uint32_t values[VALUES], last = 2;
    memset(s, 0, sizeof *s);
    say(s, "local noise = ...\nreturn function(x, y, z)\nlocal v0, v1, v2 = x, y, z\nlocal v3");
    for (int i = 4; i < VALUES; i++)
        say(s, ", v%d", i);
    say(s, "\n");
    for (int i = 0; i < 3; i++)
        values[i] = expr_input(&s->graph, (enum expr_input)(EXPR_POINT_X + i));
    for (uint32_t n = 0, filled = 3; n < operations; n++) {
        uint64_t bits = random_combine(seed, n);
        uint32_t b = (uint32_t)(bits % filled), out = filled < VALUES ? filled : (uint32_t)((bits >> 20) % VALUES);
        values[out] = add_operation(s, class, bits, values[last], values[b], (int)last, (int)b, (int)out);
        last = out;
        filled += filled < VALUES;
    }
    say(s, "return v%u\nend\n", last);
    struct error error = {0};
    if (!expr_compile(&s->graph, &values[last], 1, &s->arena, &s->program, &error))
        exit(1);
}

static void sample_free(struct sample *s) {
    arena_destroy(&s->arena);
    expr_graph_destroy(&s->graph);
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double points[3][POINTS], results[POINTS];

static void run_single(const struct sample *s) {
    for (int i = 0; i < POINTS; i++) {
        double in[EXPR_INPUT_COUNT], out[EXPR_OUTPUTS];
        for (int k = 0; k < 3; k++)
            in[k] = points[k][i];
        expr_evaluate(&s->program, in, out);
        results[i] = out[0];
    }
}

static void *rows;
static void run_batches(const struct sample *s) {
    for (int i = 0; i < POINTS; i += EXPR_BATCH) {
        const double *in[EXPR_INPUT_COUNT] = {points[0] + i, points[1] + i, points[2] + i};
        double *out[EXPR_OUTPUTS] = {results + i, NULL, NULL, NULL};
        expr_evaluate_batch(&s->program, EXPR_BATCH, in, out, rows);
    }
}

/* Seconds a point. */
static double time_of(const struct sample *s, void (*run)(const struct sample *)) {
    double times[RUNS];
    for (int r = 0; r < RUNS; r++) {
        double begin = now();
        int repeats = 0;
        for (; repeats == 0 || now() - begin < 0.02; repeats++)
            run(s);
        times[r] = (now() - begin) / repeats / POINTS;
    }
    qsort(times, RUNS, sizeof times[0], compare);
    return times[RUNS / 2];
}

static int lua_noise(lua_State *L) {
    lua_pushnumber(L, noise_perlin(luaL_checknumber(L, 1), luaL_checknumber(L, 2), luaL_checknumber(L, 3), 0));
    return 1;
}

/* Seconds a point, called from C for each. The results must be those in `results`. */
static double time_of_lua(const struct sample *s) {
    lua_State *L = luaL_newstate();
    double times[RUNS];
    luaL_openlibs(L);
    if (luaL_loadstring(L, s->text) != LUA_OK) {
        fprintf(stderr, "%s\n", lua_tostring(L, -1));
        exit(1);
    }
    lua_pushcfunction(L, lua_noise);
    lua_call(L, 1, 1);
    for (int r = 0; r < RUNS; r++) {
        double begin = now();
        for (int i = 0; i < LUA_POINTS; i++) {
            lua_pushvalue(L, -1);
            for (int k = 0; k < 3; k++)
                lua_pushnumber(L, points[k][i]);
            lua_call(L, 3, 1);
            double value = lua_tonumber(L, -1);
            lua_pop(L, 1);
            if (memcmp(&value, &results[i], sizeof value) != 0 && (value == value || results[i] == results[i])) {
                fprintf(stderr, "Lua gives %a, not %a\n", value, results[i]);
                exit(1);
            }
        }
        times[r] = (now() - begin) / LUA_POINTS;
    }
    lua_close(L);
    qsort(times, RUNS, sizeof times[0], compare);
    return times[RUNS / 2];
}

/* --- a loop --- */

enum { STEPS = 1000 };

/* The number of steps of the Mandelbrot set, until |z| > 2, as a loop. */
static void mandelbrot_make(struct sample *s) {
    struct expr_graph *g = &s->graph;
    memset(s, 0, sizeof *s);
    uint32_t cx = expr_input(g, EXPR_POINT_X), cy = expr_input(g, EXPR_POINT_Y), zero = expr_float(g, 0);
    const uint32_t one = expr_float(g, 1), initial[4] = {one, zero, zero, expr_integer(g, 0)};
    uint32_t x = expr_symbol(g, 1, 2, EXPR_TYPE_F), y = expr_symbol(g, 1, 3, EXPR_TYPE_F), states[4];
    uint32_t k = expr_symbol(g, 1, 4, EXPR_TYPE_I), xx = expr_operation(g, EXPR_MULTIPLY, x, x, EXPR_NONE);
    uint32_t yy = expr_operation(g, EXPR_MULTIPLY, y, y, EXPR_NONE);
    uint32_t size = expr_operation(g, EXPR_ADD, xx, yy, EXPR_NONE);
    uint32_t double_x = expr_operation(g, EXPR_MULTIPLY, expr_float(g, 2), x, EXPR_NONE);
    uint32_t real = expr_operation(g, EXPR_SUBTRACT, xx, yy, EXPR_NONE);
    uint32_t imaginary = expr_operation(g, EXPR_MULTIPLY, double_x, y, EXPR_NONE);
    const uint32_t next[4] = {expr_operation(g, EXPR_SUBTRACT, expr_float(g, 4), size, EXPR_NONE),
                              expr_operation(g, EXPR_ADD, real, cx, EXPR_NONE),
                              expr_operation(g, EXPR_ADD, imaginary, cy, EXPR_NONE),
                              expr_operation(g, EXPR_INTEGER_ADD, k, expr_integer(g, 1), EXPR_NONE)};
    const struct expr_graph_loop loop = {
        .first = 1, .last = STEPS, .depth = 1, .state_count = 4, .initial = initial, .next = next, .ends = true};
    struct error error = {0};
    uint32_t result = expr_loop(g, &loop, states) ? expr_operation(g, EXPR_TO_FLOAT, states[3], 0, 0) : EXPR_NONE;
    if (result == EXPR_NONE || !expr_compile(g, &result, 1, &s->arena, &s->program, &error))
        exit(1);
    say(s,
        "return function(cx, cy)\n local x, y, k = 0.0, 0.0, 0\n for i = 1, %d do local xx, yy = x * x, y * y\n"
        " x, y, k = xx - yy + cx, 2 * x * y + cy, k + 1\n if 4 - (xx + yy) <= 0 then break end end\n"
        " return k + 0.0\nend\n",
        STEPS);
}

static void measure_loop(void) {
    static struct sample s;
    mandelbrot_make(&s);
    double single = time_of(&s, run_single), batch = time_of(&s, run_batches), of_lua = time_of_lua(&s);
    printf("  Mandelbrot, %d steps         %8.1f    %8.1f\n", STEPS, of_lua / single, of_lua / batch);
    printf("\n640 x 480 points of it: %.2f s one by one, %.2f s in batches, %.2f s in Lua\n", single * 640 * 480,
           batch * 640 * 480, of_lua * 640 * 480);
    sample_free(&s);
}

/* Milliseconds of a picture of the sign, without reading the file. */
static double time_of_picture(const struct expr_program *program, int size) {
    struct prospero p;
    double times[RUNS];
    if (!prospero_init(&p, program, size))
        exit(1);
    for (int r = 0; r < RUNS; r++) {
        double begin = now();
        prospero_render(&p, program);
        times[r] = 1e3 * (now() - begin);
    }
    prospero_destroy(&p);
    qsort(times, RUNS, sizeof times[0], compare);
    return times[RUNS / 2];
}

static void measure_prospero(const char *name) {
    struct expr_graph graph = {.count = 0};
    struct arena arena = {0};
    struct error error = {0};
    struct expr_program program;
    uint32_t root;
    if (prospero_read(name, &graph, &root) && expr_compile(&graph, &root, 1, &arena, &program, &error))
        printf("\nProspero, %u operations, signs: 1024 x 1024 in %.1f ms, 4096 x 4096 in %.1f ms\n", program.count,
               time_of_picture(&program, 1024), time_of_picture(&program, 4096));
    else
        printf("\nProspero: %s is not there\n", name);
    arena_destroy(&arena);
    expr_graph_destroy(&graph);
}

int main(int argc, char **argv) {
    static struct sample s;
    rows = mem_alloc_aligned(64, (size_t)1 << 20);
    if (argc > 2 && !cpu_select_isa(argv[2]))
        return 2;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < POINTS; i++)
            points[k][i] = 4 * random_unit(random_combine((uint64_t)k, (uint64_t)i)) - 2;
    printf("instruction set: %s\n\n", argc > 2 ? argv[2] : "auto");
    printf("ns an operation, arithmetic    one point    batch of %d\n", EXPR_BATCH);
    static const uint32_t lengths[] = {10, 50, 200};
    for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
        sample_make(&s, ARITHMETIC, lengths[i], 1);
        double operations = (double)s.program.count;
        double single = time_of(&s, run_single), batch = time_of(&s, run_batches);
        printf("  %3.0f operations               %8.2f    %8.3f\n", operations, 1e9 * single / operations,
               1e9 * batch / operations);
        sample_free(&s);
    }
    printf("\ntimes faster than Lua called for each point (geometric mean of %d functions)\n"
           "                                one point    batch of %d\n",
           FUNCTIONS, EXPR_BATCH);
    for (int class = 0; class < CLASSES; class ++) {
        double single = 0, batch = 0;
        for (uint64_t f = 0; f < FUNCTIONS; f++) {
            sample_make(&s, (enum class) class, class == BRANCHES ? 200 : 40, 10 + f);
            double of_single = time_of(&s, run_single), of_batch = time_of(&s, run_batches);
            double of_lua = time_of_lua(&s);
            single += log(of_lua / of_single) / FUNCTIONS;
            batch += log(of_lua / of_batch) / FUNCTIONS;
            sample_free(&s);
        }
        printf("  %-29s %8.1f    %8.1f\n", class_names[class], exp(single), exp(batch));
    }
    measure_loop();
    mem_free(rows);
    measure_prospero(argc > 1 ? argv[1] : "../shared/models/prospero.vm");
    return 0;
}
