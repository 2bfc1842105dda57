/* Edits in the window: steps and their inverses, edits applied to a scene and removed again, the same edits as calls of
 * a script, and the node that a click selects. */
#include "inspect/pick.h"
#include "material/material_inputs.h"
#include "render/camera.h"
#include "scene/edits.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static struct change change_of(enum change_kind kind, uint32_t target, double number) {
    return (struct change){.kind = kind, .serial = target, .number = target, .numbers = {number}};
}

static bool same_list(const struct change_list *a, const struct change_list *b) {
    if (a->count != b->count)
        return false;
    for (uint32_t i = 0; i < a->count; i++) {
        if (!change_same_target(&a->items[i], &b->items[i]) || a->items[i].numbers[0] < b->items[i].numbers[0] ||
            a->items[i].numbers[0] > b->items[i].numbers[0])
            return false;
    }
    return true;
}

/* The state after the first steps, computed from the empty state. */
static bool holds(const struct edits *edits) {
    struct change_list list = {0};
    for (uint32_t i = 0; i < edits->at; i++)
        CHECK(change_list_set(&list, &edits->steps[i].after, edits->steps[i].has));
    bool same = same_list(&list, &edits->now);
    change_list_destroy(&list);
    return same;
}

TEST(edits_undone_and_made_again_in_any_order_hold_what_their_steps_say) {
    struct edits edits = {0};
    struct test_random random = {7};
    struct change target;
    for (int i = 0; i < 3000; i++) {
        double what = test_uniform(&random, 0, 1);
        if (what < 0.5) {
            enum change_kind kind = (enum change_kind)(test_uniform(&random, 0, CHANGE_KINDS - 0.01));
            struct change change = change_of(kind, (uint32_t)test_uniform(&random, 1, 6), i);
            CHECK(edits_make(&edits, &change, test_uniform(&random, 0, 1) < 0.9, test_uniform(&random, 0, 1) < 0.3));
        } else if (what < 0.8) {
            CHECK(edits_undo(&edits, &target) == (edits.at < edits.count));
        } else {
            (void)edits_redo(&edits, &target);
        }
        if (i % 16 == 0)
            CHECK(holds(&edits));
    }
    uint32_t count = edits.count;
    while (edits_redo(&edits, &target))
        ;
    CHECK(holds(&edits) && edits.at == count);
    while (edits_undo(&edits, &target))
        ;
    CHECK(edits.at == 0 && edits.now.count == 0);
    edits_destroy(&edits);
}

TEST(edits_of_one_drag_are_one_step) {
    struct edits edits = {0};
    struct change target, change = change_of(CHANGE_TRANSFORM, 3, 1);
    CHECK(edits_make(&edits, &change, true, false));
    for (int i = 2; i < 50; i++) {
        change.numbers[0] = i;
        CHECK(edits_make(&edits, &change, true, true));
    }
    struct change other = change_of(CHANGE_TRANSFORM, 4, 1);
    CHECK(edits_make(&edits, &other, true, true)); /* of another target: a separate step */
    CHECK_EQ_INT(edits.count, 2);
    CHECK(edits_undo(&edits, &target) && target.serial == 4);
    CHECK(edits_undo(&edits, &target) && target.serial == 3);
    CHECK_EQ_INT(edits.now.count, 0);
    CHECK(!edits_undo(&edits, &target));
    CHECK(edits_redo(&edits, &target));
    CHECK_NEAR(edits.now.items[0].numbers[0], 49, 0);
    CHECK(edits_make(&edits, &other, true, false)); /* undone steps are discarded */
    CHECK(!edits_redo(&edits, &target));
    edits_destroy(&edits);
}

TEST(edits_lists_do_not_depend_on_what_was_changed_first) {
    struct change_list forward = {0}, backward = {0};
    struct change changes[24];
    for (int i = 0; i < 24; i++)
        changes[i] = change_of((enum change_kind)(i % CHANGE_KINDS), (uint32_t)(1 + i * 7 % 11), i);
    for (int i = 0; i < 24; i++) {
        CHECK(change_list_set(&forward, &changes[i], true));
        CHECK(change_list_set(&backward, &changes[23 - i], true));
    }
    CHECK_EQ_INT(forward.count, backward.count);
    for (uint32_t i = 0; i < forward.count; i++)
        CHECK(change_same_target(&forward.items[i], &backward.items[i]));
    change_list_destroy(&forward);
    change_list_destroy(&backward);
}

static void count_warning(void *context, const char *text) {
    CHECK(strstr(text, "is skipped") != NULL);
    ++*(int *)context;
}

/* The window keeps the world when only colours change: its materials are copies, which are updated. */
TEST(a_kept_world_has_changed_colours_once_its_materials_are_updated) {
    static struct stage s;
    stage_begin(&s, 1);
    struct material *red = stage_phong(&s, colour_make(1, 0, 0), colour_all(0), 1);
    struct material *coated = scene_material(&s.scene, MATERIAL_FRESNEL, red, &s.error);
    stage_sphere(&s, s.root, coated);
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    const struct surface_material *material = &s.world.surfaces.materials[0];
    CHECK(s.world.authored.materials[0] == coated && coated->base == red);
    CHECK(material->fresnel && material->phong.kd.r == 1);
    red->phong.kd = colour_make(0, 0, 1);
    CHECK(material->phong.kd.r == 1);
    world_update_materials(&s.world);
    CHECK(material->phong.kd.r == 0 && material->phong.kd.b == 1);
    stage_end(&s);
}

/* A box for every call of a node, a point light for every other one. */
static bool make_box(void *context, const struct change *change, void **object, struct error *error) {
    struct stage *s = context;
    struct scene_light *made = arena_alloc(&s->scene.arena, sizeof *made);
    *made = (struct scene_light){.light = {.kind = LIGHT_POINT, .falloff = {1, 0, 0}, .colour = {1, 1, 1}}};
    *object = made;
    if (change->kind == CHANGE_ADD_LIGHT)
        return true;
    uint32_t nodes = s->scene.node_count;
    struct node *node = scene_node(&s->scene, NODE_GEOMETRY, "box", error);
    s->scene.node_count = nodes;
    node->shape = (struct shape){.kind = SHAPE_BOX, .box = {vec3_all(-1), vec3_all(1)}};
    *object = node;
    return true;
}

