/* Lua functions as textures: recording, its errors and limits, pictures. Whatever is recorded is compared with Lua at
 * 1,000 points before it is used, so a function that is taken is equal there. */
#include "tests/harness.h"
#include "tests/unit/script_host.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char preparation[] = "local fn, vec, sin, floor = gr.fn, gr.vec, math.sin, math.floor ";

static void runs(const char *text) {
    check_corner(preparation, &(struct corner){text, NULL}, NULL);
}

static void fails(const char *text, const char *words) {
    check_corner(preparation, &(struct corner){text, words}, NULL);
}

TEST(functions_of_arithmetic_are_recorded_as_lua_computes_them) {
    runs("fn(function(p) return p.x + p.y * p.z - p[1] / 3 end)");
    runs("fn(function(p, s) return {s.u, s.v, s.time} end)");
    runs("fn(function(p, s) return s.normal + s.view * 2 - s.world / 3 end)");
    runs("fn(function(p) return p.x // 0.3 + p.y % 0.7 - (-p.z) ^ 3 + p.x ^ 2 + 2 ^ p.y + p.x ^ p.y end)");
    runs("fn(function(p) return 1 end) fn(function() return {0, 0.5, 1} end)");
    runs("fn(function(p) return floor(p.x) * 3 // 2 % 5 + (floor(p.y) & 7 | 8 ~ floor(p.z)) end)");
    runs("fn(function(p) return (floor(p.x) << 3 >> 1) + ~floor(p.y) - (-floor(p.z)) end)");
    runs("fn(function(p) local i = floor(p.x * 1e6) * 1103515245 + 12345 return (i >> 16 & 0x7fff) / 32768 end)");
    runs("fn(function(p) return floor(p.x) / 3 + floor(p.y) ^ 2 + -math.max(p.x, 0) + math.min(1, p.y, p.z) * 2 end)");
    runs("fn(function(p) return math.max(p.x, 0) // 2 + math.max(1, p.y) % 3 end)");
    runs("fn(function(p) return math.abs(floor(p.x)) + math.abs(p.y) + math.ceil(p.z) - math.fmod(p.x, 3) end)");
    runs("fn(function(p) return math.fmod(floor(p.x), 3) + math.fmod(floor(p.y) * 2 + 1, floor(p.z) * 2 + 1) end)");
    runs("fn(function(p) local a, b = math.modf(p.x) return a * 10 + b end)");
    runs("fn(function(p) return math.sqrt(p.x) + sin(p.y) + math.cos(p.z) + math.tan(p.x) + math.atan(p.y) end)");
    runs("fn(function(p) return math.atan(p.x, p.y) + math.exp(p.z) + math.log(p.x) + math.log(p.y, 2) end)");
    runs("fn(function(p) return math.log(p.x, 10) + math.log(p.y, 3) + math.log(p.x, p.z) + math.pow(p.x, 2) end)");
    runs("fn(function(p, s) return math.asin(s.u) + math.acos(s.v) + math.deg(p.x) + math.rad(p.y) end)");
    runs("fn(function(p) return type(p.x) == 'number' and math.type(p.x) == 'float' and"
         " math.type(floor(p.x)) == 'integer' and 1 or nil end)");
    runs("fn(function(p) return math.tointeger(floor(p.x)) + (math.tointeger(p.y) or 0.5) end)");
    runs("fn(function(p) return math.ult(floor(p.x), floor(p.y)) and 1 or 2 end)");
}

TEST(branches_and_loops_are_recorded_as_selections) {
    runs("fn(function(p) if p.x < 0 then return 1 elseif p.x <= 0.5 then return p.y else return p.z end end)");
    runs("fn(function(p) return p.x < p.y and p.x or p.y end)");
    runs("fn(function(p) return not (p.x > 0) and 1 or 0 end)");
    runs("fn(function(p) local sum = 0 for i = 1, 8 do if p.x * i > p.y then sum = sum + i end end return sum end)");
    runs("fn(function(p) local n = 0 while n < 5 and p.x > n do n = n + 1 end return n end)");
    runs("fn(function(p) if floor(p.x) % 2 < 1 then return {1, 0, 0} end return 0.25 end)");
    runs("fn(function(p) if p.x == p.y then return 1 end return 0 end)");
    runs("fn(function(p) if floor(p.x) < floor(p.y) or floor(p.x) * 1000003 > p.z then return 1 end return 0 end)");
    runs(
        "local t = {0.1, 0.5, 0.9} fn(function(p) local s = 0 for i, v in ipairs(t) do s = s + v * p.x ^ i end return s"
        " end)");
    runs("local function f(x, n) if n == 0 then return x end return f(x * x - 1, n - 1) end"
         " fn(function(p) return f(p.x, 6) end)");
    /* decided once, and what follows from it */
    runs("fn(function(p) local n = 0 for i = 1, 100 do if p.x < p.y then n = n + 1 end"
         " if p.y < p.x then n = n + 2 end if p.y <= p.x then n = n + 3 end end return n end)");
}

TEST(paths_that_no_point_takes_are_dropped) {
    runs("fn(function(p) local n = 0 for i = 1, 13 do if p.x > i then n = n + 2 ^ i end"
         " if p.y * p.x > i then n = n - 3 ^ i end end return n end)");
    runs("fn(function(p) for i = 1, 500 do if p:length() < i / 10 then return i end end return 0 end)");
    runs("fn(function(p) if p.x < 1 then if p.x * 2 + 5 > 8 then error('empty') end return 1 end return 2 end)");
    runs("fn(function(p) local x = math.sin(p.x) if x > 1.5 then while true do end end return x end)");
    runs("fn(function(p, s) if s.normal.x + s.normal.y > 3 then while true do end end return 1 end)");
    runs("fn(function(p) if p.y <= 3 then if p.x < p.y then if p.x > 3.5 then while true do end end end end"
         " return 0 end)");
    runs("fn(function(p) if p.x / p.x < 2 then return 1 elseif p.x / p.x > 1 then return 2 else return 3 end end)");
    runs("fn(function(p) if math.floor(p.x) <= 3 then if math.floor(p.x) > 3 then while true do end end end"
         " return 1 end)");
}

TEST(an_error_on_a_path_counts_only_where_a_point_gets) {
    runs("fn(function(p) if p.x > 1000 then error('far') end return p.x end)");
    fails("fn(function(p) if p.x > 0 then error('far') end return p.x end)", "scene.lua:1: far");
    runs("fn(function(p) return 7 // (floor(p.x * 0) + 2) end)");
    fails("fn(function(p) return 7 // floor(p.x) end)", "attempt to ");
    fails("fn(function(p) return 7 & p.x end)", "has no integer representation");
}

/* Of a picture of the shape; what differs beyond +-100 is seen only there. */
static void picture_says(const char *shape, const char *material, const char *words) {
    char text[1024];
    (void)snprintf(text, sizeof text,
                   "local n = 0 local m = gr.material{kd = %s}\ngr.render{node = %s, file = 'a.png', width = 4,"
                   " height = 4, eye = {0, 0, 9}, view = {0, 0, -1}}",
                   material, shape);
    check_corner("", &(struct corner){text, words}, NULL);
}

