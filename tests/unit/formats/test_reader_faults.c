/* Files of every kind that use every feature of the readers, damaged in every place: each word replaced by unexpected
 * words, each byte changed, each tail cut off; and failures of each allocation and each system call. The result is a
 * model or one line that names the file. */
#include "tests/unit/model_makers.h"

#include "base/fault.h"
#include "formats/model_node.h"
#include "image/png_write.h"

static const char gltf_text[] =
    "{\"asset\":{\"version\":\"2.0\"},\"extensionsRequired\":[\"KHR_materials_ior\"],\"scene\":0,"
    "\"scenes\":[{\"nodes\":[0,3]}],"
    "\"nodes\":[{\"name\":\"a\",\"mesh\":0,\"children\":[1,2]},"
    "{\"mesh\":0,\"translation\":[1,2,3],\"rotation\":[0,0,0,1],\"scale\":[2,1,2]},"
    "{\"name\":\"c\",\"matrix\":[1,0,0,0,0,1,0,0,0,0,1,0,5,6,7,1]},"
    "{\"name\":\"d\",\"mesh\":1}],"
    "\"meshes\":[{\"name\":\"quad\",\"primitives\":["
    "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"COLOR_0\":3},\"indices\":4,\"material\":0},"
    "{\"attributes\":{\"POSITION\":5},\"material\":1,\"mode\":5},"
    "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1},\"material\":0,\"mode\":6}]},"
    "{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":4,\"material\":2},"
    "{\"attributes\":{\"POSITION\":0},\"mode\":1},{\"attributes\":{\"POSITION\":0},\"indices\":4}]}],"
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":1,\"byteOffset\":0,\"componentType\":5120,\"normalized\":true,\"count\":4,\"type\":\"VEC3\"},"
    "{\"bufferView\":2,\"componentType\":5123,\"normalized\":true,\"count\":4,\"type\":\"VEC2\"},"
    "{\"bufferView\":3,\"componentType\":5121,\"normalized\":true,\"count\":4,\"type\":\"VEC4\"},"
    "{\"bufferView\":4,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"sparse\":{\"count\":2,"
    "\"indices\":{\"bufferView\":5,\"byteOffset\":0,\"componentType\":5121},\"values\":{\"bufferView\":6}}}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48},{\"buffer\":0,\"byteOffset\":48,\"byteLength\":16,"
    "\"byteStride\":4},{\"buffer\":0,\"byteOffset\":64,\"byteLength\":16},"
    "{\"buffer\":0,\"byteOffset\":80,\"byteLength\":16},{\"buffer\":0,\"byteOffset\":96,\"byteLength\":12},"
    "{\"buffer\":0,\"byteOffset\":108,\"byteLength\":2},{\"buffer\":0,\"byteOffset\":112,\"byteLength\":24},"
    "{\"buffer\":1,\"byteLength\":%zu}],"
    "\"buffers\":[{\"byteLength\":136,\"uri\":\"data:application/octet-stream;base64,%s\"},{\"uri\":\"p%%69c.png\"}],"
    "\"images\":[{\"uri\":\"pic.png\"},{\"uri\":\"data:image/png;base64,%s\"},{\"bufferView\":7},"
    "{\"uri\":\"gone.png\"}],"
    "\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,\"magFilter\":9728},{}],"
    "\"textures\":[{\"source\":0,\"sampler\":0},{\"source\":1,\"sampler\":1},{\"source\":2},{\"source\":3},{}],"
    "\"materials\":[{\"name\":\"m\",\"pbrMetallicRoughness\":{\"baseColorFactor\":[1,0.5,0.5,0.5],"
    "\"metallicFactor\":0.5,\"roughnessFactor\":0.1,\"baseColorTexture\":{\"index\":0,\"extensions\":"
    "{\"KHR_texture_transform\":{\"scale\":[2,2],\"offset\":[0.5,0],\"rotation\":0}}},"
    "\"metallicRoughnessTexture\":{\"index\":1}},\"normalTexture\":{\"index\":1,\"scale\":2},"
    "\"emissiveFactor\":[1,1,1],\"emissiveTexture\":{\"index\":2},\"alphaMode\":\"MASK\",\"alphaCutoff\":0.3,"
    "\"doubleSided\":true},"
    "{\"name\":\"glass\",\"alphaMode\":\"BLEND\",\"pbrMetallicRoughness\":{\"metallicFactor\":0,"
    "\"baseColorTexture\":{\"index\":2}},\"extensions\":{\"KHR_materials_transmission\":{\"transmissionFactor\":1},"
    "\"KHR_materials_ior\":{\"ior\":1.4}}},"
    "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":3,\"texCoord\":0}},"
    "\"normalTexture\":{\"index\":4},\"extensions\":{\"KHR_materials_unlit\":{}}}]}";