TEST(changes_that_are_taken_off_leave_the_scene_as_it_was) {
    static struct stage s;
    struct changed_scene changed;
    struct error error;
    int warnings = 0;
    stage_begin(&s, 1);
    struct material *red = stage_phong(&s, colour_make(1, 0, 0), colour_all(0), 1);
    struct node *group = stage_group(&s, s.root), *ball = stage_sphere(&s, group, red);
    stage_move(&s, ball, 1, 2, 3);
    stage_point_light(&s, vec3_make(1, 2, 3), colour_all(1));
    struct transform before = ball->parent_from_node;
    const struct change_maker maker = {make_box, &s};
    uint32_t nodes = s.scene.node_count, materials = s.scene.material_count;
    const struct change changes[] = {
        {.kind = CHANGE_ADD, .serial = group->serial, .call = "box", .numbers = {0.1, 0.2, 0.3}},
        {.kind = CHANGE_ADD, .serial = group->serial, .number = 1, .source = ball->serial},
        {.kind = CHANGE_TRANSFORM, .serial = UINT32_MAX, .numbers = {2, 0, 0, 5, 0, 2, 0, 0, 0, 0, 2, 0}},
        {.kind = CHANGE_TRANSFORM, .serial = ball->serial, .numbers = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 7}},
        {.kind = CHANGE_GONE, .serial = ball->serial},
        {.kind = CHANGE_MATERIAL, .serial = red->serial, .numbers = {0, 1, 0}},
        {.kind = CHANGE_ADD_LIGHT, .call = "light", .numbers = {9, 8, 7, 0.5, 0.5, 0.5}},
        {.kind = CHANGE_LIGHT, .serial = 1, .numbers = {0, 0, 1, 2, 2, 2}},
        {.kind = CHANGE_DARK, .serial = 2},
        {.kind = CHANGE_TRANSFORM, .serial = 12345, .name = "nowhere"},
        {.kind = CHANGE_MATERIAL, .serial = 12345},
        {.kind = CHANGE_LIGHT, .serial = 12345},
    };
    for (int round = 0; round < 3; round++) {
        CHECK(changes_lay_over((struct change_range){changes, sizeof changes / sizeof *changes},
                               &(struct change_target){&maker, &s.scene, s.root, stage_lights(&s), s.light_count},
                               count_warning, &warnings, &changed, &error));
        CHECK_EQ_INT(group->child_count, 3);
        const struct node *cube = group->first_child->next->node, *copy = group->last_child->node;
        CHECK(cube->kind == NODE_GEOMETRY && cube->serial == UINT32_MAX && cube->shape.kind == SHAPE_BOX);
        CHECK_NEAR(affine_point(&cube->parent_from_node.forward, vec3_make(1, 1, 1)).x, 7, 0);
        CHECK(copy->kind == NODE_GROUP && copy->first_child->node == ball && copy->serial == UINT32_MAX - 1);
        CHECK(ball->singular);
        struct vec3 centre = affine_point(&ball->parent_from_node.forward, vec3_make(0, 0, 0));
        CHECK(centre.x == -2 && centre.y == 1 && centre.z == 10);
        CHECK(red->phong.kd.g == 1 && red->phong.kd.r == 0);
        CHECK(changed.light_count == 2 && changed.lights[0].light.position.z == 4 &&
              changed.lights[0].light.colour.r == 2);
        CHECK(changed.lights[1].light.position.x == 9 && changed.lights[1].light.colour.r == 0);
        changes_remove(&changed);
        CHECK(memcmp(&before, &ball->parent_from_node, sizeof before) == 0);
        CHECK(!ball->singular && group->child_count == 1 && group->last_child->node == ball);
        CHECK(group->last_child->next == NULL && red->phong.kd.r == 1 && s.lights[0].colour.r == 1);
        CHECK(s.scene.node_count == nodes && s.scene.material_count == materials);
    }
    CHECK_EQ_INT(warnings, 9);
    stage_end(&s);
}

TEST(changes_find_a_node_that_has_another_number_now_by_its_name_if_only_one_has_it) {
    static struct stage s;
    struct changed_scene changed;
    struct error error;
    int warnings = 0;
    stage_begin(&s, 1);
    struct material *gray = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
    struct node *a = stage_sphere(&s, s.root, gray), *b = stage_sphere(&s, s.root, gray);
    a->name = "left";
    b->name = "right";
    const struct change gone = {.kind = CHANGE_GONE, .serial = a->serial, .name = "right"};
    CHECK(changes_lay_over((struct change_range){&gone, 1}, &(struct change_target){NULL, &s.scene, s.root, NULL, 0},
                           count_warning, &warnings, &changed, &error));
    CHECK(b->singular && !a->singular);
    changes_remove(&changed);
    a->name = "right";
    a->serial = 1000;
    b->serial = 1001;
    CHECK(changes_lay_over((struct change_range){&gone, 1}, &(struct change_target){NULL, &s.scene, s.root, NULL, 0},
                           count_warning, &warnings, &changed, &error));
    CHECK(!b->singular && !a->singular);
    CHECK_EQ_INT(warnings, 1);
    changes_remove(&changed);
    stage_end(&s);
}

/* The same by calls of a script. */

#define SCENE_HEAD                                                                                                     \
    "local red = gr.material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20)\n"                                                  \
    "local r = gr.node('root')\nlocal ball = gr.geometry('ball', gr.sphere(red))\nr:add_child(ball)\n"                 \
    "local box = gr.geometry('box', gr.cube(gr.material({0.2, 0.5, 0.3}, {0, 0, 0}, 1)))\nbox:translate(-2, -1, -3)\n" \
    "r:add_child(box)\n"
#define SCENE_TAIL(eye, lights)                                                                                        \
    "gr.render(r, 'out.png', 60, 40, " eye ", {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2}, {" lights "})\n"
#define LIGHT "gr.light({4, 5, 6}, {0.5, 0.5, 0.5}, {1, 0, 0})"