TEST(functions_are_compared_in_the_bounds_of_what_they_are_put_on) {
    static const char random[] = "function(p) if p.x > 1000 then return math.random() end return 0.5 end";
    static const char unseen[] = "function(p) if math.floor(p.y) == 2000 then return 1 end return 0.5 end";
    static const char fails[] = "function(p) if p.z > 1000 then error('far') end return 0.5 end";
    static const char far_ball[] = "gr.sphere{centre = {2000, 2000, 2000}, radius = 3, material = m}";
    picture_says("gr.sphere{material = m}", random, NULL);
    picture_says("gr.sphere{material = m}", unseen, NULL);
    picture_says("gr.sphere{material = m}", fails, NULL);
    picture_says(far_ball, random, "gr.render: the function of line 1 cannot be recorded: at p = {");
    picture_says(far_ball, unseen, "x == 0 cannot be recorded");
    picture_says(far_ball, fails, "scene.lua:1: far");
    picture_says("gr.difference{gr.sphere{centre = {2000, 0, 0}}, gr.cube('c')}:set_material(m)", random, "at p = {");
    picture_says("gr.sphere{centre = {2000, 0, 0}, material = gr.material{kd = gr.mix_texture(m and"
                 " function(p) if p.x > 1000 then return math.random() end return 0 end, 1)}}",
                 "{1, 1, 1}", "at p = {");
    picture_says("gr.implicit{f = function(p) if p.x > 1000 then return math.random() - 2 end return p.x end,"
                 " bounds = {{1999, 0, 0}, {2001, 1, 1}}}",
                 "{1, 1, 1}", "at p = {");
}

TEST(a_nan_at_a_hit_is_reported_once_with_the_point) {
    static const char scene[] =
        "local ball = gr.sphere('ball'):set_material(gr.material{kd = function(p) return math.sqrt(p.x - 0.5) end})\n"
        "for i = 1, 2 do gr.render{node = ball, file = 'a.png', width = 40, height = 40, eye = {0, 0, 5 + i},"
        " view = {0, 0, -1}, up = {0, 1, 0}, fov = 25} end\n";
    char *first = NULL;
    for (int run = 0; run < 2; run++) {
        struct test_result result = test_gray_scene(scene, run ? "-j 1 --isa base scene.lua" : "-j 3 scene.lua", NULL);
        char *line = strstr(result.err, "warning: the function of scene.lua:1 is not a number (NaN) at p = {-");
        if (!line || !strstr(line, "; it counts as 0 there") || strstr(strstr(line, "there"), "(NaN)"))
            test_fail(__FILE__, __LINE__, "%s", result.err);
        if (!line)
            return;
        line[strcspn(line, "\n")] = '\0';
        if (run == 1)
            CHECK_TEXT(line, first);
        free(first);
        first = strdup(line);
        test_free_result(&result);
    }
    free(first);
}

TEST(vectors_are_numbers_by_three) {
    runs("local v = vec(1, 2, 3) assert(v.x == 1 and v[2] == 2 and v.b == 3 and v == vec{1, 2, 3} and #v == 3)"
         " assert(tostring(-v * 2) == '{-2, -4, -6}' and v:dot(v) == 14 and vec(3, 4, 0):length() == 5)"
         " assert(vec(1, 0, 0):cross{0, 1, 0} == vec(0, 0, 1) and vec(0, 3, 0):normalize() == vec(0, 1, 0))"
         " assert(gr.mix(1, 3, 0.25) == 1.5 and gr.mix(v, vec(3), 0.5) == vec(2, 2.5, 3))"
         " assert(gr.clamp(5, 0, 1) == 1 and gr.clamp(vec(-1, 0.5, 9), 0, 1) == vec(0, 0.5, 1))"
         " assert(gr.smoothstep(0, 2, 1) == 0.5 and gr.smoothstep(0, 1, -3) == 0 and gr.step(1, 1) == 1)"
         " assert(gr.min(3, 1, 2) == 1 and gr.max(vec(1, 5, 2), 3) == vec(3, 5, 3))"
         " assert(gr.where(1, 'a', 'b') == 'a' and gr.where(0, 1, 2) == 2 and gr.where(vec(1).x, 1, 2.5) == 1.0)"
         " assert(gr.lookup({5, 6, 7}, 2.9) == 6 and gr.lookup({5, 6, 7}, -1) == 5 and gr.lookup({5, 6}, 1e9) == 6)"
         " assert(gr.loop(10, 1, function(i, s) return s * 2 end) == 1024)"
         " assert(select(2, gr.loop(10, 5, 0, function(i, s, n) return s - 1, n + i end)) == 15)");
    runs("fn(function(p, s) return p:dot(s.normal) * p:length() end)");
    runs("fn(function(p, s) return p:cross(s.view):normalize() * 0.5 + 0.5 end)");
    runs("fn(function(p) return gr.smoothstep(-1, 1, p.x) * gr.mix(vec(1, 0, 0), {0, 1, 0}, gr.step(0, p.y)) end)");
    runs("fn(function(p) return gr.clamp(p, -1, 1) + gr.min(p, 0.5) * gr.max(p.x, p.y, 0) end)");
    runs("fn(function(p) return gr.where(p.x, p, {1, 2, 3}) + gr.where(p.y, 1, 2) end)");
    runs("fn(function(p) return gr.lookup({{1, 0, 0}, {0, 1, 0}, vec(0, 0, 1), {1, 1, 1}}, p.x * 4) end)");
    runs("fn(function(p) return gr.lookup({3, 1, 4, 1, 5, 9, 2, 6}, floor(p.x)) end)");
    runs("fn(function(p) local n, x = gr.loop(30, 1, 0, function(i, n, x) return 4 - x * x, x * x + p.x end)"
         " return n + x end)");
    runs("fn(function(p) return gr.noise(p) + gr.noise(p.x * 2, p.y, 0.5) + gr.turbulence(p, 5) + gr.hash(p) end)");
    runs("fn(function(p) local f1, f2, id = gr.cells(p * 3) return {f1, f2 - f1, id} end)");
    fails("vec(1, 2)", "a number or a vector is needed");
    fails("gr.lookup({}, 1)", "a table of 1 to 10000 entries is needed");
    fails("gr.loop(20000, 1, function() end)", "a constant number of steps up to 10000 is needed");
    fails("fn(function(p) return gr.loop(3, p.x, function() end) end)", "must return 1 numbers or vectors");
    fails("vec(1, 2, 3).w = 1", "the fields of a vector cannot be set");
}

