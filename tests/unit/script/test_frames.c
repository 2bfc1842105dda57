/* gr.frames, --frames and --turntable: numbers, times and poses of frames, by closed forms. */
#include "tests/unit/script_host.h"

#include <math.h>

/* A script with one ball; `body` uses it, and `show` is a table for gr.render. */
#define BALL                                                                                                           \
    "local root, ball = gr.node('r'), gr.sphere{}\nroot:add_child(ball)\n"                                             \
    "local show = {node = root, file = 'x.png', width = 4, height = 3, eye = {0, 0, 9}, view = {0, 0, -1}, fov = 40, " \
    "lights = {}}\n"

/* The same without warnings. */
#define PLAIN "gr.sphere = function() return gr.node('ball') end\n" BALL

enum { SEEN_MAX = 64 };
static struct render_request seen[SEEN_MAX];

static void see(struct listener *listener, const struct render_request *request) {
    if (listener->renders < SEEN_MAX)
        seen[listener->renders] = *request;
}

static int frames_of(const char *text, struct frame_options frames, struct listener *listener) {
    struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua", .frames = frames};
    struct error error = {0};
    *listener = (struct listener){.seen = see};
    if (!listen_to_text(listener, text, &options, &error))
        test_fail(__FILE__, __LINE__, "%s: %s", text, error.text);
    return listener->renders;
}

static void fails(const char *text, struct frame_options frames, const char *words) {
    struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua", .frames = frames};
    struct listener listener = {0};
    struct error error = {0};
    bool done = listen_to_text(&listener, text, &options, &error);
    if (done || !strstr(error.text, words))
        test_fail(__FILE__, __LINE__, "%s: %s", text, done ? "runs" : error.text);
}

TEST(frames_are_numbered_from_one_and_their_clock_ends_at_one_or_before_the_loop) {
    static struct listener listener;
    const struct frame_options all = {0};
    CHECK_EQ_INT(frames_of(BALL "gr.frames{count = 5, draw = function(t, k) assert(t == (k - 1) / 4 and t == gr.clock "
                                "and gr.frame == k and gr.time == (k - 1) / 30) return show end}\n"
                                "assert(gr.frame == 0 and gr.time == 0 and gr.clock == 0)",
                           all, &listener),
                 5);
    for (uint32_t k = 0; k < 5; k++) {
        CHECK_EQ_INT(seen[k].frame.number, k + 1);
        CHECK_EQ_INT(seen[k].frame.count, 5);
        CHECK(!seen[k].frame.loops);
    }
    CHECK_EQ_INT(frames_of(BALL "gr.frames{count = 8, fps = 12, loop = true, draw = function(t, k) assert(t == (k - 1) "
                                "/ 8 and gr.time == (k - 1) / 12) return show end}",
                           all, &listener),
                 8);
    CHECK(seen[7].frame.loops);
    CHECK_EQ_INT(frames_of(BALL "gr.frames(1, function(t) assert(t == 0) return show end)", all, &listener), 1);
    CHECK_EQ_INT(frames_of(BALL "gr.frames{seconds = 0.5, draw = function(t) return show end}", all, &listener), 15);
    CHECK_EQ_INT(frames_of(BALL "gr.frames{seconds = 0.5, draw = function(t) return show end}",
                           (struct frame_options){.rate = 8}, &listener),
                 4);
}

/* `draw` moves the ball by half a unit each time: after frame k it is at k / 2, whichever frames are rendered. */
TEST(a_node_that_moves_in_each_frame_is_where_it_would_be_without_a_selection) {
    static struct listener listener;
    static const char text[] =
        BALL "gr.frames{count = 20, draw = function() ball:translate(0.5, 0, 0) return show end}";
    CHECK_EQ_INT(frames_of(text, (struct frame_options){0}, &listener), 20);
    for (int k = 1; k <= 20; k++)
        CHECK_NEAR(listener.first_child[k - 1].m[0][3], k / 2.0, 0);
    CHECK_EQ_INT(frames_of(text, (struct frame_options){.selection = {5, 14, 3}}, &listener), 4);
    for (int i = 0; i < 4; i++) {
        CHECK_EQ_INT(seen[i].frame.number, 5 + 3 * i);
        CHECK_NEAR(listener.first_child[i].m[0][3], (5 + 3 * i) / 2.0, 0);
    }
}

