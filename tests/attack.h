/* Attacks on files: a row says what stands in a folder, what a scene and the command line name, and what may be
 * different afterwards. Everything else below the two folders of the row must be as it was: kind, mode, inode, bytes,
 * links; no special file may have been opened, and nothing may be left behind. Each row has fresh folders: "in", the
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
    /* Statements "verb NAME argument", parted by ';'. %XX in a NAME or an argument is a byte.
     *   empty png jpeg hdr pfm exr sh text   a file of this kind (png, hdr and pfm are whole pictures)
     *   poly                                 Lua that begins as a Radiance picture; polyp: as a PFM picture
     *   bytes NAME CONTENT                   scene NAME: the row's second scene, begins as a picture if NAME is one
     *   dir fifo socket null full block      tty: a link to a terminal of this test
     *   link NAME TARGET, hard NAME TARGET   mode NAME OCTAL, owner NAME UID, age NAME SECONDS
     *   reader NAME                          the test reads a FIFO, which must stay empty */
    const char *before;
    const char *scene;      /* Lua; p(name, width, height) renders, t(name) reads a texture */
    const char *scene_name; /* NULL: scene.lua; one that ends in .hdr or .pfm begins as such a picture */
    const char *second;     /* what `scene NAME` writes */
    const char *options;    /* words before the scene's name; a scene.lua among them stands for itself */
    const char *shell;      /* instead: a line of shell; $gray is the program */
    int (*inside)(void);    /* instead: a function of the test, in a process of its own; its value is the status */
    int status;
    /* Parts parted by '|' that the first line of standard error holds (of the error, where status is not 0); "*part":
     * anywhere in both outputs; "!part": nowhere in them. */
    const char *says;
    int notices; /* n > 0: lines with "notice:"; -1: none; 0: any number */
    /* What may be different:
     *   picture NAME, part NAME, dir NAME, file NAME   must have been written (file: bytes of any kind)
     *   maybe NAME, maybepart NAME, maybedir NAME      a picture, a part, a folder that may have been written
     *   gone NAME, opened NAME                         must be gone; a special file that may be opened */
    const char *after;
    unsigned flags;
};

/* Reports each row that fails by its name, and goes on with the others. */
void attacks_run(const struct attack *rows, size_t count);
#define ATTACKS(rows) attacks_run(rows, sizeof(rows) / sizeof *(rows))

/* One attack has been tried: a failure of the test, unless the reason is NULL. With GRAY_TEST_ATTACKS=FILE in the
 * environment a line is added to FILE: how it ended, as which user, its name, the reason. */
void attack_report(const char *name, uid_t user, const char *reason);

/* File systems that can do less, for the programs that are started from now on: the calls fail as they do there. */
enum attack_system {
    ATTACK_SYSTEM_WHOLE,
    ATTACK_SYSTEM_WITHOUT_TMPFILE,  /* no files without a name */
    ATTACK_SYSTEM_WITHOUT_EXCHANGE, /* nor renameat2 with flags */
    ATTACK_SYSTEM_WITHOUT_LINKS,    /* nor second names */
};
void attack_set_system(enum attack_system system); /* skips the test where that cannot be */

/* For attacks that are programs of their own. */
extern const char attack_prelude[]; /* of scenes: p(name, width, height) and t(name) */
extern const uint8_t attack_png[95];
const char *attack_binary(void); /* canonical */
/* The statements of a row in the folder `in`; false after a failure that is reported. */
bool attack_prepare(const char *in, const char *statements);
/* A program that runs in a folder, as that user (0: as the caller), with standard output and error in out.txt and
 * err.txt of the test's folder. Words are split at blanks. */
pid_t attack_start(const char *in, const char *words, uid_t user);
/* The same, stopped at its next call to the system and at each one after it (ptrace); skips where that cannot be. */
pid_t attack_start_traced(const char *in, const char *words, uid_t user);
/* Waits; 128 + signal; -1: it had to be ended after `seconds`. */
int attack_wait(pid_t program, double seconds);
/* The bytes of both outputs of attack_start, from malloc. */
char *attack_output(const char *name);
/* From now on CLOCK_REALTIME of this process, and of what it forks, goes so much ahead. */
void attack_set_clock(time_t seconds_ahead);
double attack_now(void);
void attack_rest(double seconds);
/* A user that is not root, and can run the program; 0: there is none here. */
uid_t attack_user(void);

#endif
