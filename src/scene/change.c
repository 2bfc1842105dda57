/* Every change records the previous state; removal goes backwards. Nodes are found by one traversal of the
 * distinct nodes under the root. */
#include "scene/change.h"

#include "base/mem.h"
#include "scene/traversal.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

/* The material of new shapes; its serial is 0. */
static struct material added_material(struct colour colour) {
    return (struct material){
        .kind = MATERIAL_PHONG, .depth = 1, .phong = {.kd = colour, .ks = colour_all(0.3), .shininess = 30, .ior = 1}};
}

/* The key that distinguishes changes of one kind. */
static uint64_t target_of(const struct change *change) {
    if (change->kind == CHANGE_MATERIAL)
        return (uint64_t)change->serial * MATERIAL_PART_PARTS + (uint64_t)change->part;
    if (change->kind == CHANGE_SOLO) /* there is one at most */
        return 0;
    bool counted = change->kind == CHANGE_ADD || change->kind == CHANGE_ADD_LIGHT || change->kind == CHANGE_OWN;
    return counted ? change->number : change->serial;
}

bool change_same_target(const struct change *a, const struct change *b) {
    return a->kind == b->kind && target_of(a) == target_of(b);
}

bool change_keeps_world(const struct change *change) {
    return change->kind == CHANGE_MATERIAL && material_part_keeps_world(change->part);
}

/* Of the first one that does not come before it. */
static uint32_t slot_in(const struct change_list *list, const struct change *like) {
    uint32_t i = 0;
    while (i < list->count && (list->items[i].kind < like->kind ||
                               (list->items[i].kind == like->kind && target_of(&list->items[i]) < target_of(like))))
        i++;
    return i;
}

bool change_list_set(struct change_list *list, const struct change *change, bool present) {
    uint32_t at = slot_in(list, change);
    bool there = at < list->count && change_same_target(&list->items[at], change);
    if (!present) {
        if (there) {
            memmove(list->items + at, list->items + at + 1, (list->count - at - 1) * sizeof *list->items);
            list->count--;
        }
        return true;
    }
    if (there) {
        list->items[at] = *change;
        return true;
    }
    /* The list stays sorted by targets, so that the order of changes does not matter. */
    if (list->count == list->room) {
        uint32_t room = list->room ? 2 * list->room : 16;
        struct change *more = room <= CHANGE_LIMIT ? mem_resize_array(list->items, room, sizeof *more) : NULL;
        if (!more)
            return false;
        list->items = more;
        list->room = room;
    }
    memmove(list->items + at + 1, list->items + at, (list->count - at) * sizeof *list->items);
    list->items[at] = *change;
    list->count++;
    return true;
}

const struct change *change_list_find(const struct change_list *list, const struct change *like) {
    uint32_t at = slot_in(list, like);
    return at < list->count && change_same_target(&list->items[at], like) ? &list->items[at] : NULL;
}

void change_list_destroy(struct change_list *list) {
    mem_free(list->items);
    *list = (struct change_list){0};
}

/* Finding nodes. */

static bool named(const struct node *node, const char *name) {
    return name[0] == '\0' || strncmp(node->name, name, CHANGE_NAME - 1) == 0;
}

/* The node of the last event as a mutable one: the reference of its parent. */
static struct node *found_node(const struct scene_traversal *t, struct node *root) {
    if (t->depth == 1)
        return root;
    const struct node *above = t->steps[t->depth - 2].node;
    uint32_t operand = scene_traversal_operand(t);
    if (operand != SCENE_CHILD)
        return above->operands[operand];
    const struct node_child *child = above->first_child;
    while (child->node != scene_traversal_node(t))
        child = child->next;
    return child->node;
}

/* The node with that number and name; if there is none, the only one with the name; else NULL. False: no memory. */
static bool find_node(const struct scene *scene, struct node *root, uint32_t serial, const char *name,
                      struct node **out) {
    struct scene_traversal t = {.operands = OPERANDS_ALL, .distinct = true};
    uint8_t *seen = mem_alloc_zero(scene->node_total, 1);
    struct node *exact = NULL, *only = NULL;
    uint32_t namesakes = 0;
    enum scene_event event = SCENE_NO_MEMORY;
    scene_traversal_begin(&t, root);
    while (seen && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        if (event != SCENE_ENTER)
            continue;
        if (seen[node->index]) {
            scene_traversal_skip(&t);
            continue;
        }
        seen[node->index] = 1;
        /* After an edit of the script serial numbers may differ: then the only node of that name. */
        if (node->serial == serial && named(node, name))
            exact = found_node(&t, root);
        if (name[0] != '\0' && named(node, name)) {
            only = found_node(&t, root);
            namesakes++;
        }
    }
    scene_traversal_end(&t);
    mem_free(seen);
    *out = exact ? exact : namesakes == 1 ? only : NULL;
    return event == SCENE_END;
}