static const char obj_text[] =
    "# everything\r\nmtllib gone.mtl t.mtl\nmtllib t.mtl\no thing\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1 1\n"
    "vt 0\nvt 1 0\nvt 0 1 0\nvn 0 0 1\nf 1 2 3\nusemtl red\nf 1/1/1 2/2 3//1\nusemtl  two words \nf -4 -3 \\\n -2\n"
    "g part\nusemtl nowhere\nfo 1 2/ 4\nusemtl\nf 2 3 4\ns off\n";
static const char mtl_text[] =
    "# all\nnewmtl red\nKa 1 1 1\nKd 0 0 0\nKs 0.5\nKe 1 0 0\nTf 1 1 1\nNs 10\nNi 1.5\nd 0.5\nillum 7\n"
    "map_Kd -s 2 2 -o 1 1 1 -t 0 -mm 0 1 -boost 2 -texres 8 -clamp on -blendu on -blendv off -cc off -type x "
    "-imfchan r pic.png\nmap_Ks pic.png\nmap_Ke pic.png\nmap_d pic.png\nbump -bm 2 pic.png\nnorm pic.png\n"
    "newmtl two words\r\nKd spectral x\nKs xyz 1\nTr -halo 0.5\nillum 2\nmap_bump gone.png\nmap_Kn sub\\gone.png\n"
    "newmtl red\nTr 0\nillum 4\nKd 0 0 0\nmap_Kd pic.png\n";
#define PLY_BODY                                                                                                       \
    "comment c\nobj_info i\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"                  \
    "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"                    \
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int other\n"                              \
    "property list uchar int more\nelement face 2\nproperty list uchar int vertex_indices\nproperty float w\n"         \
    "element tristrips 1\nproperty list int int vertex_indices\nelement edge 1\nproperty int a\n"                      \
    "property list uchar float b\nelement none 0\nelement last 1\nproperty int c\nend_header\n"
static const char ply_text[] =
    "ply\nformat ascii 1.0\n" PLY_BODY "0 0 0 0 0 1 0 0 255 0 0 7 1 5\n1 0 0 0 0 1 1 0 255 0 0 7 0\n"
    "0 1 0 0 0 1 0 1 0 0 255 7 0\n\n0 0 1 0 0 1 0 1 0 0 255 7 2 3 4\n3 0 1 2 0.5\n4 0 1 2 3 0.5\n"
    "8 0 1 2 3 -1 1 2 3\n1 2 3 4\n9\n";
static const char ply_corner_text[] =
    "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
    "property ushort red\r\nproperty ushort green\r\nproperty ushort blue\r\nelement face 3\r\n"
    "property list uchar uint vertex_index\r\nproperty list uchar float texcoord\r\nend_header\r\n"
    "0 0 0 65535 0 0\r\n1 0 0 0 0 0\r\n0 1 0 0 0 0\r\n3 0 1 2 0\r\n3 0 2 1 6 0 0 1 0 0 1\r\n3 1 2 0 6 0 0 1 0 0 1\r\n";
static const char stl_text[] = "solid a name\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                               "vertex 0 1 0\nendloop\nendfacet\nendsolid\nsolid\nendsolid b\n";

/* Words to insert in wrong places, including kinds and sizes that the formats know. */
static const char *const strange[] = {"0",
                                      "1",
                                      "2",
                                      "3",
                                      "-1",
                                      "1.5",
                                      "nan",
                                      "-1e999",
                                      "1e300",
                                      "7e9",
                                      "5120",
                                      "5122",
                                      "5123",
                                      "5124",
                                      "5125",
                                      "5121",
                                      "9007199254740993",
                                      "\"\"",
                                      "\"VEC4\"",
                                      "\"SCALAR\"",
                                      "\"data:;base64,AA%A\"",
                                      "\"data:,x\"",
                                      "{}",
                                      "[]",
                                      "null",
                                      "true",
                                      "list",
                                      "vertex",
                                      "float",
                                      "double",
                                      "char",
                                      "x\x01\x7f\xff"};

