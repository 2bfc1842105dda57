/* The tree of nodes as a window lists it, and selecting in it. */
#include "inspect/pick.h"
#include "tests/harness.h"
#include "tests/stage.h"

#include <stdio.h>
#include <string.h>

TEST(node_list_has_the_children_in_parts) {
    enum { COUNT = 70 };
    struct stage s;
    struct node_rows rows;
    uint32_t seen = 0;
    stage_begin(&s, 1);
    for (int i = 0; i < COUNT; i++)
        (void)stage_group(&s, s.root);
    const struct node_query above = {0};
    node_list_rows(s.root, &above, &rows);
    CHECK(rows.count == 1 && rows.rows[0].serial == s.root->serial && rows.rows[0].children == COUNT);
    CHECK_TEXT(rows.rows[0].kind, "group");
    struct node_query query = {.depth = 1};
    for (; query.first < 3 * NODE_ROWS; query.first += NODE_ROWS) {
        node_list_rows(s.root, &query, &rows);
        for (uint32_t i = 0; i < rows.count; i++, seen++) {
            const struct node_query one = {.depth = 2, .path = {0, query.first + i}};
            CHECK(node_list_find(s.root, &one)->serial == rows.rows[i].serial);
        }
    }
    CHECK_EQ_INT(seen, COUNT);
    const struct node_query none = {.depth = 2, .path = {0, COUNT}}, other = {.depth = 1, .path = {1}};
    CHECK(!node_list_find(s.root, &none) && !node_list_find(s.root, &other) && !node_list_find(s.root, &above));
    stage_end(&s);
}

TEST(a_node_selected_in_the_tree_is_what_a_click_on_it_selects) {
    struct stage s;
    struct picked clicked, chosen;
    stage_begin(&s, 1);
    struct node *group = stage_group(&s, s.root);
    stage_move(&s, stage_sphere(&s, group, stage_phong(&s, colour_all(0.5), colour_all(0), 1)), 3, 0, 0);
    (void)stage_sphere(&s, group, stage_phong(&s, colour_make(0.1, 0.2, 0.3), colour_all(0), 1));
    stage_rotate(&s, group, 1, 20);
    CHECK(stage_render(&s, 32, 32));
    struct render_job job = stage_job(&s, 32, 32);
    for (int32_t up = 0; up < 3; up++) {
        const struct node_query query = {.depth = (uint32_t)(3 - up), .path = {0, 0, 1}};
        CHECK(pick_at(&job, s.root, (struct pick_query){16, 16, up}, &clicked, &s.error) && clicked.hit);
        CHECK(pick_node(&job, s.root, &query, &chosen, &s.error) && chosen.hit);
        CHECK(clicked.serial == chosen.serial && clicked.route == chosen.route && clicked.levels == chosen.levels);
        CHECK_TEXT(clicked.node_path, chosen.node_path);
        CHECK_TEXT(clicked.shape, chosen.shape);
        CHECK(clicked.can_own == chosen.can_own && chosen.has_box);
        CHECK(up > 0 || clicked.material_serial == chosen.material_serial);
        CHECK(memcmp(clicked.corners, chosen.corners, sizeof chosen.corners) == 0);
        CHECK(memcmp(&clicked.world_from_parent, &chosen.world_from_parent, sizeof chosen.world_from_parent) == 0);
    }
    const struct node_query none = {.depth = 3, .path = {0, 0, 2}};
    CHECK(pick_node(&job, s.root, &none, &chosen, &s.error) && !chosen.hit);
    stage_end(&s);
}
