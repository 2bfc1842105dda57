/* A node of the scene is a node of the file, with the mesh of its primitive; further placements of a node are further
 * nodes with the same mesh. A node of a file has a translation, a rotation and a scale: other maps are two nodes, by
 * the singular value decomposition (one-sided Jacobi: Golub and Van Loan, "Matrix Computations", 8.6.3).
 *
 * The file has lumens where the scene has light: 683 of them count for a watt, as in files of Blender, and a white
 * surface that faces a light of colour 1 has the radiance 1 (script/gr_model.c reads lights so). */
#include "export/gltf_write.h"

#include "base/arena.h"
#include "base/hash.h"
#include "export/gltf_paint_internal.h"
#include "light/light.h"
#include "math/elementary.h"
#include "math/frame.h"
#include "world/node_path.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static const double lumens = 683 * PI; /* of a light of colour 1 */

struct pose {
    double move[3], turn[4], size[3]; /* turn: a unit quaternion, x y z w */
};
struct key {
    double time;
    struct pose pose;
};

struct out_node {
    const char *name;
    uint32_t first_child, last_child, next; /* or GLTF_NONE */
    uint32_t mesh, camera, light;           /* likewise */
    struct pose pose;
    bool is_sheared;               /* the next node is the other part of its map */
    uint32_t mesh_nodes;           /* so many nodes behind it are meshes of the same node */
    const struct transform *below; /* its mesh is in a space of its own; or NULL */
    struct list keys;              /* struct key; empty: it stands still */
    struct key last;               /* of the moments so far */
};

/* What the file lacks, counted. */
struct lack {
    const char *what, *name; /* name: of the first thing, or "" */
    size_t count;
};

struct gltf_scene {
    struct gltf_options options;
    struct gltf_file file;
    struct gltf_painter painter;
    struct arena arena;
    struct list nodes, roots, lacks; /* struct out_node, uint32_t, struct lack */
    struct key_map meshes, images;   /* by shape and material: numbers of meshes */
    uint32_t moments, cursor;        /* the node of the next place in a later moment */
    bool differs;                    /* that moment has other nodes */
};

/* A moment that is being added. */
struct visit {
    struct gltf_scene *scene;
    const struct gltf_moment *moment;
    struct error *error;
    bool ok;
};

struct gltf_scene *gltf_scene_create(const struct gltf_options *options) {
    struct gltf_scene *scene = mem_alloc_zero(1, sizeof *scene);
    if (scene)
        scene->options = *options;
    return scene;
}

static struct out_node *node_at(const struct gltf_scene *scene, uint32_t node) {
    return (struct out_node *)scene->nodes.items + node;
}

void gltf_scene_destroy(struct gltf_scene *scene) {
    if (!scene)
        return;
    for (uint32_t i = 0; i < scene->nodes.count; i++)
        list_destroy(&node_at(scene, i)->keys);
    list_destroy(&scene->nodes);
    list_destroy(&scene->roots);
    list_destroy(&scene->lacks);
    key_map_destroy(&scene->meshes);
    key_map_destroy(&scene->images);
    gltf_file_destroy(&scene->file);
    arena_destroy(&scene->arena);
    mem_free(scene);
}

/* --- what is left out --- */

static void lacks(void *context, const char *what, const char *name) {
    struct gltf_scene *scene = context;
    struct lack *list = scene->lacks.items;
    for (size_t i = 0; i < scene->lacks.count; i++)
        if (strcmp(list[i].what, what) == 0) {
            list[i].count++;
            return;
        }
    struct lack lack = {what, arena_copy_text(&scene->arena, name, strlen(name)), 1};
    scene->file.failed = !lack.name || !list_add(&scene->lacks, &lack, 1, sizeof lack) || scene->file.failed;
}

void gltf_scene_report(const struct gltf_scene *scene, void (*warn)(void *context, const char *text), void *context) {
    const struct lack *lack = scene->lacks.items;
    for (size_t i = 0; i < scene->lacks.count; i++) {
        char text[400], more[40] = "";
        bool named = lack[i].name[0] != '\0';
        if (named && lack[i].count > 1)
            (void)snprintf(more, sizeof more, " and %zu more", lack[i].count - 1);
        (void)snprintf(text, sizeof text, "%s%.100s%s%s%s%s", named ? "'" : "", lack[i].name, named ? "'" : "", more,
                       named ? ": " : "", lack[i].what);
        warn(context, text);
    }
}

/* --- poses --- */

static struct vec3 column(const struct affine *map, int k) {
    return vec3_make(map->m[0][k], map->m[1][k], map->m[2][k]);
}

static struct affine of_columns(const struct vec3 c[3], struct vec3 move) {
    return (struct affine){
        {{c[0].x, c[1].x, c[2].x, move.x}, {c[0].y, c[1].y, c[2].y, move.y}, {c[0].z, c[1].z, c[2].z, move.z}}};
}