/* Laying over. */

struct change_application {
    const struct change *change;
    struct scene *scene;
    struct node *root;
    const struct change_maker *maker;
    struct changed_scene *out;
    bool no_memory;
    change_warning *warn;
    void *context;
    struct error *error;
};

uint32_t added_number(uint32_t serial) {
    return serial > UINT32_MAX - CHANGE_LIMIT ? UINT32_MAX - serial + 1 : 0;
}

/* serial: of the object of the change, or the number of a light. */
static void report_missing(const struct change_application *l, const char *what, uint32_t serial) {
    char text[256], number[64];
    const char *name = l->change->name;
    if (added_number(serial) > 0)
        (void)snprintf(number, sizeof number, "added %u", added_number(serial));
    else if (l->change->kind == CHANGE_MATERIAL && serial <= OWN_SERIAL && serial > OWN_SERIAL - CHANGE_LIMIT)
        (void)snprintf(number, sizeof number, "own copy %u", OWN_SERIAL - serial + 1);
    else
        (void)snprintf(number, sizeof number, "%u", serial);
    if (name[0] != '\0')
        (void)snprintf(text, sizeof text, "an edit of %s '%s' (%s) is skipped: it no longer exists", what, name,
                       number);
    else
        (void)snprintf(text, sizeof text, "an edit of %s (%s) is skipped: it no longer exists", what, number);
    l->warn(l->context, text);
}

static struct node *added_node(const struct change_application *l, uint32_t serial) {
    for (uint32_t i = 0; i < l->out->added_count; i++) {
        if (l->out->added[i]->serial == serial)
            return l->out->added[i];
    }
    return NULL;
}

static struct node *node_of(struct change_application *l, uint32_t serial, const char *name) {
    struct node *node = added_node(l, serial);
    if (!node && !find_node(l->scene, l->root, serial, name, &node))
        l->no_memory = true;
    return node;
}

enum { SOLO_LEVELS = 64 };
enum { COMMON_PART = offsetof(struct node, joint_x) };

static struct changed_node *record(struct change_application *l, struct node *node) {
    struct changed_node *note = &l->out->nodes[l->out->node_count++];
    note->node = node;
    note->end = node->last_child;
    note->material = node->kind == NODE_GEOMETRY ? node->material : NULL;
    memcpy(&note->before, node, COMMON_PART);
    return note;
}

/* Records the state of the node. */
static struct node *begin_node(struct change_application *l) {
    struct node *node = node_of(l, l->change->serial, l->change->name);
    if (!node) {
        report_missing(l, "the node", l->change->serial);
        return NULL;
    }
    (void)record(l, node);
    return node;
}

/* Each node above the solo one has one child. Operands stay with their solids. */
static void leave_only(struct change_application *l) {
    struct scene_traversal t = {.operands = OPERANDS_AS_CHILD, .distinct = true};
    enum scene_event event;
    scene_traversal_begin(&t, l->root);
    while ((event = scene_traversal_next(&t)) < SCENE_END) {
        if (event == SCENE_ENTER && scene_traversal_node(&t)->serial == l->change->serial)
            break;
    }
    struct node *above = l->root;
    for (uint32_t i = 1; event < SCENE_END && i < t.depth && i < SOLO_LEVELS && above; i++) {
        struct node_child *child = above->first_child;
        while (child && child->node != t.steps[i].node)
            child = child->next;
        if (!child)
            break;
        struct changed_node *note = record(l, above);
        note->only.node = child->node;
        above->first_child = above->last_child = &note->only;
        above->child_count = 1;
        above = child->node;
    }
    if (event >= SCENE_END)
        report_missing(l, "the node", l->change->serial);
    scene_traversal_end(&t);
}

