/* Materials per face, culling, and methods of meshes in scripts. */
#include "tests/unit/model_makers.h"

#include "tests/stage.h"
#include "tests/unit/script_host.h"

/* A cube whose six faces have slots 0 .. 5: -z, +z, -y, +y, -x, +x. */
static struct mesh *cube(struct stage *s) {
    static const double vertices[8][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0},
                                          {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}};
    static const uint32_t corners[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    static const uint32_t starts[7] = {0, 4, 8, 12, 16, 20, 24}, slots[6] = {0, 1, 2, 3, 4, 5};
    struct mesh_input input = {.name = "cube",
                               .vertex_count = 8,
                               .face_count = 6,
                               .vertices = vertices,
                               .face_start = starts,
                               .vertex_index = corners,
                               .face_material = slots};
    return assets_mesh(&s->assets, &input, &s->error);
}

static struct node *cube_node(struct stage *s, const struct material *const *slots) {
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "cube", &s->error);
    node->shape = (struct shape){.kind = SHAPE_MESH, .mesh = cube(s)};
    node->slots = slots;
    node->slot_count = 6;
    return node;
}

/* The material at the hit of a ray along an axis, or NULL. */
static const struct material *seen(const struct stage *s, struct vec3 from, struct vec3 along, double *t) {
    struct world_scratch scratch;
    struct hit hit;
    struct ray ray = test_ray(from, along);
    CHECK(world_scratch_init(&scratch, &s->world));
    bool found = world_nearest(&s->world, &ray, &scratch, &hit);
    struct ray shadow = ray;
    CHECK_EQ_INT(world_any(&s->world, &shadow, &scratch), found);
    world_scratch_destroy(&scratch);
    if (t)
        *t = found ? hit.t : INFINITY;
    return found ? s->world.authored.materials[hit.material] : NULL;
}

static void make_slots(struct stage *s, const struct material *slots[6]) {
    for (int i = 0; i < 6; i++)
        slots[i] = stage_phong(s, colour_all(i), colour_all(0), 1);
}

static const struct vec3 from[6] = {{0.4, 0.6, -5}, {0.4, 0.6, 5},  {0.4, -5, 0.6},
                                    {0.4, 5, 0.6},  {-5, 0.4, 0.6}, {5, 0.4, 0.6}};
static const struct vec3 along[6] = {{0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0, -1, 0}, {1, 0, 0}, {-1, 0, 0}};

TEST(mesh_faces_have_the_material_of_their_slot) {
    struct stage s;
    stage_begin(&s, 1);
    const struct material *slots[6], *others[6];
    make_slots(&s, slots);
    make_slots(&s, others);
    slots[4] = NULL; /* plain gray, with a warning */
    struct node *far_away = cube_node(&s, others), *node = cube_node(&s, slots), *copy = cube_node(&s, slots);
    stage_move(&s, far_away, 50, 50, 50);
    stage_move(&s, copy, 0, 0, 40);
    CHECK(node_add_child(&s.scene, s.root, far_away, &s.error));
    CHECK(node_add_child(&s.scene, s.root, node, &s.error));
    CHECK(node_add_child(&s.scene, s.root, copy, &s.error));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    CHECK_EQ_INT(s.world.material_count, 12); /* the copy shares its row */
    CHECK(s.warnings > 0);
    for (int i = 0; i < 6; i++) {
        const struct material *m = seen(&s, from[i], along[i], NULL);
        CHECK(i == 4 ? m->phong.kd.r == 0.5 : m == slots[i]);
    }
    /* One material for the whole mesh overrides the slots. */
    world_destroy(&s.world);
    node->material = slots[2];
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    for (int i = 0; i < 6; i++)
        CHECK(seen(&s, from[i], along[i], NULL) == slots[2]);
    stage_end(&s);
}

TEST(mesh_faces_keep_their_materials_as_operands_of_csg) {
    struct stage s;
    stage_begin(&s, 1);
    const struct material *slots[6];
    make_slots(&s, slots);
    const struct material *red = stage_phong(&s, colour_make(9, 0, 0), colour_all(0), 1);
    struct node *ball = stage_sphere(&s, scene_node(&s.scene, NODE_GROUP, "aside", &s.error), red);
    stage_scale(&s, ball, 0.3, 0.3, 0.3);
    struct node *csg =
        scene_combine(&s.scene, "csg", NODE_DIFFERENCE, (struct node *[]){cube_node(&s, slots), ball}, 2, &s.error);
    CHECK(node_add_child(&s.scene, s.root, csg, &s.error));
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    for (int i = 0; i < 6; i++)
        CHECK(seen(&s, from[i], along[i], NULL) == slots[i]);
    CHECK(seen(&s, vec3_make(0.1, 0.1, -5), vec3_make(0, 0, 1), NULL) == red);
    stage_end(&s);
}