static char *picture_of(const char *scene, const char *name, size_t *size) {
    struct test_result result = test_gray_scene(scene, "-q scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK_TEXT(result.err, "");
    test_free_result(&result);
    return test_read_file(test_path(name), size);
}

static void same_picture(const char *a, const char *b, bool same) {
    size_t size_a = 0, size_b = 0;
    char *first = picture_of(a, "out.png", &size_a), *second = picture_of(b, "out.png", &size_b);
    CHECK((first && second && size_a == size_b && memcmp(first, second, size_a) == 0) == same);
    free(first);
    free(second);
}

TEST(changes_by_calls_give_the_bytes_of_a_script_that_says_the_same_itself) {
    same_picture(SCENE_HEAD "ball:translate(1, 0.5, 0)\nbox:translate(1, 0, 0)\n" SCENE_TAIL("{0, 1, 6}", LIGHT),
                 SCENE_HEAD
                 "gr.change_node('ball', 2, {1, 0, 0, 1, 0, 1, 0, 0.5, 0, 0, 1, 0})\n"
                 "gr.change_node('box', 4, {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0})\n"
                 "gr.change_view('out.png', {0, 1, 6}, {0, 0, -1}, {0, 1, 0}, 40)\n"
                 "gr.change_view('other.png', {0, 1, 99}, {0, 0, -1}, {0, 1, 0}, 40)\n" SCENE_TAIL("{0, 0, 9}", LIGHT),
                 true);
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT ", gr.light({1, 2, 3}, {0.2, 0.2, 0.2}, {1, 0, 0})"),
                 SCENE_HEAD
                 "gr.change_add_light({1, 2, 3}, {0.2, 0.2, 0.2})\ngr.change_light(1, {1, 1, 1}, "
                 "{2, 2, 2})\n" SCENE_TAIL("{0, 0, 6}", "gr.light({3, 4, 5}, {0.25, 0.25, 0.25}, {1, 0, 0})"),
                 true);
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_delete('ball', 2)\n" SCENE_TAIL("{0, 0, 6}", LIGHT), false);
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_exposure('out.png', 0)\n" SCENE_TAIL("{0, 0, 6}", LIGHT), true);
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_exposure('out.png', 1)\n" SCENE_TAIL("{0, 0, 6}", LIGHT), false);
}