static void transform_node(struct change_application *l) {
    struct affine matrix;
    struct transform map;
    memcpy(matrix.m, l->change->numbers, sizeof matrix.m);
    struct node *node = begin_node(l);
    if (!node || !transform_from_affine(&matrix, &map))
        return;
    if (node->moves_to && node->moves_to != node) { /* the target of its motion is moved likewise */
        struct node *end = &l->out->nodes[l->out->node_count - 1].moved_end;
        struct transform from = node_parent_from_node(node->moves_to);
        *end = (struct node){.name = node->moves_to->name, .kind = NODE_GROUP};
        end->parent_from_node = transform_compose(&map, &from);
        node->moves_to = end;
    }
    node->parent_from_node = transform_compose(&map, &node->parent_from_node);
}

static struct vec3 three(const double *numbers) {
    return vec3_make(numbers[0], numbers[1], numbers[2]);
}

static struct colour colour_of(const double *numbers) {
    return colour_make(numbers[0], numbers[1], numbers[2]);
}

/* The object of the call; *made NULL: the call is wrong, which was reported. */
static bool make_object(struct change_application *l, void **made) {
    if (l->maker->make(l->maker->context, l->change, made, l->error))
        return true;
    *made = NULL;
    if (l->error->kind == ERROR_SCENE)
        l->warn(l->context, l->error->text);
    return l->error->kind == ERROR_SCENE;
}

/* A group over the node. The scene's own numbers are not used up, so that later nodes keep theirs. */
static struct node *copy_of(struct change_application *l, struct node *source) {
    uint32_t node_count = l->scene->node_count;
    struct node *node = scene_node(l->scene, NODE_GROUP, "copy", l->error);
    l->scene->node_count = node_count;
    return node && node_add_child(l->scene, node, source, l->error) ? node : NULL;
}

/* Its own, if the call gives the shape none. */
static bool give_material(struct change_application *l, struct added_node *made) {
    uint32_t material_count = l->scene->material_count;
    struct node *node = made->object;
    if (node->kind != NODE_GEOMETRY || node->material)
        return true;
    struct material *material = scene_material(l->scene, MATERIAL_PHONG, NULL, l->error);
    l->scene->material_count = material_count;
    if (!material)
        return false;
    material->phong = added_material(colour_of(l->change->numbers)).phong;
    material->serial = UINT32_MAX - l->change->number;
    node->material = made->material = material;
    return true;
}

/* The object of the change; *out NULL: its call is wrong. An existing one is reused: dragging an object
 * applies changes many times per second. */
static bool added_object(struct change_application *l, struct node *source, struct added_node **out) {
    const struct change *change = l->change;
    struct added_node *made = l->scene->added;
    while (made && (made->number != change->number || made->kind != (int)change->kind || made->source != source ||
                    strcmp(made->call, change->call) != 0))
        made = made->next;
    *out = made;
    if (made)
        return true;
    void *object = NULL;
    if (!source && (!make_object(l, &object) || !object))
        return object != NULL || l->error->kind == ERROR_SCENE;
    made = arena_alloc(&l->scene->arena, sizeof *made);
    const char *call = made ? arena_copy_text(&l->scene->arena, change->call, strlen(change->call)) : NULL;
    if (!call)
        return error_no_memory(l->error, "a node");
    *made = (struct added_node){change->number, (int)change->kind, call, source, object, NULL, l->scene->added};
    if (source && !(made->object = copy_of(l, source)))
        return false;
    bool node = change->kind == CHANGE_ADD;
    if (node && !source && !give_material(l, made))
        return false;
    if (node)
        ((struct node *)made->object)->serial = UINT32_MAX - change->number;
    l->scene->added = made;
    *out = made;
    return true;
}

static bool add_node(struct change_application *l) {
    struct node *source = NULL;
    struct added_node *made;
    if (l->change->call[0] == '\0' && !(source = node_of(l, l->change->source, ""))) {
        report_missing(l, "a copy under the node", l->change->serial);
        return true;
    }
    struct node *parent = begin_node(l);
    if (!parent)
        return true;
    if (!added_object(l, source, &made))
        return false;
    if (!made)
        return true;
    if (made->material)
        made->material->phong.kd = colour_of(l->change->numbers);
    if (!node_add_child(l->scene, parent, made->object, l->error))
        return false;
    l->out->added[l->out->added_count++] = made->object;
    return true;
}