TEST(mesh_faces_that_are_culled_are_passed_by_every_ray) {
    struct stage s;
    const struct material *slots[6];
    double t;
    for (int cull = CULL_NONE; cull <= CULL_FRONT; cull++) {
        stage_begin(&s, 1);
        make_slots(&s, slots);
        struct node *node = cube_node(&s, slots);
        node->cull = (enum node_cull)cull;
        stage_scale(&s, node, -1, 1, 1); /* a mirrored mesh keeps its outside */
        stage_scale(&s, node, -1, 1, 1);
        CHECK(node_add_child(&s.scene, s.root, node, &s.error));
        CHECK(stage_build(&s, s.root, ACCEL_AUTO));
        const struct material *m = seen(&s, from[0], along[0], &t);
        CHECK(m == slots[cull == CULL_FRONT ? 1 : 0]);
        CHECK_NEAR(t, cull == CULL_FRONT ? 6 : 5, 1e-12);
        struct vec3 inside = {0.4, 0.6, 0.5};
        CHECK(seen(&s, inside, along[0], &t) == (cull == CULL_BACK ? NULL : slots[1]));
        stage_end(&s);
    }
}

TEST(script_asks_meshes_for_their_bounds_and_faces) {
    static const char text[] =
        "local m = gr.mesh{verts={{0,0,0},{1,0,0},{1,1,0},{0,1,0},{9,9,9}}, faces={{0,1,2,3},{0,2,1}}, name='m'}\n"
        "local v, f = m:faces()\n"
        "assert(#v == 5 and #f == 2 and #f[1] == 4 and f[1][4] == 3 and f[2][2] == 2 and v[3][2] == 1)\n"
        "local again = gr.mesh(gr.material({1,1,1},{0,0,0},1), m:faces())\n"
        "m:rotate('z', 90) m:translate(0, 0, 7)\n"
        "local lo, hi = m:bounds()\n"
        "assert(lo[1] == -1 and lo[2] == 0 and lo[3] == 7 and hi[1] == 0 and hi[2] == 1 and hi[3] == 7)\n"
        "local g = gr.node('g') g:add_child(m) g:scale(2, 2, 2)\n"
        "local ball = gr.sphere('ball') g:add_child(ball) ball:translate(0, 0, 9)\n"
        "lo, hi = g:bounds()\n"
        "assert(lo[3] == 14 and math.abs(hi[3] - 20) < 1e-12 and math.abs(lo[1] + 2) < 1e-12)\n"
        "local cut = gr.csg_intersection('c', gr.cube('a'), gr.nh_box('b', {0.5,0.5,0.5}, 5))\n"
        "lo, hi = cut:bounds()\n"
        "assert(lo[1] == 0.5 and hi[3] == 1)\n"
        "local ok, what = pcall(g.faces, g)\n"
        "assert(not ok and what:find('is not a mesh'), what)\n"
        "ok, what = pcall(function() gr.node('empty'):bounds() end)\n"
        "assert(not ok and what:find('no shape is below this node'), what)\n"
        "ok, what = pcall(g.add_child, g, g)\n"
        "assert(not ok and what:find('cannot be its own child'), what)\n";
    struct listener listener = {0};
    struct error error = {0};
    CHECK(listen_to_text(&listener, text, NULL, &error));
    CHECK_TEXT(error.text, "");
}

