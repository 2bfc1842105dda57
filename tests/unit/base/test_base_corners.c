/* Corner cases of src/base: sizes beyond all memory, impossible file names, every system call that can fail while a
 * file is written, closed standard descriptors. */
#define _GNU_SOURCE
#include "base/arena.h"
#include "base/fault.h"
#include "base/file_output.h"
#include "base/key_map.h"
#include "base/mem.h"
#include "base/pool.h"
#include "base/share.h"
#include "tests/harness.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

/* --- memory --- */

TEST(more_memory_than_there_can_be_is_not_there) {
    if (strcmp(GRAY_CONFIG, "asan") == 0 || strcmp(GRAY_CONFIG, "tsan") == 0)
        test_skip("the sanitizers end a process that asks for so much");
    CHECK(!mem_alloc_aligned(64, SIZE_MAX - 4096));
    CHECK(!mem_resize(NULL, SIZE_MAX - 4096));
}

TEST(sizes_beyond_all_memory_are_refused_and_sizes_of_zero_are_fine) {
    struct arena arena = {0};
    CHECK(!arena_alloc(&arena, SIZE_MAX) && !arena_alloc(&arena, SIZE_MAX - 20));
    CHECK(!arena_alloc_array(&arena, SIZE_MAX / 2, 8));
    CHECK(!arena_copy_text(&arena, "x", SIZE_MAX));
    char *empty = arena_alloc(&arena, 0), *next = arena_alloc(&arena, 0);
    CHECK(empty && next && empty != next);
    CHECK(!mem_resize_array(NULL, SIZE_MAX / 2, 8));
    void *blocks[] = {mem_alloc(0), mem_alloc_zero(0, 8), mem_alloc_zero(8, 0), mem_alloc_aligned(64, 0),
                      mem_resize(NULL, 0)};
    for (size_t i = 0; i < sizeof blocks / sizeof blocks[0]; i++) {
        CHECK(blocks[i] != NULL);
        mem_free(blocks[i]);
    }
    void *shared = mem_share(0);
    CHECK(shared && !mem_share(SIZE_MAX));
    mem_unshare(shared, 0);
    mem_unshare(NULL, 100);
    struct share share;
    struct error error;
    CHECK(share_create(&share, 0, &error));
    share_destroy(&share);
    CHECK(!share_attach(&share, -1, 10, &error));
    arena_destroy(&arena);
}

TEST(a_key_map_finds_every_key_that_was_added_and_no_other) {
    struct key_map map = {0};
    CHECK(!key_map_find(&map, 1));
    for (uint32_t i = 0; i < 5000; i++)
        CHECK(key_map_add(&map, UINT64_MAX - (uint64_t)i * i, i));
    for (uint32_t i = 0; i < 5000; i++) {
        const uint32_t *value = key_map_find(&map, UINT64_MAX - (uint64_t)i * i);
        CHECK(value && *value == i);
        CHECK(!key_map_find(&map, UINT64_MAX - (uint64_t)i * i - 2)); /* no square is 2 more than a square */
    }
    key_map_destroy(&map);
    CHECK(!key_map_find(&map, UINT64_MAX));
}

TEST(an_arena_that_is_reset_keeps_its_largest_block_at_any_position) {
    struct arena arena = {0};
    char *large = arena_alloc(&arena, 1 << 20); /* the next block is larger still, the one after it small again */
    CHECK(large && arena_alloc(&arena, 1 << 20) && arena_alloc(&arena, (size_t)100 << 20) &&
          arena_alloc(&arena, 1 << 20));
    arena_reset(&arena);
    CHECK(arena.total == 0);
    uint64_t before = mem_allocations();
    CHECK(arena_alloc(&arena, (size_t)90 << 20) != NULL);
    CHECK(mem_allocations() - before <= 1); /* the check for an injected failure, and no block */
    arena_destroy(&arena);
}

TEST(errors_are_cut_between_letters) {
    struct error error;
    char text[2 * sizeof error.text];
    for (int shift = 0; shift < 3; shift++) { /* each letter has three bytes */
        memset(text, 'x', (size_t)shift);
        for (size_t i = (size_t)shift; i + 3 < sizeof text; i += 3)
            memcpy(text + i, "\xE2\x82\xAC", 4);
        CHECK(!error_set(&error, ERROR_SCENE, "%s", text));
        size_t length = strlen(error.text);
        CHECK(length < sizeof error.text && strcmp(error.text + length - 3, "...") == 0);
        CHECK((length - 3 - (size_t)shift) % 3 == 0);
    }
}

TEST(pools_have_the_threads_that_make_sense) {
    char warning[256];
    struct pool *pool = pool_create(0, warning);
    CHECK(pool_workers(pool) == (int)sysconf(_SC_NPROCESSORS_ONLN));
    pool_destroy(pool);
#ifdef GRAY_FAULTS
    for (uint64_t k = 1; k <= 2; k++) {
        fault_at(FAULT_OF_ALLOCATION, k);
        CHECK(!pool_create(2, warning));
        fault_at(FAULT_OF_ALLOCATION, 0);
    }
    for (uint64_t k = 1; k <= 3; k++) {
        fault_at(FAULT_OF_CALL, k);
        pool = pool_create(4, warning);
        fault_at(FAULT_OF_CALL, 0);
        CHECK(pool && pool_workers(pool) == (int)k && warning[0] != '\0');
        pool_destroy(pool);
    }
#endif
}