TEST(changes_hold_for_every_picture_and_leave_the_tree_of_the_script_as_it_is) {
    /* The second picture is made after the script has moved the ball itself: both moves count. */
    same_picture(SCENE_HEAD "ball:translate(1, 0, 0)\nball:translate(0, 1, 0)\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_node('ball', 2, {1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 0})\n" SCENE_TAIL(
                     "{0, 0, 6}", LIGHT) "ball:translate(1, 0, 0)\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                 true);
}

TEST(changes_of_a_node_that_moves_shift_its_whole_motion) {
    static const char tail[] = "r:render{file='out.png', width=60, height=40, eye={0, 0, 6}, view={0, 0, -1}, fov=40, "
                               "shutter={0, 1}, samples=4, lights={gr.light({4, 5, 6}, {0.5, 0.5, 0.5}, {1, 0, 0})}}\n";
    char one[4096], other[4096];
    (void)snprintf(one, sizeof one,
                   SCENE_HEAD "local there = gr.node('there'):translate(1.5, 0.5, 0)\nball:translate(0.5, 0.5, "
                              "0)\nball:moves_to(there)\n%s",
                   tail);
    (void)snprintf(other, sizeof other,
                   SCENE_HEAD "local there = gr.node('there'):translate(1, 0, 0)\nball:moves_to(there)\n"
                              "gr.change_node('ball', 2, {1, 0, 0, 0.5, 0, 1, 0, 0.5, 0, 0, 1, 0})\n%s",
                   tail);
    same_picture(one, other, true);
}

TEST(changes_of_missing_nodes_are_reported_once_and_left_out) {
    struct test_result result = test_gray_scene(
        SCENE_HEAD "gr.change_delete('no such', 77)\n" SCENE_TAIL("{0, 0, 6}", LIGHT) SCENE_TAIL("{0, 0, 6}", LIGHT),
        "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    const char *reported = strstr(result.err, "the node 'no such' (77) is skipped");
    CHECK(reported && !strstr(reported + 15, "the node"));
    test_free_result(&result);
}

TEST(reports_count_nodes_that_were_added_in_the_window_from_1) {
    struct test_result result =
        test_gray_scene(SCENE_HEAD "gr.change_add('root', 4294967295, 'cube', {1, 0, 0}, 0)\n"
                                   "gr.change_node('cube', 4294967295, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3})\n"
                                   "gr.change_node('cone', 4294967291, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 3})\n"
                                   "gr.change_material(2147483645, {1, 0, 0})\n"
                                   "gr.change_material(77, {1, 0, 0})\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                        "--pixel 30,20 scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    CHECK(strstr(result.out, "root#0 / added box#1, ") != NULL);
    CHECK(strstr(result.err, "an edit of the node 'cone' (added 5) is skipped: it no longer exists") != NULL);
    CHECK(strstr(result.err, "an edit of the material (own copy 3) is skipped") != NULL);
    CHECK(strstr(result.err, "an edit of the material (77) is skipped") != NULL);
    test_free_result(&result);
}

struct collected {
    char text[16384];
};
static bool collect(void *context, const char *line) {
    struct collected *c = context;
    strncat(c->text, line, sizeof c->text - strlen(c->text) - 1);
    return true;
}

TEST(edits_as_lua_text_are_read_back_to_the_bit) {
    static struct collected c;
    struct change_list list = {0};
    struct test_random random = {5};
    struct change changes[] = {
        {.kind = CHANGE_ADD,
         .name = "root",
         .call = "gr.cone{from = {0, 1, 0}, to = {0, -1, 0}}",
         .numbers = {0.1, 0.7, 1.0 / 3}},
        {.kind = CHANGE_TRANSFORM, .serial = UINT32_MAX, .name = "cone"},
        {.kind = CHANGE_TRANSFORM, .serial = 2, .name = "ba'l\\l\n"},
        {.kind = CHANGE_MATERIAL, .serial = 1, .numbers = {1.0 / 7, 2.0 / 7, 3.0 / 7}},
        {.kind = CHANGE_ADD_LIGHT,
         .call = "gr.light{position = {0, 0, 0}, colour = {1, 1, 1}}",
         .numbers = {0.3, 3, 1, 0.1, 0.2, 0.3}},
        {.kind = CHANGE_LIGHT,
         .serial = 1,
         .turns = true,
         .colours = true,
         .numbers = {0.1, 0.1, 0.1, 1.1, 1.1, 1.1, 0.1, 1, 0, 0, 0.1, 1, 1, 0, 0.1, 0.1, 0.3, 0.7}},
        {.kind = CHANGE_LIGHT, .serial = 2, .colours = true, .numbers = {0, 0, 0, 1, 1, 1, [COLOUR_AT] = 0.3}},
        {.kind = CHANGE_MATERIAL, .serial = 1, .part = MATERIAL_PART_ROUGHNESS, .numbers = {0.1}},
        {.kind = CHANGE_OWN, .serial = 2, .name = "ball", .source = 1},
        {.kind = CHANGE_ADD_LIGHT, .number = 1, .source = 1, .numbers = {0.1, 0, 0, 1, 1, 1}},
    };
    for (int i = 0; i < 12; i++) {
        changes[1].numbers[i] = (i % 5 == 0 ? 0.3 : 0) + test_uniform(&random, -0.1, 0.1);
        changes[2].numbers[i] = (i % 5 == 0 ? 1 : 0) + test_uniform(&random, -0.2, 0.2);
    }
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++)
        CHECK(change_list_set(&list, &changes[i], true));
    const struct camera camera = {{0.1, 0.2, 6.3}, {0.01, -0.02, -1.03}, {0, 1.0 / 3, 0}, 41.7};
    const double exposure = 1.0 / 3;
    CHECK(edits_write_lua(&list, "out.png", &camera, &exposure, collect, &c));
    CHECK(strstr(c.text, "'ba\\039l\\092l\\010'") != NULL);
    /* Read back by C, the numbers are unchanged. */
    const char *at = strstr(c.text, "gr.change_material(1, {");
    CHECK(at && strtod(at + strlen("gr.change_material(1, {"), NULL) == 1.0 / 7);
    /* Lua runs the file. */
    static char scene[20000];
    (void)snprintf(scene, sizeof scene, "local ball = gr.geometry('ba\\039l\\092l\\010', gr.sphere('s'))\n%s\n%s",
                   c.text, SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT));
    struct test_result result = test_gray_scene(scene, "scene.lua", NULL);
    CHECK_EQ_INT(result.status, 0);
    test_free_result(&result);
    change_list_destroy(&list);
}

/* Of a script, and of a model, which cannot require a file. */
TEST(edits_of_the_command_line_apply_to_scripts_and_models) {
    test_write_text(test_path("scene.lua"), SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT));
    test_write_text(test_path("ball.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    test_write_text(test_path("edits.lua"),
                    "gr.change_add_light({0, 9, 9}, {3, 3, 3})\ngr.change_add('', 1, 'gr.sphere{}')\n");
    const char *line =
        "{ echo \"require 'edits'\"; cat scene.lua; } >again.lua && $gray -q again.lua -o a.png && "
        "$gray -q scene.lua --edits edits.lua -o b.png && cmp a.png b.png && $gray -q scene.lua -o c.png && "
        "! cmp -s a.png c.png && $gray -q --size 64x48 --spp 1 ball.obj -o d.png && "
        "$gray -q --size 64x48 --spp 1 ball.obj --edits edits.lua -o e.png && ! cmp -s d.png e.png";
    CHECK_EQ_INT(test_run_shell(line, ">out.txt 2>err.txt"), 0);
    CHECK_EQ_INT(test_run_shell("$gray scene.lua --edits none.lua", ">out.txt 2>err.txt"), 1);
}

/* Clicks. */

TEST(camera_projects_a_point_to_where_its_ray_goes_through) {
    const struct camera camera = {{1, 2, 3}, {-0.3, -0.1, -1}, {0.1, 1, 0}, 50};
    struct test_random random = {11};
    for (int kind = 0; kind < 4; kind++) {
        struct settings settings = settings_default();
        struct camera_frame frame;
        struct error error;
        char warning[256];
        settings.lens.projection = (enum projection)kind;
        settings.lens.view_height = 5;
        settings.lens.angle = 200;
        settings.lens.shift_x = kind == PROJECTION_PANORAMA ? 0 : 0.1;
        settings.lens.shift_y = kind == PROJECTION_PANORAMA ? 0 : -0.05;
        CHECK(camera_prepare(&camera, &settings, (struct picture_size){200, 150}, &frame, warning, &error));
        for (int i = 0; i < 300; i++) {
            double x = test_uniform(&random, 40, 160), y = test_uniform(&random, 30, 120), u, v;
            struct ray ray;
            if (!camera_ray_through(&frame, x, y, (struct sample2){0.5, 0.5}, NULL, &ray))
                continue;
            CHECK(camera_project(&frame, vec3_add_scaled(ray.origin, ray.direction, test_uniform(&random, 0.5, 9)), &u,
                                 &v));
            CHECK_NEAR(u, x, 1e-9);
            CHECK_NEAR(v, y, 1e-9);
        }
    }
}

TEST(picking_returns_the_path_of_a_node_its_position_and_its_box) {
    static struct stage s;
    struct picked picked;
    stage_begin(&s, 1);
    struct material *red = stage_phong(&s, colour_make(1, 0.5, 0.25), colour_all(0), 1);
    struct node *group = stage_group(&s, s.root), *ball = stage_sphere(&s, group, red);
    group->name = "group";
    ball->name = "ball";
    stage_scale(&s, ball, 2, 2, 2);
    stage_move(&s, group, 0, 0, -1);
    struct node *other = stage_sphere(&s, group, red);
    stage_move(&s, other, 50, 0, 0);
    CHECK(stage_build(&s, s.root, ACCEL_AUTO));
    const struct render_job job = {
        .world = &s.world, .camera = s.camera, .settings = s.settings, .width = 100, .height = 80};
    CHECK(pick_at(&job, s.root, (struct pick_query){50, 40, 0}, &picked, &s.error));
    CHECK(picked.hit && strstr(picked.node_path, "/ group#") && strstr(picked.node_path, "/ ball#"));
    CHECK_TEXT(picked.name, "ball");
    CHECK_TEXT(picked.shape, "sphere");
    CHECK(picked.serial == ball->serial && picked.parent_serial == group->serial && picked.levels == 2);
    CHECK_NEAR(picked.distance, 9, 1e-9); /* from z = 10 to z = 1 */
    CHECK_NEAR(picked.position.z, 1, 1e-9);
    CHECK(picked.material_serial == red->serial && picked.inputs[MATERIAL_PART_KD][1] == 0.5 && picked.can_own);
    CHECK(picked.has_box);
    CHECK_NEAR(picked.corners[0].x, -2, 1e-12);
    CHECK_NEAR(picked.corners[7].z, 1, 1e-12);
    CHECK_NEAR(affine_point(&picked.world_from_parent, vec3_make(0, 0, 0)).z, -1, 1e-12);
    /* One level up: the group with all its descendants. */
    CHECK(pick_at(&job, s.root, (struct pick_query){50, 40, 1}, &picked, &s.error));
    CHECK_TEXT(picked.name, "group");
    CHECK_TEXT(picked.shape, "group");
    CHECK(picked.corners[7].x > 50.9 && picked.corners[7].x < 51.1 && picked.corners[0].x < -1.9);
    CHECK(pick_at(&job, s.root, (struct pick_query){50, 40, 99}, &picked, &s.error));
    CHECK_EQ_INT(picked.levels, 0);
    CHECK(pick_at(&job, s.root, (struct pick_query){1, 1, 0}, &picked, &s.error));
    CHECK(!picked.hit);
    stage_end(&s);
}

/* Textures replace ks, shininess and reflect of the base. */
TEST(picking_names_the_parts_of_a_material_that_change_nothing) {
    const uint32_t replaced = 1U << MATERIAL_PART_KS | 1U << MATERIAL_PART_SHININESS | 1U << MATERIAL_PART_REFLECT;
    for (int passes = 0; passes < 2; passes++) {
        for (int is_textured = 0; is_textured < 2; is_textured++) {
            static const enum material_input inputs[] = {INPUT_KS, INPUT_SHININESS, INPUT_REFLECT};
            static struct stage s;
            struct picked picked;
            stage_begin(&s, 1);
            struct material *material = stage_phong(&s, colour_make(1, 0.5, 0.25), colour_all(0.125), 9);
            material->phong.refract = 0.25 * passes;
            for (int i = 0; i < 3 && is_textured; i++)
                material->inputs[inputs[i]] = texture_keep(&s.scene.arena, texture_number(0.5), &s.error);
            stage_sphere(&s, s.root, material);
            CHECK(stage_build(&s, s.root, ACCEL_AUTO));
            const struct render_job job = {
                .world = &s.world, .camera = s.camera, .settings = s.settings, .width = 100, .height = 80};
            CHECK(pick_at(&job, s.root, (struct pick_query){50, 40, 0}, &picked, &s.error));
            CHECK(picked.hit);
            CHECK_EQ_INT(picked.idle_parts, is_textured ? replaced : 0);
            stage_end(&s);
        }
    }
}

/* Lights. */

static bool near(struct vec3 a, struct vec3 b) {
    return vec3_length(vec3_sub(a, b)) < 1e-12;
}

TEST(changes_turn_and_size_lights_about_their_position) {
    const double quarter[9] = {0, 0, 1, 0, 1, 0, -1, 0, 0}; /* z becomes x, x becomes -z */
    const double double_size[9] = {2, 0, 0, 0, 2, 0, 0, 0, 2};
    struct light sun = {.kind = LIGHT_DIRECTIONAL, .direction = {0, 0, 1}};
    light_turn(&sun, quarter);
    CHECK(near(sun.direction, vec3_make(1, 0, 0)));
    light_turn(&sun, double_size);
    CHECK(near(sun.direction, vec3_make(1, 0, 0)));
    struct light area = {.kind = LIGHT_PARALLELOGRAM,
                         .position = {1, 2, 3},
                         .corner = {0, 2, 2},
                         .edge1 = {2, 0, 0},
                         .edge2 = {0, 0, 2}};
    light_turn(&area, double_size);
    CHECK(near(area.position, vec3_make(1, 2, 3)) && near(area.corner, vec3_make(-1, 2, 1)));
    CHECK(near(area.edge1, vec3_make(4, 0, 0)) && near(area.edge2, vec3_make(0, 0, 4)));
    light_turn(&area, quarter);
    CHECK(near(area.corner, vec3_make(-1, 2, 5)) && near(area.edge1, vec3_make(0, 0, -4)));
    struct light ball = {.kind = LIGHT_SPHERE, .position = {1, 1, 1}, .radius = 0.5};
    light_turn(&ball, double_size);
    CHECK_NEAR(ball.radius, 1, 1e-15);
    CHECK(light_can_size(&ball) && !light_can_turn(&ball) && light_can_move(&ball));
    CHECK(light_can_turn(&sun) && !light_can_size(&sun) && !light_can_move(&sun));
}

TEST(changes_of_the_size_of_a_spot_keep_its_cone_a_cone) {
    for (double degrees = 1; degrees < 180; degrees += 7) {
        for (double size = 0.01; size < 200; size *= 3) {
            const double turn[9] = {size, 0, 0, 0, size, 0, 0, 0, size};
            double half = degrees * M_PI / 180, wanted = 2 * atan(size * tan(half / 2));
            struct light spot = {.kind = LIGHT_SPOT, .cos_inner = cos(half / 2), .cos_outer = cos(half)};
            light_turn(&spot, turn);
            CHECK_NEAR(spot.cos_outer, cos(wanted), 1e-12);
            CHECK(spot.cos_inner >= spot.cos_outer && spot.cos_inner <= 1 && spot.cos_outer >= -1);
        }
    }
}

TEST(changes_of_lights_by_calls_give_the_bytes_of_a_script_that_says_the_same_itself) {
    const char area[] = "gr.area_light({-1, 3, 1}, {2, 0, 0}, {0, 0, 2}, {0.4, 0.4, 0.4}, {1, 0, 0})";
    char one[4096], other[4096];
    (void)snprintf(one, sizeof one,
                   "%sgr.render(r, 'out.png', 60, 40, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0, 0, 0}, "
                   "{gr.area_light({-2, 3, 0}, {4, 0, 0}, {0, 0, 4}, {0.4, 0.4, 0.4}, {1, 0, 0}), "
                   "gr.directional_light{direction={1, 0, 0}, colour={0, 0.5, 1}}})\n",
                   SCENE_HEAD);
    (void)snprintf(other, sizeof other,
                   "%sgr.change_light(1, {0, 0, 0}, nil, {2, 0, 0, 0, 2, 0, 0, 0, 2})\n"
                   "gr.change_light(2, {0, 0, 0}, {2, 2, 2}, {0, 0, 1, 0, 1, 0, -1, 0, 0}, {0, 0.25, 0.5})\n"
                   "gr.render(r, 'out.png', 60, 40, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0, 0, 0}, {%s, "
                   "gr.directional_light{direction={0, 0, 1}, colour={1, 0, 0}}})\n",
                   SCENE_HEAD, area);
    same_picture(one, other, true);
}

TEST(changes_of_skies_and_suns_give_the_bytes_of_a_script_that_says_the_same_itself) {
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", "gr.sky_light{sky={0.25, 0.5, 1}, samples=2}, "
                                                    "gr.sun_light{sun={0, 0, 1}, colour={1, 0.5, 0.25}}"),
                 SCENE_HEAD
                 "gr.change_light(1, {5, 5, 5}, {2, 2, 2})\n" /* a sky has no place */
                 "gr.change_light(2, {0, 0, 0}, nil, {0, 0, 1, 0, 1, 0, -1, 0, 0}, {1, 0.5, 0.25})\n" SCENE_TAIL(
                     "{0, 0, 6}", "gr.sky_light{sky={0.125, 0.25, 0.5}, samples=2}, "
                                  "gr.sun_light{sun={-1, 0, 0}, colour={0.1, 0, 0}}"),
                 true);
    same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_delete_light(1)\ngr.change_delete_light(2)\n" SCENE_TAIL(
                     "{0, 0, 6}", "gr.sky_light{sky={0.125, 0.25, 0.5}, samples=2}, "
                                  "gr.sun_light{sun={-1, 0, 0}, colour={0.1, 0, 0}}, " LIGHT),
                 true);
}

