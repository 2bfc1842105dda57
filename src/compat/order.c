/* Decides from the text of a scene, before it runs, the form of its pictures and the order of transforms
 * (docs/language.md 12.4). The convention of the courses changed in autumn 2015 together with the stock scenes.
 * Evidence for the new order: names of the project dialect, tables with named fields, an explicit call, a mesh by file
 * name, table.unpack. Evidence for the old order, which counts only without evidence for the new one: readobj, a bare
 * unpack, meshes from vertex tables. A gr.mesh whose first argument is a material belongs to the project dialect. */
#include "compat/order.h"

#include "base/arena.h"
#include "base/file.h"
#include "base/path_policy.h"
#include "sandbox/lexer.h"
#include "sandbox/search.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

enum {
    PATHS = 4096,
    SCENE_LIMIT = 1 << 26,
    SELF_LIMIT = 1 << 28, /* of the scene itself, or a folder where files are searched */
    SIBLING_LIMIT = 1 << 20,
    SIBLINGS = 300,
    DEPTH = 8,
    FILES = 64,
    WINDOW = 8
};
/* What has been seen so far, in all files. */
struct evidence {
    bool mentions_gr, is_new, is_old;
    bool renders, renders_otherwise; /* gr.render{...}; any other use of gr.render, or a field background or sky */
    bool calls, several;             /* gr.render; more than once, or in a loop */
    uint64_t blocks;                 /* that are open, the innermost in bit 0: 1 for a loop */
    bool awaits_do;                  /* of a loop that begins */
    char new_reason[160], old_reason[160];
};

static void say_new(struct evidence *evidence, const char *what, int line) {
    if (!evidence->is_new)
        snprintf(evidence->new_reason, sizeof evidence->new_reason, "%s (line %d)", what, line);
    evidence->is_new = true;
}

static void say_old(struct evidence *evidence, const char *what, int line) {
    if (!evidence->is_old)
        snprintf(evidence->old_reason, sizeof evidence->old_reason, "%s (line %d)", what, line);
    evidence->is_old = true;
}

static bool is_project_name(const struct token *token) {
    static const char *const names[] = {
        "fast_mesh",         "vn_mesh",          "fast_vn_mesh",       "rr_material",        "marble_pnd_material",
        "wood_pnd_material", "td_cube_material", "td_sphere_material", "difresnel_material", "difresneld_material",
        "geometry",          "csg_union",        "csg_difference",     "csg_intersection",   "csg_merge",
        "csg_inverse",       "clipped_by",       "bounded_by",         "area_light",         "render_skybox"};
    for (size_t k = 0; k < sizeof names / sizeof names[0]; k++)
        if (token_is(token, TOKEN_NAME, names[k]))
            return true;
    return false;
}

/* Names that were given a material: `m = gr.material(...)`. */
struct materials {
    struct token names[64];
    int count;
};

static bool is_material(const struct materials *materials, const struct token *token) {
    for (int k = 0; k < materials->count; k++)
        if (materials->names[k].length == token->length &&
            memcmp(materials->names[k].text, token->text, token->length) == 0)
            return token->kind == TOKEN_NAME;
    return false;
}

/* The call of gr.mesh being read: the number of the argument, the depth of brackets, the first tokens of its first two
 * arguments. */
struct mesh_call {
    int depth; /* 0: none */
    int argument, line;
    bool at_start, material_first;
    struct token second;
};

static void follow_mesh_call(struct mesh_call *call, const struct token *token, const struct materials *materials,
                             struct evidence *evidence) {
    bool starts = call->at_start;
    call->at_start = false;
    if (starts && call->argument == 1)
        call->material_first = is_material(materials, token) || token_is(token, TOKEN_NAME, "gr");
    if (starts && call->argument == 2) {
        call->second = *token;
        if (token->kind == TOKEN_STRING)
            say_new(evidence, "gr.mesh reads a file", call->line);
        else if (call->material_first)
            say_new(evidence, "gr.mesh is given a material", call->line);
        else if (token_is_symbol(token, '{'))
            say_old(evidence, "gr.mesh is given vertex tables", call->line);
    }
    bool is_file = call->second.kind == TOKEN_STRING;
    if (starts && call->argument == 3 && !is_file && !call->material_first && !token_is_symbol(token, ')'))
        say_old(evidence, "gr.mesh is given vertex tables", call->line);
    if (token_is_symbol(token, '(') || token_is_symbol(token, '{') || token_is_symbol(token, '['))
        call->depth++;
    if (token_is_symbol(token, ')') || token_is_symbol(token, '}') || token_is_symbol(token, ']'))
        call->depth--;
    if (token_is_symbol(token, ',') && call->depth == 1) {
        call->argument++;
        call->at_start = true;
    }
}

