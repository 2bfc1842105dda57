#include "export/contour_internal.h"

#include "base/mem.h"
#include "export/contour_cell_internal.h"
#include "export/contour_grid_internal.h"

uint32_t contour_add_vertex(struct contour *contour, const struct solid_vertex *vertex) {
    uint32_t index = (uint32_t)contour->vertices.count;
    if (index < NO_INDEX - 1 && list_add(&contour->vertices, vertex, 1, sizeof *vertex))
        return index;
    contour->failed = true;
    return 0;
}

void contour_add_triangle(struct contour *contour, uint32_t a, uint32_t b, uint32_t c, uint32_t surface) {
    const struct solid_triangle triangle = {{a, b, c}, surface};
    contour->failed = !list_add(&contour->triangles, &triangle, 1, sizeof triangle) || contour->failed;
}

/* The triangles of a base cell are contiguous; when they are made again, the old ones are forgotten at the end. */
struct base_mesh {
    uint32_t first, count;
};
struct octree {
    struct contour *contour;
    struct base_mesh *bases;
    size_t count; /* of bases */
    size_t limit; /* of cells that are divided, or 0 */
    bool divided; /* a cell of the base cell in work */
};

/* A cell that is divided may have neighbours that have triangles already. */
static void mesh_cell(struct octree *tree, const struct cell *cell) {
    struct contour *contour = tree->contour;
    if (contour->failed)
        return;
    if (cell->size <= contour->finest || !contour_is_divided(contour, cell)) {
        if (cell_mesh(contour, cell))
            return;
        tree->divided = true;
        if (!key_map_add(&contour->divided, cell_key(cell->at, cell->size, 0), 0)) {
            contour->failed = true;
            return;
        }
    }
    int half = cell->size / 2;
    for (int i = 0; i < 8; i++) {
        const struct cell child = {
            {cell->at[0] + (i & 1) * half, cell->at[1] + (i >> 1 & 1) * half, cell->at[2] + (i >> 2) * half}, half};
        mesh_cell(tree, &child);
    }
}

static void mesh_base(struct octree *tree, const int base[3]) {
    struct contour *contour = tree->contour;
    struct line_grid *grid = &contour->grid;
    struct base_mesh *mesh = &tree->bases[grid_base_index(grid, base)];
    const struct cell cell = {{base[0] * grid->base, base[1] * grid->base, base[2] * grid->base}, grid->base};
    bool any = false;
    mesh->first = (uint32_t)contour->triangles.count;
    do {
        contour->triangles.count = mesh->first;
        tree->divided = false;
        mesh_cell(tree, &cell);
        any = any || tree->divided;
    } while (tree->divided && !contour->failed);
    mesh->count = (uint32_t)contour->triangles.count - mesh->first;
    for (int i = 0; any && i < 6; i++) {
        int beyond[3] = {base[0], base[1], base[2]};
        beyond[i / 2] += i % 2 ? 1 : -1;
        if (beyond[i / 2] < 0 || beyond[i / 2] >= grid->base_count[i / 2])
            continue;
        grid->wanted[grid_base_index(grid, beyond)] = 1;
        grid->has_wanted = true;
    }
}

/* A fractal has details of all sizes: if more cells are divided than this, for each base cell that has a part of the
 * surface, all get one size, a part of the base cell's. The gyroid lamp of data/print needs 3. */
enum { DIVIDED_LIMIT = 4, MIN_DIVIDED_LIMIT = 2000, COARSE_PART = 4 };

static void set_limit(struct octree *tree) {
    tree->limit = MIN_DIVIDED_LIMIT;
    for (size_t i = 0; i < tree->count; i++)
        tree->limit += tree->contour->grid.wanted[i] ? DIVIDED_LIMIT : 0;
}

static bool has_too_many(const struct octree *tree) {
    const struct contour *contour = tree->contour;
    return tree->limit && contour->finest == 1 && contour->divided.count > tree->limit;
}