static void write_picture_row(void *context, uint32_t y, uint8_t *line) {
    (void)context;
    memset(line, (int)y, 3 * 4);
}

static void put(const char *name, const void *data, size_t size) {
    test_write_file(test_path(name), data, size);
}

/* The text of t.gltf with its buffers and pictures inserted. */
static void make_gltf(struct bytes *out) {
    static const double corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    struct bytes buffer = {0}, coded = {0}, picture = {0};
    for (int i = 0; i < 12; i++)
        bytes_float(&buffer, corners[i / 3][i % 3], false);
    for (int i = 0; i < 4; i++)
        bytes_number(&buffer, 0x007f0000, 4, false);
    for (int i = 0; i < 4; i++)
        bytes_number(&buffer, i % 2 ? 0xffff : 0xffff0000, 4, false);
    for (int i = 0; i < 4; i++)
        bytes_number(&buffer, 0xff80ff00, 4, false);
    for (int i = 0; i < 6; i++)
        bytes_number(&buffer, (uint64_t)(i < 3 ? i : 6 - i), 2, false);
    bytes_number(&buffer, 0x0301, 4, false);
    for (int i = 0; i < 6; i++)
        bytes_float(&buffer, i + 1, false);
    write_base64(&coded, &buffer);
    bytes_add(&coded, "", 1);
    size_t size;
    uint8_t *png = (uint8_t *)test_read_file(test_path("pic.png"), &size);
    struct bytes raw = {.data = png, .size = size};
    write_base64(&picture, &raw);
    bytes_add(&picture, "", 1);
    size_t room = sizeof gltf_text + coded.size + picture.size;
    out->data = malloc(room);
    out->size = (size_t)snprintf((char *)out->data, room, gltf_text, size, (char *)coded.data, (char *)picture.data);
    bytes_free(&buffer), bytes_free(&coded), bytes_free(&picture);
    free(png);
}

static void prepare(void) {
    struct error error = {0};
    CHECK(png_write_from(FILE_AT(test_path("pic.png")),
                         &(struct png_source){.width = 4, .height = 4, .bytes = write_picture_row}, NULL, &error));
    put("t.mtl", mtl_text, strlen(mtl_text));
}

/* Reads the file into a scene with everything that it names. */
static bool read_into_scene(const char *path, const struct model_options *options, struct error *error,
                            int *triangles) {
    struct model model;
    struct assets assets = {0};
    struct scene scene;
    *error = (struct error){0};
    if (!model_read(&model, path, options, error))
        return false;
    *triangles = 0;
    for (size_t i = 0; i < model.meshes.count; i++)
        *triangles += (int)mesh_triangle_count(model_meshes(&model)[i].mesh);
    scene_init(&scene, &assets);
    struct model_placing placing = {.name = "all"};
    bool ok = model_add_nodes(&scene, &model, &placing, error) != NULL;
    scene_destroy(&scene);
    assets_destroy(&assets);
    model_destroy(&model);
    return ok;
}

static bool is_separator(char c) {
    return strchr(" \t\r\n:,{}[]", c) != NULL;
}

/* The end of the word at `at`: a string with its quotes, or the text up to a separator. */
static size_t word_end(const char *text, size_t size, size_t at) {
    size_t end = at + 1;
    if (text[at] == '"') {
        while (end < size && text[end] != '"')
            end++;
        return end < size ? end + 1 : end;
    }
    while (end < size && !is_separator(text[end]))
        end++;
    return end;
}

static void expect_line(const char *path, bool ok, const struct error *error, const char *what) {
    char folder[512];
    (void)snprintf(folder, sizeof folder, "%s/", test_folder());
    if (!ok && (strncmp(error->text, folder, strlen(folder)) != 0 || strchr(error->text, '\n')))
        test_fail(__FILE__, __LINE__, "%s, %s: kind %d: %s", path, what, (int)error->kind, error->text);
}