static bool is_after_dot(const struct token *w, int k) {
    return token_is_symbol(&w[k - 1], '.') || token_is_symbol(&w[k - 1], ':');
}

/* The blocks of the text, for those that are loops. */
static void follow_blocks(const struct token *t, struct evidence *evidence) {
    bool is_loop = token_is(t, TOKEN_NAME, "for") || token_is(t, TOKEN_NAME, "while");
    bool is_do = token_is(t, TOKEN_NAME, "do");
    bool repeats = token_is(t, TOKEN_NAME, "repeat");
    bool begins = is_loop || repeats || (is_do && !evidence->awaits_do) || token_is(t, TOKEN_NAME, "if") ||
                  token_is(t, TOKEN_NAME, "function");
    if (begins)
        evidence->blocks = evidence->blocks << 1 | (is_loop || repeats);
    if (token_is(t, TOKEN_NAME, "end") || token_is(t, TOKEN_NAME, "until"))
        evidence->blocks >>= 1;
    evidence->awaits_do = is_loop || (evidence->awaits_do && !is_do);
}

static bool is_render(const struct token *t) {
    return token_is(t, TOKEN_NAME, "render") || token_is(t, TOKEN_NAME, "light_field");
}

/* gr.render{...}, gr.render({...}) and node:render{...} have the table form, as have the tables for gr.frames. */
static void judge_picture(const struct token *w, struct evidence *evidence) {
    const struct token *t = &w[WINDOW - 1];
    bool after_name = is_render(&w[WINDOW - 2]) && is_after_dot(w, WINDOW - 2);
    bool after_bracket =
        token_is_symbol(&w[WINDOW - 2], '(') && is_render(&w[WINDOW - 3]) && is_after_dot(w, WINDOW - 3);
    bool is_field = token_is(&w[WINDOW - 3], TOKEN_NAME, "background") || token_is(&w[WINDOW - 3], TOKEN_NAME, "sky");
    if (after_name || after_bracket) {
        evidence->renders = evidence->renders || token_is_symbol(t, '{');
        bool open = token_is_symbol(t, '{') || (after_name && token_is_symbol(t, '('));
        bool again = after_name && open && (evidence->calls || evidence->blocks != 0);
        evidence->several = evidence->several || again;
        evidence->calls = evidence->calls || (after_name && open);
        evidence->renders_otherwise = evidence->renders_otherwise || !open;
    }
    bool draws = token_is(t, TOKEN_NAME, "frames") && is_after_dot(w, WINDOW - 1);
    evidence->renders = evidence->renders || (draws && token_is(&w[WINDOW - 3], TOKEN_NAME, "gr"));
    /* background = 'transparent' keeps the default for mirrors. */
    if ((is_field && token_is_symbol(&w[WINDOW - 2], '=') && !token_is(t, TOKEN_STRING, "transparent")) ||
        (token_is(t, TOKEN_NAME, "render_skybox") && is_after_dot(w, WINDOW - 1)))
        evidence->renders_otherwise = true;
}