/* --- names of files --- */

TEST(files_that_cannot_be_written_are_errors_that_name_the_cause) {
    char long_name[5000], long_part[400];
    memset(long_name, 'x', sizeof long_name);
    long_name[sizeof long_name - 1] = '\0';
    (void)snprintf(long_part, sizeof long_part, "%s/%.300s/a.png", test_folder(), long_name);
    test_write_text(test_path("file.txt"), "x");
    CHECK(symlink("loop", test_path("loop")) == 0);
    const struct {
        const char *target;
        enum error_kind kind;
        const char *words;
    } all[] = {{"", ERROR_SCENE, "the name of the output file is empty"},
               {long_name, ERROR_SCENE, "the file name is longer than 4095 bytes"},
               {test_folder(), ERROR_SCENE, "is a folder"},
               {test_path("file.txt/a.png"), ERROR_SCENE, "Not a directory"},
               {test_path("loop/a.png"), ERROR_SCENE, strerror(ELOOP)},
               {long_part, ERROR_SCENE, strerror(ENAMETOOLONG)},
               {"/proc/nothing/a.png", ERROR_SCENE, "the folder /proc/nothing cannot be made"}};
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        struct file_output file;
        struct error error = {0};
        CHECK(!file_output_open(&file, FILE_AT(all[i].target), &error));
        if (error.kind != all[i].kind || !strstr(error.text, all[i].words))
            test_fail(__FILE__, __LINE__, "'%.100s': kind %d: %s", all[i].target, (int)error.kind, error.text);
        file_output_abandon(&file);
    }
    struct error error = {0};
    CHECK(!file_make_folders_for(long_name, &error));
    char small[8];
    CHECK(!file_canonical(test_folder(), small, sizeof small));
    CHECK(file_canonical("/", small, sizeof small));
}

TEST(a_device_that_is_full_is_no_fault_of_the_scene) {
    struct file_output file;
    struct error error = {0};
    const struct file_rules is_direct = {.is_direct = true};
    CHECK(!file_output_open(&file, FILE_AT("/dev/full"), &error) && strstr(error.text, "is a device"));
    CHECK(file_output_open(&file, &(struct file_target){.path = "/dev/full", .rules = &is_direct}, &error));
    CHECK(!file_output_write(&file, "x", 1, &error));
    CHECK_EQ_INT(error.kind, ERROR_MACHINE);
    file_output_abandon(&file);
    CHECK(file_output_open(&file, &(struct file_target){.path = "/dev/null", .rules = &is_direct}, &error) &&
          file_output_write(&file, "x", 1, &error));
    CHECK(file_output_commit(&file, &error));
}

/* --- reading --- */

static bool take(void *context, const char *name) {
    char *names = context;
    strcat(strcat(names, name), " ");
    return strlen(names) < 10;
}

TEST(folders_are_listed_in_order_up_to_a_limit_or_until_the_caller_stops) {
    char names[200] = "";
    static const char *const files[] = {"charlie", "alpha", "bravo", "delta"};
    for (int i = 0; i < 4; i++)
        test_write_text(test_path(files[i]), "");
    CHECK(file_list(test_folder(), 100, take, names));
    CHECK_TEXT(names, "alpha bravo ");
    names[0] = '\0';
    CHECK(file_list(test_folder(), 0, take, names));
    CHECK_TEXT(names, "");
    CHECK(!file_list(test_path("nothing"), 100, take, names));
#ifdef GRAY_FAULTS
    for (uint64_t k = 1; k <= 6; k++) {
        names[0] = '\0';
        fault_at(FAULT_OF_ALLOCATION, k);
        CHECK(file_list(test_folder(), 100, take, names));
        fault_at(FAULT_OF_ALLOCATION, 0);
        CHECK(k > 1 || names[0] == '\0');
    }
#endif
}

TEST(a_read_log_counts_every_content_once_in_any_order) {
    struct file_read_log witness = {0}, turned = {0};
    struct file_bytes bytes;
    struct error error = {0};
    for (int round = 0; round < 2; round++) {
        const struct file_listener listener = {.log = round ? &turned : &witness};
        file_set_listener(&listener);
        for (int i = 0; i < 50; i++) {
            int n = round ? 49 - i : i;
            char name[16], text[16];
            (void)snprintf(name, sizeof name, "%d.txt", n);
            (void)snprintf(text, sizeof text, "%d", n % 40);
            test_write_text(test_path(name), text);
            CHECK(file_map(test_path(name), 100, &bytes, &error));
            file_unmap(&bytes);
        }
    }
    file_set_listener(NULL);
    CHECK(witness.count == 40 && turned.count == 40 && !witness.incomplete);
    CHECK(digest_equal(file_read_log_sum(&witness), file_read_log_sum(&turned)));
#ifdef GRAY_FAULTS
    for (uint64_t k = 1; k <= 2; k++) { /* the bytes themselves, then the list */
        struct file_read_log poor = {0};
        const struct file_listener listener = {.log = &poor};
        file_set_listener(&listener);
        fault_at(FAULT_OF_ALLOCATION, k);
        bool read = file_map(test_path("1.txt"), 100, &bytes, &error);
        fault_at(FAULT_OF_ALLOCATION, 0);
        CHECK(read == (k == 2) && poor.incomplete == (k == 2));
        if (read)
            file_unmap(&bytes);
        file_set_listener(NULL);
        file_read_log_destroy(&poor);
    }
#endif
    file_read_log_destroy(&witness);
    file_read_log_destroy(&turned);
}

