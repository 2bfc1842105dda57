/* Attacks on files: a row says what a folder contains, what a scene and the command line name, and what may be
 * different afterwards. Everything else below the two folders of the row must be as it was: kind, mode, inode, bytes,
 * links; no special file may have been opened, and no temporary file may remain. Each row has new folders: "in", the
 * working directory with scene.lua, and "out" beside it with canary.png, canary.txt and canary.fifo. As root every row
 * runs twice, as root and as an ordinary user who owns both folders. */
#ifndef GRAY_TESTS_ATTACK_H
#define GRAY_TESTS_ATTACK_H

#include "tests/harness.h"

#include <sys/types.h>
#include <time.h>

enum { ATTACK_ANY = -1, ATTACK_WRONG = -2 }; /* any status; 1, 2 or 3 */
enum {
    ATTACK_BY_ROOT = 1, /* only root can prepare it; an ordinary user runs it then, too */
    ATTACK_AS_USER = 2, /* makes sense only for an ordinary user */
    ATTACK_AS_ROOT = 4, /* makes sense only for root */
    ATTACK_NO_RAY = 8,  /* no picture may have begun to render */
};

struct attack {
    const char *name;
    /* Statements "verb NAME argument", separated by ';'. %XX in a NAME or an argument is a byte.
     *   empty png jpeg hdr pfm exr sh text   a file of this kind (png, hdr and pfm are complete pictures)
     *   poly                                 Lua that begins as a Radiance picture; polyp: as a PFM picture
     *   bytes NAME CONTENT                   scene NAME: the row's second scene, begins as a picture if NAME is one
     *   dir fifo socket null full block      tty: a link to a terminal of this test
     *   link NAME TARGET, hard NAME TARGET   mode NAME OCTAL, owner NAME UID, age NAME SECONDS
     *   reader NAME                          the test reads a FIFO, which must stay empty */
    const char *before;
    const char *scene;      /* Lua; p(name, width, height) renders, t(name) reads a texture */
    const char *scene_name; /* NULL: scene.lua; one that ends in .hdr or .pfm begins as such a picture */
    const char *second;     /* what `scene NAME` writes */
    const char *options;    /* words before the scene's name; a scene.lua among them is the scene itself */
    const char *shell;      /* instead: a line of shell; $gray is the program */
    int (*inside)(void);    /* instead: a function of the test, in a process of its own; its value is the status */
    int status;
    /* Parts separated by '|' that the first line of standard error contains (the line of the error if status is not 0);
     * "*part": anywhere in both outputs; "!part": nowhere in them. */
    const char *says;
    int notices; /* n > 0: lines with "notice:"; -1: none; 0: any number */
    /* What may be different:
     *   picture NAME, part NAME, dir NAME, file NAME   must have been written (file: bytes of any kind)
     *   maybe NAME, maybepart NAME, maybedir NAME      a picture, a part, a folder that may have been written
     *   gone NAME, opened NAME                         must be gone; a special file that may be opened */
    const char *after;
    unsigned flags;
};

/* Reports each row that fails by its name and continues with the others. */
void attacks_run(const struct attack *rows, size_t count);
#define ATTACKS(rows) attacks_run(rows, sizeof(rows) / sizeof *(rows))

/* Records one attack: a failure of the test unless the reason is NULL. With GRAY_TEST_ATTACKS=FILE in the
 * environment a line is added to FILE: how it ended, as which user, its name, the reason. */
void attack_report(const char *name, uid_t user, const char *reason);

/* Simulates file systems with fewer features for the programs that are started from now on: the calls fail as they do
 * there. */
enum attack_system {
    ATTACK_SYSTEM_WHOLE,
    ATTACK_SYSTEM_WITHOUT_TMPFILE,  /* no files without a name */
    ATTACK_SYSTEM_WITHOUT_EXCHANGE, /* no renameat2 with flags */
    ATTACK_SYSTEM_WITHOUT_LINKS,    /* no hard links */
};
void attack_set_system(enum attack_system system); /* skips the test where this is impossible */

/* For attacks that are separate programs. */
extern const char attack_prelude[]; /* of scenes: p(name, width, height) and t(name) */
extern const uint8_t attack_png[95];
const char *attack_binary(void); /* canonical */
/* The statements of a row in the folder `in`; false after a failure that is reported. */
bool attack_prepare(const char *in, const char *statements);
/* A new folder, open to every user, with these files and a scene; its path is valid until the next one. */
const char *attack_folder(const char *statements, const char *scene);
/* Starts a program in a folder as the given user (0: as the caller). Standard output and error go to out.txt and
 * err.txt in the test's folder. Words are split at blanks. */
pid_t attack_start(const char *in, const char *words, uid_t user);
/* The same, stopped at its next system call and at each one after it (ptrace); skips where this is impossible. */
pid_t attack_start_traced(const char *in, const char *words, uid_t user);
/* Waits for the end. Returns the status, 128 + signal, or -1 if the program had to be killed after `seconds`. */
int attack_wait(pid_t program, double seconds);
/* Seconds after which a program hangs, also on a busy machine. */
enum { ATTACK_PATIENCE = 120 };
/* The bytes of both outputs of attack_start, from malloc. */
char *attack_output(const char *name);
/* From now on CLOCK_REALTIME of this process and of its children is ahead by this many seconds. */
void attack_set_clock(time_t seconds);
double attack_now(void);
void attack_rest(double seconds);
/* A user other than root who can run the program; 0: there is none here. */
uid_t attack_user(void);

#endif
