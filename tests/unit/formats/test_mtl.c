#include "mesh/mesh_internal.h"
#include "tests/unit/model_makers.h"

#include "base/path_policy.h"
#include "formats/model_node.h"
#include "material/surface_material.h"
#include "mesh/mesh_smooth.h"

/* Reads a model from the test's folder. */
static bool read_model(struct model *model, const char *name) {
    struct model_options options = {0};
    struct error error = {0};
    bool ok = model_read(model, in_folder(name), &options, &error);
    CHECK_TEXT(error.text, "");
    return ok;
}

static const struct model_material *material(const struct model *model, const char *name) {
    for (size_t i = 0; i < model->materials.count; i++)
        if (strcmp(model_materials(model)[i].name, name) == 0)
            return &model_materials(model)[i];
    test_fail(__FILE__, __LINE__, "no material '%s'", name);
    return &model_materials(model)[0];
}

TEST(mtl_statements_become_materials) {
    test_write_text(
        in_folder("a.mtl"),
        "# comment\r\nKd 9 9 9\r\n\r\nnewmtl plain\r\nKd 0.1 0.2 0.3\r\nKs .5\r\nKa 1 1 1\r\nNs 32\r\nKe 0 2 0\r\n"
        "d 0.25\r\nNi 1.5\r\nillum 7\r\nTf 0.5 0.5 0.5\r\n  newmtl two words \r\n\tTr 0.75\r\nsharpness 60\r\n"
        "Kd spectral file.rfl 1\r\nnewmtl halo\r\nd -halo 0.5\r\nillum 2");
    test_write_text(in_folder("a.obj"), SQUARE "mtllib a.mtl\nusemtl plain\nf 1 2 3\nusemtl two words\nf 1 3 4\n");
    struct model model;
    if (!read_model(&model, "a.obj"))
        return;
    const struct model_material *m = material(&model, "plain");
    CHECK_NEAR(m->kd.g, 0.2, 0);
    CHECK_NEAR(m->ks.b, 0.5, 0);
    CHECK_NEAR(m->ka.r, 1, 0);
    CHECK_NEAR(m->ke.g, 2, 0);
    CHECK_NEAR(m->shininess, 32, 0);
    CHECK_NEAR(m->dissolve, 0.25, 0);
    CHECK_NEAR(m->ior, 1.5, 0);
    CHECK_NEAR(m->filter.r, 0.5, 0);
    CHECK_EQ_INT(m->illum, 7);
    CHECK_NEAR(material(&model, "two words")->dissolve, 0.25, 0);
    CHECK_NEAR(material(&model, "halo")->dissolve, 0.5, 0);
    const struct model_mesh *mesh = model_meshes(&model);
    CHECK_EQ_INT(mesh->slots.count, 2);
    CHECK_EQ_INT(((uint32_t *)mesh->slots.items)[0], 0);
    CHECK_EQ_INT(((uint32_t *)mesh->slots.items)[1], 1);
    CHECK_EQ_INT(model.warning_count, 1);
    CHECK(
        strstr(model.warnings[0], "a.mtl:17: 1 line with a keyword that gray does not read, the first here: 'Kd' (1)"));
    model_destroy(&model);
}