#define SKY_SCENE(rotation, change, background)                                                                        \
    SCENE_HEAD "local function sky(turn) return gr.clear_sky{sun={0.6, 0.5, 1}, intensity=0.05, rotation=turn} end\n"  \
               "local s = sky(" rotation ")\n" change                                                                  \
               "gr.render{node=r, file='out.png', width=60, height=40, eye={0, 0, 6}, view={0, 0, -1}, up={0, 1, 0}, " \
               "fov=40, ambient={0, 0, 0}, lights={gr.sky_light{sky=s, samples=2}}, background=" background "}\n"

TEST(changes_that_turn_a_sky_give_the_bytes_of_a_script_that_turns_it_itself) {
    const char *turned = SKY_SCENE("90", "", "s");
    same_picture(turned, SKY_SCENE("0", "gr.change_light(1, {0, 0, 0}, nil, {0, 0, 1, 0, 1, 0, -1, 0, 0})\n", "s"),
                 true);
    same_picture(turned, SKY_SCENE("0", "", "s"), false);
    /* Of a rotation and a scale only the rotation about the y axis has an effect; the background turns too if it is the
     * same sky. */
    same_picture(turned, SKY_SCENE("-90", "gr.change_light(1, {0, 0, 0}, nil, {-3, 0, 0, 0, 2, 0, 0, 0, -3})\n", "s"),
                 true);
    same_picture(turned, SKY_SCENE("0", "gr.change_light(1, {0, 0, 0}, nil, {0, 0, 1, 0, 1, 0, -1, 0, 0})\n", "sky(0)"),
                 true);
    same_picture(SKY_SCENE("90", "", "sky(1)"),
                 SKY_SCENE("0", "gr.change_light(1, {0, 0, 0}, nil, {0, 0, 1, 0, 1, 0, -1, 0, 0})\n", "sky(1)"), true);
    same_picture(
        SKY_SCENE("90", "", "{0.1, 0.2, 0.3}"),
        SKY_SCENE("0", "gr.change_light(1, {0, 0, 0}, nil, {0, 0, 1, 0, 1, 0, -1, 0, 0})\n", "{0.1, 0.2, 0.3}"), true);
}

