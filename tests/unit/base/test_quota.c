/* An exhausted quota: one line, status 3, the old picture and no other file; and folders that may not be written,
 * because of their mode or a read-only file system, with status 1. The quota is real in one test, on a small file
 * system if this user may mount one (btrfs counts the size of a subvolume, for root too); in the other, each system
 * call reports it, as network file systems may also do at fsync, close and rename. */
#define _GNU_SOURCE
#include "base/fault.h"
#include "tests/harness.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

/* It begins like a picture: other files are never replaced. */
#define OLD_PICTURE "PF\n1 an old picture"

/* %s is the file, then its width and height. */
#define SCENE                                                                                                          \
    "local r = gr.node('root')\n"                                                                                      \
    "r:add_child(gr.geometry('ball', gr.sphere(gr.material({0.8, 0.3, 0.2}, {0.5, 0.5, 0.5}, 20))))\n"                 \
    "gr.render(r, '%s', %d, %d, {0, 0, 6}, {0, 0, -1}, {0, 1, 0}, 40, {0.2, 0.2, 0.2},\n"                              \
    "  {gr.light({4, 5, 6}, {0.9, 0.9, 0.9}, {1, 0, 0})})\n"

static int shell(const char *line) {
    return test_run_shell(line, "");
}

static void put_scene(const char *name, const char *picture, int width, int height) {
    char text[1024];
    (void)snprintf(text, sizeof text, SCENE, picture, width, height);
    test_write_text(test_path(name), text);
}

static void expect_text(const char *name, const char *text) {
    char *have = test_read_file(test_path(name), NULL);
    if (!have || strcmp(have, text) != 0)
        test_fail(__FILE__, __LINE__, "%s is \"%.300s\", not \"%s\"", name, have ? have : "(not there)", text);
    free(have);
}

/* In a separate mount namespace, which takes its mounts with it. 77: not possible here. */
static const char with_quota[] =
    "[ -n \"$inside\" ] || { unshare -m true || exit 77; inside=1 exec unshare -m sh \"$0\"; }\n"
    "truncate -s 120M image && mkfs.btrfs -q image && mkdir disk || exit 77\n"
    "mount -o loop image disk && btrfs quota enable disk || exit 77\n"
    "btrfs subvolume create disk/own >/dev/null && btrfs qgroup limit 400K disk/own || exit 77\n"
    "printf 'PF\\n1 an old picture' >disk/own/out.pfm && sync -f disk/own\n"
    "$gray -q scene.lua >err.txt 2>&1; echo $? >status.txt\n"
    "ls -A disk/own >names.txt; cp disk/own/out.pfm kept.txt\n"
    "$gray -q scene.lua -o disk/own/b.pfm --shard 1/1 >part.txt 2>&1; echo $? >>status.txt; ls -A disk/own "
    ">>names.txt\n"
    "btrfs qgroup limit none disk/own && $gray -q scene.lua >>err.txt 2>&1; echo $? >>status.txt\n"
    "$gray -q scene.lua -o free.pfm; cmp disk/own/out.pfm free.pfm >>err.txt 2>&1; echo $? >>status.txt; umount disk\n";

TEST(a_quota_that_is_used_up_leaves_the_old_picture_and_no_temporary_file) {
    test_need_tools("unshare mount mkfs.btrfs");
    put_scene("scene.lua", "disk/own/out.pfm", 330, 250);
    test_write_text(test_path("quota.sh"), with_quota);
    int status = shell("sh quota.sh 2>said.txt");
    if (status == 77)
        test_skip("this user, kernel or machine has no file system with a quota to mount");
    CHECK_EQ_INT(status, 0);
    char said[256];
    (void)snprintf(said, sizeof said, "scene.lua: disk/own/out.pfm: cannot be written: %s\n", strerror(EDQUOT));
    expect_text("err.txt", said);
    expect_text("kept.txt", OLD_PICTURE);
    expect_text("names.txt", "out.pfm\nout.pfm\n");
    expect_text("status.txt", "3\n3\n0\n0\n");
    char *part = test_read_file(test_path("part.txt"), NULL);
    (void)snprintf(said, sizeof said, "disk/own/b.pfm.1-of-1.part: cannot be written: %s\n", strerror(EDQUOT));
    CHECK(part && strstr(part, said));
    free(part);
}

