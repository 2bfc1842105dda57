/* The rules of writing on file systems with fewer features: without unnamed files, without exchange of two names,
 * without hard links. The rows are attacks: see attack.h. */
#define _GNU_SOURCE
#include "tests/attack.h"

static void run_on(enum attack_system system) {
    static const struct attack rows[] = {
        {.name = "a new picture", .scene = "p'x.png'", .after = "picture x.png"},
        {.name = "a picture twice", .scene = "p'x.png' t'x.png' p('x.png', 5, 4)", .after = "picture x.png"},
        {.name = "over a picture with all rights",
         .before = "png x.png; mode x.png 7777",
         .scene = "p'x.png'",
         .after = "picture x.png"},
        {.name = "over an empty file", .before = "empty x.png", .scene = "p'x.png'", .after = "picture x.png"},
        {.name = "over a second name of a picture outside",
         .before = "hard x.png ../out/canary.png",
         .scene = "p'x.png'",
         .after = "picture x.png"},
        {.name = "in new folders", .scene = "p'a/b/x.png'", .after = "dir a; dir a/b; picture a/b/x.png"},
        {.name = "over text", .before = "text x.png", .scene = "p'x.png'", .status = 1, .says = "x.png"},
        {.name = "over a texture", .before = "png t.png", .scene = "t't.png' p't.png'", .status = 1},
        {.name = "over a link",
         .before = "link x.png ../out/canary.png",
         .scene = "p'x.png'",
         .status = 1,
         .says = "x.png|-o"},
        {.name = "over a FIFO", .before = "fifo x.png; reader x.png", .scene = "p'x.png'", .status = 1},
        {.name = "over a terminal", .before = "tty x.pfm", .scene = "p'x.pfm'", .status = 1},
        {.name = "by -o over text", .before = "text x.txt", .options = "-o x.txt", .scene = "p'y.png'", .status = 1},
        {.name = "by -o and force over text",
         .before = "text x.txt",
         .options = "--force -o x.txt",
         .scene = "p'y.png'",
         .after = "picture x.txt"},
        {.name = "a checkpoint that is written and removed",
         .options = "--checkpoint auto --checkpoint-every 0",
         .scene = "p('x.png', 90, 90) p('y.png', 90, 90)",
         .after = "picture x.png; picture y.png"},
        {.name = "a part", .options = "--shard 1/2", .scene = "p'x.png'", .after = "part x.png.1-of-2.part"},
        {.name = "layers",
         .before = "png x.depth.png",
         .options = "--aov depth,normal",
         .scene = "p'x.png'",
         .after = "picture x.png; picture x.depth.png; picture x.normal.png"},
        {.name = "under --check", .before = "png x.png", .options = "--check", .scene = "p'x.png' p'y.png'"},
        {.name = "refused and tried again",
         .before = "text x.png",
         .scene = "assert(not pcall(p, 'x.png')) p'y.png'",
         .after = "picture y.png"},
    };
    attack_set_system(system);
    ATTACKS(rows);
}

TEST(hostile_pictures_follow_their_rules_without_nameless_files) {
    run_on(ATTACK_SYSTEM_WITHOUT_TMPFILE);
}

TEST(hostile_pictures_follow_their_rules_without_exchange) {
    run_on(ATTACK_SYSTEM_WITHOUT_EXCHANGE);
}

TEST(hostile_pictures_follow_their_rules_without_second_names) {
    run_on(ATTACK_SYSTEM_WITHOUT_LINKS);
}