/* A token and those before it: w[WINDOW - 1] is the latest. */
static void judge(const struct token *w, struct evidence *evidence, struct materials *materials,
                  struct mesh_call *call) {
    const struct token *t = &w[WINDOW - 1];
    bool after_dot = token_is_symbol(&w[WINDOW - 2], '.') || token_is_symbol(&w[WINDOW - 2], ':');
    /* Blocks, pictures and calls of gr.mesh extend over many tokens. */
    follow_blocks(t, evidence);
    judge_picture(w, evidence);
    if (call->depth > 0)
        follow_mesh_call(call, t, materials, evidence);
    /* Names of the old and of the new Lua. */
    if (token_is(t, TOKEN_NAME, "gr") && !after_dot)
        evidence->mentions_gr = true;
    if (token_is(t, TOKEN_NAME, "readobj") && !after_dot)
        say_old(evidence, "it uses readobj", t->line);
    if (token_is(t, TOKEN_NAME, "unpack") && !after_dot)
        say_old(evidence, "it calls unpack, not table.unpack", t->line);
    if (token_is(t, TOKEN_NAME, "unpack") && after_dot && token_is(&w[WINDOW - 3], TOKEN_NAME, "table"))
        say_new(evidence, "it uses table.unpack", t->line);

    /* Names of gr. */
    bool gr_dot = token_is_symbol(&w[WINDOW - 2], '.') && token_is(&w[WINDOW - 3], TOKEN_NAME, "gr");
    if (gr_dot && is_project_name(t))
        say_new(evidence, "it uses names of the project dialect", t->line);
    if (gr_dot && token_is(t, TOKEN_NAME, "transform_order"))
        say_new(evidence, "it calls gr.transform_order", t->line);
    bool assigned = gr_dot && token_is_symbol(&w[WINDOW - 4], '=') && w[WINDOW - 5].kind == TOKEN_NAME;
    if (assigned && token_is(t, TOKEN_NAME, "material") && materials->count < 64)
        materials->names[materials->count++] = w[WINDOW - 5];

    /* Calls of gr, and how their arguments look. */
    bool call_begins = token_is_symbol(&w[WINDOW - 3], '.') && token_is(&w[WINDOW - 4], TOKEN_NAME, "gr");
    if (call_begins && token_is_symbol(t, '{'))
        say_new(evidence, "it uses tables with named fields", t->line);
    if (call_begins && token_is_symbol(t, '(') && token_is(&w[WINDOW - 2], TOKEN_NAME, "mesh") && call->depth == 0)
        *call = (struct mesh_call){.depth = 1, .argument = 1, .line = t->line, .at_start = true};
    bool primitive = token_is(&w[WINDOW - 3], TOKEN_NAME, "sphere") || token_is(&w[WINDOW - 3], TOKEN_NAME, "cube");
    if (primitive && token_is_symbol(&w[WINDOW - 2], '(') && token_is_symbol(&w[WINDOW - 4], '.') &&
        is_material(materials, t))
        say_new(evidence, "a primitive is given its material", t->line);
    bool named = token_is_symbol(t, '=') && w[WINDOW - 2].kind == TOKEN_NAME && token_is_symbol(&w[WINDOW - 3], '{') &&
                 token_is_symbol(&w[WINDOW - 4], '(') && token_is_symbol(&w[WINDOW - 6], '.') &&
                 token_is(&w[WINDOW - 7], TOKEN_NAME, "gr");
    if (named)
        say_new(evidence, "it uses tables with named fields", t->line);
}

/* The string of require 'x', require('x'), dofile ..., loadfile ... that the newest token completes. */
static const struct token *required(const struct token *w, bool *is_module) {
    const struct token *t = &w[WINDOW - 1], *name = &w[WINDOW - 2];
    if (t->kind != TOKEN_STRING)
        return NULL;
    if (token_is_symbol(name, '('))
        name = &w[WINDOW - 3];
    *is_module = token_is(name, TOKEN_NAME, "require");
    bool file = token_is(name, TOKEN_NAME, "dofile") || token_is(name, TOKEN_NAME, "loadfile");
    return *is_module || file ? t : NULL;
}

struct search {
    struct arena arena;
    const struct path_policy *path_policy;
    char folder[PATHS], library[PATHS]; /* the scene's with its final slash; the library's canonical one */
    const char *visited[FILES];
    int visited_count;
    struct evidence evidence;
    struct file_search files; /* for those that are not at the path in the script */
    bool no_memory, unread;   /* unread: the scene itself could not be read; with the error */
    struct error error;
};

static void scan_file(struct search *search, const char *path, int depth);