TEST(mtl_maps_have_their_options_and_are_found) {
    test_write_text(in_folder("my picture.png"), "not looked into here");
    test_write_text(in_folder("plain.png"), "x");
    test_write_text(
        in_folder("maps.mtl"),
        "newmtl a\nmap_Kd -s 2 3 1 -o 0.5 -clamp on -blendu off my picture.png\n"
        "map_Bump -bm 0.25 C:\\pictures\\plain.png\nmap_Ks -mm 0 1 -imfchan l folder/plain.png\nnorm gone.png\n"
        "newmtl b\nbump -t 1 1 1 -odd name.png\n");
    test_write_text(in_folder("maps.obj"), SQUARE "mtllib maps.mtl\nusemtl a\nf 1/1 2/2 3/3\n");
    struct model model;
    if (!read_model(&model, "maps.obj"))
        return;
    const struct model_material *m = material(&model, "a");
    CHECK_TEXT(m->map_kd.name, "my picture.png");
    CHECK_TEXT(m->map_kd.path, in_folder("my picture.png"));
    CHECK_NEAR(m->map_kd.scale[0], 2, 0);
    CHECK_NEAR(m->map_kd.scale[1], 3, 0);
    CHECK_NEAR(m->map_kd.offset[0], 0.5, 0);
    CHECK_EQ_INT(m->map_kd.wrap_u, IMAGE_CLAMP);
    CHECK_NEAR(m->map_bump.strength, 0.25, 0);
    CHECK_TEXT(m->map_bump.path, in_folder("plain.png"));
    CHECK_TEXT(m->map_ks.path, in_folder("plain.png"));
    CHECK(m->map_normal.name && !m->map_normal.path);
    CHECK_TEXT(material(&model, "b")->map_bump.name, "-odd name.png");
    CHECK_EQ_INT(model.warning_count, 2);
    CHECK(strstr(model.warnings[0], "the picture 'gone.png' is not there") != NULL);
    model_destroy(&model);
}

/* A material library in one folder, images in another beside it, blanks in all names, both kinds of slashes. */
TEST(mtl_paths_are_relative_to_the_library_and_may_hold_blanks) {
    struct error error = {0};
    CHECK(file_make_folders_for(test_path("my parts/some tex/x"), &error));
    test_write_text(in_folder("my parts/some tex/a b.png"), "x");
    test_write_text(in_folder("my parts/two.png"), "x");
    test_write_text(in_folder("three.png"), "x");
    test_write_text(in_folder("my parts/the lib.mtl"),
                    "newmtl a\nmap_Kd some tex/a b.png\nmap_Ks -o 0.5 0.25 -s 2 some tex\\a b.png \nmap_Ke two.png\n"
                    "map_d -clamp on ../three.png\n");
    test_write_text(in_folder("rel.obj"), SQUARE "mtllib my parts/the lib.mtl\nusemtl a\nf 1/1 2/2 3/3\n");
    struct model model;
    if (!read_model(&model, "rel.obj"))
        return;
    CHECK_EQ_INT(model.warning_count, 0);
    const struct model_material *m = material(&model, "a");
    CHECK_TEXT(m->map_kd.path, in_folder("my parts/some tex/a b.png"));
    CHECK(m->map_ks.path && strstr(m->map_ks.path, "a b.png"));
    CHECK_NEAR(m->map_ks.offset[1], 0.25, 0);
    CHECK_NEAR(m->map_ks.scale[0], 2, 0);
    CHECK_NEAR(m->map_ks.scale[1], 1, 0);
    CHECK_TEXT(m->map_ke.path, in_folder("my parts/two.png"));
    CHECK_TEXT(m->map_d.path, in_folder("my parts/../three.png"));
    CHECK_EQ_INT(m->map_d.wrap_v, IMAGE_CLAMP);
    model_destroy(&model);
}

TEST(mtl_that_is_missing_and_values_that_are_wrong_are_warnings) {
    test_write_text(in_folder("b.obj"), SQUARE "\nmtllib no where.mtl\nusemtl x\nf 1 2 3\n");
    struct model model;
    if (!read_model(&model, "b.obj"))
        return;
    CHECK_EQ_INT(model.warning_count, 1);
    CHECK(strstr(model.warnings[0], "b.obj:10: the material library 'no where.mtl' is not there") != NULL);
    model_destroy(&model);
#define LEFT "a value is not a finite number: it is left out"
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"newmtl a\nKd 1 x 1\n", "c.mtl:2: " LEFT},
        {"newmtl a\nKd\nKs 1 1e999\nTr #\n", "c.mtl:2: " LEFT " (3 times, the first here)"},
        {"newmtl a\nNs nan\n", "c.mtl:2: " LEFT},
        {"newmtl a\nKd 1e31\n", "c.mtl:2: " LEFT},
        {"newmtl a\n\nmap_Kd -s 1 1\nmap_Ks\n", "c.mtl:3: the name of a picture is missing (2 times, the first here)"},
        {"newmtl a\nfoo 1\nmap_Ka x.png\nPr 0.5\nPr 1\n",
         "c.mtl:2: 3 lines with a keyword that gray does not read, the first here: 'foo' (1), 'Pr' (2)"}};
    test_write_text(in_folder("c.obj"), SQUARE "mtllib c.mtl\nusemtl a\nf 1 2 3\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        test_write_text(in_folder("c.mtl"), cases[i].text);
        if (!read_model(&model, "c.obj"))
            continue;
        CHECK_EQ_INT(model.warning_count, 1);
        CHECK_TEXT(model.warnings[0] + strlen(test_folder()) + 1, cases[i].message);
        CHECK_NEAR(model_materials(&model)[0].kd.r, 0.8, 0);
        CHECK(!model_materials(&model)[0].has_shininess && model_materials(&model)[0].dissolve == 1);
        model_destroy(&model);
    }
}

