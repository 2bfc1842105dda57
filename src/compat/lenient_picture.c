/* Replacements of --lenient: a cube for a missing mesh, a checker pattern for a picture, and the root and
 * the camera of a picture that has none. */
#include "compat/lenient_picture.h"

#include "compat/lenient.h"
#include "math/elementary.h"
#include "scene/node_bounds.h"
#include "settings/settings.h"

#include <math.h>
#include <string.h>

struct node *lenient_placeholder(struct script_context *c, const char *name, const struct material *material,
                                 struct error *error) {
    struct node *node = scene_node(&c->scene, NODE_GEOMETRY, name, error);
    if (!node)
        return NULL;
    node->material = material;
    node->shape.kind = SHAPE_BOX;
    node->shape.box = (struct box){vec3_all(0), vec3_all(1)};
    return node;
}

static void release_image(void *image) {
    image_release(image);
}

struct image *lenient_checks(struct script_context *c, struct error *error) {
    enum { SQUARE = 8, WIDTH = 4 * SQUARE, HEIGHT = 3 * SQUARE };
    static const char key[] = "checks for missing pictures";
    struct image *image = assets_find_object(c->scene.assets, key);
    uint8_t pixels[HEIGHT][WIDTH][4];
    if (image)
        return image;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            bool light = ((x / (SQUARE / 2)) + (y / (SQUARE / 2))) % 2 == 0;
            memset(pixels[y][x], light ? 220 : 90, 3);
            pixels[y][x][3] = 255;
        }
    image = image_create("missing", WIDTH, HEIGHT, 8, pixels, error);
    return image && assets_add_object(c->scene.assets, key, image, release_image, error) ? image : NULL;
}

enum { DEPTH = 200 };

static bool is_unfit(const struct node *node, int depth, int *budget) {
    if (depth > DEPTH || --*budget < 0 || node_moves(node))
        return true;
    if (node->kind == NODE_GEOMETRY &&
        (node->shape.kind == SHAPE_MESH ? mesh_is_open(node->shape.mesh) : shape_why_open(&node->shape) != NULL))
        return true;
    for (const struct node_child *child = node->first_child; child; child = child->next)
        if (is_unfit(child->node, depth + 1, budget))
            return true;
    for (uint32_t k = 0; node->kind == NODE_CSG && k < node->operand_count; k++)
        if (is_unfit(node->operands[k], depth + 1, budget))
            return true;
    return node_is_placing(node);
}

void lenient_simplify(struct script_context *c) {
    const struct lenient *lenient = c->lenient;
    struct error ignored = {0};
    for (uint32_t i = 0; i < lenient->node_count; i++) {
        struct node *node = lenient->nodes[i];
        bool unfit = false;
        int budget = 10000;
        if (node->kind != NODE_CSG)
            continue;
        for (uint32_t k = 0; k < node->operand_count; k++)
            unfit = unfit || is_unfit(node->operands[k], 0, &budget);
        uint32_t kept = node->operation == NODE_UNION || node->operation == NODE_INTERSECTION ? node->operand_count : 1;
        for (uint32_t k = 0; unfit && k < kept; k++)
            (void)node_add_child(&c->scene, node, node->operands[k], &ignored);
        if (unfit)
            node->kind = NODE_GROUP;
    }
}

enum { FIELD_OF_VIEW = 40 };

void lenient_camera(const struct node *root, struct camera *camera) {
    struct box box;
    struct error ignored = {0};
    struct vec3 from = vec3_normalize(vec3_make(0.4, 0.35, 1));
    bool has_box = node_bounds(root, &box, &ignored) && !box_is_empty(&box);
    struct vec3 middle = has_box ? vec3_scale(vec3_add(box.min, box.max), 0.5) : vec3_all(0);
    double radius = has_box ? 0.5 * vec3_length(vec3_sub(box.max, box.min)) : 1;
    if (!isfinite(radius) || radius > 1e15)
        radius = 10, middle = vec3_all(0);
    if (!(radius > 0))
        radius = 1;
    *camera = (struct camera){.eye = vec3_add_scaled(middle, from, radius / el_sin(FIELD_OF_VIEW * (PI / 360))),
                              .view = vec3_negate(from),
                              .up = {0, 1, 0},
                              .fov = FIELD_OF_VIEW};
}

static bool has_extent(const struct node *node) {
    struct box box;
    struct error ignored = {0};
    return node_bounds(node, &box, &ignored) && !box_is_empty(&box);
}

static bool holds(const struct node *node, const struct node *part) {
    for (const struct node_child *child = node->first_child; child; child = child->next)
        if (child->node == part)
            return true;
    for (uint32_t k = 0; node->kind == NODE_CSG && k < node->operand_count; k++)
        if (node->operands[k] == part)
            return true;
    return false;
}

/* A node that was made and holds this one, or NULL. */
static struct node *parent_of(const struct lenient *lenient, const struct node *node) {
    for (uint32_t i = lenient->node_count; i-- > 0;)
        if (holds(lenient->nodes[i], node))
            return lenient->nodes[i];
    return NULL;
}

struct node *lenient_root(struct script_context *c) {
    enum { STEPS = 100, LOOKED_AT = 1000 };
    const struct lenient *lenient = c->lenient;
    if (lenient->root && has_extent(lenient->root))
        return lenient->root;
    struct node *root = lenient->last;
    for (int step = 0; root && step < STEPS; step++) {
        struct node *parent = parent_of(lenient, root);
        if (!parent)
            break;
        root = parent;
    }
    if (root && has_extent(root))
        return root;
    for (uint32_t i = lenient->node_count, n = 0; i-- > 0 && n < LOOKED_AT; n++)
        if (!parent_of(lenient, lenient->nodes[i]) && has_extent(lenient->nodes[i]))
            return lenient->nodes[i];
    return NULL;
}