static bool try_path(const struct search *search, char out[PATHS], const char *folder, const char *separator,
                     const char *name, const char *end) {
    int length = snprintf(out, PATHS, "%s%s%s%s", folder, separator, name, end);
    return (size_t)length < PATHS && path_policy_is_readable(search->path_policy, out);
}

static void follow(struct search *search, const struct token *token, bool is_module, int depth) {
    /* The name of a module with slashes. */
    char name[512], path[PATHS];
    if (token->length >= sizeof name || token->length == 0)
        return;
    memcpy(name, token->text, token->length);
    name[token->length] = '\0';
    for (char *c = name; is_module && *c; c++)
        if (*c == '.' && strcmp(c, ".lua") != 0)
            *c = '/';
    /* Where Lua looks for it. */
    size_t length = strlen(name);
    bool has_end = length > 4 && strcmp(name + length - 4, ".lua") == 0;
    const char *end = is_module && !has_end ? ".lua" : "", *folder = name[0] == '/' ? "" : search->folder;
    if (try_path(search, path, folder, "", name, end) || try_path(search, path, "", "", name, end) ||
        try_path(search, path, folder, "lua/", name, end) || try_path(search, path, folder, "../lua/", name, end)) {
        scan_file(search, path, depth + 1);
        return;
    }
    /* A library module is none of the scene; otherwise the file is searched as files of scenes are. */
    const char *found;
    if (search->library[0] && try_path(search, path, search->library, "/", name, end))
        return;
    (void)snprintf(path, sizeof path, "%s%s", name, end);
    if (!search_may(search->path_policy, search->folder, path))
        return;
    if (!search_find(&search->files, search->path_policy, search->folder, path, &found))
        search->no_memory = true;
    else if (found)
        scan_file(search, found, depth + 1);
}

static void scan_text(struct search *search, const char *text, size_t size, int depth) {
    struct lexer lexer = {text, text + size, 1};
    if (size > 0 && text[0] == '#')
        lexer_skip_line(&lexer);
    struct token window[WINDOW] = {0};
    struct materials materials = {.count = 0};
    struct mesh_call call = {0};
    uint64_t outside = search->evidence.blocks;
    search->evidence.blocks = 0;
    do {
        memmove(window, window + 1, (WINDOW - 1) * sizeof *window);
        window[WINDOW - 1] = lexer_next(&lexer);
        judge(window, &search->evidence, &materials, &call);
        bool is_module;
        const struct token *file = depth < DEPTH ? required(window, &is_module) : NULL;
        if (file)
            follow(search, file, is_module, depth);
    } while (window[WINDOW - 1].kind != TOKEN_END);
    search->evidence.blocks = outside;
}

static void scan_file(struct search *search, const char *path, int depth) {
    char canonical[PATHS];
    if (search->visited_count == FILES)
        return;
    if (!file_canonical(path, canonical, sizeof canonical)) {
        if (depth == 0 && errno != ENOENT)
            search->unread = !error_set(&search->error, ERROR_SCENE, "%s: cannot be found: %s", path, strerror(errno));
        return;
    }
    size_t library = strlen(search->library);
    if (library > 0 && strncmp(canonical, search->library, library) == 0 && canonical[library] == '/')
        return;
    for (int k = 0; k < search->visited_count; k++)
        if (strcmp(search->visited[k], canonical) == 0)
            return;
    char *copy = arena_copy_text(&search->arena, canonical, strlen(canonical));
    if (!copy) {
        search->no_memory = true;
        return;
    }
    search->visited[search->visited_count++] = copy;
    struct file_bytes bytes;
    struct error error;
    /* The user named the scene itself, so it may be a link to any file. It must be readable, because its text decides
     * how it is rendered; other files may be missing. */
    if (!path_policy_map(depth > 0 ? search->path_policy : NULL, path, depth > 0 ? SCENE_LIMIT : SELF_LIMIT, &bytes,
                         &error)) {
        if (depth == 0) {
            search->unread = true;
            search->error = error;
        }
        return;
    }
    scan_text(search, (const char *)bytes.data, bytes.size, depth);
    file_unmap(&bytes);
}