TEST(mtl_in_utf_16_is_an_error) {
    static const uint8_t text[] = {'n', 0, 'e', 0, 'w', 0, 'm', 0, 't', 0, 'l', 0, ' ', 0, 'a', 0};
    struct model model;
    struct error error = {0};
    test_write_text(in_folder("w.obj"), SQUARE "mtllib w.mtl\nf 1 2 3\n");
    test_write_file(in_folder("w.mtl"), text, sizeof text);
    CHECK(!model_read(&model, in_folder("w.obj"), &(struct model_options){0}, &error));
    CHECK(strstr(error.text, "w.mtl:1: this is UTF-16 text"));
}

/* Each text is a library; the dissolve of its materials, in order. */
TEST(mtl_transparency_is_that_of_d_and_not_all_materials_are_invisible_by_tr) {
    static const struct {
        const char *text;
        double dissolve[3];
        bool warned;
    } cases[] = {
        {"newmtl a\nTr 0.25\n", {0.75}, false},
        {"newmtl a\nd 0.5\nTr 1\n", {0.5}, false},
        {"newmtl a\nTr 1\nd 0.5\n", {0.5}, false},
        {"newmtl a\nTr 1\nd 1\nnewmtl b\nTr 1\n", {1, 0}, false},
        {"newmtl a\nTr 1.0\nnewmtl b\nillum 2\nTr 1\nNi 1\n", {1, 1}, true},
        {"newmtl a\nTr 1\nnewmtl b\nTr 0\n", {0, 1}, false},
        {"newmtl a\nd 0\n", {0}, false},
        {"newmtl a\nTr 1\nnewmtl glass\nTr 1\nNi 1.5\nillum 7\n", {0, 0}, false},
        {"newmtl a\nTr 1\nTf 1 0 0\n", {0}, false},
    };
    test_write_text(in_folder("c.obj"), SQUARE "mtllib c.mtl\nusemtl a\nf 1 2 3\n");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct model model;
        test_write_text(in_folder("c.mtl"), cases[i].text);
        if (!read_model(&model, "c.obj"))
            continue;
        for (size_t k = 0; k < model.materials.count; k++)
            CHECK_NEAR(model_materials(&model)[k].dissolve, cases[i].dissolve[k], 0);
        CHECK_EQ_INT(model.warning_count, cases[i].warned);
        if (model.warning_count)
            CHECK(strstr(model.warnings[0], "c.mtl:2: Tr makes every material of this file invisible: it is opaque "
                                            "instead (2 times, the first here)"));
        model_destroy(&model);
    }
}

TEST(mtl_material_without_a_name_is_that_of_faces_without_one) {
    static const char *const texts[] = {"usemtl\nf 1 2 3\n", "f 1 2 3\n", "usemtl b\nf 1 3 4\nusemtl\nf 1 2 3\n"};
    test_write_text(in_folder("n.mtl"), "newmtl\nKd 1 0 0\nnewmtl b\n");
    for (int i = 0; i < 3; i++) {
        char text[400];
        struct model model;
        (void)snprintf(text, sizeof text, SQUARE "mtllib n.mtl\n%s", texts[i]);
        test_write_text(in_folder("n.obj"), text);
        if (!read_model(&model, "n.obj"))
            continue;
        const struct model_mesh *mesh = model_meshes(&model);
        CHECK_EQ_INT(((uint32_t *)mesh->slots.items)[mesh->slots.count - 1], 0);
        CHECK_EQ_INT(model.warning_count, 0);
        model_destroy(&model);
    }
}

