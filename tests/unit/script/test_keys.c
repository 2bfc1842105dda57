/* gr.keys and node:pose against closed forms. */
#include "tests/unit/script_host.h"

#include "render/camera.h"

#include <math.h>

static struct render_request seen[8];

static void see(struct listener *listener, const struct render_request *request) {
    if (listener->renders < 8)
        seen[listener->renders] = *request;
}

static int runs(const char *text, struct listener *listener) {
    struct error error = {0};
    *listener = (struct listener){.seen = see};
    if (!listen_to_text(listener, text, NULL, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", text, error.text);
    return listener->renders;
}

/* near(a, b): numbers, or tables of as many. */
#define NEAR                                                                                                           \
    "local function near(a, b)\n"                                                                                      \
    "  if type(a) == 'table' then assert(#a == #b) for i = 1, #a do near(a[i], b[i]) end return end\n"                 \
    "  if not (math.abs(a - b) < 1e-12) then error(a .. ' is not ' .. b, 2) end\n"                                     \
    "end\n"                                                                                                            \
    "local times, values = {-1, 0.5, 1, 3.25}, {2, -1, 5, 4}\n"                                                        \
    "local function keys(map, options)\n"                                                                              \
    "  for i = 1, 4 do options[i] = {times[i], map(values[i])} end return gr.keys(options)\n"                          \
    "end\n"                                                                                                            \
    "local function same(x) return x end\n"                                                                            \
    "local function turn(x) return {rotate = {math.cos(x / 2), math.sin(x / 2) * 0.6, 0, math.sin(x / 2) * 0.8}} "     \
    "end\n"

/* catmull(t): the Hermite form, with the tangents of the definition. */
#define CATMULL                                                                                                        \
    "local function slope(i)\n"                                                                                        \
    "  local a, b = math.max(i - 1, 1), math.min(i + 1, 4) return (values[b] - values[a]) / (times[b] - times[a])\n"   \
    "end\n"                                                                                                            \
    "local function catmull(t)\n"                                                                                      \
    "  local i = 1 while i < 3 and t >= times[i + 1] do i = i + 1 end\n"                                               \
    "  local h = times[i + 1] - times[i] local s = (t - times[i]) / h\n"                                               \
    "  return (2 * s^3 - 3 * s^2 + 1) * values[i] + (s^3 - 2 * s^2 + s) * h * slope(i)\n"                              \
    "    + (3 * s^2 - 2 * s^3) * values[i + 1] + (s^3 - s^2) * h * slope(i + 1)\n"                                     \
    "end\n"

TEST(keys_interpolate_numbers_by_the_formula_of_their_curve) {
    static struct listener listener;
    (void)runs(NEAR CATMULL
               "local linear, smooth = keys(same, {}), keys(same, {curve = 'catmull'})\n"
               "for i = 1, 4 do assert(linear(times[i]) == values[i] and smooth(times[i]) == values[i]) end\n"
               "assert(linear(-7) == 2 and linear(1e9) == 4 and smooth(-math.huge) == 2 and smooth(math.huge) == 4)\n"
               "near(linear(-0.25), 0.5) near(linear(0.75), 2) near(linear(2.125), 4.5)\n"
               "for t = -1, 3.25, 1 / 64 do near(smooth(t), catmull(t)) end\n"
               "local bezier = gr.keys{{0, 1, after = 4}, {2, 3, before = -2}, curve = 'bezier'}\n"
               "local rests = gr.keys{{0, 1}, {2, 3}, curve = 'bezier'}\n"
               "for s = 0, 1, 1 / 32 do local r = 1 - s\n"
               "  near(bezier(2 * s), r^3 + 12 * r^2 * s - 6 * r * s^2 + 3 * s^3)\n"
               "  near(rests(2 * s), 1 + 2 * (3 * s^2 - 2 * s^3))\n"
               "end\n"
               "local line = gr.keys{{0, 1}, {2, 3}, curve = 'catmull'} near(line(0.5), 1.5)\n"
               "local one = gr.keys{{3, 7}} assert(one(0) == 7 and one(3) == 7 and one(4) == 7)",
               &listener);
}

TEST(keys_interpolate_tables_of_numbers_and_colours_by_components) {
    static struct listener listener;
    (void)runs(
        NEAR CATMULL
        "local function pair(x) return {x, 3 * x, -x} end\n"
        "local many = keys(function(x) return {x, 1, x + 1, 0.1, 0.3} end, {curve = 'catmull'})\n"
        "local v, named = keys(pair, {curve = 'catmull'}), keys(function(x) return {a = x, b = pair(x)} end, {})\n"
        "for t = -1, 3.25, 1 / 8 do local x = catmull(t)\n"
        "  near(v(t), {x, 3 * x, -x}) near((v(t) * 2).y, 6 * x) near(many(t), {x, 1, x + 1, 0.1, 0.3})\n"
        "  assert(many(t)[2] == 1 and many(t)[4] == 0.1 and many(t)[5] == 0.3)\n"
        "end\n"
        "near(named(0.75).a, 2) near(named(0.75).b, {2, 6, -2})\n"
        "local colour = gr.keys{{0, '#ff0000'}, {1, gr.srgb(0, 0.5, 1)}}\n"
        "near(colour(0.25), {0.75, 0.125, 0.25}) assert(colour(0.25).encoding == 'srgb')\n"
        "local red = gr.material(colour(0.5), {0, 0, 0}, 1)",
        &listener);
}

/* About one axis a point of the unit sphere moves as its angle: by the same curves of a number. */
TEST(rotations_between_keys_follow_the_curve_of_their_angle) {
    static struct listener listener;
    (void)runs(
        NEAR CATMULL
        "values = {0.2, -0.4, 1, 2.5}\n"
        "local linear, smooth = keys(turn, {}), keys(turn, {curve = 'catmull'})\n"
        "local angle = keys(same, {})\n"
        "for t = -1, 3.25, 1 / 32 do\n"
        "  near(linear(t).rotate, turn(angle(t)).rotate) near(smooth(t).rotate, turn(catmull(t)).rotate)\n"
        "end\n"
        "local bezier = gr.keys{{0, turn(0), after = turn(0.5)}, {1, turn(2), before = turn(1)}, curve = 'bezier'}\n"
        "for s = 0, 1, 1 / 32 do local r = 1 - s\n"
        "  near(bezier(s).rotate, turn(1.5 * r^2 * s + 3 * r * s^2 + 2 * s^3).rotate)\n"
        "end\n"
        /* the shorter way: 300 degrees are -60 */
        "local short = gr.keys{{0, turn(0)}, {1, turn(math.rad(300))}} near(short(0.5).rotate, "
        "turn(math.rad(-30)).rotate)\n"
        "local long = gr.keys{{0, {rotate = {2, 0, 0, 0}}}, {1, {rotate = {-5, 0, 0, 0}}}}\n"
        "near(long(0.5).rotate, {1, 0, 0, 0})\n"
        "local eased = gr.keys{{0, turn(0)}, {2, turn(1)}, ease = function(s) return s * s end}\n"
        "near(eased(1).rotate, turn(0.25).rotate)\n"
        "local over = gr.keys{{0, 10}, {2, 20}, ease = function(s) return 1 + s end} near(over(1), 25)",
        &listener);
}

TEST(a_pose_of_keys_is_that_of_its_node) {
    static struct listener listener;
    static const char text[] =
        "local root, ball = gr.node('r'), gr.sphere{}\nroot:add_child(ball)\nball:rotate('x', 33)\n"
        "local k = gr.keys{{0, {translate = {0, 0, 0}, rotate = {1, 0, 0, 0}, scale = {1, 1, 1}}},\n"
        "  {2, {translate = {8, -4, 2}, rotate = {math.cos(math.rad(60)), 0, math.sin(math.rad(60)), 0}, scale = {3, "
        "2, 1}}}}\n"
        "gr.frames{count = 3, fps = 1, draw = function() assert(k().translate == k(gr.time).translate)\n"
        "  ball:pose(k()) return {node = root, file = 'x.png', width = 4, height = 3, eye = {0, 0, 9}, view = {0, 0, "
        "-1},\n"
        "  fov = 40, lights = {}} end}\n"
        "local before = ball:pose({1, 2, 3}):bounds() assert(before[1] == 0 and before[2] == 1 and before[3] == 2)\n"
        "gr.transform_order('old') before = ball:pose{translate = {1, 0, 0}, scale = 2}:bounds() assert(before[1] == "
        "-1)\n"
        "gr.transform_order('separate') before = ball:pose{translate = {1, 0, 0}, scale = 2}:bounds()\n"
        "assert(before[1] == -1) ball:pose{scale = {1, 0, 1}} assert(not pcall(ball.pose, ball, {rotate = {0, 0, 0, "
        "0}}))\n";
    CHECK_EQ_INT(runs(text, &listener), 3);
    for (int k = 0; k < 3; k++) {
        double angle = k * M_PI / 3, c = cos(angle), s = sin(angle), share = k / 2.0;
        const struct affine *m = &listener.first_child[k];
        CHECK_NEAR(m->m[0][0], c * (1 + 2 * share), 1e-12);
        CHECK_NEAR(m->m[0][2], s, 1e-12);
        CHECK_NEAR(m->m[2][0], -s * (1 + 2 * share), 1e-12);
        CHECK_NEAR(m->m[1][1], 1 + share, 1e-12);
        CHECK_NEAR(m->m[0][3], 8 * share, 1e-12);
        CHECK_NEAR(m->m[1][3], -4 * share, 1e-12);
        CHECK_NEAR(m->m[2][3], 2 * share, 1e-12);
    }
}

TEST(a_camera_of_keys_turns_on_the_great_circle) {
    static struct listener listener;
    static const char text[] =
        "local root = gr.node('r') root:add_child(gr.sphere{})\n"
        "local camera = gr.keys{{0, {eye = {0, 0, 8}, view = {0, 0, -2}, fov = 40}}, {1, {eye = {8, 0, 0}, view = {-1, "
        "0, 0}, fov = 20}}}\n"
        "gr.frames{count = 5, fps = 4, draw = function() local show = camera()\n"
        "  show.node, show.file, show.width, show.height, show.lights = root, 'x.png', 4, 3, {} return show end}\n";
    CHECK_EQ_INT(runs(text, &listener), 5);
    for (int k = 0; k < 5; k++) {
        CHECK_NEAR(seen[k].camera.eye.x, 2 * k, 1e-12);
        CHECK_NEAR(seen[k].camera.eye.z, 8 - 2 * k, 1e-12);
        CHECK_NEAR(seen[k].camera.view.x, -sin(k * M_PI / 8), 1e-12);
        CHECK_NEAR(seen[k].camera.view.z, -cos(k * M_PI / 8), 1e-12);
        CHECK_NEAR(seen[k].camera.fov, 40 - 5 * k, 1e-12);
    }
}

TEST(wrong_keys_are_errors_that_name_the_key) {
    static const struct corner wrong[] = {
        {"{}", "1 to 1048576 keys"},
        {"3", "one table of keys"},
        {"{5}", "keys[1] must be {seconds, value}"},
        {"{{0, 1}, {0, 2}}", "the time of keys[2] is 0.0, not later than that of keys[1], 0.0"},
        {"{{0, 1}, {1, 2}, {0.5, 2}}", "the time of keys[3] is 0.5, not later than that of keys[2], 1.0"},
        {"{{0 / 0, 1}}", "keys[1] must be {seconds, value}"},
        {"{{math.huge, 1}}", "keys[1] must be {seconds, value}"},
        {"{['1'] = {0, 1}, {0, 1}}", "unknown field '1'"},
        {"{[0] = {0, 1}, {1, 2}}", "unknown field '0'"},
        {"{[1] = {0, 1}, [9] = {1, 2}}", "keys[2] is missing"},
        {"{{1 / 0, 1}}", "keys[1] must be {seconds, value}, with a finite number of seconds"},
        {"{{0}}", "the value of keys[1] must be a number"},
        {"{{0, 'red'}}", "the value of keys[1] must be a number"},
        {"{{0, '#12'}}", "'#12' is not a colour"},
        {"{{0, {}}}", "is an empty table"},
        {"{{0, 0 / 0}}", "must be of finite numbers"},
        {"{{0, {1, 'x'}}}", "must be of finite numbers"},
        {"{{0, {1, 2}}, {1, {1, 2, 3}}}", "the value of keys[2] is of another kind than the value of keys[1]"},
        {"{{0, 1}, {1, {a = 1}}}", "the value of keys[2] is of another kind"},
        {"{{0, {a = 1}}, {1, {b = 1}}}", "a in the value of keys[2] is missing"},
        {"{{0, {a = 1}}, {1, {a = 1, b = 1}}}", "has other fields than the value of keys[1]"},
        {"{{0, {rotate = {1, 0, 0}}}}", "rotate in the value of keys[1] must be a quaternion"},
        {"{{0, {rotate = {0, 0, 0, 0}}}}", "rotate in the value of keys[1] must not be 0"},
        {"{{0, {view = {1, 0, 0}}}, {1, {view = {-2, 0, 0}}}}", "view in the value of keys[2] is opposite"},
        {"{{0, 1, before = 2}, {1, 1}}", "before of keys[1] needs curve = 'bezier'"},
        {"{{0, 1, 2}}", "keys[1] must be {seconds, value}"},
        {"{{0, 1, befor = 2}, curve = 'bezier'}", "keys[1] must be {seconds, value}, for 'bezier'"},
        {"{{0, 1, before = {2}}, curve = 'bezier'}", "before of keys[1] is of another kind"},
        {"{{0, 1}, curve = 'cubic'}", "curve must be 'linear', 'catmull' or 'bezier'"},
        {"{{0, 1}, ease = 1}", "ease must be a function"},
        {"{{0, 1}, loop = true}", "unknown field 'loop'; the fields are curve, ease"},
    };
    static const struct corner calls[] = {
        {"gr.keys{{0, 1}}('x')", "gr.keys: the time must be a number of seconds, not a string"},
        {"local k = gr.keys{{0, 1}} gr.material{kd = function(p) return k(p.x) end}",
         "the time must be a number of seconds, not a number of a recorded function"},
        {"gr.keys{{0, 1}}(0 / 0)", "the time is not a number"},
        {"gr.keys{{0, 1}, {1, 2}, ease = function() end}(0.5)", "ease(0.5) must be a finite number"},
        {"gr.keys{{0, 1}, {1, 2}, ease = function() error('no') end}(0.5)", "no"},
        {"local t = {} for i = 1, 65 do t[i] = i end gr.keys{{0, t}}", "must be a table of 1 to 64 numbers"},
        {"local t = {} for i = 1, 33 do t['a' .. i] = i end gr.keys{{0, t}}", "has more than 32 fields"},
        {"local t, u = {}, {} for i = 1, 33 do t[i] = i end gr.keys{{0, {a = t, b = t}}}", "more than 64 numbers"},
    };
    char text[256];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        (void)snprintf(text, sizeof text, "gr.keys(%s)", wrong[i].text);
        check_corner("", &(struct corner){text, wrong[i].words}, NULL);
    }
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        check_corner("", &calls[i], NULL);
}

/* gr.keys is Lua of the program in the state of the scene. */
TEST(a_scene_cannot_change_the_lua_of_gr_keys) {
    static struct listener listener;
    (void)runs("local get, format = rawget, string.format\n"
               "for _, t in ipairs{math, string, table, _G} do\n"
               "  for name, f in pairs(t) do if type(f) == 'function' and f ~= error and f ~= assert and f ~= pairs\n"
               "    and f ~= type and f ~= getfenv and f ~= setfenv and f ~= pcall and f ~= rawget\n"
               "    then t[name] = function() error('reached') end end end\n"
               "end\n"
               "local env, inner = getfenv(1), nil\n"
               "local k = gr.keys{{0, {view = {0, 0, 1}, n = 1}}, {2, {view = {0, 1, 0}, n = 3}}, curve = 'catmull',\n"
               "  ease = function(s) inner = getfenv(2) setfenv(2, {}) return s end}\n"
               "assert(k(1).n == 2 and inner == env and getfenv(k) == env and k(1).n == 2)\n"
               "local ok, text = pcall(k, {}) assert(not ok and type(text) == 'string')",
               &listener);
}