static void conclude(const struct evidence *evidence, struct order_finding *finding) {
    bool old = evidence->is_old && !evidence->is_new;
    finding->order = old ? TRANSFORM_ORDER_OLD : TRANSFORM_ORDER_NEW;
    finding->only_named_pictures = evidence->renders && !evidence->renders_otherwise;
    finding->several_pictures = evidence->several;
    const char *reason = old ? evidence->old_reason : evidence->is_new ? evidence->new_reason : "";
    snprintf(finding->reason, sizeof finding->reason, "%s", reason);
}

/* The majority of the siblings decides; the message names the first old one. */
struct siblings {
    struct search *search;
    const char *self;
    char folder[PATHS]; /* canonical */
    int votes_new, votes_old;
    char reason[400];
};

/* Whether a sibling is a link to a hidden file or to a file in another folder. */
static bool is_hidden(const struct siblings *siblings, const char *path) {
    char canonical[PATHS];
    size_t same = 0;
    if (!file_canonical(path, canonical, sizeof canonical))
        return true;
    while (canonical[same] && canonical[same] == siblings->folder[same])
        same++;
    while (same > 0 && canonical[same] != '/')
        same--;
    return strstr(canonical + same, "/.") != NULL;
}

static bool ask_sibling(void *context, const char *name) {
    struct siblings *siblings = context;
    size_t length = strlen(name);
    char path[PATHS];
    if (length < 5 || strcmp(name + length - 4, ".lua") != 0 || strcmp(name, siblings->self) == 0)
        return true;
    if (!try_path(siblings->search, path, siblings->search->folder, "", name, "") || is_hidden(siblings, path))
        return true;
    struct file_bytes bytes;
    struct error ignored;
    if (!path_policy_map(siblings->search->path_policy, path, SIBLING_LIMIT, &bytes, &ignored))
        return true;
    struct evidence before = siblings->search->evidence;
    siblings->search->evidence = (struct evidence){0};
    scan_text(siblings->search, (const char *)bytes.data, bytes.size, DEPTH);
    const struct evidence *seen = &siblings->search->evidence;
    if (seen->mentions_gr && seen->is_new)
        siblings->votes_new++;
    else if (seen->mentions_gr && seen->is_old && siblings->votes_old++ == 0)
        snprintf(siblings->reason, sizeof siblings->reason, "of its neighbour %.200s: %s", name, seen->old_reason);
    siblings->search->evidence = before;
    file_unmap(&bytes);
    return true;
}

bool order_detect(const char *path, const char *library_folder, const struct path_policy *path_policy,
                  struct order_finding *finding, struct error *error) {
    struct search search = {.path_policy = path_policy};
    /* The folders of the scene and of the library. */
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
    *finding = (struct order_finding){.order = TRANSFORM_ORDER_NEW};
    if (folder >= PATHS)
        return true;
    memcpy(search.folder, path, folder);
    if (library_folder && !file_canonical(library_folder, search.library, sizeof search.library))
        search.library[0] = '\0';

    /* What the scene itself says. */
    scan_file(&search, path, 0);
    conclude(&search.evidence, finding);
    /* Otherwise the scenes beside it decide. */
    if (!search.evidence.is_new && !search.evidence.is_old) {
        struct siblings siblings = {.search = &search, .self = slash ? slash + 1 : path};
        const char *start = folder > 0 ? search.folder : ".";
        if (file_canonical(start, siblings.folder, sizeof siblings.folder))
            (void)file_list(start, SIBLINGS, ask_sibling, &siblings);
        if (siblings.votes_old > siblings.votes_new) {
            finding->order = TRANSFORM_ORDER_OLD;
            memcpy(finding->reason, siblings.reason, sizeof finding->reason);
        }
    }
    arena_destroy(&search.arena);
    arena_destroy(&search.files.arena);
    if (search.unread)
        *error = search.error;
    if (search.no_memory)
        return error_no_memory(error, "the order of transforms");
    return !search.unread;
}

void order_of_text(const char *text, size_t size, struct order_finding *finding) {
    struct search search = {.visited_count = 0};
    scan_text(&search, text, size, DEPTH);
    conclude(&search.evidence, finding);
}