TEST(a_quota_may_be_met_by_any_call_to_the_system) {
#ifndef GRAY_FAULTS
    test_skip("failures on demand are only in builds with GRAY_FAULTS");
#endif
    put_scene("scene.lua", "sub/out.png", 12, 9);
    CHECK_EQ_INT(shell("GRAY_FAULT_COUNT=$PWD/counts $gray -q -j 1 scene.lua && mv sub/out.png whole.png"), 0);
    char *text = test_read_file(test_path("counts"), NULL), line[700];
    long long allocations = 0, calls = 0;
    CHECK(text && sscanf(text, "%lld %lld", &allocations, &calls) == 2 && calls > 20);
    free(text);
    int reported = 0;
    for (long long k = 1; k <= calls; k++) {
        (void)snprintf(
            line, sizeof line,
            "rm -rf sub; mkdir sub; printf old >sub/out.png; "
            "GRAY_FAIL_CALL=%lld GRAY_FAIL_ERRNO=%d timeout 60 $gray -q -j 1 scene.lua >err.txt 2>&1; s=$?; "
            "test \"$(ls -A sub)\" = out.png || s=90; "
            "printf old | cmp -s - sub/out.png || cmp -s whole.png sub/out.png || s=91; "
            "if [ $s = 0 ]; then cmp -s whole.png sub/out.png || s=92; "
            "else test $(wc -l <err.txt) -ge 1 || s=93; fi; "
            "if [ $s = 3 ] && grep -qx 'scene.lua: sub/out.png: cannot be written: Disk quota exceeded' err.txt; then "
            "test $(wc -l <err.txt) = 1 && s=4; fi; exit $s",
            k, EDQUOT);
        int status = shell(line);
        reported += status == 4;
        if (status != 0 && status != 1 && status != 3 && status != 4)
            test_fail(__FILE__, __LINE__, "call %lld: %d", k, status);
    }
    CHECK(reported >= 3); /* a write, the sync, the rename */
}

/* 77: not possible here. Root drops its privileges over files first. */
static const char without_rights[] =
    "mkdir shut && printf 'PF\\n1 an old picture' >shut/out.png && chmod 555 shut\n"
    "rights=; [ $(id -u) != 0 ] || rights='setpriv --bounding-set=-all --inh-caps=-all'\n"
    "$rights true || exit 77\n"
    "$rights $gray -q scene.lua >err.txt 2>&1; echo $? >status.txt\n"
    "$rights $gray -q scene.lua -o shut/new/b.png >>err.txt 2>&1; echo $? >>status.txt\n"
    "ls -A shut >names.txt; cp shut/out.png kept.txt; chmod 755 shut\n";
static const char without_writing[] =
    "[ -n \"$inside\" ] || { unshare -m true || exit 77; inside=1 exec unshare -m sh \"$0\"; }\n"
    "mkdir -p shut && printf 'PF\\n1 an old picture' >shut/out.png && mount --bind shut shut || exit 77\n"
    "mount -o remount,ro,bind shut || exit 77\n"
    "$gray -q scene.lua >err.txt 2>&1; echo $? >status.txt\n"
    "$gray -q scene.lua -o shut/new/b.png >>err.txt 2>&1; echo $? >>status.txt\n"
    "ls -A shut >names.txt; cp shut/out.png kept.txt\n";

static void expect_shut(const char *script, const char *why) {
    char lines[400];
    put_scene("scene.lua", "shut/out.png", 33, 25);
    test_write_text(test_path("shut.sh"), script);
    int status = shell("sh shut.sh 2>said.txt");
    if (status == 77)
        test_skip("this user may not give up rights or mount");
    CHECK_EQ_INT(status, 0);
    (void)snprintf(lines, sizeof lines,
                   "scene.lua:3: gr.render: shut/out.png: cannot be written: %s\n  stack traceback:\n"
                   "    [C]: in function 'gr.render'\n    scene.lua:3: in main chunk\n    [C]: in ?\n"
                   "shut/new/b.png: the folder shut/new cannot be made: %s\n",
                   why, why);
    expect_text("err.txt", lines);
    expect_text("status.txt", "1\n1\n");
    expect_text("names.txt", "out.png\n");
    expect_text("kept.txt", OLD_PICTURE);
}

TEST(a_folder_whose_mode_forbids_writing_keeps_the_old_picture) {
    expect_shut(without_rights, "Permission denied");
}

TEST(a_folder_of_a_read_only_file_system_keeps_the_old_picture) {
    expect_shut(without_writing, "Read-only file system");
}