/* Removes every word of the text, and replaces it by every unexpected one. */
static void change_words(const char *name, const char *text, size_t size, const struct model_options *options) {
    const char *path = test_path(name);
    char *changed = malloc(size + 64);
    for (size_t at = 0, end; at < size; at = end) {
        end = at + 1;
        if (is_separator(text[at]))
            continue;
        end = word_end(text, size, at);
        for (size_t k = 0; k <= sizeof strange / sizeof strange[0]; k++) {
            const char *by = k < sizeof strange / sizeof strange[0] ? strange[k] : "";
            size_t length = strlen(by);
            memcpy(changed, text, at);
            memcpy(changed + at, by, length);
            memcpy(changed + at + length, text + end, size - end);
            struct model model;
            struct error error;
            bool ok = parse_model(&model, path, changed, size - (end - at) + length, options, &error);
            expect_line(path, ok, &error, by);
            if (ok)
                model_destroy(&model);
        }
    }
    free(changed);
}

/* Call number 1, 2, 3 ... fails until a run has fewer calls. */
static void fail_everything(const char *name, const struct model_options *options) {
#ifdef GRAY_FAULTS
    for (int kind = FAULT_OF_ALLOCATION; kind <= FAULT_OF_CALL; kind++)
        for (uint64_t k = 1;; k++) {
            struct error error;
            int triangles;
            uint64_t before = fault_count((enum fault_kind)kind);
            fault_at((enum fault_kind)kind, k);
            bool ok = read_into_scene(test_path(name), options, &error, &triangles);
            fault_at((enum fault_kind)kind, 0);
            if (!ok && kind == FAULT_OF_ALLOCATION && error.kind != ERROR_MACHINE)
                test_fail(__FILE__, __LINE__, "%s, allocation %llu: %s", name, (unsigned long long)k, error.text);
            if (!ok)
                CHECK(error.text[0] && !strchr(error.text, '\n'));
            if (fault_count((enum fault_kind)kind) - before < k)
                break;
        }
#else
    (void)name, (void)options;
#endif
}

static void check_text(const char *name, const char *text, size_t size, int triangles) {
    struct error error;
    int found = 0;
    struct model_options plain = {0}, all = {.smooth = true, .smooth_angle = 60, .weld = true, .flip = true};
    prepare();
    put(name, text, size);
    if (!read_into_scene(test_path(name), &plain, &error, &found))
        test_fail(__FILE__, __LINE__, "%s", error.text);
    CHECK_EQ_INT(found, triangles);
    change_words(name, text, size, &plain);
    fail_everything(name, &plain);
    fail_everything(name, &all);
}

TEST(any_word_of_a_gltf_file_may_be_another) {
    struct bytes b = {0};
    test_need_json();
    prepare();
    make_gltf(&b);
    check_text("t.gltf", (const char *)b.data, b.size, 10);
    bytes_free(&b);
}

TEST(any_word_of_an_obj_file_may_be_another) {
    check_text("t.obj", obj_text, strlen(obj_text), 5);
}

/* As two gzip members, followed by zeros. */
TEST(any_allocation_may_fail_while_gzip_is_read) {
    char line[2048];
    prepare();
    put("t.obj", obj_text, strlen(obj_text));
    (void)snprintf(line, sizeof line,
                   "cd '%s' && head -n 9 t.obj | gzip >z.obj.gz && tail -n +10 t.obj | gzip >>z.obj.gz && "
                   "head -c 100 /dev/zero >>z.obj.gz",
                   test_folder());
    test_need_tools("gzip");
    CHECK(system(line) == 0);
    struct model_options plain = {0};
    struct error error;
    int triangles = 0;
    CHECK(read_into_scene(test_path("z.obj.gz"), &plain, &error, &triangles));
    CHECK_EQ_INT(triangles, 5);
    fail_everything("z.obj.gz", &plain);
}

TEST(any_word_of_a_ply_file_may_be_another) {
    check_text("t.ply", ply_text, strlen(ply_text), 6);
    check_text("c.ply", ply_corner_text, strlen(ply_corner_text), 3);
}

TEST(any_word_of_an_stl_file_may_be_another) {
    check_text("t.stl", stl_text, strlen(stl_text), 1);
}

/* Each kind of map alone, each kind of bump and of emission, metal without a map; an STL with an unnamed part; a mesh
 * without triangles. */