TEST(a_map_without_a_name_has_no_effect_but_a_warning) {
    test_write_text(in_folder("n.obj"), SQUARE "mtllib n.mtl\nusemtl a\nf 1 2 3\n");
    test_write_text(in_folder("n.mtl"), "newmtl a\nmap_Kd -s 1 1\nKd 1 0 0\nmap_Ke\nKe 1 1 1\n");
    struct model model;
    if (!read_model(&model, "n.obj"))
        return;
    CHECK_EQ_INT(model.warning_count, 1);
    CHECK(strstr(model.warnings[0], "n.mtl:2: the name of a picture is missing (2 times, the first here)"));
    CHECK(!material(&model, "a")->map_kd.name && material(&model, "a")->kd.r == 1);
    model_destroy(&model);
}

TEST(mtl_and_pictures_outside_the_readable_folders_are_not_there) {
    char inner[400], path[500];
    (void)snprintf(inner, sizeof inner, "%s/inner/deep", test_folder());
    (void)snprintf(path, sizeof path, "%s/r.obj", inner);
    struct error error = {0};
    CHECK(file_make_folders_for(path, &error));
    test_write_text(in_folder("far.mtl"), "newmtl a\nKd 1 0 0\n");
    test_write_text(in_folder("far.png"), "x");
    test_write_text(path, SQUARE "mtllib ../../far.mtl near.mtl\nf 1 2 3\n");
    char near[500];
    (void)snprintf(near, sizeof near, "%s/near.mtl", inner);
    char text[1000];
    (void)snprintf(text, sizeof text, "newmtl b\nmap_Kd ../../far.png\nmap_Ks %s\n", in_folder("far.png"));
    test_write_text(near, text);
    struct path_policy path_policy = {0};
    CHECK(path_policy_add(&path_policy, inner, PATH_POLICY_READ, &error));
    struct model_options options = {.path_policy = &path_policy};
    struct model model;
    CHECK(model_read(&model, path, &options, &error));
    CHECK_TEXT(error.text, "");
    if (error.kind == ERROR_NONE) {
        CHECK_EQ_INT(model.materials.count, 1);
        CHECK(!model_materials(&model)[0].map_kd.path && !model_materials(&model)[0].map_ks.path);
        CHECK_EQ_INT(model.warning_count, 3);
        model_destroy(&model);
    }
    CHECK(!model_read(&model, in_folder("a.obj"), &options, &error));
    path_policy_destroy(&path_policy);
}

