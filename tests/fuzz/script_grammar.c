/* See script_grammar.h. A script is a prelude, statements until the bytes or the buffer run out, and a picture of all
 * nodes. Most numbers are small; others are the ends of ranges and extreme values of double precision. */
#include "tests/fuzz/script_grammar.h"

#include "script/table_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

struct grammar {
    const uint8_t *at, *end;
    char *out;
    size_t used;
};

enum { STATEMENT_ROOM = 12000, STATEMENTS = 60 };

static const char prelude[] =
    "local N, M, L, T, F, V, S = {gr.node('root')}, {gr.material({1, 1, 1}, {0, 0, 0}, 1)}, {}, {}, {}, {}, {}\n"
    "local function k(list, ok, v) if ok and v ~= nil then list[#list + 1] = v end end\n"
    "local function n(i) return N[i % #N + 1] end\n"
    "local function m(i) return M[i % #M + 1] end\n"
    "local function l(i) return L[i % (#L + 1)] end\n"
    "local function t(i) return T[i % (#T + 1)] end\n"
    "local function f(i) return F[i % (#F + 1)] end\n"
    "local function v(i) return V[i % (#V + 1)] end\n"
    "local function s(i) return S[i % (#S + 1)] end\n"
    "local self = {} self[1], self[2], self.name = self, self, self\n"
    "local W = {nil, true, print, {}, '', 'x', 1e308, {{{}}}, {1, nil, 3}, '\\0', ('y'):rep(5000), '%s%n', self,\n"
    "  setmetatable({}, {__index = function() error('no') end}),\n"
    "  setmetatable({}, {__index = function(_, i) return i end, __len = function() return 1 << 40 end}),\n"
    "  setmetatable({1, 2, 3}, {__len = function() return -1 end, __pairs = function() error(self) end}),\n"
    "  setmetatable({}, {__tostring = function() return nil end, __name = 7}), coroutine.create(print),\n"
    "  '12', '0x1p-3', -0.0, 2^53, math.mininteger, {name = 1, [1.5] = 2, [true] = 3}, io.stdout, gr, 'n' , n(0)}\n"
    "local function w(i) return W[i % 28 + 1] end\n";

static const char ending[] =
    "for i = 2, #N do pcall(N[1].add_child, N[1], N[i]) end\n"
    "pcall(gr.render, N[1], 'last.png', 8, 8, {0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 50, {0.3, 0.3, 0.3}, L)\n";

static unsigned next(struct grammar *g) {
    return g->at < g->end ? *g->at++ : 0;
}

__attribute__((format(printf, 2, 3))) static void say(struct grammar *g, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(g->out + g->used, SCRIPT_GRAMMAR_SIZE - g->used, format, arguments);
    va_end(arguments);
    if (length > 0)
        g->used += (size_t)length < SCRIPT_GRAMMAR_SIZE - g->used ? (size_t)length : SCRIPT_GRAMMAR_SIZE - 1 - g->used;
}

static void say_number(struct grammar *g, const struct script_parameter *p) {
    static const char *const odd[] = {"0",     "1",     "-1",     "0.5",   "1e-9",   "1e-300", "5e-324", "-1e-5",
                                      "1e9",   "1e150", "-1e150", "1e300", "0/0",    "1/0",    "-1/0",   "-0.0",
                                      "2^53",  "2^31",  "1e5",    "90",    "180",    "360",    "1e-5",   "1e-30",
                                      "0.999", "1e19",  "-0.5",   "3",     "1e-160", "1e30",   "45",     "2^-1022"};
    bool bounded = p && (p->low != 0 || p->high != 0);
    unsigned how = next(g), value = next(g);
    double x = ((double)value - 128) / 16;
    if (how < 24) {
        say(g, "%s", odd[value % (sizeof odd / sizeof *odd)]);
    } else if (bounded && how < 40) {
        say(g, "%.17g", isfinite(p->high) && how % 2 ? p->high : p->low);
    } else {
        if (bounded)
            x = isfinite(p->high) && p->high - p->low < 1000 ? p->low + (p->high - p->low) * (value / 255.0)
                                                             : p->low + value / 16.0;
        say(g, "%.6g", p && p->kind == KIND_WHOLE ? floor(x) : x);
    }
}

static void say_tuple(struct grammar *g, const struct script_parameter *p, unsigned count) {
    for (unsigned i = 0; i < count; i++) {
        say(g, i ? ", " : "{");
        say_number(g, p);
    }
    say(g, count ? "}" : "{}");
}