TEST(a_pure_draw_is_called_for_selected_frames_only_and_has_the_same_random_numbers) {
    static struct listener listener;
    static const char text[] = BALL "local calls = 0\n"
                                    "gr.frames{count = 9, pure = PURE, draw = function(t, k) calls = calls + 1\n"
                                    "if PURE then assert(calls == 1 and k == 7) end\n"
                                    "ball:reset():translate(math.random(), math.random(1000), 0) return show end}";
    char pure[sizeof text + 32];
    CHECK_EQ_INT(frames_of(text, (struct frame_options){0}, &listener), 9);
    struct affine wanted = listener.first_child[6], other = listener.first_child[5];
    (void)snprintf(pure, sizeof pure, "PURE = true %s", text);
    CHECK_EQ_INT(frames_of(pure, (struct frame_options){.selection = {7, 7, 1}}, &listener), 1);
    CHECK(memcmp(&listener.first_child[0], &wanted, sizeof wanted) == 0);
    CHECK(memcmp(&other, &wanted, sizeof wanted) != 0);
}

/* Velocities are per second, the shutter is in frames. */
TEST(the_shutter_of_a_frame_is_a_part_of_its_time) {
    static struct listener listener;
    const struct frame_options all = {0};
    (void)frames_of(BALL "gr.frames{count = 2, fps = 25, shutter = {0, 0.5}, draw = function() return show end}", all,
                    &listener);
    CHECK_NEAR(seen[1].settings.shutter.open, 0, 0);
    CHECK_NEAR(seen[1].settings.shutter.close, 0.02, 1e-18);
    (void)frames_of(BALL "show.shutter = {-1, 1} gr.frames{count = 2, fps = 10, draw = function() return show end}",
                    all, &listener);
    CHECK_NEAR(seen[0].settings.shutter.open, -0.1, 1e-18);
    CHECK_NEAR(seen[0].settings.shutter.close, 0.1, 1e-18);
    (void)frames_of(BALL "gr.frames{count = 2, draw = function() return show end} gr.render(show)", all, &listener);
    CHECK_NEAR(seen[0].settings.shutter.close, 0, 0);
    CHECK_NEAR(seen[2].settings.shutter.close, 1, 0);
    CHECK_EQ_INT(seen[2].frame.number, 0);
}

/* The first run of a script with --frames may still call gr.frames. */
TEST(errors_before_and_after_the_frames_of_an_animation_name_no_frame) {
    static const char *const texts[] = {"error('no')\ngr.frames{count = 3, draw = error}\n",
                                        PLAIN "gr.frames{count = 3, draw = function() return show end}\nerror('no')\n",
                                        "pcall(gr.frames, {count = 3, draw = error}) error('no')\n"};
    for (int i = 0; i < 3; i++) {
        struct test_result result = test_gray_scene(texts[i], "-q --frames 2-3 scene.lua", NULL);
        CHECK_EQ_INT(result.status, 1);
        CHECK(strstr(result.err, ": no\n") != NULL);
        test_free_result(&result);
    }
    struct test_result result =
        test_gray_scene("if gr.frame == 3 then error('no') end\n", "--frames 2-3 scene.lua", NULL);
    CHECK(strstr(result.err, "scene.lua:1: no (frame 3)\n") != NULL);
    test_free_result(&result);
}