/* Of a rotation by its columns. */
static void quaternion_of(const struct vec3 columns[3], double out[4]) {
    const struct affine turn = of_columns(columns, vec3_all(0));
    affine_quaternion(&turn, out);
    double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2] + out[3] * out[3]);
    for (int n = 0; n < 4; n++)
        out[n] = out[n] / length + 0.0;
}

/* Turns the columns of `left` until they are at right angles; `right` is turned with them. */
static void jacobi(struct vec3 left[3], struct vec3 right[3]) {
    for (int step = 0; step < 60; step++) {
        int i = step % 3, k = (i + 1) % 3;
        double a = vec3_length_squared(left[i]), b = vec3_length_squared(left[k]), c = vec3_dot(left[i], left[k]);
        if (fabs(c) <= 1e-15 * sqrt(a * b))
            continue;
        double zeta = (b - a) / (2 * c), t = (zeta < 0 ? -1 : 1) / (fabs(zeta) + sqrt(1 + zeta * zeta));
        double cosine = 1 / sqrt(1 + t * t), sine = cosine * t;
        struct vec3 *sides[2] = {left, right};
        for (int s = 0; s < 2; s++) {
            struct vec3 x = sides[s][i], y = sides[s][k];
            sides[s][i] = vec3_add_scaled(vec3_scale(x, cosine), y, -sine);
            sides[s][k] = vec3_add_scaled(vec3_scale(y, cosine), x, sine);
        }
    }
}