TEST(loops_of_many_steps_are_recorded_as_lua_computes_them) {
    static const char julia[] = "local function escape(n, cx, cy) return function(p)"
                                " local _, x, y, k = gr.loop(n, 1, p.x / 50, p.y / 50, 0, function(i, _, x, y, k)"
                                " if x * x + y * y > 4 then return 0, x, y, k end"
                                " return 1, x * x - y * y + (cx or p.x / 40), 2 * x * y + (cy or p.y / 40), k + 1 end)"
                                " return {x, y, k / n} end end fn(escape(300)) fn(escape(10000, 0.4, 0.4))";
    runs(julia);
    runs("fn(function(p) local n, x = gr.loop(10000, p.x, 1.5, function(i, d, x)"
         " local next = (x + math.abs(p.x) / x) / 2 return math.abs(next - x), next end) return x end)"); /* Newton */
    runs("fn(function(p) local q, a, s = gr.loop(200, p, 1, 0, function(i, q, a, s)"
         " return q * 1.01 + 0.3, a * 0.99, s + a * gr.noise(q) end) return s + q.x end)");
    runs("fn(function(p) return (select(2, gr.loop(500, floor(p.x), 1, function(i, a, b)"
         " if a % 2 > 0 then a = 3 * a + 1 else a = a // 2 end return a - 1, b * 31 + a + i & 0xffff end))) end)");
    runs("fn(function(p) local n, k = gr.loop(300, 1, 0, function(i, a, k)"
         " if i > 20 and p.x < k or i * 2 > p.y + 300 and p.z > 0 then return 0, k end return a, k + p.y end)"
         " return k end)");
    runs("fn(function(p) local a, b = gr.loop(400, p.x, 0, function(i, a, b)"
         " return math.max(a, b, 1), math.max(b - 0.25, floor(a)) end) return a // 2 + b // 2 end)");
    runs("fn(function(p) return gr.loop(200, p.x, function(i, a)"
         " local s, b = gr.loop(300, 1.5, a, function(k, s, b) return s - 0.5, b + math.sin(b * k) / i end)"
         " return b end) end)");
    runs("fn(function(p) return (gr.loop(150, vec(0), p, function(i, s, q) return s + q / i, q:cross{1, 0, i} / 9 end))"
         " end)");
    /* the number of a step as a plain number: recorded one by one */
    runs("local t = {} for i = 1, 100 do t[i] = sin(i) end"
         " fn(function(p) return gr.loop(100, p.x, function(i, s) return s * 0.9 + t[i] + (p.y + s) * p.z / i end) "
         "end)");
    runs("fn(function(p) local a, b = gr.loop(300, 1, p.x, function(i, a, b)"
         " if i == 7 then return a, b + 100 end return a, b * 0.5 + p.y * i + p.z end) return b end)");
    fails("local kept fn(function(p) gr.loop(1000, p.x, function(i, a) kept = a return a * p.y + p.z + i end)"
          " return kept + 1 end)",
          "a number of a step of gr.loop is used outside the step");
    fails("fn(function(p)\n return gr.loop(1000, p.x, function(i, a) return a + nil end) end)", "scene.lua:2: ");
    fails("fn(function(p) return (gr.loop(1000, p.x, function(i, a) local n = 0 for k = 1, 13 do"
          " if gr.noise(a * k, p.y, p.z) > 0 then n = n + 2 ^ k end end return n end)) end)",
          "a step of gr.loop has more than 4096 paths");
}

TEST(a_function_that_is_not_pure_is_an_error_that_names_the_difference) {
    fails("local n = 0 fn(function(p) n = n + 1 return n end)", "the function of line 1 cannot be recorded: at p = ");
    fails("fn(function(p) return p.x * math.random() end)", "it must depend only on its arguments");
    fails("fn(function(p) if floor(p.x) == 0 then return 1 end return 0 end)", "x == 0 cannot be recorded");
    fails("local n = 0 fn(function(p) n = n + 1 if p.x * n < 1 then return 1 end return p.y > n and 1 or 2 end)",
          "took another branch");
    fails("local kept fn(function(p) kept = kept or p.x return kept end)", "outside the function");
}

TEST(errors_of_recording_name_the_line_and_the_remedy) {
    fails("fn(function(p)\n return p.x + nil end)", "scene.lua:2: ");
    fails("fn(function(p) return 'red' end)", "the function must return a number or a colour {r, g, b}, not a string");
    fails("fn(function(p) return {1, 2} end)", "the function must return a number or a colour {r, g, b}, not a table");
    fails("fn(function(p) return 1, 2 end)", "the function returns 2 values, not a number or a colour");
    fails("fn(function(p) end)", "the function returns 0 values");
    fails("fn(function(p) return ({1, 2})[p.x] * 2 end)", "use gr.lookup(t, i)");
    fails("fn(function(p) return gr.sphere('x') end)", "gr.sphere cannot be called by a function that is recorded");
    fails("fn(function(p) return math.frexp(p.x) end)", "math.frexp cannot be recorded");
    fails("fn(function(p) for i = 1, p.x do end return 1 end)", "'for' limit");
    fails("fn(function(p) return p.x + '1' end)", "needs another number");
    fails("local kept fn(function(p) kept = kept or p.x return 1 end) print(kept + 1)", "is used outside the function");
    fails("local t = {1, 2} fn(\nfunction(p) return t[floor(p.x)] end)",
          "scene.lua:2: the function must return a number or");
    fails("local t = {1, 2} fn(function(p) return t[floor(p.x)] end)", "use gr.lookup(t, i)");
    fails("fn(function(p) return p.w end)",
          "not nil; nil is the value of a field that does not exist, of tonumber(text)");
    fails("fn(function(p) return '#ff8800' end)", "not a string; colour.hex of require 'colour' makes a colour");
    fails("fn(function(p) return p.x > 0 end)", "not a boolean; gr.where(condition, 1, 0) is a number");
    fails("fn(function(p) return {p.x} end)", "not a table that does not contain three numbers");
    fails("fn(\n\nfunction(p) return 'red' end)", "scene.lua:3: the function must return");
    fails("fn(\n\nfunction(p) return 1, 2 end)", "scene.lua:3: the function returns 2 values");
    fails("fn(function(p) for i = 1, p.x do end return 1 end)", "gr.loop(n, state, f) may end earlier");
    fails("fn(function(p)\n return p.w * 2 end)",
          "scene.lua:2: attempt to perform arithmetic on a nil value (field 'w')");
    fails("fn(function(p)\n return p.x.y end)", "scene.lua:2: attempt to index a recorded number value (field 'x')");
    fails("fn(function(p, s, t) return t.x end)", "scene.lua:1: attempt to index a nil value (local 't')");
    fails("fn(function(p)\n return math.sin(p) end)",
          "scene.lua:2: bad argument #1 to 'sin' (number expected, got vector)");
    fails("fn(function(p)\n local a, b, c = p.x, p.y, p.z for i = 1, 30000 do a, b, c = a*b+c, b*c+a, sin(c)+a end "
          "return a "
          "end)",
          "scene.lua:2: the function has more than 100000 operations; gr.where, gr.step, gr.min and gr.max need one "
          "operation where branches need many, and gr.loop(n, state, f) records one step for all");
    fails("fn(7, 8, 9) fn('x')", "");
    fails(
        "fn(function(p)\n return #string.format('%d', p.x) end)",
        "scene.lua:2: bad argument #2 to 'format' (number "
        "expected, got recorded number); a number of the recorded function has no value yet, so it cannot become text");
    fails("fn(function(p) return p.x .. 'a' end)", "it cannot become text or choose an argument; use operators");
    fails("fn(function(p) return #table.concat{p.x, 1} end)", "it cannot become text");
    fails("fn(function(p) return (select(floor(p.x) % 3 + 1, 1, 2, 3)) end)", "choose an argument");
    /* on one of two paths */
    fails("fn(function(p) if p.y > 0 then\n return #(p.x .. 'a') end return 0.5 end)",
          "scene.lua:2: attempt to concatenate a recorded number value");
    fails("fn(function(p) return (gr.loop(2000, 1.0, p.x, function(i, a, b) if b > 3 then\n return #(b .. 'a'), b end "
          "return 1, b * 1.1 end)) end)",
          "scene.lua:2: attempt to concatenate a recorded number value");
    fails("fn(function(p) error{} end)", "the function raised a table");
}