TEST(a_script_that_renders_some_frames_is_not_reported_to_render_nothing) {
    struct test_result result = test_gray_scene(PLAIN "gr.render(show)\n", "--frames 2-3 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(!strstr(result.err, "no picture was rendered"));
    test_free_result(&result);
    result = test_gray_scene("local x\n", "--frames 2-3 scene.lua", NULL);
    CHECK_TEXT(result.err, "scene.lua: no picture was rendered, because the script did not call gr.render\n");
    test_free_result(&result);
}

TEST(a_second_picture_of_a_frame_does_not_replace_the_first_under_a_name_of_the_command_line) {
    static const char *const texts[] = {PLAIN "gr.render(show) show.file = 'other.png' gr.render(show)\n",
                                        PLAIN "for i = 1, 2 do gr.frames{count = 3, draw = function() return show end} "
                                              "end\n"};
    for (int i = 0; i < 2; i++) {
        struct test_result result = test_gray_scene(texts[i], "-q --frames 3 -o x.##.png scene.lua", NULL);
        CHECK_EQ_INT(result.status, 2);
        CHECK(
            strstr(result.err,
                   "gray: -o x.##.png: x.01.png, the only name for frame 1, is already another picture of this run") ==
            result.err);
        test_free_result(&result);
    }
    /* Scripts choose names of their own, and frames of a turntable are counted. */
    struct test_result result = test_gray_scene(texts[0], "-q --frames 2 scene.lua", NULL);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    result = test_gray_scene(texts[0], "-q --turntable 2 -o x.##.png scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
}

TEST(traces_and_dumps_of_frames_have_the_names_of_their_files) {
    struct test_result result =
        test_gray_scene(PLAIN "show.file = nil gr.frames{count = 12, draw = function() return show end}\n",
                        "--frames 9-12/3 --pixel 1,1 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "scene.0009.png, pixel 1,1 of 4 x 3") == result.out);
    CHECK(strstr(result.out, "\nscene.0012.png, pixel 1,1 of 4 x 3") != NULL);
    test_free_result(&result);
    result = test_gray_scene(PLAIN "gr.render(show)\n", "--turntable 2 --dump-scene --json scene.lua", NULL);
    CHECK(strstr(result.out, "\"picture\":\"x.0002.png\"") != NULL);
    test_free_result(&result);
}

TEST(wrong_animations_are_errors_that_name_the_frame) {
    static const struct {
        const char *text, *words;
    } wrong[] = {
        {"gr.frames{count = 3, fps = 0, draw = print}", "gr.frames: fps must be between 0.01 and 1000"},
        {"gr.frames{count = 0, draw = print}", "count must be >= 1"},
        {"gr.frames{count = 2.5, draw = print}", "count must be a whole number"},
        {"gr.frames{count = 10^9, draw = print}", "1000000000 frames are more than 10000000"},
        {"gr.frames{seconds = 10^9, draw = print}", "frames are more than 10000000"},
        {"gr.frames{draw = print}", "count or seconds is missing"},
        {"gr.frames{count = 2, seconds = 2, draw = print}", "count and seconds exclude each other"},
        {"gr.frames{count = 2}", "draw is missing"},
        {"gr.frames{count = 2, draw = 7}", "draw must be a function, not a number"},
        {"gr.frames{count = 2, shutter = {1, 0}, draw = print}", "shutter must not end before it begins"},
        {"gr.frames{count = 2, drow = 7, draw = print}", "did you mean"},
        {"gr.frames{count = 2, draw = function() end}",
         "gr.frames: draw returned nil, not the table of fields for gr.render (frame 1)"},
        {"gr.frames{count = 9, draw = function(t, k) return k < 4 and show or 7 end}", "draw returned a number"},
        {"gr.frames{count = 9, draw = function(t, k) if k == 5 then error('no') end return show end}", "no (frame 5)"},
        {"gr.frames{count = 9, draw = function(t, k) show.fov = 60 * k return show end}", "(frame 3)"},
        {"gr.frames{count = 2, draw = function() gr.frames{count = 2, draw = print} end}",
         "it is called while another gr.frames draws its frames"},
        {"pcall(gr.frames, {count = 2, draw = error}) assert(gr.frame == 0) error('later')", "later"},
    };
    char text[2048];
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        (void)snprintf(text, sizeof text, "%s%s", BALL, wrong[i].text);
        fails(text, (struct frame_options){0}, wrong[i].words);
    }
    static const char four[] = BALL "gr.frames{count = 4, draw = function() return show end}";
    fails(four, (struct frame_options){.selection = {3, 5, 1}}, "--frames selects frame 5, but the last frame is 4");
    fails(four, (struct frame_options){.turntable = 4}, "--turntable is for scripts without gr.frames");
    struct test_result result = test_gray_scene(four, "-q --frames 500 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "gr.frames: --frames selects frame 500, but the last frame is 4\n") != NULL);
    test_free_result(&result);
}

/* The eye goes around the middle of the ball at (2, 0, 0), in a circle of radius 9, and always looks at it. */
TEST(a_turntable_goes_once_around_the_scene) {
    static struct listener listener;
    static const char text[] =
        BALL "ball:translate(2, 0, 0) show.eye = {2, 3, 9} show.view = {0, 0, -1} gr.render(show)";
    CHECK_EQ_INT(frames_of(text, (struct frame_options){.turntable = 12}, &listener), 12);
    for (int k = 0; k < 12; k++) {
        double angle = k * M_PI / 6;
        CHECK_EQ_INT(seen[k].frame.number, k + 1);
        CHECK(seen[k].frame.loops);
        CHECK_NEAR(seen[k].camera.eye.x, 2 + 9 * sin(angle), 1e-12);
        CHECK_NEAR(seen[k].camera.eye.y, 3, 1e-12);
        CHECK_NEAR(seen[k].camera.eye.z, 9 * cos(angle), 1e-12);
        CHECK_NEAR(seen[k].camera.view.x, -sin(angle), 1e-12);
        CHECK_NEAR(seen[k].camera.view.z, -cos(angle), 1e-12);
    }
    CHECK_EQ_INT(frames_of(text, (struct frame_options){.turntable = 12, .selection = {4, 4, 1}}, &listener), 1);
    CHECK_NEAR(seen[0].camera.eye.x, 11, 1e-12);
}

TEST(a_script_without_gr_frames_runs_once_for_each_frame) {
    struct test_result result = test_gray_scene(BALL "print(gr.frame, gr.time, gr.clock) gr.render(show)\n",
                                                "-q --frames 2-6/2 --fps 4 -o x.##.png scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.out, "1\t0\t0\n2\t0.25\t0.2\n4\t0.75\t0.6\n6\t1.25\t1\n");
    test_free_result(&result);
    for (int k = 1; k <= 6; k++) {
        char name[32];
        (void)snprintf(name, sizeof name, "x.%02d.png", k);
        size_t size;
        char *bytes = test_read_file(test_path(name), &size);
        CHECK((bytes != NULL) == (k % 2 == 0));
        free(bytes);
    }
}

TEST(the_limit_of_time_is_that_of_one_frame) {
    static const char text[] = BALL "gr.frames{count = 6, draw = function(t, k) local from = os.clock()\n"
                                    "while k == LAST or os.clock() - from < 0.15 do end return show end}\n";
    struct test_result result = test_gray_scene(text, "-q --script-time 0.4 -D LAST=0 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    result = test_gray_scene(text, "-q --script-time 0.4 -D LAST=3 -o n##.png scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "used up its 0.4 s of processor time (--script-time allows more) (frame 3)") != NULL);
    test_free_result(&result);
}

TEST(the_command_line_limits_and_raises_the_number_of_frames) {
    static const char text[] = BALL "gr.frames{count = 200000, draw = function() return show end}\n";
    struct test_result result = test_gray_scene(text, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 1);
    CHECK(strstr(result.err, "200000 frames are more than 100000 (--picture-count allows more)") != NULL);
    test_free_result(&result);
    result = test_gray_scene(text, "-q --picture-count 200000 --frames 2-3 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    free(test_read_file(test_path("x.0003.png"), NULL));
}

/* Each frame makes 2000 nodes, more than a megabyte. With KEEP the script holds all of them to its end, so that nothing
 * is freed; USE is what older objects do with newer ones. */
#define CROWD                                                                                                          \
    "local red, held, kept = gr.material({0.9, 0.4, 0.2}, {0, 0, 0}, 1), nil, {}\n"                                    \
    "local root, old, target = gr.node('root'), gr.sphere(red), gr.node('target')\nroot:add_child(old)\n"              \
    "gr.frames{count = 15, draw = function(t, k)\n"                                                                    \
    "  local group, last = gr.node('group' .. k)\n"                                                                    \
    "  for i = 1, 2000 do\n"                                                                                           \
    "    local ball = gr.sphere{material = red, radius = 0.02, name = 'ball' .. i}\n"                                  \
    "    if i % 200 == 0 then group:add_child(ball:translate(math.random() * 4 - 2, math.random() * 4 - 2, 1)) end\n"  \
    "    if KEEP then kept[#kept + 1] = ball end\n"                                                                    \
    "    last = ball\n"                                                                                                \
    "  end\n"                                                                                                          \
    "  if KEEP then kept[#kept + 1] = group end\n"                                                                     \
    "  local new = gr.material({t, 1 - t, 0.5}, {0, 0, 0}, 1)\n"                                                       \
    "  local mesh = gr.mesh{verts = {{0, 0, 2}, {t, 0, 2}, {0, 1, 2}}, faces = {{0, 1, 2}}}\n"                         \
    "  local show = gr.node('show', {root, group, mesh})\n"                                                            \
    "  USE\n"                                                                                                          \
    "  return {node = show, width = 32, height = 24, eye = {0, 0, 9}, view = {0, 0, -1}, fov = 40,\n"                  \
    "          lights = {gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0})}} end}\n"

static struct test_result run_crowd(const char *use, const char *options) {
    char text[4096], line[256];
    const char *at = strstr(CROWD, "USE\n");
    (void)snprintf(text, sizeof text, "%.*s%s%s", (int)(at - CROWD), CROWD, use, at + 3);
    (void)snprintf(line, sizeof line, "-q -j 2 %s -o out.y4m scene.lua", options);
    return test_gray_scene(text, line, NULL);
}

static char *stream_of(const char *use, const char *options) {
    struct test_result result = run_crowd(use, options);
    if (result.status != 0)
        test_fail(__FILE__, __LINE__, "%s: %s", use, result.err);
    test_free_result(&result);
    return test_read_file(test_path("out.y4m"), NULL);
}

TEST(memory_of_frames_is_freed_and_what_older_objects_use_stays) {
    enum { SIZE = 15 * (6 + 3 * 32 * 24) };
    static const char *const uses[] = {
        "",
        "held = last",
        "if k % 7 == 0 then root:add_child(last:translate(k / 20, 0, 2)) end",
        "old:set_material(new)",
        "if k == 9 then old:set_texture(gr.texture('t.png')) end",
        "if k == 9 then old:moves_to(last) end",
        "old:spin('y', k)",
        "if k == 9 then old:set_material(gr.material(function(p) return {p.x, p.y, 0.5} end, {0, 0, 0}, 1)) end",
        "if k == 9 then held = gr.node('held', {last}) elseif held and k > 9 then group:add_child(held) end",
        "if k == 5 then gr.transform_order('separate') end old:translate(0.01, 0, 0)",
        "if k == 9 then held = coroutine.wrap(function() local a = last coroutine.yield() group:add_child(a) end) "
        "held() "
        "end",
    };
    struct test_result result =
        test_gray_scene("gr.render{node = gr.node('n'), file = 't.png', width = 4, height = 4, eye = {0, 0, 1}, "
                        "view = {0, 0, -1}, lights = {}}",
                        "-q -o t.png scene.lua", NULL);
    test_free_result(&result);
    for (size_t i = 0; i < sizeof uses / sizeof *uses; i++) {
        char *freed = stream_of(uses[i], "-D KEEP=false"), *kept = stream_of(uses[i], "-D KEEP=true");
        if (!freed || !kept || memcmp(freed, kept, SIZE) != 0)
            test_fail(__FILE__, __LINE__, "%s: other pictures", uses[i]);
        free(freed);
        free(kept);
    }
    free(stream_of("", "-D KEEP=false --script-memory 16M"));
    result = run_crowd("", "-D KEEP=true --script-memory 16M");
    CHECK(result.status != 0 && strstr(result.err, "--script-memory") != NULL);
    test_free_result(&result);
}