/* The map as outer after inner, which is the identity unless the map shears. False: it does. */
static bool pose_of(const struct affine *map, struct pose *outer, struct pose *inner) {
    struct vec3 left[3] = {column(map, 0), column(map, 1), column(map, 2)};
    struct vec3 right[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    bool is_plain = true;
    for (int i = 0; i < 3; i++) {
        struct vec3 a = left[i], b = left[(i + 1) % 3];
        is_plain = is_plain && fabs(vec3_dot(a, b)) <= 1e-12 * sqrt(vec3_length_squared(a) * vec3_length_squared(b));
    }
    *inner = (struct pose){.turn = {0, 0, 0, 1}, .size = {1, 1, 1}};
    if (!is_plain)
        jacobi(left, right);
    for (int i = 0; i < 3; i++) {
        double size = vec3_length(left[i]);
        outer->move[i] = map->m[i][3] + 0.0;
        outer->size[i] = i == 0 && affine_determinant(map) < 0 ? -size : size;
        left[i] = vec3_scale(left[i], 1 / outer->size[i]);
    }
    quaternion_of(left, outer->turn);
    if (!is_plain) {
        quaternion_of(right, inner->turn);
        inner->turn[3] = 0.0 - inner->turn[3]; /* the turn back */
    }
    return is_plain;
}

static bool pose_is(const struct pose *a, const struct pose *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

/* Poses between keys are linear: a node that stands still has no keys, or those before and after. */
static void add_key(struct gltf_scene *scene, uint32_t node, double time, struct pose pose) {
    struct out_node *at = node_at(scene, node);
    const double *last = at->last.pose.turn;
    double along = 0;
    bool ok = true;
    for (int i = 0; i < 4; i++)
        along += last[i] * pose.turn[i];
    for (int i = 0; along < 0 && i < 4; i++)
        pose.turn[i] = -pose.turn[i];
    if (!pose_is(&at->last.pose, &pose)) {
        const struct key *keys = at->keys.items, key = {time, pose};
        if (at->keys.count == 0 || keys[at->keys.count - 1].time < at->last.time)
            ok = list_add(&at->keys, &at->last, 1, sizeof key);
        ok = ok && list_add(&at->keys, &key, 1, sizeof key);
    }
    at->last = (struct key){time, pose};
    scene->file.failed = !ok || scene->file.failed;
}

static uint32_t new_node(struct gltf_scene *scene, uint32_t parent, const char *name, struct pose pose, double time) {
    struct out_node own = {.name = arena_copy_text(&scene->arena, name, strlen(name)),
                           .first_child = GLTF_NONE,
                           .last_child = GLTF_NONE,
                           .next = GLTF_NONE,
                           .mesh = GLTF_NONE,
                           .camera = GLTF_NONE,
                           .light = GLTF_NONE,
                           .pose = pose,
                           .last = {time, pose}};
    uint32_t number = (uint32_t)scene->nodes.count;
    if (!own.name || !list_add(&scene->nodes, &own, 1, sizeof own) ||
        (parent == GLTF_NONE && !list_add_index(&scene->roots, number))) {
        scene->file.failed = true;
        return 0;
    }
    if (parent != GLTF_NONE) {
        struct out_node *above = node_at(scene, parent);
        if (above->first_child == GLTF_NONE)
            above->first_child = number;
        else
            node_at(scene, above->last_child)->next = number;
        above->last_child = number;
    }
    return number;
}

/* The next node below another one, in a later moment the same; the node that is placed so is *inner. */
static uint32_t node_for(const struct visit *visit, uint32_t parent, const char *name, const struct affine *map,
                         uint32_t *inner) {
    struct gltf_scene *scene = visit->scene;
    const double time = visit->moment->time;
    struct pose parts[2];
    bool is_plain = pose_of(map, &parts[0], &parts[1]);
    uint32_t number = scene->cursor;
    *inner = number;
    if (scene->moments == 0) {
        number = *inner = new_node(scene, parent, name, parts[0], time);
        if (!is_plain && !scene->file.failed) {
            node_at(scene, number)->is_sheared = true;
            *inner = new_node(scene, number, name, parts[1], time);
        }
        return number;
    }
    if (number >= scene->nodes.count || strcmp(node_at(scene, number)->name, name) != 0) {
        scene->differs = true;
        *inner = 0;
        return 0;
    }
    add_key(scene, number, time, parts[0]);
    *inner += node_at(scene, number)->is_sheared;
    if (*inner > number)
        add_key(scene, *inner, time, parts[1]);
    else if (!is_plain)
        lacks(scene, "it is sheared in the animation, which is left out", name);
    scene->cursor = *inner + 1;
    return number;
}

/* --- meshes --- */

static uint32_t add_attribute(struct gltf_file *file, const struct gltf_surface *s, size_t offset, int width) {
    const size_t count = s->vertices.count;
    float *numbers = mem_alloc((count * (size_t)width + 1) * sizeof *numbers);
    if (!numbers) {
        file->failed = true;
        return GLTF_NONE;
    }
    for (size_t i = 0; i < count; i++) {
        memcpy(numbers + i * (size_t)width, (const char *)&gltf_vertices(s)[i] + offset, (size_t)width * sizeof(float));
        if (offset == offsetof(struct gltf_vertex, uv)) /* v from above */
            numbers[2 * i + 1] = 1 - numbers[2 * i + 1];
    }
    uint32_t accessor = gltf_add_floats(file, numbers, count, width, GLTF_VERTICES);
    mem_free(numbers);
    return accessor;
}

/* The directions of u, at right angles to the normals: the last number is -1 where v runs to their right. */
static uint32_t add_tangents(struct gltf_file *file, const struct gltf_surface *s) {
    const struct gltf_vertex *all = gltf_vertices(s);
    struct vec3 *sums = mem_alloc_zero(2 * s->vertices.count + 1, sizeof *sums); /* along u, and along v */
    float *out = mem_alloc((4 * s->vertices.count + 1) * sizeof *out);
    uint32_t accessor = GLTF_NONE;
    for (size_t i = 0; sums && i < s->triangles.count; i++) {
        const uint32_t *v = gltf_triangles(s)[i].vertex;
        struct vec3 along[2];
        gltf_directions(s, &gltf_triangles(s)[i], NULL, along);
        for (uint32_t k = 0; k < 6; k++) {
            struct vec3 *sum = &sums[2 * v[k / 2] + k % 2];
            *sum = vec3_add(*sum, along[k % 2]);
        }
    }
    for (size_t i = 0; sums && out && i < s->vertices.count; i++) {
        struct vec3 n = gltf_point(all[i].normal), other;
        struct vec3 t = vec3_add_scaled(sums[2 * i], n, -vec3_dot(n, sums[2 * i]));
        if (vec3_max_abs(t) > 0)
            t = vec3_normalize(t);
        else
            frame_tangents(n, &t, &other);
        for (int k = 0; k < 3; k++)
            out[4 * i + (size_t)k] = (float)vec3_get(t, k);
        out[4 * i + 3] = vec3_dot(vec3_cross(n, t), sums[2 * i + 1]) < 0 ? -1 : 1;
    }
    file->failed = file->failed || !sums || !out;
    if (sums && out)
        accessor = gltf_add_floats(file, out, s->vertices.count, 4, GLTF_VERTICES);
    mem_free(sums);
    mem_free(out);
    return accessor;
}

/* The triangles of one material. */
static void put_primitive(struct gltf_scene *scene, const struct gltf_surface *s, const struct gltf_paint *paint,
                          uint32_t material, struct gltf_text *text) {
    struct list indices = {0};
    struct gltf_attributes uses;
    bool ok = true;
    uint32_t number = gltf_paint_material(&scene->painter, material, s, paint, &uses);
    for (size_t i = 0; ok && i < s->triangles.count; i++) {
        const struct gltf_triangle *t = &gltf_triangles(s)[i];
        ok = t->material != material || list_add(&indices, t->vertex, 3, sizeof *t->vertex);
    }
    gltf_put(text, "{'attributes':{'POSITION':%u",
             add_attribute(&scene->file, s, offsetof(struct gltf_vertex, point), 3));
    if (s->has_normals || uses.tangents)
        gltf_put(text, "'NORMAL':%u", add_attribute(&scene->file, s, offsetof(struct gltf_vertex, normal), 3));
    if (uses.uv)
        gltf_put(text, "'TEXCOORD_0':%u", add_attribute(&scene->file, s, offsetof(struct gltf_vertex, uv), 2));
    if (uses.tangents)
        gltf_put(text, "'TANGENT':%u", add_tangents(&scene->file, s));
    if (uses.colours)
        gltf_put(text, "'COLOR_0':%u", add_attribute(&scene->file, s, offsetof(struct gltf_vertex, colour), 3));
    gltf_put(text, "},'indices':%u,'material':%u}",
             gltf_add_indices(&scene->file, indices.items, indices.count, (uint32_t)s->vertices.count), number);
    list_destroy(&indices);
    scene->file.failed = !ok || scene->file.failed;
}

static uint32_t put_mesh(struct gltf_scene *scene, const struct gltf_surface *s, const struct gltf_paint *paint,
                         const char *name) {
    struct key_map seen = {0};
    struct gltf_text text = {0};
    bool ok = true;
    gltf_put(&text, "{'name':%s,'primitives':[", name);
    for (size_t i = 0; i < s->triangles.count; i++) {
        uint32_t material = gltf_triangles(s)[i].material;
        if (key_map_find(&seen, material + 1ULL))
            continue;
        ok = key_map_add(&seen, material + 1ULL, 0) && ok;
        put_primitive(scene, s, paint, material, &text);
    }
    gltf_put(&text, "]}");
    uint32_t mesh = gltf_add(&scene->file, GLTF_MESHES, &text);
    list_destroy(&text.bytes);
    key_map_destroy(&seen);
    scene->file.failed = !ok || scene->file.failed;
    return mesh;
}

/* Equal primitives have equal keys. Those in a space of their own differ by where they are only if a texture does. */
static uint64_t key_of_primitive(const struct gltf_scene *scene, uint32_t primitive) {
    const struct world *world = scene->painter.world;
    const struct prototype *prototype = primitive_prototype(world, primitive);
    struct transform unused;
    const uint32_t numbers[] = {prototype->material, prototype->slot_count, prototype->geometry.shape.kind,
                                prototype->geometry.csg ? world->primitives[primitive].prototype : 0};
    uint64_t hash = hash_bytes(numbers, sizeof numbers, 1);
    bool is_plain =
        gltf_surface_is_unit(&prototype->geometry, &unused) && world->surfaces.materials[prototype->material].plain;
    return (is_plain ? hash : hash_bytes(&prototype->geometry.shape, sizeof(struct shape), hash)) | 1;
}

/* The number of the mesh of a primitive, or GLTF_NONE: it is left out. */
static uint32_t mesh_of(struct visit *visit, uint32_t primitive) {
    struct gltf_scene *scene = visit->scene;
    const struct world *world = scene->painter.world;
    const char *name = primitive_node(world, primitive)->name;
    const uint64_t key = key_of_primitive(scene, primitive);
    const uint32_t *known = key_map_find(&scene->meshes, key);
    const struct box *box = &world->boxes[primitive];
    double size = vec3_max_abs(vec3_sub(box->max, box->min)), wanted = scene->options.tolerance;
    const struct box all = world_finite_bounds(world);
    double share = wanted > 0 && size > 0 ? math_min(math_max(wanted / size, 1e-6), 0.1) : 1e-3;
    struct gltf_surface surface = {0};
    struct gltf_paint paint;
    uint32_t mesh = GLTF_NONE;
    if (known)
        return *known;
    double solid_share = math_max(share, math_min(1e-3 * vec3_max_abs(vec3_sub(all.max, all.min)) / size, 4e-3));
    const struct gltf_source source = {world, primitive, share, wanted > 0 ? share : solid_share, scene->options.pool};
    visit->ok = visit->ok && gltf_surface_make(&source, &surface, visit->error);
    if (visit->ok && surface.why)
        lacks(scene, surface.why, name);
    if (visit->ok && surface.triangles.count > 0) {
        visit->ok = gltf_paint_make(&scene->painter, primitive, &surface, &paint, visit->error);
        mesh = visit->ok ? put_mesh(scene, &surface, &paint, name) : GLTF_NONE;
    }
    gltf_surface_destroy(&surface);
    scene->file.failed = !key_map_add(&scene->meshes, key, mesh) || scene->file.failed;
    return mesh;
}

/* --- the tree --- */

/* Of a node on the path: where its children are, and its operands. */
struct frame {
    uint32_t node, of_children;
};

/* The map of a node at a time of a still scene, without its spin. */
static struct affine map_at(const struct node *node, const struct motion *motion, double time) {
    struct transform own = node_parent_from_node(node), moved;
    if (!motion)
        return own.forward;
    moved = motion_at(motion, time);
    if (!motion->has_end)
        moved = transform_compose(&moved, &own);
    return moved.forward;
}

static struct affine spin_at(const struct node *node, double time) {
    return transform_rotate_about(node->spin->axis, el_fmod(node->spin->degrees * time, 360)).forward;
}

/* A motion within a still scene: from time 0 to time 1. */
static void add_motion(const struct visit *visit, const struct node *node, uint32_t outer, uint32_t inner,
                       uint32_t spun) {
    enum { STEPS = 8 }; /* where the pose is turned and stretched */
    struct gltf_scene *scene = visit->scene;
    struct motion motion = motion_of_velocity(node->velocity);
    bool moves_on = node->moves_to && node->moves_to != node;
    struct transform from = node_parent_from_node(node);
    struct transform to = moves_on ? node_parent_from_node(node->moves_to) : from;
    if (moves_on && !motion_interpolate(&from, &to, node->velocity, &motion))
        moves_on = false;
    int steps = moves_on ? STEPS : 1;
    for (int i = 1; i <= steps; i++) {
        struct affine map = map_at(node, &motion, (double)i / steps);
        struct pose parts[2];
        (void)pose_of(&map, &parts[0], &parts[1]);
        add_key(scene, outer, (double)i / steps, parts[0]);
        if (inner != outer)
            add_key(scene, inner, (double)i / steps, parts[1]);
    }
    int turns = node->spin ? 1 + (int)math_min(fabs(node->spin->degrees) / 90, 10000) : 0;
    for (int i = 1; i <= turns; i++) {
        struct affine map = spin_at(node, (double)i / turns);
        struct pose parts[2];
        (void)pose_of(&map, &parts[0], &parts[1]);
        add_key(scene, spun, (double)i / turns, parts[0]);
    }
}

/* The node of the file that has what is below the node of the scene. */
static uint32_t enter_node(const struct visit *visit, const struct node *node, uint32_t parent,
                           const struct transform *below) {
    struct gltf_scene *scene = visit->scene;
    struct affine map = map_at(node, NULL, 0);
    uint32_t inner, spun;
    if (below)
        map = affine_compose(&map, &below->forward);
    uint32_t outer = node_for(visit, parent, node->name, &map, &inner);
    spun = inner;
    if (node->spin && node->spin->degrees != 0) {
        struct affine turn = spin_at(node, visit->moment->is_frame ? visit->moment->time : 0);
        (void)node_for(visit, inner, node->name, &turn, &spun);
    }
    if (node_moves(node) && scene->moments == 0 && !visit->moment->is_frame && !scene->file.failed)
        add_motion(visit, node, outer, inner, spun);
    return spun;
}

/* A node with its primitives: the mesh of one stands in the node itself, if it is in its space. */
static uint32_t enter(struct visit *visit, const struct node *node, uint32_t parent, uint32_t first, uint32_t count) {
    struct gltf_scene *scene = visit->scene;
    const struct transform identity = transform_identity();
    bool is_leaf = node->child_count == 0 && !node_moves(node) && count == 1;
    if (scene->moments > 0) {
        uint32_t at = scene->cursor < scene->nodes.count ? scene->cursor : 0;
        uint32_t number = enter_node(visit, node, parent, node_at(scene, at)->below);
        scene->cursor += node_at(scene, number)->mesh_nodes;
        return number;
    }
    uint32_t number = GLTF_NONE, nodes = 0, start = (uint32_t)scene->nodes.count;
    for (uint32_t i = 0; i < count; i++) {
        struct transform below = identity;
        uint32_t mesh = mesh_of(visit, first + i);
        bool is_unit = gltf_surface_is_unit(primitive_geometry(visit->moment->world, first + i), &below);
        if (i == 0)
            number = enter_node(visit, node, parent, is_leaf && is_unit ? &below : NULL);
        if (!visit->ok || scene->file.failed || mesh == GLTF_NONE)
            continue;
        uint32_t holder = number;
        if (is_leaf && is_unit) {
            struct transform *kept = arena_alloc(&scene->arena, sizeof *kept);
            scene->file.failed = !kept || scene->file.failed;
            if (kept)
                *kept = below;
            node_at(scene, start)->below = kept;
        } else if (is_unit || count > 1) {
            uint32_t made = (uint32_t)scene->nodes.count;
            (void)node_for(visit, number, node->name, &below.forward, &holder);
            nodes += (uint32_t)scene->nodes.count - made;
        }
        if (!scene->file.failed)
            node_at(scene, holder)->mesh = mesh;
    }
    if (count == 0)
        number = enter_node(visit, node, parent, NULL);
    if (!scene->file.failed)
        node_at(scene, number)->mesh_nodes = nodes;
    return number;
}

static void visit_tree(struct visit *visit, uint32_t root) {
    struct gltf_scene *scene = visit->scene;
    struct scene_traversal t = world_traversal(visit->moment->world, visit->moment->root, sizeof(struct frame));
    enum scene_event event = SCENE_END;
    uint32_t next = 0;
    while (visit->ok && !scene->file.failed && !scene->differs && (event = scene_traversal_next(&t)) < SCENE_END) {
        const struct node *node = scene_traversal_node(&t);
        struct frame *frame = scene_traversal_frame(&t, 0);
        if (event == SCENE_CHILDREN) {
            const uint32_t placement = t.steps[t.depth - 1].placement;
            const struct transform identity = transform_identity();
            struct transform map = scene_step_map(&t.steps[t.depth - 1], &identity);
            char name[160];
            frame->of_children = frame->node;
            (void)snprintf(name, sizeof name, "%.120s [%u]", node->name, placement);
            if (placement > 0)
                (void)node_for(visit, frame->node, name, &map.forward, &frame->of_children);
        } else if (event == SCENE_ENTER) {
            const struct frame *above = t.depth > 1 ? scene_traversal_frame(&t, 1) : NULL;
            bool is_operand = above && scene_traversal_operand(&t) != SCENE_CHILD;
            uint32_t parent = !above ? root : is_operand ? above->node : above->of_children;
            uint32_t count = world_primitives_of(visit->moment->world, node, next);
            frame->node = frame->of_children = enter(visit, node, parent, next, count);
            next += count;
        }
    }
    scene_traversal_end(&t);
    scene->file.failed = scene->file.failed || event == SCENE_NO_MEMORY;
}

/* --- the camera and the lights --- */

/* A node that looks along -z, with y upwards. */
static struct affine looking(struct vec3 from, struct vec3 along, struct vec3 up) {
    struct vec3 z = vec3_normalize(vec3_negate(along)), x = vec3_cross(vec3_normalize(up), z), other;
    if (vec3_max_abs(x) > 1e-9)
        x = vec3_normalize(x);
    else
        frame_tangents(z, &x, &other);
    return of_columns((const struct vec3[3]){x, vec3_cross(z, x), z}, from);
}

static uint32_t put_camera(struct gltf_scene *scene, const struct gltf_moment *moment) {
    const struct lens *lens = moment->lens;
    const struct box box = world_finite_bounds(moment->world);
    double size = box_is_empty(&box) ? 1 : vec3_length(vec3_sub(box.max, box.min));
    double far = box_is_empty(&box) ? 1 : vec3_length(vec3_sub(box.max, moment->camera->eye)) + size;
    bool is_orthographic = lens->projection == PROJECTION_ORTHOGRAPHIC;
    if (lens->projection != PROJECTION_PERSPECTIVE && !is_orthographic)
        lacks(scene, "the camera has a perspective projection, not that of the scene", "");
    if (lens->aperture > 0 || lens->stereo != STEREO_NONE || lens->columns > 0 || lens->shift_x != 0 ||
        lens->shift_y != 0)
        lacks(scene, "the camera is a pinhole, without depth of field, shift, stereo and light field", "");
    if (is_orthographic)
        return gltf_element(&scene->file, GLTF_CAMERAS,
                            "{'type':'orthographic','orthographic':{'xmag':%g,'ymag':%g,'zfar':%g,'znear':0}}",
                            lens->view_height / 2 * moment->aspect, lens->view_height / 2, 2 * far);
    return gltf_element(&scene->file, GLTF_CAMERAS,
                        "{'type':'perspective','perspective':{'aspectRatio':%g,'yfov':%g,'znear':%g}}", moment->aspect,
                        moment->camera->fov * (PI / 180), far / 10000);
}

/* A light as the file has it. */
struct punctual {
    enum light_kind kind; /* LIGHT_POINT, LIGHT_SPOT or LIGHT_DIRECTIONAL */
    struct vec3 from, along;
    double strength, inner, outer; /* radians */
};

/* Light that does not fall off with the square of the distance has the strength that it has in the middle of the
 * scene. */
static double strength_of(struct gltf_scene *scene, const struct light *light, struct vec3 from) {
    const struct box box = world_finite_bounds(scene->painter.world);
    const double *c = light->falloff;
    double d = box_is_empty(&box) ? 1 : vec3_length(vec3_sub(vec3_scale(vec3_add(box.min, box.max), 0.5), from));
    double sum = c[0] + d * (c[1] + d * c[2]);
    switch (light->attenuation) {
    case ATTENUATION_INVERSE_SQUARE:
        return light->intensity;
    case ATTENUATION_COEFFICIENTS:
        if (c[0] == 0 && c[1] == 0 && c[2] > 0)
            return 1 / c[2];
        lacks(scene, "a light falls off with the square of the distance; in the middle of the scene it is as before",
              "");
        return d * d / (sum > 0 ? sum : 1);
    case ATTENUATION_RANGE:
        lacks(scene, "a light falls off with the square of the distance; in the middle of the scene it is as before",
              "");
        return d * d * math_max(1 - d / light->range, 0);
    }
    return 0;
}

/* False: it is left out. */
static bool punctual_of(struct gltf_scene *scene, const struct light *light, struct punctual *out) {
    struct light_target middle;
    const bool has_middle = light_middle(light, &middle);
    *out = (struct punctual){.kind = LIGHT_POINT, .along = {0, -1, 0}, .outer = PI / 2, .strength = 1};
    out->from = has_middle ? middle.at : vec3_all(0);
    switch (light->kind) {
    case LIGHT_POINT:
        out->strength = strength_of(scene, light, out->from);
        return true;
    case LIGHT_DIRECTIONAL:
        out->kind = LIGHT_DIRECTIONAL;
        out->from = vec3_all(0);
        out->along = light->direction;
        return true;
    case LIGHT_SPOT:
        out->kind = LIGHT_SPOT;
        out->along = light->direction;
        out->strength = strength_of(scene, light, out->from);
        out->inner = el_acos(light->cos_inner);
        out->outer = math_min(el_acos(light->cos_outer), PI / 2);
        return true;
    case LIGHT_PARALLELOGRAM:
    case LIGHT_DISC:
    case LIGHT_SPHERE:
        lacks(scene, "a light with an extent is a point in its middle", "");
        if (!light->emissive) {
            out->strength = strength_of(scene, light, out->from);
            return true;
        }
        out->strength = light->kind == LIGHT_PARALLELOGRAM ? vec3_length(vec3_cross(light->edge1, light->edge2)) / PI
                                                           : light->radius * light->radius;
        out->kind = light->one_sided && light->kind != LIGHT_SPHERE ? LIGHT_SPOT : LIGHT_POINT;
        out->along = light->kind == LIGHT_DISC ? light->direction : vec3_cross(light->edge1, light->edge2);
        return true;
    case LIGHT_MESH:
        lacks(scene, "the light of a mesh is left out; its surface emits it", "");
        return false;
    case LIGHT_SKY:
        lacks(scene, "the light of the sky is left out", "");
        return false;
    }
    return false;
}

static uint32_t put_light(struct gltf_scene *scene, const struct light *light, const struct punctual *punctual) {
    double largest = colour_max_abs(light->colour);
    struct colour colour = gltf_light_of(&scene->painter, colour_scale(light->colour, 1 / largest));
    const double intensity = lumens * largest * punctual->strength;
    if (punctual->kind == LIGHT_SPOT)
        return gltf_element(
            &scene->file, GLTF_LIGHTS,
            "{'color':%3,'intensity':%g,'type':'spot','spot':{'innerConeAngle':%g,'outerConeAngle':%g}}", &colour.r,
            intensity, math_min(punctual->inner, 0.9999 * punctual->outer), punctual->outer);
    return gltf_element(&scene->file, GLTF_LIGHTS, "{'color':%3,'intensity':%g,'type':%s}", &colour.r, intensity,
                        punctual->kind == LIGHT_POINT ? "point" : "directional");
}

static void add_lights(struct visit *visit, uint32_t root) {
    struct gltf_scene *scene = visit->scene;
    const struct world *world = visit->moment->world;
    for (uint32_t i = 0; i < world->light_count && !scene->file.failed && !scene->differs; i++) {
        const struct light *light = &world->lights[i];
        struct punctual punctual;
        uint32_t inner;
        if (!punctual_of(scene, light, &punctual) || !(colour_max_abs(light->colour) > 0))
            continue;
        if (light->profile)
            lacks(scene, "the profile of a light is left out", "");
        if (light->lit)
            lacks(scene, "a light that leaves out nodes lights them, too", "");
        struct affine map = looking(punctual.from, punctual.along, vec3_make(0, 1, 0));
        uint32_t node = node_for(visit, root, "light", &map, &inner);
        if (scene->moments == 0 && !scene->file.failed)
            node_at(scene, node)->light = put_light(scene, light, &punctual);
    }
}

static void add_camera(struct visit *visit, uint32_t root) {
    struct gltf_scene *scene = visit->scene;
    const struct camera *camera = visit->moment->camera;
    uint32_t inner;
    if (!camera)
        return;
    struct affine map = looking(camera->eye, camera->view, camera->up);
    uint32_t node = node_for(visit, root, "camera", &map, &inner);
    if (scene->moments == 0 && !scene->file.failed)
        node_at(scene, node)->camera = put_camera(scene, visit->moment);
}

bool gltf_scene_add(struct gltf_scene *scene, const struct gltf_moment *moment, struct error *error) {
    struct visit visit = {.scene = scene, .moment = moment, .error = error, .ok = true};
    const struct camera *camera = moment->camera;
    uint32_t root = GLTF_NONE;
    scene->painter = (struct gltf_painter){.file = &scene->file,
                                           .world = moment->world,
                                           .pool = scene->options.pool,
                                           .linear = scene->options.linear,
                                           .images = &scene->images,
                                           .note = lacks,
                                           .context = scene};
    scene->cursor = 0;
    /* In a file y is up. */
    if (camera && fabs(camera->up.z) > fabs(camera->up.y)) {
        struct affine turn = transform_rotate(0, camera->up.z > 0 ? -90 : 90).forward;
        (void)node_for(&visit, GLTF_NONE, "upright", &turn, &root);
    }
    add_camera(&visit, root);
    add_lights(&visit, root);
    visit_tree(&visit, root);
    if (scene->differs) {
        lacks(scene, "a frame shows other nodes than the first one: from there on nothing moves", "");
        scene->differs = false;
    }
    scene->moments++;
    return visit.ok && (!scene->file.failed || error_no_memory(error, "a model"));
}

/* --- the file --- */

static void put_channel(struct gltf_scene *scene, uint32_t node, uint32_t input, const char *path, size_t offset,
                        int width) {
    const struct out_node *at = node_at(scene, node);
    const struct key *keys = at->keys.items;
    const size_t count = at->keys.count;
    float *numbers = mem_alloc((count * (size_t)width + 1) * sizeof *numbers);
    bool moves = false;
    for (size_t i = 0; numbers && i < count; i++) {
        const double *from = (const double *)(const void *)((const char *)&keys[i].pose + offset);
        for (int k = 0; k < width; k++)
            numbers[i * (size_t)width + (size_t)k] = (float)from[k];
        moves = moves || memcmp(from, (const char *)&at->pose + offset, (size_t)width * sizeof *from) != 0;
    }
    scene->file.failed = scene->file.failed || !numbers;
    if (numbers && moves) {
        uint32_t output = gltf_add_floats(&scene->file, numbers, count, width, GLTF_NO_TARGET);
        uint32_t sampler = gltf_element(&scene->file, GLTF_SAMPLERS,
                                        "{'input':%u,'interpolation':'LINEAR','output':%u}", input, output);
        (void)gltf_element(&scene->file, GLTF_CHANNELS, "{'sampler':%u,'target':{'node':%u,'path':%s}}", sampler, node,
                           path);
    }
    mem_free(numbers);
}

static void put_animation(struct gltf_scene *scene, uint32_t node) {
    const struct key *keys = node_at(scene, node)->keys.items;
    const size_t count = node_at(scene, node)->keys.count;
    float *times = count > 0 ? mem_alloc(count * sizeof *times) : NULL;
    scene->file.failed = scene->file.failed || (count > 0 && !times);
    if (!times)
        return;
    for (size_t i = 0; i < count; i++)
        times[i] = (float)keys[i].time;
    uint32_t input = gltf_add_floats(&scene->file, times, count, 1, GLTF_NO_TARGET);
    mem_free(times);
    put_channel(scene, node, input, "translation", offsetof(struct pose, move), 3);
    put_channel(scene, node, input, "rotation", offsetof(struct pose, turn), 4);
    put_channel(scene, node, input, "scale", offsetof(struct pose, size), 3);
}

static void put_node(struct gltf_scene *scene, uint32_t number, struct gltf_text *text) {
    static const struct pose rest = {.turn = {0, 0, 0, 1}, .size = {1, 1, 1}};
    const struct out_node *at = node_at(scene, number);
    gltf_put(text, "{");
    if (at->name[0])
        gltf_put(text, "'name':%s", at->name);
    if (memcmp(at->pose.move, rest.move, sizeof rest.move) != 0)
        gltf_put(text, "'translation':%3", at->pose.move);
    if (memcmp(at->pose.turn, rest.turn, sizeof rest.turn) != 0)
        gltf_put(text, "'rotation':%4", at->pose.turn);
    if (memcmp(at->pose.size, rest.size, sizeof rest.size) != 0)
        gltf_put(text, "'scale':%3", at->pose.size);
    if (at->mesh != GLTF_NONE)
        gltf_put(text, "'mesh':%u", at->mesh);
    if (at->camera != GLTF_NONE)
        gltf_put(text, "'camera':%u", at->camera);
    if (at->light != GLTF_NONE)
        gltf_put(text, "'extensions':{'KHR_lights_punctual':{'light':%u}}", at->light);
    for (uint32_t child = at->first_child; child != GLTF_NONE; child = node_at(scene, child)->next)
        gltf_put(text, child == at->first_child ? "'children':[%u" : "%u", child);
    gltf_put(text, at->first_child != GLTF_NONE ? "]}" : "}");
    (void)gltf_add(&scene->file, GLTF_NODES, text);
}

bool gltf_scene_write(struct gltf_scene *scene, bool binary, struct list *out, struct error *error) {
    struct gltf_text text = {0};
    for (uint32_t i = 0; i < scene->nodes.count; i++) {
        put_node(scene, i, &text);
        put_animation(scene, i);
    }
    list_destroy(&text.bytes);
    return gltf_file_write(&scene->file, binary, &scene->roots, out) ||
           (scene->file.failed
                ? error_no_memory(error, "a model")
                : error_set(error, ERROR_SCENE, "the model is larger than 4 GiB, which glTF cannot hold"));
}
