/* A frame that follows an equal one is copied: what counts as a change between two pictures, and the files of the
 * copies. */
#define _GNU_SOURCE
#include "image/png_write.h"
#include "script/table_internal.h"
#include "tests/unit/script_host.h"
#include "world/world.h"
#include "world/world_cache.h"

#include <math.h>

/* --- what counts as a change --- */

struct shown {
    char file[96];
    bool changed; /* since the picture before */
};
enum { SHOWN_MAX = 4096 };
static struct shown shown[SHOWN_MAX];
static int shown_count;
static struct digest last_shown;

static void see(struct listener *listener, const struct render_request *request) {
    struct digest digest = render_request_digest(request);
    listener->files[0] = '\0';
    CHECK(shown_count < SHOWN_MAX);
    (void)snprintf(shown[shown_count].file, sizeof shown->file, "%s", request->file);
    shown[shown_count++].changed = !digest_equal(digest, last_shown) || scene_has_changes(request->scene);
    last_shown = digest;
    scene_forget_changes(request->scene);
}

static void show_pictures(const char *text) {
    struct listener listener = {.seen = see};
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua"};
    struct error error;
    shown_count = 0;
    last_shown = (struct digest){0};
    if (!listen_to_text(&listener, text, &options, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
}

/* Two images, as a.png and b.png. */
static void image_row(void *context, uint32_t y, uint8_t *line) {
    for (int i = 0; i < 12; i++)
        line[i] = (uint8_t)(20 * i + 7 * (int)y + *(const int *)context);
}

static void write_images(void) {
    static const char *const names[] = {"a.png", "b.png"};
    for (int k = 0; k < 2; k++) {
        struct error error;
        struct png_source source = {.width = 4, .height = 3, .bytes = image_row, .context = &k};
        CHECK(png_write_from(FILE_AT(test_path(names[k])), &source, NULL, &error));
    }
}

/* Picture 2k shows the same as picture 2k - 1, and after that a method is called. */
static const char methods[] =
    "local arm, joint, goal = gr.node('arm'), gr.joint('joint', {-90, 10, 90}, {-90, 0, 90}), gr.node('goal')\n"
    "local stone = gr.material({0.5, 0.4, 0.3})\n"
    "local ball = gr.sphere{material = stone}\n"
    "local field = gr.height_field{heights = {{0, 1, 0}, {1, 0, 1}, {0, 1, 0}}}\n"
    "local mesh = gr.mesh(stone, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, "
    "{0, 3, 2}})\n"
    "local root = gr.node('root'):add_child(arm:add_child(ball)):add_child(joint):add_child(field):add_child(mesh)\n"
    "root:add_child(gr.csg_difference('cut', gr.cube{}, ball))\n"
    "local function show() gr.render{node = root, file = 'x.png', width = 4, height = 3, eye = {0, 0, 9}} end\n"
    "local steps = {\n"
    "  function() arm:translate(1, 0, 0) end, function() ball:rotate('x', 10) end,\n"
    "  function() ball:scale(2, 1, 1) end, function() joint:rotate_axis({1, 1, 0}, 20) end,\n"
    "  function() joint:rotate_quat(1, 0.5, 0, 0) end, function() arm:pose{translate = {1, 2, 3}} end,\n"
    "  function() ball:velocity(1, 2, 3) end, function() ball:spin('y', 30) end, function() ball:spin('y', 31) end,\n"
    "  function() arm:moves_to(goal) end, function() goal:translate(0, 1, 0) end, function() goal:rotate('z', 5) end,\n"
    "  function() ball:set_material(gr.material({0.1, 0.4, 0.3})) end,\n"
    "  function() ball:set_texture('a.png') end, function() ball:set_bump('a.png', 0.1) end,\n"
    "  function() mesh:displace{level = 1, f = function(p) return 0.1 * p.x end} end,\n"
    "  function() field:displace{level = 1, f = function(p) return 0.1 * p.x end} end,\n"
    "  function() field:displace{level = 1, f = function(p) return 0.2 * p.x end} end,\n"
    "  function() arm:add_child(gr.cube{}) end, function() arm:add_child(ball) end, function() joint:scale(0, 1, 1) "
    "end,\n"
    "  function() ball:reset() end, function() arm:reset() end}\n"
    "show() show()\n"
    "for _, step in ipairs(steps) do step() show() show() end\n";

TEST(every_method_of_nodes_is_a_change_of_their_scene) {
    static const char *const reading[] = {"bounds", "export", "faces", "render"};
    write_images();
    show_pictures(methods);
    CHECK(shown_count > 40);
    for (int i = 0; i < shown_count; i++)
        if (shown[i].changed != (i % 2 == 0))
            test_fail(__FILE__, __LINE__, "picture %d: %s", i, i % 2 == 0 ? "no change" : "a change");
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        char call[64];
        bool reads = false;
        for (size_t k = 0; k < sizeof reading / sizeof *reading; k++)
            reads = reads || strcmp(function->name, reading[k]) == 0;
        (void)snprintf(call, sizeof call, ":%s", function->name);
        if (function->owner == OWNER_NODE && !reads && !strstr(methods, call))
            test_fail(__FILE__, __LINE__, "node:%s is in no step of this test", function->name);
    }
}

/* The world that keeps its tables from picture to picture, beside a new one. */
static struct world_cache cache_of_methods;
static int wrong_worlds;

static uint64_t hash_of_world(const struct world *world) {
    uint64_t hash = world->primitive_count;
    for (uint32_t i = 0; i < world->primitive_count; i++) {
        struct transform pose = world_placement(world, i, 0.5);
        const struct prototype *prototype = primitive_prototype(world, i);
        const struct surface_material *material = &world->surfaces.materials[prototype->material];
        const struct mesh *mesh = geometry_mesh(&prototype->geometry);
        hash = hash_bytes(&pose, sizeof pose, hash);
        hash = hash_bytes(&world->boxes[i], sizeof world->boxes[i], hash);
        hash = hash_bytes(&mesh, sizeof mesh, hash);
        hash = hash_bytes(&material->phong.kd, sizeof material->phong.kd, hash);
        hash += material->needs_footprint + 2 * (uint64_t)material->needs_tangents;
    }
    return hash;
}

static void see_world(struct listener *listener, const struct render_request *request) {
    struct world_input input = {.scene = request->scene,
                                .root = request->root,
                                .lights = request->lights,
                                .light_count = request->light_count,
                                .sky = &request->sky,
                                .shutter = {0, 1},
                                .cache = &cache_of_methods,
                                .keeps_tables = true};
    struct arena arena = {0};
    struct world kept, made;
    struct error error;
    char warning[256];
    struct pool *pool = pool_create(1, warning);
    listener->files[0] = '\0';
    CHECK(pool != NULL);
    bool is_kept = world_build(&kept, &input, &arena, pool, &error);
    input.cache = NULL;
    bool is_made = world_build(&made, &input, &arena, pool, &error);
    if (!is_made)
        test_fail(__FILE__, __LINE__, "%s", error.text);
    wrong_worlds += is_kept != is_made || (is_made && hash_of_world(&kept) != hash_of_world(&made));
    if (is_kept)
        world_keep(&kept, &cache_of_methods);
    if (is_made)
        world_destroy(&made);
    arena_destroy(&arena);
    pool_destroy(pool);
}

/* Each step above in a scene of its own, between two pictures; the ball is not an operand, which must not move. */
TEST(after_every_method_of_nodes_the_world_has_the_tables_of_a_new_one) {
    struct listener listener = {.seen = see_world};
    const struct script_options options = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua"};
    struct error error;
    const char *solid = strstr(methods, "root:add_child(gr.csg"), *show = strstr(methods, "local function show()"),
               *end = strstr(methods, "show() show()\n");
    char *text = NULL;
    CHECK(solid && show && end);
    if (asprintf(&text,
                 "local function scene()\n%.*sroot:add_child(gr.csg_difference('cut', gr.cube{}, gr.sphere{}))\n%.*s"
                 "ball:rotate('y', 5) arm:translate(0, 1, 0)\nreturn show, steps\nend\n"
                 "for k = 1, #select(2, scene()) do\nlocal show, steps = scene()\n"
                 "show() show() steps[k]() show() show() end",
                 (int)(solid - methods), methods, (int)(end - show), show) < 0)
        exit(1);
    wrong_worlds = 0;
    cache_of_methods = (struct world_cache){.tables = NULL};
    write_images();
    if (!listen_to_text(&listener, text, &options, &error))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    CHECK_EQ_INT(wrong_worlds, 0);
    CHECK(listener.renders > 80);
    CHECK(cache_of_methods.reused > 30); /* equal pictures, and those after transforms */
    world_cache_destroy(&cache_of_methods);
    free(text);
}

/* Two values of a kind of parameter, as Lua text; NULL: this test has none. */
static const char *value_of(const struct script_parameter *parameter, int which) {
    static char text[2][64];
    const char *end = parameter->choices ? strchr(parameter->choices, ' ') : NULL;
    double low = parameter->low, high = parameter->high, number;
    bool any = low == 0 && high == 0, bounded = isfinite(low) && isfinite(high);
    switch (parameter->kind) {
    case KIND_NUMBER:
    case KIND_WHOLE:
        number = any ? 1 + which : bounded && high - low < 4 ? low + (high - low) * (1 + which) / 4 : low + 1 + which;
        (void)snprintf(text[which], sizeof text[which], "%.17g", number);
        return text[which];
    case KIND_BOOLEAN:
        return which ? "true" : "false";
    case KIND_TEXT:
    case KIND_FILE:
        return NULL;
    case KIND_OUTPUT:
        return which ? "'y.png'" : "'x.png'";
    case KIND_CHOICE:
        if (!end)
            return NULL;
        (void)snprintf(text[which], sizeof text[which], "'%.*s'",
                       which ? (int)strcspn(end + 1, " ") : (int)(end - parameter->choices),
                       which ? end + 1 : parameter->choices);
        return text[which];
    case KIND_AXIS:
        return which ? "'y'" : "'x'";
    case KIND_POINT:
    case KIND_DIRECTION:
    case KIND_TRIPLE:
    case KIND_SIZE:
        return which ? "{1, 2, 5}" : "{2, 1, 3}";
    case KIND_COLOUR:
        return which ? "{0.2, 0.3, 0.4}" : "{0.4, 0.3, 0.2}";
    case KIND_INTERVAL:
        return which ? "{0, 0.5}" : "{0, 0.25}";
    case KIND_QUATERNION:
        return which ? "{1, 0, 0, 0}" : "{1, 1, 0, 0}";
    case KIND_PAIR:
        return which ? "{1, 2}" : "{2, 1}";
    case KIND_NODE:
        return which ? "ball" : "root";
    case KIND_MATERIAL:
        return which ? "gr.material({1, 0, 0})" : "gr.material({0, 1, 0})";
    case KIND_IMAGE:
        return which ? "'a.png'" : "'b.png'";
    case KIND_BACKGROUND:
        return which ? "{0.1, 0.2, 0.3}" : "function(d) return {d.x * d.x, 0, 0} end";
    case KIND_FOG:
        return which ? "gr.uniform_fog(0.1)" : "gr.uniform_fog(0.2)";
    case KIND_MEDIUM:
        return which ? "gr.medium{g = 0.1}" : "gr.medium{g = 0.2}";
    case KIND_CAUSTICS:
        return which ? "100" : "{200, 0.5}";
    case KIND_NODES:
        return which ? "{ball}" : "{root}";
    case KIND_LIGHTS:
        return which ? "{gr.light({1, 2, 3}, {1, 1, 1}, {1, 0, 0})}" : "{gr.light({1, 2, 3}, {1, 0, 1}, {1, 0, 0})}";
    case KIND_POINTS:
        return which ? "{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}" : "{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}}";
    case KIND_PAIRS:
        return which ? "{{0, 0}, {1, 1}}" : "{{0, 0}, {1, 2}}";
    case KIND_STOPS:
        return which ? "{{0, 0, 0, 0}, {1, 1, 1, 1}}" : "{{0, 0, 0, 0}, {1, 1, 0, 1}}";
    case KIND_NUMBERS:
        return which ? "{1, 2, 3}" : "{1, 2, 4}";
    case KIND_FUNCTION:
        return which ? "function(p) return 0.5 + 0.25 * p.x * p.x end"
                     : "function(p) return 0.5 + 0.25 * p.y * p.y end";
    case KIND_MATERIALS:
    case KIND_FACES:
    case KIND_ROWS:
    case KIND_CURVES:
    case KIND_CALLBACK:
    case KIND_COUNT:
        break;
    }
    return NULL;
}

/* Where the result of a function is seen: the fields of gr.render that use `it`. */
static const char *use_of(const struct script_function *function) {
    switch (function->result) {
    case RESULT_LIGHT:
        return "show.lights = {it}";
    case RESULT_FOG:
        return "show.fog = it";
    case RESULT_MEDIUM:
        return "show.medium = it";
    case RESULT_SKY:
        return "show.background = it";
    case RESULT_NOTHING:
    case RESULT_SELF:
    case RESULT_NODE:
    case RESULT_MATERIAL: /* a node gets it with a method */
    case RESULT_TEXTURE:
    case RESULT_BOUNDS:
    case RESULT_FACES:
    case RESULT_GLYPHS:
    case RESULT_FRAMES:
        break;
    }
    return NULL;
}

/* One picture, if the call is right: "function parameter which". */
static void write_call(FILE *out, const struct script_function *function, int changed, int which) {
    bool renders = strcmp(function->name, "render") == 0;
    fprintf(out, "try('%s %s %d', function(show) local it = ", function->name, function->parameters[changed].name,
            which);
    fprintf(out, renders ? "{" : "gr.%s{", function->name);
    for (int k = 0; k < function->parameter_count; k++) {
        const struct script_parameter *parameter = &function->parameters[k];
        const char *value =
            k == changed || !(parameter->flags & OPTIONAL) ? value_of(parameter, k == changed && which) : NULL;
        if (value && !(renders && (parameter->kind == KIND_OUTPUT || parameter->kind == KIND_NODE)))
            fprintf(out, "%s = %s, ", parameter->name, value);
    }
    fprintf(out, "} %s end)\n", renders ? "for k, v in pairs(it) do show[k] = v end" : use_of(function));
}

/* Each call is there with one value of a parameter, twice, then with another value. */
TEST(every_argument_of_pictures_lights_fogs_and_skies_is_a_change) {
    static const char begin[] =
        "local root, ball = gr.node('root'), gr.sphere{}\n"
        "root:add_child(ball)\n"
        "local function try(name, make)\n"
        "  local show = {node = root, file = name .. '.png', width = 4, height = 3, eye = {0, 0, 9}}\n"
        "  if pcall(make, show) then pcall(gr.render, show) end\n"
        "end\n";
    /* They need a sky, columns, absorption, a plain file. */
    static const char *const with_others[] = {"render mirror", "render depth", "medium temperature", "medium type"};
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    int differ = 0, same = 0;
    write_images();
    (void)fputs(begin, out);
    for (int i = 0; i < function_count(); i++) {
        const struct script_function *function = function_at(i);
        if (function->owner != OWNER_GR || (!use_of(function) && strcmp(function->name, "render") != 0))
            continue;
        for (int k = 0; k < function->parameter_count; k++)
            if (value_of(&function->parameters[k], 0) && function->parameters[k].kind != KIND_OUTPUT &&
                (function->parameters[k].kind != KIND_NODE || use_of(function)))
                for (int call = 0; call < 3; call++)
                    write_call(out, function, k, call / 2);
    }
    (void)fclose(out);
    show_pictures(text);
    for (int i = 1; i < shown_count; i++) {
        size_t length = strlen(shown[i].file) - 5;
        if (strncmp(shown[i].file, shown[i - 1].file, length) != 0)
            continue;
        bool equal = strcmp(shown[i].file, shown[i - 1].file) == 0, matters = true;
        for (size_t k = 0; k < sizeof with_others / sizeof *with_others; k++)
            matters = matters && strncmp(shown[i].file, with_others[k], strlen(with_others[k])) != 0;
        if (!equal && !shown[i].changed && matters)
            test_fail(__FILE__, __LINE__, "%s shows the same as %s", shown[i].file, shown[i - 1].file);
        differ += !equal;
        same += equal && !shown[i].changed;
    }
    CHECK(differ > 150);
    CHECK(same > 100);
    free(text);
}

/* --- the program --- */

/* A ball at 0, 1, 2, 2, 2, 1, 0, 0: the frames 4, 5 and 8 are copies, unless `forced` is set. */
static const char held[] =
    "local root, ball = gr.node('r'), gr.sphere{}\n"
    "local stone = gr.material({0.9, 0.4, 0.2}, {0.5, 0.5, 0.5}, 20)\n"
    "root:add_child(ball:set_material(stone))\n"
    "gr.frames{count = 8, loop = true, draw = function(t, k)\n"
    "  ball:reset():translate(({0, 1, 2, 2, 2, 1, 0, 0})[k], 0, 0)\n"
    "  if forced then ball:set_material(stone) end\n"
    "  return {node = root, width = 60, height = 44, eye = {0, 0, 6}, view = {0, 0, -1}, fov = 40,\n"
    "          background = {0, 0, 0.5}, lights = {gr.light({4, 5, 6}, {1, 1, 1}, {1, 0, 0})}}\n"
    "end}\n";

/* A shell's line, in the test's folder, with scene.lua there; it prints `says`, among others. */
static void gives(const char *scene, const char *line, const char *says) {
    test_write_text(test_path("scene.lua"), scene);
    test_shell(line, 0, says);
}

TEST(frames_since_which_nothing_changed_are_copied_with_the_same_bytes) {
    gives(held, "$gray scene.lua --verbose -o 'a.##.png' 2>&1 | grep -o 'frame . is a copy of frame .' | tr '\\n' ','",
          "frame 4 is a copy of frame 3,frame 5 is a copy of frame 4,frame 8 is a copy of frame 7,");
    gives(held,
          "$gray -q scene.lua -D forced=true -o 'b.##.png' && for k in $(seq 8); do cmp a.0$k.png b.0$k.png || exit 1; "
          "done; cmp a.01.png a.02.png || $gray scene.lua --verbose -D forced=true -o 'b.##.png' 2>&1 | grep -c 'is a "
          "copy' || true",
          "a.01.png a.02.png differ");
    /* What a picture consists of: layers, further files, other formats. */
    gives(held,
          "for o in \"-o x.gif --contact-sheet --keep-frames\" \"-o x.apng --palette frame\" '-o x.##.pfm --aov depth,"
          "normal' '-o x.##.png --aov node -write-aa-targets t- --deep' '-o x.##.hdr --integrator path --spp 4' "
          "'-o x.##.png --frames 3-8/2' '-o x.y4m --frames 2-7' '-o x.##.png --integrator path --spp 2 --denoise'; do "
          "rm -rf one two; for d in one two; do mkdir $d; (cd $d && $gray -q ../scene.lua $o $(test $d = two && echo "
          "-D forced=true)) || exit 1; done; diff -r one two || exit 1; ls one; done",
          "x.sheet.png");
}

TEST(copies_of_frames_are_in_streams_shards_and_resumed_runs) {
    gives(held,
          "$gray -q scene.lua -o - >a.y4m && $gray -q scene.lua -D forced=true -o - >b.y4m && cmp a.y4m b.y4m; "
          "$gray --verbose scene.lua -o - 2>&1 >c.y4m | grep -c 'is a copy of'",
          "3");
    gives(held,
          "$gray -q scene.lua -D forced=true -o one.apng --size 150x110; for i in 1 2; do $gray --verbose scene.lua "
          "-o b.apng --size 150x110 --shard $i/2 2>&1 | grep -c 'is a copy of'; done; $gray merge -q --loop -o b.apng "
          "b.apng.frames/*.part && cmp b.apng one.apng",
          "3\n3\n");
    gives(held,
          "$gray -q scene.lua -D forced=true -o one.gif; for i in 1 2; do $gray --verbose scene.lua -o c.gif "
          "--shard-pictures $i/2 2>&1 | grep -o 'frame . is a copy.*'; done; $gray merge -q --loop -o c.gif "
          "c.gif.frames/*.png && cmp c.gif one.gif",
          "frame 5 is a copy of frame 3\n");
    gives(held,
          "! $gray -q scene.lua -o d.gif --picture-bytes 6k && ls d.gif.frames && $gray --verbose scene.lua -o d.gif "
          "--resume 2>&1 | grep -o 'frame . is a copy of frame .' | tr '\\n' ','; cmp d.gif one.gif",
          "frame 8 is a copy of frame 7,");
}

TEST(ranks_copy_frames_that_show_the_same) {
    test_need_mpi();
    gives(held,
          "$gray -q scene.lua -D forced=true -o one.gif && OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "
          "OMPI_MCA_btl_vader_backing_directory=${TMPDIR:-/tmp} mpirun --oversubscribe -n 3 $gray --mpi --verbose -j 1 "
          "scene.lua -o x.gif 2>&1 | grep -c 'is a copy of'; cmp x.gif one.gif",
          "3");
}

TEST(three_hundred_frames_of_a_still_scene_are_rendered_once) {
    gives("local root = gr.node('r'):add_child(gr.sphere{})\n"
          "gr.frames{count = 300, draw = function() return {node = root, width = 20, height = 10, eye = {0, 0, 6}} "
          "end}\n",
          "$gray --verbose --stats scene.lua -o x.gif >said.txt 2>&1; grep -c 'is a copy of frame' said.txt; grep -c "
          "'camera rays' said.txt",
          "299\n1\n");
}

/* Differences that are small, or that come from elsewhere than the nodes. */
TEST(frames_that_differ_are_never_copies) {
    static const char *const differences[] = {
        "show.seed = k",
        "ball:translate(math.random() * 1e-9, 0, 0)",
        "show.background = function(d) return d.y * gr.time end",
        "show.background = function(d) return gr.loop(k, d.y, function(i, y) return y / 2 end) end",
        "show.lights[1] = gr.light({4, 5, 6}, {1, 1, k / 100}, {1, 0, 0})",
        "ball:set_texture(k % 2 == 0 and 'a.png' or 'b.png') show.seed = k // 2",
        "show.shutter = {0, k / 10} ball:velocity(0, 1, 0)",
        "show.ambient = {k / 100, 0, 0}",
        "show.tone = function(x) return x * k / 10 end",
        "ball:set_material(gr.material({0.9, 0.4, k / 10}))",
        "show.node = gr.node('other'):add_child(ball)",
        "ball:reset():translate(k % 2 * 1e-9, 0, 0)",
        "gr.render{node = root, file = 'y.####.png', width = 20, height = 10, eye = {0, 1, k}}",
        "show.fov = 40 + k / 10"};
    char text[2048];
    write_images();
    for (size_t i = 0; i < sizeof differences / sizeof *differences; i++) {
        (void)snprintf(text, sizeof text,
                       "local root, ball = gr.node('r'), gr.sphere(gr.material({0.9, 0.4, 0.2}))\n"
                       "root:add_child(ball)\n"
                       "gr.frames{count = 6, draw = function(t, k)\n"
                       "  local show = {node = root, width = 20, height = 10, eye = {0, 0, 6}, lights = {}}\n"
                       "  %s\n  return show\nend}\n",
                       differences[i]);
        gives(text, "$gray --verbose scene.lua >said.txt 2>&1 && ! grep 'is a copy' said.txt && echo right", "right");
    }
}

/* Each frame makes 2000 nodes and frees them, so that addresses are used again. */
TEST(frames_of_memory_that_is_used_again_have_the_bytes_of_rendered_ones) {
    gives("local root, old = gr.node('r'), gr.sphere{}\n"
          "root:add_child(old)\n"
          "gr.frames{count = 12, draw = function(t, k)\n"
          "  local sky = gr.sky_gradient{stops = {{-1, 0, 0, k % 3 / 3}, {1, 0, 1, 1}}}\n"
          "  for i = 1, 2000 do gr.sphere{} end\n"
          "  return {node = root, width = 20, height = 10, eye = {0, 0, 6}, background = sky,\n"
          "          fog = gr.fog_profile{profile = {{0, 0}, {1, k % 2}}}}\n"
          "end}\n",
          "$gray scene.lua -q -o 'a.##.png' && for k in $(seq -w 12); do $gray scene.lua -q --frames $k-$k -o "
          "'b.##.png' && cmp a.$k.png b.$k.png || exit 1; done; ! cmp a.01.png a.02.png",
          "differ");
}