static struct material *material_of(const struct change_application *l, uint32_t serial) {
    struct material *material = l->scene->last_material;
    while (material && material->serial != serial)
        material = material->older;
    return material;
}

static bool change_material(struct change_application *l) {
    struct material *material = material_of(l, l->change->serial);
    struct added_node *made;
    if (!material || material->base) {
        report_missing(l, "the material", l->change->serial);
        return true;
    }
    l->out->materials[l->out->material_count++] = (struct changed_material){material, *material};
    if (l->change->kind == CHANGE_MATERIAL)
        material_part_set(material, l->change->part, l->change->numbers);
    else if (!added_object(l, NULL, &made))
        return false;
    else if (made)
        material->inputs[INPUT_KD] = made->object;
    return true;
}

/* Own materials. */

/* The material of a shape without one (world/flatten_material.c). */
static const struct material plain = {
    .kind = MATERIAL_PHONG, .depth = 1, .phong = {.kd = {0.5, 0.5, 0.5}, .shininess = 1, .ior = 1}};

/* A chain of as many links, the base a material of the scene. */
static bool copy_links(struct change_application *l, const struct material *like, struct own_material *own) {
    uint32_t material_count = l->scene->material_count, count = 0;
    for (const struct material *link = like; link; link = link->base)
        count++;
    own->links = arena_alloc_array(&l->scene->arena, count, sizeof(struct material *));
    for (const struct material *link = like; own->links && link; link = link->base) {
        struct material *copy = link->base ? arena_alloc(&l->scene->arena, sizeof *copy)
                                           : scene_material(l->scene, MATERIAL_PHONG, NULL, l->error);
        l->scene->material_count = material_count;
        if (!copy)
            return false;
        if (own->count > 0)
            own->links[own->count - 1]->base = copy;
        own->links[own->count++] = copy;
    }
    return own->links != NULL;
}

/* A copy of the current `like`, link by link. An existing copy is reused. */
static const struct material *own_material(struct change_application *l, const struct material *like) {
    struct own_material *own = l->scene->own;
    uint32_t serial = OWN_SERIAL - l->change->number;
    while (own && (own->number != l->change->number || own->like != like))
        own = own->next;
    if (!own) {
        own = arena_alloc(&l->scene->arena, sizeof *own);
        if (!own || !copy_links(l, like, own)) {
            error_no_memory(l->error, "a material");
            return NULL;
        }
        own->number = l->change->number;
        own->like = like;
        own->next = l->scene->own;
        l->scene->own = own;
    }
    /* A serial number has one owner. */
    struct material *other = material_of(l, serial), *base = own->links[own->count - 1];
    if (other)
        other->serial = 0;
    /* Made anew each time: the material that it copies may have changed. */
    const struct material *link = like;
    for (uint32_t i = 0; i < own->count; i++, link = link->base) {
        struct material *copy = own->links[i], *older = copy->older;
        *copy = *link;
        copy->base = i + 1 < own->count ? own->links[i + 1] : NULL;
        copy->origin = i + 1 < own->count ? base : NULL;
        copy->older = older;
    }
    base->serial = serial;
    return own->links[0];
}

static bool give_own(struct change_application *l) {
    struct node *node = begin_node(l);
    if (!node)
        return true;
    if (node->kind != NODE_GEOMETRY) {
        report_missing(l, "the shape", l->change->serial);
        return true;
    }
    const struct material *like = node->material;
    if (!like && l->change->source != 0)
        like = material_of(l, l->change->source);
    node->material = own_material(l, like ? like : &plain);
    return node->material != NULL;
}

static void change_light(struct change_application *l) {
    const double *numbers = l->change->numbers;
    if (l->change->serial < 1 || l->change->serial > l->out->light_count) {
        report_missing(l, "the light", l->change->serial);
        return;
    }
    struct scene_light *changed = &l->out->lights[l->change->serial - 1];
    struct light *light = &changed->light;
    if (l->change->kind == CHANGE_DARK) {
        light->colour = colour_all(0);
        light->visible = false;
        return;
    }
    light_move(light, three(numbers));
    if (l->change->turns) {
        light_turn(light, numbers + TURN_AT);
        light_turn_sky(light, numbers + TURN_AT, &changed->sky_turn);
    }
    if (l->change->colours)
        light->colour = colour_of(numbers + COLOUR_AT);
    light->colour = colour_mul(light->colour, colour_of(numbers + 3));
}

