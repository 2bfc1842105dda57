/* A host for scripts that does not render: it records requests and messages. Used by the tests of src/script. */
#ifndef GRAY_TESTS_SCRIPT_HOST_H
#define GRAY_TESTS_SCRIPT_HOST_H

#include "base/fault.h"
#include "script/script.h"
#include "settings/settings.h"
#include "tests/harness.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct listener {
    int renders, messages, polls, cancel_at; /* cancel_at: the poll that cancels; 0 = none */
    char said[8192];                         /* all messages, one per line */
    char files[4096];                        /* names of the pictures, one per line */
    struct render_request last;              /* pointers in it are stale after the call */
    struct affine first_child[64];           /* parent_from_node of the root's first child, by render */
    void (*seen)(struct listener *listener, const struct render_request *request); /* NULL: no more */
    uint64_t fail_at, failing; /* the first picture makes this later allocation fail; the number of that allocation */
    enum fault_kind fail_kind; /* or this system call */
    struct error answer;       /* the error of render; ERROR_NONE: it succeeds */
};

static inline bool listener_render(void *context, const struct render_request *request, struct error *error) {
    struct listener *listener = context;
    if (listener->renders < 64 && request->root->first_child)
        listener->first_child[listener->renders] = node_parent_from_node(request->root->first_child->node).forward;
    if (listener->seen)
        listener->seen(listener, request);
    listener->renders++;
    if (listener->fail_at && !listener->failing) {
        listener->failing = fault_count(listener->fail_kind) + listener->fail_at;
        fault_at(listener->fail_kind, listener->fail_at);
    }
    listener->last = *request;
    size_t used = strlen(listener->files);
    (void)snprintf(listener->files + used, sizeof listener->files - used, "%s\n", request->file);
    if (listener->answer.kind == ERROR_NONE)
        return true;
    *error = listener->answer;
    return false;
}

static inline void listener_message(void *context, enum script_message kind, const char *text) {
    struct listener *listener = context;
    (void)kind;
    listener->messages++;
    size_t used = strlen(listener->said);
    (void)snprintf(listener->said + used, sizeof listener->said - used, "%s\n", text);
}

static inline bool listener_cancelled(void *context) {
    struct listener *listener = context;
    return ++listener->polls == listener->cancel_at;
}

/* Runs a script file; *traceback (may be NULL) is from malloc. */
static inline bool listen_to(struct listener *listener, const char *path, const struct script_options *options,
                             struct error *error, char **traceback) {
    struct script_options standard = {.transform_order = SCRIPT_ORDER_NEW, .library_folder = "lua"};
    struct assets assets = {0};
    struct script_host host = {.context = listener,
                               .assets = &assets,
                               .settings = settings_default(),
                               .render = listener_render,
                               .message = listener_message,
                               .cancelled = listener_cancelled};
    struct arena arena = {0};
    const char *lines = NULL;
    *error = (struct error){0};
    bool done = script_run(path, options ? options : &standard, &host, &arena, &lines, error);
    if (traceback) {
        *traceback = lines ? malloc(strlen(lines) + 1) : NULL;
        if (*traceback)
            strcpy(*traceback, lines);
    }
    arena_destroy(&arena);
    assets_destroy(&assets);
    return done;
}

/* The same with a text, as scene.lua in the test's folder. */
static inline bool listen_to_text(struct listener *listener, const char *text, const struct script_options *options,
                                  struct error *error) {
    char path[512];
    (void)snprintf(path, sizeof path, "%s/scene.lua", test_folder());
    (void)remove(path); /* a file system may write what is truncated to the disk at once; tests have thousands */
    test_write_text(path, text);
    return listen_to(listener, path, options, error, NULL);
}

/* A short script that runs, or fails with these words. */
struct corner {
    const char *text, *words; /* NULL: it runs */
};

/* Each script is preceded by `preparation` and by the name of its folder as arg_folder. */
static inline void check_corner(const char *preparation, const struct corner *corner,
                                const struct script_options *options) {
    char text[4096];
    struct listener listener = {.renders = 0};
    struct error error = {0};
    (void)snprintf(text, sizeof text, "arg_folder = '%s/' %s%s\n", test_folder(), preparation, corner->text);
    bool done = listen_to_text(&listener, text, options, &error);
    if (done != !corner->words || (corner->words && !strstr(error.text, corner->words)))
        test_fail(__FILE__, __LINE__, "%s: %s", corner->text, done ? "runs" : error.text);
}

#endif