TEST(changes_copy_lights_of_every_kind) {
    static const char area[] = "gr.area_light({%g, 3, 1}, {2, 0, 0}, {0, 0, 2}, {0.2, 0.2, 0.2}, {1, 0, 0})";
    char one[4096], other[4096], first[200], second[200];
    (void)snprintf(first, sizeof first, area, -1.0);
    (void)snprintf(second, sizeof second, area, 1.5);
    (void)snprintf(
        one, sizeof one,
        SCENE_HEAD
        "local sun = gr.sun_light{sun={0, 0, 1}, colour={0.25, 0.25, 0.5}}\n"
        "gr.render(r, 'out.png', 60, 40, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0, 0, 0}, {%s, sun, %s, sun})\n",
        first, second);
    (void)snprintf(other, sizeof other,
                   SCENE_HEAD
                   "local sun = gr.sun_light{sun={0, 0, 1}, colour={0.25, 0.25, 0.5}}\n"
                   "gr.change_copy_light(1, {2.5, 0, 0})\ngr.change_copy_light(2, {0, 0, 0}, {1, 1, 1})\n"
                   "gr.render(r, 'out.png', 60, 40, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0, 0, 0}, {%s, sun})\n",
                   first);
    same_picture(one, other, true);
}

/* Materials. */