/* Forgets the triangles, and which cells were divided. */
static void begin_again(struct octree *tree) {
    struct contour *contour = tree->contour;
    struct line_grid *grid = &contour->grid;
    contour->finest = grid->base / COARSE_PART;
    contour->triangles.count = 0;
    key_map_destroy(&contour->divided);
    key_map_destroy(&contour->passed);
    memset(tree->bases, 0, tree->count * sizeof *tree->bases);
    memset(grid->wanted, 1, tree->count);
    grid->has_wanted = true;
}

static bool mesh_all(struct octree *tree, struct pool *pool, struct error *error) {
    struct contour *contour = tree->contour;
    struct line_grid *grid = &contour->grid;
    int base[3];
    while (grid->has_wanted && !has_too_many(tree)) {
        grid->has_wanted = false;
        for (base[0] = 0; base[0] < grid->base_count[0]; base[0]++) {
            for (base[1] = 0; base[1] < grid->base_count[1]; base[1]++) {
                if (pool_cancelled(pool))
                    return error_set(error, ERROR_CANCELLED, "stopped while a solid was meshed");
                for (base[2] = 0; base[2] < grid->base_count[2] && !contour->failed && !has_too_many(tree); base[2]++) {
                    size_t index = grid_base_index(grid, base);
                    if (!grid->wanted[index])
                        continue;
                    grid->wanted[index] = 0;
                    mesh_base(tree, base);
                }
            }
        }
    }
    return true;
}

/* Only the newest triangles of each base cell. */
static bool gather(const struct octree *tree, struct list *out) {
    bool ok = true;
    for (size_t i = 0; ok && i < tree->count; i++)
        ok = list_add(out, (struct solid_triangle *)tree->contour->triangles.items + tree->bases[i].first,
                      tree->bases[i].count, sizeof(struct solid_triangle));
    return ok;
}

static bool build(struct contour *contour, uint32_t cells, const struct solid_input *input, struct solid_mesh *out,
                  struct error *error) {
    struct octree tree = {.contour = contour};
    if (!line_grid_build(contour, cells, input->pool, error))
        return false;
    const int *bases = contour->grid.base_count;
    tree.count = (size_t)bases[0] * (size_t)bases[1] * (size_t)bases[2];
    tree.bases = mem_alloc_zero(tree.count, sizeof *tree.bases);
    bool ok = tree.bases || error_no_memory(error, "the mesh of a solid");
    if (ok && input->may_have_faults)
        set_limit(&tree);
    ok = ok && mesh_all(&tree, input->pool, error);
    if (ok && has_too_many(&tree)) {
        begin_again(&tree);
        ok = mesh_all(&tree, input->pool, error);
    }
    if (ok && (contour->failed || contour->probe.failed || !gather(&tree, &out->triangles)))
        ok = error_no_memory(error, "the mesh of a solid");
    mem_free(tree.bases);
    out->vertices = contour->vertices;
    contour->vertices = (struct list){0};
    return ok;
}

bool contour_build(const struct solid_input *input, uint32_t cells, struct solid_mesh *out, struct list *known,
                   bool *is_coarse, struct error *error) {
    struct contour contour = {.tolerance = input->tolerance, .finest = 1};
    struct vec3 extent = vec3_sub(input->csg->bounds.max, input->csg->bounds.min);
    *out = (struct solid_mesh){0};
    contour.size = vec3_max_abs(extent);
    if (!solid_probe_init(&contour.probe, input->csg))
        return error_no_memory(error, "the mesh of a solid");
    bool ok = build(&contour, cells, input, out, error);
    *is_coarse = contour.finest > 1;
    *known = contour.grid.known;
    contour.grid.known = (struct list){0};
    solid_probe_destroy(&contour.probe);
    line_grid_destroy(&contour.grid);
    list_destroy(&contour.vertices);
    list_destroy(&contour.triangles);
    list_destroy(&contour.arcs);
    list_destroy(&contour.faces);
    key_map_destroy(&contour.face_numbers);
    key_map_destroy(&contour.divided);
    key_map_destroy(&contour.passed);
    ok = ok && (solid_mesh_compact(out) || error_no_memory(error, "the mesh of a solid"));
    if (!ok)
        solid_mesh_destroy(out);
    return ok;
}
