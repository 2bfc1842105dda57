/* Files that are not where a scene names them. Scenes of other programs come with their meshes, pictures and modules in
 * folders that those programs know (plane.obj is in Assets/Obj/), so a missing file is looked for by its name below the
 * scene's folder, then below the folder above it. The longest common end of the two paths wins, then the nearest file,
 * then byte order. If there is none, the case of letters does not count: other systems open Cow.OBJ as cow.obj.
 *
 * All names are listed once, at the first file that is missing: level by level, so that the list is in the order of
 * nearness. Folders are opened by path_policy_list, which leaves out what scenes may not read. Links to folders are not
 * followed, so there are no cycles; a link to a file counts if the file may be read. */
#include "sandbox/search.h"

#include "base/file.h"

#include <stdio.h>
#include <string.h>

enum { LEVELS = 4, ENTRIES = 10000 };

/* A folder whose entries are still to be listed. */
struct listed_folder {
    const char *path; /* with a final slash, or "" */
    struct listed_folder *next;
};

static bool add_file(struct file_search *search, const char *path) {
    if (search->count == ENTRIES)
        return true;
    search->files[search->count++] = path;
    return path != NULL;
}

/* Lists one folder without the entry `skipped`. False: no memory. */
static bool list_folder(struct file_search *search, const struct path_policy *path_policy, const char *path,
                        const char *skipped, size_t *budget, struct listed_folder ***tail) {
    struct path_policy_entry *entries;
    size_t count = path_policy_list(path_policy, path[0] ? path : ".", *budget, &search->arena, &entries);
    *budget -= count;
    for (size_t i = 0; i < count; i++) {
        const char *name = entries[i].name;
        if (!entries[i].is_folder) {
            if (!add_file(search, arena_format(&search->arena, "%s%s", path, name)))
                return false;
        } else if (strcmp(name, skipped) != 0) {
            struct listed_folder *folder = arena_alloc(&search->arena, sizeof *folder);
            if (!folder || !(folder->path = arena_format(&search->arena, "%s%s/", path, name)))
                return false;
            **tail = folder;
            *tail = &folder->next;
        }
    }
    return true;
}

/* All files below `root`, level by level. */
static bool list_tree(struct file_search *search, const struct path_policy *path_policy, const char *root,
                      const char *skipped, size_t *budget) {
    struct listed_folder first = {.path = root}, *level = &first;
    for (int depth = 0; level && depth <= LEVELS; depth++) {
        struct listed_folder *below = NULL, **tail = &below;
        for (; level && *budget > 0; level = level->next)
            if (!list_folder(search, path_policy, level->path, depth == 0 ? skipped : "", budget, &tail))
                return false;
        level = below;
    }
    return true;
}

static bool list_files(struct file_search *search, const struct path_policy *path_policy, const char *folder) {
    char canonical[4096];
    size_t budget = ENTRIES;
    const char *above = arena_format(&search->arena, "%s../", folder), *own = "";
    search->files = arena_alloc_array(&search->arena, ENTRIES, sizeof *search->files);
    if (!search->files || !above)
        return false;
    if (file_canonical(folder[0] ? folder : ".", canonical, sizeof canonical) && strrchr(canonical, '/'))
        own = strrchr(canonical, '/') + 1;
    search->listed = true;
    return list_tree(search, path_policy, folder, "", &budget) && list_tree(search, path_policy, above, own, &budget);
}

static bool is_slash(char c) {
    return c == '/' || c == '\\';
}

static char folded(char c) {
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

/* How many parts at the ends of both paths are equal; 0: not even the file names. */
static int common_end(const char *path, const char *name, bool any_case) {
    const char *a = path + strlen(path), *b = name + strlen(name);
    int parts = 0;
    for (;; a--, b--) {
        bool a_part_begins = a == path || a[-1] == '/', b_part_begins = b == name || is_slash(b[-1]);
        if (a_part_begins && b_part_begins)
            parts++;
        if (a == path || b == name)
            return parts;
        bool equal = a[-1] == b[-1] || (any_case && folded(a[-1]) == folded(b[-1]));
        if (!equal && !(is_slash(a[-1]) && is_slash(b[-1])))
            return parts;
    }
}

static const char *best_match(const struct file_search *search, const struct path_policy *path_policy, const char *name,
                              bool any_case) {
    const char *found = NULL;
    int best = 0;
    for (uint32_t i = 0; i < search->count; i++) {
        int parts = common_end(search->files[i], name, any_case);
        if (parts > best && path_policy_is_readable(path_policy, search->files[i])) {
            best = parts;
            found = search->files[i];
        }
    }
    return found;
}

bool search_find(struct file_search *search, const struct path_policy *path_policy, const char *folder,
                 const char *name, const char **found) {
    *found = NULL;
    if (!search->listed && !list_files(search, path_policy, folder))
        return false;
    *found = best_match(search, path_policy, name, false);
    if (!*found)
        *found = best_match(search, path_policy, name, true);
    return true;
}

static bool has_dots(const char *name) {
    for (const char *part = name; *part; part += strcspn(part, "/"), part += strspn(part, "/"))
        if (strncmp(part, "..", 2) == 0 && (part[2] == '/' || part[2] == '\0'))
            return true;
    return false;
}

bool search_may(const struct path_policy *path_policy, const char *folder, const char *name) {
    char beside[4096];
    if (name[0] == '/') /* a path of another machine, or of a folder that scenes may not read */
        return path_policy_is_outside(path_policy, name) ? !has_dots(name) : !path_policy_leads_out(path_policy, name);
    if ((size_t)snprintf(beside, sizeof beside, "%s%s", folder, name) >= sizeof beside)
        return true;
    if (path_policy_leads_out(path_policy, beside))
        return false;
    /* The name is first of all relative to the scene: only a link can be meant relative to the working directory. */
    return path_policy_is_outside(path_policy, name) || !path_policy_leads_out(path_policy, name);
}