TEST(recordings_beyond_the_limits_end_with_one_line) {
    fails("fn(function(p) local n = 0 for i = 1, 13 do if gr.noise(p * i) > 0 then n = n + 2 ^ i end end return n end)",
          "the function has more than 4096 paths; gr.where(x, a, b)");
    fails("fn(function(p) local x = p.x while x > 0 do x = x - 1 end return x end)",
          "a call of the function branches more than 4096 times");
    fails("fn(function(p) local x = p.x for i = 1, 1e6 do x = x * x + p.y end return x end)",
          "the function has more than 100000 operations");
    fails("local function f(x) return f(x + 1) end fn(function(p) return f(p.x) end)", "more than 100000 operations");
    fails("local function f(x) return f(x) + 1 end fn(function(p) return f(p.x) end)", "stack overflow");
    fails("local function f(x) if gr.noise(x, p_y, 0) > 0.7 then return x end return f(x * 0.9) end"
          " fn(function(p) p_y = p.y return f(p.x) end)",
          "more than 4096 times");
    fails("fn(function(p) while true do pcall(function() local x = p.x while x > 0 do x = x - 1 end end)"
          " if p.x > 0 then return 1 end end end)",
          "more than 4096 times");
    const struct script_options hasty = {.library_folder = "lua", .time_limit = 0.2};
    check_corner(preparation, &(struct corner){"fn(function(p) while true do end end)", "used up its 0.2 s"}, &hasty);
}