TEST(any_allocation_may_fail_while_materials_are_flattened) {
    static const char library[] = "newmtl a\nillum 2\nKs 1 1 1\nNs 0\nmap_Ks pic.png\nnewmtl b\nbump pic.png\n"
                                  "newmtl c\nillum 6\nNi 0.5\nNs 7\nnewmtl d\nillum 7\nNi 1.5\nnewmtl e\nillum 10\n"
                                  "newmtl f\nillum 5\nNi 1.2\nnewmtl g\nillum 9\nNi 1.2\nmap_d pic.png\n";
    static const char model[] = "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n"
                                "usemtl c\nf 1 2 3\nusemtl d\nf 1 2 3\nusemtl e\nf 1 2 3\nusemtl f\nf 1 2 3\n"
                                "usemtl g\nf 1 2 3\n";
    struct model_options plain = {0};
    struct error error;
    char path[512];
    int triangles = 0;
    prepare();
    put("looks.mtl", library, strlen(library));
    put("looks.obj", model, strlen(model));
    (void)snprintf(path, sizeof path, "%s/looks.obj", test_folder());
    CHECK(read_into_scene(path, &plain, &error, &triangles));
    CHECK_EQ_INT(triangles, 7);
    fail_everything("looks.obj", &plain);
#ifdef HAVE_JANSSON
    static const char metal[] =
        "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"uri\":\"data:;base64,"
        "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==\"}],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
        "\"materials\":[{\"pbrMetallicRoughness\":{\"metallicFactor\":0.5,\"baseColorTexture\":{\"index\":0}}}],"
        "\"textures\":[{\"source\":0}],\"images\":[{\"uri\":\"pic.png\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1,\"material\":0}]},"
        "{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":0}]}],"
        "\"nodes\":[{\"mesh\":0},{\"mesh\":1}],\"scenes\":[{\"nodes\":[0,1]}]}";
    put("metal.gltf", metal, strlen(metal));
    (void)snprintf(path, sizeof path, "%s/metal.gltf", test_folder());
    CHECK(read_into_scene(path, &plain, &error, &triangles));
    CHECK_EQ_INT(triangles, 1);
    fail_everything("metal.gltf", &plain);
#endif
}

TEST(a_part_that_a_file_does_not_name_changes_nothing) {
    struct assets assets = {0};
    struct scene scene;
    struct model model;
    struct error error = {0};
    struct material *red;
    const char *const names[] = {"hull"};
    scene_init(&scene, &assets);
    CHECK((red = scene_material(&scene, MATERIAL_PHONG, NULL, &error)) != NULL);
    CHECK(
        model_parse(&model, "t.stl", (const uint8_t *)stl_text, strlen(stl_text), &(struct model_options){0}, &error));
    const struct material *const materials[] = {red};
    struct model_placing placing = {.name = "n", .part_names = names, .part_materials = materials, .part_count = 1};
    CHECK(!model_has_part(&model, "hull"));
    const struct node *node = model_add_nodes(&scene, &model, &placing, &error);
    CHECK(node && node->material != red);
    model_destroy(&model);
    scene_destroy(&scene);
    assets_destroy(&assets);
}

TEST(a_model_whose_real_name_is_too_long_for_the_store_is_an_error) {
    struct assets assets = {0};
    struct error error = {0};
    bool fresh;
    char *name = malloc(6000);
    memset(name, 'x', 5999);
    name[5999] = '\0';
    CHECK(!model_asset(&assets, "t.obj", name, &(struct model_options){0}, &fresh, &error));
    CHECK_TEXT(error.text, "t.obj: its path is too long");
    free(name);
    assets_destroy(&assets);
}

/* The library of materials is another file: its lines name it. */
TEST(any_word_of_a_material_library_may_be_another) {
    struct error error;
    char *changed = malloc(sizeof mtl_text + 64);
    int triangles;
    prepare();
    put("t.obj", obj_text, strlen(obj_text));
    const char *path = test_path("t.obj");
    for (size_t at = 0, end; at < strlen(mtl_text); at = end) {
        end = at + 1;
        if (is_separator(mtl_text[at]))
            continue;
        end = word_end(mtl_text, strlen(mtl_text), at);
        static const char *const words[] = {"", "-1", "7", "nan", "1e300", "-s", "spectral", "illum", "x\x01\x7f"};
        for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
            int length =
                snprintf(changed, sizeof mtl_text + 64, "%.*s%s%s", (int)at, mtl_text, words[k], mtl_text + end);
            put("t.mtl", changed, (size_t)length);
            expect_line(path, read_into_scene(path, &(struct model_options){0}, &error, &triangles), &error, words[k]);
        }
    }
    free(changed);
}