TEST(changes_of_every_part_of_a_material_give_the_bytes_of_a_script_that_says_the_same_itself) {
    static const struct {
        const char *in_script, *call;
    } parts[] = {
        {"{kd={0.1, 0.2, 0.3}, ks={0.4, 0.4, 0.4}, shininess=20}", "'kd', {0.1, 0.2, 0.3}"},
        {"{kd={0.8, 0.2, 0.1}, ks={0.1, 0.9, 0.4}, shininess=20}", "'ks', {0.1, 0.9, 0.4}"},
        {"{kd={0.8, 0.2, 0.1}, ks={0.4, 0.4, 0.4}, shininess=5}", "'shininess', 5"},
        {"{kd={0.8, 0.2, 0.1}, ks={0.4, 0.4, 0.4}, shininess=20, reflect=0.5}", "'reflect', 0.5"},
        {"{kd={0.8, 0.2, 0.1}, ks={0.4, 0.4, 0.4}, shininess=20, emission={0.3, 0, 0.1}}", "'emission', {0.3, 0, 0.1}"},
    };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        char one[4096], other[4096];
        (void)snprintf(one, sizeof one, "%slocal new = gr.material%s\nball:set_material(new)\n%s", SCENE_HEAD,
                       parts[i].in_script, SCENE_TAIL("{0, 0, 6}", LIGHT));
        (void)snprintf(other, sizeof other, "%sgr.change_look(1, %s)\n%s", SCENE_HEAD, parts[i].call,
                       SCENE_TAIL("{0, 0, 6}", LIGHT));
        same_picture(one, other, true);
        same_picture(SCENE_HEAD SCENE_TAIL("{0, 0, 6}", LIGHT), other, false);
    }
    same_picture(SCENE_HEAD
                 "ball:set_material(gr.rr_material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20, 0.1, 0.8, 1.5))\n" SCENE_TAIL(
                     "{0, 0, 6}", LIGHT),
                 SCENE_HEAD "gr.change_look(1, 'reflect', 0.1)\ngr.change_look(1, 'refract', 0.8)\n"
                            "gr.change_look(1, 'ior', 1.5)\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                 true);
}

TEST(changes_give_a_shape_a_material_of_its_own) {
    same_picture("local function red(kd) return gr.material(kd, {0.4, 0.4, 0.4}, 20) end\nlocal r = gr.node('root')\n"
                 "local a, b = gr.geometry('a', gr.sphere(red({0.8, 0.2, 0.1}))), gr.geometry('b', gr.sphere(red({0.1, "
                 "0.9, 0.1})))\na:translate(-1, 0, 0)\nb:translate(1, 0, 0)\nr:add_child(a)\nr:add_child(b)\n"
                 "local c = gr.geometry('c', gr.sphere(gr.material({0.2, 0.2, 1}, {0, 0, 0}, 1)))\nc:translate(0, 1.5, "
                 "0)\nr:add_child(c)\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                 "local m = gr.material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20)\nlocal r = gr.node('root')\n"
                 "local a, b, c = gr.geometry('a', gr.sphere(m)), gr.geometry('b', gr.sphere(m)), gr.geometry('c', "
                 "gr.sphere('s'))\na:translate(-1, 0, 0)\nb:translate(1, 0, 0)\nr:add_child(a)\nr:add_child(b)\n"
                 "c:translate(0, 1.5, 0)\nr:add_child(c)\n"
                 "gr.change_own('b', 3)\ngr.change_own('c', 6)\ngr.change_material(2147483647, {0.1, 0.9, "
                 "0.1})\ngr.change_material(2147483646, {0.2, 0.2, 1})\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
                 true); /* The decorators above the base stay, and other chains keep the old base. */
    same_picture(
        "local function glaze(kd) return gr.difresnel_material(gr.rr_material(kd, {0.4, 0.4, 0.4}, 20, 0, 0, 1.5)) "
        "end\n"
        "local r = gr.node('root')\nlocal a, b = gr.geometry('a', gr.sphere(glaze({0.8, 0.2, 0.1}))), "
        "gr.geometry('b', gr.sphere(glaze({0.1, 0.9, 0.1})))\n"
        "a:translate(-1, 0, 0)\nb:translate(1, 0, 0)\nr:add_child(a)\nr:add_child(b)\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
        "local m = gr.difresnel_material(gr.rr_material({0.8, 0.2, 0.1}, {0.4, 0.4, 0.4}, 20, 0, 0, 1.5))\nlocal r = "
        "gr.node('root')\n"
        "local a, b = gr.geometry('a', gr.sphere(m)), gr.geometry('b', gr.sphere(m))\n"
        "a:translate(-1, 0, 0)\nb:translate(1, 0, 0)\nr:add_child(a)\nr:add_child(b)\n"
        "gr.change_own('b', 4)\ngr.change_material(2147483647, {0.1, 0.9, 0.1})\n" SCENE_TAIL("{0, 0, 6}", LIGHT),
        true);
}

/* Operands of combined solids. */

struct forest {
    struct stage *stage;
    struct test_random random;
    struct material *material;
    struct node *nodes[4096]; /* by serial */
};

static struct node *grow(struct forest *f, int depth) {
    struct stage *s = f->stage;
    double what = test_uniform(&f->random, 0, 1);
    struct node *node;
    if (depth == 0 || what < 0.2) {
        node = stage_sphere(s, stage_group(s, s->root), f->material);
        s->root->last_child->node->singular = true; /* it is only in the solid */
        node->singular = test_uniform(&f->random, 0, 1) < 0.1;
    } else if (what < 0.35) {
        static const double positions[2][3] = {{-0.4, 0, 0}, {0.6, 0.1, 0}};
        static const struct placements twice = {.count = 2, .at = positions};
        node = scene_node(&s->scene, NODE_GROUP, "twice", &s->error);
        node->placements = &twice;
        CHECK(node_add_child(&s->scene, node, grow(f, depth - 1), &s->error));
    } else {
        struct node *operands[3] = {grow(f, depth - 1), grow(f, depth - 1), grow(f, depth - 1)};
        enum node_csg operation = (enum node_csg)(test_uniform(&f->random, 0, NODE_DIFFERENCE + 0.99));
        node = scene_combine(&s->scene, "solid", operation, operands, what < 0.7 ? 2 : 3, &s->error);
    }
    stage_move(s, node, test_uniform(&f->random, -0.6, 0.6), test_uniform(&f->random, -0.6, 0.6),
               test_uniform(&f->random, -0.3, 0.3));
    stage_rotate(s, node, depth % 3, test_uniform(&f->random, -180, 180));
    CHECK(node->serial < 4096);
    f->nodes[node->serial] = node;
    return node;
}