TEST(a_recorded_function_prints_in_its_first_call) {
    struct test_result result = test_gray_scene(
        "local ball = gr.sphere('b'):set_material(gr.material{kd = function(p) print('called', p.x) io.write('a ')\n"
        " io.stdout:write('b\\n') if p.x > 0.2 then print('more') return p.x end print('less') return 0.5 end})\n"
        "gr.render{node = ball, file = 'a.png', width = 4, height = 4, eye = {0, 0, 9}, view = {0, 0, -1},\n"
        " tone = function(x) print('tone') return x end}\n"
        "print('after')",
        "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.out, "called\ta number of a recorded function\na b\nmore\ntone\nafter\n");
    test_free_result(&result);
}

/* Depth first, 4,096 paths of 1,980 decisions would come before the error. */
TEST(a_function_of_too_many_long_paths_is_refused_after_few_calls) {
    runs("local calls = 0 local function count(i) if i == 1 then calls = calls + 1 end end\n"
         "local good, why = pcall(fn, function(p) local n = 0.0 for i = 1, 660 do count(i)\n"
         " if gr.noise(p * i) > 0 then n = n + 1 end if sin(p.x * i) > n * p.y then n = n * 0.5 end\n"
         " if p.z * i - n > p.x then n = n - p.y end end return n end)\n"
         "assert(not good and why:find('the function has more than 4096 paths; gr.where', 1, true), why)\n"
         "assert(calls < 100, calls)");
}

TEST(a_function_of_many_long_paths_is_recorded) {
    runs("fn(function(p) local x = p.x for i = 1, 10 do x = sin(x) * p.y + p.z end"
         " for i = 1, 12 do if gr.noise(p * i) > 0.3 then x = x + 2 ^ i end end return x end)");
    runs("fn(function(p) for i = 1, 400 do if gr.noise(p * i) > 0.3 then return i end end return 0 end)");
}

TEST(an_entry_of_a_table_is_a_float_where_one_of_them_is) {
    runs("fn(function(p) return -gr.lookup({floor(p.x), 0.5, 2}, p.y) end) "
         "fn(function(p) return -gr.lookup({0, 0.5, 2}, p.y) - gr.lookup({0, -1, 2}, p.y) / 3 end) "
         "fn(function(p) return 1 / -gr.lookup({math.min(0, p.x), 0.5, 2}, p.y) end) "
         "fn(function(p) return 1 / -gr.lookup({math.min(0, p.x), 3, 2}, p.y) end) "
         "fn(function(p) return -gr.lookup({0, floor(p.z), p.x}, 1) end) "
         "assert(math.type(gr.lookup({1, 2}, 1)) == 'integer' and math.type(gr.lookup({1, 0.5}, 1)) == 'float')");
}

TEST(components_of_chosen_vectors_are_floats_where_one_of_them_is) {
    runs("local function signs(q) return vec(1 / -q[1], 1 / -q[2], q[3] // 2) end "
         "fn(function(p) return signs(gr.where(p.y, vec(0, 0.5, 1), {0, 0, 2})) end) "
         "fn(function(p) return signs(gr.where(p.y, vec(floor(p.x), 0, 1), {0.0, 0, 2})) end) "
         "fn(function(p) return signs(gr.where(1, vec(math.min(0, p.x), 0, p.z), {3, 0.5, 2})) end) "
         "fn(function(p) return signs(gr.lookup({vec(0, 0, 1), {0.5, floor(p.x), 2}, vec(1, 0, 0)}, p.y)) end) "
         "fn(function(p) return signs(gr.lookup({vec(0, 0, 1), {0.5, math.max(0, p.x), 2}}, 1)) end) ");
    runs("fn(function(p) return gr.where(p.y, 0.5, vec(1, 2, 3)).y end) "
         "fn(function(p) return gr.lookup({0, vec(1, 2, p.x)}, 1).z + gr.where(-1, vec(1, 2, 3), floor(p.x)).z end) "
         "local v = gr.where(1, 7, {1, 2, 3.5}) assert(v.x == 7 and math.type(v.x) == 'integer' and "
         "math.type(v.z) == 'float' and gr.where(1, 'a', 'b') == 'a')");
}

TEST(a_choice_by_a_constant_is_a_float_where_lua_has_one) {
    runs("fn(function(p) return 1 / -gr.where(p.y, math.min(0, p.x), 3) end)");
    runs("fn(function(p) return -gr.where(0.5, floor(-2 - p.y), 0.0) end) "
         "fn(function(p) return -math.abs(gr.where(0, p.x, 1 - floor(p.y))) end) "
         "fn(function(p) return 2 // math.min(gr.where(1, floor(p.z), p.x), 1) end) "
         "fn(function(p) return -gr.where(1, 0 // 1, floor(p.y)) end) "
         "fn(function(p) return 7 // gr.where(-1, p.x, 3) end)");
}

/* A function of random statements: locals, branches, early returns, loops over constants, gr.loop, tables, metatables,
 * closures, variable arguments, goto, integers and their bits. What is rounded is limited before:
 * integers beyond 64 bits are a limit of recordings (docs/functions.md). Zeros are floats: Lua computes x - 0 as x + 0,
 * which is another zero for x = -0, also where it has folded the 0 of numbers. */
static const char generator[] =
    "local function pick(...) return (select(math.random(select('#', ...)), ...)) end\n"
    "local function is_zero(text)\n"
    "  local good, number = pcall(load('return ' .. (text:find('%a') and '1' or text)))\n"
    "  return good and number == 0\n"
    "end\n"
    "local function generate()\n"
    "  local names, paths = {'p.x', 'p.y', 'p.z', 's.u', 's.normal.x', 'p[2]'}, 1\n"
    "  local lines, count = {}, 0\n"
    "  local function value(depth)\n"
    "    if depth == 0 or math.random() < 0.2 then\n"
    "      return pick(names[math.random(#names)], names[math.random(#names)], pick(tostring(math.random(-4, -1)), "
    "'0.0', tostring(math.random(1, 4))),\n"
    "        string.format('%.3f', math.random() * 4 - 2))\n"
    "    end\n"
    "    local a, b = value(depth - 1), value(depth - 1)\n"
    "    return pick('(' .. a .. ' + ' .. b .. ')', '(' .. a .. (is_zero(b) and ' + ' or ' - ') .. b .. ')', '(' .. a "
    ".. ' * ' .. b .. ')',\n"
    "      '(' .. a .. ' / ' .. b .. ')', '(' .. a .. ' % ' .. b .. ')', '(' .. a .. ' // ' .. b .. ')',\n"
    "      '(- ' .. a .. ')', 'whole(' .. a .. ')', 'math.min(' .. a .. ', ' .. b .. ')',\n"
    "      'math.max(' .. a .. ', ' .. b .. ')', 'math.abs(' .. a .. ')', 'math.sin(' .. a .. ')',\n"
    "      'gr.where(' .. a .. ', ' .. b .. ', ' .. value(0) .. ')', 'gr.noise(' .. a .. ', ' .. b .. ', 1)',\n"
    "      'gr.step(' .. a .. ', ' .. b .. ')', 'twice(' .. a .. ')', 'list[' .. math.random(3) .. '](' .. a .. ')')\n"
    "  end\n"
    "  local function condition()\n"
    "    paths = paths * 2\n"
    "    return value(1) .. pick(' < ', ' <= ', ' > ', ' >= ') .. value(1)\n"
    "  end\n";
static const char generator_of_statements[] =
    "  local function statement(depth)\n"
    "    local kind = math.random(15)\n"
    "    if kind == 1 or #names < 8 then\n"
    "      count = count + 1\n"
    "      lines[#lines + 1] = 'local v' .. count .. ' = ' .. value(2)\n"
    "      names[#names + 1] = 'v' .. count\n"
    "      return\n"
    "    end\n"
    "    local target = names[math.random(7, #names)]\n"
    "    if kind == 2 and paths < 16 and depth > 0 then\n"
    "      lines[#lines + 1] = 'if ' .. condition() .. ' then'\n"
    "      local known = #names\n"
    "      statement(depth - 1)\n"
    "      while #names > known do names[#names] = nil end\n"
    "      lines[#lines + 1] = 'else'\n"
    "      statement(depth - 1)\n"
    "      while #names > known do names[#names] = nil end\n"
    "      lines[#lines + 1] = 'end'\n"
    "    elseif kind == 3 then\n"
    "      lines[#lines + 1] = 'for i = 1, ' .. math.random(4) .. ' do ' .. target .. ' = ' .. target .. ' * 0.5 + i * "
    "'\n"
    "        .. value(1) .. ' end'\n"
    "    elseif kind == 4 and paths < 16 then\n"
    "      lines[#lines + 1] = target .. ' = ' .. condition() .. ' and ' .. value(1) .. ' or ' .. value(1)\n"
    "    elseif kind == 5 then\n"
    "      lines[#lines + 1] = '_, ' .. target .. ' = gr.loop(' .. pick(1, 3, 40, 400) .. ', 1.0, 0.0 + ' .. target .. "
    "', "
    "function(i, _, x)'\n"
    "        .. ' if x > ' .. value(1) .. ' then return ' .. pick('0.0', '1.0', 'x') .. ', x * 0.5 end'\n"
    "        .. ' return ' .. pick('1.0', 'x + 1.0', '2.5 - i') .. ', x * 0.5 + ' .. value(1) .. ' end)'\n"
    "    elseif kind == 6 then\n"
    "      lines[#lines + 1] = '_, ' .. target .. ' = gr.loop(' .. pick(2, 5, 300) .. ', 9, whole(' .. value(1) .. '), "
    "function(i, n, k)'\n"
    "        .. ' return n - 1, (k * ' .. pick(3, -7, 31) .. ' ~ (k >> ' .. pick(1, 5) .. ')) + whole(' .. value(1) .. "
    "') & "
    "0xffff end)'\n"
    "    elseif kind == 7 then\n"
    "      lines[#lines + 1] = 'do local t = {' .. value(1) .. ', ' .. value(1) .. ', ' .. target .. '} t[2] = t[1] * "
    "t[3] "
    "t[#t + 1] = '\n"
    "        .. value(1) .. ' for k, v in ipairs(t) do ' .. target .. ' = ' .. target .. ' * 0.5 + v * k end end'\n"
    "    elseif kind == 8 then\n"
    "      lines[#lines + 1] = target .. ' = (whole(' .. value(1) .. ') * 7 ' .. pick('~', '|', '&') .. ' whole(' .. "
    "value(1) .. ') '\n"
    "        .. pick('>> 3', '<< 2', '% 13 & 0xff', '// 5 ~ 1', '+ 1 & 3') .. ') ' .. pick('& 255', '% 17', '// 3')\n"
    "    elseif kind == 9 and paths < 16 then\n"
    "      paths = paths * 2\n"
    "      lines[#lines + 1] = 'do local a, b = pair(' .. value(1) .. ', ' .. value(1) .. ') ' .. target .. ' = a + b "
    "* 0.25 "
    "end'\n";
static const char generator_of_functions[] =
    "    elseif kind == 10 then\n"
    "      lines[#lines + 1] = target .. ' = total(' .. value(1) .. ', ' .. value(1) .. ', ' .. value(0) .. ')'\n"
    "    elseif kind == 11 and paths < 16 and depth == 2 then\n"
    "      lines[#lines + 1] = 'if ' .. condition() .. ' then return ' .. pick(value(1), '{' .. value(1) .. ', 0.5, ' "
    ".. "
    "value(0) .. '}') .. ' end'\n"
    "    elseif kind == 12 then\n"
    "      lines[#lines + 1] = 'do local k = 0 while k < 4 do k = k + 1 if k == ' .. math.random(4) .. ' then goto "
    "continue "
    "end '\n"
    "        .. target .. ' = ' .. target .. ' * 0.25 - k * ' .. value(1) .. ' ::continue:: end end'\n"
    "    elseif kind == 13 then\n"
    "      lines[#lines + 1] = target .. ' = (' .. pick('box(' .. value(1) .. ')', '2') .. ' * box(' .. value(1) .. "
    "')).v'\n"
    "    elseif kind == 14 and paths < 16 then\n"
    "      lines[#lines + 1] = target .. ' = ({one = ' .. value(1) .. ', two = ' .. value(1) .. \"})[\" .. condition() "
    ".. \" "
    "and 'one' or 'two']\"\n"
    "    elseif kind == 15 then\n"
    "      lines[#lines + 1] = target .. ' = gr.lookup({' .. value(1) .. ', 0.5, ' .. value(1) .. '}, ' .. value(1) .. "
    "')'\n"
    "    else\n"
    "      lines[#lines + 1] = target .. ' = ' .. value(2)\n"
    "    end\n"
    "  end\n"
    "  for _ = 1, math.random(3, 8) do statement(2) end\n"
    "  local result = pick(value(2), '{' .. value(1) .. ', ' .. value(1) .. ', ' .. value(0) .. '}')\n"
    "  return 'local function whole(x) return math.floor(gr.min(1e9, gr.max(-1e9, x))) end '\n"
    "    .. 'local function twice(x) return x * 2 end local list = {twice, math.cos, function(x) return x - 1 "
    "end}\\n'\n"
    "    .. 'local function pair(a, b) if a < b then return a, b end return b, a end '\n"
    "    .. 'local function total(...) local s = 0.0 for i = 1, select(\"#\", ...) do s = s + select(i, ...) end "
    "return s end "
    "'\n"
    "    .. 'local Box = {} local function box(x) return setmetatable({v = x}, Box) end '\n"
    "    .. 'Box.__mul = function(a, b) return box((type(a) == \"table\" and a.v or a) * (type(b) == \"table\" and b.v "
    "or b)) "
    "end local _\\n'\n"
    "    .. 'return function(p, s)\\n' .. table.concat(lines, '\\n') .. '\\nreturn ' .. result .. '\\nend'\n"
    "end\n";

static void check_generated(int count, int seed) {
    char text[16384];
    (void)snprintf(text, sizeof text,
                   "%s%s%smath.randomseed(%d)\n"
                   "for i = 1, %d do\n"
                   "  local source = generate()\n"
                   "  local good, why = pcall(gr.fn, assert(load(source))())\n"
                   "  why = not good and tostring(why)\n"
                   "  local known = why and (why:find('divide by zero', 1, true) or why:find(\"'n%%0'\", 1, true)\n"
                   "    or why:find('more than 4096 paths', 1, true))\n"
                   "  assert(good or known, tostring(why) .. source:gsub('\\n', ' '))\n"
                   "  if good then taken = (taken or 0) + 1 end\n"
                   "end\n"
                   "assert(taken > %d * 0.8, taken)\n",
                   generator, generator_of_statements, generator_of_functions, seed, count, count);
    struct listener listener = {.renders = 0};
    struct error error = {0};
    const struct script_options options = {.library_folder = "lua", .no_sandbox = true};
    if (!listen_to_text(&listener, text, &options, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

TEST(generated_functions_are_recorded_as_lua_computes_them) {
    check_generated(50, 1);
}

/* Ten tests of 10,000 functions: a run that was stopped goes on with the next one. */
#define TEN_THOUSAND(first)                                                                                            \
    TEST_LONG(ten_thousand_generated_functions_from_seed_##first##_are_recorded_as_lua_computes_them) {                \
        for (int seed = first; seed < first + 10; seed++)                                                              \
            check_generated(1000, seed);                                                                               \
    }
TEN_THOUSAND(2)
TEN_THOUSAND(12)
TEN_THOUSAND(22)
TEN_THOUSAND(32)
TEN_THOUSAND(42)
TEN_THOUSAND(52)
TEN_THOUSAND(62)
TEN_THOUSAND(72)
TEN_THOUSAND(82)
TEN_THOUSAND(92)

static const char stage[] = "local ball = gr.sphere('ball'):set_material(gr.material{%s})\n"
                            "gr.render{node = ball, file = '%s', width = 60, height = 60, eye = {0, 0, 5},"
                            " view = {0, 0, -1}, up = {0, 1, 0}, fov = 25, ambient = {1, 1, 1}}\n";

static void picture_of(const char *fields, const char *name, const char *options, char **bytes, size_t *size) {
    char text[2048], line[256];
    (void)snprintf(text, sizeof text, stage, fields, name);
    (void)snprintf(line, sizeof line, "-q %s scene.lua", options);
    struct test_result result = test_gray_scene(text, line, NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", fields, result.err);
    test_free_result(&result);
    *bytes = test_read_file(test_path(name), size);
}

static void check_equal(const char *a, const char *b, const char *options_b) {
    char *bytes_a, *bytes_b;
    size_t size_a = 0, size_b = 0;
    picture_of(a, "a.png", "", &bytes_a, &size_a);
    picture_of(b, "b.png", options_b, &bytes_b, &size_b);
    if (!bytes_a || !bytes_b || size_a != size_b || memcmp(bytes_a, bytes_b, size_a) != 0)
        test_fail(__FILE__, __LINE__, "%s is not the picture of %s", a, b);
    free(bytes_a);
    free(bytes_b);
}

#define LUA_MARBLE                                                                                                     \
    "function(p) local sum, scale = 0, 1 for _ = 1, 4 do local f = 2 * scale"                                          \
    " sum = sum + gr.noise(f * p) / scale scale = scale * 4 end"                                                       \
    " local vein = math.cos(4 * p.y + 3 * sum) local t = (1 + vein) / 2"                                               \
    " return (1 - math.cos(math.pi * t)) / 2 end"

TEST(marble_written_in_lua_is_the_picture_of_the_built_in_marble) {
    check_equal("kd = gr.fn(" LUA_MARBLE ", 1)", "kd = gr.marble_texture(2, 3, 4)", "");
    check_equal("kd = {0.5, 0.5, 0.5}, bump = gr.bump(gr.multiply_texture(gr.fn(" LUA_MARBLE ", 1), 1), 0.1)",
                "kd = {0.5, 0.5, 0.5}, bump = gr.bump(gr.marble_texture(2, 3, 4), 0.1)", "");
}

/* The ball as a sum of 400 terms, with an end that no point of the ball reaches, and by its formula. */
TEST(an_implicit_solid_of_a_loop_is_that_of_its_formula) {
    static const char text[] = "local function square(p) return p.x * p.x + p.y * p.y + p.z * p.z end\n"
                               "local function sum(p) local _, s = gr.loop(400, 1, 0.0, function(i, _, s)\n"
                               " if s > 50 then return 0, s end return 1, s + square(p) / 400 end) return s end\n"
                               "for name, f in pairs{a = sum, b = square} do\n"
                               " local ball = gr.implicit{f = function(p) return f(p) - 1 end, radius = 1.25,\n"
                               " material = gr.material{kd = {0.8, 0.6, 0.3}}}\n"
                               " gr.render{node = ball, file = name .. '.png', width = 40, height = 30, eye = {2, 1.4, "
                               "1.6}, target = {0, 0, 0},\n"
                               " fov = 45, lights = {gr.light{position = {5, 10, 6}, colour = {1, 1, 1}}}} end\n";
    struct test_result result = test_gray_scene(text, "-q -ss 1 scene.lua", NULL);
    size_t size_a = 0, size_b = 0;
    CHECK_EQ_INT(result.status, 0);
    char *a = test_read_file(test_path("a.png"), &size_a), *b = test_read_file(test_path("b.png"), &size_b);
    CHECK(a && b && size_a == size_b && memcmp(a, b, size_a) == 0);
    free(a);
    free(b);
    test_free_result(&result);
}

TEST(every_input_of_a_material_takes_a_function) {
    check_equal("kd = function() return {.5, .25, 1} end, ks = function() return .5 end, emission = function() return"
                " {.125, .25, 0} end, reflect = function() return .5 end, shininess = function() return 8 end,"
                " roughness = function() return .25 end, opacity = function() return .5 end",
                "kd = {.5, .25, 1}, ks = {.5, .5, .5}, emission = {.125, .25, 0}, reflect = .5, shininess = 8,"
                " roughness = .25, opacity = .5",
                "");
}

static void copy_picture(void) {
    size_t size = 0;
    char *bytes = test_read_file("textures/parquet.png", &size);
    CHECK(bytes != NULL);
    test_write_file(test_path("parquet.png"), bytes, size);
    free(bytes);
}

TEST(a_picture_in_a_function_is_the_picture_as_a_texture) {
    copy_picture();
    check_equal("kd = (function() local img = gr.texture{file = 'parquet.png', filter = 'bilinear'}"
                " return gr.fn(function(p, s) return (img:at(s.u, s.v)) end, 1) end)()",
                "kd = gr.texture{file = 'parquet.png', filter = 'bilinear'}", "");
    check_equal("kd = (function() local img = gr.texture{file = 'parquet.png', filter = 'nearest', tiles = {4, -2},"
                " offset = {0.25, 0.5}, flip_u = true, wrap = 'mirror'}"
                " return gr.fn(function(p, s) return (img:at(s.u, s.v)) end, 1) end)()",
                "kd = gr.texture{file = 'parquet.png', filter = 'nearest', tiles = {4, -2}, offset = {0.25, 0.5},"
                " flip_u = true, wrap = 'mirror'}",
                "-j 1 --isa base");
}

TEST(pictures_in_functions_are_recorded_as_lua_reads_them) {
    copy_picture();
    char text[2048];
    (void)snprintf(
        text, sizeof text,
        "local img = gr.texture{file = '%s', encoding = 'srgb'}\n"
        "local c, a = img:at(0.3, 0.7) assert(#c == 3 and c.r > 0 and c.r < 1 and a == 1)\n"
        "gr.fn(function(p, s) local c, a = img:at(p.x, p.y * 3) if c.g > 0.1 then return a end return c end)\n"
        "gr.fn(function(p, s) return img:at(math.floor(p.x), 0.5) * img:at(0.25, p.y) end)\n"
        "local function refused(words, f, ...) local good, why = pcall(f, ...)\n"
        "  assert(not good and why:find(words, 1, true), why) end\n"
        "refused(\"no field 'size'\", function() return img.size end)\n"
        "refused('two numbers u and v, not nil', img.at, img, 1)\n"
        "refused('needs a picture, a result of gr.texture, not a number', img.at, 1, 2)\n"
        "refused('not a texture', img.at, gr.marble_texture(1, 2, 3), 1, 2)\n",
        test_path("parquet.png"));
    struct listener listener = {.renders = 0};
    struct error error = {0};
    const struct script_options options = {.library_folder = "lua", .no_sandbox = true};
    if (!listen_to_text(&listener, text, &options, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

#define CUBE_MESH                                                                                                      \
    "gr.mesh{verts = {{0,0,0},{1,0,0},{1,1,0},{0,1,0},{0,0,1},{1,0,1},{1,1,1},{0,1,1}},"                               \
    " faces = {{0,3,2,1},{4,5,6,7},{0,1,5,4},{2,3,7,6},{1,2,6,5},{0,4,7,3}}}"

TEST(displaced_nodes_are_errors_where_they_cannot_be) {
    const char *f =
        "local f = function(p) return 0.1 * gr.noise(p) end local function mesh() return " CUBE_MESH " end ";
    static const char *const cases[][2] = {
        {"mesh():displace(f, 0.1)", NULL},
        {"gr.difference{mesh():displace{f = f, level = 3}, gr.sphere('s')}", NULL},
        {"gr.node('g'):add_child(mesh()):add_child(mesh()):displace{f = f, level = 1, smooth = 0}", NULL},
        {"local m = mesh() gr.node('g'):add_child(gr.node('h'):add_child(m)):add_child(m):displace{f = f, level = 1} "
         "assert(#select(2, m:faces()) == 48)",
         NULL},
        {"gr.height_field{heights = {{0, 0}, {1, 0}}}:displace(f, 0.1)", NULL},
        {"gr.height_field{f = function(p) return p.x * p.z end, columns = 5, rows = 3}", NULL},
        {"gr.height_field{f = f, heights = {{0, 0}, {1, 0}}}", NULL},
        {"mesh():displace{f = f}", NULL},
        {"mesh():displace{edge = 1}", "f is missing, a function of a vertex"},
        {"mesh():displace{f = f, edge = 1, level = 2}", "edge and level exclude each other"},
        {"gr.sphere('x'):displace(f, 1)", "sphere 'x' has no vertices"},
        {"gr.node('x'):displace(f, 1)", "there is no shape that can be displaced"},
        {"gr.height_field{f = f, columns = 30000}", "30000 columns and 30000 rows are more than 10000000 triangles"},
        {"gr.height_field{heights = {{0, 0}, {1, 0}}, rows = 3}", "columns and rows go with f"},
        {"gr.height_field{f = function(p) return p end}", "the height of a height field is a number, not a vector"},
        {"gr.height_field{f = function(p) return 1 / p.x end}", "at p = {0, 0, 0} the function is infinite"},
        {"gr.height_field{heights = {{0, 0}, {1, 0}}}:displace(function(p) return -p.x end, 0.1)", "the floor of the"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
        check_corner(f, &(struct corner){cases[i][0], cases[i][1]}, NULL);
}

/* The facets of a ball of 20 triangles that fills the picture are less than a tenth of a pixel away from the ball.
 * Pictures of similar sizes have the same mesh, a part of one has that of the whole. */
TEST(without_edge_and_level_a_displaced_ball_has_facets_below_a_tenth_of_a_pixel) {
    static const struct {
        const char *options;
        int pixels;
    } pictures[] = {{"--size 256x256", 256}, {"--size 500x300", 500}, {"--size 600x1000 --crop 0,0,4,4", 1000}};
    test_write_text(
        test_path("ball.lua"),
        "local verts, _, faces = require('polyhedra').geodesic(0)\n"
        "local ball = gr.mesh{verts = verts, faces = faces}:displace{f = function(p) return p:normalize() - p end}\n"
        "local v, f = ball:faces()\nlocal worst = 0\n"
        "for _, t in ipairs(f) do\n  local m = (gr.vec(v[t[1] + 1]) + gr.vec(v[t[2] + 1]) + gr.vec(v[t[3] + 1])) / 3\n"
        "  worst = math.max(worst, 1 - m:length())\nend\n"
        "print(#f, worst * pixels / 2)\nassert(worst * pixels / 2 < .1 and #f < 1e6)\ngr.render{node = ball}\n");
    for (size_t i = 0; i < sizeof pictures / sizeof *pictures; i++) {
        char line[256];
        (void)snprintf(line, sizeof line, "$gray -q --check %s -D pixels=%d ball.lua >%zu.txt", pictures[i].options,
                       pictures[i].pixels, i);
        test_shell_errors(line, 0, NULL);
    }
    test_shell_errors("for i in 0 1 2; do cut -f 1 $i.txt >$i; done; cmp 0 1 && ! cmp -s 1 2", 0, NULL);
}

static const char solids[] =
    "local function wave(p) return 0.04 * math.sin(20 * p.x) * math.sin(15 * p.z) end\n"
    "%s\ngr.render{node = n, file = 'a.png', width = 60, height = 60, eye = {2, 3, 4},"
    " target = {0.5, 0, 0.5}, up = {0, 1, 0}, fov = 40, lights = {gr.light({3, 5, 1}, {1, 1, 1})}}\n";

static void solid_picture(const char *node, char **bytes, size_t *size) {
    char text[2048];
    (void)snprintf(text, sizeof text, solids, node);
    struct test_result result = test_gray_scene(text, "-q scene.lua", NULL);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", node, result.err);
    test_free_result(&result);
    *bytes = test_read_file(test_path("a.png"), size);
}

TEST(a_height_field_of_a_function_is_that_of_its_table) {
    char *bytes[2];
    size_t sizes[2] = {0, 0};
    solid_picture("local n = gr.height_field{f = wave, columns = 33, rows = 17, smooth = true}", &bytes[0], &sizes[0]);
    solid_picture("local rows = {} for j = 0, 16 do rows[j + 1] = {} for i = 0, 32 do"
                  " rows[j + 1][i + 1] = wave{x = i / 32, z = j / 16} end end"
                  " local n = gr.height_field{heights = rows, smooth = true}",
                  &bytes[1], &sizes[1]);
    CHECK(bytes[0] && bytes[1] && sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0);
    free(bytes[0]);
    free(bytes[1]);
}

TEST(pictures_of_functions_have_one_hash_for_threads_and_instruction_sets) {
    static const char fields[] = "kd = function(p, s) return gr.cells(p * 5) * gr.vec(s.u, s.v, gr.noise(p * 3)) end";
    check_equal(fields, fields, "-j 1 --isa base");
}

TEST(a_value_that_is_not_a_number_is_black) {
    check_equal("kd = function(p) return {0 * p.x / 0, 1, p.x * 0} end", "kd = {0, 1, 0}", "");
}

TEST(the_operations_of_loops_are_listed_below_them) {
    char text[2048];
    (void)snprintf(text, sizeof text, stage,
                   "kd = function(p) return (gr.loop(2000, p.x, function(i, a) return a * p.y - i end)) end", "a.png");
    struct test_result result = test_gray_scene(text, "--dump-expr scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.out, "a.png: functions\n"
                           "  scene.lua:1: 4 operations, 5 constants, 3 registers\n"
                           "    r0 = p.x\n"
                           "    r1 = p.y\n"
                           "    loop 0: r0 = r0\n"
                           "    loop 0: r1 = r1\n"
                           "    loop 0: for r2 = 1 to 2000 while r0 > 0\n"
                           "        r3 = multiply r0 r1\n"
                           "        r4 = to_float r2\n"
                           "        r4 = subtract r3 r4\n"
                           "        r0 ... = r4\n"
                           "    r2 = loop 0: r0\n"
                           "    result r2\n");
    test_free_result(&result);
}

/* Each prints a line that begins with its source. */
TEST(functions_of_textures_solids_lights_skies_and_fogs_are_listed_once) {
    static const char scene[] =
        "local f = gr.fn(function(p) return p.x - 0.25 end)\n"
        "local solid = gr.implicit{f = f, radius = 1, material = gr.material{kd = f}}\n"
        "local cut = gr.difference('d', gr.sphere('s'), gr.implicit{f = function(p) return p.y end, radius = 1})\n"
        "local node = gr.node('n'):add_child(solid):add_child(cut:set_material(gr.material{kd = {1, 1, 1}}))\n"
        "local colour = function(d) return d.z end\n"
        "local sky = function(d) return {d.y, 0, 1} end\n"
        "local density = function(p) return p.x + 1 end\n"
        "local glow = function(p) return p.y + 1 end\n"
        "gr.render{node = node, file = 'a.png', width = 8, height = 8, eye = {0, 0, 5}, view = {0, 0, -1},"
        " background = sky, lights = {gr.light{position = {1, 2, 3}, colour = colour}},"
        " fog = gr.fog_field({-1, -1, -1}, 2, density, glow)}\n";
    static const int lines[] = {1, 3, 5, 6, 7, 8};
    struct test_result result = test_gray_scene(scene, "--dump-expr scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *at = result.out;
    for (int i = 0; i < 6; i++) {
        char words[32];
        (void)snprintf(words, sizeof words, "  scene.lua:%d: ", lines[i]);
        at = strstr(at, words);
        if (!at)
            test_fail(__FILE__, __LINE__, "no function of line %d in its place: %s", lines[i], result.out);
        at += strlen(words);
    }
    CHECK(!strstr(at, "scene.lua:"));
    test_free_result(&result);
}

TEST(the_operations_of_functions_are_listed) {
    char text[2048];
    (void)snprintf(text, sizeof text, stage, "kd = function(p) return p.x * 2 + 1 end", "a.png");
    struct test_result result = test_gray_scene(text, "--dump-expr scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.out, "a.png: functions\n"
                           "  scene.lua:1: 2 operations, 2 constants, 2 registers\n"
                           "    r0 = p.x\n"
                           "    r1 = multiply r0 2\n"
                           "    r1 = add r1 1\n"
                           "    result r1\n");
    test_free_result(&result);
    result = test_gray_scene(text, "--dump-expr --json scene.lua", NULL);
    CHECK_TEXT(result.out, "{\"picture\":\"a.png\",\"functions\":[{\"source\":\"scene.lua:1\",\"operations\":2,"
                           "\"constants\":2,\"registers\":2,\"code\":[\"r0 = p.x\",\"r1 = multiply r0 2\","
                           "\"r1 = add r1 1\",\"result r1\"]}]}\n");
    test_free_result(&result);
}