TEST(versions_of_files_are_their_contents_wherever_time_says_otherwise) {
    struct file_version first, second;
    test_write_text(test_path("a"), "one");
    CHECK(file_version_of(test_path("a"), NULL, &first));
    CHECK(file_version_of(test_path("a"), &first, &second) && digest_equal(first.content, second.content));
    struct file_version known = first;
    known.content.a ^= 1; /* accepted if size and time are the same */
    CHECK(file_version_of(test_path("a"), &known, &second) && digest_equal(known.content, second.content));
    known.seconds--;
    CHECK(file_version_of(test_path("a"), &known, &second) && digest_equal(first.content, second.content));
    CHECK(!file_version_of(test_path("nothing"), NULL, &second) && !file_version_of(test_folder(), NULL, &second));
    struct file_bytes bytes;
    struct error error = {0};
    CHECK(!file_map(test_path("a"), 2, &bytes, &error));
    CHECK(strstr(error.text, "3 bytes are more than the limit of 2") != NULL);
    CHECK(!file_map("/dev/null", 2, &bytes, &error) && strstr(error.text, "is a pipe or device, not a regular file"));
    CHECK(!file_map(test_folder(), 2, &bytes, &error) && strstr(error.text, "is a folder, not a regular file"));
}

/* In a separate process: no file opened later gets one of the three descriptors, and standard input is empty. */
TEST(closed_standard_descriptors_are_taken_by_nothing) {
    pid_t child = fork();
    if (child == 0) {
        char byte;
        (void)close(0), (void)close(1), (void)close(2);
        file_fill_standard();
        int next = open("/dev/null", O_RDONLY);
        bool fine = next >= 3 && write(1, "x", 1) < 0 && read(0, &byte, 1) == 0;
        (void)close(0);
        fine = fine && file_null_input() && read(0, &byte, 1) == 0 && file_null_input();
        _exit(fine ? 0 : 1);
    }
    int how = 1;
    CHECK(waitpid(child, &how, 0) == child && how == 0);
}

#ifdef GRAY_FAULTS
static int entries;
static bool count_entry(void *context, const char *name) {
    (void)context, (void)name;
    entries++;
    return true;
}

/* Whichever call fails, with and without unnamed temporary files (O_TMPFILE): the old file or the new one remains, and
 * nothing else. */
TEST(a_file_is_written_whole_or_not_at_all_whichever_call_fails) {
    CHECK(chdir(test_folder()) == 0); /* a name without folders needs none to be made */
    for (uint64_t opening = 0; opening <= 1; opening++)
        for (uint64_t k = 1, over = 0; !over; k++) {
            struct file_output file;
            struct error error = {0};
            size_t size;
            test_write_text("a.txt", "old");
            /* The calls: open the folder, look at the name twice, then create the unnamed file. */
            fault_at(FAULT_OF_CALL, opening ? 4 : 0);
            bool ok = file_output_open(&file, FILE_AT("a.txt"), &error);
            CHECK(ok && file.nameless == (opening == 0));
            uint64_t before = fault_count(FAULT_OF_CALL);
            fault_at(FAULT_OF_CALL, k);
            ok = file_output_write(&file, "new", 3, &error);
            if (ok)
                ok = file_output_commit(&file, &error);
            else
                file_output_abandon(&file);
            fault_at(FAULT_OF_CALL, 0);
            over = fault_count(FAULT_OF_CALL) - before < k;
            char *text = test_read_file("a.txt", &size);
            CHECK_TEXT(text, ok ? "new" : "old");
            CHECK(ok || (!over && error.kind == ERROR_MACHINE)); /* ok: all calls were tried, or a fallback succeeded */
            free(text);
            entries = 0;
            CHECK(file_list(".", 100, count_entry, NULL));
            CHECK_EQ_INT(entries, 1);
        }
}

TEST(shared_memory_is_made_or_refused_whichever_call_fails) {
    for (uint64_t k = 1, over = 0; !over; k++) {
        struct share share;
        struct error error = {0};
        uint64_t before = fault_count(FAULT_OF_CALL);
        fault_at(FAULT_OF_CALL, k);
        bool ok = share_create(&share, 10000, &error);
        fault_at(FAULT_OF_CALL, 0);
        over = fault_count(FAULT_OF_CALL) - before < k;
        CHECK(ok == (bool)over && (ok || error.kind == ERROR_MACHINE));
        if (ok)
            share_destroy(&share);
    }
}
#endif
