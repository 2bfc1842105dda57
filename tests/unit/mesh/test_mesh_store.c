/* The store of meshes: each is stored once, found by its content, and dropped with the frame that made it. */
#include "base/mem.h"
#include "mesh/mesh.h"
#include "scene/node.h"
#include "tests/harness.h"

enum { OLD = 1000, NEW = 3000 };

static const uint32_t starts[] = {0, 3}, corners[] = {0, 1, 2};

/* Triangle number i; the caller gives room for its vertices. */
static struct mesh_input triangle(int i, double vertices[3][3]) {
    for (int k = 0; k < 9; k++)
        vertices[k / 3][k % 3] = k % 4 == 3 ? i : 0;
    vertices[2][1] = 1;
    return (struct mesh_input){.name = "t",
                               .vertex_count = 3,
                               .face_count = 1,
                               .vertices = (const double(*)[3])vertices,
                               .face_start = starts,
                               .vertex_index = corners};
}

static struct mesh *stored(struct assets *assets, int i, struct error *error) {
    double vertices[3][3];
    struct mesh_input input = triangle(i, vertices);
    return assets_mesh(assets, &input, error);
}

/* The table holds exactly the meshes of the list, each in its slot; returns the longest chain. */
static int check_table(const struct assets *assets) {
    uint32_t listed = 0, chained = 0;
    int longest = 0;
    for (const struct asset_mesh *entry = assets->meshes; entry; entry = entry->next)
        listed++;
    for (size_t slot = 0; slot < assets->mesh_slot_count; slot++) {
        int length = 0;
        for (const struct asset_mesh *entry = assets->mesh_slots[slot]; entry; entry = entry->chained, length++)
            CHECK_EQ_INT(entry->key % assets->mesh_slot_count, slot);
        chained += (uint32_t)length;
        longest = length > longest ? length : longest;
    }
    CHECK_EQ_INT(listed, assets->mesh_count);
    CHECK_EQ_INT(chained, assets->mesh_count);
    CHECK(assets->mesh_slot_count >= assets->mesh_count);
    return longest;
}

TEST(thousands_of_meshes_are_stored_once_and_found_in_short_chains) {
    static struct mesh *made[NEW];
    struct assets assets = {0};
    struct error error = {0};
    for (int round = 0; round < 2; round++)
        for (int i = 0; i < NEW; i++) {
            struct mesh *mesh = stored(&assets, i + 1, &error);
            CHECK(mesh && (round == 0 || mesh == made[i]));
            made[i] = mesh;
        }
    CHECK_EQ_INT(assets.mesh_count, NEW);
    CHECK(check_table(&assets) <= 10); /* with random keys, a longer one has a chance of 2e-6 */
    assets_destroy(&assets);
    CHECK(!assets.meshes && !assets.mesh_slots && assets.mesh_slot_count == 0);
}

TEST(meshes_of_a_frame_leave_the_store_and_older_ones_and_those_of_files_stay) {
    static struct mesh *old[OLD];
    struct assets assets = {0};
    struct scene scene;
    struct error error = {0};
    double vertices[3][3];
    scene_init(&scene, &assets);
    for (int i = 0; i < OLD; i++)
        old[i] = stored(&assets, i + 1, &error);
    for (int frame = 0; frame < 2; frame++) {
        struct scene_snapshot snapshot = scene_snapshot(&scene);
        struct mesh_input input = triangle(-1 - frame, vertices);
        struct mesh *of_file = mesh_create(&input, &error);
        for (int i = 0; i < NEW; i++)
            CHECK(stored(&assets, i + 1, &error) != NULL);
        for (int k = 0; k < 2; k++) /* once, and then it is there */
            CHECK(assets_keep_mesh(&assets, of_file, &error));
        CHECK(stored(&assets, -1 - frame, &error) != of_file); /* tables and files have separate meshes */
        CHECK_EQ_INT(assets.mesh_count, NEW + 2 + (uint32_t)frame);
        scene_rewind(&scene, &snapshot);
        CHECK_EQ_INT(assets.mesh_count, OLD + 1 + (uint32_t)frame);
        (void)check_table(&assets);
        CHECK(assets_keep_mesh(&assets, of_file, &error));
        for (int i = 0; i < OLD; i++)
            CHECK(stored(&assets, i + 1, &error) == old[i]);
        CHECK_EQ_INT(assets.mesh_count, OLD + 1 + (uint32_t)frame);
        mesh_release(of_file);
    }
    scene_destroy(&scene);
    assets_destroy(&assets);
}

/* Among them the allocations of the table while it grows. */
TEST(any_allocation_may_fail_while_the_store_of_meshes_grows) {
    struct assets assets = {0};
    struct error error = {0};
    uint64_t before = mem_allocations();
    int failed = 0;
    CHECK(stored(&assets, 1, &error) != NULL);
    if (mem_allocations() == before) {
        assets_destroy(&assets);
        test_skip("allocations fail on demand only in builds with GRAY_FAULTS");
    }
    for (int i = 1; i < 200; i++) {
        struct mesh *mesh = NULL;
        for (uint64_t k = 1; !mesh; k++) {
            mem_fail_at(k);
            mesh = stored(&assets, i + 1, &error);
            mem_fail_at(0);
            failed += !mesh;
            CHECK(mesh || error.kind == ERROR_MACHINE);
            CHECK_EQ_INT(assets.mesh_count, i + (mesh != NULL));
            (void)check_table(&assets);
        }
        CHECK(stored(&assets, i + 1, &error) == mesh);
    }
    CHECK(failed >= 199 * 2 + 2); /* of each a mesh and its entry; two larger tables */
    assets_destroy(&assets);
}