/* {tuple, tuple ...}, each of `min` to `max` numbers. */
static void say_tuples(struct grammar *g, unsigned limit, unsigned min, unsigned max) {
    unsigned count = next(g) % (limit + 1), length = min + next(g) % (max - min + 1);
    say(g, "{");
    for (unsigned i = 0; i < count; i++) {
        bool other = next(g) < 8;
        say_tuple(g, NULL, other ? next(g) % (max + 2) : length);
        say(g, ", ");
    }
    say(g, "}");
}

static void say_indices(struct grammar *g) {
    unsigned count = next(g) % 12, length = 3 + next(g) % 3;
    length = next(g) < 24 ? 16 : length;
    say(g, "{");
    for (unsigned i = 0; i < count; i++) {
        say(g, "{");
        for (unsigned j = 0; j < length; j++)
            say(g, "%u,", next(g) % 12);
        say(g, "}, ");
    }
    say(g, "}");
}

static void say_list(struct grammar *g, const char *function) {
    unsigned count = next(g) % 5;
    say(g, "{");
    for (unsigned i = 0; i < count; i++)
        say(g, "%s(%u), ", function, next(g));
    say(g, "}");
}

static void say_word(struct grammar *g, const char *words) {
    unsigned count = 1;
    for (const char *c = words; *c; c++)
        count += *c == ' ';
    for (unsigned skip = next(g) % count; skip > 0; skip--)
        words = strchr(words, ' ') + 1;
    say(g, "'%.*s'", (int)strcspn(words, " "), words);
}

static const char *one_of(struct grammar *g, const char *const *list, size_t count) {
    return list[next(g) % count];
}
#define ONE_OF(g, ...)                                                                                                 \
    one_of(g, (const char *const[]){__VA_ARGS__}, sizeof((const char *const[]){__VA_ARGS__}) / sizeof(const char *))

static void say_argument(struct grammar *g, const struct script_parameter *p) {
    if (next(g) < 12) {
        say(g, "w(%u)", next(g));
        return;
    }
    switch (p->kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
        say_number(g, p);
        return;
    case KIND_BOOLEAN:
        say(g, "%s", next(g) % 2 ? "true" : "false");
        return;
    case KIND_TEXT:
        say(g, "%s", ONE_OF(g, "'thing'", "'a b'", "''", "'\\xff\\xfe'", "'it\\nis'", "('z'):rep(300)"));
        return;
    case KIND_FILE:
        say(g, "%s",
            ONE_OF(g, "'flag.obj'", "'letters.ttf'", "'flag.ply'", "'cross.png'", "'flag.stl'", "'nothing'",
                   "'../up.obj'", "'/etc/passwd'", "'flag.gltf'", "'.'"));
        return;
    case KIND_OUTPUT:
        say(g, "%s", ONE_OF(g, "'out.png'", "'a/b.pfm'", "'x.0.png'", "'../x.png'", "'out.exr'"));
        return;
    case KIND_CHOICE:
    case KIND_AXIS:
        say_word(g, p->choices);
        return;
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_COLOUR:
    case KIND_TRIPLE:
        say_tuple(g, p, 3);
        return;
    case KIND_SIZE:
        say_tuple(g, p, 3);
        return;
    case KIND_INTERVAL:
    case KIND_PAIR:
        say_tuple(g, p, 2);
        return;
    case KIND_QUATERNION:
        say_tuple(g, p, 4);
        return;
    case KIND_NODE:
        say(g, "n(%u)", next(g));
        return;
    case KIND_MATERIAL:
        say(g, "m(%u)", next(g));
        return;
    case KIND_MATERIALS:
        if (next(g) % 2)
            say_list(g, "m");
        else
            say(g, "{red = m(%u), [''] = m(%u)}", next(g), next(g));
        return;
    case KIND_IMAGE:
        if (next(g) % 4 == 0)
            say(g, "t(%u)", next(g));
        else
            say(g, "%s", ONE_OF(g, "'cross.png'", "'square.png'", "'light.pfm'", "'flag.obj'"));
        return;
    case KIND_BACKGROUND:
        if (next(g) % 2)
            say_tuple(g, p, 3);
        else if (next(g) % 4)
            say(g, "s(%u)", next(g));
        else
            say(g, "'gradient'");
        return;
    case KIND_FOG:
        say(g, "f(%u)", next(g));
        return;
    case KIND_MEDIUM:
        say(g, "v(%u)", next(g));
        return;
    case KIND_CAUSTICS:
        say(g, "{photons = %u, radius = ", next(g));
        say_number(g, NULL);
        say(g, "}");
        return;
    case KIND_NODES:
        say_list(g, "n");
        return;
    case KIND_LIGHTS:
        say_list(g, "l");
        return;
    case KIND_POINTS:
        if (next(g) % 4 == 0) { /* as many as patches need */
            say(g, "{");
            for (unsigned i = 0; i < 16; i++)
                say(g, "{%u, %u, %u}, ", i % 4, i / 4, next(g) % 8);
            say(g, "}");
        } else {
            say_tuples(g, 14, 3, 3);
        }
        return;
    case KIND_PAIRS:
        say_tuples(g, 9, 2, 2);
        return;
    case KIND_STOPS:
        say_tuples(g, 6, 4, 4);
        return;
    case KIND_FACES:
        say_indices(g);
        return;
    case KIND_NUMBERS:
        if (next(g) % 3)
            say_tuple(g, p, next(g) % 14);
        else
            say_number(g, p);
        return;
    case KIND_ROWS:
        say_tuples(g, 6,
                   strcmp(p->name, "heights") == 0 ? 2
                   : strcmp(p->name, "at") == 0    ? 3
                                                   : 4,
                   strcmp(p->name, "at") == 0 ? 12 : 8);
        return;
    case KIND_CURVES: {
        unsigned count = next(g) % 4;
        say(g, "{");
        for (unsigned i = 0; i < count; i++) {
            say_tuples(g, 9, 2, 2);
            say(g, ", ");
        }
        say(g, "}");
        return;
    }
    case KIND_FUNCTION:
        say(g, "function(p) return %s end",
            ONE_OF(g, "p:length() - 1", "p.x * p.y - p.z", "gr.noise(p * 3)", "math.floor(p.x * 2) + p.y", "p.z / p.x",
                   "{p.x, p.y, p.z}", "p.q", "math.sqrt(p.x - p.y) - 0.1", "p.x < p.y and 1 or -1"));
        return;
    case KIND_CALLBACK:
        say(g, "function(t, k) return %s end",
            ONE_OF(g, "{}", "nil", "{node = gr.node('r'), width = 2, height = 2}", "gr.frame", "error('x')"));
        return;
    case KIND_COUNT:
        break;
    }
}