TEST(picking_goes_down_to_the_operand_whose_surface_was_hit) {
    static struct stage s;
    static struct forest f;
    int hits = 0;
    for (int round = 0; round < 12; round++) {
        stage_begin(&s, 1);
        f = (struct forest){.stage = &s, .random = {(uint64_t)round + 3}};
        f.material = stage_phong(&s, colour_all(0.5), colour_all(0), 1);
        struct node *parts[2] = {grow(&f, 3), grow(&f, 3)};
        struct node *whole = scene_combine(&s.scene, "whole", NODE_UNION, parts, 2, &s.error);
        f.nodes[whole->serial] = whole;
        CHECK(node_add_child(&s.scene, s.root, whole, &s.error) && stage_build(&s, s.root, ACCEL_AUTO));
        const struct render_job job = {
            .world = &s.world, .camera = s.camera, .settings = s.settings, .width = 100, .height = 100};
        for (int i = 0; i < 200; i++) {
            double x = test_uniform(&f.random, 25, 75), y = test_uniform(&f.random, 25, 75);
            struct picked picked, leaf, middle;
            CHECK(pick_at(&job, s.root, (struct pick_query){x, y, 0}, &picked, &s.error));
            CHECK(pick_at(&job, s.root, (struct pick_query){x, y, -1000}, &leaf, &s.error));
            CHECK(leaf.hit == picked.hit);
            if (!leaf.hit)
                continue;
            hits++;
            CHECK(picked.serial == whole->serial && picked.below > 0 && !picked.can_own);
            CHECK(leaf.below == 0 && leaf.up == -(int32_t)picked.below && leaf.can_own);
            CHECK_TEXT(leaf.shape, "sphere");
            /* The hit point lies on the unit sphere of that operand. */
            const struct node *node = f.nodes[leaf.serial];
            struct transform above;
            CHECK(node && transform_from_affine(&leaf.world_from_parent, &above));
            struct vec3 p = affine_point(&above.inverse, leaf.position);
            p = affine_point(&node->parent_from_node.inverse, p);
            CHECK_NEAR(vec3_length(p), 1, 1e-9);
            /* It is also in the box of every node in between. */
            int32_t up = -(int32_t)(test_uniform(&f.random, 0, picked.below + 0.99));
            CHECK(pick_at(&job, s.root, (struct pick_query){x, y, up}, &middle, &s.error));
            CHECK(middle.levels == picked.levels + (uint32_t)-up && middle.has_box);
            struct box box = box_empty();
            for (int corner = 0; corner < 8; corner++)
                box = box_join(box, (struct box){middle.corners[corner], middle.corners[corner]});
            for (int axis = 0; axis < 3; axis++)
                CHECK(vec3_get(leaf.position, axis) >= vec3_get(box.min, axis) - 1e-9 &&
                      vec3_get(leaf.position, axis) <= vec3_get(box.max, axis) + 1e-9);
        }
        stage_end(&s);
    }
    CHECK(hits > 200);
}

#define CUT                                                                                                            \
    "local function m(r, g, b) return gr.material({r, g, b}, {0.4, 0.4, 0.4}, 20) end\nlocal r = gr.node('root')\n"    \
    "local a, b = gr.geometry('a', gr.cube(m(0.8, 0.2, 0.1))), gr.geometry('b', gr.sphere(m(0.1, 0.8, 0.1)))\n"        \
    "local c = gr.geometry('c', gr.sphere(m(0.1, 0.1, 0.8)))\nb:translate(0.5, 0.5, 1)\nc:translate(1, 0, 0.2)\n"

TEST(changes_of_operands_give_the_bytes_of_a_script_that_says_the_same_itself) {
    static const char whole[] = "r:add_child(gr.csg_difference('cut', gr.csg_union('both', a, c), b))\n";
    char one[4096], other[4096];
    (void)snprintf(one, sizeof one, CUT "b:scale(0.5, 0.5, 0.5)\nb:translate(0.25, 0, 0)\n%s%s", whole,
                   SCENE_TAIL("{0, 0, 6}", LIGHT));
    (void)snprintf(other, sizeof other,
                   CUT "b:scale(0.5, 0.5, 0.5)\ngr.change_node('b', 4, {1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, 0})\n%s%s",
                   whole, SCENE_TAIL("{0, 0, 6}", LIGHT));
    same_picture(one, other, true);
    (void)snprintf(one, sizeof one, CUT "r:add_child(gr.csg_union('both', a, c))\n%s", SCENE_TAIL("{0, 0, 6}", LIGHT));
    (void)snprintf(other, sizeof other, CUT "gr.change_delete('b', 4)\n%s%s", whole, SCENE_TAIL("{0, 0, 6}", LIGHT));
    same_picture(one, other, true);
    (void)snprintf(one, sizeof one, CUT "r:add_child(gr.csg_difference('cut', c, b))\n%s",
                   SCENE_TAIL("{0, 0, 6}", LIGHT));
    (void)snprintf(other, sizeof other, CUT "gr.change_delete('a', 2)\n%s%s", whole, SCENE_TAIL("{0, 0, 6}", LIGHT));
    same_picture(one, other, true);
    (void)snprintf(other, sizeof other, CUT "gr.change_own('b', 4)\ngr.change_material(2147483647, {1, 1, 0})\n%s%s",
                   whole, SCENE_TAIL("{0, 0, 6}", LIGHT));
    (void)snprintf(one, sizeof one, CUT "b:set_material(m(1, 1, 0))\n%s%s", whole, SCENE_TAIL("{0, 0, 6}", LIGHT));
    same_picture(one, other, true);
}