TEST(script_reads_models_of_every_format_with_its_options) {
    static const char text[] = "local two = gr.geometry('two', gr.mesh('one', 'm.obj'))\n"
                               "gr.render(two, 'x.png', 1, 1, {0,0,5}, {0,0,-1}, {0,1,0}, 50, {0,0,0}, {})\n"
                               "local names = {'a.obj', 'a.ply', 'a.stl', 'a.PLY'}\n"
                               "for _, name in ipairs(names) do\n"
                               "    local m = gr.mesh{file=name, smooth=30, flip=true, cull='back', weld=true}\n"
                               "    local v, f = m:faces()\n"
                               "    assert(#f == 8 and #v == 6, name .. ' ' .. #f .. ' ' .. #v)\n"
                               "    assert(gr.mesh('n', name))\n"
                               "end\n";
    static const enum ply_kind kinds[] = {PLY_LITTLE, PLY_BIG};
    struct maker m = {0};
    maker_sphere(&m, 1);
    maker_round(&m);
    for (int i = 0; i < 4; i++) {
        struct bytes b = {0};
        char path[400];
        static const char *const names[] = {"a.obj", "a.ply", "a.stl", "a.PLY"};
        if (i == 0)
            write_obj(&b, &m);
        else if (i == 2)
            write_stl(&b, &m, true, "x");
        else
            write_ply(&b, &m, kinds[i == 3]);
        (void)snprintf(path, sizeof path, "%s/%s", test_folder(), names[i]);
        test_write_file(path, b.data, b.size);
        bytes_free(&b);
    }
    maker_free(&m);
    char path[400];
    (void)snprintf(path, sizeof path, "%s/m.mtl", test_folder());
    test_write_text(path, "newmtl red\nKd 1 0 0\n");
    (void)snprintf(path, sizeof path, "%s/m.obj", test_folder());
    test_write_text(path, "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl red\nf 3 2 1\n");
    struct listener listener = {0};
    struct error error = {0};
    CHECK(listen_to_text(&listener, text, NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_TEXT(listener.said, "");
    CHECK_EQ_INT(listener.renders, 1);
}

/* The red of the slots of the root, then of the slot of each face. */
static void print_slots(struct listener *listener, const struct render_request *request) {
    const struct node *node = request->root;
    char *out = listener->said;
    size_t size = sizeof listener->said;
    for (uint32_t i = 0; i < node->slot_count; i++)
        (void)snprintf(out + strlen(out), size - strlen(out), "%g ", node->slots[i] ? node->slots[i]->phong.kd.r : -1);
    for (uint32_t f = 0; f < mesh_triangle_count(node->shape.mesh); f++) {
        struct crossing crossing = {.part = f, .u = 0.25, .v = 0.25};
        struct ray ray = test_ray(vec3_make(0, 0, 1), vec3_make(0, 0, -1));
        struct surface surface;
        mesh_describe(node->shape.mesh, &ray, &crossing, &surface);
        (void)snprintf(out + strlen(out), size - strlen(out), "%u", surface.material_slot);
    }
    (void)snprintf(out + strlen(out), size - strlen(out), "%s\n", node->material ? " covered" : "");
}

TEST(script_gives_parts_of_files_and_faces_of_tables_their_materials) {
    static const char text[] =
        "local function m(r) return gr.material({r, 0, 0}, {0, 0, 0}, 1) end\n"
        "local function show(node) gr.render{node = node, file='a.png', width=1, height=1, eye={0,0,5}, lights={}} "
        "end\n"
        "show(gr.mesh{file='parts.obj', materials={['blue paint'] = m(7)}})\n"
        "show(gr.mesh{file='parts.obj', materials={red = m(8)}, material = m(9)})\n"
        "show(gr.mesh{file='groups.obj', materials={one = m(4), two = m(5)}})\n"
        "local verts, faces = {{0,0,0},{1,0,0},{1,1,0},{0,1,0}}, {{0,1,2},{0,2,3},{0,3,1}}\n"
        "show(gr.mesh{verts=verts, faces=faces, materials={m(1), m(2)}, face_materials={2,1,2}})\n"
        "local ok, what = pcall(gr.mesh, {file='parts.obj', materials={['blue pain'] = m(1)}})\n"
        "assert(not ok and what:find(\"parts.obj has no part 'blue pain'; did you mean 'blue paint'?\", 1, true), "
        "what)\n"
        "ok, what = pcall(gr.mesh, {file='parts.obj', materials={m(1)}})\n"
        "assert(not ok and what:find('materials of a file have names', 1, true), what)\n"
        "ok, what = pcall(gr.mesh, {verts=verts, faces=faces, materials={m(1)}, face_materials={1, 1}})\n"
        "assert(not ok and what:find('face_materials has 2 entries, but faces has 3', 1, true), what)\n"
        "ok, what = pcall(gr.mesh, {verts=verts, faces=faces, materials={m(1)}, face_materials={1, 2, 1}})\n"
        "assert(not ok and what:find('face_materials[2] is 2, but materials has 1 entries', 1, true), what)\n"
        "ok, what = pcall(gr.mesh, {verts=verts, faces=faces, materials={m(1)}})\n"
        "assert(not ok and what:find('face_materials is missing', 1, true), what)\n";
    char path[400];
    (void)snprintf(path, sizeof path, "%s/parts.mtl", test_folder());
    test_write_text(path, "newmtl red\nKd 1 0 0\nnewmtl blue paint\nKd 0 0 1\n");
    (void)snprintf(path, sizeof path, "%s/parts.obj", test_folder());
    test_write_text(path, "mtllib parts.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n"
                          "usemtl blue paint\nf 3 2 1\n");
    (void)snprintf(path, sizeof path, "%s/groups.obj", test_folder());
    test_write_text(path, "v 0 0 0\nv 1 0 0\nv 0 1 0\ng one\nf 1 2 3\ng two\nf 3 2 1\n");
    struct listener listener = {.seen = print_slots};
    struct error error = {0};
    CHECK(listen_to_text(&listener, text, NULL, &error));
    CHECK_TEXT(error.text, "");
    CHECK_TEXT(listener.said, "1 7 01\n8 9 01\n4 5 01\n1 2 101\n");
}

/* clip: the rendered node, made of `box`. */
static bool picture_of(const char *cull, const char *drawn, struct test_picture *out) {
    char text[1600];
    (void)snprintf(text, sizeof text,
                   "local function lit(r, g, b) return gr.material{kd={r, g, b}, lit=false, two_sided=true} end\n"
                   "local verts = {{0,0,0},{1,0,0},{0,1,0},{1,1,0},{0,0,1},{1,0,1},{0,1,1},{1,1,1}}\n"
                   "local faces = {{0,2,3,1},{4,5,7,6},{0,1,5,4},{2,6,7,3},{0,4,6,2},{1,3,7,5}}\n"
                   "local box = gr.mesh{verts=verts, faces=faces, cull='%s', face_materials={1,2,3,4,5,6},\n"
                   "    materials={lit(1,0,0), lit(0,1,0), lit(0,0,1), lit(1,1,0), lit(0,1,1), lit(1,0,1)}}\n"
                   "gr.render{node=%s, file='cull.png', width=40, height=40, eye={0.5,0.5,4}, target={0.5,0.5,0},\n"
                   "    fov=28, background={1, 1, 1}}\n",
                   cull, drawn);
    struct test_result result = test_gray_scene(text, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    *out = test_read_picture(test_path("cull.png"));
    return out->width == 40;
}

static bool is_colour(const struct test_picture *picture, uint32_t x, uint32_t y, int r, int g, int b) {
    const uint8_t *p = picture->rgb + 3 * ((size_t)y * picture->width + x);
    return p[0] == 255 * r && p[1] == 255 * g && p[2] == 255 * b;
}

/* A cube seen from the front: complete, it shows its front; without front faces, the inside of the other five sides,
 * each in its colour; if only back faces are culled, the inside is never seen from outside. */
TEST(pictures_of_a_culled_cube_show_its_front_or_its_inside) {
    struct test_picture whole, back, front;
    if (!picture_of("none", "box", &whole) || !picture_of("back", "box", &back) || !picture_of("front", "box", &front))
        return;
    for (uint32_t y = 0; y < 40; y++)
        for (uint32_t x = 0; x < 40; x++)
            CHECK(memcmp(whole.rgb + 3 * (y * 40 + x), back.rgb + 3 * (y * 40 + x), 3) == 0);
    CHECK(is_colour(&whole, 20, 20, 0, 1, 0));
    CHECK(is_colour(&whole, 0, 0, 1, 1, 1));
    CHECK(is_colour(&front, 20, 20, 1, 0, 0));
    uint32_t left = 0, right = 0, top = 0, bottom = 0;
    for (uint32_t i = 0; i < 40; i++) {
        left += is_colour(&front, i, 20, 0, 1, 1), right += is_colour(&front, i, 20, 1, 0, 1);
        top += is_colour(&front, 20, i, 1, 1, 0), bottom += is_colour(&front, 20, i, 0, 0, 1);
    }
    CHECK(left >= 2 && left == right && top >= 2 && top == bottom);
    CHECK(is_colour(&front, 0, 0, 1, 1, 1));
    free(whole.rgb), free(back.rgb), free(front.rgb);
}

/* A clip that removes nothing changes nothing; one that removes the near half shows the inside of the far half if its
 * back faces are not culled, else nothing. */
TEST(clips_heed_what_a_mesh_does_not_show) {
    static const char *const culls[] = {"none", "back", "front"};
    static const char clip_call[] = "gr.clipped_by(box, gr.sphere{centre={0.5,0.5,0.5}, radius=2})";
    static const char far_half[] = "gr.clipped_by(box, gr.box{min={-1,-1,-1}, max={2,2,0.5}})";
    for (int i = 0; i < 3; i++) {
        struct test_picture plain, clipped, cut;
        if (!picture_of(culls[i], "box", &plain) || !picture_of(culls[i], clip_call, &clipped) ||
            !picture_of(culls[i], far_half, &cut))
            return;
        CHECK(memcmp(plain.rgb, clipped.rgb, 3 * 40 * 40) == 0);
        if (i == 1)
            CHECK(is_colour(&cut, 20, 20, 1, 1, 1)); /* all remaining faces are seen from behind */
        else
            CHECK(is_colour(&cut, 20, 20, 1, 0, 0));
        free(plain.rgb), free(clipped.rgb), free(cut.rgb);
    }
}