/* A light that cannot be made is black, so that those after it keep their numbers. */
static bool add_light(struct change_application *l) {
    uint32_t number = l->out->light_count++, like = l->change->source;
    struct scene_light *added = &l->out->lights[number];
    struct added_node *made = NULL;
    *added = (struct scene_light){.light = {.kind = LIGHT_POINT, .falloff = {1, 0, 0}}};
    if (l->change->call[0] != '\0' && !added_object(l, NULL, &made))
        return false;
    if (made)
        *added = *(const struct scene_light *)made->object;
    else if (l->change->call[0] == '\0' && like >= 1 && like <= number)
        *added = l->out->lights[like - 1];
    else if (l->change->call[0] == '\0')
        report_missing(l, "a copy of the light", like);
    if (made && added->light.kind == LIGHT_SKY)
        l->out->sky = added->light.sky;
    light_move(&added->light, three(l->change->numbers));
    added->light.colour = colour_mul(added->light.colour, colour_of(l->change->numbers + 3));
    return true;
}

static bool lay(struct change_application *l) {
    struct node *node;
    switch (l->change->kind) {
    case CHANGE_TRANSFORM:
        transform_node(l);
        break;
    case CHANGE_GONE:
    case CHANGE_HIDDEN:
        if ((node = begin_node(l)))
            node->singular = true;
        break;
    case CHANGE_ADD:
        return add_node(l);
    case CHANGE_OWN:
        return give_own(l);
    case CHANGE_MATERIAL:
    case CHANGE_TEXTURE:
        return change_material(l);
    case CHANGE_LIGHT:
    case CHANGE_DARK:
        change_light(l);
        break;
    case CHANGE_ADD_LIGHT:
        return add_light(l);
    case CHANGE_SOLO:
        leave_only(l);
        break;
    case CHANGE_KINDS:
        break;
    }
    return !l->no_memory || error_no_memory(l->error, "the changes of the scene");
}

bool changes_lay_over(struct change_range changes, const struct change_target *target, change_warning *warn,
                      void *context, struct changed_scene *out, struct error *error) {
    uint32_t count = changes.count, light_count = target->light_count;
    *out = (struct changed_scene){.lights = mem_alloc_zero((size_t)light_count + count, sizeof *out->lights),
                                  .light_count = light_count,
                                  .nodes = mem_alloc_zero((size_t)count + SOLO_LEVELS, sizeof *out->nodes),
                                  .materials = mem_alloc_zero((size_t)count + 1, sizeof *out->materials),
                                  .added = mem_alloc_zero((size_t)count + 1, sizeof(struct node *))};
    struct change_application l = {.scene = target->scene,
                                   .root = target->root,
                                   .maker = target->maker,
                                   .out = out,
                                   .warn = warn,
                                   .context = context,
                                   .error = error};
    bool ok = out->lights && out->nodes && out->materials && out->added;
    if (!ok)
        error_no_memory(error, "the changes of the scene");
    if (ok && light_count > 0)
        memcpy(out->lights, target->lights, light_count * sizeof *out->lights);
    for (uint32_t i = 0; ok && i < count; i++) {
        l.change = &changes.items[i];
        ok = lay(&l);
    }
    if (!ok)
        changes_remove(out);
    return ok;
}

void changes_remove(struct changed_scene *changed) {
    for (uint32_t i = changed->node_count; i-- > 0;) {
        struct changed_node *note = &changed->nodes[i];
        memcpy(note->node, &note->before, COMMON_PART);
        if (note->node->kind == NODE_GEOMETRY)
            note->node->material = note->material;
        if (note->end)
            note->end->next = NULL;
    }
    for (uint32_t i = changed->material_count; i-- > 0;)
        *changed->materials[i].material = changed->materials[i].before;
    mem_free(changed->lights);
    mem_free(changed->nodes);
    mem_free(changed->materials);
    mem_free(changed->added);
    *changed = (struct changed_scene){0};
}

const struct material *changes_before(const struct changed_scene *changed, uint32_t serial) {
    for (uint32_t i = 0; i < changed->material_count; i++) {
        if (changed->materials[i].before.serial == serial)
            return &changed->materials[i].before;
    }
    return NULL;
}