TEST(mtl_materials_of_faces_keep_their_slots) {
    static const struct {
        const char *text;
        uint32_t count, slots[4]; /* of the faces */
        const char *names[4];
    } cases[] = {
        {SQUARE "f 1 2 3\nf 1 3 4\n", 1, {0, 0}, {""}},
        {SQUARE "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl a\nf 2 3 4\n", 2, {0, 1, 0}, {"a", "b"}},
        {SQUARE "f 1 2 3\nusemtl b\nf 1 3 4\n", 2, {1, 0}, {"b", ""}},
        {SQUARE "g one\nf 1 2 3\ng two\nf 1 3 4\ng one\nf 2 3 4\n", 2, {0, 1, 0}, {"one", "two"}},
        {SQUARE "g one\nusemtl a\nf 1 2 3\ng two\nf 1 3 4\n", 1, {0, 0}, {"a"}},
        {SQUARE "usemtl unused\nusemtl a\nf 1 2 3\nf 1 3 4\n", 1, {0, 0}, {"a"}},
        {SQUARE "usemtl\tred  paint \r\nf 1 2 3\r\nusemtl blue\nf 1 3 4\n", 2, {0, 1}, {"red  paint", "blue"}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct model model;
        struct error error;
        CHECK(parse_model(&model, "t.obj", cases[i].text, strlen(cases[i].text), NULL, &error));
        const struct model_mesh *mesh = model_meshes(&model);
        CHECK_EQ_INT(mesh->slots.count, cases[i].count);
        for (uint32_t k = 0; k < cases[i].count; k++)
            CHECK_TEXT(((const char **)mesh->slot_names.items)[k], cases[i].names[k]);
        for (uint32_t f = 0; f < mesh_face_count(mesh->mesh); f++) {
            struct crossing crossing = {.part = f, .u = 0.25, .v = 0.25};
            struct ray ray = test_ray(vec3_make(0, 0, 1), vec3_make(0, 0, -1));
            struct surface surface;
            mesh_describe(mesh->mesh, &ray, &crossing, &surface);
            CHECK_EQ_INT(surface.material_slot, cases[i].slots[f]);
        }
        model_destroy(&model);
    }
}

TEST(a_library_that_an_obj_names_again_and_again_is_read_once) {
    test_write_text(in_folder("l.mtl"), "newmtl red\nKd 1 0 0\n");
    test_write_text(in_folder("l.obj"), SQUARE "mtllib l.mtl\nmtllib l.mtl ./l.mtl\nmtllib ././l.mtl\nusemtl red\n"
                                               "f 1 2 3\n");
    struct model model;
    if (!read_model(&model, "l.obj"))
        return;
    CHECK_EQ_INT(model.materials.count, 1);
    CHECK_EQ_INT(model.warning_count, 0);
    model_destroy(&model);
}

TEST(mtl_materials_follow_their_mesh) {
    test_write_text(in_folder("p.mtl"), "newmtl red\nKd 1 0 0\nillum 1\nKs 1 1 1\nnewmtl glass\nKd .5 .5 .5\nd 0.25\n"
                                        "Ni 1.5\nillum 7\nnewmtl mirror\nKd 0 0 0\nKs 1 1 1\nillum 3\n");
    test_write_text(in_folder("p.obj"),
                    SQUARE "mtllib p.mtl\nusemtl red\nf 1 2 3\nusemtl glass\nf 1 3 4\nusemtl mirror\n"
                           "f 2 3 4\nusemtl other\nf 1 2 4\n");
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    struct model_options options = {0};
    struct model_placing placing = {.name = "p"};
    bool fresh;
    scene_init(&scene, &assets);
    struct model *model = model_asset(&assets, in_folder("p.obj"), "p", &options, &fresh, &error);
    CHECK(model && fresh);
    CHECK(model_asset(&assets, in_folder("p.obj"), "p", &options, &fresh, &error) == model && !fresh);
    struct node *node = model ? model_add_nodes(&scene, model, &placing, &error) : NULL;
    CHECK_TEXT(error.text, "");
    if (node) {
        CHECK_EQ_INT(node->slot_count, 4);
        CHECK_TEXT(node->slot_names[3], "other");
        CHECK(node->slots[3] == NULL);
        CHECK_NEAR(node->slots[0]->phong.kd.r, 1, 0);
        CHECK_NEAR(node->slots[0]->phong.ks.r, 0, 0);
        CHECK_EQ_INT(node->slots[1]->kind, MATERIAL_FRESNEL);
        struct surface_material glass = surface_material_make(node->slots[1], false, NULL);
        CHECK(surface_is_transparent(&glass));
        CHECK_NEAR(surface_medium(&glass).ior, 1.5, 0);
        CHECK_NEAR(node->slots[2]->phong.reflect, 1, 0);
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
}

/* --- crease angles, welding, reversing faces --- */

/* The cube with a separate vertex for every corner of every face, as exporters write hard edges. */
static void cube(struct maker *m, bool shared) {
    static const int sides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int v = 0; shared && v < 8; v++)
        maker_vertex(m, v & 1, v >> 1 & 1, v >> 2 & 1);
    for (int f = 0; f < 6; f++) {
        uint32_t corners[4];
        for (int k = 0; k < 4; k++) {
            int v = sides[f][k];
            corners[k] = shared ? (uint32_t)v : maker_vertex(m, v & 1, v >> 1 & 1, v >> 2 & 1);
        }
        maker_face(m, corners, 4);
    }
}

static struct mesh *smoothed(const struct maker *m, double degrees, bool weld, bool flip) {
    struct mesh_input input = maker_input(m);
    struct mesh_tables own = {0};
    struct error error = {0};
    CHECK(!weld || mesh_input_weld(&input, &own, 0, &error));
    CHECK(!flip || mesh_input_flip(&input, &own, &error));
    CHECK(degrees < 0 || mesh_input_smooth(&input, &own, degrees, &error));
    struct mesh *mesh = mesh_create(&input, &error);
    CHECK_TEXT(error.text, "");
    mesh_tables_destroy(&own);
    return mesh;
}

static struct surface surface_at(const struct mesh *mesh, uint32_t triangle, double u, double v) {
    struct crossing crossing = {.part = triangle, .u = u, .v = v};
    struct ray ray = test_ray(vec3_make(0, 0, 9), vec3_make(0, 0, -1));
    struct surface surface;
    mesh_describe(mesh, &ray, &crossing, &surface);
    return surface;
}

TEST(smooth_cube_has_corner_normals_at_91_degrees_and_flat_faces_at_89) {
    for (int shared = 0; shared < 2; shared++) {
        struct maker m = {0};
        cube(&m, shared);
        struct mesh *soft = smoothed(&m, 91, false, false), *hard = smoothed(&m, 89, false, false);
        struct mesh *exact = smoothed(&m, 90, false, false), *flat = smoothed(&m, 0, false, false);
        CHECK(soft->normal_count > 0 && hard->normal_count > 0 && flat->normal_count == 0);
        for (uint32_t t = 0; t < 12; t++)
            for (int k = 0; k < 3; k++) {
                struct surface s = surface_at(soft, t, k == 1, k == 2), h = surface_at(hard, t, k == 1, k == 2);
                struct surface e = surface_at(exact, t, k == 1, k == 2);
                struct vec3 out = vec3_normalize(vec3_sub(s.point, vec3_all(0.5)));
                CHECK_NEAR(vec3_dot(vec3_normalize(s.shading_normal), out), 1, 1e-12);
                CHECK_NEAR(vec3_dot(vec3_normalize(e.shading_normal), out), 1, 1e-12);
                CHECK_NEAR(vec3_dot(vec3_normalize(h.shading_normal), vec3_normalize(h.normal)), 1, 1e-12);
            }
        mesh_release(soft), mesh_release(hard), mesh_release(exact), mesh_release(flat);
        maker_free(&m);
    }
}

TEST(smooth_normals_do_not_depend_on_how_faces_are_cut_into_triangles) {
    /* The tip of a pyramid over a square with one side cut into many slivers: weights by angle do not change. */
    struct maker m = {0}, n = {0};
    for (int cut = 0; cut < 2; cut++) {
        struct maker *p = cut ? &n : &m;
        uint32_t tip = maker_vertex(p, 0, 1, 0), a = maker_vertex(p, 1, 0, 1), b = maker_vertex(p, 1, 0, -1),
                 c = maker_vertex(p, -1, 0, -1), d = maker_vertex(p, -1, 0, 1);
        maker_triangle(p, tip, a, b);
        maker_triangle(p, tip, b, c);
        maker_triangle(p, tip, c, d);
        uint32_t last = d;
        for (int i = 1; cut && i < 8; i++) {
            uint32_t next = maker_vertex(p, -1 + 2 * i / 8.0, 0, 1);
            maker_triangle(p, tip, last, next);
            last = next;
        }
        maker_triangle(p, tip, last, a);
    }
    struct mesh *whole = smoothed(&m, 180, false, false), *slivers = smoothed(&n, 180, false, false);
    struct vec3 p = vec3_normalize(surface_at(whole, 0, 0, 0).shading_normal);
    struct vec3 q = vec3_normalize(surface_at(slivers, 0, 0, 0).shading_normal);
    CHECK_NEAR(p.x, q.x, 1e-12);
    CHECK_NEAR(p.y, q.y, 1e-12);
    CHECK_NEAR(p.y, 1, 1e-12);
    mesh_release(whole), mesh_release(slivers);
    maker_free(&m), maker_free(&n);
}

TEST(smooth_normals_are_the_same_bits_at_any_power_of_two) {
    struct maker m = {0};
    maker_twisted_torus(&m, 12, 8, 1);
    struct mesh *one = smoothed(&m, 60, true, false);
    for (int power = -900; power <= 900; power += 300) {
        struct maker n = {0};
        maker_twisted_torus(&n, 12, 8, 1);
        maker_scale(&n, ldexp(1, power), 0, 0, 0);
        struct mesh *scaled = smoothed(&n, 60, true, false);
        for (uint32_t t = 0; t < mesh_triangle_count(one); t++) {
            struct vec3 a = surface_at(one, t, 0.25, 0.5).shading_normal,
                        b = surface_at(scaled, t, 0.25, 0.5).shading_normal;
            CHECK(memcmp(&a, &b, sizeof a) == 0);
        }
        mesh_release(scaled);
        maker_free(&n);
    }
    mesh_release(one);
    maker_free(&m);
}

TEST(faces_without_area_have_no_vote_in_smooth_normals) {
    /* The second face shares an edge with the first, and its third corner is beside the first one by a rounding. */
    struct maker m = {0};
    uint32_t a = maker_vertex(&m, 0.3, 0.2, 0.1), b = maker_vertex(&m, 0.9, 0.2, 0.1),
             c = maker_vertex(&m, 0.3, 0.2, -2), beside = maker_vertex(&m, 0.3, nextafter(0.2, 1), 0.1);
    maker_triangle(&m, a, b, c);
    maker_triangle(&m, b, a, beside);
    struct mesh *mesh = smoothed(&m, 180, false, false);
    struct surface s = surface_at(mesh, 0, 0, 0);
    CHECK_NEAR(vec3_dot(vec3_normalize(s.shading_normal), vec3_normalize(s.normal)), 1, 1e-15);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(smooth_fan_of_a_hundred_thousand_faces_takes_a_moment) {
    struct maker m = {0};
    uint32_t tip = maker_vertex(&m, 0, 1, 0), first = 0, last = 0;
    for (int i = 0; i < 100000; i++) {
        uint32_t v = maker_vertex(&m, cos(i * 2 * M_PI / 100000), 0, -sin(i * 2 * M_PI / 100000));
        if (i)
            maker_triangle(&m, tip, last, v);
        else
            first = v;
        last = v;
    }
    maker_triangle(&m, tip, last, first);
    struct mesh *mesh = smoothed(&m, 60, true, false);
    struct vec3 n = vec3_normalize(surface_at(mesh, 0, 0, 0).shading_normal);
    CHECK_NEAR(n.y, 1, 1e-9);
    mesh_release(mesh);
    maker_free(&m);
}

TEST(weld_makes_one_vertex_of_each_position_and_flip_turns_the_outside) {
    struct maker m = {0};
    cube(&m, false);
    maker_vertex(&m, 5, 5, 5); /* used by no face */
    struct mesh *plain = smoothed(&m, -1, false, false), *welded = smoothed(&m, -1, true, false),
                *flipped = smoothed(&m, 91, true, true);
    uint32_t count;
    (void)mesh_vertices(plain, &count);
    CHECK_EQ_INT(count, 25);
    (void)mesh_vertices(welded, &count);
    CHECK_EQ_INT(count, 8);
    CHECK(same_faces(plain, welded));
    CHECK(mesh_is_closed(welded) && mesh_is_closed(flipped));
    struct surface s = surface_at(flipped, 0, 0, 0);
    struct vec3 out = vec3_sub(s.point, vec3_all(0.5));
    CHECK(vec3_dot(s.normal, out) < 0);
    CHECK(vec3_dot(s.shading_normal, out) < 0);
    mesh_release(plain), mesh_release(welded), mesh_release(flipped);
    maker_free(&m);
}