static const char *list_of(enum result_kind result) {
    switch (result) {
    case RESULT_NOTHING:
    case RESULT_SELF:
    case RESULT_BOUNDS:
    case RESULT_FACES:
    case RESULT_GLYPHS:
    case RESULT_FRAMES:
        return "{}";
    case RESULT_NODE:
        return "N";
    case RESULT_MATERIAL:
        return "M";
    case RESULT_LIGHT:
        return "L";
    case RESULT_TEXTURE:
        return "T";
    case RESULT_FOG:
        return "F";
    case RESULT_MEDIUM:
        return "V";
    case RESULT_SKY:
        return "S";
    }
    return "{}";
}

static void say_statement(struct grammar *g) {
    const struct script_function *function = function_at((int)(next(g) % (unsigned)function_count()));
    bool method = function->owner == OWNER_NODE, coroutine = next(g) < 8;
    unsigned how = next(g), self = method ? next(g) : 0;
    say(g, "k(%s, pcall(%s", list_of(function->result), coroutine ? "coroutine.wrap(" : "");
    if (method)
        say(g, "n(%u).%s%s, n(%u)", self, function->name, coroutine ? ")" : "", self);
    else
        say(g, "gr.%s%s", function->name, coroutine ? ")" : "");
    unsigned forms = 0;
    while (forms < FORM_LIMIT && function->forms[forms])
        forms++;
    if (forms > 0 && how < 120) {
        const char *form = function->forms[how % forms];
        int index;
        bool optional;
        while (form_next(function, &form, &index, &optional)) {
            say(g, ", ");
            say_argument(g, &function->parameters[index]);
        }
    } else {
        say(g, ", {");
        for (int p = method; p < function->parameter_count; p++) {
            const struct script_parameter *parameter = &function->parameters[p];
            if ((parameter->flags & OPTIONAL) && next(g) < 128)
                continue;
            say(g, "%s = ", parameter->name);
            say_argument(g, parameter);
            say(g, ", ");
        }
        say(g, "}");
    }
    say(g, "))\n");
}

void script_grammar(const uint8_t *data, size_t size, char out[SCRIPT_GRAMMAR_SIZE]) {
    struct grammar g = {data, data + size, out, 0};
    say(&g, "%s", prelude);
    /* A statement that does not fit is left out completely: there is always room for the ending. */
    for (int count = 0; g.at < g.end && count < STATEMENTS && g.used < SCRIPT_GRAMMAR_SIZE - 2 * STATEMENT_ROOM;
         count++) {
        size_t begun = g.used;
        say_statement(&g);
        if (g.used - begun > STATEMENT_ROOM) {
            g.used = begun;
            break;
        }
    }
    say(&g, "%s", ending);
}
